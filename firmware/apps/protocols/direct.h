#include "motehound/direct.h"

#define PROTOCOL mh_protocol_direct
#define PROTOCOL_SETTINGS mh_settings_direct
#define PROTOCOL_SAMPLES true
#define PROTOCOL_REPORT NULL
static struct mh_direct_config protocol_config;
static struct mh_direct protocol_state;

static void protocol_default(void) { mh_direct_config_default(&protocol_config); }
