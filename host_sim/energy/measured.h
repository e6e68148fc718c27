/* Cycles of an ATmega128, measured. Made by tools/cpu-costs. */

/* clang-format off */
static const struct work measured_steps[] = {
    {"acoustic", 388101, 0, 0, 0, 0.0}, /* float */
    {"centroid", 6991, 354, 0, 0, 0.0}, /* fixed */
    {"cv_ekf", 0, 130227, 0, 0, 0.0}, /* float */
    {"cv_ukf", 0, 171026, 0, 0, 0.0}, /* float */
    {"diffusion", 24614515, 0, 0, 0, 0.0}, /* float */
    {"dm", 185325, 0, 0, 0, 0.0}, /* fixed */
    {"gas", 110964290, 0, 0, 0, 0.0}, /* float */
    {"gas_ekf", 0, 41205, 0, 0, 0.0}, /* float */
    {"gas_small", 0, 166276, 0, 0, 0.0}, /* float */
    {"gas_ukf", 0, 104913, 0, 0, 0.0}, /* float */
    {"luo", 429667, 0, 0, 0, 0.0}, /* fixed */
    {"ml", 31381209, 0, 0, 0, 0.0}, /* float */
    {"msl", 0, 0, 7877, 819, 8.5}, /* float */
    {"pftl", 0, 0, 4057, 320, 3.7}, /* fixed */
    {"range", 111466, 3959, 0, 0, 0.0}, /* float */
};

#define MEASURED_SAMPLE_CYCLES 3686 /* 2,337, and the converter's driver, which is an assumption */
#define MEASURED_FRAME_CYCLES 6556 /* half of hearing a report and sending it on */
/* clang-format on */
