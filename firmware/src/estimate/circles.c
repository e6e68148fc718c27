#include "motehound/circles.h"

#include <stddef.h>

#define COINCIDENT 1e-6f /* m: centres that are no farther apart show no direction */
#define TOUCH 1e-6f      /* of the square of the sum of the radii: less is rounding */
#define COLLINEAR 1e-6f  /* of the square of the longer side */
#define TOUCH_M 0.1f     /* m */
#define FARTHEST 40.0f   /* m: a circle that touches all three is no larger */

enum { STEPS = 8 };
#define STEP_MAX 20.0f /* m */
#define DAMPING 1e-6f

static mh_real distance(struct mh_vec2 a, struct mh_vec2 b)
{
    return mh_sqrt(mh_squared(b.x - a.x) + mh_squared(b.y - a.y));
}

static struct mh_vec2 middle(struct mh_vec2 a, struct mh_vec2 b)
{
    const struct mh_vec2 m = {0.5f * (a.x + b.x), 0.5f * (a.y + b.y)};
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
    const struct mh_vec2 way = {b->centre.x - a->centre.x, b->centre.y - a->centre.y};
    const struct pair p = {a, b, way, way.x * way.x + way.y * way.y};
    *pair = p;
    return p.square >= COINCIDENT * COINCIDENT;
}

/* The point at a share of the way. */
static struct mh_vec2 on_way(const struct pair *pair, mh_real share)
{
    const struct mh_vec2 p = {pair->a->centre.x + share * pair->way.x, pair->a->centre.y + share * pair->way.y};
    return p;
}

static struct mh_vec2 between(const struct pair *pair)
{
    const mh_real ra = pair->a->radius;
    const mh_real rb = pair->b->radius;
    const mh_real apart = mh_sqrt(pair->square);
    const mh_real gap = apart >= mh_abs(ra - rb) ? ra - rb : ra > rb ? ra + rb : -ra - rb;
    return on_way(pair, 0.5f + 0.5f * gap / apart);
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
    const mh_real largest = sum * sum;
    const mh_real overlap = largest - pair->square;
    const mh_real outside = pair->square - difference * difference;
    const mh_real rounding = -TOUCH * largest;
    if (overlap < rounding || outside < rounding) {
        return false;
    }
    const mh_real half_inverse = 0.5f / pair->square;
    const mh_real half = half_inverse * mh_sqrt(mh_max(overlap * outside, 0));
    chord->foot = on_way(pair, 0.5f + half_inverse * sum * difference);
    chord->aside.x = -half * pair->way.y;
    chord->aside.y = half * pair->way.x;
    chord->square = half * half * pair->square;
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
    const struct mh_vec2 f = {chord->foot.x - circle->centre.x, chord->foot.y - circle->centre.y};
    const mh_real along = f.x * chord->aside.x + f.y * chord->aside.y;
    if (along == 0) {
        return end_of(chord, otherwise);
    }
    const mh_real r = circle->radius * circle->radius;
    const mh_real excess = f.x * f.x + f.y * f.y + chord->square - r;
    const bool within = excess < r && along * along > r * excess;
    return end_of(chord, (along > 0) != within);
}

/* The centre of the incircle of a triangle -> its perimeter. */
static mh_real incentre(struct mh_vec2 a, struct mh_vec2 b, struct mh_vec2 c, struct mh_vec2 *centre)
{
    const struct mh_vec2 ab = {b.x - a.x, b.y - a.y};
    const struct mh_vec2 ac = {c.x - a.x, c.y - a.y};
    const mh_real to_a = distance(b, c);
    const mh_real to_b = mh_sqrt(ac.x * ac.x + ac.y * ac.y);
    const mh_real to_c = mh_sqrt(ab.x * ab.x + ab.y * ab.y);
    const mh_real perimeter = to_a + to_b + to_c;
    if (perimeter < 1e-9f) {
        *centre = a;
        return perimeter;
    }
    const mh_real share = 1.0f / perimeter;
    const mh_real of_b = to_b * share;
    const mh_real of_c = to_c * share;
    centre->x = a.x + of_b * ab.x + of_c * ac.x;
    centre->y = a.y + of_b * ab.y + of_c * ac.y;
    return perimeter;
}

/* Whether |point - S_i| = r_i + rho, or r_i - rho where bit i of `minus` is set: where the centres are nearly on a line too few digits are left for it. */
static bool touches(const struct mh_circle c[3], unsigned minus, mh_real rho, struct mh_vec2 point)
{
    for (unsigned i = 0; i < 3; i++) {
        const mh_real reach = minus >> i & 1U ? c[i].radius - rho : c[i].radius + rho;
        if (!(mh_abs(distance(point, c[i].centre) - reach) <= TOUCH_M)) {
            return false;
        }
    }
    return true;
}

/* The centre of the smallest circle that touches all three: the least rho with |p - S_i| = r_i + s_i rho, s_i = +-1. Differences of the squared equations
 * are linear, p = p0 + p1 rho, and leave a quadratic. A rho below 0 stands for the opposite signs, so that those with s_1 = 1 are all. False if there is none. */
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

/* sum (|p - S_i| - r_i)^2 -> min, by Gauss-Newton from the mean of the points of the pairs. */
static struct mh_vec2 least_squares(const struct mh_circle c[3])
{
    struct mh_vec2 p = {0, 0};
    for (int i = 0; i < 3; i++) {
        const struct mh_vec2 one = mh_two_circles(&c[i], &c[(i + 1) % 3]);
        p.x += one.x;
        p.y += one.y;
    }
    p.x /= 3;
    p.y /= 3;
    for (int step = 0; step < STEPS; step++) {
        struct mh_sym2 normal = {DAMPING, 0, DAMPING};
        struct mh_vec2 right = {0, 0};
        for (int i = 0; i < 3; i++) {
            const mh_real away = distance(p, c[i].centre);
            if (away < COINCIDENT) {
                continue;
            }
            const mh_real inverse = 1.0f / away;
            const struct mh_vec2 u = {(p.x - c[i].centre.x) * inverse, (p.y - c[i].centre.y) * inverse};
            const mh_real residual = c[i].radius - away;
            normal.xx += u.x * u.x;
            normal.xy += u.x * u.y;
            normal.yy += u.y * u.y;
            right.x += u.x * residual;
            right.y += u.y * residual;
        }
        const mh_real inverse = 1.0f / (normal.xx * normal.yy - normal.xy * normal.xy);
        struct mh_vec2 move = {(normal.yy * right.x - normal.xy * right.y) * inverse,
                               (normal.xx * right.y - normal.xy * right.x) * inverse};
        const mh_real length = mh_sqrt(move.x * move.x + move.y * move.y);
        const mh_real share = length > STEP_MAX ? STEP_MAX / length : 1.0f;
        p.x += share * move.x;
        p.y += share * move.y;
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
        return pair_of(third, &point, &way) ? middle(on_way(&way, third->radius / mh_sqrt(way.square)), points[0])
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
    return count % 2 == 0 ? 0.5f * (numbers[count / 2 - 1] + upper) : upper;
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
