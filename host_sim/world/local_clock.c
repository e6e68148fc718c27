#include "world/local_clock.h"

#include "engine/random.h"

#define MICROSECONDS_PER_TICK (SIM_TIME_PER_S / MH_TICKS_PER_S)

/* What a mote draws from its stream. */
enum { DRAW_OFFSET, DRAW_DRIFT, DRAW_PHASE, DRAWS };

struct local_clock local_clock_draw(uint64_t seed, uint32_t mote, double offset_s, double drift_ppm, double wander_ppm)
{
    const struct random_stream stream = random_stream(seed, RANDOM_CLOCK);
    const uint64_t first = (uint64_t)mote * DRAWS;
    return (struct local_clock){
        .offset_us = (int64_t)(offset_s * SIM_TIME_PER_S * (2 * random_uniform(stream, first + DRAW_OFFSET) - 1)),
        .drift_ppm = drift_ppm * (2 * random_uniform(stream, first + DRAW_DRIFT) - 1),
        .wander_ppm = wander_ppm,
        .wander_phase = wander_ppm > 0 ? random_uniform(stream, first + DRAW_PHASE) : 0,
    };
}

static bool is_zero(double a) { return !(a < 0 || a > 0); }

bool local_clock_is_ideal(const struct local_clock *clock)
{
    return clock->offset_us == 0 && is_zero(clock->drift_ppm) && is_zero(clock->wander_ppm);
}

static double floor_of(double a)
{
    const double whole = (double)(int64_t)a;
    return whole > a ? whole - 1 : whole;
}

/* Integral of s from the beginning of a period to `turns` periods later, in periods: s(x) = 16 x (1/2 - x) in the first half, the same with
 * the sign changed in the second, so whole periods add nothing. */
static double wander_integral(double turns)
{
    const double x = turns - floor_of(turns);
    const double u = x < 0.5 ? x : x - 0.5;
    const double arc = u * u * (4 - u * (16.0 / 3));
    return x < 0.5 ? arc : 1.0 / 3 - arc;
}

static int64_t gain_us(const struct local_clock *clock, int64_t time_us)
{
    const double time = (double)time_us;
    double gain = time * (clock->drift_ppm * 1e-6);
    if (clock->wander_ppm > 0) {
        const double period = (double)LOCAL_CLOCK_WANDER_PERIOD_S * SIM_TIME_PER_S;
        const double since =
            wander_integral(clock->wander_phase + time / period) - wander_integral(clock->wander_phase);
        gain += since * (clock->wander_ppm * 1e-6 * period);
    }
    return (int64_t)floor_of(gain);
}

int64_t local_clock_us(const struct local_clock *clock, int64_t time_us)
{
    return time_us + clock->offset_us + gain_us(clock, time_us);
}

void local_clock_restart(struct local_clock *clock, sim_time time)
{
    if (!local_clock_is_ideal(clock)) {
        clock->offset_us -= local_clock_us(clock, (int64_t)time);
    }
}

int64_t local_clock_time_of_us(const struct local_clock *clock, int64_t local_us)
{
    int64_t time = local_us - clock->offset_us;
    if (local_clock_is_ideal(clock)) {
        return time;
    }
    /* each round leaves at most 2 parts in 1,000 of the error */
    for (int round = 0; round < 8; round++) {
        time += local_us - local_clock_us(clock, time);
    }
    while (local_clock_us(clock, time) < local_us) {
        time++;
    }
    while (local_clock_us(clock, time - 1) >= local_us) {
        time--;
    }
    return time;
}

static int64_t whole_tick(int64_t local_us)
{
    return local_us / MICROSECONDS_PER_TICK - (local_us % MICROSECONDS_PER_TICK < 0);
}

mh_tick local_clock_tick(const struct local_clock *clock, sim_time time)
{
    return (mh_tick)whole_tick(local_clock_us(clock, (int64_t)time));
}

int64_t local_clock_time_of(const struct local_clock *clock, sim_time now, mh_tick tick)
{
    const int64_t shown = whole_tick(local_clock_us(clock, (int64_t)now));
    const int64_t ahead = mh_ticks_between((mh_tick)shown, tick);
    return local_clock_time_of_us(clock, (shown + ahead) * MICROSECONDS_PER_TICK);
}
