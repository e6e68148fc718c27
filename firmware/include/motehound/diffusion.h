/* The tracker `diffusion`: a sliding window of the source's path, fitted to the increments with the exact line-source model. */
#ifndef MOTEHOUND_DIFFUSION_H
#define MOTEHOUND_DIFFUSION_H

#include "motehound/tracker.h"

struct mh_diffusion_config {
    mh_real diffusion_m2ps; /* D, > 0; nominal 1 */
    mh_real chi;            /* significant concentration, g/m2, > 0; nominal 0.2 */
    mh_real release_gps;    /* expected release rate, > 0; nominal 100 (known to within a factor of about e) */
    mh_real additive_sd;    /* of a reading, g/m2; nominal 0.05, deliberately generous */
    mh_real relative_sd;    /* of a reading, as a share of it; nominal 0.05, deliberately generous */
    struct mh_region region; /* the source stays within; nominal: unbounded (+- 1e9 mm) */
};

extern const struct mh_tracker mh_tracker_diffusion;

void mh_diffusion_config_default(struct mh_diffusion_config *config);

#endif
