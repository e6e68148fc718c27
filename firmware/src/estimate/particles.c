#include "motehound/particles.h"

#define EXPONENT_MAX 40.0f    /* the squares of so large weights still have a sum */
#define EXPONENT_MIN (-80.0f) /* smaller ones are far from all that adds up to 1, and slow near the smallest number */
#define LEAST_SUM 1.2e-38f    /* its reciprocal is finite */

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

void mh_particles_add_range(struct mh_particles *particles, uint16_t from, struct mh_vec2 station, mh_real range)
{
    const uint16_t count = particles->count;
    for (uint16_t i = from; i < count; i++) {
        const mh_real dx = particles->x[i] - station.x, dy = particles->y[i] - station.y;
        const mh_real residual = range - mh_sqrt(dx * dx + dy * dy);
        particles->weight[i] += residual * residual;
    }
}

mh_real mh_particles_least(const struct mh_particles *particles)
{
    mh_real least = INFINITY;
    for (uint16_t i = 0; i < particles->count; i++) {
        least = mh_min(particles->weight[i], least);
    }
    return least;
}

void mh_particles_weigh(struct mh_particles *particles, uint16_t from, mh_real least, mh_real sd)
{
    const mh_real scale = 0.5f / (sd * sd);
    for (uint16_t i = from; i < particles->count; i++) {
        const mh_real exponent = (least - particles->weight[i]) * scale;
        particles->weight[i] =
            exponent > EXPONENT_MIN && mh_finite(exponent) ? mh_exp(mh_min(exponent, EXPONENT_MAX)) : 0.0f;
    }
}

/* Errors as of those who call it. */
static enum mh_status sum_of_weights(const struct mh_particles *particles, mh_real *sum)
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

enum mh_status mh_particles_resample(struct mh_particles *particles, struct mh_random *random)
{
    mh_real sum;
    const enum mh_status status = sum_of_weights(particles, &sum);
    if (status != MH_OK) {
        return status;
    }
    /* how often each goes on: the marks at start, start + 1, .. that fall into its part of 0 .. N; the heaviest takes what rounding leaves */
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
    uint16_t place = 0;
    for (uint16_t i = 0; i < count; i++) {
        while (particles->weight[i] > 1.0f) {
            while (particles->weight[place] > 0.0f) {
                place++;
            }
            particles->x[place] = particles->x[i];
            particles->y[place] = particles->y[i];
            particles->weight[place] = 1.0f;
            particles->weight[i] -= 1.0f;
        }
    }
    return MH_OK;
}

static void swap(mh_real *a, mh_real *b)
{
    const mh_real kept = *a;
    *a = *b;
    *b = kept;
}

enum mh_status mh_particles_reject(struct mh_particles *particles, struct mh_random *random,
                                   mh_particles_redraw *redraw, void *context)
{
    mh_real sum;
    const enum mh_status status = sum_of_weights(particles, &sum);
    if (status != MH_OK) {
        return status;
    }
    const mh_real control = sum / (mh_real)particles->count;
    uint16_t accepted = 0; /* those before stay; those from here on were refused as often as there were rounds */
    for (uint8_t round = 0;; round++) {
        for (uint16_t i = accepted; i < particles->count; i++) {
            if (mh_random_unit(random) * control <= particles->weight[i]) {
                swap(&particles->x[i], &particles->x[accepted]);
                swap(&particles->y[i], &particles->y[accepted]);
                swap(&particles->weight[i], &particles->weight[accepted]);
                particles->weight[accepted] = mh_max(particles->weight[accepted], control);
                accepted++;
            }
        }
        if (accepted == particles->count || round == MH_PARTICLES_REDRAWS) {
            return MH_OK;
        }
        redraw(context, particles, accepted);
    }
}
