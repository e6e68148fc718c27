/* One step of an unscented Kalman filter with Motehound, as peers.py does it with other libraries: 4 states, a prediction by sigma points, 4 ranges
 * stacked. Prints a line of JSON with the same keys. */
#include "motehound/geometry.h"
#include "motehound/random.h"
#include "motehound/ukf.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { STATIONS = 4, STEPS = 20000, WARM = 100, REPEATS = 5 };

#define SD_M 0.15f
#define INTERVAL_S 0.5f
#define INTENSITY 0.02f /* of the white acceleration, (m/s2)^2 s */
#define RING_M 40.0

static const double pi = 3.141592653589793;

static struct mh_vec2 truth(int step)
{
    return (struct mh_vec2){(float)(10 * cos(0.05 * step)), (float)(10 * sin(0.05 * step))};
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

static double now_us(void)
{
    struct timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return 1e6 * (double)time.tv_sec + 1e-3 * (double)time.tv_nsec;
}

static enum mh_status move(const void *context, const mh_real *x, mh_real *next, mh_real *jacobian)
{
    (void)context;
    (void)jacobian;
    next[0] = x[0] + INTERVAL_S * x[1];
    next[1] = x[1];
    next[2] = x[2] + INTERVAL_S * x[3];
    next[3] = x[3];
    return MH_OK;
}

static enum mh_status predict_range(const void *context, uint16_t k, const mh_real *x, mh_real *range,
                                    mh_real *gradient)
{
    const struct mh_vec2 *stations = context;
    const float dx = x[0] - stations[k].x, dy = x[2] - stations[k].y;
    (void)gradient;
    *range = sqrtf(dx * dx + dy * dy);
    return MH_OK;
}

int main(void)
{
    static float ranges[STEPS][STATIONS];
    static struct mh_vec2 means[STEPS];
    const float cross = INTENSITY * INTERVAL_S * INTERVAL_S / 2;
    const float place = INTENSITY * INTERVAL_S * INTERVAL_S * INTERVAL_S / 3, speed = INTENSITY * INTERVAL_S;
    const mh_real Q[10] = {place, cross, speed, 0, 0, place, 0, 0, cross, speed};
    const mh_real variance[STATIONS] = {SD_M * SD_M, SD_M * SD_M, SD_M * SD_M, SD_M * SD_M};
    const struct mh_ukf_weights weights = {0.5f, 2, -1};
    const struct mh_transition transition = {NULL, move};
    struct mh_vec2 stations[STATIONS];
    double best_us = HUGE_VAL, square = 0;
    for (int i = 0; i < STATIONS; i++) {
        const double angle = 2 * pi * i / STATIONS;
        stations[i] = (struct mh_vec2){(float)(RING_M * cos(angle)), (float)(RING_M * sin(angle))};
    }
    for (uint32_t repeat = 0; repeat < REPEATS; repeat++) {
        struct mh_random random;
        struct mh_gaussian estimate = {4, {10, 0, 0, 1}, {1, 0, 1, 0, 0, 1, 0, 0, 0, 1}};
        enum mh_status status = MH_OK;
        mh_random_init(&random, repeat);
        for (int n = 0; n < STEPS; n++) {
            const struct mh_vec2 target = truth(n);
            for (int i = 0; i < STATIONS; i++) {
                ranges[n][i] = hypotf(target.x - stations[i].x, target.y - stations[i].y) + SD_M * noise(&random);
            }
        }
        const double began_us = now_us();
        for (int n = 0; n < STEPS && status == MH_OK; n++) {
            const struct mh_observations observations = {STATIONS, ranges[n], variance, stations, predict_range, NULL};
            status = mh_ukf_predict(&estimate, &weights, &transition, Q);
            if (status == MH_OK) {
                status = mh_ukf_update_stacked(&estimate, &weights, &observations);
            }
            means[n] = (struct mh_vec2){estimate.x[0], estimate.x[2]};
        }
        best_us = fmin(best_us, (now_us() - began_us) / STEPS);
        if (status != MH_OK) {
            fprintf(stderr, "ukf_step: status %d\n", (int)status);
            return 1;
        }
        square = 0;
        for (int n = WARM; n < STEPS; n++) {
            const struct mh_vec2 target = truth(n);
            const float x = means[n].x - target.x, y = means[n].y - target.y;
            square += (double)(x * x + y * y) / (STEPS - WARM);
        }
    }
    printf("{\"name\": \"Motehound\", \"us_per_step\": %.2f, \"rmse_m\": %.3f}\n", best_us, sqrt(square));
    return 0;
}
