#include "cli/batch.h"

#include "bus/bus.h"
#include "record/recorder.h"
#include "scenario/text.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <time.h>

enum { ERROR_SIZE = 1000, REFRESH_NS = 200000000 };

/* One run that is being done or has been done. */
struct slot {
    struct recorder recorder;
    bool done, sound;
    char error[ERROR_SIZE];
};

struct work {
    const struct batch *batch;
    const struct results *results;
    struct slot *slots;
    unsigned next; /* run that nobody has begun */
    bool given_up;
    pthread_mutex_t mutex;
    pthread_cond_t changed;
};

static bool execute(const struct work *work, unsigned run, struct slot *slot)
{
    const struct batch *batch = work->batch;
    char path[OUTPUT_PATH_MAX];
    struct bus bus;
    struct simulation_counters counters = {0};
    const uint64_t seed = batch->seed + run;
    if (bus_open(&bus, (int32_t)run, results_log_path(work->results, run, path), batch->outside, batch->pace,
                 slot->error, ERROR_SIZE) != 0) {
        return false;
    }
    bus.searches = batch->scenario->sensor.quantity == QUANTITY_GAS;
    bool sound = recorder_subscribe(&slot->recorder, bus.lcm) == 0;
    if (!sound) {
        fail(slot->error, ERROR_SIZE, "run %u: LCM takes no subscription", run);
    } else {
        const struct observer observer = bus_observer(&bus);
        bus_begin(&bus, seed, batch->scenario->name, batch->version);
        sound = (batch->recording == NULL ? simulation_run_on(batch->hosts, batch->scenario, seed, &observer,
                                                              batch->stop, &counters, slot->error, ERROR_SIZE)
                                          : simulation_replay(batch->scenario, batch->recording, seed, &observer,
                                                              batch->stop, &counters, slot->error, ERROR_SIZE)) == 0;
        if (sound && batch->recording == NULL) {
            sound = bounds_of(batch->scenario, seed, &counters.bounds, slot->error, ERROR_SIZE) == 0;
        }
        if (sound) {
            bus_end(&bus, &counters);
        }
    }
    char bus_error[ERROR_SIZE];
    if (bus_close(&bus, bus_error, sizeof bus_error) != 0 && sound) {
        return fail(slot->error, ERROR_SIZE, "%s", bus_error) == 0;
    }
    if (sound && slot->recorder.failed) {
        return fail(slot->error, ERROR_SIZE, "run %u: the recorder lost a message or has no memory", run) == 0;
    }
    return sound;
}

static void *worker(void *context)
{
    struct work *work = context;
    pthread_mutex_lock(&work->mutex);
    while (!work->given_up && work->next < work->batch->runs) {
        const unsigned run = work->next++;
        pthread_mutex_unlock(&work->mutex);
        struct slot *slot = &work->slots[run];
        const bool sound = execute(work, run, slot);
        pthread_mutex_lock(&work->mutex);
        slot->sound = sound;
        slot->done = true;
        pthread_cond_signal(&work->changed);
    }
    pthread_mutex_unlock(&work->mutex);
    return NULL;
}

/* Wait for the next run's end, showing progress meanwhile. The mutex is held. */
static void wait_for(struct work *work, unsigned run)
{
    const struct batch *batch = work->batch;
    while (!work->slots[run].done) {
        if (batch->progress != NULL) {
            batch->progress(batch->progress_context, run, batch->runs);
        }
        struct timespec until;
        clock_gettime(CLOCK_REALTIME, &until);
        until.tv_nsec += REFRESH_NS;
        until.tv_sec += until.tv_nsec / 1000000000;
        until.tv_nsec %= 1000000000;
        pthread_cond_timedwait(&work->changed, &work->mutex, &until);
    }
}

/* Add the runs to the results in their order. */
static int collect(struct work *work, struct results *results, char *error, size_t error_size)
{
    const struct batch *batch = work->batch;
    for (unsigned run = 0; run < batch->runs; run++) {
        struct slot *slot = &work->slots[run];
        pthread_mutex_lock(&work->mutex);
        wait_for(work, run);
        pthread_mutex_unlock(&work->mutex);
        if (!slot->sound) {
            return fail(error, error_size, "%s", slot->error);
        }
        if (results_add(results, batch->seed + run, batch->scenario, &slot->recorder, error, error_size) != 0) {
            return -1;
        }
        recorder_free(&slot->recorder);
    }
    if (batch->progress != NULL) {
        batch->progress(batch->progress_context, batch->runs, batch->runs);
    }
    return 0;
}

int batch_execute(const struct batch *batch, struct results *results, char *error, size_t error_size)
{
    const unsigned jobs = batch->jobs < batch->runs ? batch->jobs : batch->runs;
    struct work work = {.batch = batch, .results = results, .slots = calloc(batch->runs, sizeof(struct slot))};
    pthread_t *threads = calloc(jobs, sizeof *threads);
    if (work.slots == NULL || threads == NULL) {
        free(work.slots);
        free(threads);
        return fail(error, error_size, "--runs %u: no memory", batch->runs);
    }
    bus_prepare();
    pthread_mutex_init(&work.mutex, NULL);
    pthread_cond_init(&work.changed, NULL);
    unsigned started = 0;
    while (started < jobs && pthread_create(&threads[started], NULL, worker, &work) == 0) {
        started++;
    }
    const int status = started > 0 ? collect(&work, results, error, error_size)
                                   : fail(error, error_size, "--jobs %u: no thread can be started", jobs);
    pthread_mutex_lock(&work.mutex);
    work.given_up = true;
    pthread_mutex_unlock(&work.mutex);
    for (unsigned i = 0; i < started; i++) {
        pthread_join(threads[i], NULL);
    }
    for (unsigned i = 0; i < batch->runs; i++) {
        recorder_free(&work.slots[i].recorder);
    }
    pthread_cond_destroy(&work.changed);
    pthread_mutex_destroy(&work.mutex);
    free(work.slots);
    free(threads);
    return status;
}
