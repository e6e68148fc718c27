/* The way to a neighbour: a bounded queue, one message in the air at a time, acknowledged by the neighbour's radio, sent again after a
 * while if it was not, taken once by whoever hears it twice.
 *
 * The link does not know where a message is to go: its owner asks for the message that is due, finds the next hop, and sends it.
 *
 *     while ((message = mh_link_due(link, now)) != NULL) {
 *         if (there is a next hop) mh_link_send(link, neighbour, envelope, header); else mh_link_drop(link, reason);
 *     }
 *
 * and does so again whenever mh_link_sent() or the time of mh_link_alarm() may have made a message due. So each attempt takes the next hop that
 * is best then. A message whose attempts are used up is dropped and counted: every frame that does not reach the next hop is found
 * in lost[]. Between attempts the wait doubles, and differs between neighbours.
 *
 * All that the node sends goes through here, broadcasts too, since mh_protocol.sent() tells the outcomes in the order of sending. */
#ifndef MOTEHOUND_LINK_H
#define MOTEHOUND_LINK_H

#include "motehound/protocol.h"
#include "motehound/retry.h"

struct mh_link_config {
    uint8_t attempts; /* of a message, 1 to 100, beside those that the radio makes on its own */
    mh_tick backoff; /* before the second attempt, ticks, 1 to 1,000; up to twice as long before the third, and so on */
};

struct mh_link_message {
    struct mh_message message;
    uint8_t attempts; /* made */
};

struct mh_link {
    const struct mh_link_config *config;
    const struct mh_protocol_node *node;
    struct mh_link_message queue[MH_LINK_QUEUE_MAX];
    uint8_t first, count;  /* of the queue, a ring */
    bool in_air;           /* the first message ... */
    mh_tick due_time;      /* ... since this time ... */
    mh_node_id to;         /* ... to this neighbour ... */
    uint8_t ahead, behind; /* ... and so many broadcasts before it and after it whose outcome is not known */
    bool waits;            /* the first message, for retry_time */
    mh_tick retry_time;
    struct {
        mh_node_id origin;
        mh_node_id sender, entry; /* MH_BROADCAST in MH_ENVELOPE_ROUTE */
        int16_t sequence, hops;
    } seen[MH_LINK_SEEN_MAX];
    uint8_t seen_count, seen_next;
    uint16_t retries;         /* saturates, as do all counters here */
    uint16_t lost[MH_LOSSES]; /* messages, by reason */
};

/* What mh_link_sent has found out. */
enum mh_link_outcome {
    MH_LINK_OTHER, /* a broadcast or a direct message is out, or is not */
    MH_LINK_TAKEN, /* neighbour `to` has the message */
    MH_LINK_LOST,  /* neighbour `to` did not acknowledge it */
    MH_LINK_BUSY   /* it did not go out; the neighbour is not to blame */
};

/* nominal configuration: 6 attempts, 20 ticks */
void mh_link_config_default(struct mh_link_config *config);

/* `config` and `node` outlive the link. Errors: MH_ERR_ARGUMENT (a value of the configuration outside its range). */
enum mh_status mh_link_init(struct mh_link *link, const struct mh_link_config *config,
                            const struct mh_protocol_node *node);

/* Send to all in range, at once. */
void mh_link_broadcast(struct mh_link *link, const struct mh_message *message);

/* Say hello to all in range, with the number *hellos, from 0 at the start, and count it. After UINT16_MAX comes 256: neighbours see the low byte go on. */
void mh_link_hello(struct mh_link *link, uint16_t *hellos);

/* Send to one neighbour, at once and once, past the queue: mh_link_sent() then answers MH_LINK_OTHER. */
void mh_link_direct(struct mh_link *link, mh_node_id neighbour, const struct mh_message *message);

/* Take a message in an envelope, one's own or a neighbour's, to send it on. A message sent again bears the hop count it had; one that
 * came back another way bears another. In MH_ENVELOPE_ROUTE each node is passed once, so there the hop count does not matter. A
 * walk around a face may pass a node several times, but never by the same edge in the same direction: one that does goes in a circle that is
 * no face. Errors, each counted: MH_ERR_REPEATED (taken before), MH_ERR_NO_ROUTE (goes in a circle), MH_ERR_CAPACITY. */
enum mh_status mh_link_take(struct mh_link *link, const struct mh_message *message);

/* The same without the queue, at a message's destination. Errors: MH_ERR_REPEATED (counted). */
enum mh_status mh_link_arrive(struct mh_link *link, const struct mh_message *message);

/* The message to be sent now, or NULL: the queue is empty, a message is in the air or waits. Valid until the next call. */
const struct mh_message *mh_link_due(struct mh_link *link, mh_tick now);

/* Send the message that is due to a neighbour, with another header; in the queue it keeps its own, from which the next attempt starts. */
void mh_link_send(struct mh_link *link, mh_node_id neighbour, enum mh_envelope_kind envelope, const mh_face_t *header);

/* Give the message that is due up, and count why. */
void mh_link_drop(struct mh_link *link, enum mh_loss reason);

/* Give the message that is due up because it has arrived. */
void mh_link_finish(struct mh_link *link);

/* The protocol's sent(). */
enum mh_link_outcome mh_link_sent(struct mh_link *link, mh_tick now, enum mh_sent outcome);

/* Add to `counters`. */
void mh_link_count(const struct mh_link *link, struct mh_protocol_counters *counters);

/* When a message that waits becomes due -> *time. Returns false if none waits. */
bool mh_link_alarm(const struct mh_link *link, mh_tick *time);

#endif
