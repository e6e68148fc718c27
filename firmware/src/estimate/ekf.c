#include "motehound/ekf.h"

#include <string.h>

enum mh_status mh_ekf_predict(struct mh_gaussian *gaussian, const struct mh_transition *transition, const mh_real *Q)
{
    struct mh_gaussian next = *gaussian;
    mh_real moved[MH_STATES_MAX], F[MH_STATES_MAX * MH_STATES_MAX];
    enum mh_status status = mh_gaussian_check(gaussian);
    if (status == MH_OK) {
        status = transition->move(transition->context, gaussian->x, moved, F);
    }
    if (status != MH_OK) {
        return status;
    }
    memset(next.x, 0, next.n * sizeof next.x[0]); /* only the covariance is moved by F */
    status = mh_gaussian_predict(&next, F, Q);
    for (uint_fast8_t i = 0; i < next.n && status == MH_OK; i++) {
        next.x[i] = moved[i];
        status = mh_finite(moved[i]) ? MH_OK : MH_ERR_NOT_FINITE;
    }
    if (status == MH_OK) {
        *gaussian = next;
    }
    return status;
}

/* With every model evaluated at `at`: the estimate as it was, or as it has become. */
static enum mh_status update(struct mh_gaussian *gaussian, struct mh_gaussian_root *root, const mh_real *at,
                             const struct mh_observations *observations)
{
    for (uint16_t k = 0; k < observations->count; k++) {
        mh_real h[MH_STATES_MAX], c[MH_STATES_MAX], z;
        const enum mh_status status = observations->predict(observations->context, k, at, &z, h);
        if (status != MH_OK) {
            return status;
        }
        if (!(observations->variance[k] >= MH_REAL_MIN)) {
            return MH_ERR_ARGUMENT;
        }
        mh_real innovation = observations->z[k] - z;
        if (observations->wrap) {
            innovation = observations->wrap(observations->context, k, innovation);
        }
        for (uint_fast8_t i = 0; i < root->n; i++) {
            innovation -= h[i] * (root->x[i] - at[i]);
        }
        if (!mh_finite(innovation)) {
            return MH_ERR_NOT_FINITE;
        }
        mh_gaussian_root_gradient(root, h, c);
        mh_gaussian_root_take(root, c, innovation, observations->variance[k]);
    }
    return mh_gaussian_compose(gaussian, root);
}

enum mh_status mh_ekf_update(struct mh_gaussian *gaussian, const struct mh_observations *observations)
{
    struct mh_gaussian_root root;
    const enum mh_status status = mh_gaussian_factor(&root, gaussian);
    return status == MH_OK ? update(gaussian, &root, root.x, observations) : status;
}

enum mh_status mh_ekf_update_stacked(struct mh_gaussian *gaussian, const struct mh_observations *observations)
{
    struct mh_gaussian_root root;
    const enum mh_status status = mh_gaussian_factor(&root, gaussian);
    return status == MH_OK ? update(gaussian, &root, gaussian->x, observations) : status;
}
