/* How much of a transmission arrives where: mean power, the same in both directions, constant in time.
 *
 * Disc: power 1 within the range, none beyond. Log-distance with log-normal shadowing (Rappaport, "Wireless Communications", 2002, Eq. (4.69)):
 *
 *   P(d) = power - reference_loss - 10 exponent lg(d / 1 m) - X,   X ~ N(0, shadowing^2), at most 3 shadowing either way
 *
 * in dBm; nearer than 1 m as at 1 m. X belongs to the pair of places: a hash of it and the seed. The cut at three standard
 * deviations (0.27 % of the links) bounds how far away a transmission can be felt. */
#ifndef MOTEHOUND_SIM_PROPAGATION_H
#define MOTEHOUND_SIM_PROPAGATION_H

#include "engine/random.h"
#include "radio/places.h"
#include "scenario/scenario.h"

#include <stdbool.h>

struct propagation_config {
    enum propagation_kind kind;
    double range_m;                     /* disc; HUGE_VAL: all hear all */
    double power_dbm;                   /* of all transmitters; log-distance, as all below */
    double exponent, reference_loss_db; /* of the path; loss at 1 m */
    double shadowing_db;                /* standard deviation; 0: none */
};

struct propagation {
    struct propagation_config config;
    struct random_stream shadowing;
    uint64_t places; /* their number, to number the pairs */
    double power_at_1m_mw;
};

struct propagation propagation_make(const struct propagation_config *config, size_t places, uint64_t seed);

/* Shadowing of the link between two places, dB. Symmetric. */
double propagation_shadowing_db(const struct propagation *propagation, uint32_t a, uint32_t b);

/* What arrives at `b` of a transmission of `a`, or the other way round: mW; disc: 1 or 0. */
double propagation_power(const struct propagation *propagation, const struct place *a, const struct place *b);

/* Beyond this distance nothing as strong as `power` arrives, whatever the shadowing. */
double propagation_reach_m(const struct propagation *propagation, double power);

double mw_from_dbm(double dbm);

#endif
