/* The tracker `gas` where the wind is measured and the leak can only be at known places, as on an industrial site: which place leaks, and how much.
 *
 * Measurements are concentrations (target 0) and winds (MH_TARGET_WIND_X and _Y of one node and instant, averaged over nodes). Every instant:
 * 1. each sensor's background is subtracted and followed (background.h);
 * 2. the wind gives the plumes: K = mixing_m |wind|, and directions of the standard deviation direction_sd about the measured one, by
 *    Gauss and Hermite's three points; air takes up to an interval from the source to the sensor, so the plumes of the instant before count as much as those of
 *    this one;
 * 3. the readings go into the regression of each place (plume_regression.h).
 * So nothing but sums is kept. An instant without a wind teaches the backgrounds only. The estimate is the likeliest place; its covariance adds the extent of
 * a place to the likelihood of the others. The rate carries the error of the plume model, a factor of about two, and states no deviation.
 *
 * `save` and `load` do not exist: the head stays where it is. Cost of a reading: 6 exponentials a place. */
#ifndef MOTEHOUND_GAS_WIND_H
#define MOTEHOUND_GAS_WIND_H

#if MH_REAL_FIXED
#error "motehound/gas_wind.h needs MH_REAL=float: docs/fixed_point.md"
#endif

#include "motehound/background.h"
#include "motehound/plume_regression.h"
#include "motehound/tracker.h"

/* Wind below this, in m/s, counts as this much: anemometers and the model of a steady plume both fail in a calm. */
#define MH_GAS_CALM_MPS 0.5f

struct mh_gas_wind_config {
    struct mh_place places[MH_LEAK_PLACES_MAX]; /* where the leak can be */
    uint16_t place_count;                       /* 1 to MH_LEAK_PLACES_MAX */
    mh_real place_sd_m; /* the leak is off its place by this much, 0.01 to 1,000 m; of the covariance. Nominal 3 */
    mh_real mixing_m;   /* K over the wind's speed, 1e-3 to 1e3 m. Nominal 0.3 */
    mh_real direction_sd_rad; /* of the plume's axis about the measured wind, 0 to 1. Nominal 0.2 */
    mh_real unit;             /* concentration (plume.h) that is 1 in the unit of the sensors, > 0. Nominal 1 */
    mh_real correlation;      /* readings that tell as much as one, 1 to 1e4 (plume_regression.h). Nominal 10 */
    struct mh_background_config background; /* nominal 0.2 and, for readings once a minute in ppm, 0.03 */
    mh_tick learn;                          /* in which only the backgrounds are learned, at first. Nominal an hour */
    mh_tick memory; /* the past is forgotten with this time constant, 1 ms to 24 days; 0: never. Nominal 4 hours */
};

struct mh_gas_wind {
    struct mh_gas_wind_config config;
    struct mh_vec2 places[MH_LEAK_PLACES_MAX]; /* from config.places[0] */
    struct mh_plume_regression regression;
    struct {
        mh_node_id node;
        struct mh_background background;
    } sensors[MH_LEAK_SENSORS_MAX];
    uint16_t sensor_count;
    mh_real keep;                 /* of the sums, from one instant to the next */
    struct mh_plume_share air[6]; /* the plumes of this instant, then those of the instant before */
    bool blows[2];                /* so: known */
    mh_tick interval, begin, time;
    bool stepped, learned, tracking;
    struct mh_plume_fit fit; /* while tracking */
    uint32_t crowded;        /* readings of further sensors than MH_LEAK_SENSORS_MAX, which are left out */
};

extern const struct mh_tracker mh_tracker_gas_wind;

/* The nominal values, without places. */
void mh_gas_wind_config_default(struct mh_gas_wind_config *config);

#endif
