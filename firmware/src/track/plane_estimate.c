#include "plane_estimate.h"

#include <string.h>

void mh_plane_estimate(const struct mh_gaussian *state, const struct mh_place *origin, mh_tick time,
                       struct mh_estimate *estimate)
{
    static const uint8_t place_of[4] = {0, 2, 1, 3}; /* of x, y, vx, vy in the state */
    const mh_real *P = state->P;
    const struct mh_vec2 position = {state->x[0], state->x[2]}, velocity = {state->x[1], state->x[3]};
    struct mh_estimate stated = {
        .origin = *origin,
        .time = time,
        .position = position,
        .velocity = velocity,
        .covariance = {P[MH_PACKED(0, 0)], P[MH_PACKED(0, 2)], P[MH_PACKED(2, 2)]},
        .raw = position,
        .stored = position,
        .stored_velocity = velocity,
        .states = 4,
    };
    mh_real *more = stated.covariance_more;
    for (int column = 2; column < 4; column++) {
        for (int row = 0; row <= column; row++) {
            *more++ = P[mh_packed_index(place_of[row], place_of[column])];
        }
    }
    *estimate = stated;
}
