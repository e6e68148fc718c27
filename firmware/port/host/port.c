/* The host as a board: a program with standard output and an exit status. */
#include "port.h"

#include <stdio.h>
#include <stdlib.h>

void port_putc(int c) { putchar(c); }

void port_puts(const char *s) { fputs(s, stdout); }

void port_exit(int status) { exit(status); }

void port_stack_paint(void) {}

uint32_t port_stack_used(void) { return 0; }

uint32_t port_stack_deepest(void) { return 0; }

uint32_t port_static_ram(void) { return 0; }

uint32_t port_ram_size(void) { return 0; }

bool port_stack_intact(void) { return true; }

void port_fault(enum port_fault_cause cause, uint32_t address)
{
    (void)cause;
    (void)address;
    port_puts("processor fault\n");
    port_exit(PORT_FAULT);
}

void port_reset(void) { port_exit(PORT_FAULT); }
