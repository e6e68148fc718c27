/* Four estimates of a state (x, vx, y, vy), and what each rule makes of them in double precision. */
#ifndef FUSION_ANSWERS_H
#define FUSION_ANSWERS_H

#include "motehound/gaussian.h"
#include "unity.h"

static const struct mh_gaussian told[4] = {
    {4,
     {10, 1.02f, 5.1f, -1},
     {0.0331045346f, 0, 0.00177015115f, 0.0126220648f, 0, 0.0168954654f, 0, 0.000420735492f, 0, 0.00122984885f}},
    {4,
     {10.0841471f, 1.01080605f, 4.95838532f, -0.9971776f},
     {0.01919122f, 0, 0.002f, 0.0236412113f, 0, 0.07080878f, 0, 0, 0, 0.002f}},
    {4,
     {10.0909297f, 0.991677063f, 4.93463564f, -1.00558831f},
     {0.0214967758f, 0, 0.00289548386f, -0.033652184f, 0, 0.108503224f, 0, 0.000305928945f, 0, 0.00210451614f}},
    {4,
     {10.014112f, 0.98020015f, 5.09601703f, -0.99175763f},
     {0.12013875f, 0, 0.00253148333f, -0.0662590992f, 0, 0.0498612497f, 0, 0.000883454656f, 0, 0.00346851667f}}};
static const struct mh_gaussian by_trace = {
    4,
    {10.0558562f, 1.009785f, 5.084025f, -1.00019304f},
    {0.0170811012f, 0, 0.00202068162f, 0.00335526718f, 0, 0.0185859876f, 0, 0.000366962311f, 0, 0.00162171438f}};
static const mh_real by_trace_w[4] = {0.442956358f, 0.249751989f, 0.173901385f, 0.133390267f};
static const struct mh_gaussian trace_optimal = {
    4,
    {10.0219696f, 1.01010141f, 5.09981216f, -1.00196476f},
    {0.0172524345f, 0, 0.0020935759f, 0.00149818962f, 0, 0.0169854405f, 0, 0.000438291517f, 0, 0.00151795918f}};
static const mh_real trace_optimal_w[4] = {0.573546565f, 0, 0.352617107f, 0.0738363273f};
static const struct mh_gaussian determinant_optimal = {
    4,
    {10.0130732f, 1.01691113f, 5.10299867f, -1.00094676f},
    {0.0229207482f, 0, 0.00188685214f, 0.00691098927f, 0, 0.0159588239f, 0, 0.000424269051f, 0, 0.00131680618f}};
static const mh_real determinant_optimal_w[4] = {0.835159077f, 0, 0.164840923f, 0};
static const struct mh_gaussian independent = {4,
                                               {10.0624777f, 1.00300977f, 5.06729683f, -0.999613059f},
                                               {0.00396851648f, 0, 0.000544675954f, -0.000165867166f, 0, 0.00501316379f,
                                                0, 9.27176482e-05f, 0, 0.00047363914f}}; /* of all four */
/* of the first two */
static const struct mh_gaussian pair_trace_optimal = {
    4,
    {10.0659571f, 1.0175361f, 5.10300405f, -0.999885845f},
    {0.0238720795f, 0, 0.00181293245f, 0.0114788559f, 0, 0.0210677841f, 0, 0.00034242485f, 0, 0.00137319552f}};
static const struct mh_gaussian pair_inverse = {
    4,
    {10.1124797f, 1.01642215f, 5.12278222f, -1.00040365f},
    {0.0176191819f, 0, 0.00181559137f, 0.00915754319f, 0, 0.018111186f, 0, 0.000337557741f, 0, 0.0013821047f}};
static const struct mh_gaussian pair_ellipsoidal = {
    4,
    {10.1351465f, 1.01705337f, 5.13558086f, -1.00160975f},
    {0.0146189483f, 0, 0.00177015115f, 0.00775521321f, 0, 0.0156141296f, 0, 0.000420735492f, 0, 0.00122984885f}};
static const struct mh_gaussian pair_split = {4,
                                              {10.0817338f, 1.01639573f, 5.09754869f, -0.999695922f},
                                              {0.0154688054f, 0, 0.00131702542f, 0.00841451945f, 0, 0.0173010205f, 0,
                                               0.000214272052f, 0,
                                               0.00104186041f}}; /* dependent: 0.6 of the first, 0.3 of the second */

/* Means to a share of their standard deviation, covariances to a share of the variances'. */
static inline void assert_close(const struct mh_gaussian *expected, const struct mh_gaussian *actual, mh_real share)
{
    TEST_ASSERT_EQUAL_INT(expected->n, actual->n);
    for (int j = 0; j < expected->n; j++) {
        const mh_real sd = mh_sqrt(expected->P[MH_PACKED(j, j)]);
        TEST_ASSERT_FLOAT_WITHIN(share * sd, expected->x[j], actual->x[j]);
        for (int i = 0; i <= j; i++) {
            const int k = MH_PACKED(i, j);
            TEST_ASSERT_FLOAT_WITHIN(share * sd * mh_sqrt(expected->P[MH_PACKED(i, i)]), expected->P[k], actual->P[k]);
        }
    }
}

#endif
