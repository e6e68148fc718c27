/* count_log FILE [api]: plays an LCM log, by the file provider as any LCM program would, or by the event log's own
 * functions, and prints how many messages came on each channel, and that their times never went backwards. */
#include "bus/bus.h"

#include <stdio.h>
#include <string.h>

enum { CHANNELS = 8 };
static const char *const channels[CHANNELS] = {BUS_RUN_BEGIN, BUS_NODE, BUS_TRUTH,  BUS_FRAME,
                                               BUS_TRACK,     BUS_MOTE, BUS_TOTALS, BUS_RUN_END};

static void count(const char *channel, long counts[CHANNELS + 1])
{
    int i = 0;
    while (i < CHANNELS && strcmp(channel, channels[i]) != 0) {
        i++;
    }
    counts[i]++; /* the last is for all others */
}

static void on_message(const lcm_recv_buf_t *buffer, const char *channel, void *counts)
{
    (void)buffer;
    count(channel, counts);
}

static int play(const char *path, long counts[CHANNELS + 1])
{
    char url[4200];
    snprintf(url, sizeof url, "file://%s?speed=0", path);
    lcm_t *lcm = lcm_create(url);
    if (lcm == NULL || lcm_subscribe(lcm, ".*", on_message, counts) == NULL) {
        return 1;
    }
    while (lcm_handle(lcm) == 0) {}
    lcm_destroy(lcm);
    return 0;
}

static int read_events(const char *path, long counts[CHANNELS + 1])
{
    lcm_eventlog_t *log = lcm_eventlog_create(path, "r");
    if (log == NULL) {
        return 1;
    }
    int64_t last = INT64_MIN;
    int status = 0;
    for (lcm_eventlog_event_t *event; (event = lcm_eventlog_read_next_event(log)) != NULL;) {
        status |= event->timestamp < last;
        last = event->timestamp;
        count(event->channel, counts);
        lcm_eventlog_free_event(event);
    }
    lcm_eventlog_destroy(log);
    return status;
}

int main(int argc, char **argv)
{
    long counts[CHANNELS + 1] = {0};
    if (argc < 2 || (argc > 2 ? read_events : play)(argv[1], counts) != 0) {
        return 1;
    }
    for (int i = 0; i < CHANNELS; i++) {
        printf("%s %ld\n", channels[i], counts[i]);
    }
    return 0;
}
