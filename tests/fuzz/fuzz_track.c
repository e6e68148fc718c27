/* Tracks that are handed over: load() on any bytes.
 *
 * The first byte chooses the tracker, the second the length of the track that follows, if it can be handed over; then come instants, each with its distance in time and its
 * measurements (bit 6 of the first byte: far places, any values), and of trackers that know others, now and then the track of one, which may be joined: one that was saved before, with some bytes changed. Whatever is loaded: a refusal leaves
 * no track, estimates are finite numbers with covariances that are one, and what is saved again is taken again. */
#include "fuzz.h"
#include "motehound/centroid.h"
#include "motehound/luo.h"
#include "motehound/pftl.h"
#if !MH_REAL_FIXED
#include "motehound/acoustic.h"
#include "motehound/gas.h"
#include "motehound/gas_wind.h"
#include "motehound/msl.h"
#include "motehound/range.h"
#endif

#include <string.h>

enum { INTERVAL = 2000, INSTANTS_MAX = 20, NODES = 6, WITH_WIND = 9 };

union state {
    struct mh_pftl pftl;
    struct mh_centroid_state centroid;
    struct mh_luo luo;
#if !MH_REAL_FIXED
    struct mh_range range;
    struct mh_msl msl;
    struct mh_gas gas;
    struct mh_gas_gaussian gas_gaussian;
    struct mh_gas_wind gas_wind;
    struct mh_acoustic acoustic;
#endif
};

/* Of two variances and their covariance, as far as rounding leaves it so. */
static void check_covariance(mh_real xx, mh_real xy, mh_real yy)
{
    const double step = MH_REAL_FIXED, a = (double)xx + step, b = (double)yy + step;
    require(mh_finite(xx) && mh_finite(xy) && mh_finite(yy) && xx >= 0 && yy >= 0);
    require((double)xy * (double)xy <= a * b * (1 + 1e-5));
}

static void check(const struct mh_estimate *estimate)
{
    const struct mh_sym2 c = estimate->covariance;
    require(mh_finite(estimate->position.x) && mh_finite(estimate->position.y));
    require(mh_finite(estimate->velocity.x) && mh_finite(estimate->velocity.y));
    require(mh_finite(estimate->stored.x) && mh_finite(estimate->stored.y));
    require(mh_finite(estimate->stored_velocity.x) && mh_finite(estimate->stored_velocity.y));
    require(mh_finite(estimate->rate));
    check_covariance(c.xx, c.xy, c.yy);
    require(mh_coordinate_valid(estimate->origin.x_mm) && mh_coordinate_valid(estimate->origin.y_mm));
    if (estimate->states == 3) {
        const mh_real *more = estimate->covariance_more;
        check_covariance(c.xx, more[0], more[2]);
        check_covariance(c.yy, more[1], more[2]);
    }
}

static mh_tick time_of(const uint8_t *track)
{
    return (mh_tick)track[0] << 24 | (mh_tick)track[1] << 16 | (mh_tick)track[2] << 8 | track[3];
}

static int32_t any(struct input *input)
{
    uint32_t bits = 0;
    for (int i = 0; i < 4; i++) {
        bits = bits << 8 | byte(input);
    }
    return (int32_t)bits;
}

/* A coordinate within 128 m of this one, or any. */
static int32_t beside(int32_t mm, struct input *input, int far)
{
    const int64_t sum = mm + (far ? any(input) : (int64_t)(byte(input) - 128) * 1000);
    return (int32_t)(sum > MH_COORDINATE_MAX_MM    ? MH_COORDINATE_MAX_MM
                     : sum < -MH_COORDINATE_MAX_MM ? -MH_COORDINATE_MAX_MM
                                                   : sum);
}

/* Another track beside this one, or to join it: bytes that were saved before, some of them changed. */
static void meet(const struct mh_tracker *tracker, void *state, struct input *input, const uint8_t *saved,
                 size_t length)
{
    static uint8_t bytes[MH_TRACK_BYTES_MAX]; /* until the next step */
    uint8_t part[MH_TRACK_BYTES_MAX];
    const uint8_t changes = byte(input) % 4, kind = byte(input);
    uint32_t target;
    size_t part_length;
    memcpy(bytes, saved, length);
    for (uint8_t i = 0; i < changes && length > 0; i++) {
        const size_t at = byte(input) % length;
        bytes[at] = byte(input);
    }
    const struct mh_saved_track other = {kind % 3u, bytes, length - (kind & 128 && length > 0)};
    const enum mh_status beside = tracker->among(state, kind & 32 ? 1 : 0, &other, 1);
    require(beside == MH_OK || beside == MH_ERR_CORRUPT || beside == MH_ERR_ARGUMENT);
    if (kind & 64 && tracker->join != NULL) {
        tracker->join(state, &other);
    }
    if (tracker->part != NULL && tracker->part(state, kind % 4u, &target, part, &part_length) == MH_OK) {
        require(part_length <= MH_TRACK_BYTES_MAX);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const struct mh_tracker *const trackers[] = {FLOAT_ONLY(&mh_tracker_range),
                                                        FLOAT_ONLY(&mh_tracker_range),
                                                        &mh_tracker_pftl,
                                                        FLOAT_ONLY(&mh_tracker_msl),
                                                        &mh_tracker_centroid,
                                                        FLOAT_ONLY(&mh_tracker_gas),
                                                        FLOAT_ONLY(&mh_tracker_gas_small),
                                                        FLOAT_ONLY(&mh_tracker_gas_ekf),
                                                        FLOAT_ONLY(&mh_tracker_gas_ukf),
                                                        FLOAT_ONLY(&mh_tracker_gas_wind),
                                                        FLOAT_ONLY(&mh_tracker_acoustic),
                                                        FLOAT_ONLY(&mh_tracker_acoustic),
                                                        FLOAT_ONLY(&mh_tracker_dm),
                                                        FLOAT_ONLY(&mh_tracker_ml),
                                                        &mh_tracker_luo};
    static union state state, other;
    struct mh_pftl_config pftl;
    struct mh_centroid_config centroid;
    struct mh_luo_config luo;
    mh_pftl_config_default(&pftl);
    mh_centroid_config_default(&centroid);
    mh_luo_config_default(&luo);
#if !MH_REAL_FIXED
    struct mh_range_config range, errors;
    struct mh_msl_config msl;
    struct mh_gas_config gas;
    struct mh_gas_wind_config gas_wind;
    mh_range_config_default(&range);
    mh_msl_config_default(&msl);
    mh_gas_config_default(&gas);
    mh_gas_wind_config_default(&gas_wind);
    gas_wind.place_count = 3;
    gas_wind.places[1].x_mm = 40000;
    gas_wind.places[2].y_mm = 60000;
    gas_wind.learn = 0;
    range.sensing_range_m = 50;
    range.tolerance_m = 5;
    errors = range;
    errors.bias_sd_m = 1;
    errors.scale_sd = 0.1f;
    struct mh_acoustic_config acoustic, groups, plain;
    mh_acoustic_config_default(&acoustic, 40);
    groups = plain = acoustic;
    mh_group_config_default(&groups.group, MH_GROUP_MEMBERS);
    plain.separation = MH_SEPARATION_DECOMPOSITION;
    plain.filtered = false;
#endif
    const void *const configs[] = {FLOAT_ONLY(&range),
                                   FLOAT_ONLY(&errors),
                                   &pftl,
                                   FLOAT_ONLY(&msl),
                                   &centroid,
                                   FLOAT_ONLY(&gas),
                                   FLOAT_ONLY(&gas),
                                   FLOAT_ONLY(&gas),
                                   FLOAT_ONLY(&gas),
                                   FLOAT_ONLY(&gas_wind),
                                   FLOAT_ONLY(&acoustic),
                                   FLOAT_ONLY(&groups),
                                   FLOAT_ONLY(&plain),
                                   FLOAT_ONLY(&plain),
                                   &luo};
    struct input input = {data, size};
    const uint8_t choice = byte(&input);
    const uint8_t which = choice % 64 % (sizeof trackers / sizeof trackers[0]);
    const struct mh_tracker *const tracker = trackers[which];
    if (tracker == NULL) {
        return 0;
    }
    pftl.particles = (uint16_t)(choice & 128 ? 3 : 50);
#if !MH_REAL_FIXED
    msl.particles = pftl.particles;
#endif
    uint8_t track[MH_TRACK_BYTES_MAX + 8];
    memset(track, 0, sizeof track);
    size_t length = byte(&input);
    length = length < input.left ? length : input.left;
    length = length < sizeof track ? length : sizeof track;
    memcpy(track, input.data, length);
    input.data += length;
    input.left -= length;
    memset(&state, 0, sizeof state);
    require(tracker->init(&state, configs[which], INTERVAL) == MH_OK);
    struct mh_estimate estimate;
    if (tracker->load != NULL && tracker->load(&state, track, length) != MH_OK) {
        require(tracker->predict(&state, 0, &estimate) == MH_NONE);
        require(tracker->save != NULL && tracker->save(&state, track, &length) == MH_NONE);
        return 0;
    }
    mh_tick now = time_of(tracker->among != NULL ? track + 1 : track);
    if (tracker->predict(&state, now, &estimate) == MH_OK) {
        check(&estimate);
    }
    for (int i = 0; i < INSTANTS_MAX && input.left > 0; i++) {
        struct mh_measurement set[NODES];
        const uint8_t what = byte(&input), count = what % (NODES + 1);
        struct mh_place centre;
        memset(set, 0, sizeof set);
        now += (mh_tick)INTERVAL << (what & 128 ? byte(&input) % 20 : 0);
        centre = tracker->predict(&state, now, &estimate) == MH_OK
                     ? mh_place_from_offset(&estimate.origin, estimate.position)
                     : (struct mh_place){0, 0, 0};
        for (uint8_t k = 0; k < count; k++) {
            set[k].node = k;
            set[k].place.x_mm = beside(centre.x_mm, &input, choice & 64);
            set[k].place.y_mm = beside(centre.y_mm, &input, choice & 64);
            set[k].time = now;
            if (which == WITH_WIND && k < 2) { /* the first node has an anemometer */
                set[k].node = 0;
                set[k].target = k == 0 ? MH_TARGET_WIND_X : MH_TARGET_WIND_Y;
            }
            set[k].value = choice & 64 ? any(&input) : ((mh_q20)byte(&input) - 20) * MH_Q20_ONE;
            if (tracker == &mh_tracker_luo) {
                set[k].increment = set[k].value;
                set[k].flags = MH_MEASUREMENT_HAS_INCREMENT;
            }
        }
        if (tracker->among != NULL && what & 16) {
            meet(tracker, &state, &input, track, length);
        }
        if (tracker->step(&state, now, set, count, &estimate) == MH_OK) {
            check(&estimate);
        }
        if (what & 64 && tracker->restart != NULL) {
            tracker->restart(&state);
        }
        if (tracker->save != NULL && tracker->load != NULL && tracker->save(&state, track, &length) == MH_OK) {
            require(length <= MH_TRACK_BYTES_MAX);
            require(tracker->init(&other, configs[which], INTERVAL) == MH_OK);
            if (tracker->among != NULL && tracker->predict(&state, now, &estimate) == MH_OK) {
                require(tracker->among(&other, estimate.target, NULL, 0) == MH_OK);
            }
            require(tracker->load(&other, track, length) == MH_OK);
            if (what & 32) {
                state = other;
            }
        }
    }
    return 0;
}
