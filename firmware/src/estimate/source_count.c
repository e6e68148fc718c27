#include "motehound/source_count.h"

#include "motehound/real.h"

#define SIDE MH_COUNT_SIDE
#define CELLS (SIDE * SIDE)
#define CELL_M (MH_COUNT_AREA_M / (mh_real)SIDE)
#define UPDATES 10
#define NEAREST_SQUARE 25.0f /* m2: a source in a cell is hardly ever nearer to a node */
#define CLEARANCE 0.8f
#define HEARD 1.0f /* energy of a node that takes part */
#define LOUD 16.0f
#define SHARE 0.7f

/* The nodes, the grid and the intensity on it. */
struct intensity {
    const struct mh_sound *sound;
    const struct mh_heard *nodes;
    uint8_t count;
    struct mh_vec2 corner; /* middle of the first cell */
    mh_real cells[CELLS];  /* row by row */
};

static struct mh_vec2 cell_place(const struct intensity *intensity, int cell)
{
    const int column = cell % SIDE, row = cell / SIDE;
    return (struct mh_vec2){intensity->corner.x + (mh_real)column * CELL_M,
                            intensity->corner.y + (mh_real)row * CELL_M};
}

static mh_real distance_square(struct mh_vec2 a, struct mh_vec2 b)
{
    return mh_squared(a.x - b.x) + mh_squared(a.y - b.y);
}

/* The grid about the nodes that hear something. */
static enum mh_status place_grid(struct intensity *intensity)
{
    struct mh_vec2 sum = {0, 0};
    mh_real weights = 0;
    for (uint8_t i = 0; i < intensity->count; i++) {
        const struct mh_heard *node = &intensity->nodes[i];
        if (!mh_finite(node->energy) || !(mh_abs(node->place.x) <= 1e6f && mh_abs(node->place.y) <= 1e6f)) {
            return MH_ERR_NOT_FINITE;
        }
        const mh_real weight = node->energy < HEARD ? 0.0f : mh_min(node->energy, LOUD);
        sum.x += weight * node->place.x;
        sum.y += weight * node->place.y;
        weights += weight;
    }
    if (!(weights > 0)) {
        return MH_ERR_TOO_FEW;
    }
    intensity->corner = (struct mh_vec2){sum.x / weights - 0.5f * (MH_COUNT_AREA_M - CELL_M),
                                         sum.y / weights - 0.5f * (MH_COUNT_AREA_M - CELL_M)};
    return MH_OK;
}

/* How many of the nodes that hear something are within R of a place; -1 where no source can be. */
static int hearers(const struct intensity *intensity, struct mh_vec2 place)
{
    int near = 0;
    for (uint8_t i = 0; i < intensity->count; i++) {
        const mh_real square = distance_square(place, intensity->nodes[i].place), energy = intensity->nodes[i].energy;
        if (square < CLEARANCE * CLEARANCE * intensity->sound->loudness_m2 / mh_max(energy, HEARD)) {
            return -1;
        }
        near += energy >= HEARD && square <= intensity->sound->loudness_m2;
    }
    return near;
}

/* Cells where a source can be have the same intensity, one source in all; the others none. */
static enum mh_status begin(struct intensity *intensity)
{
    int most = 0, open = 0;
    for (int g = 0; g < CELLS; g++) {
        const int near = hearers(intensity, cell_place(intensity, g));
        intensity->cells[g] = (mh_real)near;
        most = near > most ? near : most;
    }
    if (most == 0) {
        return MH_ERR_SINGULAR;
    }
    for (int g = 0; g < CELLS; g++) {
        open += intensity->cells[g] >= SHARE * (mh_real)most;
    }
    for (int g = 0; g < CELLS; g++) {
        intensity->cells[g] = intensity->cells[g] >= SHARE * (mh_real)most ? 1.0f / (mh_real)open : 0.0f;
    }
    return MH_OK;
}

/* Energy of a source at `place` at node i; 0 where that hears nothing. */
static mh_real gain(const struct intensity *intensity, struct mh_vec2 place, uint8_t i)
{
    if (intensity->nodes[i].energy < HEARD) {
        return 0.0f;
    }
    return mh_sound_energy(intensity->sound, mh_max(NEAREST_SQUARE, distance_square(place, intensity->nodes[i].place)));
}

/* x_g <- x_g sum_i(a_ig / e_i) / sum_i(a_ig / y_i) for all cells from the same e. */
static void update(struct intensity *intensity)
{
    mh_real energy[MH_COUNT_NODES_MAX] = {0};
    for (int g = 0; g < CELLS; g++) {
        const struct mh_vec2 place = cell_place(intensity, g);
        for (uint8_t i = 0; i < intensity->count && intensity->cells[g] > 0; i++) {
            energy[i] += gain(intensity, place, i) * intensity->cells[g];
        }
    }
    for (int g = 0; g < CELLS; g++) {
        if (!(intensity->cells[g] > 0)) {
            continue;
        }
        const struct mh_vec2 place = cell_place(intensity, g);
        mh_real over_energy = 0, over_measured = 0;
        for (uint8_t i = 0; i < intensity->count; i++) {
            const mh_real a = gain(intensity, place, i);
            over_energy += a / mh_max(energy[i], MH_REAL_MIN);
            over_measured += a / mh_max(intensity->nodes[i].energy, HEARD);
        }
        intensity->cells[g] *= over_energy / over_measured;
    }
}

static mh_real total(const struct intensity *intensity)
{
    mh_real sum = 0;
    for (int g = 0; g < CELLS; g++) {
        sum += intensity->cells[g];
    }
    return sum;
}

/* The cell that has most intensity in itself and the eight around it. */
static int peak(const struct intensity *intensity)
{
    int best = 0;
    mh_real most = -1.0f;
    for (int g = 0; g < CELLS; g++) {
        mh_real sum = 0;
        for (int dy = -1; dy <= 1; dy++) {
            for (int dx = -1; dx <= 1; dx++) {
                const int column = g % SIDE + dx, row = g / SIDE + dy;
                if (column >= 0 && column < SIDE && row >= 0 && row < SIDE) {
                    sum += intensity->cells[row * SIDE + column];
                }
            }
        }
        if (sum > most) {
            most = sum;
            best = g;
        }
    }
    return best;
}

/* The intensity of `share` sources nearest to the cell is taken away -> its mean place. */
static struct mh_vec2 remove_source(struct intensity *intensity, int from, mh_real share)
{
    struct mh_vec2 sum = {0, 0};
    mh_real taken = 0;
    for (int ring = 0; ring < 2 * SIDE && taken < share; ring++) {
        for (int g = 0; g < CELLS && taken < share; g++) {
            const int dx = g % SIDE - from % SIDE, dy = g / SIDE - from / SIDE;
            const int square = dx * dx + dy * dy;
            if (square < ring * ring || square >= (ring + 1) * (ring + 1)) {
                continue;
            }
            const mh_real part = mh_min(intensity->cells[g], share - taken);
            const struct mh_vec2 place = cell_place(intensity, g);
            sum.x += part * place.x;
            sum.y += part * place.y;
            taken += part;
            intensity->cells[g] -= part;
        }
    }
    if (!(taken > 0)) {
        return cell_place(intensity, from);
    }
    return (struct mh_vec2){sum.x / taken, sum.y / taken};
}

enum mh_status mh_source_count(const struct mh_sound *sound, const struct mh_heard *heard, size_t count, uint8_t most,
                               struct mh_vec2 *places, uint8_t *sources)
{
    if (!mh_sound_valid(sound) || most < 1 || most > MH_SOURCES_MAX) {
        return MH_ERR_ARGUMENT;
    }
    struct intensity intensity = {
        .sound = sound, .nodes = heard, .count = (uint8_t)(count < MH_COUNT_NODES_MAX ? count : MH_COUNT_NODES_MAX)};
    enum mh_status status = place_grid(&intensity);
    if (status == MH_OK) {
        status = begin(&intensity);
    }
    if (status != MH_OK) {
        return status;
    }
    for (uint8_t k = 0; k < UPDATES; k++) {
        update(&intensity);
    }
    const mh_real sum = total(&intensity);
    const uint8_t found = (uint8_t)mh_clamp(sum + 0.5f, 1.0f, (mh_real)most);
    for (uint8_t k = 0; k < found; k++) {
        places[k] = remove_source(&intensity, peak(&intensity), sum / (mh_real)found);
        /* Sources at one place would stay there in any fit. */
        for (uint8_t j = 0; j < k; j++) {
            if (distance_square(places[k], places[j]) < mh_squared(0.25f * CELL_M)) {
                places[k].x += 0.5f * CELL_M;
            }
        }
    }
    *sources = found;
    return MH_OK;
}
