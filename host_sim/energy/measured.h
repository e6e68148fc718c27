/* Cycles of an ATmega128, measured. Made by tools/cpu-costs. */

/* clang-format off */
static const struct work measured_steps[] = {
    {"acoustic", 418958, 0, 0, 0, 0.0}, /* float */
    {"centroid", 7729, 354, 0, 0, 0.0}, /* fixed */
    {"cv_ekf", 0, 130966, 0, 0, 0.0}, /* float */
    {"cv_ukf", 0, 171508, 0, 0, 0.0}, /* float */
    {"diffusion", 24614515, 0, 0, 0, 0.0}, /* float */
    {"dm", 162148, 0, 0, 0, 0.0}, /* float */
    {"gas", 110964166, 0, 0, 0, 0.0}, /* float */
    {"gas_ekf", 0, 41174, 0, 0, 0.0}, /* float */
    {"gas_small", 0, 166272, 0, 0, 0.0}, /* float */
    {"gas_ukf", 0, 104882, 0, 0, 0.0}, /* float */
    {"luo", 522289, 0, 0, 0, 0.0}, /* fixed */
    {"ml", 31381209, 0, 0, 0, 0.0}, /* float */
    {"msl", 0, 0, 7888, 818, 8.5}, /* float */
    {"pftl", 0, 0, 5200, 443, 3.7}, /* fixed */
    {"range", 111666, 3958, 0, 0, 0.0}, /* float */
};
/* clang-format on */

#define MEASURED_SAMPLE_CYCLES 3686 /* 2,337, and the converter's driver, which is an assumption */
#define MEASURED_FRAME_CYCLES 6550  /* half of hearing a report and sending it on */
