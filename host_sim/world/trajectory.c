#include "world/trajectory.h"

#include "world/accelerated.h"
#include "world/mobility.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double pi = 3.141592653589793;

struct point leg_position(const struct leg *leg, double elapsed_s)
{
    const double way = leg->speed_mps * elapsed_s;
    /* A chord of an arc: its length is way sinc(turn / 2), its direction half the turn on from the heading. */
    const double half_turn = 0.5 * leg->curvature_radpm * way;
    const double chord = half_turn == 0 ? way : way * sin(half_turn) / half_turn;
    const double direction = leg->heading_rad + half_turn;
    const double half_square = elapsed_s * elapsed_s / 2;
    return (struct point){leg->start.x_m + chord * cos(direction) + leg->acceleration.x_m * half_square,
                          leg->start.y_m + chord * sin(direction) + leg->acceleration.y_m * half_square};
}

/* The last leg that has begun, or the first. */
static const struct leg *leg_at(const struct trajectory *trajectory, double time_s)
{
    size_t first = 0, end = trajectory->count; /* the last leg of [first, end) that has begun */
    while (end - first > 1) {
        const size_t middle = first + (end - first) / 2;
        if (time_s >= trajectory->legs[middle].start_s) {
            first = middle;
        } else {
            end = middle;
        }
    }
    return &trajectory->legs[first];
}

struct point trajectory_position(const struct trajectory *trajectory, double time_s)
{
    const struct leg *leg = leg_at(trajectory, time_s);
    return leg_position(leg, fmin(fmax(time_s - leg->start_s, 0), leg->duration_s));
}

struct point trajectory_velocity(const struct trajectory *trajectory, double time_s)
{
    const struct leg *leg = leg_at(trajectory, time_s);
    const double elapsed_s = time_s - leg->start_s;
    const bool on_its_way = elapsed_s >= 0 && elapsed_s <= leg->duration_s;
    if (!on_its_way) {
        return (struct point){0, 0};
    }
    const double heading_rad = leg->heading_rad + leg->curvature_radpm * leg->speed_mps * elapsed_s;
    return (struct point){leg->speed_mps * cos(heading_rad) + leg->acceleration.x_m * elapsed_s,
                          leg->speed_mps * sin(heading_rad) + leg->acceleration.y_m * elapsed_s};
}

double trajectory_length_m(const struct trajectory *trajectory)
{
    double length = 0;
    for (size_t i = 0; i < trajectory->count; i++) {
        length += trajectory->legs[i].speed_mps * trajectory->legs[i].duration_s;
    }
    return length;
}

static void append(struct trajectory *trajectory, struct leg leg)
{
    leg.start_s = trajectory->duration_s;
    trajectory->legs[trajectory->count++] = leg;
    trajectory->duration_s += leg.duration_s;
}

static void make_waypoints(struct trajectory *trajectory, const struct waypoint *points, unsigned count,
                           double speed_mps)
{
    for (unsigned i = 1; i < count; i++) {
        const double dx = points[i].x_m - points[i - 1].x_m, dy = points[i].y_m - points[i - 1].y_m;
        const double speed = speed_mps * points[i].speed_factor;
        append(trajectory, (struct leg){.duration_s = hypot(dx, dy) / speed,
                                        .speed_mps = speed,
                                        .start = {points[i - 1].x_m, points[i - 1].y_m},
                                        .heading_rad = atan2(dy, dx)});
    }
}

static void make_arcs(struct trajectory *trajectory, const struct waypoint *points, double speed_mps)
{
    const double dx = points[1].x_m - points[0].x_m, dy = points[1].y_m - points[0].y_m;
    const double radius = hypot(dx, dy) / (4 * sin(pi / 4));
    struct leg left = {.duration_s = radius * pi / 2 / speed_mps,
                       .speed_mps = speed_mps,
                       .start = {points[0].x_m, points[0].y_m},
                       .heading_rad = atan2(dy, dx) - pi / 4,
                       .curvature_radpm = 1 / radius};
    struct leg right = left;
    right.start = leg_position(&left, left.duration_s);
    right.heading_rad = left.heading_rad + pi / 2;
    right.curvature_radpm = -1 / radius;
    append(trajectory, left);
    append(trajectory, right);
}

/* The path ends with a place that stays, so that each leg begins exactly where the walk is. */
static int make_walk(struct trajectory *trajectory, const struct scenario *scenario, uint64_t seed, size_t steps)
{
    const struct mobility mobility = mobility_of(scenario);
    struct point *places = malloc((steps + 1) * sizeof *places);
    if (!places) {
        return -1;
    }
    mobility_positions(&mobility, seed, steps, places);
    for (size_t n = 0; n < steps; n++) {
        const double dx = places[n + 1].x_m - places[n].x_m, dy = places[n + 1].y_m - places[n].y_m;
        trajectory->legs[n] = (struct leg){.start_s = (double)n * mobility.interval_s,
                                           .duration_s = mobility.interval_s,
                                           .speed_mps = hypot(dx, dy) / mobility.interval_s,
                                           .start = places[n],
                                           .heading_rad = atan2(dy, dx)};
    }
    trajectory->duration_s = (double)steps * mobility.interval_s;
    trajectory->legs[steps] = (struct leg){.start_s = trajectory->duration_s, .start = places[steps]};
    trajectory->count = steps + 1;
    free(places);
    return 0;
}

/* ... and with one on which it would go on. */
static int make_accelerated(struct trajectory *trajectory, const struct scenario *scenario, uint64_t seed, size_t steps)
{
    const struct accelerated target = accelerated_of(scenario);
    struct accelerated_state *states = malloc((steps + 1) * sizeof *states);
    if (!states) {
        return -1;
    }
    accelerated_states(&target, seed, steps, states);
    for (size_t n = 0; n <= steps; n++) {
        const struct accelerated_state *s = &states[n];
        append(trajectory, (struct leg){.duration_s = n < steps ? target.interval_s : 0,
                                        .speed_mps = hypot(s->velocity.x_m, s->velocity.y_m),
                                        .start = s->at,
                                        .heading_rad = atan2(s->velocity.y_m, s->velocity.x_m),
                                        .acceleration = s->acceleration});
    }
    free(states);
    return 0;
}

int trajectory_make(struct trajectory *trajectory, const struct scenario *scenario, uint64_t seed, char *error,
                    size_t error_size)
{
    const struct waypoint *points = scenario->source.points;
    const unsigned count = scenario->source.points_count;
    const double speed = scenario->source.speed_mps;
    const bool accelerates = scenario->source.path == PATH_WHITE_ACCELERATION;
    const bool walks = accelerates || scenario->source.path == PATH_GAUSS_MARKOV;
    const size_t steps = walks ? scenario_steps(scenario) : 0;
    const unsigned least = walks ? 0 : scenario->source.path == PATH_STILL ? 1 : 2;
    if (count < least) {
        snprintf(error, error_size, "source.points: %u given, the path needs at least %u", count, least);
        return -1;
    }
    if (least == 2 && !(speed > 0)) {
        snprintf(error, error_size, "source.speed_mps: %g, expected a speed above 0", speed);
        return -1;
    }
    for (unsigned i = 1; scenario->source.path == PATH_WAYPOINTS && i < count; i++) {
        if (!(points[i].speed_factor > 0)) {
            snprintf(error, error_size, "source.points[%u]: speed factor %g, expected above 0", i,
                     points[i].speed_factor);
            return -1;
        }
    }
    *trajectory = (struct trajectory){.legs = calloc((walks ? steps : count) + 1, sizeof *trajectory->legs)};
    if (!trajectory->legs ||
        (walks && (accelerates ? make_accelerated : make_walk)(trajectory, scenario, seed, steps) != 0)) {
        trajectory_free(trajectory);
        snprintf(error, error_size, "out of memory");
        return -1;
    }
    switch (scenario->source.path) {
    case PATH_WAYPOINTS:
        make_waypoints(trajectory, points, count, speed);
        break;
    case PATH_ARCS:
        make_arcs(trajectory, points, speed);
        break;
    case PATH_STILL:
        append(trajectory,
               (struct leg){.duration_s = scenario->source.duration_s, .start = {points[0].x_m, points[0].y_m}});
        break;
    case PATH_GAUSS_MARKOV:
    case PATH_WHITE_ACCELERATION:
    default: /* none, or targets.h's */
        break;
    }
    return 0;
}

void trajectory_free(struct trajectory *trajectory)
{
    free(trajectory->legs);
    *trajectory = (struct trajectory){0};
}
