/* What the parts of the protocol `fixed` share: fixed.c (events, timers, frames), fixed_member.c (who leads, what heads say and hear), fixed_sink.c. */
#ifndef MOTEHOUND_FIXED_NODE_H
#define MOTEHOUND_FIXED_NODE_H

#include "motehound/fixed.h"

#define MH_FIXED_NOBODY UINT8_MAX

/* ---- fixed.c ---- */

void mh_fixed_set(struct mh_fixed *f, enum mh_fixed_timer timer, mh_tick time);
void mh_fixed_clear(struct mh_fixed *f, enum mh_fixed_timer timer);

/* The number of member `id` in a cluster, or MH_FIXED_NOBODY. */
uint8_t mh_fixed_member_of(const struct mh_fixed_cluster *cluster, mh_node_id id);

/* Put a message, of this node, on its way. Errors: those of mh_link_take. */
enum mh_status mh_fixed_send(struct mh_fixed *f, struct mh_message *message, mh_node_id destination,
                             const struct mh_place *place);

/* The same with bytes of `cluster` at `time`, in parts. */
void mh_fixed_send_bytes(struct mh_fixed *f, uint8_t cluster, mh_tick time, const uint8_t *bytes, size_t length,
                         mh_node_id destination, const struct mh_place *place);

/* ---- fixed_member.c ---- */

/* The member that leads as far as this member knows. */
const struct mh_fixed_member *mh_fixed_head(const struct mh_fixed *f);

void mh_fixed_begin_member(struct mh_fixed *f);
void mh_fixed_say(struct mh_fixed *f);
void mh_fixed_watch(struct mh_fixed *f);
void mh_fixed_hear_lead(struct mh_fixed *f, const mh_lead_t *said);

/* A neighbour's radio has acknowledged a sample: if it is the head's, that is alive. */
void mh_fixed_report_taken(struct mh_fixed *f, mh_node_id by);
void mh_fixed_hear_report(struct mh_fixed *f, const mh_report_t *report);
void mh_fixed_hear_taken(struct mh_fixed *f, const mh_taken_t *taken);
void mh_fixed_hear_feedback(struct mh_fixed *f, mh_node_id from, const mh_hand_over_t *part);
void mh_fixed_closed(struct mh_fixed *f, mh_tick instant);
void mh_fixed_tell(struct mh_fixed *f);

/* ---- fixed_sink.c ---- */

void mh_fixed_begin_sink(struct mh_fixed *f);
void mh_fixed_fuse(struct mh_fixed *f);
void mh_fixed_hear_summary(struct mh_fixed *f, mh_node_id from, const mh_hand_over_t *part);

#endif
