#include "record/search.h"

#include "bounds/leak.h"
#include "motehound/estimate.h"

#include <math.h>

static const double near_m = 10;

static double error_of(const motehound_track_t *track)
{
    return hypot(track->x_m - track->true_x_m, track->y_m - track->true_y_m);
}

static bool is_calm(const struct recorder *recorder, int64_t calm)
{
    const size_t count = recorder->track_count;
    bool all = (int64_t)count >= calm;
    for (size_t i = 0; all && i < (size_t)calm; i++) {
        all = (recorder->tracks[count - 1 - i].flags & MH_ESTIMATE_CALM) != 0;
    }
    return all;
}

static size_t find_node(const struct recorder *recorder, int32_t id)
{
    size_t i = 0;
    while (i < recorder->node_count && recorder->nodes[i].node != id) {
        i++;
    }
    return i;
}

/* Entry `k` of the list is the first of its node. */
static bool is_new(const struct recorder *recorder, size_t k)
{
    size_t i = 0;
    while (recorder->heard[i].node != recorder->heard[k].node) {
        i++;
    }
    return i == k;
}

/* Go through the estimates with what was heard for each of them. */
static void follow(const struct recorder *recorder, const struct scenario *scenario, struct search *search)
{
    const struct gas gas = gas_of(scenario, 0);
    const struct scenario_prior prior = scenario_prior(scenario);
    struct leak_information information = leak_information_of(&prior);
    size_t next = 0;
    for (size_t i = 0; i < recorder->track_count; i++) {
        const motehound_track_t *track = &recorder->tracks[i];
        const struct point source = {track->true_x_m, track->true_y_m};
        for (; next < recorder->heard_count && recorder->heard[next].track <= i; next++) {
            const size_t node = find_node(recorder, recorder->heard[next].node);
            if (node < recorder->node_count) {
                search->sensors += is_new(recorder, next);
                leak_information_add(&information, &gas, source,
                                     (struct point){recorder->nodes[node].x_m, recorder->nodes[node].y_m});
            }
        }
        const bool near = error_of(track) < near_m;
        if (!near) {
            search->sensors_to_10m = (double)NAN;
        } else if (isnan(search->sensors_to_10m)) {
            search->sensors_to_10m = (double)search->sensors;
        }
    }
    if (gas.noise_ppm > 0) {
        const struct leak_bound bound = leak_bound(&information);
        search->crlb_m = bound.position_m;
        search->rate_crlb = gas.rate_mlps > 0 ? bound.rate / gas.rate_mlps : (double)NAN;
    }
}

struct search search_of(const struct recorder *recorder, const struct scenario *scenario)
{
    const size_t count = recorder->track_count;
    const double none = (double)NAN;
    struct search search = {.converged = is_calm(recorder, scenario->protocol.calm),
                            .error_m = HUGE_VAL,
                            .rate_error = HUGE_VAL,
                            .crlb_m = none,
                            .rate_crlb = none,
                            .heads = count,
                            .sensors_to_10m = none};
    if (count > 0) {
        const motehound_track_t *last = &recorder->tracks[count - 1];
        search.error_m = error_of(last);
        search.rate_error = last->true_rate > 0 ? fabs(last->rate - last->true_rate) / last->true_rate : none;
    }
    follow(recorder, scenario, &search);
    return search;
}
