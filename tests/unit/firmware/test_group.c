#include "motehound/group.h"
#include "port.h"
#include "unity.h"

#include <string.h>

void setUp(void) {}
void tearDown(void) {}

static struct mh_group_config config;
static mh_real velocity_sd;

static struct mh_vec2 at(mh_real x, mh_real y)
{
    const struct mh_vec2 place = {x, y};
    return place;
}

/* Two single targets at (-half, 0) and (half, 0) with the given velocities, joined. */
static void join_two(struct mh_group *group, mh_real half, struct mh_vec2 left, struct mh_vec2 right)
{
    struct mh_group other;
    mh_group_single(group, 5);
    mh_group_single(&other, 3);
    struct mh_vec2 centroid = at(-half, 0), velocity = left;
    TEST_ASSERT_EQUAL(MH_OK, mh_group_join(group, &centroid, &velocity, &other, at(half, 0), right));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0, centroid.x);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.5f * (left.y + right.y), velocity.y);
}

static void configurations(void)
{
    for (int mode = MH_GROUP_NONE; mode <= MH_GROUP_WEIGHTS; mode++) {
        mh_group_config_default(&config, (enum mh_group_mode)mode);
        TEST_ASSERT_EQUAL(MH_OK, mh_group_config_check(&config));
    }
    config.split_m = config.merge_m - 1;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_group_config_check(&config));
    mh_group_config_default(&config, MH_GROUP_MEMBERS);
    config.merge_epochs = 0;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_group_config_check(&config));
    mh_group_config_default(&config, MH_GROUP_MEMBERS);
    config.odds = NAN;
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_group_config_check(&config));
}

static void a_join_keeps_places_velocities_and_order(void)
{
    struct mh_group group;
    join_two(&group, 9, at(10, 2), at(10, -3));
    TEST_ASSERT_EQUAL(2, group.count);
    TEST_ASSERT_EQUAL(3, group.targets[0].target);
    TEST_ASSERT_EQUAL(5, group.targets[1].target);
    TEST_ASSERT_EQUAL(-12, group.targets[0].vy); /* quarters of m/s */
    TEST_ASSERT_EQUAL(8, group.targets[1].vy);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 9, mh_group_extent(&group));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 109, mh_group_place(&group, at(100, 50), 0).x);

    /* A third one, at twice the weight of the pair's members. */
    struct mh_group third;
    mh_group_single(&third, 4);
    struct mh_vec2 centroid = at(0, 0), velocity = at(10, 0);
    TEST_ASSERT_EQUAL(MH_OK, mh_group_join(&group, &centroid, &velocity, &third, at(0, 15), at(4, 0)));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 5, centroid.y);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 8, velocity.x);
    TEST_ASSERT_EQUAL(4, group.targets[1].target);
    TEST_ASSERT_EQUAL(16, group.targets[1].vx);
    TEST_ASSERT_EQUAL(-12, group.targets[0].vy); /* still those of before */
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 10, mh_group_gap(&group, at(0, 5), &third, at(0, 25)));
}

static void joins_that_cannot_be(void)
{
    struct mh_group group, same, full = {.count = MH_GROUP_MAX};
    join_two(&group, 9, at(10, 2), at(10, -3));
    const struct mh_group before = group;
    mh_group_single(&same, 3);
    struct mh_vec2 centroid = at(0, 0), velocity = at(0, 0);
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_group_join(&group, &centroid, &velocity, &same, at(0, 0), at(0, 0)));
    mh_group_single(&same, 7);
    TEST_ASSERT_EQUAL(MH_ERR_NOT_FINITE, mh_group_join(&group, &centroid, &velocity, &same, at(NAN, 0), at(0, 0)));
    TEST_ASSERT_EQUAL(MH_ERR_NOT_FINITE, mh_group_join(&group, &centroid, &velocity, &same, at(0, 0), at(0, INFINITY)));
    for (uint8_t i = 0; i < MH_GROUP_MAX; i++) {
        full.targets[i].target = 100u + i;
    }
    TEST_ASSERT_EQUAL(MH_ERR_CAPACITY, mh_group_join(&group, &centroid, &velocity, &full, at(0, 0), at(0, 0)));
    TEST_ASSERT_EQUAL_MEMORY(&before, &group, sizeof group);
    TEST_ASSERT_EQUAL_FLOAT(0, centroid.x);
}

/* Near twice in a row, to the same; the larger says so, among equals the lower. */
static void merging_takes_two_instants(void)
{
    struct mh_group one, pair;
    mh_group_config_default(&config, MH_GROUP_MEMBERS);
    mh_group_single(&one, 4);
    const struct mh_group_neighbour near[2] = {{7, 1, 19}, {8, 1, 12}}, far = {7, 1, 21}, nowhere = {7, 1, NAN};
    TEST_ASSERT_FALSE(mh_group_approach(&one, &config, near, 1));
    TEST_ASSERT_TRUE(mh_group_approach(&one, &config, near, 2)); /* 8 is nearer, but 7 came first */
    TEST_ASSERT_EQUAL(7, one.near);
    TEST_ASSERT_FALSE(mh_group_approach(&one, &config, &far, 1));
    TEST_ASSERT_FALSE(mh_group_approach(&one, &config, near, 2));
    TEST_ASSERT_EQUAL(8, one.near);
    TEST_ASSERT_FALSE(mh_group_approach(&one, &config, near, 1)); /* another one */
    TEST_ASSERT_FALSE(mh_group_approach(&one, &config, &nowhere, 1));
    TEST_ASSERT_FALSE(mh_group_approach(&one, &config, NULL, 0));
    TEST_ASSERT_EQUAL(0, one.merges);

    mh_group_single(&one, 9); /* 7 is lower and says so itself */
    for (int i = 0; i < 5; i++) {
        TEST_ASSERT_FALSE(mh_group_approach(&one, &config, near, 1));
    }
    join_two(&pair, 5, at(0, 0), at(0, 0)); /* {3, 5} is larger than 1 */
    const struct mh_group_neighbour lower = {1, 1, 5}, too_many = {20, MH_GROUP_MAX, 5};
    TEST_ASSERT_FALSE(mh_group_approach(&pair, &config, &lower, 1));
    TEST_ASSERT_TRUE(mh_group_approach(&pair, &config, &lower, 1));
    TEST_ASSERT_FALSE(mh_group_approach(&pair, &config, &too_many, 1));
    TEST_ASSERT_FALSE(mh_group_approach(&pair, &config, &too_many, 1));
}

static void take_two(struct mh_group *group, mh_real half, bool *split)
{
    const struct mh_vec2 places[2] = {at(100 - half, 0), at(100 + half, 0)};
    struct mh_vec2 centroid;
    TEST_ASSERT_EQUAL(MH_OK, mh_group_take(group, &config, 2, places, &centroid, split));
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 100, centroid.x);
}

static void splitting_takes_three_instants(void)
{
    struct mh_group group;
    bool split;
    mh_group_config_default(&config, MH_GROUP_MEMBERS);
    join_two(&group, 9, at(0, 0), at(0, 0));
    const mh_real halves[] = {14, 16, 16, 14, 16, 17, 18};
    for (int i = 0; i < 7; i++) {
        take_two(&group, halves[i], &split);
        TEST_ASSERT_EQUAL(i == 6, split);
    }
    TEST_ASSERT_EQUAL(4 * 16, group.split_time);
    TEST_ASSERT_EQUAL(7 * 2 * 16, group.targets[0].alone);
    /* While it is counted it takes in nobody. */
    const struct mh_group_neighbour near = {1, 1, 5};
    TEST_ASSERT_FALSE(mh_group_approach(&group, &config, &near, 1));
    TEST_ASSERT_EQUAL(0, group.merges);
}

static void the_extent_is_smoothed(void)
{
    struct mh_group group;
    bool split;
    mh_group_config_default(&config, MH_GROUP_MEMBERS);
    join_two(&group, 10, at(0, 0), at(0, 0));
    take_two(&group, 5, &split);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 8, mh_group_extent(&group));
    take_two(&group, 5, &split);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 6.8f, mh_group_extent(&group));
}

/* The two of join_two part at 2 x 4 m/s along x, after `seconds` together. */
static void part_two(mh_real seconds, struct mh_vec2 left, struct mh_vec2 right, uint32_t *leftmost, bool *unresolved)
{
    struct mh_group group, part;
    bool split;
    struct mh_vec2 centroid, velocity;
    mh_group_config_default(&config, MH_GROUP_MEMBERS);
    config.turn_sd_mps = 2;
    join_two(&group, 9, left, right);
    const struct mh_vec2 together[2] = {at(-9, 0), at(9, 0)};
    TEST_ASSERT_EQUAL(MH_OK, mh_group_take(&group, &config, seconds - 6, together, &centroid, &split));
    for (mh_real half = 16; half < 33; half += 8) {
        take_two(&group, half, &split);
    }
    TEST_ASSERT_TRUE(split);
    for (uint8_t k = 0; k < 2; k++) {
        TEST_ASSERT_EQUAL(
            MH_OK, mh_group_part(&group, &config, at(50, 60), at(0, 10), k, &part, &centroid, &velocity, &velocity_sd));
        TEST_ASSERT_EQUAL(1, part.count);
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, centroid.x < 50 ? -4 : 4, velocity.x);
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, 10, velocity.y);
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, 32, mh_abs(centroid.x - 50));
        if (centroid.x < 50) {
            *leftmost = part.targets[0].target;
            *unresolved = part.unresolved;
        }
    }
    TEST_ASSERT_EQUAL(MH_NONE,
                      mh_group_part(&group, &config, at(0, 0), at(0, 0), 2, &part, &centroid, &velocity, &velocity_sd));
}

static void velocities_tell_who_is_who(void)
{
    uint32_t leftmost;
    bool unresolved;
    /* 5 comes from the left at 7 m/s, 3 from the right. */
    part_two(8, at(7, 10), at(-7, 10), &leftmost, &unresolved);
    TEST_ASSERT_EQUAL(3, leftmost);
    TEST_ASSERT_FALSE(unresolved);
    /* After minutes together they may have turned. */
    part_two(200, at(7, 10), at(-7, 10), &leftmost, &unresolved);
    TEST_ASSERT_TRUE(unresolved);
    /* Slowly crossing or turned back: nobody knows. */
    part_two(8, at(1, 10), at(-1, 10), &leftmost, &unresolved);
    TEST_ASSERT_TRUE(unresolved);
    /* Side by side. */
    part_two(8, at(0, 10), at(0, 10), &leftmost, &unresolved);
    TEST_ASSERT_TRUE(unresolved);
}

/* Two that were found together have never been told apart: their identifiers cannot have been exchanged. */
static void who_was_never_alone_is_not_mistaken(void)
{
    struct mh_group group, part;
    bool split;
    struct mh_vec2 centroid, velocity;
    const struct mh_vec2 places[2] = {at(60, 0), at(140, 0)};
    mh_group_config_default(&config, MH_GROUP_MEMBERS);
    TEST_ASSERT_EQUAL(MH_OK, mh_group_found(&group, 40, places, 2, &centroid));
    for (int i = 0; i < 3; i++) {
        take_two(&group, 40, &split);
    }
    TEST_ASSERT_TRUE(split);
    for (uint8_t k = 0; k < 2; k++) {
        TEST_ASSERT_EQUAL(
            MH_OK, mh_group_part(&group, &config, at(0, 0), at(0, 10), k, &part, &centroid, &velocity, &velocity_sd));
        TEST_ASSERT_EQUAL(40 + k, part.targets[0].target);
        TEST_ASSERT_FALSE(part.unresolved);
    }
}

/* One of three leaves: who it is is known, and the two that stay are a group; which of them is which need not be known. */
static void one_of_three_leaves(void)
{
    struct mh_group group, third, part;
    bool split;
    struct mh_vec2 centroid = at(0, 0), velocity = at(10, 0);
    mh_group_config_default(&config, MH_GROUP_MEMBERS);
    config.turn_sd_mps = 2;
    join_two(&group, 8, at(10, 0), at(10, 0));
    mh_group_single(&third, 4);
    TEST_ASSERT_EQUAL(MH_OK, mh_group_join(&group, &centroid, &velocity, &third, at(0, 15), at(10, -12)));
    for (int i = 0; i < 3; i++) {
        const struct mh_vec2 places[3] = {at(-8, 0), at(8, 0), at(0, -35.0f - 24.0f * (mh_real)i)};
        TEST_ASSERT_EQUAL(MH_OK, mh_group_take(&group, &config, 2, places, &centroid, &split));
    }
    TEST_ASSERT_TRUE(split);
    velocity = at(10, -4);
    TEST_ASSERT_EQUAL(MH_OK,
                      mh_group_part(&group, &config, centroid, velocity, 0, &part, &centroid, &velocity, &velocity_sd));
    TEST_ASSERT_EQUAL(2, part.count);
    TEST_ASSERT_EQUAL(3, part.targets[0].target);
    TEST_ASSERT_EQUAL(5, part.targets[1].target);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 8, mh_group_extent(&part));
    TEST_ASSERT_FALSE(part.unresolved);
    TEST_ASSERT_EQUAL(
        MH_OK, mh_group_part(&group, &config, centroid, at(10, -4), 1, &part, &centroid, &velocity, &velocity_sd));
    TEST_ASSERT_EQUAL(1, part.count);
    TEST_ASSERT_EQUAL(4, part.targets[0].target);
    TEST_ASSERT_FALSE(part.unresolved);
}

/* Parts and allotment of all four against all 24 permutations by hand: members leave the square outwards, at 5 m/s. */
static void four_part_as_the_nearest_velocities_say(void)
{
    static const mh_real way[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    static const uint8_t order[3][4] = {{0, 1, 2, 3}, {2, 0, 3, 1}, {3, 2, 1, 0}};
    mh_group_config_default(&config, MH_GROUP_MEMBERS);
    if (MH_GROUP_MAX < 4) {
        TEST_IGNORE_MESSAGE("MH_GROUP_MAX is below 4");
    }
    for (int o = 0; o < 3; o++) {
        struct mh_group group, part;
        bool split;
        struct mh_vec2 centroid = at(0, 0), velocity, places[4];
        mh_group_single(&group, 10);
        velocity = at(5 * way[order[o][0]][0], 5 * way[order[o][0]][1]);
        for (uint8_t i = 1; i < 4; i++) {
            struct mh_group one;
            mh_group_single(&one, 10u + i);
            TEST_ASSERT_EQUAL(MH_OK, mh_group_join(&group, &centroid, &velocity, &one, at(0, 0),
                                                   at(5 * way[order[o][i]][0], 5 * way[order[o][i]][1])));
        }
        for (int t = 0; t < 3; t++) {
            for (uint8_t i = 0; i < 4; i++) {
                const mh_real far = 30.0f + 10.0f * (mh_real)t;
                places[i] = at(far * way[i][0], far * way[i][1]);
            }
            TEST_ASSERT_EQUAL(MH_OK, mh_group_take(&group, &config, 2, places, &centroid, &split));
        }
        TEST_ASSERT_TRUE(split);
        for (uint8_t k = 0; k < 4; k++) {
            TEST_ASSERT_EQUAL(MH_OK, mh_group_part(&group, &config, at(0, 0), at(0, 0), k, &part, &centroid, &velocity,
                                                   &velocity_sd));
            const uint8_t *went = order[o];
            const uint8_t i = (uint8_t)(part.targets[0].target - 10u);
            TEST_ASSERT_FLOAT_WITHIN(1e-4f, 5 * way[went[i]][0], velocity.x);
            TEST_ASSERT_FLOAT_WITHIN(1e-4f, 5 * way[went[i]][1], velocity.y);
        }
    }
}

static void a_chain_is_one_part(void)
{
    struct mh_group group;
    bool split;
    struct mh_vec2 centroid, places[MH_GROUP_MAX];
    mh_group_config_default(&config, MH_GROUP_MEMBERS);
    /* Linked in an order that is not the numbers'. */
    for (uint8_t i = 0; i < MH_GROUP_MAX; i++) {
        places[i] = at(15.0f * (mh_real)((i * 3 + 1) % MH_GROUP_MAX), 0);
    }
    TEST_ASSERT_EQUAL(MH_OK, mh_group_found(&group, 40, places, MH_GROUP_MAX, &centroid));
    TEST_ASSERT_EQUAL(40 + MH_GROUP_MAX - 1, group.targets[MH_GROUP_MAX - 1].target);
    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_EQUAL(MH_OK, mh_group_take(&group, &config, 2, places, &centroid, &split));
        TEST_ASSERT_EQUAL(0, group.splits);
    }
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_group_found(&group, 40, places, MH_GROUP_MAX + 1, &centroid));
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_group_found(&group, 40, places, 0, &centroid));
}

static void what_is_not_finite_changes_nothing(void)
{
    struct mh_group group;
    bool split = true;
    struct mh_vec2 centroid = at(1, 2), places[2] = {at(0, 0), at(NAN, 0)};
    mh_group_config_default(&config, MH_GROUP_MEMBERS);
    join_two(&group, 9, at(0, 0), at(0, 0));
    const struct mh_group before = group;
    TEST_ASSERT_EQUAL(MH_ERR_NOT_FINITE, mh_group_take(&group, &config, 2, places, &centroid, &split));
    TEST_ASSERT_EQUAL(MH_ERR_NOT_FINITE, mh_group_found(&group, 1, places, 2, &centroid));
    places[1] = at(1, 1);
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_group_take(&group, &config, NAN, places, &centroid, &split));
    TEST_ASSERT_EQUAL(MH_ERR_ARGUMENT, mh_group_take(&group, &config, -1, places, &centroid, &split));
    TEST_ASSERT_EQUAL_MEMORY(&before, &group, sizeof group);
    TEST_ASSERT_EQUAL_FLOAT(1, centroid.x);
    /* All in one place is an extent of nothing; too far apart for the offsets is limited. */
    places[0] = at(1, 1);
    TEST_ASSERT_EQUAL(MH_OK, mh_group_take(&group, &config, 2, places, &centroid, &split));
    TEST_ASSERT_EQUAL(0, group.members[0].x);
    places[0] = at(-1000, 0);
    TEST_ASSERT_EQUAL(MH_OK, mh_group_take(&group, &config, 2, places, &centroid, &split));
    TEST_ASSERT_EQUAL(-127, group.members[0].x);
}

/* Written, read and written again, byte by byte the same; the first bytes as the header has them. */
static void saved_and_back(const struct mh_group *group, size_t expected)
{
    uint8_t bytes[MH_GROUP_BYTES(MH_GROUP_MAX)], again[MH_GROUP_BYTES(MH_GROUP_MAX)];
    struct mh_group read;
    size_t taken;
    const size_t length = mh_group_write(group, bytes);
    TEST_ASSERT_EQUAL(expected, length);
    TEST_ASSERT_TRUE(length <= (size_t)MH_GROUP_BYTES(group->count));
    for (size_t cut = 0; cut < length; cut++) {
        TEST_ASSERT_EQUAL(MH_ERR_CORRUPT, mh_group_read(&read, group->targets[0].target, bytes, cut, &taken));
    }
    TEST_ASSERT_EQUAL(MH_OK, mh_group_read(&read, group->targets[0].target, bytes, length, &taken));
    TEST_ASSERT_EQUAL(length, taken);
    TEST_ASSERT_EQUAL(length, mh_group_write(&read, again));
    TEST_ASSERT_EQUAL_MEMORY(bytes, again, length);
    TEST_ASSERT_EQUAL(group->count, read.count);
    TEST_ASSERT_EQUAL(group->unresolved, read.unresolved);
    TEST_ASSERT_EQUAL(group->extent, read.extent);
    TEST_ASSERT_EQUAL(group->targets[group->count - 1].target, read.targets[group->count - 1].target);
    TEST_ASSERT_EQUAL(group->targets[0].vy, read.targets[0].vy);
    TEST_ASSERT_EQUAL(group->members[1].first_x, read.members[1].first_x);
}

static void saved_bytes(void)
{
    struct mh_group group;
    bool split;
    mh_group_config_default(&config, MH_GROUP_MEMBERS);
    mh_group_single(&group, 9);
    saved_and_back(&group, 2);
    const struct mh_group_neighbour near = {0x01020304, 1, 5};
    (void)mh_group_approach(&group, &config, &near, 1);
    saved_and_back(&group, 6);

    join_two(&group, 9, at(10, 2), at(10, -3));
    static const uint8_t expected[] = {2, 0, 900 >> 8, 900 & 0xff, 40, 0xf4, 0, 0, 18,   0,
                                       0, 0, 0,        5,          40, 8,    0, 0, 0xee, 0};
    uint8_t bytes[MH_GROUP_BYTES(2)];
    TEST_ASSERT_EQUAL(sizeof expected, mh_group_write(&group, bytes));
    TEST_ASSERT_EQUAL_MEMORY(expected, bytes, sizeof expected);
    saved_and_back(&group, 20);
    (void)mh_group_approach(&group, &config, &near, 1);
    group.unresolved = true;
    saved_and_back(&group, 24);
    take_two(&group, 20, &split);
    (void)mh_group_approach(&group, &config, &near, 1);
    saved_and_back(&group, 27);
}

static void corrupt_bytes(void)
{
    struct mh_group group, read;
    bool split;
    size_t taken;
    mh_group_config_default(&config, MH_GROUP_MEMBERS);
    join_two(&group, 9, at(10, 2), at(10, -3));
    take_two(&group, 20, &split);
    uint8_t bytes[MH_GROUP_BYTES(2)];
    const size_t length = mh_group_write(&group, bytes);
    static const struct {
        uint8_t at, value;
    } wrong[] = {{0, 0},    {0, MH_GROUP_MAX + 1},
                 {0, 1},    {1, 0x11},
                 {13, 3}, /* the targets do not ascend */
                 {5, 0x80}, {18, 0x80},
                 {20, 0},   {20, 2} /* parts that cannot be */};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        uint8_t changed[sizeof bytes];
        memcpy(changed, bytes, sizeof bytes);
        changed[wrong[i].at] = wrong[i].value;
        TEST_ASSERT_EQUAL(MH_ERR_CORRUPT, mh_group_read(&read, 3, changed, length, &taken));
    }
    TEST_ASSERT_EQUAL(MH_ERR_CORRUPT, mh_group_read(&read, 5, bytes, length, &taken));
    mh_group_single(&group, 9);
    const struct mh_group_neighbour near = {8, 1, 5};
    (void)mh_group_approach(&group, &config, &near, 1);
    TEST_ASSERT_EQUAL(6, mh_group_write(&group, bytes));
    TEST_ASSERT_EQUAL(MH_ERR_CORRUPT, mh_group_read(&read, 8, bytes, 6, &taken)); /* near to itself */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(configurations);
    RUN_TEST(a_join_keeps_places_velocities_and_order);
    RUN_TEST(joins_that_cannot_be);
    RUN_TEST(merging_takes_two_instants);
    RUN_TEST(splitting_takes_three_instants);
    RUN_TEST(the_extent_is_smoothed);
    RUN_TEST(velocities_tell_who_is_who);
    RUN_TEST(who_was_never_alone_is_not_mistaken);
    RUN_TEST(one_of_three_leaves);
    RUN_TEST(four_part_as_the_nearest_velocities_say);
    RUN_TEST(a_chain_is_one_part);
    RUN_TEST(what_is_not_finite_changes_nothing);
    RUN_TEST(saved_bytes);
    RUN_TEST(corrupt_bytes);
    port_exit(UNITY_END() > 0);
}
