#include "energy/profile.h"

#include <stddef.h>
#include <string.h>

static const struct energy_profile profiles[] = {
    {
        .name = "mica2",
        .source = "Zhou et al. 2013, Table 2: CC1000, ATmega128L",
        .volts = 3,
        .sleep = 0.5,
        .listen = 3,
        .receive = 10,
        .transmit = {{0, 27}},
        .transmit_count = 1,
        .cpu = 8,
        .cpu_idle = 0.015,
        .sensing = 10,
        .cpu_mhz = 7.3728,
    },
    {
        .name = "micaz",
        .source = "CC2420 data sheet (SWRS041), electrical specifications and Table 9; "
                  "Crossbow MPR/MIB User's Manual 7430-0021-06, Tables 6-2 and 6-3: ATmega128L, sensor board",
        .volts = 3,
        .sleep = 0.02,
        .listen = 18.8,
        .receive = 18.8,
        .transmit = {{-25, 8.5}, {-15, 9.9}, {-10, 11.2}, {-7, 12.5}, {-5, 13.9}, {-3, 15.2}, {-1, 16.5}, {0, 17.4}},
        .transmit_count = 8,
        .cpu = 12,
        .cpu_idle = 0.01,
        .sensing = 5,
        .cpu_mhz = 7.3728,
    },
};

enum { PROFILES = sizeof profiles / sizeof profiles[0] };

const struct energy_profile *energy_profile_at(int index)
{
    return index >= 0 && index < PROFILES ? &profiles[index] : NULL;
}

const struct energy_profile *energy_profile_find(const char *name)
{
    for (int i = 0; i < PROFILES; i++) {
        if (strcmp(profiles[i].name, name) == 0) {
            return &profiles[i];
        }
    }
    return NULL;
}

double energy_profile_transmit(const struct energy_profile *profile, double dbm)
{
    const int last = profile->transmit_count - 1;
    if (dbm <= profile->transmit[0].dbm) {
        return profile->transmit[0].current;
    }
    for (int i = 1; i <= last; i++) {
        const double low = profile->transmit[i - 1].dbm, high = profile->transmit[i].dbm;
        if (dbm <= high) {
            const double share = (dbm - low) / (high - low);
            return profile->transmit[i - 1].current +
                   share * (profile->transmit[i].current - profile->transmit[i - 1].current);
        }
    }
    return profile->transmit[last].current;
}

/* Cycles of an ATmega128; other processors are charged as if they needed as many. */
struct work {
    const char *tracker;
    double cycles, cycles_per_measurement;
    double cycles_per_draw, cycles_per_draw_and_measurement; /* of a particle */
    double draws_per_particle;                               /* in a step, on average over the nominal scenario */
};

#include "energy/measured.h"

/* As the published comparisons take it: the filters with particles, and `centroid`, in a fixed point of their own; the others as they were measured when the comparisons were made:
 * `range` over 4 to 12 ranges of one instant; `gas` with 15 to 24 sensors known, the others of a leak with nine samples; `cv_ukf` with four ranges; `acoustic`, `dm` and `ml` with six
 * nodes that hear one target. */
static const struct work assumed_steps[] = {
    {"luo", 479150, 0, 0, 0, 0},      {"diffusion", 25268318, 0, 0, 0, 0}, {"range", 111000, 4000, 0, 0, 0},
    {"pftl", 0, 0, 350, 300, 4.3},    {"msl", 0, 0, 150, 100, 10.7},       {"centroid", 200, 40, 0, 0, 0},
    {"gas", 110000000, 0, 0, 0, 0},   {"gas_small", 0, 279000, 0, 0, 0},   {"gas_ekf", 0, 41000, 0, 0, 0},
    {"gas_ukf", 0, 105000, 0, 0, 0},  {"cv_ukf", 0, 171000, 0, 0, 0},      {"cv_ekf", 0, 151000, 0, 0, 0},
    {"acoustic", 418000, 0, 0, 0, 0}, {"dm", 162000, 0, 0, 0, 0},          {"ml", 0, 5236000, 0, 0, 0},
};
enum {
    MEASURED_STEPS = sizeof measured_steps / sizeof measured_steps[0],
    ASSUMED_STEPS = sizeof assumed_steps / sizeof assumed_steps[0]
};

/* A sample is converted, differenced and judged: 0.5 ms at 7.3728 MHz. A report that is heard and sent on: half of it for each of the two. */
#define ASSUMED_SAMPLE_CYCLES 3686
#define ASSUMED_FRAME_CYCLES 5077
#define SENSING_US 1000

static const struct {
    double sample, frame;
} cycles_of[] = {[ENERGY_CPU_MEASURED] = {MEASURED_SAMPLE_CYCLES, MEASURED_FRAME_CYCLES},
                 [ENERGY_CPU_ASSUMED] = {ASSUMED_SAMPLE_CYCLES, ASSUMED_FRAME_CYCLES}};

static const struct work *work_of(enum energy_cpu cpu, const char *tracker)
{
    const struct work *steps = cpu == ENERGY_CPU_MEASURED ? measured_steps : assumed_steps;
    const int count = cpu == ENERGY_CPU_MEASURED ? MEASURED_STEPS : ASSUMED_STEPS;
    for (int i = 0; i < count; i++) {
        if (strcmp(steps[i].tracker, tracker) == 0) {
            return &steps[i];
        }
    }
    return NULL;
}

static uint64_t microseconds(const struct energy_profile *profile, double cycles)
{
    return (uint64_t)(cycles / profile->cpu_mhz + 0.5);
}

uint64_t energy_sensing_us(void) { return SENSING_US; }

uint64_t energy_sample_us(const struct energy_profile *profile, enum energy_cpu cpu)
{
    return microseconds(profile, cycles_of[cpu].sample);
}

uint64_t energy_frame_us(const struct energy_profile *profile, enum energy_cpu cpu)
{
    return microseconds(profile, cycles_of[cpu].frame);
}

uint32_t energy_tracker_draws(enum energy_cpu cpu, const char *tracker, int particles)
{
    const struct work *work = work_of(cpu, tracker);
    return work != NULL ? (uint32_t)(work->draws_per_particle * particles) : 0;
}

uint64_t energy_tracker_us(const struct energy_profile *profile, enum energy_cpu cpu, const char *tracker,
                           int measurements, uint32_t draws)
{
    const struct work *work = work_of(cpu, tracker);
    if (work == NULL) {
        return 0;
    }
    return microseconds(profile,
                        work->cycles + work->cycles_per_measurement * measurements +
                            draws * (work->cycles_per_draw + work->cycles_per_draw_and_measurement * measurements));
}
