#include "hosts/board.h"

#include <stdio.h>
#include <string.h>

/* QEMU counts 16 instructions a microsecond: fine against the clocks of its boards, which tick in 40 to 62 ns, and a second of theirs is long. */
#define SHIFT 6

static const struct board_kind kinds[] = {
    {"atmega128", "atmega128", NULL, 0, 7372800},
    {"cortex-m0", "microbit", "qemu-system-arm", SHIFT, 16e6},
    {"cortex-m3", "mps2-an385", "qemu-system-arm", SHIFT, 64e6},
    {"cortex-m4f", "mps2-an386", "qemu-system-arm", SHIFT, 64e6},
    {"cortex-m33", "mps2-an505", "qemu-system-arm", SHIFT, 64e6},
    {"riscv32", "virt", "qemu-system-riscv32", 0, 64e6},
    {"host", NULL, NULL, 0, 1e9},
};

const struct board_kind *board_kind_find(const char *name)
{
    const char *suffix = strstr(name, "-fixed");
    const size_t length = suffix && suffix[6] == '\0' ? (size_t)(suffix - name) : strlen(name);
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        if (strlen(kinds[i].name) == length && memcmp(kinds[i].name, name, length) == 0) {
            return &kinds[i];
        }
    }
    return NULL;
}

int board_open(struct board_line *line, const struct board_kind *kind, const char *image, char *error,
               size_t error_size)
{
    if (!kind->machine) {
        return board_process_open(line, (const char *const[]){image, NULL}, error, error_size);
    }
    if (!kind->emulator) {
        return board_simavr_open(line, kind, image, error, error_size);
    }
    char shift[40];
    snprintf(shift, sizeof shift, "shift=%u,sleep=off", kind->instruction_shift);
    const char *const arguments[] = {kind->emulator,
                                     "-M",
                                     kind->machine,
                                     "-bios",
                                     "none",
                                     "-display",
                                     "none",
                                     "-monitor",
                                     "none",
                                     "-serial",
                                     "stdio",
                                     "-semihosting-config",
                                     "enable=on,target=native",
                                     "-icount",
                                     shift,
                                     "-kernel",
                                     image,
                                     NULL};
    return board_process_open(line, arguments, error, error_size);
}
