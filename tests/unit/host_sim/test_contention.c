/* The radio with contention, on networks small enough to know by hand what must happen. */
#include "port.h"
#include "radio/radio.h"
#include "unity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOTES_MAX = 64, LOG_MAX = 4000 };

static struct radio radio;
static uint8_t bytes[MH_FRAME_MAX];

static struct told {
    unsigned on_air[MOTES_MAX], heard[MOTES_MAX], outcomes[MOTES_MAX][3];
    sim_time last_on_air, last_heard, last_sent;
    unsigned states;
    struct {
        sim_time time;
        uint32_t mote;
        enum radio_state state;
    } state[LOG_MAX];
} told;

static void on_air(void *context, sim_time time, uint32_t sender, uint32_t destination, const uint8_t *frame,
                   size_t length)
{
    (void)context;
    (void)destination;
    (void)frame;
    (void)length;
    told.on_air[sender]++;
    told.last_on_air = time;
}

static void heard(void *context, sim_time time, const uint8_t *frame, size_t length, const uint32_t *receivers,
                  uint32_t count)
{
    (void)context;
    TEST_ASSERT_EQUAL_INT(0, memcmp(frame, bytes, length));
    TEST_ASSERT_TRUE(count > 0);
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t j = 0; j < i; j++) {
            TEST_ASSERT_NOT_EQUAL(receivers[j], receivers[i]);
        }
        told.heard[receivers[i]]++;
    }
    told.last_heard = time;
}

static void sent(void *context, sim_time time, uint32_t sender, enum mh_sent outcome)
{
    (void)context;
    told.outcomes[sender][outcome]++;
    told.last_sent = time;
}

static void state(void *context, sim_time time, uint32_t mote, enum radio_state what, uint8_t cause)
{
    (void)context;
    (void)cause;
    TEST_ASSERT_TRUE(told.states < LOG_MAX);
    told.state[told.states].time = time;
    told.state[told.states].mote = mote;
    told.state[told.states++].state = what;
}

static const struct radio_sink sink = {.on_air = on_air, .heard = heard, .sent = sent};
static const struct radio_sink sink_with_states = {.on_air = on_air, .heard = heard, .sent = sent, .state = state};

void setUp(void)
{
    memset(&told, 0, sizeof told);
    for (unsigned i = 0; i < sizeof bytes; i++) {
        bytes[i] = (uint8_t)(7 * i + 1);
    }
    radio = (struct radio){0};
}

void tearDown(void) { radio_free(&radio); }

static struct radio_config disc(const char *profile)
{
    return (struct radio_config){
        .profile = *radio_profile_find(profile), .propagation = {.kind = PROPAGATION_DISC, .range_m = 100}, .queue = 8};
}

static struct radio_config log_distance(const char *profile)
{
    struct radio_config config = disc(profile);
    config.propagation =
        (struct propagation_config){.kind = PROPAGATION_LOG_DISTANCE, .exponent = 3, .reference_loss_db = 46.68};
    return config;
}

static void make(const struct radio_config *config, const double *x_m, size_t count)
{
    const double y_m[MOTES_MAX] = {0};
    TEST_ASSERT_EQUAL_INT(0, radio_make(&radio, config, x_m, y_m, count, 1));
}

static void send(sim_time time, uint32_t sender, uint32_t destination, size_t length)
{
    TEST_ASSERT_EQUAL_INT(0, radio_send(&radio, time, sender, destination, bytes, length, 3));
}

static void run(sim_time until) { TEST_ASSERT_EQUAL_INT(0, radio_run(&radio, until, &sink)); }

/* No backoff: a frame that comes at t is on the air at t + 128 + 192 us, if the channel is free. */
static struct radio_config at_once(struct radio_config config)
{
    memset(config.profile.backoff_exponents, 0, sizeof config.profile.backoff_exponents);
    return config;
}

/* 45 bytes, 1,440 us: heard 1,760 us after it came, acknowledged 192 + 352 us later. */
static void times_of_a_unicast(void)
{
    const struct radio_config config = at_once(disc("802154"));
    const double x_m[] = {0, 50};
    make(&config, x_m, 2);
    send(1000, 0, 1, 30);
    run(SIM_TIME_NEVER);
    TEST_ASSERT_EQUAL_UINT(1320, told.last_on_air);
    TEST_ASSERT_EQUAL_UINT(2760, told.last_heard);
    TEST_ASSERT_EQUAL_UINT(3304, told.last_sent);
    TEST_ASSERT_EQUAL_UINT(1, told.outcomes[0][MH_SENT_OK]);
    TEST_ASSERT_EQUAL_UINT(1, radio.counters.acks_sent);
}

/* On the CC1000: 350 + 250 us, then 46 bytes in 19,167 us; then 250 us and 16 bytes in 6,667 us. */
static void times_of_a_unicast_of_cc1000(void)
{
    struct radio_config config = at_once(disc("cc1000"));
    config.profile.least_units = 0;
    const double x_m[] = {0, 50};
    make(&config, x_m, 2);
    send(0, 0, 1, 31);
    run(SIM_TIME_NEVER);
    TEST_ASSERT_EQUAL_UINT(600, told.last_on_air);
    TEST_ASSERT_EQUAL_UINT(19767, told.last_heard);
    TEST_ASSERT_EQUAL_UINT(26684, told.last_sent);
    TEST_ASSERT_EQUAL_UINT(1, told.outcomes[0][MH_SENT_OK]);
}

/* Nobody there: one transmission and three repetitions. */
static void gives_up_without_acknowledgement(void)
{
    const struct radio_config config = at_once(disc("802154"));
    const double x_m[] = {0, 150};
    make(&config, x_m, 2);
    send(0, 0, 1, 30);
    run(SIM_TIME_NEVER);
    TEST_ASSERT_EQUAL_UINT(4, told.on_air[0]);
    TEST_ASSERT_EQUAL_UINT(3, radio.counters.frames_repeated);
    TEST_ASSERT_EQUAL_UINT(4, radio.counters.lost[LOSS_RANGE]);
    TEST_ASSERT_EQUAL_UINT(1, radio.counters.lost[LOSS_NO_ACK]);
    TEST_ASSERT_EQUAL_UINT(1, told.outcomes[0][MH_SENT_NO_ACK]);
    TEST_ASSERT_EQUAL_UINT(4 * (320 + 1440 + 864), told.last_sent);
}

/* With loss p each way a try succeeds with s = (1 - p)^2. Over F frames: F s (1 + q + q^2 + q^3) acknowledged, q = 1 - s; tries F (1 - q^4) / s; the
 * addressee's radio receives (1 - p) of the tries and hands each frame over once. */
static void losses_are_made_up_for(void)
{
    enum { FRAMES = 5000 };
    const double p = 0.3, s = (1 - p) * (1 - p), q = 1 - s;
    struct radio_config config = disc("802154");
    config.channel.loss = p;
    const double x_m[] = {0, 50};
    make(&config, x_m, 2);
    for (unsigned i = 0; i < FRAMES; i++) {
        send(i * 100000, 0, 1, 30);
    }
    run(SIM_TIME_NEVER);
    const double given_up = pow(q, 4), tries = (1 - given_up) / s;
    TEST_ASSERT_TRUE(fabs(told.outcomes[0][MH_SENT_NO_ACK] - FRAMES * given_up) < 4 * sqrt(FRAMES * given_up));
    TEST_ASSERT_EQUAL_UINT(FRAMES, told.outcomes[0][MH_SENT_OK] + told.outcomes[0][MH_SENT_NO_ACK]);
    TEST_ASSERT_TRUE(fabs(told.on_air[0] - FRAMES * tries) < 4 * sqrt(FRAMES * q) / s);
    const uint64_t received = radio.counters.frames_received + radio.counters.frames_duplicate;
    TEST_ASSERT_TRUE(fabs((double)received - told.on_air[0] * (1 - p)) < 4 * sqrt(told.on_air[0] * p * (1 - p)));
    TEST_ASSERT_EQUAL_UINT(told.on_air[0], received + radio.counters.lost[LOSS_RANDOM]);
    TEST_ASSERT_EQUAL_UINT(radio.counters.acks_sent, received);
    TEST_ASSERT_EQUAL_UINT(radio.counters.acks_lost, received - told.outcomes[0][MH_SENT_OK]);
    const double unheard = pow(p, 4); /* share of the frames that none of four tries brings over */
    TEST_ASSERT_EQUAL_UINT(told.heard[1], radio.counters.frames_received);
    TEST_ASSERT_TRUE(fabs(FRAMES - told.heard[1] - FRAMES * unheard) < 4 * sqrt(FRAMES * unheard));
}

/* Two who do not hear each other; one between them, all in range. */
static void hidden_motes_collide(void)
{
    const struct radio_config config = at_once(disc("802154"));
    const double x_m[] = {0, 90, 180};
    make(&config, x_m, 3);
    send(0, 0, RADIO_ALL, 30);
    send(1439, 2, RADIO_ALL, 30); /* its first bit meets the other's last */
    run(SIM_TIME_NEVER);
    TEST_ASSERT_EQUAL_UINT(0, told.heard[1]);
    TEST_ASSERT_EQUAL_UINT(2, radio.counters.lost[LOSS_COLLISION]);
    send(100000, 0, RADIO_ALL, 30);
    send(101440, 2, RADIO_ALL, 30);
    run(SIM_TIME_NEVER);
    TEST_ASSERT_EQUAL_UINT(2, told.heard[1]);
    TEST_ASSERT_EQUAL_UINT(2, radio.counters.lost[LOSS_COLLISION]);
}

/* Who hears a frame waits: 4 further backoffs of no length, each with its assessment, then the frame is given up. One backoff
 * more than the frame lasts gets through. */
static void carrier_sense(void)
{
    struct radio_config config = at_once(disc("802154"));
    const double x_m[] = {0, 50};
    make(&config, x_m, 2);
    send(0, 0, RADIO_ALL, 100); /* on the air from 320 to 320 + 115 x 32 = 4,000 us */
    send(400, 1, RADIO_ALL, 30);
    run(SIM_TIME_NEVER);
    TEST_ASSERT_EQUAL_UINT(0, told.on_air[1]);
    TEST_ASSERT_EQUAL_UINT(1, told.outcomes[1][MH_SENT_BUSY]);
    TEST_ASSERT_EQUAL_UINT(1, radio.counters.lost[LOSS_BUSY]);
    TEST_ASSERT_EQUAL_UINT(4000, told.last_heard);
    radio_free(&radio);
    config.profile.backoffs = 100;
    make(&config, x_m, 2);
    send(0, 0, RADIO_ALL, 100);
    send(400, 1, RADIO_ALL, 30);
    run(SIM_TIME_NEVER);
    TEST_ASSERT_EQUAL_UINT(1, told.on_air[1]);
    /* The first assessment that lies wholly after 4,000: from 400 + 29 x 128 = 4,112. */
    TEST_ASSERT_EQUAL_UINT(4112 + 128 + 192, told.last_on_air);
}

/* The channel is assessed before the radio turns round: whoever follows within 192 us does not notice the other. */
static void turnaround_is_a_blind_spot(void)
{
    const struct radio_config config = at_once(disc("802154"));
    const double x_m[] = {0, 50, 60};
    make(&config, x_m, 3);
    send(0, 0, RADIO_ALL, 30);
    send(192, 1, RADIO_ALL, 30);
    run(100000);
    TEST_ASSERT_EQUAL_UINT(1, told.on_air[1]);
    TEST_ASSERT_EQUAL_UINT(2, radio.counters.lost[LOSS_COLLISION]); /* at mote 2 */
    TEST_ASSERT_EQUAL_UINT(2, radio.counters.lost[LOSS_DEAF]);      /* each other's */
    send(200000, 0, RADIO_ALL, 30);
    send(200193, 1, RADIO_ALL, 30);
    run(200320 + 1440 + 1);
    TEST_ASSERT_EQUAL_UINT(1, told.on_air[1]);
    TEST_ASSERT_EQUAL_UINT(1, told.heard[2]);
}

/* Receiver at 0. A signal from 10 m arrives with -76.68 dBm, one from d metres 30 lg(d / 10) dB weaker: 3 dB at 12.589 m. Both
 * start together. */
static void stronger_one_is_captured(void)
{
    const struct radio_config config = at_once(log_distance("802154"));
    for (unsigned i = 0; i < 2; i++) {
        const double x_m[] = {0, 10, i == 0 ? -12.5 : -12.7};
        make(&config, x_m, 3);
        memset(&told, 0, sizeof told);
        send(0, 1, RADIO_ALL, 30);
        send(10, 2, RADIO_ALL, 30);
        run(SIM_TIME_NEVER);
        TEST_ASSERT_EQUAL_UINT(i, told.heard[0]);
        radio_free(&radio);
    }
}

/* The same when the stronger one comes later, and when it disturbs a part of the frame only. */
static void stronger_later_one_is_captured(void)
{
    struct radio_config config = at_once(log_distance("802154"));
    config.profile.cca_threshold_db = 100; /* nobody finds the channel busy */
    const double x_m[] = {0, 10, -14};
    make(&config, x_m, 3);
    send(0, 2, RADIO_ALL, 30);
    send(1000, 1, RADIO_ALL, 30);
    run(SIM_TIME_NEVER);
    TEST_ASSERT_EQUAL_UINT(1, told.heard[0]);
    TEST_ASSERT_EQUAL_UINT(1, radio.counters.lost[LOSS_COLLISION]);
}

/* Two disturb, each 5 dB weaker than the signal: together 2 dB weaker. Not at the same time, they do no harm. */
static void interference_adds_up(void)
{
    struct radio_config config = at_once(log_distance("802154"));
    config.profile.cca_threshold_db = 100;
    const double d_m = 10 * pow(10, 5 / 30.0), x_m[] = {0, 10, -d_m, -d_m};
    make(&config, x_m, 4);
    send(0, 1, RADIO_ALL, 100); /* 3,680 us */
    send(500, 2, RADIO_ALL, 10);
    send(1300, 3, RADIO_ALL, 10); /* the other one's 800 us are over */
    run(SIM_TIME_NEVER);
    TEST_ASSERT_EQUAL_UINT(1, told.heard[0]);
    send(100000, 1, RADIO_ALL, 100);
    send(100500, 2, RADIO_ALL, 10);
    send(101299, 3, RADIO_ALL, 10);
    run(SIM_TIME_NEVER);
    TEST_ASSERT_EQUAL_UINT(1, told.heard[0]);
}

/* Sensitivity -95 dBm is reached at 10^((95 - 46.68) / 30) = 40.80 m, signal to noise is 5 dB there. An interferer may add up to
 * 10^0.2 - 1 = 0.585 of the noise: at 2.3 dB below it, so -102.33 dBm, from 71.65 m. */
static void weak_signals_bear_little(void)
{
    const struct radio_config config = at_once(log_distance("802154"));
    const double edge_m = pow(10, (95 - 46.68) / 30);
    for (unsigned i = 0; i < 4; i++) {
        const double x_m[] = {0, i == 0 ? edge_m + 0.01 : edge_m - 0.001, i == 2 ? -71.5 : i == 3 ? -71.8 : -1e4};
        make(&config, x_m, 3);
        memset(&told, 0, sizeof told);
        send(0, 1, RADIO_ALL, 30);
        send(0, 2, RADIO_ALL, 30);
        run(SIM_TIME_NEVER);
        TEST_ASSERT_EQUAL_UINT(i == 1 || i == 3, told.heard[0]);
        radio_free(&radio);
    }
}

/* Who sends hears nothing, to the end of its turnaround. */
static void half_duplex(void)
{
    struct radio_config config = at_once(log_distance("802154"));
    config.profile.cca_threshold_db = 100; /* nobody finds the channel busy */
    const double x_m[] = {0, 30, 60};
    make(&config, x_m, 3);
    send(0, 1, RADIO_ALL, 30);        /* 320 ... 1,760 */
    send(1760 + 191 - 320, 0, 1, 30); /* begins before mote 1 has turned round, and has turned before that has ended */
    run(1760 + 191 + 1440 + 1);
    TEST_ASSERT_EQUAL_UINT(2, radio.counters.lost[LOSS_DEAF]);
    TEST_ASSERT_EQUAL_UINT(0, told.heard[1]);
    run(50000);
    TEST_ASSERT_EQUAL_UINT(1, told.heard[1]); /* repeated */
    send(100000, 1, RADIO_ALL, 30);
    send(101760 + 192 - 320, 0, 1, 30); /* begins when it has */
    run(101760 + 192 + 1440 + 1);
    TEST_ASSERT_EQUAL_UINT(2, radio.counters.lost[LOSS_DEAF]);
    TEST_ASSERT_EQUAL_UINT(2, told.heard[1]);
}

static void queue_is_bounded_and_answers_in_order(void)
{
    struct radio_config config = disc("802154");
    config.queue = 3;
    const double x_m[] = {0, 50};
    make(&config, x_m, 2);
    for (unsigned i = 0; i < 5; i++) {
        send(0, 0, 1, 30);
    }
    run(SIM_TIME_NEVER);
    TEST_ASSERT_EQUAL_UINT(3, told.heard[1]);
    TEST_ASSERT_EQUAL_UINT(3, told.outcomes[0][MH_SENT_OK]);
    TEST_ASSERT_EQUAL_UINT(2, told.outcomes[0][MH_SENT_BUSY]);
    TEST_ASSERT_EQUAL_UINT(2, radio.counters.lost[LOSS_QUEUE]);
}

static void sleeping_and_dead_motes_hear_nothing(void)
{
    const struct radio_config config = at_once(disc("802154"));
    const double x_m[] = {0, 50, 60, 70};
    make(&config, x_m, 4);
    radio_power(&radio, 0, 1, RADIO_POWER_ASLEEP);
    radio_power(&radio, 0, 2, RADIO_POWER_OFF);
    radio_power(&radio, 0, 3, RADIO_POWER_ASLEEP);
    radio_power(&radio, 400, 3, RADIO_POWER_ON); /* after the first bit */
    send(0, 0, RADIO_ALL, 30);
    run(50000);
    TEST_ASSERT_EQUAL_UINT(2, radio.counters.lost[LOSS_ASLEEP]);
    TEST_ASSERT_EQUAL_UINT(1, radio.counters.lost[LOSS_DEAD]);
    send(100000, 2, RADIO_ALL, 30); /* off: nothing happens */
    send(100000, 1, 3, 30);         /* wakes to send, and hears the acknowledgement */
    run(SIM_TIME_NEVER);
    TEST_ASSERT_EQUAL_UINT(0, told.on_air[2]);
    TEST_ASSERT_EQUAL_UINT(1, told.outcomes[1][MH_SENT_OK]);
}

static void frame_of_a_mote_that_dies_is_a_wreck(void)
{
    const struct radio_config config = at_once(disc("802154"));
    const double x_m[] = {0, 50};
    make(&config, x_m, 2);
    send(0, 0, RADIO_ALL, 30);
    send(0, 0, RADIO_ALL, 30);
    radio_power(&radio, 1000, 0, RADIO_POWER_OFF);
    radio_power(&radio, 1100, 0, RADIO_POWER_ON);
    send(5000, 0, RADIO_ALL, 30);
    run(SIM_TIME_NEVER);
    TEST_ASSERT_EQUAL_UINT(2, told.on_air[0]);
    TEST_ASSERT_EQUAL_UINT(1, told.heard[1]);
    TEST_ASSERT_EQUAL_UINT(1, radio.counters.lost[LOSS_DEAD]);
    TEST_ASSERT_EQUAL_UINT(1, told.outcomes[0][MH_SENT_OK]);
}

static double time_in(uint32_t mote, enum radio_state what, sim_time until)
{
    sim_time since = 0, total = 0;
    enum radio_state now = RADIO_LISTEN;
    for (unsigned i = 0; i < told.states; i++) {
        if (told.state[i].mote == mote) {
            total += now == what ? told.state[i].time - since : 0;
            since = told.state[i].time;
            now = told.state[i].state;
        }
    }
    return (double)(total + (now == what ? until - since : 0));
}

/* One unicast with its acknowledgement: who sends what for how long, and who is awake meanwhile. */
static void states_add_up(void)
{
    const struct radio_config config = at_once(disc("802154"));
    const double x_m[] = {0, 50, 60};
    make(&config, x_m, 3);
    radio_power(&radio, 0, 0, RADIO_POWER_ASLEEP);
    send(10000, 0, 1, 30);
    TEST_ASSERT_EQUAL_INT(0, radio_run(&radio, 20000, &sink_with_states));
    for (unsigned i = 1; i < told.states; i++) {
        TEST_ASSERT_TRUE(told.state[i].time >= told.state[i - 1].time);
    }
    TEST_ASSERT_TRUE(time_in(0, RADIO_TRANSMIT, 20000) == 1440);
    TEST_ASSERT_TRUE(time_in(0, RADIO_RECEIVE, 20000) == 352);
    TEST_ASSERT_TRUE(time_in(0, RADIO_LISTEN, 20000) == 320 + 192);
    TEST_ASSERT_TRUE(time_in(0, RADIO_SLEEP, 20000) == 20000 - 1440 - 352 - 320 - 192);
    TEST_ASSERT_TRUE(time_in(1, RADIO_RECEIVE, 20000) == 1440);
    TEST_ASSERT_TRUE(time_in(1, RADIO_TRANSMIT, 20000) == 352);
    TEST_ASSERT_TRUE(time_in(2, RADIO_RECEIVE, 20000) == 1440 + 352);
    TEST_ASSERT_TRUE(time_in(2, RADIO_LISTEN, 20000) == 20000 - 1440 - 352);
}

enum { WAKE_PERIOD = 250000, WAKE_LENGTH = 10000 };

static struct radio_config waking(struct radio_config config)
{
    config.wake_period = WAKE_PERIOD;
    config.wake_length = WAKE_LENGTH;
    return config;
}

/* The first bit, 320 us after the frame came, decides: into a window, or one microsecond beside it. Mote 2 sleeps from mid-frame, mote 3 is switched on
 * within the window but after the first bit. */
static void who_sleeps_hears_what_begins_in_a_window(void)
{
    const struct radio_config config = waking(at_once(disc("802154")));
    const double x_m[] = {0, 50, 60, 70};
    make(&config, x_m, 4);
    radio_power(&radio, 0, 1, RADIO_POWER_ASLEEP);
    radio_power(&radio, 0, 3, RADIO_POWER_OFF);
    const sim_time window = 3 * WAKE_PERIOD;
    send(window - 321, 0, RADIO_ALL, 30);
    radio_power(&radio, window + 100, 2, RADIO_POWER_ASLEEP);
    run(window + 8000);
    TEST_ASSERT_EQUAL_UINT(0, told.heard[1] + told.heard[2]);
    TEST_ASSERT_EQUAL_UINT(2, radio.counters.lost[LOSS_ASLEEP]);
    radio_power(&radio, window + 9999 + 1, 3, RADIO_POWER_ASLEEP);
    send(window + 9999 - 320, 0, RADIO_ALL, 30);
    run(window + 20000);
    TEST_ASSERT_EQUAL_UINT(1, told.heard[1]);
    TEST_ASSERT_EQUAL_UINT(1, told.heard[2]);
    TEST_ASSERT_EQUAL_UINT(0, told.heard[3]);
    TEST_ASSERT_EQUAL_UINT(3, radio.counters.lost[LOSS_ASLEEP]);
    send(2 * window - 320, 0, RADIO_ALL, 30);
    radio_power(&radio, 2 * window + 500, 2, RADIO_POWER_ON);
    radio_power(&radio, 2 * window + 600, 3, RADIO_POWER_OFF);
    radio_power(&radio, 2 * window + 700, 3, RADIO_POWER_ON);
    run(2 * window + 8000);
    TEST_ASSERT_EQUAL_UINT(2, told.heard[1]);
    TEST_ASSERT_EQUAL_UINT(2, told.heard[2]);
    TEST_ASSERT_EQUAL_UINT(0, told.heard[3]);
    send(2 * window + WAKE_LENGTH - 320, 0, RADIO_ALL, 30);
    run(3 * window - 1000);
    TEST_ASSERT_EQUAL_UINT(2, told.heard[1]);
    TEST_ASSERT_EQUAL_UINT(3, told.heard[2]); /* awake */
}

/* It receives to the end, long after the window, acknowledges, is open for as long as a window from the frame's end, and sleeps again; windows without
 * a frame are no changes. */
static void who_is_woken_acknowledges(void)
{
    const struct radio_config config = waking(at_once(disc("802154")));
    const double x_m[] = {0, 50, 60};
    make(&config, x_m, 3);
    radio_power(&radio, 0, 1, RADIO_POWER_ASLEEP);
    radio_power(&radio, 0, 2, RADIO_POWER_ASLEEP);
    send(WAKE_PERIOD + 9999 - 320, 0, 1, 30);
    TEST_ASSERT_EQUAL_INT(0, radio_run(&radio, 8 * WAKE_PERIOD, &sink_with_states));
    TEST_ASSERT_EQUAL_UINT(1, told.heard[1]);
    TEST_ASSERT_EQUAL_UINT(1, told.outcomes[0][MH_SENT_OK]);
    TEST_ASSERT_EQUAL_UINT(WAKE_PERIOD + 9999 + 1440 + 192 + 352, told.last_sent);
    TEST_ASSERT_TRUE(time_in(1, RADIO_RECEIVE, 8 * WAKE_PERIOD) == 1440);
    TEST_ASSERT_TRUE(time_in(1, RADIO_TRANSMIT, 8 * WAKE_PERIOD) == 352);
    TEST_ASSERT_TRUE(time_in(1, RADIO_LISTEN, 8 * WAKE_PERIOD) == WAKE_LENGTH - 352);
    TEST_ASSERT_TRUE(time_in(1, RADIO_SLEEP, 8 * WAKE_PERIOD) == 8 * WAKE_PERIOD - 1440 - WAKE_LENGTH);
    TEST_ASSERT_TRUE(time_in(2, RADIO_RECEIVE, 8 * WAKE_PERIOD) == 1440); /* not the acknowledgement */
    TEST_ASSERT_TRUE(time_in(2, RADIO_SLEEP, 8 * WAKE_PERIOD) == 8 * WAKE_PERIOD - 1440);
}

/* Tries begin at 5,000, 7,624 and 10,248 us of the window; a hidden mote's frame, from 5,000 to 8,680 us, spoils the first two. */
static void who_is_woken_waits_for_the_repetition(void)
{
    const struct radio_config config = waking(at_once(disc("802154")));
    const double x_m[] = {0, 90, 180};
    make(&config, x_m, 3);
    radio_power(&radio, 0, 1, RADIO_POWER_ASLEEP);
    send(WAKE_PERIOD + 5000 - 320, 0, 1, 30);
    send(WAKE_PERIOD + 5000 - 320, 2, RADIO_ALL, 100);
    run(WAKE_PERIOD + 15000);
    TEST_ASSERT_EQUAL_UINT(1, told.heard[1]);
    TEST_ASSERT_EQUAL_UINT(3, told.on_air[0]);
    TEST_ASSERT_EQUAL_UINT(1, told.outcomes[0][MH_SENT_OK]);
    TEST_ASSERT_EQUAL_UINT(WAKE_PERIOD + 10248 + 1440 + 192 + 352, told.last_sent);
    /* another frame is heard if it is over 10 ms after the end of the last one to this mote, but not a microsecond later */
    send(WAKE_PERIOD + 10248 + 1440 + WAKE_LENGTH - 1440 - 1 - 320, 0, RADIO_ALL, 30);
    run(2 * WAKE_PERIOD);
    TEST_ASSERT_EQUAL_UINT(2, told.heard[1]);
    send(2 * WAKE_PERIOD + 9000 - 320, 0, 1, 30);
    send(2 * WAKE_PERIOD + 9000 + 1440 + WAKE_LENGTH - 1440 + 1 - 320, 0, RADIO_ALL, 30);
    run(3 * WAKE_PERIOD);
    TEST_ASSERT_EQUAL_UINT(3, told.heard[1]);
}

static unsigned begun_in_windows;

static void count_windows(void *context, sim_time time, uint32_t sender, uint32_t destination, const uint8_t *frame,
                          size_t length)
{
    on_air(context, time, sender, destination, frame, length);
    begun_in_windows += time % WAKE_PERIOD < WAKE_LENGTH;
}

/* Frames at random times: the share of the windows is heard. Two hidden senders collide in windows as they do else. */
static void windows_are_heard_in_their_share(void)
{
    enum { FRAMES = 20000, SPACE = 20000 };
    const struct random_stream stream = random_stream(7, RANDOM_DEPLOYMENT);
    const struct radio_sink counting = {.on_air = count_windows, .heard = heard, .sent = sent};
    const struct radio_config config = waking(disc("802154"));
    const double x_m[] = {0, 90, 180};
    const double share = (double)WAKE_LENGTH / WAKE_PERIOD;
    make(&config, x_m, 3);
    begun_in_windows = 0;
    radio_power(&radio, 0, 1, RADIO_POWER_ASLEEP);
    for (unsigned i = 0; i < FRAMES; i++) {
        send(i * SPACE + random_bits(stream, i) % SPACE, 0, RADIO_ALL, 30);
    }
    TEST_ASSERT_EQUAL_INT(0, radio_run(&radio, SIM_TIME_NEVER, &counting));
    TEST_ASSERT_EQUAL_UINT(FRAMES, told.on_air[0]);
    TEST_ASSERT_EQUAL_UINT(begun_in_windows, told.heard[1]);
    TEST_ASSERT_EQUAL_UINT(FRAMES - begun_in_windows, radio.counters.lost[LOSS_ASLEEP]);
    TEST_ASSERT_TRUE(fabs(begun_in_windows - FRAMES * share) < 4 * sqrt(FRAMES * share));
    const sim_time window = FRAMES * (sim_time)SPACE / WAKE_PERIOD * WAKE_PERIOD + 2 * WAKE_PERIOD;
    send(window, 0, RADIO_ALL, 100);
    send(window, 2, RADIO_ALL, 100);
    run(SIM_TIME_NEVER);
    TEST_ASSERT_EQUAL_UINT(begun_in_windows, told.heard[1]);
    TEST_ASSERT_EQUAL_UINT(2, radio.counters.lost[LOSS_COLLISION]);
}

/* Random traffic of `motes` motes on a line; a digest of all that the radio told. */
static uint64_t busy_network(const char *profile, uint64_t seed, sim_time step, bool states)
{
    enum { MOTES = 60, FRAMES = 600 };
    struct radio_config config = log_distance(profile);
    config.propagation.shadowing_db = 4;
    config.channel.loss = 0.1;
    double x_m[MOTES];
    const double y_m[MOTES] = {0};
    const struct random_stream stream = random_stream(4, RANDOM_DEPLOYMENT);
    for (unsigned i = 0; i < MOTES; i++) {
        x_m[i] = 400 * random_uniform(stream, i);
    }
    TEST_ASSERT_EQUAL_INT(0, radio_make(&radio, &config, x_m, y_m, MOTES, seed));
    memset(&told, 0, sizeof told);
    for (unsigned i = 0; i < FRAMES; i++) {
        const sim_time time = (sim_time)(1e6 * random_uniform(stream, 1000 + i));
        const uint32_t from = (uint32_t)(MOTES * random_uniform(stream, 2000 + i));
        const uint32_t to = i % 2 ? (from + 1) % MOTES : RADIO_ALL;
        send(time, from, to, 20 + i % 80);
    }
    for (sim_time until = step; radio_next(&radio) != SIM_TIME_NEVER; until += step) {
        TEST_ASSERT_EQUAL_INT(0, radio_run(&radio, until, states ? &sink_with_states : &sink));
    }
    uint64_t digest = 14695981039346656037u;
    told.states = 0;
    memset(told.state, 0, sizeof told.state);
    for (size_t i = 0; i < sizeof told; i++) {
        digest = (digest ^ ((const uint8_t *)&told)[i]) * 1099511628211u;
    }
    for (size_t i = 0; i < sizeof radio.counters; i++) {
        digest = (digest ^ ((const uint8_t *)&radio.counters)[i]) * 1099511628211u;
    }
    const struct radio_counters *c = &radio.counters;
    TEST_ASSERT_TRUE(c->frames_received > 0 && c->lost[LOSS_COLLISION] > 0 && c->lost[LOSS_DEAF] > 0);
    unsigned fates = 0;
    for (unsigned i = 0; i < MOTES; i++) {
        fates += told.outcomes[i][0] + told.outcomes[i][1] + told.outcomes[i][2];
    }
    TEST_ASSERT_EQUAL_UINT(FRAMES, fates);
    radio_free(&radio);
    return digest;
}

/* The same seed, the same run, in steps of whatever length; another seed, another one. */
static void runs_are_repeatable(void)
{
    static const char *const profiles[] = {"802154", "cc1000"};
    for (unsigned i = 0; i < 2; i++) {
        const uint64_t digest = busy_network(profiles[i], 1, 1000000000, false);
        TEST_ASSERT_TRUE(busy_network(profiles[i], 1, 777, false) == digest);
        TEST_ASSERT_TRUE(busy_network(profiles[i], 2, 777, false) != digest);
    }
}

/* Everything at once: frames to one and to all, radios that sleep, die and come back at any moment. Frames of a radio that is never switched off have one
 * fate each, all memory comes back, and in the end nobody hears a signal. */
static void random_life(void)
{
    enum { MOTES = 40, EVENTS = 4000, SAFE = 10 };
    static const char *const profiles[] = {"ideal", "802154", "cc1000"};
    const double y_m[MOTES] = {0};
    double x_m[MOTES];
    for (unsigned p = 0; p < 3; p++) {
        const struct random_stream stream = random_stream(20 + p, RANDOM_DEPLOYMENT);
        struct radio_config config = disc(profiles[p]);
        unsigned handed[MOTES] = {0};
        config.channel.loss = 0.1;
        config.queue = 4;
        config.wake_period = p == 1 ? 20000 : 0;
        config.wake_length = p == 1 ? 5000 : 0;
        for (unsigned i = 0; i < MOTES; i++) {
            x_m[i] = 500 * random_uniform(stream, i);
        }
        TEST_ASSERT_EQUAL_INT(0, radio_make(&radio, &config, x_m, y_m, MOTES, 3));
        memset(&told, 0, sizeof told);
        for (unsigned i = 0; i < EVENTS; i++) {
            const uint64_t bits = random_bits(stream, 1000 + i);
            const sim_time time = (sim_time)i * 1000 + bits % 1000;
            const uint32_t mote = (uint32_t)(bits >> 16) % MOTES, to = (uint32_t)(bits >> 24) % MOTES;
            if ((bits >> 32) % 4 > 0) {
                handed[mote]++;
                send(time, mote, (bits >> 40) % 2 ? to : RADIO_ALL, 10 + (bits >> 48) % 100);
            } else if (mote >= SAFE || (bits >> 36) % 3 < RADIO_POWER_OFF) {
                radio_power(&radio, time, mote, (enum radio_power)((bits >> 36) % 3));
            }
            told.states = 0;
            TEST_ASSERT_EQUAL_INT(0, radio_run(&radio, time, &sink_with_states));
        }
        told.states = 0;
        TEST_ASSERT_EQUAL_INT(0, radio_run(&radio, SIM_TIME_NEVER, &sink_with_states));
        for (unsigned i = 0; i < MOTES; i++) {
            const unsigned fates = told.outcomes[i][0] + told.outcomes[i][1] + told.outcomes[i][2];
            TEST_ASSERT_TRUE(i < SAFE ? fates == handed[i] : fates <= handed[i]);
        }
        const uint32_t room = radio.frames_capacity;
        for (uint32_t i = 0; i < room; i++) {
            send(50000000, i % MOTES, RADIO_ALL, 10);
        }
        TEST_ASSERT_EQUAL_UINT(room, radio.frames_capacity);
        told.states = 0;
        TEST_ASSERT_EQUAL_INT(0, radio_run(&radio, SIM_TIME_NEVER, &sink_with_states));
        for (uint32_t i = 0; i < MOTES; i++) {
            radio_power(&radio, 100000000, i, RADIO_POWER_ASLEEP);
            radio_power(&radio, 100000000, i, RADIO_POWER_ON);
        }
        told.states = 0;
        TEST_ASSERT_EQUAL_INT(0, radio_run(&radio, SIM_TIME_NEVER, &sink_with_states));
        for (unsigned i = 0; i < told.states; i++) {
            TEST_ASSERT_TRUE(told.state[i].state == RADIO_SLEEP || told.state[i].state == RADIO_LISTEN);
        }
        radio_free(&radio);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(times_of_a_unicast);
    RUN_TEST(times_of_a_unicast_of_cc1000);
    RUN_TEST(gives_up_without_acknowledgement);
    RUN_TEST(losses_are_made_up_for);
    RUN_TEST(hidden_motes_collide);
    RUN_TEST(carrier_sense);
    RUN_TEST(turnaround_is_a_blind_spot);
    RUN_TEST(stronger_one_is_captured);
    RUN_TEST(stronger_later_one_is_captured);
    RUN_TEST(interference_adds_up);
    RUN_TEST(weak_signals_bear_little);
    RUN_TEST(half_duplex);
    RUN_TEST(queue_is_bounded_and_answers_in_order);
    RUN_TEST(sleeping_and_dead_motes_hear_nothing);
    RUN_TEST(frame_of_a_mote_that_dies_is_a_wreck);
    RUN_TEST(states_add_up);
    RUN_TEST(who_sleeps_hears_what_begins_in_a_window);
    RUN_TEST(who_is_woken_acknowledges);
    RUN_TEST(who_is_woken_waits_for_the_repetition);
    RUN_TEST(windows_are_heard_in_their_share);
    RUN_TEST(runs_are_repeatable);
    RUN_TEST(random_life);
    port_exit(UNITY_END() > 0);
    return 0;
}
