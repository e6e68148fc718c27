#include "motehound/matrix.h"
#include "port.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

/* A = B B' + I with B[i][j] = (i + 1)^(j % 3) / 5, n = 5: known to be positive definite */
#define N 5

static void fill(mh_real *a)
{
    for (int i = 0; i < N; i++) {
        for (int j = 0; j <= i; j++) {
            mh_real sum = i == j ? 1.0f : 0.0f;
            for (int k = 0; k < 3; k++) {
                mh_real x = 0.2f, y = 0.2f;
                for (int power = 0; power < k; power++) {
                    x *= (mh_real)(i + 1);
                    y *= (mh_real)(j + 1);
                }
                sum += x * y;
            }
            a[mh_packed_index(i, j)] = sum;
        }
    }
}

static void index_of_either_triangle(void)
{
    TEST_ASSERT_EQUAL_INT(0, mh_packed_index(0, 0));
    TEST_ASSERT_EQUAL_INT(4, mh_packed_index(2, 1));
    TEST_ASSERT_EQUAL_INT(4, mh_packed_index(1, 2));
    TEST_ASSERT_EQUAL_INT(MH_PACKED_SIZE(4) - 1, mh_packed_index(3, 3));
}

static void factor_of_a_known_matrix(void)
{
    /* (4 2; 2 10) = L L' with L = (2 0; 1 3) */
    mh_real a[MH_PACKED_SIZE(2)] = {4.0f, 2.0f, 10.0f};
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_cholesky_factor(2, a));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 2.0f, a[0]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1.0f, a[1]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 3.0f, a[2]);
    mh_real b[2] = {8.0f, 22.0f};
    mh_cholesky_solve(2, a, b);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1.0f, b[0]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 2.0f, b[1]);
    mh_cholesky_invert(2, a);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 10.0f / 36.0f, a[0]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, -2.0f / 36.0f, a[1]);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 4.0f / 36.0f, a[2]);
}

static void solution_and_inverse_undo_the_product(void)
{
    mh_real a[MH_PACKED_SIZE(N)], l[MH_PACKED_SIZE(N)], b[N];
    fill(a);
    fill(l);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_cholesky_factor(N, l));
    for (int i = 0; i < N; i++) {
        b[i] = 0.0f;
        for (int j = 0; j < N; j++) {
            b[i] += a[mh_packed_index(i, j)] * (mh_real)(j - 2);
        }
    }
    mh_cholesky_solve(N, l, b);
    mh_cholesky_invert(N, l);
    for (int i = 0; i < N; i++) {
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, (mh_real)(i - 2), b[i]);
        for (int j = 0; j < N; j++) {
            mh_real sum = 0.0f;
            for (int k = 0; k < N; k++) {
                sum += a[mh_packed_index(i, k)] * l[mh_packed_index(k, j)];
            }
            TEST_ASSERT_FLOAT_WITHIN(1e-4f, i == j ? 1.0f : 0.0f, sum);
        }
    }
}

static void not_positive_definite_is_an_error(void)
{
    mh_real indefinite[MH_PACKED_SIZE(2)] = {1.0f, 2.0f, 1.0f};
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_cholesky_factor(2, indefinite));
    mh_real singular[MH_PACKED_SIZE(2)] = {1.0f, 3.0f, 9.0f};
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_cholesky_factor(2, singular));
    mh_real zero = 0.0f, infinite = INFINITY, undefined = NAN;
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_cholesky_factor(1, &zero));
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_cholesky_factor(1, &infinite));
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_cholesky_factor(1, &undefined));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(index_of_either_triangle);
    RUN_TEST(factor_of_a_known_matrix);
    RUN_TEST(solution_and_inverse_undo_the_product);
    RUN_TEST(not_positive_definite_is_an_error);
    port_exit(UNITY_END() > 0);
    return 0;
}
