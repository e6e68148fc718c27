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

/* To the end of the group in which `layout` stands. Every turn of every loop reads at least one byte. */
static void read_group(const char *layout, struct reader *reader, int depth)
{
    while (reader->sound && *layout != '\0' && *layout != ']' && *layout != '}') {
        const char what = *layout++;
        if (what == 's') {
            skip_string(reader);
        } else if (what == '[' || what == '{') {
            uint32_t count = length(reader, what == '[' ? 4 : 2);
            reader->sound = reader->sound && depth < DEPTH_MAX;
            for (; count > 0 && reader->sound; count--) {
                read_group(layout, reader, depth + 1);
            }
            layout = after_group(layout);
        } else {
            skip(reader, (size_t)(what - '0'));
        }
    }
}

bool layout_fits(const char *layout, const void *data, size_t size)
{
    struct reader reader = {data, (const uint8_t *)data + size, true};
    skip(&reader, FINGERPRINT);
    read_group(layout, &reader, 0);
    return reader.sound && reader.at == reader.end;
}
