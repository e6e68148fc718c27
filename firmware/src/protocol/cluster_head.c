#include "cluster_node.h"

#include "motehound/geographic.h"

#include <string.h>

#define MISSES_MAX 2 /* instants without an answer: the first asked members only, the second everyone */

static mh_tick interval_of(const struct mh_cluster_node *c) { return c->config->election.interval; }

static bool rule_is_scm(enum mh_election rule)
{
    return rule == MH_ELECTION_SCM || rule == MH_ELECTION_SCM_NEAR || rule == MH_ELECTION_SCM_SET;
}

static bool rule_wants_joins(enum mh_election rule) { return rule == MH_ELECTION_SAC || rule == MH_ELECTION_RHO; }

static int32_t mm_per_s(mh_real mps)
{
    const mh_real most = MH_REAL_UPTO(1e6f);
    return mh_real_times(mh_clamp(mps, -most, most), 1000);
}

/* ---- who may take the track ---- */

static bool is_among(const struct mh_measurement *measurements, size_t measured, mh_node_id id)
{
    for (size_t i = 0; i < measured; i++) {
        if (measurements[i].node == id) {
            return true;
        }
    }
    return false;
}

/* The neighbours -> candidates[MH_NEIGHBOURS_MAX]. Returns how many. */
static size_t neighbours_of(const struct mh_cluster_node *c, const struct mh_measurement *measurements, size_t measured,
                            struct mh_candidate *candidates)
{
    size_t found = 0;
    for (uint8_t i = 0; i < c->neighbours.count; i++) {
        const struct mh_neighbour *n = &c->neighbours.list[i];
        if (n->id != c->config->sink && mh_neighbour_usable(n) && !mh_is_shunned(&c->shunned, n->id, c->time)) {
            const struct mh_candidate candidate = {
                n->id, {n->x_mm, n->y_mm, 0}, is_among(measurements, measured, n->id)};
            candidates[found++] = candidate;
        }
    }
    return found;
}

/* This node and its neighbours -> candidates[MH_NEIGHBOURS_MAX + 1]. Returns how many. */
static size_t candidates_of(const struct mh_cluster_node *c, const struct mh_measurement *measurements, size_t measured,
                            struct mh_candidate *candidates)
{
    const struct mh_candidate self = {c->node->id, c->node->place, is_among(measurements, measured, c->node->id)};
    candidates[0] = self;
    return 1 + neighbours_of(c, measurements, measured, candidates + 1);
}

/* ---- to lead and to follow ---- */

static struct mh_member self(const struct mh_cluster_node *c)
{
    const struct mh_member member = {c->node->id, c->node->place, 0, 0};
    return member;
}

static void stop_handing(struct mh_cluster_node *c)
{
    c->handing = false;
    mh_cluster_clear(c, MH_CLUSTER_KEEP);
}

bool mh_cluster_lead(struct mh_cluster_node *c, const struct mh_cluster_of *of, const uint8_t *track, size_t length)
{
    const struct mh_protocol_port *port = c->node->port;
    if (port->lead(c->node->context, c->now, track, length) != MH_OK &&
        (length == 0 || port->lead(c->node->context, c->now, NULL, 0) != MH_OK)) {
        return false;
    }
    c->role = MH_CLUSTER_HEAD;
    c->knows = true;
    c->of = *of;
    c->of.head = c->node->id;
    c->cluster.head = self(c);
    c->cluster.count = 0;
    c->asked = c->answers = c->joins = false;
    c->misses = 0;
    c->heard = 0;
    stop_handing(c);
    mh_cluster_clear(c, MH_CLUSTER_ANSWER);
    mh_cluster_clear(c, MH_CLUSTER_ALERT);
    mh_cluster_clear(c, MH_CLUSTER_TAKE_OVER);
    mh_cluster_plan(c);
    return true;
}

void mh_cluster_follow(struct mh_cluster_node *c)
{
    c->node->port->follow(c->node->context);
    c->role = MH_CLUSTER_SLEEPER;
    stop_handing(c);
    mh_cluster_clear(c, MH_CLUSTER_AGAIN);
    mh_cluster_clear(c, MH_CLUSTER_FORM);
    mh_cluster_quiet(c);
    mh_cluster_plan(c);
}

/* The track is here or near here. */
static bool concerns(const struct mh_cluster_node *c, const struct mh_cluster_of *other)
{
    const struct mh_place mine = mh_cluster_expected(&c->of, other->time), theirs = {other->x_mm, other->y_mm, 0};
    return other->track == c->of.track ||
           mh_place_within(&mine, &theirs, (uint32_t)mh_real_times(c->config->election.sensing_range_m, 1000));
}

bool mh_cluster_contest(struct mh_cluster_node *c, const struct mh_cluster_of *other)
{
    if (!concerns(c, other)) {
        return true;
    }
    if (mh_cluster_outranks(other, &c->of) || c->misses > 0) {
        mh_cluster_note(&c->events.yielded);
        mh_cluster_follow(c);
        return false;
    }
    if (!mh_cluster_is_set(c, MH_CLUSTER_FORM)) { /* let it know */
        c->forms = 1;
        mh_cluster_set(c, MH_CLUSTER_FORM, mh_cluster_window(c, 0));
    }
    return true;
}

/* ---- an instant ---- */

/* By the rule sacx all neighbours are asked where hardly more members than the least would be, or were at the last instant: to find out at this one
 * first is too late, since who is not asked sleeps on. */
static bool few_are_asked(const struct mh_cluster_node *c)
{
    const struct mh_election_config *election = &c->config->election;
    const struct mh_place expected = {c->of.x_mm, c->of.y_mm, 0};
    uint8_t covering = 0;
    for (uint8_t i = 0; i < c->cluster.count; i++) {
        covering = (uint8_t)(covering + mh_place_within(&c->cluster.members[i].place, &expected,
                                                        (uint32_t)mh_real_times(election->sensing_range_m, 1000)));
    }
    const uint8_t answers = covering < c->last_answers ? covering : c->last_answers;
    return election->rule == MH_ELECTION_SACX && 2 * answers < 3 * election->least_answers;
}

static void send_ask(struct mh_cluster_node *c)
{
    c->everyone = c->everyone || c->cluster.count == 0 || few_are_asked(c);
    const bool everyone = c->everyone || rule_is_scm(c->config->election.rule);
    const struct mh_message message = {.kind = MH_MESSAGE_ASK,
                                       .as.ask = {.sender = (int32_t)c->node->id,
                                                  .track = (int32_t)c->of.track,
                                                  .generation = c->of.generation,
                                                  .time_ms = (int32_t)c->of.heard,
                                                  .x_mm = c->of.x_mm,
                                                  .y_mm = c->of.y_mm,
                                                  .vx_mmps = c->of.vx_mmps,
                                                  .vy_mmps = c->of.vy_mmps,
                                                  .everyone = (uint8_t)everyone}};
    mh_link_broadcast(&c->link, &message);
}

void mh_cluster_ask(struct mh_cluster_node *c)
{
    const struct mh_place expected = mh_cluster_expected(&c->of, c->instant);
    c->of.heard = c->of.time = c->instant;
    c->of.x_mm = expected.x_mm;
    c->of.y_mm = expected.y_mm;
    c->heard = 0;
    send_ask(c);
    mh_cluster_listen(c, c->instant + c->config->window + 1);
    mh_cluster_set(c, MH_CLUSTER_AGAIN, c->instant + c->config->window / 9 * 5);
    c->counters.asked++;
    c->node->port->sense(c->node->context, c->now, c->instant);
}

/* A member well within reach of where the target is expected has not answered. */
static bool somebody_is_missing(const struct mh_cluster_node *c)
{
    const struct mh_place expected = {c->of.x_mm, c->of.y_mm, 0};
    const uint32_t surely_mm = (uint32_t)mh_real_times(c->config->election.sensing_range_m, 800);
    for (uint8_t i = 0; i < c->cluster.count && i < MH_FORM_MEMBERS; i++) {
        if ((c->heard >> i & 1u) == 0 && mh_place_within(&c->cluster.members[i].place, &expected, surely_mm)) {
            return true;
        }
    }
    return false;
}

void mh_cluster_ask_again(struct mh_cluster_node *c)
{
    if (c->role == MH_CLUSTER_HEAD && somebody_is_missing(c)) {
        send_ask(c);
    }
}

static void mark(struct mh_cluster_node *c, mh_node_id id)
{
    for (uint8_t i = 0; i < c->cluster.count && i < MH_FORM_MEMBERS; i++) {
        if (c->cluster.members[i].id == id) {
            c->heard |= (uint32_t)1 << i;
        }
    }
}

void mh_cluster_hear_answer(struct mh_cluster_node *c, const mh_answer_t *answer)
{
    struct mh_measurement measurement;
    mh_answer_to_measurement(answer, &measurement);
    if (c->role == MH_CLUSTER_HEAD) {
        c->node->port->deliver(c->node->context, c->now, &measurement);
        mark(c, measurement.node);
    }
}

/* ---- the cluster is announced ---- */

static void send_form(struct mh_cluster_node *c)
{
    struct mh_message message = {.kind = MH_MESSAGE_FORM,
                                 .as.form = {.sender = (int32_t)c->node->id,
                                             .track = (int32_t)c->of.track,
                                             .generation = c->of.generation,
                                             .time_ms = (int32_t)c->instant}};
    mh_form_t *form = &message.as.form;
    for (uint8_t i = 0; i < MH_FORM_MEMBERS; i++) {
        form->members[i] = i < c->cluster.count ? (int32_t)c->cluster.members[i].id : -1;
        form->count = (uint8_t)(form->count + (i < c->cluster.count));
    }
    mh_link_broadcast(&c->link, &message);
}

void mh_cluster_announce(struct mh_cluster_node *c)
{
    if (c->role != MH_CLUSTER_HEAD || c->forms == 0) {
        return;
    }
    const uint32_t all = c->cluster.count < MH_FORM_MEMBERS ? ((uint32_t)1 << c->cluster.count) - 1
                                                            : ((uint32_t)1 << MH_FORM_MEMBERS) - 1;
    const bool joined = rule_wants_joins(c->config->election.rule) && all != 0 && (c->heard & all) == all;
    if (joined) {
        return;
    }
    send_form(c);
    c->forms--;
    if (c->forms > 0) {
        mh_cluster_set(c, MH_CLUSTER_FORM, mh_cluster_window(c, 0));
    }
    if (rule_wants_joins(c->config->election.rule)) {
        mh_cluster_listen(c, c->time + 20 + 4u * c->cluster.count);
    }
}

void mh_cluster_hear_join(struct mh_cluster_node *c, const mh_join_t *join)
{
    if (c->role == MH_CLUSTER_HEAD && join->generation == c->of.generation && (mh_node_id)join->track == c->of.track) {
        mark(c, (mh_node_id)join->sender);
    }
}

static void announce_soon(struct mh_cluster_node *c)
{
    c->forms = 2;
    c->heard = 0;
    c->everyone = c->cluster.count == 0;
    c->last_answers = UINT8_MAX;
    c->afresh = false;
    mh_cluster_set(c, MH_CLUSTER_FORM, mh_cluster_window(c, 0));
}

/* ---- the track goes to the next head ---- */

/* Number of members, their identifiers, what the tracker saves -> bytes. By the rule sacx the next head chooses its members itself, which knows
 * its neighbours better. Returns the length; 0 if there is no track to save. */
static size_t pack(const struct mh_cluster_node *c, uint8_t *bytes)
{
    size_t length = 1, saved;
    bytes[0] = 0;
    for (uint8_t i = 0; i < c->next.count && bytes[0] < MH_FORM_MEMBERS; i++) {
        if (c->config->election.rule != MH_ELECTION_SACX) {
            const mh_node_id id = c->next.members[i].id;
            for (uint8_t k = 0; k < 4; k++) {
                bytes[length++] = (uint8_t)(id >> (24 - 8 * k));
            }
            bytes[0]++;
        }
    }
    return c->node->port->save(c->node->context, bytes + length, &saved) == MH_OK ? length + saved : 0;
}

static bool offer(struct mh_cluster_node *c)
{
    uint8_t bytes[MH_CLUSTER_CARRIED_MAX];
    const size_t length = pack(c, bytes);
    const uint8_t parts = (uint8_t)MH_PARCEL_PARTS(length);
    c->next_generation = (int32_t)((uint32_t)c->next_generation + 1);
    for (uint8_t part = 0; part < parts; part++) {
        struct mh_message message = {.kind = MH_MESSAGE_HAND_OVER,
                                     .as.hand_over = {.track = (int32_t)c->of.track,
                                                      .generation = c->next_generation,
                                                      .time_ms = (int32_t)c->of.heard}};
        mh_parcel_cut(bytes, length, part, &message.as.hand_over);
        mh_geographic_address(&message, c->node->id, mh_cluster_number(c), c->next.head.id, &c->next.head.place);
        if (mh_link_take(&c->link, &message) != MH_OK) {
            return false;
        }
    }
    c->parts = parts;
    return parts > 0;
}

/* The cluster goes on as it is, or rather as all that hear its head. */
static void stay(struct mh_cluster_node *c)
{
    stop_handing(c);
    c->of.generation = (int32_t)((uint32_t)c->next_generation + 1);
    announce_soon(c);
    c->everyone = true;
}

static void hand_over(struct mh_cluster_node *c)
{
    c->handing = true;
    c->next_generation = (int32_t)((uint32_t)c->of.generation + c->afresh);
    mh_cluster_set(c, MH_CLUSTER_KEEP, c->of.heard + interval_of(c) / 8 * 7);
    if (!offer(c)) {
        stay(c);
    }
}

void mh_cluster_part_taken(struct mh_cluster_node *c)
{
    c->parts--;
    if (c->parts > 0) {
        return;
    }
    mh_cluster_note(&c->events.handed);
    c->of.head = c->next.head.id;
    c->of.generation = c->next_generation;
    mh_cluster_follow(c);
}

/* The best member of the next cluster that can be its head. */
static bool find_another(struct mh_cluster_node *c)
{
    for (uint8_t i = 0; i < c->next.count; i++) {
        const struct mh_member member = c->next.members[i];
        if (member.id != c->node->id && member.first <= 1 && !mh_is_shunned(&c->shunned, member.id, c->time)) {
            c->next.head = member;
            c->next.count--;
            memmove(&c->next.members[i], &c->next.members[i + 1], (size_t)(c->next.count - i) * sizeof member);
            return true;
        }
    }
    return false;
}

void mh_cluster_part_refused(struct mh_cluster_node *c)
{
    mh_cluster_note(&c->events.refused);
    mh_shun(&c->shunned, c->next.head.id, c->time + MH_CLUSTER_SHUN_TIME);
    if (!find_another(c) || !offer(c)) {
        stay(c);
    }
}

void mh_cluster_keep(struct mh_cluster_node *c)
{
    if (c->handing) {
        stay(c);
    }
}

/* ---- a track comes ---- */

/* Of an estimate what is wanted of it here: whole estimates are large, and what takes in a track goes deep. */
struct motion {
    struct mh_place origin;
    struct mh_vec2 position, velocity;
};

static bool expect(const struct mh_cluster_node *c, mh_tick time, struct motion *expected)
{
    struct mh_estimate estimate;
    if (c->node->port->expect(c->node->context, time, &estimate) != MH_OK) {
        return false;
    }
    expected->origin = estimate.origin;
    expected->position = estimate.position;
    expected->velocity = estimate.velocity;
    return true;
}

static mh_node_id id_at(const uint8_t *bytes)
{
    return (mh_node_id)bytes[0] << 24 | (mh_node_id)bytes[1] << 16 | (mh_node_id)bytes[2] << 8 | bytes[3];
}

static void take_members(struct mh_cluster_node *c, const uint8_t *bytes)
{
    for (uint8_t i = 0; i < bytes[0] && c->cluster.count < MH_CLUSTER_MAX; i++) {
        const struct mh_neighbour *n = mh_neighbours_find(&c->neighbours, id_at(bytes + 1 + 4 * i));
        if (n) {
            const struct mh_member member = {n->id, {n->x_mm, n->y_mm, 0}, 0, 0};
            c->cluster.members[c->cluster.count++] = member;
        }
    }
}

/* By the rule sacx, from the neighbours of this node. */
static void choose_members(struct mh_cluster_node *c, const struct motion *expected)
{
    struct mh_candidate candidates[MH_NEIGHBOURS_MAX];
    const size_t found = neighbours_of(c, NULL, 0, candidates);
    (void)mh_elect_members(&c->config->election, &expected->origin, &expected->position, &expected->velocity,
                           candidates, found, &c->cluster);
}

/* Where the target is, and how it moves -> c->of. Returns false if it is nowhere. */
static bool locate(struct mh_cluster_node *c, mh_tick time, const struct mh_place *origin,
                   const struct mh_vec2 *position, const struct mh_vec2 *velocity)
{
    if (!mh_finite(position->x) || !mh_finite(position->y) || !mh_finite(velocity->x) || !mh_finite(velocity->y)) {
        return false;
    }
    const struct mh_place place = mh_place_from_offset(origin, *position);
    c->of.time = time;
    c->of.x_mm = place.x_mm;
    c->of.y_mm = place.y_mm;
    c->of.vx_mmps = mm_per_s(velocity->x);
    c->of.vy_mmps = mm_per_s(velocity->y);
    return true;
}

static bool lead_on(struct mh_cluster_node *c, const mh_hand_over_t *last)
{
    const uint8_t *bytes = c->incoming.bytes;
    const size_t length = c->incoming.parcel.length, members = 1 + 4 * (size_t)bytes[0];
    struct mh_cluster_of of = c->of;
    if (!c->knows || of.track != c->incoming.parcel.track) {
        of.time = (mh_tick)last->time_ms;
        of.x_mm = c->node->place.x_mm;
        of.y_mm = c->node->place.y_mm;
        of.vx_mmps = of.vy_mmps = 0;
    }
    of.track = c->incoming.parcel.track;
    of.generation = c->incoming.parcel.generation;
    of.heard = (mh_tick)last->time_ms;
    return bytes[0] <= MH_FORM_MEMBERS && members <= length &&
           mh_cluster_lead(c, &of, bytes + members, length - members);
}

static void take_track(struct mh_cluster_node *c, const mh_hand_over_t *last)
{
    if (!lead_on(c, last)) {
        return;
    }
    struct motion expected;
    take_members(c, c->incoming.bytes);
    if (expect(c, (mh_tick)last->time_ms, &expected) &&
        locate(c, (mh_tick)last->time_ms, &expected.origin, &expected.position, &expected.velocity)) {
        choose_members(c, &expected);
    }
    c->counters.formed++;
    announce_soon(c);
}

static bool can_take(const struct mh_cluster_node *c, const mh_hand_over_t *part)
{
    const int32_t age = mh_ticks_between((mh_tick)part->time_ms, c->time), limit = 2 * (int32_t)interval_of(c);
    const struct mh_cluster_of offered = {
        .track = (mh_node_id)part->track, .generation = part->generation, .head = c->node->id};
    return c->node->is_head && c->role != MH_CLUSTER_SINK && age >= 0 && age <= limit &&
           (!c->knows || c->of.track != offered.track || mh_cluster_outranks(&offered, &c->of));
}

void mh_cluster_hear_part(struct mh_cluster_node *c, mh_node_id from, const mh_hand_over_t *part)
{
    if (can_take(c, part) &&
        mh_parcel_join(&c->incoming.parcel, c->incoming.bytes, sizeof c->incoming.bytes, from, part) == MH_OK) {
        take_track(c, part);
    }
}

/* ---- the instant is closed ---- */

static void report(struct mh_cluster_node *c, const struct mh_estimate *estimate)
{
    const struct mh_place place = mh_place_from_offset(&estimate->origin, estimate->stored);
    struct mh_message message = {.kind = MH_MESSAGE_POSITION,
                                 .as.position = {.origin = (int32_t)c->node->id,
                                                 .track = (int32_t)c->of.track,
                                                 .generation = c->of.generation,
                                                 .time_ms = (int32_t)estimate->time,
                                                 .x_mm = place.x_mm,
                                                 .y_mm = place.y_mm,
                                                 .vx_mmps = mm_per_s(estimate->stored_velocity.x),
                                                 .vy_mmps = mm_per_s(estimate->stored_velocity.y)}};
    mh_geographic_address(&message, c->node->id, mh_cluster_number(c), c->config->sink, &c->config->sink_place);
    c->counters.reports++;
    (void)mh_link_take(&c->link, &message); /* counts what it refuses */
}

static void give_up(struct mh_cluster_node *c)
{
    const mh_alert_t lost = {.sender = (int32_t)c->node->id,
                             .track = (int32_t)c->of.track,
                             .generation = c->of.generation,
                             .time_ms = (int32_t)c->of.heard,
                             .x_mm = c->of.x_mm,
                             .y_mm = c->of.y_mm,
                             .lost = 1};
    mh_cluster_note(&c->events.lost);
    c->alert = lost;
    c->search_until = c->time + MH_CLUSTER_SEARCH * interval_of(c);
    mh_cluster_follow(c);
    mh_cluster_set(c, MH_CLUSTER_ALERT, mh_cluster_window(c, 0));
}

/* Nobody has answered. */
static void miss(struct mh_cluster_node *c)
{
    c->misses++;
    if (c->misses > MISSES_MAX) {
        give_up(c);
    } else {
        c->node->port->restart(c->node->context);
        c->everyone = c->afresh = true;
    }
}

static enum mh_status choose_first(struct mh_cluster_node *c, const struct mh_estimate *estimate,
                                   const struct mh_candidate *candidates, size_t found)
{
    const struct mh_place about = mh_place_from_offset(&estimate->origin, estimate->position);
    return mh_elect_first(&c->config->election, &about, candidates, found, &c->next);
}

/* The next cluster, if one is due -> c->next. A function of its own: its candidates are off the stack before anything is sent. */
static enum mh_status choose_next(struct mh_cluster_node *c, const struct mh_estimate *estimate,
                                  const struct mh_measurement *measurements, size_t measured)
{
    struct mh_candidate candidates[MH_NEIGHBOURS_MAX + 1];
    const size_t found = candidates_of(c, measurements, measured, candidates);
    c->next = c->cluster;
    return c->afresh ? choose_first(c, estimate, candidates, found)
                     : mh_elect(&c->config->election, estimate, candidates, found, &c->next);
}

static void elect(struct mh_cluster_node *c, const struct mh_estimate *estimate,
                  const struct mh_measurement *measurements, size_t measured)
{
    if (choose_next(c, estimate, measurements, measured) != MH_OK) {
        return;
    }
    if (c->next.head.id != c->node->id) {
        hand_over(c);
        return;
    }
    c->cluster = c->next;
    c->of.generation = (int32_t)((uint32_t)c->of.generation + 1 + c->afresh);
    c->counters.formed++;
    announce_soon(c);
}

void mh_cluster_closed(struct mh_cluster_node *c, mh_tick instant, const struct mh_estimate *estimate,
                       const struct mh_measurement *measurements, size_t count)
{
    mh_cluster_quiet(c);
    mh_cluster_clear(c, MH_CLUSTER_AGAIN);
    if (count == 0) {
        miss(c);
        return;
    }
    c->misses = 0;
    c->last_answers = (uint8_t)(count < UINT8_MAX ? count : UINT8_MAX);
    c->counters.answered += is_among(measurements, count, c->node->id);
    /* the way ahead is that of what is stored, but by the rule sacx */
    const bool own = c->config->election.rule == MH_ELECTION_SACX;
    if (!estimate || !locate(c, instant, &estimate->origin, own ? &estimate->position : &estimate->stored,
                             own ? &estimate->velocity : &estimate->stored_velocity)) {
        return;
    }
    /* so few answers: the target is not where it was expected, or the position is worth little. First ask around. */
    c->everyone = mh_election_asks_all(&c->config->election, count) && !c->everyone;
    if (!c->everyone) {
        elect(c, estimate, measurements, count);
    }
    if (estimate->flags & MH_ESTIMATE_REFRESHED) {
        report(c, estimate); /* after the track, which is in more of a hurry */
    }
}
