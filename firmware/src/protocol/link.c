#include "motehound/link.h"

#include <string.h>

#define DOUBLINGS_MAX 6

static void count(uint16_t *counter)
{
    if (*counter < UINT16_MAX) {
        (*counter)++;
    }
}

void mh_link_config_default(struct mh_link_config *config)
{
    const struct mh_link_config nominal = {.attempts = 8, .backoff = 4};
    *config = nominal;
}

enum mh_status mh_link_init(struct mh_link *link, const struct mh_link_config *config,
                            const struct mh_protocol_node *node)
{
    if (!link || !config || !node || config->attempts < 1 || config->attempts > 100 || config->backoff < 1 ||
        config->backoff > 1000) {
        return MH_ERR_ARGUMENT;
    }
    memset(link, 0, sizeof *link);
    link->config = config;
    link->node = node;
    return MH_OK;
}

void mh_link_broadcast(struct mh_link *link, const struct mh_message *message)
{
    uint8_t *before_or_after = link->in_air ? &link->behind : &link->ahead;
    (*before_or_after)++;
    link->node->port->send(link->node->context, MH_BROADCAST, message);
}

/* ---- what was taken before ---- */

static bool was_seen(const struct mh_link *link, const struct mh_message *message)
{
    const mh_route_t *route = &message->header.route;
    for (uint8_t i = 0; i < link->seen_count; i++) {
        if (link->seen[i].origin == (mh_node_id)route->origin && link->seen[i].sequence == route->sequence &&
            (message->envelope == MH_ENVELOPE_ROUTE || link->seen[i].hops == route->hops)) {
            return true;
        }
    }
    return false;
}

static void remember(struct mh_link *link, const struct mh_message *message)
{
    const mh_route_t *route = &message->header.route;
    link->seen[link->seen_next].origin = (mh_node_id)route->origin;
    link->seen[link->seen_next].sequence = route->sequence;
    link->seen[link->seen_next].hops = route->hops;
    link->seen_next = (uint8_t)((link->seen_next + 1) % MH_LINK_SEEN_MAX);
    if (link->seen_count < MH_LINK_SEEN_MAX) {
        link->seen_count++;
    }
}

enum mh_status mh_link_arrive(struct mh_link *link, const struct mh_message *message)
{
    struct mh_message any_hops = *message;
    any_hops.envelope = MH_ENVELOPE_ROUTE;
    if (was_seen(link, &any_hops)) {
        count(&link->lost[MH_LINK_DUPLICATE]);
        return MH_ERR_REPEATED;
    }
    remember(link, message);
    return MH_OK;
}

enum mh_status mh_link_take(struct mh_link *link, const struct mh_message *message)
{
    if (was_seen(link, message)) {
        count(&link->lost[MH_LINK_DUPLICATE]);
        return MH_ERR_REPEATED;
    }
    if (link->count == MH_LINK_QUEUE_MAX) {
        count(&link->lost[MH_LINK_QUEUE_FULL]);
        return MH_ERR_CAPACITY;
    }
    remember(link, message);
    struct mh_link_message *last = &link->queue[(link->first + link->count) % MH_LINK_QUEUE_MAX];
    last->message = *message;
    last->attempts = 0;
    link->count++;
    return MH_OK;
}

/* ---- the first of the queue ---- */

const struct mh_message *mh_link_due(struct mh_link *link, mh_tick now)
{
    if (link->count == 0 || link->in_air || (link->waits && mh_tick_before(now, link->retry_time))) {
        return NULL;
    }
    link->waits = false;
    return &link->queue[link->first].message;
}

void mh_link_send(struct mh_link *link, mh_node_id neighbour, const struct mh_message *leaving)
{
    link->in_air = true;
    link->to = neighbour;
    link->node->port->send(link->node->context, neighbour, leaving);
}

void mh_link_finish(struct mh_link *link)
{
    link->first = (uint8_t)((link->first + 1) % MH_LINK_QUEUE_MAX);
    link->count--;
}

void mh_link_drop(struct mh_link *link, enum mh_link_loss reason)
{
    count(&link->lost[reason]);
    mh_link_finish(link);
}

/* The wait doubles from attempt to attempt. Of each, half is the same for all, half depends on who waits for whom and how often. */
static mh_tick backoff(const struct mh_link *link, uint8_t attempts)
{
    const uint8_t doublings = attempts - 1 < DOUBLINGS_MAX ? (uint8_t)(attempts - 1) : DOUBLINGS_MAX;
    const mh_tick longest = link->config->backoff << doublings;
    uint32_t hash = (link->node->id ^ link->retries * UINT32_C(0x9E3779B1)) * UINT32_C(0x85EBCA6B);
    hash ^= hash >> 15;
    return longest - (mh_tick)((uint64_t)hash * (longest / 2 + 1) >> 32);
}

enum mh_link_outcome mh_link_sent(struct mh_link *link, mh_tick now, enum mh_sent outcome)
{
    if (link->ahead > 0 || !link->in_air) {
        link->ahead = (uint8_t)(link->ahead - (link->ahead > 0));
        return MH_LINK_OTHER;
    }
    link->in_air = false;
    link->ahead = link->behind;
    link->behind = 0;
    if (outcome == MH_SENT_OK) {
        mh_link_finish(link);
        return MH_LINK_TAKEN;
    }
    struct mh_link_message *first = &link->queue[link->first];
    first->attempts++;
    if (first->attempts == link->config->attempts) {
        mh_link_drop(link, MH_LINK_NOT_ACKNOWLEDGED);
    } else {
        count(&link->retries);
        link->waits = true;
        link->retry_time = now + backoff(link, first->attempts);
    }
    return outcome == MH_SENT_NO_ACK ? MH_LINK_LOST : MH_LINK_BUSY;
}

bool mh_link_alarm(const struct mh_link *link, mh_tick *time)
{
    if (link->waits) {
        *time = link->retry_time;
    }
    return link->waits;
}
