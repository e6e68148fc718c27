#include "motehound/prince.h"

#define PROTOCOL mh_protocol_prince
#define PROTOCOL_SETTINGS mh_settings_prince
#define PROTOCOL_SAMPLES false       /* when it asks for it */
#define PROTOCOL_REPORT board_report /* motes are told where the target is */
static struct mh_prince_config protocol_config;
static struct mh_prince protocol_state;

/* Targets that begin near the node: as many as it follows at once. */
static struct mh_prince_entry entries[MH_TARGETS_MAX];

#define PROTOCOL_ENTRY take_entry
static enum mh_status take_entry(struct mh_line_fields *fields, uint16_t number)
{
    if (number >= MH_TARGETS_MAX) {
        return MH_ERR_CAPACITY;
    }
    mh_settings_prince_entry(fields, &entries[number]);
    protocol_config.entries = entries;
    protocol_config.entry_count = (uint8_t)(number + 1);
    return MH_OK;
}

static void protocol_default(void)
{
    mh_prince_config_default(&protocol_config, MH_PRINCE_NAMED, true, MH_REAL(40.0f), MH_REAL(140.0f));
    protocol_config.port = &mh_mote_prince;
}
