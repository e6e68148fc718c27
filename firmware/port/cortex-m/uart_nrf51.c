/* UART of an nRF51. */
#include "cortex-m.h"
#include "port.h"
#include "ring.h"

#define UART(offset) REGISTER(0x40002000u + (offset))
#define TASK_START_RX UART(0x000)
#define TASK_START_TX UART(0x008)
#define RECEIVED UART(0x108)
#define SENT UART(0x11C)
#define INTERRUPTS UART(0x304)
#define ENABLE UART(0x500)
#define TX_PIN UART(0x50C)
#define RX_PIN UART(0x514)
#define RX_DATA UART(0x518)
#define TX_DATA UART(0x51C)
#define BAUD UART(0x524)
#define INTERRUPT_RECEIVED (1u << 2)

void port_uart_begin(void)
{
    TX_PIN = UART_TX_PIN;
    RX_PIN = UART_RX_PIN;
    BAUD = (uint32_t)(((uint64_t)PORT_BAUD << 32) / PORT_HZ + 0x800u) & 0xFFFFF000u;
    ENABLE = 4;
    INTERRUPTS = INTERRUPT_RECEIVED;
    TASK_START_RX = 1;
    TASK_START_TX = 1;
    enable_interrupt(UART_INTERRUPT);
}

void uart_interrupt(void)
{
    while (RECEIVED && !ring_is_full()) {
        RECEIVED = 0;
        ring_write((uint8_t)RX_DATA);
    }
    if (RECEIVED) { /* it waits in the UART */
        disable_interrupt(UART_INTERRUPT);
    }
}

int port_uart_get(void)
{
    const int byte = ring_read();
    enable_interrupt(UART_INTERRUPT);
    return byte;
}

void port_uart_put(uint8_t byte)
{
    SENT = 0;
    TX_DATA = byte;
    while (!SENT) {}
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
