#include "leaking.h"

#include "motehound/random.h"

void leaking_config(struct mh_gas_config *config)
{
    mh_gas_config_default(config);
    config->noise = 0.1f;
}

/* Golden sections spread the sensors evenly over the field. */
static struct mh_vec2 place_of(unsigned sensor)
{
    const unsigned x = sensor * 309u % 500u, y = sensor * 247u % 400u;
    const struct mh_vec2 place = {(mh_real)x, (mh_real)y};
    return place;
}

void leaking_measurements(unsigned step, unsigned sensors, struct mh_measurement *measurements)
{
    static const struct mh_place origin = {0, 0, 0};
    static const struct mh_vec2 leak = {50, 200};
    struct mh_gas_config config;
    struct mh_random noise;
    leaking_config(&config);
    mh_random_init(&noise, step);
    for (unsigned i = 0; i < LEAKING_MEASUREMENTS; i++) {
        const unsigned sensor = (LEAKING_MEASUREMENTS * step + i) % sensors;
        const struct mh_vec2 at = place_of(sensor);
        mh_real concentration = 0;
        mh_plume_model(&config.plume, at, leak, 0, &concentration, NULL);
        const mh_real error = 0.1f * 3.46f * (mh_random_unit(&noise) - 0.5f); /* uniform */
        const struct mh_measurement taken = {.node = (mh_node_id)(sensor + 1),
                                             .place = mh_place_from_offset(&origin, at),
                                             .time = LEAKING_INTERVAL * (mh_tick)step,
                                             .value = mh_q20_from_real(30 * concentration / config.unit + error)};
        measurements[i] = taken;
    }
}
