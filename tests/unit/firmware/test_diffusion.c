/* A source crosses a lattice of nodes in a straight line; the readings are its exact field. */
#include "motehound/diffusion.h"
#include "port.h"
#include "unity.h"

#include <math.h>

#define REPORTS_MAX (MH_DIFFUSION_NEAR + MH_DIFFUSION_STRONG + 4)
#define SIDE 9 /* nodes, 2 m apart, jittered */
#define INTERVAL 1000u

static struct mh_diffusion state;
static struct mh_measurement reports[REPORTS_MAX];

void setUp(void) {}
void tearDown(void) {}

/* a place far from the field's zero, so that it shows if anything computes there in metres */
static const struct mh_place corner = {500000000, -300000000, 0};

static struct mh_vec2 source_at(mh_real seconds)
{
    const struct mh_vec2 place = {2.0f + 1.0f * seconds, 5.0f + 0.5f * seconds};
    return place;
}

/* Luo, Eq. (1)-(2) with 100 g/s and D = 1, released from time 0: the midpoint rule in the logarithm of the age. */
static mh_real concentration(struct mh_vec2 node, mh_real seconds)
{
    const mh_real span = 9.2103404f; /* ln 10^4 */
    const int points = 32;
    mh_real sum = 0.0f;
    for (int i = 0; i < points && seconds > 0.0f; i++) {
        const mh_real age = seconds * mh_exp(span * (((mh_real)i + 0.5f) / (mh_real)points - 1.0f));
        const struct mh_vec2 source = source_at(seconds - age);
        const mh_real dx = node.x - source.x, dy = node.y - source.y;
        const mh_real exponent = (dx * dx + dy * dy) / (4.0f * age);
        sum += exponent < 20.0f ? mh_exp(-exponent) : 0.0f;
    }
    return sum * span / (mh_real)points * 100.0f / (4.0f * MH_PI);
}

static mh_real distance(struct mh_vec2 a, struct mh_vec2 b)
{
    return mh_sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y));
}

/* Add to the reports; when they are full the smallest increment gives way. */
static size_t keep(const struct mh_measurement *m, size_t count)
{
    size_t least = 0;
    if (count < REPORTS_MAX) {
        reports[count] = *m;
        return count + 1;
    }
    for (size_t i = 1; i < count; i++) {
        least = reports[i].increment < reports[least].increment ? i : least;
    }
    if (m->increment > reports[least].increment) {
        reports[least] = *m;
    }
    return count;
}

/* Those that the tracker asks for and those with a significant increment, at `second`. */
static size_t collect(int second)
{
    struct mh_interest interest = {{0, 0, 0}, 0};
    const bool asked = mh_tracker_diffusion.interest(&state, &interest) == MH_OK;
    size_t count = 0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        const int32_t x_mm = 2000 * (i % SIDE) + 37 * (i % 7) * (i % 5),
                      y_mm = 2000 * (i / SIDE) + 53 * (i % 4) * (i % 3);
        const struct mh_vec2 node = {0.001f * (mh_real)x_mm, 0.001f * (mh_real)y_mm};
        struct mh_measurement m = {.node = (mh_node_id)i, .time = (mh_tick)second * INTERVAL};
        m.place.x_mm = corner.x_mm + x_mm;
        m.place.y_mm = corner.y_mm + y_mm;
        const bool wanted = asked && mh_place_within(&m.place, &interest.centre, interest.radius_mm);
        if (wanted || distance(node, source_at((mh_real)second)) < 5.0f) {
            m.value = mh_q20_from_real(concentration(node, (mh_real)second));
            m.increment = m.value - mh_q20_from_real(concentration(node, (mh_real)second - 1.0f));
            m.flags = MH_MEASUREMENT_HAS_INCREMENT;
            if (wanted || m.increment >= MH_Q20(0.2f)) {
                count = keep(&m, count);
            }
        }
    }
    return count;
}

static mh_real error_at(const struct mh_estimate *e, mh_real second)
{
    const struct mh_vec2 offset = mh_place_relative(&e->origin, &corner);
    const struct mh_vec2 place = {offset.x + e->position.x, offset.y + e->position.y};
    return distance(place, source_at(second));
}

static mh_real sd(const struct mh_estimate *e) { return mh_sqrt(e->covariance.xx + e->covariance.yy); }

static void begin(void)
{
    struct mh_diffusion_config config;
    mh_diffusion_config_default(&config);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_diffusion.init(&state, &config, INTERVAL));
}

static void configuration_is_checked(void)
{
    struct mh_diffusion_config config;
    mh_diffusion_config_default(&config);
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_diffusion.init(&state, &config, 0));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_diffusion.init(&state, NULL, INTERVAL));
    config.diffusion_m2ps = NAN;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_diffusion.init(&state, &config, INTERVAL));
    config.diffusion_m2ps = 1.0f;
    config.release_gps = 0.0f;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_diffusion.init(&state, &config, INTERVAL));
    config.release_gps = 100.0f;
    config.release_drift = INFINITY;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_diffusion.init(&state, &config, INTERVAL));
    config.release_drift = 0.05f;
    config.region.x_max_mm = config.region.x_min_mm;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_diffusion.init(&state, &config, INTERVAL));
    config.region.x_max_mm = MH_COORDINATE_MAX_MM;
    config.region.y_min_mm = -MH_COORDINATE_MAX_MM - 1;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_diffusion.init(&state, &config, INTERVAL));
}

static void nothing_comes_of_nothing(void)
{
    struct mh_estimate e;
    struct mh_interest interest;
    begin();
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_diffusion.step(&state, 1000, NULL, 0, &e));
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_diffusion.predict(&state, 1000, &e));
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_diffusion.interest(&state, &interest));
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, mh_tracker_diffusion.step(&state, 1000, NULL, 0, &e));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_diffusion.step(&state, 2000, NULL, 1, &e));
    /* increments that were never measured do not start a track */
    const size_t count = collect(3);
    TEST_ASSERT_TRUE(count >= 4);
    for (size_t i = 0; i < count; i++) {
        reports[i].flags = 0;
    }
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_diffusion.step(&state, 3000, reports, count, &e));
}

/* Feed the samples up to `last`; the last estimate stays in *e. */
static void track_until(int last, struct mh_estimate *e)
{
    bool tracking = false;
    begin();
    for (int second = 1; second <= last; second++) {
        const enum mh_status status =
            mh_tracker_diffusion.step(&state, (mh_tick)second * INTERVAL, reports, collect(second), e);
        TEST_ASSERT_TRUE(status == MH_OK || (status == MH_NONE && !tracking));
        if (status == MH_OK) {
            TEST_ASSERT_EQUAL_INT(tracking ? 0 : MH_ESTIMATE_STARTED, e->flags);
        }
        tracking = status == MH_OK;
    }
    TEST_ASSERT_TRUE(tracking);
}

static void a_straight_path_is_followed_and_predicted(void)
{
    struct mh_estimate e;
    struct mh_interest interest;
    track_until(8, &e);
    TEST_ASSERT_FLOAT_WITHIN(0.08f, 0.0f, error_at(&e, 8.0f));
    TEST_ASSERT_TRUE(sd(&e) > 0.001f && sd(&e) < 0.3f);
    TEST_ASSERT_FLOAT_WITHIN(0.15f, 1.0f, e.velocity.x);
    TEST_ASSERT_FLOAT_WITHIN(0.15f, 0.5f, e.velocity.y);
    TEST_ASSERT_TRUE(e.measurements >= MH_DIFFUSION_NEAR);

    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_diffusion.interest(&state, &interest));
    TEST_ASSERT_TRUE(interest.radius_mm >= 1000 && interest.radius_mm <= 8000);
    const struct mh_vec2 source = source_at(9.0f);
    const struct mh_place next = mh_place_from_offset(&corner, source);
    TEST_ASSERT_TRUE(mh_place_within(&next, &interest.centre, 1000));

    const mh_real now = sd(&e);
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, mh_tracker_diffusion.predict(&state, 7999, &e));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_diffusion.predict(&state, 10000, &e));
    TEST_ASSERT_FLOAT_WITHIN(0.5f, 0.0f, error_at(&e, 10.0f));
    TEST_ASSERT_TRUE(sd(&e) > now);
}

static void silence_is_honest_and_ends_the_track(void)
{
    struct mh_estimate e, gap;
    track_until(7, &e);
    mh_real before = sd(&e);
    for (int i = 1; i <= MH_DIFFUSION_COAST; i++) {
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_diffusion.step(&state, 7000u + (mh_tick)i * INTERVAL, NULL, 0, &e));
        TEST_ASSERT_EQUAL_INT(MH_ESTIMATE_COASTED, e.flags);
        TEST_ASSERT_EQUAL_INT(0, e.measurements);
        TEST_ASSERT_TRUE(sd(&e) > before);
        TEST_ASSERT_TRUE(error_at(&e, 7.0f + (mh_real)i) < 3.0f * sd(&e));
        before = sd(&e);
        if (i == 3) {
            gap = e;
        }
    }
    TEST_ASSERT_EQUAL_INT(MH_NONE,
                          mh_tracker_diffusion.step(&state, 8000u + MH_DIFFUSION_COAST * INTERVAL, NULL, 0, &e));

    /* instants that the caller leaves out count the same */
    track_until(7, &e);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_diffusion.step(&state, 10000u, NULL, 0, &e));
    TEST_ASSERT_EQUAL_FLOAT(gap.position.x, e.position.x);
    TEST_ASSERT_EQUAL_FLOAT(gap.covariance.yy, e.covariance.yy);
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_diffusion.step(&state, 2000000000u, NULL, 0, &e));
}

static void the_source_is_found_again_after_a_gap(void)
{
    struct mh_estimate e;
    track_until(5, &e);
    for (int second = 8; second <= 11; second++) {
        TEST_ASSERT_EQUAL_INT(
            MH_OK, mh_tracker_diffusion.step(&state, (mh_tick)second * INTERVAL, reports, collect(second), &e));
    }
    TEST_ASSERT_FLOAT_WITHIN(0.15f, 0.0f, error_at(&e, 11.0f));
}

/* What an emulator does in a few seconds. */
#if defined(__AVR__) || defined(__arm__) || defined(__riscv)
#define RANDOM_INSTANTS 3
#else
#define RANDOM_INSTANTS 300
#endif

static void senseless_input_gives_sound_output(void)
{
    uint32_t random = 12345;
    mh_tick time = 0;
    begin();
    for (int k = 0; k < RANDOM_INSTANTS; k++) {
        for (int i = 0; i < REPORTS_MAX; i++) {
            struct mh_measurement *m = &reports[i];
            int32_t *fields[4] = {&m->place.x_mm, &m->place.y_mm, &m->value, &m->increment};
            for (int f = 0; f < 4; f++) {
                random = random * 1664525u + 1013904223u;
                *fields[f] = (int32_t)(random >> 1) >> (f < 2 ? 16 : (random >> 8) % 14u);
            }
            m->flags = (random >> 16) % 5u > 0 ? MH_MEASUREMENT_HAS_INCREMENT : 0;
        }
        time += INTERVAL * (k % 7 == 6 ? 5u : 1u);
        struct mh_estimate e;
        const enum mh_status status = mh_tracker_diffusion.step(&state, time, reports, REPORTS_MAX, &e);
        TEST_ASSERT_TRUE(status == MH_OK || status == MH_NONE);
        if (status == MH_OK) {
            TEST_ASSERT_TRUE(mh_finite(e.position.x) && mh_finite(e.position.y) && mh_finite(e.velocity.x));
            TEST_ASSERT_TRUE(e.covariance.xx > 0.0f && mh_finite(e.covariance.xx + e.covariance.yy));
            TEST_ASSERT_TRUE(e.covariance.xx * e.covariance.yy > e.covariance.xy * e.covariance.xy);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(configuration_is_checked);
    RUN_TEST(nothing_comes_of_nothing);
    RUN_TEST(a_straight_path_is_followed_and_predicted);
    RUN_TEST(silence_is_honest_and_ends_the_track);
    RUN_TEST(the_source_is_found_again_after_a_gap);
    RUN_TEST(senseless_input_gives_sound_output);
    port_exit(UNITY_END() > 0);
    return 0;
}
