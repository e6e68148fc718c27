/* The fixed-point scalar against what it stands for, computed in float, and against integers where those are exact. */
#include "motehound/geometry.h"
#include "port.h"

#include <math.h>
#include <unity.h>

void setUp(void) {}
void tearDown(void) {}

#define ULP (1.0f / 65536)

static void test_constants_are_rounded_to_nearest(void)
{
    TEST_ASSERT_EQUAL_INT32(65536, MH_REAL(1.0f));
    TEST_ASSERT_EQUAL_INT32(-6554, MH_REAL(-0.1f));
}

static void test_products_and_quotients_are_rounded_and_saturate(void)
{
    TEST_ASSERT_EQUAL_INT32(MH_REAL(-3.75f), mh_mul(MH_REAL(1.5f), MH_REAL(-2.5f)));
    TEST_ASSERT_EQUAL_INT32(1, mh_mul(MH_REAL(0.5f), 1)); /* half of the last place: up */
    TEST_ASSERT_EQUAL_INT32(MH_REAL(-0.6f), mh_div(MH_REAL(1.5f), MH_REAL(-2.5f)));
    TEST_ASSERT_EQUAL_INT32(MH_REAL_INFINITE, mh_mul(MH_REAL(200.0f), MH_REAL(200.0f)));
    TEST_ASSERT_EQUAL_INT32(-MH_REAL_INFINITE, mh_div(MH_REAL(-200.0f), MH_REAL(0.001f)));
    TEST_ASSERT_FALSE(mh_finite(mh_div(0, 0)));
    TEST_ASSERT_EQUAL_INT32(MH_REAL_INFINITE, mh_add(MH_REAL_INFINITE, MH_REAL(-5.0f)));
}

static void test_squared_lengths_do_not_end_where_reals_do(void)
{
    const struct mh_vec2 far = {MH_REAL(-3000.0f), MH_REAL(4000.0f)}, infinite = {MH_REAL_INFINITE, -MH_REAL_INFINITE};
    TEST_ASSERT_EQUAL_INT32(MH_REAL(5000.0f), mh_vec2_length(far));
    TEST_ASSERT_TRUE(mh_vec2_square(far) < mh_wide_mul(MH_REAL(5000.1f), MH_REAL(5000.1f)));
    TEST_ASSERT_EQUAL_INT32(MH_REAL(-6250.0f), mh_wide_div(-mh_vec2_square(far), MH_REAL(4000.0f)));
    TEST_ASSERT_EQUAL_INT32(MH_REAL_INFINITE, mh_wide_to_real(mh_vec2_square(far)));
    TEST_ASSERT_EQUAL_INT32(MH_REAL(-0.75f), mh_wide_to_real(mh_wide_mul(MH_REAL(1.5f), MH_REAL(-0.5f))));
    TEST_ASSERT_FALSE(mh_finite(mh_vec2_length(infinite)));
    TEST_ASSERT_FALSE(mh_finite(mh_vec2_between(infinite, far).x));
    TEST_ASSERT_FALSE(mh_finite(mh_vec2_along(far, MH_REAL(3000.0f), far).y));
    TEST_ASSERT_EQUAL_INT32(-2500, mh_real_times(MH_REAL(-2.5f), 1000));
    TEST_ASSERT_EQUAL_INT32(0, mh_real_times(MH_REAL(-0.9f), 1));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, mh_real_times(MH_REAL(30000.0f), 100000));
}

static void test_functions_are_as_near_as_said(void)
{
    for (mh_real at = MH_REAL(0.01f); at < MH_REAL(10.0f); at += MH_REAL(0.37f)) {
        const float x = mh_real_to_float(at);
        const float root = (float)sqrtf(x), logarithm = (float)logf(x), power = (float)expf(x);
        TEST_ASSERT_FLOAT_WITHIN(ULP, root, mh_real_to_float(mh_sqrt(at)));
        TEST_ASSERT_FLOAT_WITHIN(ULP, logarithm, mh_real_to_float(mh_log(at)));
        TEST_ASSERT_FLOAT_WITHIN(ULP + 3e-6f * power, power,
                                 mh_real_to_float(mh_exp(at))); /* the reference's error too */
        TEST_ASSERT_FLOAT_WITHIN(ULP, 1 / power, mh_real_to_float(mh_exp(-at)));
        const float angle = (float)atan2f(x - 5, 2 - x);
        TEST_ASSERT_FLOAT_WITHIN(3 * ULP, angle, mh_real_to_float(mh_atan2(at - MH_REAL(5.0f), MH_REAL(2.0f) - at)));
    }
    TEST_ASSERT_FALSE(mh_finite(mh_sqrt(-1)));
    TEST_ASSERT_FALSE(mh_finite(mh_log(0)));
    TEST_ASSERT_FALSE(mh_finite(mh_exp(MH_REAL(11.0f))));
}

/* What the integers of 64 bits of the language say. */
static mh_real saturated(uint64_t size, bool negative)
{
    const mh_real a = size > MH_REAL_MAX ? MH_REAL_INFINITE : (mh_real)size;
    return negative ? -a : a;
}

static uint64_t size_of(int64_t a) { return a < 0 ? (uint64_t)0 - (uint64_t)a : (uint64_t)a; }

static mh_real quotient(int64_t a, mh_real b)
{
    const uint64_t under = size_of(b);
    return saturated(b == 0 ? UINT64_MAX : (size_of(a) + under / 2) / under, (a < 0) != (b < 0));
}

static void assert_root(int64_t a, mh_real root)
{
    const int64_t twice = 2 * (int64_t)root; /* (2 root - 1)^2 <= 4 a < (2 root + 1)^2, exact in 64 bits for a < 2^61 */
    TEST_ASSERT_TRUE(root == 0 || (twice - 1) * (twice - 1) <= 4 * a);
    TEST_ASSERT_TRUE(4 * a < (twice + 1) * (twice + 1));
}

static void check(mh_real a, mh_real b)
{
    const int64_t product = (int64_t)a * b;
    const int64_t rounded = (product + 0x8000) >> 16;
    TEST_ASSERT_EQUAL_INT32(saturated(size_of(rounded), rounded < 0), mh_mul(a, b));
    TEST_ASSERT_EQUAL_INT32(quotient((int64_t)a * 65536, b), mh_div(a, b));
    TEST_ASSERT_EQUAL_INT32(quotient(product, a / 2), mh_wide_div(product, a / 2));
    TEST_ASSERT_EQUAL_INT32(quotient(product, b / 65536), mh_wide_div(product, b / 65536));
    for (uint8_t shift = 1; shift <= 62;
         shift = (uint8_t)(shift + 7)) { /* floor(a b / 2^shift + 1/2), without a sum to overflow */
        const int64_t down = product >> (shift - 1);
        const int64_t nearest = (down >> 1) + (down & 1);
        TEST_ASSERT_EQUAL_INT32(saturated(size_of(nearest), nearest < 0), mh_mul_shift(a, b, shift));
    }
    TEST_ASSERT_EQUAL_INT32(saturated(size_of(product), product < 0), mh_mul_shift(a, b, 0));
    TEST_ASSERT_EQUAL_INT32(saturated(size_of((int64_t)a + b), (int64_t)a + b < 0), mh_add(a, b));
    assert_root((int64_t)mh_abs(a) * 65536, mh_sqrt(mh_abs(a)));
    assert_root((int64_t)(size_of(product) / 2), mh_wide_sqrt((mh_wide)(size_of(product) / 2)));
}

static void test_the_same_as_integers_of_64_bits(void)
{
    static const mh_real edges[] = {0,      1,      2,       3,       0x7FFF,     0x8000,
                                    0x8001, 0xFFFF, 0x10000, 0x10001, 0x7FFF8000, MH_REAL_MAX};
    enum { EDGES = sizeof edges / sizeof edges[0] };
    for (uint8_t i = 0; i < EDGES; i++) {
        for (uint8_t k = 0; k < EDGES; k++) {
            check(edges[i], edges[k]);
            check(-edges[i], edges[k]);
            check(edges[i], -edges[k]);
            check(-edges[i], -edges[k]);
        }
    }
    uint32_t seed = 1;
    for (uint16_t i = 0; i < 500; i++) {
        mh_real drawn[2];
        for (uint8_t k = 0; k < 2; k++) {
            seed = seed * 1664525u + 1013904223u;
            const mh_real size = (mh_real)((seed >> 1) >> (seed & 31)); /* of every magnitude */
            drawn[k] = seed & 32 ? -size : size;
        }
        check(mh_max(drawn[0], -MH_REAL_MAX), mh_min(drawn[1], MH_REAL_MAX));
    }
}

/* FNV-1a of their bits, which is the same whatever the machine multiplies and divides with. */
static void test_functions_are_the_same_on_every_machine(void)
{
    uint32_t hash = 2166136261u, seed = 2;
    for (uint16_t i = 0; i < 200; i++) {
        seed = seed * 1664525u + 1013904223u;
        const mh_real a = (mh_real)((seed >> 1) >> (seed % 29)), b = MH_REAL(11.0f) - a % MH_REAL(23.0f);
        const mh_real values[] = {mh_exp(b), mh_log(a), mh_atan2(b, a), mh_atan2(a, b), mh_real_from_ratio(b, a | 1)};
        for (uint8_t k = 0; k < sizeof values / sizeof values[0]; k++) {
            hash = (hash ^ (uint32_t)values[k]) * 16777619u;
        }
    }
    TEST_ASSERT_EQUAL_HEX32(0x05FBDB09u, hash);
}

static void test_conversions(void)
{
    TEST_ASSERT_EQUAL_HEX32(0xBFC00000u, mh_real_to_ieee(MH_REAL(-1.5f)));
    TEST_ASSERT_EQUAL_INT32(MH_REAL(-1.5f), mh_real_from_ieee(0xBFC00000u));
    TEST_ASSERT_EQUAL_INT32(MH_REAL_INFINITE, mh_real_from_ieee(0x49742400u)); /* 1e6 */
    TEST_ASSERT_EQUAL_INT32(0, mh_real_from_ieee(0));
    TEST_ASSERT_EQUAL_INT32(MH_Q20_ONE, mh_q20_from_real(mh_q20_to_real(MH_Q20_ONE)));
    TEST_ASSERT_EQUAL_INT32(-3, mh_real_round(MH_REAL(-2.6f)));
    TEST_ASSERT_EQUAL_INT32(-32767, mh_real_round(-MH_REAL_INFINITE));
    TEST_ASSERT_EQUAL_INT32(32767, mh_real_round(MH_REAL_INFINITE));
    TEST_ASSERT_EQUAL_INT32(MH_REAL(0.25f), mh_real_from_ratio(250, 1000));
    const struct mh_place origin = {1000, 2000, 3},
                          place = mh_place_from_offset(&origin, (struct mh_vec2){MH_REAL(-1.5f), MH_REAL(0.25f)});
    TEST_ASSERT_EQUAL_INT32(-500, place.x_mm);
    TEST_ASSERT_EQUAL_INT32(2250, place.y_mm);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_constants_are_rounded_to_nearest);
    RUN_TEST(test_products_and_quotients_are_rounded_and_saturate);
    RUN_TEST(test_squared_lengths_do_not_end_where_reals_do);
    RUN_TEST(test_functions_are_as_near_as_said);
    RUN_TEST(test_the_same_as_integers_of_64_bits);
    RUN_TEST(test_functions_are_the_same_on_every_machine);
    RUN_TEST(test_conversions);
    port_exit(UNITY_END() > 0);
    return 0;
}
