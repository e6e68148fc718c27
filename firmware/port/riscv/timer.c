/* The machine timer of QEMU's `virt`, 10 MHz, with an interrupt every 10 ms; and the counter of instructions. */
#include "board.h"
#include "port.h"

__asm__(".option arch, +zicsr");

#define TIME_LOW REGISTER(0x0200BFF8u)
#define TIME_HIGH REGISTER(0x0200BFFCu)
#define COMPARE_LOW REGISTER(0x02004000u)
#define COMPARE_HIGH REGISTER(0x02004004u)
#define TIMER_HZ 10000000u
#define PERIOD (TIMER_HZ / 100u)

static uint64_t began, next;

static uint64_t now(void)
{
    uint32_t high, low;
    do {
        high = TIME_HIGH;
        low = TIME_LOW;
    } while (high != TIME_HIGH);
    return (uint64_t)high << 32 | low;
}

/* The upper half first is as late as can be, so that no earlier time is seen in between. */
static void set_next(void)
{
    next += PERIOD;
    COMPARE_HIGH = UINT32_MAX;
    COMPARE_LOW = (uint32_t)next;
    COMPARE_HIGH = (uint32_t)(next >> 32);
}

void timer_interrupt(void) { set_next(); }

void port_timer_begin(void)
{
    began = now();
    next = began;
    set_next();
    __asm__ volatile("csrs mie, %0" ::"r"(MIE_TIMER));
    __asm__ volatile("csrs mstatus, %0" ::"r"(MSTATUS_MIE) : "memory");
}

uint32_t port_cycles(void)
{
    uint32_t count;
    __asm__ volatile("csrr %0, minstret" : "=r"(count));
    return count;
}

/* QEMU counts a nanosecond of its time for one. */
uint32_t port_cycles_per_s(void) { return 1000000000u; }

uint32_t port_ticks(void) { return (uint32_t)((now() - began) / (TIMER_HZ / 1000u)); }
