/* What the steps of all peers work on: the filter of kalman_step.c with whole matrices, by rows. A peer's step counts only if its states are Motehound's. */
#ifndef KALMAN_PEER_H
#define KALMAN_PEER_H

enum { PEER_STATES = 4, PEER_MEASUREMENTS = 2 };

extern const float peer_F[16], peer_Q[16], peer_H[8], peer_R[4];
extern const float peer_x[4], peer_P[16]; /* before the first step */
extern const float peer_z[2];             /* in each step */

/* Each peer's own, beside bench_step(). */
void peer_setup(void);
void peer_state(float x[4]);

#endif
