/* The point that two or three circles mean, each a node and a measured distance, in every configuration they can have: crossing, tangent, apart, nested,
 * concentric, coincident (Han 2.1, Figs. 2-6 and 2-7, with the nested and mixed configurations completed).
 *
 * Lengths in m, relative to an origin near the work; coordinates finite and within +- 1e6, radii 0 to 1e6. The answer is finite then; for radii of up to
 * 40 m about centres that are less than 100 m apart it is within 65 m of every circle.
 *
 * Scaling and overflow (fixed point). 16 fractional bits throughout; coordinates within +- 1e4, radii 0 to 90, so that the square of the sum of two radii is a number. Squares of distances
 * between centres saturate from 181 m on, which is as good as any distance at which circles do not cross; products of lengths are wide. Centres less than 1/16 m apart are taken for one. Crossings are
 * quotients of lengths, not products with an inverse square, which would have few digits: their error is the longest length times 2^-16, some 2 mm, and where circles touch, so that a root is
 * taken of a rounding, the root of 2^-15 times the radius: 5 cm at 40 m. */
#ifndef MOTEHOUND_CIRCLES_H
#define MOTEHOUND_CIRCLES_H

#include "motehound/geometry.h"

struct mh_circle {
    struct mh_vec2 centre;
    mh_real radius;
};

/* What three circles mean, by the number m of pairs that cross or touch. A crossing is that of the pair's two which is nearer to the third circle. */
enum mh_circles_variant {
    /* Han's cases. m = 3: the centre of the incircle of the three crossings; m = 2: the mean of the two; m = 1: the middle between the crossing and the
     * third circle; m = 0: the centre of the smallest circle that touches all three, or where there is none within 40 m least squares. */
    MH_CIRCLES_CASES,
    /* The centre of the incircle of three points, for each pair its crossing, or where it has none the point of two circles. Continuous, and 6 % more accurate. */
    MH_CIRCLES_UNIFORM,
    /* Cases, but with m = 3 that of the eight triangles which has the least perimeter. No gain. */
    MH_CIRCLES_JOINT
};

/* The point of two circles: the middle of the gap, of the lens, or of the narrow part between nested ones, on the line through the centres; the first centre
 * where the centres coincide. One root, one division. */
struct mh_vec2 mh_two_circles(const struct mh_circle *a, const struct mh_circle *b);

/* The same, but for circles that cross the middle of their common chord. */
struct mh_vec2 mh_two_circles_chord(const struct mh_circle *a, const struct mh_circle *b);

/* Where two circles cross or touch, to 1e-6 of the sum of their radii: that to the left of the way from a to b first. False, and nothing written, if they do not.
 * One root, one division. */
bool mh_crossings(const struct mh_circle *a, const struct mh_circle *b, struct mh_vec2 crossings[2]);

/* The point of three circles. `uniform`: at most 6 roots and 4 divisions. `cases` where nothing crosses: at most eight quadratics and 8 steps of Gauss-Newton. */
struct mh_vec2 mh_three_circles(const struct mh_circle circles[3], enum mh_circles_variant variant);

/* The component-wise median of the points of all triples of 3 to 5 circles, variant uniform: mirrored points of single triples do not
 * move it far. Each pair is worked out once: 10 pairs and 10 triples of five circles. */
#define MH_CIRCLES_MEDIAN_MAX 5
struct mh_vec2 mh_median_of_triples(const struct mh_circle *circles, uint8_t count);

#endif
