#include "motehound/cv.h"

#define TRACKER mh_tracker_cv_ukf
#define TRACKER_SETTINGS mh_settings_cv
#define SELF_TEST self_test_sigma
static struct mh_cv_config tracker_config;
static struct mh_cv tracker_state;

/* Sensors whose noise is known: 8 bytes of RAM each. */
#define NOISE_MAX 32
static struct mh_cv_noise noise[NOISE_MAX];

static void tracker_default(void) { mh_cv_config_default(&tracker_config); }

#define TRACKER_ENTRY take_noise
static enum mh_status take_noise(struct mh_line_fields *fields, uint16_t number)
{
    if (number >= NOISE_MAX) {
        return MH_ERR_CAPACITY;
    }
    mh_settings_cv_noise(fields, &noise[number]);
    tracker_config.noise = noise;
    tracker_config.noise_count = (uint16_t)(number + 1);
    return MH_OK;
}
