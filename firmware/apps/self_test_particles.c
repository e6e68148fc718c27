#include "self_test_parts.h"

/* A range of 5 m from the origin, standard deviation 5 m, and particles at (3, 4), (0, 1) and (6, 8): residuals 0, 4 and 5 m */
bool self_test_particles(struct mh_particles *set)
{
    FLASH struct mh_sector places[] = {
        {.axis = {MH_REAL(0.6f), MH_REAL(0.8f)}, .inner = MH_REAL(5.0f), .outer = MH_REAL(5.0f)},
        {.axis = {0, MH_REAL(1.0f)}, .inner = MH_REAL(1.0f), .outer = MH_REAL(1.0f)},
        {.axis = {MH_REAL(0.6f), MH_REAL(0.8f)}, .inner = MH_REAL(10.0f), .outer = MH_REAL(10.0f)}};
    const struct mh_vec2 station = {0, 0};
    const mh_real range = MH_REAL(5.0f);
    struct mh_random random;
    struct mh_vec2 mean;
    struct mh_sym2 covariance;
    mh_random_init(&random, 1);
    bool passed = self_test_node() && mh_particles_init(set, 3, MH_REAL(50.0f), range) == MH_OK;
    for (uint8_t i = 0; i < 3; i++) {
        struct mh_sector place;
        flash_read(&place, &places[i], sizeof place);
        mh_particles_draw(set, i, &place, &random);
    }
    mh_particles_add_range(set, 0, station, range, MH_PARTICLE_SUM_MAX);
    mh_particles_weigh(set, 0, mh_particles_least(set), range);
    passed = passed && mh_particles_mean(set, 0, &mean, &covariance) == MH_OK;
    return passed && near(mean.x, MH_REAL(2.8461606f)) && near(mean.y, MH_REAL(4.1061613f));
}
