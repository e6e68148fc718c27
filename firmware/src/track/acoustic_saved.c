#include "acoustic_parts.h"
#include "motehound/bytes.h"

enum { MOTION = 4 }; /* states x, y, vx, vy */

#define VELOCITY_UNITS 256 /* in 1 m/s */
#define VELOCITY_MOST MH_REAL(127.0f)

/* The first byte: mode, refused, moving */
#define MODE_MASK 3u
#define REFUSED_SHIFT 2
#define REFUSED_MASK 3u
#define MOVING 16u
#define KIND 0xa0u
#define KIND_MASK 0xe0u

static void put_velocity(uint8_t **at, mh_real velocity)
{
    mh_put_u16(at, (uint16_t)mh_real_round(VELOCITY_UNITS * mh_clamp(velocity, -VELOCITY_MOST, VELOCITY_MOST)));
}

size_t mh_acoustic_write(const struct mh_acoustic_track *track, uint8_t *bytes)
{
    const struct mh_place place = mh_place_from_offset(&track->origin, mh_acoustic_position(track));
    uint8_t *at = bytes;
    *at++ = (uint8_t)(KIND | track->mode | (unsigned)track->refused << REFUSED_SHIFT | (track->moving ? MOVING : 0u));
    mh_put_u32(&at, track->updated);
    mh_put_u32(&at, (uint32_t)place.x_mm);
    mh_put_u32(&at, (uint32_t)place.y_mm);
    put_velocity(&at, track->filter.x[2]);
    put_velocity(&at, track->filter.x[3]);
    mh_kalman_write_factors(&track->filter, &at);
    for (int i = 0; i < 3; i++) {
        *at++ = track->speeds[i];
    }
    at += mh_group_write(&track->group, at);
    return (size_t)(at - bytes);
}

enum mh_status mh_acoustic_read(struct mh_acoustic_track *track, uint32_t target, const uint8_t *bytes, size_t length)
{
    const uint8_t *at = bytes;
    size_t taken;
    if (length < MH_ACOUSTIC_HEADER_BYTES || (bytes[0] & KIND_MASK) != KIND) {
        return MH_ERR_CORRUPT;
    }
    struct mh_acoustic_track read = {.filter = {.n = MOTION, .moving = MOTION}};
    const uint8_t first = *at++;
    read.mode = (uint8_t)(first & MODE_MASK);
    read.refused = (uint8_t)(first >> REFUSED_SHIFT & REFUSED_MASK);
    read.moving = (first & MOVING) != 0;
    read.updated = mh_get_u32(&at);
    read.origin.x_mm = mh_get_i32(&at);
    read.origin.y_mm = mh_get_i32(&at);
    read.filter.x[2] = mh_real_from_ratio(mh_get_i16(&at), VELOCITY_UNITS);
    read.filter.x[3] = mh_real_from_ratio(mh_get_i16(&at), VELOCITY_UNITS);
    const enum mh_status factors = mh_kalman_read_factors(&read.filter, &at);
    for (int i = 0; i < 3; i++) {
        read.speeds[i] = *at++;
    }
    if (read.mode > MH_TARGET_GROUP || !mh_coordinate_valid(read.origin.x_mm) ||
        !mh_coordinate_valid(read.origin.y_mm) || factors != MH_OK ||
        mh_group_read(&read.group, target, at, length - MH_ACOUSTIC_HEADER_BYTES, &taken) != MH_OK ||
        taken != length - MH_ACOUSTIC_HEADER_BYTES) {
        return MH_ERR_CORRUPT;
    }
    *track = read;
    return MH_OK;
}

enum mh_status mh_acoustic_advance(struct mh_acoustic_track *track, mh_real acceleration_psd, mh_tick time)
{
    mh_real F[MOTION * MOTION];
    mh_real Q[MH_PACKED_SIZE(MOTION)];
    if (mh_tick_before(time, track->updated)) {
        return MH_ERR_TIME;
    }
    if (time == track->updated) {
        return MH_OK;
    }
    mh_kalman_constant_velocity(mh_seconds_between(track->updated, time), acceleration_psd, F, Q);
    const enum mh_status status = mh_kalman_predict(&track->filter, F, Q);
    if (status == MH_OK) {
        track->updated = time;
    }
    return status;
}

struct mh_vec2 mh_acoustic_velocity(const struct mh_acoustic_track *track)
{
    struct mh_vec2 velocity = {track->filter.x[2], track->filter.x[3]};
    const mh_wide square = mh_vec2_square(velocity);
    mh_real scale = MH_REAL(1.0f);
    if (!track->moving || square < mh_wide_mul(MH_ACOUSTIC_SLOWEST_MPS, MH_ACOUSTIC_SLOWEST_MPS)) {
        scale = 0;
    } else if (square > mh_wide_mul(MH_ACOUSTIC_FASTEST_MPS, MH_ACOUSTIC_FASTEST_MPS)) {
        scale = mh_div(MH_ACOUSTIC_FASTEST_MPS, mh_wide_sqrt(square));
    }
    velocity.x = mh_mul(velocity.x, scale);
    velocity.y = mh_mul(velocity.y, scale);
    return velocity;
}

struct mh_sym2 mh_acoustic_covariance(const struct mh_acoustic_track *track)
{
    mh_real P[MH_PACKED_SIZE(2)];
    mh_kalman_covariance_of(&track->filter, 2, P);
    const struct mh_sym2 covariance = {P[0], P[1], P[2]};
    return covariance;
}

static mh_real largest_speed(const struct mh_acoustic_track *track)
{
    uint8_t largest = 0;
    for (int i = 0; i < 3; i++) {
        largest = track->speeds[i] > largest ? track->speeds[i] : largest;
    }
    return mh_real_from_ratio(largest, MH_ACOUSTIC_SPEEDS_A_MPS);
}

mh_real mh_acoustic_largest_speed(const struct mh_acoustic *acoustic)
{
    return acoustic->tracking ? largest_speed(&acoustic->track) : 0;
}

enum mh_status mh_acoustic_look(uint32_t target, const uint8_t *bytes, size_t length, mh_tick time,
                                struct mh_acoustic_summary *summary)
{
    struct mh_acoustic_track track;
    if (bytes == NULL || summary == NULL || mh_acoustic_read(&track, target, bytes, length) != MH_OK) {
        return MH_ERR_CORRUPT;
    }
    const struct mh_vec2 velocity = mh_acoustic_velocity(&track);
    const mh_real seconds = mh_seconds_between(track.updated, time);
    const struct mh_vec2 way = {mh_mul(seconds, velocity.x), mh_mul(seconds, velocity.y)};
    const struct mh_acoustic_summary found = {
        .place = mh_place_from_offset(&track.origin, way),
        .velocity = velocity,
        .fixed = track.updated,
        .largest_speed = largest_speed(&track),
        .extent = mh_group_extent(&track.group),
        .members = track.group.count,
    };
    *summary = found;
    return MH_OK;
}
