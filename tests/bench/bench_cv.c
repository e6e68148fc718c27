/* One step of the tracker `cv_ukf` with four ranges of one instant; of `cv_ekf` with BENCH_CV_EKF; with BENCH_CV_LATE two of them come a step late, so that every instant is filtered twice. Ranges older than
 * 2 s are settled. */
#include "bench.h"
#include "motehound/cv.h"

#include <string.h>

#ifdef BENCH_CV_EKF
#define TRACKER mh_tracker_cv_ekf
#else
#define TRACKER mh_tracker_cv_ukf
#endif

enum { TICK = 500, ANCHORS = 4 };

static const struct mh_place anchors[ANCHORS] = {{0, 0, 0}, {40000, 0, 0}, {0, 40000, 0}, {40000, 40000, 0}};
static struct mh_cv bench_state;
static struct mh_measurement set[ANCHORS];
static struct mh_estimate estimate;
static mh_tick now;
static uint32_t expected;

void bench_setup(void)
{
    struct mh_cv_config config;
    mh_cv_config_default(&config);
    (void)TRACKER.init(&bench_state, &config, TICK);
}

static void measure(unsigned anchor, unsigned tick)
{
    const mh_real east_m = 10.5f + 0.4f * (mh_real)(tick % 60), north_m = 19.7f + 0.3f * (mh_real)(tick % 60);
    const mh_real dx = east_m - (mh_real)anchors[anchor].x_mm * 0.001f;
    const mh_real dy = north_m - (mh_real)anchors[anchor].y_mm * 0.001f;
    set[anchor].node = anchor;
    set[anchor].place = anchors[anchor];
    set[anchor].time = tick * TICK;
    set[anchor].value = mh_q20_from_real(mh_sqrt(dx * dx + dy * dy) + 0.05f * (mh_real)(anchor % 3) - 0.05f);
}

void bench_prepare(unsigned step)
{
#ifdef BENCH_CV_LATE
    const unsigned late = 1;
#else
    const unsigned late = 0;
#endif
    now = (step + 2) * TICK;
    for (unsigned anchor = 0; anchor < ANCHORS; anchor++) {
        measure(anchor, step + 2 - (anchor < 2 ? late : 0));
    }
    expected = bench_state.counters.taken + ANCHORS;
}

void bench_step(void) { (void)TRACKER.step(&bench_state, now, set, ANCHORS, &estimate); }

bool bench_worked(void) { return bench_state.counters.taken == expected && bench_state.counters.failed == 0; }
