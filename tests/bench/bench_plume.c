/* What a head knows of a leak from its plume: a grid of places searched with 9 samples (BENCH_PLUME_SEARCH), and where the wind is measured a sensor's background followed and its reading taken for 5 places
 * and 3 directions of the wind, then the likeliest place (BENCH_PLUME_REGRESSION). */
#include "bench.h"
#include "leaking.h"
#include "motehound/background.h"
#include "motehound/plume_regression.h"
#include "motehound/plume_search.h"

enum { PLACES = 5, PLUMES = 3 };

static struct mh_measurement measurements[LEAKING_MEASUREMENTS];
static struct mh_vec2 places[LEAKING_MEASUREMENTS];
static struct mh_gas_config config;
static enum mh_status status;

#ifdef BENCH_PLUME_SEARCH
struct mh_plume_search bench_state;
static mh_real weight[LEAKING_MEASUREMENTS], gains[LEAKING_MEASUREMENTS];
#else
struct {
    struct mh_plume_regression regression;
    struct mh_background background;
} bench_state;
static struct mh_plume_share plumes[PLUMES];
#endif
static mh_real z[LEAKING_MEASUREMENTS];

void bench_setup(void)
{
    leaking_config(&config);
#ifndef BENCH_PLUME_SEARCH
    mh_plume_regression_init(&bench_state.regression);
#endif
}

void bench_prepare(unsigned step)
{
    static const struct mh_place origin = {0, 0, 0};
    leaking_measurements(step, 30, measurements);
    for (int i = 0; i < LEAKING_MEASUREMENTS; i++) {
        places[i] = mh_place_relative(&measurements[i].place, &origin);
        z[i] = mh_q20_to_real(measurements[i].value);
#ifdef BENCH_PLUME_SEARCH
        weight[i] = 100;
#endif
    }
}

#ifdef BENCH_PLUME_SEARCH

void bench_step(void)
{
    const struct mh_plume_problem problem = {.plume = &config.plume,
                                             .low = {0, 0},
                                             .high = {500, 400},
                                             .prior = {250, 200, 3.4f},
                                             .variance = {22500, 14400, 0.3f},
                                             .count = LEAKING_MEASUREMENTS,
                                             .places = places,
                                             .z = z,
                                             .weight = weight,
                                             .scale = 1 / config.unit};
    status = mh_plume_search(&problem, gains, &bench_state);
}

bool bench_worked(void) { return status == MH_OK && bench_state.starts > 0; }

#else

void bench_step(void)
{
    static const struct mh_background_config background = {0.1f, 0.01f};
    static const struct mh_vec2 candidates[PLACES] = {{50, 200}, {60, 100}, {100, 300}, {200, 200}, {20, 20}};
    struct mh_plume_fit fit;
    mh_real excess;
    for (int i = 0; i < PLUMES; i++) {
        plumes[i].plume = config.plume;
        plumes[i].share = 1.0f / PLUMES;
    }
    mh_background_take(&bench_state.background, &background, z[0], &excess);
    status = mh_plume_regression_take(&bench_state.regression, candidates, PLACES, plumes, PLUMES, places[0], z[0]);
    if (status == MH_OK) {
        status = mh_plume_regression_solve(&bench_state.regression, candidates, PLACES, 10, &fit);
    }
}

bool bench_worked(void) { return status == MH_OK; }

#endif
