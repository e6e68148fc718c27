/* The watchdog of an nRF51, on its 32.768 kHz oscillator. Only a reset stops it. */
#include "cortex-m.h"
#include "port.h"

#define WATCHDOG(offset) REGISTER(0x40010000u + (offset))
#define TASK_START WATCHDOG(0x000)
#define RELOAD_VALUE WATCHDOG(0x504)
#define CONFIGURATION WATCHDOG(0x50C)
#define RELOAD_REQUEST WATCHDOG(0x600)
#define RESET_REASON REGISTER(0x40000400u)
#define BY_WATCHDOG (1u << 1)

void port_watchdog_start(void)
{
    RELOAD_VALUE = 2u * 32768u;
    CONFIGURATION = 1; /* it counts while the processor sleeps, not while a debugger has stopped it */
    TASK_START = 1;
}

void port_watchdog_stop(void) {}

void port_watchdog_feed(void) { RELOAD_REQUEST = 0x6E524635u; }

bool port_watchdog_fired(void)
{
    const bool fired = (RESET_REASON & BY_WATCHDOG) != 0;
    RESET_REASON = BY_WATCHDOG;
    return fired;
}
