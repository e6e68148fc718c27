#include "radio/propagation.h"

#include <math.h>

/* Shadowing beyond so many standard deviations does not happen. */
static const double shadowing_cut = 3;

double mw_from_dbm(double dbm) { return pow(10, dbm / 10); }

struct propagation propagation_make(const struct propagation_config *config, size_t places, uint64_t seed)
{
    return (struct propagation){.config = *config,
                                .shadowing = random_stream(seed, RANDOM_RADIO_SHADOWING),
                                .places = places,
                                .power_at_1m_mw = mw_from_dbm(config->power_dbm - config->reference_loss_db)};
}

double propagation_shadowing_db(const struct propagation *propagation, uint32_t a, uint32_t b)
{
    if (!(propagation->config.shadowing_db > 0)) {
        return 0;
    }
    const uint64_t first = a < b ? a : b, second = a < b ? b : a;
    double normal;
    random_normals(propagation->shadowing, 2 * (first * propagation->places + second), 1, &normal);
    return propagation->config.shadowing_db * fmin(fmax(normal, -shadowing_cut), shadowing_cut);
}

double propagation_power(const struct propagation *propagation, const struct place *a, const struct place *b)
{
    const struct propagation_config *config = &propagation->config;
    const double distance_sq = place_distance_sq(a, b);
    if (config->kind == PROPAGATION_DISC) {
        return distance_sq <= config->range_m * config->range_m ? 1 : 0;
    }
    const double power = propagation->power_at_1m_mw * pow(fmax(distance_sq, 1), -0.5 * config->exponent);
    return config->shadowing_db > 0 ? power * mw_from_dbm(-propagation_shadowing_db(propagation, a->index, b->index))
                                    : power;
}

double propagation_reach_m(const struct propagation *propagation, double power)
{
    const struct propagation_config *config = &propagation->config;
    if (config->kind == PROPAGATION_DISC) {
        return config->range_m;
    }
    const double strongest = propagation->power_at_1m_mw * mw_from_dbm(shadowing_cut * config->shadowing_db);
    return strongest < power ? 0 : fmax(pow(strongest / power, 1 / config->exponent), 1);
}
