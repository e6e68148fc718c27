/* Image of a mote that senses and relays, and computes nothing. */
#include "mote_parts.h"

static struct board_mote board = {
    .mote = {MOTE_PARTS}, BOARD_PARTS, .self_test = self_test_node, .report = PROTOCOL_REPORT};

int main(void)
{
    protocol_default();
    return board_mote_run(&board);
}
