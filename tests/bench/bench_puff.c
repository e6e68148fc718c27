/* The puff behind 20 concentrations of one instant: the linear fit, which is least squares with a bound (BENCH_PUFF_LINEAR), and the nonlinear one begun at its answer (BENCH_PUFF_NONLINEAR). */
#include "bench.h"
#include "motehound/puff_fit.h"

#include <stddef.h>

enum { SAMPLES = 20, COLUMNS = 5 };

static const mh_real diffusion = MH_REAL(1.0f), age_max = MH_REAL(30.0f);
static struct mh_puff_sample samples[SAMPLES];
static enum mh_status status;

#ifdef BENCH_PUFF_LINEAR
struct mh_puff_linear bench_state;
#else
struct mh_puff_nonlinear bench_state;
#endif
static struct mh_puff_answer answer;
static struct mh_puff truth;
static int reference;

void bench_setup(void) {}

void bench_prepare(unsigned step)
{
    const struct mh_puff puff = {{mh_real_from_ratio((int32_t)step, 16), MH_REAL(0.3f)}, MH_REAL(4.0f), MH_REAL(40.0f)};
    truth = puff;
    reference = 0;
    for (int i = 0; i < SAMPLES; i++) {
        samples[i].position.x = mh_real_from_int(i % COLUMNS - 2);
        samples[i].position.y = mh_real_from_int(i / COLUMNS - 2);
        const mh_real c = mh_puff_concentration(&truth, diffusion, samples[i].position, NULL);
        const mh_real error = mh_mul(c, mh_real_from_ratio(i % 3 - 1, 50));
        samples[i].concentration = mh_concentration_of(mh_q20_from_real(c + error));
        reference = samples[i].concentration > samples[reference].concentration ? i : reference;
    }
}

void bench_step(void)
{
#ifdef BENCH_PUFF_LINEAR
    status = mh_puff_linear_begin(&bench_state, diffusion, &samples[reference]);
    for (int i = 0; i < SAMPLES; i++) {
        mh_puff_linear_add(&bench_state, &samples[i]);
    }
    status = mh_puff_linear_solve(&bench_state, age_max, &answer);
#else
    mh_puff_nonlinear_begin(&bench_state, diffusion, &samples[reference], samples[reference].position, 3, age_max);
    do {
        for (int i = 0; i < SAMPLES; i++) {
            mh_puff_nonlinear_add(&bench_state, &samples[i]);
        }
        status = mh_puff_nonlinear_advance(&bench_state, &answer);
    } while (status == MH_NONE);
#endif
}

bool bench_worked(void)
{
    return status == MH_OK && mh_abs(answer.puff.position.x - truth.position.x) < MH_REAL(0.5f) &&
           mh_abs(answer.puff.age - truth.age) < MH_REAL(2.0f);
}
