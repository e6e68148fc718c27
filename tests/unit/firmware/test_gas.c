#include "motehound/gas.h"
#include "port.h"
#include "unity.h"

#include <math.h>
#include <string.h>

void setUp(void) {}
void tearDown(void) {}

enum { INTERVAL = 5000, SENSORS = 9 };

/* 4 KB hold the tracker `gas` and what its step takes of the stack, but not the texts of its test besides. */
#ifdef __AVR__
enum { FIRST = 1 };
#else
enum { FIRST = 0 };
#define WITH_GAS
#endif

static union {
#ifdef WITH_GAS
    struct mh_gas gas;
#endif
    struct mh_gas_gaussian gaussian;
} state, heir;
static struct mh_measurement set[SENSORS];
static struct mh_estimate estimate;
static uint8_t track[MH_TRACK_BYTES_MAX + MH_GAS_RECORD_BYTES];

static const struct mh_tracker *const trackers[] = {&mh_tracker_gas, &mh_tracker_gas_small, &mh_tracker_gas_ekf,
                                                    &mh_tracker_gas_ukf};
enum { TRACKERS = sizeof trackers / sizeof trackers[0] };

/* The published field with its axis on y = 0. */
static struct mh_gas_config nominal(void)
{
    struct mh_gas_config config;
    mh_gas_config_default(&config);
    config.prior.y_mm = 0;
    config.area.y_min_mm = -200000;
    config.area.y_max_mm = 200000;
    return config;
}

static void begin(const struct mh_tracker *tracker, const struct mh_gas_config *config)
{
    TEST_ASSERT_EQUAL_INT(MH_OK, tracker->init(&state, config, INTERVAL));
}

/* Sensor i at (x, y), m from the field's origin, with this value. */
static void put(size_t i, mh_real x, mh_real y, mh_real value)
{
    static const struct mh_place origin = {0, 0, 0};
    const struct mh_vec2 at = {x, y};
    memset(&set[i], 0, sizeof set[i]);
    set[i].node = (mh_node_id)(i + 1);
    set[i].place = mh_place_from_offset(&origin, at);
    set[i].value = mh_q20_from_real(value);
}

/* The same with what it reads of a leak of 30 at (50, 0), and an error. */
static void put_in_plume(const struct mh_gas_config *config, size_t i, mh_real x, mh_real y, mh_real error)
{
    const struct mh_vec2 at = {x, y}, leak = {50, 0};
    mh_real c;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_model(&config->plume, at, leak, 0, &c, NULL));
    put(i, x, y, (30 * c + error) / config->unit);
}

/* Nine sensors on a square of 120 m from x = `low` on, which read the leak without noise. */
static void put_square_from(const struct mh_gas_config *config, mh_real low)
{
    for (size_t i = 0; i < SENSORS; i++) {
        put_in_plume(config, i, low + 60 * (mh_real)(i % 3), 60 * (mh_real)((int)(i / 3) - 1), 0);
    }
}

static void put_square(const struct mh_gas_config *config) { put_square_from(config, 90); }

/* Six sensors far downwind, noise 1e-4 in the pattern of a sine: what the filters make of the prior. */
static void known_answers(void)
{
    static const struct {
        const struct mh_tracker *tracker;
        mh_real x[3], P[6]; /* xx, yy, rate, x y, x rate, y rate */
        bool log;
    } known[] = {
        {&mh_tracker_gas_ekf,
         {246.603103f, 19.1536375f, 13.6306473f},
         {3079.89224f, 3863.63534f, 8.97428316f, -3255.53207f, -132.448297f, 119.647363f},
         false},
        {&mh_tracker_gas_ukf,
         {146.922601f, -1.74331308f, 33.6363211f},
         {4769.68334f, 14007.1867f, 50.3607532f, -188.029931f, -125.416111f, -68.4936334f},
         false},
        {&mh_tracker_gas_small,
         {148.657627f, 28.4523243f, 3.17242038f},
         {12164.7533f, 3943.32091f, 0.132047294f, -334.903865f, -37.4434442f, 6.11463767f},
         true},
    };
    struct mh_gas_config config = nominal();
    config.noise = 0.1f;
    for (size_t k = 0; k < 6; k++) {
        put_in_plume(&config, k, 430 + 12 * (mh_real)k, 30 * (mh_real)cos(1.3 * (double)k),
                     1e-4f * (mh_real)sin(2.0 * (double)k + 1.0));
    }
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        begin(known[i].tracker, &config);
        TEST_ASSERT_EQUAL_INT(MH_OK, known[i].tracker->step(&state, 1000, set, 6, &estimate));
        const mh_real rate = known[i].log ? mh_exp(known[i].x[2]) : known[i].x[2];
        const mh_real unit = known[i].log ? rate : 1;
        const mh_real *P = known[i].P;
        TEST_ASSERT_FLOAT_WITHIN(0.02f * known[i].x[0], known[i].x[0], 250 + estimate.position.x);
        TEST_ASSERT_FLOAT_WITHIN(0.02f * mh_abs(known[i].x[1]), known[i].x[1], estimate.position.y);
        TEST_ASSERT_FLOAT_WITHIN(0.02f * rate, rate, estimate.rate);
        TEST_ASSERT_FLOAT_WITHIN(0.02f * P[0], P[0], estimate.covariance.xx);
        TEST_ASSERT_FLOAT_WITHIN(0.02f * P[1], P[1], estimate.covariance.yy);
        TEST_ASSERT_FLOAT_WITHIN(0.02f * mh_abs(P[3]), P[3], estimate.covariance.xy);
        TEST_ASSERT_FLOAT_WITHIN(0.02f * unit * unit * P[2], unit * unit * P[2], estimate.covariance_more[2]);
        TEST_ASSERT_FLOAT_WITHIN(0.02f * unit * mh_abs(P[4]), unit * P[4], estimate.covariance_more[0]);
        TEST_ASSERT_FLOAT_WITHIN(0.02f * unit * mh_abs(P[5]), unit * P[5], estimate.covariance_more[1]);
        TEST_ASSERT_EQUAL_INT(3, estimate.states);
        TEST_ASSERT_EQUAL_INT(6, estimate.measurements);
        TEST_ASSERT_EQUAL_INT(MH_ESTIMATE_STARTED | MH_ESTIMATE_REFRESHED, estimate.flags);
    }
#ifdef WITH_GAS
    /* the most probable place of all is that of the search too */
    begin(&mh_tracker_gas, &config);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_gas.step(&state, 1000, set, 6, &estimate));
    TEST_ASSERT_FLOAT_WITHIN(0.02f * 148.7f, 148.657627f, 250 + estimate.position.x);
    TEST_ASSERT_FLOAT_WITHIN(0.02f * 28.5f, 28.4523243f, estimate.position.y);
#endif
}

#ifdef WITH_GAS
/* Nine good sensors in the plume or beside it settle it, whatever the way the wind blows. */
static void find_the_leak(void)
{
    static const struct mh_vec2 winds[] = {{1, 0}, {0, 1}, {-1, 0}, {0.6f, 0.8f}};
    for (size_t turn = 0; turn < sizeof winds / sizeof winds[0]; turn++) {
        struct mh_gas_config config = nominal();
        config.plume.downwind = winds[turn];
        put_square(&config);
        begin(&mh_tracker_gas, &config);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_gas.step(&state, 1000, set, SENSORS, &estimate));
        TEST_ASSERT_FLOAT_WITHIN(0.05f, 50, 250 + estimate.position.x);
        TEST_ASSERT_FLOAT_WITHIN(0.05f, 0, estimate.position.y);
        TEST_ASSERT_FLOAT_WITHIN(0.05f, 30, estimate.rate);
    }
}
#endif

/* Rates, prior and noise in another unit: the same places. */
static void units_do_not_matter(void)
{
    for (size_t t = FIRST; t < TRACKERS; t++) {
        struct mh_gas_config config = nominal();
        config.noise = 0.1f;
        put_square(&config);
        begin(trackers[t], &config);
        TEST_ASSERT_EQUAL_INT(MH_OK, trackers[t]->step(&state, 1000, set, SENSORS, &estimate));
        const struct mh_estimate before = estimate;
        config.unit *= 1024;
        config.prior_rate *= 1024;
        config.prior_rate_sd *= 1024;
        begin(trackers[t], &config);
        TEST_ASSERT_EQUAL_INT(MH_OK, trackers[t]->step(&state, 1000, set, SENSORS, &estimate));
        TEST_ASSERT_FLOAT_WITHIN(0.05f, before.position.x, estimate.position.x);
        TEST_ASSERT_FLOAT_WITHIN(0.05f, before.position.y, estimate.position.y);
        TEST_ASSERT_FLOAT_WITHIN(1e-3f * mh_abs(before.rate), before.rate, estimate.rate / 1024);
    }
}

static void handed_over_it_goes_on_as_if_it_had_stayed(void)
{
    for (size_t t = FIRST; t < TRACKERS; t++) {
        const struct mh_tracker *const tracker = trackers[t];
        struct mh_gas_config config = nominal();
        config.noise = 0.1f;
        put_square(&config);
        begin(tracker, &config);
        size_t length = 0;
        TEST_ASSERT_EQUAL_INT(MH_NONE, tracker->save(&state, track, &length));
        TEST_ASSERT_EQUAL_INT(MH_OK, tracker->step(&state, 1000, set, 5, &estimate));
        TEST_ASSERT_EQUAL_INT(MH_OK, tracker->save(&state, track, &length));
        TEST_ASSERT_EQUAL_size_t(t == 0 ? MH_GAS_HEADER_BYTES + 5 * MH_GAS_RECORD_BYTES : 36, length);
        TEST_ASSERT_EQUAL_INT(MH_OK, tracker->init(&heir, &config, INTERVAL));
        TEST_ASSERT_EQUAL_INT(MH_OK, tracker->load(&heir, track, length));
        struct mh_estimate other;
        TEST_ASSERT_EQUAL_INT(MH_OK, tracker->predict(&heir, 1000, &other));
        TEST_ASSERT_EQUAL_FLOAT(estimate.position.x, other.position.x);
        TEST_ASSERT_EQUAL_FLOAT(estimate.position.y, other.position.y);
        TEST_ASSERT_EQUAL_INT(t == 0 ? 0 : 3, other.states);
        TEST_ASSERT_EQUAL_INT(MH_OK, tracker->step(&state, 2000, set + 3, 4, &estimate));
        TEST_ASSERT_EQUAL_INT(MH_OK, tracker->step(&heir, 2000, set + 3, 4, &other));
        TEST_ASSERT_EQUAL_FLOAT(estimate.position.x, other.position.x);
        TEST_ASSERT_EQUAL_FLOAT(estimate.position.y, other.position.y);
        TEST_ASSERT_EQUAL_FLOAT(estimate.rate, other.rate);
        TEST_ASSERT_EQUAL_FLOAT(estimate.covariance.xx, other.covariance.xx);
        TEST_ASSERT_EQUAL_INT(estimate.flags, other.flags);
    }
}

static void set_real(size_t at, mh_real value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    for (int i = 0; i < 4; i++) {
        track[at + (size_t)i] = (uint8_t)(bits >> (24 - 8 * i));
    }
}

static void refuse(const struct mh_tracker *tracker, size_t length)
{
    struct mh_gas_config config = nominal();
    config.noise = 0.1f;
    begin(tracker, &config);
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, tracker->load(&state, track, length));
    TEST_ASSERT_EQUAL_INT(MH_NONE, tracker->predict(&state, 0, &estimate));
    TEST_ASSERT_EQUAL_INT(MH_NONE, tracker->save(&state, track, &length));
}

static size_t saved(const struct mh_tracker *tracker, size_t sensors)
{
    struct mh_gas_config config = nominal();
    config.noise = 0.1f;
    size_t length = 0;
    put_square(&config);
    begin(tracker, &config);
    TEST_ASSERT_EQUAL_INT(MH_OK, tracker->step(&state, 1000, set, sensors, &estimate));
    TEST_ASSERT_EQUAL_INT(MH_OK, tracker->save(&state, track, &length));
    return length;
}

static void what_is_no_gaussian_is_refused(void)
{
    for (size_t t = 1; t < TRACKERS; t++) {
        static const struct {
            size_t at;
            mh_real value;
        } wrong[] = {{0, NAN},  {4, INFINITY}, {8, NAN}, {0, 2e5f},  {4, -2e5f}, {12, 0},         {12, -1},
                     {20, NAN}, {32, 0},       {32, -3}, {16, 1e6f}, {28, 1e9f}, {12, 3e38f * 10}};
        saved(trackers[t], SENSORS);
        refuse(trackers[t], 35);
        saved(trackers[t], SENSORS);
        refuse(trackers[t], 0);
        saved(trackers[t], SENSORS);
        refuse(trackers[t], 37);
        for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
            saved(trackers[t], SENSORS);
            set_real(wrong[i].at, wrong[i].value);
            refuse(trackers[t], MH_GAS_SAVED);
        }
    }
}

#ifdef WITH_GAS
static void what_are_no_data_is_refused(void)
{
    static const struct {
        size_t at;
        mh_real value;
    } wrong[] = {{0, NAN}, {0, 2e5f}, {8, 1e4f}, {8, NAN}, {24, NAN}, {24, 1e4f}, {40, -INFINITY}};
    const size_t length = saved(&mh_tracker_gas, 3);
    TEST_ASSERT_EQUAL_size_t(60, length);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        saved(&mh_tracker_gas, 3);
        set_real(wrong[i].at, wrong[i].value);
        refuse(&mh_tracker_gas, length);
    }
    saved(&mh_tracker_gas, 3);
    refuse(&mh_tracker_gas, length - 1);
    saved(&mh_tracker_gas, 3);
    refuse(&mh_tracker_gas, MH_GAS_HEADER_BYTES);
    saved(&mh_tracker_gas, 3);
    track[12 + 3] = track[28 + 3]; /* a node twice */
    refuse(&mh_tracker_gas, length);
    saved(&mh_tracker_gas, 3);
    track[23] = 0; /* no sample */
    refuse(&mh_tracker_gas, length);
    memset(track, 0, sizeof track);
    refuse(&mh_tracker_gas, MH_GAS_HEADER_BYTES + (size_t)(MH_GAS_SENSORS_MAX + 1) * MH_GAS_RECORD_BYTES);
}
#endif

static void time_and_silence(void)
{
    struct mh_gas_config config = nominal();
    config.noise = 0.1f;
    put_square(&config);
    for (size_t t = FIRST; t < TRACKERS; t++) {
        const struct mh_tracker *const tracker = trackers[t];
        begin(tracker, &config);
        TEST_ASSERT_EQUAL_INT(MH_NONE, tracker->predict(&state, 1000, &estimate));
        TEST_ASSERT_EQUAL_INT(MH_NONE, tracker->step(&state, 1000, NULL, 0, &estimate));
        TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, tracker->step(&state, 1000, set, SENSORS, &estimate));
        TEST_ASSERT_EQUAL_INT(MH_OK, tracker->step(&state, 2000, set, SENSORS, &estimate));
        const struct mh_vec2 found = estimate.position;
        TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, tracker->step(&state, 1999, set, SENSORS, &estimate));
        TEST_ASSERT_EQUAL_INT(MH_OK, tracker->step(&state, 3000, NULL, 0, &estimate));
        TEST_ASSERT_EQUAL_INT(MH_ESTIMATE_COASTED, estimate.flags);
        TEST_ASSERT_EQUAL_INT(0, estimate.measurements);
        TEST_ASSERT_EQUAL_FLOAT(found.x, estimate.position.x);
        TEST_ASSERT_EQUAL_FLOAT(found.y, estimate.position.y);
        TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, tracker->predict(&state, 2999, &estimate));
        TEST_ASSERT_EQUAL_INT(MH_OK, tracker->predict(&state, 9000, &estimate));
        TEST_ASSERT_EQUAL_FLOAT(found.x, estimate.position.x);
        tracker->restart(&state);
        TEST_ASSERT_EQUAL_INT(MH_NONE, tracker->predict(&state, 9000, &estimate));
        TEST_ASSERT_EQUAL_INT(MH_OK, tracker->step(&state, 9000, set, SENSORS, &estimate));
        TEST_ASSERT_TRUE(estimate.flags & MH_ESTIMATE_STARTED);
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, found.x, estimate.position.x);
    }
}

static void winds_are_no_samples(void)
{
    const struct mh_gas_config config = nominal();
    put_square(&config);
    set[0].target = MH_TARGET_WIND_X;
    set[1].target = MH_TARGET_WIND_Y;
    for (size_t t = FIRST; t < TRACKERS; t++) {
        begin(trackers[t], &config);
        TEST_ASSERT_EQUAL_INT(MH_NONE, trackers[t]->step(&state, 1000, set, 2, &estimate));
        TEST_ASSERT_EQUAL_INT(MH_OK, trackers[t]->step(&state, 2000, set, 3, &estimate));
        TEST_ASSERT_EQUAL_INT(1, estimate.measurements);
    }
}

static void check_sound(void)
{
    const mh_real *more = estimate.covariance_more;
    TEST_ASSERT_TRUE(mh_finite(estimate.position.x) && mh_finite(estimate.position.y) && mh_finite(estimate.rate));
    TEST_ASSERT_TRUE(estimate.covariance.xx > 0 && estimate.covariance.yy > 0 && more[2] >= 0);
    TEST_ASSERT_TRUE(mh_finite(estimate.covariance.xx) && mh_finite(estimate.covariance.yy) && mh_finite(more[2]));
    TEST_ASSERT_TRUE(mh_squared(estimate.covariance.xy) <= 1.0001f * estimate.covariance.xx * estimate.covariance.yy);
}

/* A lone sensor at the estimate; none that reads anything; all below zero; all at the end of the scale; noise, with a new sign each time. */
static void hostile_samples(void)
{
    const struct mh_gas_config config = nominal();
    for (size_t t = FIRST; t < TRACKERS; t++) {
        const struct mh_tracker *const tracker = trackers[t];
        for (int what = 0; what < 5; what++) {
            begin(tracker, &config);
            for (mh_tick step = 1; step <= 4; step++) {
                size_t count = SENSORS;
                put_square(&config);
                for (size_t i = 0; i < SENSORS; i++) {
                    const mh_q20 wild = (i + step) % 2 == 0 ? INT32_MAX : INT32_MIN;
                    set[i].value = what == 1 ? 0 : what == 2 ? -MH_Q20_ONE : what == 3 ? INT32_MAX : wild;
                }
                if (what == 0) {
                    count = 1;
                    put(0, 250, 0, 2);
                    if (step > 1) {
                        set[0].place = mh_place_from_offset(&estimate.origin, estimate.position);
                    }
                }
                const enum mh_status status = tracker->step(&state, step * INTERVAL, set, count, &estimate);
                TEST_ASSERT_TRUE(status == MH_OK || status == MH_NONE);
                if (status == MH_OK) {
                    mh_real score;
                    check_sound();
                    TEST_ASSERT_EQUAL_INT(MH_OK, tracker->score(&state, 1, &set[0].place, 1, &score));
                    TEST_ASSERT_TRUE(mh_finite(score));
                }
            }
        }
    }
}

/* Calm: it has not moved since the step before, and where that counts it is sure. */
static void calm_when_it_has_settled(void)
{
    struct mh_gas_config config = nominal();
    put_square_from(&config, 300);
    for (size_t t = FIRST; t < TRACKERS; t++) {
        begin(trackers[t], &config);
        TEST_ASSERT_EQUAL_INT(MH_OK, trackers[t]->step(&state, 1000, set, SENSORS, &estimate));
        TEST_ASSERT_FALSE(estimate.flags & MH_ESTIMATE_CALM);
        for (mh_tick step = 2; step < 10; step++) {
            TEST_ASSERT_EQUAL_INT(MH_OK, trackers[t]->step(&state, step * 1000, set, SENSORS, &estimate));
        }
        TEST_ASSERT_TRUE(estimate.flags & MH_ESTIMATE_CALM);
        TEST_ASSERT_EQUAL_INT(MH_OK, trackers[t]->step(&state, 20000, NULL, 0, &estimate));
        TEST_ASSERT_FALSE(estimate.flags & MH_ESTIMATE_CALM); /* nothing was heard */
    }
    config.calm_sd_m = 1e-3f;
    for (size_t t = FIRST; t < TRACKERS; t++) {
        begin(trackers[t], &config);
        for (mh_tick step = 1; step < 10; step++) {
            TEST_ASSERT_EQUAL_INT(MH_OK, trackers[t]->step(&state, step * 1000, set, SENSORS, &estimate));
        }
        TEST_ASSERT_EQUAL_INT(t < 2 ? 0 : MH_ESTIMATE_CALM, estimate.flags & MH_ESTIMATE_CALM);
    }
}

static mh_real determinant(const mh_real *A) /* of a symmetric matrix, packed */
{
    return A[0] * (A[2] * A[5] - A[4] * A[4]) - A[1] * (A[1] * A[5] - A[4] * A[3]) + A[3] * (A[1] * A[4] - A[2] * A[3]);
}

/* The information that a neighbourhood adds, by the matrix itself. */
static void score_of_information(void)
{
    static const mh_real x[] = {-200, 0, 3.4f}, sd[] = {20, 30, 0.2f};
    struct mh_gas_config config = nominal();
    config.noise = 0.3f;
    mh_real A[6] = {0};
    mh_real before = 1;
    struct mh_place places[3];
    begin(&mh_tracker_gas_small, &config);
    for (int i = 0; i < 3; i++) {
        set_real(4 * (size_t)i, x[i]);
        A[MH_PACKED(i, i)] = 1 / (sd[i] * sd[i]);
        before *= A[MH_PACKED(i, i)];
        for (int j = 0; j <= i; j++) {
            set_real(12 + 4 * (size_t)MH_PACKED(j, i), i == j ? sd[i] * sd[i] : 0);
        }
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_gas_small.load(&state, track, MH_GAS_SAVED));
    for (int k = 0; k < 3; k++) {
        const struct mh_vec2 at = {-150 + 50 * (mh_real)k, 40 - 35 * (mh_real)k}, leak = {x[0], x[1]};
        struct mh_vec2 slope;
        mh_real c;
        places[k] = mh_place_from_offset(&config.prior, at);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_plume_model(&config.plume, at, leak, 1300, &c, &slope));
        const mh_real unit = mh_exp(x[2]) / (config.unit * config.noise);
        const mh_real h[] = {unit * slope.x, unit * slope.y, unit * c};
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j <= i; j++) {
                A[MH_PACKED(j, i)] += h[i] * h[j];
            }
        }
    }
    mh_real score;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_gas_small.score(&state, 7, places, 3, &score));
    TEST_ASSERT_FLOAT_WITHIN(0.5f / 16 + 1e-2f, mh_log(determinant(A) / before), score); /* in steps of 1 / 16 */
}

static void scores_choose_the_next_head(void)
{
    struct mh_gas_config config = nominal();
    config.noise = 0.1f;
    put_square_from(&config, 300);
    for (size_t t = FIRST; t < TRACKERS; t++) {
        mh_real first, again, other;
        begin(trackers[t], &config);
        TEST_ASSERT_EQUAL_INT(MH_NONE, trackers[t]->score(&state, 1, &set[0].place, 1, &first));
        TEST_ASSERT_EQUAL_INT(MH_OK, trackers[t]->step(&state, 1000, set, SENSORS, &estimate));
        TEST_ASSERT_EQUAL_INT(MH_OK, trackers[t]->score(&state, 1, &set[0].place, 1, &first));
        TEST_ASSERT_EQUAL_INT(MH_OK, trackers[t]->score(&state, 99, &set[0].place, 1, &again));
        TEST_ASSERT_EQUAL_INT(MH_OK, trackers[t]->score(&state, 99, &set[8].place, 1, &other));
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, t == 0 ? 0.5f : 0, again - first); /* node 1 was head */
        TEST_ASSERT_TRUE(again > other);                                   /* nearer to the leak */
        TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, trackers[t]->score(&state, 1, &set[0].place, 0, &first));
    }
    const struct mh_vec2 by = {estimate.position.x + 30, estimate.position.y - 40};
    const struct mh_place place = mh_place_from_offset(&config.prior, by);
    mh_real score;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_gas_ukf.score(&state, 1, &place, 1, &score));
    TEST_ASSERT_FLOAT_WITHIN(0.01f, -50, score);
}

#ifdef WITH_GAS
/* More sensors than there is room for: those that read the plume best are kept, and the answer is as good. */
static void those_that_tell_least_give_way(void)
{
    const struct mh_gas_config config = nominal();
    const struct mh_tracker *const tracker = &mh_tracker_gas;
    begin(tracker, &config);
    put_square(&config);
    TEST_ASSERT_EQUAL_INT(MH_OK, tracker->step(&state, 1000, set, SENSORS, &estimate));
    mh_tick step = 2;
    for (int far = 0; far < MH_GAS_SENSORS_MAX + SENSORS; far += SENSORS) {
        for (size_t i = 0; i < SENSORS; i++) {
            put(i, 5000 + 10 * (mh_real)i, (mh_real)far, 0);
            set[i].node = (mh_node_id)(100 + far + (int)i);
        }
        TEST_ASSERT_EQUAL_INT(MH_OK, tracker->step(&state, 1000 * step++, set, SENSORS, &estimate));
    }
    TEST_ASSERT_EQUAL_INT(MH_GAS_SENSORS_MAX, state.gas.count);
    size_t length;
    TEST_ASSERT_EQUAL_INT(MH_OK, tracker->save(&state, track, &length));
    TEST_ASSERT_TRUE(length <= MH_TRACK_BYTES_MAX && length > MH_TRACK_BYTES_MAX - MH_GAS_RECORD_BYTES);
    begin(tracker, &config);
    TEST_ASSERT_EQUAL_INT(MH_OK, tracker->load(&state, track, length));
    int kept = 0;
    for (uint16_t i = 0; i < state.gas.count; i++) {
        kept += state.gas.sensors[i].node <= SENSORS;
    }
    const int room = (MH_TRACK_BYTES_MAX - MH_GAS_HEADER_BYTES) / MH_GAS_RECORD_BYTES;
    TEST_ASSERT_EQUAL_INT(room < SENSORS ? room : SENSORS, kept);
    TEST_ASSERT_EQUAL_INT(MH_OK, tracker->step(&state, 1000, set, 1, &estimate));
    TEST_ASSERT_FLOAT_WITHIN(1, 50, 250 + estimate.position.x);
    TEST_ASSERT_FLOAT_WITHIN(1, 0, estimate.position.y);
}

/* A node that was put elsewhere begins anew; one too far away is left out. */
static void places_of_sensors(void)
{
    const struct mh_gas_config config = nominal();
    put_square(&config);
    begin(&mh_tracker_gas, &config);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_gas.step(&state, 1000, set, 3, &estimate));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_gas.step(&state, 2000, set, 3, &estimate));
    TEST_ASSERT_EQUAL_INT(2, state.gas.sensors[0].samples);
    TEST_ASSERT_EQUAL_INT(2, state.gas.sensors[0].heads);
    TEST_ASSERT_EQUAL_INT(0, state.gas.sensors[1].heads);
    set[0].place.x_mm += 1000;
    set[1].place.x_mm += 9000000;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_gas.step(&state, 3000, set, 2, &estimate));
    TEST_ASSERT_EQUAL_INT(1, state.gas.sensors[0].samples);
    TEST_ASSERT_EQUAL_INT(1, estimate.measurements);
    TEST_ASSERT_EQUAL_INT(3, state.gas.count);
}
#endif

static void wrong_settings_are_refused(void)
{
    for (int what = 0; what < 12; what++) {
        struct mh_gas_config config = nominal();
        mh_real *const values[] = {&config.plume.diffusion_m2ps,
                                   &config.plume.wind_mps,
                                   &config.plume.downwind.x,
                                   &config.noise,
                                   &config.unit,
                                   &config.prior_sd_m.x,
                                   &config.prior_sd_m.y,
                                   &config.prior_rate,
                                   &config.prior_rate_sd,
                                   &config.calm_step_m,
                                   &config.calm_sd_m};
        if (what < 11) {
            *values[what] = what % 2 == 0 ? NAN : -1;
        } else {
            config.area.x_max_mm = config.area.x_min_mm;
        }
        for (size_t t = FIRST; t < TRACKERS; t++) {
            TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, trackers[t]->init(&state, &config, INTERVAL));
        }
    }
    const struct mh_gas_config config = nominal();
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_gas.init(&state, &config, 0));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_gas_ukf.init(&state, NULL, 1));
    struct mh_gas_config narrow = config;
    narrow.ukf.alpha = 0.05f;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_gas_ukf.init(&state, &narrow, 1));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_tracker_gas_ekf.init(NULL, &config, 1));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(known_answers);
#ifdef WITH_GAS
    RUN_TEST(find_the_leak);
#endif
    RUN_TEST(units_do_not_matter);
    RUN_TEST(handed_over_it_goes_on_as_if_it_had_stayed);
    RUN_TEST(what_is_no_gaussian_is_refused);
#ifdef WITH_GAS
    RUN_TEST(what_are_no_data_is_refused);
#endif
    RUN_TEST(time_and_silence);
    RUN_TEST(winds_are_no_samples);
    RUN_TEST(hostile_samples);
    RUN_TEST(calm_when_it_has_settled);
    RUN_TEST(score_of_information);
    RUN_TEST(scores_choose_the_next_head);
#ifdef WITH_GAS
    RUN_TEST(those_that_tell_least_give_way);
    RUN_TEST(places_of_sensors);
#endif
    RUN_TEST(wrong_settings_are_refused);
    port_exit(UNITY_END() > 0);
    return 0;
}
