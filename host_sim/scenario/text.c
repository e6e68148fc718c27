#include "scenario/text.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define FILE_MAX ((off_t)1 << 30)

int fail(char *error, size_t size, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error, size, format, arguments);
    va_end(arguments);
    for (char *c = error; *c != '\0'; c++) {
        if (iscntrl((unsigned char)*c)) {
            *c = '?';
        }
    }
    return -1;
}

bool text_number(const char *text, size_t length, double *value)
{
    const char *end = text + length;
    while (text < end && isspace((unsigned char)*text)) {
        text++;
    }
    while (end > text && isspace((unsigned char)end[-1])) {
        end--;
    }
    for (const char *c = text; c < end; c++) {
        if (strchr("+-.0123456789eE", *c) == NULL || *c == '\0') {
            return false;
        }
    }
    char *stopped;
    const double number = strtod(text, &stopped);
    if (text == end || stopped != end || !isfinite(number)) {
        return false;
    }
    *value = number;
    return true;
}

char *text_read_file(const char *path, size_t *length, char *error, size_t error_size)
{
    struct stat status;
    FILE *file = fopen(path, "rb");
    if (file == NULL || fstat(fileno(file), &status) != 0 || S_ISDIR(status.st_mode)) {
        fail(error, error_size, "%s: cannot read: %s", path, file == NULL ? strerror(errno) : "it is a folder");
        if (file != NULL) {
            fclose(file);
        }
        return NULL;
    }
    /* by pieces, since a pipe has no size */
    size_t capacity = (size_t)(status.st_size > 0 && status.st_size <= FILE_MAX ? status.st_size : 0) + 4096;
    size_t used = 0;
    char *text = malloc(capacity);
    while (text != NULL && !feof(file) && !ferror(file) && used <= (size_t)FILE_MAX) {
        if (used + 1 >= capacity) {
            capacity *= 2;
            char *larger = realloc(text, capacity);
            if (larger == NULL) {
                free(text);
            }
            text = larger;
            continue;
        }
        used += fread(text + used, 1, capacity - used - 1, file);
    }
    const bool sound = text != NULL && !ferror(file) && used <= (size_t)FILE_MAX;
    fclose(file);
    if (!sound) {
        fail(error, error_size, "%s: cannot read: %s", path,
             used > (size_t)FILE_MAX ? "larger than 1 GiB" : (text == NULL ? "no memory" : "input error"));
        free(text);
        return NULL;
    }
    text[used] = '\0';
    *length = used;
    return text;
}
