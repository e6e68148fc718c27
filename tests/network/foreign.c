/* Messages on the workers' channels that no worker can use, until it is ended: of no type, cut short, with lengths that lie, of another
 * session. */
#include "hosts/worker_wire.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

static void publish(lcm_t *lcm, const char *channel, const uint8_t *bytes, size_t size)
{
    uint8_t spoilt[2000];
    lcm_publish(lcm, channel, "what is this", 12);
    lcm_publish(lcm, channel, bytes, (unsigned)size);
    lcm_publish(lcm, channel, bytes, (unsigned)size / 2);
    for (size_t at = 8; at < size && size < sizeof spoilt; at += 7) {
        memcpy(spoilt, bytes, size);
        spoilt[at] ^= 0xFF;
        lcm_publish(lcm, channel, spoilt, (unsigned)size);
    }
}

int main(int argc, char **argv)
{
    static char text[] = "stranger";
    const struct timespec pause = {.tv_nsec = 5000000};
    struct worker_link link;
    char error[300];
    if (argc < 2 || worker_link_open(&link, argv[1], 0, error, sizeof error) != 0) {
        puts("foreign URL");
        return 1;
    }
    motehound_worker_action_t action = {.kind = HOST_TRANSMIT, .length = 4, .frame = (uint8_t *)text};
    const motehound_worker_done_t done = {.session = 1, .worker = 2, .number = 3, .count = 1, .actions = &action};
    const motehound_worker_join_t join = {1, 2, text, text, text};
    const motehound_worker_call_t call = {1, 5, text, text};
    const motehound_worker_error_t failure = {1, 2, text};
    size_t done_size, join_size, call_size, error_size;
    uint8_t *done_bytes = worker_encode_done(&done, &done_size), *join_bytes = worker_encode_join(&join, &join_size);
    uint8_t *call_bytes = worker_encode_call(&call, &call_size),
            *error_bytes = worker_encode_error(&failure, &error_size);
    for (;;) {
        publish(link.lcm, WORKER_DONE, done_bytes, done_size);
        publish(link.lcm, WORKER_TOTALS, done_bytes, done_size);
        publish(link.lcm, WORKER_JOIN, join_bytes, join_size);
        publish(link.lcm, WORKER_CALL, call_bytes, call_size);
        publish(link.lcm, WORKER_ERROR, error_bytes, error_size);
        nanosleep(&pause, NULL);
    }
}
