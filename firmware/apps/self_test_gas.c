#include "motehound/plume.h"
#include "self_test_parts.h"

/* K = 30 m2/s, wind of 1 m/s along x, a source at (50, 0); computed with 64 bits */
bool self_test_gas(void)
{
    static const struct mh_plume plume = {30.0f, 1.0f, {1.0f, 0.0f}};
    static const struct mh_vec2 sensor = {60.0f, 10.0f}, source = {50.0f, 0.0f};
    const mh_real known = 3.50108054e-4f;
    struct mh_vec2 slope;
    mh_real c;
    return self_test_node() && mh_plume_model(&plume, sensor, source, 0.0f, &c, &slope) == MH_OK &&
           mh_abs(c - known) <= 1e-4f * known;
}
