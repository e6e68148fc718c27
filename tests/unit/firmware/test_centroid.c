#include "motehound/centroid.h"
#include "port.h"
#include "unity.h"

#include <math.h>
#include <string.h>

void setUp(void) {}
void tearDown(void) {}

static struct mh_centroid_state centroid;
static struct mh_measurement set[3];
static struct mh_estimate estimate;

static void begin(void)
{
    struct mh_centroid_config config;
    mh_centroid_config_default(&config);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_centroid.init(&centroid, &config, 2000));
    memset(set, 0, sizeof set);
    const struct mh_place places[] = {{900000000, 0, 5}, {900030000, 0, 5}, {900000000, 60000, 5}};
    for (uint8_t i = 0; i < 3; i++) {
        set[i].place = places[i];
    }
}

static enum mh_status step(mh_tick time, size_t count)
{
    return mh_tracker_centroid.step(&centroid, time, set, count, &estimate);
}

static void assert_at(int32_t x_mm, int32_t y_mm)
{
    const struct mh_place at = mh_place_from_offset(&estimate.origin, estimate.stored);
    TEST_ASSERT_INT32_WITHIN(2, x_mm, at.x_mm);
    TEST_ASSERT_INT32_WITHIN(2, y_mm, at.y_mm);
    TEST_ASSERT_TRUE(estimate.stored.x == estimate.position.x);
}

static void mean_of_the_nodes(void)
{
    begin();
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(0, 0));
    TEST_ASSERT_EQUAL_INT(MH_OK, step(2000, 3));
    assert_at(900010000, 20000);
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_STARTED | MH_ESTIMATE_REFRESHED, estimate.flags);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 2500.0f / 12.0f, mh_real_to_float(estimate.covariance.xx));
    TEST_ASSERT_EQUAL_INT(MH_OK, step(4000, 2));
    assert_at(900015000, 0);
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_REFRESHED, estimate.flags);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(6000, 0));
    assert_at(900015000, 0);
    TEST_ASSERT_EQUAL_UINT8(MH_ESTIMATE_COASTED | MH_ESTIMATE_REFRESHED, estimate.flags);
    mh_tracker_centroid.restart(&centroid);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(8000, 1));
    assert_at(900000000, 0);
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, step(8000, 1));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_centroid.predict(&centroid, 9000, &estimate));
    assert_at(900000000, 0);
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, mh_tracker_centroid.predict(&centroid, 7999, &estimate));
}

static void of_the_strongest(void)
{
    struct mh_centroid_config config;
    mh_centroid_config_default(&config);
    config.strongest = MH_CENTROID_STRONGEST_MAX + 1;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_centroid.init(&centroid, &config, 2000));
    begin();
    centroid.config.strongest = 2;
    for (uint8_t i = 0; i < 3; i++) { /* the first and the last, then the last two; equals: the first two */
        set[i].value = i == 1 ? -5 : 7;
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, step(2000, 3));
    assert_at(900000000, 30000);
    TEST_ASSERT_EQUAL_UINT16(2, estimate.measurements);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 2500.0f / 8.0f, mh_real_to_float(estimate.covariance.xx));
    set[0].value = -6;
    TEST_ASSERT_EQUAL_INT(MH_OK, step(4000, 3));
    assert_at(900015000, 30000);
    set[0].value = set[1].value = set[2].value;
    TEST_ASSERT_EQUAL_INT(MH_OK, step(6000, 3));
    assert_at(900015000, 0);
    TEST_ASSERT_EQUAL_INT(MH_OK, step(8000, 2)); /* no more than those */
    assert_at(900015000, 0);
}

static void is_handed_over(void)
{
    uint8_t bytes[MH_TRACK_BYTES_MAX];
    size_t length;
    begin();
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_centroid.save(&centroid, bytes, &length));
    TEST_ASSERT_EQUAL_INT(MH_OK, step(2000, 3));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_centroid.save(&centroid, bytes, &length));
    TEST_ASSERT_EQUAL_size_t(12, length);
    begin();
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_tracker_centroid.load(&centroid, bytes, length - 1));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_centroid.load(&centroid, bytes, length));
    TEST_ASSERT_EQUAL_INT(MH_OK, step(4000, 0));
    assert_at(900010000, 20000);
    bytes[4] = 0x7F;
    begin();
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_tracker_centroid.load(&centroid, bytes, length));
    TEST_ASSERT_EQUAL_INT(MH_NONE, step(0, 0));
}

static void refuses_what_is_out_of_range(void)
{
    const struct mh_centroid_config bad = {mh_real_from_float(NAN), 0}, good = {MH_REAL(50.0f), 0};
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_centroid.init(&centroid, &bad, 2000));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_centroid.init(&centroid, &good, 0));
    begin();
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_centroid.step(&centroid, 0, NULL, 1, &estimate));
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_tracker_centroid.predict(&centroid, 0, &estimate));
}

/* from as far as another continent: the mean of all is as far as coordinates reach */
static void of_nodes_far_apart(void)
{
    begin();
    TEST_ASSERT_EQUAL_INT(MH_OK, step(0, 1));
    for (uint8_t i = 0; i < 3; i++) {
        set[i].place.x_mm =
            900000000 + 20000000 * i; /* 20 and 40 km: their sum is beyond what a fixed-point number holds */
        set[i].place.y_mm = 0;
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, step(2000, 3));
    assert_at(920000000, 0);
#if MH_REAL_FIXED
    const struct mh_centroid_state before = centroid;
    set[0].place.x_mm = -900000000;
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, step(4000, 1));
    TEST_ASSERT_EQUAL_MEMORY(&before, &centroid, sizeof centroid);
#endif
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(mean_of_the_nodes);
    RUN_TEST(of_the_strongest);
    RUN_TEST(of_nodes_far_apart);
    RUN_TEST(is_handed_over);
    RUN_TEST(refuses_what_is_out_of_range);
    port_exit(UNITY_END() > 0);
    return 0;
}
