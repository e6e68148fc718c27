/* Fixed clusters of whole motes on a radio of the test's own, where the test decides who dies, what is lost, late or forged: 1 ms at a time, without collisions. Xu's
 * four clusters on rings, 40 m of radio; beside the network the same samples go straight into trackers and a centre, without frames: what comes out there is
 * what the network is measured against. */
#include "motehound/cv.h"
#include "motehound/fixed.h"
#include "motehound/fusion_centre.h"
#include "motehound/geographic.h"
#include "motehound/mote.h"
#include "port.h"
#include "unity.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum { CLUSTERS = 4, NODES = 18, SINK = NODES, MOTES, FLYING_MAX = 400, TRIES = 4, TICK = 500, REPORT = 1000 };

#define NEVER UINT32_MAX

static const uint8_t sizes[CLUSTERS] = {3, 4, 5, 6};
static const mh_real variances[CLUSTERS] = {0.02f, 0.015f, 0.01f, 0.03f};

/* The same tracks and the same centre without a network. */
struct ideal {
    struct mh_cv tracks[CLUSTERS];
    struct mh_fusion_centre centre;
    struct mh_estimate fused;
};

static struct world {
    struct mote {
        struct mh_mote mote;
        struct mh_mote_config config;
        struct mh_fixed protocol;
        struct mh_sensor_config sensor;
        struct mh_head_config head_config;
        struct mh_head head;
        struct mh_cv tracker;
        mh_tick alarm;
        bool dead;
    } motes[MOTES];
    struct flying {
        mh_tick begins, ends;
        unsigned from, to, tries; /* to: MOTES for all */
        uint8_t bytes[MH_FRAME_MAX];
        size_t length;
    } flying[FLYING_MAX];
    unsigned count;
    struct mh_fixed_member members[NODES];
    struct mh_fixed_cluster clusters[CLUSTERS];
    struct mh_fixed_config config;
    struct mh_cv_config tracking[CLUSTERS];
    struct mh_fusion_centre_config joining;
    struct mh_fusion_centre centre;
    struct ideal ideal;
    mh_tick now;
    uint32_t random;
    double loss, corrupt, acknowledgement_loss;
    mh_tick delay;       /* of samples, at most */
    double x[4];         /* the target's state ... */
    double at_report[2]; /* ... and place at the last instant of reports */
    /* what comes of it */
    unsigned fused, ideal_fused;
    double square, ideal_square, apart; /* sums over fused estimates from 10 s on, and the largest difference */
} * w;

static double random_share(void)
{
    w->random = w->random * 1664525u + 1013904223u;
    return (w->random >> 8) / 16777216.0;
}

static double random_normal(void)
{
    double sum = -6;
    for (int i = 0; i < 12; i++) {
        sum += random_share();
    }
    return sum;
}

static uint8_t cluster_of(unsigned node)
{
    uint8_t cluster = 0;
    for (unsigned first = 0; first + sizes[cluster] <= node; cluster++) {
        first += sizes[cluster];
    }
    return cluster;
}

static unsigned first_of(uint8_t cluster)
{
    unsigned first = 0;
    for (uint8_t i = 0; i < cluster; i++) {
        first += sizes[i];
    }
    return first;
}

/* ticks between its samples */
static unsigned period_of(unsigned node)
{
    const uint8_t cluster = cluster_of(node);
    return 2 * (1 + 3 * (node - first_of(cluster)) / sizes[cluster]);
}

static struct mh_place place_of(unsigned node)
{
    const uint8_t cluster = cluster_of(node);
    const double angle =
        2 * 3.14159265358979 * (node - first_of(cluster)) / sizes[cluster] + cluster * 3.14159265358979 / 7;
    const struct mh_place place = {(int32_t)lrint((cluster % 2 ? 75000 : 25000) + 15000 * cos(angle)),
                                   (int32_t)lrint((cluster / 2 ? 75000 : 25000) + 15000 * sin(angle)), 0};
    return place;
}

/* ---- without a network ---- */

static double error_m(const struct mh_estimate *estimate)
{
    return hypot((double)estimate->position.x - w->at_report[0], (double)estimate->position.y - w->at_report[1]);
}

/* At w->now, with the samples of this instant. */
static void step_ideal(const struct mh_measurement *samples, size_t count)
{
    const bool reports = w->now % REPORT == 0;
    uint8_t bytes[MH_SUMMARY_BYTES_MAX];
    size_t length;
    for (uint8_t c = 0; c < CLUSTERS; c++) {
        struct mh_measurement own[NODES];
        struct mh_estimate local;
        size_t own_count = 0;
        for (size_t i = 0; i < count; i++) {
            if (cluster_of(samples[i].node) == c) {
                own[own_count++] = samples[i];
            }
        }
        struct mh_cv *track = &w->ideal.tracks[c];
        TEST_ASSERT_EQUAL(MH_OK, mh_tracker_cv_ukf.step(track, w->now, own, own_count, &local));
        if (reports) {
            TEST_ASSERT_EQUAL(MH_OK, mh_tracker_cv_ukf.summarise(track, w->now, bytes, &length));
            TEST_ASSERT_EQUAL(MH_OK, mh_centre_fusion.take(&w->ideal.centre, c, w->now, bytes, length));
            mh_tracker_cv_ukf.summary_taken(track, w->now);
        }
    }
    if (reports) {
        w->at_report[0] = w->x[0];
        w->at_report[1] = w->x[2];
        TEST_ASSERT_EQUAL(MH_OK, mh_centre_fusion.fuse(&w->ideal.centre, w->now, &w->ideal.fused));
        w->ideal_fused += w->now > 10000;
        w->ideal_square += w->now > 10000 ? error_m(&w->ideal.fused) * error_m(&w->ideal.fused) : 0;
        for (uint8_t c = 0; c < CLUSTERS; c++) {
            if (mh_centre_fusion.feedback(&w->ideal.centre, bytes, &length) == MH_OK) {
                TEST_ASSERT_EQUAL(MH_OK, mh_tracker_cv_ukf.correct(&w->ideal.tracks[c], w->now, bytes, length));
            }
        }
    }
}

/* ---- what motes ask ---- */

static unsigned index_of(const void *context) { return (unsigned)((const struct mote *)context - w->motes); }

static void transmit(void *context, mh_node_id destination, const uint8_t *frame, size_t length)
{
    struct mh_message message;
    TEST_ASSERT_TRUE(w->count < FLYING_MAX);
    TEST_ASSERT_EQUAL(MH_OK, mh_wire_decode(mh_wire_all, frame, length, &message));
    struct flying *f = &w->flying[w->count++];
    const mh_tick delay = message.kind == MH_MESSAGE_REPORT ? (mh_tick)(random_share() * w->delay) : 0;
    f->begins = w->now + 1 + (mh_tick)(random_share() * 3) + delay;
    f->ends = f->begins + 3;
    f->from = index_of(context);
    f->to = destination == MH_BROADCAST ? MOTES : destination;
    f->tries = 0;
    f->length = length;
    memcpy(f->bytes, frame, length);
}

static void set_alarm(void *context, mh_tick time) { w->motes[index_of(context)].alarm = time; }

static void report(void *context, const struct mh_estimate *estimate)
{
    if (index_of(context) != SINK) {
        return;
    }
    TEST_ASSERT_EQUAL(0, estimate->time % REPORT);
    TEST_ASSERT_EQUAL(4, estimate->states);
    if (estimate->time >
        10000) { /* the target has hardly moved on since; the ideal estimate is that of the same time */
        w->fused++;
        const double error = error_m(estimate);
        const double apart = hypot((double)estimate->position.x - (double)w->ideal.fused.position.x,
                                   (double)estimate->position.y - (double)w->ideal.fused.position.y);
        TEST_ASSERT_EQUAL_UINT32(w->ideal.fused.time, estimate->time);
        w->square += error * error;
        w->apart = fmax(w->apart, apart);
    }
}

static const struct mh_port port = {.transmit = transmit, .set_alarm = set_alarm, .report = report};

/* ---- the radio ---- */

static bool hears(unsigned i, const struct flying *f)
{
    const struct mote *to = &w->motes[i];
    return i != f->from && !to->dead && mh_place_within(&to->config.place, &w->motes[f->from].config.place, 40000) &&
           random_share() >= w->loss;
}

static void arrive(unsigned i, const struct flying *f)
{
    struct mh_message message;
    uint8_t bytes[MH_FRAME_MAX];
    memcpy(bytes, f->bytes, f->length);
    TEST_ASSERT_EQUAL(MH_OK, mh_wire_decode(mh_wire_all, bytes, f->length, &message));
    if (message.kind == MH_MESSAGE_TAKEN && (unsigned)message.header.route.destination == i &&
        random_share() < w->acknowledgement_loss) {
        return;
    }
    if (random_share() < w->corrupt) {
        bytes[(size_t)(random_share() * (double)f->length)] ^= (uint8_t)(1u << (unsigned)(random_share() * 8));
    }
    (void)mh_mote_frame(&w->motes[i].mote, w->now, bytes, f->length);
}

static void land(unsigned at)
{
    struct flying f = w->flying[at];
    bool taken = false;
    w->flying[at] = w->flying[--w->count];
    if (w->motes[f.from].dead) {
        return;
    }
    for (unsigned i = f.to == MOTES ? 0 : f.to; i < MOTES && (f.to == MOTES || i == f.to); i++) {
        if (hears(i, &f)) {
            taken = true;
            arrive(i, &f);
        }
    }
    if (f.to != MOTES && !taken && f.tries + 1 < TRIES) {
        f.tries++;
        f.begins = w->now + 2;
        f.ends = f.begins + 3;
        w->flying[w->count++] = f;
    } else {
        mh_mote_sent(&w->motes[f.from].mote, w->now, f.to == MOTES || taken ? MH_SENT_OK : MH_SENT_NO_ACK);
    }
}

/* ---- the world ---- */

static void move(void)
{
    const double sd[2] = {sqrt(5e-5), sqrt(1e-4)};
    for (int axis = 0; axis < 2; axis++) {
        const double a = sd[axis] * random_normal();
        w->x[2 * axis] += 0.5 * w->x[2 * axis + 1] + 0.125 * a;
        w->x[2 * axis + 1] += 0.5 * a;
    }
}

static void sample(void)
{
    struct mh_measurement samples[NODES];
    size_t count = 0;
    for (unsigned i = 0; i < NODES; i++) {
        struct mote *m = &w->motes[i];
        if (w->now / TICK % period_of(i) > 0) {
            continue;
        }
        const double range = hypot(m->config.place.x_mm * 1e-3 - w->x[0], m->config.place.y_mm * 1e-3 - w->x[2]) +
                             sqrt((double)variances[cluster_of(i)]) * random_normal();
        const struct mh_measurement taken = {
            .node = i, .place = m->config.place, .time = w->now, .value = mh_q20_from_real((mh_real)range)};
        samples[count++] = taken;
        if (!m->dead) {
            const struct mh_reading reading = {.time = w->now, .counts = taken.value};
            TEST_ASSERT_EQUAL(MH_OK, mh_mote_reading(&m->mote, w->now, &reading));
        }
    }
    step_ideal(samples, count);
}

static void run_until(mh_tick end)
{
    for (; w->now < end; w->now++) {
        for (unsigned k = w->count; k-- > 0;) {
            if (w->flying[k].ends == w->now) {
                land(k);
            }
        }
        if (w->now > 0 && w->now % TICK == 0) {
            move();
            sample();
        }
        for (unsigned i = 0; i < MOTES; i++) {
            struct mote *m = &w->motes[i];
            for (unsigned k = 0; !m->dead && k < 10 && m->alarm <= w->now; k++) {
                m->alarm = NEVER;
                mh_mote_alarm(&m->mote, w->now);
            }
        }
    }
}

/* ---- the network ---- */

static struct world world;

static void start(unsigned i)
{
    struct mote *m = &w->motes[i];
    m->alarm = NEVER;
    m->dead = false;
    TEST_ASSERT_EQUAL(MH_OK, mh_mote_init(&m->mote, &m->config, &port, m, w->now));
}

static void come_up(enum mh_fusion_rule rule)
{
    w->joining.rule = rule;
    w->config.acknowledges = rule == MH_FUSION_HIF || rule == MH_FUSION_HIF_FEEDBACK;
    for (uint8_t c = 0; c < CLUSTERS; c++) {
        mh_cv_config_default(&w->tracking[c]);
        w->tracking[c].variance = variances[c];
        w->tracking[c].summary = mh_summary_kind_of(rule);
        TEST_ASSERT_EQUAL(MH_OK, mh_tracker_cv_ukf.init(&w->ideal.tracks[c], &w->tracking[c], TICK));
    }
    TEST_ASSERT_EQUAL(MH_OK, mh_centre_fusion.init(&w->ideal.centre, &w->joining));
    for (int i = 0; i < 4; i++) {
        w->x[i] =
            (double)w->tracking[0].mean[i] + sqrt((double)w->tracking[0].covariance[MH_PACKED(i, i)]) * random_normal();
    }
    for (unsigned i = 0; i < MOTES; i++) {
        struct mote *m = &w->motes[i];
        const bool is_sink = i == SINK;
        const uint8_t cluster = is_sink ? 0 : cluster_of(i);
        m->sensor = (struct mh_sensor_config){.q20_per_count = 1,
                                              .counts_min = INT32_MIN,
                                              .counts_max = INT32_MAX,
                                              .interval = TICK,
                                              .report_always = true,
                                              .report_spread = 20};
        m->head_config = (struct mh_head_config){.tracker = &mh_tracker_cv_ukf,
                                                 .tracker_config = &w->tracking[cluster],
                                                 .tracker_state = &m->tracker,
                                                 .interval = TICK,
                                                 .window = 150,
                                                 .lateness = 2000};
        m->config = (struct mh_mote_config){.id = i,
                                            .place = is_sink ? w->config.sink_place : w->members[i].place,
                                            .sensor = is_sink ? NULL : &m->sensor,
                                            .head = is_sink ? NULL : &m->head_config,
                                            .head_state = &m->head,
                                            .protocol = &mh_protocol_fixed,
                                            .protocol_config = &w->config,
                                            .protocol_state = &m->protocol};
        if (is_sink) {
            m->config.centre = &mh_centre_fusion;
            m->config.centre_config = &w->joining;
            m->config.centre_state = &w->centre;
        }
        start(i);
    }
}

void setUp(void)
{
    memset(&world, 0, sizeof world);
    w = &world;
    w->random = 7;
    mh_fixed_config_default(&w->config);
    mh_fusion_centre_config_default(&w->joining);
    w->joining.keep = 5000;
    w->config.port = &mh_mote_fixed;
    w->config.sink = SINK;
    w->config.sink_place = (struct mh_place){50000, 50000, 0};
    w->config.clusters = w->clusters;
    w->config.cluster_count = CLUSTERS;
    for (unsigned i = 0; i < NODES; i++) {
        w->members[i] = (struct mh_fixed_member){i, place_of(i)};
    }
    for (uint8_t c = 0; c < CLUSTERS; c++) {
        w->clusters[c] = (struct mh_fixed_cluster){&w->members[first_of(c)], sizes[c]};
    }
}

void tearDown(void) {}

static struct mh_fixed_counters counted(void)
{
    struct mh_protocol_counters counters = {.retries = 0};
    for (unsigned i = 0; i < MOTES; i++) {
        mh_protocol_fixed.count(&w->motes[i].protocol, &counters);
    }
    return counters.fixed;
}

static unsigned heads_of(uint8_t cluster, unsigned *head)
{
    unsigned count = 0;
    for (unsigned i = first_of(cluster); i < first_of(cluster) + sizes[cluster]; i++) {
        if (!w->motes[i].dead && w->motes[i].protocol.role == MH_FIXED_HEAD) {
            TEST_ASSERT_TRUE(w->motes[i].mote.leads);
            *head = i;
            count++;
        }
    }
    return count;
}

static double rmse_m(void) { return sqrt(w->square / w->fused); }
static double ideal_rmse_m(void) { return sqrt(w->ideal_square / w->ideal_fused); }

static void say(const char *what)
{
    const struct mh_fixed_counters c = counted();
    printf("  %s: RMSE %.4f m, without a network %.4f m, apart at most %.4f m, %u estimates; of %u summaries %u taken, "
           "%u repeated, "
           "%u overdue, %u refused\n",
           what, rmse_m(), ideal_rmse_m(), w->apart, w->fused, (unsigned)c.summaries, (unsigned)c.taken,
           (unsigned)c.repeated, (unsigned)c.overdue, (unsigned)c.refused);
}

/* ---- tests ---- */

static const struct {
    const char *name;
    enum mh_fusion_rule rule;
} rules[] = {
    {"ci", MH_FUSION_CI}, {"sci", MH_FUSION_SCI}, {"hif", MH_FUSION_HIF}, {"hif_feedback", MH_FUSION_HIF_FEEDBACK}};

enum { RULES = sizeof rules / sizeof rules[0] };

static void without_losses_the_network_changes_nothing(void)
{
    for (int r = 0; r < RULES; r++) {
        setUp();
        come_up(rules[r].rule);
        run_until(101000);
        say(rules[r].name);
        const struct mh_fixed_counters c = counted();
        TEST_ASSERT_EQUAL(90, w->fused);
        TEST_ASSERT_TRUE(w->apart < 2e-3); /* rounding, where a track is filtered anew after feedback */
        TEST_ASSERT_EQUAL_UINT32(CLUSTERS, c.led);
        TEST_ASSERT_EQUAL_UINT32(CLUSTERS * 100, c.summaries);
        TEST_ASSERT_EQUAL_UINT32(CLUSTERS * 100, c.taken);
        TEST_ASSERT_EQUAL_UINT32(0, c.refused + c.overdue + c.repeated + c.uncorrected);
        TEST_ASSERT_EQUAL_UINT32(rules[r].rule == MH_FUSION_HIF_FEEDBACK ? CLUSTERS * 100 : 0, c.corrected);
    }
}

static void losses_are_borne(void)
{
    for (int r = 0; r < RULES; r++) {
        setUp();
        w->loss = 0.2;
        w->corrupt = 0.05;
        come_up(rules[r].rule);
        run_until(101000);
        say(rules[r].name);
        TEST_ASSERT_EQUAL(90, w->fused);
        TEST_ASSERT_TRUE(rmse_m() < 1.2 * ideal_rmse_m());
        TEST_ASSERT_EQUAL_UINT32(0, counted().refused);
    }
}

/* Samples that come late, some after the head has closed their instant: the track is the same as soon as they are there. */
static void late_samples_are_filtered_in_their_order(void)
{
    w->delay = 900;
    come_up(MH_FUSION_CI);
    run_until(100001);
    w->delay = 0;
    say("samples up to 0.9 s late");
    run_until(101300); /* those of 100 s are there, and the instant after is closed */
    uint32_t reordered = 0;
    for (uint8_t c = 0; c < CLUSTERS; c++) {
        const struct mh_cv *track = &w->motes[first_of(c)].tracker, *ideal = &w->ideal.tracks[c];
        reordered += track->counters.reordered;
        TEST_ASSERT_EQUAL_UINT32(0, track->counters.late);
        TEST_ASSERT_EQUAL_UINT32(0, w->motes[first_of(c)].head.counters.late);
        TEST_ASSERT_EQUAL_UINT32(ideal->latest.time, track->latest.time);
        TEST_ASSERT_EQUAL_MEMORY(&ideal->latest.state, &track->latest.state, sizeof ideal->latest.state);
    }
    printf("  %u samples came after later ones\n", (unsigned)reordered);
    TEST_ASSERT_TRUE(reordered > 100);
}

/* The centre has increments whose heads do not know it: nothing counts twice. */
static void lost_acknowledgements_do_no_harm(void)
{
    w->acknowledgement_loss = 0.5;
    come_up(MH_FUSION_HIF);
    run_until(101000);
    say("every second acknowledgement lost");
    TEST_ASSERT_TRUE(counted().repeated > 100);
    TEST_ASSERT_TRUE(rmse_m() < 1.5 * ideal_rmse_m());
    /* what the centre claims is no better than what it would claim without losses */
    const struct mh_gaussian *with = &w->centre.state, *without = &w->ideal.centre.state;
    TEST_ASSERT_TRUE(with->P[0] > 0.98f * without->P[0]);
    TEST_ASSERT_TRUE(with->P[MH_PACKED(2, 2)] > 0.98f * without->P[MH_PACKED(2, 2)]);
}

static void a_head_that_dies_is_replaced(void)
{
    for (int r = 0; r < RULES; r++) {
        unsigned head = MOTES;
        setUp();
        come_up(rules[r].rule);
        run_until(40000);
        w->motes[first_of(2)].dead = true;
        run_until(50000);
        TEST_ASSERT_EQUAL(1, heads_of(2, &head));
        TEST_ASSERT_EQUAL(first_of(2) + 1, head);
        start(first_of(2)); /* comes back: leads until it hears that another does */
        run_until(55000);
        TEST_ASSERT_EQUAL(1, heads_of(2, &head));
        TEST_ASSERT_EQUAL(first_of(2) + 1, head);
        run_until(101000);
        say(rules[r].name);
        TEST_ASSERT_EQUAL(90, w->fused);
        TEST_ASSERT_EQUAL_UINT32(1, counted().taken_over);
        TEST_ASSERT_TRUE(rmse_m() < 1.5 * ideal_rmse_m());
        TEST_ASSERT_TRUE(w->apart < 0.5);
        for (uint8_t c = 0; c < CLUSTERS; c++) {
            TEST_ASSERT_EQUAL(1, heads_of(c, &head));
        }
    }
}

static void two_heads_after_the_other_are_replaced(void)
{
    unsigned head = MOTES;
    come_up(MH_FUSION_CI);
    run_until(20000);
    w->motes[first_of(3)].dead = w->motes[first_of(3) + 1].dead = true;
    run_until(30000);
    TEST_ASSERT_EQUAL(1, heads_of(3, &head));
    TEST_ASSERT_EQUAL(first_of(3) + 2, head);
}

/* Its radio acknowledges the samples of the others all the while, and that of the first member those of its own. */
static void a_head_that_is_not_the_first_member_restarts(void)
{
    unsigned head = MOTES;
    come_up(MH_FUSION_CI);
    run_until(20000);
    w->motes[first_of(2)].dead = true;
    run_until(30000);
    start(first_of(2));
    run_until(40300);
    TEST_ASSERT_EQUAL(1, heads_of(2, &head));
    TEST_ASSERT_EQUAL(first_of(2) + 1, head);
    start(head);
    run_until(44000);
    TEST_ASSERT_EQUAL(1, heads_of(2, &head));
    run_until(101000);
    TEST_ASSERT_EQUAL(1, heads_of(2, &head));
    TEST_ASSERT_EQUAL(90, w->fused);
    TEST_ASSERT_TRUE(rmse_m() < 1.5 * ideal_rmse_m());
}

static void a_sink_that_restarts_goes_on(void)
{
    for (int r = 0; r < RULES; r++) {
        setUp();
        come_up(rules[r].rule);
        run_until(40300);
        start(SINK);
        run_until(101000);
        say(rules[r].name);
        TEST_ASSERT_EQUAL(89, w->fused); /* without that of 40 s */
        TEST_ASSERT_TRUE(sqrt(w->square / w->fused) < 2 * ideal_rmse_m());
    }
}

/* Sound frames with unsound content, as from a mote that is out of its mind. */
static void forged_summaries_are_refused_and_counted(void)
{
    come_up(MH_FUSION_SCI);
    unsigned forged = 0;
    for (mh_tick end = 1050; end < 101000; end += 250) {
        run_until(end);
        struct mh_message message = {
            .kind = MH_MESSAGE_HAND_OVER,
            .as.hand_over = {.track = (int32_t)(random_share() * 6), .time_ms = (int32_t)(w->now / 1000 * 1000)}};
        uint8_t bytes[MH_SUMMARY_BYTES_MAX], frame[MH_FRAME_MAX];
        size_t length = 1 + (size_t)(random_share() * 63);
        for (size_t i = 0; i < length; i++) {
            bytes[i] = (uint8_t)(random_share() * 256);
        }
        mh_parcel_cut(bytes, length, 0, &message.as.hand_over);
        message.as.hand_over.generation = (int32_t)end;
        mh_geographic_address(&message, (mh_node_id)(random_share() * 20), (int16_t)(20000 + forged++), SINK,
                              &w->config.sink_place);
        TEST_ASSERT_EQUAL(MH_OK, mh_wire_encode(mh_wire_all, &message, frame, &length));
        (void)mh_mote_frame(&w->motes[SINK].mote, w->now, frame, length);
    }
    say("forged");
    TEST_ASSERT_EQUAL_UINT32(forged, counted().refused);
    TEST_ASSERT_TRUE(w->apart < 2e-3);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(without_losses_the_network_changes_nothing);
    RUN_TEST(losses_are_borne);
    RUN_TEST(late_samples_are_filtered_in_their_order);
    RUN_TEST(lost_acknowledgements_do_no_harm);
    RUN_TEST(a_head_that_dies_is_replaced);
    RUN_TEST(two_heads_after_the_other_are_replaced);
    RUN_TEST(a_head_that_is_not_the_first_member_restarts);
    RUN_TEST(a_sink_that_restarts_goes_on);
    RUN_TEST(forged_summaries_are_refused_and_counted);
    port_exit(UNITY_END() > 0);
    return 0;
}
