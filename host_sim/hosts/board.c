#include "hosts/board.h"

#include "scenario/text.h"

#include <stdio.h>
#include <string.h>

/* QEMU counts 16 instructions a microsecond: fine against the clocks of its boards, which tick in 40 to 62 ns, and a second of theirs is long. */
#define SHIFT 6

enum { AVR = 83, ARM = 40, RISCV = 243 }; /* in an ELF file */

static const struct board_kind kinds[] = {
    {"atmega128", "atmega128", NULL, 0, 7372800, AVR},
    {"cortex-m0", "microbit", "qemu-system-arm", SHIFT, 16e6, ARM},
    {"cortex-m3", "mps2-an385", "qemu-system-arm", SHIFT, 64e6, ARM},
    {"cortex-m4f", "mps2-an386", "qemu-system-arm", SHIFT, 64e6, ARM},
    {"cortex-m33", "mps2-an505", "qemu-system-arm", SHIFT, 64e6, ARM},
    {"riscv32", "virt", "qemu-system-riscv32", 0, 64e6, RISCV},
    {"host", NULL, NULL, 0, 1e9, 0},
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

/* An emulator runs anything, or says nothing that helps: a file that is whole, and for the board's processor. */
static int check_image(const struct board_kind *kind, const char *image, char *error, size_t error_size)
{
    enum { HEADER = 52, MACHINE = 18, SECTIONS = 32, SECTION_SIZE = 46, SECTION_COUNT = 48 }; /* of a 32-bit ELF file */
    uint8_t header[HEADER];
    FILE *file = fopen(image, "rb");
    if (!file) {
        return fail(error, error_size, "%s cannot be read", image);
    }
    const size_t count = fread(header, 1, sizeof header, file);
    const long end = fseek(file, 0, SEEK_END) == 0 ? ftell(file) : -1;
    fclose(file);
    if (count < sizeof header || memcmp(header, "\177ELF\1\1", 6) != 0) {
        return fail(error, error_size, "%s is no image of a board", image);
    }
    const unsigned machine = header[MACHINE] | (unsigned)header[MACHINE + 1] << 8;
    if (machine != kind->elf_machine) {
        return fail(error, error_size, "%s is for another processor (ELF machine %u, expected %u)", image, machine,
                    kind->elf_machine);
    }
    const uint32_t sections = header[SECTIONS] | (uint32_t)header[SECTIONS + 1] << 8 |
                              (uint32_t)header[SECTIONS + 2] << 16 | (uint32_t)header[SECTIONS + 3] << 24;
    if (end < (long)sections + header[SECTION_SIZE] * header[SECTION_COUNT]) { /* they come last */
        return fail(error, error_size, "%s is not whole", image);
    }
    return 0;
}

int board_open(struct board_line *line, const struct board_kind *kind, const char *image, char *error,
               size_t error_size)
{
    if (!kind->machine) {
        return board_process_open(line, (const char *const[]){image, NULL}, error, error_size);
    }
    if (check_image(kind, image, error, error_size) != 0) {
        return -1;
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
