/* What the parts of the protocol `token` share: token.c (events, timers, frames, neighbours), token_head.c, token_keeper.c, token_member.c, token_sink.c. */
#ifndef MOTEHOUND_TOKEN_NODE_H
#define MOTEHOUND_TOKEN_NODE_H

#include "motehound/token.h"

/* ---- token.c ---- */

void mh_token_set(struct mh_token_node *t, enum mh_token_timer timer, mh_tick time);
void mh_token_clear(struct mh_token_node *t, enum mh_token_timer timer);

/* Count an event, as far as the counter goes. */
void mh_token_note(uint16_t *events);

/* Send in an envelope. Returns false if there is no room in the queue. */
bool mh_token_post(struct mh_token_node *t, struct mh_message *message, mh_node_id to, const struct mh_place *place);

/* Tell a neighbour, or whoever is at a place, of a token. */
void mh_token_tell(struct mh_token_node *t, mh_node_id to, const struct mh_place *place, const struct mh_token_of *of);

/* `time` is of about now: at most so many instants old, and not of the future. */
bool mh_token_is_fresh(const struct mh_token_node *t, mh_tick time, uint8_t instants);

/* Of two tokens, a is to go on. */
bool mh_token_outranks(const struct mh_token_of *a, const struct mh_token_of *b);

/* What is known of the token still counts. */
bool mh_token_believes(const struct mh_token_node *t);

/* A token is heard of. Returns false if it is outranked by what is known; else that is what is known now, and a head of another token leads no more. */
bool mh_token_hear_of(struct mh_token_node *t, const struct mh_token_of *other);

/* ---- token_head.c ---- */

/* Lead from the next instant, with a track that was saved, or without. Returns false if this node cannot. */
bool mh_token_lead(struct mh_token_node *t, int32_t generation, const uint8_t *track, size_t length);

/* Lead no more; whoever keeps the token for this head is told of `of`. */
void mh_token_follow(struct mh_token_node *t, const struct mh_token_of *of);

void mh_token_begin(struct mh_token_node *t);
void mh_token_ask(struct mh_token_node *t);
void mh_token_ask_again(struct mh_token_node *t);
void mh_token_hear_answer(struct mh_token_node *t, const mh_answer_t *answer);
void mh_token_report(struct mh_token_node *t);
void mh_token_closed(struct mh_token_node *t, mh_tick instant, const struct mh_estimate *estimate);

/* The token does not go to node `id` for a while. */
void mh_token_shun(struct mh_token_node *t, mh_node_id id);

/* ---- token_keeper.c ---- */

/* Offer this head's token to the best of the neighbours. If there is none the head stays. */
void mh_token_offer(struct mh_token_node *t);

void mh_token_hear_part(struct mh_token_node *t, mh_node_id from, const mh_hand_over_t *part);
bool mh_token_is_offered(const struct mh_token_node *t, const struct mh_message *message);
void mh_token_part_taken(struct mh_token_node *t);
void mh_token_part_refused(struct mh_token_node *t);

/* Nobody was found to take the token in time. */
void mh_token_keep(struct mh_token_node *t);

/* Who has handed the token over hears of one. */
void mh_token_guard(struct mh_token_node *t, const struct mh_token_of *other);

/* ... or hears nothing. */
void mh_token_resume(struct mh_token_node *t);

/* ---- token_member.c ---- */

void mh_token_hear_ask(struct mh_token_node *t, const mh_ask_t *ask);
void mh_token_sampled(struct mh_token_node *t, const struct mh_measurement *measurement);
void mh_token_answer(struct mh_token_node *t);

/* ---- token_sink.c ---- */

void mh_token_hear_leak(struct mh_token_node *t, mh_node_id head, const mh_leak_t *leak);
void mh_token_watch(struct mh_token_node *t);

#endif
