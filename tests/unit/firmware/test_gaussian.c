#include "motehound/gaussian.h"
#include "port.h"
#include "unity.h"

#include <string.h>

void setUp(void) {}
void tearDown(void) {}

static uint32_t seed;

/* uniform in -1 to 1 */
static mh_real draw(void)
{
    seed = seed * 1664525u + 1013904223u;
    return (mh_real)(int32_t)(seed >> 8) * (2.0f / 16777216.0f) - 1.0f;
}

/* x at random, P = B B' + I / 10 */
static void draw_gaussian(struct mh_gaussian *g, uint8_t n)
{
    mh_real B[4][4];
    g->n = n;
    for (int i = 0; i < n; i++) {
        g->x[i] = 10 * draw();
        for (int j = 0; j < n; j++) {
            B[i][j] = draw();
        }
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++) {
            mh_real sum = i == j ? 0.1f : 0;
            for (int k = 0; k < n; k++) {
                sum += B[i][k] * B[j][k];
            }
            g->P[mh_packed_index(i, j)] = sum;
        }
    }
}

static mh_real element(const mh_real *P, int i, int j) { return P[mh_packed_index(i, j)]; }

static void as_bytes_and_back(void)
{
    struct mh_gaussian g, back;
    uint8_t bytes[MH_GAUSSIAN_BYTES(4)];
    seed = 1;
    for (uint8_t n = 1; n <= 4; n++) {
        draw_gaussian(&g, n);
        TEST_ASSERT_EQUAL_UINT(MH_GAUSSIAN_BYTES(n), mh_gaussian_write(&g, bytes));
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_read(&back, n, bytes));
        TEST_ASSERT_EQUAL_UINT8(n, back.n);
        TEST_ASSERT_EQUAL_MEMORY(g.x, back.x, n * sizeof g.x[0]);
        TEST_ASSERT_EQUAL_MEMORY(g.P, back.P, (unsigned)MH_PACKED_SIZE(n) * sizeof g.P[0]);
    }
    TEST_ASSERT_EQUAL_UINT(36, MH_GAUSSIAN_BYTES(3));
}

/* every byte of a Gaussian set to all ones makes a NaN; what is no covariance is refused, and nothing changes */
static void corrupt_bytes_are_refused(void)
{
    struct mh_gaussian g, untouched;
    uint8_t bytes[MH_GAUSSIAN_BYTES(2)];
    const mh_real bad[][3] = {{1, 2, 1},        {1, 1, 1},   {-1, 0, 1},     {0, 0, 0},
                              {1, 0, INFINITY}, {1, NAN, 1}, {1, 0, -1e-30f}};
    seed = 2;
    draw_gaussian(&g, 2);
    memset(&untouched, 7, sizeof untouched);
    const struct mh_gaussian before = untouched;
    for (int i = 0; i < 5; i++) {
        mh_gaussian_write(&g, bytes);
        memset(bytes + 4 * i, 0xff, 4);
        TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_gaussian_read(&untouched, 2, bytes));
    }
    for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        memcpy(g.P, bad[i], sizeof bad[i]);
        mh_gaussian_write(&g, bytes);
        TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_gaussian_read(&untouched, 2, bytes));
    }
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_gaussian_read(&untouched, 0, bytes));
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_gaussian_read(&untouched, MH_STATES_MAX + 1, bytes));
    TEST_ASSERT_EQUAL_MEMORY(&before, &untouched, sizeof before);
}

static void check_says_what_is_wrong(void)
{
    struct mh_gaussian g;
    seed = 3;
    draw_gaussian(&g, 3);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_check(&g));
    g.n = 0;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_gaussian_check(&g));
    g.n = 255;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_gaussian_check(&g));
    g.n = 3;
    g.P[1] = 100;
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_gaussian_check(&g));
    g.x[2] = INFINITY;
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_gaussian_check(&g));
}

/* F P F' + Q written out, with F full of random numbers and with zeros */
static void prediction_is_the_textbooks(void)
{
    seed = 4;
    for (int round = 0; round < 10; round++) {
        struct mh_gaussian g, before;
        mh_real F[16], Q[10] = {0}, part[10];
        draw_gaussian(&g, 4);
        for (int i = 0; i < 16; i++) {
            F[i] = i % (round + 1) == 0 ? draw() : (mh_real)(i % 5 == 0);
        }
        for (int i = 0; i < 4; i++) {
            Q[MH_PACKED(i, i)] = 0.2f;
        }
        Q[1] = 0.1f;
        before = g;
        memcpy(part, g.P, sizeof part);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_predict(&g, F, Q));
        mh_covariance_predict(4, part, F, Q);
        for (int i = 0; i < 4; i++) {
            mh_real x = 0;
            for (int k = 0; k < 4; k++) {
                x += F[4 * i + k] * before.x[k];
            }
            TEST_ASSERT_FLOAT_WITHIN(2e-5f, x, g.x[i]);
            for (int j = 0; j <= i; j++) {
                mh_real sum = element(Q, i, j);
                for (int k = 0; k < 4; k++) {
                    for (int m = 0; m < 4; m++) {
                        sum += F[4 * i + k] * element(before.P, k, m) * F[4 * j + m];
                    }
                }
                TEST_ASSERT_FLOAT_WITHIN(2e-5f, sum, element(g.P, i, j));
                TEST_ASSERT_FLOAT_WITHIN(2e-5f, sum, element(part, i, j));
            }
        }
    }
}

static void bad_predictions_change_nothing(void)
{
    struct mh_gaussian g;
    const mh_real F[4] = {1, 1, 0, 1}, bad_F[4] = {1, NAN, 0, 1}, huge_F[4] = {1e30f, 0, 0, 1}, no_F[4] = {1, 0, 0, 0};
    const mh_real Q[3] = {1, 0, 1}, bad_Q[3] = {1, INFINITY, 1}, no_Q[3] = {0, 0, 0}, indefinite_Q[3] = {-100, 0, 1};
    seed = 5;
    draw_gaussian(&g, 2);
    struct mh_gaussian before = g;
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_gaussian_predict(&g, bad_F, Q));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_gaussian_predict(&g, huge_F, Q));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_gaussian_predict(&g, F, bad_Q));
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_gaussian_predict(&g, no_F, no_Q));
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_gaussian_predict(&g, F, indefinite_Q));
    TEST_ASSERT_EQUAL_MEMORY(&before, &g, sizeof g);
    g.P[1] = before.P[1] = 100;
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_gaussian_predict(&g, F, Q));
    g.n = before.n = 0;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_gaussian_predict(&g, F, Q));
    TEST_ASSERT_EQUAL_MEMORY(&before, &g, sizeof g);
}

/* x + P h v / s, P - P h h' P / s, s = h' P h + r; and A = I - K h' by both ways */
static void one_scalar_taken(void)
{
    seed = 6;
    for (int round = 0; round < 10; round++) {
        struct mh_gaussian g, after;
        struct mh_gaussian_root root;
        mh_real h[4], c[4], Ph[4] = {0}, A[16], s = 0.3f;
        draw_gaussian(&g, 4);
        for (int i = 0; i < 4; i++) {
            h[i] = (round + i) % 3 ? draw() : 0;
        }
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_factor(&root, &g));
        for (int i = 0; i < 4; i++) {
            for (int j = 0; j < 4; j++) {
                Ph[i] += element(g.P, i, j) * h[j];
            }
            s += Ph[i] * h[i];
        }
        mh_gaussian_root_gradient(&root, h, c);
        mh_gaussian_root_take(&root, c, 2.0f, 0.3f);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_compose(&after, &root));
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_reduction(&g, &after, A));
        for (int i = 0; i < 4; i++) {
            TEST_ASSERT_FLOAT_WITHIN(2e-5f, g.x[i] + Ph[i] * 2.0f / s, after.x[i]);
            for (int j = 0; j < 4; j++) {
                TEST_ASSERT_FLOAT_WITHIN(1e-5f, element(g.P, i, j) - Ph[i] * Ph[j] / s, element(after.P, i, j));
                TEST_ASSERT_FLOAT_WITHIN(1e-4f, (mh_real)(i == j) - Ph[i] * h[j] / s, A[4 * i + j]);
            }
        }
    }
}

/* Of two states only their sum is known, to 1e-10 of their variances: more than a covariance in float can say. What is left can be factored. */
static void what_float_cannot_say_is_raised(void)
{
    const mh_real h[2] = {1, 1};
    mh_real c[2];
    struct mh_gaussian g = {2, {0, 0}, {1e6f, 0, 1e6f}}, after;
    struct mh_gaussian_root root;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_factor(&root, &g));
    mh_gaussian_root_gradient(&root, h, c);
    mh_gaussian_root_take(&root, c, 100.0f, 1e-4f);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_compose(&after, &root));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_check(&after));
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 50, after.x[0]);
    TEST_ASSERT_FLOAT_WITHIN(10, 5e5f, after.P[0]);
    TEST_ASSERT_FLOAT_WITHIN(10, -5e5f, after.P[1]);
    TEST_ASSERT_FLOAT_WITHIN(10, 5e5f, after.P[2]);

    const mh_real swallowed[3] = {1, 1, 1}, fine[3] = {1, 0.5f, 1}, indefinite[3] = {1, 1.001f, 1};
    memcpy(g.P, swallowed, sizeof swallowed);
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_gaussian_check(&g));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_settle(&g));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_check(&g));
    TEST_ASSERT_FLOAT_WITHIN(2e-6f, 1, g.P[2]);
    memcpy(g.P, fine, sizeof fine);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_settle(&g));
    TEST_ASSERT_EQUAL_MEMORY(fine, g.P, sizeof fine);
    memcpy(g.P, indefinite, sizeof indefinite);
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_gaussian_settle(&g));
}

/* Two of three combinations of the states are known to a thousandth or less, in any directions: whatever comes of it can be factored. */
static void narrow_ridges_can_be_factored(void)
{
    uint32_t draw = 1;
    for (int trial = 0; trial < 300; trial++) {
        struct mh_gaussian g = {3, {0, 0, 0}, {2e4f, 0, 1e4f, 0, 0, 900}};
        for (int k = 0; k < 4; k++) {
            struct mh_gaussian_root root;
            mh_real h[3], c[3];
            for (int i = 0; i < 3; i++) {
                draw = draw * 1664525u + 1013904223u;
                h[i] = (mh_real)(draw >> 8) / 8388608.0f - 1;
            }
            TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_factor(&root, &g));
            mh_gaussian_root_gradient(&root, h, c);
            mh_gaussian_root_take(&root, c, 0, k < 2 ? 1e-4f : 1e-2f);
            TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_compose(&g, &root));
        }
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_gaussian_check(&g));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(as_bytes_and_back);
    RUN_TEST(corrupt_bytes_are_refused);
    RUN_TEST(check_says_what_is_wrong);
    RUN_TEST(prediction_is_the_textbooks);
    RUN_TEST(bad_predictions_change_nothing);
    RUN_TEST(one_scalar_taken);
    RUN_TEST(what_float_cannot_say_is_raised);
    RUN_TEST(narrow_ridges_can_be_factored);
    port_exit(UNITY_END() > 0);
    return 0;
}
