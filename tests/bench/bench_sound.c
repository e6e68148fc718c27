/* A target's place by its sound, from what nodes report: three nodes and a table of 40 intervals (BENCH_SOUND_THREE; _CASES: by Han's cases), the default localiser
 * with six (BENCH_SOUND_FIX), and maximum likelihood on a grid with six (BENCH_SOUND_GRID). */
#include "bench.h"
#include "motehound/random.h"
#include "motehound/sound_fix.h"

enum { NODES = 6 };

static const struct mh_sound sound = {MH_REAL(1600.0f), MH_REAL(0.19f), MH_REAL(0.05f)};
static const struct mh_place origin = {500000, 500000, 0};

struct mh_vec2 bench_state;
static struct mh_measurement measurements[NODES];
static struct mh_random numbers;
static enum mh_status status;

void bench_setup(void) { mh_random_init(&numbers, 1); }

/* a target within 10 m of the origin, nodes anywhere within 38 m of it */
void bench_prepare(unsigned step)
{
    (void)step;
    const struct mh_vec2 target = {20 * mh_random_unit(&numbers) - MH_REAL(10.0f),
                                   20 * mh_random_unit(&numbers) - MH_REAL(10.0f)};
    for (int i = 0; i < NODES; i++) {
        struct mh_vec2 offset;
        mh_real square;
        do {
            offset.x = 76 * mh_random_unit(&numbers) - MH_REAL(38.0f);
            offset.y = 76 * mh_random_unit(&numbers) - MH_REAL(38.0f);
            square = mh_squared(offset.x) + mh_squared(offset.y);
        } while (square > MH_REAL(1444.0f));
        const mh_real error =
            mh_mul(mh_mul(sound.source_sd, 2 * mh_random_unit(&numbers) - MH_REAL(1.0f)), MH_REAL(1.7f));
        const struct mh_vec2 place = mh_vec2_along(target, MH_REAL(1.0f), offset);
        const mh_real energy = mh_mul(MH_REAL(1.0f) + error, mh_sound_energy(&sound, square));
        const struct mh_measurement heard = {
            .node = (mh_node_id)i, .place = mh_place_from_offset(&origin, place), .value = mh_q20_from_real(energy)};
        measurements[i] = heard;
    }
    bench_state = target;
}

static bool near(const struct mh_vec2 *place, const struct mh_vec2 *target)
{
    return mh_abs(place->x - target->x) <= MH_REAL(60.0f) && mh_abs(place->y - target->y) <= MH_REAL(60.0f);
}

void bench_step(void)
{
    struct mh_heard heard[NODES];
    struct mh_vec2 place;
#if defined(BENCH_SOUND_THREE) || defined(BENCH_SOUND_CASES)
    static const struct mh_distance_table table = {MH_REAL(40.0f), 40, MH_DISTANCE_MIDDLE};
    const size_t count = mh_strongest(measurements, 3, &origin, heard, 3);
#endif
#if defined(BENCH_SOUND_THREE)
    status = mh_distance_fix(heard, count, &table, MH_CIRCLES_UNIFORM, &place);
#elif defined(BENCH_SOUND_CASES)
    status = mh_distance_fix(heard, count, &table, MH_CIRCLES_CASES, &place);
#elif defined(BENCH_SOUND_FIX)
    const size_t count = mh_strongest(measurements, NODES, &origin, heard, NODES);
    struct mh_sym2 information;
    status = mh_sound_fix(&sound, heard, count, NULL, &place, &information);
#else
    const size_t count = mh_strongest(measurements, NODES, &origin, heard, NODES);
    status = mh_likeliest(&sound, heard, count, MH_LIKELIHOOD_CONSTANT, &place);
#endif
    if (status == MH_OK && !near(&place, &bench_state)) {
        status = MH_NONE;
    }
}

bool bench_worked(void) { return status == MH_OK; }
