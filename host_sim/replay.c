#include "simulation.h"

#include "network.h"
#include "reals.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

struct replay {
    const struct recording *recording;
    const struct observer *observer;
    struct roster roster;
    uint32_t *motes; /* of the recording's nodes */
    mh_tick interval;
    uint64_t lead;    /* ticks from simulated time 0 to the first reading, in which the nodes hear of the head */
    uint64_t instant; /* the next sampling instant, in ticks from the first reading */
    uint64_t last;    /* ... and the last reading */
    size_t next;      /* reading */
    uint64_t samples;
    struct network network;
};

/* Ticks from the first reading. */
static uint64_t ticks(const struct recording *recording, size_t reading)
{
    return (uint64_t)llround((recording->readings[reading].time_s - recording->readings[0].time_s) * MH_TICKS_PER_S);
}

static struct truth truth_at(const struct recording *recording, double time_s)
{
    struct truth truth = {.time_s = time_s};
    const struct recorded_truth *rows = recording->truths;
    const size_t count = recording->truth_count;
    if (count == 0 || !(time_s >= rows[0].time_s && time_s <= rows[count - 1].time_s)) {
        return truth;
    }
    size_t low = 0, high = count - 1; /* rows[low].time <= time <= rows[high].time */
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (rows[middle].time_s <= time_s) {
            low = middle;
        } else {
            high = middle;
        }
    }
    const double span = rows[high].time_s - rows[low].time_s;
    const double share = span > 0 ? (time_s - rows[low].time_s) / span : 0;
    truth.present = true;
    truth.rate = rows[low].rate_mlps + share * (rows[high].rate_mlps - rows[low].rate_mlps);
    truth.x_m = rows[low].x_m + share * (rows[high].x_m - rows[low].x_m);
    truth.y_m = rows[low].y_m + share * (rows[high].y_m - rows[low].y_m);
    if (span > 0) {
        truth.vx_mps = (rows[high].x_m - rows[low].x_m) / span;
        truth.vy_mps = (rows[high].y_m - rows[low].y_m) / span;
    }
    return truth;
}

static int by_value(const void *a, const void *b)
{
    const mh_tick left = *(const mh_tick *)a, right = *(const mh_tick *)b;
    return (left > right) - (left < right);
}

/* Readings come in bursts, one an interval, and jitter. A sampling instant is best placed at the end of a burst, where the
 * longest pause begins: all of it then belongs to one instant. Returns that phase of the interval, counted from the
 * first reading; 0 where all readings are whole intervals apart. */
static int longest_pause(const struct recording *recording, mh_tick interval, mh_tick *phase)
{
    const size_t count = recording->reading_count;
    mh_tick *phases = malloc(count * sizeof *phases);
    if (!phases) {
        return -1;
    }
    for (size_t i = 0; i < count; i++) {
        phases[i] = (mh_tick)(ticks(recording, i) % interval);
    }
    qsort(phases, count, sizeof *phases, by_value);
    mh_tick longest = interval - phases[count - 1] + phases[0];
    *phase = phases[count - 1];
    for (size_t i = 1; i < count; i++) {
        if (phases[i] - phases[i - 1] > longest) {
            longest = phases[i] - phases[i - 1];
            *phase = phases[i - 1];
        }
    }
    free(phases);
    return 0;
}

static void report(void *context, uint32_t mote, double now_s, double time_s, const struct mh_estimate *estimate)
{
    const struct replay *replay = context;
    if (replay->observer->estimate) {
        const struct truth at_time = truth_at(replay->recording, time_s);
        const struct truth at_arrival = truth_at(replay->recording, time_s - number_of(estimate->age));
        replay->observer->estimate(replay->observer->context, now_s, roster_id(&replay->roster, mote), estimate,
                                   &at_time, &at_arrival);
    }
}

static int schedule(struct replay *replay, uint64_t tick)
{
    return network_schedule(&replay->network, (tick + replay->lead) * (SIM_TIME_PER_S / MH_TICKS_PER_S));
}

static int32_t q20(double value) { return (int32_t)lround(fmin(fmax(ldexp(value, 20), INT32_MIN), INT32_MAX)); }

/* A node measures a value, and the wind where somebody asks for it. */
static void read(struct replay *replay, const struct recorded_reading *reading)
{
    const uint32_t mote = replay->motes[reading->node];
    network_reading(&replay->network, mote, q20(reading->value), reading->target);
    if (replay->roster.kit.tracker.wants_wind) {
        network_reading(&replay->network, mote, q20(reading->wind_x_mps), MH_TARGET_WIND_X);
        network_reading(&replay->network, mote, q20(reading->wind_y_mps), MH_TARGET_WIND_Y);
    }
}

/* A sampling instant, or readings, or both. */
static int work(void *context)
{
    struct replay *replay = context;
    const struct recording *recording = replay->recording;
    const uint64_t now = replay->network.now / (SIM_TIME_PER_S / MH_TICKS_PER_S) - replay->lead;
    if (now == replay->instant) {
        const struct truth truth = truth_at(recording, network_time_s(&replay->network));
        if (replay->observer->truth) {
            replay->observer->truth(replay->observer->context, &truth);
        }
        replay->samples += truth.present || recording->truth_count == 0;
        replay->instant += replay->interval;
    }
    for (; replay->next < recording->reading_count && ticks(recording, replay->next) == now; replay->next++) {
        read(replay, &recording->readings[replay->next]);
    }
    uint64_t next = replay->instant;
    if (replay->next < recording->reading_count && ticks(recording, replay->next) < next) {
        next = ticks(recording, replay->next);
    }
    return next < replay->last + replay->interval ? schedule(replay, next) : 0;
}

static int find_motes(struct replay *replay, char *error, size_t error_size)
{
    const struct recording *recording = replay->recording;
    if (deployment_copy(&replay->roster.deployment, recording->nodes, recording->node_count, error, error_size)) {
        return -1;
    }
    replay->motes = malloc(recording->node_count * sizeof *replay->motes + 1);
    if (!replay->motes) {
        snprintf(error, error_size, "out of memory");
        return -1;
    }
    for (size_t i = 0; i < recording->node_count; i++) {
        replay->motes[i] = (uint32_t)deployment_find(&replay->roster.deployment, recording->nodes[i].id);
    }
    return 0;
}

static int bring_up(struct replay *replay, const struct scenario *scenario, uint64_t seed, char *error,
                    size_t error_size)
{
    const struct recording *recording = replay->recording;
    const double interval_s = scenario->sensor.interval_s > 0 ? scenario->sensor.interval_s : recording->interval_s;
    if (recording->reading_count == 0 || recording->node_count == 0) {
        snprintf(error, error_size, "the recording has no readings");
        return -1;
    }
    const double span_s = recording->readings[recording->reading_count - 1].time_s - recording->readings[0].time_s;
    if (!(span_s < 1e9)) {
        snprintf(error, error_size, "the recording lasts %g s, expected less than 1e9", span_s);
        return -1;
    }
    if (!(interval_s >= 0.001 && interval_s <= 3600)) {
        snprintf(error, error_size, "sensor.interval_s: %g, expected 0.001 to 3600", interval_s);
        return -1;
    }
    replay->interval = (mh_tick)lround(interval_s * MH_TICKS_PER_S);
    replay->lead = replay->interval / 2;
    replay->last = ticks(recording, recording->reading_count - 1);
    mh_tick phase;
    if (longest_pause(recording, replay->interval, &phase)) {
        snprintf(error, error_size, "out of memory for %zu readings", recording->reading_count);
        return -1;
    }
    replay->instant = phase;
    struct roster *roster = &replay->roster;
    const struct network_config config = {
        .scenario = scenario,
        .roster = roster,
        .range_m = HUGE_VAL,
        .seed = seed,
        .observer = replay->observer,
        .start_s = recording->readings[0].time_s - (double)replay->lead / MH_TICKS_PER_S,
        .context = replay,
        .instant = work,
        .report = report,
    };
    struct mote_kit *kit = &roster->kit;
    roster->seed = seed;
    if (tracker_choose_of_recording(scenario, recording, interval_s, &kit->tracker, error, error_size) ||
        protocol_choose("direct", scenario, &kit->protocol, error, error_size) ||
        find_motes(replay, error, error_size)) {
        return -1;
    }
    kit->sensor = (struct mh_sensor_config){.q20_per_count = 1,
                                            .counts_min = INT32_MIN,
                                            .counts_max = INT32_MAX,
                                            .interval = replay->interval,
                                            .threshold = q20_of(scenario->tracker.chi),
                                            .report_always = kit->tracker.measures != QUANTITY_CONCENTRATION};
    mote_kit_complete(kit, scenario, (mh_tick)(replay->lead + phase));
    if (roster_complete(roster, scenario, error, error_size)) {
        return -1;
    }
    if (network_make(&replay->network, &config, error, error_size)) {
        return -1;
    }
    if (schedule(replay, 0)) {
        snprintf(error, error_size, "out of memory");
        return -1;
    }
    return 0;
}

int simulation_replay(const struct scenario *scenario, const struct recording *recording, uint64_t seed,
                      const struct observer *observer, const volatile sig_atomic_t *stop,
                      struct simulation_counters *counters, char *error, size_t error_size)
{
    struct replay replay = {.recording = recording, .observer = observer};
    int result = bring_up(&replay, scenario, seed, error, error_size);
    if (result == 0) {
        /* The last instant is the first at or after the last reading; the head waits for it less than one interval. */
        const uint64_t first = replay.instant, interval = replay.interval;
        const uint64_t instants = 1 + (replay.last > first ? (replay.last - first + interval - 1) / interval : 0);
        const uint64_t end = first + instants * interval + replay.lead;
        result = network_run(&replay.network, end * (SIM_TIME_PER_S / MH_TICKS_PER_S), stop, error, error_size);
        *counters = (struct simulation_counters){.samples = replay.samples};
    }
    if (result == 0) {
        result = network_count(&replay.network, counters, error, error_size);
    }
    network_free(&replay.network);
    free(replay.motes);
    roster_free(&replay.roster);
    return result;
}
