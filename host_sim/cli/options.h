/* The words after a command: options `--name value`, `--name=value` or `--flag`, and operands. */
#ifndef MOTEHOUND_SIM_OPTIONS_H
#define MOTEHOUND_SIM_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct option_rule {
    const char *name; /* "--seed" */
    bool takes_value;
    bool repeats; /* may be given more than once */
};

struct option_reader {
    int argc;
    char **argv; /* without the program and the command */
    const struct option_rule *rules;
    size_t rule_count;
    int at;
    uint64_t seen; /* rules met, one bit each */
};

enum option_kind { OPTION_END, OPTION_NAMED, OPTION_OPERAND, OPTION_ERROR };

/* The next word: OPTION_NAMED with the rule's index in *rule and, where it takes one, its *value; OPTION_OPERAND with
 * *value; OPTION_ERROR with one line in `error`; OPTION_END. At most 64 rules. */
enum option_kind option_next(struct option_reader *reader, size_t *rule, const char **value, char *error,
                             size_t error_size);

/* A whole number minimum to maximum. Returns 0, or -1 with one line in `error` that names the option. */
int option_count(const char *name, const char *value, uint64_t minimum, uint64_t maximum, uint64_t *count, char *error,
                 size_t error_size);

/* A number from 0 to below 1. Returns as option_count. */
int option_share(const char *name, const char *value, double *share, char *error, size_t error_size);

#endif
