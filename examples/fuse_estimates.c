/* Three motes follow one target, each with a filter of its own, and tell a fourth what they know: by covariance intersection it is sure of no more
 * than they can know together, whatever their errors have in common. */
#include "motehound/fusion.h"
#include <stdio.h>

enum { MOTES = 3, STATES = 2, LENGTH = MH_GAUSSIAN_BYTES(STATES) };

/* East and north of the target in metres; variances and, between them, the covariance. */
static const struct mh_gaussian at_mote[MOTES] = {
    {STATES, {10.2f, 5.1f}, {0.04f, 0, 1.0f}},       /* sees it from the south: knows east well */
    {STATES, {9.5f, 4.9f}, {1.0f, 0, 0.04f}},        /* from the west: north */
    {STATES, {10.4f, 4.8f}, {0.25f, -0.2f, 0.25f}}}; /* from the south-east: good across its line of sight */

static void print(const char *rule, const struct mh_gaussian *estimate)
{
    printf("%-24s %5.2f +- %.2f m east, %4.2f +- %.2f m north\n", rule, (double)estimate->x[0],
           (double)mh_sqrt(estimate->P[MH_PACKED(0, 0)]), (double)estimate->x[1],
           (double)mh_sqrt(estimate->P[MH_PACKED(1, 1)]));
}

int main(void)
{
    struct mh_gaussian heard[MOTES], fused;
    mh_real w[MOTES];
    uint8_t count = 0;
    for (int i = 0; i < MOTES; i++) {
        uint8_t message[LENGTH];
        mh_gaussian_write(&at_mote[i], message);
        /* ... over the air; what arrives is a mean and a covariance, or it is refused */
        if (mh_gaussian_read(&heard[count], STATES, message) == MH_OK) {
            count++;
        }
    }
    if (mh_fusion_weights(heard, count, w) != MH_OK || mh_fusion_intersect(heard, count, w, &fused) != MH_OK) {
        return 1;
    }
    print("covariance intersection", &fused);
    if (mh_fusion_weights_trace(heard, count, w) != MH_OK || mh_fusion_intersect(heard, count, w, &fused) != MH_OK) {
        return 1;
    }
    print("with the best weights", &fused);
    if (mh_fusion_naive(heard, count, &fused) != MH_OK) {
        return 1;
    }
    print("were they independent", &fused);
    return 0;
}
