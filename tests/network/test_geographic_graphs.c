/* Geographic routing on random unit-disc graphs: motes' own tables and forwarding, hellos and hops handed over without loss. */
#include "motehound/geographic.h"
#include "port.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef __SANITIZE_ADDRESS__
#define SHARE 20 /* sanitizers take ten times as long, and look for other things */
#else
#define SHARE 1
#endif

enum {
    GRAPHS = 10000 / SHARE,
    NODES_MAX = 200,
    PAIRS = 6,
    LIFETIME = 35000,
    CANDIDATES_MAX = 1200,
    UNREACHED = UINT16_MAX
};

struct graph {
    unsigned count;
    int64_t range_mm;
    struct mh_place place[NODES_MAX];
    mh_node_id id[NODES_MAX];
    uint16_t degree[NODES_MAX], neighbour[NODES_MAX][NODES_MAX];
    struct mh_neighbours table[NODES_MAX];
    unsigned walked[NODES_MAX][NODES_MAX]; /* the last walk that took this edge in this direction */
    unsigned walks;
};

static struct graph graph;
static uint64_t state;

void setUp(void) { state = 1; }
void tearDown(void) {}

/* ---- random numbers: the 64-bit generator of PCG's state, upper half (Knuth's MMIX multiplier) ---- */

static double uniform(void)
{
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(state >> 11) / 9007199254740992.0;
}

static unsigned below(unsigned limit) { return (unsigned)(uniform() * limit); }

/* ---- fields: the unit is the radio range ---- */

struct point {
    double x, y;
};

/* Points at random with so many neighbours on average, as many as may be in a component of 50 to 200 nodes. */
static unsigned scatter(struct point *p, double degree, unsigned count)
{
    const double side = sqrt(count * 3.14159265 / degree);
    for (unsigned i = 0; i < count; i++) {
        p[i].x = uniform() * side;
        p[i].y = uniform() * side;
    }
    return count;
}

/* ... without those in some discs */
static unsigned scatter_around_holes(struct point *p)
{
    const unsigned count = scatter(p, 7 + 5 * uniform(), 220), holes = 1 + below(6);
    const double side = sqrt(220 * 3.14159265 / 9);
    struct point centre[6];
    double radius[6];
    for (unsigned h = 0; h < holes; h++) {
        centre[h] = (struct point){uniform() * side, uniform() * side};
        radius[h] = 0.7 + 1.8 * uniform();
    }
    unsigned kept = 0;
    for (unsigned i = 0; i < count; i++) {
        bool free = true;
        for (unsigned h = 0; h < holes; h++) {
            free = free && hypot(p[i].x - centre[h].x, p[i].y - centre[h].y) > radius[h];
        }
        if (free) {
            p[kept++] = p[i];
        }
    }
    return kept;
}

/* ... only along a spiral, a comb or a row of cups: greedy forwarding runs into each */
static unsigned scatter_in_a_maze(struct point *p)
{
    const unsigned shape = below(3), count = 120 + below(80);
    const double width = 0.35 + 0.35 * uniform();
    unsigned kept = 0;
    while (kept < count) {
        const double t = uniform(), across = (uniform() - 0.5) * 2 * width;
        struct point q;
        if (shape == 0) {
            const double angle = 4 * 3.14159265 * sqrt(0.03 + t), radius = 0.36 * angle + across;
            q = (struct point){radius * cos(angle), radius * sin(angle)};
        } else {
            const double length = t * 27; /* up, across, down, across, ... in a meander of height 5 and pitch 2.4 */
            const unsigned turn = (unsigned)(length / 7.4);
            const double within = length - turn * 7.4;
            const bool down = shape == 1 && turn % 2 == 1;
            q = within < 5 ? (struct point){turn * 2.4 + across, down ? 5 - within : within}
                           : (struct point){turn * 2.4 + within - 5, (down ? 0 : 5) + across};
        }
        p[kept++] = q;
    }
    return kept;
}

/* ... on a lattice with nodes missing: collinear, equidistant and cocircular places */
static unsigned place_on_a_lattice(struct point *p)
{
    const double step = below(2) ? 1.0 : 1 / sqrt(2.0) - 1e-9, missing = 0.5 * uniform();
    unsigned kept = 0;
    for (unsigned i = 0; i < 18 * 18; i++) {
        if (uniform() > missing) {
            p[kept++] = (struct point){i % 18 * step, i / 18 * step};
        }
    }
    return kept;
}

static unsigned choose_points(struct point *p, unsigned kind)
{
    switch (kind) {
    case 0:
        return scatter(p, 4.6 + 2 * uniform(), 300 + below(300));
    case 1:
        return scatter_around_holes(p);
    case 2:
        return scatter_in_a_maze(p);
    case 3:
        return place_on_a_lattice(p);
    default:
        return scatter(p, 25 + 25 * uniform(), 150 + below(50)); /* more neighbours than a small table holds */
    }
}

static bool in_range(const struct mh_place *a, const struct mh_place *b)
{
    const int64_t dx = (int64_t)a->x_mm - b->x_mm, dy = (int64_t)a->y_mm - b->y_mm;
    return dx * dx + dy * dy <= graph.range_mm * graph.range_mm;
}

/* The points reached from point `from` -> the first of order[], nearest in hops first; the others behind them. */
static unsigned gather(const struct mh_place *place, unsigned count, unsigned from, uint16_t *order)
{
    unsigned reached = 1;
    for (unsigned i = 0; i < count; i++) {
        order[i] = (uint16_t)i;
    }
    order[0] = (uint16_t)from;
    order[from] = 0;
    for (unsigned next = 0; next < reached; next++) {
        for (unsigned j = reached; j < count; j++) {
            if (in_range(&place[order[next]], &place[order[j]])) {
                const uint16_t found = order[j];
                order[j] = order[reached];
                order[reached++] = found;
            }
        }
    }
    return reached;
}

/* The largest component of the points, up to 200 nodes of it, somewhere on the map and in some scale. */
static void make_graph(unsigned kind)
{
    static struct point point[CANDIDATES_MAX];
    static struct mh_place place[CANDIDATES_MAX];
    static uint16_t order[CANDIDATES_MAX];
    unsigned reached = 0;
    while (reached < 50) {
        const unsigned count = choose_points(point, kind);
        const double scale = pow(10, 3 + 4 * uniform()); /* 1 m to 10 km */
        const double x0 = (uniform() - 0.5) * 1.6e9, y0 = (uniform() - 0.5) * 1.6e9;
        graph.range_mm = (int64_t)scale;
        for (unsigned i = 0; i < count; i++) {
            place[i] = (struct mh_place){(int32_t)lround(x0 + point[i].x * scale),
                                         (int32_t)lround(y0 + point[i].y * scale), 0};
        }
        for (unsigned tries = 0; tries < 5 && reached < 50; tries++) {
            reached = gather(place, count, below(count), order);
        }
    }
    graph.count = reached < NODES_MAX ? reached : NODES_MAX;
    for (unsigned i = 0; i < graph.count; i++) {
        graph.place[i] = place[order[i]];
        graph.id[i] = 1000 + (order[i] * 7919u) % 10007u;
    }
}

static void link_up(uint8_t capacity)
{
    for (unsigned i = 0; i < graph.count; i++) {
        TEST_ASSERT_EQUAL(MH_OK, mh_neighbours_init(&graph.table[i], graph.id[i], &graph.place[i], capacity, LIFETIME));
        graph.degree[i] = 0;
        for (unsigned j = 0; j < graph.count; j++) {
            if (i != j && in_range(&graph.place[i], &graph.place[j])) {
                graph.neighbour[i][graph.degree[i]++] = (uint16_t)j;
            }
        }
    }
}

/* Hops of the shortest paths from a node; UNREACHED where there is none. */
static void search(unsigned from, uint16_t *hops)
{
    uint16_t order[NODES_MAX];
    unsigned reached = 1;
    memset(hops, 0xFF, graph.count * sizeof *hops);
    hops[from] = 0;
    order[0] = (uint16_t)from;
    for (unsigned next = 0; next < reached; next++) {
        const unsigned i = order[next];
        for (unsigned k = 0; k < graph.degree[i]; k++) {
            const uint16_t j = graph.neighbour[i][k];
            if (hops[j] == UNREACHED) {
                hops[j] = (uint16_t)(hops[i] + 1);
                order[reached++] = j;
            }
        }
    }
}

/* Every node says hello so many times, each round in another order. */
static void exchange_hellos(unsigned rounds)
{
    for (unsigned round = 0; round < rounds; round++) {
        const unsigned offset = below(graph.count);
        for (unsigned k = 0; k < graph.count; k++) {
            const unsigned i = (offset + (round % 2 ? graph.count - 1 - k : k)) % graph.count;
            const mh_hello_t hello = {(int32_t)graph.id[i], graph.place[i].x_mm, graph.place[i].y_mm, (int16_t)round};
            for (unsigned n = 0; n < graph.degree[i]; n++) {
                mh_neighbours_hello(&graph.table[graph.neighbour[i][n]], 10000 * round + k, &hello);
            }
        }
    }
}

static unsigned index_of(mh_node_id id)
{
    unsigned i = 0;
    while (graph.id[i] != id) {
        i++;
    }
    return i;
}

/* ---- messages ---- */

struct journey {
    enum mh_hop end;
    unsigned at, hops;
    bool walked; /* around a face */
};

static struct journey travel(unsigned from, mh_node_id to, const struct mh_place *place, bool faces)
{
    struct mh_message message = {.kind = MH_MESSAGE_REPORT};
    struct journey journey = {.at = from};
    mh_geographic_address(&message, graph.id[from], 7, to, place);
    for (;;) {
        mh_node_id next;
        journey.end = mh_geographic_next(&graph.table[journey.at], faces, &message, &message, &next);
        if (journey.end != MH_HOP_NEXT) {
            return journey;
        }
        const unsigned there = index_of(next);
        TEST_ASSERT_TRUE(in_range(&graph.place[journey.at], &graph.place[there]));
        const unsigned before = journey.at;
        journey.at = there;
        journey.hops++;
        if (message.envelope == MH_ENVELOPE_FACE) {
            journey.walked = true;
            graph.walks += message.header.entry == (int32_t)graph.id[before] && message.header.first == (int32_t)next;
            if (graph.walked[before][there] == graph.walks) { /* in a circle that is no face */
                journey.end = MH_HOP_TOO_MANY;
                return journey;
            }
            graph.walked[before][there] = graph.walks;
        }
    }
}

static double distance2(const struct mh_place *a, const struct mh_place *b)
{
    const double dx = (double)a->x_mm - b->x_mm, dy = (double)a->y_mm - b->y_mm;
    return dx * dx + dy * dy;
}

struct statistics {
    unsigned long journeys, delivered, walked, greedy_delivered, hops, shortest;
    unsigned most_hops;
};

static void travel_between_pairs(struct statistics *s)
{
    uint16_t hops[NODES_MAX];
    for (unsigned pair = 0; pair < PAIRS; pair++) {
        const unsigned from = below(graph.count), to = below(graph.count);
        const struct journey journey = travel(from, graph.id[to], &graph.place[to], true);
        search(from, hops);
        s->journeys++;
        s->delivered += journey.end == MH_HOP_ARRIVED && journey.at == to;
        s->walked += journey.walked;
        s->greedy_delivered += travel(from, graph.id[to], &graph.place[to], false).end == MH_HOP_ARRIVED;
        s->hops += journey.hops;
        s->shortest += hops[to];
        s->most_hops = journey.hops > s->most_hops ? journey.hops : s->most_hops;
    }
}

/* A message for whoever is nearest ends at a node to which no other is nearer. */
static void travel_to_a_place(void)
{
    const struct mh_place *corner = &graph.place[below(graph.count)];
    const struct mh_place place = {corner->x_mm + (int32_t)((uniform() - 0.5) * 6 * (double)graph.range_mm),
                                   corner->y_mm + (int32_t)((uniform() - 0.5) * 6 * (double)graph.range_mm), 0};
    const struct journey journey = travel(below(graph.count), MH_BROADCAST, &place, true);
    TEST_ASSERT_EQUAL(MH_HOP_ARRIVED, journey.end);
    for (unsigned i = 0; i < graph.count; i++) {
        TEST_ASSERT_TRUE(distance2(&graph.place[journey.at], &place) <= distance2(&graph.place[i], &place));
    }
}

static void every_message_arrives(void)
{
    static const char *const names[] = {"sparse", "holes", "mazes", "lattices", "dense"};
    struct statistics all[5] = {{0}};
    for (unsigned g = 0; g < GRAPHS; g++) {
        const unsigned kind = g % 20 == 19 ? 4 : g % 4;
        struct statistics *s = &all[kind];
        make_graph(kind);
        link_up(kind == 4 ? 12 : MH_NEIGHBOURS_MAX);
        exchange_hellos(kind == 4 ? 5 : 2);
        travel_between_pairs(s);
        travel_to_a_place();
        TEST_ASSERT_EQUAL_MESSAGE(s->journeys, s->delivered, names[kind]);
        TEST_ASSERT_TRUE(s->hops >= s->shortest);
    }
    for (unsigned kind = 0; kind < 5; kind++) {
        const struct statistics *s = &all[kind];
        printf("%-8s %lu messages, all arrive; greedily %.1f %%; %.2f x the shortest path, at most %u hops\n",
               names[kind], s->journeys, 100.0 * (double)s->greedy_delivered / (double)s->journeys,
               (double)s->hops / (double)s->shortest, s->most_hops);
    }
}

/* Without the nodes in a broad gap the graph falls into two parts. */
static void cut_in_two(void)
{
    unsigned kept = 0;
    const int32_t middle = graph.place[below(graph.count)].x_mm;
    for (unsigned i = 0; i < graph.count; i++) {
        if (llabs((long long)graph.place[i].x_mm - middle) > graph.range_mm * 51 / 100) {
            graph.place[kept] = graph.place[i];
            graph.id[kept++] = graph.id[i];
        }
    }
    graph.count = kept;
}

static void what_cannot_arrive_is_given_up(void)
{
    unsigned given_up = 0, most_hops = 0;
    for (unsigned g = 0; g < 1000 / SHARE; g++) {
        uint16_t hops[NODES_MAX];
        make_graph(g % 20 == 19 ? 4 : g % 4);
        cut_in_two();
        if (graph.count < 2) {
            continue;
        }
        link_up(MH_NEIGHBOURS_MAX);
        exchange_hellos(5);
        for (unsigned pair = 0; pair < PAIRS; pair++) {
            const unsigned from = below(graph.count), to = below(graph.count);
            const struct journey journey = travel(from, graph.id[to], &graph.place[to], true);
            search(from, hops);
            if (hops[to] != UNREACHED) {
                TEST_ASSERT_EQUAL(MH_HOP_ARRIVED, journey.end);
            } else {
                TEST_ASSERT_EQUAL(graph.degree[from] > 0 ? MH_HOP_UNREACHABLE : MH_HOP_NO_NEIGHBOUR, journey.end);
                given_up++;
                most_hops = journey.hops > most_hops ? journey.hops : most_hops;
            }
        }
    }
    printf("%u messages given up, after at most %u hops\n", given_up, most_hops);
    TEST_ASSERT_GREATER_THAN(1000 / SHARE, given_up);
}

/* Beyond the guarantee: tables that do not hold all neighbours of the Gabriel graph. Nothing travels for ever, and where a message is lost some
 * table has counted that it lacked room. */
static void too_small_tables_lose_messages_and_say_so(void)
{
    for (uint8_t capacity = 3; capacity <= 9; capacity++) {
        unsigned arrived = 0, sent = 0, too_many = 0;
        state = 1;
        for (unsigned g = 0; g < 100 / SHARE; g++) {
            make_graph(g % 4 == 3 ? 4 : 0);
            link_up(capacity);
            exchange_hellos(6);
            unsigned lacking = 0;
            for (unsigned i = 0; i < graph.count; i++) {
                lacking += graph.table[i].lost[MH_NEIGHBOUR_PLANAR] > 0;
            }
            for (unsigned pair = 0; pair < PAIRS; pair++) {
                const unsigned from = below(graph.count), to = below(graph.count);
                const struct journey journey = travel(from, graph.id[to], &graph.place[to], true);
                sent++;
                arrived += journey.end == MH_HOP_ARRIVED;
                too_many += journey.end == MH_HOP_TOO_MANY;
                TEST_ASSERT_TRUE(journey.end == MH_HOP_ARRIVED || lacking > 0);
            }
        }
        printf("table of %u: %.1f %% arrive, %.1f %% go in circles\n", capacity, 100.0 * arrived / sent,
               100.0 * too_many / sent);
        TEST_ASSERT_TRUE(capacity < 9 || arrived == sent);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_message_arrives);
    RUN_TEST(what_cannot_arrive_is_given_up);
    RUN_TEST(too_small_tables_lose_messages_and_say_so);
    port_exit(UNITY_END() > 0);
    return 0;
}
