/* The painted stack, for ports whose stack grows downwards through memory that nothing else uses.
 *
 * A port defines STACK_POINTER(), STACK_LIMIT, the lowest byte of the stack, and STACK_TOP, the byte above its highest, and includes this once. */
#ifndef STACK_PAINT_H
#define STACK_PAINT_H

#define STACK_PATTERN 0xC5
#define STACK_GUARD 4 /* bytes at the limit that must stay painted */

/* Bytes left alone below the stack pointer, so that the painter's own frame is safe; they count as used. */
#define STACK_MARGIN 16

static uint8_t *stack_painted_from;

__attribute__((noinline)) void port_stack_paint(void)
{
    stack_painted_from = STACK_POINTER();
    for (volatile uint8_t *p = STACK_LIMIT; p < stack_painted_from - STACK_MARGIN; p++) {
        *p = STACK_PATTERN;
    }
}

__attribute__((noinline)) uint32_t port_stack_used(void)
{
    const volatile uint8_t *p = STACK_LIMIT;
    while (p < stack_painted_from - STACK_MARGIN && *p == STACK_PATTERN) {
        p++;
    }
    return (uint32_t)(stack_painted_from - p);
}

uint32_t port_stack_deepest(void) { return port_stack_used() + (uint32_t)(STACK_TOP - stack_painted_from); }

bool port_stack_intact(void)
{
    const volatile uint8_t *limit = STACK_LIMIT;
    uint8_t painted = 0;
    for (uint8_t i = 0; i < STACK_GUARD; i++) {
        painted = (uint8_t)(painted + (limit[i] == STACK_PATTERN));
    }
    return painted == STACK_GUARD;
}

#endif
