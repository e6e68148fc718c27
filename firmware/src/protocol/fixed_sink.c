#include "fixed_node.h"

static void plan(struct mh_fixed *f, mh_tick time)
{
    f->fused = time;
    mh_fixed_set(f, MH_FIXED_FUSE, time + f->config->wait);
}

void mh_fixed_begin_sink(struct mh_fixed *f)
{
    for (uint8_t i = 0; i < f->config->cluster_count; i++) {
        f->incoming[i].parcel.begun = f->incoming[i].has_head = f->incoming[i].has_taken = false;
    }
    (void)f->config->port->begin(f->node->context); /* without a centre there is nothing to fuse */
    plan(f, mh_tick_aligned(0, f->config->fuse_interval, f->time + 1));
}

static void feed_back(struct mh_fixed *f, mh_tick time)
{
    uint8_t bytes[MH_SUMMARY_BYTES_MAX];
    size_t length;
    if (f->config->port->feedback(f->node->context, bytes, &length) != MH_OK) {
        return;
    }
    for (uint8_t i = 0; i < f->config->cluster_count; i++) {
        if (f->incoming[i].has_head) {
            const struct mh_fixed_member *head = &f->config->clusters[i].members[f->incoming[i].head];
            mh_fixed_send_bytes(f, i, time, bytes, length, head->id, &head->place);
        }
    }
}

void mh_fixed_fuse(struct mh_fixed *f)
{
    const mh_tick time = f->fused;
    struct mh_estimate estimate;
    plan(f, time + f->config->fuse_interval);
    if (f->config->port->fuse(f->node->context, time, &estimate) == MH_OK) {
        f->counters.fused++;
        f->node->port->tell(f->node->context, &estimate);
        feed_back(f, time);
    }
}

static void take(struct mh_fixed *f, uint8_t cluster, const struct mh_fixed_member *head, mh_tick time)
{
    struct mh_fixed_incoming *incoming = &f->incoming[cluster];
    const enum mh_status status =
        f->config->port->take(f->node->context, cluster, time, incoming->bytes, incoming->parcel.length);
    switch (status) {
    case MH_OK:
        f->counters.taken++;
        incoming->taken = time;
        incoming->has_taken = true;
        break;
    case MH_ERR_REPEATED:
        f->counters.repeated++;
        break;
    case MH_ERR_TIME:
    case MH_ERR_CAPACITY:
        f->counters.overdue++;
        break;
    default:
        f->counters.refused++;
        break;
    }
    if (f->config->acknowledges && incoming->has_taken && (status == MH_OK || status == MH_ERR_REPEATED)) {
        struct mh_message message = {.kind = MH_MESSAGE_TAKEN,
                                     .as.taken = {.time_ms = (int32_t)incoming->taken, .cluster = cluster}};
        (void)mh_fixed_send(f, &message, head->id, &head->place); /* counts what it refuses */
    }
}

void mh_fixed_hear_summary(struct mh_fixed *f, mh_node_id from, const mh_hand_over_t *part)
{
    const bool known = part->track >= 0 && part->track < f->config->cluster_count;
    const uint8_t cluster = known ? (uint8_t)part->track : 0;
    const struct mh_fixed_cluster *of = &f->config->clusters[cluster];
    struct mh_fixed_incoming *incoming = &f->incoming[cluster];
    const uint8_t head = mh_fixed_member_of(of, from);
    if (!known || head == MH_FIXED_NOBODY) {
        f->counters.refused++;
        return;
    }
    const enum mh_status status = mh_parcel_join(&incoming->parcel, incoming->bytes, MH_SUMMARY_BYTES_MAX, from, part);
    if (status == MH_OK) {
        incoming->head = head;
        incoming->has_head = true;
        take(f, cluster, &of->members[head], (mh_tick)part->time_ms);
    } else if (status != MH_NONE && status != MH_ERR_REPEATED) {
        f->counters.refused++;
    }
}
