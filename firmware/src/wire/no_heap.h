/* Compiled ahead of lcm-gen's code: a mote has no heap, so the generated T_copy and T_destroy, the only functions that would use
 * one for fixed-size messages, lose it. They must not be called; nothing in the library does. */
#include <stdlib.h>
#define malloc(size) ((void *)0)
#define free(pointer) ((void)(pointer))
