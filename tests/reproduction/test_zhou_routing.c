/* Reports routed to the sink of the published deployments: the motes' own tables and forwarding, hellos and hops handed over without loss. */
#include "motehound/geographic.h"
#include "port.h"
#include "unity.h"
#include "world/deployment.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#ifdef __SANITIZE_ADDRESS__ /* sanitizers take long, and look for other things than the mean over all seeds */
enum { SEEDS = 1, SPREAD = 25 };
#else
enum { SEEDS = 20, SPREAD = 1 };
#endif

enum { NODES = 1000, SINK = NODES, MOTES = NODES + 1, LIFETIME = 35000 };

#define RADIO_RANGE_M 100

static char error[300];
static struct scenario scenario;

static struct {
    struct mh_place place[MOTES];
    unsigned degree[MOTES];
    uint16_t neighbour[MOTES][MOTES];
    struct mh_neighbours table[MOTES];
    bool connected[MOTES]; /* to the sink */
} network;

void setUp(void)
{
    TEST_ASSERT_EQUAL_INT(0, scenario_init(&scenario));
    scenario.network.nodes = NODES;
    scenario.network.layout = LAYOUT_HASHED;
}

void tearDown(void) { scenario_free(&scenario); }

static void place_motes(uint64_t seed)
{
    struct deployment nodes;
    const struct scenario_field field = scenario_field(&scenario);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, deployment_make(&nodes, &scenario, seed, error, sizeof error), error);
    for (size_t i = 0; i < MOTES; i++) {
        const double x_m = i < SINK ? nodes.nodes[i].x_m : field.sink_x_m;
        const double y_m = i < SINK ? nodes.nodes[i].y_m : field.sink_y_m;
        network.place[i] = (struct mh_place){(int32_t)lround(1000 * x_m), (int32_t)lround(1000 * y_m), 0};
    }
    deployment_free(&nodes);
}

static bool in_range(size_t i, size_t j)
{
    const struct mh_place *a = &network.place[i], *b = &network.place[j];
    return hypot((double)a->x_mm - b->x_mm, (double)a->y_mm - b->y_mm) <= 1000.0 * RADIO_RANGE_M;
}

/* Every mote says hello twice. */
static void meet(uint8_t capacity)
{
    for (size_t i = 0; i < MOTES; i++) {
        TEST_ASSERT_EQUAL(MH_OK,
                          mh_neighbours_init(&network.table[i], (mh_node_id)i, &network.place[i], capacity, LIFETIME));
        mh_neighbours_keep(&network.table[i], SINK);
        network.degree[i] = 0;
        for (size_t j = 0; j < MOTES; j++) {
            if (i != j && in_range(i, j)) {
                network.neighbour[i][network.degree[i]++] = (uint16_t)j;
            }
        }
    }
    for (int16_t round = 0; round < 2; round++) {
        for (size_t i = 0; i < MOTES; i++) {
            const mh_hello_t hello = {(int32_t)i, network.place[i].x_mm, network.place[i].y_mm, round};
            for (unsigned k = 0; k < network.degree[i]; k++) {
                mh_neighbours_hello(&network.table[network.neighbour[i][k]], (mh_tick)(10000 * round), &hello);
            }
        }
    }
}

/* Those that a flood from the sink comes to. */
static void flood(void)
{
    static uint16_t reached[MOTES];
    size_t count = 1;
    memset(network.connected, 0, sizeof network.connected);
    network.connected[SINK] = true;
    reached[0] = SINK;
    for (size_t next = 0; next < count; next++) {
        for (unsigned k = 0; k < network.degree[reached[next]]; k++) {
            const uint16_t i = network.neighbour[reached[next]][k];
            if (!network.connected[i]) {
                network.connected[i] = true;
                reached[count++] = i;
            }
        }
    }
}

struct routes {
    unsigned connected, delivered, hops,
        walked; /* by nodes, but for the hops; walked: by a face, since no neighbour was nearer */
};

static void send_to_the_sink(size_t from, struct routes *routes)
{
    struct mh_message message = {.kind = MH_MESSAGE_REPORT};
    mh_node_id at = (mh_node_id)from;
    unsigned hops = 0;
    bool walked = false;
    enum mh_hop hop;
    mh_geographic_address(&message, at, 1, SINK, &network.place[SINK]);
    while ((hop = mh_geographic_next(&network.table[at], true, &message, &message, &at)) == MH_HOP_NEXT) {
        walked = walked || message.envelope == MH_ENVELOPE_FACE;
        hops++;
    }
    const bool delivered = hop == MH_HOP_ARRIVED && at == SINK;
    TEST_ASSERT_TRUE(!delivered || network.connected[from]);
    routes->connected += network.connected[from];
    routes->delivered += delivered;
    routes->hops += delivered ? hops : 0;
    routes->walked += walked && network.connected[from];
}

/* Totals over the seeds, from every node. */
static struct routes route_all(double density, uint8_t capacity)
{
    struct routes routes = {0, 0, 0, 0};
    scenario.network.density = density;
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        place_motes(seed);
        meet(capacity);
        flood();
        for (size_t i = 0; i < NODES; i++) {
            send_to_the_sink(i, &routes);
        }
    }
    printf("density %2g, tables of %3u: %.1f of %d nodes connected, %.1f delivered, %.4f hops, %.1f by a face\n",
           density, capacity, routes.connected / (double)SEEDS, NODES, routes.delivered / (double)SEEDS,
           routes.hops / (double)routes.delivered, routes.walked / (double)SEEDS);
    return routes;
}

static void check(double density, uint8_t capacity, double tolerance, double published_hops)
{
    const struct routes routes = route_all(density, capacity);
    TEST_ASSERT_EQUAL_UINT(SEEDS * NODES, routes.connected);
    TEST_ASSERT_EQUAL_UINT(routes.connected, routes.delivered);
    TEST_ASSERT_EQUAL_UINT(0, routes.walked);
    TEST_ASSERT_TRUE(fabs(routes.hops / (double)routes.delivered / published_hops - 1) <= SPREAD * tolerance);
}

/* No local minima: greedy all the way. */
static void dense_fields(void)
{
    check(8, MH_NEIGHBOURS_MAX, 0.002, 4.782);
    check(24, MH_NEIGHBOURS_MAX, 0.002, 2.774);
}

/* A mote that has no room for all its neighbours keeps those that bring a message farthest, and the sink. */
static void dense_fields_with_tables_as_on_motes(void)
{
    check(8, 32, 0.002, 4.782);
    check(24, 32, 0.002, 2.774);
    check(24, 16, 0.02, 2.774);
}

static void a_sparse_field(void)
{
    const struct routes routes = route_all(2, MH_NEIGHBOURS_MAX);
    TEST_ASSERT_TRUE(fabs(routes.connected / (double)SEEDS - 994) <= SPREAD * 0.5);
    TEST_ASSERT_EQUAL_UINT(routes.connected, routes.delivered);
    TEST_ASSERT_TRUE(routes.walked > 0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(dense_fields);
    RUN_TEST(dense_fields_with_tables_as_on_motes);
    RUN_TEST(a_sparse_field);
    port_exit(UNITY_END() > 0);
    return 0;
}
