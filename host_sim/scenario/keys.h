/* The one table of all keys of a scenario. The schema of the file, the checks, --set and the documentation follow from
 * it. */
#ifndef MOTEHOUND_SIM_KEYS_H
#define MOTEHOUND_SIM_KEYS_H

#include "scenario/scenario.h"

enum key_type {
    KEY_NUMBER,  /* double */
    KEY_COUNT,   /* int64_t */
    KEY_SWITCH,  /* bool: true or false */
    KEY_CHOICE,  /* an enum: the index of a word in `choices` */
    KEY_WORD,    /* char *: one of `choices` */
    KEY_TEXT,    /* char *: at most `maximum` bytes of UTF-8 */
    KEY_POINTS,  /* source.points */
    KEY_TARGETS, /* targets */
    KEY_NUMBERS, /* struct number_list: each number within the range */
    KEY_LIST     /* sweep.values */
};

struct scenario_key {
    const char *path;
    enum key_type type;
    size_t offset;           /* of the member in struct scenario */
    const char *standard;    /* default, as --set would give it */
    double minimum, maximum; /* both included */
    const char *choices;     /* separated by '|' */
    const char *help;
};

extern const struct scenario_key scenario_keys[];
extern const size_t scenario_key_count;

/* What the numbers of a point in a list of points, and of a target in a list of targets, must be; in the order of --set. */
struct member_range {
    const char *name;
    double minimum, maximum; /* both included */
};
enum { POINT_MEMBERS = 3, TARGET_MEMBERS = 3 };
extern const struct member_range point_members[POINT_MEMBERS], target_members[TARGET_MEMBERS];

/* The key of that path, or NULL. */
const struct scenario_key *scenario_key_find(const char *path);

/* What a value of this key must be: "a number 0 to 1". Written into text, which is returned. */
const char *scenario_key_expectation(const struct scenario_key *key, char *text, size_t size);

/* One line for a key that does not exist, with the nearest that does; returns -1. `place` comes before it ("file:line:
 * "). */
int scenario_key_unknown(const char *place, const char *path, char *error, size_t error_size);

#endif
