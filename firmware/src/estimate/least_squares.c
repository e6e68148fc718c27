#include "motehound/least_squares.h"

#if MH_REAL_FIXED
#define LARGEST MH_REAL(8192.0f) /* 2^29 */

static void shrink(struct mh_least_squares *problem)
{
    for (uint8_t i = 0; i < problem->unknowns; i++) {
        for (uint8_t j = i; j <= problem->unknowns; j++) {
            problem->r[i][j] /= 2;
        }
    }
    problem->scale--;
}

/* The row at the scale of the factor, with room in both for the turns. */
static void bring_to_scale(struct mh_least_squares *problem, mh_real *row)
{
    const uint8_t n = problem->unknowns;
    mh_real entry = mh_abs(row[n]), held = 0; /* all their bits: as long as the largest's */
    for (uint8_t i = 0; i < n; i++) {
        entry |= mh_abs(row[i]);
        for (uint8_t j = i; j <= n; j++) {
            held |= mh_abs(problem->r[i][j]);
        }
    }
    for (; held >= LARGEST; held >>= 1) {
        shrink(problem);
    }
    int8_t fits = 0; /* the scale at which the row has room */
    for (; entry >= LARGEST; entry >>= 1) {
        fits--;
    }
    for (; fits < problem->scale && entry < LARGEST / 2; entry += entry) {
        fits++;
    }
    while (problem->scale > fits) {
        shrink(problem);
    }
    int16_t times = 1, parts = 1;
    for (int8_t k = 0; k < problem->scale; k++) {
        times += times;
    }
    for (int8_t k = 0; k > problem->scale; k--) {
        parts += parts;
    }
    for (uint8_t j = 0; j <= n; j++) {
        row[j] = parts == 1 ? row[j] * times : row[j] / parts;
    }
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
        if (!mh_turn(problem->r[i][i], rest[i], &c, &s)) {
            continue;
        }
        mh_real *r = &problem->r[i][i];
        *r = mh_turned(c, *r, s, rest[i]); /* and what is left of the row there is 0 */
        for (uint8_t j = (uint8_t)(i + 1); j <= n; j++) {
            const mh_real kept = *++r;
            *r = mh_turned(c, kept, s, rest[j]);
            rest[j] = mh_turned(c, rest[j], -s, kept);
        }
    }
#if !MH_REAL_FIXED
    problem->left = rest[n];
#endif
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
        column = mh_hypot(column, problem->r[i][k]);
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
