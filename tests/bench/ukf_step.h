#ifndef UKF_STEP_H
#define UKF_STEP_H
#include <stdbool.h>
void bench_ukf_setup(void);
void bench_ukf_prepare(unsigned step); /* measures the ranges of a target that goes its way */
void bench_ukf_step(void); /* the prediction by sigma points, the ranges stacked: 9 + 36 evaluations of the models */
void bench_ukf_step_linear(void);   /* the prediction by the matrix, the ranges one after the other */
void bench_ekf_step(void);          /* the same with an EKF */
void bench_iterated_ekf_step(void); /* and with an iterated EKF, until it has settled */
bool bench_ukf_worked(void);        /* true if the last step succeeded and the estimate is where the target is */
#endif
