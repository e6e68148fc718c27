/* Motes under anything that can happen: random bytes, damaged and repeated frames, readings and alarms in no order, jumping
 * clocks. Nothing may crash (build with -fsanitize=address,undefined to see more) and what is promised must hold. */
#include "motehound/collection.h"
#include "motehound/direct.h"
#include "motehound/mote.h"
#include "port.h"
#include "unity.h"

#include <string.h>

enum { MOTES = 3, HEAD = 0, POOL = 64, STEPS = 200000 };

/* The frames on the air. */
static struct {
    uint8_t bytes[MH_FRAME_MAX];
    size_t length;
} pool[POOL];
static unsigned pool_next;

static uint64_t random_state;
static unsigned alarms[MOTES], sent[MOTES];
static struct mh_mote motes[MOTES];
static bool tracks;

static uint32_t draw(uint32_t limit)
{
    random_state = random_state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)((random_state >> 32) * limit >> 32);
}

static void transmit(void *context, mh_node_id destination, const uint8_t *frame, size_t length)
{
    struct mh_message message;
    (void)destination;
    sent[(struct mh_mote *)context - motes]++;
    TEST_ASSERT_LESS_OR_EQUAL(MH_FRAME_MAX, length);
    TEST_ASSERT_EQUAL(
        MH_OK, mh_wire_decode(mh_wire_all, frame, length, &message)); /* whatever came in, only sound frames go out */
    memcpy(pool[pool_next].bytes, frame, length);
    pool[pool_next].length = length;
    pool_next = (pool_next + 1) % POOL;
}

static void set_alarm(void *context, mh_tick time)
{
    (void)time;
    alarms[(struct mh_mote *)context - motes]++;
}

static void report(void *context, const struct mh_estimate *estimate)
{
    (void)context;
    (void)estimate;
}

static const struct mh_port port = {.transmit = transmit, .set_alarm = set_alarm, .report = report};

static enum mh_status tracker_init(void *state, const void *config, mh_tick interval)
{
    (void)state;
    (void)config;
    (void)interval;
    return MH_OK;
}

/* Checks what tracker.h promises to every tracker. */
static enum mh_status tracker_step(void *state, mh_tick time, const struct mh_measurement *measurements, size_t count,
                                   struct mh_estimate *estimate)
{
    mh_tick *last = state;
    for (size_t i = 0; i < count; i++) {
        TEST_ASSERT_TRUE(mh_tick_before(*last, measurements[i].time));
        TEST_ASSERT_FALSE(mh_tick_before(time, measurements[i].time));
        for (size_t j = 0; j < i; j++) {
            TEST_ASSERT_FALSE(mh_tick_before(measurements[i].time, measurements[j].time));
            TEST_ASSERT_FALSE(measurements[i].node == measurements[j].node &&
                              measurements[i].target == measurements[j].target);
        }
    }
    *last = time;
    tracks = draw(10) == 0 ? !tracks : tracks;
    memset(estimate, 0, sizeof *estimate);
    return tracks ? MH_OK : MH_NONE;
}

static enum mh_status tracker_predict(const void *state, mh_tick time, struct mh_estimate *expected)
{
    (void)state;
    (void)time;
    (void)expected;
    return tracks ? MH_OK : MH_NONE;
}

static enum mh_status tracker_interest(const void *state, struct mh_interest *interest)
{
    (void)state;
    interest->centre.x_mm = (int32_t)draw(2000000001u) - 1000000000;
    interest->centre.y_mm = (int32_t)draw(2000000001u) - 1000000000;
    interest->centre.z_mm = 0;
    interest->radius_mm = draw(UINT32_MAX);
    return draw(2) ? MH_OK : MH_NONE;
}

static const struct mh_tracker tracker = {.name = "check",
                                          .state_size = sizeof(mh_tick),
                                          .init = tracker_init,
                                          .step = tracker_step,
                                          .predict = tracker_predict,
                                          .interest = tracker_interest};

static void hurt(struct mh_mote *mote, mh_tick now)
{
    uint8_t frame[MH_FRAME_MAX + 1];
    size_t length = draw(MH_FRAME_MAX + 2);
    const unsigned from = draw(POOL);
    const unsigned damage = draw(4);
    for (size_t i = 0; i < length; i++) {
        frame[i] = (uint8_t)draw(256);
    }
    if (damage > 0) { /* else it stays noise */
        length = pool[from].length;
        memcpy(frame, pool[from].bytes, length);
    }
    if (damage == 2 && length > 10) { /* random fields under a right check sum */
        for (unsigned changes = 1 + draw(4); changes > 0; changes--) {
            frame[8 + draw((uint32_t)length - 10)] = (uint8_t)draw(256);
        }
        const uint16_t fcs = mh_wire_fcs(frame, length - 2);
        frame[length - 2] = (uint8_t)(fcs & 0xFFu);
        frame[length - 1] = (uint8_t)(fcs >> 8);
    } else if (damage == 3 && length > 0) {
        frame[draw((uint32_t)length)] = (uint8_t)draw(256);
    }
    (void)mh_mote_frame(mote, now, frame, length);
}

static void run(const struct mh_protocol *protocol, const void *protocol_config, bool with_clocks, uint64_t seed)
{
    static struct mh_clock clocks[MOTES];
    static const struct mh_clock_config root = {.root = true, .period = 2000, .wait = 100, .sent_q8 = 128};
    static const struct mh_clock_config other = {.period = 2000, .wait = 100, .sent_q8 = 128};
    static struct mh_collection collections[MOTES];
    static struct mh_direct directs[MOTES];
    static struct mh_head head;
    static mh_tick last;
    const struct mh_sensor_config sensor = {
        .q20_per_count = 1000, .counts_min = INT32_MIN, .counts_max = INT32_MAX, .interval = 1000, .threshold = 5000};
    mh_tick now = (mh_tick)0 - 100000;
    const struct mh_head_config head_config = {&tracker, "", &last, now, 1000, 500, 0, false, 0};
    struct mh_mote_config configs[MOTES];
    random_state = seed;
    last = now - 1000;
    memset(pool, 0, sizeof pool);
    memset(sent, 0, sizeof sent);
    for (unsigned i = 0; i < MOTES; i++) {
        const struct mh_mote_config config = {
            .id = i,
            .place = {(int32_t)(i * 10000), 0, 0},
            .sensor = &sensor,
            .head = i == HEAD ? &head_config : NULL,
            .protocol = protocol,
            .protocol_config = protocol_config,
            .protocol_state = protocol == &mh_protocol_direct ? (void *)&directs[i] : (void *)&collections[i],
            .head_state = i == HEAD ? &head : NULL,
            .clock = with_clocks ? &mh_clock_flooding : NULL,
            .clock_config = i == HEAD ? &root : &other,
            .clock_state = &clocks[i]};
        configs[i] = config;
        TEST_ASSERT_EQUAL(MH_OK, mh_mote_init(&motes[i], &configs[i], &port, &motes[i], now));
    }
    for (unsigned step = 0; step < STEPS; step++) {
        struct mh_mote *mote = &motes[draw(MOTES)];
        now += draw(20);
        now += draw(5000) == 0 ? draw(100000) : 0;           /* asleep for long */
        now += step == STEPS / 4 * 3 ? draw(UINT32_MAX) : 0; /* a clock set anew */
        const unsigned what = draw(with_clocks ? 4 : 3);
        const unsigned before = sent[mote - motes];
        if (what == 0) {
            hurt(mote, now);
        } else if (what == 1) {
            const struct mh_reading reading = {now - draw(6000) + (draw(50) == 0 ? draw(UINT32_MAX) : 0),
                                               (int32_t)draw(UINT32_MAX) / (draw(2) ? 1 : 1000000), (uint8_t)draw(2)};
            (void)mh_mote_reading(mote, now, &reading);
        } else if (what == 3) {
            mh_mote_sent(mote, now, (enum mh_sent)draw(3));
        } else {
            const unsigned set_before = alarms[mote - motes];
            mh_mote_alarm(mote, now);
            TEST_ASSERT_EQUAL(with_clocks                                               ? alarms[mote - motes]
                              : protocol == &mh_protocol_direct && mote != &motes[HEAD] ? set_before
                                                                                        : set_before + 1,
                              alarms[mote - motes]);
        }
        TEST_ASSERT_LESS_OR_EQUAL(before + 5, sent[mote - motes]); /* no event sets off a burst */
        TEST_ASSERT_LESS_OR_EQUAL(MH_REPORTS_MAX, head.count);
    }
    TEST_ASSERT_GREATER_THAN(100, sent[HEAD]);
    TEST_ASSERT_GREATER_THAN(100, head.counters.measurements);
    TEST_ASSERT_GREATER_THAN(100, motes[HEAD].counters.frames_corrupt);
}

void setUp(void) {}
void tearDown(void) {}

static void clocks_stand_anything(void)
{
    struct mh_collection_config config;
    mh_collection_config_default(&config);
    for (uint64_t seed = 1; seed <= 3; seed++) {
        run(&mh_protocol_collection, &config, true, seed);
    }
}

static void collection_stands_anything(void)
{
    struct mh_collection_config config;
    mh_collection_config_default(&config);
    for (uint64_t seed = 1; seed <= 3; seed++) {
        run(&mh_protocol_collection, &config, false, seed);
    }
}

static void direct_stands_anything(void)
{
    struct mh_direct_config config;
    mh_direct_config_default(&config);
    for (uint64_t seed = 1; seed <= 3; seed++) {
        run(&mh_protocol_direct, &config, false, seed);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(collection_stands_anything);
    RUN_TEST(clocks_stand_anything);
    RUN_TEST(direct_stands_anything);
    port_exit(UNITY_END() > 0);
    return 0;
}
