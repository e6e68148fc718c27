/* Image of the mote that joins the tracks of four clusters by covariance intersection, at the sink of the protocol `fixed`. The clusters are those of CLUSTERS: known by configuration to all motes, here when the image
 * is built. */
#include "motehound/fusion_centre.h"
#include "board_mote.h"
#include "self_test.h"

/* Each cluster: four sensors about the corner of a field of 40 m by 40 m, whose middle is the sink's. */
#define MEMBER(id, x_m, y_m)                                                                                           \
    {                                                                                                                  \
        (id), { (x_m) * 1000L, (y_m)*1000L, 0 }                                                                        \
    }
#define CLUSTER(first, x, y)                                                                                           \
    MEMBER(first, x, y), MEMBER((first) + 1, (x) + 8, y), MEMBER((first) + 2, x, (y) + 8),                             \
        MEMBER((first) + 3, (x) + 8, (y) + 8)
static const struct mh_fixed_member members[16] = {CLUSTER(10, -20, -20), CLUSTER(20, 12, -20), CLUSTER(30, -20, 12),
                                                   CLUSTER(40, 12, 12)};
static const struct mh_fixed_cluster clusters[4] = {
    {&members[0], 4}, {&members[4], 4}, {&members[8], 4}, {&members[12], 4}};

static struct mh_fixed_config routing;
static struct mh_fixed route;
static struct mh_fusion_centre_config joining;
static struct mh_fusion_centre centre;
static struct mh_clock_config clock_config = {.root = true, .period = 30000, .wait = 4000, .sent_q8 = 128};
static struct mh_clock clock_state;

static struct board_mote board = {
    .mote = {.id = MOTE_ID,
             .protocol = &mh_protocol_fixed,
             .protocol_config = &routing,
             .protocol_state = &route,
             .clock = &mh_clock_flooding,
             .clock_config = &clock_config,
             .clock_state = &clock_state,
             .centre = &mh_centre_fusion,
             .centre_config = &joining,
             .centre_state = &centre},
    .clock = &mh_clock_flooding,
    .clock_config = &clock_config,
    .protocol = &routing,
    .self_test = self_test_fusion,
    .report = board_report,
};

int main(void)
{
    mh_fixed_config_default(&routing);
    routing.port = &mh_mote_fixed;
    routing.sink = MOTE_ID;
    routing.clusters = clusters;
    routing.cluster_count = 4;
    mh_fusion_centre_config_default(&joining);
    return board_mote_run(&board);
}
