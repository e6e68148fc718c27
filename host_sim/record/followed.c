#include "record/followed.h"

#include "motehound/estimate.h"

#include <math.h>

static const double coalesced_share = 0.5;

enum { NOBODY = -1 };

/* The track of one target so far. */
struct line {
    const motehound_track_t *last; /* NULL: none */
    int with;                      /* the target that it was nearest to ... */
    int64_t since;                 /* ... in so many successive estimates */
    int64_t
        near[TARGETS_MAX]; /* how many it has been so near to the track of each other target that they look like one */
    bool fixed;
    double fix_s; /* time of the last fix */
};

struct walk {
    const struct recorder *recorder;
    const struct scenario *scenario;
    size_t targets;
    struct line lines[TARGETS_MAX];
    struct followed followed;
};

static bool is_group(const motehound_track_t *track) { return track->members > 1; }

static void add_fix(struct walk *walk, size_t number, const motehound_track_t *track)
{
    struct line *line = &walk->lines[number];
    const double reach_m = walk->scenario->metrics.lost_m + (is_group(track) ? track->extent_m : 0);
    struct point place;
    if ((!is_group(track) && track->number != (int32_t)number) || track->measurements == 0 ||
        !truths_at(walk->recorder, number, track->time_s, &place) ||
        hypot(track->x_m - place.x_m, track->y_m - place.y_m) > reach_m) {
        return;
    }
    if (line->fixed) {
        const double gap_m = truths_way_m(walk->recorder, number, line->fix_s, track->time_s);
        walk->followed.longest_gap_m = fmax(walk->followed.longest_gap_m, gap_m);
    }
    line->fixed = true;
    line->fix_s = track->time_s;
}

/* The target that the estimate is nearest to. */
static int nearest_to(const struct walk *walk, const motehound_track_t *track)
{
    int nearest = NOBODY;
    double least_m = HUGE_VAL;
    for (size_t number = 0; number < walk->targets; number++) {
        struct point place;
        if (truths_present(walk->recorder, number, track->time_s) &&
            truths_at(walk->recorder, number, track->time_s, &place) &&
            hypot(track->x_m - place.x_m, track->y_m - place.y_m) < least_m) {
            least_m = hypot(track->x_m - place.x_m, track->y_m - place.y_m);
            nearest = (int)number;
        }
    }
    return nearest;
}

/* `track`, of target `number`, is where that of target `other` is, which it should not be. */
static bool look_like_one(const struct walk *walk, const motehound_track_t *track, size_t number, size_t other)
{
    const motehound_track_t *its = walk->lines[other].last;
    struct point here, there;
    if (!truths_at(walk->recorder, number, track->time_s, &here) ||
        !truths_at(walk->recorder, other, track->time_s, &there)) {
        return false;
    }
    const double later_s = track->time_s - its->time_s;
    const double dx = its->x_m + later_s * its->vx_mps - track->x_m, dy = its->y_m + later_s * its->vy_mps - track->y_m;
    return hypot(dx, dy) < coalesced_share * hypot(here.x_m - there.x_m, here.y_m - there.y_m);
}

static void compare_with_others(struct walk *walk, size_t number, const motehound_track_t *track)
{
    for (size_t other = 0; other < walk->targets; other++) {
        if (other != number && walk->lines[other].last != NULL) {
            int64_t *near = &walk->lines[number].near[other];
            *near = look_like_one(walk, track, number, other) ? *near + 1 : 0;
            walk->followed.coalesced = walk->followed.coalesced || *near >= walk->scenario->metrics.lost_samples;
        }
    }
}

static void add_estimate(struct walk *walk, const motehound_track_t *track)
{
    for (size_t number = 0; number < walk->targets; number++) {
        add_fix(walk, number, track);
    }
    if (is_group(track) || track->number < 0 || (size_t)track->number >= walk->targets) {
        return;
    }
    struct line *line = &walk->lines[track->number];
    const int with = nearest_to(walk, track);
    line->since = line->last != NULL && with == line->with ? line->since + 1 : 1;
    line->with = with;
    compare_with_others(walk, (size_t)track->number, track);
    line->last = track;
}

/* Target `number` has the identifier of another in the end, and the other way round. */
static bool is_exchanged(const struct walk *walk, size_t number)
{
    const struct line *line = &walk->lines[number];
    bool is_followed = false;
    for (size_t other = 0; other < walk->targets; other++) {
        is_followed = is_followed || (walk->lines[other].last != NULL && walk->lines[other].with == (int)number);
    }
    return line->last != NULL && line->with != NOBODY && line->with != (int)number && is_followed &&
           line->since >= walk->scenario->metrics.lost_samples;
}

static void judge_end(struct walk *walk)
{
    struct followed *followed = &walk->followed;
    unsigned exchanged = 0, claimed = 0;
    for (size_t number = 0; number < walk->targets; number++) {
        const struct line *line = &walk->lines[number];
        const bool cannot_tell = line->last != NULL && (line->last->flags & MH_ESTIMATE_UNRESOLVED);
        struct point place;
        if (!truths_at(walk->recorder, number, walk->recorder->last_s, &place)) {
            continue;
        }
        const double since_s = line->fixed ? line->fix_s : walk->recorder->first_s;
        const double gap_m = truths_way_m(walk->recorder, number, since_s, walk->recorder->last_s);
        exchanged += is_exchanged(walk, number);
        claimed += is_exchanged(walk, number) && !cannot_tell;
        followed->unresolved = followed->unresolved || cannot_tell;
        followed->lost = followed->lost || !line->fixed || !truths_near_end(walk->recorder, number, since_s);
        followed->longest_gap_m = fmax(followed->longest_gap_m, gap_m);
    }
    followed->swaps = (exchanged + 1) / 2;
    followed->swaps_claimed = (claimed + 1) / 2;
}

struct followed followed_of(const struct recorder *recorder, const struct scenario *scenario)
{
    struct walk walk = {.recorder = recorder,
                        .scenario = scenario,
                        .targets = recorder->targets < TARGETS_MAX ? (size_t)recorder->targets : TARGETS_MAX,
                        .followed = {.longest_gap_m = (double)NAN}};
    for (size_t i = 0; i < recorder->track_count; i++) {
        add_estimate(&walk, &recorder->tracks[i]);
    }
    judge_end(&walk);
    return walk.followed;
}
