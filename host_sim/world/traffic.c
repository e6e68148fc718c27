#include "world/traffic.h"

#include "engine/random.h"

#include <stdlib.h>

static int by_phase(const void *a, const void *b)
{
    const struct traffic_source *left = a, *right = b;
    if (left->phase != right->phase) {
        return left->phase < right->phase ? -1 : 1;
    }
    return (left->mote > right->mote) - (left->mote < right->mote);
}

int traffic_make(struct traffic *traffic, size_t count, size_t motes, sim_time interval, uint64_t seed)
{
    const struct random_stream stream = random_stream(seed, RANDOM_TRAFFIC);
    *traffic = (struct traffic){.count = count < motes ? count : motes, .interval = interval};
    traffic->sources = malloc(traffic->count * sizeof *traffic->sources + 1);
    if (!traffic->sources) {
        return -1;
    }
    for (size_t i = 0; i < traffic->count; i++) {
        traffic->sources[i] = (struct traffic_source){.phase = (sim_time)(random_uniform(stream, i) * (double)interval),
                                                      .mote = (uint32_t)((2 * i + 1) * motes / (2 * traffic->count))};
    }
    qsort(traffic->sources, traffic->count, sizeof *traffic->sources, by_phase);
    return 0;
}

void traffic_free(struct traffic *traffic)
{
    free(traffic->sources);
    *traffic = (struct traffic){0};
}

sim_time traffic_next(const struct traffic *traffic)
{
    if (traffic->count == 0) {
        return SIM_TIME_NEVER;
    }
    return traffic->taken / traffic->count * traffic->interval +
           traffic->sources[traffic->taken % traffic->count].phase;
}

uint32_t traffic_take(struct traffic *traffic) { return traffic->sources[traffic->taken++ % traffic->count].mote; }
