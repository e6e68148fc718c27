#include "record/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int reserve(struct samples *samples, size_t count)
{
    if (count <= samples->capacity) {
        return 0;
    }
    size_t capacity = samples->capacity > 0 ? samples->capacity : 64;
    while (capacity < count) {
        capacity *= 2;
    }
    double *larger = realloc(samples->values, capacity * sizeof *larger);
    if (larger == NULL) {
        return -1;
    }
    samples->values = larger;
    samples->capacity = capacity;
    return 0;
}

int samples_add(struct samples *samples, double value)
{
    if (reserve(samples, samples->count + 1) != 0) {
        return -1;
    }
    samples->values[samples->count++] = value;
    return 0;
}

int samples_append(struct samples *samples, const struct samples *more)
{
    if (more->count == 0) {
        return 0;
    }
    if (reserve(samples, samples->count + more->count) != 0) {
        return -1;
    }
    memcpy(samples->values + samples->count, more->values, more->count * sizeof *more->values);
    samples->count += more->count;
    return 0;
}

void samples_free(struct samples *samples)
{
    free(samples->values);
    *samples = (struct samples){0};
}

double samples_mean(const struct samples *samples)
{
    double sum = 0;
    for (size_t i = 0; i < samples->count; i++) {
        sum += samples->values[i];
    }
    return samples->count > 0 ? sum / (double)samples->count : (double)NAN;
}

double samples_rms(const struct samples *samples)
{
    double sum = 0;
    for (size_t i = 0; i < samples->count; i++) {
        sum += samples->values[i] * samples->values[i];
    }
    return samples->count > 0 ? sqrt(sum / (double)samples->count) : (double)NAN;
}

double samples_sd(const struct samples *samples)
{
    const double mean = samples_mean(samples);
    double sum = 0;
    for (size_t i = 0; i < samples->count; i++) {
        sum += (samples->values[i] - mean) * (samples->values[i] - mean);
    }
    if (samples->count < 2) {
        return samples->count == 1 ? 0 : (double)NAN;
    }
    return sqrt(sum / (double)(samples->count - 1));
}

static int ascending(const void *a, const void *b)
{
    const double left = *(const double *)a, right = *(const double *)b;
    return left < right ? -1 : left > right;
}

double samples_quantile(struct samples *samples, double p)
{
    if (samples->count == 0) {
        return (double)NAN;
    }
    qsort(samples->values, samples->count, sizeof *samples->values, ascending);
    const double place = p * (double)(samples->count - 1);
    const size_t below = (size_t)place;
    const size_t above = below + 1 < samples->count ? below + 1 : below;
    return samples->values[below] + (place - (double)below) * (samples->values[above] - samples->values[below]);
}
