#include "cluster_node.h"

#define OLD 10 /* instants after which what is known of a track does not stand against another */

void mh_cluster_hear_position(struct mh_cluster_node *c, const mh_position_t *position)
{
    const mh_tick time = (mh_tick)position->time_ms;
    const struct mh_cluster_of told = {.track = (mh_node_id)position->track,
                                       .head = (mh_node_id)position->origin,
                                       .generation = position->generation,
                                       .heard = time};
    const int32_t age = mh_ticks_between(time, c->time), old = OLD * (int32_t)c->config->election.interval;
    if (c->role != MH_CLUSTER_SINK || age < 0 || age > old) {
        return;
    }
    if (c->knows && mh_ticks_between(c->of.heard, c->time) < old && mh_cluster_outranks(&c->of, &told) &&
        !(told.track == c->of.track && told.head == c->of.head)) {
        return;
    }
    const struct mh_vec2 here = {0, 0};
    const struct mh_vec2 velocity = {mh_real_from_ratio(position->vx_mmps, 1000),
                                     mh_real_from_ratio(position->vy_mmps, 1000)};
    if (mh_followed_report(&c->followed, time, here, velocity) == MH_OK) {
        const struct mh_place origin = {position->x_mm, position->y_mm, 0};
        c->followed_origin = origin;
        c->of = told;
        c->knows = true;
    }
}

void mh_cluster_tell(struct mh_cluster_node *c)
{
    struct mh_estimate estimate = {.origin = c->followed_origin,
                                   .time = c->instant,
                                   .velocity = c->followed.velocity,
                                   .stored_velocity = c->followed.velocity,
                                   .flags = MH_ESTIMATE_COASTED};
    if (mh_followed_predict(&c->followed, c->instant, &estimate.position) == MH_OK) {
        estimate.raw = estimate.stored = estimate.position;
        c->node->port->tell(c->node->context, &estimate);
    }
}
