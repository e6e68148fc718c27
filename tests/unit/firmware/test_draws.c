#include "motehound/bytes.h"
#include "motehound/random.h"
#include "port.h"
#include "unity.h"

#include <math.h>

void setUp(void) {}
void tearDown(void) {}

#define DRAWS 4096

/* Of DRAWS uniform numbers the mean is 1/2 +- 1 / sqrt(12 DRAWS) and the mean square 1/3 +- sqrt(4 / 45 / DRAWS); products of neighbours
 * 1/4 +- sqrt(7 / 144 / DRAWS). Five standard deviations are allowed. */
static void uniform_numbers(void)
{
    const uint32_t seeds[] = {0, 1, UINT32_MAX};
    for (uint8_t s = 0; s < 3; s++) {
        struct mh_random random;
        mh_random_init(&random, seeds[s]);
        float sum = 0, squares = 0, products = 0, last = mh_real_to_float(mh_random_unit(&random));
        for (uint16_t i = 0; i < DRAWS; i++) {
            const float u = mh_real_to_float(mh_random_unit(&random));
            TEST_ASSERT_TRUE(u >= 0.0f && u < 1.0f);
            sum += u;
            squares += u * u;
            products += u * last;
            last = u;
        }
        const float n = DRAWS;
        TEST_ASSERT_FLOAT_WITHIN(5.0f * sqrtf(1.0f / (12.0f * n)), 0.5f, sum / n);
        TEST_ASSERT_FLOAT_WITHIN(5.0f * sqrtf(4.0f / (45.0f * n)), 1.0f / 3.0f, squares / n);
        TEST_ASSERT_FLOAT_WITHIN(5.0f * sqrtf(7.0f / (144.0f * n)), 0.25f, products / n);
    }
}

/* Chi square with 9 degrees of freedom exceeds 33.7 once in 10,000 times. */
static void numbers_below_a_count(void)
{
    struct mh_random random;
    mh_random_init(&random, 7);
    uint16_t seen[10] = {0};
    for (uint16_t i = 0; i < DRAWS; i++) {
        const uint16_t number = mh_random_below(&random, 10);
        TEST_ASSERT_TRUE(number < 10);
        seen[number]++;
    }
    float chi_square = 0;
    for (uint8_t i = 0; i < 10; i++) {
        const float off = (float)seen[i] - DRAWS / 10.0f;
        chi_square += off * off / (DRAWS / 10.0f);
    }
    TEST_ASSERT_TRUE(chi_square < 33.7f);
    for (uint8_t i = 0; i < 100; i++) {
        TEST_ASSERT_EQUAL_UINT16(0, mh_random_below(&random, 1));
        TEST_ASSERT_TRUE(mh_random_below(&random, UINT16_MAX) < UINT16_MAX);
    }
}

static void same_seed_same_numbers(void)
{
    struct mh_random a, b, c;
    mh_random_init(&a, 5);
    mh_random_init(&b, 5);
    mh_random_init(&c, 6);
    bool differs = false;
    for (uint8_t i = 0; i < 10; i++) {
        const uint32_t word = mh_random_word(&a);
        TEST_ASSERT_EQUAL_UINT32(word, mh_random_word(&b));
        differs = differs || word != mh_random_word(&c);
    }
    TEST_ASSERT_TRUE(differs);
}

static void bytes_round_trip(void)
{
    uint8_t bytes[20];
    uint8_t *at = bytes;
    mh_put_u16(&at, 0xFFFE);
    mh_put_u32(&at, 0x80000000u);
    mh_put_u32(&at, 0x01020304u);
    mh_put_real(&at, MH_REAL(-2.5f));
    TEST_ASSERT_EQUAL_INT(14, at - bytes);
    const uint8_t expected[] = {0xFF, 0xFE, 0x80, 0, 0, 0, 1, 2, 3, 4, 0xC0, 0x20, 0, 0};
    TEST_ASSERT_EQUAL_UINT8_ARRAY(expected, bytes, 14);
    const uint8_t *from = bytes;
    TEST_ASSERT_EQUAL_INT16(-2, mh_get_i16(&from));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, mh_get_i32(&from));
    TEST_ASSERT_EQUAL_INT32(0x01020304, mh_get_i32(&from));
    TEST_ASSERT_EQUAL_FLOAT(-2.5f, mh_real_to_float(mh_get_real(&from)));
    TEST_ASSERT_EQUAL_INT(14, from - bytes);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(uniform_numbers);
    RUN_TEST(numbers_below_a_count);
    RUN_TEST(same_seed_same_numbers);
    RUN_TEST(bytes_round_trip);
    port_exit(UNITY_END() > 0);
    return 0;
}
