/* The head that goes with a target: the "prince - exception - competition" protocol (Han, 2.2), for one target and for several, with two other elections to compare it with.
 *
 * Each target (or group of targets, group.h) has a head, which was the last to localise it, and a generation, which counts its fixes. A head tells all in range where
 * the target is and how it moves (awake_t), with the track as its tracker saves it. Whoever stands about the path then watches: samples each `tick`. The others sleep. The head names as
 * prince the node that is to localise the target next. A node has a row of its table for each target that it knows of, and in each a state and a class of its own:
 *
 *     SLEEP   nothing to do with the target; the row is kept to reckon with the target's share in what is heard
 *     WATCH   samples; inner, border, outer by its place (node_class.h), or competitor: may contend for the lead
 *     LOCATE  has asked for answers, and waits for them
 *     HEAD    has localised the target, and nobody has since
 *
 * What makes a watcher localise the target when its energy is 1 or more (one target; with several see below):
 *     the prince       at once (locate_t)
 *     outer            with an energy of `exception` or more: the target has left its path. After up to 200 ms, unless somebody else asks meanwhile
 *     inner, border    regent: when the prince is overdue by a second and up to 0.5 s more, border 0.3 s later still
 *     competitor       by the election: COMPETITION: after a back-off of up to `contest` it says its energy (compete_t), unless three others have; soon after, the strongest
 *                      asks. TIMESTAMP: as prince_stamp.c has it.
 * Who hears locate_t samples; hearing the target it answers (sound_t), the nearer the sooner, unless `replies` others have; in turn of where the neighbours and
 * the target are expected to be, or where that says nothing (exceptions, competitions), by the energy. The locator, too, samples anew when its locate_t
 * is out: what made it ask is the first sample that was large enough, and so mostly too large. The fix is of that time; an energy that has fallen below 1 counts as 1. TIMESTAMP: the samples are
 * those of the detections. The locator collects for `window`. With two answers and more
 * the port localises the target, the locator is head, tells the old one (succeed_t; whoever overhears it waits for the new awake_t) and all (awake_t). Else it tries once more if
 * it still hears the target; then it says fail_t, and all who hear that are competitors for 10 s.
 *
 * What goes wrong, each guard in `guards` by itself:
 *   - The prince is dead, asleep, or has never heard that it is prince: REGENT, and WATCHDOG: a head of which nobody has taken over by 2.5 s after the prince was due, or when the target may have left its
 *     radio range, 25 s after the fix at the latest, says fail_t.
 *   - Answers are lost: RETRY. Nobody hears fail_t who hears the target: RELAY, who wins and gets no answers says fail_t again; and who hears
 *     the target when its time to watch is over watches on, as competitor.
 *   - The target turns: EXCEPTION.
 *   - An awake_t is lost: a head says it again when it hears anything of an earlier generation, or of a new target that its own explains; at most every 0.5 s.
 *   - Two locate at once: the one who hears of the other and was later, or at the same time has the higher identifier, gives up, and
 *     all answer the first. Two heads of one generation: likewise, by their fixes.
 * A target that all of this does not find is lost when the last watcher's time is over; where it is found again, as new, under another identifier. With watch_period 0 it is not looked for.
 *
 * Several targets (Han, 3.2): rows do not know of each other, but a watcher takes for a target's energy its share (3-3) in what it hears, by where it and the others within 3 R are expected, and only while
 * the target should be within range, give or take 10 m. A competitor, and an outer node, must hear more than the other rows explain, and its target must have a quarter of it. A tracker localises among the others
 * (tracker.h). Identifiers are founder x 16 + a count, so no two founders below 2^28 give the same. What no row explains is a new target: entries, and every node once a watch_period, look for such, but
 * not within 25 m, and the way it may have gone since its fix, of one that is known: targets that appear side by side are found one after the other, or as one.
 * Groups: where the tracker says that two targets are to go on as one, the head takes the other in, under the lower identifier, and says so (merge_t), which the other's head answers; it is said again
 * when the group meets it again. Where it falls apart each part gets a prince (awake_t) of its own.
 *
 * A table that is full: the row goes whose target is out of range first (time_out), one that sleeps before one that watches; a locator's or head's row never. If none can go the
 * newcomer is not taken. Both are counted (evicted).
 *
 * With wake windows (rendezvous.h) radios of nodes without watching rows sleep but in these; then awake_t, rest_t and fail_t go twice: at once and in the next window.
 *
 * The sensor is sampled when the protocol wants it (mh_mote_config.sensor: interval 1, report_always). All motes but the sink have a head's configuration; its tracker must save. Needs the network's time (to some 50 ms),
 * and does nothing before it is known. Nodes say hello three times in the first MH_PRINCE_START ticks and then once a hello period: whom a node has heard it can name as prince.
 *
 * Memory: at most 300 bytes a target on an ATmega128; docs/prince.md has the table of the state machine, docs/costs.md the rest. */
#ifndef MOTEHOUND_PRINCE_H
#define MOTEHOUND_PRINCE_H

#include "motehound/neighbours.h"
#include "motehound/node_class.h"
#include "motehound/random.h"
#include "motehound/rendezvous.h"
#include "motehound/tracker.h"

#define MH_PRINCE_START 9000                       /* ticks of the first hellos */
#define MH_PRINCE_CONTENDERS 3                     /* of a competition; whoever hears so many keeps silent */
#define MH_PRINCE_TRACK_BYTES (2 * MH_AWAKE_BYTES) /* of a saved track */

/* Answers that a node keeps, of all its open queries together, 30 bytes each. */
#ifndef MH_PRINCE_REPLIES_MAX
#ifdef __AVR__
#define MH_PRINCE_REPLIES_MAX 8
#else
#define MH_PRINCE_REPLIES_MAX 24
#endif
#endif
#if MH_PRINCE_REPLIES_MAX < 3 || MH_PRINCE_REPLIES_MAX > 100
#error "MH_PRINCE_REPLIES_MAX must be 3 to 100: a fix takes the locator's own and two more, and they are moved about"
#endif

enum mh_prince_election { MH_PRINCE_NAMED, MH_PRINCE_COMPETITION, MH_PRINCE_TIMESTAMP };

/* What keeps a track when something goes wrong. */
enum {
    MH_PRINCE_EXCEPTION = 1, /* Han's own */
    MH_PRINCE_REGENT = 2,
    MH_PRINCE_WATCHDOG = 4,
    MH_PRINCE_RELAY = 8,
    MH_PRINCE_RETRY = 16,
    MH_PRINCE_ALL = 31
};

/* Here a target may appear: whoever is in radio range watches, as competitor, for 30 s from then. */
struct mh_prince_entry {
    struct mh_place place;
    mh_tick time;
};

/* What the protocol asks of the mote besides protocol.h: of its tracker (tracker.h). `context` is the node's. Errors are the tracker's; saved tracks longer than
 * MH_PRINCE_TRACK_BYTES are MH_ERR_CAPACITY. */
struct mh_prince_port {
    /* A step at `time` of the track `own` (length 0: it begins), among `others` -> *estimate, the track as saved: bytes[0 .. *length). Of a track that cannot be
     * saved *estimate is set all the same: a second one would lie on the stack while the tracker works. */
    enum mh_status (*localise)(void *context, const struct mh_saved_track *own, const struct mh_saved_track *others,
                               size_t count, mh_tick time, const struct mh_measurement *measurements,
                               size_t measurement_count, struct mh_estimate *estimate, uint8_t *bytes, size_t *length);
    /* Where a saved track is expected at `time` -> *estimate. */
    enum mh_status (*expect)(void *context, const struct mh_saved_track *track, mh_tick time,
                             struct mh_estimate *estimate);
    /* `own` and `other` as one group, at the time of own -> bytes[0 .. *length). */
    enum mh_status (*join)(void *context, const struct mh_saved_track *own, const struct mh_saved_track *other,
                           uint8_t *bytes, size_t *length);
    /* Part `part` of the group that was localised last, at once after that -> its identifier, bytes[0 .. *length). */
    enum mh_status (*part)(void *context, uint8_t part, uint32_t *target, uint8_t *bytes, size_t *length);
};

struct mh_prince_config {
    const struct mh_prince_port *port; /* &mh_mote_prince (mote.h) */
    enum mh_prince_election election;
    uint8_t guards;          /* MH_PRINCE_* */
    uint8_t replies;         /* to a query that are wanted, 2 to 100; groups want all. Nominal 2; 4 for accuracy */
    bool farthest;           /* the prince is the one farthest along the path, whatever step_m is */
    mh_real sensing_range_m; /* R, 1 to 1,000. Nominal 40 */
    mh_real radio_range_m;   /* R_c, above R, to 10,000. Nominal 140 */
    mh_real margin_m;        /* r, 0 to R. Nominal R / 5 */
    mh_real outer_m;         /* d_outer, R to 10 R. Nominal 2 R; as published R + r */
    mh_real exception;       /* energy, 1 to 100. Nominal (R / (R - r))^2; as published 1 */
    mh_real loudness_m2;     /* C, of all targets, 1 to 1e8 (fixed point: 32,767). Nominal R^2 */
    mh_real step_m;          /* L_step: the way that the target goes between fixes, 1 to 10,000. Nominal 1.5 R */
    mh_tick tick;    /* between samples of a watcher, which are at its whole multiples. 20 to 60,000, nominal 250 */
    mh_tick window;  /* answers are waited for so long, twice as long those about groups. 20 to 10,000, nominal 300 */
    mh_tick contest; /* longest back-off of a competitor, 1 to 10,000. Nominal 350 */
    mh_tick watch_period; /* who does not watch samples so often: 0 (never), or a tick to an hour. Nominal 0 */
    mh_tick wake_period,
        wake_length;      /* of wake windows (rendezvous.h); period 0: radios listen all the time. Nominal 0 */
    mh_tick hello_period; /* 10 s to 1,000 s. Nominal 300 s */
    const struct mh_prince_entry *entries;
    uint8_t entry_count;
};

enum mh_prince_state { MH_PRINCE_FREE, MH_PRINCE_SLEEP, MH_PRINCE_WATCH, MH_PRINCE_LOCATE, MH_PRINCE_HEAD };

/* What is to be done about a target, in this order if at the same time. */
enum mh_prince_timer {
    MH_PRINCE_ACT,      /* what `act` says */
    MH_PRINCE_REPLY,    /* answer a query */
    MH_PRINCE_CLOSE,    /* locator: the answers are in */
    MH_PRINCE_DOG,      /* head: nobody has taken over */
    MH_PRINCE_ANNOUNCE, /* what `announces` says, in a wake window */
    MH_PRINCE_QUIET,    /* stop watching */
    MH_PRINCE_FORGET,   /* the row */
    MH_PRINCE_TIMERS
};

/* What a watcher has in mind. */
enum mh_prince_act {
    MH_PRINCE_ACT_NONE,
    MH_PRINCE_ACT_LOCATE,  /* ask, as `kind` says */
    MH_PRINCE_ACT_CONTEND, /* say that it competes, if not too many have */
    MH_PRINCE_ACT_DECIDE,  /* the competition is over */
    MH_PRINCE_ACT_RELEASE  /* timestamp: those suppressed may speak again */
};

/* What a sample is wanted for, in mh_prince_row.wants. */
enum {
    MH_PRINCE_WANTS_QUERY = 1,
    MH_PRINCE_WANTS_REPLY = 2,
    MH_PRINCE_WANTS_CONTEND = 4,
    MH_PRINCE_WANTS_OWN = 8 /* the locator's own, when the others sample */
};

/* A target as one node knows it. */
struct mh_prince_row {
    uint32_t target; /* 0: a new one, not yet named */
    uint16_t generation;
    uint8_t state; /* enum mh_prince_state */
    uint8_t as;    /* enum mh_node_class, of a watcher */
    bool is_prince : 1;
    bool is_passive : 1;      /* somebody has taken over: only answers, until the next awake_t */
    bool fixed : 1;           /* there is a fix: what follows holds */
    bool tried : 1;           /* locator: this is the second try */
    mh_tick found;            /* the fix: when, ... */
    int32_t x_mm, y_mm;       /* ... where, ... */
    int16_t vx_cmps, vy_cmps; /* ... and how the target moves; 0, 0: unknown */
    uint16_t extent_cm;       /* of a group */
    uint8_t members;          /* targets in it, 1: no group */
    uint8_t speeds[3];        /* between the last fixes, the newest first, quarters of m/s */
    mh_node_id head, prince;  /* MH_BROADCAST: nobody */
    mh_tick in, out; /* when the target is within the node's range; of sleepers when it is nearest to it, both */
    mh_tick enters;  /* when the prince's turn comes */
    mh_tick arms;    /* who competes may not before */
    mh_tick hold;    /* nor before this */
    mh_tick queried; /* the last query heard, or sent */
    mh_tick said;    /* when awake_t or fail_t was last said again */

    uint8_t set;                   /* bit k: timer k is set ... */
    mh_tick due[MH_PRINCE_TIMERS]; /* ... for this network time */
    uint8_t act;                   /* enum mh_prince_act */
    uint8_t kind;                  /* enum mh_locate, of what it has in mind, or has asked */
    uint8_t announces;             /* enum mh_message_kind */
    uint8_t wants;                 /* MH_PRINCE_WANTS_* */
    mh_tick localised;             /* locator: the time that its answers are of */
    uint8_t unsent; /* locator: frames whose fate is told before that of its locate_t, and it; 0: it is out */

    /* a query heard, to be answered; a query sent: asker is this node */
    mh_node_id asker;
    mh_tick asked;      /* its time ... */
    uint16_t asked_for; /* ... and generation */
    uint8_t overheard;  /* answers to it */
    mh_q20 value;       /* this node's energy: of the answer, or what it competes with */

    /* a competition: */
    uint8_t contenders; /* heard */
    mh_node_id best;    /* of all, this node among them ... */
    mh_q20 best_value;  /* ... its energy; timestamp: ... */
    mh_tick best_time;  /* ... when it detected the target */

    uint8_t gathered; /* bytes of the saved track that have come ... */
    uint8_t length;   /* ... of so many */
    uint8_t bytes[MH_PRINCE_TRACK_BYTES];
};

/* State of one mote; read it, but leave writing to the protocol. */
struct mh_prince {
    const struct mh_prince_config *config;
    const struct mh_protocol_node *node;
    struct mh_neighbours neighbours;
    struct mh_rendezvous rendezvous;
    struct mh_random random;
    mh_tick now, time; /* the mote's own time and the network's, of the event that is being handled */
    mh_tick began;     /* when the network's time became known */
    bool running;      /* it is */
    uint16_t hellos;   /* sent */
    mh_tick hello;     /* the next one */
    bool ticks;        /* the next sample of a watcher, or of one who looks for new targets, is due at ... */
    mh_tick tick;      /* ... this time */
    uint8_t founded;   /* targets */
    bool sampling;     /* a sample of `sampled` is awaited ... */
    bool ticking;      /* ... for what a watcher does at a tick, too */
    bool heard;        /* value holds, of the time sampled */
    mh_tick sampled;
    mh_q20 value;
    uint8_t on_way; /* frames sent whose fate has not been told */
    uint8_t reply_count;
    struct mh_measurement replies[MH_PRINCE_REPLIES_MAX]; /* by row, which `target` says */
    struct mh_prince_row rows[MH_TARGETS_MAX];
    struct mh_prince_counters counters;
};

extern const struct mh_protocol mh_protocol_prince;

/* nominal configuration for a sensing range and a radio range, m, with all guards, or as published (guards: EXCEPTION only); `port` and entries remain to be filled in */
void mh_prince_config_default(struct mh_prince_config *config, enum mh_prince_election election, bool guarded,
                              mh_real sensing_range_m, mh_real radio_range_m);

#endif
