/* One coordinate's step of the Sage-Husa filter. */
#include "bench.h"
#include "motehound/sage_husa.h"

struct mh_sage_husa bench_state;
static struct mh_sage_husa_config config;
static mh_real measurement;
static mh_share weight;
static enum mh_status status;

void bench_setup(void)
{
    mh_sage_husa_config_default(&config);
    mh_sage_husa_init(&bench_state, &config, MH_REAL(10.0f));
}

void bench_prepare(unsigned step)
{
    measurement = MH_REAL(10.0f) + mh_real_from_int((int32_t)step) + mh_real_from_ratio((int32_t)(step * 7 % 5) - 2, 3);
    weight = mh_sage_husa_weight(MH_REAL(0.97f), step + 2);
}

void bench_step(void) { status = mh_sage_husa_step(&bench_state, &config, measurement, MH_REAL(1.0f), weight); }

bool bench_worked(void) { return status == MH_OK; }
