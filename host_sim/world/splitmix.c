#include "world/splitmix.h"

#include <math.h>

static const double pi = 3.141592653589793;
static const uint64_t golden = UINT64_C(0x9E3779B97F4A7C15);

struct splitmix splitmix_begin(uint64_t seed, enum splitmix_stream stream)
{
    return (struct splitmix){seed * golden + (uint64_t)stream * UINT64_C(0xD1B54A32D192ED03)};
}

uint64_t splitmix_next(struct splitmix *stream)
{
    uint64_t z = stream->state += golden;
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

double splitmix_uniform(struct splitmix *stream) { return (double)(splitmix_next(stream) >> 11) * 0x1p-53; }

double splitmix_normal(struct splitmix *stream)
{
    const double radius = sqrt(-2 * log(1 - splitmix_uniform(stream)));
    return radius * cos(2 * pi * splitmix_uniform(stream));
}
