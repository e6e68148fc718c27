/* The files of tests/known_answers, each by its path from there. A file that is not there fails the test that calls: it is part of the repository. */
#ifndef KNOWN_ANSWERS_H
#define KNOWN_ANSWERS_H

#include <stddef.h>
#include <stdio.h>

/* Open one to read; the caller closes it. */
FILE *open_answers(const char *name);

/* All floats of one; the caller frees them. The files are little-endian, as is every host that the simulator is built for. */
float *read_floats(const char *name, size_t *count);

/* The comma-separated numbers of one line, which is used up; returns how many, at most `capacity`. */
size_t read_numbers(char *line, double *values, size_t capacity);

#endif
