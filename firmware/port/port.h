/* What an image needs of the board it runs on, beside main(). README.md beside this file says how to add a board.
 *
 * The library itself needs none of this: a product links libmotehound.a, gives it struct mh_port (mote.h), and keeps its own start-up code and
 * drivers. */
#ifndef PORT_H
#define PORT_H

#include <stdbool.h>
#include <stdint.h>

/* ---- every image: start-up, console, end ----
 *
 * FAMILY/port.c. It has the start-up code besides: memory set up, then main(), then port_exit() with what main returned; and a handler that turns a fault
 * into port_fault(). */

#define PORT_FAULT 99 /* exit status of an image that ran into a fault */

/* Write one character, or a string, to the console of unit tests: where the emulator shows it. */
void port_putc(int c);
void port_puts(const char *s);

/* End the image with an exit status of 0 to 255, which the emulator passes on. Never returns. */
void port_exit(int status);

/* ---- the stack ----
 *
 * FAMILY/port.c with stack_paint.h. On the host all of it is 0, and intact. */

/* Fill the free stack with a pattern, and later tell how many bytes below the caller's frame have been written since: the depth of
 * stack, interrupts included, that the calls in between have needed. */
void port_stack_paint(void);
uint32_t port_stack_used(void);

/* The same from the top of the stack: what the image has needed in all since the stack was painted; what variables take, without the
 * stack; and all RAM that there is. */
uint32_t port_stack_deepest(void);
uint32_t port_static_ram(void);
uint32_t port_ram_size(void);

/* The guard: false once the stack has come down to its lowest word. Where the stack ends at memory that cannot be written (Cortex-M, RV32), overflowing is a
 * fault besides. */
bool port_stack_intact(void);

/* ---- faults ----
 *
 * port_fault() is called by the handlers and by who finds something wrong. What an image that links fault.c does then is in fault.h; any other says "processor
 * fault" and ends with PORT_FAULT. Never returns. */
enum port_fault_cause {
    PORT_FAULT_NONE,
    PORT_FAULT_PROCESSOR, /* an illegal access or instruction, an interrupt that nobody asked for */
    PORT_FAULT_STACK,     /* overflown */
    PORT_FAULT_WATCHDOG,  /* found at the start: nobody fed it */
    PORT_FAULT_PROGRAM    /* what the program itself has found */
};
void port_fault(enum port_fault_cause cause, uint32_t address);

/* Start the image anew, as if by its reset line: variables in .noinit are kept. Never returns. */
void port_reset(void);

/* ---- the serial line ----
 *
 * FAMILY/uart*.c: UART 0, PORT_BAUD, 8 data bits, no parity, one stop bit. */
#ifndef PORT_BAUD
#define PORT_BAUD 57600ul
#endif

/* Switch it on: from now bytes are received into a ring of PORT_RING bytes by interrupt. What finds it full waits in the UART, which may lose it. */
void port_uart_begin(void);

/* The oldest byte received that was not taken yet, or -1 if there is none. */
int port_uart_get(void);

/* Send one byte; waits until the line takes it. */
void port_uart_put(uint8_t byte);

/* ---- time ----
 *
 * FAMILY/timer*.c. */

/* Switch on the timer and interrupts. */
void port_timer_begin(void);

/* A counter of the processor's clock, on RV32 of instructions; wraps. Differences of it tell what code has cost. And how much it counts in a second. */
uint32_t port_cycles(void);
uint32_t port_cycles_per_s(void);

/* Milliseconds since port_timer_begin(); wraps. */
uint32_t port_ticks(void);

/* Sleep until an interrupt, unless a byte has been received that waits. Returns after at most 10 ms, because of the timer. */
void port_wait(void);

/* ---- the watchdog ----
 *
 * FAMILY/watchdog*.c. Once started it resets the board when it is not fed for about two seconds. A board without one has empty functions. */
void port_watchdog_start(void);
void port_watchdog_stop(void); /* where that is possible: not on an nRF51 */
void port_watchdog_feed(void);
/* True if the last reset was the watchdog's; asked once. */
bool port_watchdog_fired(void);

#endif
