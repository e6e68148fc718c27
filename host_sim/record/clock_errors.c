#include "record/clock_errors.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BINS = 1 << 15 };

/* A positive float grows with its bits, taken for an integer. */
static uint32_t bin_of(float magnitude)
{
    uint32_t bits;
    memcpy(&bits, &magnitude, sizeof bits);
    return bits >> 16;
}

static double middle_of(uint32_t bin)
{
    const uint32_t bits = bin << 16 | (bin > 0 ? 0x8000u : 0);
    float magnitude;
    memcpy(&magnitude, &bits, sizeof magnitude);
    return (double)magnitude;
}

int clock_errors_add(struct clock_errors *errors, double error_s)
{
    if (isnan(error_s)) {
        errors->unknown++;
        return 0;
    }
    if (!errors->counts && !(errors->counts = calloc(BINS, sizeof *errors->counts))) {
        return -1;
    }
    errors->counts[bin_of((float)fabs(1e3 * error_s))]++;
    errors->known++;
    return 0;
}

double clock_errors_quantile_ms(const struct clock_errors *errors, double share)
{
    uint64_t below = 0;
    for (uint32_t bin = 0; errors->known > 0 && bin < BINS; bin++) {
        below += errors->counts[bin];
        if ((double)below >= share * (double)errors->known && below > 0) {
            return middle_of(bin);
        }
    }
    return (double)NAN;
}

double clock_errors_known_share(const struct clock_errors *errors)
{
    return (double)errors->known / (double)(errors->known + errors->unknown);
}

void clock_errors_free(struct clock_errors *errors)
{
    free(errors->counts);
    *errors = (struct clock_errors){0};
}
