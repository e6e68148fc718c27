/* The mote: a state machine without I/O that joins a sensor, a protocol and, on a cluster head, a tracker.
 *
 * Its owner feeds it four events, a reading, a frame, the fate of a frame sent and an alarm, each with the time; it answers through struct
 * mh_port. It reads no clock, owns no thread, allocates nothing and touches no global, so the same compiled code runs on a board, in
 * a test and as one of many thousands inside the simulator. Not re-entrant for one mote; different motes are independent.
 *
 * Its owner and it speak of the mote's own time, as its clock shows it. With a `clock` in its configuration the mote keeps the network's
 * time besides, and all that is compared between motes is in it: samples and measurements, requests, the head's instants, estimates. Waits
 * and timers, the protocol's too, stay in the mote's own time, which no correction disturbs. When the network time becomes known or
 * jumps, the sensor's history and the head begin anew; a mote that does not know it yet refuses readings, closes no instant,
 * but relays. Such a mote listens all the time, whatever its protocol needs.
 *
 * Where the protocol lets motes take turns (protocol.h), a mote with a head's configuration is a plain node until the protocol has it lead. */
#ifndef MOTEHOUND_MOTE_H
#define MOTEHOUND_MOTE_H

#include "motehound/centre.h"
#include "motehound/clock.h"
#include "motehound/fixed.h"
#include "motehound/head.h"
#include "motehound/prince.h"
#include "motehound/protocol.h"
#include "motehound/sensor.h"

/* What the mote asks of its owner. None of these may call back into the mote. */
struct mh_port {
    /* Put a frame on the air, for one neighbour or for all (MH_BROADCAST), and tell its fate with mh_mote_sent. A neighbour
     * acknowledges what is sent to it alone: that is the radio's business, as is trying again a few times. `frame` is valid during the call only. */
    void (*transmit)(void *context, mh_node_id destination, const uint8_t *frame, size_t length);
    /* Call mh_mote_alarm at `time` (at once if that is past); replaces the alarm set before. */
    void (*set_alarm)(void *context, mh_tick time);
    /* The head has an estimate; or a mote that does not compute has been told of one. Valid during the call only. NULL on a mote that neither can. */
    void (*report)(void *context, const struct mh_estimate *estimate);
    /* The radio may sleep (true) or must listen (false, and so from the start); called on changes, which come from the
     * protocol. Transmitting and the sensor are not concerned. NULL if the owner does not care. */
    void (*sleep)(void *context, bool may_sleep);
    /* Let the sensor take a sample now, and hand it over with mh_mote_reading; without one, if it senses nothing. NULL on a mote whose
     * sensor samples by itself. */
    void (*sense)(void *context);
};

struct mh_mote_config {
    mh_node_id id; /* below MH_BROADCAST, unique in the network */
    struct mh_place place;
    const struct mh_sensor_config *sensor; /* NULL on a mote without a sensor */
    const struct mh_head_config *head;     /* NULL on a mote that never computes */
    const struct mh_protocol *protocol;
    const void *protocol_config;
    void *protocol_state;                   /* protocol->state_size bytes */
    struct mh_head *head_state;             /* with head */
    const struct mh_clock_functions *clock; /* &mh_clock_flooding; NULL: the mote's own time is the network's */
    const struct mh_clock_config *clock_config;
    struct mh_clock *clock_state;   /* with clock */
    const struct mh_centre *centre; /* &mh_centre_fusion, on the mote that joins the heads' tracks */
    const void *centre_config;
    void *centre_state; /* centre->state_size bytes, with centre */
};

/* What the protocol `fixed` asks of a mote. */
extern const struct mh_fixed_port mh_mote_fixed;
/* ... and `prince`, of a mote with a head's configuration. */
extern const struct mh_prince_port mh_mote_prince;

struct mh_mote_counters {
    uint32_t frames_sent;
    uint32_t frames_received; /* sound ones */
    uint32_t frames_corrupt;
    uint32_t frames_unknown;
    uint32_t readings;         /* taken */
    uint32_t readings_refused; /* out of range, out of time */
    uint32_t readings_repeated;
    uint32_t readings_unsynchronised; /* refused because the network's time was not known yet */
    uint32_t reports;                 /* measurements handed to the protocol ... */
    uint32_t reports_asked;           /* ... of these, only because a head asked */
    uint32_t reports_no_route;        /* ... of these, lost for want of a next hop, or of room in its queue */
};

/* Memory of a sensor node: sizeof(struct mh_mote) + protocol->state_size, at most 256 bytes on an ATmega128 with the protocol
 * `collection`; with a clock sizeof(struct mh_clock) more. */
struct mh_mote {
    const struct mh_mote_config *config;
    const struct mh_port *port;
    void *port_context;
    bool tracking : 1;           /* the network follows a track */
    bool asked : 1;              /* the sample of asked_time is to be reported, whatever it is */
    bool report_waits : 1;       /* the sample of report_instant is to be reported at report_time */
    bool protocol_alarm_set : 1; /* the protocol's timer() is due at protocol_alarm */
    bool alarm_set : 1;          /* `alarm` is what the port was last told: the earliest of all that is due */
    bool may_sleep : 1;          /* as last told to the port */
    bool leads : 1;              /* this mote is a head, now */
    mh_tick asked_time;
    mh_tick report_instant;
    mh_tick report_time;
    mh_tick protocol_alarm;
    mh_tick alarm;
    struct mh_mote_counters counters;
    struct mh_protocol_node node;
    struct mh_sensor sensor;
};

/* Come up. `config`, all it points to, and `port` outlive the mote. Sets the first alarm; may transmit. After an error the mote
 * must not be used. Errors: MH_ERR_ARGUMENT, or what the parts' own init functions return. */
enum mh_status mh_mote_init(struct mh_mote *mote, const struct mh_mote_config *config, const struct mh_port *port,
                            void *port_context, mh_tick now);

/* The sensor has sampled, at reading->time, at or before `now`. Reports the sample if it is worth it or asked for; after a wait,
 * if the sensor's configuration spreads reports, and only if it still is then.
 * Errors: those of mh_sensor_take, MH_ERR_TIME also for a reading from the future or before the network's time is known (each counted; the mote goes on),
 * MH_ERR_ARGUMENT (no sensor). */
enum mh_status mh_mote_reading(struct mh_mote *mote, mh_tick now, const struct mh_reading *reading);

/* A frame came in that was sent to this mote or to all: addressing is the radio's business.
 * Errors: those of mh_wire_decode (each counted; the mote goes on). */
enum mh_status mh_mote_frame(struct mh_mote *mote, mh_tick now, const uint8_t *frame, size_t length);

/* What became of the oldest frame transmitted of which this has not been told, at the time its last bit or its acknowledgement went
 * over the air. Of frames from before mh_mote_init nothing may be told. A call too many is taken for the next frame's. */
void mh_mote_sent(struct mh_mote *mote, mh_tick now, enum mh_sent outcome);

/* The time asked for with set_alarm has come. Early and repeated calls do no harm. A late call is made up for: each call
 * closes one sampling instant and sets the alarm anew. */
void mh_mote_alarm(struct mh_mote *mote, mh_tick now);

#endif
