#include "motehound/pftl.h"

#define TRACKER mh_tracker_pftl
#define TRACKER_SETTINGS mh_settings_pftl
#define SELF_TEST self_test_pftl
static struct mh_pftl_config tracker_config;
static struct mh_pftl tracker_state;

static void tracker_default(void) { mh_pftl_config_default(&tracker_config); }

static bool self_test_pftl(void) { return self_test_particles(&tracker_state.particles); }
