#include "motehound/parcel.h"
#include "port.h"
#include "unity.h"

#include <string.h>

#define ROOM 200

static uint8_t sent[ROOM], received[ROOM + 1];
static struct mh_parcel parcel;

void setUp(void)
{
    for (uint8_t i = 0; i < ROOM; i++) {
        sent[i] = (uint8_t)(i * 7 + 1);
    }
    memset(received, 0xEE, sizeof received);
    memset(&parcel, 0, sizeof parcel);
}

void tearDown(void) {}

static mh_hand_over_t part_of(size_t length, uint8_t part, int32_t generation)
{
    mh_hand_over_t message = {.track = 5, .generation = generation};
    memset(message.data, 0xAA, sizeof message.data);
    mh_parcel_cut(sent, length, part, &message);
    return message;
}

static enum mh_status join(const mh_hand_over_t *part) { return mh_parcel_join(&parcel, received, ROOM, 3, part); }

static void expect_whole(size_t length)
{
    TEST_ASSERT_EQUAL_UINT16(length, parcel.length);
    TEST_ASSERT_EQUAL_MEMORY(sent, received, length);
}

static void every_length_makes_the_round_trip(void)
{
    for (size_t length = 1; length <= ROOM; length++) {
        const uint8_t parts = (uint8_t)MH_PARCEL_PARTS(length);
        TEST_ASSERT_EQUAL(length / 64 + (length % 64 > 0), parts);
        for (uint8_t k = 0; k < parts; k++) {
            const mh_hand_over_t part = part_of(length, k, 1);
            TEST_ASSERT_EQUAL(k + 1 < parts ? MH_NONE : MH_OK, join(&part));
        }
        expect_whole(length);
    }
    TEST_ASSERT_EQUAL_HEX8(0xEE, received[ROOM]);
}

static void what_a_part_does_not_fill_is_zero(void)
{
    const mh_hand_over_t part = part_of(65, 1, 1);
    TEST_ASSERT_EQUAL_UINT8(1, part.length);
    TEST_ASSERT_EQUAL_HEX8(sent[64], part.data[0]);
    for (uint8_t i = 1; i < MH_HAND_OVER_BYTES; i++) {
        TEST_ASSERT_EQUAL_HEX8(0, part.data[i]);
    }
}

static void parts_come_in_any_order_and_more_than_once(void)
{
    const uint8_t order[] = {2, 0, 2, 3, 0}; /* of 0, 1, 2, 3 */
    for (size_t i = 0; i < sizeof order; i++) {
        const mh_hand_over_t part = part_of(193, order[i], 1);
        TEST_ASSERT_EQUAL(i == 2 || i == 4 ? MH_ERR_REPEATED : MH_NONE, join(&part));
    }
    const mh_hand_over_t last = part_of(193, 1, 1);
    TEST_ASSERT_EQUAL(MH_OK, join(&last));
    expect_whole(193);
}

static void a_part_of_another_parcel_begins_anew(void)
{
    const mh_hand_over_t old = part_of(100, 0, 1), first = part_of(100, 0, 2), second = part_of(100, 1, 2);
    TEST_ASSERT_EQUAL(MH_NONE, join(&old));
    TEST_ASSERT_EQUAL(MH_NONE, join(&second)); /* with the old first part it would not be whole */
    TEST_ASSERT_EQUAL(MH_OK, join(&first));
    expect_whole(100);
    TEST_ASSERT_EQUAL(MH_NONE, join(&first));
    TEST_ASSERT_EQUAL(MH_NONE, mh_parcel_join(&parcel, received, ROOM, 4, &second)); /* from another */
    mh_hand_over_t other = first;
    other.track = 6;
    TEST_ASSERT_EQUAL(MH_NONE, join(&other));
    TEST_ASSERT_EQUAL(MH_NONE, join(&second));
    TEST_ASSERT_EQUAL(MH_OK, join(&first));
    expect_whole(100);
}

static void what_nobody_cuts_is_refused(void)
{
    mh_hand_over_t part = part_of(100, 0, 1);
    part.length = 63; /* not full, though not the last */
    TEST_ASSERT_EQUAL(MH_ERR_CORRUPT, join(&part));
    part = part_of(100, 1, 1);
    part.length = 65;
    TEST_ASSERT_EQUAL(MH_ERR_CORRUPT, join(&part));
    part.length = 0;
    TEST_ASSERT_EQUAL(MH_ERR_CORRUPT, join(&part));
    part = part_of(100, 1, 1);
    part.parts = 1;
    TEST_ASSERT_EQUAL(MH_ERR_CORRUPT, join(&part));
    TEST_ASSERT_FALSE(parcel.begun);
}

static void what_does_not_fit_is_refused(void)
{
    const mh_hand_over_t last = part_of(ROOM, 3, 1);
    TEST_ASSERT_EQUAL(MH_NONE, join(&last));
    mh_hand_over_t part = part_of(ROOM, 3, 1);
    part.length++;
    TEST_ASSERT_EQUAL(MH_ERR_CAPACITY, join(&part));
    part.part = 200;
    part.parts = 201;
    TEST_ASSERT_EQUAL(MH_ERR_CAPACITY, join(&part));
    part = part_of(ROOM, 0, 1);
    part.parts = MH_PARCEL_PARTS_MAX + 1;
    TEST_ASSERT_EQUAL(MH_ERR_CAPACITY, join(&part));
    TEST_ASSERT_EQUAL_UINT8(4, parcel.parts);
    TEST_ASSERT_EQUAL_HEX8(0xEE, received[ROOM]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_length_makes_the_round_trip);
    RUN_TEST(what_a_part_does_not_fill_is_zero);
    RUN_TEST(parts_come_in_any_order_and_more_than_once);
    RUN_TEST(a_part_of_another_parcel_begins_anew);
    RUN_TEST(what_nobody_cuts_is_refused);
    RUN_TEST(what_does_not_fit_is_refused);
    port_exit(UNITY_END() > 0);
    return 0;
}
