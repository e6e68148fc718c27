/* One puff: what a mass released at one place and time makes of the concentration later, in the plane (Luo, Eq. (4)).
 *
 * Scaling and overflow, in fixed point. All numbers are mh_real (Q15.16), so a concentration of 1e-3 g/m2 has six bits. The squared distance is
 * a sum of exact products: only its quotient by 4 D age is rounded, and where that passes 12 the exponential is 0. A concentration or a derivative too large for the format is
 * infinite. Good for 4 D age up to 32,767 m2. */
#ifndef MOTEHOUND_PUFF_H
#define MOTEHOUND_PUFF_H

#include "motehound/geometry.h"

struct mh_puff {
    struct mh_vec2 position; /* of the release, m */
    mh_real age;             /* time since the release, s */
    mh_real mass;            /* g (Luo's delta M) */
};

/* Derivatives of the concentration by the puff's position (x, y), by the logarithm of its mass, and by its age. */
struct mh_puff_slope {
    mh_real x, y, log_mass, age;
};

/* Concentration in g/m2 at `point` for a diffusion coefficient in m2/s (> 0), and its derivatives unless `slope` is NULL. All are 0
 * for age <= 0 and where they are too small for mh_real. Cost: one exponential and two divisions. */
mh_real mh_puff_concentration(const struct mh_puff *puff, mh_real diffusion_m2ps, struct mh_vec2 point,
                              struct mh_puff_slope *slope);

#endif
