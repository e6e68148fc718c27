/* printf to the serial line of an AVR, 115200 baud; and where main ends the chip sleeps. Elsewhere there is nothing to do. */
#ifdef __AVR__
#include <avr/interrupt.h>
#include <avr/io.h>
#include <stdio.h>

static int put(char c, FILE *file)
{
    (void)file;
    while (!(UCSR0A & _BV(UDRE0))) {}
    UDR0 = (uint8_t)c;
    return 0;
}

static FILE serial = FDEV_SETUP_STREAM(put, NULL, _FDEV_SETUP_WRITE);

__attribute__((constructor)) static void begin(void)
{
    UBRR0 = F_CPU / 16 / 115200;
    UCSR0B = _BV(TXEN0);
    stdout = &serial;
}

__attribute__((naked, used, section(".fini1"))) static void end(void) { __asm__ volatile("cli\n\tsleep"); }
#else
typedef int nothing;
#endif
