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

static double of_bounds(const struct simulation_counters *counters, double value)
{
    return counters->bounds.apply ? value : (double)NAN;
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
