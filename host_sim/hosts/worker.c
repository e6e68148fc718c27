#include "hosts/worker.h"

#include "hosts/boards.h"
#include "reals.h"
#include "roster.h"
#include "scenario/text.h"

#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { ERROR_SIZE = 1000 };

/* How long a worker that has answered one call waits for that run before it answers another's. */
static const double courtship_s = 5;

#define NOBODY UINT32_MAX

/* The motes of one run. */
struct motes {
    struct scenario scenario;
    struct mote_kit kit;
    struct host host;
    struct emulation boards; /* of these motes, in the order in which they were added */
    uint32_t count, added;
    uint32_t *numbers; /* of the motes here, in the run ... */
    uint32_t *order;   /* ... and their places in the host's memory */
    uint32_t *here;    /* number in this process of mote i of the run, or NOBODY */
    size_t known;      /* entries of `here` */
};

struct worker {
    const struct worker_config *config;
    struct worker_link *link;
    int64_t session, number;
    double joined_s, heard_s;
    bool assigned, released;
    int64_t last; /* request that was answered */
    const char *answer_channel;
    uint8_t *answer;
    size_t answer_size;
    struct motes motes;
    struct host_actions actions;
    char error[ERROR_SIZE]; /* why the worker cannot go on; empty while it can */
};

/* ---- the motes ---- */

static void forget_motes(struct motes *motes)
{
    if (motes->host.destroy) {
        motes->host.destroy(motes->host.state);
    }
    free(motes->numbers);
    free(motes->order);
    free(motes->here);
    scenario_free(&motes->scenario);
    *motes = (struct motes){0};
}

static int make_motes(struct motes *motes, const motehound_worker_assign_t *message, const char *images, char *error,
                      size_t error_size)
{
    const char *scenario = message->scenario;
    const uint32_t count = (uint32_t)message->count;
    forget_motes(motes);
    if (scenario_init(&motes->scenario) != 0) {
        return fail(error, error_size, "out of memory");
    }
    if (scenario_parse(scenario, strlen(scenario), "the run's scenario", &motes->scenario, error, error_size) != 0 ||
        mote_kit_make(&motes->kit, &motes->scenario, error, error_size) != 0 ||
        protocol_tell_entries(&motes->kit.protocol, &motes->scenario, (uint64_t)message->seed, error, error_size) !=
            0) {
        return -1;
    }
    tracker_seed(&motes->kit.tracker, (uint32_t)message->seed);
    mote_kit_tell_sink(&motes->kit, (mh_node_id)message->sink,
                       (struct mh_place){message->sink_x_mm, message->sink_y_mm, message->sink_z_mm});
    mote_kit_tell_start(&motes->kit, (mh_node_id)message->start,
                        (struct mh_place){message->start_x_mm, message->start_y_mm, message->start_z_mm});
    motes->count = count;
    motes->numbers = malloc((count + 1) * sizeof *motes->numbers);
    motes->order = malloc((count + 1) * sizeof *motes->order);
    for (uint32_t i = 0; i < count && motes->order; i++) {
        motes->order[i] = i;
    }
    if (!motes->numbers || !motes->order ||
        host_boards(&motes->host, count, motes->order, motes->kit.protocol.protocol, images) != 0) {
        return fail(error, error_size, "out of memory for %u nodes", (unsigned)count);
    }
    return 0;
}

/* Let `here` have an entry for mote `mote`. */
static int know(struct motes *motes, uint32_t mote)
{
    if (mote < motes->known) {
        return 0;
    }
    const size_t known = 2 * ((size_t)mote + 1);
    uint32_t *here = realloc(motes->here, known * sizeof *here);
    if (!here) {
        return -1;
    }
    for (size_t i = motes->known; i < known; i++) {
        here[i] = NOBODY;
    }
    motes->here = here;
    motes->known = known;
    return 0;
}

static int add_mote(struct motes *motes, const motehound_worker_mote_t *message)
{
    const uint32_t mote = (uint32_t)message->mote;
    if (message->mote < 0 || mote >= UINT32_C(1) << 28 || motes->added == motes->count || know(motes, mote) != 0) {
        return -1;
    }
    struct host_mote what =
        mote_kit_mote(&motes->kit, (mh_node_id)message->id,
                      (struct mh_place){message->x_mm, message->y_mm, message->z_mm}, message->is_sink != 0);
    if (message->board[0] != '\0') {
        const size_t at = motes->boards.count;
        if (at == BOARDS_MAX || !board_kind_find(message->board)) {
            return -1;
        }
        snprintf(motes->boards.list[at].board, BOARD_NAME_MAX, "%s", message->board);
        what.board = motes->boards.list[motes->boards.count++].board;
    }
    what.clock =
        (struct local_clock){message->offset_us, message->drift_ppm, message->wander_ppm, message->wander_phase};
    motes->here[mote] = motes->added;
    motes->numbers[motes->added] = mote;
    return motes->host.add(motes->host.state, motes->added++, &what);
}

/* Number in this process of a mote of the run; NOBODY if it does not live here. */
static uint32_t mote_here(const struct motes *motes, uint32_t mote)
{
    return mote < motes->known ? motes->here[mote] : NOBODY;
}

/* The message's events, with the numbers that its motes have here. */
static struct host_event *read_events(const struct motes *motes, const motehound_worker_window_t *window)
{
    const size_t count = (size_t)window->count;
    struct host_event *events = malloc((count + 1) * sizeof *events);
    bool sound = events != NULL && motes->added == motes->count;
    for (size_t i = 0; sound && i < count; i++) {
        motehound_worker_event_t *message = &window->events[i];
        for (int32_t m = 0; m < message->count; m++) {
            message->motes[m] = (int32_t)mote_here(motes, (uint32_t)message->motes[m]);
            sound = sound && message->motes[m] >= 0;
        }
        sound = sound && worker_event_read(message, &events[i]) == 0;
    }
    if (!sound) {
        free(events);
        return NULL;
    }
    return events;
}

/* ---- answers ---- */

static void send_answer(struct worker *worker)
{
    worker_link_publish(worker->link, worker->answer_channel, worker->answer, worker->answer_size);
}

/* Keep `answer`, new memory, as the answer to request `number`, and send it. */
static void answer(struct worker *worker, int64_t number, const char *channel, uint8_t *bytes, size_t size)
{
    if (!bytes) {
        return; /* no memory: perhaps there is when the request comes again */
    }
    free(worker->answer);
    worker->last = number;
    worker->answer_channel = channel;
    worker->answer = bytes;
    worker->answer_size = size;
    send_answer(worker);
}

static void answer_error(struct worker *worker, int64_t number)
{
    size_t size;
    const motehound_worker_error_t message = {worker->session, worker->number, worker->error};
    uint8_t *bytes = worker_encode_error(&message, &size);
    answer(worker, number, WORKER_ERROR, bytes, size);
}

/* With what the motes did, which is then forgotten. */
static void answer_done(struct worker *worker, int64_t number)
{
    struct host_actions *actions = &worker->actions;
    const struct motes *motes = &worker->motes;
    const sim_time next = motes->host.next(motes->host.state);
    motehound_worker_done_t message = {.session = worker->session,
                                       .worker = worker->number,
                                       .number = number,
                                       .next_us = next == SIM_TIME_NEVER ? -1 : (int64_t)next,
                                       .count = (int32_t)actions->count};
    message.actions = malloc((actions->count + 1) * sizeof *message.actions);
    motehound_worker_estimate_t *estimates = malloc((actions->count + 1) * sizeof *estimates);
    if (message.actions && estimates) {
        for (size_t i = 0; i < actions->count; i++) {
            actions->list[i].mote = motes->numbers[actions->list[i].mote];
            message.actions[i] = worker_action_message(&actions->list[i], &estimates[i]);
        }
        size_t size;
        uint8_t *bytes = worker_encode_done(&message, &size);
        answer(worker, number, WORKER_DONE, bytes, size);
    }
    actions->count = 0;
    free(estimates);
    free(message.actions);
}

/* Is this request to be done now? One that comes again is answered again. */
static bool is_next(struct worker *worker, int64_t session, int64_t number, bool begins)
{
    if (session != worker->session) {
        return false;
    }
    worker->heard_s = worker_now_s();
    if (worker->answer && number == worker->last) {
        send_answer(worker);
        return false;
    }
    if (worker->error[0] != '\0') {
        return false;
    }
    return begins ? number > worker->last : worker->assigned && number == worker->last + 1;
}

static void on_assign(struct worker *worker, const motehound_worker_assign_t *message)
{
    worker->assigned = true;
    if (message->count < 0 ||
        make_motes(&worker->motes, message, worker->config->images, worker->error, sizeof worker->error) != 0) {
        answer_error(worker, message->number);
    } else {
        answer_done(worker, message->number);
    }
}

static void on_motes(struct worker *worker, const motehound_worker_motes_t *message)
{
    for (int32_t i = 0; i < message->count && worker->error[0] == '\0'; i++) {
        if (add_mote(&worker->motes, &message->motes[i]) != 0) {
            fail(worker->error, sizeof worker->error, "a worker cannot host mote %ld", (long)message->motes[i].mote);
        }
    }
    if (worker->error[0] != '\0') {
        answer_error(worker, message->number);
    } else {
        answer_done(worker, message->number);
    }
}

static void on_window(struct worker *worker, const motehound_worker_window_t *message)
{
    struct host *host = &worker->motes.host;
    struct host_event *events = read_events(&worker->motes, message);
    int status = 0;
    if (!events || message->until_us < 0) {
        status = fail(worker->error, sizeof worker->error, "a worker was sent events that it cannot use");
    } else {
        status = host->run(host->state, (sim_time)message->until_us, events, (size_t)message->count, &worker->actions,
                           worker->error, sizeof worker->error);
    }
    free(events);
    if (status != 0) {
        answer_error(worker, message->number);
    } else {
        answer_done(worker, message->number);
    }
}

/* Counters are nothing but 32-bit numbers. */
static void widen(int64_t *to, const void *from, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint32_t counter;
        memcpy(&counter, (const uint8_t *)from + i * sizeof counter, sizeof counter);
        to[i] = counter;
    }
}

static void on_count(struct worker *worker, const motehound_worker_count_t *message)
{
    enum {
        MOTE = sizeof(struct mh_mote_counters) / sizeof(uint32_t),
        HEAD = sizeof(struct mh_head_counters) / sizeof(uint32_t),
        PROTOCOL = sizeof(struct mh_protocol_counters) / sizeof(uint32_t)
    };
    struct host *host = &worker->motes.host;
    struct board_results boards = {.count = 0};
    motehound_worker_board_t board_messages[BOARDS_MAX];
    struct host_totals totals = {.boards = &boards};
    int64_t motes[MOTE], heads[HEAD], protocols[PROTOCOL];
    size_t size;
    if (host->count(host->state, &totals, worker->error, sizeof worker->error) != 0) {
        answer_error(worker, message->number);
        return;
    }
    widen(motes, &totals.motes, MOTE);
    widen(heads, &totals.heads, HEAD);
    widen(protocols, &totals.protocols, PROTOCOL);
    const motehound_worker_totals_t reply = {
        worker->session, worker->number, message->number, (int64_t)totals.events, MOTE,          motes, HEAD,
        heads,           PROTOCOL,       protocols,       (int32_t)boards.count,  board_messages};
    for (size_t i = 0; i < boards.count; i++) {
        board_messages[i] = worker_board_message(&boards.list[i]);
    }
    uint8_t *bytes = worker_encode_totals(&reply, &size);
    answer(worker, message->number, WORKER_TOTALS, bytes, size);
}

/* ---- what comes in ---- */

/* Decode a request of a kind, and do it if it is its turn. */
#define SERVE(worker, kind, buffer, begins)                                                                            \
    do {                                                                                                               \
        motehound_worker_##kind##_t message;                                                                           \
        if (worker_decode_##kind((worker)->link, buffer, &message)) {                                                  \
            if (is_next(worker, message.session, message.number, begins)) {                                            \
                on_##kind(worker, &message);                                                                           \
            }                                                                                                          \
            motehound_worker_##kind##_t_decode_cleanup(&message);                                                      \
        }                                                                                                              \
    } while (0)

static void receive_request(const lcm_recv_buf_t *buffer, const char *channel, void *context)
{
    struct worker *worker = context;
    const char *kind = strrchr(channel, '_') + 1;
    if (strcmp(kind, "WINDOW") == 0) {
        SERVE(worker, window, buffer, false);
    } else if (strcmp(kind, "ASSIGN") == 0) {
        SERVE(worker, assign, buffer, true);
    } else if (strcmp(kind, "MOTES") == 0) {
        SERVE(worker, motes, buffer, false);
    } else if (strcmp(kind, "COUNT") == 0) {
        SERVE(worker, count, buffer, false);
    } else {
        worker->link->not_understood++;
    }
}

static void join(struct worker *worker, int64_t session)
{
    char name[WORKER_NAME_MAX] = "unknown";
    size_t size;
    gethostname(name, sizeof name - 30);
    name[sizeof name - 30] = '\0';
    const size_t length = strlen(name);
    snprintf(name + length, sizeof name - length, ", process %ld", (long)getpid());
    const motehound_worker_join_t message = {session, worker->number, name, (char *)worker->config->version,
                                             (char *)arithmetic_name(MH_REAL_FIXED)};
    uint8_t *bytes = worker_encode_join(&message, &size);
    if (bytes) {
        worker_link_publish(worker->link, WORKER_JOIN, bytes, size);
    }
    free(bytes);
}

static void receive_call(const lcm_recv_buf_t *buffer, const char *channel, void *context)
{
    struct worker *worker = context;
    motehound_worker_call_t call;
    (void)channel;
    if (!worker_decode_call(worker->link, buffer, &call)) {
        return;
    }
    const double now_s = worker_now_s();
    const bool is_mine = call.session == worker->session;
    if (is_mine) {
        worker->heard_s = now_s;
    }
    const bool may_join = worker->config->session == 0 || worker->config->session == call.session;
    if (!worker->assigned && may_join && call.wanted > 0 && (is_mine || now_s - worker->joined_s > courtship_s)) {
        worker->session = call.session;
        worker->joined_s = worker->heard_s = now_s;
        join(worker, call.session);
    }
    motehound_worker_call_t_decode_cleanup(&call);
}

static void receive_release(const lcm_recv_buf_t *buffer, const char *channel, void *context)
{
    struct worker *worker = context;
    motehound_worker_release_t release;
    (void)channel;
    if (worker_decode_release(worker->link, buffer, &release)) {
        worker->released = worker->released || (worker->assigned && release.session == worker->session);
        motehound_worker_release_t_decode_cleanup(&release);
    }
}

/* ---- from the beginning to the end ---- */

/* The run has ended, in whatever way, and the descriptor to it with it. */
static bool lifeline_is_cut(int lifeline)
{
    char byte;
    struct pollfd what = {lifeline, POLLIN, 0};
    return lifeline >= 0 && poll(&what, 1, 0) > 0 && read(lifeline, &byte, 1) <= 0;
}

static int serve(struct worker *worker, char *error, size_t error_size)
{
    const struct worker_config *config = worker->config;
    double looked_s = 0;
    while (!worker->released) {
        worker_link_handle(worker->link, 0.1, config->lifeline);
        const double now_s = worker_now_s();
        if (now_s - looked_s < 0.05) {
            continue;
        }
        looked_s = now_s;
        if (config->stop && __atomic_load_n(config->stop, __ATOMIC_RELAXED)) {
            return fail(error, error_size, "motehound worker: interrupted");
        }
        if (lifeline_is_cut(config->lifeline)) {
            break;
        }
        if (worker->assigned && now_s - worker->heard_s > WORKER_PATIENCE_S) {
            return fail(error, error_size, "motehound worker: the run has been silent for %.0f s", WORKER_PATIENCE_S);
        }
    }
    return worker->error[0] != '\0' ? fail(error, error_size, "%s", worker->error) : 0;
}

struct worker *worker_open(const struct worker_config *config, struct worker_link *link, char *error, size_t error_size)
{
    char channel[WORKER_CHANNEL_MAX];
    struct worker *worker = calloc(1, sizeof *worker);
    if (!worker) {
        fail(error, error_size, "out of memory");
        return NULL;
    }
    worker->config = config;
    worker->link = link;
    worker->number = config->worker ? config->worker : worker_random();
    worker->joined_s = -courtship_s;
    if (!lcm_subscribe(link->lcm, WORKER_CALL, receive_call, worker) ||
        !lcm_subscribe(link->lcm, WORKER_RELEASE, receive_release, worker) ||
        !lcm_subscribe(link->lcm, worker_channel(worker->number, WORKER_REQUESTS, channel), receive_request, worker)) {
        fail(error, error_size, "--bus %s: LCM takes no subscription", config->url);
        worker_close(worker);
        return NULL;
    }
    return worker;
}

void worker_close(struct worker *worker)
{
    forget_motes(&worker->motes);
    host_actions_free(&worker->actions);
    free(worker->answer);
    free(worker);
}

int worker_serve(const struct worker_config *config, char *error, size_t error_size)
{
    struct worker_link link;
    int status = -1;
    if (worker_link_open(&link, config->url, config->drop_share, error, error_size) != 0) {
        return -1;
    }
    struct worker *worker = worker_open(config, &link, error, error_size);
    if (worker) {
        status = serve(worker, error, error_size);
        worker_link_close(&link); /* which calls the worker no more */
        worker_close(worker);
    }
    worker_link_close(&link);
    return status;
}
