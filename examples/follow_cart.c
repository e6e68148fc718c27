/* A cart drives round in a hall. Three beacons measure its distance four times a second, a camera in the middle its bearing; now and then a reading is no
 * number. An unscented Kalman filter follows it: one function says how a cart moves, one what a sensor sees of it. */
#include "motehound/geometry.h"
#include "motehound/ukf.h"
#include <math.h>
#include <stdio.h>

enum { EAST, NORTH, HEADING, SPEED, STATES }; /* m, m, rad from east, m/s */

/* Straight on for an interval: next = f(x), and its Jacobian for those who want it (mh_ekf_predict). */
static enum mh_status drive(const void *context, const mh_real *x, mh_real *next, mh_real *F)
{
    const mh_real interval_s = *(const mh_real *)context;
    const mh_real east = interval_s * cosf(x[HEADING]), north = interval_s * sinf(x[HEADING]);
    next[EAST] = x[EAST] + x[SPEED] * east;
    next[NORTH] = x[NORTH] + x[SPEED] * north;
    next[HEADING] = x[HEADING];
    next[SPEED] = x[SPEED];
    for (int i = 0; F && i < STATES * STATES; i++) {
        F[i] = i % (STATES + 1) == 0 ? 1 : 0;
    }
    if (F) {
        F[STATES * EAST + HEADING] = -x[SPEED] * north;
        F[STATES * EAST + SPEED] = east;
        F[STATES * NORTH + HEADING] = x[SPEED] * east;
        F[STATES * NORTH + SPEED] = north;
    }
    return MH_OK;
}

struct sensor {
    struct mh_vec2 at;
    bool is_camera;
};

/* What sensor k sees, and its gradient for those who want it (mh_ekf_update). */
static enum mh_status see(const void *context, uint16_t k, const mh_real *x, mh_real *z, mh_real *gradient)
{
    const struct sensor *sensor = (const struct sensor *)context + k;
    const mh_real dx = x[EAST] - sensor->at.x, dy = x[NORTH] - sensor->at.y, square = dx * dx + dy * dy;
    *z = sensor->is_camera ? mh_atan2(dy, dx) : mh_sqrt(square);
    if (gradient) {
        gradient[EAST] = sensor->is_camera ? -dy / square : dx / *z;
        gradient[NORTH] = sensor->is_camera ? dx / square : dy / *z;
        gradient[HEADING] = gradient[SPEED] = 0;
    }
    return MH_OK;
}

/* Two bearings are never more than half a turn apart. */
static mh_real wrap(const void *context, uint16_t k, mh_real difference)
{
    const struct sensor *sensor = (const struct sensor *)context + k;
    return sensor->is_camera ? remainderf(difference, 2 * MH_PI) : difference;
}

int main(void)
{
    enum { SENSORS = 4, STEPS = 240 };
    const struct sensor sensors[SENSORS] = {{{0, 0}, false}, {{40, 0}, false}, {{0, 40}, false}, {{20, 20}, true}};
    const mh_real variance[SENSORS] = {0.04f, 0.04f, 0.04f, 4e-4f}; /* 20 cm, 0.02 rad */
    const mh_real interval_s = 0.25f;
    const mh_real Q[MH_PACKED_SIZE(STATES)] = {1e-6f, 0, 1e-6f, 0, 0, 0.01f, 0, 0, 0, 0.01f}; /* it steers by 0.1 rad */
    const struct mh_ukf_weights weights = {0.5f, 2, 0};
    const struct mh_transition transition = {&interval_s, drive};
    mh_real z[SENSORS];
    const struct mh_observations observations = {SENSORS, z, variance, sensors, see, wrap};

    /* where it may be at first: somewhere in the hall, heading anywhere */
    struct mh_gaussian cart = {STATES, {20, 20, 0, 1}, {100, 0, 100, 0, 0, 3, 0, 0, 0, 1}};
    mh_real truth[STATES], square = 0;
    unsigned refused = 0, noise = 1;
    for (int step = 0; step < STEPS; step++) {
        /* the hall: a circle of 12 m at 1.2 m/s, and sensors with uniform noise of those variances */
        const mh_real angle = 0.1f * interval_s * (mh_real)step;
        truth[EAST] = 20 + 12 * cosf(angle);
        truth[NORTH] = 20 + 12 * sinf(angle);
        for (uint16_t k = 0; k < SENSORS; k++) {
            noise = noise * 1664525u + 1013904223u;
            see(sensors, k, truth, &z[k], NULL);
            z[k] += mh_sqrt(3 * variance[k]) * ((mh_real)(noise >> 8) / 8388608.0f - 1);
        }
        z[step % SENSORS] = step % 50 == 49 ? (mh_real)NAN : z[step % SENSORS];

        /* the filter: an update that is refused leaves the estimate as it was */
        if (mh_ukf_predict(&cart, &weights, &transition, Q) != MH_OK) {
            return 1;
        }
        refused += mh_ukf_update(&cart, &weights, &observations) != MH_OK;
        square += step < 20 ? 0 : mh_squared(cart.x[EAST] - truth[EAST]) + mh_squared(cart.x[NORTH] - truth[NORTH]);
    }
    printf("cart at %.1f %.1f m, estimated at %.1f %.1f m, speed %.1f +- %.1f m/s\n", (double)truth[EAST],
           (double)truth[NORTH], (double)cart.x[EAST], (double)cart.x[NORTH], (double)cart.x[SPEED],
           (double)mh_sqrt(cart.P[MH_PACKED(SPEED, SPEED)]));
    printf("off by %.2f m, root mean square; %u of %d updates refused\n", (double)mh_sqrt(square / (STEPS - 20)),
           refused, STEPS);
    return 0;
}
