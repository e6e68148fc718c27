/* Searches by whole motes on a radio of the test's own, which loses frames and acknowledgements and where the test decides who dies: 100 nodes on 500 m x 400 m,
 * a gas leak at (50, 200) m in a wind along +x, searched for from at least 400 m away (Zhang). Measured readings depend on the node and the instant only, so
 * that a walk without any network, by the tracker alone, has the same to work on. */
#include "motehound/gas.h"
#include "motehound/geographic.h"
#include "motehound/mote.h"
#include "motehound/spread.h"
#include "motehound/token.h"
#include "port.h"
#include "unity.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NODES = 100, SINK = NODES, MOTES, FLYING_MAX = 4000, TRIES = 4, HEADS_MAX = 100 };

#define T 5000u
#define NEVER UINT32_MAX
#define RANGE_MM 80000
#define FIRST 10000u /* the first instant of a search */
#define UNIT 0.001   /* concentration of a reading of 1 */
#define LEVEL_A 3e-6
#define LEVEL_M 1e-4

static const struct mh_place source = {50000, 200000, 0};

union tracker_state {
    struct mh_gas gas;
    struct mh_gas_gaussian gaussian;
};

static struct world {
    struct mote {
        struct mh_mote mote;
        struct mh_mote_config config;
        struct mh_token_node protocol;
        struct mh_head_config head_config;
        struct mh_head head;
        union tracker_state tracker;
        mh_tick alarm, sample;
        bool dead;
    } motes[MOTES];
    struct flying {
        mh_tick ends;
        unsigned from, to, tries; /* to: MOTES for all */
        bool taken;               /* the addressee has it */
        uint8_t bytes[MH_FRAME_MAX];
        size_t length;
    } flying[FLYING_MAX];
    unsigned count;
    struct mh_token_config config;
    struct mh_sensor_config sensor;
    struct mh_gas_config gas;
    const struct mh_tracker *tracker;
    struct mh_place places[NODES];
    mh_tick now;
    uint32_t random, seed;
    double loss, corrupt, noise;
    bool kills_next; /* whoever is to be handed the token dies before he gets it, once */
    /* what comes of it */
    unsigned heads[HEADS_MAX], heads_count, frames, told;
    uint8_t state; /* of the last report */
    double error_m;
    mh_real rate;
} * w;

/* ---- chance ---- */

static double random_share(void)
{
    w->random = w->random * 1664525u + 1013904223u;
    return (w->random >> 8) / 16777216.0;
}

static double mixed_share(uint32_t a, uint32_t b) { return (mh_spread(a, b, 1u << 30) + 0.5) / (1u << 30); }

/* Standard normal, of a node at an instant. */
static double noise_of(unsigned node, uint32_t instant)
{
    const uint32_t which = w->seed * 7919u + node * 104729u;
    const double radius = sqrt(-2 * log(mixed_share(which, 2 * instant)));
    return radius * cos(6.283185307179586 * mixed_share(which, 2 * instant + 1));
}

/* ---- the field ---- */

static double distance_m(const struct mh_place *a, const struct mh_place *b)
{
    return hypot((a->x_mm - b->x_mm) * 1e-3, (a->y_mm - b->y_mm) * 1e-3);
}

static bool hear_each_other(unsigned i, unsigned k) { return mh_place_within(&w->places[i], &w->places[k], RANGE_MM); }

static bool connected(void)
{
    bool reached[NODES] = {true};
    unsigned queue[NODES] = {0}, begin = 0, end = 1;
    while (begin < end) {
        const unsigned i = queue[begin++];
        for (unsigned k = 0; k < NODES; k++) {
            if (!reached[k] && hear_each_other(i, k)) {
                reached[k] = true;
                queue[end++] = k;
            }
        }
    }
    return end == NODES;
}

static mh_q20 reading(unsigned node, mh_tick time)
{
    const uint32_t instant = (time + T / 2) / T;
    const double d = fmax(distance_m(&w->places[node], &source), 1), D = (w->places[node].x_mm - source.x_mm) * 1e-3;
    const double c = 30 / (2 * 3.141592653589793 * 30 * d) * exp(-(d - D) / 60);
    return (mh_q20)lround((c + w->noise * noise_of(node, instant)) / UNIT * (1 << 20));
}

/* Places of nodes of a connected network, and who is to begin. */
static void deploy(uint32_t seed)
{
    unsigned far[NODES], count;
    w->seed = w->random = seed;
    do {
        count = 0;
        for (unsigned i = 0; i < NODES; i++) {
            w->places[i] = (struct mh_place){(int32_t)(random_share() * 500000), (int32_t)(random_share() * 400000), 0};
            if (distance_m(&w->places[i], &source) > 400) {
                far[count++] = i;
            }
        }
    } while (count < 10 || !connected());
    w->config.start = far[(unsigned)(random_share() * count)];
    w->config.start_place = w->places[w->config.start];
}

/* ---- what motes ask ---- */

static unsigned index_of(const void *context) { return (unsigned)((const struct mote *)context - w->motes); }

static void transmit(void *context, mh_node_id destination, const uint8_t *frame, size_t length)
{
    TEST_ASSERT_TRUE(w->count < FLYING_MAX);
    struct flying *f = &w->flying[w->count++];
    struct mh_message message;
    *f = (struct flying){.ends = w->now + 3 + (mh_tick)(random_share() * 3),
                         .from = index_of(context),
                         .to = destination == MH_BROADCAST ? MOTES : destination,
                         .length = length};
    memcpy(f->bytes, frame, length);
    w->frames++;
    TEST_ASSERT_EQUAL(MH_OK, mh_wire_decode(mh_wire_all, frame, length, &message));
    if (message.kind == MH_MESSAGE_ASK && destination == MH_BROADCAST && w->heads_count < HEADS_MAX) {
        w->heads[w->heads_count++] = f->from;
    }
    if (message.kind == MH_MESSAGE_HAND_OVER && w->kills_next) {
        w->motes[destination].dead = true;
        w->kills_next = false;
    }
}

static void set_alarm(void *context, mh_tick time) { w->motes[index_of(context)].alarm = time; }

static void sense(void *context) { w->motes[index_of(context)].sample = w->now + 1; }

static void report(void *context, const struct mh_estimate *estimate)
{
    if (index_of(context) == SINK) {
        const struct mh_place found = mh_place_from_offset(&estimate->origin, estimate->position);
        w->told++;
        w->error_m = distance_m(&found, &source);
        w->rate = estimate->rate;
        w->state = w->motes[SINK].protocol.of.state;
    }
}

static const struct mh_port port = {.transmit = transmit, .set_alarm = set_alarm, .report = report, .sense = sense};

/* ---- the radio ---- */

static bool hears(unsigned i, const struct flying *f)
{
    return i != f->from && !w->motes[i].dead &&
           mh_place_within(&w->motes[i].config.place, &w->motes[f->from].config.place, RANGE_MM) &&
           random_share() >= w->loss;
}

static void arrive(unsigned i, const struct flying *f)
{
    uint8_t bytes[MH_FRAME_MAX];
    memcpy(bytes, f->bytes, f->length);
    if (random_share() < w->corrupt) {
        bytes[(size_t)(random_share() * (double)f->length)] ^= (uint8_t)(1u << (unsigned)(random_share() * 8));
    }
    (void)mh_mote_frame(&w->motes[i].mote, w->now, bytes, f->length);
}

/* Acknowledgements are lost as frames are; a radio does not hand the same frame on twice. */
static void land(unsigned at)
{
    struct flying f = w->flying[at];
    bool acknowledged = false;
    w->flying[at] = w->flying[--w->count];
    if (w->motes[f.from].dead) {
        return;
    }
    for (unsigned i = f.to == MOTES ? 0 : f.to; i < MOTES && (f.to == MOTES || i == f.to); i++) {
        if (hears(i, &f)) {
            acknowledged = random_share() >= w->loss;
            if (!f.taken || f.to == MOTES) {
                f.taken = true;
                arrive(i, &f);
            }
        }
    }
    if (f.to != MOTES && !acknowledged && f.tries + 1 < TRIES) {
        f.tries++;
        f.ends = w->now + 4;
        w->flying[w->count++] = f;
    } else {
        mh_mote_sent(&w->motes[f.from].mote, w->now, f.to == MOTES || acknowledged ? MH_SENT_OK : MH_SENT_NO_ACK);
    }
}

static void sample(unsigned i)
{
    struct mote *m = &w->motes[i];
    const struct mh_reading taken = {.time = w->now, .counts = reading(i, w->now)};
    m->sample = NEVER;
    (void)mh_mote_reading(&m->mote, w->now, &taken);
}

static mh_tick next_event(mh_tick end)
{
    mh_tick next = end;
    for (unsigned i = 0; i < MOTES; i++) {
        const struct mote *m = &w->motes[i];
        const mh_tick first = m->alarm < m->sample ? m->alarm : m->sample;
        next = !m->dead && first < next ? first : next;
    }
    for (unsigned k = 0; k < w->count; k++) {
        next = w->flying[k].ends < next ? w->flying[k].ends : next;
    }
    return next > w->now ? next : w->now + 1;
}

static void run_until(mh_tick end)
{
    while (w->now < end) {
        for (unsigned k = w->count; k-- > 0;) {
            if (w->flying[k].ends <= w->now) {
                land(k);
            }
        }
        for (unsigned i = 0; i < MOTES; i++) {
            struct mote *m = &w->motes[i];
            if (!m->dead && m->sample <= w->now) {
                sample(i);
            }
            for (unsigned k = 0; k < 10 && !m->dead && m->alarm <= w->now; k++) {
                m->alarm = NEVER;
                mh_mote_alarm(&m->mote, w->now);
            }
        }
        w->now = next_event(end);
    }
}

/* ---- the network ---- */

static struct world world;

static void come_up_mote(unsigned i)
{
    struct mote *m = &w->motes[i];
    m->head_config = (struct mh_head_config){.tracker = w->tracker,
                                             .tracker_config = &w->gas,
                                             .tracker_state = &m->tracker,
                                             .interval = T,
                                             .window = w->config.window,
                                             .tolerance = T / 4,
                                             .own_first = true};
    m->config = (struct mh_mote_config){.id = i,
                                        .place = i == SINK ? w->config.sink_place : w->places[i],
                                        .sensor = i == SINK ? NULL : &w->sensor,
                                        .head = i == SINK ? NULL : &m->head_config,
                                        .protocol = &mh_protocol_token,
                                        .protocol_config = &w->config,
                                        .protocol_state = &m->protocol,
                                        .head_state = &m->head};
    m->alarm = m->sample = NEVER;
    TEST_ASSERT_EQUAL(MH_OK, mh_mote_init(&m->mote, &m->config, &port, m, w->now));
}

static void come_up(void)
{
    for (unsigned i = 0; i < MOTES; i++) {
        come_up_mote(i);
    }
}

static void prepare(const struct mh_tracker *tracker, double noise, uint32_t seed)
{
    const struct mh_place sink = {250000, 200000, 0};
    memset(&world, 0, sizeof world);
    w = &world;
    mh_token_config_default(&w->config, SINK, &sink);
    mh_gas_config_default(&w->gas);
    w->gas.unit = (mh_real)UNIT;
    w->gas.noise = (mh_real)(noise / UNIT);
    w->tracker = tracker;
    w->noise = noise;
    w->sensor = (struct mh_sensor_config){
        .q20_per_count = 1, .counts_min = INT32_MIN, .counts_max = INT32_MAX, .interval = T, .report_always = true};
    deploy(seed);
}

void setUp(void) {}
void tearDown(void) {}

static void search(mh_tick end)
{
    come_up();
    run_until(end);
}

static bool found_it(void) { return w->told > 0 && w->state == MH_SEARCH_CONVERGED && w->error_m < 50; }

static struct mh_search_counters counters(void)
{
    struct mh_protocol_counters all;
    memset(&all, 0, sizeof all);
    for (unsigned i = 0; i < MOTES; i++) {
        mh_protocol_token.count(&w->motes[i].protocol, &all);
    }
    return all.searches;
}

static unsigned leading(void)
{
    unsigned count = 0;
    for (unsigned i = 0; i < NODES; i++) {
        count += !w->motes[i].dead && w->motes[i].protocol.role == MH_TOKEN_HEAD;
    }
    return count;
}

/* ---- the walk without a network ---- */

struct walk {
    unsigned heads[HEADS_MAX], count;
    bool converged;
    double error_m;
    mh_real rate;
};

static size_t around(unsigned candidate, struct mh_place *places)
{
    size_t count = 0;
    places[count++] = w->places[candidate];
    for (unsigned i = 0; i < NODES; i++) {
        if (i != candidate && hear_each_other(candidate, i)) {
            places[count++] = w->places[i];
        }
    }
    return count;
}

static void measure(unsigned node, mh_tick instant, struct mh_measurement *measurement)
{
    *measurement = (struct mh_measurement){
        .node = node, .place = w->places[node], .time = instant, .value = reading(node, instant)};
}

static struct walk walk(void)
{
    static union tracker_state state;
    static uint8_t carried[MH_TRACK_BYTES_MAX];
    struct walk done = {.count = 0};
    unsigned head = w->config.start, calm = 0;
    size_t length = 0;
    for (mh_tick instant = FIRST; done.count < w->config.heads_max && calm < w->config.calm; instant += T) {
        struct mh_measurement measurements[NODES];
        struct mh_place places[NODES];
        struct mh_estimate estimate;
        size_t count = 0;
        TEST_ASSERT_EQUAL(MH_OK, w->tracker->init(&state, &w->gas, T));
        if (length > 0) {
            TEST_ASSERT_EQUAL(MH_OK, w->tracker->load(&state, carried, length));
        }
        measure(head, instant, &measurements[count++]);
        for (unsigned i = 0; i < NODES; i++) {
            if (i != head && hear_each_other(head, i)) {
                measure(i, instant, &measurements[count++]);
            }
        }
        done.heads[done.count++] = head;
        TEST_ASSERT_EQUAL(MH_OK, w->tracker->step(&state, instant, measurements, count, &estimate));
        const struct mh_place found = mh_place_from_offset(&estimate.origin, estimate.position);
        done.error_m = distance_m(&found, &source);
        done.rate = estimate.rate;
        calm = estimate.flags & MH_ESTIMATE_CALM ? calm + 1 : 0;
        unsigned next = head;
        mh_real highest = 0;
        for (unsigned i = 0; i < NODES; i++) {
            mh_real score;
            if (i != head && hear_each_other(head, i)) {
                TEST_ASSERT_EQUAL(MH_OK, w->tracker->score(&state, i, places, around(i, places), &score));
                if (next == head || score > highest) {
                    next = i;
                    highest = score;
                }
            }
        }
        head = next;
        TEST_ASSERT_EQUAL(MH_OK, w->tracker->save(&state, carried, &length));
    }
    done.converged = calm >= w->config.calm;
    return done;
}

/* ---- tests ---- */

static void without_losses_the_heads_are_those_of_the_walk(void)
{
    static const struct mh_tracker *const trackers[] = {&mh_tracker_gas, &mh_tracker_gas_small, &mh_tracker_gas_ukf,
                                                        &mh_tracker_gas_ekf};
    unsigned hops = 0, frames = 0;
    for (uint32_t seed = 1; seed <= 12; seed++) {
        prepare(trackers[seed % 4], seed % 8 < 4 ? LEVEL_A : LEVEL_M, seed);
        const struct walk ideal = walk();
        search(FIRST + (ideal.count + 4) * T);
        TEST_ASSERT_EQUAL(ideal.count, w->heads_count);
        TEST_ASSERT_EQUAL_MEMORY(ideal.heads, w->heads, ideal.count * sizeof ideal.heads[0]);
        TEST_ASSERT_EQUAL(ideal.converged ? MH_SEARCH_CONVERGED : MH_SEARCH_EXHAUSTED, w->state);
        TEST_ASSERT_EQUAL(ideal.count, w->told);
        TEST_ASSERT_TRUE(fabs(ideal.error_m - w->error_m) < 0.002); /* it travels in millimetres */
        TEST_ASSERT_TRUE(ideal.rate == w->rate);
        const struct mh_search_counters did = counters();
        TEST_ASSERT_EQUAL(1, did.begun);
        TEST_ASSERT_EQUAL(ideal.count, did.heads);
        TEST_ASSERT_EQUAL(ideal.count - 1, did.handed);
        TEST_ASSERT_EQUAL(0, did.refused + did.resumed + did.yielded + did.corrupt + did.sent_for);
        TEST_ASSERT_EQUAL(0, leading());
        hops += w->heads_count;
        frames += w->frames;
    }
    printf("  %u heads in 12 searches, %u frames a search\n", hops, frames / 12);
}

/* Searches from so many deployments. Returns how many found it. */
static unsigned searches(const struct mh_tracker *tracker, double noise, double loss, double corrupt, uint32_t runs)
{
    unsigned found = 0, hops = 0, resumed = 0, yielded = 0, sent_for = 0, frames = 0;
    for (uint32_t seed = 1; seed <= runs; seed++) {
        prepare(tracker, noise, 1000 + seed);
        w->loss = loss;
        w->corrupt = corrupt;
        search(330000);
        const struct mh_search_counters did = counters();
        found += found_it();
        hops += did.heads;
        resumed += did.resumed;
        yielded += did.yielded;
        sent_for += did.sent_for;
        frames += w->frames;
    }
    printf("  %s, noise %g, %.0f %% lost, %.0f %% corrupt: %u of %u found it, %.1f heads, %u frames, resumed %u, "
           "yielded %u, sent "
           "for %u\n",
           tracker->name, noise, 100 * loss, 100 * corrupt, found, (unsigned)runs, (double)hops / runs,
           frames / (unsigned)runs, resumed, yielded, sent_for);
    return found;
}

static void losses_leave_the_success_as_it_is(void)
{
    static const struct {
        const struct mh_tracker *tracker;
        double noise;
    } cases[] = {{&mh_tracker_gas, LEVEL_M}, {&mh_tracker_gas_ukf, LEVEL_A}, {&mh_tracker_gas_ukf, LEVEL_M}};
    const uint32_t runs = getenv("MOTEHOUND_LONG_TESTS") ? 200 : 34;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const unsigned without = searches(cases[i].tracker, cases[i].noise, 0, 0, runs);
        const unsigned with = searches(cases[i].tracker, cases[i].noise, 0.1, 0, runs);
        TEST_ASSERT_TRUE(100 * with + 3 * runs >= 100 * without);
    }
}

static void many_losses_and_corrupt_frames_are_borne(void)
{
    TEST_ASSERT_TRUE(searches(&mh_tracker_gas, LEVEL_A, 0.3, 0, 10) >= 9);
    TEST_ASSERT_TRUE(searches(&mh_tracker_gas, LEVEL_A, 0, 0.1, 10) == 10);
}

/* ---- who dies ---- */

static void kill(unsigned i) { w->motes[i].dead = true; }

/* Somebody leads: run until then, and return who. */
static unsigned run_until_head(mh_tick end)
{
    for (; w->now < end; run_until(w->now + 10)) {
        for (unsigned i = 0; i < NODES; i++) {
            if (!w->motes[i].dead && w->motes[i].protocol.role == MH_TOKEN_HEAD) {
                return i;
            }
        }
    }
    TEST_FAIL_MESSAGE("nobody leads");
    return 0;
}

/* The third head dies so long after its instant, or before if that is negative: the search goes on with what the one before it knew. */
static void a_head_dies_at(int32_t after, unsigned most_heads)
{
    for (uint32_t seed = 1; seed <= 6; seed++) {
        prepare(&mh_tracker_gas, LEVEL_M, 2000 + seed);
        const struct walk ideal = walk();
        come_up();
        run_until(FIRST + T + T / 2);
        TEST_ASSERT_EQUAL(1, leading());
        run_until((mh_tick)((int32_t)(FIRST + 2 * T) - 100));
        const unsigned head = run_until_head(w->now + 1);
        run_until((mh_tick)((int32_t)(FIRST + 2 * T) + after));
        kill(head);
        run_until(330000);
        const struct mh_search_counters did = counters();
        TEST_ASSERT_TRUE(found_it());
        TEST_ASSERT_EQUAL(1, did.resumed);
        TEST_ASSERT_EQUAL(1, did.begun);
        TEST_ASSERT_EQUAL(0, did.sent_for);
        TEST_ASSERT_TRUE(did.heads <= ideal.count + most_heads);
    }
}

static void a_head_that_dies_does_not_end_the_search(void)
{
    a_head_dies_at(-50, 15);  /* it has the token, and never asks */
    a_head_dies_at(300, 15);  /* it has asked */
    a_head_dies_at(1000, 15); /* it is about to choose the next */
}

/* The head dies while it hands the token over: the next has some of its parts. */
static void a_head_that_dies_half_way_does_not_end_the_search(void)
{
    for (uint32_t seed = 1; seed <= 6; seed++) {
        prepare(&mh_tracker_gas, LEVEL_M, 2100 + seed);
        come_up();
        run_until(FIRST + 3 * T);
        const unsigned head = run_until_head(w->now + 1);
        while (w->motes[head].protocol.part < 2) {
            TEST_ASSERT_TRUE(w->now < FIRST + 4 * T);
            run_until(w->now + 1);
        }
        TEST_ASSERT_TRUE(w->motes[head].protocol.handing);
        kill(head);
        run_until(330000);
        TEST_ASSERT_TRUE(found_it());
        TEST_ASSERT_EQUAL(1, counters().resumed);
    }
}

/* Whoever is to be next is dead already: another is chosen at once. */
static void the_token_is_not_handed_to_the_dead(void)
{
    for (uint32_t seed = 1; seed <= 6; seed++) {
        prepare(&mh_tracker_gas, LEVEL_M, 2200 + seed);
        come_up();
        run_until(FIRST + 2 * T);
        w->kills_next = true;
        run_until(330000);
        const struct mh_search_counters did = counters();
        TEST_ASSERT_TRUE(found_it());
        TEST_ASSERT_TRUE(did.refused >= 1);
        TEST_ASSERT_EQUAL(0, did.resumed);
    }
}

/* A head every 20 s, at any moment. */
static void heads_may_go_on_dying(void)
{
    unsigned found = 0, killed = 0, resumed = 0, sent_for = 0;
    for (uint32_t seed = 1; seed <= 10; seed++) {
        prepare(&mh_tracker_gas, LEVEL_M, 2300 + seed);
        w->loss = 0.05;
        come_up();
        for (mh_tick time = FIRST + 12000; time < 150000; time += 20000) {
            run_until(time + (mh_tick)(random_share() * 5000));
            for (unsigned i = 0; i < NODES; i++) {
                if (w->motes[i].protocol.role == MH_TOKEN_HEAD && !w->motes[i].dead) {
                    kill(i);
                    killed++;
                }
            }
        }
        run_until(420000);
        const struct mh_search_counters did = counters();
        found += found_it();
        resumed += did.resumed;
        sent_for += did.sent_for;
    }
    printf("  %u heads killed in 10 searches: %u found it, resumed %u, sent for %u\n", killed, found, resumed,
           sent_for);
    TEST_ASSERT_TRUE(killed >= 15);
    TEST_ASSERT_TRUE(found >= 9);
}

/* With who keeps its token the head dies too: the sink has another begin. */
static void head_and_keeper_die(void)
{
    for (uint32_t seed = 1; seed <= 4; seed++) {
        prepare(&mh_tracker_gas, LEVEL_M, 2400 + seed);
        come_up();
        run_until(FIRST + 3 * T + 300);
        const unsigned head = run_until_head(w->now + 1);
        kill(w->motes[head].protocol.guard);
        kill(head);
        run_until(420000);
        const struct mh_search_counters did = counters();
        TEST_ASSERT_TRUE(found_it());
        TEST_ASSERT_EQUAL(1, did.sent_for);
        TEST_ASSERT_EQUAL(2, did.begun);
        TEST_ASSERT_EQUAL(0, leading());
    }
}

static void who_is_to_begin_is_dead(void)
{
    for (uint32_t seed = 1; seed <= 4; seed++) {
        prepare(&mh_tracker_gas, LEVEL_M, 2500 + seed);
        come_up();
        kill(w->config.start);
        run_until(420000);
        TEST_ASSERT_TRUE(found_it());
        TEST_ASSERT_EQUAL(1, counters().begun);
        TEST_ASSERT_EQUAL(1, counters().sent_for);
    }
}

/* ---- two tokens ---- */

/* Who has begun restarts, after its neighbours have said their first hellos. */
static void who_has_begun_does_not_begin_again(void)
{
    for (uint32_t seed = 1; seed <= 4; seed++) {
        prepare(&mh_tracker_gas, LEVEL_M, 2800 + seed);
        come_up();
        run_until(65000);
        come_up_mote(w->config.start);
        run_until(330000);
        TEST_ASSERT_TRUE(found_it());
        TEST_ASSERT_EQUAL(0, counters().begun); /* with all else it has forgotten the first time */
        TEST_ASSERT_EQUAL(0, counters().yielded);
    }
}

static void have_begin(unsigned i)
{
    struct mh_message message = {.kind = MH_MESSAGE_TOKEN,
                                 .as.token = {.sender = SINK, .track = SINK, .holder = (int32_t)MH_BROADCAST}};
    uint8_t frame[MH_FRAME_MAX];
    size_t length;
    mh_geographic_address(&message, SINK, 77, i, &w->places[i]);
    TEST_ASSERT_EQUAL(MH_OK, mh_wire_encode(mh_wire_all, &message, frame, &length));
    TEST_ASSERT_EQUAL(MH_OK, mh_mote_frame(&w->motes[i].mote, w->now, frame, length));
    TEST_ASSERT_EQUAL(MH_TOKEN_HEAD, w->motes[i].protocol.role);
}

/* Somebody begins a second time; the sink stops that search, whether the first is still on its way or over. */
static void a_second_search_is_stopped(void)
{
    for (uint32_t seed = 1; seed <= 6; seed++) {
        prepare(&mh_tracker_gas, LEVEL_M, 2600 + seed);
        const struct walk ideal = walk();
        come_up();
        run_until(seed % 2 ? FIRST + 6 * T : FIRST + (ideal.count + 6) * T);
        have_begin(w->config.start);
        run_until(w->now + 12 * T);
        TEST_ASSERT_TRUE(counters().yielded >= 1);
        TEST_ASSERT_TRUE(leading() <= 1);
        run_until(420000);
        TEST_ASSERT_EQUAL(0, leading());
        TEST_ASSERT_TRUE(found_it());
        TEST_ASSERT_EQUAL(1, counters().converged);
    }
}

/* The place nearest to which somebody is to begin is given, and nobody begins by himself. */
static void the_sink_begins_the_search(void)
{
    prepare(&mh_tracker_gas, LEVEL_A, 2700);
    w->config.start = MH_BROADCAST;
    search(200000);
    TEST_ASSERT_TRUE(found_it());
    TEST_ASSERT_EQUAL(1, counters().begun);
    double nearest_m = 1e9;
    for (unsigned i = 0; i < NODES; i++) {
        nearest_m = fmin(nearest_m, distance_m(&w->places[i], &w->config.start_place));
    }
    TEST_ASSERT_TRUE(distance_m(&w->places[w->heads[0]], &w->config.start_place) == nearest_m);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(without_losses_the_heads_are_those_of_the_walk);
    RUN_TEST(losses_leave_the_success_as_it_is);
    RUN_TEST(many_losses_and_corrupt_frames_are_borne);
    RUN_TEST(a_head_that_dies_does_not_end_the_search);
    RUN_TEST(a_head_that_dies_half_way_does_not_end_the_search);
    RUN_TEST(the_token_is_not_handed_to_the_dead);
    RUN_TEST(heads_may_go_on_dying);
    RUN_TEST(head_and_keeper_die);
    RUN_TEST(who_is_to_begin_is_dead);
    RUN_TEST(who_has_begun_does_not_begin_again);
    RUN_TEST(a_second_search_is_stopped);
    RUN_TEST(the_sink_begins_the_search);
    port_exit(UNITY_END() > 0);
    return 0;
}
