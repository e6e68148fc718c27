/* Registers of QEMU's `virt`, and the functions that handle its interrupts. */
#ifndef BOARD_H
#define BOARD_H

#include <stdint.h>

#define REGISTER(address) (*(volatile uint32_t *)(address))
#define MIE_TIMER (1u << 7)
#define MIE_EXTERNAL (1u << 11)
#define MSTATUS_MIE (1u << 3)

void uart_interrupt(void);
void timer_interrupt(void);

#endif
