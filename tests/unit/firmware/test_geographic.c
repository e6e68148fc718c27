/* Single decisions of geographic routing. Whole graphs: tests/network/test_geographic_graphs.c. */
#include "motehound/geographic.h"
#include "port.h"
#include "unity.h"

enum { HERE = 100, GOAL = 50 };

#define FAR 1000000000 /* the edge of the map */

static struct mh_neighbours table;
static struct mh_message message, leaving;
static mh_node_id next;

void setUp(void)
{
    static const struct mh_place here = {0, 0, 0};
    TEST_ASSERT_EQUAL(MH_OK, mh_neighbours_init(&table, HERE, &here, 8, 35000));
}

void tearDown(void) {}

static void know(mh_node_id id, int32_t x_mm, int32_t y_mm)
{
    for (int16_t i = 0; i < 2; i++) {
        const mh_hello_t hello = {(int32_t)id, x_mm, y_mm, i};
        TEST_ASSERT_EQUAL(MH_OK, mh_neighbours_hello(&table, (mh_tick)i, &hello));
    }
}

static void address(mh_node_id destination, int32_t x_mm, int32_t y_mm)
{
    const struct mh_place place = {x_mm, y_mm, 0};
    const struct mh_message report = {.kind = MH_MESSAGE_REPORT};
    message = report;
    mh_geographic_address(&message, 7, 1, destination, &place);
}

static enum mh_hop hop(void) { return mh_geographic_next(&table, true, &message, &leaving, &next); }

static void to_the_neighbour_nearest_to_the_destination(void)
{
    know(1, 8000, 7000);
    know(2, 7000, 0); /* nearer to it than 1, though not as far away */
    know(3, -9000, 0);
    address(GOAL, 20000, 0);
    TEST_ASSERT_EQUAL(MH_HOP_NEXT, hop());
    TEST_ASSERT_EQUAL_UINT32(2, next);
    TEST_ASSERT_EQUAL(MH_ENVELOPE_ROUTE, leaving.envelope);
    TEST_ASSERT_EQUAL_INT32(HERE, leaving.header.route.sender);
    TEST_ASSERT_EQUAL_INT32(7, leaving.header.route.origin);
    TEST_ASSERT_EQUAL_INT16(1, leaving.header.route.hops);
    for (uint8_t i = 0; i < 3; i++) {
        mh_neighbours_acked(&table, 2, false);
    }
    TEST_ASSERT_EQUAL(MH_HOP_NEXT, hop());
    TEST_ASSERT_EQUAL_UINT32(1, next); /* less progress, but a much better link */
}

static void straight_to_a_destination_that_is_a_neighbour(void)
{
    know(1, 5000, 0);
    know(GOAL, -5000, 0); /* it has moved meanwhile */
    address(GOAL, 20000, 0);
    TEST_ASSERT_EQUAL(MH_HOP_NEXT, hop());
    TEST_ASSERT_EQUAL_UINT32(GOAL, next);
    address(HERE, 20000, 0);
    TEST_ASSERT_EQUAL(MH_HOP_ARRIVED, hop());
}

/* Neighbours in all four quarters but towards the destination: counterclockwise from the line to it, and so on around. */
static void by_the_right_hand_rule(void)
{
    know(1, -1000, 7000);
    know(2, -7000, 1000);
    know(3, -2000, -6000);
    address(GOAL, 20000, 100);
    TEST_ASSERT_EQUAL(MH_HOP_NEXT, hop());
    TEST_ASSERT_EQUAL_UINT32(1, next);
    TEST_ASSERT_EQUAL(MH_ENVELOPE_FACE, leaving.envelope);
    TEST_ASSERT_EQUAL_INT32(HERE, leaving.header.entry);
    TEST_ASSERT_EQUAL_INT32(1, leaving.header.first);
    TEST_ASSERT_EQUAL_INT32(0, leaving.header.entry_x_mm);
    message = leaving;
    message.header.entry = 9; /* someone else's walk, begun as far from the destination as this node is */
    static const struct {
        int32_t x_mm, y_mm;
        mh_node_id onward;
    } came_from[] = {{-1000, 7000, 2}, {-7000, 1000, 3}, {-2000, -6000, 1}, {5000, 0, 1}, {1, 0, 1}, {0, -1, 1}};
    for (uint8_t i = 0; i < sizeof came_from / sizeof came_from[0]; i++) {
        message.header.sender_x_mm = came_from[i].x_mm;
        message.header.sender_y_mm = came_from[i].y_mm;
        TEST_ASSERT_EQUAL(MH_HOP_NEXT, hop());
        TEST_ASSERT_EQUAL_UINT32(came_from[i].onward, next);
        TEST_ASSERT_EQUAL(MH_ENVELOPE_FACE, leaving.envelope);
        TEST_ASSERT_EQUAL_INT32(9, leaving.header.entry);
    }
    TEST_ASSERT_EQUAL(MH_HOP_NO_NEIGHBOUR, mh_geographic_next(&table, false, &message, &leaving, &next));
}

static void a_walk_ends_where_it_gains_on_its_beginning(void)
{
    know(1, -1000, 7000);
    know(2, 4000, -6000);
    address(GOAL, 20000, 0);
    message.envelope = MH_ENVELOPE_FACE;
    message.header.entry = 9;
    message.header.entry_x_mm = -3000;
    message.header.sender_x_mm = -1000;
    message.header.sender_y_mm = 7000;
    TEST_ASSERT_EQUAL(MH_HOP_NEXT, hop());
    TEST_ASSERT_EQUAL_UINT32(2, next);
    TEST_ASSERT_EQUAL(MH_ENVELOPE_ROUTE, leaving.envelope);
}

static void a_walk_that_comes_to_its_first_edge_again_is_given_up(void)
{
    know(1, -1000, 7000);
    address(GOAL, 20000, 0);
    TEST_ASSERT_EQUAL(MH_HOP_NEXT, hop());
    message = leaving; /* neighbour 1 knows nobody else and sends it back */
    message.header.sender_x_mm = -1000;
    message.header.sender_y_mm = 7000;
    TEST_ASSERT_EQUAL(MH_HOP_UNREACHABLE, hop());
    message.header.route.destination = -1;
    TEST_ASSERT_EQUAL(MH_HOP_ARRIVED, hop()); /* nobody is nearer */
}

static void nobody_there(void)
{
    address(GOAL, 20000, 0);
    TEST_ASSERT_EQUAL(MH_HOP_NO_NEIGHBOUR, hop());
    address(MH_BROADCAST, 20000, 0);
    TEST_ASSERT_EQUAL(MH_HOP_ARRIVED, hop());
    know(1, -1000, 7000);
    address(GOAL, 0, 0); /* should be at this very place */
    TEST_ASSERT_EQUAL(MH_HOP_UNREACHABLE, hop());
    address(MH_BROADCAST, 0, 0);
    TEST_ASSERT_EQUAL(MH_HOP_ARRIVED, hop());
    address(GOAL, 20000, 0);
    message.header.route.hops = MH_ROUTE_HOPS_MAX;
    TEST_ASSERT_EQUAL(MH_HOP_TOO_MANY, hop());
}

/* From one corner of the map to the others: squares and cross products near 2^63. */
static void at_the_edges_of_the_map(void)
{
    static const struct mh_place corner = {-FAR, -FAR, 0};
    TEST_ASSERT_EQUAL(MH_OK, mh_neighbours_init(&table, HERE, &corner, 8, 35000));
    know(1, FAR, -FAR);
    know(2, -FAR, FAR);
    address(GOAL, FAR, FAR);
    TEST_ASSERT_EQUAL(MH_HOP_NEXT, hop());
    TEST_ASSERT_EQUAL_UINT32(1, next); /* as near as 2 */
    message.envelope = MH_ENVELOPE_FACE;
    message.header.entry = 9;
    message.header.entry_x_mm = FAR - 1;
    message.header.entry_y_mm = FAR;
    message.header.sender_x_mm = FAR;
    message.header.sender_y_mm = -FAR;
    TEST_ASSERT_EQUAL(MH_HOP_NEXT, hop());
    TEST_ASSERT_EQUAL_UINT32(2, next);
    message.header.sender_x_mm = FAR - 1;
    message.header.sender_y_mm = FAR;
    TEST_ASSERT_EQUAL(MH_HOP_NEXT, hop());
    TEST_ASSERT_EQUAL_UINT32(2, next);
    message.header.sender_x_mm = -FAR + 1;
    TEST_ASSERT_EQUAL(MH_HOP_NEXT, hop());
    TEST_ASSERT_EQUAL_UINT32(2, next);
    message.header.sender_x_mm = -FAR;
    TEST_ASSERT_EQUAL(MH_HOP_NEXT, hop());
    TEST_ASSERT_EQUAL_UINT32(1, next);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(to_the_neighbour_nearest_to_the_destination);
    RUN_TEST(straight_to_a_destination_that_is_a_neighbour);
    RUN_TEST(by_the_right_hand_rule);
    RUN_TEST(a_walk_ends_where_it_gains_on_its_beginning);
    RUN_TEST(a_walk_that_comes_to_its_first_edge_again_is_given_up);
    RUN_TEST(nobody_there);
    RUN_TEST(at_the_edges_of_the_map);
    port_exit(UNITY_END() > 0);
    return 0;
}
