#include "motehound/followed.h"

static bool is_finite(struct mh_vec2 v) { return mh_finite(v.x) && mh_finite(v.y); }

enum mh_status mh_followed_report(struct mh_followed *followed, mh_tick time, struct mh_vec2 position,
                                  struct mh_vec2 velocity)
{
    if (!is_finite(position) || !is_finite(velocity)) {
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
    const struct mh_vec2 there = {followed->position.x + followed->velocity.x * seconds,
                                  followed->position.y + followed->velocity.y * seconds};
    if (!is_finite(there)) {
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
    const mh_real square = mh_squared(position.x - expected.x) + mh_squared(position.y - expected.y);
    return !(square <= mh_squared(tolerance_m));
}
