#include "port.h"
#include "record/output.h"
#include "record/results.h"
#include "unity.h"

#include <dirent.h>
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static char base[64];
static char error[1000];

static const char *at(const char *name)
{
    static char path[300];
    snprintf(path, sizeof path, "%s/%s", base, name);
    return path;
}

/* Names in a folder that begin with `prefix`, "." and ".." apart. */
static int entries(const char *folder, const char *prefix)
{
    int count = 0;
    DIR *open_folder = opendir(folder);
    for (const struct dirent *e; open_folder != NULL && (e = readdir(open_folder)) != NULL;) {
        count += strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0 &&
                 strncmp(e->d_name, prefix, strlen(prefix)) == 0;
    }
    if (open_folder != NULL) {
        closedir(open_folder);
    }
    return count;
}

static void put(const struct output *output, const char *name, const char *text)
{
    FILE *file = output_create(output, name, error, sizeof error);
    TEST_ASSERT_NOT_NULL_MESSAGE(file, error);
    fputs(text, file);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, output_finish(file, name, error, sizeof error), error);
}

static void assert_file(const char *name, const char *text)
{
    char found[300] = "";
    FILE *file = fopen(at(name), "r");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, name);
    found[fread(found, 1, sizeof found - 1, file)] = '\0';
    fclose(file);
    TEST_ASSERT_EQUAL_STRING(text, found);
}

static void remove_tree(const char *path)
{
    char command[400];
    snprintf(command, sizeof command, "rm -rf '%s'", path);
    TEST_ASSERT_EQUAL_INT(0, system(command));
}

void setUp(void)
{
    snprintf(base, sizeof base, "/tmp/motehound-XXXXXX");
    TEST_ASSERT_NOT_NULL(mkdtemp(base));
}
void tearDown(void) { remove_tree(base); }

static void nothing_shows_before_the_commit_and_all_after(void)
{
    static const char *const names[] = {"runs.csv", "summary.json"};
    struct output output;
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, output_open(&output, at("deep/er/out/"), error, sizeof error), error);
    put(&output, "runs.csv", "1");
    put(&output, "summary.json", "2");
    TEST_ASSERT_NOT_EQUAL(0, access(at("deep/er/out"), F_OK));
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, output_commit(&output, names, 2, error, sizeof error), error);
    assert_file("deep/er/out/runs.csv", "1");
    assert_file("deep/er/out/summary.json", "2");
    TEST_ASSERT_EQUAL_INT(1, entries(at("deep/er"), ""));
}

static void a_discarded_output_leaves_what_was_there(void)
{
    static const char *const names[] = {"runs.csv"};
    struct output output;
    TEST_ASSERT_EQUAL_INT(0, output_open(&output, at("out"), error, sizeof error));
    put(&output, "runs.csv", "old");
    TEST_ASSERT_EQUAL_INT(0, output_commit(&output, names, 1, error, sizeof error));
    TEST_ASSERT_EQUAL_INT(0, output_open(&output, at("out"), error, sizeof error));
    put(&output, "runs.csv", "new");
    output_discard(&output);
    assert_file("out/runs.csv", "old");
    TEST_ASSERT_EQUAL_INT(1, entries(base, ""));
}

/* Opens the output and is gone, as if it were killed. */
static void be_killed_over(const char *name)
{
    const pid_t child = fork();
    TEST_ASSERT_TRUE(child >= 0);
    if (child == 0) {
        struct output output;
        _exit(output_open(&output, at(name), error, sizeof error) == 0 &&
                      output_create(&output, "runs.csv", error, sizeof error) != NULL
                  ? 0
                  : 1);
    }
    int status;
    TEST_ASSERT_EQUAL_INT(child, waitpid(child, &status, 0));
    TEST_ASSERT_EQUAL_INT(0, status);
}

static void what_a_killed_process_left_goes_and_what_others_write_stays(void)
{
    struct output output;
    char living[100];
    snprintf(living, sizeof living, ".out.partial-%ld", (long)getppid());
    TEST_ASSERT_EQUAL_INT(0, mkdir(at(living), 0777));
    TEST_ASSERT_EQUAL_INT(0, mkdir(at(".out.partial-"), 0777));
    be_killed_over("other");
    be_killed_over("out");
    TEST_ASSERT_EQUAL_INT(3, entries(base, ".out"));
    TEST_ASSERT_EQUAL_INT(0, output_open(&output, at("out"), error, sizeof error));
    output_discard(&output);
    TEST_ASSERT_EQUAL_INT(2, entries(base, ".out"));
    TEST_ASSERT_EQUAL_INT(1, entries(base, ".other"));
    TEST_ASSERT_EQUAL_INT(0, mkdir(at("out"), 0777)); /* the hidden folder is then within it */
    be_killed_over("out");
    TEST_ASSERT_EQUAL_INT(1, entries(at("out"), ""));
    TEST_ASSERT_EQUAL_INT(0, output_open(&output, at("out"), error, sizeof error));
    output_discard(&output);
    TEST_ASSERT_EQUAL_INT(0, entries(at("out"), ""));
}

static void a_commit_replaces_results_and_nothing_else(void)
{
    static const char *const before[] = {"runs.csv", "events.lcm", "summary.json"};
    static const char *const after[] = {"runs.csv", "summary.json"};
    struct output output;
    TEST_ASSERT_EQUAL_INT(0, output_open(&output, at("out"), error, sizeof error));
    for (size_t i = 0; i < 3; i++) {
        put(&output, before[i], "old");
    }
    TEST_ASSERT_EQUAL_INT(0, output_commit(&output, before, 3, error, sizeof error));
    FILE *mine = fopen(at("out/mine.txt"), "w");
    fputs("mine", mine);
    fclose(mine);
    TEST_ASSERT_EQUAL_INT(0, output_open(&output, at("out"), error, sizeof error));
    put(&output, "runs.csv", "new");
    put(&output, "summary.json", "new");
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, output_commit(&output, after, 2, error, sizeof error), error);
    assert_file("out/runs.csv", "new");
    assert_file("out/summary.json", "new");
    assert_file("out/mine.txt", "mine");
    TEST_ASSERT_EQUAL_INT(3, entries(at("out"), ""));
    TEST_ASSERT_EQUAL_INT(1, entries(base, ""));
}

static void a_link_to_a_folder_and_the_working_folder_are_written_into(void)
{
    static const char *const names[] = {"runs.csv"};
    char here[300];
    struct output output;
    struct stat before, after;
    TEST_ASSERT_EQUAL_INT(0, mkdir(at("real"), 0777));
    TEST_ASSERT_EQUAL_INT(0, symlink("real", at("link")));
    TEST_ASSERT_EQUAL_INT(0, stat(at("real"), &before));
    TEST_ASSERT_EQUAL_INT(0, output_open(&output, at("link"), error, sizeof error));
    put(&output, "runs.csv", "1");
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, output_commit(&output, names, 1, error, sizeof error), error);
    assert_file("real/runs.csv", "1");
    TEST_ASSERT_NOT_NULL(getcwd(here, sizeof here));
    TEST_ASSERT_EQUAL_INT(0, chdir(at("real")));
    TEST_ASSERT_EQUAL_INT(0, output_open(&output, ".", error, sizeof error));
    put(&output, "runs.csv", "2");
    const int status = output_commit(&output, names, 1, error, sizeof error);
    TEST_ASSERT_EQUAL_INT(0, chdir(here));
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, status, error);
    assert_file("real/runs.csv", "2");
    TEST_ASSERT_EQUAL_INT(1, entries(at("real"), ""));
    TEST_ASSERT_EQUAL_INT(0, stat(at("real"), &after));
    TEST_ASSERT_TRUE(before.st_ino == after.st_ino);
}

static void a_folder_that_cannot_be_written_is_refused(void)
{
    struct output output;
    fclose(fopen(at("file"), "w"));
    TEST_ASSERT_EQUAL_INT(-1, output_open(&output, at("file"), error, sizeof error));
    TEST_ASSERT_NOT_NULL(strstr(error, "file: cannot write into this folder: Not a directory"));
    TEST_ASSERT_EQUAL_INT(-1, output_open(&output, at("file/out"), error, sizeof error));
    TEST_ASSERT_EQUAL_INT(-1, output_open(&output, "", error, sizeof error));
    TEST_ASSERT_EQUAL_INT(0, symlink("nowhere", at("link")));
    TEST_ASSERT_EQUAL_INT(-1, output_open(&output, at("link"), error, sizeof error));
    TEST_ASSERT_EQUAL_INT(2, entries(base, ""));
}

/* A disk that is full, as Linux offers one. */
static void a_full_disk_is_noticed(void)
{
    FILE *file = fopen("/dev/full", "w");
    if (file == NULL) {
        TEST_IGNORE_MESSAGE("no /dev/full");
    }
    fputs("x", file);
    TEST_ASSERT_EQUAL_INT(-1, output_finish(file, "runs.csv", error, sizeof error));
    TEST_ASSERT_EQUAL_STRING("runs.csv: cannot write: No space left on device", error);
}

/* Three runs whose only position errors are 1, 2 and 6 m, in one, two and three estimates. */
static void the_summary_says_what_the_runs_say(void)
{
    static const double errors_m[] = {1, 2, 6};
    struct scenario scenario;
    struct results results;
    TEST_ASSERT_EQUAL_INT(0, scenario_init(&scenario));
    TEST_ASSERT_EQUAL_INT(0, scenario_set(&scenario, "metrics.skip_first", "0", error, sizeof error));
    TEST_ASSERT_EQUAL_INT_MESSAGE(
        0, results_open(&results, at("out"), "a \"scenario\"", NULL, 40, false, error, sizeof error), error);
    for (int run = 0; run < 3; run++) {
        motehound_track_t tracks[3];
        memset(tracks, 0, sizeof tracks);
        for (int i = 0; i <= run; i++) {
            tracks[i] = (motehound_track_t){.time_s = i, .x_m = errors_m[run], .true_known = 1, .raw_y_m = 0.1};
        }
        const struct recorder recorder = {.tracks = tracks, .track_count = (size_t)run + 1, .samples = 4};
        TEST_ASSERT_EQUAL_INT_MESSAGE(
            0, results_add(&results, 40 + (uint64_t)run, &scenario, &recorder, error, sizeof error), error);
    }
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, results_commit(&results, "1.2.3", error, sizeof error), error);
    scenario_free(&scenario);

    json_error_t json_error;
    json_t *summary = json_load_file(at("out/summary.json"), 0, &json_error);
    TEST_ASSERT_NOT_NULL_MESSAGE(summary, json_error.text);
    const char *name, *version;
    int seed, runs, n;
    double mean, sd, median, p95, share, pooled_rmse, pooled_median;
    TEST_ASSERT_EQUAL_INT_MESSAGE(0,
                                  json_unpack_ex(summary, &json_error, 0, "{s:s, s:s, s:i, s:i}", "scenario", &name,
                                                 "version", &version, "seed", &seed, "runs", &runs),
                                  json_error.text);
    TEST_ASSERT_EQUAL_size_t(6, json_object_size(summary)); /* with metrics and pooled */
    TEST_ASSERT_EQUAL_INT_MESSAGE(0,
                                  json_unpack_ex(summary, &json_error, 0, "{s:{s:F, s:F}}", "pooled", "position_rmse_m",
                                                 &pooled_rmse, "position_median_m", &pooled_median),
                                  json_error.text);
    TEST_ASSERT_EQUAL_STRING("a \"scenario\"", name);
    TEST_ASSERT_EQUAL_STRING("1.2.3", version);
    TEST_ASSERT_TRUE(seed == 40 && runs == 3);
    TEST_ASSERT_TRUE(fabs(pooled_rmse - sqrt((1 + 2 * 4 + 3 * 36) / 6.0)) < 1e-8 && fabs(pooled_median - 4) < 1e-8);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0,
                                  json_unpack_ex(summary, &json_error, 0, "{s:{s:{s:F, s:F, s:F, s:F, s:i !}}}",
                                                 "metrics", "position_rmse_m", "mean", &mean, "std", &sd, "median",
                                                 &median, "p95", &p95, "n", &n),
                                  json_error.text);
    TEST_ASSERT_TRUE(fabs(mean - 3) < 1e-8 && fabs(sd - sqrt(7)) < 1e-8 && fabs(median - 2) < 1e-8 &&
                     fabs(p95 - 5.6) < 1e-8 && n == 3);
    TEST_ASSERT_EQUAL_INT(0, json_unpack(summary, "{s:{s:{s:F}}}", "metrics", "tracked_share", "mean", &share));
    TEST_ASSERT_TRUE(fabs(share - 0.5) < 1e-8);
    TEST_ASSERT_NULL(json_object_get(json_object_get(summary, "metrics"), "nees_median"));
    json_decref(summary);
    TEST_ASSERT_EQUAL_INT(4, entries(at("out"), ""));
}

static void several_targets_have_files_of_their_own(void)
{
    struct results results;
    struct scenario scenario;
    TEST_ASSERT_EQUAL_INT(0, scenario_init(&scenario));
    motehound_track_t tracks[] = {
        {.time_s = 2, .target = 32, .number = 1, .x_m = 5, .members = 1, .extent_m = 3},
        {.time_s = 2, .target = 16, .number = -1, .x_m = 6, .members = 2, .extent_m = 4, .of = {16, 48}}};
    motehound_track_t sinks[] = {{.time_s = 2, .target = 16, .x_m = 60}, {.time_s = 2, .target = 32, .x_m = 50}};
    motehound_watch_t watches[] = {
        {.time_s = 2,
         .target = 32,
         .number = 1,
         .head = 7,
         .prince = 8,
         .prince_s = 4,
         .x_m = 5,
         .vx_mps = 10,
         .sd_m = 2},
        {.time_s = 3, .target = 16, .number = -1, .head = 9, .prince = -1, .prince_s = 4, .members = 2, .extent_m = 4}};
    motehound_truth_t truths[] = {{.time_s = 2, .target = 0, .x_m = 6}, {.time_s = 2, .target = 1, .x_m = 5}};
    struct recorder recorder = {.tracks = tracks,
                                .track_count = 2,
                                .sinks = sinks,
                                .sink_count = 2,
                                .watches = watches,
                                .watch_count = 2,
                                .truths = truths,
                                .truth_count = 2,
                                .targets = 1};
    for (unsigned several = 0; several < 2; several++) {
        const int status =
            results_open(&results, at("out"), "few", NULL, 0, false, error, sizeof error) |
            results_add(&results, 0, &scenario, &recorder, error, sizeof error) |
            (several ? results_add(&results, 1, &scenario, &(struct recorder){0}, error, sizeof error) : 0) |
            results_commit(&results, "1", error, sizeof error);
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, status, error);
        TEST_ASSERT_EQUAL_INT(several ? 0 : -1, access(at("out/truth.csv"), R_OK));
        recorder.targets = 2;
    }
    scenario_free(&scenario);
    assert_file("out/truth.csv", "run,time_s,target,x_m,y_m,vx_mps,vy_mps\n0,2,0,6,0,0,0\n0,2,1,5,0,0,0\n");
    assert_file("out/watch.csv",
                "run,time_s,target,number,head,prince,prince_s,x_m,y_m,vx_mps,vy_mps,sd_m,extent_m,members\n"
                "0,2,32,1,7,8,4,5,0,10,0,2,,0\n"
                "0,3,16,,9,,,0,0,,,0,4,2\n");
    FILE *file = fopen(at("out/track.csv"), "r");
    TEST_ASSERT_NOT_NULL(file);
    char line[400];
    const char *const ends[] = {"number,mode,members,extent_m,of_0,of_1,of_2,of_3\n", "50,0,0,0,,1,0,1,,,,,\n",
                                "60,0,0,0,,,0,2,4,16,48,,\n"};
    for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++) { /* the sink's x_m is that of the same target */
        TEST_ASSERT_NOT_NULL(fgets(line, sizeof line, file));
        TEST_ASSERT_TRUE(strlen(line) > strlen(ends[i]));
        TEST_ASSERT_EQUAL_STRING(ends[i], line + strlen(line) - strlen(ends[i]));
    }
    fclose(file);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(nothing_shows_before_the_commit_and_all_after);
    RUN_TEST(a_discarded_output_leaves_what_was_there);
    RUN_TEST(what_a_killed_process_left_goes_and_what_others_write_stays);
    RUN_TEST(a_commit_replaces_results_and_nothing_else);
    RUN_TEST(a_link_to_a_folder_and_the_working_folder_are_written_into);
    RUN_TEST(a_folder_that_cannot_be_written_is_refused);
    RUN_TEST(a_full_disk_is_noticed);
    RUN_TEST(the_summary_says_what_the_runs_say);
    RUN_TEST(several_targets_have_files_of_their_own);
    port_exit(UNITY_END() > 0);
    return 0;
}
