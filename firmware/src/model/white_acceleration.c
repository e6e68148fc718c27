#include "motehound/white_acceleration.h"

#include "motehound/matrix.h"

#include <string.h>

/* One axis: variances and covariance of position and velocity after `ticks` whole ticks of length T and a further r, for noise of variance 1. */
struct axis {
    mh_real position, both, velocity;
};

/* What a tick has done is (T^2 / 2 + k T^2, T) after k more: the sums over k are T^4 (m^3 / 3 - m / 12), T^3 m^2 / 2, m T^2. The rest adds
 * T / r times the square of (r^2 / 2, r). */
static struct axis axis_of(mh_real ticks, mh_real T, mh_real r)
{
    const mh_real velocity = ticks * T * T;
    const mh_real both = velocity * ticks * T * 0.5f;
    const mh_real position = velocity * T * T * (ticks * ticks * (1.0f / 3.0f) - 1.0f / 12.0f);
    return (struct axis){position + r * (2 * both + r * (velocity + 0.25f * T * r)),
                         both + r * (velocity + 0.5f * T * r), velocity + T * r};
}

void mh_white_acceleration(const struct mh_white_acceleration *model, mh_tick elapsed, mh_real *F, mh_real *Q)
{
    const mh_real per_s = 1.0f / (mh_real)MH_TICKS_PER_S;
    const mh_tick whole = elapsed / model->tick;
    const mh_real dt = (mh_real)elapsed * per_s;
    const struct axis axis =
        axis_of((mh_real)whole, (mh_real)model->tick * per_s, (mh_real)(elapsed - whole * model->tick) * per_s);
    const mh_real x = model->variance.x, y = model->variance.y;
    const mh_real transition[] = {1, dt, 0, 0, 0, 1, 0, 0, 0, 0, 1, dt, 0, 0, 0, 1};
    const mh_real noise[] = {x * axis.position, x * axis.both,    x * axis.velocity, 0, 0, y * axis.position, 0, 0,
                             y * axis.both,     y * axis.velocity};
    memcpy(F, transition, sizeof transition);
    memcpy(Q, noise, sizeof noise);
}
