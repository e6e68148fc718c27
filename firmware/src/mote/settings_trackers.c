/* Trackers of both arithmetics. */
#include "motehound/centroid.h"
#include "motehound/luo.h"
#include "motehound/pftl.h"
#include "motehound/settings.h"

void mh_settings_luo(struct mh_line_fields *fields, void *config)
{
    struct mh_luo_config *luo = config;
    mh_line_real(fields, &luo->diffusion_m2ps);
    mh_line_real(fields, &luo->chi);
    mh_line_real(fields, &luo->forgetting);
    mh_line_real(fields, &luo->filter.process_variance);
    mh_line_real(fields, &luo->filter.measurement_variance);
    mh_line_real(fields, &luo->filter.estimate_variance);
    mh_line_real(fields, &luo->filter.process_floor);
    mh_line_real(fields, &luo->filter.measurement_floor);
    mh_line_bool(fields, &luo->nonlinear);
    mh_line_bool(fields, &luo->stop_outside);
    mh_line_region(fields, &luo->region);
    mh_line_i32(fields, &luo->inside_mm);
}

void mh_settings_pftl(struct mh_line_fields *fields, void *config)
{
    struct mh_pftl_config *pftl = config;
    mh_line_real(fields, &pftl->speed_mps);
    mh_line_real(fields, &pftl->speed_sd_mps);
    mh_line_real(fields, &pftl->sensing_range_m);
    mh_line_real(fields, &pftl->range_sd_m);
    mh_line_real(fields, &pftl->tolerance_m);
    mh_line_u16(fields, &pftl->particles);
    mh_line_u32(fields, &pftl->seed);
    mh_line_bool(fields, &pftl->literal);
    mh_line_bool(fields, &pftl->systematic);
}

void mh_settings_centroid(struct mh_line_fields *fields, void *config)
{
    struct mh_centroid_config *centroid = config;
    mh_line_real(fields, &centroid->sensing_range_m);
    mh_line_u8(fields, &centroid->strongest);
}
