#include "motehound/fusion_centre.h"
#include "port.h"
#include "unity.h"

#include <string.h>

void setUp(void) {}
void tearDown(void) {}

static struct mh_fusion_centre centre;
static struct mh_fusion_centre_config config;
static struct mh_estimate estimate;
static struct mh_summary summary;
static uint8_t bytes[MH_SUMMARY_BYTES_MAX];

static void begin(enum mh_fusion_rule rule)
{
    mh_fusion_centre_config_default(&config);
    config.rule = rule;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_centre_fusion.init(&centre, &config));
}

/* All summaries of these tests are diagonal: position at (x, -x), variances `variance` and a hundredth of it. */
static void gaussian_at(struct mh_gaussian *gaussian, mh_real x, mh_real variance)
{
    memset(gaussian, 0, sizeof *gaussian);
    gaussian->n = 4;
    gaussian->x[0] = x;
    gaussian->x[2] = -x;
    for (int i = 0; i < 4; i++) {
        gaussian->P[MH_PACKED(i, i)] = i % 2 ? 0.01f * variance : variance;
    }
}

static enum mh_status take_plain(uint8_t cluster, mh_tick time, mh_real x, mh_real variance)
{
    memset(&summary, 0, sizeof summary);
    summary.kind = MH_SUMMARY_PLAIN;
    gaussian_at(&summary.of.plain, x, variance);
    return mh_centre_fusion.take(&centre, cluster, time, bytes, mh_summary_write(&summary, bytes));
}

/* An increment that is one measurement of position. */
static enum mh_status take_increment(uint8_t cluster, mh_tick since, mh_tick time, mh_real x, mh_real variance)
{
    memset(&summary, 0, sizeof summary);
    summary.kind = MH_SUMMARY_INCREMENT;
    summary.since = since;
    summary.of.increment.n = 4;
    for (int i = 0; i < 4; i += 2) {
        summary.of.increment.matrix[MH_PACKED(i, i)] = 1 / variance;
        summary.of.increment.vector[i] = (i ? -x : x) / variance;
    }
    return mh_centre_fusion.take(&centre, cluster, time, bytes, mh_summary_write(&summary, bytes));
}

static void joins_what_came(void)
{
    begin(MH_FUSION_CI);
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_centre_fusion.fuse(&centre, 500, &estimate));
    TEST_ASSERT_EQUAL_INT(MH_OK, take_plain(0, 1000, 1, 0.1f));
    TEST_ASSERT_EQUAL_INT(MH_OK, take_plain(2, 1000, 4, 0.2f));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_centre_fusion.fuse(&centre, 1000, &estimate));
    /* weights 2/3 and 1/3: information 2/3 / 0.1 + 1/3 / 0.2 = 25/3, mean (20/3 + 20/3) / (25/3) */
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 1.6f, estimate.position.x);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, -1.6f, estimate.position.y);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.12f, estimate.covariance.xx);
    TEST_ASSERT_FLOAT_WITHIN(1e-7f, 0.0012f, estimate.covariance_more[6]);
    TEST_ASSERT_EQUAL_UINT(2, estimate.measurements);
    TEST_ASSERT_EQUAL_UINT(4, estimate.states);
    TEST_ASSERT_EQUAL_UINT(0, estimate.flags);
    TEST_ASSERT_EQUAL_UINT32(1000, estimate.time);
}

/* who is silent is predicted, until `keep` has passed; then the whole is */
static void silent_clusters(void)
{
    struct mh_gaussian told[2];
    mh_real F[16], Q[10];
    size_t length;
    begin(MH_FUSION_NAIVE);
    config.keep = 2000;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_centre_fusion.init(&centre, &config));
    take_plain(0, 1000, 1, 0.1f);
    take_plain(1, 1000, 1, 0.1f);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_centre_fusion.fuse(&centre, 1000, &estimate));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.05f, estimate.covariance.xx);
    take_plain(1, 3000, 1, 0.1f);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_centre_fusion.fuse(&centre, 3000, &estimate));
    TEST_ASSERT_EQUAL_UINT(1, estimate.measurements);
    gaussian_at(&told[0], 1, 0.1f);
    gaussian_at(&told[1], 1, 0.1f);
    mh_white_acceleration(&config.motion, 2000, F, Q);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_predict(&told[0], F, Q));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_naive(told, 2, &told[0]));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, told[0].P[0], estimate.covariance.xx);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_centre_fusion.fuse(&centre, 4000, &estimate));
    TEST_ASSERT_TRUE(estimate.flags & MH_ESTIMATE_COASTED);
    TEST_ASSERT_TRUE(estimate.covariance.xx > 0.1f); /* cluster 1 alone */
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_centre_fusion.fuse(&centre, 60000, &estimate));
    TEST_ASSERT_TRUE(estimate.flags & MH_ESTIMATE_COASTED);
    TEST_ASSERT_TRUE(estimate.covariance.xx > 0.1f + 0.001f * 56 * 56);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 1, estimate.position.x);
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_centre_fusion.feedback(&centre, bytes, &length));
}

static void refused_and_counted(void)
{
    begin(MH_FUSION_CI);
    TEST_ASSERT_EQUAL_INT(MH_OK, take_plain(3, 5000, 1, 0.1f));
    const struct mh_fusion_slot before = centre.slots[3];
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, take_plain(4, 5000, 1, 0.1f));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, take_plain(255, 5000, 1, 0.1f));
    TEST_ASSERT_EQUAL_INT(MH_ERR_REPEATED, take_plain(3, 5000, 2, 0.2f));
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, take_plain(3, 4000, 2, 0.2f));
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, take_plain(3, 6000, 2, -1));
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, take_plain(3, 6000, NAN, 1));
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, take_plain(3, 6000, 1, 0));
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, take_increment(3, 0, 6000, 1, 1)); /* not what this rule joins */
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_centre_fusion.take(&centre, 3, 6000, bytes, 0));
    TEST_ASSERT_EQUAL_MEMORY(&before, &centre.slots[3], sizeof before);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_centre_fusion.fuse(&centre, 5000, &estimate));
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, mh_centre_fusion.fuse(&centre, 5000, &estimate));
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, mh_centre_fusion.fuse(&centre, 4000, &estimate));
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, take_plain(2, 5001 + MH_FUSION_AHEAD, 1, 0.1f));
    TEST_ASSERT_EQUAL_INT(MH_OK, take_plain(2, 4500, 1, 0.1f)); /* late, but still of use */
    TEST_ASSERT_EQUAL_UINT32(2, centre.counters.taken);
    TEST_ASSERT_EQUAL_UINT32(1, centre.counters.repeated);
    TEST_ASSERT_EQUAL_UINT32(2, centre.counters.late);
    TEST_ASSERT_EQUAL_UINT32(5, centre.counters.corrupt);
    TEST_ASSERT_EQUAL_UINT32(2, centre.counters.unknown);
}

/* Before the first fusion the centre does not know what time it is: a wrong time must not keep the cluster out for good. */
static void a_time_from_the_far_future(void)
{
    begin(MH_FUSION_CI);
    TEST_ASSERT_EQUAL_INT(MH_OK, take_plain(0, 0x60000000u, 1, 0.1f));
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_centre_fusion.fuse(&centre, 1000, &estimate));
    TEST_ASSERT_EQUAL_INT(MH_OK, take_plain(0, 2000, 1, 0.1f));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_centre_fusion.fuse(&centre, 2000, &estimate));
}

static void increments(void)
{
    begin(MH_FUSION_HIF);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_centre_fusion.fuse(&centre, 1000, &estimate));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 10.8f, estimate.position.x);
    const mh_real prior = estimate.covariance.xx; /* 1.04 and a little */
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 1.04f, prior);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_centre_fusion.init(&centre, &config));
    TEST_ASSERT_EQUAL_INT(MH_OK, take_increment(0, 0, 1000, 11, 0.5f));
    TEST_ASSERT_EQUAL_INT(MH_OK, take_increment(1, 0, 1000, 11, 0.5f));
    TEST_ASSERT_EQUAL_INT(MH_ERR_REPEATED, take_increment(1, 0, 1000, 11, 0.5f));
    TEST_ASSERT_EQUAL_INT(MH_ERR_CAPACITY, take_increment(1, 1000, 2000, 11, 0.5f));
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, take_increment(2, 1001, 1000, 11, 0.5f));
    TEST_ASSERT_EQUAL_INT(MH_OK, take_increment(3, 0, 1500, 11, 0.5f)); /* of later: waits */
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_centre_fusion.fuse(&centre, 1000, &estimate));
    TEST_ASSERT_EQUAL_UINT(2, estimate.measurements);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 1 / (1 / prior + 4), estimate.covariance.xx);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, (10.8f / prior + 44) / (1 / prior + 4), estimate.position.x);
    TEST_ASSERT_EQUAL_INT(MH_ERR_TIME, take_increment(2, 0, 1000, 11, 0.5f));
    /* its acknowledgement was lost: it tells again what it has told, and some more, until it knows */
    TEST_ASSERT_EQUAL_INT(MH_ERR_REPEATED, take_increment(0, 0, 2000, 11, 0.25f));
    TEST_ASSERT_EQUAL_INT(MH_OK, take_increment(0, 1000, 3000, 11, 0.5f));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_centre_fusion.fuse(&centre, 3000, &estimate));
    TEST_ASSERT_EQUAL_UINT(2, estimate.measurements);
    TEST_ASSERT_EQUAL_UINT32(1, centre.counters.waiting);
}

/* Information cannot be taken away. */
static void an_increment_that_decreases(void)
{
    begin(MH_FUSION_HIF);
    TEST_ASSERT_EQUAL_INT(MH_OK, take_increment(0, 0, 1000, 11, -0.5f));
    TEST_ASSERT_EQUAL_INT(MH_OK, take_increment(1, 0, 1000, 11, 0.5f));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_centre_fusion.fuse(&centre, 1000, &estimate));
    TEST_ASSERT_EQUAL_UINT(1, estimate.measurements);
    TEST_ASSERT_EQUAL_UINT32(1, centre.counters.unfit);
    TEST_ASSERT_TRUE(estimate.covariance.xx > 0 && estimate.covariance.xx < 0.5f);
}

/* Nothing is so far or so fast: what is as absurd as this would be beyond all numbers soon, and the centre be lost for good. */
static void what_is_absurd_is_left_out(void)
{
    begin(MH_FUSION_HIF);
    TEST_ASSERT_EQUAL_INT(MH_OK, take_increment(0, 0, 1000, 1e38f, 0.9f));
    TEST_ASSERT_EQUAL_INT(MH_OK, take_increment(1, 0, 1000, 11, 0.5f));
    for (mh_tick time = 1000; time <= 300000; time += 1000) {
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_centre_fusion.fuse(&centre, time, &estimate));
    }
    TEST_ASSERT_EQUAL_UINT32(1, centre.counters.unfit);
    TEST_ASSERT_FLOAT_WITHIN(100, 240, estimate.position.x); /* 0.8 m/s, less surely with every second */
    begin(MH_FUSION_CI);
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, take_plain(0, 1000, 1e20f, 0.1f));
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, take_plain(0, 1000, 1, 1e20f));
    TEST_ASSERT_EQUAL_INT(MH_OK, take_plain(0, 1000, 1e6f, 1e12f));
}

static void an_hour_is_the_longest_to_keep(void)
{
    begin(MH_FUSION_CI);
    config.keep = config.motion.tick = 3600000u;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_centre_fusion.init(&centre, &config));
    config.keep++;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_centre_fusion.init(&centre, &config));
}

static void feedback_says_what_is_in_it(void)
{
    size_t length;
    begin(MH_FUSION_HIF_FEEDBACK);
    TEST_ASSERT_EQUAL_INT(MH_NONE, mh_centre_fusion.feedback(&centre, bytes, &length));
    take_increment(0, 0, 500, 11, 0.5f);
    take_increment(3, 0, 1000, 11, 0.5f);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_centre_fusion.fuse(&centre, 1000, &estimate));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_centre_fusion.feedback(&centre, bytes, &length));
    TEST_ASSERT_FALSE(mh_summary_holds(bytes, length, 0)); /* of another time */
    TEST_ASSERT_TRUE(mh_summary_holds(bytes, length, 3));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_summary_read(&summary, bytes, length));
    TEST_ASSERT_EQUAL_FLOAT(estimate.position.y, summary.of.plain.x[2]);
}

/* Each rule of estimates against its own function, for two clusters of the same time. */
static void every_rule(void)
{
    struct mh_gaussian told[2], expected;
    mh_real w[2];
    gaussian_at(&told[0], 1, 0.1f);
    gaussian_at(&told[1], 2, 0.2f);
    told[1].P[MH_PACKED(0, 2)] = 0.15f;
    for (int rule = MH_FUSION_CI; rule <= MH_FUSION_NAIVE; rule++) {
        if (mh_summary_kind_of((enum mh_fusion_rule)rule) != MH_SUMMARY_PLAIN) {
            continue;
        }
        begin((enum mh_fusion_rule)rule);
        for (uint8_t c = 0; c < 2; c++) {
            memset(&summary, 0, sizeof summary);
            summary.kind = MH_SUMMARY_PLAIN;
            summary.of.plain = told[c];
            TEST_ASSERT_EQUAL_INT(MH_OK,
                                  mh_centre_fusion.take(&centre, c, 7000, bytes, mh_summary_write(&summary, bytes)));
        }
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_centre_fusion.fuse(&centre, 7000, &estimate));
        if (rule == MH_FUSION_NAIVE) {
            mh_fusion_naive(told, 2, &expected);
        } else if (rule == MH_FUSION_ICI) {
            mh_fusion_inverse(&told[0], &told[1], &expected);
        } else if (rule == MH_FUSION_EI) {
            mh_fusion_ellipsoidal(&told[0], &told[1], &expected);
        } else {
            if (rule == MH_FUSION_CI) {
                mh_fusion_weights(told, 2, w);
            } else if (rule == MH_FUSION_CI_DET) {
                mh_fusion_weights_determinant(told, 2, w);
            } else {
                mh_fusion_weights_trace(told, 2, w);
            }
            mh_fusion_intersect(told, 2, w, &expected);
        }
        TEST_ASSERT_FLOAT_WITHIN(1e-6f, expected.x[0], estimate.position.x);
        TEST_ASSERT_FLOAT_WITHIN(1e-7f, expected.P[MH_PACKED(0, 2)], estimate.covariance.xy);
        TEST_ASSERT_FLOAT_WITHIN(1e-7f, expected.P[MH_PACKED(2, 2)], estimate.covariance.yy);
    }
}

static void split_summaries(void)
{
    begin(MH_FUSION_SCI);
    for (uint8_t c = 0; c < 2; c++) {
        memset(&summary, 0, sizeof summary);
        summary.kind = MH_SUMMARY_SPLIT;
        gaussian_at(&summary.of.split.dependent, 1 + (mh_real)c, 0.1f);
        for (int i = 0; i < 4; i++) {
            summary.of.split.independent[MH_PACKED(i, i)] = i % 2 ? 0.001f : 0.1f;
        }
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_centre_fusion.take(&centre, c, 1000, bytes, mh_summary_write(&summary, bytes)));
    }
    /* w = 1/2: 0.1 / 0.5 + 0.1 = 0.3 each */
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_centre_fusion.fuse(&centre, 1000, &estimate));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.15f, estimate.covariance.xx);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 1.5f, estimate.position.x);
    /* both predicted by 2 s: 0.104 / 0.5 + 0.104 and the noise */
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_centre_fusion.fuse(&centre, 3000, &estimate));
    TEST_ASSERT_FLOAT_WITHIN(2e-4f, 0.156f, estimate.covariance.xx);
}

static void configurations(void)
{
    begin(MH_FUSION_CI);
    struct mh_fusion_centre_config wrong = config;
    wrong.clusters = 0;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_centre_fusion.init(&centre, &wrong));
    wrong.clusters = MH_FUSED_MAX + 1;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_centre_fusion.init(&centre, &wrong));
    wrong = config;
    wrong.rule = MH_FUSION_CENTRAL;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_centre_fusion.init(&centre, &wrong));
    wrong = config;
    wrong.motion.tick = 0;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_centre_fusion.init(&centre, &wrong));
    wrong = config;
    wrong.motion.variance.y = NAN;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_centre_fusion.init(&centre, &wrong));
    wrong = config;
    wrong.start.P[0] = 0;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_centre_fusion.init(&centre, &wrong));
    wrong = config;
    wrong.start.n = 3;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_centre_fusion.init(&centre, &wrong));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(joins_what_came);
    RUN_TEST(silent_clusters);
    RUN_TEST(refused_and_counted);
    RUN_TEST(a_time_from_the_far_future);
    RUN_TEST(increments);
    RUN_TEST(an_increment_that_decreases);
    RUN_TEST(what_is_absurd_is_left_out);
    RUN_TEST(an_hour_is_the_longest_to_keep);
    RUN_TEST(feedback_says_what_is_in_it);
    RUN_TEST(every_rule);
    RUN_TEST(split_summaries);
    RUN_TEST(configurations);
    port_exit(UNITY_END() > 0);
    return 0;
}
