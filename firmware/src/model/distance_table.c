#include "motehound/distance_table.h"

#define FINEST 40U /* intervals */

#ifdef __AVR__
#include <avr/pgmspace.h>
#else
#define PROGMEM
#define pgm_read_float(address) (*(address))
#endif

/* n_k of the finest table; that of a table of n intervals, where n divides FINEST, is number k FINEST / n of it. */
static const mh_real levels[FINEST] PROGMEM = {
    1600,       400,        177.777778f, 100,        64,         44.444444f,  32.65306f,  25,
    19.753086f, 16,         13.2231405f, 11.111111f, 9.467456f,  8.163265f,   7.111111f,  6.25f,
    5.536332f,  4.9382716f, 4.432133f,   4,          3.6281179f, 3.3057851f,  3.0245747f, 2.77777778f,
    2.56f,      2.366864f,  2.19478738f, 2.0408163f, 1.902497f,  1.7777778f,  1.6649324f, 1.5625f,
    1.4692378f, 1.384083f,  1.3061224f,  1.2345679f, 1.1687363f, 1.10803324f, 1.0519395f, 1};

static mh_real level(uint8_t intervals, uint16_t stride, uint16_t k)
{
    return stride > 0 ? pgm_read_float(&levels[(uint16_t)(k * stride - 1)])
                      : mh_squared((mh_real)intervals / (mh_real)k);
}

/* From one n_k to the next in `levels`; 0 if they are not there. */
static uint16_t stride_of(uint8_t intervals) { return (uint16_t)(FINEST % intervals == 0 ? FINEST / intervals : 0); }

uint16_t mh_distance_interval(uint8_t intervals, mh_real energy)
{
    const uint16_t stride = stride_of(intervals);
    uint16_t beyond = 0;                         /* the energy is below the least of this interval, */
    uint16_t within = (uint16_t)(intervals + 1); /* but not of this one */
    while (within - beyond > 1) {
        const uint16_t k = (uint16_t)((beyond + within) / 2);
        if (energy >= level(intervals, stride, k)) {
            within = k;
        } else {
            beyond = k;
        }
    }
    return within;
}

mh_real mh_distance(const struct mh_distance_table *table, mh_real energy)
{
    if (!(energy >= 1)) {
        return table->range_m;
    }
    if (table->intervals == 0) {
        return mh_max(table->range_m / mh_sqrt(energy), 1);
    }
    const uint16_t k = mh_distance_interval(table->intervals, energy);
    const mh_real width = table->range_m / (mh_real)table->intervals;
    if (table->mode == MH_DISTANCE_LINEAR) {
        const uint16_t stride = stride_of(table->intervals);
        const mh_real outer = level(table->intervals, stride, k);
        if (k == 1) {
            return width * outer / energy;
        }
        const mh_real inner = level(table->intervals, stride, (uint16_t)(k - 1));
        return width * ((mh_real)(k - 1) + (inner - energy) / (inner - outer));
    }
    if (k == 1 && table->mode == MH_DISTANCE_OUTER) {
        return width;
    }
    if (k == 1 && table->mode == MH_DISTANCE_CENTROID) {
        return width * (2.0f / 3.0f);
    }
    return width * ((mh_real)k - 0.5f);
}
