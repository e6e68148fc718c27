#include "motehound/clock.h"

#include "motehound/spread.h"

#include <string.h>

#define HALF_TICK_Q8 128
#define SKEW_MAX_Q32 (MH_CLOCK_SKEW_MAX_PPM * (int32_t)4295) /* 2^32 / 10^6 */

/* What is assumed before there is data: that a clock's skew is about 50 ppm, as if Sxx were variance / (50 ppm)^2 already at a slope of zero
 * (ridge regression; 6104 is 1 / (50 ppm)^2 in the unit of the variance), and that pairs lie 2 ticks off the line, as if four had. */
#define PRIOR_SXX_PER_VARIANCE 6104
#define PRIOR_PAIRS 4
#define PRIOR_VARIANCE_Q16 ((uint32_t)4 << 16)

#define REJECT_SQUARED 25 /* a pair is rejected beyond 5 standard deviations, more with few pairs ... */
#define REJECT_AGE 64     /* ... and 1/256 tick in 64 ticks, 61 ppm, since the last one */
#define MERGE_SHARE 4     /* pairs within this part of a period become one */
#define FAR_TICKS ((int32_t)1 << 20)
#define OLD_TICKS ((int32_t)1 << 28)

static int32_t floor_q8(int32_t a) { return a / 256 - (a % 256 < 0); }

static int32_t gain_q8(int32_t skew_q32, int32_t ticks)
{
    return (int32_t)((int64_t)skew_q32 * ticks / ((int32_t)1 << 24));
}

/* What the line adds to local + offset. */
static int32_t line_q8(const struct mh_clock *clock, mh_tick local)
{
    return clock->line_q8 + gain_q8(clock->skew_q32, mh_ticks_between(clock->origin, local));
}

/* Whole ticks go from the line and the pairs into the offset, so that few digits are left. */
static void rebase(struct mh_clock *clock)
{
    const int32_t ticks = floor_q8(clock->line_q8);
    clock->offset += (mh_tick)ticks;
    clock->line_q8 -= ticks * 256;
    for (uint8_t i = 0; i < clock->count; i++) {
        clock->pairs[i].offset_q8 -= ticks * 256;
    }
}

/* The line through the pairs by least squares; its origin is the newest pair. */
static void fit(struct mh_clock *clock)
{
    const uint8_t n = clock->count;
    const struct mh_clock_pair *pairs = clock->pairs;
    const mh_tick origin = pairs[n - 1].local;
    int64_t sum_t = 0, sum_y = 0;
    for (uint8_t i = 0; i < n; i++) {
        sum_t += mh_ticks_between(origin, pairs[i].local);
        sum_y += pairs[i].offset_q8;
    }
    const int32_t mean_t = (int32_t)(sum_t / n), mean_y = (int32_t)(sum_y / n);
    /* |t| < 2^29, |y| < 2^28, n <= 2^5: no sum passes 2^62 */
    int64_t sxx = (int64_t)clock->variance_q16 * PRIOR_SXX_PER_VARIANCE, sxy = 0;
    for (uint8_t i = 0; i < n; i++) {
        const int64_t t = mh_ticks_between(origin, pairs[i].local) - mean_t;
        sxx += t * t;
        sxy += t * (pairs[i].offset_q8 - mean_y);
    }
    while (sxy > (int64_t)1 << 38 || sxy < -((int64_t)1 << 38)) { /* at most 23 times */
        sxy /= 2;
        sxx /= 2;
    }
    const int64_t skew = sxx > 0 ? sxy * ((int64_t)1 << 24) / sxx : 0;
    clock->skew_q32 = skew > SKEW_MAX_Q32 ? SKEW_MAX_Q32 : skew < -SKEW_MAX_Q32 ? -SKEW_MAX_Q32 : (int32_t)skew;
    clock->origin = origin;
    clock->line_q8 = mean_y + gain_q8(clock->skew_q32, -mean_t);
    uint64_t squares = (uint64_t)PRIOR_PAIRS * PRIOR_VARIANCE_Q16;
    for (uint8_t i = 0; i < n; i++) {
        const int64_t residual = pairs[i].offset_q8 - line_q8(clock, pairs[i].local);
        squares += (uint64_t)(residual * residual);
    }
    squares /= (uint64_t)n + PRIOR_PAIRS;
    clock->variance_q16 = squares > UINT32_MAX ? UINT32_MAX : (uint32_t)squares;
    rebase(clock);
}

static void forget(struct mh_clock *clock, uint8_t oldest)
{
    clock->count = (uint8_t)(clock->count - oldest);
    memmove(&clock->pairs[0], &clock->pairs[oldest], clock->count * sizeof clock->pairs[0]);
}

static void begin_anew(struct mh_clock *clock, mh_tick local, mh_tick offset, int32_t offset_q8)
{
    clock->synchronised = true;
    clock->variance_q16 = PRIOR_VARIANCE_Q16;
    clock->count = 1;
    clock->merged = 1;
    clock->rejects = 0;
    clock->offset = offset;
    clock->pairs[0].local = local;
    clock->pairs[0].offset_q8 = offset_q8;
    clock->interval = MH_CLOCK_FIRST_INTERVAL;
    clock->counters.pairs++;
    clock->counters.jumps++;
    fit(clock);
}

static bool is_outlier(const struct mh_clock *clock, mh_tick local, int32_t residual_q8)
{
    const int32_t since = clock->count > 0 ? mh_ticks_between(clock->pairs[clock->count - 1].local, local) : OLD_TICKS;
    const int64_t magnitude = residual_q8 < 0 ? -(int64_t)residual_q8 : residual_q8;
    const int64_t beyond = magnitude - (since > 0 ? since : 0) / REJECT_AGE;
    const uint64_t scaled = (uint64_t)(beyond > 0 ? beyond : 0) * clock->count / MH_CLOCK_PAIRS;
    return scaled * scaled > (uint64_t)REJECT_SQUARED * clock->variance_q16;
}

static bool is_between(mh_tick earlier, mh_tick later, int32_t least, int32_t most)
{
    const int32_t ticks = mh_ticks_between(earlier, later);
    return ticks >= least && ticks <= most;
}

static void add(struct mh_clock *clock, mh_tick local, int32_t offset_q8)
{
    struct mh_clock_pair *newest = clock->count > 0 ? &clock->pairs[clock->count - 1] : NULL;
    const int32_t near = (int32_t)(clock->config->period / MERGE_SHARE);
    if (newest && clock->merged < UINT8_MAX && is_between(newest->local, local, -near, near)) {
        clock->merged++;
        newest->local += (mh_tick)(mh_ticks_between(newest->local, local) / clock->merged);
        newest->offset_q8 += (offset_q8 - newest->offset_q8) / clock->merged;
        return;
    }
    uint8_t old =
        0; /* where frames are lost, pairs are farther apart; none is ahead of its time, unless ticks have wrapped unseen */
    const int32_t longest = (int32_t)(4 * MH_CLOCK_PAIRS * clock->config->period);
    while (old < clock->count &&
           !is_between(clock->pairs[old].local, local, -(int32_t)clock->config->period, longest)) {
        old++;
    }
    if (old == 0 && clock->count == MH_CLOCK_PAIRS) {
        old = 1;
    }
    forget(clock, old);
    clock->pairs[clock->count].local = local;
    clock->pairs[clock->count].offset_q8 = offset_q8;
    clock->count++;
    clock->merged = 1;
}

/* A moment with both its times. True if the network time jumped. */
static bool take(struct mh_clock *clock, mh_tick local, mh_tick network, uint8_t fraction)
{
    const mh_tick offset = network - local;
    const int32_t fine_q8 = (int32_t)fraction - HALF_TICK_Q8;
    const int32_t ticks = mh_ticks_between(clock->offset, offset);
    if (!clock->synchronised) {
        begin_anew(clock, local, offset, fine_q8);
        return true;
    }
    const bool is_far = ticks > FAR_TICKS || ticks < -FAR_TICKS;
    if (is_far || is_outlier(clock, local, ticks * 256 + fine_q8 - line_q8(clock, local))) {
        clock->counters.rejected++;
        if (++clock->rejects < MH_CLOCK_REJECTS) {
            return false;
        }
        begin_anew(clock, local, offset, fine_q8);
        return true;
    }
    clock->rejects = 0;
    clock->counters.pairs++;
    add(clock, local, ticks * 256 + fine_q8);
    fit(clock);
    return false;
}

/* The network time of a moment of this mote's own, as it tells it to others: from the newest pair. */
static void stamp(const struct mh_clock *clock, mh_tick local, mh_sync_t *message)
{
    int32_t offset_q8 = clock->config->sent_q8;
    if (clock->count > 0) {
        const struct mh_clock_pair *newest = &clock->pairs[clock->count - 1];
        offset_q8 += newest->offset_q8 + gain_q8(clock->skew_q32, mh_ticks_between(newest->local, local));
    } else {
        offset_q8 += line_q8(clock, local);
    }
    const int32_t ticks = floor_q8(offset_q8);
    message->time_ms = (int32_t)(local + clock->offset + (mh_tick)ticks);
    message->fraction = (uint8_t)(offset_q8 - ticks * 256);
    message->stamped = 1;
}

/* ---- rounds ---- */

static mh_tick pseudo_random(const struct mh_clock *clock, mh_tick limit)
{
    return mh_spread(clock->id, (uint32_t)clock->round << 8 | clock->number, limit);
}

static bool is_newer(const struct mh_clock *clock, const mh_sync_t *message)
{
    return (int16_t)((uint16_t)message->round - clock->round) > 0;
}

static bool is_silent(const struct mh_clock *clock, mh_tick now)
{
    return mh_ticks_between(clock->round_time, now) > (int32_t)(MH_CLOCK_SILENCE * clock->config->period);
}

/* The message tells of a round that this mote has not heard of. */
static bool is_news(const struct mh_clock *clock, mh_tick now, const mh_sync_t *message)
{
    const bool same_root = clock->following && (mh_node_id)message->root == clock->root;
    return same_root ? is_newer(clock, message) : !clock->following || is_silent(clock, now);
}

/* One more than in the message, at most UINT8_MAX, which stands for not known. */
static uint8_t hops_by(const mh_sync_t *message)
{
    return message->hops < UINT8_MAX ? (uint8_t)(message->hops + 1) : UINT8_MAX;
}

/* A new round. This mote is as far from the root as the last two said, in the worse one: a frame that comes through once
 * in a while from far away makes no neighbour. */
static void follow(struct mh_clock *clock, mh_tick now, const mh_sync_t *message)
{
    if (!clock->following || clock->root != (mh_node_id)message->root) {
        clock->nearest = clock->nearest_before = UINT8_MAX;
    }
    clock->hops = clock->nearest > clock->nearest_before ? clock->nearest : clock->nearest_before;
    clock->nearest_before = clock->nearest;
    clock->nearest = UINT8_MAX;
    clock->root = (mh_node_id)message->root;
    clock->round = (uint16_t)message->round;
    clock->round_time = now;
    clock->following = true;
    if (!clock->waits) {
        clock->waits = true;
        clock->again = false;
        clock->sends = true;
        clock->send_time = now + 1 + pseudo_random(clock, clock->config->wait);
    }
}

/* Keep when the message came in, and give when the sender's last one did (false: not known). */
static bool remember(struct mh_clock *clock, mh_tick now, const mh_sync_t *message, mh_tick *last)
{
    struct mh_clock_moment *place =
        NULL; /* for one that is not known: of a silent one, or the farthest from the root */
    uint8_t farthest = message->hops;
    const int32_t long_ago = (int32_t)(3 * clock->config->period);
    for (uint8_t i = 0; i < clock->heard_count; i++) {
        struct mh_clock_moment *moment = &clock->heard[i];
        const bool fresh = mh_ticks_between(moment->local, now) <= long_ago;
        if (moment->sender == (mh_node_id)message->sender) {
            const bool known = fresh && (uint8_t)(moment->number + 1) == message->number;
            *last = moment->local;
            moment->local = now;
            moment->number = message->number;
            moment->hops = message->hops;
            return known;
        }
        const uint8_t hops = fresh ? moment->hops : UINT8_MAX;
        if (hops > farthest) {
            farthest = hops;
            place = moment;
        }
    }
    if (clock->heard_count < MH_CLOCK_NEIGHBOURS) {
        place = &clock->heard[clock->heard_count++];
    }
    if (place) {
        place->sender = (mh_node_id)message->sender;
        place->local = now;
        place->number = message->number;
        place->hops = message->hops;
    }
    return false;
}

/* ---- the events ---- */

enum mh_status mh_clock_init(struct mh_clock *clock, const struct mh_clock_config *config, mh_node_id id, mh_tick now)
{
    if (!clock || !config || config->period < 2000 || config->period > 3600000u || config->wait < 1 ||
        config->wait > config->period / 2) {
        return MH_ERR_ARGUMENT;
    }
    memset(clock, 0, sizeof *clock);
    clock->config = config;
    clock->id = id;
    clock->variance_q16 = PRIOR_VARIANCE_Q16;
    clock->interval = MH_CLOCK_FIRST_INTERVAL;
    clock->hops = clock->nearest = clock->nearest_before = config->root ? 0 : UINT8_MAX;
    if (config->root) {
        clock->synchronised = true;
        clock->root = id;
        clock->following = true;
        clock->sends = true;
        clock->send_time = now + config->wait; /* the others need a moment to come up */
    }
    return MH_OK;
}

bool mh_clock_message(struct mh_clock *clock, mh_tick now, const mh_sync_t *message)
{
    if (clock->config->root) {
        if ((mh_node_id)message->root == clock->id && is_newer(clock, message)) {
            clock->round = (uint16_t)message->round; /* begun before this root was restarted: go on from there */
        }
        return false;
    }
    mh_tick last = now;
    const bool known = remember(clock, now, message, &last);
    if (is_news(clock, now, message)) {
        follow(clock, now, message);
    } else if ((mh_node_id)message->root != clock->root || (uint16_t)message->round != clock->round) {
        return false;
    }
    const uint8_t hops = hops_by(message);
    if (hops < clock->nearest) {
        clock->nearest = hops;
    }
    if (clock->hops == UINT8_MAX) {
        clock->hops = hops;
    }
    return known && message->stamped && message->hops < clock->hops &&
           take(clock, last, (mh_tick)message->time_ms, message->fraction);
}

bool mh_clock_due(const struct mh_clock *clock, mh_tick *time)
{
    *time = clock->send_time;
    return clock->sends;
}

/* Far from its origin the line would lose its digits, and ticks their order. */
static void keep_up(struct mh_clock *clock, mh_tick now)
{
    if (mh_ticks_between(clock->origin, now) > OLD_TICKS) {
        clock->line_q8 = line_q8(clock, now);
        clock->origin = now;
        rebase(clock);
        clock->count = 0;
        clock->round_time = now - (MH_CLOCK_SILENCE + 1) * clock->config->period;
    }
}

bool mh_clock_timer(struct mh_clock *clock, mh_tick now, struct mh_message *message)
{
    if (!clock->sends || mh_tick_before(now, clock->send_time)) {
        return false;
    }
    const struct mh_clock_config *config = clock->config;
    keep_up(clock, now);
    if (clock->on_its_way && mh_ticks_between(clock->sent_time, now) < (int32_t)config->period) {
        clock->send_time = now + config->wait;
        return false;
    }
    if (clock->on_its_way) { /* the radio has forgotten it, and whatever was handed over before */
        clock->others = 0;
    }
    if (clock->again) {
        clock->again = false;
        clock->send_time = clock->next_time;
    } else {
        clock->round = (uint16_t)(clock->round + config->root);
        clock->next_time = now + clock->interval + (config->root ? 0 : config->wait);
        clock->interval = clock->interval < config->period / 2 ? 3 * clock->interval / 2 : config->period;
        clock->again = true;
        clock->send_time = now + 1 + pseudo_random(clock, config->wait);
    }
    clock->waits = false;
    memset(message, 0, sizeof *message);
    message->kind = MH_MESSAGE_SYNC;
    mh_sync_t *sync = &message->as.sync;
    sync->sender = (int32_t)clock->id;
    sync->root = (int32_t)clock->root;
    sync->round = (int16_t)clock->round;
    if (clock->sent && clock->synchronised) {
        stamp(clock, clock->sent_time, sync);
    }
    sync->hops = clock->hops;
    sync->number = ++clock->number;
    clock->sent = false;
    clock->sent_time = now;
    clock->on_its_way = true;
    clock->before = clock->others;
    return true;
}

void mh_clock_other_frame(struct mh_clock *clock) { clock->others++; }

bool mh_clock_sent(struct mh_clock *clock, mh_tick now, enum mh_sent outcome)
{
    if (clock->on_its_way && clock->before == 0) {
        clock->on_its_way = false;
        clock->sent = outcome == MH_SENT_OK;
        clock->sent_time = now;
        return true;
    }
    clock->before = (uint16_t)(clock->before - clock->on_its_way);
    clock->others = (uint16_t)(clock->others - (clock->others > 0));
    return false;
}

/* ---- the time ---- */

mh_tick mh_clock_network(const struct mh_clock *clock, mh_tick local, uint8_t *fraction)
{
    const int32_t more_q8 = HALF_TICK_Q8 + line_q8(clock, local);
    const int32_t ticks = floor_q8(more_q8);
    if (fraction) {
        *fraction = (uint8_t)(more_q8 - ticks * 256);
    }
    return local + clock->offset + (mh_tick)ticks;
}

mh_tick mh_clock_local(const struct mh_clock *clock, mh_tick network)
{
    mh_tick local = network - clock->offset;
    for (uint8_t round = 0; round < 4; round++) { /* each leaves at most 3 parts in 10,000 of the error */
        local += network - mh_clock_network(clock, local, NULL);
    }
    for (uint8_t step = 0; step < 4 && mh_tick_before(mh_clock_network(clock, local, NULL), network); step++) {
        local++;
    }
    for (uint8_t step = 0; step < 4 && !mh_tick_before(mh_clock_network(clock, local - 1, NULL), network); step++) {
        local--;
    }
    return local;
}

static mh_wire_types types[] = {&mh_wire_sync, NULL};

const struct mh_clock_functions mh_clock_flooding = {
    .types = types,
    .init = mh_clock_init,
    .message = mh_clock_message,
    .due = mh_clock_due,
    .timer = mh_clock_timer,
    .other_frame = mh_clock_other_frame,
    .sent = mh_clock_sent,
    .network = mh_clock_network,
    .local = mh_clock_local,
};
