#include "motehound/sound_fix.h"
#include "port.h"
#include "unity.h"

#include <math.h>

void setUp(void) {}
void tearDown(void) {}

static const struct mh_sound sound = {1600, 0.19f, 0.05f};
static const struct mh_distance_table table = {40, 40, MH_DISTANCE_MIDDLE};

static void assert_at(mh_real tolerance, mh_real x, mh_real y, struct mh_vec2 point)
{
    TEST_ASSERT_FLOAT_WITHIN(tolerance, x, point.x);
    TEST_ASSERT_FLOAT_WITHIN(tolerance, y, point.y);
}

/* What nodes heard, and where the target is by that, computed with 64 bits; the first node is the origin. */
static const struct {
    struct mh_heard heard[6];
    size_t count;
    struct mh_vec2 three, median, refined[3], full, constant;
} known[] = {
    {{{{0, 0}, 5.661283f},
      {{-3.232219f, 0.543692f}, 5.250398f},
      {{16.410204f, 28.894264f}, 3.966938f},
      {{-33.157829f, 18.429631f}, 1.810566f},
      {{1.146757f, 52.188557f}, 1.299117f},
      {{24.980493f, -3.831813f}, 1.095736f}},
     6,
     {0.360235f, 16.926731f},
     {-2.319457f, 17.040032f},
     {{-2.303266f, 17.795229f}, {-2.245555f, 17.816318f}, {-2.242937f, 17.818427f}},
     {-2.179921f, 17.802699f},
     {-0.243301f, 17.321957f}},
    {{{{0, 0}, 13.28843f},
      {{-28.080502f, -0.169693f}, 6.072341f},
      {{-26.211049f, -9.071769f}, 5.910761f},
      {{7.857290f, -4.719355f}, 4.630811f},
      {{0.703865f, -24.458754f}, 1.648991f}},
     5,
     {-11.171171f, -1.331748f},
     {-11.000022f, 1.895841f},
     {{-11.387748f, 0.535976f}, {-11.405957f, 0.836535f}, {-11.400551f, 0.729206f}},
     {-11.394387f, 0.647947f},
     {-11.029994f, -0.988139f}},
    {{{{0, 0}, 51.60624f},
      {{-24.942515f, 13.194578f}, 2.229653f},
      {{13.507936f, -23.885769f}, 1.695384f},
      {{23.081960f, 20.323381f}, 1.219923f},
      {{-33.848978f, -28.967553f}, 1.070277f}},
     5,
     {0.853314f, 4.592328f},
     {-4.605310f, -1.462642f},
     {{-5.138454f, -2.189051f}, {-5.109365f, -2.208141f}, {-5.111227f, -2.203734f}},
     {-5.108722f, -2.211462f},
     {-4.954872f, -2.540276f}},
};
enum { KNOWN = sizeof known / sizeof known[0] };

static void known_fixes(void)
{
    for (unsigned i = 0; i < KNOWN; i++) {
        const struct mh_heard *heard = known[i].heard;
        struct mh_vec2 p, median;
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_distance_fix(heard, known[i].count, &table, MH_CIRCLES_UNIFORM, &p));
        assert_at(1e-3f, known[i].three.x, known[i].three.y, p);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_median_fix(heard, known[i].count, &table, &median));
        assert_at(1e-3f, known[i].median.x, known[i].median.y, median);
        for (uint8_t n = 1; n <= 3; n++) {
            p = median;
            TEST_ASSERT_EQUAL_INT(MH_OK, mh_sound_refine(&sound, heard, known[i].count, NULL, n, &p, NULL));
            assert_at(1e-3f, known[i].refined[n - 1].x, known[i].refined[n - 1].y, p);
        }
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_sound_fix(&sound, heard, known[i].count, NULL, &p, NULL));
        assert_at(1e-3f, known[i].refined[1].x, known[i].refined[1].y, p);
    }
}

/* To the grid's spacing: the minima themselves are flat */
static void known_likeliest_places(void)
{
    for (unsigned i = 0; i < KNOWN; i++) {
        struct mh_vec2 p;
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_likeliest(&sound, known[i].heard, known[i].count, MH_LIKELIHOOD_CONSTANT, &p));
        assert_at(0.75f, known[i].constant.x, known[i].constant.y, p);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_likeliest(&sound, known[i].heard, known[i].count, MH_LIKELIHOOD_FULL, &p));
        assert_at(0.11f, known[i].full.x, known[i].full.y, p);
    }
}

/* Five nodes about a target at (12, -7) that hear it without noise */
static const struct mh_vec2 target = {12, -7};
static struct mh_heard heard[5];

static void hear(mh_real origin_x, mh_real origin_y)
{
    static const struct mh_vec2 places[] = {{3, -4}, {26, -10}, {10, 14}, {-9, -24}, {40, 8}};
    for (unsigned i = 0; i < 5; i++) {
        heard[i].place.x = places[i].x + origin_x;
        heard[i].place.y = places[i].y + origin_y;
        heard[i].energy =
            mh_sound_energy(&sound, mh_squared(places[i].x - target.x) + mh_squared(places[i].y - target.y));
    }
}

static void without_noise_the_target_is_found(void)
{
    const struct mh_distance_table undivided = {40, 0, 0};
    for (int shift = 0; shift <= 1; shift++) {
        const struct mh_vec2 at = {(mh_real)shift * 500 + target.x, target.y - (mh_real)shift * 300};
        hear((mh_real)shift * 500, (mh_real)shift * -300);
        struct mh_vec2 p;
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_distance_fix(heard, 5, &undivided, MH_CIRCLES_CASES, &p));
        assert_at(2e-3f, at.x, at.y, p);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_median_fix(heard, 5, &undivided, &p));
        assert_at(2e-3f, at.x, at.y, p);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_median_fix(heard, 5, &table, &p));
        assert_at(1.5f, at.x, at.y, p);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_sound_fix(&sound, heard, 5, NULL, &p, NULL));
        assert_at(0.02f, at.x, at.y, p);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_likeliest(&sound, heard, 5, MH_LIKELIHOOD_CONSTANT, &p));
        assert_at(0.5f, at.x, at.y, p);
    }
}

/* Fisher's information is sum u u' / var; far from any prior it decides, near to it the prior does */
static void information_and_prior(void)
{
    hear(0, 0);
    mh_real xx = 0, xy = 0, yy = 0;
    for (unsigned i = 0; i < 5; i++) {
        const mh_real dx = target.x - heard[i].place.x, dy = target.y - heard[i].place.y, square = dx * dx + dy * dy;
        const mh_real share = 4 / (square * square * mh_sound_log_variance(&sound, heard[i].energy));
        xx += share * dx * dx;
        xy += share * dx * dy;
        yy += share * dy * dy;
    }
    struct mh_vec2 p = target;
    struct mh_sym2 information;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_sound_refine(&sound, heard, 5, NULL, 2, &p, &information));
    assert_at(1e-4f, target.x, target.y, p);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f * xx, xx, information.xx);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f * xx, xy, information.xy);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f * yy, yy, information.yy);

    struct mh_position_prior prior = {{target.x + 1, target.y}, 1};
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_sound_refine(&sound, heard, 5, &prior, 4, &p, &information));
    TEST_ASSERT_FLOAT_WITHIN(0.02f * xx, xx + 1, information.xx);
    /* where the pull of the prior and of the rest are equal: (I + A) step = I (1, 0)' */
    const mh_real determinant = (xx + 1) * (yy + 1) - xy * xy;
    assert_at(0.05f, target.x + (yy + 1) / determinant, target.y - xy / determinant, p);
    prior.sd_m = 0.01f;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_sound_refine(&sound, heard, 5, &prior, 4, &p, NULL));
    assert_at(0.01f, target.x + 1, target.y, p);
    prior.sd_m = 1e4f;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_sound_refine(&sound, heard, 5, &prior, 8, &p, NULL));
    assert_at(0.01f, target.x, target.y, p);
    prior.sd_m = 3;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_sound_refine(&sound, NULL, 0, &prior, 8, &p, &information)); /* all that is known */
    assert_at(0.01f, target.x + 1, target.y, p);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1.0f / 9, information.xx);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1.0f / 9, information.yy);
}

static void one_step_is_no_longer_than_15_m(void)
{
    hear(0, 0);
    const struct mh_vec2 start = {target.x + 60, target.y};
    struct mh_vec2 p = start;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_sound_refine(&sound, heard, 5, NULL, 1, &p, NULL));
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 15, mh_sqrt(mh_squared(p.x - start.x) + mh_squared(p.y - start.y)));
    TEST_ASSERT_TRUE(mh_sqrt(mh_squared(p.x - target.x) + mh_squared(p.y - target.y)) < 60);
}

static void one_and_two_nodes(void)
{
    hear(0, 0);
    struct mh_vec2 p;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_distance_fix(heard, 1, &table, MH_CIRCLES_CASES, &p));
    assert_at(1e-6f, heard[0].place.x, heard[0].place.y, p);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_median_fix(heard, 1, &table, &p));
    assert_at(1e-6f, heard[0].place.x, heard[0].place.y, p);
    const struct mh_circle a = {heard[0].place, mh_distance(&table, heard[0].energy)};
    const struct mh_circle b = {heard[1].place, mh_distance(&table, heard[1].energy)};
    const struct mh_vec2 both = mh_two_circles(&a, &b);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_median_fix(heard, 2, &table, &p));
    assert_at(1e-6f, both.x, both.y, p);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_heard_centroid(heard, 3, &p));
    assert_at(1e-5f, 13, 0, p);
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_sound_fix(&sound, heard, 2, NULL, &p, NULL));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_sound_fix(&sound, heard, 1, NULL, &p, NULL));
    TEST_ASSERT_TRUE(mh_finite(p.x) && mh_finite(p.y));
}

static void strongest_first(void)
{
    static const mh_real values[] = {1, -3, 5, 0.5f, 5, 2047.9f, 2, 0};
    struct mh_measurement measurements[8];
    const struct mh_place origin = {1000, 2000, 0};
    for (int i = 0; i < 8; i++) {
        const struct mh_measurement m = {
            .node = (mh_node_id)i, .place = {1000 * i, 0, 0}, .value = mh_q20_from_real(values[i])};
        measurements[i] = m;
    }
    static const int order[] = {5, 2, 4, 6, 0, 3, 7, 1};
    struct mh_heard list[8];
    for (size_t capacity = 0; capacity <= 8; capacity++) {
        TEST_ASSERT_EQUAL_size_t(capacity, mh_strongest(measurements, 8, &origin, list, capacity));
        for (size_t i = 0; i < capacity; i++) {
            assert_at(1e-6f, (mh_real)order[i] - 1, -2, list[i].place);
            TEST_ASSERT_FLOAT_WITHIN(1e-3f, values[order[i]], list[i].energy);
        }
    }
    TEST_ASSERT_EQUAL_size_t(2, mh_strongest(measurements, 2, &origin, list, 8));
    TEST_ASSERT_EQUAL_FLOAT(1, list[0].energy);
}

/* Every localiser gives a place near the nodes, whatever they say. */
static void assert_near_nodes(const struct mh_heard *nodes, size_t count)
{
    struct mh_vec2 centre, p[8];
    struct mh_sym2 information;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_heard_centroid(nodes, count, &centre));
    for (int variant = MH_CIRCLES_CASES; variant <= MH_CIRCLES_JOINT; variant++) {
        TEST_ASSERT_EQUAL_INT(MH_OK,
                              mh_distance_fix(nodes, count, &table, (enum mh_circles_variant)variant, &p[variant]));
    }
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_median_fix(nodes, count, &table, &p[3]));
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_sound_fix(&sound, nodes, count, NULL, &p[4], &information));
    TEST_ASSERT_TRUE(mh_finite(information.xx) && mh_finite(information.xy) && information.yy >= 0);
    p[5] = centre;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_sound_refine(&sound, nodes, count, NULL, 4, &p[5], NULL));
    for (int i = 0; i < 6; i++) {
        const mh_real off = mh_sqrt(mh_squared(p[i].x - centre.x) + mh_squared(p[i].y - centre.y));
        TEST_ASSERT_TRUE(off <= 200); /* false for NaN */
    }
}

static void degenerate_inputs(void)
{
    for (size_t count = 1; count <= 5; count++) {
        hear(0, 0);
        for (unsigned i = 1; i < 5; i++) { /* all at one place */
            heard[i].place = heard[0].place;
        }
        assert_near_nodes(heard, count);
        static const mh_real energies[] = {0, -1, 2047.99f, 1, 1e-30f};
        for (unsigned e = 0; e < sizeof energies / sizeof energies[0]; e++) {
            hear(0, 0);
            for (unsigned i = 0; i < 5; i++) {
                heard[i].energy = energies[e];
            }
            assert_near_nodes(heard, count);
        }
        hear(0, 0); /* on the first node, which is saturated */
        heard[0].place = target;
        heard[0].energy = 2047.99f;
        assert_near_nodes(heard, count);
        struct mh_vec2 p;
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_sound_fix(&sound, heard, count, NULL, &p, NULL));
        if (count != 2) { /* the point of two circles is on the line to the second node */
            assert_at(2, target.x, target.y, p);
        }
        for (unsigned i = 0; i < 5; i++) { /* on one line */
            heard[i].place.x = 10 * (mh_real)i;
            heard[i].place.y = 0;
        }
        assert_near_nodes(heard, count);
    }
    hear(0, 0);
    struct mh_vec2 p;
    heard[4].place.x = 900; /* a false detection far off neither bounds the grid nor empties it */
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_likeliest(&sound, heard, 5, MH_LIKELIHOOD_CONSTANT, &p));
    assert_at(1, target.x, target.y, p);
}

static void errors_leave_the_position_alone(void)
{
    struct mh_vec2 p = {7, 8};
    hear(0, 0);
    TEST_ASSERT_EQUAL_INT(MH_ERR_TOO_FEW, mh_distance_fix(heard, 0, &table, MH_CIRCLES_UNIFORM, &p));
    TEST_ASSERT_EQUAL_INT(MH_ERR_TOO_FEW, mh_median_fix(heard, 0, &table, &p));
    TEST_ASSERT_EQUAL_INT(MH_ERR_TOO_FEW, mh_sound_refine(&sound, heard, 0, NULL, 2, &p, NULL));
    TEST_ASSERT_EQUAL_INT(MH_ERR_TOO_FEW, mh_sound_fix(&sound, heard, 0, NULL, &p, NULL));
    TEST_ASSERT_EQUAL_INT(MH_ERR_TOO_FEW, mh_likeliest(&sound, heard, 0, MH_LIKELIHOOD_FULL, &p));
    TEST_ASSERT_EQUAL_INT(MH_ERR_TOO_FEW, mh_heard_centroid(heard, 0, &p));
    const struct mh_sound wrong = {1600, 0, 0};
    const struct mh_distance_table no_range = {0, 40, MH_DISTANCE_MIDDLE};
    const struct mh_position_prior no_sd = {{0, 0}, 0}, nowhere = {{NAN, 0}, 1};
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_distance_fix(heard, 3, &no_range, MH_CIRCLES_UNIFORM, &p));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_sound_refine(&wrong, heard, 5, NULL, 2, &p, NULL));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_sound_refine(&sound, heard, 5, NULL, 0, &p, NULL));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_sound_refine(&sound, heard, 5, &no_sd, 2, &p, NULL));
    TEST_ASSERT_EQUAL_INT(MH_ERR_NOT_FINITE, mh_sound_refine(&sound, heard, 5, &nowhere, 2, &p, NULL));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_sound_fix(&wrong, heard, 5, NULL, &p, NULL));
    TEST_ASSERT_EQUAL_INT(MH_ERR_ARGUMENT, mh_likeliest(&wrong, heard, 5, MH_LIKELIHOOD_FULL, &p));
    const mh_real senseless[] = {NAN, INFINITY, -INFINITY, 1e10f};
    for (unsigned i = 0; i < 4; i++) {
        for (int field = 0; field < 3; field++) {
            hear(0, 0);
            mh_real *fields[] = {&heard[2].place.x, &heard[2].place.y, &heard[2].energy};
            *fields[field] = senseless[i];
            const enum mh_status error = i < 3 ? MH_ERR_NOT_FINITE : MH_ERR_RANGE;
            TEST_ASSERT_EQUAL_INT(error, mh_heard_centroid(heard, 5, &p));
            TEST_ASSERT_EQUAL_INT(error, mh_distance_fix(heard, 5, &table, MH_CIRCLES_CASES, &p));
            TEST_ASSERT_EQUAL_INT(error, mh_median_fix(heard, 5, &table, &p));
            TEST_ASSERT_EQUAL_INT(error, mh_sound_refine(&sound, heard, 5, NULL, 2, &p, NULL));
            TEST_ASSERT_EQUAL_INT(error, mh_sound_fix(&sound, heard, 5, NULL, &p, NULL));
            TEST_ASSERT_EQUAL_INT(error, mh_likeliest(&sound, heard, 5, MH_LIKELIHOOD_FULL, &p));
        }
    }
    TEST_ASSERT_EQUAL_FLOAT(7, p.x);
    TEST_ASSERT_EQUAL_FLOAT(8, p.y);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(known_fixes);
    RUN_TEST(known_likeliest_places);
    RUN_TEST(without_noise_the_target_is_found);
    RUN_TEST(information_and_prior);
    RUN_TEST(one_step_is_no_longer_than_15_m);
    RUN_TEST(one_and_two_nodes);
    RUN_TEST(strongest_first);
    RUN_TEST(degenerate_inputs);
    RUN_TEST(errors_leave_the_position_alone);
    port_exit(UNITY_END() > 0);
    return 0;
}
