#include "motehound/config.h"
#include "port.h"
#include "scenario/recording.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NODES "node,x_m,y_m\n1,0,0\n2,10,0\n3,0,10\n7,10,10\n"

static struct recording recording;
static char error[1000];

void setUp(void) { memset(&recording, 0, sizeof recording); }
void tearDown(void) { recording_free(&recording); }

static int nodes(const char *text)
{
    return recording_parse_nodes(text, strlen(text), "n.csv", &recording, error, sizeof error);
}
static int readings(const char *text)
{
    return recording_parse_readings(text, strlen(text), "r.csv", &recording, error, sizeof error);
}
static int truth(const char *text)
{
    return recording_parse_truth(text, strlen(text), "t.csv", &recording, error, sizeof error);
}

static int candidates(const char *text)
{
    return recording_parse_candidates(text, strlen(text), "c.csv", &recording, error, sizeof error);
}

static void columns_may_stand_in_any_order_and_lines_end_in_crlf(void)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(
        0, nodes("\xEF\xBB\xBFz_m,y_m,node,x_m\r\n1.5,2,1,3\r\n\r\n0,0,2,0\r\n0,0,3,0\r\n0,0,4294967294,0"), error);
    TEST_ASSERT_EQUAL_size_t(4, recording.node_count);
    TEST_ASSERT_TRUE(recording.nodes[0].x_m == 3 && recording.nodes[0].y_m == 2 && recording.nodes[0].z_m == 1.5);
    TEST_ASSERT_EQUAL_UINT32(4294967294u, recording.nodes[3].id);
    TEST_ASSERT_EQUAL_INT_MESSAGE(
        0, readings("time_s,node,value,bearing_rad,target\n0,4294967294,-1.25e1,3.1,2\n0.5,1,+2,0,0\n"), error);
    TEST_ASSERT_EQUAL_size_t(2, recording.reading_count);
    TEST_ASSERT_EQUAL_size_t(3, recording.readings[0].node);
    TEST_ASSERT_TRUE(recording.readings[0].value == -12.5 && fabs(recording.readings[0].bearing_rad - 3.1) < 1e-15);
    TEST_ASSERT_EQUAL_UINT8(2, recording.readings[0].target);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, truth("time_s,x_m,y_m\n0,1,2\n0,1,2\n3,1,2\n"), error);
    TEST_ASSERT_EQUAL_size_t(3, recording.truth_count);
}

static void winds_rates_and_candidates_are_optional(void)
{
    TEST_ASSERT_EQUAL_INT(0, nodes(NODES));
    TEST_ASSERT_EQUAL_INT_MESSAGE(
        0,
        readings(
            "time_s,wind_toward_rad,node,value,wind_speed_mps\n0,3.14159265358979,1,5,2\n1,-1.5707963267949,2,6,0.5\n"),
        error);
    TEST_ASSERT_TRUE(recording.has_wind);
    TEST_ASSERT_TRUE(fabs(recording.readings[0].wind_x_mps + 2) < 1e-9 &&
                     fabs(recording.readings[0].wind_y_mps) < 1e-9);
    TEST_ASSERT_TRUE(fabs(recording.readings[1].wind_x_mps) < 1e-9 &&
                     fabs(recording.readings[1].wind_y_mps + 0.5) < 1e-9);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, truth("time_s,x_m,y_m,rate_mlps\n0,1,2,300\n3,1,2,0\n"), error);
    TEST_ASSERT_TRUE(recording.truths[0].rate_mlps == 300 && recording.truths[1].rate_mlps == 0);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, candidates("y_m,place,x_m\n2,7,-1\n0,0,0\n"), error);
    TEST_ASSERT_EQUAL_size_t(2, recording.candidate_count);
    TEST_ASSERT_EQUAL_UINT32(7, recording.candidates[0].id);
    TEST_ASSERT_TRUE(recording.candidates[0].x_m == -1 && recording.candidates[0].y_m == 2);
    tearDown();
    setUp();
    TEST_ASSERT_EQUAL_INT(0, nodes(NODES));
    TEST_ASSERT_EQUAL_INT(0, readings("time_s,node,value\n0,1,5\n"));
    TEST_ASSERT_FALSE(recording.has_wind);
}

static void more_candidates_than_a_head_has_room_for_are_refused(void)
{
    char text[20 * (MH_LEAK_PLACES_MAX + 2)] = "place,x_m,y_m\n", message[100];
    for (unsigned i = 0; i <= MH_LEAK_PLACES_MAX; i++) {
        sprintf(text + strlen(text), "%u,%u,0\n", i, i);
    }
    TEST_ASSERT_EQUAL_INT(-1, candidates(text));
    snprintf(message, sizeof message, "c.csv:%d: expected at most %d places, found more", MH_LEAK_PLACES_MAX + 2,
             MH_LEAK_PLACES_MAX);
    TEST_ASSERT_EQUAL_STRING(message, error);
}

/* Nodes 1 and 2 every 0.2 s, node 3 every 0.2 s for each of two targets in turn, one gap of 5 s. */
static void the_interval_is_the_median_spacing_of_one_node_and_target(void)
{
    TEST_ASSERT_EQUAL_INT(0, nodes(NODES));
    char text[40000] = "time_s,node,value,target\n";
    size_t used = strlen(text);
    for (int i = 0; i < 200; i++) {
        const double time = 1.7e9 + 0.2 * i + (i > 100 ? 5 : 0);
        used += (size_t)snprintf(text + used, sizeof text - used, "%.4f,1,0,0\n%.4f,2,0,0\n%.4f,3,0,1\n%.4f,3,0,2\n",
                                 time, time + 0.001, time + 0.002, time + 0.1);
    }
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, readings(text), error);
    TEST_ASSERT_TRUE(recording.interval_s == 0.2);
}

static void a_recording_without_two_readings_of_a_node_has_no_interval(void)
{
    TEST_ASSERT_EQUAL_INT(0, nodes(NODES));
    TEST_ASSERT_EQUAL_INT(0, readings("time_s,node,value\n0,1,0\n1,2,0\n"));
    TEST_ASSERT_TRUE(recording.interval_s == 0);
}

struct bad {
    int (*parse)(const char *text);
    const char *text, *message;
};

static void a_bad_file_is_refused_in_one_line_with_file_line_column_and_expectation(void)
{
    static const struct bad cases[] = {
        {nodes, "",
         "n.csv:1: expected the columns node,x_m,y_m,[z_m],[cluster],[period_s],[noise_m2], found no 'node'"},
        {nodes, "node,x_m\n",
         "n.csv:1: expected the columns node,x_m,y_m,[z_m],[cluster],[period_s],[noise_m2], found no 'y_m'"},
        {nodes, "node,x_m,y_m,colour\n",
         "n.csv:1: expected the columns node,x_m,y_m,[z_m],[cluster],[period_s],[noise_m2], found an unknown column "
         "'colour'"},
        {nodes, "node,x_m,y_m,x_m\n",
         "n.csv:1: expected the columns node,x_m,y_m,[z_m],[cluster],[period_s],[noise_m2], found twice 'x_m'"},
        {nodes, "node,x_m,y_m,\n",
         "n.csv:1: expected the columns node,x_m,y_m,[z_m],[cluster],[period_s],[noise_m2], found an unknown column "
         "''"},
        {nodes, "node,x_m,y_m\n1,0,0\n2,0,0\n3,0,0\n", "n.csv: node: expected at least 4 nodes, found 3"},
        {nodes, "node,x_m,y_m\n", "n.csv: node: expected at least 4 nodes, found 0"},
        {nodes, "node,x_m,y_m\n5,0,0\n2,0,0\n3,0,0\n5,1,0\n",
         "n.csv: node: expected each once, found 5 in rows 1 and 4"},
        {nodes, "node,x_m,y_m\n1,0\n", "n.csv:2: expected 3 fields, found fewer"},
        {nodes, "node,x_m,y_m\n1,0,0,0\n", "n.csv:2: expected 3 fields, found more"},
        {nodes, "node,x_m,y_m\n1.5,0,0\n", "n.csv:2: node: expected a whole number 0 to 4294967294, found '1.5'"},
        {nodes, "node,x_m,y_m\n4294967295,0,0\n",
         "n.csv:2: node: expected a whole number 0 to 4294967294, found '4294967295'"},
        {nodes, "node,x_m,y_m\n-1,0,0\n", "n.csv:2: node: expected a whole number 0 to 4294967294, found '-1'"},
        {nodes, "node,x_m,y_m\n1,2e6,0\n", "n.csv:2: x_m: expected a number -1000000 to 1000000, found '2e6'"},
        {nodes, "node,x_m,y_m\n1,,0\n", "n.csv:2: x_m: expected a number -1000000 to 1000000, found ''"},
        {readings, "time_s,node,value\n\n1,1,nan\n",
         "r.csv:3: value: expected a number -2047.99 to 2047.99, found 'nan'"},
        {readings, "time_s,node,value\n1,1,NAN\n",
         "r.csv:2: value: expected a number -2047.99 to 2047.99, found 'NAN'"},
        {readings, "time_s,node,value\n1,1,-inf\n",
         "r.csv:2: value: expected a number -2047.99 to 2047.99, found '-inf'"},
        {readings, "time_s,node,value\n1,1,1e400\n",
         "r.csv:2: value: expected a number -2047.99 to 2047.99, found '1e400'"},
        {readings, "time_s,node,value\n1,1,0x1\n",
         "r.csv:2: value: expected a number -2047.99 to 2047.99, found '0x1'"},
        {readings, "time_s,node,value\n1,1,1 2\n",
         "r.csv:2: value: expected a number -2047.99 to 2047.99, found '1 2'"},
        {readings, "time_s,node,value\n1,1,2048\n",
         "r.csv:2: value: expected a number -2047.99 to 2047.99, found '2048'"},
        {readings, "time_s,node,value\nnan,1,1\n", "r.csv:2: time_s: expected a number -1e+12 to 1e+12, found 'nan'"},
        {readings, "time_s,node,value\n1,4,1\n",
         "r.csv:2: node: expected one of the 4 nodes of the nodes file, found 4"},
        {readings, "time_s,node,value\n1,8,1\n",
         "r.csv:2: node: expected one of the 4 nodes of the nodes file, found 8"},
        {readings, "time_s,node,value\n1,1,1\n2,1,1\n1.5,2,1\n",
         "r.csv:4: time_s: expected at least 2, the time of the row before, found 1.5"},
        {readings, "time_s,node,value\n", "r.csv:2: expected at least one reading, found none"},
        {readings, "time_s,value\n1,1\n",
         "r.csv:1: expected the columns "
         "time_s,node,value,[target],[bearing_rad],[wind_speed_mps],[wind_toward_rad], found no 'node'"},
        {readings, "\ntime_s,node,value,wind_speed_mps\n1,1,1,1\n",
         "r.csv:2: expected both columns wind_speed_mps and wind_toward_rad or neither, found one"},
        {readings, "time_s,node,value,wind_speed_mps,wind_toward_rad\n1,1,1,-1,0\n",
         "r.csv:2: wind_speed_mps: expected a number 0 to 100, found '-1'"},
        {readings, "time_s,node,value,wind_speed_mps,wind_toward_rad\n1,1,1,1,\n",
         "r.csv:2: wind_toward_rad: expected a number -7 to 7, found ''"},
        {readings, "time_s,node,value,target\n1,1,1,256\n",
         "r.csv:2: target: expected a whole number 0 to 255, found '256'"},
        {truth, "time_s,x_m,y_m\n2,0,0\n1,0,0\n",
         "t.csv:3: time_s: expected at least 2, the time of the row before, found 1"},
        {truth, "time_s,x_m,y_m\n", "t.csv:2: expected at least one row, found none"},
        {truth, "time_s,x_m,y_m,rate_mlps\n2,0,0,-1\n",
         "t.csv:2: rate_mlps: expected a number 0 to 1000000000, found '-1'"},
        {candidates, "place,x_m,y_m\n", "c.csv:2: expected at least one place, found none"},
        {candidates, "place,x_m,y_m\n1,0,0\n2,0,0\n1,5,5\n", "c.csv:4: place: expected each once, found 1 again"},
        {candidates, "place,x_m,y_m\n1,0,nan\n", "c.csv:2: y_m: expected a number -1000000 to 1000000, found 'nan'"},
        {truth, "time_s,x_m,y_m\n2,inf,0\n", "t.csv:2: x_m: expected a number -1000000 to 1000000, found 'inf'"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        tearDown();
        setUp();
        if (cases[i].parse != nodes) {
            TEST_ASSERT_EQUAL_INT(0, nodes(NODES));
        }
        TEST_ASSERT_EQUAL_INT_MESSAGE(-1, cases[i].parse(cases[i].text), cases[i].text);
        TEST_ASSERT_EQUAL_STRING(cases[i].message, error);
    }
}

static void a_zero_byte_or_a_cut_file_is_refused(void)
{
    static const char zero[] = "node,x_m,y_m\n1,0,0\n2,\0,0\n";
    TEST_ASSERT_EQUAL_INT(-1, recording_parse_nodes(zero, sizeof zero - 1, "n.csv", &recording, error, sizeof error));
    TEST_ASSERT_NULL(strchr(error, '\n'));
    tearDown();
    setUp();
    TEST_ASSERT_EQUAL_INT(-1, recording_load("/nonexistent/n.csv", "r.csv", NULL, &recording, error, sizeof error));
    TEST_ASSERT_EQUAL_STRING("/nonexistent/n.csv: cannot read: No such file or directory", error);
    TEST_ASSERT_EQUAL_INT(-1, recording_load("/tmp", "r.csv", NULL, &recording, error, sizeof error));
    TEST_ASSERT_EQUAL_STRING("/tmp: cannot read: it is a folder", error);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(columns_may_stand_in_any_order_and_lines_end_in_crlf);
    RUN_TEST(winds_rates_and_candidates_are_optional);
    RUN_TEST(more_candidates_than_a_head_has_room_for_are_refused);
    RUN_TEST(the_interval_is_the_median_spacing_of_one_node_and_target);
    RUN_TEST(a_recording_without_two_readings_of_a_node_has_no_interval);
    RUN_TEST(a_bad_file_is_refused_in_one_line_with_file_line_column_and_expectation);
    RUN_TEST(a_zero_byte_or_a_cut_file_is_refused);
    port_exit(UNITY_END() > 0);
    return 0;
}
