#include "fusion_answers.h"
#include "motehound/fusion.h"
#include "port.h"

#include <string.h>

void setUp(void) {}
void tearDown(void) {}

static struct mh_gaussian out;

static void covariance_intersection_of_four(void)
{
    mh_real w[4];
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_weights(told, 4, w));
    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_FLOAT_WITHIN(1e-6f, by_trace_w[i], w[i]);
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_intersect(told, 4, w, &out));
    assert_close(&by_trace, &out, 1e-3f);
}

static void optimal_weights(void)
{
    mh_real w[4];
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_weights_trace(told, 4, w));
    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, trace_optimal_w[i], w[i]);
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_intersect(told, 4, w, &out));
    assert_close(&trace_optimal, &out, 1e-3f);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_weights_trace(told, 2, w));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_intersect(told, 2, w, &out));
    assert_close(&pair_trace_optimal, &out, 1e-3f);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_weights_determinant(told, 4, w));
    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, determinant_optimal_w[i], w[i]);
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_intersect(told, 4, w, &out));
    assert_close(&determinant_optimal, &out, 1e-3f);
}

static void as_if_independent(void)
{
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_naive(told, 4, &out));
    assert_close(&independent, &out, 1e-3f);
}

static void of_identical_estimates_it_is_that_estimate(void)
{
    struct mh_gaussian same[3];
    const mh_real w[3] = {0.2f, 0.5f, 0.3f};
    mh_real found[3];
    for (int i = 0; i < 3; i++) {
        same[i] = told[2];
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_intersect(same, 3, w, &out));
    assert_close(&told[2], &out, 2e-6f);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_weights_trace(same, 3, found));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1.0f / 3, found[0]);
    const mh_real one = 1;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_intersect(&told[2], 1, &one, &out));
    assert_close(&told[2], &out, 2e-6f);
}

static void who_has_no_weight_has_no_say(void)
{
    const mh_real w[2] = {0, 1};
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_intersect(told, 2, w, &out));
    assert_close(&told[1], &out, 2e-6f);
}

static void the_output_may_be_an_input(void)
{
    struct mh_gaussian inputs[4];
    memcpy(inputs, told, sizeof inputs);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_intersect(inputs, 4, by_trace_w, &inputs[1]));
    assert_close(&by_trace, &inputs[1], 1e-3f);
}

/* All rules must refuse it, and leave everything as it was. */
static void assert_refused(const struct mh_gaussian *estimates, uint8_t count, enum mh_status expected)
{
    struct mh_gaussian before;
    mh_real w[4] = {1, 0, 0, 0}, kept[4];
    memset(&before, 0x5a, sizeof before);
    out = before;
    TEST_ASSERT_EQUAL_INT(expected, mh_fusion_intersect(estimates, count, w, &out));
    TEST_ASSERT_EQUAL_INT(expected, mh_fusion_naive(estimates, count, &out));
    TEST_ASSERT_EQUAL_MEMORY(&before, &out, sizeof out);
    memcpy(kept, w, sizeof w);
    TEST_ASSERT_EQUAL_INT(expected, mh_fusion_weights_trace(estimates, count, w));
    TEST_ASSERT_EQUAL_INT(expected, mh_fusion_weights_determinant(estimates, count, w));
    TEST_ASSERT_EQUAL_MEMORY(kept, w, sizeof w);
}

static void what_is_no_estimate_is_refused(void)
{
    struct mh_gaussian e[2];
    memcpy(e, told, sizeof e);
    assert_refused(e, 0, MH_ERR_ARGUMENT);
    assert_refused(e, MH_FUSED_MAX + 1, MH_ERR_ARGUMENT);
    assert_refused(e, 255, MH_ERR_ARGUMENT);
    e[1].n = 3;
    assert_refused(e, 2, MH_ERR_ARGUMENT);
    e[0].n = e[1].n = 0;
    assert_refused(e, 2, MH_ERR_ARGUMENT);
    e[0].n = e[1].n = MH_STATES_MAX + 1;
    assert_refused(e, 2, MH_ERR_ARGUMENT);
    memcpy(e, told, sizeof e);
    e[1].x[3] = NAN;
    assert_refused(e, 2, MH_ERR_NOT_FINITE);
    e[1].x[3] = -INFINITY;
    assert_refused(e, 2, MH_ERR_NOT_FINITE);
    e[1] = told[1];
    e[1].P[4] = NAN;
    assert_refused(e, 2, MH_ERR_NOT_FINITE);
    e[1].P[4] = INFINITY;
    assert_refused(e, 2, MH_ERR_NOT_FINITE);
    e[1] = told[1];
    e[1].P[0] = -e[1].P[0];
    assert_refused(e, 2, MH_ERR_SINGULAR);
    e[1] = told[1];
    e[1].P[3] = 0.06f; /* |covariance| above both deviations' product */
    assert_refused(e, 2, MH_ERR_SINGULAR);
    memset(e[1].P, 0, sizeof e[1].P);
    assert_refused(e, 2, MH_ERR_SINGULAR);
}

static void weights_are_weights(void)
{
    const mh_real wrong[][2] = {{0.5f, 0.6f}, {1.5f, -0.5f}, {0, 0}, {NAN, 1}, {INFINITY, 0}};
    for (unsigned i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_fusion_intersect(told, 2, wrong[i], &out));
    }
    struct mh_gaussian e[2] = {{1, {0}, {1}}, {1, {0}, {0}}};
    mh_real w[2] = {7, 7};
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_fusion_weights(e, 2, w));
    e[1].P[0] = NAN;
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_fusion_weights(e, 2, w));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_fusion_weights(e, 0, w));
    TEST_ASSERT_EQUAL_FLOAT(7, w[0]);
    e[0].P[0] = 1e-30f; /* traces 60 decades apart */
    e[1].P[0] = 1e30f;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_weights(e, 2, w));
    TEST_ASSERT_EQUAL_FLOAT(1, w[0]);
    TEST_ASSERT_EQUAL_FLOAT(0, w[1]);
}

/* standard deviations of 1e-4 to 1 in one state: a condition number of 1e8 */
static void ill_conditioned(void)
{
    struct mh_gaussian e[2] = {{2, {1, 2}, {1e-8f, 0.9e-4f, 1}}, {2, {1.00001f, 2.1f}, {2e-8f, -0.9e-4f, 3}}};
    const mh_real w[2] = {0.5f, 0.5f};
    /* by hand, in units of 1e-4 and 1 */
    const mh_real det_a = 1 - 0.81f, det_b = 6 - 0.81f;
    const mh_real Ixx = 0.5f * (1 / det_a + 3 / det_b), Iyy = 0.5f * (1 / det_a + 2 / det_b);
    const mh_real Ixy = 0.5f * (-0.9f / det_a + 0.9f / det_b), det = Ixx * Iyy - Ixy * Ixy;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_intersect(e, 2, w, &out));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, Iyy / det, out.P[0] * 1e8f);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, -Ixy / det, out.P[1] * 1e4f);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, Ixx / det, out.P[2]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(covariance_intersection_of_four);
    RUN_TEST(optimal_weights);
    RUN_TEST(as_if_independent);
    RUN_TEST(of_identical_estimates_it_is_that_estimate);
    RUN_TEST(who_has_no_weight_has_no_say);
    RUN_TEST(the_output_may_be_an_input);
    RUN_TEST(what_is_no_estimate_is_refused);
    RUN_TEST(weights_are_weights);
    RUN_TEST(ill_conditioned);
    port_exit(UNITY_END() > 0);
    return 0;
}
