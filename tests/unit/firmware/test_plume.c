#include "motehound/plume.h"
#include "port.h"
#include "unity.h"

#include <math.h>
#include <stddef.h>

void setUp(void) {}
void tearDown(void) {}

static struct mh_plume blowing(mh_real wind_mps, mh_real angle)
{
    const struct mh_plume plume = {30, wind_mps, {cosf(angle), sinf(angle)}};
    return plume;
}

/* Model and Jacobian with respect to place and rate, computed with 64 bits */
static void known_answers(void)
{
    static const struct {
        struct mh_vec2 sensor, source;
        mh_real rate, wind_mps, angle, c, x, y, per_rate;
    } known[] = {
        {{475, 112}, {50, 0}, 30, 1, 0, 2.84331426e-4f, 4.69122312e-7f, 1.37245575e-6f, 9.47771422e-6f},
        {{450, 0}, {50, 0}, 30, 1, 0, 3.97887358e-4f, 9.94718394e-7f, 0, 1.32629119e-5f},
        {{250, -150}, {50, 0}, 30, 1, 0, 2.76673813e-4f, -3.68898417e-8f, -3.43075528e-6f, 9.22246042e-6f},
        {{60, 10}, {50, 0}, 30, 1, 0, 1.05032416e-2f, 4.73889944e-4f, 6.48943971e-4f, 3.50108054e-4f},
        {{50.3f, 0.2f}, {50, 0}, 30, 1, 0, 1.57308925e-1f, -2.62181541e-3f, 0, 5.24363083e-3f},
        {{20, 40}, {50, 0}, 30, 1, 0, 8.39055750e-4f, -3.24434890e-5f, 2.46123020e-5f, 2.79685250e-5f},
        {{500, 200}, {50, 0}, 30, 1, 0, 1.59313426e-4f, 6.67835371e-8f, 1.20978102e-6f, 5.31044754e-6f},
        {{300, 150}, {60, -20}, 45, 2, 0.7f, 7.84326744e-4f, 3.51428809e-6f, -1.89305335e-7f, 1.74294832e-5f},
        {{100, -80}, {60, -20}, 45, 2, 0.7f, 2.28730626e-4f, 1.57269382e-7f, -1.38947895e-5f, 5.08290280e-6f},
        {{40, -10}, {60, -20}, 45, 2, 0.7f, 3.77170712e-3f, -3.59477556e-4f, 5.06660846e-5f, 8.38157138e-5f},
    };
    for (unsigned i = 0; i < sizeof known / sizeof known[0]; i++) {
        const struct mh_plume plume = blowing(known[i].wind_mps, known[i].angle);
        mh_real c;
        struct mh_vec2 slope;
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_model(&plume, known[i].sensor, known[i].source, 0, &c, &slope));
        TEST_ASSERT_FLOAT_WITHIN(1e-4f * known[i].per_rate, known[i].per_rate, c);
        TEST_ASSERT_FLOAT_WITHIN(1e-4f * known[i].c, known[i].c, known[i].rate * c);
        TEST_ASSERT_FLOAT_WITHIN(1e-4f * mh_abs(known[i].x), known[i].x, known[i].rate * slope.x);
        TEST_ASSERT_FLOAT_WITHIN(1e-4f * mh_abs(known[i].y), known[i].y, known[i].rate * slope.y);
    }
}

/* Fisher's information of place and rate in six samples of standard deviation 1e-4, computed with 64 bits */
static void known_information(void)
{
    static const mh_real known[] = {5.22954724e-4f, 5.85214202e-5f, 1.02901798e-4f,
                                    7.17761297e-3f, 7.92087374e-4f, 9.87473768e-2f}; /* packed */
    const struct mh_plume plume = blowing(1, 0);
    const struct mh_vec2 source = {50, 0};
    mh_real sum[6] = {0};
    for (int k = 0; k < 6; k++) {
        const struct mh_vec2 sensor = {430 + 12 * (mh_real)k, 30 * (mh_real)cos(1.3 * k)};
        mh_real c;
        struct mh_vec2 slope;
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_model(&plume, sensor, source, 0, &c, &slope));
        const mh_real h[] = {3e5f * slope.x, 3e5f * slope.y, 1e4f * c};
        for (int j = 0, at = 0; j < 3; j++) {
            for (int i = 0; i <= j; i++) {
                sum[at++] += h[i] * h[j];
            }
        }
    }
    for (int i = 0; i < 6; i++) {
        TEST_ASSERT_FLOAT_WITHIN(2e-4f * known[i], known[i], sum[i]);
    }
}

/* Whatever is released leaves downwind, through any plane across the wind, by wind and by diffusion; through a plane upwind, in all nothing. The
 * plume is round about its axis, of which half is above the ground. */
static void what_is_released_passes_every_plane(void)
{
    static const mh_real planes_m[] = {-60, 3, 50, 200};
    const struct mh_plume plume = blowing(2, 0.6f);
    const struct mh_vec2 w = plume.downwind, source = {7, -3};
    for (unsigned i = 0; i < sizeof planes_m / sizeof planes_m[0]; i++) {
        mh_real passing = 0;
        mh_real edge = 0.1f;
        for (int ring = 0; ring < 300; ring++) {
            const mh_real width = 0.03f * edge, radius = edge + 0.5f * width;
            const struct mh_vec2 sensor = {source.x + planes_m[i] * w.x - radius * w.y,
                                           source.y + planes_m[i] * w.y + radius * w.x};
            mh_real c;
            struct mh_vec2 slope;
            TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_model(&plume, sensor, source, 0, &c, &slope));
            /* the slope is the source's, the sensor's has the other sign */
            const mh_real flux = plume.wind_mps * c + plume.diffusion_m2ps * (slope.x * w.x + slope.y * w.y);
            passing += flux * MH_PI * radius * width;
            edge += width;
        }
        TEST_ASSERT_FLOAT_WITHIN(3e-3f, planes_m[i] > 0 ? 1 : 0, passing);
    }
}

static mh_real at(const struct mh_plume *plume, mh_real x, mh_real y, mh_real spread)
{
    const struct mh_vec2 sensor = {40, 25}, source = {x, y};
    mh_real c = 0;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_model(plume, sensor, source, spread, &c, NULL));
    return c;
}

static void gradient_is_the_slope(void)
{
    static const mh_real spreads_m2[] = {0, 900};
    const mh_real h = 0.05f;
    for (int i = 0; i < 24; i++) {
        const struct mh_plume plume = blowing(1.5f, (mh_real)i * (MH_PI / 12));
        const mh_real spread = spreads_m2[i % 2];
        const struct mh_vec2 sensor = {40, 25}, source = {20, 10};
        mh_real c;
        struct mh_vec2 slope;
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_model(&plume, sensor, source, spread, &c, &slope));
        const mh_real x = (at(&plume, 20 + h, 10, spread) - at(&plume, 20 - h, 10, spread)) / (2 * h);
        const mh_real y = (at(&plume, 20, 10 + h, spread) - at(&plume, 20, 10 - h, spread)) / (2 * h);
        TEST_ASSERT_FLOAT_WITHIN(2e-3f * c / 10, x, slope.x);
        TEST_ASSERT_FLOAT_WITHIN(2e-3f * c / 10, y, slope.y);
    }
}

/* (K, u) -> 2 (K, u) dilutes twofold and changes nothing else */
static void only_the_ratio_of_wind_and_diffusion_shapes_it(void)
{
    const struct mh_plume plume = blowing(1, 0.3f);
    struct mh_plume twice = plume;
    twice.diffusion_m2ps *= 2;
    twice.wind_mps *= 2;
    TEST_ASSERT_FLOAT_WITHIN(1e-9f, at(&plume, 10, 20, 0), 2 * at(&twice, 10, 20, 0));
}

static void next_to_the_source_it_stays_finite(void)
{
    const struct mh_plume plume = blowing(1, 0);
    const struct mh_vec2 place = {5, 5};
    mh_real c;
    struct mh_vec2 slope;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_model(&plume, place, place, 0, &c, &slope));
    TEST_ASSERT_FLOAT_WITHIN(1e-7f, mh_exp(-1.0f / 60) / (60 * MH_PI), c);
    TEST_ASSERT_FLOAT_WITHIN(1e-9f, -c / 60, slope.x);
    TEST_ASSERT_EQUAL_FLOAT(0, slope.y);
}

static void bad_input_changes_nothing(void)
{
    const struct mh_plume plume = blowing(1, 0);
    const struct mh_vec2 place = {5, 5}, bad = {NAN, 0}, far = {1e30f, 0};
    mh_real c = 77;
    struct mh_vec2 slope = {78, 79};
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_plume_model(&plume, place, bad, 0, &c, &slope));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_plume_model(&plume, bad, place, 0, &c, &slope));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_plume_model(&plume, far, place, 0, &c, &slope));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_plume_model(&plume, place, place, INFINITY, &c, &slope));
    TEST_ASSERT_EQUAL_FLOAT(77, c);
    TEST_ASSERT_EQUAL_FLOAT(78, slope.x);
    TEST_ASSERT_EQUAL_FLOAT(79, slope.y);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(known_answers);
    RUN_TEST(known_information);
    RUN_TEST(what_is_released_passes_every_plane);
    RUN_TEST(gradient_is_the_slope);
    RUN_TEST(only_the_ratio_of_wind_and_diffusion_shapes_it);
    RUN_TEST(next_to_the_source_it_stays_finite);
    RUN_TEST(bad_input_changes_nothing);
    port_exit(UNITY_END() > 0);
    return 0;
}
