#include "motehound/kalman.h"
#include "motehound/range_model.h"
#include "self_test_parts.h"

bool self_test_range(void)
{
    static const struct mh_vec2 target = {MH_REAL(3.0f), MH_REAL(4.0f)}, anchor = {0, 0};
    static const mh_real mean = 0, variance = MH_REAL(4.0f), one = MH_REAL(1.0f), two = MH_REAL(2.0f);
    struct mh_kalman filter;
    struct mh_vec2 gradient;
    mh_real distance;
    return self_test_node() && mh_range_model(target, anchor, 0, &distance, &gradient) == MH_OK &&
           near(distance, MH_REAL(5.0f)) && near(gradient.y, MH_REAL(0.8f)) &&
           mh_kalman_init(&filter, 1, &mean, &variance) == MH_OK &&
           mh_kalman_update(&filter, &one, two, variance, 0) == MH_OK && near(filter.x[0], one) &&
           mh_kalman_predict(&filter, &two, &one) == MH_OK && near(filter.x[0], two) &&
           near(mh_kalman_variance(&filter, 0), MH_REAL(9.0f));
}
