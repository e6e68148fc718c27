/* The tracker `range`: constant velocity in the plane, measured by ranges, one scalar update a range. */
#ifndef MOTEHOUND_RANGE_H
#define MOTEHOUND_RANGE_H

#include "motehound/tracker.h"

struct mh_range_config {
    mh_real range_sd_m;          /* of one range, > 0 */
    mh_real acceleration_sd_mps2; /* of the target's white acceleration, > 0 */
    mh_real height_m;            /* of the target in the field's frame (z), so that slant ranges can be used in the plane */
};

extern const struct mh_tracker mh_tracker_range;

void mh_range_config_default(struct mh_range_config *config);

#endif
