/* UART of Arm's Cortex-M System Design Kit. */
#include "cortex-m.h"
#include "port.h"
#include "ring.h"

#define DATA REGISTER(UART_BASE + 0x0u)
#define STATE REGISTER(UART_BASE + 0x4u)
#define CONTROL REGISTER(UART_BASE + 0x8u)
#define CLEAR REGISTER(UART_BASE + 0xCu)
#define DIVISOR REGISTER(UART_BASE + 0x10u)
#define STATE_TX_FULL 1u
#define STATE_RX_FULL 2u
#define CONTROL_ON 0xBu /* transmitter, receiver, the receiver's interrupt */
#define CLEAR_RX 2u

void port_uart_begin(void)
{
    DIVISOR = PORT_HZ / PORT_BAUD;
    CONTROL = CONTROL_ON;
    enable_interrupt(UART_INTERRUPT);
}

void uart_interrupt(void)
{
    CLEAR = CLEAR_RX;
    while ((STATE & STATE_RX_FULL) && !ring_is_full()) {
        ring_write((uint8_t)DATA);
    }
}

/* The interrupt comes with each byte; one that found the ring full still waits in the UART. */
int port_uart_get(void)
{
    interrupts_off();
    int byte = ring_read();
    if (byte < 0 && (STATE & STATE_RX_FULL)) {
        byte = (uint8_t)DATA;
    }
    interrupts_on();
    return byte;
}

void port_uart_put(uint8_t byte)
{
    while (STATE & STATE_TX_FULL) {}
    DATA = byte;
}

/* wfi ends when an interrupt waits, even while it is off */
void port_wait(void)
{
    interrupts_off();
    if (ring_count() == 0) {
        __asm__ volatile("wfi");
    }
    interrupts_on();
}
