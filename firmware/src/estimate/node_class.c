#include "motehound/node_class.h"

#include "motehound/time_window.h"

enum mh_node_class mh_node_class(const struct mh_strips *strips, const struct mh_course *course, struct mh_vec2 place)
{
    const struct mh_vec2 v = course->velocity, offset = mh_vec2_between(course->fix, place);
    const mh_wide square = mh_vec2_square(v);
    if (square == 0 && mh_vec2_finite(offset)) {
        return MH_NODE_COMPETITOR;
    }
    const struct mh_vec2 ahead = mh_vec2_between(course->head, place);
    if (!mh_vec2_finite(v) || !mh_vec2_finite(ahead) || !(mh_vec2_dot(v, ahead) >= 0)) {
        return MH_NODE_NONE;
    }
    const mh_wide cross = mh_wide_mul(v.x, offset.y) - mh_wide_mul(v.y, offset.x), across = cross < 0 ? -cross : cross;
    const mh_real speed = mh_wide_sqrt(square);
    return across <= mh_wide_mul(strips->inner_m, speed)    ? MH_NODE_INNER
           : across <= mh_wide_mul(strips->border_m, speed) ? MH_NODE_BORDER
           : across <= mh_wide_mul(strips->outer_m, speed)  ? MH_NODE_OUTER
                                                            : MH_NODE_NONE;
}

void mh_prince_consider(struct mh_prince_choice *best, const struct mh_prince_rule *rule,
                        const struct mh_strips *strips, const struct mh_course *course, mh_real elapsed_s,
                        mh_node_id id, struct mh_vec2 place)
{
    struct mh_time_window window;
    if (mh_node_class(strips, course, place) != MH_NODE_INNER ||
        mh_time_window(mh_vec2_between(course->fix, place), course->velocity, strips->border_m, &window) != MH_OK ||
        window.in < elapsed_s + rule->lead_s) {
        return;
    }
    const mh_real path = mh_mul(window.in, mh_vec2_length(course->velocity));
    const mh_real worse = rule->farthest ? best->path_m - path
                                         : mh_abs(mh_add(path, -rule->step_m)) - mh_abs(best->path_m - rule->step_m);
    if (!best->found || worse < 0 || (worse == 0 && id < best->id)) {
        const struct mh_prince_choice choice = {.found = true, .id = id, .path_m = path, .entry_s = window.in};
        *best = choice;
    }
}
