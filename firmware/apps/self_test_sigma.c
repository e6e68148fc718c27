#include "motehound/range_model.h"
#include "motehound/ukf.h"
#include "self_test_parts.h"

/* What is measured is the state itself. */
static enum mh_status itself(const void *context, uint16_t k, const mh_real *x, mh_real *z, mh_real *gradient)
{
    (void)context;
    (void)k;
    (void)gradient;
    *z = x[0];
    return MH_OK;
}

/* A mean of 0 with variance 4, and a measurement of 2 with as much: 1, with 2. */
bool self_test_sigma(void)
{
    static const struct mh_ukf_weights weights = {MH_REAL(1.0f), MH_REAL(2.0f), MH_REAL(0.0f)};
    static const mh_real two = MH_REAL(2.0f), four = MH_REAL(4.0f);
    static const struct mh_observations measured = {.count = 1, .z = &two, .variance = &four, .predict = itself};
    static const struct mh_vec2 target = {MH_REAL(3.0f), MH_REAL(4.0f)}, anchor = {0, 0};
    struct mh_gaussian state = {.n = 1};
    struct mh_vec2 gradient;
    mh_real distance;
    state.P[0] = four;
    return self_test_node() && mh_range_model(target, anchor, 0, &distance, &gradient) == MH_OK &&
           near(distance, MH_REAL(5.0f)) && mh_ukf_update_stacked(&state, &weights, &measured) == MH_OK &&
           near(state.x[0], MH_REAL(1.0f)) && near(state.P[0], two);
}
