#include "motehound/decomposition.h"

#include "motehound/sound.h"

static mh_wide square_of_distance(struct mh_vec2 source, struct mh_vec2 node)
{
    const mh_wide square = mh_vec2_square(mh_vec2_between(node, source)),
                  least = mh_wide_mul(MH_SOUND_NEAR_M, MH_SOUND_NEAR_M);
    return square > least ? square : least;
}

mh_real mh_sound_share(const struct mh_vec2 *sources, size_t count, size_t own, struct mh_vec2 node, mh_real range_m)
{
    const mh_wide square = square_of_distance(sources[own], node);
    mh_real parts = MH_REAL(1.0f); /* in units of the own one, which is 1 / d^2 */
    for (size_t j = 0; j < count; j++) {
        const mh_wide other = square_of_distance(sources[j], node);
        if (j != own && other <= mh_wide_mul(range_m, range_m)) {
            parts = mh_add(parts, mh_wide_ratio(square, other));
        }
    }
    return mh_div(MH_REAL(1.0f), parts);
}

mh_real mh_sound_residual(mh_real loudness, const struct mh_vec2 *sources, size_t count, size_t own,
                          struct mh_vec2 node, mh_real energy)
{
    mh_real left = energy;
    for (size_t j = 0; j < count; j++) {
        if (j != own) {
            left = mh_add(left,
                          -mh_wide_ratio(mh_wide_mul(loudness, MH_REAL(1.0f)), square_of_distance(sources[j], node)));
        }
    }
    return mh_max(left, mh_mul(MH_RESIDUAL_LEAST, energy));
}
