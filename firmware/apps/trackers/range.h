#include "motehound/range.h"

#define TRACKER mh_tracker_range
#define TRACKER_SETTINGS mh_settings_range
#define SELF_TEST self_test_range
static struct mh_range_config tracker_config;
static struct mh_range tracker_state;

static void tracker_default(void) { mh_range_config_default(&tracker_config); }
