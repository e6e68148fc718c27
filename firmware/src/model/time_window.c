#include "motehound/time_window.h"

#define SLOWEST_MPS 1e-3f

enum mh_status mh_time_window(struct mh_vec2 node, struct mh_vec2 velocity, mh_real radius,
                              struct mh_time_window *window)
{
    if (!mh_finite(node.x) || !mh_finite(node.y) || !mh_finite(velocity.x) || !mh_finite(velocity.y) ||
        !mh_finite(radius)) {
        return MH_ERR_NOT_FINITE;
    }
    if (radius <= 0) {
        return MH_ERR_RANGE;
    }
    const mh_real speed = mh_sqrt(mh_squared(velocity.x) + mh_squared(velocity.y));
    if (!(speed >= SLOWEST_MPS)) {
        return MH_ERR_SINGULAR;
    }
    const struct mh_vec2 u = {velocity.x / speed, velocity.y / speed};
    const mh_real s = node.x * u.x + node.y * u.y;
    const mh_real q = mh_abs(node.x * u.y - node.y * u.x);
    if (!(q < radius)) {
        return MH_NONE;
    }
    const mh_real h = mh_sqrt((radius - q) * (radius + q)); /* not R^2 - q^2, which loses what is left of close ones */
    window->in = (s - h) / speed;
    window->out = (s + h) / speed;
    window->closest_s = s / speed;
    window->closest_m = q;
    return MH_OK;
}
