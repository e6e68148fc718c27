#include "motehound/summary.h"

#include "motehound/bytes.h"

#include <string.h>

enum { N = MH_SUMMARY_STATES, PACKED = MH_PACKED_SIZE(N) };

enum {
    PLAIN_BYTES = 1 + MH_GAUSSIAN_BYTES(N),
    SPLIT_BYTES = PLAIN_BYTES + 4 * PACKED,
    INCREMENT_BYTES = PLAIN_BYTES + 4,
    FUSED_BYTES = PLAIN_BYTES + 2
};

#if MH_SUMMARY_BYTES_MAX < 97
#error "MH_SUMMARY_BYTES_MAX must have room for a split summary"
#endif

static void put(uint8_t **at, const mh_real *values, uint_fast8_t count)
{
    for (uint_fast8_t i = 0; i < count; i++) {
        mh_put_real(at, values[i]);
    }
}

/* Returns whether all are finite. */
static bool get(const uint8_t **at, mh_real *values, uint_fast8_t count)
{
    bool finite = true;
    for (uint_fast8_t i = 0; i < count; i++) {
        values[i] = mh_get_real(at);
        finite = finite && mh_finite(values[i]);
    }
    return finite;
}

bool mh_summary_sane(const struct mh_gaussian *state)
{
    bool sane = true;
    for (int i = 0; i < N; i++) {
        const mh_real most = i % 2 == 0 ? MH_SUMMARY_FARTHEST_M : MH_SUMMARY_FASTEST_MPS;
        sane = sane && mh_within(state->x[i], -most, most) && state->P[MH_PACKED(i, i)] <= mh_squared(most);
    }
    return sane;
}

static bool read_gaussian(struct mh_gaussian *gaussian, const uint8_t *at)
{
    return mh_gaussian_read(gaussian, N, at) == MH_OK && mh_summary_sane(gaussian);
}

size_t mh_summary_write(const struct mh_summary *summary, uint8_t *bytes)
{
    uint8_t *at = bytes;
    *at++ = (uint8_t)summary->kind;
    switch (summary->kind) {
    case MH_SUMMARY_SPLIT:
        at += mh_gaussian_write(&summary->of.split.dependent, at);
        put(&at, summary->of.split.independent, PACKED);
        break;
    case MH_SUMMARY_INCREMENT:
        put(&at, summary->of.increment.vector, N);
        put(&at, summary->of.increment.matrix, PACKED);
        mh_put_u32(&at, summary->since);
        break;
    case MH_SUMMARY_PLAIN:
    case MH_SUMMARY_FUSED:
        at += mh_gaussian_write(&summary->of.plain, at);
        if (summary->kind == MH_SUMMARY_FUSED) {
            mh_put_u16(&at, summary->clusters);
        }
        break;
    }
    return (size_t)(at - bytes);
}

/* Both parts of a sane covariance are. */
static bool read_split(struct mh_split_gaussian *split, const uint8_t *at)
{
    split->dependent.n = N;
    if (!get(&at, split->dependent.x, N) || !get(&at, split->dependent.P, PACKED) ||
        !get(&at, split->independent, PACKED) || mh_split_check(split) != MH_OK) {
        return false;
    }
    struct mh_gaussian whole = split->dependent;
    for (int i = 0; i < PACKED; i++) {
        whole.P[i] += split->independent[i];
    }
    return mh_summary_sane(&whole);
}

enum mh_status mh_summary_read(struct mh_summary *summary, const uint8_t *bytes, size_t length)
{
    struct mh_summary told;
    const uint8_t *at = bytes + 1;
    bool right = false;
    memset(&told, 0, sizeof told);
    if (length == 0) {
        return MH_ERR_CORRUPT;
    }
    switch (bytes[0]) {
    case MH_SUMMARY_PLAIN:
        told.kind = MH_SUMMARY_PLAIN;
        right = length == PLAIN_BYTES && read_gaussian(&told.of.plain, at);
        break;
    case MH_SUMMARY_SPLIT:
        told.kind = MH_SUMMARY_SPLIT;
        right = length == SPLIT_BYTES && read_split(&told.of.split, at);
        break;
    case MH_SUMMARY_INCREMENT:
        told.kind = MH_SUMMARY_INCREMENT;
        told.of.increment.n = N;
        right = length == INCREMENT_BYTES && get(&at, told.of.increment.vector, N) &&
                get(&at, told.of.increment.matrix, PACKED);
        if (right) {
            told.since = mh_get_u32(&at);
        }
        break;
    case MH_SUMMARY_FUSED:
        told.kind = MH_SUMMARY_FUSED;
        right = length == FUSED_BYTES && read_gaussian(&told.of.plain, at);
        if (right) {
            at += MH_GAUSSIAN_BYTES(N);
            told.clusters = mh_get_u16(&at);
        }
        break;
    default:
        break;
    }
    if (right) {
        *summary = told;
    }
    return right ? MH_OK : MH_ERR_CORRUPT;
}

enum mh_summary_kind mh_summary_kind_of(enum mh_fusion_rule rule)
{
    switch (rule) {
    case MH_FUSION_SCI:
        return MH_SUMMARY_SPLIT;
    case MH_FUSION_HIF:
    case MH_FUSION_HIF_FEEDBACK:
        return MH_SUMMARY_INCREMENT;
    default:
        return MH_SUMMARY_PLAIN;
    }
}

bool mh_summary_holds(const uint8_t *bytes, size_t length, uint8_t cluster)
{
    if (length != FUSED_BYTES || bytes[0] != MH_SUMMARY_FUSED || cluster >= 16) {
        return false;
    }
    const uint8_t *at = bytes + PLAIN_BYTES;
    return (mh_get_u16(&at) >> cluster & 1) != 0;
}
