#include "fusion_answers.h"
#include "motehound/summary.h"
#include "port.h"

#include <string.h>

void setUp(void) {}
void tearDown(void) {}

static uint8_t bytes[MH_SUMMARY_BYTES_MAX];
static struct mh_summary summary, back;

static size_t write(enum mh_summary_kind kind)
{
    memset(&summary, 0, sizeof summary);
    summary.kind = kind;
    if (kind == MH_SUMMARY_SPLIT) {
        summary.of.split.dependent = told[1];
        memcpy(summary.of.split.independent, told[2].P, sizeof told[2].P);
    } else if (kind == MH_SUMMARY_INCREMENT) {
        summary.of.increment.n = 4;
        summary.of.increment.vector[3] = -7;
        summary.of.increment.matrix[9] = 0.25f;
        summary.since = 0xfffffff0u;
    } else {
        summary.of.plain = told[0];
        summary.clusters = kind == MH_SUMMARY_FUSED ? 0x8005 : 0;
    }
    return mh_summary_write(&summary, bytes);
}

static void what_is_written_is_read(void)
{
    static const uint8_t lengths[] = {57, 97, 61, 59};
    for (int kind = MH_SUMMARY_PLAIN; kind <= MH_SUMMARY_FUSED; kind++) {
        const size_t length = write((enum mh_summary_kind)kind);
        TEST_ASSERT_EQUAL_UINT(lengths[kind - 1], length);
        TEST_ASSERT_EQUAL_UINT(kind, bytes[0]);
        memset(&back, 0x5a, sizeof back);
        TEST_ASSERT_EQUAL_INT(MH_OK, mh_summary_read(&back, bytes, length));
        TEST_ASSERT_EQUAL_INT(summary.kind, back.kind);
        TEST_ASSERT_EQUAL_MEMORY(&summary.of, &back.of, sizeof summary.of);
        TEST_ASSERT_EQUAL_UINT32(summary.since, back.since);
        TEST_ASSERT_EQUAL_UINT(summary.clusters, back.clusters);
    }
    /* the first number of a plain one: 10, the most significant byte first */
    write(MH_SUMMARY_PLAIN);
    TEST_ASSERT_EQUAL_HEX8(0x41, bytes[1]);
    TEST_ASSERT_EQUAL_HEX8(0x20, bytes[2]);
}

static void what_is_in_it(void)
{
    size_t length = write(MH_SUMMARY_FUSED);
    TEST_ASSERT_TRUE(mh_summary_holds(bytes, length, 0));
    TEST_ASSERT_FALSE(mh_summary_holds(bytes, length, 1));
    TEST_ASSERT_TRUE(mh_summary_holds(bytes, length, 2));
    TEST_ASSERT_TRUE(mh_summary_holds(bytes, length, 15));
    TEST_ASSERT_FALSE(mh_summary_holds(bytes, length, 16));
    TEST_ASSERT_FALSE(mh_summary_holds(bytes, length - 1, 0));
    length = write(MH_SUMMARY_PLAIN);
    TEST_ASSERT_FALSE(mh_summary_holds(bytes, length, 0));
}

static void assert_corrupt(size_t length)
{
    struct mh_summary before;
    memset(&before, 0x5a, sizeof before);
    back = before;
    TEST_ASSERT_EQUAL_INT(MH_ERR_CORRUPT, mh_summary_read(&back, bytes, length));
    TEST_ASSERT_EQUAL_MEMORY(&before, &back, sizeof back);
}

static void what_is_none_is_refused(void)
{
    static const uint8_t none[4] = {0x7f, 0xc0, 0, 0}; /* NaN */
    for (int kind = MH_SUMMARY_PLAIN; kind <= MH_SUMMARY_FUSED; kind++) {
        const size_t length = write((enum mh_summary_kind)kind);
        for (size_t cut = 0; cut < length; cut++) {
            assert_corrupt(cut);
        }
        memcpy(bytes + 1 + 4 * 3, none, sizeof none);
        assert_corrupt(length);
        if (kind != MH_SUMMARY_INCREMENT) {
            write((enum mh_summary_kind)kind);
            bytes[1 + 4 * 4] |= 0x80; /* a negative variance */
            assert_corrupt(length);
        }
        write((enum mh_summary_kind)kind);
        bytes[0] = 0;
        assert_corrupt(length);
        bytes[0] = 5;
        assert_corrupt(length);
        bytes[0] = (uint8_t)(kind % 4 + 1); /* of another length */
        assert_corrupt(length);
    }
    write(MH_SUMMARY_SPLIT);
    bytes[1 + 4 * 14] |= 0x80; /* negative in the independent part only */
    assert_corrupt(97);
}

static void kinds_of_rules(void)
{
    TEST_ASSERT_EQUAL_INT(MH_SUMMARY_PLAIN, mh_summary_kind_of(MH_FUSION_CI));
    TEST_ASSERT_EQUAL_INT(MH_SUMMARY_PLAIN, mh_summary_kind_of(MH_FUSION_NAIVE));
    TEST_ASSERT_EQUAL_INT(MH_SUMMARY_SPLIT, mh_summary_kind_of(MH_FUSION_SCI));
    TEST_ASSERT_EQUAL_INT(MH_SUMMARY_INCREMENT, mh_summary_kind_of(MH_FUSION_HIF_FEEDBACK));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_is_written_is_read);
    RUN_TEST(what_is_in_it);
    RUN_TEST(what_is_none_is_refused);
    RUN_TEST(kinds_of_rules);
    port_exit(UNITY_END() > 0);
    return 0;
}
