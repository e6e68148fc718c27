#include "motehound/source_count.h"
#include "motehound/random.h"
#include "port.h"
#include "unity.h"

#include <math.h>

void setUp(void) {}
void tearDown(void) {}

#define LOUDNESS 1600.0f
#define SIDE 8
#define SPACING 17.0f

static struct mh_heard_sound nodes[SIDE * SIDE];
