#include "record/metrics.h"

#include "motehound/matrix.h"
#include "record/followed.h"
#include "record/grouping.h"
#include "record/search.h"

#include <math.h>
#include <string.h>

#define NAME(id, name, meaning) name,
#define NAME_OF_TOTAL(id, name, value, meaning) name,
const char *const metric_names[METRIC_COUNT] = {METRICS_OF_ERRORS(NAME) METRICS_OF_TRACK(NAME) TOTALS(NAME_OF_TOTAL)};

#define MEANING(id, name, meaning) meaning,
#define MEANING_OF_TOTAL(id, name, value, meaning) meaning,
const char *const metric_meanings[METRIC_COUNT] = {METRICS_OF_ERRORS(MEANING) METRICS_OF_TRACK(MEANING)
                                                       TOTALS(MEANING_OF_TOTAL)};

static double error_of(const motehound_track_t *track)
{
    return hypot(track->x_m - track->true_x_m, track->y_m - track->true_y_m);
}

/* Something of each track, by its identifier; of those after so many the last one's. */
enum { TALLY_MAX = 32 };
struct tally {
    int32_t targets[TALLY_MAX];
    size_t count;
    int64_t values[TALLY_MAX];
};

static int64_t *tally_of(struct tally *tally, int32_t target)
{
    size_t i = 0;
    while (i < tally->count && tally->targets[i] != target) {
        i++;
    }
    if (i == TALLY_MAX) {
        return &tally->values[TALLY_MAX - 1];
    }
    if (i == tally->count) {
        tally->targets[tally->count++] = target;
    }
    return &tally->values[i];
}

/* e' P^-1 e by elimination; P is packed as motehound/matrix.h says, and overwritten, as e is. NaN unless P is positive definite. */
static double normalised(int n, double *P, double *e)
{
    double sum = 0;
    for (int k = 0; k < n; k++) {
        const double pivot = P[MH_PACKED(k, k)];
        if (!(pivot > 0)) {
            return (double)NAN;
        }
        sum += e[k] * e[k] / pivot;
        for (int j = k + 1; j < n; j++) {
            const double factor = P[MH_PACKED(k, j)] / pivot;
            e[j] -= factor * e[k];
            for (int i = k + 1; i <= j; i++) {
                P[MH_PACKED(i, j)] -= factor * P[MH_PACKED(k, i)];
            }
        }
    }
    return sum;
}

/* Normalised squared error of all states that a covariance is stated of; NaN where there are none. */
static double nees_of(const motehound_track_t *track)
{
    enum { STATES_MAX = 4 };
    double P[MH_PACKED_SIZE(STATES_MAX)] = {track->cov_xx_m2, track->cov_xy_m2, track->cov_yy_m2, track->cov_13,
                                            track->cov_23,    track->cov_33,    track->cov_14,    track->cov_24,
                                            track->cov_34,    track->cov_44};
    double e[STATES_MAX] = {track->x_m - track->true_x_m, track->y_m - track->true_y_m};
    if (track->states == 3) {
        e[2] = track->rate - track->true_rate;
    } else if (track->states == 4) {
        e[2] = track->vx_mps - track->true_vx_mps;
        e[3] = track->vy_mps - track->true_vy_mps;
    } else if (track->states != 2) {
        return (double)NAN;
    }
    return normalised(track->states, P, e);
}

static double claim_of(const motehound_track_t *track)
{
    return track->states > 0 ? track->cov_xx_m2 + track->cov_yy_m2 : (double)NAN;
}

/* NaN is no number to add. Returns 0, or -1 if there is no memory. */
static int add(struct samples *samples, double value) { return isnan(value) ? 0 : samples_add(samples, value); }

/* `square` and `count` at instant `i`. */
static int add_square(struct errors *errors, size_t i, double square, double count)
{
    while (errors->squares.count <= i) {
        if (samples_add(&errors->squares, 0) != 0 || samples_add(&errors->counts, 0) != 0) {
            return -1;
        }
    }
    errors->squares.values[i] += square;
    errors->counts.values[i] += count;
    return 0;
}

static int local_errors_of(const struct recorder *recorder, const struct scenario *scenario, struct errors *errors)
{
    int64_t seen[LOCAL_CLUSTERS] = {0};
    for (size_t i = 0; i < recorder->local_count; i++) {
        const motehound_local_t *local = &recorder->locals[i];
        const int cluster = local->cluster;
        if (cluster < 0 || cluster >= LOCAL_CLUSTERS || seen[cluster]++ < scenario->metrics.skip_first ||
            !local->track.true_known) {
            continue;
        }
        if (samples_add(&errors->local_position[cluster], error_of(&local->track)) != 0 ||
            add(&errors->local_nees[cluster], nees_of(&local->track)) != 0) {
            return -1;
        }
    }
    return 0;
}

/* Of fixed clusters: from sampling instant to sampling instant. */
static int squares_of(const struct recorder *recorder, const struct scenario *scenario, struct errors *errors)
{
    const bool fixed = strcmp(scenario->network.protocol, "fixed") == 0;
    for (size_t i = 0; fixed && i < recorder->track_count; i++) {
        const motehound_track_t *track = &recorder->tracks[i];
        const double instant = round((track->time_s - recorder->first_s) / scenario->sensor.interval_s);
        if (!track->true_known || instant < 0) {
            continue;
        }
        if (add_square(errors, (size_t)instant, pow(error_of(track), 2), 1) != 0) {
            return -1;
        }
        if (i < (size_t)scenario->metrics.skip_first) {
            errors->squares_skipped = (size_t)instant + 1;
        }
    }
    return 0;
}

static const double success_m = 50, close_success_m = 10, largest_ratio = 5;

static bool is_search(const struct scenario *scenario, const motehound_track_t *track)
{
    return scenario->sensor.quantity == QUANTITY_GAS && track->true_known;
}

static int add_track(struct errors *errors, const motehound_track_t *track)
{
    const double nees = nees_of(track);
    const double raw = hypot(track->raw_x_m - track->true_x_m, track->raw_y_m - track->true_y_m);
    const double at_arrival = hypot(track->x_m - track->arrival_x_m, track->y_m - track->arrival_y_m);
    const bool sound = samples_add(&errors->position, error_of(track)) == 0 &&
                       samples_add(track->members > 1 ? &errors->group : &errors->single, error_of(track)) == 0 &&
                       samples_add(&errors->raw_position, raw) == 0 &&
                       (!track->arrival_known || samples_add(&errors->position_at_arrival, at_arrival) == 0) &&
                       add(&errors->nees, nees) == 0 && add(&errors->claimed, claim_of(track)) == 0;
    return sound ? 0 : -1;
}

static int add_search(struct errors *errors, const struct search *search, const motehound_track_t *last)
{
    const double ratio = fmin(search->error_m / search->crlb_m, largest_ratio);
    const bool judged = search->converged && search->error_m < success_m && !isnan(search->crlb_m);
    const bool sound = add_track(errors, last) == 0 && samples_add(&errors->found, search->error_m) == 0 &&
                       add(&errors->rate, search->rate_error) == 0 &&
                       (!judged || samples_add(&errors->efficiency, ratio) == 0);
    return sound ? 0 : -1;
}

bool metric_is_over_runs(enum metric metric)
{
    return metric == METRIC_POSITION_ERROR_MEDIAN_M || metric == METRIC_RATE_ERROR_MEDIAN ||
           metric == METRIC_ERROR_OVER_CRLB || metric == METRIC_NEES_MEDIAN || metric == METRIC_SMSE_M ||
           metric == METRIC_POSITION_RMSE_WORST_M;
}

int errors_of(const struct recorder *recorder, const struct scenario *scenario, struct errors *errors)
{
    struct tally seen = {0};
    const size_t count = recorder->track_count;
    if (count > 0 && is_search(scenario, &recorder->tracks[count - 1])) {
        const struct search search = search_of(recorder, scenario);
        return add_search(errors, &search, &recorder->tracks[count - 1]);
    }
    for (size_t i = 0; i < count; i++) {
        const motehound_track_t *track = &recorder->tracks[i];
        const bool skipped = (*tally_of(&seen, track->target))++ < scenario->metrics.skip_first;
        if (!skipped && track->true_known && add_track(errors, track) != 0) {
            return -1;
        }
    }
    return local_errors_of(recorder, scenario, errors) == 0 && squares_of(recorder, scenario, errors) == 0 ? 0 : -1;
}

int errors_append(struct errors *errors, const struct errors *more)
{
    bool sound =
        samples_append(&errors->position, &more->position) == 0 &&
        samples_append(&errors->single, &more->single) == 0 && samples_append(&errors->group, &more->group) == 0 &&
        samples_append(&errors->raw_position, &more->raw_position) == 0 &&
        samples_append(&errors->position_at_arrival, &more->position_at_arrival) == 0 &&
        samples_append(&errors->found, &more->found) == 0 && samples_append(&errors->rate, &more->rate) == 0 &&
        samples_append(&errors->efficiency, &more->efficiency) == 0 &&
        samples_append(&errors->nees, &more->nees) == 0 && samples_append(&errors->claimed, &more->claimed) == 0;
    for (int c = 0; c < LOCAL_CLUSTERS; c++) {
        sound = sound && samples_append(&errors->local_position[c], &more->local_position[c]) == 0 &&
                samples_append(&errors->local_nees[c], &more->local_nees[c]) == 0;
    }
    for (size_t i = 0; i < more->squares.count; i++) {
        sound = sound && add_square(errors, i, more->squares.values[i], more->counts.values[i]) == 0;
    }
    errors->squares_skipped = more->squares_skipped;
    return sound ? 0 : -1;
}

void errors_free(struct errors *errors)
{
    samples_free(&errors->position);
    samples_free(&errors->single);
    samples_free(&errors->group);
    samples_free(&errors->raw_position);
    samples_free(&errors->position_at_arrival);
    samples_free(&errors->found);
    samples_free(&errors->rate);
    samples_free(&errors->efficiency);
    samples_free(&errors->nees);
    samples_free(&errors->claimed);
    for (int c = 0; c < LOCAL_CLUSTERS; c++) {
        samples_free(&errors->local_position[c]);
        samples_free(&errors->local_nees[c]);
    }
    samples_free(&errors->squares);
    samples_free(&errors->counts);
}

/* The root mean square error of each instant, added up, and the largest one of those that count. NaN for none. */
static void metrics_over_instants(const struct errors *errors, double *sum_m, double *worst_m)
{
    *sum_m = *worst_m = (double)NAN;
    for (size_t i = 0; i < errors->squares.count; i++) {
        if (errors->counts.values[i] > 0) {
            const double rms_m = sqrt(errors->squares.values[i] / errors->counts.values[i]);
            *sum_m = isnan(*sum_m) ? rms_m : *sum_m + rms_m;
            *worst_m = i < errors->squares_skipped ? *worst_m : fmax(*worst_m, rms_m);
        }
    }
}

void metrics_of_errors(struct errors *errors, double values[METRIC_ERRORS_COUNT])
{
    values[METRIC_POSITION_RMSE_M] = samples_rms(&errors->position);
    values[METRIC_POSITION_ERROR_M] = samples_mean(&errors->single);
    values[METRIC_GROUP_CENTROID_ERROR_M] = samples_mean(&errors->group);
    values[METRIC_POSITION_MEDIAN_M] = samples_quantile(&errors->position, 0.5);
    values[METRIC_POSITION_P95_M] = samples_quantile(&errors->position, 0.95);
    values[METRIC_RAW_POSITION_RMSE_M] = samples_rms(&errors->raw_position);
    values[METRIC_POSITION_RMSE_AT_ARRIVAL_M] = samples_rms(&errors->position_at_arrival);
    values[METRIC_POSITION_ERROR_MEDIAN_M] = samples_quantile(&errors->found, 0.5);
    values[METRIC_RATE_ERROR_MEDIAN] = samples_quantile(&errors->rate, 0.5);
    values[METRIC_ERROR_OVER_CRLB] = samples_rms(&errors->efficiency);
    values[METRIC_NEES_MEDIAN] = samples_quantile(&errors->nees, 0.5);
    values[METRIC_ANEES] = samples_mean(&errors->nees);
    const double rmse_m = values[METRIC_POSITION_RMSE_M];
    values[METRIC_CLAIMED_OVER_RMSE] = rmse_m > 0 ? sqrt(samples_mean(&errors->claimed)) / rmse_m : (double)NAN;
    metrics_over_instants(errors, &values[METRIC_SMSE_M], &values[METRIC_POSITION_RMSE_WORST_M]);
    for (int c = 0; c < LOCAL_CLUSTERS; c++) {
        values[METRIC_LOCAL_POSITION_RMSE_M_1 + c] = samples_rms(&errors->local_position[c]);
        values[METRIC_LOCAL_ANEES_1 + c] = samples_mean(&errors->local_nees[c]);
    }
}

static bool lost(const struct recorder *recorder, const struct scenario *scenario)
{
    struct tally seen = {0}, wrong = {0};
    for (size_t i = 0; i < recorder->track_count; i++) {
        const motehound_track_t *track = &recorder->tracks[i];
        if ((*tally_of(&seen, track->target))++ < scenario->metrics.skip_first || !track->true_known) {
            continue;
        }
        int64_t *successive = tally_of(&wrong, track->target);
        *successive = error_of(track) > scenario->metrics.lost_m ? *successive + 1 : 0;
        if (*successive >= scenario->metrics.lost_samples) {
            return true;
        }
    }
    return false;
}

/* Positions with a covariance and a truth, those among them that the covariance covers, and the longest succession of others of a target. */
struct coverage {
    size_t positions, covered, longest;
};

static struct coverage coverage_of(const struct recorder *recorder)
{
    struct coverage coverage = {0, 0, 0};
    struct tally beyond = {0};
    for (size_t i = 0; i < recorder->track_count; i++) {
        const motehound_track_t *track = &recorder->tracks[i];
        const double sd_m = sqrt((track->cov_xx_m2 + track->cov_yy_m2) / 2);
        if (!track->true_known || !(sd_m > 0)) {
            continue;
        }
        const bool covered = error_of(track) <= 3 * sd_m;
        int64_t *succession = tally_of(&beyond, track->target);
        *succession = covered ? 0 : *succession + 1;
        coverage.positions++;
        coverage.covered += covered;
        coverage.longest = (size_t)*succession > coverage.longest ? (size_t)*succession : coverage.longest;
    }
    return coverage;
}

/* Mean error of `tracks` in sensing ranges, from sample number metrics.skip_first on; NaN for none. */
static double error_in_ranges(const motehound_track_t *tracks, size_t count, const struct recorder *recorder,
                              const struct scenario *scenario)
{
    const double from_s =
        recorder->first_s + ((double)scenario->metrics.skip_first - 0.5) * scenario->sensor.interval_s;
    double sum_m = 0;
    size_t counted = 0;
    for (size_t i = 0; i < count; i++) {
        if (tracks[i].true_known && tracks[i].time_s >= from_s) {
            sum_m += error_of(&tracks[i]);
            counted++;
        }
    }
    return counted > 0 ? sum_m / (double)counted / scenario->sensor.range_m : (double)NAN;
}

/* The longest time between positions within `near_m` of the target, from its first sampling instant to its last. */
static double longest_gap_s(const struct recorder *recorder, double near_m)
{
    double longest_s = 0, good_s = recorder->first_s;
    for (size_t i = 0; i < recorder->track_count; i++) {
        const motehound_track_t *track = &recorder->tracks[i];
        if (track->true_known && error_of(track) <= near_m) {
            longest_s = fmax(longest_s, track->time_s - good_s);
            good_s = fmax(good_s, track->time_s);
        }
    }
    return fmax(longest_s, recorder->last_s - good_s);
}

static void metrics_of_search(const struct recorder *recorder, const struct scenario *scenario,
                              double values[METRIC_COUNT])
{
    const struct search search = search_of(recorder, scenario);
    const bool right = search.converged && search.error_m < success_m;
    values[METRIC_SUCCESS_50M] = right;
    values[METRIC_SUCCESS_10M] = right && search.error_m < close_success_m;
    values[METRIC_CONVERGED] = search.converged;
    values[METRIC_CONVERGED_WRONG] = search.converged && !right;
    values[METRIC_HOPS] = (double)search.heads;
    values[METRIC_SENSORS_USED] = (double)search.sensors;
    values[METRIC_SENSORS_TO_10M] = search.sensors_to_10m;
    values[METRIC_CRLB_M] = search.crlb_m;
    values[METRIC_RATE_CRLB] = search.rate_crlb;
}

/* Of targets that are heard, and stay where they are for longer than an instant. */
static void metrics_of_followed(const struct recorder *recorder, const struct scenario *scenario,
                                double values[METRIC_COUNT])
{
    const struct followed followed = followed_of(recorder, scenario);
    const struct grouping grouping = grouping_of(recorder, scenario);
    const bool is_lost = values[METRIC_TRACK_LOST] > 0 || followed.lost;
    values[METRIC_TRACK_LOST] = is_lost;
    values[METRIC_SUCCESS] = !is_lost && followed.swaps == 0 && !followed.coalesced;
    values[METRIC_IDENTITY_SWAPS] = followed.swaps;
    values[METRIC_SWAPS_CLAIMED] = followed.swaps_claimed;
    values[METRIC_UNRESOLVED] = followed.unresolved;
    values[METRIC_LONGEST_GAP_M] = followed.longest_gap_m;
    values[METRIC_MERGE_DELAY_S] = grouping.merge_delay_s;
    values[METRIC_SPLIT_DELAY_S] = grouping.split_delay_s;
    values[METRIC_EXTENT_BIAS_M] = grouping.extent_bias_m;
    values[METRIC_MODE_CHANGES_PER_MIN] = grouping.mode_changes_pmin;
    values[METRIC_SPURIOUS_SPLITS_PER_MIN] = grouping.spurious_splits_pmin;
    values[METRIC_COUNT_RIGHT] = grouping.count_right;
    values[METRIC_APART_AT_END] = grouping.apart_at_end;
}

/* Of the last estimate that there is a truth for. */
static double rate_ratio_of(const struct recorder *recorder)
{
    for (size_t i = recorder->track_count; i > 0; i--) {
        const motehound_track_t *track = &recorder->tracks[i - 1];
        if (track->true_known) {
            return track->rate > 0 && track->true_rate > 0 ? track->rate / track->true_rate : (double)NAN;
        }
    }
    return (double)NAN;
}

void metrics_of_run(const struct recorder *recorder, const struct scenario *scenario, struct errors *errors,
                    double values[METRIC_COUNT])
{
    size_t tracked = 0; /* instants, each once however many targets it has */
    double counted_s = -HUGE_VAL;
    for (size_t i = 0; i < recorder->track_count; i++) {
        const motehound_track_t *track = &recorder->tracks[i];
        if (track->true_known && track->time_s > counted_s) {
            tracked++;
            counted_s = track->time_s;
        }
    }
    const bool truth = recorder->samples > 0;
    const bool follows =
        truth && strcmp(scenario->network.protocol, "token") != 0; /* a search ends when it has found */
    metrics_of_errors(errors, values);
    values[METRIC_TRACKED_SHARE] = follows ? (double)tracked / (double)recorder->samples : (double)NAN;
    values[METRIC_TRACK_LOST] = follows ? lost(recorder, scenario) : (double)NAN;
    const struct coverage coverage = coverage_of(recorder);
    const bool stated = coverage.positions > 0;
    values[METRIC_COVERED_SHARE] = stated ? (double)coverage.covered / (double)coverage.positions : (double)NAN;
    values[METRIC_OVERCONFIDENT_SAMPLES] = stated ? (double)coverage.longest : (double)NAN;
    values[METRIC_ESTIMATES] = (double)recorder->track_count;
    const bool ranged = truth && scenario->sensor.quantity == QUANTITY_RANGE;
    const double none = (double)NAN;
    values[METRIC_LOCALISATION_ERROR_RS] =
        ranged ? error_in_ranges(recorder->tracks, recorder->track_count, recorder, scenario) : none;
    values[METRIC_SINK_ERROR_RS] =
        ranged ? error_in_ranges(recorder->sinks, recorder->sink_count, recorder, scenario) : none;
    const double pcrb_m = recorder->totals[TOTAL_PCRB_M];
    values[METRIC_RMSE_OVER_PCRB] = pcrb_m > 0 ? values[METRIC_POSITION_RMSE_M] / pcrb_m : none;
    const double crlb_m = recorder->totals[TOTAL_FIX_CRLB_M];
    values[METRIC_RMSE_OVER_CRLB] = crlb_m > 0 ? values[METRIC_POSITION_RMSE_M] / crlb_m : none;
    values[METRIC_RATE_RATIO] = rate_ratio_of(recorder);
    values[METRIC_LONGEST_GAP_S] = ranged ? longest_gap_s(recorder, scenario->sensor.range_m) : none;
    for (int i = METRIC_SUCCESS_50M; i <= METRIC_RATE_CRLB; i++) {
        values[i] = none;
    }
    if (truth && scenario->sensor.quantity == QUANTITY_GAS) {
        metrics_of_search(recorder, scenario, values);
    }
    for (int i = METRIC_SUCCESS; i <= METRIC_APART_AT_END; i++) {
        values[i] = none;
    }
    if (truth && scenario->sensor.quantity == QUANTITY_SOUND && scenario->source.path != PATH_SCATTERED) {
        metrics_of_followed(recorder, scenario, values);
    }
    memcpy(&values[METRIC_FIRST_TOTAL], recorder->totals, sizeof recorder->totals);
}
