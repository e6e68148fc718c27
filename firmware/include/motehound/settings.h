/* Configuration structures as fields of a message on the line (line.h), so that whoever is at its other end can configure any image: CONFIGURE
 * says which part, then come these fields. Each function says for both directions what a structure holds, in the order of its members; pointers are left as they are.
 *
 * A list that a structure points to is sent entry by entry, its length left out: who reads counts the entries.
 *
 * Nothing is checked but that values fit their variables: mh_mote_init does that. An image holds the functions that it names. */
#ifndef MOTEHOUND_SETTINGS_H
#define MOTEHOUND_SETTINGS_H

#include "motehound/line.h"

/* Identifier and place, of struct mh_mote_config. */
void mh_settings_mote(struct mh_line_fields *fields, struct mh_mote_config *config);
void mh_settings_sensor(struct mh_line_fields *fields, struct mh_sensor_config *config);
void mh_settings_head(struct mh_line_fields *fields, struct mh_head_config *config);
void mh_settings_clock(struct mh_line_fields *fields, struct mh_clock_config *config);

/* Of protocols and trackers: `config` is the structure of that name. */
typedef void mh_settings(struct mh_line_fields *fields, void *config);

mh_settings mh_settings_direct, mh_settings_collection, mh_settings_cluster, mh_settings_token;
mh_settings mh_settings_prince, mh_settings_fixed; /* without entries; without clusters */
mh_settings mh_settings_luo, mh_settings_pftl, mh_settings_centroid, mh_settings_range, mh_settings_diffusion,
    mh_settings_gas;
mh_settings mh_settings_acoustic;      /* and of dm and ml */
mh_settings mh_settings_cv;            /* of cv_ukf and cv_ekf, without noise */
mh_settings mh_settings_fusion_centre; /* of the centre `fusion` */

struct mh_cv_noise;

/* Entries: of mh_prince_config.entries, mh_fixed_config.clusters (cluster by cluster), mh_cv_config.noise. */
void mh_settings_prince_entry(struct mh_line_fields *fields, struct mh_prince_entry *entry);
void mh_settings_fixed_member(struct mh_line_fields *fields, uint8_t *cluster, struct mh_fixed_member *member);
void mh_settings_cv_noise(struct mh_line_fields *fields, struct mh_cv_noise *noise);

#endif
