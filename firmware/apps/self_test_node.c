#include "motehound/sensor.h"
#include "motehound/wire.h"
#include "self_test_parts.h"

static bool knows_check_sequence(void)
{
    static const uint8_t digits[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
    return mh_wire_fcs(digits, sizeof digits) == 0x2189;
}

static bool knows_difference(void)
{
    static const struct mh_sensor_config config = {
        .zero_counts = 10, .q20_per_count = 5125, .counts_max = 1023, .interval = 1000};
    static const struct mh_reading readings[] = {{0, 10, 0}, {1000, 110, 0}};
    struct mh_sensor sensor;
    struct mh_sample sample;
    return mh_sensor_init(&sensor, &config) == MH_OK && mh_sensor_take(&sensor, &readings[0], &sample) == MH_OK &&
           mh_sensor_take(&sensor, &readings[1], &sample) == MH_OK && sample.has_increment &&
           sample.increment == 512500 && sample.value == 512500;
}

bool self_test_node(void) { return knows_check_sequence() && knows_difference(); }
