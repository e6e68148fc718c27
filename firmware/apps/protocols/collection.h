#include "motehound/collection.h"

#define PROTOCOL mh_protocol_collection
#define PROTOCOL_SETTINGS mh_settings_collection
#define PROTOCOL_SAMPLES true
#define PROTOCOL_REPORT NULL
static struct mh_collection_config protocol_config;
static struct mh_collection protocol_state;

static void protocol_default(void) { mh_collection_config_default(&protocol_config); }
