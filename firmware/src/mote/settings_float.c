/* Protocols and trackers that need MH_REAL=float. */
#include "motehound/diffusion.h"
#include "motehound/gas.h"
#include "motehound/range.h"
#include "motehound/settings.h"
#include "motehound/token.h"

void mh_settings_range(struct mh_line_fields *fields, void *config)
{
    struct mh_range_config *range = config;
    mh_line_real(fields, &range->range_sd_m);
    mh_line_real(fields, &range->bias_sd_m);
    mh_line_real(fields, &range->scale_sd);
    mh_line_real(fields, &range->sensing_range_m);
    mh_line_real(fields, &range->acceleration_sd_mps2);
    mh_line_real(fields, &range->speed_mps);
    mh_line_real(fields, &range->height_m);
    mh_line_real(fields, &range->tolerance_m);
}

void mh_settings_diffusion(struct mh_line_fields *fields, void *config)
{
    struct mh_diffusion_config *diffusion = config;
    mh_line_real(fields, &diffusion->diffusion_m2ps);
    mh_line_real(fields, &diffusion->chi);
    mh_line_real(fields, &diffusion->release_gps);
    mh_line_real(fields, &diffusion->release_drift);
    mh_line_real(fields, &diffusion->additive_sd);
    mh_line_real(fields, &diffusion->relative_sd);
    mh_line_real(fields, &diffusion->turn_mps2);
    mh_line_real(fields, &diffusion->speed_mps);
    mh_line_real(fields, &diffusion->reach_m);
    mh_line_region(fields, &diffusion->region);
}

void mh_settings_gas(struct mh_line_fields *fields, void *config)
{
    struct mh_gas_config *gas = config;
    mh_line_real(fields, &gas->plume.diffusion_m2ps);
    mh_line_real(fields, &gas->plume.wind_mps);
    mh_line_vec2(fields, &gas->plume.downwind);
    mh_line_real(fields, &gas->noise);
    mh_line_real(fields, &gas->unit);
    mh_line_region(fields, &gas->area);
    mh_line_place(fields, &gas->prior);
    mh_line_vec2(fields, &gas->prior_sd_m);
    mh_line_real(fields, &gas->prior_rate);
    mh_line_real(fields, &gas->prior_rate_sd);
    mh_line_real(fields, &gas->calm_step_m);
    mh_line_real(fields, &gas->calm_sd_m);
    mh_line_real(fields, &gas->ukf.alpha);
    mh_line_real(fields, &gas->ukf.beta);
    mh_line_real(fields, &gas->ukf.kappa);
}

void mh_settings_token(struct mh_line_fields *fields, void *config)
{
    struct mh_token_config *token = config;
    mh_line_u8(fields, &token->link.attempts);
    mh_line_u32(fields, &token->link.backoff);
    mh_line_u32(fields, &token->sink);
    mh_line_place(fields, &token->sink_place);
    mh_line_u32(fields, &token->start);
    mh_line_place(fields, &token->start_place);
    mh_line_u32(fields, &token->range_mm);
    mh_line_u32(fields, &token->interval);
    mh_line_u32(fields, &token->window);
    mh_line_u32(fields, &token->hello_period);
    mh_line_u8(fields, &token->calm);
    mh_line_u8(fields, &token->heads_max);
    mh_line_u8(fields, &token->patience);
    mh_line_bool(fields, &token->faces);
}
