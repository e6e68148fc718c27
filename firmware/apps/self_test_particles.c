#include "self_test_parts.h"

/* A range of 5 m from the origin, standard deviation 5 m, and particles at (3, 4), (0, 1) and (6, 8): residuals 0, 4 and 5 m */
bool self_test_particles(struct mh_particles *set)
{
    static const struct mh_vec2 places[] = {
        {MH_REAL(3.0f), MH_REAL(4.0f)}, {0, MH_REAL(1.0f)}, {MH_REAL(6.0f), MH_REAL(8.0f)}};
    const struct mh_vec2 station = {0, 0};
    struct mh_vec2 mean;
    struct mh_sym2 covariance;
    set->count = 3;
    for (uint8_t i = 0; i < 3; i++) {
        set->x[i] = places[i].x;
        set->y[i] = places[i].y;
        set->weight[i] = 0;
    }
    mh_particles_add_range(set, 0, station, MH_REAL(5.0f));
    mh_particles_weigh(set, 0, mh_particles_least(set), MH_REAL(5.0f));
    return self_test_node() && mh_particles_mean(set, 0, &mean, &covariance) == MH_OK &&
           near(mean.x, MH_REAL(2.8461606f)) && near(mean.y, MH_REAL(4.1061613f));
}
