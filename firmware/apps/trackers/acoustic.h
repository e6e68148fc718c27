#include "motehound/acoustic.h"

#define TRACKER mh_tracker_acoustic
#define TRACKER_SETTINGS mh_settings_acoustic
#define SELF_TEST self_test_sound
static struct mh_acoustic_config tracker_config;
static struct mh_acoustic tracker_state;

static void tracker_default(void)
{
    mh_acoustic_config_default(&tracker_config, MH_REAL(40.0f));
    tracker_config.separation = MH_SEPARATION_NONE; /* one target */
}
