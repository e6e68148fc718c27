#include "bounds/fix_bound.h"

#include <math.h>

static const double near_m = 1, least_pivot = 1e-9;

void fix_information_add(struct fix_information *information, const struct heard_target *targets, struct point node,
                         double source_sd, double background_sd)
{
    double energy = 0, gradient[2 * FIX_BOUND_TARGETS_MAX];
    for (size_t k = 0; k < information->targets; k++) {
        const double dx = targets[k].place.x_m - node.x_m, dy = targets[k].place.y_m - node.y_m;
        const double square_m2 = fmax(dx * dx + dy * dy, near_m * near_m);
        const double own = targets[k].loudness_m2 / square_m2;
        gradient[2 * k] = -2 * own * dx / square_m2;
        gradient[2 * k + 1] = -2 * own * dy / square_m2;
        energy += own;
    }
    const double variance = source_sd * source_sd + pow(background_sd / energy, 2);
    for (size_t i = 0; i < 2 * information->targets; i++) {
        for (size_t j = 0; j < 2 * information->targets; j++) {
            information->J[i][j] += gradient[i] * gradient[j] / (energy * energy * variance);
        }
    }
}

/* J = L L', lower. Returns false unless J is positive definite. */
static bool factor(const struct fix_information *information,
                   double L[2 * FIX_BOUND_TARGETS_MAX][2 * FIX_BOUND_TARGETS_MAX])
{
    for (size_t i = 0; i < 2 * information->targets; i++) {
        for (size_t j = 0; j <= i; j++) {
            double rest = information->J[i][j];
            for (size_t k = 0; k < j; k++) {
                rest -= L[i][k] * L[j][k];
            }
            if (i == j && !(rest > least_pivot * information->J[i][i])) {
                return false;
            }
            L[i][j] = i == j ? sqrt(rest) : rest / L[j][j];
        }
    }
    return information->targets > 0;
}

/* tr J^-1 = sum of the squares of L^-1. */
double fix_bound_m2(const struct fix_information *information)
{
    double L[2 * FIX_BOUND_TARGETS_MAX][2 * FIX_BOUND_TARGETS_MAX], column[2 * FIX_BOUND_TARGETS_MAX], trace = 0;
    if (!factor(information, L)) {
        return (double)NAN;
    }
    for (size_t j = 0; j < 2 * information->targets; j++) {
        for (size_t i = j; i < 2 * information->targets; i++) {
            double rest = i == j;
            for (size_t k = j; k < i; k++) {
                rest -= L[i][k] * column[k];
            }
            column[i] = rest / L[i][i];
            trace += column[i] * column[i];
        }
    }
    return trace / (double)information->targets;
}
