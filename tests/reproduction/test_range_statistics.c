/* The range tracker on its own model: is it as good as the bound allows, and does its covariance say the truth? */
#include "motehound/range.h"
#include "port.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void setUp(void) {}
void tearDown(void) {}

enum { ANCHORS = 4, STEPS = 300, SKIPPED = 50, RUNS = 200, INTERVAL = 100 };

static const double anchor_m[ANCHORS][3] = {{0, 0, 2.5}, {30, 0, 0.5}, {30, 30, 2.5}, {0, 30, 0.5}};
static const double range_sd = 0.15, acceleration_sd = 0.5, height = 1.0;

static uint64_t generator;

static double uniform(void) /* xorshift64*, in (0, 1) */
{
    generator ^= generator >> 12;
    generator ^= generator << 25;
    generator ^= generator >> 27;
    return ((double)((generator * 2685821657736338717u) >> 11) + 0.5) / 9007199254740992.0;
}

static double normal(void) { return sqrt(-2 * log(uniform())) * cos(6.283185307179586 * uniform()); }

static double slant(const double *anchor, double x, double y)
{
    return sqrt((x - anchor[0]) * (x - anchor[0]) + (y - anchor[1]) * (y - anchor[1]) +
                (height - anchor[2]) * (height - anchor[2]));
}

/* In double, with gradients at the true place: the posterior Cramer-Rao bound of Tichavsky, Muravchik and Nehorai, 1998, which for
 * a linear motion model and one given path is this Riccati recursion. */
static void bound_predict(double P[4][4], double dt)
{
    const double q = acceleration_sd * acceleration_sd;
    const double F[4][4] = {{1, 0, dt, 0}, {0, 1, 0, dt}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    double FP[4][4];
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            FP[i][j] = 0;
            for (int k = 0; k < 4; k++) {
                FP[i][j] += F[i][k] * P[k][j];
            }
        }
    }
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            P[i][j] = 0;
            for (int k = 0; k < 4; k++) {
                P[i][j] += FP[i][k] * F[j][k];
            }
        }
    }
    for (int i = 0; i < 2; i++) {
        P[i][i] += q * dt * dt * dt / 3;
        P[i][i + 2] += q * dt * dt / 2;
        P[i + 2][i] += q * dt * dt / 2;
        P[i + 2][i + 2] += q * dt;
    }
}

static void bound_update(double P[4][4], double hx, double hy)
{
    double Ph[4];
    for (int i = 0; i < 4; i++) {
        Ph[i] = P[i][0] * hx + P[i][1] * hy;
    }
    const double s = hx * Ph[0] + hy * Ph[1] + range_sd * range_sd;
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            P[i][j] -= Ph[i] * Ph[j] / s;
        }
    }
}

static double squares, bound, nees;
static int restarts;

static void run(uint64_t seed)
{
    generator = seed * 0x9e3779b97f4a7c15u + 1;
    struct mh_range state;
    const struct mh_range_config config = {.range_sd_m = (mh_real)range_sd,
                                           .acceleration_sd_mps2 = (mh_real)acceleration_sd,
                                           .speed_mps = 2.5f,
                                           .height_m = (mh_real)height};
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.init(&state, &config, INTERVAL));
    double x[4] = {10 + 10 * uniform(), 10 + 10 * uniform(), 0, 0};
    double P[4][4] = {{100, 0, 0, 0}, {0, 100, 0, 0}, {0, 0, 6.25, 0}, {0, 0, 0, 6.25}};
    const double dt = 0.001 * INTERVAL / ANCHORS;
    for (int step = 1; step <= STEPS; step++) {
        struct mh_measurement m[ANCHORS];
        memset(m, 0, sizeof m);
        for (int a = 0; a < ANCHORS; a++) { /* one after the other, evenly over the interval */
            const double q = acceleration_sd * acceleration_sd;
            for (int axis = 0; axis < 2; axis++) { /* an exact draw from the white acceleration */
                const double w = normal() * sqrt(q * dt);
                const double p = w * dt / 2 + normal() * sqrt(q * dt * dt * dt / 12);
                x[axis] += x[axis + 2] * dt + p;
                x[axis + 2] += w;
            }
            const double r = slant(anchor_m[a], x[0], x[1]);
            bound_predict(P, dt);
            bound_update(P, (x[0] - anchor_m[a][0]) / r, (x[1] - anchor_m[a][1]) / r);
            m[a].node = (mh_node_id)a;
            m[a].place.x_mm = (int32_t)(1000 * anchor_m[a][0]);
            m[a].place.y_mm = (int32_t)(1000 * anchor_m[a][1]);
            m[a].place.z_mm = (int32_t)(1000 * anchor_m[a][2]);
            m[a].time = (mh_tick)((step - 1) * INTERVAL + (a + 1) * INTERVAL / ANCHORS);
            m[a].value = mh_q20_from_real((mh_real)(r + range_sd * normal()));
        }
        struct mh_estimate e;
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.step(&state, (mh_tick)(step * INTERVAL), m, ANCHORS, &e));
        if (step <= SKIPPED) {
            continue;
        }
        restarts += (e.flags & MH_ESTIMATE_STARTED) != 0;
        const double ex = (double)e.position.x + 0.001 * e.origin.x_mm - x[0];
        const double ey = (double)e.position.y + 0.001 * e.origin.y_mm - x[1];
        const double xx = (double)e.covariance.xx, xy = (double)e.covariance.xy, yy = (double)e.covariance.yy;
        TEST_ASSERT_TRUE(xx > 0 && xx * yy > xy * xy);
        squares += ex * ex + ey * ey;
        bound += P[0][0] + P[1][1];
        nees += (yy * ex * ex - 2 * xy * ex * ey + xx * ey * ey) / (xx * yy - xy * xy);
    }
}

static void efficient_and_consistent(void)
{
    for (uint64_t seed = 1; seed <= RUNS; seed++) {
        run(seed);
    }
    const double count = (double)RUNS * (STEPS - SKIPPED);
    const double efficiency = bound / squares;
    char message[128];
    snprintf(message, sizeof message, "rmse %.4f m, bound %.4f m, mean NEES %.3f (2 is exact), %d restarts in %d runs",
             sqrt(squares / count), sqrt(bound / count), nees / count, restarts, RUNS);
    TEST_MESSAGE(message);
    /* errors are correlated over about a second, so the 50,000 of them are worth some 5,000 independent ones: 2 +- 3 x 0.03 */
    TEST_ASSERT_TRUE_MESSAGE(fabs(nees / count - 2) < 0.15, message);
    TEST_ASSERT_TRUE_MESSAGE(efficiency > 0.93 && efficiency < 1.07, message);
    TEST_ASSERT_EQUAL_INT(0, restarts);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(efficient_and_consistent);
    port_exit(UNITY_END() > 0);
    return 0;
}
