/* The painted stack, for ports whose stack grows downwards through memory that nothing else uses.
 *
 * A port defines STACK_POINTER() and STACK_LIMIT, the lowest byte of the stack, and includes this once. */
#ifndef STACK_PAINT_H
#define STACK_PAINT_H

#define STACK_PATTERN 0xC5

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

#endif
