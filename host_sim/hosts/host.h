/* Where motes run. The simulator knows them by index and through this table alone, so that they may as well live in another
 * process or in an emulator. Every call returns when the mote has done all it does at that time. */
#ifndef MOTEHOUND_SIM_HOST_H
#define MOTEHOUND_SIM_HOST_H

#include "motehound/mote.h"

#include <stddef.h>

/* What motes ask of the simulator: struct mh_port, and who asks. */
struct host_port {
    void (*transmit)(void *context, uint32_t mote, mh_node_id destination, const uint8_t *frame, size_t length);
    void (*set_alarm)(void *context, uint32_t mote, mh_tick time);
    void (*report)(void *context, uint32_t mote, const struct mh_estimate *estimate);
};

/* What one mote is. All that the pointers point to outlives the host; state memory is the host's. */
struct host_mote {
    mh_node_id id;
    struct mh_place place;
    const struct mh_sensor_config *sensor; /* NULL: none */
    const struct mh_head_config *head;     /* NULL: does not compute; tracker_state is ignored */
    const struct mh_protocol *protocol;
    const void *protocol_config;
};

struct host {
    void *state;
    /* The four events of a mote, as in mote.h. */
    enum mh_status (*init)(void *state, uint32_t mote, const struct host_mote *what, mh_tick now);
    enum mh_status (*reading)(void *state, uint32_t mote, mh_tick now, const struct mh_reading *reading);
    enum mh_status (*frame)(void *state, uint32_t mote, mh_tick now, const uint8_t *frame, size_t length);
    void (*alarm)(void *state, uint32_t mote, mh_tick now);
    /* Add all motes' counters to what is there. */
    void (*count)(const void *state, struct mh_mote_counters *motes, struct mh_head_counters *heads);
    void (*destroy)(void *state);
};

/* Motes of this process: the firmware library's own, `count` of them in one block of memory, each beside its protocol's
 * state. Mote i lies at place order[i] of the block, a permutation of 0 ... count - 1: where motes that hear each other
 * lie side by side, a broadcast finds them in few pages of memory. `order`, `port` and `context` outlive the host.
 * Returns 0, or -1 if there is no memory. */
int host_in_process(struct host *host, uint32_t count, const uint32_t *order, const struct mh_protocol *protocol,
                    const struct host_port *port, void *context);

#endif
