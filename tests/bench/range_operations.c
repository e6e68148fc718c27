/* How many floating-point operations a step of the tracker `range` takes, counted at the doors of the soft-float library: the linker leads
 * every call through the counters here (--wrap). */
#include "motehound/random.h"
#include "motehound/range.h"
#include "port.h"
#include "unity.h"

#include <stdio.h>

void setUp(void) {}
void tearDown(void) {}

enum { ADDED, MULTIPLIED, DIVIDED, ROOTS, COMPARED, CONVERTED, KINDS };

static uint32_t counts[KINDS];
static bool counting;

#define COUNTED(name, kind)                                                                                            \
    uint32_t __real_##name(uint32_t a, uint32_t b);                                                                    \
    uint32_t __wrap_##name(uint32_t a, uint32_t b);                                                                    \
    uint32_t __wrap_##name(uint32_t a, uint32_t b)                                                                     \
    {                                                                                                                  \
        counts[kind] += counting;                                                                                      \
        return __real_##name(a, b);                                                                                    \
    }

COUNTED(__aeabi_fadd, ADDED)
COUNTED(__aeabi_fsub, ADDED)
COUNTED(__aeabi_frsub, ADDED)
COUNTED(__aeabi_fmul, MULTIPLIED)
COUNTED(__aeabi_fdiv, DIVIDED)
COUNTED(__aeabi_fcmpeq, COMPARED)
COUNTED(__aeabi_fcmplt, COMPARED)
COUNTED(__aeabi_fcmple, COMPARED)
COUNTED(__aeabi_fcmpge, COMPARED)
COUNTED(__aeabi_fcmpgt, COMPARED)
COUNTED(__aeabi_fcmpun, COMPARED)
COUNTED(__aeabi_i2f, CONVERTED)
COUNTED(__aeabi_ui2f, CONVERTED)
COUNTED(__aeabi_f2iz, CONVERTED)
COUNTED(__aeabi_f2uiz, CONVERTED)

float __real_sqrtf(float a);
float __wrap_sqrtf(float a);
float __wrap_sqrtf(float a) /* what it is made of is not counted */
{
    const bool before = counting;
    counts[ROOTS] += counting;
    counting = false;
    const float root = __real_sqrtf(a);
    counting = before;
    return root;
}

enum { RANGES = 12, STEPS = 300, INTERVAL = 2000 };

static const mh_real reach_m = 50, speed_mps = 4.4704f, noise_m = 5;

static struct mh_random random_numbers;
static struct mh_range state;
static struct mh_measurement measurements[RANGES];

static mh_real normal(void) /* a sum of twelve uniform ones */
{
    mh_real sum = -6;
    for (int i = 0; i < 12; i++) {
        sum += mh_random_unit(&random_numbers);
    }
    return sum;
}

/* twelve nodes somewhere within reach of a target at (x, y) m */
static void measure(mh_tick time, mh_real x, mh_real y)
{
    for (int i = 0; i < RANGES; i++) {
        mh_real dx, dy, square;
        do {
            dx = reach_m * (2 * mh_random_unit(&random_numbers) - 1);
            dy = reach_m * (2 * mh_random_unit(&random_numbers) - 1);
            square = dx * dx + dy * dy;
        } while (square > reach_m * reach_m);
        const struct mh_measurement taken = {.node = (mh_node_id)i,
                                             .place = {(int32_t)(1000 * (x + dx)), (int32_t)(1000 * (y + dy)), 0},
                                             .time = time,
                                             .value = mh_q20_from_real(__real_sqrtf(square) + noise_m * normal())};
        measurements[i] = taken;
    }
}

/* The nominal target and sensors of Zhou: 10 miles an hour, heading and speed as Gauss-Markov processes, ranges of 5 m. */
static void a_step_costs_few_operations(void)
{
    struct mh_range_config config;
    mh_range_config_default(&config);
    config.range_sd_m = noise_m;
    config.sensing_range_m = reach_m;
    config.acceleration_sd_mps2 = 0.43f;
    config.speed_mps = speed_mps;
    config.height_m = 0;
    config.tolerance_m = 5;
    TEST_ASSERT_EQUAL_INT(MH_OK, mh_tracker_range.init(&state, &config, INTERVAL));
    mh_random_init(&random_numbers, 1);
    mh_real x = 0, y = 0, speed = 0, heading = 0; /* the latter two from their means */
    uint32_t worst = 0, before = 0;
    for (int step = 0; step < STEPS; step++) {
        struct mh_estimate estimate;
        measure((mh_tick)step * INTERVAL, x, y);
        counting = step > 0;
        TEST_ASSERT_EQUAL_INT(MH_OK,
                              mh_tracker_range.step(&state, (mh_tick)step * INTERVAL, measurements, RANGES, &estimate));
        counting = false;
        TEST_ASSERT_EQUAL_UINT16(RANGES, estimate.measurements);
        const uint32_t all = counts[ADDED] + counts[MULTIPLIED];
        worst = all - before > worst ? all - before : worst;
        before = all;
        x += 2 * (speed_mps + speed) * cosf(heading);
        y += 2 * (speed_mps + speed) * sinf(heading);
        speed = 0.9f * speed + 0.436f * 0.2f * speed_mps * normal();
        heading = 0.9f * heading + 0.436f * 0.3927f * normal();
    }
    uint32_t mean[KINDS];
    for (int i = 0; i < KINDS; i++) {
        mean[i] = counts[i] / (STEPS - 1);
    }
    char message[160];
    snprintf(
        message, sizeof message,
        "a step with 12 ranges: %u additions, %u multiplications (at most %u together), %u divisions, %u roots, %u "
        "comparisons, %u conversions",
        (unsigned)mean[ADDED], (unsigned)mean[MULTIPLIED], (unsigned)worst, (unsigned)mean[DIVIDED],
        (unsigned)mean[ROOTS], (unsigned)mean[COMPARED], (unsigned)mean[CONVERTED]);
    TEST_MESSAGE(message);
    TEST_ASSERT_TRUE_MESSAGE(mean[ADDED] + mean[MULTIPLIED] <= 900, message);
    TEST_ASSERT_TRUE_MESSAGE(mean[ADDED] + mean[MULTIPLIED] >= 300, message); /* the counters count */
    TEST_ASSERT_TRUE_MESSAGE(mean[DIVIDED] + mean[ROOTS] <= 100, message);
    TEST_ASSERT_TRUE_MESSAGE(mean[DIVIDED] + mean[ROOTS] >= 30, message);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_step_costs_few_operations);
    port_exit(UNITY_END() > 0);
    return 0;
}
