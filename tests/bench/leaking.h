/* A leak of 30 at (50, 200) in the published field (gas.h) and sensors about it, which read it with a noise of 0.1 ppb. */
#ifndef LEAKING_H
#define LEAKING_H

#include "motehound/gas.h"

enum { LEAKING_INTERVAL = 5000, LEAKING_MEASUREMENTS = 9 };

void leaking_config(struct mh_gas_config *config);

/* A head and its eight neighbours out of so many sensors, at step number `step`: in seven steps each of up to 60 has its turn. */
void leaking_measurements(unsigned step, unsigned sensors, struct mh_measurement *measurements);

#endif
