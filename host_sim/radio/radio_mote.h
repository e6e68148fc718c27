/* One radio of many, as the parts of the radio know it: radio.c moves it, reception.c asks it whether it could hear. */
#ifndef MOTEHOUND_SIM_RADIO_MOTE_H
#define MOTEHOUND_SIM_RADIO_MOTE_H

#include "radio/radio.h"

enum mac_state { MAC_IDLE, MAC_BACKOFF, MAC_TURNING, MAC_SENDING, MAC_WAITING };
enum ack_state { ACK_NONE, ACK_TURNING, ACK_SENDING };

struct radio_mote {
    sim_time due;         /* of the event that the MAC waits for: others are out of date */
    sim_time awake;       /* listens since, if it does */
    sim_time powered;     /* since when it has not been off */
    sim_time attends;     /* though it may sleep it stays open until then; 0: it does not */
    uint32_t first, last; /* of its queue; NONE, NONE: empty */
    struct csma csma;
    uint32_t flight; /* being sent, frame or acknowledgement */
    uint32_t ack_to;
    uint16_t queued;
    uint16_t signals; /* that arrive above the sensitivity, if states are shown ... */
    uint16_t caught;  /* ... of these, begun in a wake window */
    uint8_t power, mac, ack, mac_cause, ack_cause, signal_cause, attends_cause;
    uint8_t shown, shown_cause; /* as last told */
};

/* Without regard to a wake window that opens by itself. */
static inline bool radio_mote_listens(const struct radio_mote *mote)
{
    return mote->power == RADIO_POWER_ON ||
           (mote->power == RADIO_POWER_ASLEEP && (mote->mac || mote->ack || mote->attends));
}

/* A radio that sleeps is open. */
static inline bool radio_wakes(const struct radio *radio, sim_time time)
{
    const struct radio_config *config = &radio->config;
    return config->wake_period > 0 && time % config->wake_period < config->wake_length;
}

#endif
