/* The cluster head: gathers the measurements of one sampling instant, then steps its tracker. */
#ifndef MOTEHOUND_HEAD_H
#define MOTEHOUND_HEAD_H

#include "motehound/config.h"
#include "motehound/tracker.h"

struct mh_head_config {
    const struct mh_tracker *tracker;
    const void *tracker_config; /* the tracker's own structure */
    void *tracker_state;        /* tracker->state_size bytes */
    mh_tick epoch;              /* a sampling instant; the others are whole intervals from it */
    mh_tick interval;           /* between sampling instants, 1 to 3,600,000 */
    mh_tick window;             /* measurements are waited for this long after their instant; below interval */
    /* A measurement taken this much before or after an instant, below interval / 2, is taken for one of the instant, its time set to it: where
     * each mote samples by its own idea of the network's time. 0: times are exact. */
    mh_tick tolerance;
    bool
        own_first; /* a head's own measurements come before the others of their time: for trackers that take them one by one */
    /* Measurements of instants closed at most this long ago are handed to the tracker at the next instant all the same, because it can use them. 0 to
     * 3,600,000; 0: they are refused. */
    mh_tick lateness;
};

struct mh_head_counters {
    uint32_t measurements; /* taken */
    uint32_t late;         /* came after their instant was closed, and the lateness besides */
    uint32_t early;        /* belong to an instant after the next */
    uint32_t repeated;     /* same node, target and instant once more */
    uint32_t overflowed;   /* gave way because MH_REPORTS_MAX was reached */
    uint32_t estimates;    /* positions given */
    uint32_t at_end; /* of the measurements: value or increment at an end of Q11.20, where sensor nodes saturate */
    uint32_t
        saturated; /* steps that the tracker refused because a number was too large: MH_ERR_RANGE, MH_ERR_NOT_FINITE */
};

struct mh_head {
    const struct mh_head_config *config;
    struct mh_measurement measurements[MH_REPORTS_MAX]; /* by time, then node, own first if wanted, then target */
    uint16_t count;
    mh_node_id own;  /* this node; set by who runs the head, after init, where own_first */
    mh_tick instant; /* the sampling instant being gathered */
    bool tracking;   /* a track exists: the tracker can predict, whether or not the last instant gave a position */
    struct mh_head_counters counters;
};

/* Begin gathering at the first instant at or after `now`. Errors: MH_ERR_ARGUMENT (a null pointer, a value outside its
 * range), or what the tracker's init returns. */
enum mh_status mh_head_init(struct mh_head *head, const struct mh_head_config *config, mh_tick now);

/* Take one measurement. It belongs to the instant within the tolerance of the time it was taken, else to the first after it; one of the
 * instant after the one being gathered is kept for it, and one that is late, but not too late, for the one being gathered. Cost: O(MH_REPORTS_MAX).
 * Errors, each counted: MH_ERR_TIME (its instant is closed, or is not yet the next), MH_ERR_REPEATED (same node, target and
 * instant), MH_ERR_CAPACITY (one gave way, this or another: the smallest increment, of equal ones the largest node
 * number, so that what is kept does not depend on the order of arrival). */
enum mh_status mh_head_measurement(struct mh_head *head, const struct mh_measurement *given);

/* When the instant being gathered is to be closed. */
mh_tick mh_head_deadline(const struct mh_head *head);

/* Close it: step the tracker with its measurements, go on to the next instant. Instants are closed one by one, none is left
 * out: the interval must be longer than the tracker's step takes on the board, or the head falls behind for good and
 * measurements count as early.
 * Errors: MH_NONE (no position at this instant), or what the tracker's step returns; the next instant is gathered all the same. */
enum mh_status mh_head_close(struct mh_head *head, struct mh_estimate *estimate);

/* The same in two parts, for who wants to see the measurements, which are measurements[0 .. *used) in between. */
enum mh_status mh_head_step(struct mh_head *head, struct mh_estimate *estimate, uint16_t *used);
void mh_head_go_on(struct mh_head *head, uint16_t used);

#endif
