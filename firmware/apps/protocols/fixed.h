/* Clusters: four, each of four sensors about a corner of a field of 40 m by 40 m, whose middle is the sink's, until others are configured. */
#include "motehound/fixed.h"

#define PROTOCOL mh_protocol_fixed
#define PROTOCOL_SETTINGS mh_settings_fixed
#define PROTOCOL_SAMPLES true
#define PROTOCOL_REPORT board_report
static struct mh_fixed_config protocol_config;
static struct mh_fixed protocol_state;

/* Members of all clusters: 16 bytes of RAM each. */
#ifdef __AVR__
#define MEMBERS_MAX 16
#else
#define MEMBERS_MAX 32
#endif

#define MEMBER(id, x_m, y_m)                                                                                           \
    {                                                                                                                  \
        (id), { (x_m) * 1000L, (y_m)*1000L, 0 }                                                                        \
    }
#define CORNER(first, x, y)                                                                                            \
    MEMBER(first, x, y), MEMBER((first) + 1, (x) + 8, y), MEMBER((first) + 2, x, (y) + 8),                             \
        MEMBER((first) + 3, (x) + 8, (y) + 8)
static struct mh_fixed_member members[MEMBERS_MAX] = {CORNER(10, -20, -20), CORNER(20, 12, -20), CORNER(30, -20, 12),
                                                      CORNER(40, 12, 12)};
static struct mh_fixed_cluster clusters[MH_FIXED_CLUSTERS_MAX] = {
    {&members[0], 4}, {&members[4], 4}, {&members[8], 4}, {&members[12], 4}};

static void protocol_default(void)
{
    mh_fixed_config_default(&protocol_config);
    protocol_config.port = &mh_mote_fixed;
    protocol_config.clusters = clusters;
    protocol_config.cluster_count = 4;
}

#define PROTOCOL_ENTRY take_member
/* A member of the cluster of the one before, or of the next. */
static enum mh_status take_member(struct mh_line_fields *fields, uint16_t number)
{
    const uint8_t begun = number == 0 ? 0 : protocol_config.cluster_count;
    uint8_t cluster = UINT8_MAX;
    struct mh_fixed_member member = {0, {0, 0, 0}};
    mh_settings_fixed_member(fields, &cluster, &member);
    if (number >= MEMBERS_MAX || cluster >= MH_FIXED_CLUSTERS_MAX) {
        return MH_ERR_CAPACITY;
    }
    if (cluster == begun) {
        const struct mh_fixed_cluster next = {&members[number], 0};
        clusters[cluster] = next;
        protocol_config.cluster_count = (uint8_t)(cluster + 1);
    } else if (cluster + 1 != begun) {
        return MH_ERR_ARGUMENT;
    }
    members[number] = member;
    clusters[cluster].count++;
    return MH_OK;
}
