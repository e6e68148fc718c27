/* Known answers, recomputed when an image comes up: whatever has spoilt a coefficient or an instruction in flash since, a mote that computes nonsense does not run.
 *
 * One function for each kind of image: what it tests is what that image computes with. The answers are worked out by hand or taken from the unit tests; each is compared to within what the
 * arithmetic's rounding can do. */
#ifndef SELF_TEST_H
#define SELF_TEST_H

#include "motehound/particles.h"

/* Every image: check sequence of frames, differencing of samples. */
bool self_test_node(void);

/* Heads, each with self_test_node besides. */
bool self_test_luo(void);   /* a puff's concentration, least squares, a step of the Sage-Husa filter */
bool self_test_range(void); /* the model of ranges, prediction and update of a Kalman filter */
bool self_test_sigma(void); /* the model of ranges, an update by sigma points */
bool self_test_particles(struct mh_particles *set); /* the weights and mean of three particles. Leaves them in `set` */
bool self_test_distances(void);                     /* the distance table, the point of two circles */
bool self_test_sound(void);                         /* a fix from five energies */
bool self_test_fusion(void);                        /* covariance intersection of two estimates */
bool self_test_diffusion(void);                     /* the field of a moving source */
bool self_test_gas(void);                           /* a plume, and a step of the filter behind the samples */

#endif
