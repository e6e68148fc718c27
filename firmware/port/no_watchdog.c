/* The watchdog of boards without one: the hook is there, and does nothing. A board with one has its own file instead (README.md). */
#include "port.h"

void port_watchdog_start(void) {}

void port_watchdog_stop(void) {}

void port_watchdog_feed(void) {}

bool port_watchdog_fired(void) { return false; }
