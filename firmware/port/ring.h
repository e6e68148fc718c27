/* Bytes on their way from an interrupt to the main loop: one writes, one reads, neither waits. Included by the drivers of serial lines. */
#ifndef RING_H
#define RING_H

#include <stdint.h>

#ifndef PORT_RING
#define PORT_RING 32
#endif
#if PORT_RING < 2 || PORT_RING > 128 || (PORT_RING & (PORT_RING - 1)) != 0
#error "PORT_RING must be a power of two from 2 to 128: its ends are counted in a byte"
#endif

static struct {
    volatile uint8_t written, read; /* in all; wrap */
    volatile uint8_t bytes[PORT_RING];
} ring;

static inline uint8_t ring_count(void) { return (uint8_t)(ring.written - ring.read); }

static inline uint8_t ring_is_full(void) { return ring_count() == PORT_RING; }

static inline void ring_write(uint8_t byte)
{
    if (!ring_is_full()) {
        ring.bytes[ring.written % PORT_RING] = byte;
        ring.written = (uint8_t)(ring.written + 1);
    }
}

static inline int ring_read(void)
{
    if (ring_count() == 0) {
        return -1;
    }
    const uint8_t byte = ring.bytes[ring.read % PORT_RING];
    ring.read = (uint8_t)(ring.read + 1);
    return byte;
}

#endif
