/* The messages between a run and its workers: lcm_types/motehound_worker.lcm. Here they are sent, received and checked, and motes, events
 * and actions turned into them and back; when which is sent is the business of worker_pool.c and worker.c. */
#ifndef MOTEHOUND_SIM_WORKER_WIRE_H
#define MOTEHOUND_SIM_WORKER_WIRE_H

#include "bus/layout.h"
#include "engine/random.h"
#include "hosts/boards.h"

#include "motehound_worker_assign_t.h"
#include "motehound_worker_call_t.h"
#include "motehound_worker_count_t.h"
#include "motehound_worker_done_t.h"
#include "motehound_worker_error_t.h"
#include "motehound_worker_join_t.h"
#include "motehound_worker_motes_t.h"
#include "motehound_worker_release_t.h"
#include "motehound_worker_totals_t.h"
#include "motehound_worker_window_t.h"

#include <lcm/lcm.h>
#include <stdlib.h>

#define WORKER_CALL "MOTEHOUND_WORKER_CALL"
#define WORKER_JOIN "MOTEHOUND_WORKER_JOIN"
#define WORKER_DONE "MOTEHOUND_WORKER_DONE"
#define WORKER_TOTALS "MOTEHOUND_WORKER_TOTALS"
#define WORKER_ERROR "MOTEHOUND_WORKER_ERROR"
#define WORKER_RELEASE "MOTEHOUND_WORKER_RELEASE"

enum worker_request { WORKER_ASSIGN, WORKER_MOTES, WORKER_WINDOW, WORKER_COUNT, WORKER_REQUESTS };

/* The shortest silence after which a run takes a worker that it did not start itself, and a worker a run, for dead. */
#define WORKER_PATIENCE_S 30.0

enum { WORKER_CHANNEL_MAX = 64, WORKER_NAME_MAX = 100 };

/* An LCM on the bus, and how it went. */
struct worker_link {
    lcm_t *lcm;
    double drop_share; /* of what is published is dropped on purpose */
    struct random_stream drops;
    uint64_t published, received, not_understood;
};

/* Returns 0, or -1 with one line in `error` that names `url`. */
int worker_link_open(struct worker_link *link, const char *url, double drop_share, char *error, size_t error_size);

void worker_link_close(struct worker_link *link);

/* What UDP may lose it may as well lose here: there is no error. */
void worker_link_publish(struct worker_link *link, const char *channel, const void *bytes, size_t size);

/* Handle what has come; if there is nothing, wait for up to `wait_s`, at first awake, since a sleeper takes long to wake, then asleep. Wakes
 * up too when `lifeline` (a descriptor, -1 for none) has something to say. */
void worker_link_handle(struct worker_link *link, double wait_s, int lifeline);

/* Seconds from some time on. */
double worker_now_s(void);

/* A random number above 0. */
int64_t worker_random(void);

/* The channel on which `worker` hears requests of a kind; all of them for WORKER_REQUESTS. Returns `channel`. */
const char *worker_channel(int64_t worker, enum worker_request request, char channel[WORKER_CHANNEL_MAX]);

/* worker_encode_NAME: message motehound_worker_NAME_t into new memory, to be freed; NULL if there is none.
 * worker_decode_NAME: the opposite, after checking the bytes. False, and counted, if they are no such message; after true,
 * motehound_worker_NAME_t_decode_cleanup is to be called. */
#define WORKER_CODEC(name, layout)                                                                                     \
    static inline uint8_t *worker_encode_##name(const motehound_worker_##name##_t *message, size_t *size)              \
    {                                                                                                                  \
        const int room = motehound_worker_##name##_t_encoded_size(message);                                            \
        uint8_t *bytes = malloc((size_t)room);                                                                         \
        *size = (size_t)room;                                                                                          \
        if (bytes && motehound_worker_##name##_t_encode(bytes, 0, room, message) != room) {                            \
            free(bytes);                                                                                               \
            return NULL;                                                                                               \
        }                                                                                                              \
        return bytes;                                                                                                  \
    }                                                                                                                  \
    static inline bool worker_decode_##name(struct worker_link *link, const lcm_recv_buf_t *buffer,                    \
                                            motehound_worker_##name##_t *message)                                      \
    {                                                                                                                  \
        const bool sound = layout_fits(layout, buffer->data, buffer->data_size) &&                                     \
                           motehound_worker_##name##_t_decode(buffer->data, 0, (int)buffer->data_size, message) >= 0;  \
        link->not_understood += !sound;                                                                                \
        return sound;                                                                                                  \
    }

WORKER_CODEC(call, "84ss")
WORKER_CODEC(join, "88sss")
WORKER_CODEC(assign, "888s8444444444")
WORKER_CODEC(motes, "888[4444418888s]")
WORKER_CODEC(window, "8888[8141[4]{1}]")
WORKER_CODEC(count, "888")
WORKER_CODEC(done, "8888[814418{1}{444"
                   "88888888888888888888888"
                   "488888884444}421]")
WORKER_CODEC(totals, "8888[8][8][8][4ss188888844444[4]8]")
WORKER_CODEC(error, "88s")
WORKER_CODEC(release, "8")

/* One mote, but for what the scenario says of all of them. */
motehound_worker_mote_t worker_mote_message(uint32_t mote, const struct host_mote *what);

/* An event with the receivers, if it is a frame, or else the mote in event->mote. It points into `event`. */
motehound_worker_event_t worker_event_message(const struct host_event *event);

/* The opposite. The message has one mote; frames have any number, which become the receivers. It points into `message`. Returns 0, or
 * -1 if a value is outside its range. */
int worker_event_read(const motehound_worker_event_t *message, struct host_event *event);

/* An action. `estimate` is where the message of a report points to; it points into `action`, too. */
motehound_worker_action_t worker_action_message(const struct host_action *action,
                                                motehound_worker_estimate_t *estimate);

/* How a board did. It points into `result`. */
motehound_worker_board_t worker_board_message(const struct board_result *result);

/* The opposite. */
struct board_result worker_board_read(const motehound_worker_board_t *message);

/* The opposite. Returns 0, or -1 if a value is outside its range. */
int worker_action_read(const motehound_worker_action_t *message, struct host_action *action);

#endif
