/* Places, in the integers of a sensor node and in the reals of a cluster head. */
#ifndef MOTEHOUND_GEOMETRY_H
#define MOTEHOUND_GEOMETRY_H

#include "motehound/real.h"

#include <stdint.h>

/* Largest size of a coordinate: 1,000 km, so that differences fit in 32 bits. */
#define MH_COORDINATE_MAX_MM ((int32_t)1000000000)

/* A place in the field's own frame, in millimetres: what a node knows of itself and what frames carry. Each
 * coordinate within +- MH_COORDINATE_MAX_MM. */
struct mh_place {
    int32_t x_mm, y_mm, z_mm;
};

/* A point or vector in the plane, in metres, relative to an origin near the work. */
struct mh_vec2 {
    mh_real x, y;
};

/* Symmetric 2 x 2 matrix. */
struct mh_sym2 {
    mh_real xx, xy, yy;
};

/* A rectangle of the field, in millimetres, borders included. */
struct mh_region {
    int32_t x_min_mm, x_max_mm, y_min_mm, y_max_mm;
};

/* (cos angle, sin angle) for |angle| <= pi, each within 3e-6 (fixed point: 5e-4): by polynomials of half the angle, without branches, so that a loop of them is
 * vectorised where the processor can. 16 multiplications. */
static inline struct mh_vec2 mh_direction(mh_real angle)
{
    const mh_real half = angle / 2, square = mh_squared(half);
    const mh_real sine =
        mh_mul(half, MH_REAL(9.99996616e-1f) +
                         mh_mul(square,
                                MH_REAL(-1.66648284e-1f) +
                                    mh_mul(square, MH_REAL(8.30632523e-3f) - mh_mul(square, MH_REAL(1.83636540e-4f)))));
    const mh_real cosine =
        MH_REAL(9.99999953e-1f) +
        mh_mul(square, MH_REAL(-4.99999053e-1f) +
                           mh_mul(square, MH_REAL(4.16635847e-2f) +
                                              mh_mul(square, MH_REAL(-1.38537043e-3f) +
                                                                 mh_mul(square, MH_REAL(2.31539316e-5f)))));
    const struct mh_vec2 direction = {mh_squared(cosine) - mh_squared(sine), 2 * mh_mul(sine, cosine)};
    return direction;
}

static inline bool mh_vec2_finite(struct mh_vec2 v) { return mh_finite(v.x) && mh_finite(v.y); }

/* b - a */
static inline struct mh_vec2 mh_vec2_between(struct mh_vec2 a, struct mh_vec2 b)
{
    const struct mh_vec2 difference = {mh_add(b.x, -a.x), mh_add(b.y, -a.y)};
    return difference;
}

/* a + factor b */
static inline struct mh_vec2 mh_vec2_along(struct mh_vec2 a, mh_real factor, struct mh_vec2 b)
{
    const struct mh_vec2 sum = {mh_add(a.x, mh_mul(factor, b.x)), mh_add(a.y, mh_mul(factor, b.y))};
    return sum;
}

static inline mh_wide mh_vec2_dot(struct mh_vec2 a, struct mh_vec2 b)
{
    return mh_wide_mul(a.x, b.x) + mh_wide_mul(a.y, b.y);
}

static inline mh_wide mh_vec2_square(struct mh_vec2 a) { return mh_vec2_dot(a, a); }
static inline mh_real mh_vec2_length(struct mh_vec2 a) { return mh_wide_sqrt(mh_vec2_square(a)); }

/* True if mm may be a coordinate of a place. */
static inline bool mh_coordinate_valid(int32_t mm) { return mm >= -MH_COORDINATE_MAX_MM && mm <= MH_COORDINATE_MAX_MM; }

/* True if the horizontal distance between a and b is at most radius_mm. Integers only. */
static inline bool mh_place_within(const struct mh_place *a, const struct mh_place *b, uint32_t radius_mm)
{
    int64_t dx = (int64_t)a->x_mm - b->x_mm;
    int64_t dy = (int64_t)a->y_mm - b->y_mm;
    return (uint64_t)(dx * dx + dy * dy) <= (uint64_t)radius_mm * radius_mm;
}

/* Horizontal distance between a and b, rounded down. Integers only; about 32 steps of 64 bits. */
uint32_t mh_place_distance_mm(const struct mh_place *a, const struct mh_place *b);

/* floor of the square root */
uint32_t mh_square_root(uint64_t square);

/* Millimetres as metres. */
#if MH_REAL_FIXED
mh_real mh_metres(int32_t mm);
#else
static inline mh_real mh_metres(int32_t mm) { return mh_real_from_ratio(mm, 1000); }
#endif

/* place - origin in metres, horizontal part. */
static inline struct mh_vec2 mh_place_relative(const struct mh_place *place, const struct mh_place *origin)
{
    struct mh_vec2 v = {mh_metres(place->x_mm - origin->x_mm), mh_metres(place->y_mm - origin->y_mm)};
    return v;
}

/* For the mean of places relative to an origin; begins as all zero. Fixed point: in millimetres, so that it does not overflow. */
struct mh_place_sum {
#if MH_REAL_FIXED
    int64_t x_mm, y_mm;
#else
    mh_real x, y;
#endif
};

static inline void mh_place_sum_add(struct mh_place_sum *sum, const struct mh_place *place,
                                    const struct mh_place *origin)
{
#if MH_REAL_FIXED
    sum->x_mm += (int64_t)place->x_mm - origin->x_mm;
    sum->y_mm += (int64_t)place->y_mm - origin->y_mm;
#else
    const struct mh_vec2 at = mh_place_relative(place, origin);
    sum->x += at.x;
    sum->y += at.y;
#endif
}

/* The mean of `count` >= 1. */
static inline struct mh_vec2 mh_place_sum_mean(const struct mh_place_sum *sum, int32_t count)
{
#if MH_REAL_FIXED
    const struct mh_vec2 mean = {mh_metres((int32_t)(sum->x_mm / count)), mh_metres((int32_t)(sum->y_mm / count))};
#else
    const struct mh_vec2 mean = {sum->x / mh_real_from_int(count), sum->y / mh_real_from_int(count)};
#endif
    return mean;
}

/* origin + offset, rounded to the millimetre; z is the origin's. Saturates at the range of a coordinate. */
struct mh_place mh_place_from_offset(const struct mh_place *origin, struct mh_vec2 offset);

#endif
