/* What the parts of the protocol `prince` share: prince.c (events, timers, samples, the table), prince_watch.c (who watches, and what it makes of a sample), prince_query.c (queries, answers, fixes),
 * prince_head.c (what a head says and hears), prince_group.c (merges and splits), prince_compete.c and prince_stamp.c (elections). */
#ifndef MOTEHOUND_PRINCE_NODE_H
#define MOTEHOUND_PRINCE_NODE_H

#include "motehound/prince.h"

#define MH_PRINCE_SECOND 1000u
#define MH_PRINCE_ANSWERS 2 /* that a fix takes at least, beside the locator's own energy */

#define MH_PRINCE_SHARE                                                                                                \
    MH_REAL(                                                                                                           \
        0.25f) /* of a target in what a node hears, by where all are expected: with less it is another that is heard */

/* ---- prince.c ---- */

void mh_prince_set(struct mh_prince_row *row, enum mh_prince_timer timer, mh_tick time);
void mh_prince_clear(struct mh_prince_row *row, enum mh_prince_timer timer);
bool mh_prince_is_set(const struct mh_prince_row *row, enum mh_prince_timer timer);

/* Have `act` in mind for `wait` ticks from now; in place of what it had. */
void mh_prince_plan(struct mh_prince *p, struct mh_prince_row *row, enum mh_prince_act act, mh_tick wait);

/* Nothing is in mind any more, and nothing to be answered. */
void mh_prince_calm(struct mh_prince_row *row);

/* Uniform in 0 .. limit - 1; limit to 65,535. */
mh_tick mh_prince_wait(struct mh_prince *p, mh_tick limit);

/* By how much generation a is ahead of b; negative: behind. */
int16_t mh_prince_ahead(uint16_t a, uint16_t b);

/* `time` is of about now: at most 30 s old, and at most 1 s ahead. Counts what is not. */
bool mh_prince_is_fresh(struct mh_prince *p, mh_tick time);

/* (a_time, a_id) is before (b_time, b_id). */
bool mh_prince_is_first(mh_tick a_time, mh_node_id a_id, mh_tick b_time, mh_node_id b_id);

/* To all in range. */
void mh_prince_send(struct mh_prince *p, const struct mh_message *message);

/* The row of a target, or NULL. */
struct mh_prince_row *mh_prince_find(struct mh_prince *p, uint32_t target);

/* The same, or a new one, asleep, for a target that is out of range at `out`, and that is to be watched or not; another row may give way. NULL if none can. */
struct mh_prince_row *mh_prince_find_or_make(struct mh_prince *p, uint32_t target, bool watched, mh_tick out);

/* The row of a target without a fix, named or not; where new targets are looked for, one that is not yet named. NULL if there is none, and no room. */
struct mh_prince_row *mh_prince_find_new(struct mh_prince *p);

/* Forget a target. */
void mh_prince_drop(struct mh_prince *p, struct mh_prince_row *row);

/* The place of a row in the table. */
uint8_t mh_prince_number(const struct mh_prince *p, const struct mh_prince_row *row);

/* Sample now, for `wants` (MH_PRINCE_WANTS_*) of the row; what is sensed comes to mh_prince_sampled, perhaps during the call. */
void mh_prince_sample(struct mh_prince *p, struct mh_prince_row *row, uint8_t wants);

/* ---- prince_watch.c ---- */

/* How the target moves, m/s. */
static inline struct mh_vec2 mh_prince_velocity(const struct mh_prince_row *row)
{
    const struct mh_vec2 velocity = {mh_real_from_ratio(row->vx_cmps, 100), mh_real_from_ratio(row->vy_cmps, 100)};
    return velocity;
}

/* How fast the target goes, m/s; 0: unknown. */
mh_real mh_prince_speed(const struct mh_prince_row *row);

/* Where the target is expected now, relative to `origin`, m. */
struct mh_vec2 mh_prince_expected(const struct mh_prince *p, const struct mh_prince_row *row,
                                  const struct mh_place *origin);

/* How far off it may be, m: more the longer ago it was found, since it may have turned. */
mh_real mh_prince_drift(const struct mh_prince *p, const struct mh_prince_row *row);

/* What the row's target adds to the energy p->value, as predicted; *share of it (1: all) and the number of other targets that have one -> *others, both may be NULL. */
mh_real mh_prince_energy(const struct mh_prince *p, const struct mh_prince_row *row, mh_real *share, uint8_t *others);

/* The target is heard here: its energy, so far as the other rows leave it, is enough, and it may be within range about now. */
bool mh_prince_hears(const struct mh_prince *p, const struct mh_prince_row *row);

/* From here on the row's node is a competitor, at least for `ticks` from now. */
void mh_prince_become_competitor(struct mh_prince *p, struct mh_prince_row *row, mh_tick ticks);

/* Stand to the target as its fix, and who is prince, say, and until when; the new head stands at `head`, m relative to the fix, and who competes may not before `arms`. */
void mh_prince_classify(struct mh_prince *p, struct mh_prince_row *row, struct mh_vec2 head, mh_tick arms);

/* p->value is more than all targets that are known explain. */
bool mh_prince_is_new(const struct mh_prince *p);

/* Node at `place` hears something of this energy that it knows no target for: whom this head follows is said again, if that may be it. */
void mh_prince_recognise(struct mh_prince *p, const struct mh_place *place, mh_q20 value);

/* What is heard at `place` may be a target that has a fix. */
bool mh_prince_is_known(const struct mh_prince *p, const struct mh_place *place);

/* A tick: the sample is p->value. */
void mh_prince_watch(struct mh_prince *p);

/* Stop watching. */
void mh_prince_quiet(struct mh_prince *p, struct mh_prince_row *row);

/* ---- prince_query.c ---- */

/* Localise the target: sample, and if it is heard, ask (locate_t). */
void mh_prince_ask(struct mh_prince *p, struct mh_prince_row *row, enum mh_locate kind);

/* How long answers about the target are waited for. */
mh_tick mh_prince_window(const struct mh_prince *p, const struct mh_prince_row *row);

/* A target that has none yet gets its identifier. */
void mh_prince_name(struct mh_prince *p, struct mh_prince_row *row);

/* The samples that these wanted are there: p->value, of p->sampled. */
void mh_prince_take_own(struct mh_prince *p, struct mh_prince_row *row);
void mh_prince_query(struct mh_prince *p, struct mh_prince_row *row);
void mh_prince_prepare_reply(struct mh_prince *p, struct mh_prince_row *row);

void mh_prince_hear_locate(struct mh_prince *p, const mh_locate_t *locate);
void mh_prince_hear_sound(struct mh_prince *p, const mh_sound_t *sound);
void mh_prince_reply(struct mh_prince *p, struct mh_prince_row *row);

/* Keep an answer of node `id` for the row, unless there is one of it; where there is no room the weakest of the row gives way. */
void mh_prince_collect(struct mh_prince *p, const struct mh_prince_row *row, mh_node_id id,
                       const struct mh_place *place, mh_q20 value);

/* Forget the row's answers. */
void mh_prince_discard(struct mh_prince *p, const struct mh_prince_row *row);

/* The row has the whole saved track. */
bool mh_prince_has_track(const struct mh_prince_row *row);

/* How many answers of others there are. */
uint8_t mh_prince_collected(const struct mh_prince *p, const struct mh_prince_row *row);

/* Localise with the answers that there are, of time row->localised. Returns true if this node is head now; else the row is as it was. The answers are discarded. */
bool mh_prince_localise(struct mh_prince *p, struct mh_prince_row *row);

/* The query's time is over: localise, try again, or say that it failed. */
void mh_prince_close(struct mh_prince *p, struct mh_prince_row *row);

/* ---- prince_head.c ---- */

/* `estimate`, and the track as saved in row->bytes, begin the next generation, with this node as head. */
void mh_prince_lead(struct mh_prince *p, struct mh_prince_row *row, const struct mh_estimate *estimate);

/* Be head of the row's target, which the estimate is of: say so, and name the next. */
void mh_prince_go_ahead(struct mh_prince *p, struct mh_prince_row *row, const struct mh_estimate *estimate);

/* Say what the row knows of the target, as its head. */
void mh_prince_announce(struct mh_prince *p, struct mh_prince_row *row);

/* Somebody has an older generation in mind: if this node has led since, it says so again, but not all the time. */
void mh_prince_remind(struct mh_prince *p, struct mh_prince_row *row);

/* The target is not where it should have been: say so, and compete. */
void mh_prince_say_fail(struct mh_prince *p, struct mh_prince_row *row);

/* Nobody has taken over. */
void mh_prince_bark(struct mh_prince *p, struct mh_prince_row *row);

/* A wake window is open. */
void mh_prince_say_again(struct mh_prince *p, struct mh_prince_row *row);

void mh_prince_hear_awake(struct mh_prince *p, const mh_awake_t *awake);
void mh_prince_hear_rest(struct mh_prince *p, const mh_rest_t *rest);
void mh_prince_hear_fail(struct mh_prince *p, const mh_fail_t *fail);
void mh_prince_hear_succeed(struct mh_prince *p, const mh_succeed_t *succeed);

/* ---- prince_group.c ---- */

/* A new head's estimate -> this node goes ahead (mh_prince_go_ahead) with the row, and where the estimate says so, with the group that its target and another become, or with each part of a group
 * that is one no more. */
void mh_prince_regroup(struct mh_prince *p, struct mh_prince_row *row, const struct mh_estimate *estimate);

/* A new target was found where one that is known may be: it is that, whose head says so. Returns false if there is no such. */
bool mh_prince_claims(struct mh_prince *p, const mh_awake_t *awake);

void mh_prince_hear_merge(struct mh_prince *p, const mh_merge_t *merge);

/* ---- prince_compete.c ---- */

/* A competitor hears the target, and has nothing in mind (mh_prince_watch): the election begins for it. row->target may be 0, of generation 0. With MH_PRINCE_TIMESTAMP all of these go to
 * prince_stamp.c. */
void mh_prince_contend(struct mh_prince *p, struct mh_prince_row *row);

/* The time of MH_PRINCE_ACT_CONTEND has come; of DECIDE, who wins asks (mh_prince_ask, MH_LOCATE_COMPETITION), others hold back (row->hold). */
void mh_prince_say_compete(struct mh_prince *p, struct mh_prince_row *row);
void mh_prince_decide(struct mh_prince *p, struct mh_prince_row *row);

void mh_prince_hear_compete(struct mh_prince *p, const mh_compete_t *compete);

/* What elections have in common. A back-off, with row->value, before MH_PRINCE_ACT_CONTEND; */
void mh_prince_enter(struct mh_prince *p, struct mh_prince_row *row);

/* MH_PRINCE_ACT_DECIDE, when all have spoken who began about when this node `began`; */
void mh_prince_plan_decision(struct mh_prince *p, struct mh_prince_row *row, mh_tick began);

/* who has lost keeps silent for a while; */
void mh_prince_hold_back(struct mh_prince *p, struct mh_prince_row *row);

/* another contends to begin `generation`, since `time`: counted -> the row if this node contends for it too, else NULL. */
struct mh_prince_row *mh_prince_contest(struct mh_prince *p, uint32_t target, uint16_t generation, mh_tick time);

/* ---- prince_stamp.c: who detects the target first leads, and the fix is of what the others said of their detections ---- */

void mh_prince_detect(struct mh_prince *p, struct mh_prince_row *row);
void mh_prince_say_detection(struct mh_prince *p, struct mh_prince_row *row);
void mh_prince_decide_first(struct mh_prince *p, struct mh_prince_row *row);
void mh_prince_hear_detection(struct mh_prince *p, const mh_detection_t *detection);
void mh_prince_hear_suppress(struct mh_prince *p, const mh_suppress_t *suppress);

/* The old head, a while after its successor's succeed_t (MH_PRINCE_ACT_RELEASE). */
void mh_prince_release(struct mh_prince *p, struct mh_prince_row *row);

#endif
