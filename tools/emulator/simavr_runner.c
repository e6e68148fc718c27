/* Runs an AVR image on simavr: bytes of UART0 go to standard output, and the image's exit status becomes this program's.
 *
 *   simavr_runner [-m MCU] [-s] [-c NAME=ADDRESS]... IMAGE
 *
 * -m  the chip; without it the one that the image names.
 * -s  bytes of standard input go to UART0, however long the image runs; the end of the input ends it, with status 0.
 * -c  count the cycles of every call of the function at byte address ADDRESS, from its first instruction to its return; a line
 *     "NAME calls=N min=N max=N mean=N" on standard error tells them.
 *
 * An image ends with "sleep" while interrupts are off and its status in r24 (firmware/port/avr/port.c). Own statuses: 95 bad
 * command line or image, 96 the stack has run into the variables, 97 no end after MAX_CYCLES, 98 simavr reports a crash. */
#include <avr_uart.h>
#include <sim_avr.h>
#include <sim_elf.h>

#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { BAD_USAGE = 95, STACK_OVERFLOW = 96, NO_END = 97, CRASHED = 98 };
enum { COUNTERS_MAX = 16, STATUS_REGISTER = 24 };
#define MAX_CYCLES 2000000000ull

struct counter {
    const char *name;
    uint32_t address;
    int inside;
    uint32_t return_address;
    uint16_t sp_at_entry;
    avr_cycle_count_t begin, total, min, max;
    unsigned long calls;
};

static void print_byte(struct avr_irq_t *irq, uint32_t value, void *context)
{
    (void)irq;
    (void)context;
    putchar((int)value);
}

static void log_errors(avr_t *avr, const int level, const char *format, va_list arguments)
{
    (void)avr;
    if (level <= LOG_ERROR) {
        vfprintf(stderr, format, arguments);
    }
}

/* Sleeping takes no time of the host's. */
static void sleep_at_once(avr_t *avr, avr_cycle_count_t cycles)
{
    (void)avr;
    (void)cycles;
}

/* Standard input as the other end of the line, at the line's own pace: a byte of ten bits at 57,600 baud. While the chip sleeps the host waits a
 * little, too. */
enum { LINE_CYCLES = 1280, LINE_WAIT_MS = 1 };

static struct {
    int open;
    int slept;
    avr_irq_t *to_chip;
    avr_cycle_count_t next;
} line;

static void sleep_and_listen(avr_t *avr, avr_cycle_count_t cycles)
{
    (void)avr;
    (void)cycles;
    line.slept = 1;
}

static void listen_to_line(const avr_t *avr)
{
    if (avr->cycle < line.next && !line.slept) {
        return;
    }
    struct pollfd input = {STDIN_FILENO, POLLIN, 0};
    fflush(stdout);
    if (poll(&input, 1, line.slept && avr->cycle >= line.next ? LINE_WAIT_MS : 0) > 0 && avr->cycle >= line.next) {
        unsigned char byte;
        line.open = read(STDIN_FILENO, &byte, 1) == 1;
        if (line.open) {
            avr_raise_irq(line.to_chip, byte);
        }
    }
    line.slept = 0;
    line.next = avr->cycle > line.next ? avr->cycle + LINE_CYCLES : line.next;
}

static uint16_t stack_pointer(const avr_t *avr) { return (uint16_t)(avr->data[R_SPL] | avr->data[R_SPH] << 8); }

/* What the call that has just been made left on the stack, high byte lowest, in words. */
static uint32_t return_address(const avr_t *avr, uint16_t sp)
{
    uint32_t words = 0;
    for (int i = 1; i <= avr->address_size; i++) {
        words = words << 8 | avr->data[sp + i];
    }
    return words * 2;
}

/* The two bytes of SP are written one after the other, so SP alone does not tell a return from a frame that is being removed. */
static void count(struct counter *c, const avr_t *avr)
{
    const uint16_t sp = stack_pointer(avr);
    if (!c->inside && avr->pc == c->address) {
        c->inside = 1;
        c->begin = avr->cycle;
        c->sp_at_entry = sp;
        c->return_address = return_address(avr, sp);
    } else if (c->inside && sp > c->sp_at_entry && avr->pc == c->return_address) {
        const avr_cycle_count_t taken = avr->cycle - c->begin;
        c->inside = 0;
        c->min = c->calls == 0 || taken < c->min ? taken : c->min;
        c->max = taken > c->max ? taken : c->max;
        c->total += taken;
        c->calls++;
    }
}

static int usage(void)
{
    fprintf(stderr, "usage: simavr_runner [-m MCU] [-s] [-c NAME=ADDRESS]... IMAGE\n");
    return BAD_USAGE;
}

int main(int argc, char **argv)
{
    struct counter counters[COUNTERS_MAX] = {{0}};
    int counter_count = 0;
    const char *mcu = NULL, *image = NULL;
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "-m") == 0 && i + 1 < argc) {
            mcu = argv[++i];
        } else if (strcmp(argv[i], "-c") == 0 && i + 1 < argc && counter_count < COUNTERS_MAX) {
            char *equals = strchr(argv[++i], '=');
            if (equals == NULL) {
                return usage();
            }
            *equals = '\0';
            counters[counter_count].name = argv[i];
            counters[counter_count++].address = (uint32_t)strtoul(equals + 1, NULL, 0);
        } else if (strcmp(argv[i], "-s") == 0) {
            line.open = 1;
        } else if (image == NULL && argv[i][0] != '-') {
            image = argv[i];
        } else {
            return usage();
        }
    }
    if (image == NULL) {
        return usage();
    }

    avr_global_logger_set(log_errors);
    elf_firmware_t firmware = {0};
    if (elf_read_firmware(image, &firmware) != 0) {
        fprintf(stderr, "simavr_runner: cannot read %s\n", image);
        return BAD_USAGE;
    }
    avr_t *avr = avr_make_mcu_by_name(mcu != NULL ? mcu : firmware.mmcu);
    if (avr == NULL) {
        fprintf(stderr, "simavr_runner: simavr knows no chip '%s'\n", mcu != NULL ? mcu : firmware.mmcu);
        return BAD_USAGE;
    }
    avr_init(avr);
    avr_load_firmware(avr, &firmware);
    avr->sleep = line.open ? sleep_and_listen : sleep_at_once;
    avr->log = LOG_ERROR;
    uint32_t uart_flags = 0;
    avr_ioctl(avr, AVR_IOCTL_UART_GET_FLAGS('0'), &uart_flags);
    uart_flags &= ~(uint32_t)(AVR_UART_FLAG_STDIO | AVR_UART_FLAG_POLL_SLEEP);
    avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &uart_flags);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), print_byte, NULL);
    line.to_chip = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
    avr->run_cycle_limit = 1; /* one instruction a call, so that no entry and no return is missed */
    avr->run_cycle_count = 1;

    const uint16_t first_free = (uint16_t)(avr->ioend + 1 + firmware.datasize + firmware.bsssize);
    const int serves = line.open;
    int state = cpu_Running, overflown = 0;
    while (state != cpu_Done && state != cpu_Crashed && !overflown && (serves ? line.open : avr->cycle < MAX_CYCLES)) {
        if (serves) {
            listen_to_line(avr);
        }
        for (int i = 0; i < counter_count; i++) {
            count(&counters[i], avr);
        }
        state = avr_run(avr);
        /* the low byte of SP is written before the high one, so only a value that lasts is believed */
        static int below;
        const uint16_t sp = stack_pointer(avr);
        below = sp > avr->ioend && sp < first_free ? below + 1 : 0;
        overflown = below > 2;
    }

    int status = serves ? 0 : avr->data[STATUS_REGISTER];
    fflush(stdout);
    if (overflown) {
        fprintf(stderr, "simavr_runner: the stack has run into the variables\n");
        status = STACK_OVERFLOW;
    } else if (state == cpu_Crashed) {
        fprintf(stderr, "simavr_runner: crash at 0x%x\n", avr->pc);
        status = CRASHED;
    } else if (state != cpu_Done && !serves) {
        fprintf(stderr, "simavr_runner: still running after %llu cycles\n", MAX_CYCLES);
        status = NO_END;
    }
    for (int i = 0; i < counter_count; i++) {
        const struct counter *c = &counters[i];
        fprintf(stderr, "%s calls=%lu min=%llu max=%llu mean=%.1f\n", c->name, c->calls, (unsigned long long)c->min,
                (unsigned long long)c->max, c->calls > 0 ? (double)c->total / (double)c->calls : 0.0);
    }
    avr_terminate(avr);
    return status;
}
