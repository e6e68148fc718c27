#include "record/recorder.h"

#include "bus/bus.h"

#include "motehound_cluster_t.h"
#include "motehound_totals_t.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Room for one more element of `size` bytes. Returns false if there is no memory. */
static bool grow(void **array, size_t count, size_t *capacity, size_t size)
{
    if (count < *capacity) {
        return true;
    }
    const size_t wanted = *capacity > 0 ? 2 * *capacity : 128;
    void *larger = realloc(*array, wanted * size);
    if (larger == NULL) {
        return false;
    }
    *array = larger;
    *capacity = wanted;
    return true;
}

/* Keep every message of a channel: `list` and its number and room, named after `one`, are members of struct recorder. */
#define KEEPER(type, list, one)                                                                                        \
    static void on_##one(const lcm_recv_buf_t *buffer, const char *channel, void *context)                             \
    {                                                                                                                  \
        (void)channel;                                                                                                 \
        struct recorder *recorder = context;                                                                           \
        if (grow((void **)&recorder->list, recorder->one##_count, &recorder->one##_capacity,                           \
                 sizeof *recorder->list) &&                                                                            \
            type##_decode(buffer->data, 0, (int)buffer->data_size, &recorder->list[recorder->one##_count]) >= 0) {     \
            recorder->one##_count++;                                                                                   \
        } else {                                                                                                       \
            recorder->failed = true;                                                                                   \
        }                                                                                                              \
    }

KEEPER(motehound_track_t, tracks, track)
KEEPER(motehound_track_t, sinks, sink)
KEEPER(motehound_local_t, locals, local)
KEEPER(motehound_watch_t, watches, watch)
KEEPER(motehound_node_t, nodes, node)

static void on_cluster(const lcm_recv_buf_t *buffer, const char *channel, void *context)
{
    (void)channel;
    struct recorder *recorder = context;
    motehound_cluster_t cluster;
    if (motehound_cluster_t_decode(buffer->data, 0, (int)buffer->data_size, &cluster) < 0) {
        recorder->failed = true;
        return;
    }
    for (int32_t i = -1; i < cluster.count; i++) {
        if (grow((void **)&recorder->heard, recorder->heard_count, &recorder->heard_capacity,
                 sizeof *recorder->heard)) {
            recorder->heard[recorder->heard_count++] =
                (struct heard){recorder->track_count, i < 0 ? cluster.head : cluster.members[i]};
        } else {
            recorder->failed = true;
        }
    }
    motehound_cluster_t_decode_cleanup(&cluster);
}

static void on_truth(const lcm_recv_buf_t *buffer, const char *channel, void *context)
{
    (void)channel;
    struct recorder *recorder = context;
    motehound_truth_t truth;
    if (motehound_truth_t_decode(buffer->data, 0, (int)buffer->data_size, &truth) < 0) {
        recorder->failed = true;
        return;
    }
    if (!truth.present) {
        return;
    }
    if (!grow((void **)&recorder->truths, recorder->truth_count, &recorder->truth_capacity, sizeof *recorder->truths)) {
        recorder->failed = true;
        return;
    }
    recorder->truths[recorder->truth_count++] = truth;
    recorder->targets = truth.target >= recorder->targets ? truth.target + 1 : recorder->targets;
    if (recorder->samples == 0 || truth.time_s > recorder->last_s) {
        recorder->first_s = recorder->samples > 0 ? recorder->first_s : truth.time_s;
        recorder->last_s = truth.time_s;
        recorder->samples++;
    }
}

static void on_totals(const lcm_recv_buf_t *buffer, const char *channel, void *context)
{
    (void)channel;
    struct recorder *recorder = context;
    motehound_totals_t message;
    if (motehound_totals_t_decode(buffer->data, 0, (int)buffer->data_size, &message) < 0) {
        recorder->failed = true;
        return;
    }
    for (int total = 0; total < TOTAL_COUNT; total++) {
        recorder->totals[total] = (double)NAN;
        for (int32_t i = 0; i < message.count; i++) {
            if (strcmp(message.names[i], total_names[total]) == 0) {
                recorder->totals[total] = message.values[i];
            }
        }
    }
    motehound_totals_t_decode_cleanup(&message);
}

int recorder_subscribe(struct recorder *recorder, lcm_t *lcm)
{
    const bool sound = lcm_subscribe(lcm, BUS_NODE, on_node, recorder) != NULL &&
                       lcm_subscribe(lcm, BUS_TRACK, on_track, recorder) != NULL &&
                       lcm_subscribe(lcm, BUS_SINK, on_sink, recorder) != NULL &&
                       lcm_subscribe(lcm, BUS_LOCAL, on_local, recorder) != NULL &&
                       lcm_subscribe(lcm, BUS_CLUSTER, on_cluster, recorder) != NULL &&
                       lcm_subscribe(lcm, BUS_WATCH, on_watch, recorder) != NULL &&
                       lcm_subscribe(lcm, BUS_TRUTH, on_truth, recorder) != NULL &&
                       lcm_subscribe(lcm, BUS_TOTALS, on_totals, recorder) != NULL;
    return sound ? 0 : -1;
}

void recorder_free(struct recorder *recorder)
{
    free(recorder->tracks);
    free(recorder->sinks);
    free(recorder->locals);
    free(recorder->heard);
    free(recorder->watches);
    free(recorder->truths);
    free(recorder->nodes);
    *recorder = (struct recorder){0};
}
