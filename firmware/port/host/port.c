/* The host as a board: a program with standard output and an exit status. */
#include "port.h"

#include <stdio.h>
#include <stdlib.h>

void port_putc(int c) { putchar(c); }

void port_puts(const char *s) { fputs(s, stdout); }

void port_exit(int status) { exit(status); }

void port_stack_paint(void) {}

uint32_t port_stack_used(void) { return 0; }
