#include "motehound/time_window.h"

#define SLOWEST_MPS MH_REAL(1e-3f)

enum mh_status mh_time_window(struct mh_vec2 node, struct mh_vec2 velocity, mh_real radius,
                              struct mh_time_window *window)
{
    if (!mh_vec2_finite(node) || !mh_vec2_finite(velocity) || !mh_finite(radius)) {
        return MH_ERR_NOT_FINITE;
    }
    if (radius <= 0) {
        return MH_ERR_RANGE;
    }
    const mh_real speed = mh_vec2_length(velocity);
    if (!(speed >= SLOWEST_MPS)) {
        return MH_ERR_SINGULAR;
    }
    const struct mh_vec2 u = {mh_div(velocity.x, speed), mh_div(velocity.y, speed)};
    const mh_real s = mh_wide_to_real(mh_vec2_dot(node, u));
    const mh_real q = mh_abs(mh_wide_to_real(mh_wide_mul(node.x, u.y) - mh_wide_mul(node.y, u.x)));
    if (!(q < radius)) {
        return MH_NONE;
    }
    const mh_real h = mh_wide_sqrt(
        mh_wide_mul(radius - q, mh_add(radius, q))); /* not R^2 - q^2, which loses what is left of close ones */
    window->in = mh_div(mh_add(s, -h), speed);
    window->out = mh_div(mh_add(s, h), speed);
    window->closest_s = mh_div(s, speed);
    window->closest_m = q;
    return MH_OK;
}
