#include "cli/workers.h"

#include "hosts/remote.h"
#include "record/scenario_json.h"
#include "scenario/text.h"

#include <stdio.h>
#include <stdlib.h>

/* All keys of the scenario but those that are lists and empty, which a scenario leaves out. */
static void leave_out_empty(json_t *object)
{
    const char *name;
    json_t *value;
    void *following;
    json_object_foreach_safe(object, following, name, value)
    {
        if (json_is_array(value) && json_array_size(value) == 0) {
            json_object_del(object, name);
        }
    }
}

static char *scenario_text(const struct scenario *scenario)
{
    json_t *whole = scenario_json(scenario);
    const char *name;
    json_t *section;
    leave_out_empty(whole);
    json_object_foreach(whole, name, section) { leave_out_empty(section); }
    char *text = whole ? json_dumps(whole, JSON_REAL_PRECISION(17)) : NULL;
    json_decref(whole);
    return text;
}

static int open_host(void *context, struct host *host, uint32_t count, const uint32_t *order,
                     const struct mh_protocol *protocol, uint64_t seed)
{
    const struct workers *workers = context;
    (void)protocol; /* the workers find it in the scenario */
    return host_remote(host, count, order, workers->scenario, seed, workers->pool);
}

static void tell_waiting(unsigned missing)
{
    printf("waiting for %u worker%s to join: motehound worker --bus URL\n", missing, missing == 1 ? "" : "s");
    fflush(stdout);
}

int workers_open(struct workers *workers, const struct worker_pool_config *config, const struct scenario *scenario,
                 char *error, size_t error_size)
{
    *workers =
        (struct workers){.provider = {.context = workers, .open = open_host}, .scenario = scenario_text(scenario)};
    if (!workers->scenario) {
        return fail(error, error_size, "%s: cannot be told to workers", scenario->name);
    }
    workers->pool = worker_pool_open(config, tell_waiting, error, error_size);
    if (!workers->pool) {
        free(workers->scenario);
        return -1;
    }
    return 0;
}

void workers_report(const struct workers *workers)
{
    const struct worker_pool_statistics s = worker_pool_statistics(workers->pool);
    printf("%u worker%s, %llu windows in lock step, %.0f us each; %llu requests, %llu sent again, %llu messages not "
           "understood",
           s.workers, s.workers == 1 ? "" : "s", (unsigned long long)s.windows,
           s.windows > 0 ? 1e6 * s.window_s / (double)s.windows : 0.0, (unsigned long long)s.requests,
           (unsigned long long)s.repeated, (unsigned long long)s.not_understood);
    if (s.replaced > 0) {
        printf("; %u replaced", s.replaced);
    }
    putchar('\n');
}

void workers_close(struct workers *workers)
{
    worker_pool_close(workers->pool);
    free(workers->scenario);
}
