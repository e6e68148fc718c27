#include "ideal/cluster.h"

#include "ideal/ledger.h"
#include "ideal/messages.h"
#include "ideal/vicinity.h"
#include "motehound/election.h"
#include "motehound/followed.h"
#include "reals.h"
#include "roster.h"
#include "world/ranging.h"
#include "world/trajectory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double guard_ms = 2; /* that who is asked listens for the request */

struct run {
    const struct scenario *scenario;
    const struct observer *observer;
    const struct message_sizes *sizes;
    struct deployment deployment;
    struct vicinity vicinity;
    struct ledger ledger;
    struct trajectory path;
    struct clusters clusters; /* fixed ones, whose nodes have noise of their own */
    struct ranging ranging;
    struct tracker_choice tracker;
    struct mh_election_config election;
    void *state; /* of the tracker, which travels with the head */

    uint64_t sample;
    struct truth truth;
    bool *detects; /* the target, now, each node */
    double *range_m;
    uint32_t *asked; /* nodes ... */
    size_t asked_count;
    size_t far_first; /* from there on those out of the head's range */
    struct mh_measurement *answers;
    size_t answer_count;
    struct mh_candidate *candidates; /* room for every node */

    bool following;
    struct mh_cluster cluster;
    struct mh_followed at_sink;
    struct mh_place sink_origin; /* of what the sink knows */
    struct mh_cluster_counters counters;
};

static mh_tick instant_of(const struct run *run) { return (mh_tick)(run->sample * run->election.interval); }

static uint32_t index_of(const struct run *run, mh_node_id id) { return vicinity_find(&run->vicinity, id); }

static bool has_members_listed(const struct run *run) { return run->election.rule <= MH_ELECTION_RHO; }

/* Who detects the target, and their ranges. Returns their number. */
static size_t sense(struct run *run)
{
    size_t detecting = 0;
    for (uint32_t i = 0; i < run->deployment.count; i++) {
        const struct recorded_node *node = &run->deployment.nodes[i];
        const double dx = node->x_m - run->truth.x_m, dy = node->y_m - run->truth.y_m, dz = node->z_m;
        run->detects[i] =
            ranging_detects(&run->ranging, run->sample, i, sqrt(dx * dx + dy * dy + dz * dz), &run->range_m[i]);
        detecting += run->detects[i];
    }
    return detecting;
}

static void add_asked(struct run *run, uint32_t node) { run->asked[run->asked_count++] = node; }

static bool was_asked(const struct run *run, uint32_t node)
{
    size_t i = 0;
    while (i < run->asked_count && run->asked[i] != node) {
        i++;
    }
    return i < run->asked_count;
}

static size_t count_answers(const struct run *run)
{
    size_t count = 0;
    for (size_t i = 0; i < run->asked_count; i++) {
        count += run->detects[run->asked[i]];
    }
    return count;
}

static int by_node(const void *a, const void *b)
{
    const mh_node_id left = ((const struct mh_measurement *)a)->node, right = ((const struct mh_measurement *)b)->node;
    return (left > right) - (left < right);
}

static void take_answers(struct run *run)
{
    run->answer_count = 0;
    for (size_t i = 0; i < run->asked_count; i++) {
        const uint32_t node = run->asked[i];
        if (run->detects[node]) {
            run->answers[run->answer_count++] = (struct mh_measurement){.node = run->vicinity.id[node],
                                                                        .place = run->vicinity.place[node],
                                                                        .time = instant_of(run),
                                                                        .value = q20_of(run->range_m[node])};
        }
    }
    qsort(run->answers, run->answer_count, sizeof *run->answers, by_node);
    run->counters.asked += (uint32_t)run->asked_count;
    run->counters.answered += (uint32_t)run->answer_count;
}

/* The head's request to asked[first ..], their samples, and the answers of those that detect the target. */
static void charge_request(struct run *run, uint32_t head, size_t first)
{
    struct ledger *ledger = &run->ledger;
    ledger_broadcast(ledger, ENERGY_MEASURING, head, run->asked + first, run->asked_count - first, REQUEST_BYTES);
    for (size_t i = first; i < run->asked_count; i++) {
        const uint32_t node = run->asked[i];
        ledger_charge(ledger, node, ENERGY_LISTEN, ENERGY_MEASURING, guard_ms);
        ledger_sample(ledger, node);
        if (run->detects[node]) {
            ledger_unicast(ledger, ENERGY_MEASURING, node, head, run->sizes->answer);
        }
    }
}

/* By the rules scm* all who detect the target are heard: those out of the head's range by way of others. */
static void ask_beyond(struct run *run, uint32_t head)
{
    const struct mh_place *centre = &run->vicinity.place[head];
    const uint32_t range_mm = (uint32_t)(number_of(run->election.radio_range_m) * 1e3);
    for (uint32_t node = 0; node < run->deployment.count; node++) {
        if (run->detects[node] && !mh_place_within(&run->vicinity.place[node], centre, range_mm)) {
            ledger_unicast(&run->ledger, ENERGY_MEASURING, head, node, REQUEST_BYTES);
            ledger_unicast(&run->ledger, ENERGY_MEASURING, node, head, run->sizes->answer);
            ledger_sample(&run->ledger, node);
            add_asked(run, node);
        }
    }
}

/* Add those of the head's neighbours that the rule asks, or with `all` those that it has left out. */
static void add_neighbours(struct run *run, uint32_t head, const struct mh_place *predicted, bool all)
{
    for (size_t k = run->vicinity.first[head]; k < run->vicinity.first[head + 1]; k++) {
        const uint32_t node = run->vicinity.neighbours[k];
        if (node < run->deployment.count &&
            (all ? !was_asked(run, node)
                 : mh_election_asks(&run->election, &run->cluster, run->vicinity.id[node], &run->vicinity.place[node],
                                    predicted))) {
            add_asked(run, node);
        }
    }
}

/* The head samples and asks, and all who are asked sample; those who detect the target answer. */
static void ask(struct run *run, const struct mh_place *predicted)
{
    const uint32_t head = index_of(run, run->cluster.head.id);
    run->asked_count = 0;
    add_asked(run, head);
    ledger_sense(&run->ledger, head);
    add_neighbours(run, head, predicted, false);
    charge_request(run, head, 1);
    if (mh_election_asks_all(&run->election, count_answers(run))) {
        const size_t before = run->asked_count;
        add_neighbours(run, head, predicted, true);
        charge_request(run, head, before);
    }
    run->far_first = run->asked_count;
    if (!has_members_listed(run)) {
        ask_beyond(run, head);
    }
    take_answers(run);
}

/* Before there is a head everybody who detects the target is heard. */
static void ask_all(struct run *run)
{
    run->asked_count = 0;
    for (uint32_t i = 0; i < run->deployment.count; i++) {
        if (run->detects[i]) {
            add_asked(run, i);
        }
    }
    take_answers(run);
}

/* All nodes that detect, as candidates. */
static size_t detecting(struct run *run)
{
    size_t count = 0;
    for (uint32_t i = 0; i < run->deployment.count; i++) {
        if (run->detects[i]) {
            run->candidates[count++] = (struct mh_candidate){run->vicinity.id[i], run->vicinity.place[i], true};
        }
    }
    return count;
}

static bool answered(const struct run *run, uint32_t node)
{
    const struct mh_measurement key = {.node = run->vicinity.id[node]};
    return bsearch(&key, run->answers, run->answer_count, sizeof *run->answers, by_node) != NULL;
}

static void add_candidate(struct run *run, uint32_t node, size_t *count)
{
    run->candidates[(*count)++] =
        (struct mh_candidate){run->vicinity.id[node], run->vicinity.place[node], answered(run, node)};
}

/* Mote `head` and its neighbours, as candidates; by the rules scm* also who else answered. */
static size_t around(struct run *run, uint32_t head)
{
    size_t count = 0;
    add_candidate(run, head, &count);
    for (size_t k = run->vicinity.first[head]; k < run->vicinity.first[head + 1]; k++) {
        if (run->vicinity.neighbours[k] < run->deployment.count) {
            add_candidate(run, run->vicinity.neighbours[k], &count);
        }
    }
    for (size_t i = run->far_first; i < run->asked_count; i++) {
        add_candidate(run, run->asked[i], &count);
    }
    return count;
}

/* The track goes from mote `before` to mote `after`, with a list of members of so many bytes. */
static void charge_hand_over(struct run *run, uint32_t before, uint32_t after, unsigned list)
{
    const struct mh_place *from = &run->vicinity.place[before], *to = &run->vicinity.place[after];
    const double hops = ceil(mh_place_distance_mm(from, to) * 1e-3 / number_of(run->election.radio_range_m));
    const unsigned particles = run->sizes->particle * (unsigned)run->scenario->tracker.particles;
    for (unsigned hop = 0; hop < (unsigned)hops; hop++) {
        ledger_unicast(&run->ledger, ENERGY_CLUSTERING, before, after, run->sizes->hand_over + particles + list);
    }
}

/* What a new cluster costs that takes over from mote `before`. */
static void charge_formation(struct run *run, uint32_t before)
{
    const struct mh_cluster *cluster = &run->cluster;
    const uint32_t head = index_of(run, cluster->head.id);
    const unsigned list = has_members_listed(run) ? MEMBER_BYTES * (unsigned)cluster->count : 0;
    const size_t first = run->vicinity.first[head], heard = run->vicinity.first[head + 1] - first;
    uint32_t members[MH_CLUSTER_MAX] = {0};
    for (uint8_t i = 0; i < cluster->count; i++) {
        members[i] = index_of(run, cluster->members[i].id);
    }
    ledger_broadcast(&run->ledger, ENERGY_CLUSTERING, head,
                     has_members_listed(run) ? members : run->vicinity.neighbours + first,
                     has_members_listed(run) ? cluster->count : heard, FORM_BYTES + list);
    for (uint8_t i = 0; i < cluster->count && run->election.rule != MH_ELECTION_SACX; i++) {
        ledger_unicast(&run->ledger, ENERGY_CLUSTERING, members[i], head, JOIN_BYTES);
    }
    if (head != before) {
        charge_hand_over(run, before, head, list);
    }
}

static void tell_cluster(struct run *run, bool is_new)
{
    run->counters.formed += is_new;
    if (run->observer->cluster) {
        mh_node_id members[MH_CLUSTER_MAX];
        for (uint8_t i = 0; i < run->cluster.count; i++) {
            members[i] = run->cluster.members[i].id;
        }
        run->observer->cluster(run->observer->context, run->truth.time_s, 0, run->cluster.head.id, members,
                               run->cluster.count, is_new);
    }
}

/* None of those asked detects the target, but others do. */
static void recover(struct run *run, const struct mh_place *predicted)
{
    const uint32_t before = index_of(run, run->cluster.head.id);
    (void)mh_elect_first(&run->election, predicted, run->candidates, detecting(run), &run->cluster);
    const uint32_t head = index_of(run, run->cluster.head.id);
    const size_t first = run->vicinity.first[head], end = run->vicinity.first[head + 1];
    ledger_broadcast(&run->ledger, ENERGY_CLUSTERING, head, run->vicinity.neighbours + first, end - first, ALERT_BYTES);
    charge_formation(run, before);
    run->counters.recoveries++;
    tell_cluster(run, true);
    run->tracker.tracker->restart(run->state);
    ask(run, &run->vicinity.place[head]);
}

static void charge_hop(void *context, uint32_t from, uint32_t to)
{
    struct run *run = context;
    ledger_unicast(&run->ledger, ENERGY_REPORTING, from, to, run->sizes->report);
}

static void report(struct run *run, const struct mh_estimate *estimate)
{
    run->counters.reports++;
    (void)mh_followed_report(&run->at_sink, estimate->time, estimate->stored, estimate->stored_velocity);
    run->sink_origin = estimate->origin;
    (void)vicinity_walk(&run->vicinity, index_of(run, run->cluster.head.id), charge_hop, run);
}

static void tell_positions(struct run *run, const struct mh_estimate *estimate)
{
    const struct observer *observer = run->observer;
    if (observer->estimate) {
        observer->estimate(observer->context, run->truth.time_s, run->cluster.head.id, estimate, &run->truth,
                           &run->truth);
    }
    struct mh_estimate known = {.origin = run->sink_origin, .time = estimate->time, .velocity = run->at_sink.velocity};
    if (observer->sink && mh_followed_predict(&run->at_sink, known.time, &known.position) == MH_OK) {
        observer->sink(observer->context, run->truth.time_s, &known, &run->truth);
    }
}

/* Who goes on. */
static void elect(struct run *run, const struct mh_estimate *estimate)
{
    const uint32_t before = index_of(run, run->cluster.head.id);
    if (mh_elect(&run->election, estimate, run->candidates, around(run, before), &run->cluster) == MH_OK) {
        const uint32_t head = index_of(run, run->cluster.head.id);
        (void)mh_elect_members(&run->election, &estimate->origin, &estimate->position, &estimate->velocity,
                               run->candidates, around(run, head), &run->cluster);
        charge_formation(run, before);
        tell_cluster(run, true);
    }
}

static enum mh_status localise(struct run *run, struct mh_estimate *estimate)
{
    const uint32_t before = tracker_draws(&run->tracker, run->state);
    const enum mh_status status =
        run->tracker.tracker->step(run->state, instant_of(run), run->answers, run->answer_count, estimate);
    if (run->following && run->ledger.profile) {
        const uint32_t draws = tracker_draws(&run->tracker, run->state) - before;
        ledger_compute(&run->ledger, index_of(run, run->cluster.head.id),
                       (double)energy_tracker_us(run->ledger.profile, run->ledger.cpu, run->tracker.tracker->name,
                                                 (int)run->answer_count, draws));
    }
    return status;
}

static void begin(struct run *run)
{
    struct mh_estimate estimate;
    ask_all(run);
    if (run->answer_count == 0 || localise(run, &estimate) != MH_OK) {
        return;
    }
    const struct mh_place about = mh_place_from_offset(&estimate.origin, estimate.position);
    (void)mh_elect_first(&run->election, &about, run->candidates, detecting(run), &run->cluster);
    run->following = true;
    tell_cluster(run, false);
    report(run, &estimate);
    tell_positions(run, &estimate);
}

static void follow(struct run *run, size_t detecting_count)
{
    struct mh_estimate expected, estimate;
    if (run->tracker.tracker->predict(run->state, instant_of(run), &expected) != MH_OK) {
        run->following = false;
        begin(run);
        return;
    }
    const struct mh_place predicted = mh_place_from_offset(&expected.origin, expected.position);
    ask(run, &predicted);
    if (run->answer_count == 0 && detecting_count > 0) {
        recover(run, &predicted);
    }
    if (localise(run, &estimate) != MH_OK) {
        return;
    }
    if (estimate.flags & MH_ESTIMATE_REFRESHED) {
        report(run, &estimate);
    }
    tell_positions(run, &estimate);
    elect(run, &estimate);
}

static void sample(struct run *run)
{
    const double time_s = (double)run->sample * run->scenario->sensor.interval_s;
    const struct point p = trajectory_position(&run->path, time_s);
    const struct point v = trajectory_velocity(&run->path, time_s);
    run->truth =
        (struct truth){.time_s = time_s, .x_m = p.x_m, .y_m = p.y_m, .present = true, .vx_mps = v.x_m, .vy_mps = v.y_m};
    if (run->observer->truth) {
        run->observer->truth(run->observer->context, &run->truth);
    }
    const size_t detecting_count = sense(run);
    if (run->following) {
        follow(run, detecting_count);
    } else {
        begin(run);
    }
    run->sample++;
}

static int make_world(struct run *run, uint64_t seed, char *error, size_t error_size)
{
    const struct scenario *scenario = run->scenario;
    const struct scenario_field field = scenario_field(scenario);
    const struct mh_place corner = place_from_metres(field.width_m, field.height_m, 0);
    const struct mh_region region = {0, corner.x_mm, 0, corner.y_mm};
    run->ranging = ranging_of(scenario, &run->clusters, seed);
    run->election = election_config_of(scenario);
    if (clusters_make(&run->clusters, scenario, error, error_size) ||
        deployment_make(&run->deployment, scenario, seed, error, error_size) ||
        trajectory_make(&run->path, scenario, seed, error, error_size) ||
        tracker_choose(scenario, &region, &run->tracker, error, error_size)) {
        return -1;
    }
    run->sizes = message_sizes_of(run->tracker.tracker->name);
    if (!run->sizes) {
        snprintf(error, error_size, "tracker.name: `%s`, expected range, pftl, msl or centroid in an ideal network",
                 run->tracker.tracker->name);
        return -1;
    }
    tracker_seed(&run->tracker, (uint32_t)seed);
    snprintf(error, error_size, "out of memory");
    const size_t nodes = run->deployment.count;
    run->state = malloc(run->tracker.tracker->state_size);
    run->detects = calloc(nodes, sizeof *run->detects);
    run->range_m = calloc(nodes, sizeof *run->range_m);
    run->asked = calloc(nodes, sizeof *run->asked);
    run->answers = calloc(nodes, sizeof *run->answers);
    run->candidates = calloc(nodes, sizeof *run->candidates);
    if (!run->state || !run->detects || !run->range_m || !run->asked || !run->answers || !run->candidates ||
        vicinity_of(&run->vicinity, scenario, &run->deployment, number_of(run->election.radio_range_m)) ||
        ledger_make(&run->ledger, scenario, run->vicinity.count)) {
        return -1;
    }
    if (run->tracker.tracker->init(run->state, &run->tracker.config, run->election.interval) != MH_OK) {
        snprintf(error, error_size, "tracker %s: a setting is outside its range", run->tracker.tracker->name);
        return -1;
    }
    return 0;
}

static void free_world(struct run *run)
{
    free(run->state);
    free(run->detects);
    free(run->range_m);
    free(run->asked);
    free(run->answers);
    free(run->candidates);
    ledger_free(&run->ledger);
    vicinity_free(&run->vicinity);
    trajectory_free(&run->path);
    deployment_free(&run->deployment);
}

static int run_samples(struct run *run, const volatile sig_atomic_t *stop, char *error, size_t error_size)
{
    const uint64_t samples = (uint64_t)(run->path.duration_s / run->scenario->sensor.interval_s + 1e-6) + 1;
    for (uint32_t i = 0; run->observer->node && i < run->vicinity.count; i++) {
        run->observer->node(run->observer->context, run->vicinity.id[i], &run->vicinity.place[i]);
    }
    while (run->sample < samples) {
        if (stop && *stop) {
            snprintf(error, error_size, "stopped");
            return -1;
        }
        sample(run);
    }
    return 0;
}

int ideal_cluster_run(const struct scenario *scenario, uint64_t seed, const struct observer *observer,
                      const volatile sig_atomic_t *stop, struct simulation_counters *counters, char *error,
                      size_t error_size)
{
    struct run run = {.scenario = scenario, .observer = observer};
    int result = make_world(&run, seed, error, error_size);
    if (result == 0) {
        result = run_samples(&run, stop, error, error_size);
    }
    if (result == 0) {
        const double none = (double)NAN;
        *counters = (struct simulation_counters){.samples = run.sample,
                                                 .head.measurements = run.counters.answered,
                                                 .clusters = {.present = true, .total = run.counters},
                                                 .energy = ledger_totals(&run.ledger),
                                                 .clock_error_median_ms = none,
                                                 .clock_error_p99_ms = none,
                                                 .clock_known_share = none};
    }
    free_world(&run);
    return result;
}
