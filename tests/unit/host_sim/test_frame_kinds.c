#include "frame_kinds.h"
#include "port.h"
#include "unity.h"

static struct frame_kinds kinds;
static uint8_t frame[MH_FRAME_MAX];
static size_t length;

void setUp(void) { frame_kinds_learn(&kinds); }
void tearDown(void) {}

static enum mh_status try_to_encode(enum mh_message_kind kind, enum mh_envelope_kind envelope)
{
    struct mh_message message = {.kind = kind, .envelope = envelope};
    message.header.route.sender = 7;
    return mh_wire_encode(mh_wire_all, &message, frame, &length);
}

static void encode(enum mh_message_kind kind, enum mh_envelope_kind envelope)
{
    TEST_ASSERT_EQUAL_INT(MH_OK, try_to_encode(kind, envelope));
}

static void every_message_is_known_in_every_envelope(void)
{
    for (int kind = 0; kind < MH_MESSAGE_KINDS; kind++) {
        for (int envelope = 0; envelope < MH_ENVELOPE_KINDS; envelope++) {
            if (try_to_encode((enum mh_message_kind)kind, (enum mh_envelope_kind)envelope) != MH_ERR_CAPACITY) {
                TEST_ASSERT_EQUAL_INT(kind, frame_kind(&kinds, frame, length));
            }
        }
    }
}

static void what_is_none_of_ours_is_not(void)
{
    for (int envelope = 0; envelope < MH_ENVELOPE_KINDS; envelope++) {
        encode(MH_MESSAGE_REPORT, (enum mh_envelope_kind)envelope);
        for (size_t cut = 0; cut < 8; cut++) {
            TEST_ASSERT_EQUAL_INT(MH_MESSAGE_KINDS, frame_kind(&kinds, frame, cut));
        }
    }
    frame[0] ^= 1;
    TEST_ASSERT_EQUAL_INT(MH_MESSAGE_KINDS, frame_kind(&kinds, frame, length));
}

static void an_envelope_cut_short_holds_nothing(void)
{
    size_t bare;
    encode(MH_MESSAGE_BEACON, MH_ENVELOPE_NONE);
    bare = length;
    encode(MH_MESSAGE_BEACON, MH_ENVELOPE_ROUTE);
    TEST_ASSERT_EQUAL_INT(MH_MESSAGE_BEACON, frame_kind(&kinds, frame, length - bare + 8));
    TEST_ASSERT_EQUAL_INT(MH_MESSAGE_KINDS, frame_kind(&kinds, frame, length - bare + 7));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_message_is_known_in_every_envelope);
    RUN_TEST(what_is_none_of_ours_is_not);
    RUN_TEST(an_envelope_cut_short_holds_nothing);
    port_exit(UNITY_END() > 0);
    return 0;
}
