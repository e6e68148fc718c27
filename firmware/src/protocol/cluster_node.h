/* What the parts of the protocol `cluster` share: cluster.c (events, timers, frames), cluster_head.c, cluster_member.c, cluster_sink.c. */
#ifndef MOTEHOUND_CLUSTER_NODE_H
#define MOTEHOUND_CLUSTER_NODE_H

#include "motehound/cluster.h"

/* ---- cluster.c ---- */

void mh_cluster_set(struct mh_cluster_node *c, enum mh_cluster_timer timer, mh_tick time);
void mh_cluster_clear(struct mh_cluster_node *c, enum mh_cluster_timer timer);
bool mh_cluster_is_set(const struct mh_cluster_node *c, enum mh_cluster_timer timer);

/* Count an event, as far as the counter goes. */
void mh_cluster_note(uint16_t *events);

/* Listen until then at least; listen for nothing in particular any more. */
void mh_cluster_listen(struct mh_cluster_node *c, mh_tick until);
void mh_cluster_quiet(struct mh_cluster_node *c);

/* When to send to nodes that may be asleep, `windows` windows from now. */
mh_tick mh_cluster_window(const struct mh_cluster_node *c, uint8_t windows);

/* Find the next instant that matters to a node of this role. */
void mh_cluster_plan(struct mh_cluster_node *c);

/* The number of the next message in an envelope. */
int16_t mh_cluster_number(struct mh_cluster_node *c);

/* Of two heads, a is to go on. */
bool mh_cluster_outranks(const struct mh_cluster_of *a, const struct mh_cluster_of *b);

/* Where the target of a cluster is expected at `time`. */
struct mh_place mh_cluster_expected(const struct mh_cluster_of *of, mh_tick time);

/* ---- cluster_head.c ---- */

/* Lead from the next instant, with a track that was saved or without: of->generation of of->track. Returns false if this node cannot. */
bool mh_cluster_lead(struct mh_cluster_node *c, const struct mh_cluster_of *of, const uint8_t *track, size_t length);

/* Lead no more. */
void mh_cluster_follow(struct mh_cluster_node *c);

void mh_cluster_ask(struct mh_cluster_node *c);
void mh_cluster_ask_again(struct mh_cluster_node *c);
void mh_cluster_announce(struct mh_cluster_node *c);
void mh_cluster_hear_answer(struct mh_cluster_node *c, const mh_answer_t *answer);
void mh_cluster_hear_join(struct mh_cluster_node *c, const mh_join_t *join);
void mh_cluster_hear_part(struct mh_cluster_node *c, mh_node_id from, const mh_hand_over_t *part);
void mh_cluster_closed(struct mh_cluster_node *c, mh_tick instant, const struct mh_estimate *estimate,
                       const struct mh_measurement *measurements, size_t count);

/* The next head has acknowledged a part of the track; or has failed to, for good. */
void mh_cluster_part_taken(struct mh_cluster_node *c);
void mh_cluster_part_refused(struct mh_cluster_node *c);

/* Nobody was found to take the track in time. */
void mh_cluster_keep(struct mh_cluster_node *c);

/* Another head is heard of. Returns true if this one goes on; else it has given way. */
bool mh_cluster_contest(struct mh_cluster_node *c, const struct mh_cluster_of *other);

/* ---- cluster_member.c ---- */

void mh_cluster_hear_ask(struct mh_cluster_node *c, const mh_ask_t *ask);
void mh_cluster_hear_form(struct mh_cluster_node *c, const mh_form_t *form);
void mh_cluster_hear_alert(struct mh_cluster_node *c, const mh_alert_t *alert);
void mh_cluster_answer(struct mh_cluster_node *c);
void mh_cluster_answer_sent(struct mh_cluster_node *c, enum mh_sent outcome);
void mh_cluster_watch(struct mh_cluster_node *c);
void mh_cluster_sampled(struct mh_cluster_node *c, const struct mh_measurement *measurement);
void mh_cluster_alert(struct mh_cluster_node *c);
void mh_cluster_missed(struct mh_cluster_node *c);
void mh_cluster_take_over(struct mh_cluster_node *c);

/* ---- cluster_sink.c ---- */

void mh_cluster_hear_position(struct mh_cluster_node *c, const mh_position_t *position);
void mh_cluster_tell(struct mh_cluster_node *c);

#endif
