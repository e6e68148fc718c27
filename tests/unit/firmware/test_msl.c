#include "motehound/msl.h"
#include "port.h"
#include "unity.h"

#include <math.h>
#include <string.h>

void setUp(void) {}
void tearDown(void) {}

#define INTERVAL 2000
#define NODES 9

static struct mh_msl msl;
static struct mh_measurement set[NODES];
static struct mh_estimate estimate;

static const struct mh_place corner = {-900000000, 900000000, 7};

static void begin(uint16_t particles)
{
    struct mh_msl_config config;
    mh_msl_config_default(&config);
    config.particles = particles;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_msl.init(&msl, &config, INTERVAL));
}

static void put(size_t i, mh_real x, mh_real y)
{
    const struct mh_vec2 at = {x, y};
    memset(&set[i], 0, sizeof set[i]);
    set[i].node = (mh_node_id)i;
    set[i].place = mh_place_from_offset(&corner, at);
}

/* The nodes of a grid of 40 m that sense a target at (x, y), m from the corner. */
static size_t sense(mh_real x, mh_real y)
{
    size_t n = 0;
    for (int32_t i = (int32_t)(x / 40) - 1; i <= (int32_t)(x / 40) + 2; i++) {
        for (int32_t j = (int32_t)(y / 40) - 1; j <= (int32_t)(y / 40) + 2; j++) {
            const mh_real node_x = (mh_real)(40 * i), node_y = (mh_real)(40 * j);
            if (mh_squared(x - node_x) + mh_squared(y - node_y) <= 2500.0f && n < NODES) {
                put(n++, node_x, node_y);
            }
        }
    }
    return n;
}

static enum mh_status step(mh_tick time, size_t count)
{
    return mh_tracker_msl.step(&msl, time, set, count, &estimate);
}

static mh_real error_at(mh_real x, mh_real y)
{
    const struct mh_vec2 origin = mh_place_relative(&estimate.origin, &corner);
    return mh_sqrt(mh_squared(origin.x + estimate.position.x - x) + mh_squared(origin.y + estimate.position.y - y));
}

/* every particle is within the sensing range of every node that measures */
static void assert_particles_count(size_t n)
{
    for (uint16_t i = 0; i < msl.count; i++) {
        for (size_t j = 0; j < n; j++) {
            const struct mh_vec2 node = mh_place_relative(&set[j].place, &msl.origin);
            TEST_ASSERT_TRUE(mh_squared(msl.x[i] - node.x) + mh_squared(msl.y[i] - node.y) <= 2500.0f);
        }
    }
}

static void assert_answer(uint8_t flags)
{
    TEST_ASSERT_EQUAL_UINT8(flags, estimate.flags);
    TEST_ASSERT_EQUAL_FLOAT(estimate.position.x, estimate.stored.x);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, estimate.stored_velocity.x);
    const struct mh_sym2 c = estimate.covariance;
    TEST_ASSERT_TRUE(c.xx > 0 && c.yy > 0 && c.xx * c.yy - c.xy * c.xy > 0);
}

static void follow(uint16_t from, uint16_t to)
{
    for (uint16_t i = from; i < to; i++) {
        const mh_real x = 100 + 7.0f * (mh_real)i, y = 100 + 5.0f * (mh_real)i;
        const size_t n = sense(x, y);
        const uint32_t draws = msl.draws;
        TEST_ASSERT_EQUAL_INT(MH_OK, step((mh_tick)i * INTERVAL, n));
        TEST_ASSERT_EQUAL_UINT16(msl.config.particles, msl.count);
        TEST_ASSERT_TRUE(msl.draws - draws >= msl.config.particles);
        assert_particles_count(n);
        assert_answer(i == 0 ? MH_ESTIMATE_STARTED | MH_ESTIMATE_REFRESHED : MH_ESTIMATE_REFRESHED);
        TEST_ASSERT_TRUE(error_at(x, y) < 25.0f); /* half the sensing range */
    }
}

static void follows_a_straight_line(void)
{
    begin(20);
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(UINT32_MAX, 0));
    follow(0, 15);
}

/* the mean of a disc is its centre, its variance a quarter of the radius squared; resolution comes on top */
static void one_node_is_a_disc(void)
{
    begin(MH_PARTICLES_MAX);
    put(0, 500, 300);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(0, 1));
    const mh_real n = MH_PARTICLES_MAX;
    TEST_ASSERT_TRUE(error_at(500, 300) < 5.0f * 25.0f / mh_sqrt(n));
    TEST_ASSERT_FLOAT_WITHIN(5.0f * 625.0f / mh_sqrt(n), 625.0f, estimate.covariance.xx);
    assert_particles_count(1);
}

static void spreads_without_a_measurement(void)
{
    begin(50);
    follow(0, 5);
    const struct mh_estimate last = estimate;
    struct mh_estimate predicted;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_msl.predict(&msl, 5 * INTERVAL, &predicted));
    TEST_ASSERT_EQUAL_FLOAT(last.position.x, predicted.position.x);
    for (uint16_t i = 5; i < 15; i++) {
        TEST_ASSERT_EQUAL_INT(MH_OK, step((mh_tick)i * INTERVAL, 0));
        assert_answer(MH_ESTIMATE_COASTED | MH_ESTIMATE_REFRESHED);
    }
    /* ten discs of radius 14.3 m: 10 r^2 / 4 = 512 m2 more, of 50 particles */
    TEST_ASSERT_TRUE(estimate.covariance.xx > last.covariance.xx + 100.0f);
    TEST_ASSERT_TRUE(estimate.covariance.xx < last.covariance.xx + 1500.0f);
}

static void finds_a_target_that_jumps(void)
{
    begin(20);
    follow(0, 5);
    size_t n = sense(500, 50); /* no old particle leads there */
    TEST_ASSERT_EQUAL_INT(MH_OK, step(5 * INTERVAL, n));
    assert_particles_count(n);
    TEST_ASSERT_TRUE(error_at(500, 50) < 25.0f);
    mh_tracker_msl.restart(&msl);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(6 * INTERVAL, 0)); /* still to come */
    n = sense(510, 50);
    const uint32_t draws = msl.draws;
    TEST_ASSERT_EQUAL_INT(MH_OK, step(7 * INTERVAL, n));
    TEST_ASSERT_TRUE(msl.draws > draws);
    assert_particles_count(n);
}

/* two nodes 120 m apart sense nothing in common: the mean of both; 100 m apart, one point */
static void discs_that_do_not_meet(void)
{
    for (uint8_t i = 0; i < 2; i++) {
        begin(5);
        put(0, 0, 0);
        put(1, i == 0 ? 120.0f : 100.0f, 0);
        TEST_ASSERT_EQUAL_INT(MH_OK, step(0, 2));
        assert_answer(MH_ESTIMATE_STARTED | MH_ESTIMATE_REFRESHED);
        TEST_ASSERT_TRUE(error_at(i == 0 ? 60.0f : 50.0f, 0) < 1.0f);
        TEST_ASSERT_TRUE(msl.draws <= 1000);
    }
}

static void one_particle_is_enough(void)
{
    begin(1);
    for (uint16_t i = 0; i < 10; i++) {
        const size_t n = sense(100 + 7.0f * (mh_real)i, 100);
        TEST_ASSERT_EQUAL_INT(MH_OK, step((mh_tick)i * INTERVAL, n));
        assert_particles_count(n);
        assert_answer((uint8_t)(MH_ESTIMATE_REFRESHED | (i == 0 ? MH_ESTIMATE_STARTED : 0)));
    }
}

static void is_handed_over(void)
{
    static uint8_t bytes[MH_TRACK_BYTES_MAX];
    size_t length = 0;
    begin(MH_PARTICLES_MAX);
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_msl.save(&msl, bytes, &length));
    const size_t n = sense(100, 100);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(0, n));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_msl.save(&msl, bytes, &length));
    const uint16_t room = (MH_TRACK_BYTES_MAX - 12) / 4;
    const uint16_t saved = MH_PARTICLES_MAX < room ? MH_PARTICLES_MAX : room;
    TEST_ASSERT_EQUAL_size_t(12u + 4u * saved, length);
    const struct mh_vec2 origin = mh_place_relative(&msl.origin, &corner);
    const mh_real first_x = origin.x + msl.x[0], first_y = origin.y + msl.y[0];
    begin(MH_PARTICLES_MAX);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_msl.load(&msl, bytes, length));
    TEST_ASSERT_EQUAL_UINT16(saved, msl.count);
    const struct mh_vec2 new_origin = mh_place_relative(&msl.origin, &corner);
    TEST_ASSERT_FLOAT_WITHIN(0.006f, first_x, new_origin.x + msl.x[0]);
    TEST_ASSERT_FLOAT_WITHIN(0.006f, first_y, new_origin.y + msl.y[0]);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(INTERVAL, sense(107, 105)));
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_REFRESHED, estimate.flags);
    TEST_ASSERT_TRUE(error_at(107, 105) < 25.0f);
    /* what no save writes */
    begin(5);
    const size_t lengths[] = {0, 12, 15, 17, MH_TRACK_BYTES_MAX + 4};
    for (uint8_t i = 0; i < 5; i++) {
        TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_tracker_msl.load(&msl, bytes, lengths[i]));
    }
    bytes[4] = 0x7F;
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_tracker_msl.load(&msl, bytes, length));
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(0, 0));
}

static void refuses_what_is_out_of_range(void)
{
    struct mh_msl_config good;
    mh_msl_config_default(&good);
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_msl.init(&msl, &good, 0));
    for (uint8_t i = 0; i < 5; i++) {
        struct mh_msl_config bad = good;
        mh_real *const values[] = {&bad.speed_mps, &bad.speed_sd_mps, &bad.sensing_range_m};
        if (i < 3) {
            *values[i] = NAN;
        } else {
            bad.particles = i == 3 ? 0 : MH_PARTICLES_MAX + 1;
        }
        TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_msl.init(&msl, &bad, INTERVAL));
    }
    begin(5);
    follow(0, 2);
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, step(INTERVAL, 0));
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, mh_tracker_msl.predict(&msl, 0, &estimate));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_msl.step(&msl, 2 * INTERVAL, NULL, 1, &estimate));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(follows_a_straight_line);
    RUN_TEST(one_node_is_a_disc);
    RUN_TEST(spreads_without_a_measurement);
    RUN_TEST(finds_a_target_that_jumps);
    RUN_TEST(discs_that_do_not_meet);
    RUN_TEST(one_particle_is_enough);
    RUN_TEST(is_handed_over);
    RUN_TEST(refuses_what_is_out_of_range);
    port_exit(UNITY_END() > 0);
    return 0;
}
