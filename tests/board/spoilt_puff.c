/* The model of puffs with one coefficient that is not as it should be. Linked before the library, it stands for flash that has changed. */
#include "motehound/real.h"

#undef MH_PI
#define MH_PI MH_REAL(3.15f)

#include "../../firmware/src/model/puff.c"
