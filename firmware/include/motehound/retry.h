/* When to send again what the radio could not deliver. */
#ifndef MOTEHOUND_RETRY_H
#define MOTEHOUND_RETRY_H

#include "motehound/measurement.h"
#include "motehound/spread.h"

#define MH_RETRY_PATIENCE 10000 /* ticks: a radio silent so long about a frame has forgotten it, which counts as busy */

/* The wait after so many attempts, >= 1: it doubles from one to the next, six times at most, beginning with `first`, 1 to 1,000 ticks. Of each,
 * half is the same for all, half depends on who waits and on its count of retries. */
static inline mh_tick mh_retry_wait(mh_tick first, uint8_t attempts, mh_node_id node, uint16_t retries)
{
    const mh_tick longest = first << (attempts < 7 ? attempts - 1 : 6);
    return longest - mh_spread(node, retries, longest / 2 + 1);
}

#endif
