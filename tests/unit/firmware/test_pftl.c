#include "motehound/pftl.h"
#include "port.h"
#include "unity.h"

#include <math.h>
#include <string.h>

#define R mh_real_from_float
#define F mh_real_to_float

void setUp(void) {}
void tearDown(void) {}

#define INTERVAL 2000
#define SPACING 30 /* m: nine nodes within the sensing range */
#define NODES 16

static float squared(float a) { return a * a; }

static struct mh_pftl pftl, heir;
static struct mh_measurement set[NODES];
static struct mh_estimate estimate;
static struct mh_random noise;

static const struct mh_place corner = {900000000, -900000000, 0};

static struct mh_pftl_config nominal(void)
{
    struct mh_pftl_config config;
    mh_pftl_config_default(&config);
    config.particles = 25; /* half the default: the emulators are slow */
    return config;
}

static void begin(const struct mh_pftl_config *config)
{
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_pftl.init(&pftl, config, INTERVAL));
    mh_random_init(&noise, 3);
}

static void put(size_t i, float node_x, float node_y, float range)
{
    const struct mh_vec2 at = {R(node_x), R(node_y)};
    memset(&set[i], 0, sizeof set[i]);
    set[i].node = (mh_node_id)i;
    set[i].place = mh_place_from_offset(&corner, at);
    set[i].value = mh_q20_from_real(R(range));
}

/* What the nodes of a grid measure of a target at (x, y), m from the corner: uniform noise of standard deviation `sd`. Returns how many do. */
static size_t sense(float x, float y, float sd)
{
    size_t n = 0;
    const int32_t column = (int32_t)(x / SPACING), row = (int32_t)(y / SPACING);
    for (int32_t i = column - 2; i <= column + 3; i++) {
        for (int32_t j = row - 2; j <= row + 3; j++) {
            const float node_x = (float)(i * SPACING), node_y = (float)(j * SPACING);
            const float distance = (float)sqrtf(squared(x - node_x) + squared(y - node_y));
            if (distance <= 50.0f && n < NODES) {
                put(n++, node_x, node_y, distance + sd * 3.4641f * (F(mh_random_unit(&noise)) - 0.5f));
            }
        }
    }
    return n;
}

static enum mh_status step(mh_tick time, size_t count)
{
    return mh_tracker_pftl.step(&pftl, time, set, count, &estimate);
}

/* a place of the estimate, m from the corner */
static struct mh_vec2 from_corner(struct mh_vec2 position)
{
    const struct mh_vec2 origin = mh_place_relative(&estimate.origin, &corner);
    const struct mh_vec2 place = {mh_add(origin.x, position.x), mh_add(origin.y, position.y)};
    return place;
}

static float error_of(struct mh_vec2 position, float x, float y)
{
    const struct mh_vec2 at = from_corner(position);
    return (float)sqrtf(squared(F(at.x) - x) + squared(F(at.y) - y));
}

static void assert_covariance(void)
{
    const struct mh_sym2 c = estimate.covariance;
    TEST_ASSERT_TRUE(c.xx > 0 && c.yy > 0 && F(c.xx) * F(c.yy) > squared(F(c.xy)) && mh_finite(c.xx) &&
                     mh_finite(c.yy));
}

/* (100, 100) and on at (3.5, 2.5) m/s, one step each interval, the clock wrapping on the way. Returns the mean error. */
static float follow(mh_tick start, uint16_t from, uint16_t to, float sd)
{
    float sum = 0;
    for (uint16_t i = from; i < to; i++) {
        const float x = 100 + 7.0f * (float)i, y = 100 + 5.0f * (float)i;
        const size_t n = sense(x, y, sd);
        TEST_ASSERT_EQUAL_INT(MH_OK, step(start + (mh_tick)i * INTERVAL, n));
        TEST_ASSERT_EQUAL_UINT16(n, estimate.measurements);
        assert_covariance();
        sum += error_of(estimate.position, x, y);
    }
    return sum / (float)(to - from);
}

static void begins_at_the_centroid(void)
{
    const struct mh_pftl_config config = nominal();
    begin(&config);
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(0, 0));
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_pftl.predict(&pftl, 0, &estimate));
    put(0, 10, 20, 3);
    put(1, 20, 40, 3);
    put(2, 60, 30, 3);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(INTERVAL, 3));
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.0f, error_of(estimate.position, 30, 30));
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_STARTED | MH_ESTIMATE_REFRESHED, estimate.flags);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, F(estimate.stored_velocity.x));
    TEST_ASSERT_EQUAL_UINT32(0, pftl.draws);
    /* the second is always stored: it gives the velocity */
    TEST_ASSERT_EQUAL_INT(MH_OK, step(2 * INTERVAL, 3));
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_REFRESHED, estimate.flags);
    TEST_ASSERT_TRUE(pftl.draws >= 25);
}

/* with exact ranges the error is what N particles leave of the region: A / (pi N) = 250 m2 / 79 is the square of the distance to the nearest */
static void follows_a_straight_line(void)
{
    struct mh_pftl_config config = nominal();
    config.range_sd_m = R(1.0f);
    begin(&config);
    follow(UINT32_MAX - 5000, 0, 3, 0.0f);
    TEST_ASSERT_TRUE(follow(UINT32_MAX - 5000, 3, 18, 0.0f) < 2.0f);
    TEST_ASSERT_FLOAT_WITHIN(1.5f, 3.5f, F(estimate.velocity.x));
    TEST_ASSERT_FLOAT_WITHIN(1.5f, 2.5f, F(estimate.velocity.y));
}

static void options_follow_too(void)
{
    struct mh_pftl_config config = nominal();
    config.systematic = true;
    begin(&config);
    follow(0, 0, 3, 5.0f);
    TEST_ASSERT_TRUE(follow(0, 3, 15, 5.0f) < 6.0f);
    config = nominal();
    config.literal = true;
    begin(&config);
    follow(0, 0, 3, 5.0f);
    TEST_ASSERT_TRUE(follow(0, 3, 15, 5.0f) < 25.0f);
}

/* whoever is told what is refreshed has what is stored, and that is within the tolerance */
static void stored_is_what_a_follower_has(float tolerance)
{
    struct mh_pftl_config config = nominal();
    config.tolerance_m = R(tolerance);
    begin(&config);
    struct mh_followed follower = {0};
    uint16_t reports = 0;
    for (uint16_t i = 0; i < 17; i++) {
        const float x = 100 + 7.0f * (float)i;
        TEST_ASSERT_EQUAL_INT(MH_OK, step((mh_tick)i * INTERVAL, i % 8 == 7 ? 0 : sense(x, 110, 5.0f)));
        if (estimate.flags & MH_ESTIMATE_REFRESHED) {
            TEST_ASSERT_FALSE(estimate.flags & MH_ESTIMATE_COASTED);
            TEST_ASSERT_EQUAL_INT(
                MH_OK, mh_followed_report(&follower, estimate.time, estimate.position, estimate.stored_velocity));
            reports++;
        }
        struct mh_vec2 expected;
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_followed_predict(&follower, estimate.time, &expected));
        TEST_ASSERT_EQUAL_FLOAT(F(expected.x), F(estimate.stored.x));
        TEST_ASSERT_EQUAL_FLOAT(F(expected.y), F(estimate.stored.y));
        const float off = (float)sqrtf(squared(F(estimate.stored.x) - F(estimate.position.x)) +
                                       squared(F(estimate.stored.y) - F(estimate.position.y)));
        TEST_ASSERT_TRUE(off <= tolerance);
    }
    if (tolerance == 0.0f) {
        TEST_ASSERT_EQUAL_UINT16(15, reports); /* all but those without a measurement */
    } else {
        TEST_ASSERT_TRUE(reports >= 2 && reports < 15);
    }
}

static void tolerance_bounds_what_is_stored(void)
{
    stored_is_what_a_follower_has(5.0f);
    stored_is_what_a_follower_has(0.0f);
}

static void coasts_without_a_measurement(void)
{
    const struct mh_pftl_config config = nominal();
    begin(&config);
    follow(0, 0, 10, 1.0f);
    const struct mh_estimate last = estimate;
    const uint32_t draws = pftl.draws;
    for (uint16_t i = 1; i <= 3; i++) {
        struct mh_estimate predicted;
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_pftl.predict(&pftl, last.time + (mh_tick)i * INTERVAL, &predicted));
        TEST_ASSERT_EQUAL_INT(MH_OK, step(last.time + (mh_tick)i * INTERVAL, 0));
        TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_COASTED, estimate.flags);
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, F(last.stored.x) + 2.0f * (float)i * F(last.velocity.x),
                                 F(estimate.position.x));
        TEST_ASSERT_EQUAL_FLOAT(F(predicted.position.y), F(estimate.position.y));
        TEST_ASSERT_EQUAL_FLOAT(0.0f, F(estimate.covariance.xx));
    }
    TEST_ASSERT_EQUAL_UINT32(draws, pftl.draws);
}

/* One range draws a circle, two leave two places: where the target can have moved to settles it to what it can move in an interval. */
static void one_or_two_ranges(void)
{
    for (size_t n = 1; n <= 2; n++) {
        struct mh_pftl_config config = nominal();
        config.range_sd_m = R(1.0f);
        begin(&config);
        follow(0, 0, 5, 1.0f);
        for (uint16_t i = 5; i < 8; i++) {
            const float x = 100 + 7.0f * (float)i, y = 100 + 5.0f * (float)i;
            (void)sense(x, y, 1.0f);
            TEST_ASSERT_EQUAL_INT(MH_OK, step((mh_tick)i * INTERVAL, n));
            TEST_ASSERT_EQUAL_UINT16(n, estimate.measurements);
            assert_covariance();
            TEST_ASSERT_TRUE(error_of(estimate.position, x, y) < 15.0f);
        }
    }
}

/* nodes on the line y = 0: what lies above it and what lies below give the same ranges, but the track does not change sides */
static void nodes_on_a_line(void)
{
    struct mh_pftl_config config = nominal();
    config.range_sd_m = R(1.0f);
    begin(&config);
    put(0, 0, 30, 1);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(0, 1));
    for (uint16_t i = 1; i < 12; i++) {
        const float x = 9.0f * (float)i, y = 30;
        size_t n = 0;
        for (int8_t j = 0; j < 8; j++) {
            const float distance = (float)sqrtf(squared(x - 20.0f * (float)j) + y * y);
            if (distance <= 50.0f) {
                put(n++, 20.0f * (float)j, 0, distance);
            }
        }
        TEST_ASSERT_EQUAL_INT(MH_OK, step((mh_tick)i * INTERVAL, n));
        assert_covariance();
        TEST_ASSERT_TRUE(error_of(estimate.position, x, y) < 10.0f);
    }
}

static void ranges_that_cannot_be(void)
{
    const struct mh_pftl_config config = nominal();
    begin(&config);
    follow(0, 0, 10, 1.0f);
    /* on top of a node; noise makes its range negative, which is as good as any */
    put(0, 170, 150, -3);
    put(1, 200, 150, 29);
    put(2, 170, 180, 31);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(10 * INTERVAL, 3));
    TEST_ASSERT_EQUAL_UINT16(3, estimate.measurements);
    TEST_ASSERT_TRUE(error_of(estimate.position, 170, 150) < 8.0f);
    /* saturated, and as far below 0: left out */
    put(0, 177, 155, 1e9f);
    put(1, 207, 155, 30);
    put(2, 177, 185, 30);
    put(3, 147, 155, 30);
    put(4, 170, 150, -1e9f);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(11 * INTERVAL, 5));
    TEST_ASSERT_EQUAL_UINT16(3, estimate.measurements);
    TEST_ASSERT_TRUE(error_of(estimate.position, 177, 155) < 8.0f);
    put(0, 177, 155, 1e9f);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(12 * INTERVAL, 1));
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_COASTED, estimate.flags);
    TEST_ASSERT_EQUAL_UINT16(0, estimate.measurements);
}

/* nor are their nodes among those about which the target is looked for */
static void nodes_whose_ranges_cannot_be(void)
{
    const struct mh_pftl_config config = nominal();
    begin(&config);
    for (uint8_t i = 0; i < 2; i++) {
        put(0, 5000, 5000, 1e9f);
        put(1, 20, 30, 11);
        put(2, 40, 30, 11);
        mh_tracker_pftl.restart(&pftl);
        TEST_ASSERT_EQUAL_INT(MH_OK, step((1 + (mh_tick)i) * INTERVAL, 3));
        TEST_ASSERT_EQUAL_UINT16(2, estimate.measurements);
        TEST_ASSERT_TRUE(error_of(estimate.position, 30, 30) < (i == 0 ? 1e-3f : 50.0f));
    }
}

/* Ranges that contradict each other give all particles a likelihood of 0 in mh_real; the best of them is still the best. */
static void no_particle_fits(void)
{
    struct mh_pftl_config config = nominal();
    const float scale = MH_REAL_FIXED ? 0.25f : 1.0f;
    config.range_sd_m = R(MH_REAL_FIXED ? 0.13f : 1e-3f);
    config.sensing_range_m = R(1000.0f * scale);
    begin(&config);
    for (uint8_t i = 0; i < 2; i++) {
        put(0, 0, 0, 900 * scale);
        put(1, 10, 0, 0);
        put(2, 0, 10, 500 * scale);
        TEST_ASSERT_EQUAL_INT(MH_OK, step((mh_tick)i * INTERVAL, 3));
        assert_covariance();
        TEST_ASSERT_TRUE(error_of(estimate.position, 0, 0) <= 1020.0f * scale);
    }
}

static void numbers_of_particles_at_their_limits(void)
{
    struct mh_pftl_config config = nominal();
    config.particles = 1;
    begin(&config);
    follow(0, 0, 3, 5.0f);
    TEST_ASSERT_TRUE(follow(0, 3, 15, 5.0f) < 60.0f); /* the region is all it knows */
    config.particles = MH_PARTICLES_MAX;
    begin(&config);
    follow(0, 0, 3, 5.0f);
    TEST_ASSERT_TRUE(follow(0, 3, 6, 5.0f) < 6.0f);
}

static void finds_a_target_that_jumps(void)
{
    const struct mh_pftl_config config = nominal();
    begin(&config);
    follow(0, 0, 10, 5.0f);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(10 * INTERVAL, sense(500, 50, 5.0f)));
    TEST_ASSERT_TRUE(error_of(estimate.position, 500, 50) < 15.0f);
    /* the jump is no velocity: at most the class's largest speed */
    const float speed = (float)sqrtf(squared(F(estimate.velocity.x)) + squared(F(estimate.velocity.y)));
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 1.6f * 4.4704f, speed);
}

static void restarts_about_the_nodes(void)
{
    const struct mh_pftl_config config = nominal();
    begin(&config);
    follow(0, 0, 10, 5.0f);
    mh_tracker_pftl.restart(&pftl);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(10 * INTERVAL, 0)); /* still to come */
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_COASTED, estimate.flags);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(11 * INTERVAL, sense(20, 40, 5.0f)));
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_REFRESHED, estimate.flags);
    TEST_ASSERT_TRUE(error_of(estimate.position, 20, 40) < 15.0f);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, F(estimate.stored_velocity.x));
    TEST_ASSERT_EQUAL_FLOAT(0.0f, F(estimate.stored_velocity.y));
    TEST_ASSERT_EQUAL_INT(MH_OK, step(12 * INTERVAL, sense(29, 40, 5.0f)));
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_REFRESHED, estimate.flags);
    TEST_ASSERT_TRUE(estimate.stored_velocity.x != 0.0f);
}

static void is_handed_over(void)
{
    const struct mh_pftl_config config = nominal();
    uint8_t bytes[MH_TRACK_BYTES_MAX];
    size_t length = 0;
    begin(&config);
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_pftl.save(&pftl, bytes, &length));
    for (uint16_t steps = 1; steps <= 10; steps += 9) { /* at rest, moving */
        begin(&config);
        follow(7000, 0, steps, 5.0f);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_pftl.save(&pftl, bytes, &length));
        TEST_ASSERT_EQUAL_size_t(steps == 1 ? 12 : 20, length);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_pftl.init(&heir, &config, INTERVAL));
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_pftl.load(&heir, bytes, length));
        const mh_tick later = 7000 + (mh_tick)steps * INTERVAL;
        struct mh_estimate here, there;
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_pftl.predict(&pftl, later, &here));
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_pftl.predict(&heir, later, &there));
        const struct mh_vec2 between = mh_place_relative(&there.origin, &here.origin);
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, F(here.position.x), F(between.x) + F(there.position.x));
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, F(here.position.y), F(between.y) + F(there.position.y));
        TEST_ASSERT_EQUAL_FLOAT(F(here.velocity.x), F(there.velocity.x));
        pftl = heir;
        TEST_ASSERT_TRUE(follow(7000, steps, (uint16_t)(steps + 1), 5.0f) < 15.0f);
        TEST_ASSERT_FALSE(estimate.flags & MH_ESTIMATE_STARTED);
    }
}

/* time 1 s, at (0.258, -1) m, 2 m/s towards x: the bytes are those of every machine */
static void known_bytes(void)
{
    static const uint8_t written[] = {0, 0, 3, 0xE8, 0, 0, 1, 2, 0xFF, 0xFF, 0xFC, 0x18, 0x40, 0, 0, 0, 0, 0, 0, 0};
    const struct mh_pftl_config config = nominal();
    begin(&config);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_pftl.load(&pftl, written, sizeof written));
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, step(1000, 0));
    TEST_ASSERT_EQUAL_INT(MH_OK, step(3000, 0));
    const struct mh_place at = mh_place_from_offset(&estimate.origin, estimate.position);
    TEST_ASSERT_EQUAL_INT32(4258, at.x_mm);
    TEST_ASSERT_EQUAL_INT32(-1000, at.y_mm);
    uint8_t bytes[MH_TRACK_BYTES_MAX];
    size_t length;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_pftl.save(&pftl, bytes, &length));
    TEST_ASSERT_EQUAL_size_t(sizeof written, length);
    TEST_ASSERT_EQUAL_UINT8_ARRAY(written, bytes, sizeof written);
    /* what no save writes */
    const struct {
        uint8_t at, value;
    } faults[] = {{4, 0x7F} /* outside the map */, {12, 0x7F} /* too fast */, {16, 0xFF} /* faster */};
    begin(&config);
    for (uint8_t i = 0; i < 3; i++) {
        memcpy(bytes, written, sizeof written);
        bytes[faults[i].at] = faults[i].value;
        TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_tracker_pftl.load(&pftl, bytes, sizeof written));
    }
    const uint8_t nan[] = {0, 0, 3, 0xE8, 0, 0, 0, 0, 0, 0, 0, 0, 0x7F, 0xC0, 0, 0, 0, 0, 0, 0};
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_tracker_pftl.load(&pftl, nan, sizeof nan));
    for (size_t i = 0; i <= sizeof written; i++) {
        if (i != 12 && i != 20) {
            TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_tracker_pftl.load(&pftl, written, i));
        }
    }
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(1000, 0));
}

static void refuses_what_is_out_of_range(void)
{
    const struct mh_pftl_config good = nominal();
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_pftl.init(NULL, &good, INTERVAL));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_pftl.init(&pftl, NULL, INTERVAL));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_pftl.init(&pftl, &good, 0));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_pftl.init(&pftl, &good, 3600001));
    for (uint8_t i = 0; i < 7; i++) {
        struct mh_pftl_config bad = good;
        mh_real *const values[] = {&bad.speed_mps, &bad.speed_sd_mps, &bad.sensing_range_m, &bad.range_sd_m,
                                   &bad.tolerance_m};
        if (i < 5) {
            *values[i] = R(NAN);
            TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_pftl.init(&pftl, &bad, INTERVAL));
            *values[i] = R(-1.0f);
        } else {
            bad.particles = i == 5 ? 0 : MH_PARTICLES_MAX + 1;
        }
        TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_pftl.init(&pftl, &bad, INTERVAL));
    }
    begin(&good);
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_pftl.step(&pftl, 0, NULL, 1, &estimate));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_pftl.step(&pftl, 0, set, 0, NULL));
    follow(0, 0, 3, 1.0f);
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, step(2 * INTERVAL, 0));
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, mh_tracker_pftl.predict(&pftl, INTERVAL, &estimate));
}

/* However wrong the track, a step draws no more than MH_PFTL_DRAWS_MAX particles a particle. */
static void work_is_bounded(void)
{
    struct mh_pftl_config config = nominal();
    for (uint8_t i = 0; i < 4; i++) {
        config.range_sd_m = R(i < 2 ? 5.0f : 0.2f);
        config.literal = i % 2 == 1;
        begin(&config);
        follow(0, 0, 5, 1.0f);
        const uint32_t before = pftl.draws;
        TEST_ASSERT_EQUAL_INT(MH_OK, step(5 * INTERVAL, sense(400, 300, 5.0f)));
        TEST_ASSERT_TRUE(pftl.draws - before >= 6u * config.particles);
        TEST_ASSERT_TRUE(pftl.draws - before <= (uint32_t)MH_PFTL_DRAWS_MAX * config.particles);
    }
}

#if MH_REAL_FIXED
static void refuses_what_its_format_cannot_hold(void)
{
    struct mh_pftl_config config = nominal(); /* extent 202 m: 1/64 m */
    config.range_sd_m = R(0.0624f);
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_pftl.init(&pftl, &config, INTERVAL));
    config.range_sd_m = R(0.0626f);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_pftl.init(&pftl, &config, INTERVAL));
    TEST_ASSERT_EQUAL_UINT8(6, pftl.particles.bits);
    config.range_sd_m = R(181.1f); /* its square would not be a number */
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_pftl.init(&pftl, &config, INTERVAL));
    config.range_sd_m = R(181.0f);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_pftl.init(&pftl, &config, INTERVAL));
    config.speed_mps = R(900.0f); /* 5 x 2 s of it, and half the sensing range: 9 km; 16 s: farther than 16 km */
    config.range_sd_m = R(5.0f);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_pftl.init(&pftl, &config, INTERVAL));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_pftl.init(&pftl, &config, 2 * INTERVAL));
}

/* 32.76 km from where it began the next position would not be a number */
static void ends_where_its_coordinates_do(void)
{
    const struct mh_pftl_config config = nominal();
    begin(&config);
    put(0, 0, 0, 3);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(0, 1));
    put(0, 10, 0, 3);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(INTERVAL, 1));
    pftl.buffer.position.x = R(32764.0f);
    pftl.buffer.velocity.x = R(5.0f);
    const struct mh_pftl before = pftl;
    const struct mh_estimate last = estimate;
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, step(2 * INTERVAL, 1));
    TEST_ASSERT_EQUAL_MEMORY(&before, &pftl, sizeof pftl);
    TEST_ASSERT_EQUAL_MEMORY(&last, &estimate, sizeof estimate);
}

/* the mean place of nodes: exact while it is within 32.7 km of the first, refused beyond */
static void begins_at_the_centroid_of_far_nodes(void)
{
    const struct mh_pftl_config config = nominal();
    begin(&config);
    for (size_t i = 0; i < 3; i++) {
        put(i, 0, 0, 3);
    }
    set[1].place.y_mm = set[2].place.y_mm += 90000000;
    const struct mh_pftl before = pftl;
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, step(0, 3));
    TEST_ASSERT_EQUAL_MEMORY(&before, &pftl, sizeof pftl);
    set[2].place.y_mm = set[0].place.y_mm;
    TEST_ASSERT_EQUAL_INT(MH_OK, step(0, 3));
    TEST_ASSERT_EQUAL_INT32(0, estimate.position.x);
    TEST_ASSERT_EQUAL_INT32(R(30000.0f), estimate.position.y);
}
#endif

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(begins_at_the_centroid);
    RUN_TEST(follows_a_straight_line);
    RUN_TEST(options_follow_too);
    RUN_TEST(tolerance_bounds_what_is_stored);
    RUN_TEST(coasts_without_a_measurement);
    RUN_TEST(one_or_two_ranges);
    RUN_TEST(nodes_on_a_line);
    RUN_TEST(ranges_that_cannot_be);
    RUN_TEST(nodes_whose_ranges_cannot_be);
    RUN_TEST(no_particle_fits);
    RUN_TEST(numbers_of_particles_at_their_limits);
    RUN_TEST(finds_a_target_that_jumps);
    RUN_TEST(restarts_about_the_nodes);
    RUN_TEST(is_handed_over);
    RUN_TEST(known_bytes);
    RUN_TEST(refuses_what_is_out_of_range);
    RUN_TEST(work_is_bounded);
#if MH_REAL_FIXED
    RUN_TEST(refuses_what_its_format_cannot_hold);
    RUN_TEST(ends_where_its_coordinates_do);
    RUN_TEST(begins_at_the_centroid_of_far_nodes);
#endif
    port_exit(UNITY_END() > 0);
    return 0;
}
