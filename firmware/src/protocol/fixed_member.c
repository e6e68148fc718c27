#include "fixed_node.h"

#include "motehound/spread.h"

#include <string.h>

#define BELIEVED 4u                /* patiences that acknowledged samples stand for what the head has not said */
#define TELL_SPREAD 10             /* part of a report interval over which heads tell the sink of their tracks */
#define LONGEST ((int32_t)1 << 30) /* ticks: that anybody says to have led, so that times can be compared */

static const struct mh_fixed_cluster *own(const struct mh_fixed *f) { return &f->config->clusters[f->cluster]; }

const struct mh_fixed_member *mh_fixed_head(const struct mh_fixed *f) { return &own(f)->members[f->head]; }

/* How many members look for a silent head earlier than this one. */
static mh_tick before(const struct mh_fixed *f) { return f->head < f->rank ? f->rank - 1u : f->rank; }

static void wait_for_head(struct mh_fixed *f)
{
    mh_fixed_set(f, MH_FIXED_WATCH, f->time + (f->config->patience + before(f)) * f->config->report_interval);
}

static int32_t silence(const struct mh_fixed *f) { return mh_ticks_between(f->said, f->time); }

/* The head has not said that it leads for so long that another that says so is believed. */
static bool is_silent(const struct mh_fixed *f)
{
    return !f->heard || silence(f) >= (int32_t)((f->config->patience - 1u) * f->config->report_interval);
}

static void follow(struct mh_fixed *f, uint8_t head, const mh_lead_t *said)
{
    f->role = MH_FIXED_MEMBER;
    f->head = head;
    f->since = (mh_tick)said->since_ms;
    f->heard = true;
    f->said = f->time;
    f->track_length = said->length;
    memcpy(f->track, said->data, MH_LEAD_BYTES);
    mh_fixed_clear(f, MH_FIXED_SAY);
    wait_for_head(f);
}

/* With the track that was heard, if the tracker takes it. Returns false if this member cannot, now. */
static bool lead(struct mh_fixed *f)
{
    const struct mh_protocol_port *port = f->node->port;
    const bool goes_on =
        f->track_length > 0 && port->lead(f->node->context, f->now, f->track, f->track_length) == MH_OK;
    if (!goes_on && port->lead(f->node->context, f->now, NULL, 0) != MH_OK) {
        return false;
    }
    f->role = MH_FIXED_HEAD;
    f->head = f->rank;
    f->since = f->time;
    f->incoming[0].parcel.begun = false;
    f->counters.led++;
    mh_fixed_clear(f, MH_FIXED_WATCH);
    mh_fixed_set(f, MH_FIXED_SAY, f->time + mh_spread(f->node->id, f->time, f->config->report_interval / 8));
    return true;
}

void mh_fixed_begin_member(struct mh_fixed *f)
{
    f->role = MH_FIXED_MEMBER;
    f->head = 0;
    f->heard = false;
    f->said = f->time;
    f->track_length = 0;
    if (f->rank > 0 || !lead(f)) {
        wait_for_head(f);
    }
}

void mh_fixed_say(struct mh_fixed *f)
{
    if (mh_ticks_between(f->since, f->time) > LONGEST) {
        f->since = f->time - (mh_tick)LONGEST;
    }
    struct mh_message message = {
        .kind = MH_MESSAGE_LEAD,
        .as.lead = {.sender = (int32_t)f->node->id, .since_ms = (int32_t)f->since, .cluster = f->cluster}};
    uint8_t track[MH_TRACK_BYTES_MAX];
    size_t length;
    if (f->node->port->save(f->node->context, track, &length) == MH_OK && length <= MH_LEAD_BYTES) {
        message.as.lead.length = (uint8_t)length;
        memcpy(message.as.lead.data, track, length);
    }
    mh_link_broadcast(&f->link, &message);
    /* not at the same time after each sample, when others send as well */
    const mh_tick interval = f->config->report_interval;
    mh_fixed_set(f, MH_FIXED_SAY, f->time + interval - mh_spread(f->node->id, f->time, interval / 4));
}

void mh_fixed_watch(struct mh_fixed *f)
{
    if (lead(f)) {
        f->counters.taken_over++;
    } else {
        wait_for_head(f);
    }
}

/* The one that leads since then is to go on rather than the one this node knows. */
static bool outranks(const struct mh_fixed *f, uint8_t member, mh_tick since)
{
    return since != f->since ? mh_tick_before(since, f->since) : member < f->head;
}

void mh_fixed_hear_lead(struct mh_fixed *f, const mh_lead_t *said)
{
    if (said->cluster != f->cluster || (f->role != MH_FIXED_MEMBER && f->role != MH_FIXED_HEAD)) {
        return;
    }
    const uint8_t member = mh_fixed_member_of(own(f), (mh_node_id)said->sender);
    const mh_tick since = (mh_tick)said->since_ms;
    if (member == MH_FIXED_NOBODY || member == f->rank) {
        f->counters.refused++;
    } else if (f->role == MH_FIXED_HEAD) {
        if (outranks(f, member, since)) {
            f->counters.yielded++;
            f->node->port->follow(f->node->context);
            follow(f, member, said);
        }
    } else if (is_silent(f) || member == f->head || outranks(f, member, since)) {
        follow(f, member, said);
    }
}

void mh_fixed_report_taken(struct mh_fixed *f, mh_node_id by)
{
    if (f->role == MH_FIXED_MEMBER && by == mh_fixed_head(f)->id &&
        silence(f) < (int32_t)(BELIEVED * f->config->report_interval * f->config->patience)) {
        wait_for_head(f);
    }
}

void mh_fixed_hear_report(struct mh_fixed *f, const mh_report_t *report)
{
    struct mh_measurement measurement;
    if (f->role == MH_FIXED_RELAY || mh_fixed_member_of(own(f), (mh_node_id)report->origin) == MH_FIXED_NOBODY) {
        f->counters.refused++;
        return;
    }
    /* who takes this node for the head has heard it lead: if it knows of no other it has restarted */
    if (f->role != MH_FIXED_HEAD && (f->heard || !lead(f))) {
        f->counters.misdirected++;
        return;
    }
    mh_report_to_measurement(report, &measurement);
    f->node->port->deliver(f->node->context, f->now, &measurement);
}

void mh_fixed_hear_taken(struct mh_fixed *f, const mh_taken_t *taken)
{
    if (f->role == MH_FIXED_HEAD && taken->cluster == f->cluster) {
        f->config->port->summary_taken(f->node->context, (mh_tick)taken->time_ms);
    }
}

void mh_fixed_hear_feedback(struct mh_fixed *f, mh_node_id from, const mh_hand_over_t *part)
{
    struct mh_fixed_incoming *incoming = &f->incoming[0];
    if (f->role != MH_FIXED_HEAD || part->track != f->cluster) {
        return;
    }
    const enum mh_status status = mh_parcel_join(&incoming->parcel, incoming->bytes, MH_SUMMARY_BYTES_MAX, from, part);
    if (status == MH_OK) {
        const bool corrected = f->config->port->correct(f->node->context, f->cluster, (mh_tick)part->time_ms,
                                                        incoming->bytes, incoming->parcel.length) == MH_OK;
        f->counters.corrected += corrected;
        f->counters.uncorrected += !corrected;
    } else if (status != MH_NONE && status != MH_ERR_REPEATED) {
        f->counters.refused++;
    }
}

void mh_fixed_closed(struct mh_fixed *f, mh_tick instant)
{
    const mh_tick interval = f->config->report_interval;
    if (f->role == MH_FIXED_HEAD && mh_tick_aligned(0, interval, instant) == instant &&
        !mh_tick_before(instant, f->since + interval)) {
        f->told = instant; /* heads close an instant at the same time, but need not all send then */
        mh_fixed_set(f, MH_FIXED_TELL, f->time + mh_spread(f->node->id, instant, interval / TELL_SPREAD));
    }
}

void mh_fixed_tell(struct mh_fixed *f)
{
    uint8_t bytes[MH_SUMMARY_BYTES_MAX];
    size_t length;
    if (f->role == MH_FIXED_HEAD && f->config->port->summarise(f->node->context, f->told, bytes, &length) == MH_OK) {
        f->counters.summaries++;
        mh_fixed_send_bytes(f, f->cluster, f->told, bytes, length, f->config->sink, &f->config->sink_place);
    }
}
