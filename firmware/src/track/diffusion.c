#include "motehound/diffusion.h"

#include <string.h>

#define CLUSTER_CANDIDATES (MH_DIFFUSION_SMALL ? 12 : 64)
#define CLUSTER_LEAST 3     /* increments that make a cluster */
#define DETECTIONS_LEAST 4  /* concentrations above chi that make a start */
#define LEVEL_MIN 0.01f     /* straight segments do not fit a curved path better than that */
#define LEVEL_INERTIA 10.0f /* rows' worth of what was known before */
#define MISFIT_SHARED 4.0f  /* rows an unknown: what noise does not explain they have in common */
#define SIGNIFICANCE_MAX 8.0f
#define RANKING_MAX (MH_DIFFUSION_STRONG > CLUSTER_CANDIDATES ? MH_DIFFUSION_STRONG : CLUSTER_CANDIDATES)

/* The best few of many, best first. */
struct ranking {
    int count, capacity;
    uint16_t index[RANKING_MAX > MH_DIFFUSION_NEAR ? RANKING_MAX : MH_DIFFUSION_NEAR];
    mh_real score[RANKING_MAX > MH_DIFFUSION_NEAR ? RANKING_MAX : MH_DIFFUSION_NEAR];
};

/* Where the significant increments of an instant crowd. */
struct cluster {
    bool found;
    struct mh_vec2 centre;
};

/* The measurements of one instant. */
struct instant {
    mh_tick time;
    const struct mh_measurement *measurements;
    size_t count;
};

static mh_real distance2(struct mh_vec2 a, struct mh_vec2 b) { return mh_squared(a.x - b.x) + mh_squared(a.y - b.y); }

static void rank(struct ranking *ranking, uint16_t index, mh_real score)
{
    int at = ranking->count;
    if (at == ranking->capacity) {
        at--;
        if (!(score > ranking->score[at])) {
            return;
        }
    } else {
        ranking->count++;
    }
    for (; at > 0 && score > ranking->score[at - 1]; at--) {
        ranking->index[at] = ranking->index[at - 1];
        ranking->score[at] = ranking->score[at - 1];
    }
    ranking->index[at] = index;
    ranking->score[at] = score;
}

void mh_diffusion_config_default(struct mh_diffusion_config *config)
{
    const struct mh_diffusion_config nominal = {
        .diffusion_m2ps = 1.0f,
        .chi = 0.2f,
        .release_gps = 100.0f,
        .release_drift = 0.05f,
        .additive_sd = 0.05f,
        .relative_sd = 0.05f,
        .turn_mps2 = 0.35f,
        .speed_mps = 3.0f,
        .reach_m = 8.0f,
        .region = {-MH_COORDINATE_MAX_MM, MH_COORDINATE_MAX_MM, -MH_COORDINATE_MAX_MM, MH_COORDINATE_MAX_MM},
    };
    *config = nominal;
}

/* The release rate may go on to change as much as it has lately: a steady one is known the better for it, and helps the position. */
static void learn_rate_change(struct mh_diffusion *track, mh_real change)
{
    track->rate_change2 += 0.1f * (mh_squared(mh_min(change, 0.2f)) - track->rate_change2);
    track->fit.log_rate_step_sd = mh_max(0.01f, mh_sqrt(track->rate_change2));
    track->fit.log_rate_drift = mh_max(track->config.release_drift, mh_sqrt(track->rate_change2));
}

static bool is_span(int32_t low_mm, int32_t high_mm)
{
    return low_mm < high_mm && mh_coordinate_valid(low_mm) && mh_coordinate_valid(high_mm);
}

static enum mh_status init(void *state, const void *config, mh_tick interval)
{
    struct mh_diffusion *track = state;
    const struct mh_diffusion_config *c = config;
    if (track == NULL || c == NULL || interval < 1 || interval > 3600000u) {
        return MH_ERR_ARGUMENT;
    }
    if (!mh_within(c->diffusion_m2ps, 1e-4f, 1e3f) || !mh_within(c->chi, 1e-3f, 1e3f) ||
        !mh_within(c->release_gps, 1e-3f, 1e5f) || !mh_within(c->release_drift, 1e-3f, 1.0f) ||
        !mh_within(c->additive_sd, 1e-3f, 1e3f) || !mh_within(c->relative_sd, 0.0f, 1.0f) ||
        !mh_within(c->turn_mps2, 1e-3f, 1e2f) || !mh_within(c->speed_mps, 1e-2f, 1e3f) ||
        !mh_within(c->reach_m, 0.1f, 1e3f) || !is_span(c->region.x_min_mm, c->region.x_max_mm) ||
        !is_span(c->region.y_min_mm, c->region.y_max_mm)) {
        return MH_ERR_ARGUMENT;
    }
    track->config = *c;
    track->stepped = false;
    track->tracking = false;
    track->silent = 0;
    track->unanswered = 0;
    track->level = 1.0f;
    track->rate_change2 = 0.0f;
    track->usual_misfit = 0.0f;
    track->density = 0.0f;
    track->asked_radius = c->reach_m;

    struct mh_trail_fit *fit = &track->fit;
    fit->model.diffusion_m2ps = c->diffusion_m2ps;
    fit->model.turn_mps2 = c->turn_mps2;
    fit->model.speed_mps = c->speed_mps;
    fit->model.interval = interval;
    fit->log_rate = mh_log(c->release_gps);
    learn_rate_change(track, 0.0f);
    fit->bounds.log_rate_low = fit->log_rate - 3.0f;
    fit->bounds.log_rate_high = fit->log_rate + 3.0f;
    return MH_OK;
}

static bool has_increment(const struct mh_measurement *m) { return (m->flags & MH_MEASUREMENT_HAS_INCREMENT) != 0; }

/* Variance of an increment from the noise of the two readings. */
static mh_real noise_variance(const struct mh_diffusion_config *config, const struct mh_measurement *m)
{
    const mh_real now = mh_q20_to_real(m->value);
    const mh_real before = now - mh_q20_to_real(m->increment);
    return 2.0f * mh_squared(config->additive_sd) +
           mh_squared(config->relative_sd) * (mh_squared(now) + mh_squared(before));
}

static mh_real significance(const struct mh_diffusion_config *config, const struct mh_measurement *m)
{
    return mh_q20_to_real(m->increment) / mh_sqrt(noise_variance(config, m) + mh_squared(0.25f * config->chi));
}

static bool is_strong(const struct mh_diffusion_config *config, const struct mh_measurement *m)
{
    return has_increment(m) && mh_q20_to_real(m->increment) >= config->chi;
}

/* Within `radius2` of either place. */
struct vicinity {
    struct mh_vec2 centres[2];
    mh_real radius2;
};

static bool is_within(const struct vicinity *vicinity, struct mh_vec2 place)
{
    return distance2(place, vicinity->centres[0]) <= vicinity->radius2 ||
           distance2(place, vicinity->centres[1]) <= vicinity->radius2;
}

/* The most significant increments of at least chi, in a vicinity or (NULL) anywhere. */
static void rank_strong(const struct mh_diffusion *track, const struct instant *now, int capacity,
                        const struct vicinity *vicinity, struct ranking *ranking)
{
    ranking->count = 0;
    ranking->capacity = capacity;
    for (size_t i = 0; i < now->count; i++) {
        const struct mh_measurement *m = &now->measurements[i];
        if (is_strong(&track->config, m) &&
            (vicinity == NULL || is_within(vicinity, mh_place_relative(&m->place, &track->origin)))) {
            rank(ranking, (uint16_t)i, significance(&track->config, m));
        }
    }
}

/* Among the most significant increments the one in the most significant neighbourhood; the centre is that neighbourhood's mean. */
static struct cluster find_cluster(const struct mh_diffusion *track, const struct instant *now)
{
    struct ranking strong;
    struct cluster cluster = {false, {0.0f, 0.0f}};
    const mh_real radius2 = mh_squared(0.625f * track->config.reach_m);
    mh_real best = 0.0f;
    rank_strong(track, now, CLUSTER_CANDIDATES, NULL, &strong);
    for (int i = 0; i < strong.count; i++) {
        const struct mh_vec2 place = mh_place_relative(&now->measurements[strong.index[i]].place, &track->origin);
        struct mh_vec2 moment = {0.0f, 0.0f};
        mh_real weight = 0.0f, sum = 0.0f;
        int neighbours = 0;
        for (int j = 0; j < strong.count; j++) {
            const struct mh_measurement *m = &now->measurements[strong.index[j]];
            const struct mh_vec2 other = mh_place_relative(&m->place, &track->origin);
            if (distance2(place, other) <= radius2) {
                const mh_real increment = mh_q20_to_real(m->increment);
                moment.x += increment * other.x;
                moment.y += increment * other.y;
                weight += increment;
                sum += mh_min(strong.score[j], SIGNIFICANCE_MAX);
                neighbours++;
            }
        }
        if (neighbours >= CLUSTER_LEAST && sum > best) {
            best = sum;
            cluster.found = true;
            cluster.centre.x = moment.x / weight;
            cluster.centre.y = moment.y / weight;
        }
    }
    return cluster;
}

static void add_row(struct mh_diffusion *track, const struct mh_measurement *m)
{
    const mh_real before = mh_q20_to_real(m->value) - mh_q20_to_real(m->increment);
    mh_real unknown_past =
        0.2f * before; /* release from before the start is not in the model; what it does to increments fades */
    for (int i = 0; i < track->since && i < 16; i++) {
        unknown_past *= 0.5f;
    }
    const mh_real variance = noise_variance(&track->config, m) + mh_squared(unknown_past);
    if (mh_trail_fit_add_row(&track->fit, mh_place_relative(&m->place, &track->origin), mh_q20_to_real(m->increment),
                             variance) == MH_OK) {
        track->used++;
    }
}

/* Rows of the newest knot: the nodes nearest to `centre`, silent or not, and the most significant increments that are within reach of the centre or
 * the cluster. */
static void add_rows(struct mh_diffusion *track, const struct instant *now, struct mh_vec2 centre, mh_real radius,
                     const struct cluster *cluster)
{
    struct ranking near = {.capacity = MH_DIFFUSION_NEAR}, strong;
    track->used = 0;
    for (size_t i = 0; i < now->count; i++) {
        const struct mh_measurement *m = &now->measurements[i];
        const mh_real d2 = distance2(mh_place_relative(&m->place, &track->origin), centre);
        if (has_increment(m) && d2 <= mh_squared(radius)) {
            rank(&near, (uint16_t)i, -d2);
        }
    }
    for (int i = 0; i < near.count; i++) {
        add_row(track, &now->measurements[near.index[i]]);
    }
    const struct vicinity vicinity = {{centre, cluster->found ? cluster->centre : centre},
                                      mh_squared(mh_max(radius, track->config.reach_m))};
    rank_strong(track, now, MH_DIFFUSION_STRONG, &vicinity, &strong);
    for (int i = 0; i < strong.count; i++) {
        bool taken = false;
        for (int j = 0; j < near.count; j++) {
            taken = taken || near.index[j] == strong.index[i];
        }
        if (!taken) {
            add_row(track, &now->measurements[strong.index[i]]);
        }
    }
}

static void bound_region(struct mh_diffusion *track)
{
    const struct mh_region *region = &track->config.region;
    const struct mh_place low = {region->x_min_mm, region->y_min_mm, 0}, high = {region->x_max_mm, region->y_max_mm, 0};
    track->fit.bounds.low = mh_place_relative(&low, &track->origin);
    track->fit.bounds.high = mh_place_relative(&high, &track->origin);
}

/* Begin, or begin again, at the cluster's centre. */
static enum mh_status start(struct mh_diffusion *track, const struct instant *now, struct mh_vec2 centre)
{
    mh_trail_fit_start(&track->fit, centre, 0.375f * track->config.reach_m, now->time - track->fit.model.interval,
                       now->time);
    track->tracking = true;
    track->since = 0;
    track->doubtful = 0;
    track->astray = 0;
    const struct cluster here = {true, centre};
    track->cluster = centre;
    add_rows(track, now, centre, track->config.reach_m, &here);
    return mh_trail_fit_solve(&track->fit);
}

/* The same after a track: its release rate is a better guess than none. */
static enum mh_status restart(struct mh_diffusion *track, const struct instant *now, struct mh_vec2 centre)
{
    const mh_real expected = mh_log(track->config.release_gps);
    track->fit.log_rate = mh_clamp(track->fit.log_rate, expected - 1.60943791f, expected + 1.60943791f); /* ln 5 */
    track->fit.prior_log_rate = track->fit.log_rate;
    track->fit.log_rate_sd = 0.5f;
    return start(track, now, centre);
}

static mh_real misfit(const struct mh_trail_fit *fit)
{
    return fit->row_count > 0 ? fit->cost / (mh_real)fit->row_count : 0.0f;
}

static struct mh_fit_knot *newest(struct mh_trail_fit *fit) { return &fit->knots[fit->knot_count - 1]; }

/* Solve again with the knots after number `from` on the straight line to the cluster's centre; keep the better of the two. */
static enum mh_status second_start(struct mh_trail_fit *fit, int from, struct mh_vec2 centre)
{
    struct mh_fit_knot knots[MH_FIT_KNOTS];
    const mh_real cost = fit->cost, log_rate = fit->log_rate, log_rate_step = fit->log_rate_step;
    for (int k = 0; k < fit->knot_count; k++) {
        knots[k] = fit->knots[k];
    }
    const struct mh_vec2 start = knots[from].place;
    for (int k = from + 1; k < fit->knot_count; k++) {
        const mh_real share = mh_seconds_between(knots[from].time, knots[k].time) /
                              mh_seconds_between(knots[from].time, newest(fit)->time);
        fit->knots[k].place.x = start.x + share * (centre.x - start.x);
        fit->knots[k].place.y = start.y + share * (centre.y - start.y);
    }
    fit->log_rate = fit->prior_log_rate;
    fit->log_rate_step = 0.0f;
    if (mh_trail_fit_solve(fit) == MH_OK && fit->cost < cost) {
        return MH_OK;
    }
    for (int k = 0; k < fit->knot_count; k++) {
        fit->knots[k] = knots[k];
    }
    fit->log_rate = log_rate;
    fit->log_rate_step = log_rate_step;
    return mh_trail_fit_assess(fit);
}

/* Count the signs that the fit follows something else than the source; true if that is enough. What counts as a misfit follows what is usual, so
 * that noise above what was assumed does not look like a lost source for ever. */
static bool is_lost(struct mh_diffusion *track, const struct cluster *cluster)
{
    const mh_real bad = misfit(&track->fit);
    const mh_real normal = mh_max(1.0f, track->usual_misfit);
    track->usual_misfit += 0.05f * (mh_min(bad, 4.0f * normal) - track->usual_misfit);
    track->doubtful = bad > 6.0f * normal ? track->doubtful + 1 : 0;
    if (cluster->found) {
        const mh_real near = (bad > 1.0f ? 0.5f : 1.0f) * track->config.reach_m;
        const bool astray = distance2(newest(&track->fit)->place, cluster->centre) > mh_squared(near);
        track->astray = astray ? track->astray + 1 : 0;
        track->cluster = cluster->centre;
    }
    return cluster->found && (track->doubtful >= 3 || bad > 24.0f * normal || track->astray >= 4 ||
                              track->unanswered >= MH_DIFFUSION_SILENCE);
}

/* One instant of a track, with measurements. After a gap a knot one interval back lets the source have turned meanwhile, and what it released
 * there is as little known as before a start. `restarted` tells whether the track began again. */
static enum mh_status follow(struct mh_diffusion *track, const struct instant *now, bool *restarted)
{
    struct mh_trail_fit *fit = &track->fit;
    const mh_tick interval = fit->model.interval;
    const mh_real log_rate = fit->log_rate;
    const struct cluster cluster = find_cluster(track, now);
    if (now->time - newest(fit)->time > interval + interval / 2) {
        mh_trail_fit_advance(fit, now->time - interval);
        track->since = 0;
    }
    mh_trail_fit_advance(fit, now->time);
    track->since++;
    add_rows(track, now, track->asked, track->asked_radius, &cluster);
    enum mh_status status = mh_trail_fit_solve(fit);
    if (status == MH_OK && cluster.found &&
        (misfit(fit) > 1.0f ||
         distance2(newest(fit)->place, cluster.centre) > mh_squared(0.25f * track->config.reach_m))) {
        status = second_start(fit, fit->knot_count - 2, cluster.centre);
        if (status == MH_OK && misfit(fit) > 1.0f) {
            status = second_start(fit, 0, cluster.centre);
        }
    }
    learn_rate_change(track, mh_abs(fit->log_rate - log_rate));
    *restarted = status == MH_OK && is_lost(track, &cluster);
    return *restarted ? restart(track, now, cluster.centre) : status;
}

/* Position, velocity and covariance at `time`, not before the newest knot: along the last segment. The covariance is the fit's plus that of
 * the turns since, one independent change of velocity an interval, and the doubt of learn_misfit(). */
static void extrapolate(const struct mh_diffusion *track, mh_tick time, struct mh_estimate *estimate)
{
    const struct mh_trail_fit *fit = &track->fit;
    const int m = fit->knot_count - 1;
    const struct mh_fit_knot *last = &fit->knots[m], *older = last - 1;
    const mh_real duration = mh_seconds_between(older->time, last->time), ahead = mh_seconds_between(last->time, time);
    const mh_real interval = mh_seconds_between(0, fit->model.interval);
    estimate->origin = track->origin;
    estimate->time = time;
    estimate->velocity.x = (last->place.x - older->place.x) / duration;
    estimate->velocity.y = (last->place.y - older->place.y) / duration;
    estimate->position.x =
        mh_clamp(last->place.x + ahead * estimate->velocity.x, fit->bounds.low.x, fit->bounds.high.x);
    estimate->position.y =
        mh_clamp(last->place.y + ahead * estimate->velocity.y, fit->bounds.low.y, fit->bounds.high.y);
    estimate->raw = estimate->position;
    estimate->states = 2;

    const mh_real f = ahead / duration, g = 1.0f + f, steps = ahead / interval;
    const mh_real turns = mh_squared(fit->model.turn_mps2 * interval * interval) * steps * (steps + 1.0f) *
                          (2.0f * steps + 1.0f) * (1.0f / 6.0f);
    mh_real pp[4], pq[4], qq[4];
    mh_trail_fit_block(fit, m, m, pp);
    mh_trail_fit_block(fit, m, m - 1, pq);
    mh_trail_fit_block(fit, m - 1, m - 1, qq);
    const mh_real level = track->level < 1.0f ? track->level : 1.0f + MISFIT_SHARED * (track->level - 1.0f);
    estimate->covariance.xx =
        track->ambiguity.xx + level * (g * g * pp[0] - 2.0f * g * f * pq[0] + f * f * qq[0]) + turns;
    estimate->covariance.xy = track->ambiguity.xy + level * (g * g * pp[1] - g * f * (pq[1] + pq[2]) + f * f * qq[1]);
    estimate->covariance.yy =
        track->ambiguity.yy + level * (g * g * pp[3] - 2.0f * g * f * pq[3] + f * f * qq[3]) + turns;
}

/* What the residuals say of the covariance. Where they are larger than the noise assumed, the source may as well be where the increments crowd:
 * with the share of the misfit that noise does not explain as probability. Where no increment is significant any more, it may have left. */
static void learn_misfit(struct mh_diffusion *track)
{
    const struct mh_trail_fit *fit = &track->fit;
    track->level =
        mh_max(LEVEL_MIN, (fit->cost + LEVEL_INERTIA * track->level) / ((mh_real)fit->row_count + LEVEL_INERTIA));
    const struct mh_vec2 place = fit->knots[fit->knot_count - 1].place;
    const struct mh_vec2 off = {track->cluster.x - place.x, track->cluster.y - place.y};
    const mh_real doubt = track->level > 1.0f ? 1.0f - 1.0f / track->level : 0.0f;
    const mh_real unheard = (mh_real)(track->unanswered > 1 ? track->unanswered - 1 : 0);
    const mh_real left = mh_squared(unheard * mh_seconds_between(0, fit->model.interval) * track->config.speed_mps);
    track->ambiguity.xx = doubt * off.x * off.x + left;
    track->ambiguity.xy = doubt * off.x * off.y;
    track->ambiguity.yy = doubt * off.y * off.y + left;
}

/* Follow the density of the nodes that answered, and choose whom to ask next. */
static void ask(struct mh_diffusion *track, const struct instant *now)
{
    const mh_real reach = track->config.reach_m;
    size_t answers = 0;
    for (size_t i = 0; i < now->count; i++) {
        const struct mh_vec2 place = mh_place_relative(&now->measurements[i].place, &track->origin);
        answers += distance2(place, track->asked) <= mh_squared(track->asked_radius) ? 1u : 0u;
    }
    if (now->count > 0) {
        const mh_real density = (mh_real)answers / (MH_PI * mh_squared(track->asked_radius));
        track->density = track->density > 0.0f ? track->density + 0.2f * (density - track->density) : density;
    }
    struct mh_estimate last, next;
    extrapolate(track, now->time, &last);
    extrapolate(track, now->time + track->fit.model.interval, &next);
    track->asked.x = last.position.x + 0.75f * (next.position.x - last.position.x);
    track->asked.y = last.position.y + 0.75f * (next.position.y - last.position.y);
    const mh_real known =
        track->density > 0.0f ? mh_sqrt(1.25f * (mh_real)MH_DIFFUSION_NEAR / (MH_PI * track->density)) : reach;
    const mh_real spread = 2.0f * mh_sqrt(mh_max(next.covariance.xx, next.covariance.yy));
    track->asked_radius = mh_clamp(mh_max(known, spread), 0.125f * reach, reach);
}

/* The measurement with the largest increment of at least chi; NULL if there is none. */
static const struct mh_measurement *strongest(const struct mh_diffusion *track, const struct instant *now)
{
    const struct mh_measurement *best = NULL;
    for (size_t i = 0; i < now->count; i++) {
        const struct mh_measurement *m = &now->measurements[i];
        if (is_strong(&track->config, m) && (best == NULL || m->increment > best->increment)) {
            best = m;
        }
    }
    return best;
}

static size_t count_detections(const struct mh_diffusion *track, const struct instant *now)
{
    size_t detections = 0;
    for (size_t i = 0; i < now->count; i++) {
        detections += mh_q20_to_real(now->measurements[i].value) > track->config.chi ? 1u : 0u;
    }
    return detections;
}

/* True if the instant says anything about where the source is: a strong increment anywhere, or a node near the source. */
static bool is_heard(const struct mh_diffusion *track, const struct instant *now)
{
    for (size_t i = 0; i < now->count; i++) {
        const struct mh_measurement *m = &now->measurements[i];
        const struct mh_vec2 place = mh_place_relative(&m->place, &track->origin);
        if (has_increment(m) &&
            (is_strong(&track->config, m) || distance2(place, track->asked) <= mh_squared(track->asked_radius))) {
            return true;
        }
    }
    return false;
}

/* True if a significant increment stands near the newest knot: the source, if it is there, goes on releasing. */
static bool is_answered(struct mh_diffusion *track, const struct instant *now)
{
    const struct mh_vec2 place = newest(&track->fit)->place;
    const struct vicinity vicinity = {{place, place}, mh_squared(0.5f * track->config.reach_m)};
    struct ranking strong;
    rank_strong(track, now, 1, &vicinity, &strong);
    return strong.count > 0;
}

/* Look for a source. */
static enum mh_status detect(struct mh_diffusion *track, const struct instant *now)
{
    const struct mh_measurement *peak = strongest(track, now);
    if (peak == NULL || count_detections(track, now) < DETECTIONS_LEAST) {
        return MH_NONE;
    }
    track->origin = peak->place;
    const struct cluster cluster = find_cluster(track, now);
    if (!cluster.found) {
        return MH_NONE;
    }
    bound_region(track);
    track->fit.log_rate = mh_log(track->config.release_gps);
    track->fit.prior_log_rate = track->fit.log_rate;
    track->fit.log_rate_sd = 1.0f;
    track->asked = cluster.centre;
    track->asked_radius = track->config.reach_m;
    return start(track, now, cluster.centre);
}

static enum mh_status step(void *state, mh_tick time, const struct mh_measurement *measurements, size_t count,
                           struct mh_estimate *estimate)
{
    struct mh_diffusion *track = state;
    if (track == NULL || estimate == NULL || (measurements == NULL && count > 0)) {
        return MH_ERR_ARGUMENT;
    }
    if (track->stepped && !mh_tick_before(track->time, time)) {
        return MH_ERR_TIME;
    }
    const struct instant now = {time, measurements, count};
    struct mh_trail_fit *fit = &track->fit;
    track->time = time;
    track->stepped = true;
    track->tracking = track->tracking && time - newest(fit)->time <= MH_DIFFUSION_COAST * fit->model.interval;

    uint16_t flags = 0;
    if (!track->tracking) {
        track->silent = 0;
        track->unanswered = 0;
        track->tracking = detect(track, &now) == MH_OK;
        flags = MH_ESTIMATE_STARTED;
    } else if (is_heard(track, &now)) {
        bool restarted = false;
        track->tracking = follow(track, &now, &restarted) == MH_OK;
        track->silent = strongest(track, &now) != NULL ? 0 : track->silent + 1;
        track->unanswered = restarted || is_answered(track, &now) ? 0 : track->unanswered + 1;
        track->tracking =
            track->tracking && track->silent <= MH_DIFFUSION_SILENCE && track->unanswered <= MH_DIFFUSION_COAST;
        flags = restarted ? MH_ESTIMATE_STARTED : 0;
    } else {
        track->used = 0;
        flags = MH_ESTIMATE_COASTED;
    }
    if (!track->tracking) {
        return MH_NONE;
    }
    if (flags != MH_ESTIMATE_COASTED) {
        learn_misfit(track);
    }
    ask(track, &now);
    memset(estimate, 0, sizeof *estimate);
    estimate->measurements = track->used;
    estimate->flags = flags;
    extrapolate(track, time, estimate);
    return MH_OK;
}

static enum mh_status predict(const void *state, mh_tick time, struct mh_estimate *estimate)
{
    const struct mh_diffusion *track = state;
    if (track == NULL || estimate == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!track->tracking) {
        return MH_NONE;
    }
    if (mh_tick_before(time, track->time)) {
        return MH_ERR_TIME;
    }
    memset(estimate, 0, sizeof *estimate);
    estimate->flags = MH_ESTIMATE_COASTED;
    extrapolate(track, time, estimate);
    return MH_OK;
}

static enum mh_status interest(const void *state, struct mh_interest *result)
{
    const struct mh_diffusion *track = state;
    if (track == NULL || result == NULL) {
        return MH_ERR_ARGUMENT;
    }
    if (!track->tracking) {
        return MH_NONE;
    }
    result->centre = mh_place_from_offset(&track->origin, track->asked);
    result->radius_mm = (uint32_t)(track->asked_radius * 1000.0f);
    return MH_OK;
}

const struct mh_tracker mh_tracker_diffusion = {
    .name = "diffusion",
    .state_size = sizeof(struct mh_diffusion),
    .config_size = sizeof(struct mh_diffusion_config),
    .init = init,
    .step = step,
    .predict = predict,
    .interest = interest,
};
