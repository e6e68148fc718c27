/* AVR with a UART0: console by polling, start-up from avr-libc.
 *
 * "sleep" with interrupts off never ends on the chip, and is where simavr stops; the exit status is in r24. */
#include "port.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/wdt.h>

void port_putc(int c)
{
    UCSR0B |= _BV(TXEN0);
    while (!(UCSR0A & _BV(UDRE0))) {}
    UDR0 = (uint8_t)c;
}

void port_puts(const char *s)
{
    while (*s) {
        port_putc(*s++);
    }
}

void port_exit(int status)
{
    cli();
    for (;;) {
        __asm__ volatile("mov r24, %A0\n\tsleep" ::"r"(status) : "r24");
    }
}

extern uint8_t __heap_start[]; /* the end of the variables; there is no heap */

#define STACK_POINTER() ((uint8_t *)SP)
#define STACK_LIMIT __heap_start
#define STACK_TOP ((uint8_t *)RAMEND + 1)
#include "stack_paint.h"

uint32_t port_static_ram(void) { return (uint16_t)(__heap_start - (uint8_t *)RAMSTART); }

uint32_t port_ram_size(void) { return RAMEND + 1u - RAMSTART; }

__attribute__((weak)) void port_fault(enum port_fault_cause cause, uint32_t address)
{
    (void)cause;
    (void)address;
    port_puts("processor fault\n");
    port_exit(PORT_FAULT);
}

void port_reset(void)
{
    cli();
    wdt_enable(WDTO_15MS);
    for (;;) {}
}

/* avr-libc's exit(), which main() returns to with its result in r24, ends by running the code in the .fini sections */
__attribute__((naked, used, section(".fini1"))) static void end_of_main(void) { __asm__ volatile("cli\n\tsleep"); }

/* an interrupt that nobody asked for */
ISR(BADISR_vect) { port_fault(PORT_FAULT_PROCESSOR, 0); }
