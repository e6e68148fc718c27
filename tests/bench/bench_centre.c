/* A round of the fusion centre: the summaries of four clusters taken, joined by covariance intersection with weights by the traces, and the answer to their heads. */
#include "bench.h"
#include "motehound/fusion_centre.h"

#include <string.h>

enum { CLUSTERS = 4, INTERVAL = 500 };

struct mh_fusion_centre bench_state;
static uint8_t told[CLUSTERS][MH_SUMMARY_BYTES_MAX], answer[MH_SUMMARY_BYTES_MAX];
static size_t lengths[CLUSTERS], answered;
static struct mh_estimate estimate;
static mh_tick now;
static enum mh_status status;

void bench_setup(void)
{
    struct mh_fusion_centre_config config;
    mh_fusion_centre_config_default(&config);
    config.clusters = CLUSTERS;
    mh_centre_fusion.init(&bench_state, &config);
}

void bench_prepare(unsigned step)
{
    now = (mh_tick)(step + 1) * INTERVAL;
    for (int c = 0; c < CLUSTERS; c++) {
        struct mh_summary summary;
        memset(&summary, 0, sizeof summary);
        summary.kind = MH_SUMMARY_PLAIN;
        summary.of.plain.n = MH_SUMMARY_STATES;
        for (int i = 0; i < MH_SUMMARY_STATES; i++) {
            summary.of.plain.x[i] = 10 + 0.1f * (mh_real)(c + i) + 0.4f * (mh_real)step;
            for (int j = 0; j <= i; j++) {
                summary.of.plain.P[MH_PACKED(j, i)] = i == j ? 0.1f * (mh_real)(c + 1) : 0.02f;
            }
        }
        lengths[c] = mh_summary_write(&summary, told[c]);
    }
}

void bench_step(void)
{
    for (uint8_t c = 0; c < CLUSTERS; c++) {
        (void)mh_centre_fusion.take(&bench_state, c, now, told[c], lengths[c]);
    }
    status = mh_centre_fusion.fuse(&bench_state, now, &estimate);
    (void)mh_centre_fusion.feedback(&bench_state, answer, &answered);
}

bool bench_worked(void) { return status == MH_OK && estimate.measurements == CLUSTERS; }
