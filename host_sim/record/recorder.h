/* The recorder of one run: an ordinary LCM subscriber of its bus that keeps what the files and metrics are made of. */
#ifndef MOTEHOUND_SIM_RECORDER_H
#define MOTEHOUND_SIM_RECORDER_H

#include "motehound_local_t.h"
#include "motehound_node_t.h"
#include "motehound_track_t.h"
#include "motehound_truth_t.h"
#include "motehound_watch_t.h"
#include "totals.h"

#include <lcm/lcm.h>
#include <stdbool.h>

/* Node `node` was asked for the estimate number `track`, whether it had been before or not. */
struct heard {
    size_t track;
    int32_t node;
};

struct recorder {
    motehound_track_t *tracks; /* in the order they came, so by time */
    size_t track_count, track_capacity;
    motehound_track_t *sinks; /* what the sink had, likewise */
    size_t sink_count, sink_capacity;
    motehound_local_t *locals; /* what fixed clusters had, likewise */
    size_t local_count, local_capacity;
    struct heard *heard; /* in the order they came */
    size_t heard_count, heard_capacity;
    motehound_watch_t *watches; /* how the nodes around targets stood, likewise */
    size_t watch_count, watch_capacity;
    motehound_truth_t *truths; /* of the targets that were present, likewise */
    size_t truth_count, truth_capacity;
    int32_t targets;         /* one more than the largest number among them */
    motehound_node_t *nodes; /* the motes, where the bus tells them */
    size_t node_count, node_capacity;
    size_t samples;             /* sampling instants at which a target was present */
    double first_s, last_s;     /* of these */
    double totals[TOTAL_COUNT]; /* of the run, all zero until it has ended */
    bool failed;                /* no memory, or a message that is none of ours */
};

/* `recorder` begins as all zero bytes and stays where it is while `lcm` is alive. Returns 0, or -1 if LCM refuses. */
int recorder_subscribe(struct recorder *recorder, lcm_t *lcm);

void recorder_free(struct recorder *recorder);

#endif
