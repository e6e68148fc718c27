#include "readings.h"

#include "unity.h"
#include "world/field.h"
#include "world/sensor.h"

#include <math.h>
#include <stdlib.h>

void readings_make(struct readings *readings, const struct scenario *scenario, uint64_t seed)
{
    char error[300] = "no memory";
    struct field field;
    struct sensors sensors;
    TEST_ASSERT_EQUAL_INT64(0, scenario->sensor.adc_bits);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, deployment_make(&readings->deployment, scenario, seed, error, sizeof error),
                                  error);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, field_make(&field, scenario, 0, error, sizeof error), error);
    const size_t count = readings->deployment.count;
    const double interval_s = scenario->sensor.interval_s;
    readings->instants = (size_t)floor(field.trajectory.duration_s / interval_s + 1e-9) + 1;
    readings->all = calloc(readings->instants * count, sizeof *readings->all);
    readings->x_m = calloc(2 * readings->instants, sizeof *readings->x_m);
    readings->y_m = readings->x_m + readings->instants;
    double *concentrations = calloc(count, sizeof *concentrations);
    int32_t *counts = calloc(count, sizeof *counts);
    TEST_ASSERT_TRUE(readings->all != NULL && readings->x_m != NULL && concentrations != NULL && counts != NULL);
    TEST_ASSERT_EQUAL_INT(0, sensors_make(&sensors, scenario, seed, count));
    for (size_t k = 0; k < readings->instants; k++) {
        const double time_s = (double)k * interval_s;
        const struct point source = trajectory_position(&field.trajectory, time_s);
        readings->x_m[k] = source.x_m;
        readings->y_m[k] = source.y_m;
        TEST_ASSERT_EQUAL_INT(0, field_prepare(&field, time_s));
        for (size_t i = 0; i < count; i++) {
            const struct recorded_node *node = &readings->deployment.nodes[i];
            concentrations[i] = field_concentration(&field, node->x_m, node->y_m);
        }
        sensors_read(&sensors, k, concentrations, counts);
        for (size_t i = 0; i < count; i++) {
            readings->all[k * count + i] = (struct reading){!sensors_lost(&sensors, k, time_s, i), counts[i]};
        }
    }
    sensors_free(&sensors);
    field_free(&field);
    free(counts);
    free(concentrations);
}

void readings_free(struct readings *readings)
{
    deployment_free(&readings->deployment);
    free(readings->all);
    free(readings->x_m);
    *readings = (struct readings){0};
}

const struct reading *readings_at(const struct readings *readings, size_t instant, size_t node)
{
    return &readings->all[instant * readings->deployment.count + node];
}

bool readings_increment(const struct readings *readings, size_t instant, size_t node, mh_q20 *increment)
{
    if (instant == 0 || !readings_at(readings, instant, node)->came ||
        !readings_at(readings, instant - 1, node)->came) {
        return false;
    }
    *increment = readings_at(readings, instant, node)->value - readings_at(readings, instant - 1, node)->value;
    return true;
}
