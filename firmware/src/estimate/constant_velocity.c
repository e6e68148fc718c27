#include "motehound/kalman.h"

#include <string.h>

void mh_kalman_constant_velocity(mh_real dt, mh_real intensity, mh_real *F, mh_real *Q)
{
    const mh_real velocity = mh_mul(intensity, dt);
    const mh_real cross = mh_mul(mh_mul(velocity, dt), MH_REAL(1.0f / 2.0f));
#if MH_REAL_FIXED
    /* rounding must not make Q indefinite: position >= cross^2 / velocity */
    const mh_wide square = mh_wide_mul(cross, cross);
    const mh_real least = velocity > 0 ? mh_wide_div(square, velocity) : 0;
    const mh_real position =
        mh_max(mh_mul(mh_mul(velocity, dt), dt) / 3, least + (mh_wide_mul(least, velocity) < square ? MH_REAL_MIN : 0));
#else
    const mh_real position = velocity * dt * dt * (1.0f / 3.0f);
#endif
    const mh_real transition[] = {MH_REAL(1.0f), 0, dt, 0, 0, MH_REAL(1.0f), 0, dt, 0, 0,
                                  MH_REAL(1.0f), 0, 0,  0, 0, MH_REAL(1.0f)};
    const mh_real noise[] = {position, 0, position, cross, 0, velocity, 0, cross, 0, velocity};
    memcpy(F, transition, sizeof transition);
    memcpy(Q, noise, sizeof noise);
}
