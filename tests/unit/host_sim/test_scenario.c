#include "port.h"
#include "scenario/folder.h"
#include "scenario/keys.h"
#include "unity.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct scenario scenario;
static char error[1000];

void setUp(void)
{
    TEST_ASSERT_EQUAL_INT(0, scenario_init(&scenario));
    error[0] = '\0';
}
void tearDown(void) { scenario_free(&scenario); }

static int parse(const char *yaml)
{
    return scenario_parse(yaml, strlen(yaml), "a.yaml", &scenario, error, sizeof error);
}

/* Unity is built without double; these numbers are exact in both or compared as text. */
static void assert_number(const char *expected, double actual)
{
    char text[40];
    snprintf(text, sizeof text, "%.12g", actual);
    TEST_ASSERT_EQUAL_STRING(expected, text);
}

static void every_default_is_inside_its_range_and_every_key_documented_once(void)
{
    for (size_t i = 0; i < scenario_key_count; i++) {
        TEST_ASSERT_EQUAL_PTR(&scenario_keys[i], scenario_key_find(scenario_keys[i].path));
        TEST_ASSERT_EQUAL_INT_MESSAGE(
            0, scenario_set(&scenario, scenario_keys[i].path, scenario_keys[i].standard, error, sizeof error), error);
    }
    TEST_ASSERT_EQUAL_INT(0, scenario_check(&scenario, "defaults", error, sizeof error));
}

static void a_file_sets_what_it_names_and_leaves_the_rest(void)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(0,
                                  parse("name: x\n"
                                        "source:\n"
                                        "  path: waypoints\n"
                                        "  points:\n"
                                        "    - {x_m: 1, y_m: 2.5}\n"
                                        "    - {x_m: -3e1, y_m: 4, speed_factor: 0.8}\n"
                                        "  speed_mps: 2.25\n"
                                        "network: {nodes: 640, layout: grid}\n"
                                        "tracker: {name: luo, nonlinear: true}\n"
                                        "clusters: {nodes: [2, 7], range_variance_m2: [0.5, 1e-2]}\n"
                                        "sweep: {key: network.nodes, values: [640, 960]}\n"),
                                  error);
    TEST_ASSERT_EQUAL_STRING("x", scenario.name);
    TEST_ASSERT_EQUAL_INT(PATH_WAYPOINTS, scenario.source.path);
    TEST_ASSERT_EQUAL_UINT(2, scenario.source.points_count);
    assert_number("2.5", scenario.source.points[0].y_m);
    assert_number("1", scenario.source.points[0].speed_factor);
    assert_number("-30", scenario.source.points[1].x_m);
    assert_number("0.8", scenario.source.points[1].speed_factor);
    assert_number("2.25", scenario.source.speed_mps);
    TEST_ASSERT_EQUAL_INT64(640, scenario.network.nodes);
    TEST_ASSERT_EQUAL_INT(LAYOUT_GRID, scenario.network.layout);
    TEST_ASSERT_EQUAL_STRING("luo", scenario.tracker.name);
    TEST_ASSERT_TRUE(scenario.tracker.nonlinear);
    TEST_ASSERT_EQUAL_UINT(2, scenario.sweep.values_count);
    TEST_ASSERT_EQUAL_STRING("960", scenario.sweep.values[1]);
    TEST_ASSERT_EQUAL_UINT(2, scenario.clusters.nodes.count);
    assert_number("7", scenario.clusters.nodes.values[1]);
    assert_number("0.01", scenario.clusters.range_variance_m2.values[1]);
    assert_number("80", scenario.field.width_m);
    assert_number("0.2", scenario.tracker.chi);
}

static void a_bad_file_is_refused_in_one_line_with_file_line_key_and_expectation(void)
{
    static const struct {
        const char *yaml, *start, *part;
    } cases[] = {
        {"source:\n\n  speed_mps: fast\n", "a.yaml:3: source.speed_mps: expected a number 0.01 to 100, found 'fast'",
         ""},
        {"source: {speed_mps: 0x10}", "a.yaml:1: source.speed_mps: expected a number", "'0x10'"},
        {"source: {speed_mps: .nan}", "a.yaml:1: source.speed_mps: expected a number", "'.nan'"},
        {"source: {speed_mps: nan}", "a.yaml:1: source.speed_mps: expected a number", "'nan'"},
        {"source: {speed_mps: inf}", "a.yaml:1: source.speed_mps: expected a number", "'inf'"},
        {"source: {speed_mps: 1e999}", "a.yaml:1: source.speed_mps: expected a number", "'1e999'"},
        {"source: {speed_mps: 0}", "a.yaml:1: source.speed_mps: expected a number 0.01 to 100, found '0'", ""},
        {"source: {speed_mps: [1]}", "a.yaml:1: source.speed_mps: expected a single value, found a list", ""},
        {"source: {speed_mps: }", "a.yaml:1: source.speed_mps: expected a number", "''"},
        {"name: x\nsource:\n  sped_mps: 1\n", "a.yaml:3: source.sped_mps: unknown key", "source.speed_mps"},
        {"sensors: {loss: 1}", "a.yaml:1: sensors: unknown key", ""},
        {"source: 3", "a.yaml:1: source: expected a block of keys, found a single value", ""},
        {"source: {points: [{x_m: 1, y_m: '1,5'}]}",
         "a.yaml:1: source.points[0].y_m: expected a number -1e+06 to 1e+06, found '1,5'", ""},
        {"source: {points: [{x_m: 1}]}", "a.yaml:1: source.points: expected a key y_m", ""},
        {"source: {points: [{x_m: 1, y_m: 2, z: 3}]}", "a.yaml:1: source.points.z: unknown key", ""},
        {"source: {points: []}", "a.yaml:1: source.points: expected at least one entry, found none", ""},
        {"targets: [{points: [{x_m: 1, y_m: 2}, {x_m: q, y_m: 2}]}]",
         "a.yaml:1: targets[0].points[1].x_m: expected a number -1e+06 to 1e+06, found 'q'", ""},
        {"targets:\n- {points: [{x_m: 1, y_m: 2}], loudness: loud}",
         "a.yaml:2: targets[0].loudness: expected a number 0.001 to 1000, found 'loud'", ""},
        {"targets:\n- {speed_mps: 2}", "a.yaml:2: targets: expected a key points", ""},
        {"targets:\n- {points: [{x_m: 1, y_m: 2}]}\n- {points: [{x_m: 1, y_m: 2}], speed_mps: -1}",
         "a.yaml:3: targets[1].speed_mps: expected a number 0.01 to 100, found '-1'", ""},
        {"clusters: {nodes: [3, 4, x]}",
         "a.yaml:1: clusters.nodes: expected 1 to 16 numbers 1 to 32 `a, b, ...`, found '3,4,x'", ""},
        {"clusters: {nodes: [3, 33]}", "a.yaml:1: clusters.nodes: expected 1 to 16 numbers 1 to 32", "'3,33'"},
        {"clusters: {nodes: 3}", "a.yaml:1: clusters.nodes: expected a list, found a single value", ""},
        {"network: {nodes: 3}", "a.yaml:1: network.nodes: expected a whole number 4 to 1000000, found '3'", ""},
        {"network: {nodes: 4.5}", "a.yaml:1: network.nodes: expected a whole number", "'4.5'"},
        {"tracker: {name: kalman}",
         "a.yaml:1: tracker.name: expected one of "
         "diffusion/luo/range/pftl/msl/centroid/cv_ukf/cv_ekf/gas/gas_small/gas_ekf/gas_ukf/acoustic/dm/ml, found "
         "'kalman'",
         ""},
        {"tracker: {nonlinear: yes}", "a.yaml:1: tracker.nonlinear: expected true or false, found 'yes'", ""},
        {"name: a\nname: b", "a.yaml:1: name: expected once, found twice", ""},
        {"name: a\n---\nname: b", "a.yaml:1: expected one document, found more", ""},
        {"name: a\n  source: {", "a.yaml:2: expected YAML: ", ""},
        {"name: \"\\xZZ\"", "a.yaml:1: expected YAML: ", ""},
        {"name: \xff", "a.yaml:", "expected YAML: "},
        {"", "a.yaml:1: expected keys of a scenario, found nothing", ""},
        {"- 1", "a.yaml:1: expected a block of keys, found a list", ""},
        {"name: &a x\ndescription: *a", "a.yaml:", "alias"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        tearDown();
        setUp();
        TEST_ASSERT_EQUAL_INT_MESSAGE(-1, parse(cases[i].yaml), cases[i].yaml);
        TEST_ASSERT_EQUAL_STRING_LEN_MESSAGE(cases[i].start, error, strlen(cases[i].start), cases[i].yaml);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error, cases[i].part), error);
        TEST_ASSERT_NULL_MESSAGE(strchr(error, '\n'), error);
    }
}

static void set_refuses_what_a_file_may_not_hold_and_changes_nothing_then(void)
{
    TEST_ASSERT_EQUAL_INT(-1, scenario_set(&scenario, "source.speed_mp", "1", error, sizeof error));
    TEST_ASSERT_NOT_NULL(strstr(error, "source.speed_mps"));
    TEST_ASSERT_EQUAL_INT(-1, scenario_set(&scenario, "sensor.relative_noise", "1.5", error, sizeof error));
    TEST_ASSERT_EQUAL_STRING("sensor.relative_noise: expected a number 0 to 1, found '1.5'", error);
    TEST_ASSERT_EQUAL_INT(-1, scenario_set(&scenario, "source.points", "1,2; 3", error, sizeof error));
    TEST_ASSERT_EQUAL_INT(-1, scenario_set(&scenario, "source.points", "1,2; 3,4,0", error, sizeof error));
    TEST_ASSERT_EQUAL_INT(-1, scenario_set(&scenario, "source.points", "1,2; 3,4,1,1", error, sizeof error));
    TEST_ASSERT_EQUAL_UINT(2, scenario.source.points_count);
    assert_number("78", scenario.source.points[1].y_m);
    TEST_ASSERT_EQUAL_INT(0, scenario_set(&scenario, "source.points", " 1 , 2 ;3,4, 0.5", error, sizeof error));
    assert_number("0.5", scenario.source.points[1].speed_factor);
}

static void keys_that_contradict_each_other_are_refused(void)
{
    static const char *const cases[][4] = {
        {"source.path", "waypoints", "source.points", "1,1"},
        {"source.path", "arcs", "source.points", "1,1; 1,1"},
        {"source.path", "still", "source.duration_s", "0"},
        {"source.speed_mps", "0.01", "source.points", "0,0; 100000,0"},
        {"sensor.outage_start_s", "90", "sensor.outage_s", "10"},
        {"network.layout", "file", "network.file", ""},
        {"network.sink_x_m", "81", "network.sink_y_m", "0"},
        {"network.sink_x_m", "80", "network.sink_y_m", "-1"},
        {"radio.propagation", "log_distance", "radio.power_dbm", "-50"},
        {"energy.profile", "none", "energy.battery_j", "1"},
        {"faults.every_s", "0.5", "sensor.interval_s", "1"},
        {"tracker.window_s", "1", "sensor.interval_s", "1"},
        {"tracker.chi", "0", "tracker.name", "diffusion"},
        {"source.path", "gauss_markov", "source.duration_s", "0.5"},
        {"source.path", "scripted", "sensor.quantity", "sound"},
        {"source.path", "parallel", "sensor.quantity", "concentration"},
        {"target.count", "2", "source.path", "arcs"},
        {"targets", "0,1,1: 0,0; 5,5", "source.path", "arcs"},
        {"network.ideal", "true", "network.protocol", "collection"},
        {"network.protocol", "cluster", "sensor.quantity", "concentration"},
        {"network.protocol", "token", "sensor.quantity", "range"},
        {"network.starts", "10", "network.layout", "uniform"},
        {"network.density", "12", "network.layout", "file"},
        {"tracker.range_sd_m", "1e-4", "tracker.name", "range"},
        {"tracker.acceleration_sd_mps2", "1e-4", "tracker.name", "range"},
        {"tracker.speed_mps", "1e-4", "tracker.name", "pftl"},
        {"network.density", "1e-4", "network.nodes", "100000"},
        {"sweep.key", "network.node", "sweep.values", "1"},
        {"sweep.key", "network.nodes", "sweep.values", ""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        tearDown();
        setUp();
        TEST_ASSERT_EQUAL_INT(0, scenario_set(&scenario, cases[i][0], cases[i][1], error, sizeof error));
        TEST_ASSERT_EQUAL_INT(0, scenario_set(&scenario, cases[i][2], cases[i][3], error, sizeof error));
        TEST_ASSERT_EQUAL_INT_MESSAGE(-1, scenario_check(&scenario, "a.yaml", error, sizeof error), cases[i][0]);
        TEST_ASSERT_EQUAL_STRING_LEN("a.yaml: ", error, 8);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error, "expected"), error);
    }
    tearDown();
    setUp();
    scenario.faults.dead.share = 0.1;
    scenario.faults.dead.from_s = scenario.faults.every_s = 20;
    TEST_ASSERT_EQUAL_INT(-1, scenario_check(&scenario, "a.yaml", error, sizeof error));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error, "faults.every_s: expected 0 or more than 20"), error);
    scenario.faults.every_s = 0;
    /* E1 lasts 96.3706 s */
    TEST_ASSERT_EQUAL_INT(0, scenario_set(&scenario, "sensor.outage_start_s", "76.37", error, sizeof error));
    TEST_ASSERT_EQUAL_INT(0, scenario_set(&scenario, "sensor.outage_s", "20", error, sizeof error));
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_check(&scenario, "a.yaml", error, sizeof error), error);
}

static void fixed_clusters_have_limits(void)
{
    static const char *const sound[][2] = {
        {"source.path", "white_acceleration"}, {"source.duration_s", "100"}, {"network.protocol", "fixed"},
        {"network.layout", "rings"},           {"network.nodes", "18"},      {"network.ideal", "true"},
        {"sensor.quantity", "range"},          {"sensor.interval_s", "0.5"}, {"tracker.name", "cv_ukf"}};
    static const char *const cases[][2] = {{"network.layout", "uniform"},
                                           {"network.nodes", "17"},
                                           {"source.path", "arcs"},
                                           {"sensor.quantity", "concentration"},
                                           {"tracker.name", "range"},
                                           {"network.protocol", "collection"},
                                           {"clusters.nodes", "3, 4, 5, 6.5"},
                                           {"clusters.range_variance_m2", "1, 2, 3"},
                                           {"clusters.nodes", "2, 2, 2, 2, 2, 2, 2, 2, 2"},
                                           {"clusters.shared", "4"},
                                           {"fusion.report_s", "0.75"},
                                           {"fusion.report_s", "0.25"},
                                           {"sensor.noisy_detection", "true"},
                                           {"sensor.loss", "0.1"}};
    static const char *const on_air[][2] = {{"fusion.report_loss", "0.1"}, {"clusters.shared", "1"}};
    for (size_t k = 0; k < sizeof sound / sizeof sound[0]; k++) {
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_set(&scenario, sound[k][0], sound[k][1], error, sizeof error), error);
    }
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_check(&scenario, "a.yaml", error, sizeof error), error);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0] + sizeof on_air / sizeof on_air[0]; i++) {
        const bool ideal = i < sizeof cases / sizeof cases[0];
        const char *const *set = ideal ? cases[i] : on_air[i - sizeof cases / sizeof cases[0]];
        tearDown();
        setUp();
        for (size_t k = 0; k < sizeof sound / sizeof sound[0]; k++) {
            (void)scenario_set(&scenario, sound[k][0], sound[k][1], error, sizeof error);
        }
        scenario.network.ideal = ideal;
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_set(&scenario, set[0], set[1], error, sizeof error), error);
        TEST_ASSERT_EQUAL_INT_MESSAGE(-1, scenario_check(&scenario, "a.yaml", error, sizeof error), set[0]);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error, "expected"), error);
    }
}

/* What the ideal network or the walk of the published experiments cannot do. */
static void a_ranged_target_in_clusters_has_limits(void)
{
    static const char *const cases[][2] = {
        {"network.protocol", "direct"}, {"sensor.quantity", "concentration"},
        {"source.path", "none"},        {"sensor.loss", "0.1"},
        {"energy.battery_j", "1"},      {"faults.stuck_share", "0.1"},
        {"clock.drift_ppm", "1"},       {"clock.sync", "flooding"},
        {"sensor.adc_bits", "8"},       {"sensor.range_m", "1"},     /* steps of 17 m in a field of 14 */
        {"faults.mute_for_s", "5"},     {"network.density", "1000"}, /* a field of 50 m x 1.77 */
        {"target.speed_mph", "1000"},   {"source.duration_s", "1.9"},
    };
    char path[SCENARIO_PATH_MAX];
    TEST_ASSERT_EQUAL_INT(0, scenario_find("zhou_nominal", path, error, sizeof error));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        tearDown();
        setUp();
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_load(path, &scenario, error, sizeof error), error);
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_check(&scenario, "a.yaml", error, sizeof error), error);
        TEST_ASSERT_EQUAL_INT(0, scenario_set(&scenario, cases[i][0], cases[i][1], error, sizeof error));
        TEST_ASSERT_EQUAL_INT_MESSAGE(-1, scenario_check(&scenario, "a.yaml", error, sizeof error), cases[i][0]);
        TEST_ASSERT_EQUAL_STRING_LEN("a.yaml: ", error, 8);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error, "expected"), error);
    }
}

static void count_sound(void *context, const char *name, const char *path)
{
    struct scenario listed;
    TEST_ASSERT_EQUAL_INT(0, scenario_init(&listed));
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_load(path, &listed, error, sizeof error), error);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_check(&listed, path, error, sizeof error), error);
    TEST_ASSERT_EQUAL_STRING(name, listed.name);
    TEST_ASSERT_TRUE(listed.description[0] != '\0');
    scenario_free(&listed);
    ++*(size_t *)context;
}

static void the_scenarios_that_come_along_are_sound(void)
{
    static const char *const names[] = {"luo_exp1", "luo_exp2", "luo_exp3", "luo_exp4", "zhou_nominal", "zhou_real"};
    char path[SCENARIO_PATH_MAX];
    size_t count = 0;
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        TEST_ASSERT_EQUAL_INT(0, scenario_find(names[i], path, error, sizeof error));
    }
    const size_t listed = scenario_list(count_sound, &count);
    TEST_ASSERT_EQUAL_size_t(listed, count);
    TEST_ASSERT_TRUE(count >= 4);
    TEST_ASSERT_EQUAL_INT(-1, scenario_find("luo_exp9", path, error, sizeof error));
    TEST_ASSERT_EQUAL_INT(-1, scenario_find("./luo_exp1", path, error, sizeof error));
}

static void targets_that_are_heard_have_limits(void)
{
    static const char *const cases[][3] = {
        {"sensor.range_m", "0.5", "sensor.range_m: expected 1 to 1000"},
        {"sensor.range_m", "140", "radio.range_m: expected radios that reach farther than sensor.range_m = 140"},
        {"sensor.interval_s", "0.01", "sensor.interval_s: expected 0.02 to 60"},
        {"protocol.watch_s", "0.2", "protocol.watch_s: expected 0 or at least sensor.interval_s = 0.25, found 0.2"},
        {"tracker.groups", "members", "tracker.groups: expected none unless tracker.name is acoustic, found dm"},
        {"tracker.strongest", "1", "tracker.strongest: expected 0 or at least 2, found 1"},
        {"targets", "0,1,1: 1,1", "targets: expected none unless source.path is scripted, found 1"},
        {"source.path", "scripted", "targets: expected at least one for source.path scripted, found none"},
        {"protocol.election", "sacx", "protocol.election: expected prince, competition or timestamp"},
    };
    char path[SCENARIO_PATH_MAX];
    TEST_ASSERT_EQUAL_INT(0, scenario_find("han_straight", path, error, sizeof error));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct scenario heard;
        TEST_ASSERT_EQUAL_INT(0, scenario_init(&heard));
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_load(path, &heard, error, sizeof error), error);
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_set(&heard, cases[i][0], cases[i][1], error, sizeof error), error);
        TEST_ASSERT_EQUAL_INT(-1, scenario_check(&heard, "s", error, sizeof error));
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error, cases[i][2]), error);
        scenario_free(&heard);
    }
    struct scenario still;
    TEST_ASSERT_EQUAL_INT(0, scenario_init(&still));
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_load(path, &still, error, sizeof error), error);
    TEST_ASSERT_EQUAL_INT(0, scenario_set(&still, "source.path", "scripted", error, sizeof error));
    TEST_ASSERT_EQUAL_INT(0, scenario_set(&still, "targets", "0,1,1: 1,1; 9,9 | 0,1,1: 5,5; 5,5", error, sizeof error));
    TEST_ASSERT_EQUAL_INT(-1, scenario_check(&still, "s", error, sizeof error));
    TEST_ASSERT_EQUAL_STRING("s: targets[1].points: expected at least 2 different ones, found 2", error);
    scenario_free(&still);
}

static void a_deployment_file_is_found_beside_its_scenario(void)
{
    char folder[] = "/tmp/motehound-XXXXXX", path[100], expected[100];
    TEST_ASSERT_NOT_NULL(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/s.yaml", folder);
    FILE *file = fopen(path, "w");
    TEST_ASSERT_NOT_NULL(file);
    fputs("network: {layout: file, file: nodes.csv}\n", file);
    fclose(file);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, scenario_load(path, &scenario, error, sizeof error), error);
    snprintf(expected, sizeof expected, "%s/nodes.csv", folder);
    TEST_ASSERT_EQUAL_STRING(expected, scenario.network.file);
    remove(path);
    remove(folder);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_default_is_inside_its_range_and_every_key_documented_once);
    RUN_TEST(a_file_sets_what_it_names_and_leaves_the_rest);
    RUN_TEST(a_bad_file_is_refused_in_one_line_with_file_line_key_and_expectation);
    RUN_TEST(set_refuses_what_a_file_may_not_hold_and_changes_nothing_then);
    RUN_TEST(keys_that_contradict_each_other_are_refused);
    RUN_TEST(a_ranged_target_in_clusters_has_limits);
    RUN_TEST(fixed_clusters_have_limits);
    RUN_TEST(targets_that_are_heard_have_limits);
    RUN_TEST(the_scenarios_that_come_along_are_sound);
    RUN_TEST(a_deployment_file_is_found_beside_its_scenario);
    port_exit(UNITY_END() > 0);
    return 0;
}
