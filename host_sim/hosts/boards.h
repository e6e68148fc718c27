/* Motes on boards: the table of host.h for motes of which some live on emulated boards, each a whole mote behind a serial line (motehound/line.h), and the
 * others in this process.
 *
 * Time on a board is logical: what an event makes the mote do happens at the event's time, however many cycles it takes. So the run goes as it would with
 * the mote in this process, as far as the image computes alike and has room for as much. The cycles are counted, for the energy and to say what would have been
 * late. */
#ifndef MOTEHOUND_SIM_BOARDS_H
#define MOTEHOUND_SIM_BOARDS_H

#include "hosts/board.h"
#include "hosts/host.h"
#include "hosts/step_cycles.h"

enum { BOARDS_MAX = 64, BOARD_NAME_MAX = 32, BOARD_IMAGE_MAX = 400 };

/* Which motes live on boards. */
struct emulation {
    char images[BOARD_IMAGE_MAX]; /* the folder of images: DIR/BOARD/IMAGE */
    struct emulated_node {
        mh_node_id node;
        char board[BOARD_NAME_MAX];
    } list[BOARDS_MAX];
    size_t count;
};

/* NODE=BOARD[,NODE=BOARD...], added to what there is. Returns 0, or -1 with one line in `error`. */
int emulation_parse(struct emulation *emulation, const char *text, char *error, size_t error_size);

/* The board of `node`; NULL: none. */
const char *emulation_board(const struct emulation *emulation, mh_node_id node);

/* The folder of images when none is named: $MOTEHOUND_IMAGES, or else where tools/images puts them. */
const char *emulation_images(void);

/* How a board did. */
struct board_result {
    mh_node_id node;
    char board[BOARD_NAME_MAX], image[BOARD_IMAGE_MAX];
    bool fixed;          /* its arithmetic */
    uint64_t events;     /* that it handled */
    uint64_t cycles;     /* that they took; of QEMU, instructions ... */
    uint64_t cycles_max; /* ... the longest */
    double rate_hz;      /* so many make a second */
    struct step_cycles steps;
    uint64_t
        missed; /* events that took longer than from one sampling instant to the next, a head's or else the sensor's */
    uint64_t overlapped;            /* events that came before the one before was through */
    uint32_t ram, variables, stack; /* bytes: what there is, what is static, the stack at its deepest; 0 on the host */
    uint32_t reports_max, neighbours_max; /* capacities of the image */
};

/* RAM that was never used. */
static inline uint32_t board_ram_free(const struct board_result *result)
{
    const uint32_t used = result->variables + result->stack;
    return result->ram > used ? result->ram - used : 0;
}

struct board_results {
    struct board_result list[BOARDS_MAX];
    size_t count;
};

/* Add what a board did, to that of the same node and image if there is one. */
void board_results_add(struct board_results *results, const struct board_result *result);

/* As host_in_process, but motes with a `board` live on it, with an image from the folder `images`. Boards begin to run with their motes. Errors of
 * run(), each naming node, board and image: no such image, one that is not for this mote, a board that ends, starts anew, or answers nonsense or not at all. */
int host_boards(struct host *host, uint32_t count, const uint32_t *order, const struct mh_protocol *protocol,
                const char *images);

#endif
