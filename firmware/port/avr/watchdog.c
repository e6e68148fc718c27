/* The watchdog of an ATmega, on its own oscillator. */
#include "port.h"

#include <avr/io.h>
#include <avr/wdt.h>

void port_watchdog_start(void) { wdt_enable(WDTO_2S); }

void port_watchdog_stop(void) { wdt_disable(); }

void port_watchdog_feed(void) { wdt_reset(); }

bool port_watchdog_fired(void)
{
    const bool fired = (MCUCSR & _BV(WDRF)) != 0;
    MCUCSR = 0;
    wdt_disable(); /* on some chips it goes on after it has fired */
    return fired;
}
