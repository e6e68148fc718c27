#include "motehound/collection.h"
#include "motehound/line.h"
#include "motehound/luo.h"
#include "motehound/settings.h"
#include "port.h"
#include "unity.h"

#include <string.h>

/* A line: what is sent lies here until it is received. */
static uint8_t wire[600], buffer[200];
static uint16_t sent;
static struct mh_line_receiver receiver;

static void put(void *context, uint8_t byte)
{
    (void)context;
    wire[sent++] = byte;
}

static struct mh_line_sender sender = {.put = put};

void setUp(void)
{
    sent = 0;
    mh_line_receiver_init(&receiver, buffer, sizeof buffer);
}

void tearDown(void) {}

/* How many messages what has been sent is. */
static uint8_t receive(void)
{
    uint8_t messages = 0;
    for (uint16_t i = 0; i < sent; i++) {
        messages = (uint8_t)(messages + mh_line_take(&receiver, wire[i]));
    }
    return messages;
}

static void send_frame(const uint8_t *bytes, uint16_t length)
{
    mh_line_begin(&sender, MH_LINE_FRAME);
    struct mh_line_fields fields = mh_line_write(&sender);
    mh_line_bytes(&fields, &bytes, &length);
    mh_line_end(&sender);
}

static void empty_message_is_as_defined(void)
{
    mh_line_begin(&sender, MH_LINE_IDENTIFY);
    mh_line_end(&sender);
    /* x^16 + x^12 + x^5 + 1, reflected, of the byte 1 */
    const uint8_t expected[] = {0x7E, 0x01, 0x89, 0x11, 0x7E};
    TEST_ASSERT_EQUAL_UINT16(sizeof expected, sent);
    TEST_ASSERT_EQUAL_UINT8_ARRAY(expected, wire, sizeof expected);
    TEST_ASSERT_EQUAL_UINT8(1, receive());
    TEST_ASSERT_EQUAL_UINT16(1, receiver.length);
}

static void every_byte_comes_through(void)
{
    uint8_t bytes[128];
    for (uint16_t first = 0; first < 256; first += 64) {
        for (uint16_t i = 0; i < sizeof bytes; i++) {
            bytes[i] = (uint8_t)(first + i);
        }
        setUp();
        send_frame(bytes, sizeof bytes);
        for (uint16_t i = 1; i + 1 < sent; i++) {
            TEST_ASSERT_TRUE(wire[i] != 0x7E);
        }
        TEST_ASSERT_EQUAL_UINT8(1, receive());
        TEST_ASSERT_EQUAL_UINT8(MH_LINE_FRAME, buffer[0]);
        struct mh_line_fields fields = mh_line_read(&receiver);
        const uint8_t *back;
        uint16_t length;
        mh_line_bytes(&fields, &back, &length);
        TEST_ASSERT_TRUE(mh_line_complete(&fields));
        TEST_ASSERT_EQUAL_UINT16(sizeof bytes, length);
        TEST_ASSERT_EQUAL_UINT8_ARRAY(bytes, back, sizeof bytes);
    }
}

/* Each bit of a frame turned: never another message, and the one behind it comes through. The flag between two frames is both's. */
static void damage_is_noticed(void)
{
    const uint8_t bytes[] = {0x7E, 0x00, 0x7D, 0x5E, 0xFF};
    send_frame(bytes, sizeof bytes);
    const uint16_t end = sent;
    mh_line_begin(&sender, MH_LINE_IDENTIFY);
    mh_line_end(&sender);
    for (uint16_t bit = 0; bit < 8 * end; bit++) {
        mh_line_receiver_init(&receiver, buffer, sizeof buffer);
        wire[bit / 8] = (uint8_t)(wire[bit / 8] ^ (1u << bit % 8));
        uint8_t of_it = 0;
        for (uint16_t i = 0; i < sent; i++) {
            const bool whole = mh_line_take(&receiver, wire[i]);
            of_it = (uint8_t)(of_it + (whole && buffer[0] == MH_LINE_FRAME));
            TEST_ASSERT_TRUE(whole == (i + 1 == sent) || bit < 8 || bit >= 8 * (end - 1u));
        }
        TEST_ASSERT_EQUAL_UINT8(MH_LINE_IDENTIFY, buffer[0]);
        TEST_ASSERT_TRUE(of_it == 0 || bit >= 8 * (end - 1u)); /* the next frame's flag ends it too */
        TEST_ASSERT_TRUE(receiver.damaged > 0 || bit >= 8 * (end - 1u));
        wire[bit / 8] = (uint8_t)(wire[bit / 8] ^ (1u << bit % 8));
    }
}

static void too_long_is_dropped(void)
{
    uint8_t bytes[sizeof buffer] = {0};
    send_frame(bytes, sizeof buffer - 2);
    TEST_ASSERT_EQUAL_UINT8(0, receive());
    TEST_ASSERT_EQUAL_UINT16(1, receiver.damaged);
    sent = 0;
    send_frame(bytes, sizeof buffer - 3);
    TEST_ASSERT_EQUAL_UINT8(1, receive());
}

static void settings_come_back(void)
{
    const struct mh_collection_config routing = {30000, 100, 40, 3, 15000, 5, 20};
    struct mh_collection_config routing_back;
    struct mh_luo_config luo, luo_back;
    memset(&luo, 0, sizeof luo);
    memset(&luo_back, 0xA5, sizeof luo_back);
    memset(&routing_back, 0xA5, sizeof routing_back);
    luo.diffusion_m2ps = MH_REAL(1.25f);
    luo.chi = MH_REAL(0.2f);
    luo.filter.measurement_floor = MH_REAL(-300.5f);
    luo.stop_outside = true;
    luo.region.y_max_mm = -80000;
    luo.inside_mm = 5000;

    struct mh_line_fields fields = mh_line_write(&sender);
    mh_line_begin(&sender, MH_LINE_CONFIGURE);
    mh_settings_luo(&fields, &luo);
    mh_settings_collection(&fields, (void *)&routing);
    mh_line_end(&sender);
    TEST_ASSERT_EQUAL_UINT8(1, receive());
    fields = mh_line_read(&receiver);
    mh_settings_luo(&fields, &luo_back);
    mh_settings_collection(&fields, &routing_back);
    TEST_ASSERT_TRUE(mh_line_complete(&fields));
    TEST_ASSERT_TRUE(luo.diffusion_m2ps == luo_back.diffusion_m2ps && luo.chi == luo_back.chi &&
                     luo.filter.measurement_floor == luo_back.filter.measurement_floor);
    TEST_ASSERT_TRUE(luo_back.stop_outside && !luo_back.nonlinear);
    TEST_ASSERT_EQUAL_INT32(-80000, luo_back.region.y_max_mm);
    TEST_ASSERT_EQUAL_INT32(5000, luo_back.inside_mm);
    TEST_ASSERT_EQUAL_UINT32(30000, routing_back.beacon_period);
    TEST_ASSERT_EQUAL_UINT8(3, routing_back.suppress_after);
    TEST_ASSERT_EQUAL_UINT8(5, routing_back.attempts);
    TEST_ASSERT_EQUAL_UINT32(20, routing_back.backoff);
}

/* 300 for a variable of 8 bits, 2 for a bool; a field too few. */
static void what_does_not_fit_is_broken(void)
{
    uint32_t numbers[] = {300, 2};
    mh_line_begin(&sender, MH_LINE_CONFIGURE);
    struct mh_line_fields fields = mh_line_write(&sender);
    mh_line_u32(&fields, &numbers[0]);
    mh_line_u32(&fields, &numbers[1]);
    mh_line_end(&sender);
    (void)receive();
    uint8_t eight = 7;
    bool yes = true;
    fields = mh_line_read(&receiver);
    mh_line_u8(&fields, &eight);
    TEST_ASSERT_TRUE(fields.broken);
    TEST_ASSERT_EQUAL_UINT8(7, eight);
    fields = mh_line_read(&receiver);
    mh_line_u32(&fields, &numbers[0]);
    TEST_ASSERT_FALSE(fields.broken || mh_line_complete(&fields));
    mh_line_bool(&fields, &yes);
    TEST_ASSERT_TRUE(fields.broken && yes);
    fields = mh_line_read(&receiver);
    mh_line_u32(&fields, &numbers[0]);
    mh_line_u32(&fields, &numbers[1]);
    TEST_ASSERT_TRUE(mh_line_complete(&fields));
    mh_line_u16(&fields, &(uint16_t){0});
    TEST_ASSERT_TRUE(fields.broken);
}

static void identity_comes_back(void)
{
    struct mh_line_identity identity = {.version = MH_LINE_VERSION,
                                        .self_test_passed = true,
                                        .board = "atmega128",
                                        .protocol = "collection",
                                        .tracker = "",
                                        .library = "1.0",
                                        .reports_max = 24,
                                        .cycles_per_s = 7372800,
                                        .ram_size = 4096};
    mh_line_begin(&sender, MH_LINE_IDENTITY);
    struct mh_line_fields fields = mh_line_write(&sender);
    mh_line_identity(&fields, &identity);
    mh_line_end(&sender);
    TEST_ASSERT_EQUAL_UINT8(1, receive());
    memset(&identity, 0, sizeof identity);
    fields = mh_line_read(&receiver);
    mh_line_identity(&fields, &identity);
    TEST_ASSERT_TRUE(mh_line_complete(&fields));
    TEST_ASSERT_EQUAL_STRING("atmega128", identity.board);
    TEST_ASSERT_EQUAL_STRING("", identity.tracker);
    TEST_ASSERT_EQUAL_STRING("1.0", identity.library);
    TEST_ASSERT_TRUE(identity.self_test_passed && !identity.fixed);
    TEST_ASSERT_EQUAL_UINT32(7372800, identity.cycles_per_s);
    receiver.length = 25; /* cut off in a text */
    fields = mh_line_read(&receiver);
    mh_line_identity(&fields, &identity);
    TEST_ASSERT_TRUE(fields.broken);
}

static void estimate_comes_back(void)
{
    struct mh_estimate estimate, back;
    memset(&estimate, 0, sizeof estimate);
    memset(&back, 0, sizeof back);
    estimate.position.x = MH_REAL(12345.678f) + MH_REAL_MIN;
    estimate.covariance_more[6] = MH_REAL(-2);
    estimate.flags = MH_ESTIMATE_MIRRORED;
    estimate.members = 2;
    estimate.of[1] = 99;
    mh_line_begin(&sender, MH_LINE_REPORT);
    struct mh_line_fields fields = mh_line_write(&sender);
    mh_line_estimate(&fields, &estimate, MH_REAL_FIXED != 0);
    mh_line_end(&sender);
    TEST_ASSERT_EQUAL_UINT8(1, receive());
    fields = mh_line_read(&receiver);
    mh_line_estimate(&fields, &back, MH_REAL_FIXED != 0);
    TEST_ASSERT_TRUE(mh_line_complete(&fields));
    TEST_ASSERT_TRUE(back.position.x == estimate.position.x);
    TEST_ASSERT_TRUE(back.covariance_more[6] == MH_REAL(-2));
    TEST_ASSERT_EQUAL_UINT16(MH_ESTIMATE_MIRRORED, back.flags);
    TEST_ASSERT_EQUAL_UINT8(2, back.members);
    TEST_ASSERT_EQUAL_UINT32(99, back.of[1]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(empty_message_is_as_defined);
    RUN_TEST(every_byte_comes_through);
    RUN_TEST(damage_is_noticed);
    RUN_TEST(too_long_is_dropped);
    RUN_TEST(settings_come_back);
    RUN_TEST(what_does_not_fit_is_broken);
    RUN_TEST(identity_comes_back);
    RUN_TEST(estimate_comes_back);
    port_exit(UNITY_END() > 0);
}
