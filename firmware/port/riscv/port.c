/* RV32: start-up, console and exit through semihosting ("RISC-V Semihosting", the same operations as Arm's). */
#include "port.h"
#include "board.h"

/* -march=..._zicsr would select another C library, so the instructions that touch control registers are allowed here only */
__asm__(".option arch, +zicsr");

/* from the linker script */
extern uint8_t __stack_limit[], __stack_top[], __data_start[], end[], __ram_size[];

int main(void);

/* The three instructions mark an ebreak as a call to the host; they must be uncompressed and share a page. */
static void semihost(uint32_t operation, const void *argument)
{
    register uint32_t a0 __asm__("a0") = operation;
    register const void *a1 __asm__("a1") = argument;
    __asm__ volatile(".option push\n.option norvc\n.balign 16\n"
                     "slli x0, x0, 0x1f\n ebreak\n srai x0, x0, 7\n"
                     ".option pop"
                     : "+r"(a0)
                     : "r"(a1)
                     : "memory");
}

#include "semihosting.h"

#define STACK_POINTER() ((uint8_t *)__builtin_frame_address(0))
#define STACK_LIMIT __stack_limit
#define STACK_TOP __stack_top
#include "stack_paint.h"

uint32_t port_static_ram(void) { return (uint32_t)(end - __data_start); }

uint32_t port_ram_size(void) { return (uint32_t)__ram_size; }

__attribute__((weak)) void port_fault(enum port_fault_cause cause, uint32_t address)
{
    (void)cause;
    (void)address;
    port_puts("processor fault\n");
    port_exit(PORT_FAULT);
}

/* QEMU's test device ("sifive_test") */
void port_reset(void)
{
    *(volatile uint32_t *)0x100000u = 0x7777;
    for (;;) {}
}

__attribute__((used)) static void fault_of(const uint8_t *sp, uint32_t address)
{
    port_fault(sp < __stack_limit + 64 ? PORT_FAULT_STACK : PORT_FAULT_PROCESSOR, address);
}

/* What the drivers handle, in images that have them. */
static void unexpected(void) { port_fault(PORT_FAULT_PROCESSOR, 0); }
__attribute__((weak, alias("unexpected"))) void uart_interrupt(void);
__attribute__((weak, alias("unexpected"))) void timer_interrupt(void);

__attribute__((used, aligned(4), interrupt)) static void interrupt_of(void)
{
    uint32_t cause;
    __asm__ volatile("csrr %0, mcause" : "=r"(cause));
    if ((cause & 0xFF) == 7) {
        timer_interrupt();
    } else {
        uart_interrupt();
    }
}

/* An interrupt, or a fault: then the stack may be used up, so it begins anew. */
__attribute__((naked, used, aligned(4))) static void trap(void)
{
    __asm__ volatile("csrw mscratch, t0\n\t"
                     "csrr t0, mcause\n\t"
                     "bgez t0, 1f\n\t"
                     "csrr t0, mscratch\n\t"
                     "j interrupt_of\n\t"
                     "1: mv a0, sp\n\t"
                     "csrr a1, mepc\n\t"
                     "la sp, __stack_top\n\t"
                     "j fault_of");
}

__attribute__((naked, section(".init"), used)) void _start(void)
{
    __asm__ volatile(".option push\n.option norelax\n"
                     "la gp, __global_pointer$\n"
                     ".option pop\n"
                     "la sp, __stack_top\n"
                     "la t0, trap\n"
                     "csrw mtvec, t0\n"
                     /* the code, 2 MB from 0x80000000, may be read and run, not written: whoever tries faults */
                     "li t0, (0x80000000 | (0x200000 - 1)) >> 2 & ~(1 << 18)\n"
                     "csrw pmpaddr0, t0\n"
                     "li t0, 0x9D\n" /* locked, a power of two, run and read */
                     "csrw pmpcfg0, t0\n"
                     "la a0, __data_start\n"
                     "la a1, __data_end\n"
                     "la a2, __data_load\n"
                     "1: bgeu a0, a1, 2f\n"
                     "lw t0, 0(a2)\n"
                     "sw t0, 0(a0)\n"
                     "addi a0, a0, 4\n"
                     "addi a2, a2, 4\n"
                     "j 1b\n"
                     "2: la a0, __bss_start\n"
                     "la a1, __bss_end\n"
                     "3: bgeu a0, a1, 4f\n"
                     "sw zero, 0(a0)\n"
                     "addi a0, a0, 4\n"
                     "j 3b\n"
                     "4: call main\n"
                     "call port_exit\n");
}
