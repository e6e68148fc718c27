#include "known_answers.h"

#include "unity.h"

#include <stdlib.h>
#include <string.h>

FILE *open_answers(const char *name)
{
    char path[1024];
    snprintf(path, sizeof path, MOTEHOUND_KNOWN_ANSWERS "/%s", name);
    FILE *file = fopen(path, "rb");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, path);
    return file;
}

float *read_floats(const char *name, size_t *count)
{
    FILE *file = open_answers(name);
    fseek(file, 0, SEEK_END);
    *count = (size_t)ftell(file) / sizeof(float);
    rewind(file);
    float *values = malloc(*count * sizeof *values);
    TEST_ASSERT_NOT_NULL(values);
    TEST_ASSERT_EQUAL_size_t(*count, fread(values, sizeof *values, *count, file));
    fclose(file);
    return values;
}

size_t read_numbers(char *line, double *values, size_t capacity)
{
    size_t count = 0;
    for (char *field = strtok(line, ",\r\n"); field != NULL && count < capacity; field = strtok(NULL, ",\r\n")) {
        values[count++] = strtod(field, NULL);
    }
    return count;
}
