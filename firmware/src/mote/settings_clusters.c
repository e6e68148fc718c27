/* Fixed clusters: their protocol, trackers and fusion centre. */
#include "motehound/cv.h"
#include "motehound/fixed.h"
#include "motehound/fusion_centre.h"
#include "motehound/settings.h"

void mh_settings_fixed(struct mh_line_fields *fields, void *config)
{
    struct mh_fixed_config *fixed = config;
    mh_line_u8(fields, &fixed->link.attempts);
    mh_line_u32(fields, &fixed->link.backoff);
    mh_line_u32(fields, &fixed->sink);
    mh_line_place(fields, &fixed->sink_place);
    mh_line_u32(fields, &fixed->report_interval);
    mh_line_u32(fields, &fixed->fuse_interval);
    mh_line_u32(fields, &fixed->wait);
    mh_line_u8(fields, &fixed->patience);
    mh_line_bool(fields, &fixed->acknowledges);
    mh_line_u32(fields, &fixed->hello_period);
}

void mh_settings_fixed_member(struct mh_line_fields *fields, uint8_t *cluster, struct mh_fixed_member *member)
{
    mh_line_u8(fields, cluster);
    mh_line_u32(fields, &member->id);
    mh_line_place(fields, &member->place);
}

static void motion(struct mh_line_fields *fields, struct mh_white_acceleration *config)
{
    mh_line_u32(fields, &config->tick);
    mh_line_vec2(fields, &config->variance);
}

static void reals(struct mh_line_fields *fields, mh_real *list, uint8_t count)
{
    for (uint8_t i = 0; i < count; i++) {
        mh_line_real(fields, &list[i]);
    }
}

void mh_settings_cv(struct mh_line_fields *fields, void *config)
{
    struct mh_cv_config *cv = config;
    mh_line_place(fields, &cv->origin);
    mh_line_u32(fields, &cv->start);
    reals(fields, cv->mean, MH_CV_STATES);
    reals(fields, cv->covariance, MH_PACKED_SIZE(MH_CV_STATES));
    motion(fields, &cv->motion);
    mh_line_real(fields, &cv->variance);
    mh_line_u32(fields, &cv->lag);
    mh_line_real(fields, &cv->alpha);
    mh_line_real(fields, &cv->beta);
    mh_line_real(fields, &cv->kappa);
    MH_LINE_ENUM(fields, cv->summary);
}

void mh_settings_cv_noise(struct mh_line_fields *fields, struct mh_cv_noise *noise)
{
    mh_line_u32(fields, &noise->node);
    mh_line_real(fields, &noise->variance);
}

void mh_settings_fusion_centre(struct mh_line_fields *fields, void *config)
{
    struct mh_fusion_centre_config *centre = config;
    MH_LINE_ENUM(fields, centre->rule);
    mh_line_u8(fields, &centre->clusters);
    mh_line_place(fields, &centre->origin);
    motion(fields, &centre->motion);
    mh_line_u32(fields, &centre->keep);
    mh_line_u8(fields, &centre->start.n);
    reals(fields, centre->start.x, MH_SUMMARY_STATES);
    reals(fields, centre->start.P, MH_PACKED_SIZE(MH_SUMMARY_STATES));
    mh_line_u32(fields, &centre->start_time);
}
