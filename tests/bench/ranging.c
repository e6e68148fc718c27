#include "ranging.h"

#include "motehound/random.h"

/* nodes within 50 m of a place: eight */
static const int32_t pitch_mm = 31000;

struct mh_place ranging_target(unsigned step)
{
    const struct mh_place target = {8000 * (int32_t)step, 4000 * (int32_t)step, 0};
    return target;
}

void ranging_measurements(unsigned step, uint8_t wanted, struct mh_measurement *measurements)
{
    const struct mh_place target = ranging_target(step);
    const int32_t x_mm = target.x_mm, y_mm = target.y_mm;
    struct mh_random noise;
    mh_random_init(&noise, step);
    mh_q20 kept[RANGING_MEASUREMENTS_MAX]; /* distances, ascending */
    uint8_t count = 0;
    for (int8_t i = -2; i <= 3; i++) {
        for (int8_t j = -2; j <= 3; j++) {
            const struct mh_place node = {(x_mm / pitch_mm + i) * pitch_mm, (y_mm / pitch_mm + j) * pitch_mm, 0};
            const mh_q20 distance = mh_q20_from_real(mh_vec2_length(mh_place_relative(&node, &target)));
            uint8_t at = count;
            for (; at > 0 && kept[at - 1] > distance; at--) {
                if (at < wanted) {
                    kept[at] = kept[at - 1];
                    measurements[at] = measurements[at - 1];
                }
            }
            if (at < wanted) {
                const mh_real error = mh_mul(MH_REAL(17.3f), mh_random_unit(&noise) -
                                                                 MH_REAL(0.5f)); /* uniform, standard deviation 5 m */
                const struct mh_measurement taken = {.node = (mh_node_id)(10 * (i + 2) + j + 2),
                                                     .place = node,
                                                     .time = RANGING_INTERVAL * step,
                                                     .value = distance + mh_q20_from_real(error)};
                measurements[at] = taken;
                kept[at] = distance;
                count = (uint8_t)(count + (count < wanted));
            }
        }
    }
}
