#include "hosts/host.h"

#include <stdlib.h>
#include <string.h>

enum { MICROSECONDS_PER_TICK = SIM_TIME_PER_S / MH_TICKS_PER_S };

sim_time host_alarm_time(const struct local_clock *clock, sim_time now, mh_tick tick)
{
    const int64_t time = local_clock_time_of(clock, now, tick);
    return time < (int64_t)now ? now : (sim_time)time;
}

double host_clock_error_s(mh_tick shown, uint8_t fraction, sim_time now)
{
    const sim_time ticks = now / MICROSECONDS_PER_TICK;
    const double shown_ms = mh_ticks_between((mh_tick)ticks, shown) + fraction / 256.0;
    return (shown_ms * MICROSECONDS_PER_TICK - (double)(now - ticks * MICROSECONDS_PER_TICK)) / SIM_TIME_PER_S;
}

struct host_action *host_actions_add(struct host_actions *actions)
{
    if (actions->count == actions->capacity) {
        const size_t capacity = actions->capacity ? 2 * actions->capacity : 64;
        struct host_action *list = realloc(actions->list, capacity * sizeof *list);
        if (!list) {
            return NULL;
        }
        actions->list = list;
        actions->capacity = capacity;
    }
    return &actions->list[actions->count++];
}

static bool before(const struct host_action *a, const struct host_action *b)
{
    return a->time != b->time ? a->time < b->time : a->mote < b->mote;
}

/* Merge the sorted runs [from, middle) and [middle, to) into `into`; of equals those of the first come first. */
static void merge(const struct host_action *list, size_t from, size_t middle, size_t to, struct host_action *into)
{
    size_t left = from, right = middle;
    for (size_t i = from; i < to; i++) {
        into[i] = left < middle && (right >= to || !before(&list[right], &list[left])) ? list[left++] : list[right++];
    }
}

static bool is_sorted(const struct host_actions *actions)
{
    for (size_t i = 1; i < actions->count; i++) {
        if (before(&actions->list[i], &actions->list[i - 1])) {
            return false;
        }
    }
    return true;
}

/* Merge sort from the bottom up; hosts hand most windows over in order. */
int host_actions_sort(struct host_actions *actions)
{
    const size_t count = actions->count;
    if (is_sorted(actions)) {
        return 0;
    }
    struct host_action *other = malloc(actions->capacity * sizeof *other);
    if (!other) {
        return -1;
    }
    for (size_t width = 1; width < count; width *= 2) {
        for (size_t from = 0; from < count; from += 2 * width) {
            const size_t middle = from + width < count ? from + width : count;
            const size_t to = middle + width < count ? middle + width : count;
            merge(actions->list, from, middle, to, other);
        }
        struct host_action *merged = other;
        other = actions->list;
        actions->list = merged;
    }
    free(other);
    return 0;
}

void host_actions_free(struct host_actions *actions)
{
    free(actions->list);
    *actions = (struct host_actions){0};
}

/* Counters are nothing but 32-bit numbers. */
static void add(void *to, const void *from, size_t size)
{
    for (size_t i = 0; i < size / sizeof(uint32_t); i++) {
        ((uint32_t *)to)[i] += ((const uint32_t *)from)[i];
    }
}

void host_totals_add(struct host_totals *totals, const struct mh_mote_counters *motes,
                     const struct mh_head_counters *heads, const struct mh_protocol_counters *protocols)
{
    add(&totals->motes, motes, sizeof *motes);
    add(&totals->heads, heads, sizeof *heads);
    add(&totals->protocols, protocols, sizeof *protocols);
}
