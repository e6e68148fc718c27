#include "cluster_node.h"

#include "motehound/spread.h"

#include <string.h>

#define SAMPLE_TIME 15     /* ticks in which a sample that was asked for comes, if one does */
#define ANSWER_TIME 12     /* ticks that an answer takes, acknowledged */
#define ANSWER_TRIES 2     /* beside what the radio does on its own */
#define JOIN_SLOT 4        /* ticks between the members' answers to a form_t */
#define ALERT_WINDOWS 5    /* over which those who have found the target spread */
#define FINDS_ENOUGH 3     /* samples of a target far off, after which it needs no other */
#define SILENT_INSTANTS 2  /* after which a head counts as dead */
#define FORGOTTEN 86400000 /* ticks: a day */

static mh_tick interval_of(const struct mh_cluster_node *c) { return c->config->election.interval; }

/* Somebody has followed the target of c->of within so many instants. */
static bool heard_within(const struct mh_cluster_node *c, mh_tick time, uint8_t instants)
{
    return c->knows && mh_ticks_between(c->of.heard, time) < (int32_t)(instants * interval_of(c) + interval_of(c) / 2);
}

static bool same(const struct mh_cluster_of *a, const struct mh_cluster_of *b)
{
    return a->track == b->track && a->generation == b->generation && a->head == b->head;
}

/* ---- clusters heard of ---- */

/* A cluster is heard of. Returns false if it is not to be listened to, since a better one is there. */
static bool hear_of(struct mh_cluster_node *c, const struct mh_cluster_of *other)
{
    const int32_t ahead = mh_ticks_between(c->time, other->heard), limit = (int32_t)interval_of(c);
    if (ahead > limit || ahead < -limit) {
        return false;
    }
    if (c->role == MH_CLUSTER_HEAD) {
        if (mh_cluster_contest(c, other)) {
            return false;
        }
    } else if (heard_within(c, c->time, SILENT_INSTANTS) && mh_cluster_outranks(&c->of, other) &&
               c->of.track == other->track) {
        return false;
    }
    if (c->role == MH_CLUSTER_MEMBER && !same(&c->of, other)) {
        c->role = MH_CLUSTER_SLEEPER;
    }
    c->of = *other;
    c->knows = true;
    c->search_until = c->time;
    c->finds = 0;
    mh_cluster_clear(c, MH_CLUSTER_TAKE_OVER);
    if (!c->alert.lost) {
        mh_cluster_clear(c, MH_CLUSTER_ALERT);
    }
    return true;
}

/* What was known of where the target of that track is. */
static void fill_place(const struct mh_cluster_node *c, struct mh_cluster_of *of)
{
    if (c->knows && c->of.track == of->track) {
        of->time = c->of.time;
        of->x_mm = c->of.x_mm;
        of->y_mm = c->of.y_mm;
        of->vx_mmps = c->of.vx_mmps;
        of->vy_mmps = c->of.vy_mmps;
    } else {
        of->time = of->heard;
        of->x_mm = c->node->place.x_mm;
        of->y_mm = c->node->place.y_mm;
    }
}

static void join(struct mh_cluster_node *c, const mh_form_t *form, uint8_t rank)
{
    const bool wanted = c->config->election.rule == MH_ELECTION_SAC || c->config->election.rule == MH_ELECTION_RHO;
    c->role = MH_CLUSTER_MEMBER;
    c->rank = rank;
    memset(&c->cluster, 0, sizeof c->cluster);
    c->cluster.head.id = (mh_node_id)form->sender;
    for (uint8_t i = 0; i < form->count && c->cluster.count < MH_CLUSTER_MAX; i++) {
        struct mh_member *member = &c->cluster.members[c->cluster.count++];
        member->id = (mh_node_id)form->members[i];
        if (i == rank) {
            member->place = c->node->place;
        }
    }
    if (wanted) {
        c->joins = true;
        mh_cluster_set(c, MH_CLUSTER_ANSWER, c->time + 2 + (mh_tick)rank * JOIN_SLOT);
    }
}

void mh_cluster_hear_form(struct mh_cluster_node *c, const mh_form_t *form)
{
    struct mh_cluster_of of = {.track = (mh_node_id)form->track,
                               .head = (mh_node_id)form->sender,
                               .generation = form->generation,
                               .heard = (mh_tick)form->time_ms - interval_of(c)};
    const bool is_new = !c->knows || c->role != MH_CLUSTER_MEMBER;
    fill_place(c, &of);
    const bool again = !is_new && same(&c->of, &of);
    if (!hear_of(c, &of) || again) {
        return;
    }
    c->role = MH_CLUSTER_SLEEPER;
    for (uint8_t i = 0; i < form->count; i++) {
        if ((mh_node_id)form->members[i] == c->node->id) {
            join(c, form, i);
        }
    }
    mh_cluster_plan(c);
}

/* ---- asked ---- */

/* The sample is to be answered when it comes: members one after the other, others spread, in the part of the window that is left. */
static mh_tick answer_time(const struct mh_cluster_node *c)
{
    const mh_tick first = c->asked_for + c->config->window / 9 * 5, last = c->asked_for + c->config->window;
    const mh_tick end = (mh_tick_before(c->time, first) ? first : last) - ANSWER_TIME;
    const int32_t left = mh_ticks_between(c->time, end);
    const uint32_t room = left > 1 ? (uint32_t)left : 1;
    const bool in_turn = c->role == MH_CLUSTER_MEMBER && c->cluster.count > 0;
    return c->time + (in_turn ? c->rank * room / c->cluster.count : mh_spread(c->node->id, c->asked_for, room));
}

void mh_cluster_hear_ask(struct mh_cluster_node *c, const mh_ask_t *ask)
{
    const struct mh_cluster_of of = {.track = (mh_node_id)ask->track,
                                     .head = (mh_node_id)ask->sender,
                                     .generation = ask->generation,
                                     .heard = (mh_tick)ask->time_ms,
                                     .time = (mh_tick)ask->time_ms,
                                     .x_mm = ask->x_mm,
                                     .y_mm = ask->y_mm,
                                     .vx_mmps = ask->vx_mmps,
                                     .vy_mmps = ask->vy_mmps};
    const struct mh_place expected = {ask->x_mm, ask->y_mm, 0};
    if (!hear_of(c, &of)) {
        return;
    }
    const bool of_cluster = c->role == MH_CLUSTER_MEMBER && mh_election_asks(&c->config->election, &c->cluster,
                                                                             c->node->id, &c->node->place, &expected);
    const bool known = c->asked && c->asked_for == of.heard && c->asked_by == of.head;
    if (!ask->everyone && !of_cluster) {
        mh_cluster_quiet(c);
        return;
    }
    if (known) { /* the sample was not worth an answer, or the answer is on its way */
        return;
    }
    c->counters.asked++;
    c->asked = true;
    c->asked_for = of.heard;
    c->asked_by = of.head;
    c->answered = c->answers = false;
    c->answer_tries = 0;
    mh_cluster_listen(c, c->time + SAMPLE_TIME);
    c->due[MH_CLUSTER_QUIET] = mh_cluster_is_set(c, MH_CLUSTER_QUIET) && c->time - c->began >= MH_CLUSTER_START
                                   ? c->time + SAMPLE_TIME
                                   : c->due[MH_CLUSTER_QUIET];
    c->node->port->sense(c->node->context, c->now, c->asked_for);
}

void mh_cluster_answer(struct mh_cluster_node *c)
{
    struct mh_message message = {.kind = MH_MESSAGE_ANSWER};
    if (c->role == MH_CLUSTER_HEAD) {
        return;
    }
    if (c->answers) {
        c->answers = false;
        mh_answer_from_measurement(&c->measured, &message.as.answer);
        mh_link_direct(&c->link, c->asked_by, &message);
        c->answer_ahead = (uint8_t)(c->link.ahead + c->link.behind);
        mh_cluster_listen(c, c->time + ANSWER_TIME);
    } else if (c->joins) {
        message.kind = MH_MESSAGE_JOIN;
        message.as.join.sender = (int32_t)c->node->id;
        message.as.join.track = (int32_t)c->of.track;
        message.as.join.generation = c->of.generation;
        mh_link_direct(&c->link, c->cluster.head.id, &message);
    }
    c->joins = false;
}

void mh_cluster_answer_sent(struct mh_cluster_node *c, enum mh_sent outcome)
{
    if (c->answer_ahead == 0) {
        return;
    }
    c->answer_ahead--;
    if (c->answer_ahead > 0 || c->role == MH_CLUSTER_HEAD) {
        return;
    }
    c->answer_tries++;
    c->answered = outcome == MH_SENT_OK;
    if (!c->answered && c->answer_tries < ANSWER_TRIES &&
        mh_tick_before(c->time + ANSWER_TIME, c->asked_for + c->config->window)) {
        c->answers = true;
        mh_cluster_set(c, MH_CLUSTER_ANSWER, c->time + 2 + mh_spread(c->node->id, c->time, ANSWER_TIME));
        mh_cluster_listen(c, c->time + 2 * ANSWER_TIME);
    } else {
        mh_cluster_quiet(c);
    }
}

/* ---- on one's own ---- */

/* Of several who have found the target the nearest speaks first: one of a few windows, and in that sooner or later. */
static mh_tick alert_time(const struct mh_cluster_node *c, mh_q20 range)
{
    const mh_real reach =
        mh_clamp(mh_div(mh_q20_to_real(range), c->config->election.sensing_range_m), 0, MH_REAL(1.0f)) * ALERT_WINDOWS;
    const uint8_t windows =
        reach < mh_real_from_int(ALERT_WINDOWS) ? (uint8_t)mh_real_times(reach, 1) : ALERT_WINDOWS - 1;
    const mh_tick half = c->config->wake_length / 2;
    return mh_rendezvous_after(&c->rendezvous, c->time, windows) +
           (mh_tick)mh_real_times(reach - mh_real_from_int(windows), (int32_t)half);
}

/* The target was found by a node that nobody has asked. It counts as a generation behind the cluster that it has heard of until it has formed its
 * own, so that a head whose asking it has only missed goes on. */
static void found(struct mh_cluster_node *c, const struct mh_measurement *measurement)
{
    const bool goes_on = heard_within(c, measurement->time, MH_CLUSTER_SEARCH);
    const mh_alert_t alert = {.sender = (int32_t)c->node->id,
                              .track = (int32_t)(goes_on ? c->of.track : c->node->id),
                              .generation = goes_on ? (int32_t)((uint32_t)c->of.generation - 1) : 0,
                              .time_ms = (int32_t)measurement->time,
                              .x_mm = c->node->place.x_mm,
                              .y_mm = c->node->place.y_mm,
                              .value_q20 = measurement->value};
    c->alert = alert;
    mh_cluster_set(c, MH_CLUSTER_ALERT, alert_time(c, measurement->value));
}

/* A head within reach of the target is within reach of the radio. */
static bool is_near(const struct mh_cluster_node *c, const struct mh_measurement *measurement)
{
    const struct mh_election_config *election = &c->config->election;
    return mh_q20_to_real(measurement->value) + election->sensing_range_m <=
           mh_mul(MH_REAL(0.9f), election->radio_range_m);
}

/* Who measures the target from far may only be too far from its head: he waits and sees whether others find it. */
static void sampled_unasked(struct mh_cluster_node *c, const struct mh_measurement *measurement)
{
    if (!c->node->is_head || mh_cluster_is_set(c, MH_CLUSTER_ALERT) || mh_cluster_is_set(c, MH_CLUSTER_TAKE_OVER)) {
        return;
    }
    if (c->role == MH_CLUSTER_MEMBER && !heard_within(c, c->time, SILENT_INSTANTS - 1)) {
        mh_cluster_set(c, MH_CLUSTER_TAKE_OVER, mh_cluster_window(c, c->rank));
    } else if (!heard_within(c, measurement->time, SILENT_INSTANTS)) {
        c->finds++;
        if (c->finds >= FINDS_ENOUGH || is_near(c, measurement)) {
            found(c, measurement);
        }
    }
}

void mh_cluster_sampled(struct mh_cluster_node *c, const struct mh_measurement *measurement)
{
    const int32_t off = c->asked ? mh_ticks_between(c->asked_for, measurement->time) : INT32_MAX;
    const int32_t limit = (int32_t)(interval_of(c) / 4);
    if (off < -limit || off > limit) {
        sampled_unasked(c, measurement);
        return;
    }
    c->counters.answered++;
    c->measured = *measurement;
    c->answers = true;
    const mh_tick time = answer_time(c);
    mh_cluster_set(c, MH_CLUSTER_ANSWER, time);
    mh_cluster_listen(c, time + ANSWER_TIME);
}

static bool is_forgotten(const struct mh_cluster_node *c, mh_tick time)
{
    return mh_ticks_between(time, c->time) > FORGOTTEN;
}

static mh_tick not_past(const struct mh_cluster_node *c, mh_tick time)
{
    return mh_tick_before(c->time, time) ? time : c->time;
}

/* What is long past is not to come back when the ticks wrap. */
static void forget(struct mh_cluster_node *c)
{
    c->knows = c->knows && !is_forgotten(c, c->of.heard);
    c->asked = c->asked && !is_forgotten(c, c->asked_for);
    c->followed.known = c->followed.known && !is_forgotten(c, c->followed.time);
    c->search_until = not_past(c, c->search_until);
    mh_shunned_age(&c->shunned, c->time);
}

void mh_cluster_watch(struct mh_cluster_node *c)
{
    forget(c);
    const mh_tick instant = c->instant;
    const uint8_t role = c->role;
    if (role == MH_CLUSTER_HEAD) {
        mh_cluster_ask(c);
    } else if (role == MH_CLUSTER_SINK) {
        mh_cluster_tell(c);
    } else if (role == MH_CLUSTER_MEMBER) {
        mh_cluster_listen(c, instant + c->config->window);
    }
    mh_cluster_plan(c);
    if (role == MH_CLUSTER_SLEEPER && !heard_within(c, instant, SILENT_INSTANTS)) {
        c->node->port->sense(c->node->context, c->now, instant);
    }
}

void mh_cluster_alert(struct mh_cluster_node *c)
{
    const struct mh_message message = {.kind = MH_MESSAGE_ALERT, .as.alert = c->alert};
    mh_link_broadcast(&c->link, &message);
    if (c->alert.lost) {
        return;
    }
    struct mh_cluster_of of = {
        .track = (mh_node_id)c->alert.track, .generation = c->alert.generation, .heard = (mh_tick)c->alert.time_ms};
    const bool goes_on = of.track != c->node->id;
    of.time = of.heard;
    of.x_mm = c->node->place.x_mm;
    of.y_mm = c->node->place.y_mm;
    if (mh_cluster_lead(c, &of, NULL, 0)) {
        c->everyone = c->afresh = true;
        c->forms = 0;
        if (goes_on) {
            c->counters.recoveries++;
        } else {
            mh_cluster_note(&c->events.begun);
        }
    }
}

/* The target is lost: look for it, and tell others. */
static void search(struct mh_cluster_node *c, const mh_alert_t *alert)
{
    const bool repeated = c->alert.lost && c->alert.track == alert->track && c->alert.generation == alert->generation &&
                          c->alert.time_ms == alert->time_ms;
    if (repeated || c->role == MH_CLUSTER_HEAD) {
        return;
    }
    c->role = MH_CLUSTER_SLEEPER;
    c->search_until = c->time + MH_CLUSTER_SEARCH * interval_of(c);
    mh_cluster_plan(c);
    if (alert->hops + 1 < MH_CLUSTER_ALERT_HOPS && !mh_cluster_is_set(c, MH_CLUSTER_ALERT)) {
        c->alert = *alert;
        c->alert.sender = (int32_t)c->node->id;
        c->alert.hops++;
        mh_cluster_set(c, MH_CLUSTER_ALERT, mh_cluster_window(c, (uint8_t)mh_spread(c->node->id, c->time, 3)));
    }
}

void mh_cluster_hear_alert(struct mh_cluster_node *c, const mh_alert_t *alert)
{
    struct mh_cluster_of of = {.track = (mh_node_id)alert->track,
                               .head = (mh_node_id)alert->sender,
                               .generation = alert->generation,
                               .heard = (mh_tick)alert->time_ms,
                               .time = (mh_tick)alert->time_ms,
                               .x_mm = alert->x_mm,
                               .y_mm = alert->y_mm};
    if (alert->lost) {
        if (!heard_within(c, c->time, 1) || (c->of.track == of.track && !mh_cluster_outranks(&c->of, &of))) {
            search(c, alert);
        }
        return;
    }
    if (hear_of(c, &of)) {
        mh_cluster_plan(c);
    }
}

/* ---- a silent head ---- */

/* The head has asked at neither of the last instants. Who measures the target all the same, and has not just been left behind, is to take over. */
void mh_cluster_missed(struct mh_cluster_node *c)
{
    c->listening = false;
    if (c->role == MH_CLUSTER_MEMBER && !heard_within(c, c->time, SILENT_INSTANTS - 1)) {
        c->node->port->sense(c->node->context, c->now, c->of.heard + SILENT_INSTANTS * interval_of(c));
    }
}

void mh_cluster_take_over(struct mh_cluster_node *c)
{
    if (c->role != MH_CLUSTER_MEMBER || heard_within(c, c->time, SILENT_INSTANTS - 1)) {
        return;
    }
    const uint8_t known = c->cluster.count;
    struct mh_cluster_of of = c->of;
    of.generation = (int32_t)((uint32_t)of.generation + 1);
    of.heard = c->time;
    if (!mh_cluster_lead(c, &of, NULL, 0)) {
        return;
    }
    mh_cluster_note(&c->events.taken_over);
    for (uint8_t i = 0; i < known; i++) { /* of them those that are neighbours are left */
        const struct mh_neighbour *n = mh_neighbours_find(&c->neighbours, c->cluster.members[i].id);
        if (n) {
            const struct mh_member member = {n->id, {n->x_mm, n->y_mm, 0}, 0, 0};
            c->cluster.members[c->cluster.count++] = member;
        }
    }
    c->everyone = c->afresh = true;
    c->forms = 1;
    mh_cluster_announce(c);
}
