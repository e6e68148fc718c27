#include "world/field.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

static const double pi = 3.141592653589793;

/* exp(-45) = 3e-20: with the largest kernels of Eq. (2) still nine digits below 1e-9 g/m2. */
static const double largest_exponent = 45;
static const double smallest_distance_m = 1e-3;

/* Width of a panel in u = sqrt(age): the smaller of these, see field.h. Measured, the integral is then good to 2e-12; panels a third wider
 * would still do. */
static const double share_of_u = 0.4;
static const double widths_of_trace = 1.1; /* times sqrt(D) / v */

/* Gauss-Legendre, 16 points on [-1, 1]: the positive half. */
static const double node[FIELD_PANEL_POINTS / 2] = {0.095012509837637441, 0.28160355077925892, 0.45801677765722737,
                                                    0.61787624440264377,  0.755404408355003,   0.86563120238783176,
                                                    0.9445750230732326,   0.98940093499164994};
static const double node_weight[FIELD_PANEL_POINTS / 2] = {
    0.1894506104550685,  0.18260341504492358,  0.16915651939500254,  0.14959598881657674,
    0.12462897125553388, 0.095158511682492786, 0.062253523938647894, 0.027152459411754096};

int field_make(struct field *field, const struct scenario *scenario, uint64_t seed, char *error, size_t error_size)
{
    *field = (struct field){.diffusion_m2ps = scenario->source.diffusion_m2ps,
                            .release_gps = scenario->source.release_gps,
                            .release_variation = scenario->source.release_variation,
                            .release_period_s = scenario->source.release_period_s};
    if (!(field->diffusion_m2ps > 0)) {
        snprintf(error, error_size, "source.diffusion_m2ps: %g, expected above 0", field->diffusion_m2ps);
        return -1;
    }
    if (field->release_variation != 0 && !(field->release_period_s > 0)) {
        snprintf(error, error_size, "source.release_period_s: %g, expected above 0", field->release_period_s);
        return -1;
    }
    return trajectory_make(&field->trajectory, scenario, seed, error, error_size);
}

void field_free(struct field *field)
{
    trajectory_free(&field->trajectory);
    free(field->panels);
    *field = (struct field){0};
}

static double release(const struct field *field, double time_s)
{
    if (field->release_variation == 0) {
        return field->release_gps;
    }
    return field->release_gps * (1 + field->release_variation * sin(2 * pi * time_s / field->release_period_s));
}

static struct field_panel *new_panel(struct field *field)
{
    if (field->count == field->capacity) {
        const size_t capacity = field->capacity ? 2 * field->capacity : 64;
        struct field_panel *panels = realloc(field->panels, capacity * sizeof *panels);
        if (!panels) {
            return NULL;
        }
        field->panels = panels;
        field->capacity = capacity;
    }
    return &field->panels[field->count++];
}

static double square(double a) { return a * a; }

/* The release on `leg` at ages u_young^2 to u_old^2; `way_since` is the length of the path from the older end to now. */
static void lay_panel(const struct field *field, struct field_panel *panel, const struct leg *leg, double time_s,
                      double u_young, double u_old, double way_since)
{
    const double d = field->diffusion_m2ps;
    const double middle = 0.5 * (u_old + u_young), half = 0.5 * (u_old - u_young);
    for (int i = 0; i < FIELD_PANEL_POINTS; i++) {
        const int pair = i / 2;
        const double u = middle + (i % 2 ? half : -half) * node[pair];
        const double tau = time_s - u * u;
        const struct point p = leg_position(leg, tau - leg->start_s);
        panel->x[i] = p.x_m;
        panel->y[i] = p.y_m;
        panel->rate[i] = 1 / (4 * d * u * u);
        panel->weight[i] =
            release(field, tau) / (4 * pi * d) * (2 / u) * half * node_weight[pair]; /* ds / s = 2 du / u */
    }
    const double age_old = u_old * u_old, age_young = u_young * u_young;
    const double felt = sqrt(largest_exponent * 4 * d * age_old);
    const struct point centre = leg_position(leg, time_s - 0.5 * (age_old + age_young) - leg->start_s);
    panel->middle_x = centre.x_m;
    panel->middle_y = centre.y_m;
    panel->reach_sq = square(felt + 0.5 * leg->speed_mps * (age_old - age_young));
    panel->younger_reach_sq = square(felt + way_since);
}

int field_prepare(struct field *field, double time_s)
{
    const double d = field->diffusion_m2ps;
    const double youngest_u = smallest_distance_m / sqrt(4 * d * largest_exponent);
    double way_since = 0;
    for (size_t i = 0; i < field->trajectory.count; i++) {
        const struct leg *leg = &field->trajectory.legs[i];
        way_since += leg->speed_mps * fmin(fmax(time_s - leg->start_s, 0), leg->duration_s);
    }
    field->count = 0;
    field->source = trajectory_position(&field->trajectory, time_s);
    for (size_t i = 0; i < field->trajectory.count; i++) {
        const struct leg *leg = &field->trajectory.legs[i];
        if (time_s <= leg->start_s) {
            break;
        }
        const double trace = leg->speed_mps > 0 ? widths_of_trace * sqrt(d) / leg->speed_mps : HUGE_VAL;
        const double end_u = fmax(youngest_u, sqrt(fmax(time_s - leg->start_s - leg->duration_s, 0)));
        double u = sqrt(time_s - leg->start_s);
        while (u > end_u) {
            double next = fmax(u - fmin(share_of_u * u, trace), end_u);
            if (field->release_variation != 0) {
                next = fmax(next, sqrt(fmax(u * u - 0.5 * field->release_period_s, 0)));
            }
            struct field_panel *panel = new_panel(field);
            if (!panel) {
                return -1;
            }
            lay_panel(field, panel, leg, time_s, next, u, way_since);
            way_since -= leg->speed_mps * (u * u - next * next);
            u = next;
        }
    }
    return 0;
}

double field_concentration(const struct field *field, double x_m, double y_m)
{
    const double from_source_sq = square(x_m - field->source.x_m) + square(y_m - field->source.y_m);
    double sum = 0;
    for (size_t k = 0; k < field->count; k++) {
        const struct field_panel *panel = &field->panels[k];
        if (from_source_sq > panel->younger_reach_sq) {
            break;
        }
        if (square(x_m - panel->middle_x) + square(y_m - panel->middle_y) > panel->reach_sq) {
            continue;
        }
        for (int i = 0; i < FIELD_PANEL_POINTS; i++) {
            sum += panel->weight[i] * exp(-(square(x_m - panel->x[i]) + square(y_m - panel->y[i])) * panel->rate[i]);
        }
    }
    return sum;
}
