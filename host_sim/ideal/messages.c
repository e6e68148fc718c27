#include "ideal/messages.h"

#include <stddef.h>
#include <string.h>

static const struct message_sizes sizes[] = {
    {"range", 7, 20, 20, 0},
    {"pftl", 7, 16, 20, 0},
    {"msl", 5, 16, 20, 4},
    {"centroid", 5, 16, 6, 0},
};

const struct message_sizes *message_sizes_of(const char *name)
{
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        if (strcmp(sizes[i].tracker, name) == 0) {
            return &sizes[i];
        }
    }
    return NULL;
}
