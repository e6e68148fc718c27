/* A step of the acoustic tracker with six nodes (BENCH_ACOUSTIC_ONE), and of one of two targets 30 m apart, with what nine nodes hear of both (BENCH_ACOUSTIC_TWO); of `dm` with the three
 * of six that are strongest (BENCH_ACOUSTIC_DM), and where no more than three are heard (BENCH_ACOUSTIC_DM_THREE); of `ml` with all six (BENCH_ACOUSTIC_ML). The nodes stand on a grid of 30 m. */
#include "bench.h"
#include "motehound/acoustic.h"
#include "motehound/random.h"

#include <string.h>

enum { INTERVAL = 2000 };

#ifdef BENCH_ACOUSTIC_TWO
enum { NODES = 9, TARGETS = 2 };
#elif defined BENCH_ACOUSTIC_DM_THREE
enum { NODES = 3, TARGETS = 1 };
#else
enum { NODES = 6, TARGETS = 1 };
#endif
#if defined BENCH_ACOUSTIC_DM || defined BENCH_ACOUSTIC_DM_THREE
#define MEASURES_DISTANCES 1
#define TRACKER mh_tracker_dm
#elif defined BENCH_ACOUSTIC_ML
#define TRACKER mh_tracker_ml
#else
#define TRACKER mh_tracker_acoustic
#endif

struct mh_acoustic bench_state;
static struct mh_measurement measurements[NODES];
static struct mh_estimate estimate;
static struct mh_random numbers;
static uint8_t other[MH_ACOUSTIC_HEADER_BYTES + MH_GROUP_BYTES(1)];
static size_t other_length;
static mh_tick now;
static enum mh_status status;

static struct mh_place place_of(unsigned step, int target)
{
    const struct mh_place place = {(int32_t)(60000 + 10000 * (int32_t)(step % 32)), 95000 + (int32_t)30000 * target, 0};
    return place;
}

static void begin(unsigned step, int target)
{
    struct mh_acoustic_config config;
    mh_acoustic_config_default(&config, MH_REAL(40.0f));
#if defined MEASURES_DISTANCES || defined BENCH_ACOUSTIC_ML
    config.separation = MH_SEPARATION_NONE;
#endif
    const struct mh_place place = place_of(step, target);
    const struct mh_vec2 velocity = {MH_REAL(5.0f), 0};
    (void)TRACKER.init(&bench_state, &config, INTERVAL);
    (void)mh_acoustic_begin(&bench_state, (uint32_t)target, now - INTERVAL, &place, velocity, MH_REAL(2.0f),
                            MH_REAL(1.0f));
}

void bench_setup(void) { mh_random_init(&numbers, 1); }

static mh_real energy_at(const struct mh_place *node, unsigned step)
{
    mh_real energy = 0;
    for (int k = 0; k < TARGETS; k++) {
        const struct mh_place target = place_of(step, k);
        const struct mh_vec2 away = mh_place_relative(node, &target);
        energy =
            mh_add(energy, mh_div(MH_REAL(1600.0f), mh_max(mh_squared(away.x) + mh_squared(away.y), MH_REAL(1.0f))));
    }
    return mh_mul(energy, MH_REAL(1.0f) + mh_mul(MH_REAL(0.3f), 2 * mh_random_unit(&numbers) - MH_REAL(1.0f)));
}

/* The nodes of the three columns, and of the rows, about the targets. */
void bench_prepare(unsigned step)
{
    const struct mh_place target = place_of(step + 1, 0);
    now += INTERVAL;
    begin(step, 1);
    (void)TRACKER.save(&bench_state, other, &other_length);
    begin(step, 0);
    for (int i = 0; i < NODES; i++) {
        struct mh_measurement *m = &measurements[i];
        memset(m, 0, sizeof *m);
        const int at = NODES == 3 ? 2 * i : i; /* a triangle */
        m->node = (mh_node_id)i;
        m->place.x_mm = 30000 * ((target.x_mm + 15000) / 30000 - 1 + at % 3);
        m->place.y_mm = 80000 + (int32_t)30000 * (at / 3);
        m->time = now;
        m->value = mh_q20_from_real(mh_max(energy_at(&m->place, step + 1), MH_REAL(1.0f)));
    }
    if (TARGETS > 1) {
        const struct mh_saved_track beside = {1, other, other_length};
        (void)TRACKER.among(&bench_state, 0, &beside, 1);
    }
}

void bench_step(void) { status = TRACKER.step(&bench_state, now, measurements, NODES, &estimate); }

bool bench_worked(void)
{
    return status == MH_OK && estimate.measurements == NODES && !(estimate.flags & MH_ESTIMATE_COASTED);
}
