/* How far the motes' idea of the network's time is off, over motes and time. */
#ifndef MOTEHOUND_SIM_CLOCK_ERRORS_H
#define MOTEHOUND_SIM_CLOCK_ERRORS_H

#include <stdint.h>

/* Magnitudes are counted by the leading 16 bits of a float, so a quantile is right to 0.4 % and the memory, 256 KB, does not depend on how
 * many there are. All zero bytes: none so far. */
struct clock_errors {
    uint64_t *counts;
    uint64_t known, unknown;
};

/* One more; NaN: that mote does not know the time. Returns 0, or -1 if there is no memory. */
int clock_errors_add(struct clock_errors *errors, double error_s);

/* The magnitude, in ms, below which `share` of the known errors are; NaN if there are none. */
double clock_errors_quantile_ms(const struct clock_errors *errors, double share);

/* Share of the motes and times at which the time was known at all; NaN if none was asked for. */
double clock_errors_known_share(const struct clock_errors *errors);

void clock_errors_free(struct clock_errors *errors);

#endif
