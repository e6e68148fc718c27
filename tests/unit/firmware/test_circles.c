#include "motehound/circles.h"
#include "motehound/random.h"
#include "port.h"
#include "unity.h"

#define R mh_real_from_float
#define F mh_real_to_float
#define TOLERANCE (MH_REAL_FIXED ? 2e-3f : 1e-4f)

void setUp(void) {}
void tearDown(void) {}

/* What an emulator does in a few seconds. */
#if defined(__AVR__) || defined(__arm__) || defined(__riscv)
#define TRIPLES 100
#else
#define TRIPLES 50000
#endif
#define FARTHEST 65.0f /* m */

static struct mh_circle circle(float x, float y, float radius)
{
    const struct mh_circle c = {{R(x), R(y)}, R(radius)};
    return c;
}

static void assert_at(float x, float y, struct mh_vec2 point)
{
    TEST_ASSERT_FLOAT_WITHIN(TOLERANCE, x, F(point.x));
    TEST_ASSERT_FLOAT_WITHIN(TOLERANCE, y, F(point.y));
}

/* The middle of the lens, of the gap, and of the narrow part between nested circles; either order gives the same. */
static void point_of_two_circles(void)
{
    static const struct {
        float ra, x, y, rb, at, chord; /* the second centre at (x, y); the point on the way there, in shares of it */
    } known[] = {
        {10, 12, 16, 10, 0.5f, 0.5f}, /* tangent */
        {10, 9, 12, 10, 0.5f, 0.5f},  /* crossing */
        {12, 9, 12, 9, 0.6f, 0.64f},  /* crossing, unequal: 12 + 15 - 9, 225 + 144 - 81 */
        {10, 18, 24, 10, 0.5f, 0.5f}, /* apart */
        {10, 1.8f, 2.4f, 5, 3, 3},    /* the second inside the first: 10 + 3 + 5 */
        {5, 1.8f, 2.4f, 10, -2, -2},  /* the first inside the second */
        {0, 9, 12, 0, 0.5f, 0.5f},    /* points */
    };
    for (unsigned i = 0; i < sizeof known / sizeof known[0]; i++) {
        const float x = known[i].x, y = known[i].y, at = known[i].at, chord = known[i].chord;
        const struct mh_circle a = circle(-3, 7, known[i].ra), b = circle(x - 3, y + 7, known[i].rb);
        assert_at(at * x - 3, at * y + 7, mh_two_circles(&a, &b));
        assert_at(at * x - 3, at * y + 7, mh_two_circles(&b, &a));
        assert_at(chord * x - 3, chord * y + 7, mh_two_circles_chord(&a, &b));
        assert_at(chord * x - 3, chord * y + 7, mh_two_circles_chord(&b, &a));
    }
    const struct mh_circle small = circle(4, 5, 2), large = circle(4, 5, 9);
    assert_at(4, 5, mh_two_circles(&small, &large));
    assert_at(4, 5, mh_two_circles(&small, &small));
    assert_at(4, 5, mh_two_circles_chord(&large, &small));
}

static void crossings_lie_on_both_circles(void)
{
    struct mh_vec2 at[2];
    const struct mh_circle a = circle(100, 50, 13), b = circle(114, 50, 15);
    TEST_ASSERT_TRUE(mh_crossings(&a, &b, at));
    assert_at(105, 62, at[0]);
    assert_at(105, 38, at[1]);
    TEST_ASSERT_TRUE(mh_crossings(&b, &a, at)); /* to the left of the way first */
    assert_at(105, 38, at[0]);
    assert_at(105, 62, at[1]);
    const struct mh_circle tangent = circle(100, 80, 17), apart = circle(100, 81, 17), inside = circle(101, 50, 11);
    TEST_ASSERT_TRUE(mh_crossings(&a, &tangent, at));
    assert_at(100, 63, at[0]);
    assert_at(100, 63, at[1]);
    TEST_ASSERT_FALSE(mh_crossings(&a, &apart, at));
    TEST_ASSERT_FALSE(mh_crossings(&a, &inside, at));
    TEST_ASSERT_FALSE(mh_crossings(&a, &a, at));
    assert_at(100, 63, at[0]); /* untouched */
}

/* Han's cases, computed with 64 bits */
static void known_answers(void)
{
    static const struct {
        struct {
            struct {
                float x, y;
            } centre;
            float radius;
        } circles[3];
        struct {
            float x, y;
        } cases, uniform, joint;
    } known[] = {
        /* a: one pair tangent, b: all, c: two pairs cross, d: three, e: one, f: none, and on one line */
        {{{{0, 0}, 10}, {{20, 0}, 10}, {{10, 12}, 10}}, {10, 1.81903143f}, {10, 1.81903143f}, {10, 1.81903143f}},
        {{{{0, 0}, 10}, {{20, 0}, 10}, {{10, 17.3205081f}, 10}},
         {10, 5.77350269f},
         {10, 5.77350269f},
         {10, 5.77350269f}},
        {{{{0, 0}, 12}, {{30, 0}, 12}, {{15, 4}, 10}}, {15, -5.10315091f}, {15, -3.13088861f}, {15, -5.10315091f}},
        {{{{0, 0}, 10}, {{15, 0}, 10}, {{8, 12}, 10}},
         {7.48329775f, 3.63442566f},
         {7.48329775f, 3.63442566f},
         {7.48329775f, 3.63442566f}},
        {{{{0, 0}, 10}, {{15, 0}, 10}, {{8, 40}, 10}},
         {7.67512586f, 18.3077498f},
         {7.68256884f, 17.1565238f},
         {7.67512586f, 18.3077498f}},
        {{{{0, 0}, 10}, {{60, 0}, 12}, {{30, 50}, 8}},
         {28.8332932f, 18.0200722f},
         {29.2676094f, 17.7997929f},
         {28.8332932f, 18.0200722f}},
        {{{{0, 0}, 10}, {{50, 0}, 10}, {{100, 0}, 10}}, {50, 0}, {50, 0}, {50, 0}},
        /* nested pair; two in one; concentric; two concentric; crossing on a line */
        {{{{0, 0}, 20}, {{2, 0}, 5}, {{30, 0}, 12}},
         {13.0206988f, -3.42502171f},
         {13.3794910f, -0.306403407f},
         {13.0206988f, -3.42502171f}},
        {{{{0, 0}, 30}, {{2, 1}, 8}, {{-3, 2}, 5}},
         {-8.05691666f, 17.0587408f},
         {-3.15513915f, 8.53433430f},
         {-8.05691666f, 17.0587408f}},
        {{{{5, 5}, 3}, {{5, 5}, 6}, {{5, 5}, 9}}, {5, 5}, {5, 5}, {5, 5}},
        {{{{0, 0}, 10}, {{0, 0}, 14}, {{30, 0}, 20}}, {10.8f, 3.91918359f}, {8, 2.44948974f}, {10.8f, 3.91918359f}},
        {{{{0, 0}, 12}, {{10, 0}, 12}, {{20, 0}, 12}}, {10, 7.13472553f}, {10, 7.13472553f}, {10, -9.06245368f}},
    };
    for (unsigned i = 0; i < sizeof known / sizeof known[0]; i++) {
        struct mh_circle c[3];
        for (int k = 0; k < 3; k++) {
            c[k] = circle(known[i].circles[k].centre.x, known[i].circles[k].centre.y, known[i].circles[k].radius);
        }
        assert_at(known[i].cases.x, known[i].cases.y, mh_three_circles(c, MH_CIRCLES_CASES));
        assert_at(known[i].uniform.x, known[i].uniform.y, mh_three_circles(c, MH_CIRCLES_UNIFORM));
        assert_at(known[i].joint.x, known[i].joint.y, mh_three_circles(c, MH_CIRCLES_JOINT));
    }
}

/* Circles through one point, whatever their order: all variants find it. */
static void exact_distances_give_the_place(void)
{
    const struct mh_circle c[] = {circle(503, 204, 5), circle(508, 185, 17), circle(485, 208, 17), circle(509, 188, 15),
                                  circle(500, 160, 40)};
    for (unsigned i = 0; i < 3; i++) {
        const struct mh_circle three[] = {c[i], c[(i + 1) % 3], c[(i + 2) % 3]};
        for (int variant = MH_CIRCLES_CASES; variant <= MH_CIRCLES_JOINT; variant++) {
            const struct mh_vec2 p = mh_three_circles(three, (enum mh_circles_variant)variant);
            TEST_ASSERT_FLOAT_WITHIN(10 * TOLERANCE, 500, F(p.x));
            TEST_ASSERT_FLOAT_WITHIN(10 * TOLERANCE, 200, F(p.y));
        }
    }
    for (uint8_t count = 3; count <= 5; count++) {
        const struct mh_vec2 p = mh_median_of_triples(c, count);
        TEST_ASSERT_FLOAT_WITHIN(10 * TOLERANCE, 500, F(p.x));
        TEST_ASSERT_FLOAT_WITHIN(10 * TOLERANCE, 200, F(p.y));
    }
}

/* The median of the four triples' points one by one, and of five circles that of ten. */
static void median_is_that_of_the_triples(void)
{
    const struct mh_circle c[] = {circle(0, 0, 9), circle(24, 3, 18), circle(-6, 20, 21), circle(15, -25, 27),
                                  circle(-30, -8, 36)};
    for (uint8_t count = 4; count <= 5; count++) {
        mh_real x[10], y[10];
        uint8_t triples = 0;
        for (uint8_t i = 0; i < count; i++) {
            for (uint8_t j = (uint8_t)(i + 1); j < count; j++) {
                for (uint8_t k = (uint8_t)(j + 1); k < count; k++) {
                    const struct mh_circle three[] = {c[i], c[j], c[k]};
                    const struct mh_vec2 p = mh_three_circles(three, MH_CIRCLES_UNIFORM);
                    x[triples] = p.x;
                    y[triples++] = p.y;
                }
            }
        }
        TEST_ASSERT_EQUAL_UINT8(count == 4 ? 4 : 10, triples);
        const struct mh_vec2 p = mh_median_of_triples(c, count);
        uint8_t left = 0, below = 0;
        for (uint8_t i = 0; i < triples; i++) {
            left = (uint8_t)(left + (x[i] < p.x));
            below = (uint8_t)(below + (y[i] < p.y));
        }
        TEST_ASSERT_EQUAL_UINT8(triples / 2, left);
        TEST_ASSERT_EQUAL_UINT8(triples / 2, below);
    }
}

static struct mh_random numbers;

static float up_to(float limit) { return limit * F(mh_random_unit(&numbers)); }

enum { RANDOM, COLLINEAR, NEARLY_COLLINEAR, COINCIDENT, CONCENTRIC, NESTED, IN_INTERVALS, ALIKE, KINDS };

static void make(int kind, struct mh_circle c[3])
{
    for (int i = 0; i < 3; i++) {
        c[i] = circle(up_to(80), up_to(80), up_to(40));
    }
    const float share = up_to(1);
    const float near = kind == NEARLY_COLLINEAR ? F(mh_exp(R(up_to(12) - 12.0f))) : 0;
    switch (kind) {
    case COLLINEAR:
    case NEARLY_COLLINEAR:
        c[2].centre.x = c[0].centre.x + R(share * F(c[1].centre.x - c[0].centre.x) + near);
        c[2].centre.y = c[0].centre.y + R(share * F(c[1].centre.y - c[0].centre.y) - near);
        break;
    case COINCIDENT:
        c[1].centre = c[0].centre;
        break;
    case CONCENTRIC:
        c[2].centre = c[1].centre = c[0].centre;
        break;
    case NESTED:
        c[0].radius = R(40);
        c[1].centre.x = c[0].centre.x + R(up_to(10));
        c[1].radius = R(up_to(20));
        c[2].centre.y = c[1].centre.y + R(up_to(5));
        c[2].radius = R(up_to(5));
        break;
    case IN_INTERVALS: /* a grid of nodes and a coarse table: circles touch, go through centres, are alike */
    case ALIKE:
        for (int i = 0; i < 3; i++) {
            c[i].centre.x = R(10.0f * (float)(int)up_to(8));
            c[i].centre.y = R(10.0f * (float)(int)up_to(8));
            c[i].radius = R(kind == ALIKE ? 20.0f : 5.0f + 10.0f * (float)(int)up_to(4));
        }
        break;
    default:
        break;
    }
}

static void any_triple_gives_a_point_near_its_circles(void)
{
    mh_random_init(&numbers, 1);
    for (long i = 0; i < TRIPLES; i++) {
        struct mh_circle c[3];
        make((int)(i % KINDS), c);
        for (int variant = MH_CIRCLES_CASES; variant <= MH_CIRCLES_JOINT; variant++) {
            const struct mh_vec2 p = mh_three_circles(c, (enum mh_circles_variant)variant);
            for (int k = 0; k < 3; k++) {
                const mh_real off = mh_abs(mh_vec2_length(mh_vec2_between(p, c[k].centre)) - c[k].radius);
                TEST_ASSERT_TRUE(off <= R(FARTHEST)); /* false for NaN */
            }
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(point_of_two_circles);
    RUN_TEST(crossings_lie_on_both_circles);
    RUN_TEST(known_answers);
    RUN_TEST(exact_distances_give_the_place);
    RUN_TEST(median_is_that_of_the_triples);
    RUN_TEST(any_triple_gives_a_point_near_its_circles);
    port_exit(UNITY_END() > 0);
    return 0;
}
