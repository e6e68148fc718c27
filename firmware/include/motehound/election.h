/* Who leads the track of a moving target next, and who helps: election rules of dynamic clusters, as pure functions.
 *
 * At each sampling instant the head asks nodes around it, localises the target, and then decides on the cluster of the next instant. All
 * rules look ahead along a straight line: the target is expected at P_q = stored + q T stored_velocity in q instants, from what is stored of
 * the track (estimate.h) but for sacx. A node covers a place within the sensing range of it. Candidates are the head and its neighbours.
 *
 * Zhou et al., "Moving target localization and tracking algorithms: a particle filter based method", Journal of Software 24(9), 2013:
 *   sac       Few, and those that will serve longest. The head and `members` others are asked. A new cluster is due when the head does not
 *             cover P_1, or when the nodes of the cluster that detected now, or those that cover P_1, are fewer than `least_answers` and
 *             there are more candidates that cover P_1 than that. Of these, ordered by how many of P_1 ... P_horizon they cover (most first),
 *             then by the distance to P_horizon, the first is head and the next are members.
 *   sacx      The same with a horizon as long as the target takes to cross a disc of the sensing range, ties broken by the distance to the
 *             middle of the way, and as members those neighbours of the new head that cover any instant of it. The way ahead is
 *             that of the tracker's own position and velocity, which its head knows. A member is asked only when the target is
 *             expected within the sensing range and MH_ELECTION_MARGIN_M of it; all neighbours, when few of these detect it.
 *   scm       All neighbours of the head are asked. The nodes that detect form a new cluster as soon as one of them is new to it, or the
 *             head detects no more; its head is the one nearest to the position.
 *   scm_near  The same, as soon as another detecting node is the nearest.
 *   scm_set   The same, as soon as another set of nodes detects.
 * He and Hou, "Tracking targets with quality in wireless sensor networks", ICNP 2005:
 *   rho       As sac, ordered by how far the target still goes inside the node's disc from P_1 on, straight ahead (at rest: how far it can
 *             go in any direction). The head is to be
 *             within the sensing range of the present head and in the sector of +- 45 degrees ahead of the stored position; failing that
 *             within that range; failing that anywhere.
 * Remaining ties go to the lowest identifier.
 *
 * Scaling and overflow (fixed point): Q15.16; places within 32,767 m of the estimate's origin, those farther off count as infinitely far. Distances are compared as exact squares, and only the
 * merit of rho is rounded, to 1.5e-5 m.
 *
 * Cost: linear in the candidates, times the horizon for sac and sacx, when a new cluster is due; else linear in the cluster. */
#ifndef MOTEHOUND_ELECTION_H
#define MOTEHOUND_ELECTION_H

#include "motehound/config.h"
#include "motehound/estimate.h"
#include "motehound/measurement.h"
#include "motehound/status.h"

#include <stdbool.h>
#include <stddef.h>

#define MH_ELECTION_MARGIN_M MH_REAL(10.0f) /* sacx: what the prediction may be off by before a member is missed */
#define MH_ELECTION_HORIZON_MAX 40          /* instants */

enum mh_election {
    MH_ELECTION_SACX,
    MH_ELECTION_SAC,
    MH_ELECTION_RHO,
    MH_ELECTION_SCM,
    MH_ELECTION_SCM_NEAR,
    MH_ELECTION_SCM_SET,
    MH_ELECTIONS
};

struct mh_election_config {
    enum mh_election rule;
    uint8_t members;         /* beside the head, 1 to MH_CLUSTER_MAX; of the rules scm* all that find room */
    uint8_t horizon;         /* sac: 1 to MH_ELECTION_HORIZON_MAX instants */
    uint8_t least_answers;   /* sac, sacx, rho: 0 to MH_CLUSTER_MAX + 1 */
    mh_real sensing_range_m; /* 0.1 to 1e4 */
    mh_real radio_range_m;   /* 0.1 to 1e5 (fixed point: 32,767) */
    mh_tick interval;        /* between sampling instants, 1 to 3,600,000 ticks */
};

/* The head, or a neighbour of it. */
struct mh_candidate {
    mh_node_id id;
    struct mh_place place;
    bool detects; /* it was asked at the instant just closed and detected the target */
};

/* A node of a cluster. It covers the instants first ... last, counted from 1, of the horizon after its election; 0, 0 for none, and by the rules rho and
 * scm*. */
struct mh_member {
    mh_node_id id;
    struct mh_place place;
    uint8_t first, last;
};

struct mh_cluster {
    struct mh_member head;
    uint8_t count;
    struct mh_member members[MH_CLUSTER_MAX]; /* [0 .. count), without the head; best first */
};

/* Nominal values of `rule`: 7 members, of sacx 15 (or MH_CLUSTER_MAX if that is less), horizon 4, at least 4 answers, sensing range 50 m, radio
 * range 100 m, every 2 s. */
void mh_election_config_default(struct mh_election_config *config, enum mh_election rule);

/* MH_OK, or MH_ERR_ARGUMENT: a value is outside its range. The functions below take only a configuration that passes. */
enum mh_status mh_election_check(const struct mh_election_config *config);

/* The instant of `estimate` is closed: who goes on? `cluster` holds the present cluster and, with MH_OK, the new one, which may have the
 * same head. `candidates`: the present head and its neighbours, in any order, each once. The rule scm* takes members from all that detect, sac
 * and rho from all candidates, sacx from those that the new head hears.
 * Returns MH_NONE if the present cluster goes on, also when there is nobody to replace it. Errors: MH_ERR_NOT_FINITE (estimate). */
enum mh_status mh_elect(const struct mh_election_config *config, const struct mh_estimate *estimate,
                        const struct mh_candidate *candidates, size_t count, struct mh_cluster *cluster);

/* sacx: the new head, which knows its own neighbours best, chooses the members of `cluster`, as of the instant at which the target is at
 * `position` (m from `origin`) and moves with `velocity` (m/s); `candidates` are its neighbours. No effect by other rules. Errors:
 * MH_ERR_NOT_FINITE (position, velocity). */
enum mh_status mh_elect_members(const struct mh_election_config *config, const struct mh_place *origin,
                                const struct mh_vec2 *position, const struct mh_vec2 *velocity,
                                const struct mh_candidate *candidates, size_t count, struct mh_cluster *cluster);

/* The first cluster of a track, or the first after it was lost: of the candidates that detect the one nearest to `about` is head, those
 * nearest to it are members. Errors: MH_NONE (nobody detects). */
enum mh_status mh_elect_first(const struct mh_election_config *config, const struct mh_place *about,
                              const struct mh_candidate *candidates, size_t count, struct mh_cluster *cluster);

/* True if node `id` at `place` is to sample at the instant for which the target is expected at `predicted`. The head always is. */
bool mh_election_asks(const struct mh_election_config *config, const struct mh_cluster *cluster, mh_node_id id,
                      const struct mh_place *place, const struct mh_place *predicted);

/* sacx: so few of those asked detect the target, fewer than least_answers, that the head is to ask all its other neighbours too, at the same
 * instant if they are still within reach. The prediction was wrong, and a position from few ranges may be, too; by the other rules it is made
 * of those. */
bool mh_election_asks_all(const struct mh_election_config *config, size_t answers);

/* The member, or the head, with identifier `id`; NULL if it is not of the cluster. */
const struct mh_member *mh_cluster_find(const struct mh_cluster *cluster, mh_node_id id);

#endif
