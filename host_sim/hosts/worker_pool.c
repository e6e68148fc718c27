#include "hosts/worker_pool.h"

#include "reals.h"
#include "scenario/text.h"

#include <fcntl.h>
#include <inttypes.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

extern char **environ;

/* Of a local worker, from its start until it has joined. */
static const double start_patience_s = 20;

/* Calls, while workers are wanted and while they are not; requests that are sent again, the first time and then at twice the time before up to
 * the last. */
static const double call_often_s = 0.02, call_rarely_s = 1, repeat_first_s = 2e-3, repeat_last_s = 0.1;

struct request {
    enum worker_request kind;
    uint8_t *bytes;
    size_t size;
};

struct member {
    int64_t key; /* what the messages call `worker`; of one that others start 0 until it has joined */
    char name[WORKER_NAME_MAX];
    bool is_local, joined;
    pid_t process;
    int lifeline; /* whose other end the local worker reads */
    double started_s;
    /* Requests of the run so far with respawn, else the last one. The one at `current` has been sent; later ones wait while a replacement
     * catches up. */
    struct request *requests;
    size_t request_count, request_capacity, current;
    int64_t number;  /* of the last request */
    bool is_open;    /* the last request has not been answered */
    int64_t died_at; /* request at which a predecessor of the worker died */
    double asked_s, sent_s, repeat_s;
};

struct worker_pool {
    struct worker_pool_config config;
    struct worker_link link;
    int64_t session;
    struct member *members;
    unsigned count;
    double called_s;
    struct worker_pool_statistics statistics;
    const struct worker_answers *answers; /* during worker_pool_await */
    bool failed;                          /* with the reason in error */
    char error[1000];
};

static int give_up(struct worker_pool *pool, const char *reason)
{
    if (!pool->failed) {
        pool->failed = true;
        fail(pool->error, sizeof pool->error, "%s", reason);
    }
    return -1;
}

static unsigned missing(const struct worker_pool *pool, bool local)
{
    unsigned count = 0;
    for (unsigned i = 0; i < pool->count; i++) {
        count += !pool->members[i].joined && pool->members[i].is_local == local;
    }
    return count;
}

/* ---- processes ---- */

/* Start PROGRAM worker with a pipe for its standard input, which ends when we do, and silence for its output: what it has to say it says on
 * the bus. */
static int spawn(struct worker_pool *pool, struct member *member)
{
    const struct worker_pool_config *config = &pool->config;
    char session[20], key[20], drop[40];
    int ends[2];
    snprintf(session, sizeof session, "%" PRIx64, (uint64_t)pool->session);
    snprintf(key, sizeof key, "%" PRIx64, (uint64_t)member->key);
    snprintf(drop, sizeof drop, "%.17g", config->drop_share);
    char *const words[] = {(char *)"motehound",
                           (char *)"worker",
                           (char *)"--bus",
                           (char *)config->url,
                           (char *)"--session",
                           session,
                           (char *)"--key",
                           key,
                           (char *)"--drop-share",
                           drop,
                           (char *)"--images",
                           (char *)config->images,
                           NULL};
    if (pipe(ends) != 0) {
        return give_up(pool, "--workers: no pipe to a worker");
    }
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    fcntl(ends[0], F_SETFD, FD_CLOEXEC);
    fcntl(ends[1], F_SETFD, FD_CLOEXEC);
    const int status = posix_spawn(&member->process, config->program, &actions, NULL, words, environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[0]);
    if (status != 0) {
        close(ends[1]);
        member->process = 0;
        return give_up(pool, "--workers: no process for a worker");
    }
    member->lifeline = ends[1];
    member->started_s = worker_now_s();
    snprintf(member->name, sizeof member->name, "process %ld", (long)member->process);
    return 0;
}

/* Forget the process of a local worker, which has ended. */
static void bury(struct member *member)
{
    if (member->lifeline >= 0) {
        close(member->lifeline);
    }
    member->lifeline = -1;
    member->process = 0;
}

/* Let a local worker's process come to its end, or else end it. */
static void finish(struct member *member)
{
    const pid_t process = member->process;
    if (process == 0) {
        return;
    }
    bury(member);
    const double began_s = worker_now_s();
    while (waitpid(process, NULL, WNOHANG) == 0) {
        if (worker_now_s() - began_s > 5) {
            kill(process, SIGKILL);
            waitpid(process, NULL, 0);
            return;
        }
        const struct timespec pause = {.tv_nsec = 1000000};
        nanosleep(&pause, NULL);
    }
}

/* ---- calls and joins ---- */

static void call(struct worker_pool *pool, double every_s)
{
    const double now_s = worker_now_s();
    if (now_s - pool->called_s < every_s) {
        return;
    }
    size_t size;
    const motehound_worker_call_t message = {pool->session, (int32_t)(missing(pool, true) + missing(pool, false)),
                                             (char *)pool->config.version, (char *)arithmetic_name(MH_REAL_FIXED)};
    uint8_t *bytes = worker_encode_call(&message, &size);
    if (bytes) {
        worker_link_publish(&pool->link, WORKER_CALL, bytes, size);
    }
    free(bytes);
    pool->called_s = now_s;
}

static struct member *find(struct worker_pool *pool, int64_t session, int64_t key)
{
    for (unsigned i = 0; i < pool->count && session == pool->session; i++) {
        if (pool->members[i].key == key) {
            return &pool->members[i];
        }
    }
    return NULL;
}

static struct member *free_place(struct worker_pool *pool)
{
    for (unsigned i = 0; i < pool->count; i++) {
        if (!pool->members[i].is_local && !pool->members[i].joined) {
            return &pool->members[i];
        }
    }
    return NULL;
}

static void on_join(struct worker_pool *pool, const motehound_worker_join_t *message)
{
    if (message->session != pool->session) {
        return;
    }
    struct member *member = find(pool, message->session, message->worker);
    if (!member) {
        member = free_place(pool);
    }
    if (!member || member->joined) {
        return;
    }
    if (strcmp(message->version, pool->config.version) != 0) {
        char reason[400];
        snprintf(reason, sizeof reason, "worker %.90s is motehound %.50s, expected %.50s like this run", message->name,
                 message->version, pool->config.version);
        give_up(pool, reason);
        return;
    }
    if (strcmp(message->arithmetic, arithmetic_name(MH_REAL_FIXED)) != 0 && !pool->config.mixed) {
        char reason[400];
        snprintf(reason, sizeof reason,
                 "worker %.90s computes in %.50s, expected %s like this run; --mixed lets it join", message->name,
                 message->arithmetic, arithmetic_name(MH_REAL_FIXED));
        give_up(pool, reason);
        return;
    }
    member->key = message->worker;
    member->joined = true;
    snprintf(member->name, sizeof member->name, "%.90s", message->name);
}

static void receive_join(const lcm_recv_buf_t *buffer, const char *channel, void *context)
{
    struct worker_pool *pool = context;
    motehound_worker_join_t message;
    (void)channel;
    if (worker_decode_join(&pool->link, buffer, &message)) {
        on_join(pool, &message);
        motehound_worker_join_t_decode_cleanup(&message);
    }
}

/* ---- requests and answers ---- */

/* The worker that a request is for stands behind the fingerprint and the session. Replacements have a number of their own. */
static void readdress(struct request *request, int64_t key)
{
    for (int i = 0; i < 8; i++) {
        request->bytes[16 + i] = (uint8_t)((uint64_t)key >> (56 - 8 * i));
    }
}

static void send_current(struct worker_pool *pool, struct member *member)
{
    char channel[WORKER_CHANNEL_MAX];
    struct request *request = &member->requests[member->current];
    readdress(request, member->key);
    worker_link_publish(&pool->link, worker_channel(member->key, request->kind, channel), request->bytes,
                        request->size);
    member->sent_s = worker_now_s();
}

static void send_anew(struct worker_pool *pool, struct member *member)
{
    member->repeat_s = repeat_first_s;
    send_current(pool, member);
    member->asked_s = member->sent_s;
}

static int64_t current_number(const struct member *member)
{
    return member->number - (int64_t)(member->request_count - 1 - member->current);
}

/* Is this the answer to what `member` was asked last? A replacement's answers to what its predecessor has answered only let it go on to the
 * next. */
static bool is_last_answer(struct worker_pool *pool, struct member *member, int64_t number)
{
    if (!member || !member->is_open || number != current_number(member)) {
        return false;
    }
    if (member->current + 1 < member->request_count) {
        member->current++;
        send_anew(pool, member);
        return false;
    }
    member->is_open = false;
    return true;
}

#define RECEIVE_ANSWER(name)                                                                                           \
    static void receive_##name(const lcm_recv_buf_t *buffer, const char *channel, void *context)                       \
    {                                                                                                                  \
        struct worker_pool *pool = context;                                                                            \
        motehound_worker_##name##_t message;                                                                           \
        (void)channel;                                                                                                 \
        if (!worker_decode_##name(&pool->link, buffer, &message)) {                                                    \
            return;                                                                                                    \
        }                                                                                                              \
        struct member *member = find(pool, message.session, message.worker);                                           \
        if (is_last_answer(pool, member, message.number) &&                                                            \
            pool->answers->name(pool->answers->context, (unsigned)(member - pool->members), &message, pool->error,     \
                                sizeof pool->error) != 0) {                                                            \
            pool->failed = true;                                                                                       \
        }                                                                                                              \
        motehound_worker_##name##_t_decode_cleanup(&message);                                                          \
    }

RECEIVE_ANSWER(done)
RECEIVE_ANSWER(totals)

static void receive_error(const lcm_recv_buf_t *buffer, const char *channel, void *context)
{
    struct worker_pool *pool = context;
    motehound_worker_error_t message;
    (void)channel;
    if (worker_decode_error(&pool->link, buffer, &message)) {
        if (find(pool, message.session, message.worker)) {
            give_up(pool, message.text);
        }
        motehound_worker_error_t_decode_cleanup(&message);
    }
}

static void drop_requests(struct member *member)
{
    for (size_t i = 0; i < member->request_count; i++) {
        free(member->requests[i].bytes);
    }
    member->request_count = 0;
}

int worker_pool_request(struct worker_pool *pool, unsigned worker, enum worker_request kind, uint8_t *bytes,
                        size_t size, char *error, size_t error_size)
{
    struct member *member = &pool->members[worker];
    if (!pool->config.respawn || kind == WORKER_ASSIGN) {
        drop_requests(member);
    }
    if (bytes && member->request_count == member->request_capacity) {
        const size_t capacity = member->request_capacity ? 2 * member->request_capacity : 16;
        struct request *requests = realloc(member->requests, capacity * sizeof *requests);
        if (!requests) {
            free(bytes);
            bytes = NULL;
        } else {
            member->requests = requests;
            member->request_capacity = capacity;
        }
    }
    if (!bytes) {
        return fail(error, error_size, "out of memory for what a worker is asked");
    }
    member->current = member->request_count;
    member->requests[member->request_count++] = (struct request){kind, bytes, size};
    member->number++;
    member->is_open = true;
    pool->statistics.requests++;
    send_anew(pool, member);
    return 0;
}

/* ---- life and death ---- */

static int lose(struct worker_pool *pool, struct member *member, const char *how)
{
    char reason[400];
    snprintf(reason, sizeof reason, "worker %.90s %s%s", member->name, how,
             pool->config.respawn ? "" : "; --respawn replaces such workers");
    if (!pool->config.respawn || !member->joined || member->died_at == member->number) {
        return give_up(pool, reason); /* one that has died of a request lets its replacement die too */
    }
    member->died_at = member->number;
    pool->statistics.replaced++;
    member->joined = false;
    return 0;
}

/* Has the worker ended, or been silent for too long? A replacement that joins begins with the first request. */
static int look_after(struct worker_pool *pool, struct member *member, double now_s)
{
    if (member->is_local) {
        int status;
        char how[100];
        if (member->process != 0 && waitpid(member->process, &status, WNOHANG) == member->process) {
            bury(member);
            if (WIFSIGNALED(status)) {
                snprintf(how, sizeof how, "was ended by signal %d", WTERMSIG(status));
            } else {
                snprintf(how, sizeof how, "has ended with status %d", WEXITSTATUS(status));
            }
            return lose(pool, member, how) == 0 ? spawn(pool, member) : -1;
        }
        if (!member->joined && now_s - member->started_s > start_patience_s) {
            return lose(pool, member, "does not join: does the bus reach this machine's own processes?");
        }
    } else if (member->joined && member->is_open && now_s - member->asked_s > WORKER_PATIENCE_S) {
        member->key = 0;
        return lose(pool, member, "has been silent for too long");
    }
    return 0;
}

static int look_around(struct worker_pool *pool)
{
    const double now_s = worker_now_s();
    call(pool, missing(pool, true) + missing(pool, false) > 0 ? call_often_s : call_rarely_s);
    for (unsigned i = 0; i < pool->count; i++) {
        if (look_after(pool, &pool->members[i], now_s) != 0) {
            return -1;
        }
    }
    if (pool->config.stop && __atomic_load_n(pool->config.stop, __ATOMIC_RELAXED)) {
        return give_up(pool, "stopped");
    }
    return 0;
}

/* Wait a moment for what comes, and see to it that something does. Returns 0, or -1: the pool has failed. */
static int attend(struct worker_pool *pool)
{
    double wait_s = 0.01;
    for (unsigned i = 0; i < pool->count; i++) {
        struct member *member = &pool->members[i];
        if (!member->is_open || !member->joined) {
            continue;
        }
        const double since_s = worker_now_s() - member->sent_s;
        if (since_s >= member->repeat_s) {
            member->repeat_s = member->repeat_s < repeat_last_s / 2 ? 2 * member->repeat_s : repeat_last_s;
            pool->statistics.repeated++;
            send_current(pool, member);
            if (look_around(pool) != 0) {
                return -1;
            }
        } else if (member->repeat_s - since_s < wait_s) {
            wait_s = member->repeat_s - since_s;
        }
    }
    worker_link_handle(&pool->link, wait_s, -1);
    return pool->failed ? -1 : 0;
}

static int gather(struct worker_pool *pool, void (*waiting)(unsigned missing))
{
    bool told = false;
    while (missing(pool, true) + missing(pool, false) > 0) {
        if (waiting && !told && missing(pool, true) == 0) {
            waiting(missing(pool, false));
            told = true;
        }
        if (look_around(pool) != 0 || attend(pool) != 0) {
            return -1;
        }
    }
    return 0;
}

int worker_pool_await(struct worker_pool *pool, const struct worker_answers *answers, char *error, size_t error_size)
{
    pool->answers = answers;
    if (worker_now_s() - pool->called_s > call_rarely_s) {
        (void)look_around(pool);
    }
    for (bool open = true; open && !pool->failed;) {
        open = false;
        for (unsigned i = 0; i < pool->count && !pool->failed; i++) {
            struct member *member = &pool->members[i];
            open = open || member->is_open;
            if (member->is_open && !member->joined && gather(pool, NULL) == 0) {
                member->current = 0;
                send_anew(pool, member);
            }
        }
        if (open && !pool->failed) {
            (void)attend(pool);
        }
    }
    return pool->failed ? fail(error, error_size, "%s", pool->error) : 0;
}

/* ---- from the beginning to the end ---- */

static int start(struct worker_pool *pool)
{
    if (worker_link_open(&pool->link, pool->config.url, pool->config.drop_share, pool->error, sizeof pool->error) !=
        0) {
        return -1;
    }
    lcm_t *lcm = pool->link.lcm;
    if (!lcm_subscribe(lcm, WORKER_JOIN, receive_join, pool) || !lcm_subscribe(lcm, WORKER_DONE, receive_done, pool) ||
        !lcm_subscribe(lcm, WORKER_TOTALS, receive_totals, pool) ||
        !lcm_subscribe(lcm, WORKER_ERROR, receive_error, pool)) {
        return give_up(pool, "--bus: LCM takes no subscription");
    }
    for (unsigned i = 0; i < pool->count; i++) {
        struct member *member = &pool->members[i];
        if (member->is_local) {
            member->key = worker_random();
            if (spawn(pool, member) != 0) {
                return -1;
            }
        }
    }
    return 0;
}

struct worker_pool *worker_pool_open(const struct worker_pool_config *config, void (*waiting)(unsigned missing),
                                     char *error, size_t error_size)
{
    struct worker_pool *pool = calloc(1, sizeof *pool);
    struct member *members = calloc(config->local + config->joining, sizeof *members);
    if (!pool || !members) {
        free(pool);
        free(members);
        fail(error, error_size, "out of memory for the workers");
        return NULL;
    }
    pool->config = *config;
    pool->session = worker_random();
    pool->members = members;
    pool->count = config->local + config->joining;
    for (unsigned i = 0; i < pool->count; i++) {
        members[i].is_local = i < config->local;
        members[i].lifeline = -1;
    }
    if (start(pool) != 0 || gather(pool, waiting) != 0) {
        fail(error, error_size, "%s", pool->error);
        worker_pool_close(pool);
        return NULL;
    }
    return pool;
}

void worker_pool_close(struct worker_pool *pool)
{
    size_t size;
    const motehound_worker_release_t message = {pool->session};
    uint8_t *bytes = pool->link.lcm ? worker_encode_release(&message, &size) : NULL;
    for (int i = 0; i < 3 && bytes; i++) { /* a worker that hears none of them notices the silence */
        worker_link_publish(&pool->link, WORKER_RELEASE, bytes, size);
    }
    free(bytes);
    for (unsigned i = 0; i < pool->count; i++) {
        finish(&pool->members[i]);
        drop_requests(&pool->members[i]);
        free(pool->members[i].requests);
    }
    worker_link_close(&pool->link);
    free(pool->members);
    free(pool);
}

unsigned worker_pool_count(const struct worker_pool *pool) { return pool->count; }

void worker_pool_address(const struct worker_pool *pool, unsigned worker, int64_t *session, int64_t *key,
                         int64_t *number)
{
    *session = pool->session;
    *key = pool->members[worker].key;
    *number = pool->members[worker].number + 1;
}

void worker_pool_note_window(struct worker_pool *pool, double seconds)
{
    pool->statistics.windows++;
    pool->statistics.window_s += seconds;
}

struct worker_pool_statistics worker_pool_statistics(const struct worker_pool *pool)
{
    struct worker_pool_statistics statistics = pool->statistics;
    statistics.workers = pool->count;
    statistics.not_understood = pool->link.not_understood;
    return statistics;
}
