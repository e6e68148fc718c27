/* What a mote draws: one row of a table for each kind of mote, from its data sheet, and what its processor has to do. */
#ifndef MOTEHOUND_SIM_ENERGY_PROFILE_H
#define MOTEHOUND_SIM_ENERGY_PROFILE_H

#include <stdint.h>

/* Currents in mA at `volts`. */
struct energy_profile {
    const char *name, *source;
    double volts;
    double sleep, listen, receive;
    /* Transmitting, by the power at the antenna: ascending, linear between rows, the ends' own beyond them. */
    struct {
        double dbm, current;
    } transmit[8];
    int transmit_count;
    double cpu, cpu_idle; /* working; while the mote does nothing */
    double sensing;       /* besides the processor */
    double cpu_mhz;
};

/* Profile `index`, or NULL after the last: `none`, where nothing is charged, is no row. */
const struct energy_profile *energy_profile_at(int index);

/* Or NULL: `none`, or no such name. */
const struct energy_profile *energy_profile_find(const char *name);

/* Current of transmitting at `dbm`, mA. */
double energy_profile_transmit(const struct energy_profile *profile, double dbm);

/* What work costs the processor: measured on the ATmega128's benchmarks (tools/cpu-costs), or as published comparisons take it. */
enum energy_cpu { ENERGY_CPU_MEASURED, ENERGY_CPU_ASSUMED };

/* How long work takes, in microseconds. */
uint64_t energy_sensing_us(void); /* the sensor, for one sample */
uint64_t energy_sample_us(const struct energy_profile *profile,
                          enum energy_cpu cpu); /* the processor, for that sample */
uint64_t energy_frame_us(const struct energy_profile *profile,
                         enum energy_cpu cpu); /* ... for a frame received or sent */
/* ... for a step of the tracker named, with so many measurements and particles drawn; 0 for a name that no row has. */
uint64_t energy_tracker_us(const struct energy_profile *profile, enum energy_cpu cpu, const char *tracker,
                           int measurements, uint32_t draws);
/* How many particles a step of the tracker named draws on average, with so many to keep: where its mote does not tell. */
uint32_t energy_tracker_draws(enum energy_cpu cpu, const char *tracker, int particles);

#endif
