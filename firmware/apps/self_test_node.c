#include "motehound/sensor.h"
#include "motehound/wire.h"
#include "self_test_parts.h"

static bool knows_check_sequence(void)
{
    uint16_t fcs = 0;
    for (uint8_t digit = '1'; digit <= '9'; digit++) {
        fcs = mh_wire_fcs_next(fcs, digit);
    }
    return fcs == 0x2189;
}

static bool knows_difference(void)
{
    FLASH struct mh_sensor_config given = {
        .zero_counts = 10, .q20_per_count = 5125, .counts_max = 1023, .interval = 1000};
    FLASH struct mh_reading given_readings[] = {{0, 10, 0}, {1000, 110, 0}};
    struct mh_sensor_config config;
    struct mh_reading readings[2];
    struct mh_sensor sensor;
    struct mh_sample sample;
    flash_read(&config, &given, sizeof config);
    flash_read(readings, given_readings, sizeof readings);
    return mh_sensor_init(&sensor, &config) == MH_OK && mh_sensor_take(&sensor, &readings[0], &sample) == MH_OK &&
           mh_sensor_take(&sensor, &readings[1], &sample) == MH_OK && sample.has_increment &&
           sample.increment == 512500 && sample.value == 512500;
}

bool self_test_node(void) { return knows_check_sequence() && knows_difference(); }
