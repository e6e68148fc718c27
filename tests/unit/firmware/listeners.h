/* A field of sensors that hear targets without noise: a grid of 30 m, of which only the nodes that report are kept. */
#ifndef LISTENERS_H
#define LISTENERS_H

#include "motehound/measurement.h"

#include <string.h>

enum { LISTENERS_MAX = 16 };

static struct mh_measurement heard[LISTENERS_MAX];
static size_t heard_count;

/* Where the field's (0, 0) is. */
static const struct mh_place corner = {700000000, -300000000, 0};

static float energy_at(int i, int j, const struct mh_vec2 *targets, int count)
{
    float energy = 0;
    for (int k = 0; k < count; k++) {
        const float x = 30.0f * (float)i - mh_real_to_float(targets[k].x);
        const float y = 30.0f * (float)j - mh_real_to_float(targets[k].y);
        const float square = x * x + y * y;
        energy += 1600.0f / (square > 1.0f ? square : 1.0f);
    }
    return energy;
}

static void hear(mh_tick time, const struct mh_vec2 *targets, int count)
{
    heard_count = 0;
    for (int i = -2; i < 30; i++) {
        for (int j = -2; j < 16 && heard_count < LISTENERS_MAX; j++) {
            const float energy = energy_at(i, j, targets, count);
            if (energy < 1.0f) {
                continue;
            }
            struct mh_measurement *m = &heard[heard_count++];
            memset(m, 0, sizeof *m);
            m->node = (mh_node_id)(i * 32 + j + 100);
            m->place.x_mm = corner.x_mm + (int32_t)30000 * i;
            m->place.y_mm = corner.y_mm + (int32_t)30000 * j;
            m->time = time;
            m->value = mh_q20_from_real(mh_real_from_float(energy));
        }
    }
}

#endif
