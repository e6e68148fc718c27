/* What an image needs of the board it runs on, beside main(). One port.c a board family gives it; README.md beside this file
 * says how to add one.
 *
 * The library itself needs none of this: it is for images that run alone, as the unit tests and the benchmarks do. Each port
 * also has the start-up code (memory set up, then main(), then port_exit() with what main returned) and a handler that
 * turns a fault into port_exit(PORT_FAULT). */
#ifndef PORT_H
#define PORT_H

#include <stdint.h>

#define PORT_FAULT 99 /* exit status of an image that ran into a processor fault */

/* Write one character, or a string, to the board's console. */
void port_putc(int c);
void port_puts(const char *s);

/* End the image with an exit status of 0 to 255, which the emulator passes on. Never returns. */
void port_exit(int status);

/* Fill the free stack with a pattern, and later tell how many bytes below the caller's frame have been written since: the depth of
 * stack, interrupts included, that the calls in between have needed. On the host 0. */
void port_stack_paint(void);
uint32_t port_stack_used(void);

#endif
