#include "motehound/sound_fix.h"
#include "self_test_parts.h"

#include <stddef.h>

/* A target at (10, 5) heard without noise: energies 1600 / d^2 */
bool self_test_sound(void)
{
    static const struct mh_sound sound = {1600.0f, 0.19f, 0.05f};
    static const struct mh_vec2 places[] = {{30.0f, 0.0f}, {0.0f, 0.0f}, {10.0f, 35.0f}, {-5.0f, 20.0f}};
    static const mh_real squares[] = {425.0f, 125.0f, 900.0f, 450.0f};
    struct mh_heard heard[4];
    struct mh_vec2 place;
    for (uint8_t i = 0; i < 4; i++) {
        heard[i].place = places[i];
        heard[i].energy = 1600.0f / squares[i];
    }
    return self_test_node() && mh_sound_fix(&sound, heard, 4, NULL, &place, NULL) == MH_OK &&
           mh_abs(place.x - 10.0f) < 0.01f && mh_abs(place.y - 5.0f) < 0.01f;
}
