#include "motehound/prince.h"
#include "motehound/settings.h"

void mh_settings_prince(struct mh_line_fields *fields, void *config)
{
    struct mh_prince_config *prince = config;
    MH_LINE_ENUM(fields, prince->election);
    mh_line_u8(fields, &prince->guards);
    mh_line_u8(fields, &prince->replies);
    mh_line_bool(fields, &prince->farthest);
    mh_line_real(fields, &prince->sensing_range_m);
    mh_line_real(fields, &prince->radio_range_m);
    mh_line_real(fields, &prince->margin_m);
    mh_line_real(fields, &prince->outer_m);
    mh_line_real(fields, &prince->exception);
    mh_line_real(fields, &prince->loudness_m2);
    mh_line_real(fields, &prince->step_m);
    mh_line_u32(fields, &prince->tick);
    mh_line_u32(fields, &prince->window);
    mh_line_u32(fields, &prince->contest);
    mh_line_u32(fields, &prince->watch_period);
    mh_line_u32(fields, &prince->wake_period);
    mh_line_u32(fields, &prince->wake_length);
    mh_line_u32(fields, &prince->hello_period);
}

void mh_settings_prince_entry(struct mh_line_fields *fields, struct mh_prince_entry *entry)
{
    mh_line_place(fields, &entry->place);
    mh_line_u32(fields, &entry->time);
}
