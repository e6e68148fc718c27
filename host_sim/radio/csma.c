#include "radio/csma.h"

#include <math.h>

sim_time csma_wait(struct csma *csma, const struct radio_profile *profile, struct random_stream stream, uint32_t mote)
{
    const uint32_t step = csma->busy < RADIO_BACKOFF_STEPS ? csma->busy : RADIO_BACKOFF_STEPS - 1;
    const uint64_t mask = (UINT64_C(1) << profile->backoff_exponents[step]) - 1;
    const uint64_t bits = random_bits(stream, (uint64_t)mote << 32 | csma->draws++);
    const double units = (double)(profile->least_units + (bits >> 32 & mask));
    return (sim_time)llround(units * profile->backoff_unit_us + profile->cca_us);
}

bool csma_was_busy(struct csma *csma, const struct radio_profile *profile) { return ++csma->busy <= profile->backoffs; }

bool csma_not_acknowledged(struct csma *csma, const struct radio_profile *profile)
{
    csma->busy = 0;
    return ++csma->tries <= profile->retries;
}
