#include "motehound/puff_fit.h"

static enum mh_status check(const struct mh_puff_sample *sample)
{
    if (!mh_finite(sample->position.x) || !mh_finite(sample->position.y) || !mh_finite(sample->concentration)) {
        return MH_ERR_NOT_FINITE;
    }
    return sample->concentration > 0 ? MH_OK : MH_ERR_RANGE;
}

enum mh_status mh_puff_linear_begin(struct mh_puff_linear *fit, mh_real diffusion,
                                    const struct mh_puff_sample *reference)
{
    const enum mh_status status = check(reference);
    if (status != MH_OK) {
        return status;
    }
    if (!mh_finite(diffusion)) {
        return MH_ERR_NOT_FINITE;
    }
    if (!(diffusion > 0)) {
        return MH_ERR_RANGE;
    }
    fit->diffusion = diffusion;
    fit->reference = *reference;
    mh_least_squares_begin(&fit->equations, 3);
    return MH_OK;
}

/* Eq. (A2) of the sample minus that of the reference, with the position relative to the reference and the age s = t - tau for unknowns:
 * 2 dx e + 2 dy n + 4 D ln(c_Q / c_k) s = dx^2 + dy^2. */
enum mh_status mh_puff_linear_add(struct mh_puff_linear *fit, const struct mh_puff_sample *sample)
{
    const enum mh_status status = check(sample);
    if (status != MH_OK) {
        return status;
    }
    const mh_real dx = sample->position.x - fit->reference.position.x;
    const mh_real dy = sample->position.y - fit->reference.position.y;
    const mh_real logarithm = mh_log(fit->reference.concentration / sample->concentration);
    const mh_real row[3] = {2.0f * dx, 2.0f * dy, 4.0f * fit->diffusion * logarithm};
    return mh_least_squares_add(&fit->equations, row, dx * dx + dy * dy);
}

enum mh_status mh_puff_linear_solve(const struct mh_puff_linear *fit, mh_real age_max, struct mh_puff_answer *answer)
{
    if (fit->equations.rows < MH_PUFF_SAMPLES_MIN) {
        return MH_ERR_TOO_FEW;
    }
    mh_real z[3];
    enum mh_bound bound;
    const enum mh_status status = mh_least_squares_solve(&fit->equations, 0, age_max, z, &bound);
    if (status != MH_OK) {
        return status;
    }
    /* (A2) of the reference itself */
    const mh_real spread = 4.0f * fit->diffusion * z[2];
    const mh_real exponent = spread > 0 ? (z[0] * z[0] + z[1] * z[1]) / spread : 0;
    const mh_real mass = fit->reference.concentration * MH_PI * spread * mh_exp(mh_min(exponent, 60.0f));
    const struct mh_puff_answer solved = {
        {{fit->reference.position.x + z[0], fit->reference.position.y + z[1]}, z[2], mass}, bound};
    *answer = solved;
    return MH_OK;
}
