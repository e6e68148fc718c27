#include "motehound/diffusion.h"

#define TRACKER mh_tracker_diffusion
#define TRACKER_SETTINGS mh_settings_diffusion
#define SELF_TEST self_test_diffusion
static struct mh_diffusion_config tracker_config;
static struct mh_diffusion tracker_state;

static void tracker_default(void) { mh_diffusion_config_default(&tracker_config); }
