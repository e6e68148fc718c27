/* Text and numbers on the board's serial line, without stdio. On AVR texts stay in flash. */
#ifndef CONSOLE_H
#define CONSOLE_H

#include "port.h"

#ifdef __AVR__
#include <avr/pgmspace.h>
#define TEXT_BYTE(at) pgm_read_byte(at)
#define put_text(text) put_stored(PSTR(text))
#else
#define TEXT_BYTE(at) (*(at))
#define put_text(text) put_stored(text)
#endif

static inline void put_stored(const char *text)
{
    for (char c; (c = (char)TEXT_BYTE(text)) != '\0'; text++) {
        port_uart_put((uint8_t)c);
    }
}

/* A text in RAM. */
static inline void put_name(const char *name)
{
    for (; *name; name++) {
        port_uart_put((uint8_t)*name);
    }
}

static inline void put_number(int32_t number)
{
    uint32_t rest = number < 0 ? 0u - (uint32_t)number : (uint32_t)number;
    uint8_t digits[10], count = 0;
    do {
        digits[count++] = (uint8_t)('0' + rest % 10);
        rest /= 10;
    } while (rest > 0);
    if (number < 0) {
        port_uart_put('-');
    }
    while (count > 0) {
        port_uart_put(digits[--count]);
    }
}

#endif
