/* The Kalman filter in fixed point beside the textbook's in floating point, with the same numbers. */
#include "motehound/kalman.h"
#include "port.h"
#include "unity.h"

#include <math.h>
#include <string.h>

void setUp(void) {}
void tearDown(void) {}

#define ONE MH_REAL(1.0f)

#if UINTPTR_MAX > 0xFFFFFFFF
typedef double wide_float;
enum { STEPS = 300, MANY_STEPS = 25000 };
#else
typedef float wide_float; /* what the boards can afford; its own rounding is in the bounds, too */
enum { STEPS = 40, MANY_STEPS = 100 };
#endif

static uint32_t seed;

/* uniform in -1 to 1 */
static float draw(void)
{
    seed = seed * 1664525u + 1013904223u;
    return (float)(int32_t)(seed >> 8) * (2.0f / 16777216.0f) - 1.0f;
}

/* The textbook's, Joseph's form. */
struct reference {
    wide_float x[4], P[4][4];
};

static wide_float value(mh_real a) { return (wide_float)a / 65536; }

static void reference_predict(struct reference *r, const mh_real *F, const mh_real *Q)
{
    wide_float x[4], FP[4][4];
    for (int i = 0; i < 4; i++) {
        x[i] = 0;
        for (int k = 0; k < 4; k++) {
            x[i] += value(F[4 * i + k]) * r->x[k];
            FP[i][k] = 0;
            for (int m = 0; m < 4; m++) {
                FP[i][k] += value(F[4 * i + m]) * r->P[m][k];
            }
        }
    }
    for (int i = 0; i < 4; i++) {
        r->x[i] = x[i];
        for (int j = 0; j < 4; j++) {
            r->P[i][j] = value(Q[mh_packed_index(i, j)]);
            for (int k = 0; k < 4; k++) {
                r->P[i][j] += FP[i][k] * value(F[4 * j + k]);
            }
        }
    }
}

static void reference_update(struct reference *r, const mh_real *h, wide_float innovation, mh_real variance)
{
    wide_float K[4], A[4][4], AP[4][4], s = value(variance);
    for (int i = 0; i < 4; i++) {
        K[i] = 0;
        for (int k = 0; k < 4; k++) {
            K[i] += r->P[i][k] * value(h[k]);
        }
        s += K[i] * value(h[i]);
    }
    for (int i = 0; i < 4; i++) {
        K[i] /= s;
        r->x[i] += K[i] * innovation;
        for (int k = 0; k < 4; k++) {
            A[i][k] = (wide_float)(i == k) - K[i] * value(h[k]);
        }
    }
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            AP[i][j] = 0;
            for (int k = 0; k < 4; k++) {
                AP[i][j] += A[i][k] * r->P[k][j];
            }
        }
    }
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            r->P[i][j] = K[i] * K[j] * value(variance);
            for (int k = 0; k < 4; k++) {
                r->P[i][j] += AP[i][k] * A[j][k];
            }
        }
    }
}

struct scene {
    float position_sd, speed_sd, noise_sd, intensity, dt;
    int every;  /* measures in one step of so many */
    bool dense; /* all states by random weights; or x and y */
};

static struct mh_kalman filter;
static struct reference reference;

static void begin(const struct scene *scene)
{
    const mh_real x[4] = {0}, p = mh_real_from_float(scene->position_sd * scene->position_sd),
                  v = mh_real_from_float(scene->speed_sd * scene->speed_sd);
    const mh_real P[10] = {p, 0, p, 0, 0, v, 0, 0, 0, v};
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_init(&filter, 4, x, P));
    memset(&reference, 0, sizeof reference);
    for (int i = 0; i < 4; i++) {
        reference.P[i][i] = value(i < 2 ? p : v);
    }
}

/* One step of both with innovations as large as they ought to be. */
static void step(const struct scene *scene, const mh_real *F, const mh_real *Q, int n)
{
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_predict(&filter, F, Q));
    reference_predict(&reference, F, Q);
    for (int m = 0; m < 2 && n % scene->every == 0; m++) {
        mh_real h[4] = {0};
        h[m] = ONE;
        wide_float offset = 0;
        for (int k = 0; k < 4; k++) {
            h[k] = scene->dense ? mh_real_from_float(draw()) : h[k];
            offset += value(h[k]) * (value(filter.x[k]) - reference.x[k]);
        }
        const mh_real innovation = mh_real_from_float(scene->noise_sd * draw());
        const mh_real variance = mh_real_from_float(scene->noise_sd * scene->noise_sd);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_update(&filter, h, innovation, variance, NULL));
        reference_update(&reference, h, value(innovation) + offset, variance);
    }
}

/* Within 0.5 % of a standard deviation, and variances within 0.5 % and what their rounding to a real takes. */
static void as_the_textbook(void)
{
    static const struct scene scenes[] = {
        {1, 1, 0.1f, 0.04f, 0.1f, 1, false},   {10, 5, 1, 0.1f, 1, 1, false},         {100, 10, 1, 1, 1, 1, false},
        {100, 10, 0.1f, 0.1f, 1, 1, false},    {10, 5, 1, 0.01f, 1, 20, false},       {10, 5, 1, 0.1f, 1, 1, true},
        {1, 0.1f, 0.05f, 0.001f, 1, 1, false}, {0.1f, 0.1f, 100, 0.001f, 1, 1, false}};
    for (uint8_t i = 0; i < sizeof scenes / sizeof scenes[0]; i++) {
        mh_real F[16], Q[10];
        seed = i;
        begin(&scenes[i]);
        mh_kalman_constant_velocity(mh_real_from_float(scenes[i].dt), mh_real_from_float(scenes[i].intensity), F, Q);
        for (int n = 0; n < STEPS; n++) {
            step(&scenes[i], F, Q, n);
            for (uint8_t k = 0; k < 4; k++) {
                const float variance = (float)reference.P[k][k], sd = sqrtf(variance);
                TEST_ASSERT_FLOAT_WITHIN(0.005f * sd + 1e-5f, (float)reference.x[k], mh_real_to_float(filter.x[k]));
                TEST_ASSERT_FLOAT_WITHIN(0.005f * variance + 1e-5f, variance,
                                         mh_real_to_float(mh_kalman_variance(&filter, k)));
            }
        }
    }
}

/* Variances further apart than the format holds: the filter is more cautious than it could be, for a while, but never bolder. */
static void a_prior_too_wide_is_taken_with_caution(void)
{
    static const struct scene scene = {170, 170, 0.01f, 0.01f, 0.1f, 1, false};
    mh_real F[16], Q[10];
    seed = 9;
    begin(&scene);
    mh_kalman_constant_velocity(mh_real_from_float(scene.dt), mh_real_from_float(scene.intensity), F, Q);
    for (int n = 0; n < 40; n++) {
        step(&scene, F, Q, n);
        for (uint8_t k = 0; k < 4; k++) {
            const float variance = mh_real_to_float(mh_kalman_variance(&filter, k));
            TEST_ASSERT_TRUE(variance + 2e-5f > 0.98f * (float)reference.P[k][k]);
            TEST_ASSERT_FLOAT_WITHIN(3 * sqrtf(variance) + 1e-3f, (float)reference.x[k], mh_real_to_float(filter.x[k]));
        }
    }
    for (uint8_t k = 0; k < 4; k++) { /* by now it knows what there is to know */
        const float variance = mh_real_to_float(mh_kalman_variance(&filter, k)), expected = (float)reference.P[k][k];
        TEST_ASSERT_FLOAT_WITHIN(0.05f * expected + 2e-5f, expected, variance);
    }
}

static void assert_definite(void)
{
    mh_real largest = 0, smallest = MH_REAL_INFINITE;
    for (uint8_t i = 0; i < filter.n; i++) {
        largest = mh_max(largest, filter.ud[MH_PACKED(i, i)]);
        smallest = mh_min(smallest, filter.ud[MH_PACKED(i, i)]);
    }
    TEST_ASSERT_TRUE(smallest >= 64 && largest <= (mh_real)1 << 28);
}

/* With measurements at random in kind, size and quality, and none for a while; what is refused leaves no trace. */
static void stays_definite(void)
{
    mh_real F[16], Q[10];
    seed = 11;
    for (int run = 0; run < 4; run++) {
        const struct scene scene = {run & 1 ? 100 : 0.5f, 3, 1, run & 2 ? 1e-4f : 1, 0.5f, 1, false};
        begin(&scene);
        mh_kalman_constant_velocity(mh_real_from_float(scene.dt), mh_real_from_float(scene.intensity), F, Q);
        for (int n = 0; n < MANY_STEPS; n++) {
            struct mh_kalman before = filter;
            if (mh_kalman_predict(&filter, F, Q) != MH_OK) {
                TEST_ASSERT_EQUAL_MEMORY(&before, &filter, sizeof filter);
            }
            assert_definite();
            const float size = draw(), quality = draw();
            const mh_real h[4] = {mh_real_from_float(10 * size * size * size), mh_real_from_float(draw()),
                                  mh_real_from_float(size * draw()), draw() > 0 ? ONE : 0};
            before = filter;
            if (n % 50 < 40 &&
                mh_kalman_update(&filter, h, mh_real_from_float(draw()),
                                 1 + mh_real_from_float(100 * quality * quality * quality * quality), NULL) != MH_OK) {
                TEST_ASSERT_EQUAL_MEMORY(&before, &filter, sizeof filter);
            }
            assert_definite();
            if (n % 1000 == 0) { /* a target that runs away is not what is meant here */
                memset(filter.x, 0, sizeof filter.x);
            }
        }
    }
}

static void what_is_out_of_format_is_refused(void)
{
    const mh_real x[2] = {0}, too_far_apart[3] = {MH_REAL(1000.0f), 0, MH_REAL(0.0001f)}, P[3] = {ONE, 0, ONE};
    const mh_real away[2] = {MH_REAL(32767.0f), MH_REAL(32767.0f)}, F[4] = {ONE, ONE, 0, ONE}, Q[3] = {0},
                  h[2] = {ONE, 0};
    memset(&filter, 0, sizeof filter);
    struct mh_kalman before = filter;
    TEST_ASSERT_EQUAL_INT(MH_ERR_RANGE, mh_kalman_init(&filter, 2, x, too_far_apart));
    TEST_ASSERT_EQUAL_MEMORY(&before, &filter, sizeof filter);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_kalman_init(&filter, 2, away, P));
    before = filter;
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_kalman_predict(&filter, F, Q));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_kalman_update(&filter, h, MH_REAL(30000.0f), ONE, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&before, &filter, sizeof filter);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(as_the_textbook);
    RUN_TEST(a_prior_too_wide_is_taken_with_caution);
    RUN_TEST(stays_definite);
    RUN_TEST(what_is_out_of_format_is_refused);
    port_exit(UNITY_END() > 0);
    return 0;
}
