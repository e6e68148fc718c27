#include "motehound/node_class.h"

#include "motehound/time_window.h"

static mh_real dot(struct mh_vec2 a, struct mh_vec2 b) { return a.x * b.x + a.y * b.y; }

static struct mh_vec2 from(struct mh_vec2 a, struct mh_vec2 b)
{
    const struct mh_vec2 difference = {b.x - a.x, b.y - a.y};
    return difference;
}

enum mh_node_class mh_node_class(const struct mh_strips *strips, const struct mh_course *course, struct mh_vec2 place)
{
    const struct mh_vec2 v = course->velocity, offset = from(course->fix, place);
    const mh_real square = dot(v, v);
    if (square == 0.0f && mh_finite(offset.x) && mh_finite(offset.y)) {
        return MH_NODE_COMPETITOR;
    }
    const mh_real ahead = dot(v, from(course->head, place));
    if (!mh_finite(ahead) || ahead < 0.0f) {
        return MH_NODE_NONE;
    }
    const mh_real across = mh_abs(v.x * offset.y - v.y * offset.x), speed = mh_sqrt(square);
    return across <= strips->inner_m * speed    ? MH_NODE_INNER
           : across <= strips->border_m * speed ? MH_NODE_BORDER
           : across <= strips->outer_m * speed  ? MH_NODE_OUTER
                                                : MH_NODE_NONE;
}

void mh_prince_consider(struct mh_prince_choice *best, const struct mh_prince_rule *rule,
                        const struct mh_strips *strips, const struct mh_course *course, mh_real elapsed_s,
                        mh_node_id id, struct mh_vec2 place)
{
    struct mh_time_window window;
    if (mh_node_class(strips, course, place) != MH_NODE_INNER ||
        mh_time_window(from(course->fix, place), course->velocity, strips->border_m, &window) != MH_OK ||
        window.in < elapsed_s + rule->lead_s) {
        return;
    }
    const mh_real path = window.in * mh_sqrt(dot(course->velocity, course->velocity));
    const mh_real worse =
        rule->farthest ? best->path_m - path : mh_abs(path - rule->step_m) - mh_abs(best->path_m - rule->step_m);
    if (!best->found || worse < 0.0f || (worse == 0.0f && id < best->id)) {
        const struct mh_prince_choice choice = {.found = true, .id = id, .path_m = path, .entry_s = window.in};
        *best = choice;
    }
}
