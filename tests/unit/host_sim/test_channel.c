#include "port.h"
#include "radio/channel.h"
#include "scenarios.h"
#include "unity.h"

#include <math.h>

enum { PLACES = 50 };

static struct channel channel;
static struct place places[PLACES];
static uint64_t number;

void setUp(void)
{
    number = 0;
    for (uint32_t i = 0; i < PLACES; i++) {
        places[i] = (struct place){i, 10, i};
    }
}

void tearDown(void) { channel_free(&channel); }

static enum loss_reason pass(uint32_t sender, uint32_t receiver, double start_s, double end_s)
{
    const struct passage passage = {.number = number++,
                                    .start = (sim_time)(start_s * SIM_TIME_PER_S),
                                    .end = (sim_time)(end_s * SIM_TIME_PER_S),
                                    .sender = &places[sender],
                                    .receiver = &places[receiver]};
    return channel_verdict(&channel, &passage);
}

static void nothing_is_quiet(void)
{
    const struct channel_config none = {.good_s = 1}, loss = {.loss = 1e-9, .good_s = 1},
                                bursts = {.good_s = 1, .bad_s = 1};
    TEST_ASSERT_EQUAL_INT(0, channel_make(&channel, &none, PLACES, 1));
    TEST_ASSERT_TRUE(channel_is_quiet(&channel));
    TEST_ASSERT_EQUAL_INT(LOSS_NONE, pass(0, 1, 1, 2));
    TEST_ASSERT_EQUAL_INT(0, channel_make(&channel, &loss, PLACES, 1));
    TEST_ASSERT_FALSE(channel_is_quiet(&channel));
    TEST_ASSERT_EQUAL_INT(0, channel_make(&channel, &bursts, PLACES, 1));
    TEST_ASSERT_FALSE(channel_is_quiet(&channel));
}

/* Bursts of 2 s with 6 s between: a quarter of the time. Losses of 0.8 and 0.1 give 0.275 in all. A burst that is on is still on after
 * t with probability 1/4 + 3/4 exp(-t (1/2 + 1/6)), so with losses of 1 and 0 do two frames t apart get lost. */
static void bursts_have_their_duration(void)
{
    enum { STEPS = 100000 };
    const struct channel_config mild = {.loss = 0.1, .burst_loss = 0.8, .good_s = 6, .bad_s = 2};
    TEST_ASSERT_EQUAL_INT(0, channel_make(&channel, &mild, PLACES, 1));
    int lost = 0;
    for (int k = 0; k < STEPS; k++) {
        lost += pass(0, 1 + (uint32_t)k % 40, k, k + 0.001) == LOSS_RANDOM;
    }
    TEST_ASSERT_INT_WITHIN(5 * 160, STEPS * 275 / 1000, lost); /* correlated: about 160 */
    channel_free(&channel);

    const struct channel_config sharp = {.loss = 0, .burst_loss = 1, .good_s = 6, .bad_s = 2};
    TEST_ASSERT_EQUAL_INT(0, channel_make(&channel, &sharp, PLACES, 2));
    int on = 0, still_on = 0, elsewhere = 0;
    for (int k = 0; k < STEPS; k++) {
        const double time_s = 20 * k;
        if (pass(0, 7, time_s, time_s + 0.001) == LOSS_RANDOM) {
            on++;
            elsewhere += pass(0, 8, time_s, time_s + 0.001) == LOSS_RANDOM;
            still_on += pass(0, 7, time_s + 1, time_s + 1.001) == LOSS_RANDOM;
        }
    }
    TEST_ASSERT_INT_WITHIN(5 * 137, STEPS / 4, on);
    TEST_ASSERT_INT_WITHIN(5 * 69, on / 4, elsewhere);
    TEST_ASSERT_INT_WITHIN(5 * 78, (int)(on * (0.25 + 0.75 * exp(-2.0 / 3))), still_on);
}

static void configure(const struct scenario *scenario)
{
    struct channel_config config = {.good_s = 1};
    faults_make(&config.faults, scenario, 0);
    TEST_ASSERT_EQUAL_INT(0, channel_make(&channel, &config, PLACES, 1));
    TEST_ASSERT_FALSE(channel_is_quiet(&channel));
}

static void partition_lies_between_its_sides_for_its_time(void)
{
    struct scenario scenario = e1();
    scenario.faults.partition.from_s = 10;
    scenario.faults.partition.for_s = 5;
    scenario.faults.partition.x_m = 20.5;
    scenario.faults.partition.angle_rad = acos(0.0);
    configure(&scenario);
    TEST_ASSERT_EQUAL_INT(LOSS_NONE, pass(20, 21, 9.9, 9.99));
    TEST_ASSERT_EQUAL_INT(LOSS_PARTITION, pass(20, 21, 9.9, 10.01));
    TEST_ASSERT_EQUAL_INT(LOSS_PARTITION, pass(21, 20, 12, 12.01));
    TEST_ASSERT_EQUAL_INT(LOSS_PARTITION, pass(2, 49, 14.99, 15.01));
    TEST_ASSERT_EQUAL_INT(LOSS_NONE, pass(19, 20, 12, 12.01));
    TEST_ASSERT_EQUAL_INT(LOSS_NONE, pass(21, 49, 12, 12.01));
    TEST_ASSERT_EQUAL_INT(LOSS_NONE, pass(20, 21, 15, 15.01));
}

static void jammed_receivers_hear_nothing(void)
{
    struct scenario scenario = e1();
    scenario.faults.jam.from_s = 10;
    scenario.faults.jam.for_s = 5;
    scenario.faults.jam.x_m = 30;
    scenario.faults.jam.y_m = 10;
    scenario.faults.jam.radius_m = 3;
    configure(&scenario);
    TEST_ASSERT_EQUAL_INT(LOSS_JAMMED, pass(10, 27, 11, 11.1));
    TEST_ASSERT_EQUAL_INT(LOSS_NONE, pass(10, 26, 11, 11.1));
    TEST_ASSERT_EQUAL_INT(LOSS_NONE, pass(27, 10, 11, 11.1));
    TEST_ASSERT_EQUAL_INT(LOSS_NONE, pass(10, 27, 15, 15.1));
}

/* The head is the last place. */
static void mute_head_neither_sends_nor_hears(void)
{
    struct scenario scenario = e1();
    scenario.faults.mute.from_s = 10;
    scenario.faults.mute.for_s = 5;
    configure(&scenario);
    TEST_ASSERT_EQUAL_INT(LOSS_MUTE, pass(PLACES - 1, 3, 11, 11.1));
    TEST_ASSERT_EQUAL_INT(LOSS_MUTE, pass(3, PLACES - 1, 11, 11.1));
    TEST_ASSERT_EQUAL_INT(LOSS_NONE, pass(3, 4, 11, 11.1));
    TEST_ASSERT_EQUAL_INT(LOSS_NONE, pass(3, PLACES - 1, 15, 15.1));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(nothing_is_quiet);
    RUN_TEST(bursts_have_their_duration);
    RUN_TEST(partition_lies_between_its_sides_for_its_time);
    RUN_TEST(jammed_receivers_hear_nothing);
    RUN_TEST(mute_head_neither_sends_nor_hears);
    port_exit(UNITY_END() > 0);
}
