#include "motehound/token.h"

#define PROTOCOL mh_protocol_token
#define PROTOCOL_SETTINGS mh_settings_token
#define PROTOCOL_SAMPLES false       /* when it asks for it */
#define PROTOCOL_REPORT board_report /* motes are told where the target is */
static struct mh_token_config protocol_config;
static struct mh_token_node protocol_state;

static void protocol_default(void)
{
    const struct mh_place sink = {0, 0, 0};
    mh_token_config_default(&protocol_config, 0, &sink);
}
