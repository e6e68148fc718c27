/* The parts of a board that an image needs besides what unit tests need: clock, stack guard, fault record, watchdog. Each fault resets the board, and the next start goes
 * on where the record says that the one before has ended. */
#include "fault.h"

#define ADDRESS 0x12345678u

#ifdef __AVR__
#define OVERFLOW_FAULTS false
#else
#define OVERFLOW_FAULTS true
#endif

/* Run until the stack is at its end: where that is a fault, to the fault. */
__attribute__((noinline)) static uint8_t overflow(volatile uint8_t *above)
{
    volatile uint8_t frame[4];
    frame[0] = above[0];
    if ((!OVERFLOW_FAULTS || frame[0] > 0) && !port_stack_intact()) {
        return frame[0];
    }
    const uint8_t below = overflow(frame);
    return (uint8_t)(below + frame[0]);
}

static bool clock_runs(void)
{
    const uint32_t ticks = port_ticks(), cycles = port_cycles();
    uint32_t last = ticks;
    for (uint16_t waits = 0; waits < 1000 && port_ticks() - ticks < 100; waits++) {
        port_wait();
        if (port_ticks() - last > 10 + 50) { /* 50: emulators lose time while others use the processor */
            return false;
        }
        last = port_ticks();
    }
    return port_ticks() - ticks >= 100 && port_ticks() - ticks < 1000 && port_cycles() - cycles > 100;
}

static int say(const char *what, int status)
{
    port_puts(what);
    port_puts("\n");
    return status;
}

int main(void)
{
    struct fault_record record;
    volatile uint8_t nothing = 0;
    fault_begin(&record);
    port_stack_paint();
    port_timer_begin();
    switch (record.count) {
    case 0:
        if (record.cause != PORT_FAULT_NONE || !clock_runs()) {
            return say("the clock does not run", 1);
        }
        if (!port_stack_intact() || port_stack_deepest() == 0 || port_stack_deepest() > 2048) {
            return say("the stack is not as it should be at the start", 1);
        }
        say("overflowing", overflow(&nothing));
        port_fault(port_stack_intact() ? PORT_FAULT_NONE : PORT_FAULT_STACK, 0);
        break;
    case 1:
        if (record.cause != PORT_FAULT_STACK || !port_stack_intact()) {
            return say("the overflow of the stack is not in the record", 1);
        }
        port_fault(PORT_FAULT_PROGRAM, ADDRESS);
        break;
    case 2:
        if (record.cause != PORT_FAULT_PROGRAM || record.address != ADDRESS) {
            return say("what the program has found is not in the record", 1);
        }
#ifdef __AVR__
        port_watchdog_start();
        for (;;) {}
#else
        __builtin_trap();
#endif
        break;
    case 3:
        if (record.cause == PORT_FAULT_NONE) {
            return say("the record is gone", 1);
        }
#ifdef __AVR__
        if (record.cause != PORT_FAULT_WATCHDOG) {
            return say("the watchdog is not in the record", 1);
        }
#else
        if (record.cause != PORT_FAULT_PROCESSOR || record.address == 0) {
            return say("the processor's fault is not in the record", 1);
        }
#endif
        return say("passed", 0);
    default:
        return say("a fault too many", 1);
    }
    return say("still running", 1);
}
