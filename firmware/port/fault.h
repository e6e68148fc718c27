/* The fault record: what went wrong last, in memory that no start clears (.noinit), so that the next start can tell.
 *
 * An image that links fault.c is reset by a fault, after the record is written. The record is protected by a check sum: after power-up, when the memory
 * holds anything, there is none. It lasts until the power goes. */
#ifndef FAULT_H
#define FAULT_H

#include "port.h"

struct fault_record {
    uint8_t cause;  /* enum port_fault_cause */
    uint16_t count; /* faults since power-up; saturates */
    uint32_t
        address; /* of the instruction, as far as the processor tells; of PORT_FAULT_PROGRAM, what the program says */
};

/* At the start, once: what ended the run before -> *record, cause PORT_FAULT_NONE if nothing did. `count` is kept from start to start all the same. */
void fault_begin(struct fault_record *record);

#endif
