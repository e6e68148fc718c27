/* Any Cortex-M: start-up in C, console and exit through semihosting (Arm, "Semihosting for AArch32 and AArch64").
 *
 * Under an emulator or a debugger, `bkpt 0xab` with an operation in r0 and its argument in r1 is a call to the host. On a board
 * that runs alone, replace semihost() by a UART. */
#include "port.h"

#define REGISTER(address) (*(volatile uint32_t *)(address))
#define CPACR REGISTER(0xE000ED88u) /* access to the coprocessors, of which 10 and 11 are the FPU */

/* from cortex-m.ld */
extern uint32_t __data_load[], __data_start[], __data_end[], __bss_start[], __bss_end[], __stack_top[];
extern uint8_t __stack_limit[];

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
#include "stack_paint.h"

static void fault(void)
{
    port_puts("processor fault\n");
    port_exit(PORT_FAULT);
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

/* The system exceptions of ARMv6-M and ARMv7-M; no interrupt is enabled. */
typedef void (*vector)(void);
__attribute__((section(".vectors"), used)) static const vector vectors[16] = {
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
    fault /* SysTick */,
};
