#include "motehound/least_squares.h"
#include "motehound/puff.h"
#include "motehound/sage_husa.h"
#include "self_test_parts.h"

#include <stddef.h>

/* 100 g, a second old, D = 1 m2/s, seen from 1 m: 100 / (4 pi) e^(-1/4) */
static bool knows_puff(void)
{
    const struct mh_puff puff = {{0, 0}, MH_REAL(1.0f), MH_REAL(100.0f)};
    const struct mh_vec2 point = {MH_REAL(1.0f), 0};
    return near(mh_puff_concentration(&puff, MH_REAL(1.0f), point, NULL), MH_REAL(6.1974996f));
}

/* x = 2, y = 3, x + y = 6: least squares (7/3, 10/3) */
static bool knows_least_squares(void)
{
    FLASH mh_real rows[3][3] = {{MH_REAL(1.0f), 0, MH_REAL(2.0f)},
                                {0, MH_REAL(1.0f), MH_REAL(3.0f)},
                                {MH_REAL(1.0f), MH_REAL(1.0f), MH_REAL(6.0f)}};
    struct mh_least_squares problem;
    mh_real z[2];
    enum mh_bound bound;
    mh_least_squares_begin(&problem, 2);
    for (uint8_t i = 0; i < 3; i++) {
        mh_real row[3];
        flash_read(row, rows[i], sizeof row);
        if (mh_least_squares_add(&problem, row, row[2]) != MH_OK) {
            return false;
        }
    }
    return mh_least_squares_solve(&problem, 0, MH_REAL(10.0f), z, &bound) == MH_OK && near(z[0], MH_REAL(2.3333333f)) &&
           near(z[1], MH_REAL(3.3333333f));
}

/* Sage-Husa, worked out in double precision */
static bool knows_filter(void)
{
    struct mh_sage_husa_config config;
    struct mh_sage_husa filter;
    mh_sage_husa_config_default(&config);
    return mh_sage_husa_init(&filter, &config, MH_REAL(2.0f)) == MH_OK &&
           mh_sage_husa_step(&filter, &config, MH_REAL(5.0f), MH_REAL(1.5f), MH_SHARE(0.1f)) == MH_OK &&
           mh_sage_husa_step(&filter, &config, MH_REAL(3.0f), MH_REAL(-0.5f), MH_SHARE(0.2f)) == MH_OK &&
           near(filter.estimate, MH_REAL(3.4722136f)) && near(filter.estimate_variance, MH_REAL(2.6602433f)) &&
           near(filter.measurement_variance, MH_REAL(5.5782501f));
}

bool self_test_luo(void) { return self_test_node() && knows_puff() && knows_least_squares() && knows_filter(); }
