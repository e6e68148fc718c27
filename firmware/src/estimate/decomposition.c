#include "motehound/decomposition.h"

#include "motehound/sound.h"

static mh_real square_of_distance(struct mh_vec2 source, struct mh_vec2 node)
{
    return mh_max(mh_squared(source.x - node.x) + mh_squared(source.y - node.y), MH_SOUND_NEAR_M * MH_SOUND_NEAR_M);
}

mh_real mh_sound_share(const struct mh_vec2 *sources, size_t count, size_t own, struct mh_vec2 node, mh_real range_m)
{
    const mh_real square = square_of_distance(sources[own], node);
    mh_real parts = 1.0f; /* in units of the own one, which is 1 / d^2 */
    for (size_t j = 0; j < count; j++) {
        const mh_real other = square_of_distance(sources[j], node);
        if (j != own && other <= range_m * range_m) {
            parts += square / other;
        }
    }
    return 1.0f / parts;
}

mh_real mh_sound_residual(mh_real loudness, const struct mh_vec2 *sources, size_t count, size_t own,
                          struct mh_vec2 node, mh_real energy)
{
    mh_real left = energy;
    for (size_t j = 0; j < count; j++) {
        if (j != own) {
            left -= loudness / square_of_distance(sources[j], node);
        }
    }
    return mh_max(left, MH_RESIDUAL_LEAST * energy);
}
