/* Timer 0 of an nRF51, which has no SysTick: counts the processor's clock in 32 bits, with an interrupt every 10 ms. */
#include "cortex-m.h"
#include "port.h"

#define TIMER(offset) REGISTER(0x40008000u + (offset))
#define TASK_START TIMER(0x000)
#define TASK_CAPTURE TIMER(0x040) /* into CAPTURED */
#define COMPARED TIMER(0x144)
#define INTERRUPTS TIMER(0x304)
#define WIDTH TIMER(0x508)
#define PRESCALER TIMER(0x510)
#define CAPTURED TIMER(0x540)
#define COMPARE TIMER(0x544)
#define INTERRUPT_COMPARED (1u << 17)
#define WIDTH_32 3u

#define PERIOD_MS 10u
#define CYCLES_PER_MS (PORT_HZ / 1000u)
#define PERIOD (CYCLES_PER_MS * PERIOD_MS)

static volatile uint32_t began, milliseconds; /* the present period: counter and clock */

void timer_interrupt(void)
{
    COMPARED = 0;
    began += PERIOD;
    milliseconds += PERIOD_MS;
    COMPARE = began + PERIOD;
}

void port_timer_begin(void)
{
    WIDTH = WIDTH_32;
    PRESCALER = 0;
    COMPARE = PERIOD;
    INTERRUPTS = INTERRUPT_COMPARED;
    TASK_START = 1;
    enable_interrupt(TIMER_INTERRUPT);
    interrupts_on();
}

uint32_t port_cycles(void)
{
    TASK_CAPTURE = 1;
    return CAPTURED;
}

uint32_t port_cycles_per_s(void) { return PORT_HZ; }

uint32_t port_ticks(void)
{
    interrupts_off();
    const uint32_t ticks = milliseconds + (port_cycles() - began) / CYCLES_PER_MS;
    interrupts_on();
    return ticks;
}
