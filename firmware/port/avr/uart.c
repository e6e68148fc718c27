/* UART 0 of an ATmega. */
#include "port.h"
#include "ring.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>

void port_uart_begin(void)
{
    UBRR0H = 0;
    UBRR0L = (uint8_t)((F_CPU + 8 * PORT_BAUD) / (16 * PORT_BAUD) - 1);
    UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
    UCSR0B = _BV(RXCIE0) | _BV(RXEN0) | _BV(TXEN0);
}

ISR(USART0_RX_vect) { ring_write(UDR0); }

int port_uart_get(void) { return ring_read(); }

void port_uart_put(uint8_t byte) { port_putc(byte); }

/* The instruction after sei is executed before any interrupt, so a byte cannot come in between unseen. */
void port_wait(void)
{
    set_sleep_mode(SLEEP_MODE_IDLE);
    cli();
    if (ring_count() == 0) {
        sleep_enable();
        sei();
        sleep_cpu();
        sleep_disable();
    }
    sei();
}
