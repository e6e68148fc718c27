#include "motehound/least_squares.h"

#if MH_REAL_FIXED

#define LARGEST ((mh_real)1 << 29)

static uint32_t high_word(uint32_t a, uint32_t b) { return (uint32_t)(((uint64_t)a * b) >> 32); }

/* Cosine and sine of the turn that brings (a, b) onto the axis of a; false if both are 0. A factor common to both would only weigh the equation, so the inverse
 * root, by Newton's method, may end at 6e-8. */
static bool turn(mh_real a, mh_real b, mh_share *c, mh_share *s)
{
    uint32_t over_a = (uint32_t)mh_abs(a), over_b = (uint32_t)mh_abs(b);
    if ((over_a | over_b) == 0) {
        return false;
    }
    while (((over_a | over_b) & (uint32_t)1 << 30) == 0) {
        over_a <<= 1;
        over_b <<= 1;
    }
    uint32_t square = (uint32_t)(((uint64_t)over_a * over_a + (uint64_t)over_b * over_b) >> 32);
    const uint8_t doubled = square < (uint32_t)1 << 29;
    square <<= 2 * doubled;                                       /* 1/2 to 2, with 30 fractional bits */
    uint32_t root = 3238615640u - high_word(square, 3701275022u); /* its inverse, within 9 %, with 31 */
    for (uint8_t i = 0; i < 3; i++) {
        root = high_word(root, ((uint32_t)3 << 28) - high_word(square, high_word(root, root))) << 3;
    }
    const mh_share cosine = (mh_share)(high_word(over_a, root) << doubled);
    const mh_share sine = (mh_share)(high_word(over_b, root) << doubled);
    *c = a < 0 ? -cosine : cosine;
    *s = b < 0 ? -sine : sine;
    return true;
}

static mh_real length(mh_real a, mh_real b)
{
    mh_share c, s;
    return turn(a, b, &c, &s) ? mh_turned(c, a, s, b) : 0;
}

static mh_real half(mh_real a) { return (a + 1) >> 1; }

/* The row at the scale of the factor, with room in both for the turns. */
static void bring_to_scale(struct mh_least_squares *problem, mh_real *row)
{
    const uint8_t n = problem->unknowns;
    mh_real entry = 0, held = problem->residual;
    for (uint8_t j = 0; j <= n; j++) {
        entry = mh_max(entry, mh_abs(row[j]));
        for (uint8_t i = 0; i < n; i++) {
            held = mh_max(held, mh_abs(problem->r[i][j]));
        }
    }
    int8_t scale = problem->scale;
    for (; held > LARGEST || (scale < 0 ? entry >> -scale : entry) > (scale < 0 ? LARGEST : LARGEST >> scale);
         scale--) {
        held = half(held);
        problem->residual = half(problem->residual);
        for (uint8_t i = 0; i < n; i++) {
            for (uint8_t j = i; j <= n; j++) {
                problem->r[i][j] = half(problem->r[i][j]);
            }
        }
    }
    problem->scale = scale;
    for (uint8_t j = 0; j <= n; j++) {
        row[j] = scale < 0 ? row[j] / ((mh_real)1 << -scale) : row[j] * ((mh_real)1 << scale);
    }
}

#else

/* hypot without overflow or underflow of the squares. */
static mh_real length(mh_real a, mh_real b)
{
    const mh_real large = mh_max(mh_abs(a), mh_abs(b));
    const mh_real small = mh_min(mh_abs(a), mh_abs(b));
    if (large == 0) {
        return 0;
    }
    const mh_real ratio = small / large;
    return large * mh_sqrt(1 + ratio * ratio);
}

/* Cosine and sine of the turn that brings (a, b) onto the axis of a; false if both are 0. */
static bool turn(mh_real a, mh_real b, mh_share *c, mh_share *s)
{
    const mh_real diagonal = length(a, b);
    if (diagonal == 0) {
        return false;
    }
    *c = a / diagonal;
    *s = b / diagonal;
    return true;
}

#endif

void mh_least_squares_begin(struct mh_least_squares *problem, uint8_t unknowns)
{
    const struct mh_least_squares empty = {
        .unknowns = unknowns,
#if MH_REAL_FIXED
        .scale = MH_LEAST_SQUARES_GUARD_BITS,
#endif
    };
    *problem = empty;
}

enum mh_status mh_least_squares_add(struct mh_least_squares *problem, const mh_real *row, mh_real b)
{
    const uint8_t n = problem->unknowns;
    mh_real rest[MH_LEAST_SQUARES_UNKNOWNS + 1];
    for (uint8_t i = 0; i <= n; i++) {
        rest[i] = i < n ? row[i] : b;
        if (!mh_finite(rest[i])) {
            return MH_ERR_NOT_FINITE;
        }
        if (mh_abs(rest[i]) > MH_LEAST_SQUARES_ENTRY_MAX) {
            return MH_ERR_RANGE;
        }
    }
#if MH_REAL_FIXED
    bring_to_scale(problem, rest);
#endif
    for (uint8_t i = 0; i < n; i++) {
        mh_share c, s;
        if (!turn(problem->r[i][i], rest[i], &c, &s)) {
            continue;
        }
        for (uint8_t j = i; j <= n; j++) {
            const mh_real kept = problem->r[i][j];
            problem->r[i][j] = mh_turned(c, kept, s, rest[j]);
            rest[j] = mh_turned(c, rest[j], -s, kept);
        }
    }
    problem->residual = length(problem->residual, rest[n]);
    if (problem->rows < UINT16_MAX) {
        problem->rows++;
    }
    return MH_OK;
}

/* The diagonal of column k is the length of its part that the columns before it cannot make up. */
static bool dependent(const struct mh_least_squares *problem, uint8_t k)
{
    mh_real column = 0;
    for (uint8_t i = 0; i <= k; i++) {
        column = length(column, problem->r[i][k]);
    }
    return mh_abs(problem->r[k][k]) <= mh_mul(MH_LEAST_SQUARES_RANK, column);
}

enum mh_status mh_least_squares_solve(const struct mh_least_squares *problem, mh_real low, mh_real high, mh_real *z,
                                      enum mh_bound *bound)
{
    const uint8_t n = problem->unknowns;
    const uint8_t last = (uint8_t)(n - 1);
    if (!(low <= high)) {
        return MH_ERR_ARGUMENT;
    }
    if (problem->rows < n) {
        return MH_ERR_TOO_FEW;
    }
    for (uint8_t k = 0; k < last; k++) {
        if (dependent(problem, k)) {
            return MH_ERR_SINGULAR;
        }
    }
    enum mh_bound active = MH_BOUND_NONE;
    mh_real x = high;
    if (dependent(problem, last)) {
        active = MH_BOUND_HIGH;
    } else {
        x = mh_div(problem->r[last][n], problem->r[last][last]);
        active = x < low ? MH_BOUND_LOW : x > high ? MH_BOUND_HIGH : MH_BOUND_NONE;
        x = mh_clamp(x, low, high);
    }
    mh_real solution[MH_LEAST_SQUARES_UNKNOWNS];
    solution[last] = x;
    if (!mh_finite(x)) {
        return MH_ERR_SINGULAR;
    }
    for (uint8_t k = last; k-- > 0;) {
        mh_wide sum = mh_wide_mul(problem->r[k][n], MH_REAL(1.0f));
        for (uint8_t j = (uint8_t)(k + 1); j < n; j++) {
            sum -= mh_wide_mul(problem->r[k][j], solution[j]);
        }
        solution[k] = mh_wide_div(sum, problem->r[k][k]);
        if (!mh_finite(solution[k])) {
            return MH_ERR_SINGULAR;
        }
    }
    for (uint8_t k = 0; k < n; k++) {
        z[k] = solution[k];
    }
    *bound = active;
    return MH_OK;
}
