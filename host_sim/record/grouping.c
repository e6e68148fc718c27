#include "record/grouping.h"

#include "motehound/estimate.h"

#include <math.h>

static const double together_m = 20, apart_m = 30, minute_s = 60;

enum { IDENTIFIERS_MAX = 64, UNKNOWN = -1 };

struct mean {
    double sum;
    size_t count;
};

/* Two targets. */
struct pair {
    bool together, reported; /* truly; in one group */
    bool was_reported;       /* at some time */
    double changed_s;        /* when the report last changed */
    bool merges, splits;     /* truly, and not yet reported ... */
    double since_s;          /* ... since */
};

/* What was last told of a target. */
struct told {
    bool known, grouped;
    int32_t by; /* the identifier of the track */
    int32_t mode;
    double time_s;
};

struct walk {
    const struct recorder *recorder;
    const struct scenario *scenario;
    size_t targets, next;                                           /* of the tracks */
    int32_t identifiers[IDENTIFIERS_MAX], numbers[IDENTIFIERS_MAX]; /* of targets: which is which */
    size_t identifier_count;
    struct told told[TARGETS_MAX];
    struct pair pairs[TARGETS_MAX][TARGETS_MAX]; /* [i][j], i < j */
    bool linked[TARGETS_MAX][TARGETS_MAX];       /* now, by a chain */
    bool present[TARGETS_MAX];
    struct mean extent, merge, split, right;
    size_t mode_changes, spurious;
    double together_s, last_s;
    bool begun;
};

static void add(struct mean *mean, double value)
{
    mean->sum += value;
    mean->count++;
}

static double value_of(const struct mean *mean)
{
    return mean->count > 0 ? mean->sum / (double)mean->count : (double)NAN;
}

static bool is_group(const motehound_track_t *track) { return track->members > 1; }

/* ---- what was reported ---- */

static int number_of(const struct walk *walk, int32_t identifier)
{
    for (size_t i = 0; i < walk->identifier_count; i++) {
        if (walk->identifiers[i] == identifier) {
            return walk->numbers[i];
        }
    }
    return UNKNOWN;
}

static void learn_one(struct walk *walk, int32_t identifier, int32_t number)
{
    if (number >= 0 && (size_t)number < walk->targets && number_of(walk, identifier) == UNKNOWN &&
        walk->identifier_count < IDENTIFIERS_MAX) {
        walk->identifiers[walk->identifier_count] = identifier;
        walk->numbers[walk->identifier_count++] = number;
    }
}

/* In a group of all targets that was found as such it does not matter which is which. */
static void learn(struct walk *walk, const motehound_track_t *track)
{
    if (!is_group(track)) {
        learn_one(walk, track->target, track->number);
    }
    const bool is_all = (size_t)track->members == walk->targets && walk->identifier_count == 0;
    for (int32_t i = 0; is_group(track) && is_all && i < MH_GROUP_MAX && i < track->members; i++) {
        learn_one(walk, track->of[i], i);
    }
}

/* The targets of the track, by number; returns how many are known. */
static size_t numbers_of(const struct walk *walk, const motehound_track_t *track, int numbers[MH_GROUP_MAX])
{
    size_t count = 0;
    const int32_t members = is_group(track) ? track->members : 1;
    for (int32_t i = 0; i < members && i < MH_GROUP_MAX; i++) {
        const int number = number_of(walk, is_group(track) ? track->of[i] : track->target);
        if (number != UNKNOWN) {
            numbers[count++] = number;
        }
    }
    return count;
}

static void judge_extent(struct walk *walk, const motehound_track_t *track, const int numbers[], size_t count)
{
    struct point places[MH_GROUP_MAX], centre = {0};
    double squares = 0;
    if (!is_group(track) || count != (size_t)track->members) {
        return;
    }
    for (size_t i = 0; i < count; i++) {
        (void)truths_at(walk->recorder, (size_t)numbers[i], track->time_s, &places[i]);
        centre.x_m += places[i].x_m / (double)count;
        centre.y_m += places[i].y_m / (double)count;
    }
    for (size_t i = 0; i < count; i++) {
        squares += pow(places[i].x_m - centre.x_m, 2) + pow(places[i].y_m - centre.y_m, 2);
    }
    add(&walk->extent, track->extent_m - sqrt(squares / (double)count));
}

/* Returns true if the mode of a target changes. */
static bool take(struct walk *walk, const motehound_track_t *track)
{
    int numbers[MH_GROUP_MAX];
    bool changes = false;
    learn(walk, track);
    const size_t count = numbers_of(walk, track, numbers);
    judge_extent(walk, track, numbers, count);
    for (size_t i = 0; i < walk->targets; i++) {
        walk->told[i].grouped = walk->told[i].grouped && walk->told[i].by != track->target;
    }
    for (size_t i = 0; i < count; i++) {
        struct told *told = &walk->told[numbers[i]];
        changes = changes || (told->known && told->mode != track->mode);
        *told = (struct told){!(track->flags & MH_ESTIMATE_STARTED), is_group(track), track->target, track->mode,
                              track->time_s};
    }
    return changes;
}

/* ---- what was true ---- */

static double distance_m(const struct walk *walk, size_t i, size_t j, double time_s)
{
    struct point a, b;
    return truths_at(walk->recorder, i, time_s, &a) && truths_at(walk->recorder, j, time_s, &b)
               ? hypot(a.x_m - b.x_m, a.y_m - b.y_m)
               : HUGE_VAL;
}

static struct pair *pair_of(struct walk *walk, size_t i, size_t j)
{
    return i < j ? &walk->pairs[i][j] : &walk->pairs[j][i];
}

static void link_all(struct walk *walk, double time_s)
{
    for (size_t i = 0; i < walk->targets; i++) {
        walk->present[i] = truths_present(walk->recorder, i, time_s);
    }
    for (size_t i = 0; i < walk->targets; i++) {
        for (size_t j = 0; j < walk->targets; j++) {
            const double step_m = i != j && pair_of(walk, i, j)->together ? apart_m : together_m;
            walk->linked[i][j] = walk->present[i] && walk->present[j] && distance_m(walk, i, j, time_s) <= step_m;
        }
    }
    for (size_t k = 0; k < walk->targets; k++) {
        for (size_t i = 0; i < walk->targets; i++) {
            for (size_t j = 0; j < walk->targets; j++) {
                walk->linked[i][j] = walk->linked[i][j] || (walk->linked[i][k] && walk->linked[k][j]);
            }
        }
    }
}

/* ---- both ---- */

/* What is pending of `pair` has come to pass, or never will. */
static void settle(struct walk *walk, struct pair *pair, double until_s)
{
    if (pair->merges || pair->splits) {
        add(pair->merges ? &walk->merge : &walk->split, until_s - pair->since_s);
    }
    pair->merges = pair->splits = false;
}

/* What is true of the pair has changed. What was reported before it was true has a delay below 0. */
static void turn(struct walk *walk, struct pair *pair, bool together, double time_s)
{
    settle(walk, pair, time_s);
    pair->together = together;
    pair->merges = together && walk->begun;
    pair->splits = !together && pair->was_reported;
    pair->since_s = time_s;
    if (pair->reported == together) {
        settle(walk, pair, pair->changed_s);
    }
}

/* Returns true if a group loses one of the two though they are together. */
static bool judge_pair(struct walk *walk, size_t i, size_t j, double time_s)
{
    struct pair *pair = &walk->pairs[i][j];
    const struct told *a = &walk->told[i], *b = &walk->told[j];
    const bool reported = a->grouped && b->grouped && a->by == b->by;
    if (walk->linked[i][j] != pair->together) {
        turn(walk, pair, walk->linked[i][j], time_s);
    }
    if (reported == pair->reported) {
        return false;
    }
    pair->reported = reported;
    pair->was_reported = true;
    pair->changed_s = time_s;
    if (reported ? pair->merges : pair->splits) {
        settle(walk, pair, time_s);
    }
    return !reported && pair->together;
}

static void judge_count(struct walk *walk, double time_s)
{
    const double interval_s = walk->scenario->sensor.interval_s;
    size_t present = 0;
    int64_t followed = 0;
    for (size_t i = 0; i < walk->targets; i++) {
        present += walk->present[i];
    }
    for (size_t i = walk->next; i > 0 && walk->recorder->tracks[i - 1].time_s > time_s - interval_s / 2; i--) {
        const motehound_track_t *track = &walk->recorder->tracks[i - 1];
        followed += is_group(track) ? track->members : 1;
    }
    const double from_s = walk->recorder->first_s + ((double)walk->scenario->metrics.skip_first - 0.5) * interval_s;
    if (walk->scenario->network.ideal && time_s >= from_s) {
        add(&walk->right, followed == (int64_t)present);
    }
}

static void judge_instant(struct walk *walk, double time_s)
{
    bool has_changed = false, has_lost = false, any = false;
    while (walk->next < walk->recorder->track_count && walk->recorder->tracks[walk->next].time_s <= time_s) {
        has_changed |= take(walk, &walk->recorder->tracks[walk->next++]);
    }
    link_all(walk, time_s);
    for (size_t i = 0; i < walk->targets; i++) {
        for (size_t j = i + 1; j < walk->targets; j++) {
            has_lost |= judge_pair(walk, i, j, time_s);
            any |= walk->linked[i][j];
        }
    }
    judge_count(walk, time_s);
    walk->mode_changes += has_changed;
    walk->spurious += has_lost;
    walk->together_s += any && walk->begun ? time_s - walk->last_s : 0;
    walk->last_s = time_s;
    walk->begun = true;
}

static struct grouping judge_end(struct walk *walk)
{
    const double duration_s = walk->recorder->last_s - walk->recorder->first_s, none = (double)NAN;
    bool apart = walk->targets > 0;
    for (size_t i = 0; i < walk->targets; i++) {
        const struct told *told = &walk->told[i];
        apart = apart && told->known && !told->grouped && truths_near_end(walk->recorder, i, told->time_s);
        for (size_t j = i + 1; j < walk->targets; j++) {
            settle(walk, &walk->pairs[i][j], walk->recorder->last_s);
        }
    }
    return (struct grouping){
        .extent_bias_m = value_of(&walk->extent),
        .merge_delay_s = value_of(&walk->merge),
        .split_delay_s = value_of(&walk->split),
        .mode_changes_pmin = duration_s > 0 ? minute_s * (double)walk->mode_changes / duration_s : none,
        .spurious_splits_pmin = walk->together_s > 0 ? minute_s * (double)walk->spurious / walk->together_s : none,
        .count_right = value_of(&walk->right),
        .apart_at_end = apart};
}

struct grouping grouping_of(const struct recorder *recorder, const struct scenario *scenario)
{
    struct walk walk = {.recorder = recorder,
                        .scenario = scenario,
                        .targets = recorder->targets < TARGETS_MAX ? (size_t)recorder->targets : TARGETS_MAX};
    for (size_t i = 0; i < recorder->truth_count; i++) {
        const double time_s = recorder->truths[i].time_s;
        const bool is_last = i + 1 == recorder->truth_count || recorder->truths[i + 1].time_s > time_s;
        if (is_last) {
            judge_instant(&walk, time_s);
        }
    }
    return judge_end(&walk);
}
