/* The ways of several targets against what their description says, and the energy of their sound. */
#include "port.h"
#include "unity.h"
#include "world/sound.h"
#include "world/targets.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static struct scenario scenario;
static struct targets targets;
static char error[300];

void setUp(void)
{
    TEST_ASSERT_EQUAL_INT(0, scenario_init(&scenario));
    targets = (struct targets){0};
    scenario.field.width_m = scenario.field.height_m = 1000;
}

void tearDown(void)
{
    targets_free(&targets);
    scenario_free(&scenario);
}

static void set(const char *key, const char *value)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_set(&scenario, key, value, error, sizeof error), error);
}

static void make(const char *settings, uint64_t seed)
{
    char copy[400];
    snprintf(copy, sizeof copy, "%s", settings);
    set("sensor.quantity", "sound");
    set("sensor.range_m", "40");
    set("source.speed_mps", "10");
    for (char *one = strtok(copy, "&"); one != NULL; one = strtok(NULL, "&")) {
        char *equals = strchr(one, '=');
        *equals = '\0';
        set(one, equals + 1);
    }
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_check(&scenario, "test", error, sizeof error), error);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, targets_make(&targets, &scenario, seed, error, sizeof error), error);
}

static void expect_at(size_t target, double time_s, double x_m, double y_m)
{
    const struct target_state state = targets_at(&targets, target, time_s);
    char text[120];
    snprintf(text, sizeof text, "target %zu at %g s: (%g, %g), expected (%g, %g)", target, time_s, state.at.x_m,
             state.at.y_m, x_m, y_m);
    TEST_ASSERT_TRUE_MESSAGE(state.present && hypot(state.at.x_m - x_m, state.at.y_m - y_m) < 1e-9, text);
}

static double gap(double time_s, size_t a, size_t b)
{
    const struct target_state p = targets_at(&targets, a, time_s), q = targets_at(&targets, b, time_s);
    TEST_ASSERT_TRUE(p.present && q.present);
    return hypot(p.at.x_m - q.at.x_m, p.at.y_m - q.at.y_m);
}

static void side_by_side(void)
{
    make("source.path=parallel&source.points=100,500;700,500&target.count=3&target.spacing_m=50", 1);
    TEST_ASSERT_EQUAL_size_t(3, targets.count);
    TEST_ASSERT_TRUE(fabs(targets.duration_s - 60) < 1e-9);
    expect_at(0, 0, 100, 450);
    expect_at(1, 30, 400, 500);
    expect_at(2, 60, 700, 550);
    const struct target_state state = targets_at(&targets, 2, 10);
    TEST_ASSERT_TRUE(fabs(state.velocity.x_m - 10) < 1e-9 && fabs(state.velocity.y_m) < 1e-9);
    TEST_ASSERT_FALSE(targets_at(&targets, 0, 60.001).present);
    TEST_ASSERT_FALSE(targets_at(&targets, 0, -0.001).present);
}

static void crossing_and_bouncing(void)
{
    make("source.path=crossing&source.points=100,500;700,500&target.count=2&target.turn_deg=90", 1);
    TEST_ASSERT_TRUE(gap(30, 0, 1) < 1e-9);
    expect_at(0, 30, 400, 500);
    const struct point v = targets_at(&targets, 0, 10).velocity, w = targets_at(&targets, 1, 10).velocity;
    TEST_ASSERT_TRUE(fabs(v.x_m * w.x_m + v.y_m * w.y_m) < 1e-9 && fabs(hypot(v.x_m, v.y_m) - 10) < 1e-9);
    const double apart_m = gap(0, 0, 1);
    TEST_ASSERT_TRUE(fabs(gap(60, 0, 1) - apart_m) < 1e-9);
    TEST_ASSERT_TRUE(targets_at(&targets, 0, 0).at.y_m > targets_at(&targets, 1, 0).at.y_m); /* they change sides */
    TEST_ASSERT_TRUE(targets_at(&targets, 0, 60).at.y_m < targets_at(&targets, 1, 60).at.y_m);
    targets_free(&targets);

    make("source.path=bounce&target.spacing_m=10", 1);
    for (double t = 0; t <= 60; t += 1.5) {
        TEST_ASSERT_TRUE(gap(t, 0, 1) >= 10 - 1e-9);
        TEST_ASSERT_TRUE(targets_at(&targets, 0, t).at.y_m < targets_at(&targets, 1, t).at.y_m); /* they do not */
    }
    TEST_ASSERT_TRUE(fabs(gap(30, 0, 1) - 10) < 1e-9 && fabs(gap(0, 0, 1) - 10 - apart_m) < 1e-9);
}

static void lanes(void)
{
    make("source.path=lanes&source.points=100,500;700,500&target.count=3&target.spacing_m=8&target.apart_m=80", 1);
    for (int i = 0; i <= 60; i++) {
        const double wanted = i <= 10 || i >= 50 ? 80 : i >= 20 && i <= 40 ? 8 : -1;
        TEST_ASSERT_TRUE(wanted < 0 || fabs(gap(i, 0, 1) - wanted) < 1e-9);
        TEST_ASSERT_TRUE(fabs(gap(i, 0, 2) - 2 * gap(i, 0, 1)) < 1e-9);
        TEST_ASSERT_TRUE(fabs(targets_at(&targets, 0, i).at.x_m - (100 + 10 * i)) < 1e-9); /* abreast */
    }
}

static void turning(void)
{
    make("source.path=turn&source.points=200,500;800,500&target.turn_deg=90", 1);
    expect_at(0, 30, 500, 500);
    expect_at(0, 60, 500, 800);
    targets_free(&targets);
    make("target.turns=5&target.turn_deg=-90&source.points=0,900;400,900", 1);
    TEST_ASSERT_TRUE(fabs(targets.duration_s - 120) < 1e-9);
    expect_at(0, 40, 200, 700);
    expect_at(0, 120, 600, 300); /* three legs to the right, three down */
}

static void in_a_ring(void)
{
    struct point first[2];
    for (uint64_t seed = 1; seed <= 2; seed++) {
        make("source.path=ring&source.points=100,500;700,500&target.count=3&target.spacing_m=10", seed);
        for (double t = 0; t <= 60; t += 20) {
            struct point middle = {0, 0};
            for (size_t i = 0; i < 3; i++) {
                TEST_ASSERT_TRUE(fabs(gap(t, i, (i + 1) % 3) - 10 * sqrt(3)) < 1e-9);
                middle.x_m += targets_at(&targets, i, t).at.x_m / 3;
                middle.y_m += targets_at(&targets, i, t).at.y_m / 3;
            }
            TEST_ASSERT_TRUE(hypot(middle.x_m - 100 - 10 * t, middle.y_m - 500) < 1e-9);
        }
        first[seed - 1] = targets_at(&targets, 0, 0).at;
        targets_free(&targets);
    }
    TEST_ASSERT_TRUE(hypot(first[0].x_m - first[1].x_m, first[0].y_m - first[1].y_m) > 0.1);
}

static void expect_inside(struct point p)
{
    TEST_ASSERT_TRUE(p.x_m >= 40 && p.x_m <= 960 && p.y_m >= 40 && p.y_m <= 960);
}

static void at_random(void)
{
    make("source.path=random&source.duration_s=300&target.count=2", 1);
    TEST_ASSERT_TRUE(fabs(targets.duration_s - 300) < 1e-9);
    struct point before = targets_at(&targets, 1, 0).at;
    double way_m = 0;
    for (double t = 0.5; t <= 300; t += 0.5) {
        const struct target_state state = targets_at(&targets, 1, t);
        const double step_m = hypot(state.at.x_m - before.x_m, state.at.y_m - before.y_m);
        expect_inside(state.at);
        TEST_ASSERT_TRUE(step_m <= 5 + 1e-9); /* never jumps */
        way_m += step_m;
        before = state.at;
    }
    TEST_ASSERT_TRUE(way_m > 0.9 * 3000); /* always goes */
    TEST_ASSERT_TRUE(gap(150, 0, 1) > 1);
}

/* Half of the places are in the left half, to within four standard deviations. */
static void scattered(void)
{
    make("source.path=scattered&source.duration_s=500&sensor.interval_s=2", 1);
    unsigned left = 0;
    for (int n = 0; n <= 250; n++) {
        const struct point p = targets_at(&targets, 0, 2 * n).at;
        expect_inside(p);
        left += p.x_m < 500;
        const struct point around = targets_at(&targets, 0, fmin(2 * n + 0.9, 500)).at;
        TEST_ASSERT_TRUE(hypot(p.x_m - around.x_m, p.y_m - around.y_m) < 1e-9);
    }
    TEST_ASSERT_TRUE(fabs(left - 125.5) < 4 * sqrt(251 / 4.0));
    const struct point first = targets_at(&targets, 0, 0).at, second = targets_at(&targets, 0, 2).at;
    TEST_ASSERT_TRUE(hypot(first.x_m - second.x_m, first.y_m - second.y_m) > 1);
}

static void scripted(void)
{
    const char yaml[] = "source: {path: scripted, speed_mps: 5}\n"
                        "sensor: {quantity: sound}\n"
                        "targets:\n"
                        "- points: [{x_m: 0, y_m: 0}, {x_m: 100, y_m: 0}]\n"
                        "- {start_s: 10, speed_mps: 20, loudness: 2, points: [{x_m: 1, y_m: 2}, {x_m: 1, y_m: 42}]}\n";
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_parse(yaml, sizeof yaml - 1, "a.yaml", &scenario, error, sizeof error),
                                  error);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_check(&scenario, "a.yaml", error, sizeof error), error);
    TEST_ASSERT_EQUAL_INT(0, targets_make(&targets, &scenario, 1, error, sizeof error));
    TEST_ASSERT_EQUAL_size_t(2, targets.count);
    TEST_ASSERT_TRUE(fabs(targets.duration_s - 20) < 1e-9);
    expect_at(0, 20, 100, 0);
    TEST_ASSERT_FALSE(targets_at(&targets, 1, 9.99).present);
    expect_at(1, 11, 1, 22);
    TEST_ASSERT_FALSE(targets_at(&targets, 1, 12.01).present);
    TEST_ASSERT_TRUE(fabs(targets.list[0].loudness - 1) < 1e-12 && fabs(targets.list[1].loudness - 2) < 1e-12);
}

/* Alone, together, too loud, not there; and the noise's mean and variance over nodes. */
static void sound(void)
{
    set("targets", "0,10,1: 0,0 ; 100,0 | 5,10,3: 0,30; 100,30");
    make("source.path=scripted&sensor.source_noise=0&sensor.background_noise=0", 1);
    struct sound s = sound_of(&scenario, 7);
    TEST_ASSERT_TRUE(fabs(sound_energy(&s, &targets, 0, (struct point){0, 20}) - 4) < 1e-12); /* (40 / 20)^2 */
    TEST_ASSERT_TRUE(fabs(sound_energy(&s, &targets, 5, (struct point){0, 30}) - 4800 - 1600 / 3400.0) < 1e-9);
    TEST_ASSERT_TRUE(fabs(sound_reading(&s, &targets, 0, 3, (struct point){0.5, 0}) - 1600) < 1e-9);
    TEST_ASSERT_TRUE(fabs(sound_energy(&s, &targets, 20, (struct point){0, 20})) < 1e-12);
    s.source_noise = 0.19;
    s.background_noise = 0.05;
    enum { N = 20000 };
    double sum = 0, squares = 0;
    for (uint32_t i = 0; i < N; i++) {
        const double y = sound_reading(&s, &targets, 0, i, (struct point){0, 20}) / 4;
        sum += y;
        squares += y * y;
    }
    const double mean = sum / N, variance = squares / N - mean * mean;
    const double log_variance = 0.19 * 0.19, expected = exp(log_variance / 2);
    const double expected_variance = expected * expected * (exp(log_variance) - 1) + 0.05 * 0.05 / 16;
    TEST_ASSERT_TRUE(fabs(mean - expected) < 4 * sqrt(expected_variance / N));
    TEST_ASSERT_TRUE(fabs(variance / expected_variance - 1) < 0.06);
    const struct point place = {0, 20};
    TEST_ASSERT_TRUE(fabs(sound_reading(&s, &targets, 1, 5, place) - sound_reading(&s, &targets, 1, 5, place)) < 1e-12);
    TEST_ASSERT_TRUE(fabs(sound_reading(&s, &targets, 1, 5, place) - sound_reading(&s, &targets, 1.001, 5, place)) >
                     1e-6);
}

/* What does not go together is refused with the key's name. */
static void refused(void)
{
    static const struct {
        const char *settings, *message;
    } cases[] = {
        {"sensor.quantity=range&source.path=parallel", "test: source.path: "},
        {"source.path=scripted", "test: targets: "},
        {"source.path=turn&source.points=1,1", "test: source.points: "},
        {"source.path=turn&source.points=1,1;1,1", "test: source.points: "},
        {"source.path=random", "test: source.duration_s: "},
        {"source.path=scattered&source.duration_s=10&sensor.range_m=600", "test: source.path: "},
        {"source.path=waypoints&target.count=2", "test: target.count: "},
        {"source.path=scattered&source.duration_s=10&sensor.range_m=30&target.count=2", "test: target.count: "},
        {"source.path=scattered&source.duration_s=10&sensor.range_m=30&network.protocol=prince&"
         "protocol.election=prince&radio.range_m=140",
         "test: source.path: expected one that leads"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char copy[200];
        tearDown();
        setUp();
        set("sensor.quantity", "sound");
        snprintf(copy, sizeof copy, "%s", cases[i].settings);
        for (char *one = strtok(copy, "&"); one != NULL; one = strtok(NULL, "&")) {
            char *equals = strchr(one, '=');
            *equals = '\0';
            set(one, equals + 1);
        }
        TEST_ASSERT_EQUAL_INT_MESSAGE(-1, scenario_check(&scenario, "test", error, sizeof error), cases[i].settings);
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, strncmp(error, cases[i].message, strlen(cases[i].message)), error);
    }
    static const char *const lists[] = {"0,1,1",      "0,1: 1,1", "0,0,1: 1,1",  "-1,1,1: 1,1",
                                        "0,1,0: 1,1", "0,1,1: 1", "0,1,1: 1,1 |"};
    for (size_t i = 0; i < sizeof lists / sizeof lists[0]; i++) {
        TEST_ASSERT_EQUAL_INT_MESSAGE(-1, scenario_set(&scenario, "targets", lists[i], error, sizeof error), lists[i]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(side_by_side);
    RUN_TEST(crossing_and_bouncing);
    RUN_TEST(lanes);
    RUN_TEST(turning);
    RUN_TEST(in_a_ring);
    RUN_TEST(at_random);
    RUN_TEST(scattered);
    RUN_TEST(scripted);
    RUN_TEST(sound);
    RUN_TEST(refused);
    port_exit(UNITY_END() > 0);
}
