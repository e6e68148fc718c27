/* One step of a particle filter with Motehound's particles, as peers.py does it with other libraries. Prints a line of JSON with the same keys. */
#include "motehound/particles.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { PARTICLES = 200, STATIONS = 8, STEPS = 20000, WARM = 100, REPEATS = 5 };

#define SD_M 5.0f
#define STEP_RADIUS_M 6.0f /* of the disc that a particle moves in: a standard deviation of 3 m in each coordinate */
#define RING_M 40.0

static const double pi = 3.141592653589793;

static struct mh_vec2 station(int i)
{
    return (struct mh_vec2){(float)(RING_M * cos(2 * pi * i / STATIONS)), (float)(RING_M * sin(2 * pi * i / STATIONS))};
}

static struct mh_vec2 truth(int step)
{
    return (struct mh_vec2){(float)(10 * cos(0.2 * step)), (float)(10 * sin(0.2 * step))};
}

/* Approximately normal: the sum of twelve uniform numbers. */
static float noise(struct mh_random *random)
{
    float sum = -6;
    for (int i = 0; i < 12; i++) {
        sum += mh_random_unit(random);
    }
    return sum;
}

static void measure(int step, struct mh_random *random, float *ranges)
{
    const struct mh_vec2 target = truth(step);
    for (int i = 0; i < STATIONS; i++) {
        const struct mh_vec2 from = station(i);
        ranges[i] = hypotf(target.x - from.x, target.y - from.y) + SD_M * noise(random);
    }
}

static double now_us(void)
{
    struct timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return 1e6 * (double)time.tv_sec + 1e-3 * (double)time.tv_nsec;
}

static void must(enum mh_status status)
{
    if (status != MH_OK) {
        fprintf(stderr, "particle_step: status %d\n", (int)status);
        exit(1);
    }
}

struct bootstrap {
    struct mh_particles particles, moves;
    struct mh_vec2 stations[STATIONS];
    struct mh_random random;
};

static void bootstrap_begin(struct bootstrap *filter, uint32_t seed)
{
    const struct mh_sector start = {truth(0), {1, 0}, (float)pi, 0, STEP_RADIUS_M};
    mh_random_init(&filter->random, seed);
    filter->particles.count = filter->moves.count = PARTICLES;
    mh_particles_draw(&filter->particles, 0, &start, &filter->random);
    for (int i = 0; i < STATIONS; i++) {
        filter->stations[i] = station(i);
    }
}

static struct mh_vec2 bootstrap_step(struct bootstrap *filter, const float *ranges)
{
    const struct mh_sector disc = {{0, 0}, {1, 0}, (float)pi, 0, STEP_RADIUS_M};
    struct mh_particles *particles = &filter->particles;
    mh_particles_draw(&filter->moves, 0, &disc, &filter->random);
    for (int i = 0; i < PARTICLES; i++) {
        particles->x[i] += filter->moves.x[i];
        particles->y[i] += filter->moves.y[i];
        particles->weight[i] = 0;
    }
    for (int i = 0; i < STATIONS; i++) {
        mh_particles_add_range(particles, 0, filter->stations[i], ranges[i], MH_PARTICLE_SUM_MAX);
    }
    mh_particles_weigh(particles, 0, mh_particles_least(particles), SD_M);
    struct mh_vec2 mean;
    struct mh_sym2 covariance;
    must(mh_particles_mean(particles, 0, &mean, &covariance));
    must(mh_particles_resample(particles, &filter->random));
    return mean;
}

int main(void)
{
    static struct bootstrap filter;
    static float ranges[STEPS][STATIONS];
    static struct mh_vec2 means[STEPS];
    double best_us = HUGE_VAL, square = 0;
    for (uint32_t repeat = 0; repeat < REPEATS; repeat++) {
        struct mh_random random;
        mh_random_init(&random, 100 + repeat);
        for (int n = 0; n < STEPS; n++) {
            measure(n, &random, ranges[n]);
        }
        bootstrap_begin(&filter, repeat);
        const double began_us = now_us();
        for (int n = 0; n < STEPS; n++) {
            means[n] = bootstrap_step(&filter, ranges[n]);
        }
        best_us = fmin(best_us, (now_us() - began_us) / STEPS);
        square = 0;
        for (int n = WARM; n < STEPS; n++) {
            const struct mh_vec2 target = truth(n);
            const float x = means[n].x - target.x, y = means[n].y - target.y;
            square += (double)(x * x + y * y);
        }
    }
    printf("{\"name\": \"Motehound\", \"us_per_step\": %.1f, \"rmse_m\": %.2f}\n", best_us,
           sqrt(square / (STEPS - WARM)));
    return 0;
}
