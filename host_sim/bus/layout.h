/* Does a message hold what its type says? lcm-gen's code takes the lengths in a message at their word, so messages of types with lengths that
 * come from other processes are checked before they are decoded. */
#ifndef MOTEHOUND_SIM_LAYOUT_H
#define MOTEHOUND_SIM_LAYOUT_H

#include <stdbool.h>
#include <stddef.h>

/* True if data[0 .. size), a message as it comes, is a fingerprint and then exactly what `layout` says, member by member: `1`, `2`, `4`
 * or `8` for a number of so many bytes, `s` for a string, `[...]` for a 32-bit number and as many times what stands between the
 * brackets, `{...}` the same with a 16-bit number. Groups nest to a depth of 4. Cost: O(size). */
bool layout_fits(const char *layout, const void *data, size_t size);

#endif
