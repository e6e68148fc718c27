/* SysTick on the processor's clock: begins anew every 10 ms, with an exception. */
#include "cortex-m.h"
#include "port.h"

#define PERIOD_MS 10u
#define PERIOD (PORT_HZ / 1000u * PERIOD_MS)
#define SYSTICK_ON 7u /* counting, with its exception, by the processor's clock */
#define SYSTICK_WAITS (1u << 26)

static volatile uint32_t periods;

void timer_interrupt(void) { periods++; }

void port_timer_begin(void)
{
    SYST_RVR = PERIOD - 1u;
    SYST_CVR = 0;
    SYST_CSR = SYSTICK_ON;
    interrupts_on();
}

/* Periods that are over, the one whose exception waits included, and cycles of the present one. */
static uint32_t read(uint32_t *cycles)
{
    interrupts_off();
    uint32_t over = periods, left = SYST_CVR;
    if (ICSR & SYSTICK_WAITS) {
        over++;
        left = SYST_CVR;
    }
    interrupts_on();
    *cycles = PERIOD - 1u - left;
    return over;
}

uint32_t port_cycles(void)
{
    uint32_t cycles;
    const uint32_t over = read(&cycles);
    return over * PERIOD + cycles;
}

uint32_t port_cycles_per_s(void) { return PORT_HZ; }

uint32_t port_ticks(void)
{
    uint32_t cycles;
    const uint32_t over = read(&cycles);
    return over * PERIOD_MS + cycles / (PORT_HZ / 1000u);
}
