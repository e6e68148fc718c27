/* Numbers on the board's console, without stdio. */
#ifndef CONSOLE_H
#define CONSOLE_H

#include "port.h"

#include <stddef.h>
#include <stdint.h>

static inline void put_number(int32_t number)
{
    uint32_t rest = number < 0 ? 0u - (uint32_t)number : (uint32_t)number;
    char digits[12];
    size_t at = sizeof digits;
    digits[--at] = '\0';
    do {
        digits[--at] = (char)('0' + rest % 10);
        rest /= 10;
    } while (rest > 0);
    if (number < 0) {
        digits[--at] = '-';
    }
    port_puts(&digits[at]);
}

static inline void put_named(const char *name, int32_t number)
{
    port_puts(name);
    put_number(number);
}

#endif
