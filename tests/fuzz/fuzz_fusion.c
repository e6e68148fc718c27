/* Two clusters with a tracker each, and a fusion centre: whatever measurements, summaries and feedback come, when and how often.
 *
 * The first byte chooses the rule, the second the filters; then events follow, each a byte and what it needs. Whatever comes: estimates are finite numbers with
 * covariances that are positive definite, what is refused leaves no trace but a count, and what is read is written the same. */
#include "fuzz.h"
#include "motehound/cv.h"
#include "motehound/fusion_centre.h"

#include <string.h>

enum { HEADS = 2, EVENTS_MAX = 300, SAMPLES_MAX = 6, BYTES_MAX = 4 * (MH_STATES_MAX + MH_PACKED_SIZE(MH_STATES_MAX)) };

static const struct mh_tracker *tracker;
static struct mh_cv heads[HEADS];
static struct mh_fusion_centre centre;
static mh_tick now;

/* As many bytes as there are, at most `most`; zeros behind them. */
static size_t bytes_of(struct input *input, uint8_t *to, size_t most)
{
    memset(to, 0, most);
    return bytes(input, to, most);
}

static void check(const struct mh_estimate *estimate)
{
    struct mh_gaussian stated = {4, {0}, {estimate->covariance.xx, estimate->covariance.xy, estimate->covariance.yy}};
    memcpy(stated.P + 3, estimate->covariance_more, sizeof estimate->covariance_more);
    const mh_real x[] = {estimate->position.x, estimate->position.y, estimate->velocity.x, estimate->velocity.y};
    memcpy(stated.x, x, sizeof x);
    for (int i = 0; i < 4; i++) {
        require(mh_finite(x[i]));
        require(stated.P[MH_PACKED(i, i)] > 0);
        for (int j = 0; j <= i; j++) {
            const double both = (double)stated.P[MH_PACKED(j, i)];
            require(mh_finite(stated.P[MH_PACKED(j, i)]));
            require(both * both <= (double)stated.P[MH_PACKED(i, i)] * (double)stated.P[MH_PACKED(j, j)] * (1 + 1e-5));
        }
    }
}

/* Ranges of nodes on a circle, some of them late, early, twice. */
static void step(struct input *input, struct mh_cv *head, uint8_t count)
{
    struct mh_measurement set[SAMPLES_MAX];
    struct mh_estimate estimate;
    memset(set, 0, sizeof set);
    for (int k = 0; k < count; k++) {
        const uint8_t where = byte(input), range = byte(input), late = byte(input);
        set[k].node = where % 16;
        set[k].place.x_mm = (where - 128) * 300;
        set[k].place.y_mm = (where * 7 % 256 - 128) * 300;
        set[k].value = late & 128 ? INT32_MAX - range : (mh_q20)range * (MH_Q20_ONE / 4);
        set[k].time = now - (mh_tick)(late & 127) * 50;
    }
    if (tracker->step(head, now, set, count, &estimate) == MH_OK) {
        check(&estimate);
    }
}

/* The summary of a head, perhaps damaged, misdirected or of a wrong time; `how` says so. */
static void tell(struct input *input, uint8_t which, uint8_t how)
{
    uint8_t bytes[MH_SUMMARY_BYTES_MAX];
    struct mh_cv *head = &heads[which % HEADS];
    mh_tick time = now;
    size_t length = 0;
    if (tracker->summarise(head, now, bytes, &length) != MH_OK) {
        return;
    }
    require(length <= sizeof bytes);
    if (how & 1) {
        bytes[byte(input) % length] ^= byte(input);
    }
    if (how & 2) {
        length -= byte(input) % length;
    }
    if (how & 4) {
        time += (mh_tick)(byte(input) - 128) << byte(input) % 32;
    }
    const uint8_t cluster = how & 8 ? byte(input) : which % HEADS;
    const enum mh_status status = mh_centre_fusion.take(&centre, cluster, time, bytes, length);
    if ((status == MH_OK || status == MH_ERR_REPEATED) && !(how & 16)) {
        tracker->summary_taken(head, time);
    }
}

static void fuse(struct input *input, uint8_t how)
{
    uint8_t bytes[MH_SUMMARY_BYTES_MAX];
    struct mh_estimate estimate;
    size_t length = 0;
    const mh_tick time = how & 2 ? now + (mh_tick)(byte(input) - 128) * 100 : now;
    if (mh_centre_fusion.fuse(&centre, time, &estimate) == MH_OK) {
        check(&estimate);
        require(mh_gaussian_check(&centre.state) == MH_OK);
    }
    if (mh_centre_fusion.feedback(&centre, bytes, &length) != MH_OK) {
        return;
    }
    require(length <= sizeof bytes);
    for (int h = 0; h < HEADS; h++) {
        if (how & 4) {
            bytes[byte(input) % length] ^= byte(input);
        }
        if (mh_summary_holds(bytes, length, (uint8_t)h) && !(how & 8)) {
            tracker->summary_taken(&heads[h], time);
        }
        if (!(how & 1)) {
            tracker->correct(&heads[h], time, bytes, length);
        }
        if (tracker->predict(&heads[h], now + 5000, &estimate) == MH_OK) {
            check(&estimate);
        }
    }
}

static void read_gaussian(struct input *input)
{
    uint8_t bytes[BYTES_MAX], again[BYTES_MAX];
    struct mh_gaussian gaussian = {.n = UINT8_MAX};
    const uint8_t n = byte(input) % (MH_STATES_MAX + 3);
    bytes_of(input, bytes, n <= MH_STATES_MAX ? (size_t)MH_GAUSSIAN_BYTES(n) : 0);
    if (mh_gaussian_read(&gaussian, n, bytes) == MH_OK) {
        require(mh_gaussian_check(&gaussian) == MH_OK && gaussian.n == n);
        require(mh_gaussian_write(&gaussian, again) == (size_t)MH_GAUSSIAN_BYTES(n));
        require(memcmp(bytes, again, (size_t)MH_GAUSSIAN_BYTES(n)) == 0);
    } else {
        require(gaussian.n == UINT8_MAX && gaussian.x[0] == 0 && gaussian.P[0] == 0);
    }
}

static void read_raw(struct input *input, uint8_t how)
{
    uint8_t bytes[MH_SUMMARY_BYTES_MAX], again[MH_SUMMARY_BYTES_MAX];
    struct mh_summary summary;
    const struct mh_fusion_slot before = centre.slots[how % HEADS];
    const size_t length = bytes_of(input, bytes, byte(input) % (sizeof bytes + 1));
    if (mh_summary_read(&summary, bytes, length) == MH_OK) {
        require(mh_summary_write(&summary, again) == length && memcmp(bytes, again, length) == 0);
    }
    if (mh_centre_fusion.take(&centre, how % HEADS, now, bytes, length) == MH_ERR_CORRUPT) {
        const struct mh_fusion_slot *after = &centre.slots[how % HEADS];
        require(after->time == before.time && after->held == before.held && after->fresh == before.fresh);
        for (int i = 0; i < MH_PACKED_SIZE(MH_SUMMARY_STATES); i++) {
            require(before.P[i] == after->P[i]);
        }
    }
    if (how & 128) {
        tracker->correct(&heads[how % HEADS], now, bytes, length);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct input input = {data, size};
    struct mh_fusion_centre_config config;
    struct mh_cv_config cv;
    mh_fusion_centre_config_default(&config);
    mh_cv_config_default(&cv);
    config.rule = (enum mh_fusion_rule)(byte(&input) % MH_FUSION_CENTRAL);
    const uint8_t flags = byte(&input);
    config.clusters = HEADS;
    config.keep = flags & 1 ? 0 : config.keep;
    cv.summary = mh_summary_kind_of(config.rule);
    tracker = flags & 2 ? &mh_tracker_cv_ekf : &mh_tracker_cv_ukf;
    memset(heads, 0, sizeof heads);
    memset(&centre, 0, sizeof centre);
    now = flags & 4 ? 0xfffff000u : 0;
    config.start_time = cv.start = now;
    require(mh_centre_fusion.init(&centre, &config) == MH_OK);
    for (int h = 0; h < HEADS; h++) {
        require(tracker->init(&heads[h], &cv, 500) == MH_OK);
    }
    for (int event = 0; event < EVENTS_MAX && input.left > 0; event++) {
        const uint8_t what = byte(&input);
        switch (what % 8) {
        case 0: {
            now += ((mh_tick)byte(&input) + 1) * 8;
            const uint8_t count = byte(&input) % (SAMPLES_MAX + 1);
            for (int h = 0; h < HEADS; h++) {
                step(&input, &heads[h], count);
            }
            break;
        }
        case 1: {
            const uint8_t which = byte(&input);
            tell(&input, which, byte(&input));
            break;
        }
        case 2:
            fuse(&input, byte(&input));
            break;
        case 3:
            read_raw(&input, byte(&input));
            break;
        case 4:
            read_gaussian(&input);
            break;
        default:
            now += (mh_tick)(what / 8) << byte(&input) % 28;
            break;
        }
    }
    return 0;
}
