#include "bounds/leak.h"

#include "motehound/matrix.h"

#include <math.h>

struct leak_information leak_information_of(const struct scenario_prior *prior)
{
    struct leak_information information = {{0}};
    information.J[MH_PACKED(0, 0)] = 1 / (prior->sd_x_m * prior->sd_x_m);
    information.J[MH_PACKED(1, 1)] = 1 / (prior->sd_y_m * prior->sd_y_m);
    information.J[MH_PACKED(2, 2)] = 1 / (prior->rate_sd * prior->rate_sd);
    return information;
}

void leak_information_add(struct leak_information *information, const struct gas *gas, struct point source,
                          struct point place)
{
    double h[3];
    gas_gradient(gas, source, place, h);
    for (int column = 0; column < 3; column++) {
        for (int row = 0; row <= column; row++) {
            information->J[MH_PACKED(row, column)] += h[row] * h[column] / (gas->noise_ppm * gas->noise_ppm);
        }
    }
}

/* Element (i, i) of the inverse by cofactors. Rows of very different units are brought to a unit diagonal first. */
struct leak_bound leak_bound(const struct leak_information *information)
{
    const double *J = information->J;
    const double sx = sqrt(J[MH_PACKED(0, 0)]), sy = sqrt(J[MH_PACKED(1, 1)]), sq = sqrt(J[MH_PACKED(2, 2)]);
    const double a = J[MH_PACKED(0, 1)] / (sx * sy), b = J[MH_PACKED(0, 2)] / (sx * sq),
                 c = J[MH_PACKED(1, 2)] / (sy * sq);
    const double determinant = 1 - a * a - b * b - c * c + 2 * a * b * c;
    const double xx = (1 - c * c) / determinant / (sx * sx), yy = (1 - b * b) / determinant / (sy * sy);
    return (struct leak_bound){sqrt(xx + yy), sqrt((1 - a * a) / determinant) / sq};
}
