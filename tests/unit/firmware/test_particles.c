#include "motehound/particles.h"
#include "port.h"
#include "unity.h"

#include <math.h>

#define R mh_real_from_float
#define F mh_real_to_float
#define PI 3.14159265f
#define UNIT (MH_REAL_FIXED ? 0.0079f : 1e-6f) /* m: of coordinates */

void setUp(void) {}
void tearDown(void) {}

static struct mh_particles set;
static struct mh_random draws;

static float squared(float a) { return a * a; }

static void begin(uint16_t count)
{
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_particles_init(&set, count, R(127.0f), R(0.1f)));
#if MH_REAL_FIXED
    TEST_ASSERT_EQUAL_UINT8(7, set.bits);
    set.centre.x = set.centre.y = 0;
#endif
    mh_random_init(&draws, 42);
}

static void put(uint16_t i, float x, float y)
{
#if MH_REAL_FIXED
    set.x[i] = (int16_t)(x * 128.0f);
    set.y[i] = (int16_t)(y * 128.0f);
#else
    set.x[i] = x;
    set.y[i] = y;
#endif
}

static float x_of(uint16_t i) { return F(mh_particles_place(&set, i).x); }
static float y_of(uint16_t i) { return F(mh_particles_place(&set, i).y); }
static mh_particle_weight weight(float w) { return (mh_particle_weight)(w * (float)MH_PARTICLE_WEIGHT_ONE); }
static float weight_of(uint16_t i) { return (float)set.weight[i] / (float)MH_PARTICLE_WEIGHT_ONE; }
static mh_particle_weight sum(float square_m2) { return mh_particles_sum(&set, mh_wide_mul(R(square_m2), R(1.0f))); }

/* particle i stands at (i, -i) */
static void give_weights(const float *weights, uint16_t count)
{
    begin(count);
    for (uint16_t i = 0; i < count; i++) {
        put(i, (float)i, -(float)i);
        set.weight[i] = weight(weights[i]);
    }
}

static void directions(void)
{
    for (int16_t i = -64; i <= 64; i++) {
        const float angle = PI * (float)i / 64.0f, tolerance = MH_REAL_FIXED ? 5e-4f : 3e-6f;
        const struct mh_vec2 direction = mh_direction(R(angle));
        TEST_ASSERT_FLOAT_WITHIN(tolerance, (float)cosf(angle), F(direction.x));
        TEST_ASSERT_FLOAT_WITHIN(tolerance, (float)sinf(angle), F(direction.y));
    }
}

#define ROUNDS 40

/* Uniform in area between radii a and b: r^2 is uniform from a^2 to b^2, the angle from the axis is uniform and independent. Means may be off by five
 * standard deviations. */
static void uniform_in_area(void)
{
    const struct mh_sector sectors[] = {{{R(5), R(-7)}, {R(0.6f), R(0.8f)}, R(1.0f), R(3.0f), R(10.0f)},
                                        {{0, 0}, {R(-1.0f), 0}, MH_PI, 0, R(50.0f)},
                                        {{0, 0}, {0, R(1.0f)}, R(0.1f), R(99.0f), R(100.0f)}};
    const float rounding = MH_REAL_FIXED ? 0.02f : 1e-4f;
    for (uint8_t s = 0; s < 3; s++) {
        const struct mh_sector *sector = &sectors[s];
        const float least = squared(F(sector->inner)), span = squared(F(sector->outer)) - least;
        const float axis_x = F(sector->axis.x), axis_y = F(sector->axis.y);
        begin(MH_PARTICLES_MAX);
        float squares = 0, angles = 0, angles_square = 0, products = 0;
        for (uint8_t round = 0; round < ROUNDS; round++) {
            mh_particles_draw(&set, 0, sector, &draws);
            for (uint16_t i = 0; i < set.count; i++) {
                const float dx = x_of(i) - F(sector->apex.x), dy = y_of(i) - F(sector->apex.y);
                const float along = dx * axis_x + dy * axis_y, across = dy * axis_x - dx * axis_y;
                const float u = (dx * dx + dy * dy - least) / span; /* 0 to 1 */
                const float angle = (float)atan2f(across, along) / F(sector->half_angle);
                TEST_ASSERT_FLOAT_WITHIN(0.5f + rounding, 0.5f, u);
                TEST_ASSERT_FLOAT_WITHIN(1.0f + rounding, 0.0f, angle);
                TEST_ASSERT_TRUE(set.weight[i] == 0);
                squares += u;
                angles += angle;
                angles_square += angle * angle;
                products += (u - 0.5f) * angle;
            }
        }
        const float n = (float)ROUNDS * MH_PARTICLES_MAX;
        TEST_ASSERT_FLOAT_WITHIN(5.0f * (float)sqrtf(1.0f / 12.0f / n), 0.5f, squares / n);
        TEST_ASSERT_FLOAT_WITHIN(5.0f * (float)sqrtf(1.0f / 3.0f / n), 0.0f, angles / n);
        TEST_ASSERT_FLOAT_WITHIN(5.0f * (float)sqrtf(4.0f / 45.0f / n), 1.0f / 3.0f, angles_square / n);
        TEST_ASSERT_FLOAT_WITHIN(5.0f * (float)sqrtf(1.0f / 36.0f / n), 0.0f, products / n);
    }
}

/* 91 and 7,854 m2 */
static void shares_of_an_area(void)
{
    const struct mh_sector part = {{0, 0}, {R(1.0f), 0}, R(1.0f), R(3.0f), R(10.0f)};
    const struct mh_sector all = {{0, 0}, {R(1.0f), 0}, MH_PI, 0, R(50.0f)};
    TEST_ASSERT_FLOAT_WITHIN(2e-3f, 2.0f * 91.0f / (2.0f * PI * 10.0f),
                             F(mh_wide_to_real(mh_sector_share(&part, R(2.0f), 10))));
    TEST_ASSERT_FLOAT_WITHIN(1e-2f, 25.0f, F(mh_wide_to_real(mh_sector_share(&all, R(1.0f), 50))));
}

static void a_point_is_a_sector(void)
{
    const struct mh_sector point = {{R(3), R(4)}, {R(1), 0}, 0, 0, 0};
    begin(5);
    mh_particles_draw(&set, 0, &point, &draws);
    for (uint16_t i = 0; i < 5; i++) {
        TEST_ASSERT_EQUAL_FLOAT(3.0f, x_of(i));
        TEST_ASSERT_EQUAL_FLOAT(4.0f, y_of(i));
    }
}

static void a_part_is_drawn_anew(void)
{
    const float weights[] = {1, 2, 3, 4};
    const struct mh_sector sector = {{R(100), R(100)}, {R(1), 0}, MH_PI, 0, R(1.0f)};
    const struct mh_vec2 station = {0, 0};
    give_weights(weights, 4);
    mh_particles_draw(&set, 2, &sector, &draws);
    mh_particles_add_range(&set, 2, station, R(0.0f), MH_PARTICLE_SUM_MAX);
    mh_particles_weigh(&set, 2, 0, R(100.0f));
    TEST_ASSERT_EQUAL_FLOAT(1.0f, x_of(1));
    TEST_ASSERT_EQUAL_FLOAT(2.0f, weight_of(1));
    TEST_ASSERT_TRUE(x_of(2) > 98.0f && x_of(3) > 98.0f);
    TEST_ASSERT_TRUE(weight_of(3) < 1.0f);
}

/* distances 5 and 13 from the station */
static void sums_of_squared_residuals(void)
{
    const struct mh_vec2 station = {R(1), R(2)};
    begin(2);
    put(0, 4, 6);
    put(1, 6, 14);
    set.weight[0] = set.weight[1] = 0;
    mh_particles_add_range(&set, 0, station, R(7.0f), MH_PARTICLE_SUM_MAX);
    mh_particles_add_range(&set, 0, station, R(-2.0f), MH_PARTICLE_SUM_MAX); /* noise may exceed the distance */
    TEST_ASSERT_TRUE(set.weight[0] == sum(4.0f + 49.0f));
    TEST_ASSERT_TRUE(set.weight[1] == sum(36.0f + 225.0f));
    TEST_ASSERT_TRUE(mh_particles_least(&set) == sum(53.0f));
    mh_particles_add_range(&set, 0, station, R(1e9f), MH_PARTICLE_SUM_MAX);
    TEST_ASSERT_TRUE(mh_particles_least(&set) < MH_PARTICLE_SUM_MAX);
    for (uint8_t i = 0; i < 20; i++) {
        mh_particles_add_range(&set, 0, station, R(1e30f), MH_PARTICLE_SUM_MAX);
    }
    TEST_ASSERT_TRUE(mh_particles_least(&set) == MH_PARTICLE_SUM_MAX);
    mh_particles_weigh(&set, 0, mh_particles_least(&set), R(5.0f));
    TEST_ASSERT_TRUE(set.weight[0] == 0);
    TEST_ASSERT_TRUE(set.weight[1] == 0);
}

/* Distances from all over the plane, against the hypotenuse of the library of mathematics. */
static void distances(void)
{
    begin(1);
    for (uint16_t i = 0; i < 300; i++) {
        const float angle = 0.7f * (float)i, radius = 0.38f * (float)i, x = radius * (float)cosf(angle),
                    y = radius * (float)sinf(angle);
        const struct mh_vec2 station = {R(x), R(y)};
        put(0, 0, 0);
        set.weight[0] = 0;
        mh_particles_add_range(&set, 0, station, R(radius + 10.0f), MH_PARTICLE_SUM_MAX);
        mh_particles_add_range(&set, 0, station, R(radius - 10.0f), MH_PARTICLE_SUM_MAX);
        mh_particle_weight expected = sum(200.0f);
        /* either residual is off by a unit and what the root leaves, with opposite signs, or both by a rounding of the range */
        const mh_particle_weight off = sum(MH_REAL_FIXED ? 40.0f * UNIT : 2e-3f);
        TEST_ASSERT_TRUE(set.weight[0] + off >= expected && set.weight[0] <= expected + off);
    }
}

static void worthless_ones_may_be_left(void)
{
    const struct mh_vec2 station = {R(1), R(2)};
    begin(2);
    put(0, 4, 6);
    put(1, 6, 100);
    set.weight[0] = 0;
    set.weight[1] = mh_particles_worthless(&set, sum(4.0f), R(2.0f)); /* exp(-81), 2^-16 */
    const mh_particle_weight sums = set.weight[1];
    mh_particles_add_range(&set, 0, station, R(7.0f), sums);
    TEST_ASSERT_TRUE(set.weight[0] == sum(4.0f) && set.weight[1] >= sums);
    mh_particles_weigh(&set, 0, sum(4.0f), R(2.0f));
    TEST_ASSERT_EQUAL_FLOAT(1.0f, weight_of(0));
    TEST_ASSERT_TRUE(set.weight[1] == 0);
    TEST_ASSERT_TRUE(mh_particles_worthless(&set, MH_PARTICLE_SUM_MAX, R(2.0f)) == MH_PARTICLE_SUM_MAX);
}

static void weights_of_sums(void)
{
    begin(5);
    const float far = MH_REAL_FIXED ? 30000.0f : 1e9f;
    set.weight[0] = sum(18);
    set.weight[1] = sum(26);
    set.weight[2] = MH_PARTICLE_SUM_MAX;
#if MH_REAL_FIXED
    set.weight[3] = MH_PARTICLE_SUM_MAX;
#else
    set.weight[3] = NAN;
#endif
    set.weight[4] = sum(far);
    TEST_ASSERT_TRUE(mh_particles_least(&set) == sum(18));
    mh_particles_weigh(&set, 0, sum(18), R(2.0f));
    TEST_ASSERT_EQUAL_FLOAT(1.0f, weight_of(0));
    TEST_ASSERT_FLOAT_WITHIN(MH_REAL_FIXED ? 5e-4f : 1e-6f, 0.36787944f, weight_of(1));
    for (uint8_t i = 2; i < 5; i++) {
        TEST_ASSERT_TRUE(set.weight[i] == 0);
    }
    set.weight[0] = 0;
    mh_particles_weigh(&set, 0, sum(far), R(2.0f));
    if (MH_REAL_FIXED) {
        TEST_ASSERT_EQUAL_FLOAT(32768.0f, weight_of(0)); /* the largest */
    } else {
        TEST_ASSERT_FLOAT_WITHIN(1e13f, 2.3538527e17f, weight_of(0)); /* exp(40) */
    }
}

/* Over all octaves, above and below the sum that has weight 1, for errors small and large. */
static void weights_against_the_exponential(void)
{
    const float sds[] = {0.1f, 0.5f, 1.7f, 10.0f};
    for (uint8_t k = 0; k < 4; k++) {
        const float twice_square = 2.0f * squared(sds[k]), least = 10.0f * twice_square;
        begin(1);
        for (int8_t i = -40; i <= 44; i++) {
            const mh_particle_weight at = sum(least + 0.25f * (float)i * twice_square);
            set.weight[0] = at;
            /* a sum is a whole number of units squared */
            const float exponent = ((float)at - (float)sum(least)) / ((float)sum(16.0f) / 16.0f) / twice_square;
            mh_particles_weigh(&set, 0, sum(least), R(sds[k]));
            const float expected = (float)expf(-exponent);
            TEST_ASSERT_FLOAT_WITHIN(MH_REAL_FIXED ? 1.5e-3f * expected + 2e-5f : 1e-4f * expected, expected,
                                     weight_of(0));
        }
    }
}

#define EFFECTIVE (MH_REAL_FIXED ? 5e-4f : 1e-5f)

static void effective_number(void)
{
    const float equal[] = {0.3f, 0.3f, 0.3f, 0.3f}, one[] = {0, 0, 9, 0}, mixed[] = {1, 2, 3}, none[] = {0, 0};
    give_weights(equal, 4);
    TEST_ASSERT_FLOAT_WITHIN(EFFECTIVE, 4.0f, F(mh_particles_effective(&set)));
    give_weights(one, 4);
    TEST_ASSERT_FLOAT_WITHIN(EFFECTIVE, 1.0f, F(mh_particles_effective(&set)));
    give_weights(mixed, 3);
    TEST_ASSERT_FLOAT_WITHIN(EFFECTIVE, 36.0f / 14.0f, F(mh_particles_effective(&set)));
    give_weights(none, 2);
    TEST_ASSERT_TRUE(mh_particles_effective(&set) == 0);
}

static void mean_and_covariance(void)
{
    const float weights[] = {1, 0, 3};
    struct mh_vec2 mean;
    struct mh_sym2 covariance;
    give_weights(weights, 3); /* (0, 0) once, (2, -2) three times */
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_particles_mean(&set, R(0.5f), &mean, &covariance));
    TEST_ASSERT_FLOAT_WITHIN(UNIT, 1.5f, F(mean.x));
    TEST_ASSERT_FLOAT_WITHIN(UNIT, -1.5f, F(mean.y));
    TEST_ASSERT_FLOAT_WITHIN(UNIT, 1.25f, F(covariance.xx));
    TEST_ASSERT_FLOAT_WITHIN(UNIT, -0.75f, F(covariance.xy));
    TEST_ASSERT_FLOAT_WITHIN(UNIT, 1.25f, F(covariance.yy));
}

static uint16_t redrawn;

static void redraw_worthless(void *context, struct mh_particles *particles, uint16_t from)
{
    (void)context;
    for (uint16_t i = from; i < particles->count; i++) {
        particles->weight[i] = 0;
        redrawn++;
    }
}

/* no function divides by a sum of 0 or lets NaN through */
static void weights_that_are_none(void)
{
    const float none[] = {0, 0, 0}, nan[] = {1, NAN, 1}, infinite[] = {1, INFINITY, 1};
    const float *const cases[] = {none, nan, infinite};
    for (uint8_t c = 0; c < (MH_REAL_FIXED ? 1 : 3); c++) { /* every weight in fixed point is a number */
        const enum mh_status expected = c == 0 ? MH_ERR_SINGULAR : MH_ERR_NOT_FINITE;
        struct mh_vec2 mean = {R(7), R(7)};
        struct mh_sym2 covariance = {R(7), R(7), R(7)};
        give_weights(cases[c], 3);
        redrawn = 0;
        TEST_ASSERT_EQUAL_INT(expected, mh_particles_mean(&set, R(1.0f), &mean, &covariance));
        TEST_ASSERT_EQUAL_INT(expected, mh_particles_resample(&set, &draws));
        TEST_ASSERT_EQUAL_INT(expected, mh_particles_reject(&set, &draws, redraw_worthless, NULL));
        TEST_ASSERT_EQUAL_FLOAT(7.0f, F(mean.x));
        TEST_ASSERT_EQUAL_FLOAT(7.0f, F(covariance.yy));
        TEST_ASSERT_EQUAL_UINT16(0, redrawn);
        for (uint16_t i = 0; i < 3; i++) {
            TEST_ASSERT_EQUAL_FLOAT((float)i, x_of(i));
        }
    }
}

/* Of four, weights 0.05, 0.8, 0 and 0.15 go on 0.2, 3.2, 0 and 0.6 times on average, and never more or less often than the integers around. */
static void resampling_is_systematic_and_unbiased(void)
{
    const float weights[] = {0.5f, 8.0f, 0.0f, 1.5f}, expected[] = {0.2f, 3.2f, 0.0f, 0.6f};
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
            TEST_ASSERT_EQUAL_FLOAT(1.0f, weight_of(i));
            TEST_ASSERT_EQUAL_FLOAT(-x_of(i), y_of(i));
            times[(uint8_t)x_of(i)]++;
        }
        for (uint8_t i = 0; i < 4; i++) {
            seen[i] = (uint16_t)(seen[i] + times[i]);
            TEST_ASSERT_FLOAT_WITHIN(0.999f, expected[i], (float)times[i]);
        }
    }
    for (uint8_t i = 0; i < 4; i++) { /* a count of 0 or 1 more has at most a standard deviation of 1/2 */
        TEST_ASSERT_FLOAT_WITHIN(5.0f * 0.5f / (float)sqrtf(REPEATS), expected[i], (float)seen[i] / REPEATS);
    }
}

static void the_only_one_goes_on(void)
{
    const float weights[] = {0, 0, 0, MH_REAL_FIXED ? 2e-5f : 1e-30f, 0};
    give_weights(weights, 5);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_particles_resample(&set, &draws));
    for (uint16_t i = 0; i < 5; i++) {
        TEST_ASSERT_EQUAL_FLOAT(3.0f, x_of(i));
    }
    give_weights(&weights[3], 1);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_particles_resample(&set, &draws));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_particles_reject(&set, &draws, redraw_worthless, NULL));
    TEST_ASSERT_EQUAL_FLOAT(0.0f, x_of(0));
}

static const struct mh_sector disc = {{0, 0}, {MH_REAL(1.0f), 0}, MH_REAL(3.14159265f), 0, MH_REAL(10.0f)};
static float (*weight_at)(float x);

static float half(float x) { return x > 0 ? 5.0f : 0.0f; }
static float slope(float x) { return 1.0f + x / 10.0f; }

static void redraw(void *context, struct mh_particles *particles, uint16_t from)
{
    mh_particles_draw(particles, from, context, &draws);
    for (uint16_t i = from; i < particles->count; i++) {
        particles->weight[i] = weight(weight_at(F(mh_particles_place(particles, i).x)));
    }
}

/* Uniform in a disc of radius R, weights 1 in one half of it: the mean is 4 R / (3 pi) from the centre, the variance R^2 / 4 less its square.
 * Weights 1 + x / R: R / 4. Rejection control must not move the mean, and leaves no worthless particle. */
static void rejection_control_is_unbiased(void)
{
    float (*const weights[])(float) = {half, slope};
    const float expected[] = {40.0f / (3.0f * PI), 2.5f};
    for (uint8_t w = 0; w < 2; w++) {
        weight_at = weights[w];
        begin(MH_PARTICLES_MAX);
        struct mh_sector region = disc;
        float total = 0;
        for (uint8_t round = 0; round < ROUNDS; round++) {
            redraw(&region, &set, 0);
            const mh_real before = mh_particles_effective(&set);
            TEST_ASSERT_EQUAL_INT(MH_OK, mh_particles_reject(&set, &draws, redraw, &region));
            TEST_ASSERT_TRUE(mh_particles_effective(&set) > before);
            struct mh_vec2 mean;
            struct mh_sym2 covariance;
            TEST_ASSERT_EQUAL_INT(MH_OK, mh_particles_mean(&set, 0, &mean, &covariance));
            total += F(mean.x);
        }
        const float n = (float)ROUNDS * MH_PARTICLES_MAX;
        TEST_ASSERT_FLOAT_WITHIN(5.0f * 5.0f / (float)sqrtf(n), expected[w], total / ROUNDS);
    }
}

/* the one good particle weighs as before, the others were drawn as often as is allowed */
static void redraws_are_bounded(void)
{
    const float weights[] = {0, 0, 6, 0};
    give_weights(weights, 4);
    redrawn = 0;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_particles_reject(&set, &draws, redraw_worthless, NULL));
    TEST_ASSERT_EQUAL_UINT16(3 * MH_PARTICLES_REDRAWS, redrawn);
    TEST_ASSERT_EQUAL_FLOAT(2.0f, x_of(0));
    TEST_ASSERT_EQUAL_FLOAT(6.0f, weight_of(0));
    TEST_ASSERT_EQUAL_FLOAT(0.0f, weight_of(3));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(directions);
    RUN_TEST(uniform_in_area);
    RUN_TEST(shares_of_an_area);
    RUN_TEST(a_point_is_a_sector);
    RUN_TEST(a_part_is_drawn_anew);
    RUN_TEST(sums_of_squared_residuals);
    RUN_TEST(distances);
    RUN_TEST(worthless_ones_may_be_left);
    RUN_TEST(weights_of_sums);
    RUN_TEST(weights_against_the_exponential);
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
