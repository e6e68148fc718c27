#include "motehound/settings.h"

#include "motehound/cluster.h"
#include "motehound/collection.h"
#include "motehound/direct.h"

void mh_settings_mote(struct mh_line_fields *fields, struct mh_mote_config *config)
{
    mh_line_u32(fields, &config->id);
    mh_line_place(fields, &config->place);
}

void mh_settings_sensor(struct mh_line_fields *fields, struct mh_sensor_config *config)
{
    mh_line_i32(fields, &config->zero_counts);
    mh_line_i32(fields, &config->q20_per_count);
    mh_line_i32(fields, &config->counts_min);
    mh_line_i32(fields, &config->counts_max);
    mh_line_u32(fields, &config->interval);
    mh_line_i32(fields, &config->threshold);
    mh_line_bool(fields, &config->report_always);
    mh_line_u32(fields, &config->report_spread);
}

void mh_settings_head(struct mh_line_fields *fields, struct mh_head_config *config)
{
    mh_line_u32(fields, &config->epoch);
    mh_line_u32(fields, &config->interval);
    mh_line_u32(fields, &config->window);
    mh_line_u32(fields, &config->tolerance);
    mh_line_bool(fields, &config->own_first);
    mh_line_u32(fields, &config->lateness);
}

void mh_settings_clock(struct mh_line_fields *fields, struct mh_clock_config *config)
{
    mh_line_bool(fields, &config->root);
    mh_line_u32(fields, &config->period);
    mh_line_u32(fields, &config->wait);
    mh_line_u8(fields, &config->sent_q8);
}

void mh_settings_direct(struct mh_line_fields *fields, void *config)
{
    struct mh_direct_config *direct = config;
    mh_line_u32(fields, &direct->beacon_period);
    mh_line_bool(fields, &direct->sleeps);
}

void mh_settings_collection(struct mh_line_fields *fields, void *config)
{
    struct mh_collection_config *collection = config;
    mh_line_u32(fields, &collection->beacon_period);
    mh_line_u32(fields, &collection->beacon_wait);
    mh_line_u32(fields, &collection->request_wait);
    mh_line_u8(fields, &collection->suppress_after);
    mh_line_u32(fields, &collection->range_mm);
    mh_line_u8(fields, &collection->attempts);
    mh_line_u32(fields, &collection->backoff);
}

static void link(struct mh_line_fields *fields, struct mh_link_config *config)
{
    mh_line_u8(fields, &config->attempts);
    mh_line_u32(fields, &config->backoff);
}

static void election(struct mh_line_fields *fields, struct mh_election_config *config)
{
    MH_LINE_ENUM(fields, config->rule);
    mh_line_u8(fields, &config->members);
    mh_line_u8(fields, &config->horizon);
    mh_line_u8(fields, &config->least_answers);
    mh_line_real(fields, &config->sensing_range_m);
    mh_line_real(fields, &config->radio_range_m);
    mh_line_u32(fields, &config->interval);
}

void mh_settings_cluster(struct mh_line_fields *fields, void *config)
{
    struct mh_cluster_config *cluster = config;
    election(fields, &cluster->election);
    link(fields, &cluster->link);
    mh_line_u32(fields, &cluster->sink);
    mh_line_place(fields, &cluster->sink_place);
    mh_line_u32(fields, &cluster->wake_period);
    mh_line_u32(fields, &cluster->wake_length);
    mh_line_u32(fields, &cluster->window);
    mh_line_u32(fields, &cluster->watch_period);
    mh_line_u32(fields, &cluster->hello_period);
    mh_line_bool(fields, &cluster->faces);
}
