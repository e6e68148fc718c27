#include "bounds/hindsight.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

/* longest[n]: how many samples from n on one and the same node senses the target. */
static void extend(const struct recorded_node *node, const struct point *path, size_t samples, double range_m,
                   size_t *longest)
{
    size_t stretch = 0;
    for (size_t n = samples; n-- > 0;) {
        const double x_m = path[n].x_m - node->x_m, y_m = path[n].y_m - node->y_m;
        stretch = x_m * x_m + y_m * y_m <= range_m * range_m ? stretch + 1 : 0;
        longest[n] = stretch > longest[n] ? stretch : longest[n];
    }
}

int hindsight_hand_overs(const struct recorded_node *nodes, size_t node_count, const struct point *path, size_t samples,
                         double range_m, size_t *hand_overs)
{
    size_t *longest = calloc(samples, sizeof *longest);
    if (longest == NULL && samples > 0) {
        return -1;
    }
    for (size_t i = 0; i < node_count; i++) {
        extend(&nodes[i], path, samples, range_m, longest);
    }
    size_t heads = 0;
    for (size_t n = 0; n<samples; n += longest[n]> 0 ? longest[n] : 1) {
        heads += longest[n] > 0 ? 1 : 0;
    }
    free(longest);
    *hand_overs = heads > 0 ? heads - 1 : 0;
    return 0;
}

/* Position and velocity, for a time in samples. */
struct motion {
    double x_m, y_m, vx, vy;
};

static double residual(const struct motion *motion, const struct point *path, size_t n)
{
    const double t = (double)n;
    return hypot(path[n].x_m - motion->x_m - motion->vx * t, path[n].y_m - motion->y_m - motion->vy * t);
}

/* The weighted least squares fit to path[0 .. samples); the weights add up to 1. */
static struct motion fit(const struct point *path, const double *weight, size_t samples)
{
    double t_mean = 0, x_mean = 0, y_mean = 0, tt = 0, tx = 0, ty = 0;
    for (size_t n = 0; n < samples; n++) {
        t_mean += weight[n] * (double)n;
        x_mean += weight[n] * path[n].x_m;
        y_mean += weight[n] * path[n].y_m;
    }
    for (size_t n = 0; n < samples; n++) {
        const double t = (double)n - t_mean;
        tt += weight[n] * t * t;
        tx += weight[n] * t * (path[n].x_m - x_mean);
        ty += weight[n] * t * (path[n].y_m - y_mean);
    }
    const double vx = tt > 0 ? tx / tt : 0, vy = tt > 0 ? ty / tt : 0;
    return (struct motion){x_mean - vx * t_mean, y_mean - vy * t_mean, vx, vy};
}

/* One motion follows path[0 .. samples) within the tolerance. Begins at `weight`, which is left near those of the minimax fit. */
static bool follows(const struct point *path, double *weight, size_t samples, double tolerance_m)
{
    enum { ROUNDS = 200 };
    for (int round = 0; round < ROUNDS; round++) {
        const struct motion motion = fit(path, weight, samples);
        double greatest = 0, mean = 0, square = 0;
        for (size_t n = 0; n < samples; n++) {
            const double r = residual(&motion, path, n);
            greatest = fmax(greatest, r);
            mean += weight[n] * r;
            square += weight[n] * r * r;
        }
        if (greatest <= tolerance_m) {
            return true;
        }
        if (square > tolerance_m * tolerance_m) {
            return false;
        }
        for (size_t n = 0; n < samples; n++) {
            weight[n] *= residual(&motion, path, n) / mean;
        }
    }
    return true;
}

/* How many samples from path[0] on one motion follows, of at most `samples`. */
static size_t reach(const struct point *path, double *weight, size_t samples, double tolerance_m)
{
    size_t followed = 1;
    weight[0] = 1;
    while (followed < samples) {
        const double share = 1 / (double)(followed + 1); /* of the sample that is added */
        for (size_t n = 0; n < followed; n++) {
            weight[n] *= 1 - share;
        }
        weight[followed] = share;
        if (!follows(path, weight, followed + 1, tolerance_m)) {
            return followed;
        }
        followed++;
    }
    return followed;
}

int hindsight_reports(const struct point *path, size_t samples, double tolerance_m, size_t *reports)
{
    double *weight = calloc(samples, sizeof *weight);
    if (weight == NULL && samples > 0) {
        return -1;
    }
    *reports = 0;
    for (size_t n = 0; n < samples; n += reach(&path[n], weight, samples - n, tolerance_m)) {
        ++*reports;
    }
    free(weight);
    return 0;
}
