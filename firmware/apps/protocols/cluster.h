#include "motehound/cluster.h"

#define PROTOCOL mh_protocol_cluster
#define PROTOCOL_SETTINGS mh_settings_cluster
#define PROTOCOL_SAMPLES false       /* when it asks for it */
#define PROTOCOL_REPORT board_report /* motes are told where the target is */
static struct mh_cluster_config protocol_config;
static struct mh_cluster_node protocol_state;

static void protocol_default(void)
{
    const struct mh_place sink = {0, 0, 0};
    mh_cluster_config_default(&protocol_config, MH_ELECTION_SACX, 0, &sink);
}
