/* The host as a board that runs alone: the serial line is standard input and output, the clock is the system's. */
#define _POSIX_C_SOURCE 200809L
#include "fault.h"

#include <poll.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

void port_uart_begin(void) {}

static bool readable(int timeout_ms)
{
    struct pollfd line = {STDIN_FILENO, POLLIN, 0};
    return poll(&line, 1, timeout_ms) > 0;
}

/* The end of the input is the end of the image. */
int port_uart_get(void)
{
    uint8_t byte;
    if (!readable(0)) {
        return -1;
    }
    if (read(STDIN_FILENO, &byte, 1) != 1) {
        port_exit(0);
    }
    return byte;
}

void port_uart_put(uint8_t byte)
{
    if (write(STDOUT_FILENO, &byte, 1) != 1) {
        port_exit(1);
    }
}

void port_timer_begin(void) {}

static uint64_t nanoseconds(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (uint64_t)time.tv_sec * 1000000000u + (uint64_t)time.tv_nsec;
}

uint32_t port_cycles(void) { return (uint32_t)nanoseconds(); }

uint32_t port_cycles_per_s(void) { return 1000000000u; }

uint32_t port_ticks(void) { return (uint32_t)(nanoseconds() / 1000000u); }

void port_wait(void) { (void)readable(10); }

void port_watchdog_start(void) {}

void port_watchdog_stop(void) {}

void port_watchdog_feed(void) {}

bool port_watchdog_fired(void) { return false; }

void fault_begin(struct fault_record *record)
{
    const struct fault_record none = {PORT_FAULT_NONE, 0, 0};
    *record = none;
}
