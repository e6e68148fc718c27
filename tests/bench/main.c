/* Runs a workload and prints the depth of its stack; the emulator counts the calls of bench_counted(). */
#include "bench.h"
#include "port.h"

void bench_counted(void);
void bench_counted_end(void);

__attribute__((noinline)) void bench_counted(void)
{
    bench_step();
    __asm__ volatile(""); /* no tail call: the emulators look for the return */
}

__attribute__((noinline)) void bench_counted_end(void) { __asm__ volatile(""); }

static void print_hex(uint32_t value)
{
    for (int shift = 28; shift >= 0; shift -= 4) {
        port_putc("0123456789abcdef"[(value >> shift) & 15]);
    }
}

int main(void)
{
    uint32_t deepest = 0, draws = 0;
    bench_setup();
    for (unsigned step = 0; step < BENCH_WARM_UP + BENCH_COUNTED; step++) {
        bench_prepare(step);
        if (step < BENCH_WARM_UP) {
            bench_step();
            continue;
        }
        const uint32_t before = bench_draws ? bench_draws() : 0;
        port_stack_paint();
        bench_counted();
        bench_counted_end();
        const uint32_t used = port_stack_used();
        if (!bench_worked()) {
            port_puts("the step did not do the work that was meant\n");
            return 1;
        }
        draws += bench_draws ? bench_draws() - before : 0;
        deepest = used > deepest ? used : deepest;
    }
    port_puts("stack 0x");
    print_hex(deepest);
    port_puts(" draws 0x");
    print_hex(draws);
    port_puts("\n");
    return 0;
}
