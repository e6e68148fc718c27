#include "radio/reception.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LISTED_MAX = 1000 /* receivers of a mote that are kept; more are looked up each time */ };

struct radio_receivers {
    uint32_t count;
    uint32_t mote[];
};

/* Who receives `sender` when nothing disturbs: into radio->found, in the order of the places, which is
 * that in which the motes' memory lies. Returns their number. */
static uint32_t look_up_receivers(const struct radio *radio, uint32_t sender)
{
    const size_t near = places_within(&radio->places, sender, radio->reach_m, radio->found);
    const struct place *place = places_at(&radio->places, sender);
    uint32_t count = 0;
    for (size_t i = 0; i < near; i++) {
        const uint32_t index = radio->found[i];
        if (propagation_power(&radio->propagation, place, places_at(&radio->places, index)) >= radio->sensitivity) {
            radio->found[count++] = index;
        }
    }
    return count;
}

const uint32_t *reception_receivers(struct radio *radio, uint32_t sender, uint32_t *count)
{
    struct radio_receivers *list = radio->receivers[sender];
    if (list) {
        *count = list->count;
        return list->mote;
    }
    *count = look_up_receivers(radio, sender);
    if (*count <= LISTED_MAX && (list = malloc(sizeof *list + *count * sizeof *list->mote)) != NULL) {
        list->count = *count;
        memcpy(list->mote, radio->found, *count * sizeof *list->mote);
        radio->receivers[sender] = list;
        return list->mote;
    }
    return radio->found;
}

static double power_between(const struct radio *radio, uint32_t a, uint32_t b)
{
    return propagation_power(&radio->propagation, places_at(&radio->places, a), places_at(&radio->places, b));
}

bool reception_in_reach(const struct radio *radio, uint32_t sender, uint32_t receiver)
{
    return receiver != sender && power_between(radio, sender, receiver) >= radio->sensitivity;
}

double reception_power(struct radio *radio, uint32_t mote, sim_time from, sim_time now)
{
    uint32_t found[MEETINGS_MAX];
    const struct place *place = places_at(&radio->places, mote);
    size_t count = air_find(&radio->air, place, from, now, found, MEETINGS_MAX);
    count = count < MEETINGS_MAX ? count : MEETINGS_MAX;
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        const struct flight *flight = &radio->air.flights[found[i]];
        if (flight->sender == mote) {
            return HUGE_VAL;
        }
        const sim_time start = flight->start > from ? flight->start : from;
        const sim_time end = flight->end < now ? flight->end : now;
        sum += power_between(radio, flight->sender, mote) * (double)(end - start);
    }
    return sum / (double)(now - from);
}

void reception_meetings(struct radio *radio, const struct flight *flight, uint32_t itself, sim_time now,
                        struct meetings *meetings)
{
    uint32_t found[MEETINGS_MAX];
    const sim_time from = flight->start > radio->turnaround ? flight->start - radio->turnaround : 0;
    const struct place *place = places_at(&radio->places, flight->sender);
    size_t count = air_find(&radio->air, place, from, now, found, MEETINGS_MAX);
    count = count < MEETINGS_MAX ? count : MEETINGS_MAX;
    meetings->count = 0;
    for (size_t i = 0; i < count; i++) {
        if (found[i] != itself) {
            meetings->flight[meetings->count++] = radio->air.flights[found[i]];
        }
    }
}

/* Interference is largest when some disturbing transmission has just begun. */
static bool drowns(const struct radio *radio, const struct flight *flight, uint32_t receiver,
                   const struct meetings *meetings)
{
    double power[MEETINGS_MAX];
    double sum = 0;
    for (size_t i = 0; i < meetings->count; i++) {
        const struct flight *other = &meetings->flight[i];
        power[i] = other->end > flight->start ? power_between(radio, other->sender, receiver) : 0;
        power[i] = power[i] < radio->disturbance ? 0 : power[i];
        sum += power[i];
    }
    if (!(sum > 0)) {
        return false;
    }
    const double bearable = power_between(radio, flight->sender, receiver) / radio->capture - radio->noise;
    for (size_t i = 0; i < meetings->count && sum > bearable; i++) {
        const sim_time start = meetings->flight[i].start;
        const sim_time instant = start > flight->start ? start : flight->start;
        double interference = 0;
        for (size_t j = 0; j < meetings->count; j++) {
            const struct flight *other = &meetings->flight[j];
            interference += other->start <= instant && instant < other->end ? power[j] : 0;
        }
        if (interference > bearable) {
            return true;
        }
    }
    return false;
}

/* The receiver has been sending, is about to, or has not turned round in time. */
static bool was_deaf(const struct radio *radio, uint32_t receiver, const struct meetings *meetings)
{
    if (radio->motes[receiver].mac == MAC_TURNING) {
        return true;
    }
    for (size_t i = 0; i < meetings->count; i++) {
        if (meetings->flight[i].sender == receiver) {
            return true;
        }
    }
    return false;
}

/* A receiver in range was not open all the time, or something has disturbed it. What does it make of a transmission? LOSS_NONE:
 * it has it. */
static enum loss_reason look_closer(const struct radio *radio, const struct flight *flight, uint32_t receiver,
                                    const struct meetings *meetings)
{
    const struct radio_mote *mote = &radio->motes[receiver];
    if (mote->power == RADIO_POWER_OFF || flight->cut) {
        return LOSS_DEAD;
    }
    const bool awake = radio_mote_listens(mote) && mote->awake <= flight->start;
    const bool woken = mote->powered <= flight->start && radio_wakes(radio, flight->start);
    if (!awake && !woken) {
        return LOSS_ASLEEP;
    }
    if (meetings && was_deaf(radio, receiver, meetings)) {
        return LOSS_DEAF;
    }
    return meetings && drowns(radio, flight, receiver, meetings) ? LOSS_COLLISION : LOSS_NONE;
}

enum loss_reason reception_judge(struct radio *radio, const struct flight *flight, uint32_t receiver,
                                 const struct meetings *meetings, sim_time now)
{
    const bool undisturbed =
        radio->open[receiver] <= flight->start && !flight->cut && (!meetings || meetings->count == 0);
    const enum loss_reason reason = undisturbed ? LOSS_NONE : look_closer(radio, flight, receiver, meetings);
    if (reason != LOSS_NONE || channel_is_quiet(&radio->channel)) {
        return reason;
    }
    const struct passage passage = {flight->number, flight->start, now, places_at(&radio->places, flight->sender),
                                    places_at(&radio->places, receiver)};
    return channel_verdict(&radio->channel, &passage);
}
