#include "motehound/acoustic.h"
#include "motehound/settings.h"

void mh_settings_acoustic(struct mh_line_fields *fields, void *config)
{
    struct mh_acoustic_config *acoustic = config;
    mh_line_real(fields, &acoustic->sound.loudness_m2);
    mh_line_real(fields, &acoustic->sound.source_sd);
    mh_line_real(fields, &acoustic->sound.background_sd);
    mh_line_real(fields, &acoustic->sensing_range_m);
    mh_line_real(fields, &acoustic->reach_m);
    MH_LINE_ENUM(fields, acoustic->variant);
    mh_line_u8(fields, &acoustic->intervals);
    MH_LINE_ENUM(fields, acoustic->distances);
    mh_line_u8(fields, &acoustic->strongest);
    MH_LINE_ENUM(fields, acoustic->separation);
    mh_line_real(fields, &acoustic->share_range_m);
    mh_line_bool(fields, &acoustic->filtered);
    mh_line_bool(fields, &acoustic->mirror_check);
    mh_line_real(fields, &acoustic->acceleration_psd);
    mh_line_real(fields, &acoustic->speed_mps);
    mh_line_real(fields, &acoustic->fix_sd_m);
    mh_line_real(fields, &acoustic->coast_s);
    MH_LINE_ENUM(fields, acoustic->group.mode);
    mh_line_real(fields, &acoustic->group.merge_m);
    mh_line_real(fields, &acoustic->group.split_m);
    mh_line_u8(fields, &acoustic->group.merge_epochs);
    mh_line_u8(fields, &acoustic->group.split_epochs);
    mh_line_real(fields, &acoustic->group.member_sd_m);
    mh_line_real(fields, &acoustic->group.fix_sd_m);
    mh_line_real(fields, &acoustic->group.extent_memory);
    mh_line_real(fields, &acoustic->group.turn_sd_mps);
    mh_line_real(fields, &acoustic->group.odds);
}
