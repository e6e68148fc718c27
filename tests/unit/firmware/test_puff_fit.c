#include "motehound/puff_fit.h"
#include "port.h"
#include "reals.h"

#include <stddef.h>

#define COUNT 6

void setUp(void) {}
void tearDown(void) {}

static const struct mh_vec2 nodes[COUNT] = {{MH_REAL(1.0f), 0},
                                            {MH_REAL(-1.5f), MH_REAL(0.5f)},
                                            {0, MH_REAL(2.0f)},
                                            {MH_REAL(0.5f), MH_REAL(-1.0f)},
                                            {MH_REAL(3.0f), MH_REAL(1.0f)},
                                            {MH_REAL(-1.0f), MH_REAL(-2.0f)}};

static const struct mh_puff truth = {{MH_REAL(0.3f), MH_REAL(-0.2f)}, MH_REAL(0.8f), MH_REAL(60.0f)};

static mh_concentration concentration(float g)
{
    return FLOAT_FIXED(g, g < 2048 ? (mh_q20)(g * 1048576.0f + 0.5f) : INT32_MAX);
}

static struct mh_puff_sample sample(float x, float y, float g)
{
    const struct mh_puff_sample made = {{mh_real_from_float(x), mh_real_from_float(y)}, concentration(g)};
    return made;
}

static mh_real at(const struct mh_puff *puff, struct mh_vec2 node)
{
    return mh_puff_concentration(puff, MH_REAL(1.5f), node, NULL);
}

/* What the nodes read of one puff; returns the index of the largest. */
static size_t puff_samples(const struct mh_puff *puff, struct mh_puff_sample samples[COUNT])
{
    size_t largest = 0;
    for (size_t k = 0; k < COUNT; k++) {
        samples[k].position = nodes[k];
        samples[k].concentration = FLOAT_FIXED(at(puff, nodes[k]), mh_q20_from_real(at(puff, nodes[k])));
        largest = samples[k].concentration > samples[largest].concentration ? k : largest;
    }
    return largest;
}

static enum mh_status solve_linear(const struct mh_puff_sample *samples, size_t count, size_t reference, float age_max,
                                   struct mh_puff_answer *answer)
{
    struct mh_puff_linear fit;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_puff_linear_begin(&fit, MH_REAL(1.5f), &samples[reference]));
    for (size_t k = 0; k < count; k++) {
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_puff_linear_add(&fit, &samples[k]));
    }
    return mh_puff_linear_solve(&fit, mh_real_from_float(age_max), answer);
}

/* Eq. (4) against the formula by hand, its derivatives against central differences. */
static void model(void)
{
    const struct mh_puff puff = truth;
    const struct mh_vec2 node = {MH_REAL(1.0f), MH_REAL(1.0f)};
    struct mh_puff_slope slope;
    const mh_real c = mh_puff_concentration(&puff, MH_REAL(1.5f), node, &slope);
    EXPECT_REAL(1e-5f, 6e-5f, 2.6615680f, c); /* 60 / (4.8 pi) exp(-1.93 / 4.8) */
    const mh_real h = MH_REAL(0.03125f);
    struct mh_puff a = puff, b = puff;
    a.position.x -= h, b.position.x += h;
    EXPECT_REAL(1e-3f, 2e-3f, mh_real_to_float((at(&b, node) - at(&a, node)) * 16), slope.x);
    a = b = puff;
    a.position.y -= h, b.position.y += h;
    EXPECT_REAL(1e-3f, 2e-3f, mh_real_to_float((at(&b, node) - at(&a, node)) * 16), slope.y);
    a = b = puff;
    a.age -= h, b.age += h;
    EXPECT_REAL(2e-3f, 3e-3f, mh_real_to_float((at(&b, node) - at(&a, node)) * 16), slope.age);
    EXPECT_REAL(0, 0, mh_real_to_float(c), slope.log_mass);
    a.age = 0;
    TEST_ASSERT_TRUE(mh_puff_concentration(&a, MH_REAL(1.5f), node, &slope) == 0);
    TEST_ASSERT_TRUE(slope.age == 0);
}

static void an_exact_puff_is_found(void)
{
    struct mh_puff_sample samples[COUNT];
    const size_t largest = puff_samples(&truth, samples);
    struct mh_puff_answer answer;
    TEST_ASSERT_EQUAL_INT(MH_OK, solve_linear(samples, COUNT, largest, 5, &answer));
    TEST_ASSERT_EQUAL_INT(MH_BOUND_NONE, answer.bound);
    EXPECT_REAL(1e-4f, 2e-4f, 0.3f, answer.puff.position.x);
    EXPECT_REAL(1e-4f, 2e-4f, -0.2f, answer.puff.position.y);
    EXPECT_REAL(1e-4f, 2e-4f, 0.8f, answer.puff.age);
    EXPECT_REAL(0.01f, 0.02f, 60, answer.puff.mass);
}

/* Four nodes on the corners of a square read the same from a puff in its middle whatever its age. */
static void undetermined_age_is_the_largest(void)
{
    const struct mh_puff_sample corners[4] = {sample(0, 0, 3), sample(2, 0, 3), sample(2, 2, 3), sample(0, 2, 3)};
    struct mh_puff_answer answer;
    TEST_ASSERT_EQUAL_INT(MH_OK, solve_linear(corners, 4, 0, 0.7f, &answer));
    TEST_ASSERT_EQUAL_INT(MH_BOUND_HIGH, answer.bound);
    TEST_ASSERT_TRUE(answer.puff.age == MH_REAL(0.7f));
    EXPECT_REAL(1e-5f, 2e-5f, 1, answer.puff.position.x);
    EXPECT_REAL(1e-5f, 2e-5f, 1, answer.puff.position.y);
}

/* More on the corners than in the middle asks for a negative age. With the age 0 symmetry leaves one unknown, e = n, in
 * 4 e = 4, 8 e = 8, 4 e = 4, 4 e = 2. */
static void negative_age_is_zero(void)
{
    const struct mh_puff_sample samples[5] = {sample(0, 0, 2), sample(2, 0, 2), sample(2, 2, 2), sample(0, 2, 2),
                                              sample(1, 1, 1)};
    struct mh_puff_answer answer;
    TEST_ASSERT_EQUAL_INT(MH_OK, solve_linear(samples, 5, 0, 3, &answer));
    TEST_ASSERT_EQUAL_INT(MH_BOUND_LOW, answer.bound);
    TEST_ASSERT_TRUE(answer.puff.age == 0);
    EXPECT_REAL(1e-5f, 2e-5f, 104.0f / 112.0f, answer.puff.position.x);
    EXPECT_REAL(1e-5f, 2e-5f, 104.0f / 112.0f, answer.puff.position.y);
}

#if !MH_REAL_FIXED

static enum mh_status solve_nonlinear(const struct mh_puff_sample *samples, size_t reference, struct mh_vec2 position,
                                      mh_real age, mh_real age_max, struct mh_puff_answer *answer, mh_real *cost)
{
    struct mh_puff_nonlinear fit;
    enum mh_status status = mh_puff_nonlinear_begin(&fit, 1.5f, &samples[reference], position, age, age_max);
    TEST_ASSERT_EQUAL_INT(MH_OK, status);
    do {
        for (size_t k = 0; k < COUNT; k++) {
            TEST_ASSERT_EQUAL_INT(MH_OK, mh_puff_nonlinear_add(&fit, &samples[k]));
        }
        status = mh_puff_nonlinear_advance(&fit, answer);
        TEST_ASSERT_LESS_OR_EQUAL_UINT8(24, fit.passes);
    } while (status == MH_NONE);
    *cost = fit.cost;
    return status;
}

/* The answer of the linear problem, from a start that is a metre and a factor of 3 off. */
static void the_nonlinear_problem_finds_an_exact_puff(void)
{
    struct mh_puff_sample samples[COUNT];
    const size_t largest = puff_samples(&truth, samples);
    struct mh_puff_answer answer;
    mh_real cost;
    const struct mh_vec2 start = {1, 0.5f};
    TEST_ASSERT_EQUAL_INT(MH_OK, solve_nonlinear(samples, largest, start, 2.4f, 5, &answer, &cost));
    TEST_ASSERT_EQUAL_INT(MH_BOUND_NONE, answer.bound);
    TEST_ASSERT_FLOAT_WITHIN(1e-2f, truth.position.x, answer.puff.position.x);
    TEST_ASSERT_FLOAT_WITHIN(1e-2f, truth.position.y, answer.puff.position.y);
    TEST_ASSERT_FLOAT_WITHIN(1e-2f, truth.age, answer.puff.age);
}

/* With the age on its bound no neighbour within the bound may cost less: brute force around the nonlinear answer. */
static void bounded_nonlinear_minimum(void)
{
    struct mh_puff_sample samples[COUNT];
    const size_t largest = puff_samples(&truth, samples);
    struct mh_puff_answer answer;
    mh_real cost;
    TEST_ASSERT_EQUAL_INT(MH_OK,
                          solve_nonlinear(samples, largest, samples[largest].position, 0.2f, 0.5f, &answer, &cost));
    TEST_ASSERT_EQUAL_INT(MH_BOUND_HIGH, answer.bound);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.5f, answer.puff.age);
    for (int8_t direction = 0; direction < 7; direction++) {
        struct mh_puff other = answer.puff;
        other.position.x += direction == 0 ? 0.05f : direction == 1 ? -0.05f : 0;
        other.position.y += direction == 2 ? 0.05f : direction == 3 ? -0.05f : 0;
        other.mass *= direction == 4 ? 1.05f : direction == 5 ? 0.95f : 1;
        other.age *= direction == 6 ? 0.95f : 1;
        mh_real sum = 0;
        for (size_t k = 0; k < COUNT; k++) {
            const mh_real r = samples[k].concentration - at(&other, nodes[k]);
            sum += r * r;
        }
        TEST_ASSERT_TRUE(sum > cost);
    }
}

static void bad_input_to_the_nonlinear_problem(void)
{
    struct mh_puff_nonlinear nonlinear;
    struct mh_puff_answer answer = {{{0, 0}, 0, 0}, MH_BOUND_NONE};
    const struct mh_puff_sample fine = {{0, 0}, 1}, nan = {{NAN, 0}, 1};
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, mh_puff_nonlinear_begin(&nonlinear, 1, &fine, fine.position, 1, 0));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_puff_nonlinear_begin(&nonlinear, 1, &fine, fine.position, NAN, 1));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_puff_nonlinear_begin(&nonlinear, 1, &fine, fine.position, 1, 1));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_puff_nonlinear_add(&nonlinear, &nan));
    TEST_ASSERT_EQUAL_INT(MH_ERR_TOO_FEW, mh_puff_nonlinear_advance(&nonlinear, &answer));
    TEST_ASSERT_EQUAL_FLOAT(0, answer.puff.mass);
}

#endif

/* Two of the known answers in tests/known_answers/luo (double precision). */
struct known {
    float age_max, x, y, age;
    enum mh_bound bound;
    uint8_t count;
    float samples[8][3]; /* x, y, concentration */
};

static const struct known known[] = {
    {10.0f,
     60.9055163f,
     21.6896263f,
     1.38064239f,
     MH_BOUND_NONE,
     6,
     {{60.0928482f, 20.4323851f, 3.31701957f},
      {59.0150564f, 24.1031004f, 1.04789072f},
      {63.4993726f, 21.0465543f, 1.56837713f},
      {60.4642408f, 22.1619255f, 5.08513026f},
      {63.8707652f, 22.7760946f, 0.844356434f},
      {61.9134252f, 20.2207506f, 3.37426946f}}},
    {0.288292983f,
     57.279692f,
     50.8635707f,
     0.288292983f,
     MH_BOUND_HIGH,
     8,
     {{56.0915934f, 49.5085396f, 3.30957901f},
      {59.4981179f, 50.1227087f, 3.22052137f},
      {58.4203261f, 53.793424f, 0.0472101836f},
      {57.5407778f, 47.5673647f, 0.170787986f},
      {56.4629861f, 51.23808f, 4.16179794f},
      {54.505646f, 48.6827359f, 0.0157702945f},
      {59.8695105f, 51.8522491f, 0.402175019f},
      {57.9121705f, 49.2969051f, 5.37363558f}}},
};

static void known_answers(void)
{
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        struct mh_puff_sample samples[8];
        size_t largest = 0;
        for (size_t k = 0; k < known[i].count; k++) {
            samples[k] = sample(known[i].samples[k][0], known[i].samples[k][1], known[i].samples[k][2]);
            largest = samples[k].concentration > samples[largest].concentration ? k : largest;
        }
        struct mh_puff_linear fit;
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_puff_linear_begin(&fit, MH_REAL(1.0f), &samples[largest]));
        for (size_t k = 0; k < known[i].count; k++) {
            TEST_ASSERT_EQUAL_INT(MH_OK, mh_puff_linear_add(&fit, &samples[k]));
        }
        struct mh_puff_answer answer;
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_puff_linear_solve(&fit, mh_real_from_float(known[i].age_max), &answer));
        TEST_ASSERT_EQUAL_INT(known[i].bound, answer.bound);
        EXPECT_REAL(1e-3f, 1e-3f, known[i].x, answer.puff.position.x);
        EXPECT_REAL(1e-3f, 1e-3f, known[i].y, answer.puff.position.y);
        EXPECT_REAL(1e-3f, 1e-3f, known[i].age, answer.puff.age);
    }
}

static void bad_input(void)
{
    struct mh_puff_linear fit;
    const struct mh_puff_sample fine = sample(0, 0, 1), none = sample(0, 0, 0), nan = sample(NAN, 0, 1),
                                infinite = sample(0, 0, INFINITY);
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, mh_puff_linear_begin(&fit, 0, &fine));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_puff_linear_begin(&fit, NOT_A_NUMBER, &fine));
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, mh_puff_linear_begin(&fit, MH_REAL(1.0f), &none));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_puff_linear_begin(&fit, MH_REAL(1.0f), &fine));
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, mh_puff_linear_add(&fit, &none));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_puff_linear_add(&fit, &nan));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_puff_linear_add(&fit, &infinite));
    struct mh_puff_answer answer = {{{0, 0}, 0, 0}, MH_BOUND_NONE};
    const struct mh_puff_sample line[4] = {sample(0, 0, 1), sample(1, 1, 2), sample(2, 2, 3), sample(3, 3, 2)};
    TEST_ASSERT_EQUAL_INT(MH_ERR_TOO_FEW, solve_linear(line, 3, 2, 1, &answer));
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, solve_linear(line, 4, 2, 1, &answer));
    TEST_ASSERT_TRUE(answer.puff.mass == 0);
}

#if MH_REAL_FIXED
/* The farthest node that the squares have room for, and one beyond; diffusion coefficients that lose their digits. */
static void what_has_no_room_is_refused(void)
{
    struct mh_puff_linear fit;
    const struct mh_puff_sample reference = sample(0, 0, 1), far = sample(180, -180, 0.5f),
                                farther = sample(257, 0, 0.5f), farthest = sample(32767, 32767, 0.5f);
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, mh_puff_linear_begin(&fit, MH_REAL(0.009f), &reference));
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, mh_puff_linear_begin(&fit, MH_REAL(501.0f), &reference));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_puff_linear_begin(&fit, MH_REAL(500.0f), &reference));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_puff_linear_add(&fit, &far));
    const struct mh_puff_linear kept = fit;
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, mh_puff_linear_add(&fit, &farther));
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, mh_puff_linear_add(&fit, &farthest));
    TEST_ASSERT_EQUAL_MEMORY(&kept, &fit, sizeof kept);
}
#endif

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(model);
    RUN_TEST(an_exact_puff_is_found);
    RUN_TEST(undetermined_age_is_the_largest);
    RUN_TEST(negative_age_is_zero);
#if !MH_REAL_FIXED
    RUN_TEST(the_nonlinear_problem_finds_an_exact_puff);
    RUN_TEST(bounded_nonlinear_minimum);
    RUN_TEST(bad_input_to_the_nonlinear_problem);
#else
    RUN_TEST(what_has_no_room_is_refused);
#endif
    RUN_TEST(known_answers);
    RUN_TEST(bad_input);
    port_exit(UNITY_END() > 0);
    return 0;
}
