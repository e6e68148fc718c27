/* Boards on which motes can live instead of in this process: an emulator, or a process, that runs an image and has a serial line. What goes over
 * the line is the business of boards.c (motehound/line.h). */
#ifndef MOTEHOUND_SIM_BOARD_H
#define MOTEHOUND_SIM_BOARD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A kind of board. */
struct board_kind {
    const char *name;
    const char *machine;  /* of simavr, or of QEMU; NULL: the image is a program of this machine */
    const char *emulator; /* the program of QEMU; NULL: simavr */
    unsigned
        instruction_shift; /* an instruction takes 2^shift ns of QEMU's time, by which the board's own clock goes */
    double rate_hz;        /* what the processor is taken to do in a second: cycles; of QEMU, instructions */
    unsigned elf_machine;  /* of its images */
};

/* The kind called `name`, also with "-fixed" behind it; NULL if there is none. */
const struct board_kind *board_kind_find(const char *name);

/* All names, one after the other, for error messages. */
#define BOARD_NAMES "atmega128, cortex-m0, cortex-m3, cortex-m4f, cortex-m33, riscv32 or host"

/* A board that runs. */
struct board_line {
    void *state;
    /* Bytes to the board. Returns 0, or -1 with what happened to it in `error`. */
    int (*put)(void *state, const uint8_t *bytes, size_t count, char *error, size_t error_size);
    /* Let it run until it has sent something -> bytes[0 .. room). Returns how many; 0 after patience_s, of the board's time in simavr, else of
     * ours; -1 with what happened to it in `error`: "has ended with status 3". */
    long (*get)(void *state, uint8_t *bytes, size_t room, double patience_s, char *error, size_t error_size);
    /* It has nothing to do until it is sent something: time stands still for it. */
    void (*rest)(void *state);
    void (*close)(void *state);
};

/* Begin to run `image`. Returns 0, or -1 with one line in `error`. Emulators are no part of this program: simavr's library is asked for when it is
 * built, QEMU's programs when they are needed. */
int board_open(struct board_line *line, const struct board_kind *kind, const char *image, char *error,
               size_t error_size);

int board_simavr_open(struct board_line *line, const struct board_kind *kind, const char *image, char *error,
                      size_t error_size);
/* arguments: NULL at the end, its first the program. */
int board_process_open(struct board_line *line, const char *const *arguments, char *error, size_t error_size);

#endif
