#include "motehound/head.h"

#include <string.h>

/* The order the tracker is promised: -1, 0 or 1 as a comes before, with or after b. */
static int order(const struct mh_head *head, const struct mh_measurement *a, const struct mh_measurement *b)
{
    if (a->time != b->time) {
        return mh_tick_before(a->time, b->time) ? -1 : 1;
    }
    if (a->node != b->node) {
        const bool own_first = head->config->own_first;
        const bool a_first = own_first && a->node == head->own;
        const bool b_first = own_first && b->node == head->own;
        return a_first || (!b_first && a->node < b->node) ? -1 : 1;
    }
    return (a->target > b->target) - (a->target < b->target);
}

/* The order in which measurements give way when the table is full. */
static bool gives_way_before(const struct mh_head *head, const struct mh_measurement *a, const struct mh_measurement *b)
{
    if (a->increment != b->increment) {
        return a->increment < b->increment;
    }
    return a->node != b->node ? a->node > b->node : order(head, a, b) > 0;
}

static bool is_at_end(mh_q20 a) { return a == INT32_MAX || a == INT32_MIN; }

static bool is_of_next(const struct mh_head *head, const struct mh_measurement *measurement)
{
    return mh_tick_before(head->instant, measurement->time);
}

static mh_tick instant_of(const struct mh_head *head, const struct mh_measurement *measurement)
{
    return mh_tick_aligned(head->instant, head->config->interval, measurement->time);
}

static void insert(struct mh_head *head, const struct mh_measurement *measurement)
{
    uint16_t at = head->count++;
    for (; at > 0 && order(head, measurement, &head->measurements[at - 1]) < 0; at--) {
        head->measurements[at] = head->measurements[at - 1];
    }
    head->measurements[at] = *measurement;
}

static void remove_at(struct mh_head *head, uint16_t at)
{
    head->count--;
    memmove(&head->measurements[at], &head->measurements[at + 1],
            (size_t)(head->count - at) * sizeof head->measurements[0]);
}

enum mh_status mh_head_init(struct mh_head *head, const struct mh_head_config *config, mh_tick now)
{
    if (!head || !config || !config->tracker || !config->tracker_config || !config->tracker_state ||
        config->interval < 1 || config->interval > 3600000u || config->window >= config->interval ||
        config->tolerance > (config->interval - 1) / 2 || config->lateness > 3600000u) {
        return MH_ERR_ARGUMENT;
    }
    const enum mh_status status =
        config->tracker->init(config->tracker_state, config->tracker_config, config->interval);
    if (status != MH_OK) {
        return status;
    }
    head->config = config;
    head->own = 0;
    head->count = 0; /* the table stays as it is: it is large, and where heads take turns most motes never need it */
    head->tracking = false;
    head->counters = (struct mh_head_counters){0};
    head->instant = mh_tick_aligned(config->epoch, config->interval, now);
    return MH_OK;
}

/* `time`, or the instant within the tolerance of it. */
static mh_tick instant_near(const struct mh_head *head, mh_tick time)
{
    const mh_tick tolerance = head->config->tolerance;
    const mh_tick instant = mh_tick_aligned(head->instant, head->config->interval, time - tolerance);
    return instant - time + tolerance <= 2 * tolerance ? instant : time;
}

enum mh_status mh_head_measurement(struct mh_head *head, const struct mh_measurement *given)
{
    struct mh_measurement timed = *given;
    const struct mh_measurement *measurement = &timed;
    timed.time = instant_near(head, given->time);
    const int32_t interval = (int32_t)head->config->interval;
    const int32_t ahead = mh_ticks_between(head->instant, measurement->time);
    if (ahead <= -interval - (int32_t)head->config->lateness) {
        head->counters.late++;
        return MH_ERR_TIME;
    }
    if (ahead > interval) {
        head->counters.early++;
        return MH_ERR_TIME;
    }
    uint16_t least = 0;
    for (uint16_t i = 0; i < head->count; i++) {
        const struct mh_measurement *kept = &head->measurements[i];
        if (kept->node == measurement->node && kept->target == measurement->target &&
            instant_of(head, kept) == instant_of(head, measurement)) {
            head->counters.repeated++;
            return MH_ERR_REPEATED;
        }
        if (gives_way_before(head, kept, &head->measurements[least])) {
            least = i;
        }
    }
    head->counters.measurements++;
    head->counters.at_end += is_at_end(measurement->value) || is_at_end(measurement->increment);
    if (head->count < MH_REPORTS_MAX) {
        insert(head, measurement);
        return MH_OK;
    }
    head->counters.overflowed++;
    if (gives_way_before(head, &head->measurements[least], measurement)) {
        remove_at(head, least);
        insert(head, measurement);
    }
    return MH_ERR_CAPACITY;
}

mh_tick mh_head_deadline(const struct mh_head *head) { return head->instant + head->config->window; }

/* A function of its own: the estimate is not on the stack while the tracker works. */
static bool has_track(const struct mh_head *head)
{
    struct mh_estimate expected;
    return head->config->tracker->predict(head->config->tracker_state, head->instant, &expected) == MH_OK;
}

enum mh_status mh_head_step(struct mh_head *head, struct mh_estimate *estimate, uint16_t *used)
{
    uint16_t due = 0; /* the others are already of the next instant */
    while (due < head->count && !is_of_next(head, &head->measurements[due])) {
        due++;
    }
    const struct mh_tracker *tracker = head->config->tracker;
    void *state = head->config->tracker_state;
    const enum mh_status status = tracker->step(state, head->instant, head->measurements, due, estimate);
    head->counters.estimates += status == MH_OK;
    head->counters.saturated += status == MH_ERR_RANGE || status == MH_ERR_NOT_FINITE;
    head->tracking = has_track(head);
    *used = due;
    return status;
}

void mh_head_go_on(struct mh_head *head, uint16_t used)
{
    head->count = (uint16_t)(head->count - used);
    memmove(&head->measurements[0], &head->measurements[used], head->count * sizeof head->measurements[0]);
    head->instant += head->config->interval;
}

enum mh_status mh_head_close(struct mh_head *head, struct mh_estimate *estimate)
{
    uint16_t used;
    const enum mh_status status = mh_head_step(head, estimate, &used);
    mh_head_go_on(head, used);
    return status;
}
