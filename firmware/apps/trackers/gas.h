#include "motehound/gas.h"

#define TRACKER mh_tracker_gas
#define TRACKER_SETTINGS mh_settings_gas
#define SELF_TEST self_test_gas
static struct mh_gas_config tracker_config;
static struct mh_gas tracker_state;

static void tracker_default(void) { mh_gas_config_default(&tracker_config); }
