#include "motehound/least_squares.h"

void mh_least_squares_begin(struct mh_least_squares *problem, uint8_t unknowns)
{
    const struct mh_least_squares empty = {.unknowns = unknowns};
    *problem = empty;
}

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
    for (uint8_t i = 0; i < n; i++) {
        const mh_real diagonal = length(problem->r[i][i], rest[i]);
        if (diagonal == 0) {
            continue;
        }
        const mh_real c = problem->r[i][i] / diagonal;
        const mh_real s = rest[i] / diagonal;
        for (uint8_t j = i; j <= n; j++) {
            const mh_real kept = problem->r[i][j];
            problem->r[i][j] = c * kept + s * rest[j];
            rest[j] = c * rest[j] - s * kept;
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
    return mh_abs(problem->r[k][k]) <= MH_LEAST_SQUARES_RANK * column;
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
        x = problem->r[last][n] / problem->r[last][last];
        active = x < low ? MH_BOUND_LOW : x > high ? MH_BOUND_HIGH : MH_BOUND_NONE;
        x = mh_clamp(x, low, high);
    }
    mh_real solution[MH_LEAST_SQUARES_UNKNOWNS];
    solution[last] = x;
    if (!mh_finite(x)) {
        return MH_ERR_SINGULAR;
    }
    for (uint8_t k = last; k-- > 0;) {
        mh_real sum = problem->r[k][n];
        for (uint8_t j = (uint8_t)(k + 1); j < n; j++) {
            sum -= problem->r[k][j] * solution[j];
        }
        solution[k] = sum / problem->r[k][k];
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
