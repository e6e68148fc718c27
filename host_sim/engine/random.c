#include "engine/random.h"

#include <math.h>

static const double two_pi = 6.283185307179586;

void random_normals(struct random_stream stream, uint64_t first, size_t count, double *normals)
{
    for (size_t i = 0; i < count;) {
        const uint64_t even = (first + i) & ~UINT64_C(1);
        const double r = sqrt(-2.0 * log1p(-random_uniform(stream, even)));
        const double angle = two_pi * random_uniform(stream, even + 1);
        if (first + i == even) {
            normals[i++] = r * cos(angle);
        }
        if (i < count && first + i == even + 1) {
            normals[i++] = r * sin(angle);
        }
    }
}
