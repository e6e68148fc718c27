/* An AVR within this process, cycle by cycle. */
#include "hosts/board.h"
#include "scenario/text.h"

#ifdef MOTEHOUND_SIMAVR

#include <avr_uart.h>
#include <sim_avr.h>
#include <sim_elf.h>

#include <stdlib.h>
#include <string.h>

enum { STATUS_REGISTER = 24, IN_MAX = 1024, OUT_MAX = 256 };

struct simavr {
    avr_t *avr;
    uint8_t in[IN_MAX], out[OUT_MAX]; /* to the board, and from it */
    size_t in_count, in_sent, out_count;
    bool full; /* its receiver takes no more for now */
};

/* ---- the serial line ---- */

static void feed(struct simavr *board)
{
    avr_irq_t *input = avr_io_getirq(board->avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
    while (!board->full && board->in_sent < board->in_count) {
        avr_raise_irq(input, board->in[board->in_sent++]);
    }
}

static void on_output(struct avr_irq_t *irq, uint32_t value, void *context)
{
    struct simavr *board = context;
    (void)irq;
    if (board->out_count < OUT_MAX) {
        board->out[board->out_count++] = (uint8_t)value;
    }
}

static void on_room(struct avr_irq_t *irq, uint32_t value, void *context)
{
    struct simavr *board = context;
    (void)irq;
    (void)value;
    board->full = false;
    feed(board);
}

static void on_full(struct avr_irq_t *irq, uint32_t value, void *context)
{
    struct simavr *board = context;
    (void)irq;
    (void)value;
    board->full = true;
}

/* ---- the board ---- */

static void say_nothing(avr_t *avr, const int level, const char *format, va_list arguments)
{
    (void)avr;
    (void)level;
    (void)format;
    (void)arguments;
}

/* Sleeping takes no time of ours. */
static void sleep_at_once(avr_t *avr, avr_cycle_count_t cycles)
{
    (void)avr;
    (void)cycles;
}

static int put(void *state, const uint8_t *bytes, size_t count, char *error, size_t error_size)
{
    struct simavr *board = state;
    if (board->in_sent == board->in_count) {
        board->in_sent = board->in_count = 0;
    }
    if (count > IN_MAX - board->in_count) {
        return fail(error, error_size, "does not take what it is sent");
    }
    memcpy(board->in + board->in_count, bytes, count);
    board->in_count += count;
    feed(board);
    return 0;
}

static long get(void *state, uint8_t *bytes, size_t room, double patience_s, char *error, size_t error_size)
{
    struct simavr *board = state;
    avr_t *avr = board->avr;
    const avr_cycle_count_t until = avr->cycle + (avr_cycle_count_t)(patience_s * avr->frequency);
    while (board->out_count == 0 && avr->cycle < until) {
        const int how = avr_run(avr);
        if (how == cpu_Crashed) {
            return fail(error, error_size, "has crashed at 0x%lx", (unsigned long)avr->pc);
        }
        if (how == cpu_Done) {
            return fail(error, error_size, "has ended with status %u", avr->data[STATUS_REGISTER]);
        }
    }
    const size_t count = board->out_count < room ? board->out_count : room;
    memcpy(bytes, board->out, count);
    board->out_count -= count;
    memmove(board->out, board->out + count, board->out_count);
    return (long)count;
}

static void rest(void *state) { (void)state; }

static void close_simavr(void *state)
{
    struct simavr *board = state;
    if (board->avr) {
        avr_terminate(board->avr);
        free(board->avr);
    }
    free(board);
}

static void connect(struct simavr *board)
{
    avr_t *avr = board->avr;
    const uint32_t uart = AVR_IOCTL_UART_GETIRQ('0');
    uint32_t flags = 0;
    avr_ioctl(avr, AVR_IOCTL_UART_GET_FLAGS('0'), &flags);
    flags &= ~(uint32_t)(AVR_UART_FLAG_STDIO | AVR_UART_FLAG_POLL_SLEEP);
    avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    avr_irq_register_notify(avr_io_getirq(avr, uart, UART_IRQ_OUTPUT), on_output, board);
    avr_irq_register_notify(avr_io_getirq(avr, uart, UART_IRQ_OUT_XON), on_room, board);
    avr_irq_register_notify(avr_io_getirq(avr, uart, UART_IRQ_OUT_XOFF), on_full, board);
}

int board_simavr_open(struct board_line *line, const struct board_kind *kind, const char *image, char *error,
                      size_t error_size)
{
    elf_firmware_t firmware = {0};
    struct simavr *board = calloc(1, sizeof *board);
    avr_global_logger_set(say_nothing);
    if (!board || elf_read_firmware(image, &firmware) != 0) {
        free(board);
        return fail(error, error_size, "%s: simavr cannot read it", image);
    }
    board->avr = avr_make_mcu_by_name(kind->machine);
    if (!board->avr || avr_init(board->avr) != 0) {
        free(board);
        return fail(error, error_size, "simavr knows no %s", kind->machine);
    }
    firmware.frequency = (uint32_t)kind->rate_hz;
    avr_load_firmware(board->avr, &firmware);
    board->avr->sleep = sleep_at_once;
    board->avr->log = LOG_ERROR;
    connect(board);
    free(firmware.flash);
    *line = (struct board_line){board, put, get, rest, close_simavr};
    return 0;
}

#else

int board_simavr_open(struct board_line *line, const struct board_kind *kind, const char *image, char *error,
                      size_t error_size)
{
    (void)line;
    (void)image;
    return fail(error, error_size,
                "this motehound is built without simavr's library, and so without board %s: install libsimavr-dev and "
                "libelf-dev and build anew",
                kind->name);
}

#endif
