#include "motehound/fusion_centre.h"

#include "plane_estimate.h"

#include <string.h>

enum { N = MH_SUMMARY_STATES, PACKED = MH_PACKED_SIZE(N) };

static bool by_increments(const struct mh_fusion_centre *centre)
{
    return mh_summary_kind_of(centre->config.rule) == MH_SUMMARY_INCREMENT;
}

static enum mh_status init(void *state, const void *config)
{
    const struct mh_fusion_centre_config *chosen = config;
    const mh_tick hour = 3600000u;
    struct mh_fusion_centre *centre = state;
    if (centre == NULL || chosen == NULL || (unsigned)chosen->rule >= MH_FUSION_CENTRAL || chosen->clusters < 1 ||
        chosen->clusters > MH_FUSED_MAX || chosen->motion.tick < 1 || chosen->motion.tick > hour ||
        chosen->keep > hour || !(chosen->motion.variance.x > 0) || !mh_finite(chosen->motion.variance.x) ||
        !(chosen->motion.variance.y > 0) || !mh_finite(chosen->motion.variance.y) || chosen->start.n != N ||
        mh_gaussian_check(&chosen->start) != MH_OK) {
        return MH_ERR_ARGUMENT;
    }
    memset(centre, 0, sizeof *centre);
    centre->config = *chosen;
    centre->state = chosen->start;
    centre->time = chosen->start_time;
    return MH_OK;
}

static enum mh_status judge(const struct mh_fusion_centre *centre, const struct mh_fusion_slot *slot, mh_tick time,
                            const struct mh_summary *summary)
{
    if (slot->heard && slot->time == time) {
        return MH_ERR_REPEATED;
    }
    if ((slot->heard && mh_tick_before(time, slot->time)) ||
        (centre->fused && mh_ticks_between(centre->time, time) > (int32_t)MH_FUSION_AHEAD)) {
        return MH_ERR_TIME;
    }
    if (summary->kind == MH_SUMMARY_INCREMENT) {
        if (mh_tick_before(time, summary->since)) {
            return MH_ERR_CORRUPT;
        }
        if (!mh_tick_before(centre->time, time)) {
            return MH_ERR_TIME;
        }
        if (slot->held) {
            return MH_ERR_CAPACITY;
        }
        if (slot->heard && mh_tick_before(summary->since, slot->time)) {
            return MH_ERR_REPEATED;
        }
    }
    return MH_OK;
}

static void count(struct mh_fusion_counters *counters, enum mh_status status)
{
    switch (status) {
    case MH_OK:
        counters->taken++;
        break;
    case MH_ERR_REPEATED:
        counters->repeated++;
        break;
    case MH_ERR_TIME:
        counters->late++;
        break;
    case MH_ERR_CAPACITY:
        counters->waiting++;
        break;
    case MH_ERR_ARGUMENT:
        counters->unknown++;
        break;
    default:
        counters->corrupt++;
        break;
    }
}

static void keep(struct mh_fusion_slot *slot, mh_tick time, const struct mh_summary *summary)
{
    slot->time = time;
    slot->heard = slot->fresh = slot->held = true;
    switch (summary->kind) {
    case MH_SUMMARY_INCREMENT:
        memcpy(slot->x, summary->of.increment.vector, sizeof slot->x);
        memcpy(slot->P, summary->of.increment.matrix, sizeof slot->P);
        break;
    case MH_SUMMARY_SPLIT:
        memcpy(slot->x, summary->of.split.dependent.x, sizeof slot->x);
        memcpy(slot->P, summary->of.split.dependent.P, sizeof slot->P);
        memcpy(slot->own, summary->of.split.independent, sizeof slot->own);
        break;
    default:
        memcpy(slot->x, summary->of.plain.x, sizeof slot->x);
        memcpy(slot->P, summary->of.plain.P, sizeof slot->P);
        break;
    }
}

static enum mh_status take(void *state, uint8_t cluster, mh_tick time, const uint8_t *bytes, size_t length)
{
    struct mh_fusion_centre *centre = state;
    struct mh_summary summary;
    enum mh_status status = MH_ERR_ARGUMENT;
    if (centre == NULL || bytes == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (cluster < centre->config.clusters) {
        status = mh_summary_read(&summary, bytes, length);
        if (status == MH_OK && summary.kind != mh_summary_kind_of(centre->config.rule)) {
            status = MH_ERR_CORRUPT;
        }
        if (status == MH_OK) {
            status = judge(centre, &centre->slots[cluster], time, &summary);
        }
        if (status == MH_OK) {
            keep(&centre->slots[cluster], time, &summary);
        }
    }
    count(&centre->counters, status);
    return status;
}

static enum mh_status predict(const struct mh_fusion_centre *centre, struct mh_gaussian *state, mh_tick from,
                              mh_tick to)
{
    mh_real F[N * N], Q[PACKED];
    if (from == to) {
        return MH_OK;
    }
    mh_white_acceleration(&centre->config.motion, to - from, F, Q);
    return mh_gaussian_predict(state, F, Q);
}

static void forget(struct mh_fusion_centre *centre, struct mh_fusion_slot *slot)
{
    slot->held = slot->fresh = false;
    centre->counters.unfit++;
}

static void begin_gaussian(struct mh_gaussian *gaussian, const struct mh_fusion_slot *slot)
{
    memset(gaussian, 0, sizeof *gaussian);
    gaussian->n = N;
    memcpy(gaussian->x, slot->x, sizeof slot->x);
    memcpy(gaussian->P, slot->P, sizeof slot->P);
}

/* Whether the summary counts at `time`. */
static bool speaks(const struct mh_fusion_centre *centre, const struct mh_fusion_slot *slot, mh_tick time)
{
    return slot->held && mh_ticks_between(slot->time, time) >= 0 &&
           mh_ticks_between(slot->time, time) <= (int32_t)centre->config.keep;
}

/* The plain summaries of all who speak -> estimates. Returns their number. */
static uint8_t gather(struct mh_fusion_centre *centre, mh_tick time, struct mh_gaussian *estimates)
{
    uint8_t found = 0;
    for (uint_fast8_t c = 0; c < centre->config.clusters; c++) {
        struct mh_fusion_slot *slot = &centre->slots[c];
        if (speaks(centre, slot, time)) {
            begin_gaussian(&estimates[found], slot);
            if (predict(centre, &estimates[found], slot->time, time) == MH_OK) {
                found++;
            } else {
                forget(centre, slot);
            }
        }
    }
    return found;
}

static enum mh_status join_pairs(enum mh_fusion_rule rule, const struct mh_gaussian *estimates, uint8_t found,
                                 struct mh_gaussian *fused)
{
    enum mh_status status = MH_OK;
    *fused = estimates[0];
    for (uint_fast8_t i = 1; i < found && status == MH_OK; i++) {
        status = rule == MH_FUSION_ICI ? mh_fusion_inverse(fused, &estimates[i], fused)
                                       : mh_fusion_ellipsoidal(fused, &estimates[i], fused);
    }
    return status;
}

static enum mh_status join_plain(struct mh_fusion_centre *centre, mh_tick time, struct mh_gaussian *fused)
{
    struct mh_gaussian estimates[MH_FUSED_MAX];
    mh_real w[MH_FUSED_MAX];
    const uint8_t found = gather(centre, time, estimates);
    const enum mh_fusion_rule rule = centre->config.rule;
    enum mh_status status;
    if (found == 0) {
        return MH_NONE;
    }
    switch (rule) {
    case MH_FUSION_NAIVE:
        return mh_fusion_naive(estimates, found, fused);
    case MH_FUSION_ICI:
    case MH_FUSION_EI:
        return join_pairs(rule, estimates, found, fused);
    case MH_FUSION_CI_TRACE_OPT:
        status = mh_fusion_weights_trace(estimates, found, w);
        break;
    case MH_FUSION_CI_DET:
        status = mh_fusion_weights_determinant(estimates, found, w);
        break;
    default:
        status = mh_fusion_weights(estimates, found, w);
        break;
    }
    return status == MH_OK ? mh_fusion_intersect(estimates, found, w, fused) : status;
}

static enum mh_status predict_split(const struct mh_fusion_centre *centre, const struct mh_fusion_slot *slot,
                                    mh_tick time, struct mh_split_gaussian *split)
{
    mh_real F[N * N], Q[PACKED];
    memset(split, 0, sizeof *split);
    begin_gaussian(&split->dependent, slot);
    memcpy(split->independent, slot->own, sizeof slot->own);
    if (slot->time != time) {
        const mh_tick elapsed = time - slot->time;
        mh_white_acceleration(&centre->config.motion, elapsed, F, Q);
        mh_covariance_predict(N, split->dependent.P, F, Q);
        mh_covariance_predict(N, split->independent, F, NULL);
        split->dependent.x[0] += F[1] * split->dependent.x[1];
        split->dependent.x[2] += F[1] * split->dependent.x[3];
    }
    return mh_split_check(split);
}

static enum mh_status join_split(struct mh_fusion_centre *centre, mh_tick time, struct mh_gaussian *fused)
{
    struct mh_split_gaussian joined, next;
    bool any = false;
    for (uint_fast8_t c = 0; c < centre->config.clusters; c++) {
        struct mh_fusion_slot *slot = &centre->slots[c];
        if (!speaks(centre, slot, time)) {
            continue;
        }
        if (predict_split(centre, slot, time, &next) != MH_OK ||
            (any && mh_fusion_split(&joined, &next, &joined) != MH_OK)) {
            forget(centre, slot);
        } else if (!any) {
            joined = next;
            any = true;
        }
    }
    if (!any) {
        return MH_NONE;
    }
    *fused = joined.dependent;
    for (int i = 0; i < PACKED; i++) {
        fused->P[i] += joined.independent[i];
    }
    return mh_gaussian_settle(fused);
}

/* The summaries that were not there at the last fusion, up to `time`: they are fused now. */
static uint16_t count_fresh(struct mh_fusion_centre *centre, mh_tick time)
{
    uint16_t fresh = 0;
    for (uint_fast8_t c = 0; c < centre->config.clusters; c++) {
        struct mh_fusion_slot *slot = &centre->slots[c];
        if (slot->fresh && speaks(centre, slot, time)) {
            slot->fresh = false;
            fresh++;
        }
    }
    return fresh;
}

static enum mh_status fuse_estimates(struct mh_fusion_centre *centre, mh_tick time, struct mh_gaussian *fused,
                                     uint16_t *used)
{
    enum mh_status status =
        centre->config.rule == MH_FUSION_SCI ? join_split(centre, time, fused) : join_plain(centre, time, fused);
    if (status == MH_OK) {
        *used = count_fresh(centre, time);
        return MH_OK;
    }
    if (status != MH_NONE) { /* which of them is at fault cannot be known */
        for (uint_fast8_t c = 0; c < centre->config.clusters; c++) {
            if (speaks(centre, &centre->slots[c], time)) {
                forget(centre, &centre->slots[c]);
            }
        }
    }
    if (!centre->fused) {
        return MH_NONE;
    }
    *fused = centre->state;
    return predict(centre, fused, centre->time, time);
}

/* The next increment that waits, by time and then cluster, up to `time`; NULL if there is none. */
static struct mh_fusion_slot *next_increment(struct mh_fusion_centre *centre, mh_tick time)
{
    struct mh_fusion_slot *next = NULL;
    for (uint_fast8_t c = 0; c < centre->config.clusters; c++) {
        struct mh_fusion_slot *slot = &centre->slots[c];
        if (slot->held && !mh_tick_before(time, slot->time) && (!next || mh_tick_before(slot->time, next->time))) {
            next = slot;
        }
    }
    return next;
}

static enum mh_status fuse_increments(struct mh_fusion_centre *centre, mh_tick time, struct mh_gaussian *fused,
                                      uint16_t *used)
{
    mh_tick now = centre->time;
    enum mh_status status = MH_OK;
    *fused = centre->state;
    centre->clusters = 0;
    for (uint_fast8_t i = 0; i < centre->config.clusters && status == MH_OK; i++) {
        struct mh_fusion_slot *slot = next_increment(centre, time);
        if (slot == NULL) {
            break;
        }
        struct mh_information increment = {.n = N};
        struct mh_gaussian more;
        memcpy(increment.vector, slot->x, sizeof slot->x);
        memcpy(increment.matrix, slot->P, sizeof slot->P);
        status = predict(centre, fused, now, slot->time);
        now = slot->time;
        if (status == MH_OK && mh_fusion_add(fused, &increment, 1, &more) == MH_OK && mh_summary_sane(&more)) {
            *fused = more;
            slot->held = slot->fresh = false;
            (*used)++;
            if (now == time) {
                centre->clusters = (uint16_t)(centre->clusters | 1u << (slot - centre->slots));
            }
        } else {
            forget(centre, slot);
        }
    }
    return status == MH_OK ? predict(centre, fused, now, time) : status;
}

/* Times from which no report can be told old or new any more are forgotten, and so are those that were taken for the future before the first fusion. */
static void clear_wrong_times(struct mh_fusion_centre *centre, mh_tick now)
{
    const int32_t longest = INT32_MAX / 2;
    for (uint_fast8_t c = 0; c < centre->config.clusters; c++) {
        struct mh_fusion_slot *slot = &centre->slots[c];
        if (slot->heard && !(mh_ticks_between(slot->time, now) >= -(int32_t)MH_FUSION_AHEAD &&
                             mh_ticks_between(slot->time, now) <= longest)) {
            slot->heard = slot->held = slot->fresh = false;
        }
    }
}

static enum mh_status fuse(void *state, mh_tick time, struct mh_estimate *estimate)
{
    struct mh_fusion_centre *centre = state;
    struct mh_gaussian fused;
    uint16_t used = 0;
    if (centre == NULL || estimate == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if ((centre->fused || by_increments(centre)) && !mh_tick_before(centre->time, time)) {
        return MH_ERR_TIME;
    }
    clear_wrong_times(centre, time);
    const enum mh_status status = by_increments(centre) ? fuse_increments(centre, time, &fused, &used)
                                                        : fuse_estimates(centre, time, &fused, &used);
    if (status != MH_OK) {
        return MH_NONE;
    }
    centre->state = fused;
    centre->time = time;
    centre->fused = true;
    mh_plane_estimate(&fused, &centre->config.origin, time, estimate);
    estimate->measurements = used;
    estimate->flags = used == 0 ? MH_ESTIMATE_COASTED : 0;
    return MH_OK;
}

static enum mh_status feedback(const void *state, uint8_t *bytes, size_t *length)
{
    const struct mh_fusion_centre *centre = state;
    if (centre == NULL || bytes == NULL || length == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (centre->config.rule != MH_FUSION_HIF_FEEDBACK || !centre->fused) {
        return MH_NONE;
    }
    const struct mh_summary summary = {
        .kind = MH_SUMMARY_FUSED, .of = {.plain = centre->state}, .clusters = centre->clusters};
    *length = mh_summary_write(&summary, bytes);
    return MH_OK;
}

void mh_fusion_centre_config_default(struct mh_fusion_centre_config *config)
{
    memset(config, 0, sizeof *config);
    config->rule = MH_FUSION_CI;
    config->clusters = 4;
    config->motion.tick = 500;
    config->motion.variance.x = 5e-5f;
    config->motion.variance.y = 1e-4f;
    config->keep = 30000;
    config->start.n = N;
    config->start.x[0] = 10;
    config->start.x[1] = 0.8f;
    config->start.x[2] = 20;
    config->start.x[3] = 0.6f;
    config->start.P[MH_PACKED(0, 0)] = config->start.P[MH_PACKED(2, 2)] = 1;
    config->start.P[MH_PACKED(1, 1)] = config->start.P[MH_PACKED(3, 3)] = 0.04f;
}

const struct mh_centre mh_centre_fusion = {
    .name = "fusion",
    .state_size = sizeof(struct mh_fusion_centre),
    .config_size = sizeof(struct mh_fusion_centre_config),
    .init = init,
    .take = take,
    .fuse = fuse,
    .feedback = feedback,
};
