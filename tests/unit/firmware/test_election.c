#include "motehound/election.h"
#include "port.h"
#include "unity.h"

#include <string.h>

/* Unless a test says otherwise the target is expected to start from (0, 0) and to go 20 m in the direction of x an interval. */
static struct mh_election_config config;
static struct mh_estimate estimate;
static struct mh_cluster cluster;
static struct mh_candidate nodes[12];
static uint8_t count;

static void use(enum mh_election rule)
{
    mh_election_config_default(&config, rule);
    config.sensing_range_m = MH_REAL(50.001f); /* so that a node at 50 m is in, however floats round */
    TEST_ASSERT_EQUAL(MH_OK, mh_election_check(&config));
}

void setUp(void)
{
    memset(&estimate, 0, sizeof estimate);
    memset(&cluster, 0, sizeof cluster);
    estimate.velocity.x = estimate.stored_velocity.x = MH_REAL(10.0f);
    count = 0;
}

void tearDown(void) {}

static void place(mh_node_id id, int32_t x_m, int32_t y_m, bool detects)
{
    const struct mh_candidate node = {id, {x_m * 1000, y_m * 1000, 0}, detects};
    nodes[count++] = node;
}

/* The present cluster: a head and members out of `nodes`, by their index. */
static void lead(uint8_t head, uint8_t members)
{
    const struct mh_member leader = {nodes[head].id, nodes[head].place, 0, 0};
    cluster.head = leader;
    cluster.count = 0;
    for (uint8_t i = 0; cluster.count < members; i++) {
        if (i != head) {
            const struct mh_member member = {nodes[i].id, nodes[i].place, 0, 0};
            cluster.members[cluster.count++] = member;
        }
    }
}

static enum mh_status elect(void) { return mh_elect(&config, &estimate, nodes, count, &cluster); }

static void expect_members(uint8_t expected, const mh_node_id *ids)
{
    TEST_ASSERT_EQUAL_UINT8(expected, cluster.count);
    for (uint8_t i = 0; i < expected; i++) {
        TEST_ASSERT_EQUAL_UINT32(ids[i], cluster.members[i].id);
    }
}

static void sac_takes_those_that_serve_longest(void)
{
    use(MH_ELECTION_SAC);
    config.members = 3;
    place(1, -40, 0, true); /* covers no P */
    place(2, 0, 40, true);  /* P_1 at 44.7; P_2 at 56.6: 1 */
    place(3, 50, 0, true);  /* P_1 ... P_4 at 30, 10, 10, 30 */
    place(4, 60, 30, true); /* P_1 at 50: just; P_4 at 36: 4 of 4 */
    place(5, 50, 9, true);  /* 4 of 4; P_4 at 31.3 */
    place(6, 90, 0, true);  /* would serve at P_2, but not at P_1 */
    lead(0, 0);
    TEST_ASSERT_EQUAL(MH_OK, elect());
    TEST_ASSERT_EQUAL_UINT32(3, cluster.head.id);
    TEST_ASSERT_EQUAL_UINT8(1, cluster.head.first);
    TEST_ASSERT_EQUAL_UINT8(4, cluster.head.last);
    const mh_node_id ids[] = {5, 4, 2};
    expect_members(3, ids);
    TEST_ASSERT_EQUAL_UINT8(1, cluster.members[2].first);
    TEST_ASSERT_EQUAL_UINT8(1, cluster.members[2].last);
    TEST_ASSERT_EQUAL(MH_NONE, elect());
}

static void sac_renews_a_cluster_that_thins_out(void)
{
    use(MH_ELECTION_SAC);
    config.least_answers = 2;
    place(1, 20, 0, true);
    place(2, 25, 0, true);
    place(3, -45, 0, true);
    place(4, 30, 5, false);
    lead(0, 2);
    TEST_ASSERT_EQUAL(MH_NONE, elect()); /* three answer, two of the cluster cover P_1 */
    config.least_answers = 3;
    TEST_ASSERT_EQUAL(MH_OK, elect()); /* three nodes cover P_1 */
    TEST_ASSERT_EQUAL_UINT32(4, cluster.head.id);
    const mh_node_id ids[] = {2, 1};
    expect_members(2, ids);
    config.least_answers = 4;
    nodes[3].detects = true;
    TEST_ASSERT_EQUAL(MH_NONE, elect()); /* no more than the three there are */
    nodes[1].detects = nodes[2].detects = false;
    TEST_ASSERT_EQUAL(MH_OK, elect()); /* two answered */
    config.least_answers = 0;
    TEST_ASSERT_EQUAL(MH_NONE, elect());
}

static void rho_goes_by_the_way_inside_the_disc(void)
{
    use(MH_ELECTION_RHO);
    config.members = 2;
    place(1, -31, 0, true); /* does not cover P_1 */
    place(2, 15, 10, true); /* the way ahead from (20, 0) ends at x = 15 + sqrt(2400) */
    place(3, 60, 25, true); /* longest, x = 60 + sqrt(1875), but out of the present head's range */
    place(4, 10, -2, true); /* x = 10 + sqrt(2496); in the sector and in range */
    place(5, 15, 30, true); /* x = 15 + 40 = 55; outside the sector */
    lead(0, 0);
    TEST_ASSERT_EQUAL(MH_OK, elect());
    TEST_ASSERT_EQUAL_UINT32(2, cluster.head.id);
    const mh_node_id ids[] = {3, 4};
    expect_members(2, ids);
}

static void rho_relaxes_what_it_asks_of_a_head(void)
{
    use(MH_ELECTION_RHO);
    place(1, -31, 0, true);
    place(2, 5, 30, true);  /* near the head, outside the sector */
    place(3, 60, 25, true); /* in the sector, too far from the head */
    lead(0, 0);
    TEST_ASSERT_EQUAL(MH_OK, elect());
    TEST_ASSERT_EQUAL_UINT32(2, cluster.head.id);
    lead(0, 0);
    nodes[1] = nodes[2];
    count = 2;
    TEST_ASSERT_EQUAL(MH_OK, elect());
    TEST_ASSERT_EQUAL_UINT32(3, cluster.head.id);
    TEST_ASSERT_EQUAL_UINT8(0, cluster.count);
}

static void scm_follows_detection(void)
{
    use(MH_ELECTION_SCM);
    estimate.position.x = MH_REAL(12.0f);
    place(1, 0, 0, true);
    place(2, 10, 0, true);
    place(3, 30, 0, true);
    place(4, 14, 0, false); /* nearest, but silent */
    lead(0, 2);
    TEST_ASSERT_EQUAL(MH_NONE, elect());
    nodes[2].detects = false;
    TEST_ASSERT_EQUAL(MH_NONE, elect()); /* who leaves does no harm */
    nodes[0].detects = false;
    TEST_ASSERT_EQUAL(MH_OK, elect()); /* unless it is the head */
    TEST_ASSERT_EQUAL_UINT32(2, cluster.head.id);
    TEST_ASSERT_EQUAL_UINT8(0, cluster.count);
    nodes[2].detects = nodes[0].detects = true;
    TEST_ASSERT_EQUAL(MH_OK, elect()); /* two join */
    const mh_node_id ids[] = {1, 3};
    expect_members(2, ids);
}

static void scm_variants_differ_in_when(void)
{
    use(MH_ELECTION_SCM_SET);
    place(1, 0, 0, true);
    place(2, 10, 0, true);
    place(3, 30, 0, true);
    lead(0, 2);
    TEST_ASSERT_EQUAL(MH_NONE, elect());
    nodes[2].detects = false;
    TEST_ASSERT_EQUAL(MH_OK, elect());
    TEST_ASSERT_EQUAL_UINT8(1, cluster.count);
    use(MH_ELECTION_SCM_NEAR);
    nodes[2].detects = true;
    TEST_ASSERT_EQUAL(MH_NONE, elect());
    estimate.position.x = MH_REAL(6.0f);
    TEST_ASSERT_EQUAL(MH_OK, elect());
    TEST_ASSERT_EQUAL_UINT32(2, cluster.head.id);
    const mh_node_id ids[] = {1, 3};
    expect_members(2, ids);
}

static void sacx_looks_as_far_as_a_disc_is_wide(void)
{
    use(MH_ELECTION_SACX);
    config.sensing_range_m = MH_REAL(49.99f); /* 99.98 m at 20 m an interval: P_1 ... P_5 */
    config.radio_range_m = MH_REAL(60.0f);
    place(1, -40, 0, true);
    place(2, 60, 0, false);   /* all five; in the middle */
    place(3, 61, 1, false);   /* all five */
    place(4, 109, 0, false);  /* P_3 ... P_5 */
    place(5, 0, 0, true);     /* P_1, P_2; just hears the new head */
    place(6, 121, 0, false);  /* does not */
    place(7, 110, 33, false); /* P_4, P_5 */
    lead(0, 0);
    TEST_ASSERT_EQUAL(MH_OK, elect());
    TEST_ASSERT_EQUAL_UINT32(2, cluster.head.id);
    const mh_node_id ids[] = {3, 4, 7, 5};
    expect_members(4, ids);
    TEST_ASSERT_EQUAL_UINT8(3, cluster.members[1].first);
    TEST_ASSERT_EQUAL_UINT8(5, cluster.members[1].last);
    TEST_ASSERT_EQUAL_UINT8(1, cluster.members[3].first);
    TEST_ASSERT_EQUAL_UINT8(2, cluster.members[3].last);

    place(8, 60, 30, false); /* the new head hears one more */
    TEST_ASSERT_EQUAL(MH_OK, mh_elect_members(&config, &estimate.origin, &estimate.position, &estimate.velocity, nodes,
                                              count, &cluster));
    TEST_ASSERT_EQUAL_UINT8(5, cluster.count);
    use(MH_ELECTION_SAC);
    TEST_ASSERT_EQUAL(
        MH_OK, mh_elect_members(&config, &estimate.origin, &estimate.position, &estimate.velocity, nodes, 0, &cluster));
    TEST_ASSERT_EQUAL_UINT8(5, cluster.count);
}

static void who_is_asked(void)
{
    const struct mh_place predicted = {20000, 0, 0}, near = {80000, 0, 0}, far = {80010, 0, 0};
    const struct mh_place in_radio_range = {100000, 0, 0}, out_of_it = {100001, 0, 0};
    place(1, 0, 0, true);
    place(2, 10, 0, true);
    lead(0, 1);
    use(MH_ELECTION_SACX);
    TEST_ASSERT_TRUE(mh_election_asks(&config, &cluster, 1, &far, &predicted));
    TEST_ASSERT_TRUE(mh_election_asks(&config, &cluster, 2, &near, &predicted));
    TEST_ASSERT_FALSE(mh_election_asks(&config, &cluster, 2, &far, &predicted));
    TEST_ASSERT_FALSE(mh_election_asks(&config, &cluster, 3, &near, &predicted));
    use(MH_ELECTION_SAC);
    TEST_ASSERT_TRUE(mh_election_asks(&config, &cluster, 2, &far, &predicted));
    TEST_ASSERT_FALSE(mh_election_asks(&config, &cluster, 3, &near, &predicted));
    use(MH_ELECTION_SCM);
    TEST_ASSERT_TRUE(mh_election_asks(&config, &cluster, 3, &in_radio_range, &predicted));
    TEST_ASSERT_FALSE(mh_election_asks(&config, &cluster, 3, &out_of_it, &predicted));
}

static void sacx_looks_from_the_position_itself(void)
{
    use(MH_ELECTION_SACX);
    estimate.stored.y = MH_REAL(300.0f);
    estimate.stored_velocity.x = MH_REAL(-10.0f);
    place(1, -60, 0, true);
    place(2, 40, 0, true);
    place(3, 0, 290, true);
    lead(0, 0);
    TEST_ASSERT_EQUAL(MH_OK, elect());
    TEST_ASSERT_EQUAL_UINT32(2, cluster.head.id);
    use(MH_ELECTION_SAC);
    lead(0, 0);
    TEST_ASSERT_EQUAL(MH_OK, elect());
    TEST_ASSERT_EQUAL_UINT32(3, cluster.head.id);
}

static void sacx_asks_all_when_few_answer(void)
{
    use(MH_ELECTION_SACX);
    TEST_ASSERT_TRUE(mh_election_asks_all(&config, 0));
    TEST_ASSERT_TRUE(mh_election_asks_all(&config, 3));
    TEST_ASSERT_FALSE(mh_election_asks_all(&config, 4));
    use(MH_ELECTION_SAC);
    TEST_ASSERT_FALSE(mh_election_asks_all(&config, 0));
}

static void first_cluster_is_about_the_detection(void)
{
    use(MH_ELECTION_SAC);
    config.members = 2;
    const struct mh_place about = {9000, 0, 0};
    place(1, 0, 0, true);
    place(2, 10, 0, false);
    place(3, 12, 0, true);
    place(4, 25, 0, true);
    place(5, 20, 0, true);
    TEST_ASSERT_EQUAL(MH_OK, mh_elect_first(&config, &about, nodes, count, &cluster));
    TEST_ASSERT_EQUAL_UINT32(3, cluster.head.id);
    const mh_node_id ids[] = {5, 1};
    expect_members(2, ids);
    config.rule = MH_ELECTION_SCM;
    TEST_ASSERT_EQUAL(MH_OK, mh_elect_first(&config, &about, nodes, count, &cluster));
    TEST_ASSERT_EQUAL_UINT8(3, cluster.count);
    const struct mh_cluster before = cluster;
    TEST_ASSERT_EQUAL(MH_NONE, mh_elect_first(&config, &about, nodes + 1, 1, &cluster));
    TEST_ASSERT_EQUAL(MH_NONE, mh_elect_first(&config, &about, nodes, 0, &cluster));
    TEST_ASSERT_EQUAL_MEMORY(&before, &cluster, sizeof cluster);
}

static void lowest_identifier_breaks_ties(void)
{
    for (enum mh_election rule = MH_ELECTION_SACX; rule < MH_ELECTIONS; rule++) {
        use(rule);
        config.radio_range_m = MH_REAL(200.0f);
        count = 0;
        place(9, -60, 0, rule == MH_ELECTION_SCM_SET); /* the head covers nothing, and detects nothing new */
        place(7, 40, 20, true);
        place(3, 40, 20, true);
        place(5, 40, -20, true);
        lead(0, 0);
        estimate.position.x = MH_REAL(30.0f);
        TEST_ASSERT_EQUAL(MH_OK, elect());
        TEST_ASSERT_EQUAL_UINT32(3, cluster.head.id);
        TEST_ASSERT_EQUAL_UINT32(5, cluster.members[0].id);
        TEST_ASSERT_EQUAL_UINT32(7, cluster.members[1].id);
    }
}

static void nobody_to_elect(void)
{
    for (enum mh_election rule = MH_ELECTION_SACX; rule < MH_ELECTIONS; rule++) {
        use(rule);
        count = 0;
        TEST_ASSERT_EQUAL(MH_NONE, elect());
        place(1, -500, 0, false);
        lead(0, 0);
        const struct mh_cluster before = cluster;
        TEST_ASSERT_EQUAL(MH_NONE, elect());
        TEST_ASSERT_EQUAL_MEMORY(&before, &cluster, sizeof cluster);
        place(2, 20, 0, true); /* the only one */
        TEST_ASSERT_EQUAL(MH_OK, elect());
        TEST_ASSERT_EQUAL_UINT32(2, cluster.head.id);
        TEST_ASSERT_EQUAL_UINT8(0, cluster.count);
    }
}

static void target_at_rest(void)
{
    estimate.velocity.x = estimate.stored_velocity.x = 0;
    place(1, -60, 0, false);
    place(2, 30, 0, true);
    place(3, -20, 0, true); /* behind, if there were such a thing */
    const enum mh_election rules[] = {MH_ELECTION_SACX, MH_ELECTION_SAC, MH_ELECTION_RHO};
    for (uint8_t i = 0; i < 3; i++) {
        use(rules[i]);
        lead(0, 0);
        TEST_ASSERT_EQUAL(MH_OK, elect());
        TEST_ASSERT_EQUAL_UINT32(3, cluster.head.id);
        TEST_ASSERT_EQUAL_UINT32(2, cluster.members[0].id);
        TEST_ASSERT_EQUAL_UINT8(rules[i] == MH_ELECTION_SACX  ? MH_ELECTION_HORIZON_MAX
                                : rules[i] == MH_ELECTION_SAC ? config.horizon
                                                              : 0,
                                cluster.head.last);
    }
}

static void all_on_a_line(void)
{
    for (enum mh_election rule = MH_ELECTION_SACX; rule <= MH_ELECTION_RHO; rule++) {
        use(rule);
        count = 0;
        for (uint8_t i = 0; i < 12; i++) {
            place(i, 20 * i - 80, 0, true); /* -80 ... 140 */
        }
        lead(0, 0);
        TEST_ASSERT_EQUAL(MH_OK, elect());
        TEST_ASSERT_EQUAL_UINT32(
            7, cluster.head.id); /* x = 60: P_1 ... P_5 in its disc, and nobody farther on covers P_1 */
    }
}

static uint32_t random_state;

static int32_t random_below(int32_t limit)
{
    random_state = random_state * 1664525u + 1013904223u;
    return (int32_t)((random_state >> 8) % (uint32_t)limit);
}

/* From P_q, squared, in mm2. */
static int64_t squared_distance(const struct mh_candidate *node, uint8_t q)
{
    const int64_t x = node->place.x_mm - (int32_t)20000 * q, y = node->place.y_mm;
    return x * x + y * y;
}

/* How many of P_1 ... P_last. */
static uint8_t covered(const struct mh_candidate *node, uint8_t last)
{
    uint8_t instants = 0;
    for (uint8_t q = 1; q <= last; q++) {
        if (squared_distance(node, q) <= (int64_t)50001 * 50001) {
            instants++;
        }
    }
    return instants;
}

/* sac against its definition: the order in which candidates precede each other. */
static void sac_is_what_it_says(void)
{
    use(MH_ELECTION_SAC);
    config.members = 4;
    for (uint16_t field = 0; field < 300; field++) {
        count = 0;
        for (uint8_t i = 0; i < 12; i++) {
            place(i, 0, 0, true);
            nodes[i].place.x_mm = random_below(120000) - 30000;
            nodes[i].place.y_mm = random_below(120000) - 60000;
        }
        nodes[0].place.x_mm = -100000;
        lead(0, 0);
        uint8_t candidates = 0;
        mh_node_id order[12];
        for (uint8_t i = 0; i < count; i++) {
            uint8_t before = 0;
            for (uint8_t j = 0; j < count; j++) {
                const bool more = covered(&nodes[j], 4) > covered(&nodes[i], 4);
                const bool as_many = covered(&nodes[j], 4) == covered(&nodes[i], 4);
                const bool precedes =
                    more || (as_many && squared_distance(&nodes[j], 4) < squared_distance(&nodes[i], 4));
                if (covered(&nodes[j], 1) && precedes) {
                    before++;
                }
            }
            if (covered(&nodes[i], 1)) {
                order[before] = i;
                candidates++;
            }
        }
        if (candidates == 0) {
            TEST_ASSERT_EQUAL(MH_NONE, elect());
            continue;
        }
        TEST_ASSERT_EQUAL(MH_OK, elect());
        TEST_ASSERT_EQUAL_UINT32(order[0], cluster.head.id);
        expect_members(candidates > 4 ? 4 : (uint8_t)(candidates - 1), order + 1);
    }
}

static void what_is_refused(void)
{
    use(MH_ELECTION_SAC);
    place(1, -40, 0, true);
    place(2, 20, 0, true);
    lead(0, 0);
    const struct mh_cluster before = cluster;
    estimate.stored.x = mh_real_from_float(NAN);
    TEST_ASSERT_EQUAL(MH_ERR_NOT_FINITE, elect());
    estimate.stored.x = 0;
    estimate.stored_velocity.y = mh_real_from_float(INFINITY);
    TEST_ASSERT_EQUAL(MH_ERR_NOT_FINITE, elect());
    estimate.velocity.y = mh_real_from_float(INFINITY);
    TEST_ASSERT_EQUAL(MH_ERR_NOT_FINITE, mh_elect_members(&config, &estimate.origin, &estimate.position,
                                                          &estimate.velocity, nodes, count, &cluster));
    TEST_ASSERT_EQUAL_MEMORY(&before, &cluster, sizeof cluster);

    struct mh_election_config wrong = config;
    wrong.members = 0;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_election_check(&wrong));
    wrong.members = MH_CLUSTER_MAX + 1;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_election_check(&wrong));
    wrong = config;
    wrong.horizon = 0;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_election_check(&wrong));
    wrong = config;
    wrong.sensing_range_m = mh_real_from_float(NAN);
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_election_check(&wrong));
    wrong = config;
    wrong.rule = MH_ELECTIONS;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_election_check(&wrong));
    wrong = config;
    wrong.interval = 0;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_election_check(&wrong));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(sac_takes_those_that_serve_longest);
    RUN_TEST(sac_renews_a_cluster_that_thins_out);
    RUN_TEST(rho_goes_by_the_way_inside_the_disc);
    RUN_TEST(rho_relaxes_what_it_asks_of_a_head);
    RUN_TEST(scm_follows_detection);
    RUN_TEST(scm_variants_differ_in_when);
    RUN_TEST(sacx_looks_as_far_as_a_disc_is_wide);
    RUN_TEST(who_is_asked);
    RUN_TEST(sacx_looks_from_the_position_itself);
    RUN_TEST(sacx_asks_all_when_few_answer);
    RUN_TEST(first_cluster_is_about_the_detection);
    RUN_TEST(lowest_identifier_breaks_ties);
    RUN_TEST(nobody_to_elect);
    RUN_TEST(target_at_rest);
    RUN_TEST(all_on_a_line);
    RUN_TEST(sac_is_what_it_says);
    RUN_TEST(what_is_refused);
    port_exit(UNITY_END() > 0);
    return 0;
}
