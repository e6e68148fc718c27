/* Estimators in fixed point under any numbers: whatever comes in, they answer with numbers or refuse, and what they refuse leaves them as they were.
 *
 * The first byte chooses the estimator. A number is its size, a shift, and as many bytes as are left of four. */
#include "fuzz.h"
#include "motehound/fusion.h"
#include "motehound/kalman.h"
#include "motehound/least_squares.h"
#include "motehound/sage_husa.h"
#include "motehound/sound_fix.h"

enum { STEPS_MAX = 40, STATES = 4, ESTIMATES = 4 };

/* Any real, infinite ones too. */
static mh_real number(struct input *input)
{
    const uint8_t shift = byte(input) % 32, count = (uint8_t)((31 - shift) / 8 + 1);
    uint32_t bits = 0;
    for (uint8_t i = 0; i < count; i++) {
        bits = bits << 8 | byte(input);
    }
    const uint32_t size = bits & (UINT32_MAX >> 1 >> shift);
    return bits >> 31 || byte(input) & 1 ? -(mh_real)size : (mh_real)size;
}

static void numbers(struct input *input, mh_real *list, int count)
{
    for (int i = 0; i < count; i++) {
        list[i] = number(input);
    }
}

/* A covariance more often than not: any variances, any correlation. */
static void covariance(struct input *input, mh_real *P)
{
    const uint8_t wild = byte(input) & 15;
    for (int i = 0; i < STATES; i++) {
        P[MH_PACKED(i, i)] = mh_abs(number(input));
        for (int j = 0; j < i; j++) {
            const mh_real limit = mh_sqrt(mh_min(P[MH_PACKED(j, j)], P[MH_PACKED(i, i)])) / 4;
            P[MH_PACKED(j, i)] = wild == 0 ? number(input) : mh_mul(limit, (mh_real)((byte(input) - 128) * 256));
        }
    }
}

static void check(const mh_real *x, const mh_real *P, int n)
{
    for (int i = 0; i < n; i++) {
        require(mh_finite(x[i]) && mh_finite(P[MH_PACKED(i, i)]) && P[MH_PACKED(i, i)] > 0);
        for (int j = 0; j < i; j++) {
            const double c = P[MH_PACKED(j, i)], a = P[MH_PACKED(i, i)] + 1.0, b = P[MH_PACKED(j, j)] + 1.0;
            require(c * c <= a * b * 1.00001);
        }
    }
}

static void kalman(struct input *input)
{
    struct mh_kalman filter;
    mh_real x[STATES], P[MH_PACKED_SIZE(STATES)], F[STATES * STATES], Q[MH_PACKED_SIZE(STATES)];
    struct mh_gate gate = {.sigmas = MH_REAL(3.0f), .patience = 3};
    numbers(input, x, STATES);
    covariance(input, P);
    memset(&filter, 0, sizeof filter);
    if (mh_kalman_init(&filter, STATES, x, P) != MH_OK) {
        return;
    }
    for (int i = 0; i < STEPS_MAX && input->left > 0; i++) {
        const uint8_t what = byte(input);
        const struct mh_kalman before = filter;
        enum mh_status status;
        if (what & 1) {
            covariance(input, Q);
            numbers(input, F, STATES * STATES);
            if (what & 2) { /* constant velocity */
                for (int k = 0; k < STATES * STATES; k++) {
                    F[k] = k % (STATES + 1) == 0 ? MH_REAL(1.0f) : k == 1 || k == 11 ? F[k] : 0;
                }
            }
            status = mh_kalman_predict(&filter, F, Q);
        } else {
            numbers(input, x, STATES);
            const mh_real innovation = number(input), variance = number(input);
            status = mh_kalman_update(&filter, x, innovation, variance, what & 2 ? &gate : NULL);
        }
        require(status == MH_OK || memcmp(&before, &filter, sizeof filter) == 0);
        mh_kalman_covariance(&filter, P);
        for (int k = 0; k < STATES; k++) {
            require(mh_finite(filter.x[k]) && P[MH_PACKED(k, k)] >= 0 && filter.ud[MH_PACKED(k, k)] > 0);
        }
    }
}

static void fusion(struct input *input)
{
    struct mh_gaussian estimates[ESTIMATES], fused;
    mh_real w[ESTIMATES];
    const uint8_t what = byte(input), count = (uint8_t)(1 + what % ESTIMATES);
    memset(estimates, 0, sizeof estimates);
    for (uint8_t i = 0; i < count; i++) {
        estimates[i].n = STATES;
        numbers(input, estimates[i].x, STATES);
        covariance(input, estimates[i].P);
    }
    if (what & 64) {
        numbers(input, w, count);
    } else if (mh_fusion_weights(estimates, count, w) != MH_OK) {
        return;
    }
    const enum mh_status status =
        what & 128 ? mh_fusion_naive(estimates, count, &fused) : mh_fusion_intersect(estimates, count, w, &fused);
    if (status == MH_OK) {
        check(fused.x, fused.P, STATES);
        require(mh_gaussian_check(&fused) == MH_OK);
    }
}

static void squares(struct input *input)
{
    struct mh_least_squares problem;
    mh_real row[3], z[3];
    enum mh_bound bound;
    mh_least_squares_begin(&problem, 3);
    for (int i = 0; i < STEPS_MAX && input->left > 0; i++) {
        numbers(input, row, 3);
        (void)mh_least_squares_add(&problem, row, number(input));
        const mh_real low = number(input), high = number(input);
        if (mh_least_squares_solve(&problem, low, high, z, &bound) == MH_OK) {
            require(mh_finite(z[0]) && mh_finite(z[1]) && z[2] >= low && z[2] <= high);
        }
    }
}

static void sage_husa(struct input *input)
{
    struct mh_sage_husa_config config;
    struct mh_sage_husa filter;
    mh_sage_husa_config_default(&config);
    config.process_variance = number(input);
    config.measurement_variance = number(input);
    config.estimate_variance = number(input);
    config.process_floor = number(input);
    if (mh_sage_husa_init(&filter, &config, number(input)) != MH_OK) {
        return;
    }
    for (uint32_t i = 1; i < STEPS_MAX && input->left > 0; i++) {
        const struct mh_sage_husa before = filter;
        const mh_share weight = mh_sage_husa_weight(MH_REAL(0.97f), i);
        const mh_real measurement = number(input), u = number(input);
        const enum mh_status status = mh_sage_husa_step(&filter, &config, measurement, u, weight);
        require(status == MH_OK || memcmp(&before, &filter, sizeof filter) == 0);
        require(mh_finite(filter.estimate) && mh_finite(filter.process_mean) && mh_finite(filter.measurement_mean));
        require(filter.estimate_variance > 0 && filter.process_variance > 0 && filter.measurement_variance > 0);
    }
}

static void sound(struct input *input)
{
    struct mh_heard heard[5];
    const uint8_t what = byte(input);
    const size_t count = what % 6u;
    const struct mh_distance_table table = {mh_abs(number(input)), byte(input), what % 4};
    struct mh_vec2 position = {0, 0};
    for (size_t i = 0; i < count; i++) {
        heard[i].place.x = number(input);
        heard[i].place.y = number(input);
        heard[i].energy = number(input);
        if (!mh_finite(heard[i].energy)) {
            return;
        }
    }
    const enum mh_status status =
        what & 64 ? mh_median_fix(heard, count, &table, &position)
                  : mh_distance_fix(heard, count, &table, (enum mh_circles_variant)(what / 8 % 3), &position);
    require(status != MH_OK || mh_vec2_finite(position));
}

/* Not infinite: least of all from the wire. */
static void scalar(struct input *input)
{
    const mh_real a = number(input), b = number(input);
    const int64_t rounding = (int64_t)mh_real_from_ieee(mh_real_to_ieee(a)) - a;
    require(rounding >= -64 && rounding <= 64); /* 24 significant bits of 31 */
    const uint32_t bits = (uint32_t)a ^ (uint32_t)b << 16;
    const mh_real c = mh_real_from_ieee(bits);
    require(c >= -MH_REAL_INFINITE && (mh_finite(c) || (bits & 0x7FFFFFFFu) >= 0x46FFFFFFu));
    (void)mh_mul(a, b);
    (void)mh_div(a, b);
    (void)mh_add(a, b);
    (void)mh_exp(a);
    (void)mh_log(a);
    (void)mh_atan2(a, b);
    (void)mh_real_round(a);
    require(a < 0 ? !mh_finite(mh_sqrt(a)) : mh_sqrt(a) >= 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static void (*const estimators[])(struct input *) = {kalman, fusion, squares, sage_husa, sound, scalar};
    struct input input = {data, size};
    estimators[byte(&input) % (sizeof estimators / sizeof estimators[0])](&input);
    return 0;
}
