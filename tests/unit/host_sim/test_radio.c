#include "engine/random.h"
#include "port.h"
#include "radio/radio.h"
#include "unity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PLACES = 600 };

static double x_m[PLACES], y_m[PLACES];
static struct radio radio;

static const uint8_t bytes[] = "what is sent";
static struct heard {
    unsigned times[PLACES], total, outcomes[3];
    sim_time began, landed, told;
    bool damaged;
} heard;

void setUp(void) { radio = (struct radio){0}; }
void tearDown(void) { radio_free(&radio); }

static struct radio_config ideal(double range_m, double loss)
{
    return (struct radio_config){.profile = *radio_profile_find("ideal"),
                                 .propagation = {.kind = PROPAGATION_DISC, .range_m = range_m},
                                 .channel = {.loss = loss}};
}

static void scatter(double width, double height)
{
    const struct random_stream stream = random_stream(9, RANDOM_DEPLOYMENT);
    for (unsigned i = 0; i < PLACES; i++) {
        x_m[i] = width * (random_uniform(stream, 2 * i) - 0.3);
        y_m[i] = height * (random_uniform(stream, 2 * i + 1) - 0.3);
    }
}

static void on_air(void *context, sim_time time, uint32_t sender, uint32_t destination, const uint8_t *frame,
                   size_t length)
{
    struct heard *what = context;
    (void)sender;
    (void)destination;
    what->began = time;
    what->damaged |= length != sizeof bytes || memcmp(frame, bytes, length) != 0;
}

static void hear(void *context, sim_time time, const uint8_t *frame, size_t length, const uint32_t *receivers,
                 uint32_t count)
{
    struct heard *what = context;
    what->landed = time;
    for (uint32_t i = 0; i < count; i++) {
        what->times[receivers[i]]++;
    }
    what->total += count;
    what->damaged |= length != sizeof bytes || memcmp(frame, bytes, length) != 0;
}

static void sent(void *context, sim_time time, uint32_t sender, enum mh_sent outcome)
{
    struct heard *what = context;
    (void)sender;
    what->told = time;
    what->outcomes[outcome]++;
}

static void run(sim_time until)
{
    const struct radio_sink sink = {.context = &heard, .on_air = on_air, .heard = hear, .sent = sent};
    memset(&heard, 0, sizeof heard);
    TEST_ASSERT_EQUAL_INT(0, radio_run(&radio, until, &sink));
}

/* At a time when nothing else goes on. */
static void send(uint32_t sender, uint32_t destination)
{
    static sim_time now;
    now += 1000000;
    TEST_ASSERT_EQUAL_INT(0, radio_send(&radio, now, sender, destination, bytes, sizeof bytes, 0));
    run(SIM_TIME_NEVER);
}

static void broadcast_reaches_those_in_range_and_nobody_else(void)
{
    static const double shapes[][3] = {{100, 100, 15}, {100, 100, 0.5}, {100, 100, 500},
                                       {1000, 1, 20},  {1, 1000, 3},    {0, 0, 1}};
    for (unsigned s = 0; s < sizeof shapes / sizeof shapes[0]; s++) {
        scatter(shapes[s][0], shapes[s][1]);
        const struct radio_config config = ideal(shapes[s][2], 0);
        TEST_ASSERT_EQUAL_INT(0, radio_make(&radio, &config, x_m, y_m, PLACES, 1));
        for (uint32_t sender = 0; sender < PLACES; sender++) {
            send(sender, RADIO_ALL);
            TEST_ASSERT_FALSE(heard.damaged);
            for (uint32_t i = 0; i < PLACES; i++) {
                const double dx = x_m[i] - x_m[sender], dy = y_m[i] - y_m[sender];
                const bool in_range = dx * dx + dy * dy <= shapes[s][2] * shapes[s][2];
                TEST_ASSERT_EQUAL_UINT(i != sender && in_range, heard.times[i]);
            }
        }
        radio_free(&radio);
    }
}

static void without_a_limit_all_hear_all(void)
{
    scatter(100, 100);
    const struct radio_config config = ideal(HUGE_VAL, 0);
    TEST_ASSERT_EQUAL_INT(0, radio_make(&radio, &config, x_m, y_m, PLACES, 1));
    send(5, RADIO_ALL);
    TEST_ASSERT_EQUAL_UINT(PLACES - 1, heard.total);
}

static void unicast_is_handed_to_its_addressee_if_in_range(void)
{
    scatter(100, 100);
    const struct radio_config config = ideal(15, 0);
    TEST_ASSERT_EQUAL_INT(0, radio_make(&radio, &config, x_m, y_m, PLACES, 1));
    for (uint32_t to = 1; to < PLACES; to++) {
        send(0, to);
        const bool in_range = hypot(x_m[to] - x_m[0], y_m[to] - y_m[0]) <= 15;
        TEST_ASSERT_EQUAL_UINT(in_range, heard.total);
        TEST_ASSERT_EQUAL_UINT(in_range, heard.times[to]);
        TEST_ASSERT_EQUAL_UINT(1, heard.outcomes[in_range ? MH_SENT_OK : MH_SENT_NO_ACK]);
    }
    TEST_ASSERT_TRUE(radio.counters.frames_sent == PLACES - 1 &&
                     radio.counters.frames_received + radio.counters.lost[LOSS_RANGE] == PLACES - 1 &&
                     radio.counters.frames_received > 0);
}

static void takes_its_air_time_one_after_the_other(void)
{
    const struct radio_config config = ideal(15, 0);
    const sim_time air = (sizeof bytes + 6) * 32;
    scatter(1, 1);
    TEST_ASSERT_EQUAL_INT(0, radio_make(&radio, &config, x_m, y_m, PLACES, 1));
    TEST_ASSERT_TRUE(radio_next(&radio) == SIM_TIME_NEVER);
    TEST_ASSERT_EQUAL_INT(0, radio_send(&radio, 5000, 0, RADIO_ALL, bytes, sizeof bytes, 0));
    TEST_ASSERT_EQUAL_INT(0, radio_send(&radio, 5001, 0, 1, bytes, sizeof bytes, 0));
    TEST_ASSERT_TRUE(radio_next(&radio) == 5000);
    run(5000 + air);
    TEST_ASSERT_TRUE(heard.began == 5000 && heard.total == 0);
    run(5000 + air + 1);
    TEST_ASSERT_TRUE(heard.began == 5000 + air && heard.landed == 5000 + air && heard.told == heard.landed);
    TEST_ASSERT_EQUAL_UINT(1, heard.outcomes[MH_SENT_OK]);
    run(SIM_TIME_NEVER);
    TEST_ASSERT_TRUE(heard.landed == 5000 + 2 * air && heard.total == 1 && heard.times[1] == 1);
}

static void only_radios_that_are_on_hear(void)
{
    const struct radio_config config = ideal(15, 0);
    scatter(1, 1);
    TEST_ASSERT_EQUAL_INT(0, radio_make(&radio, &config, x_m, y_m, 4, 1));
    TEST_ASSERT_EQUAL_INT(0, radio_power(&radio, 1, 1, RADIO_POWER_ASLEEP));
    TEST_ASSERT_EQUAL_INT(0, radio_power(&radio, 1, 2, RADIO_POWER_OFF));
    send(0, RADIO_ALL);
    TEST_ASSERT_TRUE(heard.total == 1 && heard.times[3] == 1);
    TEST_ASSERT_TRUE(radio.counters.lost[LOSS_ASLEEP] == 1 && radio.counters.lost[LOSS_DEAD] == 1);
    send(0, 2);
    TEST_ASSERT_EQUAL_UINT(1, heard.outcomes[MH_SENT_NO_ACK]);
    send(1, RADIO_ALL);
    TEST_ASSERT_EQUAL_UINT(2, heard.total);
    send(2, RADIO_ALL);
    TEST_ASSERT_TRUE(heard.began == 0 && heard.total == 0);
}

/* Each receiver loses its share, and two receivers lose the same frame as often as chance has it. */
static void loss_is_independent(void)
{
    enum { FRAMES = 20000 };
    const struct radio_config config = ideal(HUGE_VAL, 0.3);
    scatter(1, 1);
    TEST_ASSERT_EQUAL_INT(0, radio_make(&radio, &config, x_m, y_m, 3, 1));
    unsigned first = 0, second = 0, both = 0;
    for (unsigned i = 0; i < FRAMES; i++) {
        send(0, RADIO_ALL);
        first += heard.times[1] == 0;
        second += heard.times[2] == 0;
        both += heard.times[1] == 0 && heard.times[2] == 0;
    }
    const double sd = sqrt(FRAMES * 0.3 * 0.7);
    TEST_ASSERT_TRUE(fabs(first - 0.3 * FRAMES) < 4 * sd);
    TEST_ASSERT_TRUE(fabs(second - 0.3 * FRAMES) < 4 * sd);
    TEST_ASSERT_TRUE(fabs(both - 0.09 * FRAMES) < 4 * sqrt(FRAMES * 0.09 * 0.91));
    TEST_ASSERT_TRUE(radio.counters.lost[LOSS_RANDOM] == first + second &&
                     radio.counters.frames_received == 2 * FRAMES - first - second);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(broadcast_reaches_those_in_range_and_nobody_else);
    RUN_TEST(without_a_limit_all_hear_all);
    RUN_TEST(unicast_is_handed_to_its_addressee_if_in_range);
    RUN_TEST(takes_its_air_time_one_after_the_other);
    RUN_TEST(only_radios_that_are_on_hear);
    RUN_TEST(loss_is_independent);
    port_exit(UNITY_END() > 0);
    return 0;
}
