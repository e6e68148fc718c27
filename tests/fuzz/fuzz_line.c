/* A board's line: any bytes, and any fields in a sound message. */
#include "fuzz.h"
#include "motehound/settings.h"

#include "motehound/acoustic.h"
#include "motehound/cluster.h"
#include "motehound/luo.h"
#include "motehound/pftl.h"
#include "motehound/token.h"
#if !MH_REAL_FIXED
#include "motehound/cv.h"
#include "motehound/fusion_centre.h"
#endif

enum { ROOM = 160 };

struct bytes {
    uint8_t list[4 * ROOM];
    size_t count;
};

static void put(void *context, uint8_t byte)
{
    struct bytes *bytes = context;
    require(bytes->count < sizeof bytes->list);
    bytes->list[bytes->count++] = byte;
}

/* What is understood is what a sender writes. */
static void understand(const struct mh_line_receiver *receiver)
{
    union {
        struct mh_luo_config luo;
        struct mh_pftl_config pftl;
        struct mh_acoustic_config acoustic;
        struct mh_cluster_config cluster;
        struct mh_token_config token;
#if !MH_REAL_FIXED
        struct mh_fixed_config fixed;
        struct mh_cv_config cv;
        struct mh_fusion_centre_config centre;
#endif
    } config;
    static mh_settings *const settings[] = {
        mh_settings_luo,
        mh_settings_pftl,
        mh_settings_acoustic,
        mh_settings_cluster,
#if !MH_REAL_FIXED
        mh_settings_token,
        mh_settings_fixed,
        mh_settings_cv,
        mh_settings_fusion_centre,
#endif
    };
    for (size_t i = 0; i < sizeof settings / sizeof settings[0]; i++) {
        struct mh_line_fields fields = mh_line_read(receiver);
        memset(&config, 0, sizeof config);
        settings[i](&fields, &config);
        if (mh_line_complete(&fields)) {
            struct bytes bytes = {.count = 0};
            struct mh_line_sender sender = {put, &bytes, 0};
            fields = mh_line_write(&sender);
            mh_line_begin(&sender, MH_LINE_CONFIGURE);
            settings[i](&fields, &config);
            mh_line_end(&sender);
            require(bytes.count >= receiver->length + 4u); /* flags and check sequence */
        }
    }
    struct mh_line_fields fields = mh_line_read(receiver);
    struct mh_line_identity identity;
    memset(&identity, 0, sizeof identity);
    mh_line_identity(&fields, &identity);
    require(fields.broken || strlen(identity.library) < receiver->length);

    fields = mh_line_read(receiver);
    struct mh_estimate estimate;
    memset(&estimate, 0, sizeof estimate);
    mh_line_estimate(&fields, &estimate, receiver->bytes[0] & 1);
    require(estimate.members <= MH_GROUP_MAX);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    uint8_t buffer[ROOM];
    struct mh_line_receiver receiver;
    mh_line_receiver_init(&receiver, buffer, sizeof buffer);
    for (size_t i = 0; i < size; i++) {
        if (mh_line_take(&receiver, data[i])) {
            require(receiver.length >= 1 && receiver.length <= ROOM - 2);
            understand(&receiver);
        }
    }
    /* the same bytes as a message's fields */
    struct bytes bytes = {.count = 0};
    struct mh_line_sender sender = {put, &bytes, 0};
    const size_t length = size < ROOM - 3 ? size : ROOM - 3;
    mh_line_begin(&sender, MH_LINE_REPORT);
    for (size_t i = 0; i < length; i++) {
        mh_line_byte(&sender, data[i]);
    }
    mh_line_end(&sender);
    bool whole = false;
    for (size_t i = 0; i < bytes.count; i++) {
        whole = mh_line_take(&receiver, bytes.list[i]);
    }
    require(whole && receiver.length == length + 1 && memcmp(buffer + 1, data, length) == 0);
    understand(&receiver);
    return 0;
}
