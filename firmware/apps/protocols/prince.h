#include "motehound/prince.h"

#define PROTOCOL mh_protocol_prince
#define PROTOCOL_SETTINGS mh_settings_prince
#define PROTOCOL_SAMPLES false       /* when it asks for it */
#define PROTOCOL_REPORT board_report /* motes are told where the target is */
static struct mh_prince_config protocol_config;
static struct mh_prince protocol_state;

static void protocol_default(void)
{
    mh_prince_config_default(&protocol_config, MH_PRINCE_NAMED, true, MH_REAL(40.0f), MH_REAL(140.0f));
    protocol_config.port = &mh_mote_prince;
}
