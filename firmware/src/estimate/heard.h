/* What all localisers by sound ask of what was heard. */
#ifndef MOTEHOUND_HEARD_H
#define MOTEHOUND_HEARD_H

#include "motehound/sound_fix.h"

/* Errors: MH_ERR_NOT_FINITE, MH_ERR_RANGE. */
enum mh_status mh_heard_check(const struct mh_heard *heard, size_t count);

#endif
