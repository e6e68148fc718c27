/* A scenario as it was run, for whoever reads the results: all keys with their values, an object a section. */
#ifndef MOTEHOUND_SIM_SCENARIO_JSON_H
#define MOTEHOUND_SIM_SCENARIO_JSON_H

#include "scenario/scenario.h"

#include <jansson.h>

/* {"name": ..., "source": {"path": "arcs", "points": [{"x_m", "y_m", "speed_factor"}], ...}, ...}; to be released with
 * json_decref. Returns NULL if there is no memory or a text is not UTF-8. */
json_t *scenario_json(const struct scenario *scenario);

#endif
