/* What the trackers `cv_ukf` and `cv_ekf` tell a fusion centre, and are told by it. */
#include "motehound/cv.h"
#include "port.h"
#include "unity.h"

#include <string.h>

enum { TICK = 500, STEPS = 16 };

static struct mh_cv_config config;
static struct mh_cv state;
static struct mh_estimate estimate;
static struct mh_summary summary;
static uint8_t bytes[MH_SUMMARY_BYTES_MAX];
static size_t length;

void setUp(void)
{
    mh_cv_config_default(&config);
    memset(&estimate, 0, sizeof estimate);
}

void tearDown(void) {}

static const struct mh_place anchors[] = {{25000, 40000, 0}, {-3000, 9000, 0}, {31000, 5000, 0}};

static mh_real x_at(int k) { return 10.3f + 0.45f * (mh_real)k; }
static mh_real y_at(int k) { return 19.5f + 0.25f * (mh_real)k; }

/* The noisy range of tick k, to one of the anchors in turn. */
static struct mh_measurement sample(int k)
{
    const struct mh_place *at = &anchors[k % 3];
    const mh_real dx = x_at(k) - (mh_real)at->x_mm * 0.001f, dy = y_at(k) - (mh_real)at->y_mm * 0.001f;
    const mh_real noise = (mh_real)(k * 7 % 11 - 5) * 0.03f;
    const struct mh_measurement m = {.node = (mh_node_id)(k % 3),
                                     .place = *at,
                                     .time = (mh_tick)k * TICK,
                                     .value = mh_q20_from_real(mh_sqrt(dx * dx + dy * dy) + noise)};
    return m;
}

static void begin(enum mh_summary_kind kind)
{
    config.summary = kind;
    TEST_ASSERT_EQUAL(MH_OK, mh_tracker_cv_ekf.init(&state, &config, TICK));
}

static void step(int k, const struct mh_measurement *set, size_t count)
{
    TEST_ASSERT_EQUAL(MH_OK, mh_tracker_cv_ekf.step(&state, (mh_tick)k * TICK, set, count, &estimate));
}

static void step_with_sample(int k)
{
    const struct mh_measurement m = sample(k);
    step(k, &m, 1);
}

static void summarise(int k)
{
    TEST_ASSERT_EQUAL(MH_OK, mh_tracker_cv_ekf.summarise(&state, (mh_tick)k * TICK, bytes, &length));
    TEST_ASSERT_EQUAL(MH_OK, mh_summary_read(&summary, bytes, length));
}

static void predict(struct mh_gaussian *gaussian, int ticks)
{
    mh_real F[16], Q[10];
    mh_white_acceleration(&config.motion, (mh_tick)ticks * TICK, F, Q);
    TEST_ASSERT_EQUAL(MH_OK, mh_gaussian_predict(gaussian, F, Q));
}

static struct mh_gaussian start(void)
{
    struct mh_gaussian gaussian = {.n = 4};
    memcpy(gaussian.x, config.mean, sizeof config.mean);
    memcpy(gaussian.P, config.covariance, sizeof config.covariance);
    return gaussian;
}

static void assert_same(const struct mh_gaussian *expected, const struct mh_gaussian *actual, mh_real tolerance)
{
    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_FLOAT_WITHIN(tolerance * mh_sqrt(expected->P[MH_PACKED(i, i)]), expected->x[i], actual->x[i]);
        for (int j = 0; j <= i; j++) {
            const mh_real scale = mh_sqrt(expected->P[MH_PACKED(i, i)] * expected->P[MH_PACKED(j, j)]);
            TEST_ASSERT_FLOAT_WITHIN(tolerance * scale, expected->P[MH_PACKED(j, i)], actual->P[MH_PACKED(j, i)]);
        }
    }
}

static void a_plain_summary_is_the_track_predicted(void)
{
    begin(MH_SUMMARY_PLAIN);
    TEST_ASSERT_EQUAL(MH_NONE, mh_tracker_cv_ekf.summarise(&state, 0, bytes, &length));
    for (int k = 1; k <= STEPS; k++) {
        step_with_sample(k);
    }
    summarise(STEPS);
    TEST_ASSERT_EQUAL(MH_SUMMARY_PLAIN, summary.kind);
    struct mh_gaussian now = summary.of.plain;
    TEST_ASSERT_EQUAL_FLOAT(estimate.position.x, now.x[0]);
    TEST_ASSERT_EQUAL_FLOAT(estimate.velocity.y, now.x[3]);
    TEST_ASSERT_EQUAL_FLOAT(estimate.covariance.xy, now.P[MH_PACKED(0, 2)]);
    summarise(STEPS + 3);
    predict(&now, 3);
    assert_same(&now, &summary.of.plain, 1e-5f);
    TEST_ASSERT_EQUAL(MH_ERR_TIME, mh_tracker_cv_ekf.summarise(&state, STEPS * TICK - 1, bytes, &length));
}

/* ---- split ---- */

typedef mh_real matrix[4][4];

static void unpack(const mh_real *packed, matrix a)
{
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            a[i][j] = packed[mh_packed_index(i, j)];
        }
    }
}

/* a := f a f' + q */
static void congruence(matrix a, matrix f, matrix q)
{
    matrix fa = {{0}};
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            for (int k = 0; k < 4; k++) {
                fa[i][j] += f[i][k] * a[k][j];
            }
        }
    }
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            a[i][j] = q[i][j];
            for (int k = 0; k < 4; k++) {
                a[i][j] += fa[i][k] * f[j][k];
            }
        }
    }
}

/* The textbook's EKF with its covariance in two parts. */
static mh_real x[4];
static matrix shared, own;

static void filter(int k)
{
    const struct mh_measurement m = sample(k);
    mh_real f[16], packed[10], h[4] = {0}, gain[4];
    matrix F, Q, A, none = {{0}}, KRK;
    mh_white_acceleration(&config.motion, TICK, f, packed);
    memcpy(F, f, sizeof f);
    unpack(packed, Q);
    congruence(shared, F, Q);
    congruence(own, F, none);
    x[0] += 0.5f * x[1];
    x[2] += 0.5f * x[3];
    const mh_real dx = x[0] - (mh_real)m.place.x_mm * 0.001f, dy = x[2] - (mh_real)m.place.y_mm * 0.001f;
    const mh_real range = mh_sqrt(dx * dx + dy * dy);
    h[0] = dx / range;
    h[2] = dy / range;
    mh_real variance = config.variance;
    for (int i = 0; i < 4; i++) {
        gain[i] = 0;
        for (int j = 0; j < 4; j++) {
            gain[i] += (shared[i][j] + own[i][j]) * h[j];
        }
        variance += h[i] * gain[i];
    }
    for (int i = 0; i < 4; i++) {
        gain[i] /= variance;
        x[i] += gain[i] * (mh_q20_to_real(m.value) - range);
    }
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            A[i][j] = (i == j ? 1.0f : 0) - gain[i] * h[j];
            KRK[i][j] = gain[i] * config.variance * gain[j];
        }
    }
    congruence(shared, A, none);
    congruence(own, A, KRK);
}

static void a_split_summary_tells_the_own_noise_apart(void)
{
    begin(MH_SUMMARY_SPLIT);
    memcpy(x, config.mean, sizeof x);
    unpack(config.covariance, shared);
    memset(own, 0, sizeof own);
    step(0, NULL, 0);
    summarise(0);
    TEST_ASSERT_EQUAL(97, length);
    for (int i = 0; i < 10; i++) {
        TEST_ASSERT_EQUAL_FLOAT(0, summary.of.split.independent[i]);
    }
    for (int k = 1; k <= STEPS; k++) {
        step_with_sample(k);
        filter(k);
        summarise(k);
        TEST_ASSERT_EQUAL(MH_SUMMARY_SPLIT, summary.kind);
        for (int i = 0; i < 4; i++) {
            const mh_real sd = mh_sqrt(shared[i][i] + own[i][i]);
            TEST_ASSERT_FLOAT_WITHIN(1e-3f * sd, x[i], summary.of.split.dependent.x[i]);
            for (int j = 0; j <= i; j++) {
                const mh_real tolerance = 1e-4f * sd * mh_sqrt(shared[j][j] + own[j][j]);
                TEST_ASSERT_FLOAT_WITHIN(tolerance, shared[j][i], summary.of.split.dependent.P[MH_PACKED(j, i)]);
                TEST_ASSERT_FLOAT_WITHIN(tolerance, own[j][i], summary.of.split.independent[MH_PACKED(j, i)]);
            }
        }
    }
    TEST_ASSERT_TRUE(own[0][0] > 0.2f * shared[0][0]); /* both parts matter */
}

/* ---- increments ---- */

/* One head alone: what the centre adds up is the head's track, whatever is lost and however late samples come. */
static void increments_add_up_to_the_track(void)
{
    begin(MH_SUMMARY_INCREMENT);
    struct mh_gaussian centre = start(), track = start();
    mh_tick last = 0;
    for (int k = 1; k <= STEPS; k++) {
        const bool first_late = k % 4 == 0; /* three ticks late */
        struct mh_measurement set[2] = {sample(first_late ? k - 3 : k), sample(k)};
        step(k, first_late ? set : set + 1, first_late ? 2 : k % 4 == 1 ? 0 : 1);
        predict(&centre, 1);
        if (k % 2 > 0) {
            continue;
        }
        summarise(k);
        TEST_ASSERT_EQUAL(61, length);
        TEST_ASSERT_EQUAL_UINT32(last, summary.since);
        if (k % 6 == 0) {
            continue; /* lost */
        }
        TEST_ASSERT_EQUAL(MH_OK, mh_fusion_add(&centre, &summary.of.increment, 1, &centre));
        last = (mh_tick)k * TICK;
        mh_tracker_cv_ekf.summary_taken(&state, last + 1); /* of another summary */
        mh_tracker_cv_ekf.summary_taken(&state, last);
        track = state.latest.state;
        predict(&track, 0);
        assert_same(&track, &centre, 2e-3f);
    }
    TEST_ASSERT_EQUAL_UINT32(STEPS - STEPS / 4 + STEPS / 4, state.counters.taken);
    TEST_ASSERT_EQUAL_UINT32(0, state.counters.late);
}

/* A head that begins later knows no more than the start, and says when it began. */
static void a_head_that_begins_later_says_so(void)
{
    begin(MH_SUMMARY_INCREMENT);
    step_with_sample(9);
    summarise(10);
    TEST_ASSERT_EQUAL_UINT32(8 * TICK, summary.since);
    struct mh_gaussian centre = start(), track = state.latest.state;
    predict(&centre, 10);
    predict(&track, 1);
    TEST_ASSERT_EQUAL(MH_OK, mh_fusion_add(&centre, &summary.of.increment, 1, &centre));
    assert_same(&track, &centre, 2e-3f);
}

/* ---- feedback ---- */

static enum mh_status correct(int k, const struct mh_gaussian *told)
{
    const struct mh_summary fused = {.kind = MH_SUMMARY_FUSED, .of.plain = *told, .clusters = 1};
    length = mh_summary_write(&fused, bytes);
    return mh_tracker_cv_ekf.correct(&state, (mh_tick)k * TICK, bytes, length);
}

static struct mh_gaussian tracked(int k)
{
    struct mh_gaussian now = state.latest.state;
    predict(&now, k - (int)(state.latest.time / TICK));
    return now;
}

static void feedback_replaces_the_track_and_what_came_after_it_counts(void)
{
    begin(MH_SUMMARY_INCREMENT);
    for (int k = 1; k <= 8; k++) {
        step_with_sample(k);
    }
    summarise(8);
    mh_tracker_cv_ekf.summary_taken(&state, 8 * TICK);
    const struct mh_gaussian told = tracked(8);
    step_with_sample(9);
    step_with_sample(10);
    const struct mh_gaussian before = tracked(10);
    TEST_ASSERT_EQUAL(MH_OK, correct(8, &told)); /* nothing that it does not know */
    struct mh_gaussian after = tracked(10);
    assert_same(&before, &after, 1e-5f);
    struct mh_gaussian other = told;
    other.x[0] += 0.5f;
    TEST_ASSERT_EQUAL(MH_OK, correct(8, &other));
    after = tracked(10);
    TEST_ASSERT_TRUE(after.x[0] > before.x[0] + 0.1f);
    TEST_ASSERT_EQUAL_UINT32(2, state.counters.corrected);
    /* increments count from what the centre has said */
    summarise(10);
    TEST_ASSERT_EQUAL_UINT32(8 * TICK, summary.since);
    predict(&other, 2);
    TEST_ASSERT_EQUAL(MH_OK, mh_fusion_add(&other, &summary.of.increment, 1, &other));
    assert_same(&after, &other, 2e-3f);
    const struct mh_measurement old = sample(8);
    step(11, &old, 1);
    TEST_ASSERT_EQUAL_UINT32(1, state.counters.late); /* what was before the feedback is settled */
}

/* What the centre has not got stays in the track, and in the next increment. */
static void feedback_does_not_lose_what_the_centre_has_not_got(void)
{
    begin(MH_SUMMARY_INCREMENT);
    for (int k = 1; k <= 8; k++) {
        step_with_sample(k);
    }
    summarise(8);
    const struct mh_gaussian before = tracked(8);
    struct mh_gaussian centre = start();
    predict(&centre, 8);
    TEST_ASSERT_EQUAL(MH_OK, correct(8, &centre));
    struct mh_gaussian after = tracked(8);
    assert_same(&before, &after, 2e-3f);
    summarise(9);
    after = tracked(9);
    predict(&centre, 1);
    TEST_ASSERT_EQUAL(MH_OK, mh_fusion_add(&centre, &summary.of.increment, 1, &centre));
    assert_same(&after, &centre, 2e-3f);
}

static void feedback_that_is_of_no_use_is_refused(void)
{
    begin(MH_SUMMARY_INCREMENT);
    struct mh_gaussian told = start();
    TEST_ASSERT_EQUAL(MH_ERR_TIME, correct(0, &told)); /* no track yet */
    for (int k = 1; k <= 8; k++) {
        step_with_sample(k);
    }
    const struct mh_gaussian before = tracked(8);
    TEST_ASSERT_EQUAL(MH_ERR_TIME, correct(9, &told)); /* yet to come */
    TEST_ASSERT_EQUAL(MH_ERR_TIME, correct(3, &told)); /* a sample of tick 4 is settled */
    summarise(8);
    TEST_ASSERT_EQUAL(MH_ERR_TIME, correct(7, &told)); /* without the last summary, of another time */
    told.P[0] = -1;
    TEST_ASSERT_EQUAL(MH_ERR_CORRUPT, correct(8, &told));
    told.P[0] = NAN;
    TEST_ASSERT_EQUAL(MH_ERR_CORRUPT, correct(8, &told));
    told = start();
    told.x[0] = 1e30f; /* finite, but not for long */
    TEST_ASSERT_EQUAL(MH_ERR_CORRUPT, correct(8, &told));
    told = start();
    told.P[0] = 1e30f;
    TEST_ASSERT_EQUAL(MH_ERR_CORRUPT, correct(8, &told));
    TEST_ASSERT_EQUAL(MH_ERR_CORRUPT, mh_tracker_cv_ekf.correct(&state, 8 * TICK, bytes, 3));
    summarise(8);
    TEST_ASSERT_EQUAL(MH_ERR_CORRUPT, mh_tracker_cv_ekf.correct(&state, 8 * TICK, bytes, length)); /* an increment */
    TEST_ASSERT_EQUAL_UINT32(10, state.counters.refused);
    const struct mh_gaussian after = tracked(8);
    TEST_ASSERT_EQUAL_MEMORY(&before, &after, sizeof before);
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_tracker_cv_ekf.correct(&state, 8 * TICK, NULL, 3));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_plain_summary_is_the_track_predicted);
    RUN_TEST(a_split_summary_tells_the_own_noise_apart);
    RUN_TEST(increments_add_up_to_the_track);
    RUN_TEST(a_head_that_begins_later_says_so);
    RUN_TEST(feedback_replaces_the_track_and_what_came_after_it_counts);
    RUN_TEST(feedback_does_not_lose_what_the_centre_has_not_got);
    RUN_TEST(feedback_that_is_of_no_use_is_refused);
    port_exit(UNITY_END() > 0);
    return 0;
}
