#include "motehound/distance_table.h"

#define FINEST 40U /* intervals */

#ifdef __AVR__
#include <avr/pgmspace.h>
#if MH_REAL_FIXED
#define read_flash(address) ((mh_real)pgm_read_dword(address))
#else
#define read_flash(address) pgm_read_float(address)
#endif
#else
#define PROGMEM
#define read_flash(address) (*(address))
#endif

/* n_k of the finest table; that of a table of n intervals, where n divides FINEST, is number k FINEST / n of it. */
static const mh_real levels[FINEST] PROGMEM = {
    MH_REAL(1600.0f),     MH_REAL(400.0f),      MH_REAL(177.777778f), MH_REAL(100.0f),      MH_REAL(64.0f),
    MH_REAL(44.444444f),  MH_REAL(32.65306f),   MH_REAL(25.0f),       MH_REAL(19.753086f),  MH_REAL(16.0f),
    MH_REAL(13.2231405f), MH_REAL(11.111111f),  MH_REAL(9.467456f),   MH_REAL(8.163265f),   MH_REAL(7.111111f),
    MH_REAL(6.25f),       MH_REAL(5.536332f),   MH_REAL(4.9382716f),  MH_REAL(4.432133f),   MH_REAL(4.0f),
    MH_REAL(3.6281179f),  MH_REAL(3.3057851f),  MH_REAL(3.0245747f),  MH_REAL(2.77777778f), MH_REAL(2.56f),
    MH_REAL(2.366864f),   MH_REAL(2.19478738f), MH_REAL(2.0408163f),  MH_REAL(1.902497f),   MH_REAL(1.7777778f),
    MH_REAL(1.6649324f),  MH_REAL(1.5625f),     MH_REAL(1.4692378f),  MH_REAL(1.384083f),   MH_REAL(1.3061224f),
    MH_REAL(1.2345679f),  MH_REAL(1.1687363f),  MH_REAL(1.10803324f), MH_REAL(1.0519395f),  MH_REAL(1.0f)};

static mh_real level(uint8_t intervals, uint16_t stride, uint16_t k)
{
    return stride > 0 ? read_flash(&levels[(uint16_t)(k * stride - 1)])
                      : mh_squared(mh_div(mh_real_from_int(intervals), mh_real_from_int(k)));
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
    if (!(energy >= MH_REAL(1.0f))) {
        return table->range_m;
    }
    if (table->intervals == 0) {
        return mh_max(mh_div(table->range_m, mh_sqrt(energy)), MH_REAL(1.0f));
    }
    const uint16_t k = mh_distance_interval(table->intervals, energy);
    const mh_real width = mh_div(table->range_m, mh_real_from_int(table->intervals));
    if (table->mode == MH_DISTANCE_LINEAR) {
        const uint16_t stride = stride_of(table->intervals);
        const mh_real outer = level(table->intervals, stride, k);
        if (k == 1) {
            return mh_div(mh_mul(width, outer), energy);
        }
        const mh_real inner = level(table->intervals, stride, (uint16_t)(k - 1));
        return mh_mul(width, mh_real_from_int(k - 1) + mh_div(inner - energy, inner - outer));
    }
    if (k == 1 && table->mode == MH_DISTANCE_OUTER) {
        return width;
    }
    if (k == 1 && table->mode == MH_DISTANCE_CENTROID) {
        return mh_mul(width, MH_REAL(2.0f / 3.0f));
    }
    return mh_mul(width, mh_real_from_int(k) - MH_REAL(0.5f));
}
