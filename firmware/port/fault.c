#include "fault.h"

#define FRESH 0x8000u /* not yet told of */

static struct {
    uint32_t address;
    uint16_t cause; /* and FRESH */
    uint16_t count;
    uint16_t check;
} kept __attribute__((section(".noinit")));

static uint16_t check(void)
{
    const uint16_t words[] = {(uint16_t)kept.address, (uint16_t)(kept.address >> 16), kept.cause, kept.count};
    uint16_t sum = 0x5AC3;
    for (uint8_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        sum = (uint16_t)((uint16_t)(sum << 1 | sum >> 15) ^ words[i]);
    }
    return sum;
}

static void keep(enum port_fault_cause cause, uint32_t address)
{
    kept.count = kept.check != check() ? 1 : kept.count < UINT16_MAX ? (uint16_t)(kept.count + 1u) : UINT16_MAX;
    kept.cause = (uint16_t)(cause | FRESH);
    kept.address = address;
    kept.check = check();
}

void port_fault(enum port_fault_cause cause, uint32_t address)
{
    keep(cause, address);
    port_reset();
}

void fault_begin(struct fault_record *record)
{
    const bool valid = kept.check == check(), fired = port_watchdog_fired();
    if (fired && !(valid && kept.cause & FRESH)) { /* a reset after a fault may be the watchdog's work */
        keep(PORT_FAULT_WATCHDOG, 0);
    } else if (!valid) {
        kept.address = 0;
        kept.cause = PORT_FAULT_NONE;
        kept.count = 0;
    }
    record->cause = kept.cause & FRESH ? (uint8_t)kept.cause : (uint8_t)PORT_FAULT_NONE;
    record->count = kept.count;
    record->address = kept.address;
    kept.cause &= (uint16_t)~FRESH;
    kept.check = check();
}
