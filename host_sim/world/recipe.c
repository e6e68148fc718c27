#include "world/recipe.h"

#include <math.h>

static const uint64_t golden = UINT64_C(0x9E3779B97F4A7C15);
static const double pi = 3.141592653589793;

static uint64_t mix(uint64_t z)
{
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

uint64_t recipe_hash(uint64_t seed, uint64_t a, uint64_t b)
{
    return mix(mix(mix(seed + golden) + golden * (a + 1)) + golden * (b + 1));
}

double recipe_uniform(uint64_t seed, uint64_t a, uint64_t b)
{
    return ((double)(recipe_hash(seed, a, b) >> 11) + 0.5) * 0x1p-53;
}

double recipe_normal(uint64_t seed, uint64_t a, uint64_t b)
{
    return sqrt(-2 * log(recipe_uniform(seed, a, 2 * b))) * cos(2 * pi * recipe_uniform(seed, a, 2 * b + 1));
}
