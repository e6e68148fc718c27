/* The rules of two estimates, and increments of information. */
#include "fusion_answers.h"
#include "motehound/fusion.h"
#include "port.h"

#include <string.h>

void setUp(void) {}
void tearDown(void) {}

static struct mh_gaussian out;
static struct mh_split_gaussian split[2], joined;

static void split_up(struct mh_split_gaussian *estimate, const struct mh_gaussian *whole, mh_real dependent)
{
    memset(estimate, 0, sizeof *estimate);
    estimate->dependent = *whole;
    for (int i = 0; i < MH_PACKED_SIZE(4); i++) {
        estimate->dependent.P[i] = dependent * whole->P[i];
        estimate->independent[i] = (1 - dependent) * whole->P[i];
    }
}

static void whole_of(const struct mh_split_gaussian *estimate, struct mh_gaussian *whole)
{
    *whole = estimate->dependent;
    for (int i = 0; i < MH_PACKED_SIZE(4); i++) {
        whole->P[i] += estimate->independent[i];
    }
}

static void inverse_covariance_intersection(void)
{
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_inverse(&told[0], &told[1], &out));
    assert_close(&pair_inverse, &out, 1e-3f);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_inverse(&told[1], &told[0], &out));
    assert_close(&pair_inverse, &out, 1e-3f);
}

static void ellipsoidal_intersection(void)
{
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_ellipsoidal(&told[0], &told[1], &out));
    assert_close(&pair_ellipsoidal, &out, 1e-3f);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_ellipsoidal(&told[1], &told[0], &out));
    assert_close(&pair_ellipsoidal, &out, 1e-3f);
}

static void split_covariance_intersection(void)
{
    split_up(&split[0], &told[0], 0.6f);
    split_up(&split[1], &told[1], 0.3f);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_split(&split[0], &split[1], &joined));
    whole_of(&joined, &out);
    assert_close(&pair_split, &out, 1e-3f);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_split(&split[1], &split[0], &split[0])); /* over an input */
    whole_of(&split[0], &out);
    assert_close(&pair_split, &out, 1e-3f);
}

/* all independent: information adds up; all dependent: covariance intersection */
static void split_at_its_ends(void)
{
    struct mh_gaussian expected;
    mh_real w[2];
    split_up(&split[0], &told[0], 0);
    split_up(&split[1], &told[1], 0);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_split(&split[0], &split[1], &joined));
    whole_of(&joined, &out);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_naive(told, 2, &expected));
    assert_close(&expected, &out, 1e-5f);
    for (int i = 0; i < MH_PACKED_SIZE(4); i++) {
        TEST_ASSERT_EQUAL_FLOAT(0, joined.dependent.P[i]);
    }
    split_up(&split[0], &told[0], 1);
    split_up(&split[1], &told[1], 1);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_split(&split[0], &split[1], &joined));
    whole_of(&joined, &out);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_weights_trace(told, 2, w));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_intersect(told, 2, w, &expected));
    assert_close(&expected, &out, 2e-3f);
}

static void of_one_estimate_twice_it_is_that_estimate(void)
{
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_inverse(&told[3], &told[3], &out));
    assert_close(&told[3], &out, 1e-5f);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_ellipsoidal(&told[3], &told[3], &out));
    assert_close(&told[3], &out, 1e-5f);
}

/* of equal covariances the mean of both, whoever comes first */
static void equally_good(void)
{
    struct mh_gaussian a = told[0], b = told[0];
    a.x[0] += 0.1f;
    b.x[2] += 0.2f;
    struct mh_gaussian expected = told[0];
    expected.x[0] += 0.05f;
    expected.x[2] += 0.1f;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_ellipsoidal(&a, &b, &out));
    assert_close(&expected, &out, 1e-4f);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_inverse(&a, &b, &out));
    assert_close(&expected, &out, 1e-4f);
}

/* b is a after two scalar measurements: the increment is h h' / R each, and a with it is b */
static void increments_add_up(void)
{
    static const mh_real h[2][4] = {{0.6f, 0, 0.8f, 0}, {-0.8f, 0, 0.6f, 0}};
    static const mh_real z[2] = {10.2f, -4.9f}, R = 0.02f;
    const struct mh_gaussian *prior = &told[3];
    struct mh_gaussian posterior;
    struct mh_information added[2], increment;
    for (int m = 0; m < 2; m++) {
        added[m].n = 4;
        for (int j = 0; j < 4; j++) {
            added[m].vector[j] = h[m][j] * z[m] / R;
            for (int i = 0; i <= j; i++) {
                added[m].matrix[MH_PACKED(i, j)] = h[m][i] * h[m][j] / R;
            }
        }
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_add(prior, added, 2, &posterior));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_increment(&posterior, prior, &increment));
    for (int i = 0; i < 10; i++) {
        TEST_ASSERT_FLOAT_WITHIN(0.05f, added[0].matrix[i] + added[1].matrix[i], increment.matrix[i]);
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_add(prior, &increment, 1, &out));
    assert_close(&posterior, &out, 1e-3f);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_add(prior, NULL, 0, &out));
    assert_close(prior, &out, 1e-5f);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_fusion_increment(prior, prior, &increment));
    for (int i = 0; i < 10; i++) {
        TEST_ASSERT_EQUAL_FLOAT(0, increment.matrix[i]);
    }
}

static void refused_increments(void)
{
    struct mh_information increment;
    memset(&increment, 0, sizeof increment);
    struct mh_gaussian before, three = told[0];
    memset(&before, 0x5a, sizeof before);
    out = before;
    increment.n = 3;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_fusion_add(&told[0], &increment, 1, &out));
    increment.n = 4;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_fusion_add(&told[0], &increment, 255, &out));
    increment.matrix[0] = -1; /* of 1 / 0.033 that were known */
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_fusion_add(&told[0], &increment, 1, &out));
    increment.matrix[0] = NAN;
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_fusion_add(&told[0], &increment, 1, &out));
    increment.matrix[0] = 0;
    increment.vector[2] = INFINITY;
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_fusion_add(&told[0], &increment, 1, &out));
    TEST_ASSERT_EQUAL_MEMORY(&before, &out, sizeof out);
    three.n = 3;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_fusion_increment(&told[0], &three, &increment));
}

static void refused_pairs(void)
{
    struct mh_gaussian before, bad = told[1];
    memset(&before, 0x5a, sizeof before);
    out = before;
    bad.n = 3;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_fusion_inverse(&told[0], &bad, &out));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_fusion_ellipsoidal(&told[0], &bad, &out));
    bad = told[1];
    bad.x[0] = NAN;
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_fusion_inverse(&told[0], &bad, &out));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_fusion_ellipsoidal(&bad, &told[0], &out));
    bad = told[1];
    bad.P[0] = 0;
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_fusion_inverse(&bad, &told[0], &out));
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_fusion_ellipsoidal(&told[0], &bad, &out));
    TEST_ASSERT_EQUAL_MEMORY(&before, &out, sizeof out);
    split_up(&split[0], &told[0], 0.6f);
    split_up(&split[1], &told[1], 1.2f); /* the independent part is negative */
    memset(&joined, 0x5a, sizeof joined);
    const struct mh_split_gaussian kept = joined;
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_fusion_split(&split[0], &split[1], &joined));
    split_up(&split[1], &told[1], 0.3f);
    split[1].independent[5] = NAN;
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_fusion_split(&split[0], &split[1], &joined));
    split[1].dependent.n = 3;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_fusion_split(&split[1], &split[0], &joined));
    TEST_ASSERT_EQUAL_MEMORY(&kept, &joined, sizeof joined);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(inverse_covariance_intersection);
    RUN_TEST(ellipsoidal_intersection);
    RUN_TEST(split_covariance_intersection);
    RUN_TEST(split_at_its_ends);
    RUN_TEST(of_one_estimate_twice_it_is_that_estimate);
    RUN_TEST(equally_good);
    RUN_TEST(increments_add_up);
    RUN_TEST(refused_increments);
    RUN_TEST(refused_pairs);
    port_exit(UNITY_END() > 0);
    return 0;
}
