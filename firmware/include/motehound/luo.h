/* The tracker `luo`: Algorithm 1 of Luo, Chai and Yang, "Mobile diffusion source tracking in wireless sensor networks".
 *
 * One pre-estimate of position and arrival time a sampling instant by bound-constrained least squares, Eq. (10), or optionally the
 * nonlinear problem (9) started from it, then a Sage-Husa filter on the sequence of positions (Appendix 2). */
#ifndef MOTEHOUND_LUO_H
#define MOTEHOUND_LUO_H

#include "motehound/tracker.h"

struct mh_luo_config {
    mh_real diffusion_m2ps; /* D, > 0; nominal 1 */
    mh_real chi;            /* selection threshold on concentration, g/m2, >= 0; nominal 0.2 */
    mh_real forgetting;     /* b of the Sage-Husa weight, 0 < b < 1; nominal 0.97 */
    bool nonlinear;         /* solve Eq. (9), started from the answer of (10); nominal false */
    bool stop_outside;      /* end for good once the track has left `region` after having been well inside; nominal false */
    struct mh_region region; /* used with stop_outside only */
};

extern const struct mh_tracker mh_tracker_luo;

void mh_luo_config_default(struct mh_luo_config *config);

#endif
