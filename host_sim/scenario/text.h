/* Text in: numbers, whole files, and one-line errors. */
#ifndef MOTEHOUND_SIM_TEXT_H
#define MOTEHOUND_SIM_TEXT_H

#include <stdbool.h>
#include <stddef.h>

/* Write one line into error[0 .. size) and return -1, so that `return fail(...)` reads as what it is. Control
 * characters of the arguments become '?': an error stays one line whatever a file holds. */
int fail(char *error, size_t size, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* The whole of text[0 .. length) as a finite decimal number: no NaN, infinity, hexadecimal or trailing characters;
 * spaces around it are allowed. text[length] must be readable and no part of a number. */
bool text_number(const char *text, size_t length, double *value);

/* The file's bytes with a zero byte behind them; to be freed. Returns NULL with one line in `error` (at most 1 GiB). */
char *text_read_file(const char *path, size_t *length, char *error, size_t error_size);

#endif
