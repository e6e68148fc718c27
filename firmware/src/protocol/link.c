#include "motehound/link.h"

#include <string.h>

static void count(uint16_t *counter)
{
    if (*counter < UINT16_MAX) {
        (*counter)++;
    }
}

void mh_link_config_default(struct mh_link_config *config)
{
    const struct mh_link_config nominal = {.attempts = 6, .backoff = 20};
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

void mh_link_direct(struct mh_link *link, mh_node_id neighbour, const struct mh_message *message)
{
    uint8_t *before_or_after = link->in_air ? &link->behind : &link->ahead;
    (*before_or_after)++;
    link->node->port->send(link->node->context, neighbour, message);
}

void mh_link_broadcast(struct mh_link *link, const struct mh_message *message)
{
    mh_link_direct(link, MH_BROADCAST, message);
}

void mh_link_hello(struct mh_link *link, uint16_t *hellos)
{
    const struct mh_message hello = {.kind = MH_MESSAGE_HELLO,
                                     .as.hello = {.sender = (int32_t)link->node->id,
                                                  .x_mm = link->node->place.x_mm,
                                                  .y_mm = link->node->place.y_mm,
                                                  .sequence = (int16_t)*hellos}};
    mh_link_broadcast(link, &hello);
    *hellos = *hellos < UINT16_MAX ? (uint16_t)(*hellos + 1) : UINT8_MAX + 1;
}

/* ---- what was taken before ---- */

/* MH_OK, MH_ERR_REPEATED or MH_ERR_NO_ROUTE, as in mh_link_take. */
static enum mh_status compare_with_seen(const struct mh_link *link, const struct mh_message *message)
{
    const mh_face_t *header = &message->header;
    const bool walks = message->envelope == MH_ENVELOPE_FACE;
    enum mh_status found = MH_OK;
    for (uint8_t i = 0; i < link->seen_count; i++) {
        if (link->seen[i].origin != (mh_node_id)header->route.origin ||
            link->seen[i].sequence != header->route.sequence) {
            continue;
        }
        if (!walks || link->seen[i].hops == header->route.hops) {
            return MH_ERR_REPEATED;
        }
        if (link->seen[i].sender == (mh_node_id)header->route.sender &&
            link->seen[i].entry == (mh_node_id)header->entry) {
            found = MH_ERR_NO_ROUTE;
        }
    }
    return found;
}

static void remember(struct mh_link *link, const struct mh_message *message)
{
    const mh_face_t *header = &message->header;
    const bool walks = message->envelope == MH_ENVELOPE_FACE;
    link->seen[link->seen_next].origin = (mh_node_id)header->route.origin;
    link->seen[link->seen_next].sender = walks ? (mh_node_id)header->route.sender : MH_BROADCAST;
    link->seen[link->seen_next].entry = walks ? (mh_node_id)header->entry : MH_BROADCAST;
    link->seen[link->seen_next].sequence = header->route.sequence;
    link->seen[link->seen_next].hops = header->route.hops;
    link->seen_next = (uint8_t)((link->seen_next + 1) % MH_LINK_SEEN_MAX);
    if (link->seen_count < MH_LINK_SEEN_MAX) {
        link->seen_count++;
    }
}

enum mh_status mh_link_arrive(struct mh_link *link, const struct mh_message *message)
{
    struct mh_message by_any_way = *message;
    by_any_way.envelope = MH_ENVELOPE_ROUTE;
    const enum mh_status status = compare_with_seen(link, &by_any_way);
    if (status != MH_OK) {
        count(&link->lost[MH_LOSS_DUPLICATE]);
    } else {
        remember(link, &by_any_way);
    }
    return status;
}

enum mh_status mh_link_take(struct mh_link *link, const struct mh_message *message)
{
    const enum mh_status status = compare_with_seen(link, message);
    if (status != MH_OK) {
        count(&link->lost[status == MH_ERR_REPEATED ? MH_LOSS_DUPLICATE : MH_LOSS_LOOP]);
        return status;
    }
    if (link->count == MH_LINK_QUEUE_MAX) {
        count(&link->lost[MH_LOSS_QUEUE_FULL]);
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
    if (link->in_air && mh_ticks_between(link->due_time, now) > MH_RETRY_PATIENCE) {
        link->ahead = link->behind = 0;
        (void)mh_link_sent(link, now, MH_SENT_BUSY);
    }
    if (link->count == 0 || link->in_air || (link->waits && mh_tick_before(now, link->retry_time))) {
        return NULL;
    }
    link->waits = false;
    link->due_time = now;
    return &link->queue[link->first].message;
}

void mh_link_send(struct mh_link *link, mh_node_id neighbour, enum mh_envelope_kind envelope, const mh_face_t *header)
{
    struct mh_message *message = &link->queue[link->first].message;
    const enum mh_envelope_kind came_in = message->envelope;
    const mh_face_t came_with = message->header;
    link->in_air = true;
    link->to = neighbour;
    message->envelope = envelope;
    message->header = *header;
    link->node->port->send(link->node->context, neighbour, message);
    message->envelope = came_in;
    message->header = came_with;
}

void mh_link_finish(struct mh_link *link)
{
    link->first = (uint8_t)((link->first + 1) % MH_LINK_QUEUE_MAX);
    link->count--;
}

void mh_link_drop(struct mh_link *link, enum mh_loss reason)
{
    count(&link->lost[reason]);
    mh_link_finish(link);
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
        mh_link_drop(link, MH_LOSS_NOT_ACKNOWLEDGED);
    } else {
        count(&link->retries);
        link->waits = true;
        link->retry_time = now + mh_retry_wait(link->config->backoff, first->attempts, link->node->id, link->retries);
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

void mh_link_count(const struct mh_link *link, struct mh_protocol_counters *counters)
{
    for (int reason = 0; reason < MH_LOSSES; reason++) {
        counters->lost[reason] += link->lost[reason];
    }
    counters->retries += link->retries;
}
