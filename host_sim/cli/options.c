#include "cli/options.h"

#include "scenario/text.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum option_kind option_next(struct option_reader *reader, size_t *rule, const char **value, char *error,
                             size_t error_size)
{
    if (reader->at >= reader->argc) {
        return OPTION_END;
    }
    const char *word = reader->argv[reader->at++];
    *value = word;
    if (word[0] != '-' || word[1] == '\0') {
        return OPTION_OPERAND;
    }
    const char *equals = strchr(word, '=');
    const size_t length = equals != NULL ? (size_t)(equals - word) : strlen(word);
    size_t i = 0;
    while (i < reader->rule_count &&
           (strlen(reader->rules[i].name) != length || strncmp(reader->rules[i].name, word, length) != 0)) {
        i++;
    }
    if (i == reader->rule_count) {
        fail(error, error_size, "motehound: unknown option '%.100s', expected one that --help lists", word);
        return OPTION_ERROR;
    }
    const struct option_rule *found = &reader->rules[i];
    if ((reader->seen >> i & 1) != 0 && !found->repeats) {
        fail(error, error_size, "motehound: %s: expected once, found twice", found->name);
        return OPTION_ERROR;
    }
    reader->seen |= (uint64_t)1 << i;
    *rule = i;
    *value = NULL;
    if (!found->takes_value) {
        if (equals != NULL) {
            fail(error, error_size, "motehound: %s: expected no value, found '%.100s'", found->name, equals + 1);
            return OPTION_ERROR;
        }
        return OPTION_NAMED;
    }
    if (equals == NULL && reader->at >= reader->argc) {
        fail(error, error_size, "motehound: %s: expected a value, found nothing", found->name);
        return OPTION_ERROR;
    }
    *value = equals != NULL ? equals + 1 : reader->argv[reader->at++];
    return OPTION_NAMED;
}

int option_count(const char *name, const char *value, uint64_t minimum, uint64_t maximum, uint64_t *count, char *error,
                 size_t error_size)
{
    char *end = NULL;
    errno = 0;
    const unsigned long long number = value[0] >= '0' && value[0] <= '9' ? strtoull(value, &end, 10) : 0;
    if (end == NULL || *end != '\0' || errno != 0 || number < minimum || number > maximum) {
        return fail(error, error_size, "motehound: %s: expected a whole number %llu to %llu, found '%.60s'", name,
                    (unsigned long long)minimum, (unsigned long long)maximum, value);
    }
    *count = number;
    return 0;
}

int option_share(const char *name, const char *value, double *share, char *error, size_t error_size)
{
    double number;
    if (!text_number(value, strlen(value), &number) || number < 0 || number >= 1) {
        return fail(error, error_size, "%s: expected a number from 0 to below 1, found '%.100s'", name, value);
    }
    *share = number;
    return 0;
}
