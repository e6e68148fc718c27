#include "ideal/prince.h"

#include "motehound/acoustic.h"
#include "motehound/source_count.h"
#include "reals.h"
#include "roster.h"
#include "world/identify.h"
#include "world/sound.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { TRACKS_MAX = 2 * TARGETS_MAX };

static const double known_sd_m = 3, known_sd_mps = 2, together_m = 20;
static const double heard_ranges = 2; /* a few targets are heard so many sensing ranges away */

/* Of one target or group. */
struct track {
    bool live;
    uint32_t target;
    uint32_t near;      /* whom it is to take in, at this instant; 0: nobody */
    struct track *into; /* who has taken it in, at this instant; NULL: nobody */
    void *state;
    struct mh_estimate estimate;       /* of this instant */
    bool told;                         /* there is one */
    uint8_t saved[MH_TRACK_BYTES_MAX]; /* at the instant before; length 0: nothing */
    size_t length;
};

struct run {
    const struct scenario *scenario;
    const struct observer *observer;
    struct deployment deployment;
    struct targets targets;
    struct sound sound;
    struct identify identify;
    struct tracker_choice tracker;
    mh_tick interval;
    bool scattered;
    bool begun[TARGETS_MAX];

    uint64_t sample, samples; /* of those at which a target was there */
    double time_s;
    struct mh_measurement *heard; /* room for every node */
    size_t heard_count;
    uint64_t measurements;
    struct track tracks[TRACKS_MAX];
};

static mh_tick now(const struct run *run) { return (mh_tick)(run->sample * run->interval); }

static const struct mh_tracker *tracker_of(const struct run *run) { return run->tracker.tracker; }

/* ---- what is there ---- */

static bool tell_truths(struct run *run)
{
    bool any = false;
    for (size_t k = 0; k < run->targets.count; k++) {
        const struct target_state state = targets_at(&run->targets, k, run->time_s);
        const struct truth truth = {.time_s = run->time_s,
                                    .x_m = state.at.x_m,
                                    .y_m = state.at.y_m,
                                    .present = state.present,
                                    .vx_mps = state.velocity.x_m,
                                    .vy_mps = state.velocity.y_m,
                                    .target = (uint32_t)k};
        any = any || state.present;
        if (run->observer->truth) {
            run->observer->truth(run->observer->context, &truth);
        }
    }
    return any;
}

static void hear(struct run *run)
{
    run->heard_count = 0;
    for (size_t i = 0; i < run->deployment.count; i++) {
        const struct recorded_node *node = &run->deployment.nodes[i];
        const struct point at = {node->x_m, node->y_m};
        const double y = sound_reading(&run->sound, &run->targets, run->time_s, (uint32_t)i, at);
        if (y >= 1) {
            run->heard[run->heard_count++] = (struct mh_measurement){
                .node = node->id, .place = place_from_metres(at.x_m, at.y_m, 0), .time = now(run), .value = q20_of(y)};
        }
    }
    run->measurements += run->heard_count;
}

/* The node that hears something nearest to `at`; MH_BROADCAST where nobody does. */
static mh_node_id nearest_to(const struct run *run, struct point at)
{
    mh_node_id nearest = MH_BROADCAST;
    double least_m = HUGE_VAL;
    for (size_t i = 0; i < run->heard_count; i++) {
        const struct mh_place *place = &run->heard[i].place;
        const double distance_m = hypot(1e-3 * place->x_mm - at.x_m, 1e-3 * place->y_mm - at.y_m);
        if (distance_m < least_m) {
            least_m = distance_m;
            nearest = run->heard[i].node;
        }
    }
    return nearest;
}

static void tell_estimate(struct run *run, const struct mh_estimate *estimate)
{
    const struct identified identified = identify_estimate(&run->identify, &run->targets, estimate, run->time_s);
    const struct truth truth = {.time_s = run->time_s,
                                .x_m = identified.state.at.x_m,
                                .y_m = identified.state.at.y_m,
                                .present = identified.state.present,
                                .vx_mps = identified.state.velocity.x_m,
                                .vy_mps = identified.state.velocity.y_m,
                                .target = identified.number};
    if (run->observer->estimate) {
        run->observer->estimate(run->observer->context, run->time_s, nearest_to(run, identify_place(estimate)),
                                estimate, &truth, &truth);
    }
}

/* ---- tracks ---- */

static enum mh_status begin_state(struct run *run, void *state)
{
    return tracker_of(run)->init(state, &run->tracker.config, run->interval);
}

/* A track that knows nothing; NULL where there is no room. */
static struct track *add_track(struct run *run, uint32_t target)
{
    struct track *track = run->tracks;
    while (track < run->tracks + TRACKS_MAX && track->live) {
        track++;
    }
    if (track == run->tracks + TRACKS_MAX || begin_state(run, track->state) != MH_OK) {
        return NULL;
    }
    track->live = true;
    track->target = target;
    track->near = 0;
    track->into = NULL;
    track->told = false;
    track->length = 0;
    return track;
}

/* What the track says now, beside its steps. */
static void look_again(struct run *run, struct track *track, const struct mh_estimate *before)
{
    track->told = tracker_of(run)->predict(track->state, now(run), &track->estimate) == MH_OK;
    track->live = track->told;
    track->estimate.measurements = before->measurements;
    track->estimate.flags = (uint16_t)(before->flags | (track->estimate.flags & MH_ESTIMATE_UNRESOLVED));
}

/* New targets that belong together by steps of together_m, by number; their middle and mean velocity. */
struct company {
    size_t members[TARGETS_MAX], count;
    struct point centre, velocity;
};

static struct company company_of(struct run *run, size_t first)
{
    struct company company = {.members = {first}, .count = 1};
    run->begun[first] = true;
    for (size_t i = 0; i < company.count; i++) {
        const struct target_state one = targets_at(&run->targets, company.members[i], run->time_s);
        company.centre.x_m += one.at.x_m;
        company.centre.y_m += one.at.y_m;
        company.velocity.x_m += one.velocity.x_m;
        company.velocity.y_m += one.velocity.y_m;
        for (size_t k = 0; k < run->targets.count && run->scenario->tracker.groups != MH_GROUP_NONE; k++) {
            const struct target_state other = targets_at(&run->targets, k, run->time_s);
            if (!run->begun[k] && other.present &&
                hypot(other.at.x_m - one.at.x_m, other.at.y_m - one.at.y_m) < together_m) {
                run->begun[k] = true;
                company.members[company.count++] = k;
            }
        }
    }
    const double share = 1 / (double)company.count;
    company.centre = (struct point){company.centre.x_m * share, company.centre.y_m * share};
    company.velocity = (struct point){company.velocity.x_m * share, company.velocity.y_m * share};
    return company;
}

/* How many they sound like, and where -> places. */
static uint8_t count_sources(const struct run *run, struct point centre, struct mh_place places[MH_GROUP_MAX])
{
    enum { HEARD_MAX = 64 };
    const struct mh_place origin = place_from_metres(centre.x_m, centre.y_m, 0);
    const struct mh_acoustic_config *config = &run->tracker.config.acoustic;
    const uint32_t reach_mm = (uint32_t)(heard_ranges * 1e3 * (double)config->sensing_range_m);
    struct mh_measurement near[HEARD_MAX];
    struct mh_heard heard[HEARD_MAX];
    struct mh_vec2 found[MH_SOURCES_MAX];
    size_t count = 0;
    uint8_t sources = 0;
    for (size_t i = 0; i < run->heard_count && count < HEARD_MAX; i++) {
        if (mh_place_within(&run->heard[i].place, &origin, reach_mm)) {
            near[count++] = run->heard[i];
        }
    }
    count = mh_strongest(near, count, &origin, heard, HEARD_MAX);
    if (mh_source_count(&config->sound, heard, count, MH_GROUP_MAX, found, &sources) != MH_OK) {
        return 0;
    }
    for (uint8_t i = 0; i < sources; i++) {
        places[i] = mh_place_from_offset(&origin, found[i]);
    }
    return sources;
}

static void begin_tracks(struct run *run, const struct company *company)
{
    static const struct mh_estimate nothing = {.flags = MH_ESTIMATE_STARTED};
    struct mh_place places[MH_GROUP_MAX] = {place_from_metres(company->centre.x_m, company->centre.y_m, 0)};
    const uint8_t count = company->count > 1 ? count_sources(run, company->centre, places) : 1;
    const struct mh_vec2 velocity = {real_of(company->velocity.x_m), real_of(company->velocity.y_m)};
    struct track *track = count > 0 ? add_track(run, (uint32_t)company->members[0] + 1) : NULL;
    if (track == NULL) {
        return;
    }
    if (count > 1) {
        (void)mh_acoustic_begin_group(track->state, track->target, now(run), places, count, velocity,
                                      real_of(known_sd_m), real_of(known_sd_mps));
    } else {
        (void)mh_acoustic_begin(track->state, track->target, now(run), &places[0], velocity, real_of(known_sd_m),
                                real_of(known_sd_mps));
    }
    look_again(run, track, &nothing);
}

static void begin_targets(struct run *run)
{
    for (size_t k = 0; k < run->targets.count; k++) {
        if (!run->begun[k] && targets_at(&run->targets, k, run->time_s).present) {
            const struct company company = company_of(run, k);
            begin_tracks(run, &company);
        }
    }
}

static void save_all(struct run *run)
{
    for (size_t i = 0; i < TRACKS_MAX; i++) {
        struct track *track = &run->tracks[i];
        if (!track->live || tracker_of(run)->save(track->state, track->saved, &track->length) != MH_OK) {
            track->length = 0;
        }
    }
}

static void step(struct run *run, struct track *track)
{
    struct mh_saved_track others[TRACKS_MAX];
    size_t count = 0;
    for (size_t i = 0; i < TRACKS_MAX; i++) {
        const struct track *other = &run->tracks[i];
        if (other != track && other->live && other->length > 0) {
            others[count++] = (struct mh_saved_track){other->target, other->saved, other->length};
        }
    }
    (void)tracker_of(run)->among(track->state, track->target, others, count);
    track->told =
        tracker_of(run)->step(track->state, now(run), run->heard, run->heard_count, &track->estimate) == MH_OK;
    track->live = track->told;
    track->near = track->told && (track->estimate.flags & MH_ESTIMATE_MERGE) ? track->estimate.near : 0;
}

static void split(struct run *run, struct track *whole)
{
    const struct mh_estimate before = whole->estimate;
    whole->near = 0;
    uint32_t target;
    uint8_t bytes[MH_TRACK_BYTES_MAX];
    size_t length;
    for (uint8_t i = 0; tracker_of(run)->part(whole->state, i, &target, bytes, &length) == MH_OK; i++) {
        struct track *part = add_track(run, target);
        if (part != NULL) {
            (void)tracker_of(run)->among(part->state, target, NULL, 0);
            (void)tracker_of(run)->load(part->state, bytes, length);
            look_again(run, part, &before);
            part->estimate.flags &= (uint16_t)~MH_ESTIMATE_SPLIT; /* it is done */
        }
    }
    whole->live = false;
}

/* Who has the track now. */
static struct track *carrier_of(struct track *track)
{
    while (track->into != NULL) {
        track = track->into;
    }
    return track->live ? track : NULL;
}

static struct track *find_carrier(struct run *run, uint32_t target)
{
    for (size_t i = 0; i < TRACKS_MAX; i++) {
        struct track *track = &run->tracks[i];
        if (track->target == target && (track->live || track->into != NULL)) {
            return carrier_of(track);
        }
    }
    return NULL;
}

static void join(struct run *run, struct track *track, struct track *near)
{
    const struct mh_estimate before = track->estimate;
    uint8_t bytes[MH_TRACK_BYTES_MAX];
    size_t length;
    if (tracker_of(run)->save(near->state, bytes, &length) != MH_OK) {
        return;
    }
    const struct mh_saved_track saved = {near->target, bytes, length};
    if (tracker_of(run)->join(track->state, &saved) == MH_OK) {
        look_again(run, track, &before);
        near->live = false;
        near->into = track;
    }
}

/* Those that come together at one instant do so though each says it of the next one only. */
static void join_all(struct run *run)
{
    for (size_t i = 0; i < TRACKS_MAX; i++) {
        struct track *track = run->tracks[i].near != 0 ? carrier_of(&run->tracks[i]) : NULL;
        struct track *near = track != NULL ? find_carrier(run, run->tracks[i].near) : NULL;
        if (near != NULL && near != track) {
            join(run, track, near);
        }
    }
    for (size_t i = 0; i < TRACKS_MAX; i++) {
        struct track *track = &run->tracks[i];
        track->target = track->live ? track->estimate.target : 0;
        track->near = 0;
        track->into = NULL;
    }
}

static void follow(struct run *run)
{
    save_all(run);
    for (size_t i = 0; i < TRACKS_MAX; i++) {
        if (run->tracks[i].live) {
            step(run, &run->tracks[i]);
        }
    }
    for (size_t i = 0; i < TRACKS_MAX; i++) {
        if (run->tracks[i].live && (run->tracks[i].estimate.flags & MH_ESTIMATE_SPLIT)) {
            split(run, &run->tracks[i]);
        }
    }
    join_all(run);
    begin_targets(run);
    for (size_t i = 0; i < TRACKS_MAX; i++) {
        if (run->tracks[i].live && run->tracks[i].told) {
            tell_estimate(run, &run->tracks[i].estimate);
        }
    }
}

/* One fix, by a tracker that knows nothing. */
static void fix(struct run *run)
{
    struct track *track = &run->tracks[0];
    if (begin_state(run, track->state) == MH_OK &&
        tracker_of(run)->step(track->state, now(run), run->heard, run->heard_count, &track->estimate) == MH_OK) {
        const struct target_state state = targets_at(&run->targets, 0, run->time_s);
        const struct truth truth = {
            .time_s = run->time_s, .x_m = state.at.x_m, .y_m = state.at.y_m, .present = state.present};
        if (run->observer->estimate) {
            run->observer->estimate(run->observer->context, run->time_s, nearest_to(run, state.at), &track->estimate,
                                    &truth, &truth);
        }
    }
}

/* ---- the run ---- */

static int make_world(struct run *run, uint64_t seed, char *error, size_t error_size)
{
    const struct scenario *scenario = run->scenario;
    const struct scenario_field field = scenario_field(scenario);
    const struct mh_place corner = place_from_metres(field.width_m, field.height_m, 0);
    const struct mh_region region = {0, corner.x_mm, 0, corner.y_mm};
    run->sound = sound_of(scenario, seed);
    run->identify.range_m = scenario->sensor.range_m;
    run->interval = (mh_tick)llround(scenario->sensor.interval_s * MH_TICKS_PER_S);
    run->scattered = scenario->source.path == PATH_SCATTERED;
    if (deployment_make(&run->deployment, scenario, seed, error, error_size) ||
        targets_make(&run->targets, scenario, seed, error, error_size) ||
        tracker_choose(scenario, &region, &run->tracker, error, error_size)) {
        return -1;
    }
    if (run->tracker.measures != QUANTITY_SOUND || (!run->scattered && !tracker_of(run)->among)) {
        snprintf(error, error_size, "tracker.name: `%s`, expected acoustic, dm or ml for targets that are heard",
                 tracker_of(run)->name);
        return -1;
    }
    snprintf(error, error_size, "out of memory");
    run->heard = calloc(run->deployment.count, sizeof *run->heard);
    bool sound = run->heard != NULL;
    for (size_t i = 0; i < TRACKS_MAX; i++) {
        run->tracks[i].state = malloc(tracker_of(run)->state_size);
        sound = sound && run->tracks[i].state != NULL;
    }
    if (sound && begin_state(run, run->tracks[0].state) != MH_OK) {
        snprintf(error, error_size, "tracker %s: a setting is outside its range", tracker_of(run)->name);
        return -1;
    }
    return sound ? 0 : -1;
}

static void free_world(struct run *run)
{
    for (size_t i = 0; i < TRACKS_MAX; i++) {
        free(run->tracks[i].state);
    }
    free(run->heard);
    targets_free(&run->targets);
    deployment_free(&run->deployment);
}

static void tell_nodes(const struct run *run)
{
    for (size_t i = 0; run->observer->node && i < run->deployment.count; i++) {
        const struct recorded_node *node = &run->deployment.nodes[i];
        const struct mh_place place = place_from_metres(node->x_m, node->y_m, node->z_m);
        run->observer->node(run->observer->context, node->id, &place);
    }
}

static int run_samples(struct run *run, const volatile sig_atomic_t *stop, char *error, size_t error_size)
{
    const uint64_t last = (uint64_t)(run->targets.duration_s / run->scenario->sensor.interval_s + 1e-6);
    tell_nodes(run);
    for (run->sample = 0; run->sample <= last; run->sample++) {
        if (stop && *stop) {
            snprintf(error, error_size, "stopped");
            return -1;
        }
        run->time_s = (double)run->sample * run->scenario->sensor.interval_s;
        run->samples += tell_truths(run);
        hear(run);
        if (run->scattered) {
            fix(run);
        } else {
            follow(run);
        }
    }
    return 0;
}

int ideal_prince_run(const struct scenario *scenario, uint64_t seed, const struct observer *observer,
                     const volatile sig_atomic_t *stop, struct simulation_counters *counters, char *error,
                     size_t error_size)
{
    struct run *run = calloc(1, sizeof *run);
    if (run == NULL) {
        snprintf(error, error_size, "out of memory");
        return -1;
    }
    run->scenario = scenario;
    run->observer = observer;
    int result = make_world(run, seed, error, error_size);
    if (result == 0) {
        result = run_samples(run, stop, error, error_size);
    }
    if (result == 0) {
        const double none = (double)NAN;
        *counters = (struct simulation_counters){.samples = run->samples,
                                                 .head.measurements = (uint32_t)run->measurements,
                                                 .energy = energy_total_unknown(),
                                                 .clock_error_median_ms = none,
                                                 .clock_error_p99_ms = none,
                                                 .clock_known_share = none};
    }
    free_world(run);
    free(run);
    return result;
}
