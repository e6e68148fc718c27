#include "totals.h"

#include <math.h>

#define ANY (-1)

static uint64_t frames_sent(const struct simulation_counters *counters)
{
    uint64_t sum = 0;
    for (int kind = 0; kind <= MH_MESSAGE_KINDS; kind++) {
        sum += counters->frames_sent[kind];
    }
    return sum;
}

static double delivery_share(const struct simulation_counters *counters)
{
    const double reports = counters->motes.reports;
    return reports > 0 ? ((double)counters->head.measurements + counters->head.late) / reports : (double)NAN;
}

static double per_sample(const struct simulation_counters *counters, double value)
{
    return counters->samples > 0 ? value / (double)counters->samples : (double)NAN;
}

static double of_clusters(const struct simulation_counters *counters, uint32_t value)
{
    return counters->clusters.present ? value : (double)NAN;
}

static double of_princes(const struct simulation_counters *counters, uint32_t value)
{
    return counters->protocol.princes.located > 0 ? value : (double)NAN;
}

static double per_cluster(const struct simulation_counters *counters, double value)
{
    return value / of_princes(counters, counters->protocol.princes.located);
}

static double sum_of(const struct simulation_counters *counters, const enum mh_message_kind *kinds, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        sum += (double)counters->frames_sent[kinds[i]];
    }
    return sum;
}

/* What Han, Eqs. (2-14) to (2-16), count. */
static double messages_of_locating(const struct simulation_counters *counters)
{
    static const enum mh_message_kind kinds[] = {MH_MESSAGE_LOCATE, MH_MESSAGE_SOUND, MH_MESSAGE_COMPETE,
                                                 MH_MESSAGE_DETECTION, MH_MESSAGE_SUPPRESS};
    return sum_of(counters, kinds, sizeof kinds / sizeof kinds[0]);
}

/* ... and what they do not. */
static double messages_of_heads(const struct simulation_counters *counters)
{
    static const enum mh_message_kind kinds[] = {MH_MESSAGE_AWAKE, MH_MESSAGE_SUCCEED, MH_MESSAGE_FAIL};
    return sum_of(counters, kinds, sizeof kinds / sizeof kinds[0]);
}

static double of_bounds(const struct simulation_counters *counters, double value)
{
    return counters->bounds.apply ? value : (double)NAN;
}

static double of_sound(const struct simulation_counters *counters, double value)
{
    return counters->bounds.heard ? value : (double)NAN;
}

static double in_hindsight(const struct simulation_counters *counters, uint64_t value)
{
    return counters->bounds.apply && counters->bounds.follow ? (double)value : (double)NAN;
}

static double energy_mj(const struct simulation_counters *counters, int state, int cause)
{
    double sum = 0;
    for (int s = 0; s < ENERGY_STATES; s++) {
        for (int c = 0; c < ENERGY_CAUSES; c++) {
            if ((state == ANY || s == state) && (cause == ANY || c == cause)) {
                sum += counters->energy.joules[s][c];
            }
        }
    }
    return 1e3 * sum;
}

#define NAME(id, name, value, meaning) name,
const char *const total_names[TOTAL_COUNT] = {TOTALS(NAME)};

#define MEANING(id, name, value, meaning) meaning,
const char *const total_meanings[TOTAL_COUNT] = {TOTALS(MEANING)};

void totals_of(const struct simulation_counters *c, double values[TOTAL_COUNT])
{
#define VALUE(id, name, value, meaning) values[TOTAL_##id] = (double)(value);
    TOTALS(VALUE)
}
