#include "port.h"
#include "unity.h"
#include "world/traffic.h"

#include <math.h>

static struct traffic traffic;

void setUp(void) {}
void tearDown(void) { traffic_free(&traffic); }

/* In each interval every source comes once, at the same phase as before. */
static void each_source_once_in_an_interval(void)
{
    enum { SOURCES = 20, MOTES = 1000, ROUNDS = 3 };
    const sim_time interval = 10 * SIM_TIME_PER_S;
    sim_time phases[MOTES] = {0}, last = 0;
    unsigned comes[MOTES] = {0};
    TEST_ASSERT_EQUAL_INT(0, traffic_make(&traffic, SOURCES, MOTES, interval, 5));
    for (unsigned i = 0; i < ROUNDS * SOURCES; i++) {
        const sim_time time = traffic_next(&traffic);
        const uint32_t mote = traffic_take(&traffic);
        TEST_ASSERT_TRUE(time >= last && time / interval == i / SOURCES);
        TEST_ASSERT_TRUE(mote < MOTES);
        TEST_ASSERT_TRUE(comes[mote] == 0 || phases[mote] == time % interval);
        phases[mote] = time % interval;
        comes[mote]++;
        last = time;
    }
    for (unsigned part = 0; part < SOURCES; part++) { /* one in each fiftieth of the motes, evenly */
        unsigned in_part = 0;
        for (unsigned i = 0; i < MOTES / SOURCES; i++) {
            in_part += comes[part * (MOTES / SOURCES) + i];
        }
        TEST_ASSERT_EQUAL_UINT(ROUNDS, in_part);
    }
}

static void phases_are_uniform_and_differ_between_seeds(void)
{
    enum { SOURCES = 10000 };
    sim_time first[2];
    for (int seed = 0; seed < 2; seed++) {
        double in_tenth[10] = {0};
        TEST_ASSERT_EQUAL_INT(0, traffic_make(&traffic, SOURCES, SOURCES, 1000000, (uint64_t)seed));
        first[seed] = traffic_next(&traffic);
        for (int i = 0; i < SOURCES; i++) {
            in_tenth[traffic_next(&traffic) / 100000]++;
            traffic_take(&traffic);
        }
        for (int tenth = 0; tenth < 10; tenth++) {
            TEST_ASSERT_TRUE(fabs(in_tenth[tenth] - 1000) <= 4 * 30); /* binomial: sd 30 */
        }
        traffic_free(&traffic);
    }
    TEST_ASSERT_TRUE(first[0] != first[1]);
}

static void without_sources_nothing_comes(void)
{
    TEST_ASSERT_EQUAL_INT(0, traffic_make(&traffic, 0, 10, 1000, 0));
    TEST_ASSERT_TRUE(traffic_next(&traffic) == SIM_TIME_NEVER);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(each_source_once_in_an_interval);
    RUN_TEST(phases_are_uniform_and_differ_between_seeds);
    RUN_TEST(without_sources_nothing_comes);
    port_exit(UNITY_END() > 0);
    return 0;
}
