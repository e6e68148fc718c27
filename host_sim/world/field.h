/* The concentration that a moving source leaves in the plane: a continuous line source in an unbounded medium.
 *
 *   C(x, t) = int_0^t mu(tau) / (4 pi D (t - tau)) exp(-|x - p(tau)|^2 / (4 D (t - tau))) dtau       Luo, Eq. (1)-(2)
 *
 * integrated over the age s = t - tau by panels of 16-point Gauss-Legendre quadrature in u = sqrt(s). In u the trace of a
 * source that passes by is a Gaussian of width sqrt(D / 2) / v whatever its age, and the diffusion kernel changes over a
 * constant share of u: so panels grow with u up to a multiple of sqrt(D) / v. They break where the path does. Relative error
 * below 1e-9 wherever C > 1e-9 g/m2 and the source is more than 1 mm away; nearer, C stays finite. */
#ifndef MOTEHOUND_SIM_FIELD_H
#define MOTEHOUND_SIM_FIELD_H

#include "world/trajectory.h"

#include <stddef.h>

enum { FIELD_PANEL_POINTS = 16 };

/* Nothing of a release is felt where the exponent of Eq. (2) is beyond 45, so farther from the path's places of one age than
 * the square root of 45 x 4 D s: such panels are passed over. */
struct field_panel {
    double middle_x, middle_y, reach_sq; /* of this panel: nothing beyond sqrt(reach_sq) from its middle */
    double younger_reach_sq;             /* of this panel and all younger ones, from where the source is now */
    double x[FIELD_PANEL_POINTS], y[FIELD_PANEL_POINTS];
    double rate[FIELD_PANEL_POINTS];   /* 1 / (4 D s) */
    double weight[FIELD_PANEL_POINTS]; /* mu / (4 pi D s) ds */
};

struct field {
    struct trajectory trajectory;
    double diffusion_m2ps, release_gps, release_variation, release_period_s;
    struct field_panel *panels; /* of the instant that was prepared last, oldest first */
    size_t count, capacity;
    struct point source; /* where it is at that instant */
};

/* The field of scenario->source. Returns 0, or -1 with one line in `error` and nothing to free. */
int field_make(struct field *field, const struct scenario *scenario, uint64_t seed, char *error, size_t error_size);

void field_free(struct field *field);

/* Lay the panels for `time_s`, once for all places. Cost: a few hundred positions on the path. Returns 0, or -1 if there is no
 * memory. */
int field_prepare(struct field *field, double time_s);

/* C at a place, g/m2, at the time prepared. Cost: 16 exponentials for each panel whose release can have come so far. */
double field_concentration(const struct field *field, double x_m, double y_m);

#endif
