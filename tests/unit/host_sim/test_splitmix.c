/* The published numbers of the generator, and where it puts the nodes of deployments. */
#include "port.h"
#include "unity.h"
#include "world/deployment.h"
#include "world/splitmix.h"
#include "world/trajectory.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void setUp(void) {}
void tearDown(void) {}

static FILE *open_answers(const char *name)
{
    char path[1024], header[200];
    snprintf(path, sizeof path, MOTEHOUND_KNOWN_ANSWERS "/han/%s", name);
    FILE *file = fopen(path, "r");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, path);
    TEST_ASSERT_NOT_NULL(fgets(header, sizeof header, file));
    return file;
}

static void numbers(void)
{
    FILE *file = open_answers("rng.csv");
    uint64_t seed, x[3];
    unsigned stream;
    double uniform, normal;
    size_t rows = 0;
    while (fscanf(file, "%" SCNu64 ",%u,%" SCNx64 ",%" SCNx64 ",%" SCNx64 ",%lf,%lf", &seed, &stream, &x[0], &x[1],
                  &x[2], &uniform, &normal) == 7) {
        struct splitmix s = splitmix_begin(seed, (enum splitmix_stream)stream);
        for (int i = 0; i < 3; i++) {
            TEST_ASSERT_TRUE(splitmix_next(&s) == x[i]);
        }
        s = splitmix_begin(seed, (enum splitmix_stream)stream);
        TEST_ASSERT_TRUE(fabs(splitmix_uniform(&s) - uniform) <= 1e-16);
        TEST_ASSERT_TRUE(fabs(splitmix_normal(&s) - normal) <= 1e-14);
        rows++;
    }
    fclose(file);
    TEST_ASSERT_GREATER_THAN_size_t(9, rows);
}

/* The caller frees the nodes. */
static struct deployment strata(int64_t side, uint64_t seed)
{
    struct scenario scenario;
    struct deployment deployment;
    char error[300];
    TEST_ASSERT_EQUAL_INT(0, scenario_init(&scenario));
    scenario.field.width_m = scenario.field.height_m = 1000;
    scenario.network.layout = LAYOUT_STRAT;
    scenario.network.grid = side;
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, deployment_make(&deployment, &scenario, seed, error, sizeof error), error);
    TEST_ASSERT_EQUAL_size_t((size_t)(side * side), deployment.count);
    scenario_free(&scenario);
    return deployment;
}

static struct point strat(int64_t side, uint64_t seed, size_t index)
{
    struct deployment deployment = strata(side, seed);
    TEST_ASSERT_LESS_THAN_size_t(deployment.count, index);
    const struct point place = {deployment.nodes[index].x_m, deployment.nodes[index].y_m};
    deployment_free(&deployment);
    return place;
}

/* Nodes anywhere: x then y of 1000 m. */
static struct point anywhere(uint64_t seed, size_t index)
{
    struct splitmix s = splitmix_begin(seed, SPLITMIX_DEPLOYMENT);
    for (size_t i = 0; i < 2 * index; i++) {
        (void)splitmix_next(&s);
    }
    const double x_m = 1000 * splitmix_uniform(&s);
    return (struct point){x_m, 1000 * splitmix_uniform(&s)};
}

static void places(void)
{
    FILE *file = open_answers("deploy.csv");
    char kind[20];
    int64_t n;
    uint64_t seed;
    size_t index, rows = 0;
    double x_m, y_m;
    while (fscanf(file, "%19[a-z],%" SCNd64 ",%" SCNu64 ",%zu,%lf,%lf\n", kind, &n, &seed, &index, &x_m, &y_m) == 6) {
        const struct point p = strcmp(kind, "strat") == 0 ? strat(n, seed, index) : anywhere(seed, index);
        TEST_ASSERT_TRUE_MESSAGE(fabs(p.x_m - x_m) <= 1e-9 && fabs(p.y_m - y_m) <= 1e-9, kind);
        rows++;
    }
    fclose(file);
    TEST_ASSERT_GREATER_THAN_size_t(29, rows);
}

/* The share of places, 40 m from the border and farther, with three nodes within 40 m, of three seeds: published to three digits. */
static void coverage(void)
{
    static const struct {
        int64_t side;
        double share;
    } wanted[] = {{23, 0.549}, {26, 0.815}, {34, 0.999}};
    for (size_t k = 0; k < sizeof wanted / sizeof wanted[0]; k++) {
        unsigned places = 0, covered = 0;
        for (uint64_t seed = 1; seed <= 3; seed++) {
            const struct deployment deployment = strata(wanted[k].side, seed);
            for (double x_m = 40; x_m <= 960; x_m += 20) {
                for (double y_m = 40; y_m <= 960; y_m += 20) {
                    unsigned near = 0;
                    for (size_t i = 0; i < deployment.count && near < 3; i++) {
                        near += hypot(deployment.nodes[i].x_m - x_m, deployment.nodes[i].y_m - y_m) <= 40;
                    }
                    places++;
                    covered += near == 3;
                }
            }
            free(deployment.nodes);
        }
        TEST_ASSERT_TRUE(fabs((double)covered / places - wanted[k].share) < 0.015);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(numbers);
    RUN_TEST(places);
    RUN_TEST(coverage);
    port_exit(UNITY_END() > 0);
}
