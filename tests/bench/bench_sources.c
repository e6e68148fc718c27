/* Several sources of sound near one another: two found at once by what nine nodes hear (BENCH_JOINT_SOURCES), as many counted as there are (BENCH_SOURCE_COUNT), and the share of one of three in what one
 * node hears (BENCH_SOUND_SHARE). */
#include "bench.h"
#include "motehound/random.h"

#if defined(BENCH_SOUND_SHARE)
#include "motehound/decomposition.h"
enum { SOURCES = 3 };
mh_real bench_state;
#elif defined(BENCH_JOINT_SOURCES)
#include "motehound/joint_sources.h"
enum { SOURCES = 2 };
struct mh_source_fix bench_state[SOURCES];
#else
#include "motehound/source_count.h"
enum { SOURCES = 2 };
struct mh_vec2 bench_state[SOURCES];
#endif

static const struct mh_vec2 truth[3] = {
    {MH_REAL(-12.0f), MH_REAL(5.0f)}, {MH_REAL(12.0f), MH_REAL(-5.0f)}, {MH_REAL(5.0f), MH_REAL(30.0f)}};
static struct mh_random numbers;

void bench_setup(void) { mh_random_init(&numbers, 1); }

#ifdef BENCH_SOUND_SHARE

static struct mh_vec2 node;

void bench_prepare(unsigned step)
{
    (void)step;
    node.x = 40 * mh_random_unit(&numbers) - MH_REAL(20.0f);
    node.y = 40 * mh_random_unit(&numbers) - MH_REAL(20.0f);
}

void bench_step(void) { bench_state = mh_sound_share(truth, SOURCES, 0, node, MH_REAL(120.0f)); }

bool bench_worked(void) { return bench_state > 0 && bench_state < MH_REAL(1.0f); }

#else

enum { SIDE = 3, NODES = SIDE * SIDE };

static const struct mh_sound sound = {1600, 0.19f, 0.05f};
static struct mh_heard nodes[NODES];
static enum mh_status status;

/* One node in each square of 30 m, the strongest first. */
void bench_prepare(unsigned step)
{
    size_t count = 0;
    (void)step;
    for (int i = 0; i < NODES; i++) {
        struct mh_heard heard = {{30 * ((mh_real)(i % SIDE) + mh_random_unit(&numbers) - 0.5f * SIDE),
                                  30 * ((mh_real)(i / SIDE) + mh_random_unit(&numbers) - 0.5f * SIDE)},
                                 0};
        for (int k = 0; k < SOURCES; k++) {
            heard.energy += mh_sound_energy(&sound, mh_squared(heard.place.x - truth[k].x) +
                                                        mh_squared(heard.place.y - truth[k].y));
        }
        heard.energy *= 1 + 0.3f * (2 * mh_random_unit(&numbers) - 1);
        mh_heard_insert(nodes, &count, NODES, &heard);
    }
}

#ifdef BENCH_JOINT_SOURCES

void bench_step(void)
{
    static const struct mh_source expected[SOURCES] = {{{-9, 5}, {25, 0, 25}, 0}, {{12, -8}, {25, 0, 25}, 0}};
    status = mh_joint_sources(&sound, nodes, NODES, expected, NULL, SOURCES, bench_state);
}

bool bench_worked(void) { return status == MH_OK; }

#else

static uint8_t found;

void bench_step(void) { status = mh_source_count(&sound, nodes, NODES, SOURCES, bench_state, &found); }

bool bench_worked(void) { return status == MH_OK; }

#endif
#endif
