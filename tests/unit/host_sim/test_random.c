#include "engine/random.h"
#include "port.h"
#include "unity.h"

#include <math.h>

void setUp(void) {}
void tearDown(void) {}

/* Outputs of Vigna's splitmix64.c from state 1234567. */
static void splitmix64_reference_values(void)
{
    static const uint64_t reference[] = {UINT64_C(6457827717110365317), UINT64_C(3203168211198807973),
                                         UINT64_C(9817491932198370423), UINT64_C(4593380528125082431),
                                         UINT64_C(16408922859458223821)};
    const struct random_stream stream = random_stream(1234567, RANDOM_DEPLOYMENT);
    for (unsigned i = 0; i < 5; i++) {
        TEST_ASSERT_EQUAL_HEX64(reference[i], random_bits(stream, i));
    }
}

static void uniform_has_the_moments_of_one(void)
{
    enum { DRAWS = 1000000 };
    const struct random_stream stream = random_stream(3, RANDOM_RADIO_LOSS);
    double sum = 0, square = 0;
    for (uint64_t i = 0; i < DRAWS; i++) {
        const double u = random_uniform(stream, i);
        TEST_ASSERT_TRUE(u >= 0 && u < 1);
        sum += u;
        square += u * u;
    }
    TEST_ASSERT_TRUE(fabs(sum / DRAWS - 0.5) < 4 * sqrt(1.0 / 12 / DRAWS));
    TEST_ASSERT_TRUE(fabs(square / DRAWS - 1.0 / 3) < 4 * sqrt(4.0 / 45 / DRAWS));
}

static void normals_have_the_moments_of_one(void)
{
    enum { DRAWS = 1000000 };
    static double normals[DRAWS];
    random_normals(random_stream(5, RANDOM_ADDITIVE_NOISE), 0, DRAWS, normals);
    double moments[4] = {0}, neighbours = 0;
    for (unsigned i = 0; i < DRAWS; i++) {
        double power = 1;
        for (int m = 0; m < 4; m++) {
            power *= normals[i];
            moments[m] += power / DRAWS;
        }
        neighbours += normals[i] * normals[(i + 1) % DRAWS] / DRAWS;
    }
    const double sd = 1 / sqrt((double)DRAWS);
    TEST_ASSERT_TRUE(fabs(moments[0]) < 4 * sd);
    TEST_ASSERT_TRUE(fabs(moments[1] - 1) < 4 * sqrt(2.0) * sd);
    TEST_ASSERT_TRUE(fabs(moments[2]) < 4 * sqrt(15.0) * sd);
    TEST_ASSERT_TRUE(fabs(moments[3] - 3) < 4 * sqrt(96.0) * sd);
    TEST_ASSERT_TRUE(fabs(neighbours) < 4 * sd);
}

/* A number belongs to its place in the stream, wherever a block begins. */
static void normals_do_not_depend_on_the_block(void)
{
    const struct random_stream stream = random_stream(5, RANDOM_RELATIVE_NOISE);
    double all[101], part[101];
    random_normals(stream, 0, 101, all);
    for (unsigned first = 0; first < 101; first++) {
        for (unsigned count = 1; first + count <= 101; count += 3) {
            random_normals(stream, first, count, part);
            TEST_ASSERT_EQUAL_MEMORY(all + first, part, count * sizeof part[0]);
        }
    }
}

static void purposes_and_seeds_are_independent(void)
{
    enum { DRAWS = 100000 };
    static double a[DRAWS], b[DRAWS];
    const struct random_stream streams[] = {
        random_stream(1, RANDOM_DEPLOYMENT),     random_stream(2, RANDOM_DEPLOYMENT),
        random_stream(1, RANDOM_RELATIVE_NOISE), random_stream(1, RANDOM_ADDITIVE_NOISE),
        random_stream(1, RANDOM_READING_LOSS),   random_stream(1, RANDOM_RADIO_LOSS)};
    for (unsigned i = 0; i < 6; i++) {
        for (unsigned j = 0; j < i; j++) {
            random_normals(streams[i], 0, DRAWS, a);
            random_normals(streams[j], 0, DRAWS, b);
            double correlation = 0;
            for (unsigned k = 0; k < DRAWS; k++) {
                correlation += a[k] * b[k] / DRAWS;
            }
            TEST_ASSERT_TRUE(fabs(correlation) < 4 / sqrt((double)DRAWS));
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(splitmix64_reference_values);
    RUN_TEST(uniform_has_the_moments_of_one);
    RUN_TEST(normals_have_the_moments_of_one);
    RUN_TEST(normals_do_not_depend_on_the_block);
    RUN_TEST(purposes_and_seeds_are_independent);
    port_exit(UNITY_END() > 0);
    return 0;
}
