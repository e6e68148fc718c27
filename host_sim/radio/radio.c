#include "radio/radio.h"

#include "radio/reception.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NONE UINT32_MAX

/* What is weaker than the noise by this much is not felt: it would add 0.4 dB to it. */
static const double disturbance_db = -10;

/* What happens: four bits of kind, 28 of index. */
enum {
    EVENT_FRAME,     /* a frame comes to its radio */
    EVENT_TAKE_OFF,  /* ideal: a mote begins to send */
    EVENT_LANDING,   /* ideal: a frame is there */
    EVENT_ASSESSED,  /* a mote has assessed the channel */
    EVENT_START,     /* a mote begins to send */
    EVENT_END,       /* a flight ends */
    EVENT_NO_ACK,    /* a mote has waited long enough */
    EVENT_ACK_START, /* a mote begins to acknowledge */
    EVENT_DOZE,      /* a mote has been open long enough for what could be repeated */
    EVENT_POWER_ON,  /* three of radio_power, in its order */
    EVENT_POWER_ASLEEP,
    EVENT_POWER_OFF
};

#define EVENT(kind, index) ((uint32_t)(kind) << 28 | (uint32_t)(index))

struct radio_frame {
    uint32_t sender, destination;
    uint32_t next; /* in its sender's queue, or among the free ones */
    uint8_t cause;
    uint8_t length;
    bool refused; /* the radio was full */
    bool taken;   /* by its one addressee, who has perhaps not been able to say so */
    uint8_t bytes[MH_FRAME_MAX];
};

/* ---- making ---- */

/* In a disc every signal has power 1: noise there is none, of two that overlap neither is received, and the channel is busy if there
 * is a signal at any time of its assessment. */
static void set_powers(struct radio *radio)
{
    const struct radio_profile *profile = &radio->config.profile;
    radio->capture = mw_from_dbm(profile->capture_db);
    if (radio->config.propagation.kind == PROPAGATION_DISC) {
        radio->sensitivity = radio->disturbance = 1;
        radio->noise = 0;
        radio->cca_threshold = 1e-9;
        return;
    }
    radio->sensitivity = mw_from_dbm(profile->sensitivity_dbm);
    radio->noise = mw_from_dbm(profile->sensitivity_dbm - profile->noise_margin_db);
    radio->cca_threshold = mw_from_dbm(profile->sensitivity_dbm + profile->cca_threshold_db);
    radio->disturbance = radio->noise * mw_from_dbm(disturbance_db);
}

static sim_time rounded(double microseconds) { return (sim_time)llround(microseconds); }

int radio_make(struct radio *radio, const struct radio_config *config, const double *x_m, const double *y_m,
               size_t count, uint64_t seed)
{
    *radio = (struct radio){.config = *config,
                            .propagation = propagation_make(&config->propagation, count, seed),
                            .turnaround = rounded(config->profile.turnaround_us),
                            .backoff_stream = random_stream(seed, RANDOM_RADIO_BACKOFF),
                            .free_frame = NONE};
    set_powers(radio);
    radio->reach_m = propagation_reach_m(&radio->propagation, radio->sensitivity);
    if (places_make(&radio->places, x_m, y_m, count, radio->reach_m)) {
        return -1;
    }
    const double disturbs_m = propagation_reach_m(&radio->propagation, radio->disturbance);
    const sim_time longest = radio_profile_air_us(&config->profile, config->profile.preamble_bytes +
                                                                        config->profile.header_bytes + MH_FRAME_MAX);
    radio->motes = calloc(count, sizeof *radio->motes);
    radio->open = calloc(count, sizeof *radio->open);
    radio->receivers = calloc(count, sizeof *radio->receivers);
    radio->found = malloc(count * sizeof *radio->found);
    if (!radio->motes || !radio->open || !radio->receivers || !radio->found ||
        channel_make(&radio->channel, &config->channel, count, seed) ||
        air_make(&radio->air, &radio->places, radio->reach_m + disturbs_m, longest + radio->turnaround)) {
        radio_free(radio);
        return -1;
    }
    for (size_t i = 0; i < count; i++) {
        radio->motes[i].first = radio->motes[i].last = radio->motes[i].flight = NONE;
        radio->motes[i].shown = RADIO_LISTEN;
    }
    return 0;
}

void radio_free(struct radio *radio)
{
    for (size_t i = 0; radio->receivers && i < radio->places.count; i++) {
        free(radio->receivers[i]);
    }
    free(radio->receivers);
    free(radio->motes);
    free(radio->open);
    free(radio->frames);
    free(radio->found);
    channel_free(&radio->channel);
    places_free(&radio->places);
    air_free(&radio->air);
    event_queue_free(&radio->events);
    *radio = (struct radio){0};
}

static void push(struct radio *radio, sim_time time, uint32_t event)
{
    if (event_queue_push(&radio->events, time, event)) {
        radio->out_of_memory = true;
    }
}

/* ---- frames ---- */

static int grow_frames(struct radio *radio)
{
    const uint32_t capacity = radio->frames_capacity ? 2 * radio->frames_capacity : 64;
    struct radio_frame *frames = realloc(radio->frames, capacity * sizeof *frames);
    if (!frames) {
        return -1;
    }
    radio->frames = frames;
    for (uint32_t i = capacity; i-- > radio->frames_capacity;) {
        frames[i].next = radio->free_frame;
        radio->free_frame = i;
    }
    radio->frames_capacity = capacity;
    return 0;
}

static void free_frame(struct radio *radio, uint32_t frame)
{
    radio->frames[frame].next = radio->free_frame;
    radio->free_frame = frame;
}

int radio_send(struct radio *radio, sim_time time, uint32_t sender, uint32_t destination, const uint8_t *bytes,
               size_t length, uint8_t cause)
{
    if (radio->free_frame == NONE && grow_frames(radio)) {
        return -1;
    }
    const uint32_t index = radio->free_frame;
    struct radio_frame *frame = &radio->frames[index];
    radio->free_frame = frame->next;
    *frame = (struct radio_frame){
        .sender = sender, .destination = destination, .next = NONE, .cause = cause, .length = (uint8_t)length};
    memcpy(frame->bytes, bytes, length);
    return event_queue_push(&radio->events, time, EVENT(EVENT_FRAME, index));
}

int radio_power(struct radio *radio, sim_time time, uint32_t mote, enum radio_power power)
{
    return event_queue_push(&radio->events, time, EVENT(EVENT_POWER_ON + (uint32_t)power, mote));
}

sim_time radio_next(const struct radio *radio) { return event_queue_next(&radio->events); }

const uint32_t *radio_order(const struct radio *radio) { return radio->places.position; }

/* One radio_run: what its steps need. */
struct run {
    struct radio *radio;
    const struct radio_sink *sink;
    sim_time now;
};

/* ---- states ---- */

/* A radio that waits to send, or for an answer, listens for its frame's cause. */
static void show(const struct run *run, uint32_t index)
{
    struct radio_mote *mote = &run->radio->motes[index];
    if (!run->sink->state) {
        return;
    }
    const enum radio_state state = mote->power == RADIO_POWER_OFF                         ? RADIO_OFF
                                   : mote->mac == MAC_SENDING || mote->ack == ACK_SENDING ? RADIO_TRANSMIT
                                   : !radio_mote_listens(mote) && mote->caught == 0       ? RADIO_SLEEP
                                   : mote->signals > 0                                    ? RADIO_RECEIVE
                                                                                          : RADIO_LISTEN;
    const bool attends = mote->attends && mote->power == RADIO_POWER_ASLEEP;
    const uint8_t own = mote->ack ? mote->ack_cause : mote->mac ? mote->mac_cause : attends ? mote->attends_cause : 0;
    const uint8_t cause = state == RADIO_RECEIVE ? mote->signal_cause : own;
    if (state != mote->shown || (cause != mote->shown_cause && state != RADIO_RECEIVE)) {
        mote->shown = (uint8_t)state;
        mote->shown_cause = cause;
        run->sink->state(run->sink->context, run->now, index, state, cause);
    }
}

static void open_or_close(const struct run *run, uint32_t index)
{
    const struct radio_mote *mote = &run->radio->motes[index];
    sim_time *open = &run->radio->open[index];
    if (!radio_mote_listens(mote) || mote->mac == MAC_TURNING || mote->mac == MAC_SENDING || mote->ack == ACK_SENDING) {
        *open = SIM_TIME_NEVER;
    } else if (*open == SIM_TIME_NEVER) {
        *open = run->now + run->radio->turnaround;
    }
}

static void enter(const struct run *run, uint32_t index, enum mac_state state, uint8_t cause)
{
    struct radio_mote *mote = &run->radio->motes[index];
    if (!radio_mote_listens(mote)) {
        mote->awake = run->now;
    }
    mote->mac = (uint8_t)state;
    mote->mac_cause = cause;
    open_or_close(run, index);
    show(run, index);
}

static void enter_ack(const struct run *run, uint32_t index, enum ack_state state)
{
    struct radio_mote *mote = &run->radio->motes[index];
    if (!radio_mote_listens(mote)) {
        mote->awake = run->now;
    }
    mote->ack = (uint8_t)state;
    open_or_close(run, index);
    show(run, index);
}

/* A frame to a mote that may sleep has ended. If it has it not, or its acknowledgement is lost, it will be repeated. */
static void attend(const struct run *run, uint32_t index, uint8_t cause)
{
    struct radio *radio = run->radio;
    struct radio_mote *mote = &radio->motes[index];
    if (radio->config.wake_length == 0 || mote->power != RADIO_POWER_ASLEEP) {
        return;
    }
    if (!radio_mote_listens(mote)) {
        mote->awake = run->now;
    }
    mote->attends = run->now + radio->config.wake_length;
    mote->attends_cause = cause;
    push(radio, mote->attends, EVENT(EVENT_DOZE, index));
    open_or_close(run, index);
    show(run, index);
}

static void doze(const struct run *run, uint32_t index)
{
    struct radio_mote *mote = &run->radio->motes[index];
    if (mote->attends == run->now) {
        mote->attends = 0;
        open_or_close(run, index);
        show(run, index);
    }
}

/* ---- those in reach ---- */

/* All that may hear a transmission, which started at `start`, begin or cease to receive it. */
static void show_signal(const struct run *run, uint32_t sender, sim_time start, uint8_t cause, int change)
{
    const int caught = radio_wakes(run->radio, start) ? change : 0;
    if (!run->sink->state) {
        return;
    }
    uint32_t count;
    const uint32_t *receivers = reception_receivers(run->radio, sender, &count);
    for (uint32_t i = 0; i < count; i++) {
        struct radio_mote *mote = &run->radio->motes[receivers[i]];
        mote->signals = (uint16_t)(mote->signals + change);
        mote->caught = (uint16_t)(mote->caught + caught);
        mote->signal_cause = change > 0 ? cause : mote->signal_cause;
        show(run, receivers[i]);
    }
}

/* The end of a frame: who has received it, now for the first time, is told. Returns whether the addressee has. */
static bool deliver(const struct run *run, const struct flight *flight, const struct meetings *meetings)
{
    struct radio *radio = run->radio;
    const struct radio_frame frame = radio->frames[flight->frame]; /* the sink may send, which may move the frames */
    uint32_t count = 1;
    const uint32_t *receivers = &flight->destination;
    if (flight->destination == RADIO_ALL) {
        receivers = reception_receivers(radio, flight->sender, &count);
    } else if (!reception_in_reach(radio, flight->sender, flight->destination)) {
        radio->counters.lost[LOSS_RANGE]++;
        return false;
    }
    uint32_t received = 0;
    for (uint32_t i = 0; i < count; i++) {
        const enum loss_reason reason = reception_judge(radio, flight, receivers[i], meetings, run->now);
        if (reason == LOSS_NONE) {
            radio->found[received++] = receivers[i];
        } else {
            radio->counters.lost[reason]++;
        }
        if (meetings && flight->destination != RADIO_ALL &&
            (reason == LOSS_NONE || reason == LOSS_RANDOM || reason == LOSS_COLLISION)) {
            attend(run, receivers[i], flight->cause);
        }
    }
    if (received > 0 && frame.taken) {
        radio->counters.frames_duplicate++;
        return true;
    }
    radio->frames[flight->frame].taken |= received > 0 && flight->destination != RADIO_ALL;
    radio->counters.frames_received += received;
    if (received > 0 && run->sink->heard) {
        run->sink->heard(run->sink->context, run->now, frame.bytes, frame.length, radio->found, received);
    }
    return received > 0;
}

/* ---- one mote's way to the air ---- */

static void count_lost(const struct run *run, enum loss_reason reason) { run->radio->counters.lost[reason]++; }

static void tell_sent(const struct run *run, uint32_t sender, enum mh_sent outcome)
{
    if (run->sink->sent) {
        run->sink->sent(run->sink->context, run->now, sender, outcome);
    }
}

static void pop(struct radio *radio, struct radio_mote *mote)
{
    const uint32_t frame = mote->first;
    mote->first = radio->frames[frame].next;
    mote->last = mote->first == NONE ? NONE : mote->last;
    mote->queued -= !radio->frames[frame].refused;
    free_frame(radio, frame);
}

static void back_off(const struct run *run, uint32_t index)
{
    struct radio *radio = run->radio;
    struct radio_mote *mote = &radio->motes[index];
    mote->due = run->now + csma_wait(&mote->csma, &radio->config.profile, radio->backoff_stream, index);
    push(radio, mote->due, EVENT(EVENT_ASSESSED, index));
    enter(run, index, MAC_BACKOFF, radio->frames[mote->first].cause);
}

/* Take up the next frame, if there is one; those that were refused get their answer in their turn. */
static void next_frame(const struct run *run, uint32_t index)
{
    struct radio *radio = run->radio;
    struct radio_mote *mote = &radio->motes[index];
    while (mote->first != NONE && radio->frames[mote->first].refused) {
        pop(radio, mote);
        tell_sent(run, index, MH_SENT_BUSY);
    }
    if (mote->first == NONE) {
        enter(run, index, MAC_IDLE, 0);
        return;
    }
    csma_begin(&mote->csma);
    back_off(run, index);
}

static void finish(const struct run *run, uint32_t index, enum mh_sent outcome)
{
    struct radio_mote *mote = &run->radio->motes[index];
    pop(run->radio, mote);
    tell_sent(run, index, outcome);
    next_frame(run, index);
}

static void busy(const struct run *run, uint32_t index)
{
    if (csma_was_busy(&run->radio->motes[index].csma, &run->radio->config.profile)) {
        back_off(run, index);
    } else {
        count_lost(run, LOSS_BUSY);
        finish(run, index, MH_SENT_BUSY);
    }
}

/* False: the event is out of date. */
static bool waits(const struct run *run, uint32_t index, enum mac_state state)
{
    const struct radio_mote *mote = &run->radio->motes[index];
    return mote->mac == state && mote->due == run->now;
}

static void assessed(const struct run *run, uint32_t index)
{
    struct radio *radio = run->radio;
    struct radio_mote *mote = &radio->motes[index];
    const struct radio_profile *profile = &radio->config.profile;
    if (!waits(run, index, MAC_BACKOFF)) {
        return;
    }
    if (mote->ack != ACK_NONE ||
        reception_power(radio, index, run->now - rounded(profile->cca_us), run->now) >= radio->cca_threshold) {
        busy(run, index);
        return;
    }
    mote->due = run->now + radio->turnaround;
    push(radio, mote->due, EVENT(EVENT_START, index));
    enter(run, index, MAC_TURNING, radio->frames[mote->first].cause);
}

static void launch(const struct run *run, uint32_t sender, uint32_t destination, uint32_t frame, size_t bytes,
                   uint8_t cause)
{
    struct radio *radio = run->radio;
    const struct flight flight = {.start = run->now,
                                  .end = run->now + radio_profile_air_us(&radio->config.profile, bytes),
                                  .number = radio->transmissions++,
                                  .sender = sender,
                                  .destination = destination,
                                  .frame = frame,
                                  .cause = cause};
    uint32_t index;
    if (air_put(&radio->air, &flight, &index)) {
        radio->out_of_memory = true;
        return;
    }
    radio->motes[sender].flight = index;
    push(radio, flight.end, EVENT(EVENT_END, index));
    show_signal(run, sender, run->now, cause, 1);
}

static void announce(const struct run *run, const struct radio_frame *frame)
{
    run->radio->counters.frames_sent++;
    if (run->sink->on_air) {
        const struct radio_frame copy = *frame;
        run->sink->on_air(run->sink->context, run->now, copy.sender, copy.destination, copy.bytes, copy.length);
    }
}

static size_t bytes_on_air(const struct radio *radio, const struct radio_frame *frame)
{
    return radio->config.profile.preamble_bytes + radio->config.profile.header_bytes + frame->length;
}

static void start(const struct run *run, uint32_t index)
{
    struct radio *radio = run->radio;
    struct radio_mote *mote = &radio->motes[index];
    if (!waits(run, index, MAC_TURNING)) {
        return;
    }
    if (mote->ack != ACK_NONE) {
        busy(run, index);
        return;
    }
    const struct radio_frame *frame = &radio->frames[mote->first];
    radio->counters.frames_repeated += mote->csma.tries > 0;
    enter(run, index, MAC_SENDING, frame->cause);
    launch(run, index, frame->destination, mote->first, bytes_on_air(radio, frame), frame->cause);
    announce(run, frame);
}

static void frame_ends(const struct run *run, const struct flight *flight, const struct meetings *meetings)
{
    struct radio *radio = run->radio;
    const struct radio_profile *profile = &radio->config.profile;
    const bool received = deliver(run, flight, meetings);
    struct radio_mote *sender = &radio->motes[flight->sender];
    if (received && flight->destination != RADIO_ALL) {
        struct radio_mote *receiver = &radio->motes[flight->destination];
        receiver->ack_to = flight->sender;
        receiver->ack_cause = flight->cause;
        enter_ack(run, flight->destination, ACK_TURNING);
        push(radio, run->now + rounded(profile->ack_turnaround_us), EVENT(EVENT_ACK_START, flight->destination));
    }
    if (flight->cut) {
        free_frame(radio, flight->frame);
    } else if (flight->destination == RADIO_ALL) {
        finish(run, flight->sender, MH_SENT_OK);
    } else {
        sender->due = run->now + rounded(profile->ack_wait_us);
        push(radio, sender->due, EVENT(EVENT_NO_ACK, flight->sender));
        enter(run, flight->sender, MAC_WAITING, flight->cause);
    }
}

static void ack_starts(const struct run *run, uint32_t index)
{
    struct radio_mote *mote = &run->radio->motes[index];
    if (mote->ack != ACK_TURNING) {
        return;
    }
    enter_ack(run, index, ACK_SENDING);
    run->radio->counters.acks_sent++;
    launch(run, index, mote->ack_to, AIR_NO_FRAME, run->radio->config.profile.ack_bytes, mote->ack_cause);
}

static void ack_ends(const struct run *run, const struct flight *flight, const struct meetings *meetings)
{
    struct radio *radio = run->radio;
    if (!flight->cut) {
        enter_ack(run, flight->sender, ACK_NONE);
    }
    const struct radio_mote *waiting = &radio->motes[flight->destination];
    const bool expected = waiting->mac == MAC_WAITING && radio->frames[waiting->first].destination == flight->sender;
    if (expected && reception_judge(radio, flight, flight->destination, meetings, run->now) == LOSS_NONE) {
        finish(run, flight->destination, MH_SENT_OK);
    } else {
        radio->counters.acks_lost++;
    }
}

static void flight_ends(const struct run *run, uint32_t index)
{
    struct radio *radio = run->radio;
    const struct flight flight = radio->air.flights[index];
    struct meetings meetings;
    reception_meetings(radio, &flight, index, run->now, &meetings);
    show_signal(run, flight.sender, flight.start, flight.cause, -1);
    if (!flight.cut) {
        radio->motes[flight.sender].flight = NONE;
    }
    if (flight.frame == AIR_NO_FRAME) {
        ack_ends(run, &flight, &meetings);
    } else {
        frame_ends(run, &flight, &meetings);
    }
}

static void no_ack(const struct run *run, uint32_t index)
{
    if (!waits(run, index, MAC_WAITING)) {
        return;
    }
    if (csma_not_acknowledged(&run->radio->motes[index].csma, &run->radio->config.profile)) {
        back_off(run, index);
    } else {
        count_lost(run, LOSS_NO_ACK);
        finish(run, index, MH_SENT_NO_ACK);
    }
}

/* ---- without contention ---- */

static sim_time air_time(const struct radio *radio, const struct radio_frame *frame)
{
    return radio_profile_air_us(&radio->config.profile, bytes_on_air(radio, frame));
}

/* A radio sends one frame at a time; `due` is when it has sent all that it was given so far. */
static void line_up(const struct run *run, uint32_t index)
{
    const struct radio_frame *frame = &run->radio->frames[index];
    struct radio_mote *sender = &run->radio->motes[frame->sender];
    const sim_time begin = sender->due > run->now ? sender->due : run->now;
    sender->due = begin + air_time(run->radio, frame);
    push(run->radio, begin, EVENT(EVENT_TAKE_OFF, index));
}

static void take_off(const struct run *run, uint32_t index)
{
    struct radio *radio = run->radio;
    const struct radio_frame *frame = &radio->frames[index];
    if (radio->motes[frame->sender].power == RADIO_POWER_OFF) {
        free_frame(radio, index);
        return;
    }
    push(radio, run->now + air_time(radio, frame), EVENT(EVENT_LANDING, index));
    enter(run, frame->sender, MAC_SENDING, frame->cause);
    show_signal(run, frame->sender, run->now, frame->cause, 1);
    announce(run, frame);
}

static void land(const struct run *run, uint32_t index)
{
    struct radio *radio = run->radio;
    const struct radio_frame *frame = &radio->frames[index];
    const struct flight flight = {.start = run->now -
                                           radio_profile_air_us(&radio->config.profile, bytes_on_air(radio, frame)),
                                  .end = run->now,
                                  .number = radio->transmissions++,
                                  .sender = frame->sender,
                                  .destination = frame->destination,
                                  .frame = index,
                                  .cause = frame->cause,
                                  .cut = radio->motes[frame->sender].power == RADIO_POWER_OFF};
    const bool received = deliver(run, &flight, NULL);
    free_frame(radio, index);
    show_signal(run, flight.sender, flight.start, flight.cause, -1);
    if (!flight.cut) {
        enter(run, flight.sender, MAC_IDLE, 0);
        if (flight.destination != RADIO_ALL && !received) {
            count_lost(run, LOSS_NO_ACK);
        }
        tell_sent(run, flight.sender, flight.destination == RADIO_ALL || received ? MH_SENT_OK : MH_SENT_NO_ACK);
    }
}

/* ---- a radio gets a frame, or is switched ---- */

static void frame_comes(const struct run *run, uint32_t index)
{
    struct radio *radio = run->radio;
    struct radio_frame *frame = &radio->frames[index];
    struct radio_mote *mote = &radio->motes[frame->sender];
    if (mote->power == RADIO_POWER_OFF) {
        free_frame(radio, index);
        return;
    }
    if (!radio->config.profile.contention) {
        line_up(run, index);
        return;
    }
    frame->refused = mote->queued >= radio->config.queue;
    mote->queued += !frame->refused;
    radio->counters.lost[LOSS_QUEUE] += frame->refused;
    if (mote->last == NONE) {
        mote->first = index;
    } else {
        radio->frames[mote->last].next = index;
    }
    mote->last = index;
    if (mote->mac == MAC_IDLE) {
        next_frame(run, frame->sender);
    }
}

/* A frame that is in the air goes on as a wreck: it disturbs, but nobody receives it. */
static void drop_all(struct radio *radio, struct radio_mote *mote)
{
    if (mote->flight != NONE) {
        struct flight *flight = &radio->air.flights[mote->flight];
        flight->cut = true;
        mote->flight = NONE;
        if (flight->frame != AIR_NO_FRAME) {
            mote->first = radio->frames[mote->first].next; /* freed where it ends */
        }
    }
    while (mote->first != NONE) {
        pop(radio, mote);
    }
    mote->last = NONE;
    mote->queued = 0;
    mote->mac = MAC_IDLE;
    mote->ack = ACK_NONE;
    mote->attends = 0;
}

static void switch_power(const struct run *run, uint32_t index, enum radio_power power)
{
    struct radio_mote *mote = &run->radio->motes[index];
    const bool listened = radio_mote_listens(mote);
    if (power == RADIO_POWER_OFF) {
        drop_all(run->radio, mote);
    }
    if (mote->power == RADIO_POWER_OFF) {
        mote->powered = run->now;
    }
    mote->power = (uint8_t)power;
    if (!listened && radio_mote_listens(mote)) {
        mote->awake = run->now;
    }
    open_or_close(run, index);
    show(run, index);
}

static void happen(const struct run *run, uint32_t content)
{
    const uint32_t index = content & ((UINT32_C(1) << 28) - 1);
    switch (content >> 28) {
    case EVENT_FRAME:
        frame_comes(run, index);
        break;
    case EVENT_TAKE_OFF:
        take_off(run, index);
        break;
    case EVENT_LANDING:
        land(run, index);
        break;
    case EVENT_ASSESSED:
        assessed(run, index);
        break;
    case EVENT_START:
        start(run, index);
        break;
    case EVENT_END:
        flight_ends(run, index);
        break;
    case EVENT_NO_ACK:
        no_ack(run, index);
        break;
    case EVENT_ACK_START:
        ack_starts(run, index);
        break;
    case EVENT_DOZE:
        doze(run, index);
        break;
    default:
        switch_power(run, index, (enum radio_power)((content >> 28) - EVENT_POWER_ON));
    }
}

int radio_run(struct radio *radio, sim_time until, const struct radio_sink *sink)
{
    struct event event;
    struct run run = {.radio = radio, .sink = sink, .now = radio->now};
    while (!radio->out_of_memory && event_queue_next(&radio->events) < until &&
           event_queue_pop(&radio->events, &event)) {
        run.now = event.time > run.now ? event.time : run.now;
        happen(&run, event.content);
    }
    radio->now = run.now;
    return radio->out_of_memory ? -1 : 0;
}
