#include "motehound/luo.h"
#include "motehound/puff_fit.h"
#include "port.h"
#include "reals.h"

#define NODES 9

void setUp(void) {}
void tearDown(void) {}

/* A 3 x 3 grid, 1.5 m apart, far from the origin of the field. */
static const struct mh_place corner = {700000000, -300000000, 0};
static struct mh_measurement measurements[NODES];
static struct mh_luo_config config;
static struct mh_luo luo;

static void begin(void)
{
    mh_luo_config_default(&config);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_luo.init(&luo, &config, 1000));
}

/* Every node reads a puff at (x, y) from the corner, as value and as increment. */
static void read_puff(float x, float y, float age)
{
    const struct mh_puff puff = {
        {mh_real_from_float(x), mh_real_from_float(y)}, mh_real_from_float(age), MH_REAL(50.0f)};
    for (uint8_t i = 0; i < NODES; i++) {
        struct mh_measurement *m = &measurements[i];
        m->node = i;
        m->place.x_mm = corner.x_mm + 1500 * (i % 3);
        m->place.y_mm = corner.y_mm + 1500 * (i / 3);
        m->value =
            mh_q20_from_real(mh_puff_concentration(&puff, MH_REAL(1.0f), mh_place_relative(&m->place, &corner), NULL));
        m->increment = m->value;
        m->flags = MH_MEASUREMENT_HAS_INCREMENT;
    }
}

static enum mh_status step(mh_tick time, size_t count, struct mh_estimate *estimate)
{
    return mh_tracker_luo.step(&luo, time, measurements, count, estimate);
}

/* `at` (from the estimate's origin) is (x, y) from the corner to 2 mm. */
static void expect_place(float x, float y, const struct mh_estimate *estimate, struct mh_vec2 at)
{
    const struct mh_vec2 origin = mh_place_relative(&estimate->origin, &corner);
    EXPECT_REAL(2e-3f, 2e-3f, x, origin.x + at.x);
    EXPECT_REAL(2e-3f, 2e-3f, y, origin.y + at.y);
}

/* Three puffs: the first two positions are the pre-estimates, the third is filtered by the recursion's formulas. */
static void a_short_track(void)
{
    begin();
    struct mh_estimate e = {.measurements = 99};
    const mh_tick start = UINT32_MAX - 500; /* the clock wraps under way */
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(start, 0, &e));
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_luo.predict(&luo, start, &e));
    TEST_ASSERT_EQUAL_UINT16(99, e.measurements);

    read_puff(1.2f, 0.9f, 0.8f);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(start + 2000, NODES, &e));
    expect_place(1.2f, 0.9f, &e, e.position);
    expect_place(1.2f, 0.9f, &e, e.raw);
    EXPECT_REAL(1e-3f, 1e-3f, 0.8f, e.age);
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_STARTED, e.flags);
    TEST_ASSERT_EQUAL_UINT16(NODES, e.measurements);
    TEST_ASSERT_EQUAL_UINT32(start + 2000, e.time);
    TEST_ASSERT_EQUAL_INT32(corner.x_mm + 1500, e.origin.x_mm); /* the node nearest to the puff */
    TEST_ASSERT_EQUAL_INT32(corner.y_mm + 1500, e.origin.y_mm);
    TEST_ASSERT_TRUE(e.covariance.xx == 0);

    read_puff(1.7f, 0.9f, 0.5f);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(start + 3000, NODES, &e));
    expect_place(1.7f, 0.9f, &e, e.position);
    TEST_ASSERT_EQUAL_UINT8(0, e.flags);
    const float v = 0.5f / 1.3f; /* tau went from 1.2 s to 2.5 s */
    EXPECT_REAL(2e-3f, 2e-3f, v, e.velocity.x);
    EXPECT_REAL(2e-3f, 2e-3f, 0, e.velocity.y);

    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_luo.predict(&luo, start + 4000, &e));
    expect_place(1.7f + 1.5f * v, 0.9f, &e, e.position);
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_COASTED, e.flags);
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, mh_tracker_luo.predict(&luo, start + 2999, &e));

    read_puff(2.0f, 1.4f, 0.6f);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(start + 4000, NODES, &e));
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_FILTERED, e.flags);
    expect_place(2.0f, 1.4f, &e, e.raw);
    const float d = 0.03f * (1 - 0.97f * 0.97f);
    const float predicted = 1.7f + 0.9f * v; /* tau went on to 3.4 s */
    const float innovation = (1 - d) * (2.0f - predicted);
    const float variance = (1 - d) * 10 + d * (innovation * innovation - 11);
    expect_place(predicted + 11 / (11 + variance) * innovation,
                 0.9f + 0.5f * (1 - d) * 11 / (11 + 10 * (1 - d) + d * (0.25f - 11)), &e, e.position);
    EXPECT_REAL(4e-3f, 4e-3f, (predicted + 11 / (11 + variance) * innovation - 1.7f) / 0.9f, e.velocity.x);
}

/* A third pre-estimate equal to one of the two before passes the filter by. */
static void a_repeated_position_is_not_filtered(void)
{
    begin();
    struct mh_estimate e;
    (void)step(0, 0, &e);
    read_puff(1.2f, 0.9f, 0.6f);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(1000, NODES, &e));
    read_puff(1.5f, 0.9f, 0.6f);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(2000, NODES, &e));
    read_puff(1.2f, 0.9f, 0.6f);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(3000, NODES, &e));
    TEST_ASSERT_EQUAL_UINT8(0, e.flags);
    TEST_ASSERT_TRUE(e.raw.x == e.position.x);
    read_puff(1.4f, 1.0f, 0.6f);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(4000, NODES, &e));
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_FILTERED, e.flags);
}

static void age_is_bounded_by_the_arrival_before(void)
{
    begin();
    struct mh_estimate e;
    (void)step(0, 0, &e);
    read_puff(1.2f, 0.9f, 0.8f);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(500, NODES, &e)); /* older than the session */
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_STARTED | MH_ESTIMATE_AGE_HIGH, e.flags);
    TEST_ASSERT_TRUE(e.age == MH_REAL(0.5f));
    read_puff(1.3f, 0.9f, 5.0f);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(1500, NODES, &e));
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_AGE_HIGH, e.flags);
    TEST_ASSERT_TRUE(e.age == MH_REAL(1.5f));
    TEST_ASSERT_TRUE(e.velocity.x == 0); /* both arrived at the same time: no velocity yet */
}

static void who_takes_part(void)
{
    begin();
    struct mh_estimate e;
    (void)step(0, 0, &e);
    read_puff(1.2f, 0.9f, 0.8f);
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(1000, 3, &e)); /* too few */
    /* the first position wants values above chi, with or without an increment */
    for (uint8_t i = 0; i < NODES; i++) {
        measurements[i].flags = 0;
    }
    measurements[8].value = mh_q20_from_real(config.chi);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(2000, NODES, &e));
    TEST_ASSERT_EQUAL_UINT16(NODES - 1, e.measurements);
    /* later ones want known increments of at least chi */
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(3000, NODES, &e));
    read_puff(1.3f, 1.0f, 0.8f);
    measurements[8].increment = mh_q20_from_real(config.chi);
    measurements[6].increment = mh_q20_from_real(config.chi) - 1;
    measurements[2].increment = -MH_Q20_ONE;
    measurements[0].flags = 0;
    TEST_ASSERT_EQUAL_INT(MH_OK, step(4000, NODES, &e));
    TEST_ASSERT_EQUAL_UINT16(NODES - 3, e.measurements);
    /* nodes on one line determine nothing */
    read_puff(1.3f, 1.0f, 0.8f);
    for (uint8_t i = 0; i < NODES; i++) {
        measurements[i].place.y_mm = measurements[i].place.x_mm;
    }
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(5000, NODES, &e));
}

static void of_equal_readings_the_lowest_node_is_the_origin(void)
{
    begin();
    struct mh_estimate e;
    (void)step(0, 0, &e);
    read_puff(0.75f, 0.75f, 0.8f);
    measurements[0].node = 50; /* nodes 50, 1, 3 and 4 are equally near */
    measurements[1].value = measurements[3].value = measurements[4].value = measurements[0].value;
    TEST_ASSERT_EQUAL_INT(MH_OK, step(1000, NODES, &e));
    TEST_ASSERT_EQUAL_INT32(measurements[1].place.x_mm, e.origin.x_mm);
    TEST_ASSERT_EQUAL_INT32(measurements[1].place.y_mm, e.origin.y_mm);
}

static void ends_outside_after_having_been_inside(void)
{
    mh_luo_config_default(&config);
    config.stop_outside = true;
    config.inside_mm = 500;
    const struct mh_region region = {corner.x_mm, corner.x_mm + 2000, corner.y_mm, corner.y_mm + 2000};
    config.region = region;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_luo.init(&luo, &config, 1000));
    struct mh_estimate e;
    (void)step(0, 0, &e);
    read_puff(2.2f, 0.9f, 0.6f); /* outside, but never inside before */
    TEST_ASSERT_EQUAL_INT(MH_OK, step(1000, NODES, &e));
    read_puff(1.2f, 0.9f, 0.6f);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(2000, NODES, &e));
    read_puff(2.2f, 0.9f, 0.6f); /* equal to the first: not filtered */
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(3000, NODES, &e));
    read_puff(1.2f, 0.9f, 0.6f);
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(4000, NODES, &e));
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_luo.predict(&luo, 4000, &e));
}

#if !MH_REAL_FIXED
static void nonlinear_finds_the_same_exact_puff(void)
{
    mh_luo_config_default(&config);
    config.nonlinear = true;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_luo.init(&luo, &config, 1000));
    struct mh_estimate e;
    (void)step(0, 0, &e);
    read_puff(1.2f, 0.9f, 0.8f);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(2000, NODES, &e));
    expect_place(1.2f, 0.9f, &e, e.raw);
    EXPECT_REAL(2e-3f, 2e-3f, 0.8f, e.age);
}
#endif

/* Four nodes that claim to stand almost on a line through half the world put a position, and so the velocity, beyond what the
 * filter takes, or in fixed point the nodes themselves. */
static void a_wild_position_does_not_stop_the_track(void)
{
    static const struct mh_place claimed[4] = {
        {-462162, -462086, 0}, {621533677, 621534918, 0}, {113909, 120488, 0}, {-698004414, -698003634, 0}};
    static const mh_q20 increments[4] = {215733540, 1361603167, 1995745563, 704972666};
    begin();
    struct mh_estimate e;
    (void)step(0, 0, &e);
    read_puff(1.2f, 0.9f, 0.6f);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(1000, NODES, &e));
    for (uint8_t i = 0; i < 4; i++) {
        measurements[i].place = claimed[i];
        measurements[i].increment = increments[i];
    }
#if MH_REAL_FIXED
    const struct mh_luo kept = luo;
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, step(2000, 4, &e));
    TEST_ASSERT_EQUAL_MEMORY(&kept, &luo, sizeof kept);
#else
    TEST_ASSERT_EQUAL_INT(MH_OK, step(2000, 4, &e));
    TEST_ASSERT_TRUE(mh_abs(e.velocity.x) + mh_abs(e.velocity.y) > 1e9f);
#endif
    for (mh_tick time = 3000; time <= 6000; time += 1000) {
        read_puff(1.3f + (float)time * 1e-4f, 0.9f, 0.6f);
        TEST_ASSERT_EQUAL_INT(MH_OK, step(time, NODES, &e));
    }
    expect_place(1.9f, 0.9f, &e, e.raw);
    EXPECT_REAL(0.2f, 0.2f, mh_real_to_float(e.raw.x), e.position.x);
    EXPECT_REAL(0.2f, 0.2f, mh_real_to_float(e.raw.y), e.position.y);
}

/* The largest region and margin that init() takes, seen from the far end of the field. */
static void the_largest_region_has_room(void)
{
    mh_luo_config_default(&config);
    config.stop_outside = true;
    config.inside_mm = FLOAT_FIXED(1000000000, 16000000);
    const struct mh_region region = {1000000000, 1000000000, 1000000000, 1000000000};
    config.region = region;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_luo.init(&luo, &config, 1000));
    struct mh_estimate e;
    (void)step(0, 0, &e);
    read_puff(1.2f, 0.9f, 0.6f);
    for (uint8_t i = 0; i < NODES; i++) {
        measurements[i].place.x_mm -= corner.x_mm + 1000000000;
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, step(1000, NODES, &e));
    TEST_ASSERT_FALSE(luo.armed);
}

#if MH_REAL_FIXED
/* A step that has no room is refused, by its status, and the state is as if it had not been: a saturated reading, a node too far from the others, a source that
 * has gone 8 km from where the track began. */
static void what_has_no_room_is_refused(void)
{
    begin();
    struct mh_estimate e = {.measurements = 99};
    (void)step(0, 0, &e);
    read_puff(1.2f, 0.9f, 0.6f);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(1000, NODES, &e));
    const struct mh_luo kept = luo;
    e.measurements = 99;
    measurements[4].increment = INT32_MAX;
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, step(2000, NODES, &e));
    read_puff(1.3f, 0.9f, 0.6f);
    measurements[8].place.x_mm += 260000;
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, step(2000, NODES, &e));
    read_puff(1.3f, 0.9f, 0.6f);
    for (uint8_t i = 0; i < NODES; i++) {
        measurements[i].place.y_mm += 8001000;
    }
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, step(2000, NODES, &e));
    TEST_ASSERT_EQUAL_MEMORY(&kept, &luo, sizeof kept);
    TEST_ASSERT_EQUAL_UINT16(99, e.measurements);
    read_puff(1.3f, 0.9f, 0.6f);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(2000, NODES, &e));
    /* the velocity is finite; its way from here is not */
    luo.velocity.x = MH_REAL(30000.0f);
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, mh_tracker_luo.predict(&luo, 9000, &e));
    config.nonlinear = true;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_luo.init(&luo, &config, 1000));
}
#endif

static void bad_input(void)
{
    begin();
    struct mh_estimate e;
    read_puff(1.2f, 0.9f, 0.8f);
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(5000, 0, &e));
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, step(5000, NODES, &e));
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, step(4000, NODES, &e));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_luo.step(&luo, 6000, NULL, 1, &e));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_luo.init(&luo, &config, 0));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_luo.init(&luo, &config, 3600001));
    config.chi = NOT_A_NUMBER;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_luo.init(&luo, &config, 1000));
    mh_luo_config_default(&config);
    config.diffusion_m2ps = 0;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_luo.init(&luo, &config, 1000));
    mh_luo_config_default(&config);
    config.region.x_max_mm = INT32_MAX;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_luo.init(&luo, &config, 1000));
    mh_luo_config_default(&config);
    config.forgetting = MH_REAL(1.0f);
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_luo.init(&luo, &config, 1000));
    mh_luo_config_default(&config);
    config.filter.measurement_floor = MH_REAL(-1.0f);
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_luo.init(&luo, &config, 1000));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_short_track);
    RUN_TEST(a_repeated_position_is_not_filtered);
    RUN_TEST(age_is_bounded_by_the_arrival_before);
    RUN_TEST(who_takes_part);
    RUN_TEST(of_equal_readings_the_lowest_node_is_the_origin);
    RUN_TEST(ends_outside_after_having_been_inside);
#if MH_REAL_FIXED
    RUN_TEST(what_has_no_room_is_refused);
#else
    RUN_TEST(nonlinear_finds_the_same_exact_puff);
#endif
    RUN_TEST(a_wild_position_does_not_stop_the_track);
    RUN_TEST(the_largest_region_has_room);
    RUN_TEST(bad_input);
    port_exit(UNITY_END() > 0);
    return 0;
}
