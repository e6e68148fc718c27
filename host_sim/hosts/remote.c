#include "hosts/remote.h"

#include "engine/arena.h"
#include "motehound/token.h"
#include "scenario/text.h"
#include "trackers.h"

#include <string.h>

/* The most motes that one request speaks of, in all its events: so many readings are 13 KB, and what so many motes answer fits
 * the buffers of a socket. */
enum { MOTES_PER_REQUEST = 500 };

/* What one worker has to hear of in a window. */
struct share {
    sim_time next; /* its motes' earliest alarm */
    motehound_worker_event_t *events;
    size_t count, capacity, sent;
    motehound_worker_mote_t *motes; /* all of its motes, for as long as they have not been assigned */
    size_t mote_count;
};

struct remote {
    struct worker_pool *pool;
    const char *scenario;
    uint64_t seed;
    struct host_mote sink;
    uint32_t count;
    unsigned workers;
    uint32_t *worker_of;            /* each mote */
    motehound_worker_mote_t *motes; /* by place in the order */
    const uint32_t *order;
    struct share *shares;
    struct arena arena; /* receivers, by worker */
    bool assigned;
    /* while waiting for answers */
    struct host_actions *actions;
    struct host_totals *totals;
};

/* ---- answers ---- */

static int on_done(void *context, unsigned worker, const motehound_worker_done_t *message, char *error,
                   size_t error_size)
{
    struct remote *remote = context;
    remote->shares[worker].next = message->next_us < 0 ? SIM_TIME_NEVER : (sim_time)message->next_us;
    for (int32_t i = 0; i < message->count; i++) {
        struct host_action *action = host_actions_add(remote->actions);
        if (!action) {
            return fail(error, error_size, "out of memory");
        }
        if (worker_action_read(&message->actions[i], action) != 0 || action->mote >= remote->count) {
            return fail(error, error_size, "a worker answers with an action that no mote can do");
        }
    }
    return 0;
}

static int add_counters(void *to, size_t size, const int64_t *from, int32_t count, char *error, size_t error_size)
{
    uint32_t counters[64] = {0};
    if ((size_t)count * sizeof counters[0] != size || size > sizeof counters) {
        return fail(error, error_size, "a worker counts %ld things, expected %zu", (long)count,
                    size / sizeof counters[0]);
    }
    memcpy(counters, to, size);
    for (int32_t i = 0; i < count; i++) {
        counters[i] += (uint32_t)from[i];
    }
    memcpy(to, counters, size);
    return 0;
}

static int on_totals(void *context, unsigned worker, const motehound_worker_totals_t *message, char *error,
                     size_t error_size)
{
    const struct remote *remote = context;
    struct host_totals *totals = remote->totals;
    (void)worker;
    totals->events += (uint64_t)message->events;
    for (int32_t i = 0; totals->boards && i < message->board_count; i++) {
        const struct board_result result = worker_board_read(&message->boards[i]);
        board_results_add(totals->boards, &result);
    }
    return add_counters(&totals->motes, sizeof totals->motes, message->motes, message->mote_counters, error,
                        error_size) != 0 ||
                   add_counters(&totals->heads, sizeof totals->heads, message->heads, message->head_counters, error,
                                error_size) != 0 ||
                   add_counters(&totals->protocols, sizeof totals->protocols, message->protocols,
                                message->protocol_counters, error, error_size) != 0
               ? -1
               : 0;
}

static int await(struct remote *remote, char *error, size_t error_size)
{
    const struct worker_answers answers = {remote, on_done, on_totals};
    return worker_pool_await(remote->pool, &answers, error, error_size);
}

/* ---- requests ---- */

#define REQUEST(remote, share, kind, name, message, error, error_size)                                                 \
    do {                                                                                                               \
        size_t size;                                                                                                   \
        worker_pool_address((remote)->pool, share, &(message).session, &(message).worker, &(message).number);          \
        uint8_t *bytes = worker_encode_##name(&(message), &size);                                                      \
        if (worker_pool_request((remote)->pool, share, kind, bytes, size, error, error_size) != 0) {                   \
            return -1;                                                                                                 \
        }                                                                                                              \
    } while (0)

/* Every worker's next message of motes. *more: there are others to come. */
static int assign_some(struct remote *remote, bool *more, char *error, size_t error_size)
{
    *more = false;
    for (unsigned w = 0; w < remote->workers; w++) {
        struct share *share = &remote->shares[w];
        const size_t left = share->mote_count - share->sent;
        const size_t count = left < MOTES_PER_REQUEST ? left : MOTES_PER_REQUEST;
        if (count > 0) {
            motehound_worker_motes_t message = {.count = (int32_t)count, .motes = share->motes + share->sent};
            REQUEST(remote, w, WORKER_MOTES, motes, message, error, error_size);
            share->sent += count;
        }
        *more = *more || share->sent < share->mote_count;
    }
    return await(remote, error, error_size);
}

static int assign(struct remote *remote, char *error, size_t error_size)
{
    const struct mh_token_config *token = remote->sink.protocol_config, none = {.start = 0};
    const struct mh_token_config *search = protocol_is(remote->sink.protocol, "token") ? token : &none;
    for (unsigned w = 0; w < remote->workers; w++) {
        motehound_worker_assign_t message = {.scenario = (char *)remote->scenario,
                                             .seed = (int64_t)remote->seed,
                                             .count = (int32_t)remote->shares[w].mote_count,
                                             .sink = (int32_t)remote->sink.id,
                                             .sink_x_mm = remote->sink.place.x_mm,
                                             .sink_y_mm = remote->sink.place.y_mm,
                                             .sink_z_mm = remote->sink.place.z_mm,
                                             .start = (int32_t)search->start,
                                             .start_x_mm = search->start_place.x_mm,
                                             .start_y_mm = search->start_place.y_mm,
                                             .start_z_mm = search->start_place.z_mm};
        REQUEST(remote, w, WORKER_ASSIGN, assign, message, error, error_size);
    }
    if (await(remote, error, error_size) != 0) {
        return -1;
    }
    for (bool more = true; more;) {
        if (assign_some(remote, &more, error, error_size) != 0) {
            return -1;
        }
    }
    remote->assigned = true;
    return 0;
}

static int give(struct share *share, const motehound_worker_event_t *event)
{
    if (share->count == share->capacity) {
        const size_t capacity = share->capacity ? 2 * share->capacity : 64;
        motehound_worker_event_t *events = realloc(share->events, capacity * sizeof *events);
        if (!events) {
            return -1;
        }
        share->events = events;
        share->capacity = capacity;
    }
    share->events[share->count++] = *event;
    return 0;
}

/* A frame goes to each worker with those of its receivers that live there, in as many events as keep every request small. */
static int give_frame(struct remote *remote, const struct host_event *event)
{
    const uint32_t *receivers = event->as.frame.receivers;
    const uint32_t count = event->as.frame.count;
    motehound_worker_event_t message = worker_event_message(event);
    for (unsigned w = 0; w < remote->workers; w++) {
        uint32_t mine = 0;
        for (uint32_t i = 0; i < count; i++) {
            mine += remote->worker_of[receivers[i]] == w;
        }
        int32_t *motes = mine > 0 ? arena_take(&remote->arena, mine * sizeof *motes) : NULL;
        if (mine > 0 && !motes) {
            return -1;
        }
        uint32_t taken = 0;
        for (uint32_t i = 0; i < count && taken < mine; i++) {
            if (remote->worker_of[receivers[i]] == w) {
                motes[taken++] = (int32_t)receivers[i];
            }
        }
        for (uint32_t from = 0; from < mine; from += MOTES_PER_REQUEST) {
            message.motes = motes + from;
            message.count = (int32_t)(mine - from < MOTES_PER_REQUEST ? mine - from : MOTES_PER_REQUEST);
            if (give(&remote->shares[w], &message) != 0) {
                return -1;
            }
        }
    }
    return 0;
}

static int share_out(struct remote *remote, const struct host_event *events, size_t count)
{
    arena_reset(&remote->arena);
    for (unsigned w = 0; w < remote->workers; w++) {
        remote->shares[w].count = remote->shares[w].sent = 0;
    }
    for (size_t i = 0; i < count; i++) {
        int status;
        if (events[i].kind == HOST_FRAME) {
            status = give_frame(remote, &events[i]);
        } else {
            const motehound_worker_event_t message = worker_event_message(&events[i]);
            status = give(&remote->shares[remote->worker_of[events[i].mote]], &message);
        }
        if (status != 0) {
            return -1;
        }
    }
    return 0;
}

/* So many of the share's next events go into one request. */
static size_t fitting(const struct share *share)
{
    size_t motes = 0, at = share->sent;
    while (at < share->count && (motes += (size_t)share->events[at].count) <= MOTES_PER_REQUEST) {
        at++;
    }
    return at - share->sent;
}

/* Each worker's next part of the window. A part that is not the last runs until its last event: the events of the next, which are not earlier,
 * then come before the alarms of that time, as they shall. *more: there are parts to come. */
static int run_part(struct remote *remote, sim_time until, bool first, bool *more, char *error, size_t error_size)
{
    bool asked = false;
    *more = false;
    for (unsigned w = 0; w < remote->workers; w++) {
        struct share *share = &remote->shares[w];
        const size_t count = fitting(share);
        if (count == 0 && !(first && share->next < until)) {
            continue;
        }
        const bool last = share->sent + count == share->count;
        motehound_worker_window_t message = {.count = (int32_t)count, .events = share->events + share->sent};
        message.until_us = last ? (int64_t)until : message.events[count - 1].time_us;
        REQUEST(remote, w, WORKER_WINDOW, window, message, error, error_size);
        share->sent += count;
        asked = true;
        *more = *more || !last;
    }
    return asked ? await(remote, error, error_size) : 0;
}

/* ---- the table ---- */

static int add(void *state, uint32_t mote, const struct host_mote *what)
{
    struct remote *remote = state;
    remote->motes[remote->order[mote]] = worker_mote_message(mote, what);
    if (!what->sensor) {
        remote->sink = *what;
    }
    return 0;
}

static sim_time next(const void *state)
{
    const struct remote *remote = state;
    sim_time earliest = SIM_TIME_NEVER;
    for (unsigned w = 0; w < remote->workers; w++) {
        earliest = remote->shares[w].next < earliest ? remote->shares[w].next : earliest;
    }
    return earliest;
}

static int run(void *state, sim_time until, const struct host_event *events, size_t count, struct host_actions *actions,
               char *error, size_t error_size)
{
    struct remote *remote = state;
    remote->actions = actions;
    if (!remote->assigned && assign(remote, error, error_size) != 0) {
        return -1;
    }
    const double began_s = worker_now_s();
    if (share_out(remote, events, count) != 0) {
        return fail(error, error_size, "out of memory");
    }
    bool more = true;
    for (bool first = true; more; first = false) {
        if (run_part(remote, until, first, &more, error, error_size) != 0) {
            return -1;
        }
    }
    worker_pool_note_window(remote->pool, worker_now_s() - began_s);
    return 0;
}

static int count_all(void *state, struct host_totals *totals, char *error, size_t error_size)
{
    struct remote *remote = state;
    remote->totals = totals;
    for (unsigned w = 0; w < remote->workers && remote->assigned; w++) {
        motehound_worker_count_t message;
        REQUEST(remote, w, WORKER_COUNT, count, message, error, error_size);
    }
    return remote->assigned ? await(remote, error, error_size) : 0;
}

static void destroy(void *state)
{
    struct remote *remote = state;
    for (unsigned w = 0; w < remote->workers && remote->shares; w++) {
        free(remote->shares[w].events);
    }
    arena_free(&remote->arena);
    free(remote->shares);
    free(remote->worker_of);
    free(remote->motes);
    free(remote);
}

int host_remote(struct host *host, uint32_t count, const uint32_t *order, const char *scenario, uint64_t seed,
                struct worker_pool *pool)
{
    struct remote *remote = calloc(1, sizeof *remote);
    if (!remote) {
        return -1;
    }
    remote->pool = pool;
    remote->scenario = scenario;
    remote->seed = seed;
    remote->count = count;
    remote->order = order;
    remote->workers = worker_pool_count(pool);
    remote->worker_of = malloc(count * sizeof *remote->worker_of);
    remote->motes = calloc(count, sizeof *remote->motes);
    remote->shares = calloc(remote->workers, sizeof *remote->shares);
    if (!remote->worker_of || !remote->motes || !remote->shares) {
        destroy(remote);
        return -1;
    }
    for (unsigned w = 0; w < remote->workers; w++) {
        struct share *share = &remote->shares[w];
        const size_t from = (size_t)count * w / remote->workers, to = (size_t)count * (w + 1) / remote->workers;
        share->next = SIM_TIME_NEVER;
        share->motes = remote->motes + from;
        share->mote_count = to - from;
    }
    for (uint32_t mote = 0; mote < count; mote++) {
        unsigned w = 0;
        while ((size_t)count * (w + 1) / remote->workers <= order[mote]) {
            w++;
        }
        remote->worker_of[mote] = w;
    }
    *host = (struct host){remote, add, next, run, count_all, destroy};
    return 0;
}
