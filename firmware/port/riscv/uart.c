/* UART 0 of QEMU's `virt`, a 16550, and its way through the PLIC. */
#include "board.h"
#include "port.h"
#include "ring.h"

__asm__(".option arch, +zicsr");

#define UART(offset) (*(volatile uint8_t *)(0x10000000u + (offset)))
#define DATA UART(0)
#define INTERRUPTS UART(1)
#define FIFO UART(2)
#define LINE UART(3)
#define STATUS UART(5)
#define STATUS_RECEIVED 1u
#define STATUS_TX_EMPTY 0x20u
#define UART_INTERRUPT 10u

#define PLIC(offset) REGISTER(0x0C000000u + (offset))
#define PRIORITY PLIC(4u * UART_INTERRUPT)
#define ENABLE PLIC(0x2000u)
#define THRESHOLD PLIC(0x200000u)
#define CLAIM PLIC(0x200004u)

void port_uart_begin(void)
{
    LINE = 3; /* 8 bits; QEMU has no baud rate */
    FIFO = 1;
    INTERRUPTS = 1;
    PRIORITY = 1;
    ENABLE = 1u << UART_INTERRUPT;
    THRESHOLD = 0;
    __asm__ volatile("csrs mie, %0" ::"r"(MIE_EXTERNAL));
}

void uart_interrupt(void)
{
    const uint32_t source = CLAIM;
    while ((STATUS & STATUS_RECEIVED) && !ring_is_full()) {
        ring_write(DATA);
    }
    INTERRUPTS = (STATUS & STATUS_RECEIVED) == 0; /* else it waits in the UART */
    CLAIM = source;
}

int port_uart_get(void)
{
    const int byte = ring_read();
    INTERRUPTS = 1;
    return byte;
}

void port_uart_put(uint8_t byte)
{
    while (!(STATUS & STATUS_TX_EMPTY)) {}
    DATA = byte;
}

/* wfi ends when an interrupt waits, even while it is off */
void port_wait(void)
{
    __asm__ volatile("csrc mstatus, %0" ::"r"(MSTATUS_MIE) : "memory");
    if (ring_count() == 0) {
        __asm__ volatile("wfi");
    }
    __asm__ volatile("csrs mstatus, %0" ::"r"(MSTATUS_MIE) : "memory");
}
