#include "world/faults.h"

#include <math.h>

void faults_make(struct faults *faults, const struct scenario *scenario, uint64_t seed)
{
    const double angle = scenario->faults.partition.angle_rad;
    *faults = (struct faults){.every_s = scenario->faults.every_s,
                              .stream = random_stream(seed, RANDOM_FAULTS),
                              .line_x = -sin(angle),
                              .line_y = cos(angle),
                              .jam_x_m = scenario->faults.jam.x_m,
                              .jam_y_m = scenario->faults.jam.y_m,
                              .jam_radius_m = scenario->faults.jam.radius_m};
    faults->line_at = scenario->faults.partition.x_m * faults->line_x + scenario->faults.partition.y_m * faults->line_y;
    const struct {
        double share, from_s, for_s;
    } given[FAULTS] = {
        [FAULT_STUCK] = {scenario->faults.stuck.share, scenario->faults.stuck.from_s, scenario->faults.stuck.for_s},
        [FAULT_SPIKE] = {scenario->faults.spike.share, scenario->faults.spike.from_s, scenario->faults.spike.for_s},
        [FAULT_SATURATE] = {scenario->faults.saturate.share, scenario->faults.saturate.from_s,
                            scenario->faults.saturate.for_s},
        [FAULT_BIAS] = {scenario->faults.bias.share, scenario->faults.bias.from_s, scenario->faults.bias.for_s},
        [FAULT_DEAD] = {scenario->faults.dead.share, scenario->faults.dead.from_s, HUGE_VAL},
        [FAULT_REBOOT] = {scenario->faults.reboot.share, scenario->faults.reboot.from_s, scenario->faults.reboot.for_s},
        [FAULT_PARTITION] = {1, scenario->faults.partition.from_s, scenario->faults.partition.for_s},
        [FAULT_MUTE] = {1, scenario->faults.mute.from_s, scenario->faults.mute.for_s},
        [FAULT_JAM] = {1, scenario->faults.jam.from_s, scenario->faults.jam.for_s},
    };
    for (int i = 0; i < FAULTS; i++) {
        faults->windows[i].share = given[i].share;
        faults->windows[i].from_s = given[i].from_s;
        faults->windows[i].until_s = given[i].from_s + given[i].for_s;
    }
}

bool faults_include(const struct faults *faults, enum fault fault)
{
    return faults->windows[fault].share > 0 && faults->windows[fault].until_s > faults->windows[fault].from_s;
}

/* How many periods are over. */
static double periods(const struct faults *faults, double time_s)
{
    return faults->every_s > 0 ? floor(time_s / faults->every_s) : 0;
}

bool faults_are_on(const struct faults *faults, enum fault fault, double time_s)
{
    const double since_s = time_s - periods(faults, time_s) * faults->every_s;
    return faults_include(faults, fault) && since_s >= faults->windows[fault].from_s &&
           since_s < faults->windows[fault].until_s;
}

bool faults_hit(const struct faults *faults, enum fault fault, double time_s, uint32_t mote)
{
    if (!faults_are_on(faults, fault, time_s)) {
        return false;
    }
    const uint64_t draw = (uint64_t)periods(faults, time_s) * FAULTS + (uint64_t)fault;
    return random_uniform(faults->stream, draw << 32 | mote) < faults->windows[fault].share;
}

double faults_next_change_s(const struct faults *faults, enum fault fault, double time_s)
{
    const double begin_s = periods(faults, time_s) * faults->every_s;
    const double changes_s[] = {begin_s + faults->windows[fault].from_s, begin_s + faults->windows[fault].until_s,
                                faults->every_s > 0 ? begin_s + faults->every_s : HUGE_VAL};
    double next_s = HUGE_VAL;
    for (size_t i = 0; i < sizeof changes_s / sizeof changes_s[0] && faults_include(faults, fault); i++) {
        next_s = changes_s[i] > time_s && changes_s[i] < next_s ? changes_s[i] : next_s;
    }
    return next_s;
}

bool faults_part(const struct faults *faults, double time_s, double ax_m, double ay_m, double bx_m, double by_m)
{
    const bool a_beyond = ax_m * faults->line_x + ay_m * faults->line_y > faults->line_at;
    const bool b_beyond = bx_m * faults->line_x + by_m * faults->line_y > faults->line_at;
    return a_beyond != b_beyond && faults_are_on(faults, FAULT_PARTITION, time_s);
}

bool faults_jam(const struct faults *faults, double time_s, double x_m, double y_m)
{
    const double x = x_m - faults->jam_x_m, y = y_m - faults->jam_y_m;
    return x * x + y * y <= faults->jam_radius_m * faults->jam_radius_m && faults_are_on(faults, FAULT_JAM, time_s);
}
