#include "motehound/decomposition.h"
#include "motehound/joint_sources.h"
#include "port.h"
#include "unity.h"

enum { SIDE = 4, NODES = SIDE * SIDE };

static const struct mh_sound sound = {.loudness_m2 = 1600, .source_sd = 0.19f, .background_sd = 0.05f};
static struct mh_heard heard[NODES];

void setUp(void) {}
void tearDown(void) {}

/* What a grid of 30 m hears of the sources, without noise; `count` nodes, the others are silent. */
static void hear(const struct mh_vec2 *sources, size_t count)
{
    for (int i = 0; i < NODES; i++) {
        const struct mh_vec2 place = {30.0f * (mh_real)(i % SIDE), 30.0f * (mh_real)(i / SIDE)};
        heard[i].place = place;
        heard[i].energy = 0;
        for (size_t k = 0; k < count; k++) {
            heard[i].energy +=
                mh_sound_energy(&sound, mh_squared(place.x - sources[k].x) + mh_squared(place.y - sources[k].y));
        }
    }
}

static void two_sources_half_a_range_apart(void)
{
    const struct mh_vec2 truth[2] = {{40, 50}, {60, 52}};
    const struct mh_source expected[2] = {{{36, 53}, {400, 0, 400}, 0}, {{65, 49}, {400, 0, 400}, 0}};
    struct mh_source_fix fixes[2];
    hear(truth, 2);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_joint_sources(&sound, heard, NODES, expected, NULL, 2, fixes));
    for (int k = 0; k < 2; k++) {
        TEST_ASSERT_FLOAT_WITHIN(0.3f, truth[k].x, fixes[k].position.x);
        TEST_ASSERT_FLOAT_WITHIN(0.3f, truth[k].y, fixes[k].position.y);
    }
}

/* Three targets at two places. */
static void two_at_one_place(void)
{
    const struct mh_vec2 truth[3] = {{30, 50}, {70, 52}, {70, 52}};
    const struct mh_source expected[2] = {{{33, 48}, {400, 0, 400}, 0}, {{66, 54}, {400, 0, 400}, 1}};
    struct mh_source_fix fixes[2];
    hear(truth, 3);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_joint_sources(&sound, heard, NODES, expected, NULL, 2, fixes));
    for (int k = 0; k < 2; k++) {
        TEST_ASSERT_FLOAT_WITHIN(0.3f, truth[k].x, fixes[k].position.x);
        TEST_ASSERT_FLOAT_WITHIN(0.3f, truth[k].y, fixes[k].position.y);
    }
}

/* As many as there is room for, on a ring. */
static void as_many_as_there_is_room_for(void)
{
    struct mh_vec2 truth[MH_SOURCES_MAX];
    struct mh_source expected[MH_SOURCES_MAX];
    struct mh_source_fix fixes[MH_SOURCES_MAX];
    for (int k = 0; k < MH_SOURCES_MAX; k++) {
        const struct mh_vec2 u = mh_direction(2.0f * MH_PI * (mh_real)k / MH_SOURCES_MAX - MH_PI);
        const struct mh_vec2 place = {45 + 35 * u.x, 47 + 35 * u.y}, guess = {46 + 35 * u.x, 45 + 35 * u.y};
        const struct mh_source source = {guess, {100, 0, 100}, 0};
        truth[k] = place;
        expected[k] = source;
    }
    hear(truth, MH_SOURCES_MAX);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_joint_sources(&sound, heard, NODES, expected, NULL, MH_SOURCES_MAX, fixes));
    for (int k = 0; k < MH_SOURCES_MAX; k++) {
        TEST_ASSERT_FLOAT_WITHIN(0.5f, truth[k].x, fixes[k].position.x);
        TEST_ASSERT_FLOAT_WITHIN(0.5f, truth[k].y, fixes[k].position.y);
    }
}

/* Of one source: the covariance's inverse is Fisher's information and the prior's. */
static void information_of_one_source(void)
{
    const struct mh_vec2 truth = {50, 40};
    const struct mh_source expected = {truth, {9, 2, 4}, 0};
    struct mh_source_fix fix;
    struct mh_sym2 fisher = {0, 0, 0};
    hear(&truth, 1);
    for (int i = 0; i < NODES; i++) {
        const struct mh_vec2 away = {truth.x - heard[i].place.x, truth.y - heard[i].place.y};
        const mh_real square = mh_squared(away.x) + mh_squared(away.y), e = 1600 / square;
        const mh_real weight = 4 / (mh_squared(square) * (mh_squared(0.19f) + mh_squared(0.05f / e)));
        fisher.xx += weight * away.x * away.x;
        fisher.xy += weight * away.x * away.y;
        fisher.yy += weight * away.y * away.y;
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_joint_sources(&sound, heard, NODES, &expected, NULL, 1, &fix));
    const mh_real tolerance = 0.005f * (fisher.xx + fisher.yy); /* the damping's part */
    TEST_ASSERT_FLOAT_WITHIN(tolerance, fisher.xx, fix.information.xx);
    TEST_ASSERT_FLOAT_WITHIN(tolerance, fisher.xy, fix.information.xy);
    TEST_ASSERT_FLOAT_WITHIN(tolerance, fisher.yy, fix.information.yy);
    const struct mh_sym2 both = {fisher.xx + 0.125f, fisher.xy - 0.0625f, fisher.yy + 0.28125f}; /* 1/32 {4, -2, 9} */
    const mh_real determinant = both.xx * both.yy - both.xy * both.xy;
    TEST_ASSERT_FLOAT_WITHIN(0.01f * fix.covariance.xx, both.yy / determinant, fix.covariance.xx);
    TEST_ASSERT_FLOAT_WITHIN(0.01f * fix.covariance.xx, -both.xy / determinant, fix.covariance.xy);
    TEST_ASSERT_FLOAT_WITHIN(0.01f * fix.covariance.yy, both.xx / determinant, fix.covariance.yy);
}

/* One that nobody hears stays where it was expected, as uncertain as it was. */
static void a_source_that_nobody_hears(void)
{
    const struct mh_vec2 truth = {50, 40};
    const struct mh_source expected[2] = {{{52, 41}, {25, 0, 25}, 0}, {{5000, 40}, {25, 3, 36}, 0}};
    struct mh_source_fix fixes[2];
    hear(&truth, 1);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_joint_sources(&sound, heard, NODES, expected, NULL, 2, fixes));
    TEST_ASSERT_FLOAT_WITHIN(0.2f, truth.x, fixes[0].position.x);
    TEST_ASSERT_FLOAT_WITHIN(0.1f, 5000, fixes[1].position.x);
    TEST_ASSERT_FLOAT_WITHIN(0.3f, 25, fixes[1].covariance.xx);
    TEST_ASSERT_FLOAT_WITHIN(0.3f, 3, fixes[1].covariance.xy);
    TEST_ASSERT_FLOAT_WITHIN(0.3f, 36, fixes[1].covariance.yy);
}

static void what_is_refused(void)
{
    const struct mh_vec2 truth = {50, 40}, bad = {INFINITY, 0};
    struct mh_source source = {{52, 41}, {25, 0, 25}, 0};
    struct mh_source_fix fix = {.covariance = {-7, 0, 0}};
    struct mh_sound silent = sound;
    hear(&truth, 1);
    silent.source_sd = silent.background_sd = 0;
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_joint_sources(&sound, heard, NODES, &source, NULL, 0, &fix));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT,
                          mh_joint_sources(&sound, heard, NODES, &source, NULL, MH_SOURCES_MAX + 1, &fix));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_joint_sources(&silent, heard, NODES, &source, NULL, 1, &fix));
    TEST_ASSERT_EQUAL_INT(MH_ERR_TOO_FEW, mh_joint_sources(&sound, heard, 0, &source, NULL, 1, &fix));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_joint_sources(&sound, heard, NODES, &source, &bad, 1, &fix));
    heard[3].energy = NAN;
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_joint_sources(&sound, heard, NODES, &source, NULL, 1, &fix));
    heard[3].energy = 1;
    source.covariance.xy = 26;
    TEST_ASSERT_EQUAL_INT(MH_ERR_SINGULAR, mh_joint_sources(&sound, heard, NODES, &source, NULL, 1, &fix));
    TEST_ASSERT_EQUAL_FLOAT(-7, fix.covariance.xx);
}

/* On a node, at each other's place, with energies of zero, below and saturated. */
static void degenerate_places_and_energies(void)
{
    const struct mh_vec2 truth[2] = {{30, 30}, {30, 30}};
    const struct mh_source expected[2] = {{{30, 30}, {25, 0, 25}, 0}, {{30, 30}, {25, 0, 25}, 0}};
    struct mh_source_fix fixes[2];
    hear(truth, 2);
    heard[0].energy = 0;
    heard[1].energy = -3;
    heard[2].energy = 2048;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_joint_sources(&sound, heard, NODES, expected, NULL, 2, fixes));
    for (int k = 0; k < 2; k++) {
        TEST_ASSERT_TRUE(mh_finite(fixes[k].position.x) && mh_finite(fixes[k].position.y));
        TEST_ASSERT_TRUE(fixes[k].covariance.xx > 0 && fixes[k].covariance.yy > 0);
    }
}

static void shares_add_up(void)
{
    const struct mh_vec2 sources[3] = {{0, 0}, {50, 0}, {300, 0}}, node = {20, 10};
    mh_real sum = 0;
    for (size_t k = 0; k < 3; k++) {
        sum += mh_sound_share(sources, 3, k, node, 1e4f);
    }
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1, sum);
    TEST_ASSERT_EQUAL_FLOAT(1, mh_sound_share(sources, 1, 0, node, 40));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 2.0f / 3, mh_sound_share(sources, 2, 0, node, 40)); /* 500 : 1000 */
    TEST_ASSERT_EQUAL_FLOAT(1, mh_sound_share(sources, 2, 0, node, 20));       /* the other is too far away to count */
    TEST_ASSERT_EQUAL_FLOAT(1, mh_sound_share(sources, 1, 0, sources[0], 40)); /* on a node */
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 3, mh_sound_residual(1600, sources, 2, 0, node, 4.6f));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.05f, mh_sound_residual(1600, sources, 2, 0, node, 1));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(two_sources_half_a_range_apart);
    RUN_TEST(two_at_one_place);
    RUN_TEST(as_many_as_there_is_room_for);
    RUN_TEST(information_of_one_source);
    RUN_TEST(a_source_that_nobody_hears);
    RUN_TEST(what_is_refused);
    RUN_TEST(degenerate_places_and_energies);
    RUN_TEST(shares_add_up);
    port_exit(UNITY_END() > 0);
}
