#include "motehound/plume_search.h"

#include <stddef.h>

#define NEWTON_STEPS 3
#define CLIP_SIGMAS 3.0f

struct cell {
    int column, row;
    mh_real x[3]; /* x, y and ln q */
    mh_real cost;
};

/* The cells are counted so that they are about square. */
struct grid {
    int columns, rows;
    mh_real width, height; /* of a cell */
};

static struct grid grid_over(const struct mh_plume_problem *problem)
{
    const mh_real width = problem->high.x - problem->low.x;
    const mh_real height = problem->high.y - problem->low.y;
    const mh_real columns = mh_sqrt((mh_real)MH_GAS_CELLS * width / height);
    struct grid grid = {.columns = (int)mh_clamp(columns + 0.5f, 1.0f, (mh_real)MH_GAS_CELLS)};
    grid.rows = MH_GAS_CELLS / grid.columns;
    grid.width = width / (mh_real)grid.columns;
    grid.height = height / (mh_real)grid.rows;
    return grid;
}

/* The best rate and the cost at the cell's place. False if it is not finite. */
static bool profile(const struct mh_plume_problem *problem, mh_real *gains, struct cell *cell)
{
    const struct mh_vec2 source = {cell->x[0], cell->x[1]};
    mh_real gz = 0, gg = 0;
    for (uint16_t k = 0; k < problem->count; k++) {
        if (mh_plume_model(problem->plume, problem->places[k], source, 0, &gains[k], NULL) != MH_OK) {
            return false;
        }
        gains[k] *= problem->scale;
        gz += problem->weight[k] * gains[k] * problem->z[k];
        gg += problem->weight[k] * gains[k] * gains[k];
    }
    const mh_real expected = problem->prior[2], variance = problem->variance[2];
    const mh_real reach = CLIP_SIGMAS * mh_sqrt(variance);
    const mh_real free = gz > 0 && gg > 0 ? mh_log(gz / gg) : expected - reach;
    mh_real log_rate = mh_clamp(free, expected - reach, expected + reach);
    for (int i = 0; i < NEWTON_STEPS; i++) {
        const mh_real rate = mh_exp(log_rate);
        const mh_real slope = rate * (rate * gg - gz) + (log_rate - expected) / variance;
        const mh_real bend = rate * rate * gg + 1.0f / variance;
        log_rate = mh_clamp(log_rate - slope / bend, expected - 2.0f * reach, expected + 2.0f * reach);
    }
    const mh_real rate = mh_exp(log_rate);
    /* by residuals: the sums would cancel where the samples are thousands of standard deviations */
    mh_real cost = mh_squared(log_rate - expected) / variance +
                   mh_squared(source.x - problem->prior[0]) / problem->variance[0] +
                   mh_squared(source.y - problem->prior[1]) / problem->variance[1];
    for (uint16_t k = 0; k < problem->count; k++) {
        cost += problem->weight[k] * mh_squared(problem->z[k] - rate * gains[k]);
    }
    cell->x[2] = log_rate;
    cell->cost = cost;
    return mh_finite(cost);
}

static int apart(const struct cell *a, const struct cell *b)
{
    const int columns = a->column > b->column ? a->column - b->column : b->column - a->column;
    const int rows = a->row > b->row ? a->row - b->row : b->row - a->row;
    return columns > rows ? columns : rows;
}

/* Keep the best cells that are apart from each other, the best first. */
static int keep(struct cell *best, int count, const struct cell *cell)
{
    struct cell kept[MH_PLUME_STARTS];
    int n = 0;
    bool placed = false;
    for (int i = 0; i <= count; i++) {
        if (!placed && (i == count || cell->cost < best[i].cost)) {
            if (n < MH_PLUME_STARTS) {
                kept[n++] = *cell;
            }
            placed = true;
        }
        if (i < count) {
            if (apart(&best[i], cell) <= MH_PLUME_APART) {
                if (!placed) {
                    return count; /* a better one is near */
                }
                continue;
            }
            if (n < MH_PLUME_STARTS) {
                kept[n++] = best[i];
            }
        }
    }
    for (int i = 0; i < n; i++) {
        best[i] = kept[i];
    }
    return n;
}

/* Moments, in which the best place so far has weight 1. */
struct moments {
    mh_real least, weight;
    mh_real sum[3], square[3];
};

static void add(struct moments *moments, const struct cell *cell)
{
    if (cell->cost < moments->least) {
        const mh_real shrink = mh_exp(0.5f * (cell->cost - moments->least));
        moments->least = cell->cost;
        moments->weight *= shrink;
        for (int i = 0; i < 3; i++) {
            moments->sum[i] *= shrink;
            moments->square[i] *= shrink;
        }
    }
    const mh_real weight = mh_exp(0.5f * (moments->least - cell->cost));
    moments->weight += weight;
    for (int i = 0; i < 3; i++) {
        moments->sum[i] += weight * cell->x[i];
        moments->square[i] += weight * cell->x[i] * cell->x[i];
    }
}

enum mh_status mh_plume_search(const struct mh_plume_problem *problem, mh_real *gains, struct mh_plume_search *search)
{
    const struct grid grid = grid_over(problem);
    struct cell best[MH_PLUME_STARTS];
    int starts = 0;
    struct moments moments = {.weight = 0};
    struct cell cell;
    for (cell.row = 0; cell.row < grid.rows; cell.row++) {
        for (cell.column = 0; cell.column < grid.columns; cell.column++) {
            cell.x[0] = problem->low.x + ((mh_real)cell.column + 0.5f) * grid.width;
            cell.x[1] = problem->low.y + ((mh_real)cell.row + 0.5f) * grid.height;
            if (!profile(problem, gains, &cell)) {
                continue;
            }
            if (starts == 0) {
                moments.least = cell.cost;
            }
            add(&moments, &cell);
            starts = keep(best, starts, &cell);
        }
    }
    if (starts == 0) {
        return MH_ERR_NOT_FINITE;
    }
    search->starts = (uint8_t)starts;
    for (int i = 0; i < starts; i++) {
        search->cost[i] = best[i].cost;
        for (int j = 0; j < 3; j++) {
            search->start[i][j] = best[i].x[j];
        }
    }
    for (int i = 0; i < 3; i++) {
        const mh_real mean = moments.sum[i] / moments.weight;
        search->mean[i] = mean;
        search->variance[i] = mh_max(moments.square[i] / moments.weight - mean * mean, 0);
    }
    return MH_OK;
}
