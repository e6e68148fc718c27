/* RV32: start-up, console and exit through semihosting ("RISC-V Semihosting", the same operations as Arm's). */
#include "port.h"

/* -march=..._zicsr would select another C library, so the instructions that touch control registers are allowed here only */
__asm__(".option arch, +zicsr");

extern uint8_t __stack_limit[]; /* from the linker script */

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
#include "stack_paint.h"

__attribute__((used, aligned(4), interrupt)) void trap(void)
{
    port_puts("processor fault\n");
    port_exit(PORT_FAULT);
}

__attribute__((naked, section(".init"), used)) void _start(void)
{
    __asm__ volatile(".option push\n.option norelax\n"
                     "la gp, __global_pointer$\n"
                     ".option pop\n"
                     "la sp, __stack_top\n"
                     "la t0, trap\n"
                     "csrw mtvec, t0\n"
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
