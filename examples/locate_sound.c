/* Where a vehicle is, by how loud five microphones hear it. */
#include "motehound/sound_fix.h"

#include <stdio.h>

int main(void)
{
    const struct mh_sound sound = {.loudness_m2 = 1600, .source_sd = 0.19f, .background_sd = 0.05f};
    static const struct mh_heard reports[] = {
        /* where they stand, m, and what they hear, in units of the least they report */
        {{0, 0}, 3.9f}, {{30, 0}, 4.6f}, {{10, 35}, 2.6f}, {{45, 30}, 1.45f}, {{-20, 20}, 1.1f},
    };
    struct mh_heard heard[5];
    size_t count = 0;
    for (int i = 0; i < 5; i++) {
        mh_heard_insert(heard, &count, 5, &reports[i]); /* the strongest first */
    }
    struct mh_vec2 place;
    struct mh_sym2 information;
    if (mh_sound_fix(&sound, heard, count, NULL, &place, &information) != MH_OK) {
        return 1;
    }
    const mh_real determinant = information.xx * information.yy - information.xy * information.xy;
    printf("at (%.2f, %.2f) m, +- %.2f and %.2f m\n", (double)place.x, (double)place.y,
           (double)mh_sqrt(information.yy / determinant), (double)mh_sqrt(information.xx / determinant));
    return 0;
}
