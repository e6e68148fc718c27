#include "bus/layout.h"

#include <stdint.h>

enum { FINGERPRINT = 8, DEPTH_MAX = 4 };

struct reader {
    const uint8_t *at, *end;
    bool sound;
};

static void skip(struct reader *reader, size_t size)
{
    reader->sound = reader->sound && (size_t)(reader->end - reader->at) >= size;
    if (reader->sound) {
        reader->at += size;
    }
}

/* A signed big-endian number of `size` bytes that is not negative. */
static uint32_t length(struct reader *reader, size_t size)
{
    const uint8_t *bytes = reader->at;
    uint32_t value = 0;
    skip(reader, size);
    for (size_t i = 0; i < size && reader->sound; i++) {
        value = value << 8 | bytes[i];
    }
    reader->sound = reader->sound && value >> (8 * size - 1) == 0;
    return reader->sound ? value : 0;
}

/* Strings are stored with the zero byte that ends them. */
static void skip_string(struct reader *reader)
{
    const uint32_t size = length(reader, 4);
    skip(reader, size);
    reader->sound = reader->sound && size > 0 && reader->at[-1] == 0;
}

static const char *after_group(const char *layout)
{
    for (int depth = 1; depth > 0; layout++) {
        depth += (*layout == '[' || *layout == '{') - (*layout == ']' || *layout == '}');
    }
    return layout;
}

/* A group that is being read: where it stands in the layout, and how often it is still to come. */
struct group {
    const char *begin;
    uint32_t left;
};

/* Every step of the loop either reads at least one byte of the message or goes on in the layout. */
bool layout_fits(const char *layout, const void *data, size_t size)
{
    struct reader reader = {data, (const uint8_t *)data + size, true};
    struct group groups[DEPTH_MAX] = {{layout, 0}};
    int depth = 0;
    skip(&reader, FINGERPRINT);
    while (reader.sound && *layout != '\0') {
        const char what = *layout++;
        if (what == 's') {
            skip_string(&reader);
        } else if (what == ']' || what == '}') {
            if (depth == 0) {
                return false; /* a layout that closes what it has not opened */
            }
            struct group *group = &groups[depth - 1];
            if (--group->left > 0) {
                layout = group->begin;
            } else {
                depth--;
            }
        } else if (what == '[' || what == '{') {
            const uint32_t count = length(&reader, what == '[' ? 4 : 2);
            if (count == 0) {
                layout = after_group(layout);
            } else if (depth == DEPTH_MAX) {
                reader.sound = false;
            } else {
                groups[depth++] = (struct group){layout, count};
            }
        } else {
            skip(&reader, (size_t)(what - '0'));
        }
    }
    return reader.sound && reader.at == reader.end;
}
