/* The neighbour table against brute force over all who were heard. */
#include "motehound/neighbours.h"
#include "port.h"
#include "unity.h"

#include <string.h>

#define LIFETIME ((mh_tick)35000)
#define PERIOD ((mh_tick)10000)

enum { CROWD = 40, HERE = 100 };

static const struct mh_place here = {0, 0, 0};
static struct mh_neighbours table;
static uint32_t state;

static struct {
    mh_node_id id;
    int32_t x_mm, y_mm;
} crowd[CROWD];

void setUp(void)
{
    state = 1;
    TEST_ASSERT_EQUAL(MH_OK, mh_neighbours_init(&table, HERE, &here, 12, LIFETIME));
}

void tearDown(void) {}

static uint32_t below(uint32_t limit)
{
    state = state * UINT32_C(1664525) + UINT32_C(1013904223);
    return (state >> 8) % limit;
}

static enum mh_status hear(mh_tick now, mh_node_id id, int32_t x_mm, int32_t y_mm, int16_t sequence)
{
    const mh_hello_t hello = {(int32_t)id, x_mm, y_mm, sequence};
    return mh_neighbours_hello(&table, now, &hello);
}

static bool planar(mh_node_id id)
{
    const struct mh_neighbour *n = mh_neighbours_find(&table, id);
    return n && mh_neighbour_planar(&table, n);
}

static bool gabriel(uint8_t v)
{
    for (uint8_t w = 0; w < CROWD; w++) {
        const int64_t x = crowd[w].x_mm, y = crowd[w].y_mm;
        if (w != v && x * (x - crowd[v].x_mm) + y * (y - crowd[v].y_mm) < 0) {
            return false;
        }
    }
    return true;
}

static void bad_configurations_are_refused(void)
{
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_neighbours_init(&table, HERE, &here, 0, LIFETIME));
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_neighbours_init(&table, HERE, &here, MH_NEIGHBOURS_MAX + 1, LIFETIME));
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_neighbours_init(&table, HERE, &here, 4, 511));
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_neighbours_init(&table, HERE, &here, 4, 3600001));
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, hear(0, HERE, 1, 1, 0));
}

/* Three times as many neighbours as the table holds, in a scale of metres and of a thousand kilometres. */
static void the_gabriel_graph_is_exact_though_the_table_is_full(void)
{
    for (uint8_t trial = 0; trial < 10; trial++) {
        const int32_t scale = trial % 2 ? 990000 : 15;
        setUp();
        state = trial;
        for (uint8_t i = 0; i < CROWD; i++) {
            crowd[i].id = i;
            crowd[i].x_mm = ((int32_t)below(2000) - 1000) * scale;
            crowd[i].y_mm = ((int32_t)below(2000) - 1000) * scale;
        }
        for (uint8_t round = 0; round < 5; round++) {
            const uint8_t offset = (uint8_t)below(CROWD);
            for (uint8_t k = 0; k < CROWD; k++) {
                const uint8_t i = (uint8_t)((k * 7 + offset) % CROWD);
                hear(PERIOD * round + k, i, crowd[i].x_mm, crowd[i].y_mm, round);
            }
        }
        TEST_ASSERT_EQUAL(12, table.count);
        for (uint8_t i = 0; i < CROWD; i++) {
            TEST_ASSERT_EQUAL(gabriel(i), planar(i));
        }
    }
}

/* What is not in the Gabriel graph is there for greedy hops: the farthest, in all directions. */
static void the_rest_of_the_table_is_the_farthest_in_all_directions(void)
{
    uint8_t in_octant[8] = {0};
    for (uint8_t round = 0; round < 3; round++) {
        hear(PERIOD * round, 90, 100, 100, round); /* witnesses all in their half plane */
        hear(PERIOD * round, 91, -100, -100, round);
        for (uint8_t i = 0; i < CROWD; i++) {
            static const int8_t corner[8][2] = {{7, 2}, {2, 7}, {-2, 7}, {-7, 2}, {-7, -2}, {-2, -7}, {2, -7}, {7, -2}};
            const int32_t ring = 1000 * (1 + i / 8);
            hear(PERIOD * round + 1, i, corner[i % 8][0] * ring, corner[i % 8][1] * ring, round);
        }
    }
    TEST_ASSERT_EQUAL(12, table.count);
    for (uint8_t i = 0; i < table.count; i++) {
        const mh_node_id id = table.list[i].id;
        if (id < CROWD) {
            TEST_ASSERT_GREATER_OR_EQUAL_UINT32(24, id); /* the two farthest rings */
            in_octant[id % 8]++;
        }
    }
    for (uint8_t i = 0; i < 8; i++) {
        TEST_ASSERT_GREATER_OR_EQUAL(1, in_octant[i]);
    }
    TEST_ASSERT_EQUAL(0, table.lost[MH_NEIGHBOUR_PLANAR]);
}

static void a_star_that_does_not_fit_is_counted(void)
{
    static const int8_t corner[13][2] = {{10, 0},  {9, 5},   {5, 9},   {0, 10}, {-5, 9}, {-9, 5}, {-10, 0},
                                         {-9, -5}, {-5, -9}, {0, -10}, {5, -9}, {9, -5}, {10, 1}};
    for (uint8_t i = 0; i < 12; i++) {
        TEST_ASSERT_EQUAL(MH_OK, hear(0, i, corner[i][0] * 1000, corner[i][1] * 1000, 0));
    }
    TEST_ASSERT_EQUAL(MH_NONE, hear(0, 12, corner[12][0] * 1000, corner[12][1] * 1000, 0));
    TEST_ASSERT_EQUAL(1, table.lost[MH_NEIGHBOUR_PLANAR]);
    TEST_ASSERT_EQUAL(12, table.count);
}

static void missed_hellos_and_acknowledgements_make_the_quality(void)
{
    for (int16_t i = 0; i < 30; i++) {
        hear((mh_tick)i * PERIOD, 1, 1000, 0, i);
        hear((mh_tick)i * PERIOD, 2, -1000, 0, (int16_t)(2 * i)); /* every other one */
        hear((mh_tick)i * PERIOD, 3, 0, 1000, (int16_t)(i % 2));  /* restarted again and again */
        hear((mh_tick)i * PERIOD, 4, 0, -1000, (int16_t)(9 * i));
    }
    TEST_ASSERT_EQUAL_UINT16(65025, mh_neighbour_quality(mh_neighbours_find(&table, 1)));
    TEST_ASSERT_UINT16_WITHIN(65025 / 8, 65025 * 4 / 7, mh_neighbour_quality(mh_neighbours_find(&table, 2)));
    TEST_ASSERT_GREATER_THAN_UINT16(60000, mh_neighbour_quality(mh_neighbours_find(&table, 3)));
    TEST_ASSERT_TRUE(mh_neighbour_usable(mh_neighbours_find(&table, 2)));
    TEST_ASSERT_TRUE(mh_neighbour_usable(mh_neighbours_find(&table, 4)));
    uint8_t failures = 0;
    while (mh_neighbour_usable(mh_neighbours_find(&table, 1)) && failures < 100) {
        mh_neighbours_acked(&table, 1, false);
        failures++;
    }
    TEST_ASSERT_EQUAL(5, failures); /* (3/4)^5 < 1/4 */
    TEST_ASSERT_FALSE(planar(1));
    mh_neighbours_acked(&table, 77, false); /* not there */
    hear(31 * PERIOD, 1, 1000, 0, 30);
    TEST_ASSERT_TRUE(mh_neighbour_usable(mh_neighbours_find(&table, 1))); /* another try */
    const uint16_t quality = mh_neighbour_quality(mh_neighbours_find(&table, 1));
    mh_neighbours_acked(&table, 1, true);
    TEST_ASSERT_GREATER_THAN_UINT16(quality, mh_neighbour_quality(mh_neighbours_find(&table, 1)));
}

static void a_link_that_is_not_used_gives_way_first(void)
{
    for (uint8_t i = 0; i < 12; i++) {
        hear(0, i, 1000 + 100 * i, 0, 0);
    }
    for (uint8_t i = 0; i < 9; i++) {
        mh_neighbours_acked(&table, 11, false); /* the farthest, which would be the last to go */
    }
    TEST_ASSERT_EQUAL(MH_OK, hear(0, 20, 1050, 0, 0));
    TEST_ASSERT_NULL(mh_neighbours_find(&table, 11));
    TEST_ASSERT_EQUAL(1, table.lost[MH_NEIGHBOUR_UNUSED]);
    TEST_ASSERT_EQUAL(MH_NONE, hear(0, 21, 1040, 0, 0)); /* all are in one octant; it has the least reach */
    TEST_ASSERT_EQUAL(MH_OK, hear(0, 22, 2500, 0, 0));
    TEST_ASSERT_EQUAL(1, table.lost[MH_NEIGHBOUR_CROWDED]);
}

/* Without its witness a neighbour comes back into the Gabriel graph; both take the same time to be forgotten. */
static void the_silent_are_forgotten_and_so_is_what_they_witnessed(void)
{
    mh_tick now = 0xFFFFC000u; /* across the wrap */
    int16_t sequence = 0;
    for (uint8_t i = 0; i < 3; i++, now += PERIOD, sequence++) {
        hear(now, 1, 5000, 100, sequence);
        hear(now, 2, 10000, 0, sequence);
        mh_neighbours_age(&table, now);
    }
    TEST_ASSERT_TRUE(planar(1));
    TEST_ASSERT_FALSE(planar(2));
    for (uint8_t i = 0; i < 3; i++, now += PERIOD, sequence++) {
        hear(now, 2, 10000, 0, sequence);
        mh_neighbours_age(&table, now);
        TEST_ASSERT_FALSE(planar(2));
        TEST_ASSERT_NOT_NULL(mh_neighbours_find(&table, 1));
    }
    hear(now, 2, 10000, 0, sequence);
    mh_neighbours_age(&table, now);
    TEST_ASSERT_NULL(mh_neighbours_find(&table, 1));
    TEST_ASSERT_TRUE(planar(2));
    TEST_ASSERT_EQUAL(1, table.lost[MH_NEIGHBOUR_SILENT]);
    mh_neighbours_age(&table, now - 1000000u); /* a clock that is set back forgets nobody */
    TEST_ASSERT_EQUAL(1, table.count);
}

static void who_moves_is_entered_anew(void)
{
    for (uint8_t i = 0; i < 2; i++) {
        hear(i, 1, 5000, 100, i);
        hear(i, 2, 10000, 0, i);
    }
    hear(2, 2, 0, 10000, 2);
    TEST_ASSERT_EQUAL(2, table.count);
    TEST_ASSERT_FALSE(planar(2));
    hear(3, 2, 0, 10000, 3);
    TEST_ASSERT_TRUE(planar(2));
}

/* At one place the lowest identifier stands for all. */
static void nodes_at_one_place(void)
{
    for (uint8_t i = 0; i < 2; i++) {
        hear(i, 5, 3000, 0, i);
        hear(i, 4, 3000, 0, i);
        hear(i, HERE + 1, 0, 0, i);
    }
    TEST_ASSERT_TRUE(planar(4));
    TEST_ASSERT_FALSE(planar(5));
    TEST_ASSERT_FALSE(planar(HERE + 1));
    hear(2, HERE - 1, 0, 0, 2);
    TEST_ASSERT_FALSE(planar(4));
    TEST_ASSERT_FALSE(planar(HERE - 1));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(bad_configurations_are_refused);
    RUN_TEST(the_gabriel_graph_is_exact_though_the_table_is_full);
    RUN_TEST(the_rest_of_the_table_is_the_farthest_in_all_directions);
    RUN_TEST(a_star_that_does_not_fit_is_counted);
    RUN_TEST(missed_hellos_and_acknowledgements_make_the_quality);
    RUN_TEST(a_link_that_is_not_used_gives_way_first);
    RUN_TEST(the_silent_are_forgotten_and_so_is_what_they_witnessed);
    RUN_TEST(who_moves_is_entered_anew);
    RUN_TEST(nodes_at_one_place);
    port_exit(UNITY_END() > 0);
    return 0;
}
