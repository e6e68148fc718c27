#include "ideal/ideal.h"

#include "ideal/cluster.h"
#include "ideal/fixed.h"
#include "ideal/prince.h"
#include "ideal/token.h"

#include <stdio.h>
#include <string.h>

static const struct {
    const char *protocol;
    int (*run)(const struct scenario *scenario, uint64_t seed, const struct observer *observer,
               const volatile sig_atomic_t *stop, struct simulation_counters *counters, char *error, size_t error_size);
} modes[] = {
    {"cluster", ideal_cluster_run},
    {"fixed", ideal_fixed_run},
#if !MH_REAL_FIXED /* knows the tracker `acoustic` itself */
    {"prince", ideal_prince_run},
#endif
    {"token", ideal_token_run},
};

int ideal_run(const struct scenario *scenario, uint64_t seed, const struct observer *observer,
              const volatile sig_atomic_t *stop, struct simulation_counters *counters, char *error, size_t error_size)
{
    for (size_t i = 0; i < sizeof modes / sizeof modes[0]; i++) {
        if (strcmp(scenario->network.protocol, modes[i].protocol) == 0) {
            return modes[i].run(scenario, seed, observer, stop, counters, error, error_size);
        }
    }
    snprintf(error, error_size, "network.ideal: no such thing %sfor network.protocol %s",
             MH_REAL_FIXED ? "in this build (MH_REAL=fixed) " : "", scenario->network.protocol);
    return -1;
}
