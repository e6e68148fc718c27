/* Order statistics and moments of a sample of finite numbers. */
#ifndef MOTEHOUND_SIM_STATISTICS_H
#define MOTEHOUND_SIM_STATISTICS_H

#include <stddef.h>

/* A list of numbers that grows. All zero bytes is empty. */
struct samples {
    double *values;
    size_t count, capacity;
};

/* Returns 0, or -1 if there is no memory. */
int samples_add(struct samples *samples, double value);
int samples_append(struct samples *samples, const struct samples *more);
void samples_free(struct samples *samples);

/* All of them give NaN for an empty sample. */
double samples_mean(const struct samples *samples);
double samples_rms(const struct samples *samples);

/* Standard deviation with the divisor n - 1; 0 for a single number. */
double samples_sd(const struct samples *samples);

/* The quantile of order 0 <= p <= 1 by linear interpolation between order statistics (Hyndman and Fan's type 7). Puts
 * the values in ascending order. O(n log n). */
double samples_quantile(struct samples *samples, double p);

#endif
