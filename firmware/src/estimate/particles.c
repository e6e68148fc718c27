#include "motehound/particles.h"

#define ONE MH_PARTICLE_WEIGHT_ONE

#if MH_REAL_FIXED

#define BITS_MAX 8
#define LIMIT 16383 /* units: of a coordinate */
#define OCTAVES 16  /* smaller than that of the least sum by a factor of 2^16 is 0; larger by 2^15 the largest */

typedef uint64_t weight_sum;

enum mh_status mh_particles_init(struct mh_particles *particles, uint16_t count, mh_real extent, mh_real sd)
{
    uint8_t bits = 0;
    while (bits < BITS_MAX && extent <= mh_real_from_bits(mh_real_to_bits(MH_REAL(LIMIT)) >> (bits + 1))) {
        bits++;
    }
    if (extent > MH_REAL(LIMIT) || sd < mh_real_from_bits((4 * MH_REAL_ONE) >> bits)) {
        return MH_ERR_ARGUMENT;
    }
    particles->count = count;
    particles->bits = bits;
    return MH_OK;
}

/* Products of 16 bits: of numbers that are not negative, the upper half of them, of a number that may be negative with one that is not, of two that may, and
 * squares. An AVR's compiler calls a function for each, which takes twice as long. */
#ifdef __AVR_HAVE_MUL__
static inline uint32_t wide(uint16_t a, uint16_t b) __attribute__((always_inline));
static inline uint32_t wide(uint16_t a, uint16_t b)
{
    uint32_t result;
    /* clang-format off */
    __asm__("mul %A[a], %A[b]\n\tmovw %A[result], r0\n\tmul %B[a], %B[b]\n\tmovw %C[result], r0\n\t"
            "mul %B[a], %A[b]\n\tadd %B[result], r0\n\tadc %C[result], r1\n\tadc %D[result], %[zero]\n\t"
            "mul %A[a], %B[b]\n\tadd %B[result], r0\n\tadc %C[result], r1\n\tadc %D[result], %[zero]\n\tclr __zero_reg__"
            : [result] "=&r"(result)
            : [a] "r"(a), [b] "r"(b), [zero] "r"((uint8_t)0)
            : "r0");
    /* clang-format on */
    return result;
}
static uint16_t product(uint16_t a, uint16_t b) { return (uint16_t)(wide(a, b) >> 16); }

/* The bits of a negative number are 2^16 more. */
static int16_t product_of(int16_t a, uint16_t b) { return (int16_t)(product((uint16_t)a, b) - (a < 0 ? b : 0u)); }

static int16_t turned(int16_t a, int16_t b)
{
    return (int16_t)((uint16_t)product_of(a, (uint16_t)b) - (b < 0 ? (uint16_t)a : 0u));
}

static uint32_t square_of(int16_t a) { return wide((uint16_t)(a < 0 ? -a : a), (uint16_t)(a < 0 ? -a : a)); }
#else
static uint32_t wide(uint16_t a, uint16_t b) { return (uint32_t)a * b; }
static uint16_t product(uint16_t a, uint16_t b) { return (uint16_t)(wide(a, b) >> 16); }
static int16_t product_of(int16_t a, uint16_t b) { return (int16_t)((int32_t)a * b >> 16); }
static int16_t turned(int16_t a, int16_t b) { return (int16_t)((int32_t)a * b >> 16); }
static uint32_t square_of(int16_t a) { return (uint32_t)((int32_t)a * a); }
#endif

/* a * part / 2^16 */
static uint32_t part_of(uint32_t a, uint16_t part)
{
    return wide((uint16_t)(a >> 16), part) + (wide((uint16_t)a, part) >> 16);
}

static int16_t limited(int16_t a) { return a > LIMIT ? LIMIT : a < -LIMIT ? -LIMIT : a; }

/* A length, at most the limit. */
static int16_t to_units(const struct mh_particles *particles, mh_real length)
{
    const mh_real limit = mh_real_from_bits((int32_t)LIMIT << (MH_REAL_BITS - particles->bits));
    const int32_t half = MH_REAL_ONE / 2 >> particles->bits;
    return (int16_t)((mh_real_to_bits(mh_clamp(length, -limit, limit)) + half) >> (MH_REAL_BITS - particles->bits));
}

/* Square root, rounded: of the number as m 2^e, m from 1/2 to 1, by a polynomial of 1 - m. */
static uint16_t root(uint32_t square)
{
    if (square == 0) {
        return 0;
    }
    uint8_t exponent = 32;
    if (square < 0x10000u) {
        square <<= 16;
        exponent = (uint8_t)(exponent - 16);
    }
    if (square < 0x1000000u) {
        square <<= 8;
        exponent = (uint8_t)(exponent - 8);
    }
    while (square < 0x80000000u) {
        square <<= 1;
        exponent--;
    }
    const uint16_t u = (uint16_t)(0xFFFFu - (uint16_t)(square >> 16));
    uint16_t sum = product(u, 7582);
    sum = product(u, (uint16_t)(1404u + sum));
    sum = product(u, (uint16_t)(8703u + sum));
    sum = product(u, (uint16_t)(32739u + sum));
    uint16_t m = (uint16_t)(0xFFFFu - sum);
    if (exponent & 1) {
        m = product(m, 46341u); /* 2^-1/2 */
        exponent++;
    }
    const uint8_t shift = (uint8_t)(16 - exponent / 2);
    return shift == 0 ? m : (uint16_t)(((m >> (shift - 1)) + 1) >> 1);
}

/* (cos a, sin a) with 15 fractional bits for a = pi half, half from 0 to 1 with 16: by polynomials of a / 2. */
static void direction(uint16_t half, int16_t *along, int16_t *across)
{
    const uint16_t square = product(half, half);
    uint16_t sum = (uint16_t)(5210u - product(square, 286));
    sum = (uint16_t)(42331u - product(square, sum));
    sum = (uint16_t)(37405u - product(square, sum));
    const uint16_t sine = (uint16_t)(half + product(half, sum));
    sum = (uint16_t)(16553u - product(square, 1251));
    sum = (uint16_t)(15302u - product(square, sum));
    const uint16_t cosine = (uint16_t)(0xFFFFu - square - product(square, sum));
    *along = (int16_t)((product(cosine, cosine) >> 1) - (product(sine, sine) >> 1));
    *across = (int16_t)product(sine, cosine);
}

/* a direction with 14 fractional bits, to a length */
static int16_t stretched(int16_t direction, uint16_t length) { return product_of(direction, (uint16_t)(4 * length)); }

/* a component of a unit vector, 15 fractional bits */
static int16_t to_axis(mh_real a)
{
    const int32_t bits = mh_real_to_bits(a) >> 1;
    return (int16_t)(bits > 32767 ? 32767 : bits < -32767 ? -32767 : bits);
}

void mh_particles_draw(struct mh_particles *particles, uint16_t from, const struct mh_sector *sector,
                       struct mh_random *random)
{
    if (from == 0) {
        particles->centre = sector->apex;
    }
    const struct mh_vec2 apex = mh_vec2_between(particles->centre, sector->apex);
    const int16_t apex_x = to_units(particles, apex.x), apex_y = to_units(particles, apex.y);
    const int16_t axis_x = to_axis(sector->axis.x);
    const int16_t axis_y = to_axis(sector->axis.y);
    const int32_t turn = mh_real_to_bits(mh_mul(sector->half_angle, MH_REAL(0.318309886f)));
    const uint16_t half_angle = (uint16_t)(turn < 0xFFFF ? turn : 0xFFFF); /* of pi */
    const uint16_t inner = (uint16_t)to_units(particles, sector->inner),
                   outer = (uint16_t)to_units(particles, sector->outer);
    const uint32_t inner_square = (uint32_t)inner * inner, span = (uint32_t)outer * outer - inner_square;
    const uint16_t count = particles->count;
    for (uint16_t i = from; i < count; i++) {
        const uint32_t word = mh_random_word(random);
        const uint16_t low = (uint16_t)word;
        const uint16_t radius = root(inner_square + part_of(span, (uint16_t)(word >> 16)));
        int16_t along, across;
        direction(product(half_angle, (uint16_t)(low << 1)), &along, &across);
        across = (int16_t)(low & 0x8000u ? -across : across);
        /* 14 fractional bits */
        const int16_t x = (int16_t)(turned(axis_x, along) - turned(axis_y, across));
        const int16_t y = (int16_t)(turned(axis_y, along) + turned(axis_x, across));
        particles->x[i] = limited((int16_t)(apex_x + stretched(x, radius)));
        particles->y[i] = limited((int16_t)(apex_y + stretched(y, radius)));
        particles->weight[i] = 0;
    }
}

void mh_particles_add_range(struct mh_particles *particles, uint16_t from, struct mh_vec2 station, mh_real range,
                            mh_particle_weight beyond)
{
    const struct mh_vec2 at = mh_vec2_between(particles->centre, station);
    const int16_t at_x = to_units(particles, at.x), at_y = to_units(particles, at.y);
    const int16_t reading = to_units(particles, range);
    const uint16_t count = particles->count;
    for (uint16_t i = from; i < count; i++) {
        if (particles->weight[i] > beyond) {
            continue;
        }
        const int16_t dx = (int16_t)(particles->x[i] - at_x), dy = (int16_t)(particles->y[i] - at_y);
        const uint16_t distance = root(square_of(dx) + square_of(dy));
        const bool longer = reading >= 0 && (uint16_t)reading > distance;
        const uint16_t residual = (uint16_t)(longer ? (uint16_t)reading - distance : distance - (uint16_t)reading);
        const uint32_t square = wide(residual, residual), sum = particles->weight[i] + square;
        particles->weight[i] = sum < square ? MH_PARTICLE_SUM_MAX : sum;
    }
}

/* Sums of squared residuals as octaves of likelihood: sum * factor * 2^-shift with 11 fractional bits. */
struct octaves {
    uint32_t most; /* OCTAVES of them */
    uint16_t factor;
    int8_t shift;
};

static struct octaves octaves_of(const struct mh_particles *particles, mh_real sd)
{
    const uint32_t units = (uint32_t)mh_real_to_bits(sd) >> (BITS_MAX - particles->bits); /* 8 fractional bits */
    const uint64_t wide = (uint64_t)units * units;
    const uint64_t octave = (wide >> 8) * 90852u >> 16; /* 2 ln 2 sd^2, 8 fractional bits */
    struct octaves octaves = {.most = (uint32_t)(octave * OCTAVES >> 8), .shift = -16};
    uint32_t rest = octaves.most;
    for (; rest > 0; rest >>= 1) {
        octaves.shift++;
    }
    const uint64_t factor = ((uint64_t)1 << (35 + octaves.shift)) / octave;
    octaves.factor = (uint16_t)(factor > 0xFFFF ? 0xFFFF : factor);
    return octaves;
}

mh_particle_weight mh_particles_worthless(const struct mh_particles *particles, mh_particle_weight least, mh_real sd)
{
    const uint32_t most = octaves_of(particles, sd).most;
    return least < MH_PARTICLE_SUM_MAX - most ? least + most : MH_PARTICLE_SUM_MAX;
}

/* 2^-f, f and the result with 16 fractional bits, the result less 1 */
static uint16_t power(uint16_t f)
{
    const uint16_t sum = (uint16_t)(15137u - product(f, 2595));
    return (uint16_t)(0xFFFFu - product(f, (uint16_t)(45310u - product(f, sum))));
}

void mh_particles_weigh(struct mh_particles *particles, uint16_t from, mh_particle_weight least, mh_real sd)
{
    const struct octaves octaves = octaves_of(particles, sd);
    for (uint16_t i = from; i < particles->count; i++) {
        const uint32_t sum = particles->weight[i];
        const bool above = sum >= least;
        const uint32_t difference = above ? sum - least : least - sum;
        if (sum == MH_PARTICLE_SUM_MAX || (above && difference >= octaves.most)) {
            particles->weight[i] = 0;
            continue;
        }
        const uint16_t fine = (uint16_t)(difference >= octaves.most ? 0xFFFF
                                         : octaves.shift >= 0       ? difference >> octaves.shift
                                                                    : difference << -octaves.shift);
        const uint16_t exponent = product(fine, octaves.factor);
        const uint16_t fraction = (uint16_t)(exponent << 5);
        const uint8_t whole = (uint8_t)(exponent >> 11);
        particles->weight[i] = above                  ? ((uint32_t)power(fraction) + 1) >> whole
                               : whole >= OCTAVES - 1 ? (uint32_t)1 << 31
                                                      : ((uint32_t)power((uint16_t)~fraction) + 1) << (whole + 1);
    }
}

static mh_particle_weight largest_weight(const struct mh_particles *particles)
{
    mh_particle_weight largest = 0;
    for (uint16_t i = 0; i < particles->count; i++) {
        largest = particles->weight[i] > largest ? particles->weight[i] : largest;
    }
    return largest;
}

/* Left shift that makes 16 bits of the largest weight. */
static int8_t shift_to_share(mh_particle_weight largest)
{
    int8_t shift = 0;
    for (; largest > 0xFFFF; largest >>= 1) {
        shift--;
    }
    for (; largest < 0x8000 && shift < 16; largest <<= 1) {
        shift++;
    }
    return shift;
}

static uint16_t share_of(mh_particle_weight weight, int8_t shift)
{
    return (uint16_t)(shift < 0 ? weight >> -shift : weight << shift);
}

/* Errors as of those who call it. */
static enum mh_status sum_of_weights(const struct mh_particles *particles, weight_sum *sum)
{
    *sum = 0;
    for (uint16_t i = 0; i < particles->count; i++) {
        *sum += particles->weight[i];
    }
    return *sum > 0 ? MH_OK : MH_ERR_SINGULAR;
}

mh_real mh_particles_effective(const struct mh_particles *particles)
{
    const int8_t shift = shift_to_share(largest_weight(particles));
    uint64_t sum = 0, squares = 0;
    for (uint16_t i = 0; i < particles->count; i++) {
        const uint16_t share = share_of(particles->weight[i], shift);
        sum += share;
        squares += (uint32_t)share * share;
    }
    squares >>= MH_REAL_BITS;
    return squares > 0 ? mh_real_from_bits((int32_t)(sum * sum / squares)) : 0;
}

static int64_t quotient(int64_t a, uint32_t b)
{
    const int64_t half = b / 2;
    return (a + (a < 0 ? -half : half)) / (int64_t)b;
}

/* m2, of the mean of products of differences in units. */
static mh_real to_square_metres(const struct mh_particles *particles, int64_t sum, uint32_t total)
{
    const int64_t fine = quotient(sum * 16, total); /* 4 fractional bits */
    return mh_real_saturate(fine * (MH_REAL_ONE / 16) >> 2 * particles->bits);
}

enum mh_status mh_particles_mean(const struct mh_particles *particles, mh_real resolution, struct mh_vec2 *mean,
                                 struct mh_sym2 *covariance)
{
    const int8_t shift = shift_to_share(largest_weight(particles));
    uint32_t total = 0;
    int64_t x = 0, y = 0;
    for (uint16_t i = 0; i < particles->count; i++) {
        const uint16_t share = share_of(particles->weight[i], shift);
        total += share;
        x += (int32_t)share * particles->x[i];
        y += (int32_t)share * particles->y[i];
    }
    if (total == 0) {
        return MH_ERR_SINGULAR;
    }
    const int16_t mean_x = (int16_t)quotient(x, total), mean_y = (int16_t)quotient(y, total);
    int64_t xx = 0, xy = 0, yy = 0;
    for (uint16_t i = 0; i < particles->count; i++) {
        const uint16_t share = share_of(particles->weight[i], shift);
        const int32_t dx = (int32_t)particles->x[i] - mean_x, dy = (int32_t)particles->y[i] - mean_y;
        xx += (int64_t)(dx * dx) * share;
        xy += (int64_t)(dx * dy) * share;
        yy += (int64_t)(dy * dy) * share;
    }
    const int32_t unit = (int32_t)1 << (MH_REAL_BITS - particles->bits);
    const struct mh_vec2 m = {mh_add(particles->centre.x, mh_real_from_bits((int32_t)quotient(x * unit, total))),
                              mh_add(particles->centre.y, mh_real_from_bits((int32_t)quotient(y * unit, total)))};
    const struct mh_sym2 c = {mh_add(to_square_metres(particles, xx, total), resolution),
                              to_square_metres(particles, xy, total),
                              mh_add(to_square_metres(particles, yy, total), resolution)};
    if (!mh_finite(m.x) || !mh_finite(m.y) || !mh_finite(c.xx) || !mh_finite(c.yy)) {
        return MH_ERR_NOT_FINITE;
    }
    *mean = m;
    *covariance = c;
    return MH_OK;
}

/* Weights -> how often each goes on: the marks at start, start + sum, .. that fall into its part of 0 .. N sum. */
static void count_offspring(struct mh_particles *particles, weight_sum sum, struct mh_random *random)
{
    const uint16_t count = particles->count;
    int64_t reached = -(int64_t)(sum * (mh_random_word(random) >> 16) >> 16);
    for (uint16_t i = 0; i < count; i++) {
        reached += (int64_t)particles->weight[i] * count;
        mh_particle_weight times = 0;
        for (; reached > 0; reached -= (int64_t)sum) {
            times += ONE;
        }
        particles->weight[i] = times;
    }
}

/* With probability min(1, weight / control). */
static bool accepts(struct mh_random *random, mh_particle_weight control, mh_particle_weight weight)
{
    return part_of(control, (uint16_t)(mh_random_word(random) >> 16)) < weight;
}

static mh_particle_weight mean_weight(weight_sum sum, uint16_t count)
{
    return (mh_particle_weight)((sum + count - 1) / count);
}

#else

#define EXPONENT_MAX 40.0f    /* the squares of so large weights still have a sum */
#define EXPONENT_MIN (-80.0f) /* smaller ones are far from all that adds up to 1, and slow near the smallest number */
#define LEAST_SUM 1.2e-38f    /* its reciprocal is finite */

typedef mh_real weight_sum;

enum mh_status mh_particles_init(struct mh_particles *particles, uint16_t count, mh_real extent, mh_real sd)
{
    (void)extent;
    (void)sd;
    particles->count = count;
    return MH_OK;
}

void mh_particles_draw(struct mh_particles *particles, uint16_t from, const struct mh_sector *sector,
                       struct mh_random *random)
{
    mh_real *const x = particles->x, *const y = particles->y;
    const uint16_t count = particles->count;
    for (uint16_t i = from; i < count; i++) {
        x[i] = mh_random_unit(random);
        y[i] = mh_random_unit(random);
    }
    const struct mh_sector s = *sector;
    const mh_real inner_square = s.inner * s.inner;
    const mh_real square_span = (s.outer - s.inner) * (s.outer + s.inner);
    for (uint16_t i = from; i < count; i++) {
        const mh_real radius = mh_sqrt(inner_square + square_span * x[i]);
        const struct mh_vec2 turn = mh_direction(s.half_angle * (2.0f * y[i] - 1.0f));
        x[i] = s.apex.x + radius * (s.axis.x * turn.x - s.axis.y * turn.y);
        y[i] = s.apex.y + radius * (s.axis.y * turn.x + s.axis.x * turn.y);
        particles->weight[i] = 0.0f;
    }
}

void mh_particles_add_range(struct mh_particles *particles, uint16_t from, struct mh_vec2 station, mh_real range,
                            mh_particle_weight beyond)
{
    (void)beyond; /* a loop without branches is faster */
    const uint16_t count = particles->count;
    for (uint16_t i = from; i < count; i++) {
        const mh_real dx = particles->x[i] - station.x, dy = particles->y[i] - station.y;
        const mh_real residual = range - mh_sqrt(dx * dx + dy * dy);
        particles->weight[i] += residual * residual;
    }
}

void mh_particles_weigh(struct mh_particles *particles, uint16_t from, mh_particle_weight least, mh_real sd)
{
    const mh_real scale = 0.5f / (sd * sd);
    for (uint16_t i = from; i < particles->count; i++) {
        const mh_real exponent = (least - particles->weight[i]) * scale;
        particles->weight[i] =
            exponent > EXPONENT_MIN && mh_finite(exponent) ? mh_exp(mh_min(exponent, EXPONENT_MAX)) : 0.0f;
    }
}

mh_particle_weight mh_particles_worthless(const struct mh_particles *particles, mh_particle_weight least, mh_real sd)
{
    (void)particles;
    return least - (EXPONENT_MIN - 1.0f) * 2.0f * sd * sd; /* and a rounding more */
}

/* Errors as of those who call it. */
static enum mh_status sum_of_weights(const struct mh_particles *particles, weight_sum *sum)
{
    *sum = 0.0f;
    for (uint16_t i = 0; i < particles->count; i++) {
        *sum += particles->weight[i];
    }
    if (!mh_finite(*sum)) {
        return MH_ERR_NOT_FINITE;
    }
    return *sum >= LEAST_SUM ? MH_OK : MH_ERR_SINGULAR;
}

mh_real mh_particles_effective(const struct mh_particles *particles)
{
    mh_real sum = 0.0f, squares = 0.0f;
    for (uint16_t i = 0; i < particles->count; i++) {
        sum += particles->weight[i];
        squares += mh_squared(particles->weight[i]);
    }
    return squares > 0.0f ? sum * (sum / squares) : 0.0f;
}

enum mh_status mh_particles_mean(const struct mh_particles *particles, mh_real resolution, struct mh_vec2 *mean,
                                 struct mh_sym2 *covariance)
{
    mh_real sum;
    const enum mh_status status = sum_of_weights(particles, &sum);
    if (status != MH_OK) {
        return status;
    }
    const mh_real scale = 1.0f / sum;
    struct mh_vec2 m = {0, 0};
    for (uint16_t i = 0; i < particles->count; i++) {
        const mh_real share = particles->weight[i] * scale;
        m.x += share * particles->x[i];
        m.y += share * particles->y[i];
    }
    struct mh_sym2 c = {resolution, 0, resolution};
    for (uint16_t i = 0; i < particles->count; i++) {
        const mh_real share = particles->weight[i] * scale;
        const mh_real dx = particles->x[i] - m.x, dy = particles->y[i] - m.y;
        c.xx += share * dx * dx;
        c.xy += share * dx * dy;
        c.yy += share * dy * dy;
    }
    if (!mh_finite(m.x) || !mh_finite(m.y) || !mh_finite(c.xx) || !mh_finite(c.yy)) {
        return MH_ERR_NOT_FINITE;
    }
    *mean = m;
    *covariance = c;
    return MH_OK;
}

/* Weights -> how often each goes on: the marks at start, start + 1, .. that fall into its part of 0 .. N; the heaviest takes what rounding leaves. */
static void count_offspring(struct mh_particles *particles, weight_sum sum, struct mh_random *random)
{
    const uint16_t count = particles->count;
    const mh_real scale = (mh_real)count / sum, start = mh_random_unit(random);
    mh_real reached = -start, largest = 0.0f;
    uint16_t marks = 0, heaviest = 0;
    for (uint16_t i = 0; i < count; i++) {
        const mh_real weight = particles->weight[i];
        heaviest = weight > largest ? i : heaviest;
        largest = mh_max(weight, largest);
        reached += weight * scale;
        const uint16_t whole = reached < (mh_real)count ? (uint16_t)mh_max(reached, 0.0f) : count;
        const uint16_t passed = (uint16_t)(whole + ((mh_real)whole < reached && whole < count ? 1 : 0));
        particles->weight[i] = (mh_real)(passed - marks);
        marks = passed;
    }
    particles->weight[heaviest] += (mh_real)(count - marks);
}

/* With probability min(1, weight / control). */
static bool accepts(struct mh_random *random, mh_particle_weight control, mh_particle_weight weight)
{
    return mh_random_unit(random) * control <= weight;
}

static mh_particle_weight mean_weight(weight_sum sum, uint16_t count) { return sum / (mh_real)count; }

#endif

mh_particle_weight mh_particles_least(const struct mh_particles *particles)
{
    mh_particle_weight least = MH_PARTICLE_SUM_MAX;
    for (uint16_t i = 0; i < particles->count; i++) {
        least = particles->weight[i] < least ? particles->weight[i] : least;
    }
    return least;
}

enum mh_status mh_particles_resample(struct mh_particles *particles, struct mh_random *random)
{
    weight_sum sum;
    const enum mh_status status = sum_of_weights(particles, &sum);
    if (status != MH_OK) {
        return status;
    }
    count_offspring(particles, sum, random);
    const uint16_t count = particles->count;
    uint16_t place = 0;
    for (uint16_t i = 0; i < count; i++) {
        while (particles->weight[i] > ONE) {
            while (particles->weight[place] > 0) {
                place++;
            }
            particles->x[place] = particles->x[i];
            particles->y[place] = particles->y[i];
            particles->weight[place] = ONE;
            particles->weight[i] -= ONE;
        }
    }
    return MH_OK;
}

static void swap(mh_particle_coordinate *a, mh_particle_coordinate *b)
{
    const mh_particle_coordinate kept = *a;
    *a = *b;
    *b = kept;
}

enum mh_status mh_particles_reject(struct mh_particles *particles, struct mh_random *random,
                                   mh_particles_redraw *redraw, void *context)
{
    weight_sum sum;
    const enum mh_status status = sum_of_weights(particles, &sum);
    if (status != MH_OK) {
        return status;
    }
    const mh_particle_weight control = mean_weight(sum, particles->count);
    uint16_t accepted = 0; /* those before stay; those from here on were refused as often as there were rounds */
    for (uint8_t round = 0;; round++) {
        for (uint16_t i = accepted; i < particles->count; i++) {
            if (accepts(random, control, particles->weight[i])) {
                const mh_particle_weight weight = particles->weight[i];
                swap(&particles->x[i], &particles->x[accepted]);
                swap(&particles->y[i], &particles->y[accepted]);
                particles->weight[i] = particles->weight[accepted];
                particles->weight[accepted] = weight > control ? weight : control;
                accepted++;
            }
        }
        if (accepted == particles->count || round == MH_PARTICLES_REDRAWS) {
            return MH_OK;
        }
        redraw(context, particles, accepted);
    }
}
