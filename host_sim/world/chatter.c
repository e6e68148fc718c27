#include "world/chatter.h"

#include "engine/random.h"

#include <string.h>

static enum mh_status init(void *state, const void *config, const struct mh_protocol_node *node)
{
    const struct chatter_config *chosen = config;
    if (!state || !chosen || !node || chosen->interval < 1) {
        return MH_ERR_ARGUMENT;
    }
    *(struct chatter *)state = (struct chatter){.config = chosen, .node = node};
    return MH_OK;
}

/* Places differ from run to run, so phases do. */
static void start(void *state, mh_tick now)
{
    struct chatter *c = state;
    const struct mh_place place = c->node->place;
    const struct random_stream stream = {(uint64_t)(uint32_t)place.x_mm << 32 | (uint32_t)place.y_mm};
    c->next = now + (mh_tick)(random_uniform(stream, c->node->id) * c->config->interval);
    c->node->port->set_timer(c->node->context, c->next);
}

static void message(void *state, mh_tick now, const struct mh_message *heard)
{
    (void)now, (void)heard;
    ((struct chatter *)state)->heard++;
}

static void timer(void *state, mh_tick now)
{
    struct chatter *c = state;
    if (mh_tick_before(now, c->next)) {
        return;
    }
    const struct mh_message said = {.kind = MH_MESSAGE_LANDMARK,
                                    .as.landmark = {.beacon = {.sender = (int32_t)c->node->id},
                                                    .x_mm = c->node->place.x_mm,
                                                    .y_mm = c->node->place.y_mm}};
    c->node->port->send(c->node->context, MH_BROADCAST, &said);
    c->next += c->config->interval;
    c->node->port->set_timer(c->node->context, c->next);
}

static enum mh_status publish(void *state, mh_tick now, const struct mh_measurement *measurement)
{
    (void)state, (void)now, (void)measurement;
    return MH_ERR_NO_ROUTE;
}

static mh_wire_types types[] = {&mh_wire_landmark, NULL};

const struct mh_protocol chatter_protocol = {.name = "chatter",
                                             .state_size = sizeof(struct chatter),
                                             .config_size = sizeof(struct chatter_config),
                                             .types = types,
                                             .init = init,
                                             .start = start,
                                             .message = message,
                                             .timer = timer,
                                             .publish = publish};
