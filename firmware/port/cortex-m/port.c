/* Any Cortex-M: start-up in C, console and exit through semihosting (Arm, "Semihosting for AArch32 and AArch64").
 *
 * Under an emulator or a debugger, `bkpt 0xab` with an operation in r0 and its argument in r1 is a call to the host. On a board
 * that runs alone nobody answers: an image for such a board uses the serial line (port.h). */
#include "port.h"
#include "cortex-m.h"

/* from cortex-m.ld */
extern uint32_t __data_load[], __data_start[], __data_end[], __bss_start[], __bss_end[], __stack_top[];
extern uint8_t __stack_limit[], end[], __ram_size[];

int main(void);

static void semihost(uint32_t operation, const void *argument)
{
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory", "cc");
}

#include "semihosting.h"

#define STACK_POINTER() ((uint8_t *)__builtin_frame_address(0))
#define STACK_LIMIT __stack_limit
#define STACK_TOP ((uint8_t *)__stack_top)
#include "stack_paint.h"

uint32_t port_static_ram(void) { return (uint32_t)(end - (uint8_t *)__data_start); }

uint32_t port_ram_size(void) { return (uint32_t)__ram_size; }

__attribute__((weak)) void port_fault(enum port_fault_cause cause, uint32_t address)
{
    (void)cause;
    (void)address;
    port_puts("processor fault\n");
    port_exit(PORT_FAULT);
}

void port_reset(void)
{
    AIRCR = 0x05FA0004u;
    for (;;) {}
}

/* `frame` is what the processor has put on the stack: r0 to r3, r12, lr, pc, psr; or would have, had the stack not come to its end. */
__attribute__((used)) static void fault_of(const uint32_t *frame)
{
    const bool inside = (const uint8_t *)frame >= __stack_limit && frame + 8 <= __stack_top;
    port_fault(inside ? PORT_FAULT_PROCESSOR : PORT_FAULT_STACK, inside ? frame[6] : 0);
}

/* The stack may be used up, so it begins anew. */
__attribute__((naked)) static void fault(void)
{
    __asm__ volatile("mov r0, sp\n\t"
                     "ldr r1, =__stack_top\n\t"
                     "mov sp, r1\n\t"
                     "ldr r1, =fault_of\n\t"
                     "bx r1\n\t"
                     ".pool");
}

__attribute__((noreturn)) void reset_handler(void)
{
#if defined(__ARM_FP)
    CPACR |= 0xFu << 20;
    __asm__ volatile("dsb\n\tisb" ::: "memory");
#endif
    const uint32_t *source = __data_load;
    for (uint32_t *word = __data_start; word < __data_end; word++) {
        *word = *source++;
    }
    for (uint32_t *word = __bss_start; word < __bss_end; word++) {
        *word = 0;
    }
    port_exit(main());
    for (;;) {}
}

/* What the drivers handle, in images that have them. */
__attribute__((weak, alias("fault"))) void uart_interrupt(void);
__attribute__((weak, alias("fault"))) void timer_interrupt(void);

/* The system exceptions of ARMv6-M and ARMv7-M, then interrupts; those left out are never enabled. */
typedef void (*vector)(void);
__attribute__((section(".vectors"), used)) static const vector vectors[] = {
    (vector)__stack_top,
    reset_handler,
    fault /* NMI */,
    fault /* hard fault */,
    fault /* memory */,
    fault /* bus */,
    fault /* usage */,
    0,
    0,
    0,
    0,
    fault /* SVC */,
    fault /* debug */,
    0,
    fault /* PendSV */,
#ifdef TIMER_INTERRUPT
    fault /* SysTick */,
    [16 + TIMER_INTERRUPT] = timer_interrupt,
#else
    timer_interrupt /* SysTick */,
#endif
    [16 + UART_INTERRUPT] = uart_interrupt,
};
