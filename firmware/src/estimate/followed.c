#include "motehound/followed.h"

enum mh_status mh_followed_report(struct mh_followed *followed, mh_tick time, struct mh_vec2 position,
                                  struct mh_vec2 velocity)
{
    if (!mh_vec2_finite(position) || !mh_vec2_finite(velocity)) {
        return MH_ERR_NOT_FINITE;
    }
    if (followed->known && mh_tick_before(time, followed->time)) {
        return MH_ERR_TIME;
    }
    followed->time = time;
    followed->position = position;
    followed->velocity = velocity;
    followed->known = true;
    return MH_OK;
}

enum mh_status mh_followed_predict(const struct mh_followed *followed, mh_tick time, struct mh_vec2 *position)
{
    if (!followed->known) {
        return MH_NONE;
    }
    const mh_real seconds = mh_seconds_between(followed->time, time);
    const struct mh_vec2 there = mh_vec2_along(followed->position, seconds, followed->velocity);
    if (!mh_vec2_finite(there)) {
        return MH_ERR_NOT_FINITE;
    }
    *position = there;
    return MH_OK;
}

bool mh_followed_differs(const struct mh_followed *followed, mh_tick time, struct mh_vec2 position, mh_real tolerance_m)
{
    struct mh_vec2 expected;
    if (mh_followed_predict(followed, time, &expected) != MH_OK) {
        return true;
    }
    return !(mh_vec2_square(mh_vec2_between(expected, position)) <= mh_wide_mul(tolerance_m, tolerance_m));
}
