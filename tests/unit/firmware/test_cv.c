#include "motehound/cv.h"
#include "motehound/spread.h"
#include "port.h"
#include "unity.h"

#include <string.h>

enum { TICK = 500 };

static struct mh_cv_config config;
static struct mh_cv state;
static struct mh_estimate estimate;

void setUp(void)
{
    mh_cv_config_default(&config);
    memset(&estimate, 0, sizeof estimate);
}

void tearDown(void) {}

static void begin(const struct mh_tracker *tracker, struct mh_cv *of)
{
    TEST_ASSERT_EQUAL(MH_OK, tracker->init(of, &config, TICK));
}

static struct mh_measurement sample(mh_node_id node, int32_t x_mm, int32_t y_mm, mh_tick time, mh_real range)
{
    const struct mh_measurement m = {
        .node = node, .place = {x_mm, y_mm, 0}, .time = time, .value = mh_q20_from_real(range)};
    return m;
}

static mh_real distance(int32_t x_mm, int32_t y_mm, mh_real x, mh_real y)
{
    const mh_real dx = x - (mh_real)x_mm * 0.001f, dy = y - (mh_real)y_mm * 0.001f;
    return mh_sqrt(dx * dx + dy * dy);
}

/* ---- one update ---- */

struct anchor {
    int32_t x_mm, y_mm;
};

static const struct anchor cluster_1[] = {{40000, 25000}, {17500, 37990}, {17500, 12010}};
static const struct anchor cluster_4[] = {{78338, 89624}, {64004, 85203}, {60666, 70579},
                                          {71662, 60376}, {85996, 64797}, {89334, 79421}};

/* What the update from the start, predicted by two ticks, gives: mean, covariance row by row. */
static const struct answer {
    const struct mh_tracker *tracker;
    const struct anchor *anchors;
    uint8_t count;
    mh_real variance, mean[4], covariance[10];
} answers[] = {
    {&mh_tracker_cv_ukf,
     cluster_1,
     3,
     0.02f,
     {10.8967470f, 0.803722172f, 20.4301199f, 0.593462164f},
     {0.0171143629f, 0.000658445481f, -0.000693243604f, -2.66794792e-05f, 0.0385109209f, -2.66713474e-05f,
      -1.02644678e-06f, 0.0132805673f, 0.000511102614f, 0.0385293077f}},
    {&mh_tracker_cv_ekf,
     cluster_1,
     3,
     0.02f,
     {10.8788931f, 0.803035275f, 20.4348867f, 0.593645615f},
     {0.0132934214f, 0.000511441374f, 1.84671892e-05f, 7.10709754e-07f, 0.0385052652f, 7.10493133e-07f, 2.73433273e-08f,
      0.0130382214f, 0.000501775934f, 0.0385289488f}},
    {&mh_tracker_cv_ukf,
     cluster_4,
     6,
     0.03f,
     {10.8469790f, 0.801807434f, 20.5698273f, 0.598838803f},
     {0.103996465f, 0.00400108394f, -0.116606723f, -0.00448760957f, 0.0386395231f, -0.00448624177f, -0.000172653009f,
      0.142771803f, 0.00549457267f, 0.0387210965f}},
    {&mh_tracker_cv_ekf,
     cluster_4,
     6,
     0.03f,
     {10.8422264f, 0.801624590f, 20.5658013f, 0.598683855f},
     {0.103860974f, 0.00399587115f, -0.116601811f, -0.00448742055f, 0.0386393226f, -0.00448605280f, -0.000172645736f,
      0.142660422f, 0.00549028616f, 0.0387209316f}},
};

static void one_update_is_the_published_one(void)
{
    static const mh_real sines[] = {0.841470985f, 0.141120008f, -0.958924275f,
                                    0.656986599f, 0.412118485f, -0.999990207f};
    for (size_t a = 0; a < sizeof answers / sizeof answers[0]; a++) {
        const struct answer *answer = &answers[a];
        struct mh_measurement set[6];
        if (answer->count > MH_STACKED_MAX) {
            continue; /* in two updates it would be another number */
        }
        config.variance = answer->variance;
        begin(answer->tracker, &state);
        for (uint8_t i = 0; i < answer->count; i++) {
            const struct anchor *at = &answer->anchors[i];
            set[i] =
                sample(i, at->x_mm, at->y_mm, 2 * TICK, distance(at->x_mm, at->y_mm, 10.9f, 20.5f) + 0.1f * sines[i]);
        }
        TEST_ASSERT_EQUAL(MH_OK, answer->tracker->step(&state, 2 * TICK, set, answer->count, &estimate));
        TEST_ASSERT_EQUAL(answer->count, estimate.measurements);
        TEST_ASSERT_EQUAL(MH_ESTIMATE_STARTED, estimate.flags);
        TEST_ASSERT_EQUAL(4, estimate.states);
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, answer->mean[0], estimate.position.x);
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, answer->mean[1], estimate.velocity.x);
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, answer->mean[2], estimate.position.y);
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, answer->mean[3], estimate.velocity.y);
        const mh_real *P = answer->covariance, *more = estimate.covariance_more;
        const mh_real expected[] = {P[0], P[2], P[7], P[1], P[5], P[4], P[3], P[8], P[6], P[9]};
        const mh_real stated[] = {estimate.covariance.xx,
                                  estimate.covariance.xy,
                                  estimate.covariance.yy,
                                  more[0],
                                  more[1],
                                  more[2],
                                  more[3],
                                  more[4],
                                  more[5],
                                  more[6]};
        for (int i = 0; i < 10; i++) { /* places are rounded to 1 mm; elements that cancel know that of the others */
            TEST_ASSERT_FLOAT_WITHIN(1e-3f * mh_abs(expected[i]) + 3e-6f, expected[i], stated[i]);
        }
    }
}

/* ---- many, at different rates ---- */

enum {
    NODES = 4,
    STEPS = 24,
    LAG = 2,
    AT_ONCE = 7
}; /* of three ticks at most two are even and one is a third: six samples, and one to look at */

static const struct anchor anchors[NODES] = {{25000, 40000}, {-3000, 9000}, {31000, 5000}, {2000, 44000}};
static const uint8_t periods[NODES] = {2, 2, 3, 3}; /* ticks */

/* The noisy range of a node at tick k after `start`, if it samples then. */
static bool measures(mh_tick start, uint8_t node, int k, struct mh_measurement *m)
{
    const mh_real t = 0.5f * (mh_real)k;
    const struct anchor *at = &anchors[node];
    const mh_real noise = (mh_real)((k * 7 + node * 5) % 11 - 5) * 0.03f;
    *m = sample(node, at->x_mm, at->y_mm, start + (mh_tick)k * TICK,
                distance(at->x_mm, at->y_mm, 10.3f + 0.9f * t, 19.5f + 0.5f * t) + noise);
    return k >= 1 && k % periods[node] == 0;
}

/* How many ticks late it comes. */
static int delay(uint8_t node, int k, uint32_t salt)
{
    return salt == 0 ? 0 : (int)mh_spread(node, (uint32_t)k * 4 + salt, LAG + 1);
}

/* Samples in the order of arrival, salt 0: without delay. The last LAG ticks bring only what is late. */
static void run(const struct mh_tracker *tracker, uint32_t salt)
{
    const mh_tick start = config.start;
    begin(tracker, &state);
    for (int k = 1; k <= STEPS + LAG; k++) {
        struct mh_measurement set[AT_ONCE];
        size_t count = 0;
        for (int d = 0; d <= LAG; d++) {
            for (uint8_t node = 0; node < NODES; node++) {
                count += k - d <= STEPS && delay(node, k - d, salt) == d && measures(start, node, k - d, &set[count]);
            }
        }
        TEST_ASSERT_EQUAL(MH_OK, tracker->step(&state, start + (mh_tick)k * TICK, set, count, &estimate));
        TEST_ASSERT_EQUAL(count, estimate.measurements);
    }
}

/* A summary says all that a track knows. */
static void note(const struct mh_tracker *tracker, uint8_t *bytes)
{
    size_t length;
    TEST_ASSERT_EQUAL(MH_OK, tracker->summarise(&state, config.start + (STEPS + LAG + 1) * TICK, bytes, &length));
    TEST_ASSERT_EQUAL(57, length);
}

static void whatever_the_order_the_result_is_that_of_samples_in_time(void)
{
    const struct mh_tracker *const trackers[] = {&mh_tracker_cv_ukf, &mh_tracker_cv_ekf};
    for (int t = 0; t < 2; t++) {
        uint8_t in_time[57], late[57];
        config.lag = 0;
        run(trackers[t], 0);
        note(trackers[t], in_time);
        TEST_ASSERT_EQUAL_UINT32(0, state.counters.reordered);
        config.lag = LAG * TICK;
        for (uint32_t salt = 0; salt < 4; salt++) {
            run(trackers[t], salt);
            note(trackers[t], late);
            TEST_ASSERT_EQUAL_MEMORY(in_time, late, 57);
            TEST_ASSERT_EQUAL_UINT32(2 * (STEPS / 2) + 2 * (STEPS / 3), state.counters.taken);
            TEST_ASSERT_TRUE((state.counters.reordered > 0) == (salt > 0));
            TEST_ASSERT_EQUAL_UINT32(0, state.counters.late + state.counters.hurried + state.counters.failed);
        }
    }
}

static void a_track_across_the_wrap_of_time_is_the_same(void)
{
    uint8_t here[57], there[57];
    config.lag = LAG * TICK;
    run(&mh_tracker_cv_ukf, 1);
    note(&mh_tracker_cv_ukf, here);
    config.start = (mh_tick)0 - 9 * TICK;
    run(&mh_tracker_cv_ukf, 1);
    note(&mh_tracker_cv_ukf, there);
    TEST_ASSERT_EQUAL_MEMORY(here, there, 57);
}

static void what_is_late_early_or_repeated_is_refused_and_counted(void)
{
    uint8_t before[57], after[57];
    struct mh_measurement set[NODES];
    config.lag = LAG * TICK;
    run(&mh_tracker_cv_ukf, 1);
    note(&mh_tracker_cv_ukf, before);
    const mh_tick last = (STEPS + LAG) * TICK, next = last + TICK / 2;
    (void)measures(0, 0, STEPS, &set[0]); /* kept no longer: just too late */
    (void)measures(0, 1, 3, &set[1]);
    (void)measures(0, 2, STEPS + 2, &set[2]);
    set[2].time = next + 1;
    TEST_ASSERT_EQUAL(MH_OK, mh_tracker_cv_ukf.step(&state, next, set, 3, &estimate));
    TEST_ASSERT_EQUAL(MH_ESTIMATE_COASTED, estimate.flags);
    TEST_ASSERT_EQUAL(0, estimate.measurements);
    TEST_ASSERT_EQUAL_UINT32(2, state.counters.late);
    TEST_ASSERT_EQUAL_UINT32(1, state.counters.early);
    note(&mh_tracker_cv_ukf, after);
    TEST_ASSERT_EQUAL_MEMORY(before, after, 57);

    TEST_ASSERT_EQUAL(MH_ERR_TIME, mh_tracker_cv_ukf.step(&state, next, set, 0, &estimate));
    TEST_ASSERT_EQUAL(MH_ERR_TIME, mh_tracker_cv_ukf.step(&state, last, set, 0, &estimate));
    set[3] = set[2]; /* now in time, twice, and with another value */
    set[3].value++;
    TEST_ASSERT_EQUAL(MH_OK, mh_tracker_cv_ukf.step(&state, next + 1, set + 2, 2, &estimate));
    TEST_ASSERT_EQUAL(1, estimate.measurements);
    TEST_ASSERT_EQUAL_UINT32(1, state.counters.repeated);
    set[3].target = 1; /* another target's: nothing of the kind */
    TEST_ASSERT_EQUAL(MH_OK, mh_tracker_cv_ukf.step(&state, next + 2, set + 3, 1, &estimate));
    TEST_ASSERT_EQUAL_UINT32(1, state.counters.repeated);
}

/* With more samples to keep than there is room for, the oldest are settled early: the same result if they came in order. */
static void without_room_the_oldest_are_settled(void)
{
    uint8_t settled[57], in_time[57];
    for (int pass = 0; pass < 2; pass++) {
        config.lag = pass == 0 ? 0 : 3600000u;
        begin(&mh_tracker_cv_ekf, &state);
        for (int k = 1; k <= 2 * MH_CV_SAMPLES_MAX; k++) {
            const mh_real range = distance(25000, 40000, 10 + 0.4f * (mh_real)k, 20 + 0.3f * (mh_real)k);
            const struct mh_measurement m = sample((mh_node_id)(k % 3), 25000, 40000, (mh_tick)k * TICK, range);
            TEST_ASSERT_EQUAL(MH_OK, mh_tracker_cv_ekf.step(&state, (mh_tick)k * TICK, &m, 1, &estimate));
        }
        size_t length;
        TEST_ASSERT_EQUAL(MH_OK,
                          mh_tracker_cv_ekf.summarise(&state, state.time, pass == 0 ? in_time : settled, &length));
    }
    TEST_ASSERT_EQUAL_MEMORY(in_time, settled, 57);
    TEST_ASSERT_EQUAL_UINT32(MH_CV_SAMPLES_MAX, state.counters.hurried);
    const struct mh_measurement old = sample(7, 25000, 40000, MH_CV_SAMPLES_MAX * TICK, 1);
    TEST_ASSERT_EQUAL(MH_OK, mh_tracker_cv_ekf.step(&state, state.time + 1, &old, 1, &estimate));
    TEST_ASSERT_EQUAL_UINT32(1, state.counters.late);
}

static void a_saved_track_goes_on_elsewhere(void)
{
    uint8_t saved[MH_CV_SAVED], there[57], here[57];
    size_t length = 0;
    config.lag = 0;
    begin(&mh_tracker_cv_ukf, &state);
    TEST_ASSERT_EQUAL(MH_NONE, mh_tracker_cv_ukf.save(&state, saved, &length));
    for (int k = 1; k <= STEPS; k++) {
        struct mh_measurement m;
        (void)measures(0, (uint8_t)(k % NODES), k, &m);
        if (k == STEPS / 2) {
            TEST_ASSERT_EQUAL(MH_OK, mh_tracker_cv_ukf.save(&state, saved, &length));
            TEST_ASSERT_EQUAL(MH_CV_SAVED, length);
        }
        TEST_ASSERT_EQUAL(MH_OK, mh_tracker_cv_ukf.step(&state, (mh_tick)k * TICK, &m, 1, &estimate));
    }
    note(&mh_tracker_cv_ukf, here);
    begin(&mh_tracker_cv_ukf, &state);
    TEST_ASSERT_EQUAL(MH_OK, mh_tracker_cv_ukf.load(&state, saved, length));
    TEST_ASSERT_EQUAL(MH_NONE, mh_tracker_cv_ukf.step(&state, TICK, NULL, 0, &estimate)); /* before it */
    for (int k = STEPS / 2; k <= STEPS; k++) {
        struct mh_measurement m;
        (void)measures(0, (uint8_t)(k % NODES), k, &m);
        TEST_ASSERT_EQUAL(MH_OK, mh_tracker_cv_ukf.step(&state, (mh_tick)k * TICK, &m, 1, &estimate));
    }
    note(&mh_tracker_cv_ukf, there);
    TEST_ASSERT_EQUAL_MEMORY(here, there, 57);
    begin(&mh_tracker_cv_ukf, &state);
    TEST_ASSERT_EQUAL(MH_ERR_CORRUPT, mh_tracker_cv_ukf.load(&state, saved, MH_CV_SAVED - 1));
    memset(saved + 20, 0, 4); /* a variance of 0 */
    TEST_ASSERT_EQUAL(MH_ERR_CORRUPT, mh_tracker_cv_ukf.load(&state, saved, MH_CV_SAVED));
    memset(saved, 0xFF, 4); /* before the start */
    TEST_ASSERT_EQUAL(MH_ERR_CORRUPT, mh_tracker_cv_ukf.load(&state, saved, MH_CV_SAVED));
}

/* ---- prediction ---- */

static void without_samples_the_start_is_predicted(void)
{
    struct mh_estimate later;
    begin(&mh_tracker_cv_ukf, &state);
    TEST_ASSERT_EQUAL(MH_NONE, mh_tracker_cv_ukf.predict(&state, 0, &estimate)); /* not stepped yet */
    TEST_ASSERT_EQUAL(MH_OK, mh_tracker_cv_ukf.step(&state, 4 * TICK, NULL, 0, &estimate));
    TEST_ASSERT_EQUAL(MH_ESTIMATE_STARTED | MH_ESTIMATE_COASTED, estimate.flags);
    TEST_ASSERT_EQUAL(MH_ERR_TIME, mh_tracker_cv_ukf.predict(&state, 4 * TICK - 1, &later));
    TEST_ASSERT_EQUAL(MH_OK, mh_tracker_cv_ukf.predict(&state, 20 * TICK, &later));
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 10 + 0.8f * 10, later.position.x);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 20 + 0.6f * 10, later.position.y);
    /* m = 20 ticks: P0 + t^2 Pv + q (m^3 / 3 - m / 12) T^4, Pv t + q m^2 / 2 T^3, Pv + q m T^2 */
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 1 + 100 * 0.04f + 5e-5f * 2665 / 16, later.covariance.xx);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 10 * 0.04f + 5e-5f * 200 / 8, later.covariance_more[0]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.04f + 5e-5f * 20 / 4, later.covariance_more[2]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.04f + 1e-4f * 20 / 4, later.covariance_more[6]);
    TEST_ASSERT_EQUAL_FLOAT(0, later.covariance.xy);
}

static void there_is_no_track_before_the_start(void)
{
    config.start = 10 * TICK;
    begin(&mh_tracker_cv_ukf, &state);
    struct mh_measurement m = sample(1, 0, 0, 9 * TICK, 20);
    TEST_ASSERT_EQUAL(MH_NONE, mh_tracker_cv_ukf.step(&state, 9 * TICK, &m, 1, &estimate));
    TEST_ASSERT_EQUAL(MH_NONE, mh_tracker_cv_ukf.predict(&state, 9 * TICK, &estimate));
    m.time = 10 * TICK; /* the first that counts */
    TEST_ASSERT_EQUAL(MH_OK, mh_tracker_cv_ukf.step(&state, 10 * TICK, &m, 1, &estimate));
    TEST_ASSERT_EQUAL(1, estimate.measurements);
}

/* ---- particular samples ---- */

static void nodes_may_have_a_noise_of_their_own(void)
{
    static const struct mh_cv_noise noise[] = {{3, 0.5f}, {0, 0.5f}, {1, 0.5f}, {2, 0.5f}};
    uint8_t all[57], each[57];
    config.variance = 0.5f;
    run(&mh_tracker_cv_ukf, 0);
    note(&mh_tracker_cv_ukf, all);
    config.variance = 0.02f;
    config.noise = noise;
    config.noise_count = 4;
    run(&mh_tracker_cv_ukf, 0);
    note(&mh_tracker_cv_ukf, each);
    TEST_ASSERT_EQUAL_MEMORY(all, each, 57);
    config.noise_count = 3;
    run(&mh_tracker_cv_ukf, 0);
    note(&mh_tracker_cv_ukf, each);
    TEST_ASSERT_TRUE(memcmp(all, each, 57) != 0);
}

static void ranges_are_slant(void)
{
    config.origin.z_mm = 1500;
    config.origin.x_mm = -7000;
    begin(&mh_tracker_cv_ekf, &state);
    struct mh_measurement m = sample(1, 0, 20000, 0, 5); /* the target is 3 m away, 4 m higher */
    m.place.z_mm = -2500;
    TEST_ASSERT_EQUAL(MH_OK, mh_tracker_cv_ekf.step(&state, 0, &m, 1, &estimate));
    TEST_ASSERT_EQUAL_INT32(-7000, estimate.origin.x_mm);
    TEST_ASSERT_TRUE(mh_abs(estimate.position.x - 10) < 1e-4f);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 1 - 0.36f / 0.38f,
                             estimate.covariance.xx); /* along the slant, horizontally 3 of 5 */
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 1, estimate.covariance.yy);
}

/* Just where the anchor is a range has no gradient. */
static void an_update_that_is_not_possible_leaves_the_track(void)
{
    const struct mh_measurement m = sample(1, 10000, 20000, 0, 0);
    begin(&mh_tracker_cv_ekf, &state);
    TEST_ASSERT_EQUAL(MH_OK, mh_tracker_cv_ekf.step(&state, 0, &m, 1, &estimate));
    TEST_ASSERT_EQUAL_UINT32(1, state.counters.failed);
    TEST_ASSERT_EQUAL_FLOAT(10, estimate.position.x);
    TEST_ASSERT_EQUAL_FLOAT(1, estimate.covariance.xx);
    begin(&mh_tracker_cv_ukf, &state); /* which needs none */
    TEST_ASSERT_EQUAL(MH_OK, mh_tracker_cv_ukf.step(&state, 0, &m, 1, &estimate));
    TEST_ASSERT_EQUAL_UINT32(0, state.counters.failed);
}

static void bad_configurations_are_refused(void)
{
    const struct mh_cv_config good = config;
    static const struct mh_cv_noise noise[] = {{1, 0}};
    begin(&mh_tracker_cv_ukf, &state);
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_tracker_cv_ukf.init(&state, &config, 0));
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_tracker_cv_ukf.init(&state, NULL, TICK));
#define REFUSED(change)                                                                                                \
    config = good;                                                                                                     \
    config.change;                                                                                                     \
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_tracker_cv_ukf.init(&state, &config, TICK))
    REFUSED(alpha = 0.05f);
    REFUSED(beta = NAN);
    REFUSED(variance = 0);
    REFUSED(variance = NAN);
    REFUSED(covariance[0] = 0);
    REFUSED(covariance[1] = 0.2f); /* correlation of 1 */
    REFUSED(mean[3] = INFINITY);
    REFUSED(motion.tick = 0);
    REFUSED(motion.variance.x = -1);
    REFUSED(motion.variance.y = NAN);
    REFUSED(lag = 3600001u);
    REFUSED(origin.x_mm = INT32_MIN);
    REFUSED(summary = MH_SUMMARY_FUSED);
    REFUSED(noise_count = 1); /* of none */
    config = good;
    config.noise = noise;
    config.noise_count = 1;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_tracker_cv_ekf.init(&state, &config, TICK));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(one_update_is_the_published_one);
    RUN_TEST(whatever_the_order_the_result_is_that_of_samples_in_time);
    RUN_TEST(a_track_across_the_wrap_of_time_is_the_same);
    RUN_TEST(what_is_late_early_or_repeated_is_refused_and_counted);
    RUN_TEST(without_room_the_oldest_are_settled);
    RUN_TEST(a_saved_track_goes_on_elsewhere);
    RUN_TEST(without_samples_the_start_is_predicted);
    RUN_TEST(there_is_no_track_before_the_start);
    RUN_TEST(nodes_may_have_a_noise_of_their_own);
    RUN_TEST(ranges_are_slant);
    RUN_TEST(an_update_that_is_not_possible_leaves_the_track);
    RUN_TEST(bad_configurations_are_refused);
    port_exit(UNITY_END() > 0);
    return 0;
}
