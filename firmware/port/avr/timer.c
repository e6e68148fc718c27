/* Timer 1 of an ATmega: counts the processor's clock and begins anew every 5 ms, with an interrupt. */
#include "port.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <util/atomic.h>

#define PERIOD_MS 5
#define PERIOD (F_CPU / (1000 / PERIOD_MS))
#if F_CPU % (1000 / PERIOD_MS) != 0 || PERIOD > 65536
#error "F_CPU must be a multiple of 200 Hz, at most 13.1 MHz: 5 ms are counted in 16 bits"
#endif

static volatile uint32_t periods;

ISR(TIMER1_COMPA_vect) { periods++; }

void port_timer_begin(void)
{
    OCR1A = (uint16_t)(PERIOD - 1);
    TCCR1A = 0;
    TCCR1B = _BV(WGM12) | _BV(CS10);
    TIMSK |= _BV(OCIE1A);
    sei();
}

/* Periods that are over, the one whose interrupt waits included, and cycles of the present one. */
static uint32_t read(uint16_t *cycles)
{
    uint32_t over;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        over = periods;
        *cycles = TCNT1;
        if (TIFR & _BV(OCF1A)) {
            over++;
            *cycles = TCNT1;
        }
    }
    return over;
}

uint32_t port_cycles(void)
{
    uint16_t cycles;
    const uint32_t over = read(&cycles);
    return over * PERIOD + cycles;
}

uint32_t port_cycles_per_s(void) { return F_CPU; }

uint32_t port_ticks(void)
{
    uint16_t cycles;
    const uint32_t over = read(&cycles);
    return over * PERIOD_MS + cycles / (uint16_t)((PERIOD + PERIOD_MS - 1) / PERIOD_MS);
}
