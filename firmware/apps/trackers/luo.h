#include "motehound/luo.h"

#define TRACKER mh_tracker_luo
#define TRACKER_SETTINGS mh_settings_luo
#define SELF_TEST self_test_luo

static struct mh_luo_config tracker_config;
static struct mh_luo tracker_state;

static void tracker_default(void) { mh_luo_config_default(&tracker_config); }
