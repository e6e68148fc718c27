/* The tracker `msl`: range-free Monte Carlo localisation (Hu and Evans, MobiCom 2004; Rudafshani and Datta, IPSN 2007), turned round so that nodes
 * that sense the target locate it. Who senses it is all that is used of a measurement.
 *
 * N particles persist. A new particle is uniform in the disc of radius (mean + three standard deviations of the class's speed) x interval
 * about a random old one, and counts if it is within the sensing range of every node that measures; so it goes on until N count or 20 N are
 * drawn. If some count but fewer than N, they are drawn from with equal probability to make up N. If none does, and at the start and after
 * restart(), particles are drawn in the same way from the bounding box of the intersection of the discs, at most 200 N of them; if it seems empty, the
 * centroid of the nodes is taken. Without a measurement every particle counts, so the set spreads.
 *
 * What an estimate holds: `position`, `raw` and `stored` the mean of the particles; velocities 0, as nothing is predicted, so every position is
 * reported; `covariance` that of the particles; `age` 0; `measurements` their number; `flags` STARTED, COASTED, REFRESHED (always).
 * `origin` is the first node's place, its z 0; mh_real resolves 1 mm 10 km from it. step() gives MH_NONE until the first measurement. interest() does
 * not exist. save() writes 12 bytes and 4 a particle, to 1 cm, so many as find room, evenly chosen; particles farther than 327 m from their mean go
 * to that distance in each axis.
 *
 * Cost: a draw takes up to 7 n operations, and there are from N to 220 N of them; 20 bytes a particle. */
#ifndef MOTEHOUND_MSL_H
#define MOTEHOUND_MSL_H

#if MH_REAL_FIXED
#error "motehound/msl.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/particles.h"
#include "motehound/tracker.h"

struct mh_msl_config {
    mh_real speed_mps;       /* mean speed of the target's class, 1e-3 to 1e3; nominal 4.4704 (10 mph) */
    mh_real speed_sd_mps;    /* its standard deviation, 0 to 1e3; nominal a fifth of that */
    mh_real sensing_range_m; /* how far a node measures, 1e-2 to 1e4; nominal 50 */
    uint16_t particles;      /* N, 1 to MH_PARTICLES_MAX; nominal 50 */
    uint32_t seed;           /* of the random numbers; nominal 1 */
};

/* The state, in the header so that it can be allocated statically; its members are the tracker's own, but `draws` may be read. */
struct mh_msl {
    struct mh_msl_config config;
    mh_real reach_m; /* how far the target moves in an interval */
    struct mh_random random;
    uint32_t draws; /* particles drawn since init: what the work goes with */
    mh_tick time;   /* of the last step */
    bool stepped;   /* `time` is set */
    bool restarted; /* the old particles are not to be used */
    struct mh_place origin;
    struct mh_vec2 position;
    uint16_t count; /* old particles; 0: no track */
    mh_real x[MH_PARTICLES_MAX], y[MH_PARTICLES_MAX];
    struct mh_particles next;
};

extern const struct mh_tracker mh_tracker_msl;

void mh_msl_config_default(struct mh_msl_config *config);

#endif
