/* What a scenario says of the radio. */
#include "radio/radio.h"

#include <math.h>

struct radio_config radio_config_of(const struct scenario *scenario, double range_m)
{
    struct radio_config config = {.profile = *radio_profile_find(scenario->radio.profile),
                                  .channel = {.loss = scenario->radio.loss,
                                              .burst_loss = scenario->radio.burst_loss,
                                              .good_s = scenario->radio.burst_good_s,
                                              .bad_s = scenario->radio.burst_bad_s},
                                  .queue = (unsigned)scenario->radio.queue};
    if (scenario->radio.wake_period_s > 0) {
        config.wake_period = (sim_time)llround(scenario->radio.wake_period_s * SIM_TIME_PER_S);
        config.wake_length = (sim_time)llround(scenario->radio.wake_length_s * SIM_TIME_PER_S);
    }
    struct radio_profile *profile = &config.profile;
    faults_make(&config.channel.faults, scenario, 0); /* those of the channel are not drawn */
    if (!profile->contention) {
        profile->bitrate_bps = scenario->radio.bitrate_bps;
    }
    if (scenario->radio.sensitivity_dbm < 0) {
        profile->sensitivity_dbm = scenario->radio.sensitivity_dbm;
    }
    if (scenario->radio.retries >= 0) {
        profile->retries = (unsigned)scenario->radio.retries;
    }
    if (scenario->radio.backoffs >= 0) {
        profile->backoffs = (unsigned)scenario->radio.backoffs;
    }
    config.propagation = (struct propagation_config){
        .kind = isinf(range_m) ? PROPAGATION_DISC : scenario->radio.propagation,
        .range_m = range_m,
        .power_dbm = scenario->radio.power_dbm,
        .exponent = scenario->radio.path_loss_exponent,
        .reference_loss_db = scenario->radio.reference_loss_db,
        .shadowing_db = scenario->radio.shadowing_db,
    };
    return config;
}

double radio_nominal_range_m(const struct scenario *scenario)
{
    struct radio_config config = radio_config_of(scenario, scenario->radio.range_m);
    config.propagation.shadowing_db = 0;
    const struct propagation propagation = propagation_make(&config.propagation, 0, 0);
    return propagation_reach_m(&propagation, mw_from_dbm(config.profile.sensitivity_dbm));
}
