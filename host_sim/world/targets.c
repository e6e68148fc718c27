#include "world/targets.h"

#include "world/splitmix.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double pi = 3.141592653589793;

bool targets_are_several(enum path_kind path) { return path >= PATH_SCRIPTED; }

/* The leg that all go along: `along` and `left` are its directions. */
struct axis {
    struct point from, along, left;
    double length_m;
};

static struct axis axis_of(const struct scenario *scenario)
{
    const struct waypoint *a = &scenario->source.points[0], *b = &scenario->source.points[1];
    const double length_m = hypot(b->x_m - a->x_m, b->y_m - a->y_m);
    const struct point along = {(b->x_m - a->x_m) / length_m, (b->y_m - a->y_m) / length_m};
    return (struct axis){{a->x_m, a->y_m}, along, {-along.y_m, along.x_m}, length_m};
}

static struct point place_on(const struct axis *axis, double along_m, double left_m)
{
    return (struct point){axis->from.x_m + along_m * axis->along.x_m + left_m * axis->left.x_m,
                          axis->from.y_m + along_m * axis->along.y_m + left_m * axis->left.y_m};
}

static void go(struct trajectory *path, struct point from, struct point to, double duration_s)
{
    const double dx = to.x_m - from.x_m, dy = to.y_m - from.y_m;
    path->legs[path->count++] = (struct leg){.start_s = path->duration_s,
                                             .duration_s = duration_s,
                                             .speed_mps = hypot(dx, dy) / duration_s,
                                             .start = from,
                                             .heading_rad = atan2(dy, dx)};
    path->duration_s += duration_s;
}

/* Target `rank` places to the left of the middle of the formation. */
struct member {
    const struct scenario *scenario;
    struct axis axis;
    double rank;
    size_t index;
    double direction_rad; /* of a ring's first */
};

static void go_straight(struct trajectory *path, const struct member *m, double left_m)
{
    go(path, place_on(&m->axis, 0, left_m), place_on(&m->axis, m->axis.length_m, left_m),
       m->axis.length_m / m->scenario->source.speed_mps);
}

static void go_parallel(struct trajectory *path, const struct member *m)
{
    go_straight(path, m, m->rank * m->scenario->target.spacing_m);
}

static void go_across(struct trajectory *path, const struct member *m)
{
    const double half_m = m->axis.length_m / 2, angle = m->rank * m->scenario->target.turn_deg * pi / 180;
    const double along_m = half_m * cos(angle), left_m = half_m * sin(angle);
    go(path, place_on(&m->axis, half_m - along_m, -left_m), place_on(&m->axis, half_m + along_m, left_m),
       m->axis.length_m / m->scenario->source.speed_mps);
}

static void go_and_part(struct trajectory *path, const struct member *m)
{
    const double half_m = m->axis.length_m / 2, angle = m->rank * m->scenario->target.turn_deg * pi / 180;
    const double along_m = half_m * cos(angle), left_m = half_m * sin(angle);
    const double near_m = m->rank * m->scenario->target.spacing_m;
    const struct point middle = place_on(&m->axis, half_m, near_m);
    const double duration_s = half_m / m->scenario->source.speed_mps;
    go(path, place_on(&m->axis, half_m - along_m, near_m + left_m), middle, duration_s);
    go(path, middle, place_on(&m->axis, half_m + along_m, near_m + left_m), duration_s);
}

static void go_in_lane(struct trajectory *path, const struct member *m)
{
    static const double shares[] = {0, 1.0 / 6, 2.0 / 6, 4.0 / 6, 5.0 / 6, 1}; /* of the leg */
    const double far_m = m->rank * m->scenario->target.apart_m, near_m = m->rank * m->scenario->target.spacing_m;
    const double left_m[] = {far_m, far_m, near_m, near_m, far_m, far_m};
    const double length_m = m->axis.length_m;
    for (int i = 0; i < 5; i++) {
        go(path, place_on(&m->axis, shares[i] * length_m, left_m[i]),
           place_on(&m->axis, shares[i + 1] * length_m, left_m[i + 1]),
           (shares[i + 1] - shares[i]) * length_m / m->scenario->source.speed_mps);
    }
}

static void go_and_turn(struct trajectory *path, const struct member *m)
{
    const double leg_m = m->axis.length_m / 2, angle = m->scenario->target.turn_deg * pi / 180;
    const double duration_s = leg_m / m->scenario->source.speed_mps;
    double along_m = 0, left_m = m->rank * m->scenario->target.spacing_m;
    for (int64_t i = 0; i <= m->scenario->target.turns; i++) {
        const double heading = i % 2 == 0 ? 0 : angle;
        const double next_m = along_m + leg_m * cos(heading), next_left_m = left_m + leg_m * sin(heading);
        go(path, place_on(&m->axis, along_m, left_m), place_on(&m->axis, next_m, next_left_m), duration_s);
        along_m = next_m;
        left_m = next_left_m;
    }
}

static void go_in_ring(struct trajectory *path, const struct member *m)
{
    const double direction = m->direction_rad + 2 * pi * (double)m->index / (double)m->scenario->target.count;
    const double radius_m = m->scenario->target.spacing_m;
    struct member shifted = *m;
    shifted.axis.from.x_m += radius_m * cos(direction);
    shifted.axis.from.y_m += radius_m * sin(direction);
    go_straight(path, &shifted, 0);
}

static int out_of_memory(char *error, size_t error_size)
{
    snprintf(error, error_size, "out of memory");
    return -1;
}

static int make_formation(struct targets *targets, const struct scenario *scenario, uint64_t seed, char *error,
                          size_t error_size)
{
    static void (*const kinds[])(struct trajectory *, const struct member *) = {go_parallel, go_across,   go_and_part,
                                                                                go_in_lane,  go_and_turn, go_in_ring};
    const size_t legs = 5 > scenario->target.turns + 1 ? 5 : (size_t)scenario->target.turns + 1;
    struct splitmix stream = splitmix_begin(seed, SPLITMIX_TARGETS);
    const double direction_rad = 2 * pi * splitmix_uniform(&stream);
    if (scenario->source.points_count < 2) {
        snprintf(error, error_size, "source.points: %u given, the path needs at least 2",
                 scenario->source.points_count);
        return -1;
    }
    const struct axis axis = axis_of(scenario);
    for (size_t i = 0; i < targets->count; i++) {
        const struct member member = {scenario, axis, (double)i - 0.5 * (double)(targets->count - 1), i, direction_rad};
        targets->list[i].path.legs = calloc(legs, sizeof *targets->list[i].path.legs);
        if (!targets->list[i].path.legs) {
            return out_of_memory(error, error_size);
        }
        kinds[scenario->source.path - PATH_PARALLEL](&targets->list[i].path, &member);
    }
    return 0;
}

/* Anywhere in the field but near its border. */
static struct point draw_place(const struct scenario *scenario, struct splitmix *stream)
{
    const struct scenario_field field = scenario_field(scenario);
    const double margin_m = scenario->sensor.range_m;
    const double x_m = margin_m + (field.width_m - 2 * margin_m) * splitmix_uniform(stream);
    return (struct point){x_m, margin_m + (field.height_m - 2 * margin_m) * splitmix_uniform(stream)};
}

static int make_scattered(struct trajectory *path, const struct scenario *scenario, uint64_t seed, char *error,
                          size_t error_size)
{
    const size_t steps = scenario_steps(scenario);
    const double interval_s = scenario->sensor.interval_s;
    struct splitmix stream = splitmix_begin(seed, SPLITMIX_TARGETS);
    *path = (struct trajectory){calloc(steps + 1, sizeof *path->legs), steps + 1, (double)steps * interval_s};
    if (!path->legs) {
        return out_of_memory(error, error_size);
    }
    for (size_t n = 0; n <= steps; n++) {
        const double half_s = n > 0 ? interval_s / 2 : 0; /* it is there around the instant */
        path->legs[n] = (struct leg){.start_s = (double)n * interval_s - half_s,
                                     .duration_s = interval_s / 2 + half_s,
                                     .start = draw_place(scenario, &stream)};
    }
    return 0;
}

/* `stream` is that of all targets. */
static int wander(struct trajectory *path, const struct scenario *scenario, struct splitmix *stream)
{
    size_t capacity = 0;
    struct point at = draw_place(scenario, stream);
    while (path->duration_s < scenario->source.duration_s) {
        if (path->count == capacity) {
            capacity = capacity ? 2 * capacity : 16;
            struct leg *larger = realloc(path->legs, capacity * sizeof *larger);
            if (!larger) {
                return -1;
            }
            path->legs = larger;
        }
        const struct point to = draw_place(scenario, stream);
        const double speed_mps = scenario->source.speed_mps;
        const double way_m = hypot(to.x_m - at.x_m, to.y_m - at.y_m);
        const double left_m = (scenario->source.duration_s - path->duration_s) * speed_mps;
        const double share = fmin(left_m / way_m, 1);
        if (way_m > 0) {
            go(path, at, (struct point){at.x_m + share * (to.x_m - at.x_m), at.y_m + share * (to.y_m - at.y_m)},
               share < 1 ? scenario->source.duration_s - path->duration_s : way_m / speed_mps);
        }
        at = to;
    }
    path->duration_s = scenario->source.duration_s;
    return 0;
}

static int make_random(struct targets *targets, const struct scenario *scenario, uint64_t seed, char *error,
                       size_t error_size)
{
    struct splitmix stream = splitmix_begin(seed, SPLITMIX_TARGETS);
    for (size_t i = 0; i < targets->count; i++) {
        if (wander(&targets->list[i].path, scenario, &stream) != 0) {
            return out_of_memory(error, error_size);
        }
    }
    return 0;
}

static int make_scripted(struct targets *targets, const struct scenario *scenario, uint64_t seed, char *error,
                         size_t error_size)
{
    for (size_t i = 0; i < targets->count; i++) {
        const struct scripted_target *script = &scenario->targets[i];
        struct scenario alone = *scenario; /* what it points to is only read */
        alone.source.path = script->points_count > 1 ? PATH_WAYPOINTS : PATH_STILL;
        alone.source.points = script->points;
        alone.source.points_count = script->points_count;
        alone.source.speed_mps = script->speed_mps;
        targets->list[i].start_s += script->start_s;
        targets->list[i].loudness = script->loudness;
        if (trajectory_make(&targets->list[i].path, &alone, seed, error, error_size)) {
            return -1;
        }
    }
    return 0;
}

static int make_paths(struct targets *targets, const struct scenario *scenario, uint64_t seed, char *error,
                      size_t error_size)
{
    switch (scenario->source.path) {
    case PATH_SCRIPTED:
        return make_scripted(targets, scenario, seed, error, error_size);
    case PATH_RANDOM:
        return make_random(targets, scenario, seed, error, error_size);
    case PATH_SCATTERED:
        return make_scattered(&targets->list[0].path, scenario, seed, error, error_size);
    default:
        return targets_are_several(scenario->source.path)
                   ? make_formation(targets, scenario, seed, error, error_size)
                   : trajectory_make(&targets->list[0].path, scenario, seed, error, error_size);
    }
}

int targets_make(struct targets *targets, const struct scenario *scenario, uint64_t seed, char *error,
                 size_t error_size)
{
    const enum path_kind path = scenario->source.path;
    *targets = (struct targets){.count = path == PATH_NONE           ? 0
                                         : path == PATH_SCRIPTED     ? scenario->targets_count
                                         : targets_are_several(path) ? (size_t)scenario->target.count
                                                                     : 1};
    targets->list = calloc(targets->count + 1, sizeof *targets->list);
    if (!targets->list) {
        return out_of_memory(error, error_size);
    }
    for (size_t i = 0; i < targets->count; i++) {
        targets->list[i].loudness = scenario->source.loudness;
        targets->list[i].start_s = targets_are_several(path) ? scenario->source.start_s : 0;
    }
    if (targets->count > 0 && make_paths(targets, scenario, seed, error, error_size)) {
        targets_free(targets);
        return -1;
    }
    for (size_t i = 0; i < targets->count; i++) {
        const struct target *target = &targets->list[i];
        targets->duration_s = fmax(targets->duration_s, target->start_s + target->path.duration_s);
    }
    return 0;
}

void targets_free(struct targets *targets)
{
    for (size_t i = 0; targets->list && i < targets->count; i++) {
        trajectory_free(&targets->list[i].path);
    }
    free(targets->list);
    *targets = (struct targets){0};
}

struct target_state targets_at(const struct targets *targets, size_t target, double time_s)
{
    const struct trajectory *path = &targets->list[target].path;
    const double elapsed_s = time_s - targets->list[target].start_s;
    if (path->count == 0 || elapsed_s < 0 || elapsed_s > path->duration_s) {
        return (struct target_state){0};
    }
    return (struct target_state){true, trajectory_position(path, elapsed_s), trajectory_velocity(path, elapsed_s)};
}
