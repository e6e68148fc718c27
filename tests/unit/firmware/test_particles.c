#include "motehound/particles.h"
#include "port.h"
#include "unity.h"

#include <math.h>

void setUp(void) {}
void tearDown(void) {}

static struct mh_particles set;
static struct mh_random draws;

static void begin(uint16_t count)
{
    set.count = count;
    mh_random_init(&draws, 42);
}

/* particle i stands at (i, -i) */
static void give_weights(const mh_real *weights, uint16_t count)
{
    begin(count);
    for (uint16_t i = 0; i < count; i++) {
        set.x[i] = i;
        set.y[i] = -(mh_real)i;
        set.weight[i] = weights[i];
    }
}

static void directions(void)
{
    for (int16_t i = -64; i <= 64; i++) {
        const mh_real angle = MH_PI * (mh_real)i / 64.0f;
        const struct mh_vec2 direction = mh_direction(angle);
        TEST_ASSERT_FLOAT_WITHIN(3e-6f, cosf(angle), direction.x);
        TEST_ASSERT_FLOAT_WITHIN(3e-6f, sinf(angle), direction.y);
    }
}

#define ROUNDS 40

/* Uniform in area between radii a and b: r^2 is uniform from a^2 to b^2, the angle from the axis is uniform and independent. Means may be off by five
 * standard deviations. */
static void uniform_in_area(void)
{
    const struct mh_sector sectors[] = {{{5, -7}, {0.6f, 0.8f}, 1.0f, 3.0f, 10.0f},
                                        {{0, 0}, {-1.0f, 0.0f}, MH_PI, 0.0f, 50.0f},
                                        {{0, 0}, {0.0f, 1.0f}, 0.1f, 99.0f, 100.0f}};
    for (uint8_t s = 0; s < 3; s++) {
        const struct mh_sector *sector = &sectors[s];
        const mh_real least = mh_squared(sector->inner), span = mh_squared(sector->outer) - least;
        begin(MH_PARTICLES_MAX);
        mh_real squares = 0, angles = 0, angles_square = 0, products = 0;
        for (uint8_t round = 0; round < ROUNDS; round++) {
            mh_particles_draw(&set, 0, sector, &draws);
            for (uint16_t i = 0; i < set.count; i++) {
                const mh_real dx = set.x[i] - sector->apex.x, dy = set.y[i] - sector->apex.y;
                const mh_real along = dx * sector->axis.x + dy * sector->axis.y;
                const mh_real across = dy * sector->axis.x - dx * sector->axis.y;
                const mh_real u = (dx * dx + dy * dy - least) / span; /* 0 to 1 */
                const mh_real angle = mh_atan2(across, along) / sector->half_angle;
                TEST_ASSERT_TRUE(mh_within(u, -1e-4f, 1.0001f) && mh_within(angle, -1.0001f, 1.0001f));
                TEST_ASSERT_EQUAL_FLOAT(0.0f, set.weight[i]);
                squares += u;
                angles += angle;
                angles_square += angle * angle;
                products += (u - 0.5f) * angle;
            }
        }
        const mh_real n = (mh_real)ROUNDS * MH_PARTICLES_MAX;
        TEST_ASSERT_FLOAT_WITHIN(5.0f * mh_sqrt(1.0f / 12.0f / n), 0.5f, squares / n);
        TEST_ASSERT_FLOAT_WITHIN(5.0f * mh_sqrt(1.0f / 3.0f / n), 0.0f, angles / n);
        TEST_ASSERT_FLOAT_WITHIN(5.0f * mh_sqrt(4.0f / 45.0f / n), 1.0f / 3.0f, angles_square / n);
        TEST_ASSERT_FLOAT_WITHIN(5.0f * mh_sqrt(1.0f / 36.0f / n), 0.0f, products / n);
    }
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 91.0f, mh_sector_area(&sectors[0]));
    TEST_ASSERT_FLOAT_WITHIN(0.1f, 7853.98f, mh_sector_area(&sectors[1]));
}

static void a_point_is_a_sector(void)
{
    const struct mh_sector point = {{3, 4}, {1, 0}, 0.0f, 0.0f, 0.0f};
    begin(5);
    mh_particles_draw(&set, 0, &point, &draws);
    for (uint16_t i = 0; i < 5; i++) {
        TEST_ASSERT_EQUAL_FLOAT(3.0f, set.x[i]);
        TEST_ASSERT_EQUAL_FLOAT(4.0f, set.y[i]);
    }
}

static void a_part_is_drawn_anew(void)
{
    const mh_real weights[] = {1, 2, 3, 4};
    const struct mh_sector sector = {{100, 100}, {1, 0}, MH_PI, 0.0f, 1.0f};
    const struct mh_vec2 station = {0, 0};
    give_weights(weights, 4);
    mh_particles_draw(&set, 2, &sector, &draws);
    mh_particles_add_range(&set, 2, station, 0.0f);
    mh_particles_weigh(&set, 2, 0.0f, 1e3f);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, set.x[1]);
    TEST_ASSERT_EQUAL_FLOAT(2.0f, set.weight[1]);
    TEST_ASSERT_TRUE(set.x[2] > 98.0f && set.x[3] > 98.0f);
    TEST_ASSERT_TRUE(set.weight[3] < 1.0f);
}

/* distances 5 and 13 from the station */
static void sums_of_squared_residuals(void)
{
    const struct mh_vec2 station = {1, 2};
    begin(2);
    set.x[0] = 4;
    set.y[0] = 6;
    set.x[1] = 6;
    set.y[1] = 14;
    set.weight[0] = set.weight[1] = 0;
    mh_particles_add_range(&set, 0, station, 7.0f);
    mh_particles_add_range(&set, 0, station, -2.0f); /* noise may exceed the distance */
    TEST_ASSERT_EQUAL_FLOAT(4.0f + 49.0f, set.weight[0]);
    TEST_ASSERT_EQUAL_FLOAT(36.0f + 225.0f, set.weight[1]);
    TEST_ASSERT_EQUAL_FLOAT(53.0f, mh_particles_least(&set));
    mh_particles_add_range(&set, 0, station, 1e9f);
    TEST_ASSERT_TRUE(mh_finite(mh_particles_least(&set)));
    mh_particles_add_range(&set, 0, station, 1e30f);
    TEST_ASSERT_FALSE(mh_finite(mh_particles_least(&set)));
    mh_particles_weigh(&set, 0, mh_particles_least(&set), 5.0f);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, set.weight[0]);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, set.weight[1]);
}

static void weights_of_sums(void)
{
    const mh_real sums[] = {18, 26, NAN, INFINITY, 1e9f, -1e9f};
    give_weights(sums, 5);
    TEST_ASSERT_EQUAL_FLOAT(18.0f, mh_particles_least(&set));
    give_weights(sums, 6);
    mh_particles_weigh(&set, 0, 18.0f, 2.0f);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, set.weight[0]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.36787944f, set.weight[1]);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, set.weight[2]);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, set.weight[3]);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, set.weight[4]);
    TEST_ASSERT_FLOAT_WITHIN(1e13f, 2.3538527e17f, set.weight[5]); /* exp(40) */
}

static void effective_number(void)
{
    const mh_real equal[] = {0.3f, 0.3f, 0.3f, 0.3f}, one[] = {0, 0, 9, 0}, mixed[] = {1, 2, 3}, none[] = {0, 0};
    give_weights(equal, 4);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 4.0f, mh_particles_effective(&set));
    give_weights(one, 4);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1.0f, mh_particles_effective(&set));
    give_weights(mixed, 3);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 36.0f / 14.0f, mh_particles_effective(&set));
    give_weights(none, 2);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, mh_particles_effective(&set));
}

static void mean_and_covariance(void)
{
    const mh_real weights[] = {1, 0, 3};
    struct mh_vec2 mean;
    struct mh_sym2 covariance;
    give_weights(weights, 3); /* (0, 0) once, (2, -2) three times */
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_particles_mean(&set, 0.5f, &mean, &covariance));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1.5f, mean.x);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, -1.5f, mean.y);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1.25f, covariance.xx);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, -0.75f, covariance.xy);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1.25f, covariance.yy);
}

static uint16_t redrawn;

static void redraw_worthless(void *context, struct mh_particles *particles, uint16_t from)
{
    (void)context;
    for (uint16_t i = from; i < particles->count; i++) {
        particles->weight[i] = 0.0f;
        redrawn++;
    }
}

/* no function divides by a sum of 0 or lets NaN through */
static void weights_that_are_none(void)
{
    const mh_real none[] = {0, 0, 0}, nan[] = {1, NAN, 1}, infinite[] = {1, INFINITY, 1};
    const mh_real *const cases[] = {none, nan, infinite};
    for (uint8_t c = 0; c < 3; c++) {
        const enum mh_status expected = c == 0 ? MH_ERR_SINGULAR : MH_ERR_NOT_FINITE;
        struct mh_vec2 mean = {7, 7};
        struct mh_sym2 covariance = {7, 7, 7};
        give_weights(cases[c], 3);
        redrawn = 0;
        TEST_ASSERT_EQUAL_INT(expected, mh_particles_mean(&set, 1.0f, &mean, &covariance));
        TEST_ASSERT_EQUAL_INT(expected, mh_particles_resample(&set, &draws));
        TEST_ASSERT_EQUAL_INT(expected, mh_particles_reject(&set, &draws, redraw_worthless, NULL));
        TEST_ASSERT_EQUAL_FLOAT(7.0f, mean.x);
        TEST_ASSERT_EQUAL_FLOAT(7.0f, covariance.yy);
        TEST_ASSERT_EQUAL_UINT16(0, redrawn);
        for (uint16_t i = 0; i < 3; i++) {
            TEST_ASSERT_EQUAL_FLOAT((mh_real)i, set.x[i]);
        }
    }
}

/* Of four, weights 0.05, 0.8, 0 and 0.15 go on 0.2, 3.2, 0 and 0.6 times on average, and never more or less often than the integers around. */
static void resampling_is_systematic_and_unbiased(void)
{
    const mh_real weights[] = {0.5f, 8.0f, 0.0f, 1.5f}, expected[] = {0.2f, 3.2f, 0.0f, 0.6f};
    enum { REPEATS = 2000 };
    uint16_t seen[4] = {0};
    give_weights(weights, 4);
    for (uint16_t repeat = 0; repeat < REPEATS; repeat++) {
        const struct mh_random going_on = draws;
        give_weights(weights, 4);
        draws = going_on;
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_particles_resample(&set, &draws));
        uint16_t times[4] = {0};
        for (uint8_t i = 0; i < 4; i++) {
            TEST_ASSERT_EQUAL_FLOAT(1.0f, set.weight[i]);
            TEST_ASSERT_EQUAL_FLOAT(-set.x[i], set.y[i]);
            times[(uint8_t)set.x[i]]++;
        }
        for (uint8_t i = 0; i < 4; i++) {
            seen[i] = (uint16_t)(seen[i] + times[i]);
            TEST_ASSERT_FLOAT_WITHIN(0.999f, expected[i], (mh_real)times[i]);
        }
    }
    for (uint8_t i = 0; i < 4; i++) { /* a count of 0 or 1 more has at most a standard deviation of 1/2 */
        TEST_ASSERT_FLOAT_WITHIN(5.0f * 0.5f / mh_sqrt(REPEATS), expected[i], (mh_real)seen[i] / REPEATS);
    }
}

static void the_only_one_goes_on(void)
{
    const mh_real weights[] = {0, 0, 0, 1e-30f, 0};
    give_weights(weights, 5);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_particles_resample(&set, &draws));
    for (uint16_t i = 0; i < 5; i++) {
        TEST_ASSERT_EQUAL_FLOAT(3.0f, set.x[i]);
    }
    give_weights(&weights[3], 1);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_particles_resample(&set, &draws));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_particles_reject(&set, &draws, redraw_worthless, NULL));
    TEST_ASSERT_EQUAL_FLOAT(0.0f, set.x[0]);
}

static const struct mh_sector disc = {{0, 0}, {1, 0}, MH_PI, 0.0f, 10.0f};
static mh_real (*weight_at)(mh_real x);

static mh_real half(mh_real x) { return x > 0 ? 5.0f : 0.0f; }
static mh_real slope(mh_real x) { return 1.0f + x / 10.0f; }

static void redraw(void *context, struct mh_particles *particles, uint16_t from)
{
    mh_particles_draw(particles, from, context, &draws);
    for (uint16_t i = from; i < particles->count; i++) {
        particles->weight[i] = weight_at(particles->x[i]);
    }
}

/* Uniform in a disc of radius R, weights 1 in one half of it: the mean is 4 R / (3 pi) from the centre, the variance R^2 / 4 less its square.
 * Weights 1 + x / R: R / 4. Rejection control must not move the mean, and leaves no worthless particle. */
static void rejection_control_is_unbiased(void)
{
    mh_real (*const weights[])(mh_real) = {half, slope};
    const mh_real expected[] = {40.0f / (3.0f * MH_PI), 2.5f};
    for (uint8_t w = 0; w < 2; w++) {
        weight_at = weights[w];
        begin(MH_PARTICLES_MAX);
        struct mh_sector region = disc;
        mh_real sum = 0;
        for (uint8_t round = 0; round < ROUNDS; round++) {
            redraw(&region, &set, 0);
            const mh_real before = mh_particles_effective(&set);
            TEST_ASSERT_EQUAL_INT(MH_OK, mh_particles_reject(&set, &draws, redraw, &region));
            TEST_ASSERT_TRUE(mh_particles_effective(&set) > before);
            struct mh_vec2 mean;
            struct mh_sym2 covariance;
            TEST_ASSERT_EQUAL_INT(MH_OK, mh_particles_mean(&set, 0.0f, &mean, &covariance));
            sum += mean.x;
        }
        const mh_real n = (mh_real)ROUNDS * MH_PARTICLES_MAX;
        TEST_ASSERT_FLOAT_WITHIN(5.0f * 5.0f / mh_sqrt(n), expected[w], sum / ROUNDS);
    }
}

/* the one good particle weighs as before, the others were drawn as often as is allowed */
static void redraws_are_bounded(void)
{
    const mh_real weights[] = {0, 0, 6, 0};
    give_weights(weights, 4);
    redrawn = 0;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_particles_reject(&set, &draws, redraw_worthless, NULL));
    TEST_ASSERT_EQUAL_UINT16(3 * MH_PARTICLES_REDRAWS, redrawn);
    TEST_ASSERT_EQUAL_FLOAT(2.0f, set.x[0]);
    TEST_ASSERT_EQUAL_FLOAT(6.0f, set.weight[0]);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, set.weight[3]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(directions);
    RUN_TEST(uniform_in_area);
    RUN_TEST(a_point_is_a_sector);
    RUN_TEST(a_part_is_drawn_anew);
    RUN_TEST(sums_of_squared_residuals);
    RUN_TEST(weights_of_sums);
    RUN_TEST(effective_number);
    RUN_TEST(mean_and_covariance);
    RUN_TEST(weights_that_are_none);
    RUN_TEST(resampling_is_systematic_and_unbiased);
    RUN_TEST(the_only_one_goes_on);
    RUN_TEST(rejection_control_is_unbiased);
    RUN_TEST(redraws_are_bounded);
    port_exit(UNITY_END() > 0);
    return 0;
}
