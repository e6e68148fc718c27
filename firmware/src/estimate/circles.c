#include "motehound/circles.h"

#include <stddef.h>

/* COINCIDENT: m; centres that are no farther apart show no direction. POINT: m; a triangle of no larger perimeter is one. TOUCH: of the square of the sum of the radii; less is
 * rounding. COLLINEAR: of the square of the longer side. DAMPING: of the sum of three squares of cosines. */
#if MH_REAL_FIXED
#define COINCIDENT MH_REAL(0.0625f)
#define POINT MH_REAL(1e-3f)
#define DAMPING MH_REAL(0.01f)
#else
#define COINCIDENT 1e-6f
#define POINT 1e-9f
#define TOUCH 1e-6f
#define DAMPING 1e-6f
#define COLLINEAR 1e-6f
#endif
#define TOUCH_M MH_REAL(0.1f)   /* m */
#define FARTHEST MH_REAL(40.0f) /* m: a circle that touches all three is no larger */

enum { STEPS = 8 };
#define STEP_MAX MH_REAL(20.0f) /* m */

#if MH_REAL_FIXED
/* True if squares of lengths of this size have room, so that wide products need not be. */
static bool is_short(struct mh_vec2 a)
{
    const mh_real most = MH_REAL(127.0f);
    return mh_within(a.x, -most, most) && mh_within(a.y, -most, most);
}

static mh_real dot(struct mh_vec2 a, struct mh_vec2 b) { return mh_mul(a.x, b.x) + mh_mul(a.y, b.y); }

static mh_real square_of(struct mh_vec2 a) { return is_short(a) ? dot(a, a) : mh_wide_to_real(mh_vec2_square(a)); }
static mh_real length_of(struct mh_vec2 a) { return is_short(a) ? mh_sqrt(dot(a, a)) : mh_vec2_length(a); }
#else
static mh_real square_of(struct mh_vec2 a) { return mh_vec2_square(a); }
static mh_real length_of(struct mh_vec2 a) { return mh_vec2_length(a); }
#endif

static mh_real distance(struct mh_vec2 a, struct mh_vec2 b) { return length_of(mh_vec2_between(a, b)); }

static struct mh_vec2 middle(struct mh_vec2 a, struct mh_vec2 b)
{
    const struct mh_vec2 m = {a.x / 2 + b.x / 2, a.y / 2 + b.y / 2};
    return m;
}

/* How two circles lie to each other: the way d from the first centre to the second, and the square of its length. */
struct pair {
    const struct mh_circle *a, *b;
    struct mh_vec2 way;
    mh_real square;
};

/* False if the centres coincide. */
static bool pair_of(const struct mh_circle *a, const struct mh_circle *b, struct pair *pair)
{
    const struct mh_vec2 way = mh_vec2_between(a->centre, b->centre);
    const struct pair p = {a, b, way, square_of(way)};
    *pair = p;
    return p.square >= mh_squared(COINCIDENT);
}

/* The point at a share of the way. */
static struct mh_vec2 on_way(const struct pair *pair, mh_real share)
{
    return mh_vec2_along(pair->a->centre, share, pair->way);
}

static struct mh_vec2 between(const struct pair *pair)
{
    const mh_real ra = pair->a->radius;
    const mh_real rb = pair->b->radius;
    const mh_real apart = length_of(pair->way);
    const mh_real gap = apart >= mh_abs(ra - rb) ? ra - rb : ra > rb ? ra + rb : -ra - rb;
    return on_way(pair, MH_REAL(0.5f) + mh_div(gap / 2, apart));
}

/* The common chord of two circles: its middle, the way from there to its first end, and the square of that. */
struct chord {
    struct mh_vec2 foot, aside;
    mh_real square;
};

/* False if the circles do not meet. */
static bool chord_of(const struct pair *pair, struct chord *chord)
{
    const mh_real sum = pair->a->radius + pair->b->radius;
    const mh_real difference = pair->a->radius - pair->b->radius;
    const mh_real largest = mh_squared(sum);
    const mh_real overlap = largest - pair->square;
    const mh_real outside = pair->square - mh_squared(difference);
#if MH_REAL_FIXED /* not by the inverse of the square, which has few digits */
    /* that of the centres, and so twice the sum of it in the square */
    const mh_real rounding = mh_real_from_bits(-(mh_real_to_bits(sum) >> (MH_REAL_BITS - 1)));
    if (overlap < rounding || outside < rounding) {
        return false;
    }
    const mh_real root = mh_wide_sqrt(mh_wide_mul(mh_max(overlap, 0), mh_max(outside, 0)));
    const mh_real half = mh_div(root / 2, pair->square);
    chord->foot = on_way(pair, MH_REAL(0.5f) + mh_div(mh_mul(sum, difference) / 2, pair->square));
    chord->square = mh_mul(mh_mul(half, root), MH_REAL(0.5f));
#else
    const mh_real rounding = -TOUCH * largest;
    if (overlap < rounding || outside < rounding) {
        return false;
    }
    const mh_real half_inverse = 0.5f / pair->square;
    const mh_real half = half_inverse * mh_sqrt(mh_max(overlap * outside, 0));
    chord->foot = on_way(pair, 0.5f + half_inverse * sum * difference);
    chord->square = half * half * pair->square;
#endif
    chord->aside.x = -mh_mul(half, pair->way.y);
    chord->aside.y = mh_mul(half, pair->way.x);
    return true;
}

static struct mh_vec2 end_of(const struct chord *chord, bool second)
{
    struct mh_vec2 end = chord->foot;
    if (second) {
        end.x -= chord->aside.x;
        end.y -= chord->aside.y;
    } else {
        end.x += chord->aside.x;
        end.y += chord->aside.y;
    }
    return end;
}

struct mh_vec2 mh_two_circles(const struct mh_circle *a, const struct mh_circle *b)
{
    struct pair pair;
    return pair_of(a, b, &pair) ? between(&pair) : a->centre;
}

struct mh_vec2 mh_two_circles_chord(const struct mh_circle *a, const struct mh_circle *b)
{
    struct pair pair;
    struct chord chord;
    if (!pair_of(a, b, &pair)) {
        return a->centre;
    }
    return chord_of(&pair, &chord) ? chord.foot : between(&pair);
}

/* The chord of two circles that are not concentric. */
static bool common_chord(const struct mh_circle *a, const struct mh_circle *b, struct chord *chord)
{
    struct pair pair;
    return pair_of(a, b, &pair) && chord_of(&pair, chord);
}

bool mh_crossings(const struct mh_circle *a, const struct mh_circle *b, struct mh_vec2 crossings[2])
{
    struct chord chord;
    if (!common_chord(a, b, &chord)) {
        return false;
    }
    crossings[0] = end_of(&chord, false);
    crossings[1] = end_of(&chord, true);
    return true;
}

/* What a pair says to the variant uniform: its chord, or else its one point, as a chord without length. */
static void chord_or_point(const struct mh_circle *a, const struct mh_circle *b, struct chord *chord)
{
    struct pair pair;
    const bool apart = pair_of(a, b, &pair);
    if (!apart || !chord_of(&pair, chord)) {
        const struct chord point = {apart ? between(&pair) : a->centre, {0, 0}, 0};
        *chord = point;
    }
}

/* Which end of a chord is nearer to a circle; of equals the first, or `otherwise` the second. With p, q the ends' distances from its centre it is the
 * farther one where p + q < 2 r; with f the middle of the chord from there and a half of the chord, where m = (p^2 + q^2) / 2 = f^2 + a^2 < 2 r^2 and
 * (f . a)^2 > r^2 (m - r^2). */
static struct mh_vec2 nearer(const struct chord *chord, const struct mh_circle *circle, bool otherwise)
{
    const struct mh_vec2 f = mh_vec2_between(circle->centre, chord->foot);
#if MH_REAL_FIXED /* of what is farther away than 127 m both ends are outside the circle */
    const mh_real along = is_short(f) ? dot(f, chord->aside) : mh_wide_to_real(mh_vec2_dot(f, chord->aside));
#else
    const mh_real along = f.x * chord->aside.x + f.y * chord->aside.y;
#endif
    if (along == 0) {
        return end_of(chord, otherwise);
    }
    const mh_real r = mh_squared(circle->radius);
#if MH_REAL_FIXED
    const mh_real excess = mh_add(square_of(f), chord->square - r);
    const bool within = excess < r && (excess <= 0 || mh_abs(along) > mh_mul(circle->radius, mh_sqrt(excess)));
#else
    const mh_real excess = f.x * f.x + f.y * f.y + chord->square - r;
    const bool within = excess < r && along * along > r * excess;
#endif
    return end_of(chord, (along > 0) != within);
}

/* The centre of the incircle of a triangle -> its perimeter. */
static mh_real incentre(struct mh_vec2 a, struct mh_vec2 b, struct mh_vec2 c, struct mh_vec2 *centre)
{
    const struct mh_vec2 ab = mh_vec2_between(a, b);
    const struct mh_vec2 ac = mh_vec2_between(a, c);
    const mh_real to_a = distance(b, c);
    const mh_real to_b = length_of(ac);
    const mh_real to_c = length_of(ab);
    const mh_real perimeter = mh_add(mh_add(to_a, to_b), to_c);
    if (perimeter < POINT) {
        *centre = a;
        return perimeter;
    }
#if MH_REAL_FIXED
    const mh_real of_b = mh_div(to_b, perimeter);
    const mh_real of_c = mh_div(to_c, perimeter);
#else
    const mh_real share = 1.0f / perimeter;
    const mh_real of_b = to_b * share;
    const mh_real of_c = to_c * share;
#endif
    *centre = mh_vec2_along(mh_vec2_along(a, of_b, ab), of_c, ac);
    return perimeter;
}

/* Whether |point - S_i| = r_i + rho, or r_i - rho where bit i of `minus` is set: where the centres are nearly on a line too few digits are left for it. */
static bool touches(const struct mh_circle c[3], unsigned minus, mh_real rho, struct mh_vec2 point)
{
    for (unsigned i = 0; i < 3; i++) {
        const mh_real reach = minus >> i & 1U ? c[i].radius - rho : c[i].radius + rho;
        if (!(mh_abs(mh_add(distance(point, c[i].centre), -reach)) <= TOUCH_M)) {
            return false;
        }
    }
    return true;
}

#if MH_REAL_FIXED
/* v with v . a = fa, v . b = fb. */
static struct mh_vec2 solution(struct mh_vec2 a, struct mh_vec2 b, mh_wide determinant, mh_real fa, mh_real fb)
{
    const struct mh_vec2 v = {mh_wide_ratio(mh_wide_mul(fa, b.y) - mh_wide_mul(fb, a.y), determinant),
                              mh_wide_ratio(mh_wide_mul(fb, a.x) - mh_wide_mul(fa, b.x), determinant)};
    return v;
}

/* The centre of the smallest circle that touches all three: the least rho with |p - S_i| = r_i + s_i rho, s_i = +-1. Differences of the squared equations
 * are linear, p = p0 + p1 rho, and leave a quadratic. A rho below 0 stands for the opposite signs, so that those with s_1 = 1 are all. False if there is none.
 * Products are wide; what is too large for them, where the centres are nearly on a line, ends as a circle that does not touch. */
static bool touching(const struct mh_circle c[3], struct mh_vec2 *point)
{
    const struct mh_vec2 a = mh_vec2_between(c[0].centre, c[1].centre);
    const struct mh_vec2 b = mh_vec2_between(c[0].centre, c[2].centre);
    const mh_wide determinant = mh_wide_mul(a.x, b.y) - mh_wide_mul(a.y, b.x);
    if (determinant == 0) {
        return false;
    }
    const mh_real r = c[0].radius;
    const mh_wide aa = mh_vec2_square(a) + mh_wide_mul(r - c[1].radius, r + c[1].radius);
    const mh_wide bb = mh_vec2_square(b) + mh_wide_mul(r - c[2].radius, r + c[2].radius);
    const struct mh_vec2 p0 = solution(a, b, determinant, mh_wide_to_real(aa / 2), mh_wide_to_real(bb / 2));
    if (!mh_vec2_finite(p0)) {
        return false;
    }
    const mh_real constant = mh_wide_to_real(mh_vec2_square(p0) - mh_wide_mul(r, r));
    mh_real least = FARTHEST;
    bool found = false;
    for (uint8_t minus = 0; minus < 8; minus = (uint8_t)(minus + 2)) {
        const struct mh_vec2 p1 = solution(a, b, determinant, minus & 2U ? r + c[1].radius : r - c[1].radius,
                                           minus & 4U ? r + c[2].radius : r - c[2].radius);
        if (!mh_vec2_finite(p1)) {
            continue;
        }
        const mh_real square = mh_wide_to_real(mh_vec2_square(p1) - mh_wide_mul(MH_REAL(1.0f), MH_REAL(1.0f)));
        const mh_real half = mh_wide_to_real(mh_vec2_dot(p0, p1) - mh_wide_mul(r, MH_REAL(1.0f)));
        const mh_wide discriminant = mh_wide_mul(half, half) - mh_wide_mul(square, constant);
        if (discriminant < 0) {
            continue;
        }
        const mh_real root = mh_wide_sqrt(discriminant);
        const mh_real larger = half > 0 ? mh_add(-half, -root) : mh_add(root, -half);
        const mh_real radii[] = {mh_div(constant, larger), mh_div(larger, square)};
        for (uint8_t i = 0; i < 2; i++) {
            const mh_real rho = radii[i];
            const struct mh_vec2 p = mh_vec2_along(mh_vec2_along(c[0].centre, MH_REAL(1.0f), p0), rho, p1);
            if (mh_abs(rho) <= least && touches(c, minus, rho, p)) {
                least = mh_abs(rho);
                found = true;
                *point = p;
            }
        }
    }
    return found;
}
#else
static bool touching(const struct mh_circle c[3], struct mh_vec2 *point)
{
    const struct mh_vec2 a = {c[1].centre.x - c[0].centre.x, c[1].centre.y - c[0].centre.y};
    const struct mh_vec2 b = {c[2].centre.x - c[0].centre.x, c[2].centre.y - c[0].centre.y};
    const mh_real aa = a.x * a.x + a.y * a.y;
    const mh_real bb = b.x * b.x + b.y * b.y;
    const mh_real determinant = a.x * b.y - a.y * b.x;
    if (!(mh_abs(determinant) > COLLINEAR * mh_max(aa, bb))) {
        return false;
    }
    const mh_real inverse = 1.0f / determinant;
    const mh_real r = c[0].radius;
    const mh_real fa = 0.5f * (aa + (r - c[1].radius) * (r + c[1].radius));
    const mh_real fb = 0.5f * (bb + (r - c[2].radius) * (r + c[2].radius));
    const struct mh_vec2 p0 = {(fa * b.y - fb * a.y) * inverse, (fb * a.x - fa * b.x) * inverse};
    const mh_real constant = p0.x * p0.x + p0.y * p0.y - r * r;
    mh_real least = FARTHEST;
    bool found = false;
    for (unsigned minus = 0; minus < 8; minus += 2) {
        const mh_real ga = minus & 2U ? r + c[1].radius : r - c[1].radius;
        const mh_real gb = minus & 4U ? r + c[2].radius : r - c[2].radius;
        const struct mh_vec2 p1 = {(ga * b.y - gb * a.y) * inverse, (gb * a.x - ga * b.x) * inverse};
        /* square rho^2 + 2 half rho + constant = 0 */
        const mh_real square = p1.x * p1.x + p1.y * p1.y - 1.0f;
        const mh_real half = p0.x * p1.x + p0.y * p1.y - r;
        const mh_real discriminant = half * half - square * constant;
        if (!(discriminant >= 0)) {
            continue;
        }
        const mh_real root = mh_sqrt(discriminant);
        const mh_real larger = half > 0 ? -half - root : root - half;
        const mh_real radii[] = {constant / larger, larger / square};
        for (int i = 0; i < 2; i++) {
            const mh_real rho = radii[i];
            const struct mh_vec2 p = {c[0].centre.x + p0.x + p1.x * rho, c[0].centre.y + p0.y + p1.y * rho};
            if (mh_abs(rho) <= least && touches(c, minus, rho, p)) {
                least = mh_abs(rho);
                found = true;
                *point = p;
            }
        }
    }
    return found;
}
#endif

/* sum (|p - S_i| - r_i)^2 -> min, by Gauss-Newton from the mean of the points of the pairs. */
static struct mh_vec2 least_squares(const struct mh_circle c[3])
{
    struct mh_vec2 p = {0, 0};
    for (int i = 0; i < 3; i++) {
        const struct mh_vec2 one = mh_two_circles(&c[i], &c[(i + 1) % 3]);
#if MH_REAL_FIXED /* the sum may be too large */
        p.x += one.x / 3;
        p.y += one.y / 3;
#else
        p.x += one.x;
        p.y += one.y;
#endif
    }
#if !MH_REAL_FIXED
    p.x /= 3;
    p.y /= 3;
#endif
    for (int step = 0; step < STEPS; step++) {
        struct mh_sym2 normal = {DAMPING, 0, DAMPING};
        struct mh_vec2 right = {0, 0};
        for (int i = 0; i < 3; i++) {
            const mh_real away = distance(p, c[i].centre);
            if (away < COINCIDENT) {
                continue;
            }
            const struct mh_vec2 from = mh_vec2_between(c[i].centre, p);
#if MH_REAL_FIXED
            const struct mh_vec2 u = {mh_div(from.x, away), mh_div(from.y, away)};
#else
            const mh_real inverse = 1.0f / away;
            const struct mh_vec2 u = {from.x * inverse, from.y * inverse};
#endif
            const mh_real residual = c[i].radius - away;
            normal.xx += mh_mul(u.x, u.x);
            normal.xy += mh_mul(u.x, u.y);
            normal.yy += mh_mul(u.y, u.y);
            right.x = mh_add(right.x, mh_mul(u.x, residual));
            right.y = mh_add(right.y, mh_mul(u.y, residual));
        }
        const mh_real determinant = mh_mul(normal.xx, normal.yy) - mh_mul(normal.xy, normal.xy);
        const struct mh_vec2 above = {mh_add(mh_mul(normal.yy, right.x), -mh_mul(normal.xy, right.y)),
                                      mh_add(mh_mul(normal.xx, right.y), -mh_mul(normal.xy, right.x))};
#if MH_REAL_FIXED
        const struct mh_vec2 move = {mh_div(above.x, determinant), mh_div(above.y, determinant)};
#else
        const mh_real inverse = 1.0f / determinant;
        const struct mh_vec2 move = {above.x * inverse, above.y * inverse};
#endif
        const mh_real length = mh_vec2_length(move);
        p = mh_vec2_along(p, length > STEP_MAX ? mh_div(STEP_MAX, length) : MH_REAL(1.0f), move);
    }
    return p;
}

static struct mh_vec2 cases(const struct mh_circle c[3], bool joint)
{
    struct chord chords[3];
    struct mh_vec2 points[3];
    int pairs = 0;
    const struct mh_circle *third = NULL;
    for (int i = 0; i < 3; i++) {
        const struct mh_circle *other = &c[(i + 2) % 3];
        if (common_chord(&c[i], &c[(i + 1) % 3], &chords[pairs])) {
            points[pairs] = nearer(&chords[pairs], other, false);
            third = other;
            pairs++;
        }
    }
    struct mh_vec2 p;
    if (pairs == 3) {
        mh_real least = incentre(points[0], points[1], points[2], &p);
        for (unsigned which = 0; joint && which < 8; which++) {
            struct mh_vec2 candidate;
            const mh_real perimeter = incentre(end_of(&chords[0], which & 1U), end_of(&chords[1], which & 2U),
                                               end_of(&chords[2], which & 4U), &candidate);
            if (perimeter < least) {
                least = perimeter;
                p = candidate;
            }
        }
        return p;
    }
    if (pairs == 2) {
        return middle(points[0], points[1]);
    }
    if (pairs == 1) {
        const struct mh_circle point = {points[0], 0};
        struct pair way; /* from the third circle's centre through the point */
        return pair_of(third, &point, &way) ? middle(on_way(&way, mh_div(third->radius, length_of(way.way))), points[0])
                                            : points[0];
    }
    return touching(c, &p) ? p : least_squares(c);
}

static struct mh_vec2 uniform(const struct mh_circle c[3])
{
    struct chord chords[3];
    for (int i = 0; i < 3; i++) {
        chord_or_point(&c[i], &c[i < 2 ? i + 1 : 0], &chords[i]);
    }
    struct mh_vec2 p;
    incentre(nearer(&chords[0], &c[2], false), nearer(&chords[1], &c[0], false), nearer(&chords[2], &c[1], false), &p);
    return p;
}

struct mh_vec2 mh_three_circles(const struct mh_circle circles[3], enum mh_circles_variant variant)
{
    return variant == MH_CIRCLES_UNIFORM ? uniform(circles) : cases(circles, variant == MH_CIRCLES_JOINT);
}

/* The middle one of `count` numbers, which it sorts, or the mean of the middle two. */
static mh_real median_of(mh_real *numbers, uint8_t count)
{
    for (uint8_t i = 1; i < count; i++) {
        const mh_real number = numbers[i];
        uint8_t at = i;
        for (; at > 0 && numbers[at - 1] > number; at--) {
            numbers[at] = numbers[at - 1];
        }
        numbers[at] = number;
    }
    const mh_real upper = numbers[count / 2];
    return count % 2 == 0 ? numbers[count / 2 - 1] / 2 + upper / 2 : upper;
}

struct mh_vec2 mh_median_of_triples(const struct mh_circle *circles, uint8_t count)
{
    enum { MAX = MH_CIRCLES_MEDIAN_MAX };
    struct chord chords[MAX * (MAX - 1) / 2]; /* that of circles i < j is number j (j - 1) / 2 + i */
    mh_real x[MAX * (MAX - 1) * (MAX - 2) / 6] = {0}, y[MAX * (MAX - 1) * (MAX - 2) / 6] = {0};
    uint8_t triples = 0;
    for (uint8_t j = 1; j < count; j++) {
        for (uint8_t i = 0; i < j; i++) {
            chord_or_point(&circles[i], &circles[j], &chords[j * (j - 1) / 2 + i]);
        }
    }
    for (uint8_t k = 2; k < count; k++) {
        for (uint8_t j = 1; j < k; j++) {
            for (uint8_t i = 0; i < j; i++) {
                struct mh_vec2 p;
                /* the pair of the third and the first goes the other way round */
                incentre(nearer(&chords[j * (j - 1) / 2 + i], &circles[k], false),
                         nearer(&chords[k * (k - 1) / 2 + j], &circles[i], false),
                         nearer(&chords[k * (k - 1) / 2 + i], &circles[j], true), &p);
                x[triples] = p.x;
                y[triples] = p.y;
                triples++;
            }
        }
    }
    const struct mh_vec2 point = {median_of(x, triples), median_of(y, triples)};
    return point;
}
