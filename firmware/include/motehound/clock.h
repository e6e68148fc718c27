/* The network's time, which is the time of one mote's clock, the root's, on every mote: flooding with regression over neighbours.
 *
 * The root begins a round of sync messages each period; every mote relays it after a pseudo-random wait, and once more after another. Each
 * message is a moment that its sender and all who hear it stamp with their own clocks, at the end of the frame. The sender's next message
 * tells the network time of that moment (two steps: no radio needs to write a time into a frame that is on its way). So a mote gets pairs
 * of local and network time, and draws a straight line through the last of them, by least squares: offset and skew (Maroti et al., "The
 * flooding time synchronization protocol", 2004). Pairs less than a quarter of a period apart are merged into one. Three things differ from there:
 *
 * - What a mote passes on is its newest pair, carried to the moment of its message with the line's skew, not the line itself. A line in
 *   every hop is a filter in every hop, whose errors grow exponentially with the hops; without it they grow as their square root
 *   (Lenzen et al., "PulseSync: an efficient and scalable clock synchronization protocol", 2015).
 * - A mote takes pairs of all neighbours that knew of the round before it relays it, or that are nearer to the root: not of one parent. So
 *   errors never run in circles.
 * - A mote that hears of no new round still sends, a wait after the period: a frame lost near the root does not silence all behind it.
 *
 * Rounds begin 2 s apart and slow down to the period, at the root and at every mote that has just got to know the time.
 *
 * Ticks are whole: a stamp stands for the middle of its tick, and times on the air have fractions. All in integers. docs/time.md has
 * the error budget.
 *
 * Before the first pair the mote has no network time (mh_clock_synchronised). When the root falls silent the last line holds, and its error
 * grows with the error of the skew, some parts per million; after MH_CLOCK_SILENCE periods another root is followed, if there is one. A root
 * that is restarted and still has the right time goes on with its round where its neighbours say it was. A pair far from the line is
 * rejected, so a neighbour that has been restarted or stamps wildly does no harm. Only after MH_CLOCK_REJECTS of them with no good one
 * between them does the mote begin anew: the root itself has jumped. */
#ifndef MOTEHOUND_CLOCK_H
#define MOTEHOUND_CLOCK_H

#include "motehound/config.h"
#include "motehound/protocol.h"

#define MH_CLOCK_SILENCE 8           /* periods without a new round after which a root counts as gone */
#define MH_CLOCK_REJECTS 5           /* pairs rejected in succession after which the mote believes them */
#define MH_CLOCK_SKEW_MAX_PPM 300    /* of a mote's clock against the root's: what crystals may do, and more */
#define MH_CLOCK_FIRST_INTERVAL 2000 /* between the first rounds, ticks; grows by half up to the period */

struct mh_clock_config {
    bool root;      /* this mote's clock is the network's time; one mote in a network */
    mh_tick period; /* between rounds, 2,000 to 3,600,000 ticks */
    mh_tick wait;   /* longest wait before a round is relayed, 1 to period / 2 */
    /* Where in its tick a sync message ends on average, 1/256. 128, the middle, if the radio's access to the channel is random. Where it sends a
     * fixed time after it is asked to, which happens as a tick begins, the fraction of that time and the air time, lest it add up hop by hop. */
    uint8_t sent_q8;
};

struct mh_clock_counters {
    uint16_t pairs;    /* taken; wraps, as all of these */
    uint16_t rejected; /* too far from the line */
    uint16_t jumps;    /* times the network time was set anew, the first one too */
};

/* Read it, but leave writing to the functions below. */
struct mh_clock {
    const struct mh_clock_config *config;
    mh_node_id id;

    /* network = local + offset + (line_q8 + skew x (local - origin)) / 256, both times in the middle of their ticks */
    mh_tick offset, origin;
    int32_t line_q8;
    int32_t skew_q32; /* ticks of gain a tick, 2^-32 */
    bool synchronised;

    struct mh_clock_pair {
        mh_tick local;
        int32_t offset_q8;   /* network - local - offset, 1/256 tick */
    } pairs[MH_CLOCK_PAIRS]; /* one a round, oldest first */
    uint8_t count;
    uint8_t merged;        /* pairs in the newest one so far */
    uint8_t rejects;       /* in succession */
    uint32_t variance_q16; /* of pairs about the line */

    mh_node_id root;
    uint16_t round; /* newest heard of (or, at the root, begun) */
    uint8_t hops;   /* to the root; UINT8_MAX: not known */
    uint8_t nearest,
        nearest_before; /* one more than the fewest hops of the senders in this round so far, in the last one */
    bool following;     /* root and round are known */
    mh_tick round_time; /* when it was heard of */
    mh_tick interval;   /* until the next message without a new round; at the root until the next round */

    bool sends, waits; /* send_time holds; a round waits to be relayed */
    mh_tick send_time;
    bool again;        /* the message to send is the second of its round */
    mh_tick next_time; /* when to send again if no new round comes */
    uint8_t number;    /* of the last own message */
    bool on_its_way;   /* it has been handed to the radio, which has not told its fate; for a period at most */
    uint16_t others;   /* other frames of which that is true ... */
    uint16_t before;   /* ... and of these, handed over before it */
    bool sent;         /* it went out, at (or, on its way, was handed over at) ... */
    mh_tick sent_time;

    struct mh_clock_moment {
        mh_node_id sender;
        mh_tick local;
        uint8_t number, hops;
    } heard
        [MH_CLOCK_NEIGHBOURS]; /* the last message of each; a neighbour stays until it has been silent for 3 periods */
    uint8_t heard_count;

    struct mh_clock_counters counters;
};

/* Begin, unsynchronised unless this is the root. `config` outlives the clock. Errors: MH_ERR_ARGUMENT (a null pointer, a value outside its
 * range). */
enum mh_status mh_clock_init(struct mh_clock *clock, const struct mh_clock_config *config, mh_node_id id, mh_tick now);

/* A sound sync message came in, its last bit at `now`. Returns true if the network time jumped: it is known for the first time, or begun
 * anew. Else it moved by no more than the errors of the pairs. Cost: one fit, some 50 additions and multiplications a kept pair. */
bool mh_clock_message(struct mh_clock *clock, mh_tick now, const mh_sync_t *message);

/* When to call mh_clock_timer, in local time. False: not as things stand. */
bool mh_clock_due(const struct mh_clock *clock, mh_tick *time);

/* The time has come. Returns true if `message` is to be sent to all; mh_clock_sent then tells its fate. Early and repeated
 * calls do no harm. */
bool mh_clock_timer(struct mh_clock *clock, mh_tick now, struct mh_message *message);

/* A frame of somebody else on this mote is handed to the radio. */
void mh_clock_other_frame(struct mh_clock *clock);

/* What became of the oldest frame handed to the radio of which this has not been told: it went out, its last bit at `now`, or
 * not. Returns true if it was the clock's own. */
bool mh_clock_sent(struct mh_clock *clock, mh_tick now, enum mh_sent outcome);

/* The mote knows the network's time. */
static inline bool mh_clock_synchronised(const struct mh_clock *clock) { return clock->synchronised; }

/* The network time in the middle of local tick `local`: the tick that it is in and, if `fraction` is not NULL, 1/256 of it. Never
 * decreases as `local` increases, between two calls of mh_clock_message; within 24.8 days of the last one. Before the
 * first synchronisation `local` itself. */
mh_tick mh_clock_network(const struct mh_clock *clock, mh_tick local, uint8_t *fraction);

/* The first local tick whose network time is `network` or later: the exact inverse. */
mh_tick mh_clock_local(const struct mh_clock *clock, mh_tick network);

/* These functions as a mote calls them, so that only the image of a mote that keeps the network's time holds them. */
struct mh_clock_functions {
    mh_wire_types *types; /* the sync message */
    enum mh_status (*init)(struct mh_clock *clock, const struct mh_clock_config *config, mh_node_id id, mh_tick now);
    bool (*message)(struct mh_clock *clock, mh_tick now, const mh_sync_t *message);
    bool (*due)(const struct mh_clock *clock, mh_tick *time);
    bool (*timer)(struct mh_clock *clock, mh_tick now, struct mh_message *message);
    void (*other_frame)(struct mh_clock *clock);
    bool (*sent)(struct mh_clock *clock, mh_tick now, enum mh_sent outcome);
    mh_tick (*network)(const struct mh_clock *clock, mh_tick local, uint8_t *fraction);
    mh_tick (*local)(const struct mh_clock *clock, mh_tick network);
};

extern const struct mh_clock_functions mh_clock_flooding;

#endif
