#include "motehound/fusion.h"
#include "self_test_parts.h"

#include <string.h>

/* Means 0 and 5 with variances 1 and 4: weights 4/5 and 1/5, 1 / P = 0.85, x = 0.25 / 0.85 */
bool self_test_fusion(void)
{
    struct mh_gaussian told[2], fused;
    mh_real weights[2];
    memset(told, 0, sizeof told); /* no initialiser: an AVR would keep that in RAM */
    told[0].n = told[1].n = 1;
    told[0].P[0] = MH_REAL(1.0f);
    told[1].x[0] = MH_REAL(5.0f);
    told[1].P[0] = MH_REAL(4.0f);
    return self_test_node() && mh_fusion_weights(told, 2, weights) == MH_OK && near(weights[0], MH_REAL(0.8f)) &&
           mh_fusion_intersect(told, 2, weights, &fused) == MH_OK && near(fused.x[0], MH_REAL(0.2941176f)) &&
           near(fused.P[0], MH_REAL(1.1764706f));
}
