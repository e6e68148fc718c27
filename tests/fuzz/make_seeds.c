/* make_seeds WIRE_FOLDER MOTE_FOLDER TRACK_FOLDER FUSION_FOLDER FIXED_FOLDER PRINCE_FOLDER: good inputs of fuzz_wire.c, fuzz_mote.c, fuzz_track.c, fuzz_fusion.c, fuzz_fixed.c and fuzz_prince.c, for the fuzzer
 * to start from. */
#include "motehound/centroid.h"
#include "motehound/luo.h"
#include "motehound/pftl.h"
#include "motehound/wire.h"
#if !MH_REAL_FIXED
#include "motehound/acoustic.h"
#include "motehound/fusion.h"
#include "motehound/gas.h"
#include "motehound/gas_wind.h"
#include "motehound/msl.h"
#include "motehound/range.h"
#endif

#include <stdio.h>
#include <string.h>

static int save(const char *folder, const char *name, const uint8_t *bytes, size_t length)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "wb");
    if (file == NULL || fwrite(bytes, 1, length, file) != length || fclose(file) != 0) {
        perror(path);
        return -1;
    }
    return 0;
}

static int save_frame(const char *folder, const char *name, const struct mh_message *message)
{
    uint8_t frame[MH_FRAME_MAX];
    size_t length;
    return mh_wire_encode(mh_wire_all, message, frame, &length) == MH_OK ? save(folder, name, frame, length) : -1;
}

/* Every second six reports around a source that walks, then the time goes on: a track. The protocol `geographic` wants its neighbours first,
 * envelopes around reports to itself, and to hear what becomes of what it sends. */
static int save_track(const char *folder, const char *name, uint8_t choice)
{
    uint8_t input[2048] = {choice};
    size_t length = 2;
    const int geographic = choice & 16;
    for (int neighbour = 0; geographic && neighbour < 6; neighbour++) {
        const uint8_t event[] = {6, (uint8_t)neighbour, (uint8_t)(100 + 11 * neighbour), (uint8_t)(neighbour * 50), 1};
        for (size_t i = 0; i < sizeof event; i++) {
            input[length++] = event[i];
        }
    }
    for (int second = 0; second < 12; second++) {
        for (int node = 0; node < 6; node++) {
            const uint8_t event[] = {2,
                                     (uint8_t)(second * 6 + node),
                                     (uint8_t)(28 + 2 * second + node % 3 * 4),
                                     (uint8_t)(30 + node / 3 * 5),
                                     0,
                                     (uint8_t)(60 + node * 7),
                                     (uint8_t)(100 + node * 20),
                                     (uint8_t)node,
                                     (uint8_t)second,
                                     (uint8_t)(node % 2 ? 7 : 1),
                                     5,
                                     (uint8_t)(node % 3)};
            for (size_t i = 0; i < (geographic ? sizeof event : 7); i++) {
                input[length++] = event[i];
            }
        }
        input[length++] = 4;
        input[length++] = 63; /* 1,008 ms */
    }
    return save(folder, name, input, length);
}

/* The mote hears neighbours and is handed a track; at every instant five nodes answer around a target that walks, it measures itself, and so on. */
static int save_cluster(const char *folder, const char *name, uint8_t choice, uint8_t second)
{
    uint8_t input[2048] = {choice, second};
    size_t length = 2;
    for (int neighbour = 0; neighbour < 8; neighbour++) {
        const uint8_t event[] = {6, (uint8_t)(8 + neighbour), (uint8_t)(100 + 8 * neighbour), (uint8_t)(neighbour * 30),
                                 1};
        for (size_t i = 0; i < sizeof event; i++) {
            input[length++] = event[i];
        }
    }
    const uint8_t track[] = {7, 4, 0x2A, 3, 0, 4, 0, 1, 2, 3, 9};
    for (size_t i = 0; i < sizeof track; i++) {
        input[length++] = track[i];
    }
    for (int instant = 0; instant < 15; instant++) {
        const uint8_t opens[] = {7, 0, 0x29, (uint8_t)(3 + instant / 4), 128, 1, 3, 1, 50, (uint8_t)(instant % 2)};
        for (size_t i = 0; i < sizeof opens; i++) {
            input[length++] = opens[i];
        }
        for (int node = 0; node < 5; node++) {
            const uint8_t event[] = {7,
                                     1,
                                     (uint8_t)(8 + node),
                                     0,
                                     (uint8_t)(110 + 9 * node),
                                     (uint8_t)(node * 20),
                                     (uint8_t)(20 + 10 * node + instant),
                                     5,
                                     0};
            for (size_t i = 0; i < sizeof event; i++) {
                input[length++] = event[i];
            }
        }
        for (int k = 0; k < 4; k++) { /* time, and the fate of what was sent in it */
            input[length++] = 4;
            input[length++] = 16; /* 256 ms */
            input[length++] = (uint8_t)(k == 3 ? instant % 3 : 0);
        }
    }
    return save(folder, name, input, length);
}

/* The mote hears neighbours and begins a search; at every instant five nodes answer, it measures itself, and hands the token on, which is handed back. */
static int save_search(const char *folder, const char *name, uint8_t choice, uint8_t second)
{
    uint8_t input[2048] = {choice, second};
    size_t length = 2;
    for (int neighbour = 0; neighbour < 8; neighbour++) {
        const uint8_t event[] = {6, (uint8_t)(8 + neighbour), (uint8_t)(100 + 8 * neighbour), (uint8_t)(neighbour * 30),
                                 1};
        for (size_t i = 0; i < sizeof event; i++) {
            input[length++] = event[i];
        }
    }
    const uint8_t begin[] = {7, 3, 9, 1, 0, 77}, list[] = {7, 5, 9, 0, 131};
    for (size_t i = 0; i < sizeof begin; i++) {
        input[length++] = begin[i];
    }
    for (size_t i = 0; i < sizeof list; i++) {
        input[length++] = list[i];
    }
    for (int instant = 0; instant < 12; instant++) {
        for (int node = 0; node < 5; node++) {
            const uint8_t event[] = {7,
                                     1,
                                     (uint8_t)(8 + node),
                                     0,
                                     (uint8_t)(110 + 9 * node),
                                     (uint8_t)(node * 20),
                                     (uint8_t)(20 + 10 * node + instant),
                                     (uint8_t)(5 * instant + node)};
            for (size_t i = 0; i < sizeof event; i++) {
                input[length++] = event[i];
            }
        }
        for (int k = 0; k < 6; k++) { /* time, and the fate of what was sent in it */
            input[length++] = 4;
            input[length++] = 11; /* 176 ms */
            input[length++] = (uint8_t)(k == 3 ? instant % 3 : 0);
        }
        const uint8_t asks[] = {7, 0, (uint8_t)(8 + instant % 5), (uint8_t)(2 * instant), 128};
        for (size_t i = 0; i < sizeof asks; i++) {
            input[length++] = asks[i];
        }
    }
    const uint8_t leak[] = {7, 4, 9, 30, 128, 0x41, 0, 0, 0};
    for (size_t i = 0; i < sizeof leak; i++) {
        input[length++] = leak[i];
    }
    return save(folder, name, input, length);
}

/* A track, if there is such a thing, as `tracker` saves it after three instants with five ranges, then six instants of fuzz_track.c. */
static int save_saved(const char *folder, const char *name, uint8_t choice, const struct mh_tracker *tracker,
                      const void *config)
{
    static union {
        struct mh_pftl pftl;
        struct mh_centroid_state centroid;
        struct mh_luo luo;
#if !MH_REAL_FIXED
        struct mh_range range;
        struct mh_msl msl;
        struct mh_gas gas;
        struct mh_gas_gaussian gas_gaussian;
        struct mh_gas_wind gas_wind;
        struct mh_acoustic acoustic;
#endif
    } state;
    uint8_t input[512] = {choice};
    size_t length = 0;
    enum mh_status status = tracker->init(&state, config, 2000);
    for (int i = 1; i <= 3 && status == MH_OK && tracker->save != NULL; i++) {
        struct mh_measurement set[5];
        struct mh_estimate estimate;
        memset(set, 0, sizeof set);
        for (int k = 0; k < 5; k++) {
            const int row = k / 3;
            const int32_t x = k % 3 * 20 - 8 * i, y = row * 30 - 10;
            set[k].node = (mh_node_id)k;
            set[k].place.x_mm = k % 3 * 20000;
            set[k].place.y_mm = k / 3 * 30000;
            set[k].time = (mh_tick)i * 2000;
            set[k].value = mh_q20_from_real(mh_sqrt(mh_real_from_int(x * x + y * y)));
        }
        status = tracker->step(&state, (mh_tick)i * 2000, set, 5, &estimate);
    }
    if (status != MH_OK || (tracker->save != NULL && tracker->save(&state, input + 2, &length) != MH_OK)) {
        return -1;
    }
    input[1] = (uint8_t)length;
    length += 2;
    for (int i = 0; i < 6; i++) {
        input[length++] = (uint8_t)(5 + 32 * i);
        for (int k = 0; k < 5; k++) {
            const uint8_t node[] = {(uint8_t)(108 + 10 * k), (uint8_t)(120 + 9 * (k % 3)), (uint8_t)(30 + 5 * k)};
            for (size_t n = 0; n < sizeof node; n++) {
                input[length++] = node[n]; /* in four bytes where any may be: 6 km */
                for (int zeros = 0; choice & 64 && zeros < 3; zeros++) {
                    input[length++] = zeros == 0 ? (uint8_t)(node[n] * 77) : 0;
                }
            }
        }
    }
    return save(folder, name, input, length);
}

#if !MH_REAL_FIXED
/* Ten seconds of two clusters and a centre, as fuzz_fusion.c reads them: now and then a report is lost, or its acknowledgement. */
static int save_fusion(const char *folder, const char *name, uint8_t rule, uint8_t flags)
{
    uint8_t input[1024] = {rule, flags};
    size_t length = 2;
    for (int second = 0; second < 10; second++) {
        const uint8_t passes[] = {0, 124, 3}; /* 1,000 ms, three ranges each */
        memcpy(input + length, passes, sizeof passes);
        length += sizeof passes;
        for (int k = 0; k < 6; k++) {
            const uint8_t sample[] = {(uint8_t)(k * 37), (uint8_t)(20 + 6 * k + second), 0};
            memcpy(input + length, sample, sizeof sample);
            length += sizeof sample;
        }
        for (int head = 0; head < 2; head++) {
            const uint8_t tells[] = {1, (uint8_t)head, (uint8_t)(second % 4 == 3 ? 16 : 0)};
            memcpy(input + length, tells, sizeof tells);
            length += second % 5 == 2 ? 0 : sizeof tells;
        }
        const uint8_t fuses[] = {2, 0};
        memcpy(input + length, fuses, sizeof fuses);
        length += sizeof fuses;
    }
    return save(folder, name, input, length);
}

/* A mote that measures, hears samples and summaries, and what becomes of what it sends, while the time goes on. */
static int save_fixed(const char *folder, const char *name, uint8_t choice)
{
    uint8_t input[600] = {choice};
    uint32_t random = choice;
    size_t length = 1;
    for (uint8_t step = 0; length + 40 < sizeof input; step++) {
        static const uint8_t kinds[] = {6, 2, 7, 8, 3, 10, 2, 9, 5, 10, 1, 8, 10, 3};
        input[length++] = kinds[step % sizeof kinds];
        for (int i = 0; i < (kinds[step % sizeof kinds] == 3 ? 14 : 8); i++) {
            random = random * 1664525u + 1013904223u;
            input[length++] = (uint8_t)(random >> 24);
        }
    }
    return save(folder, name, input, length);
}

#endif

/* A mote that looks for targets, is told of some, hears them, is answered, and rings when it wants. */
static int save_prince(const char *folder, const char *name, uint8_t choice)
{
    uint8_t input[900] = {choice};
    uint32_t random = choice;
    size_t length = 1;
    for (uint8_t step = 0; length + 80 < sizeof input; step++) {
        static const uint8_t kinds[] = {4, 7, 7, 1, 7, 7, 2, 7, 3, 2, 7, 5, 2, 7};
        static const uint8_t operands[] = {0, 70, 9, 9, 3, 1, 2, 2};
        const uint8_t kind = kinds[step % sizeof kinds];
        input[length++] = kind;
        for (int i = 0; i < operands[kind]; i++) {
            random = random * 1664525u + 1013904223u;
            input[length++] = (uint8_t)(random >> 24);
        }
    }
    return save(folder, name, input, length);
}

int main(int argc, char **argv)
{
    if (argc != 7) {
        return 2;
    }
    const struct mh_message beacon = {.kind = MH_MESSAGE_BEACON,
                                      .as.beacon = {.sender = 3, .sink = 1, .round = 12, .hops = 2, .tracking = 1}};
    const struct mh_message report = {.kind = MH_MESSAGE_REPORT,
                                      .as.report = {.sender = 4,
                                                    .origin = 5,
                                                    .time_ms = 12000,
                                                    .x_mm = 1000,
                                                    .y_mm = -2000,
                                                    .value_q20 = 1 << 20,
                                                    .increment_q20 = 1 << 19,
                                                    .flags = 1,
                                                    .hops = 3}};
    const struct mh_message request = {.kind = MH_MESSAGE_REQUEST,
                                       .as.request = {.sender = 1,
                                                      .origin = 1,
                                                      .time_ms = 13000,
                                                      .x_mm = 5000,
                                                      .y_mm = 6000,
                                                      .radius_mm = 8000,
                                                      .sender_x_mm = -100,
                                                      .sender_y_mm = 200}};
    const struct mh_message sync = {.kind = MH_MESSAGE_SYNC,
                                    .as.sync = {.sender = 4,
                                                .root = 1,
                                                .time_ms = 14000,
                                                .fraction = 77,
                                                .stamped = 1,
                                                .number = 9,
                                                .round = 5,
                                                .hops = 2}};
    const char *wire = argv[1], *mote = argv[2], *track = argv[3];
    const struct mh_message hello = {.kind = MH_MESSAGE_HELLO,
                                     .as.hello = {.sender = 8, .x_mm = 7000, .y_mm = -3000, .sequence = 5}};
    const struct mh_message landmark = {.kind = MH_MESSAGE_LANDMARK,
                                        .as.landmark = {.beacon = beacon.as.beacon, .x_mm = 40000, .y_mm = 40000}};
    const struct mh_message ask = {.kind = MH_MESSAGE_ASK,
                                   .as.ask = {.sender = 3,
                                              .track = 2,
                                              .generation = 4,
                                              .time_ms = 14000,
                                              .x_mm = 5000,
                                              .y_mm = 6000,
                                              .vx_mmps = 4470,
                                              .vy_mmps = -100}};
    const struct mh_message answer = {
        .kind = MH_MESSAGE_ANSWER,
        .as.answer = {.sender = 5, .time_ms = 14000, .x_mm = 7000, .y_mm = 8000, .value_q20 = 20 << 20, .flags = 2}};
    struct mh_message form = {.kind = MH_MESSAGE_FORM,
                              .as.form = {.sender = 3, .track = 2, .generation = 5, .time_ms = 16000, .count = 2}};
    for (int i = 0; i < MH_FORM_MEMBERS; i++) {
        form.as.form.members[i] = i < 2 ? 7 + i : -1; /* the mote of fuzz_mote.c first */
    }
    const struct mh_message join = {.kind = MH_MESSAGE_JOIN, .as.join = {.sender = 8, .track = 2, .generation = 5}};
    struct mh_message part = {
        .kind = MH_MESSAGE_HAND_OVER,
        .as.hand_over = {.track = 2, .generation = 6, .time_ms = 14000, .parts = 1, .length = 20, .data = {1, 2, 3}}};
    part.envelope = MH_ENVELOPE_ROUTE;
    part.header.route = (mh_route_t){.sender = 3, .origin = 3, .destination = 7, .sequence = 9};
    const struct mh_message alert = {
        .kind = MH_MESSAGE_ALERT,
        .as.alert = {.sender = 8, .track = 8, .generation = 1, .time_ms = 14000, .value_q20 = 3 << 20}};
    struct mh_message position = {
        .kind = MH_MESSAGE_POSITION,
        .as.position = {
            .origin = 3, .track = 2, .generation = 4, .time_ms = 14000, .x_mm = 5000, .y_mm = 6000, .vx_mmps = 4470}};
    position.envelope = MH_ENVELOPE_ROUTE;
    position.header.route = (mh_route_t){.sender = 3, .origin = 3, .destination = 1, .x_mm = 40000, .sequence = 10};
    struct mh_message route = report;
    route.envelope = MH_ENVELOPE_ROUTE;
    route.header.route = (mh_route_t){
        .sender = 4, .origin = 5, .destination = 1, .x_mm = 40000, .y_mm = 40000, .sequence = 77, .hops = 3};
    struct mh_message face = route;
    face.envelope = MH_ENVELOPE_FACE;
    face.header.entry = 5;
    face.header.first = 4;
    face.header.sender_x_mm = 9000;
    int failed = save_frame(wire, "beacon", &beacon) || save_frame(wire, "report", &report) ||
                 save_frame(wire, "request", &request) || save_frame(wire, "hello", &hello) ||
                 save_frame(wire, "landmark", &landmark) || save_frame(wire, "route", &route) ||
                 save_frame(wire, "face", &face) || save_frame(wire, "sync", &sync) || save_frame(wire, "ask", &ask) ||
                 save_frame(wire, "answer", &answer) || save_frame(wire, "form", &form) ||
                 save_frame(wire, "join", &join) || save_frame(wire, "hand_over", &part) ||
                 save_frame(wire, "alert", &alert) || save_frame(wire, "position", &position);
    for (uint8_t choice = 0; choice < 64; choice++) {
        char name[20];
        snprintf(name, sizeof name, "track%u", choice);
        failed = failed || save_track(mote, name, choice);
    }
    for (int choice = 0; choice < 64; choice += 6) {
        for (int second = 128; second < 256; second += 21) {
            char name[20];
            snprintf(name, sizeof name, "cluster%d_%d", choice, second);
            failed = failed || save_cluster(mote, name, (uint8_t)choice, (uint8_t)second);
        }
    }
    for (uint8_t choice = 0; choice < 64; choice += 24) {
        for (uint8_t second = 64; second < 96; second++) {
            char name[20];
            snprintf(name, sizeof name, "search%u_%u", choice, second);
            failed = failed || (second % 8 < 4 && save_search(mote, name, choice, second));
        }
    }
    const struct mh_message token = {.kind = MH_MESSAGE_TOKEN,
                                     .as.token = {.sender = 8, .track = 1, .generation = 5, .holder = 9, .state = 1}};
    struct mh_message vicinity = {.kind = MH_MESSAGE_VICINITY, .as.vicinity = {.sender = 8, .count = 2}};
    for (int i = 0; i < MH_VICINITY_NODES; i++) {
        vicinity.as.vicinity.id[i] = i < 2 ? 10 + i : -1;
        vicinity.as.vicinity.y_mm[i] = i < 2 ? -30000 : 0;
    }
    const struct mh_message leak = {.kind = MH_MESSAGE_LEAK,
                                    .as.leak = {.track = 1,
                                                .generation = 4,
                                                .time_ms = 14000,
                                                .x_mm = 50000,
                                                .rate = {0x41, 0xF0},
                                                .spread = {0x40, 0x80, [8] = 0x41},
                                                .heads = 7}};
    failed = failed || save_frame(wire, "token", &token) || save_frame(wire, "vicinity", &vicinity) ||
             save_frame(wire, "leak", &leak);
    struct mh_pftl_config pftl;
    struct mh_centroid_config centroid;
    struct mh_luo_config luo;
    mh_pftl_config_default(&pftl);
    mh_centroid_config_default(&centroid);
    mh_luo_config_default(&luo);
    failed = failed || save_saved(track, "pftl", 2, &mh_tracker_pftl, &pftl) ||
             save_saved(track, "pftl_far", 47 + 64, &mh_tracker_pftl, &pftl) ||
             save_saved(track, "centroid", 4, &mh_tracker_centroid, &centroid) ||
             save_saved(track, "luo", 14, &mh_tracker_luo, &luo) ||
             save_saved(track, "luo_far", 14 + 64, &mh_tracker_luo, &luo);
#if !MH_REAL_FIXED
    struct mh_range_config range;
    struct mh_msl_config msl;
    struct mh_gas_config gas;
    struct mh_gas_wind_config gas_wind;
    mh_range_config_default(&range);
    mh_msl_config_default(&msl);
    mh_gas_config_default(&gas);
    mh_gas_wind_config_default(&gas_wind);
    gas_wind.place_count = 1;
    range.sensing_range_m = 50;
    range.height_m = 0;
    struct mh_acoustic_config acoustic, groups, plain;
    mh_acoustic_config_default(&acoustic, 40);
    groups = plain = acoustic;
    mh_group_config_default(&groups.group, MH_GROUP_MEMBERS);
    plain.separation = MH_SEPARATION_DECOMPOSITION;
    plain.filtered = false;
    failed = failed || save_saved(track, "range", 0, &mh_tracker_range, &range) ||
             save_saved(track, "range_errors", 1, &mh_tracker_range, &range) ||
             save_saved(track, "msl", 3, &mh_tracker_msl, &msl) || save_saved(track, "gas", 5, &mh_tracker_gas, &gas) ||
             save_saved(track, "gas_small", 6, &mh_tracker_gas_small, &gas) ||
             save_saved(track, "gas_ekf", 7, &mh_tracker_gas_ekf, &gas) ||
             save_saved(track, "gas_ukf", 8, &mh_tracker_gas_ukf, &gas) ||
             save_saved(track, "gas_wind", 9, &mh_tracker_gas_wind, &gas_wind) ||
             save_saved(track, "acoustic", 10, &mh_tracker_acoustic, &acoustic) ||
             save_saved(track, "acoustic_groups", 11, &mh_tracker_acoustic, &groups) ||
             save_saved(track, "dm", 12, &mh_tracker_dm, &plain) || save_saved(track, "ml", 13, &mh_tracker_ml, &plain);
    for (int rule = MH_FUSION_CI; rule < MH_FUSION_CENTRAL; rule++) {
        char name[20];
        snprintf(name, sizeof name, "rule%d", rule);
        failed = failed || save_fusion(argv[4], name, (uint8_t)rule, (uint8_t)(rule % 4));
    }
    for (int choice = 0; choice < 256; choice += 5) {
        char name[20];
        snprintf(name, sizeof name, "fixed%d", choice);
        failed = failed || save_fixed(argv[5], name, (uint8_t)choice);
    }
#endif
    for (int choice = 0; choice < 128; choice++) {
        char name[20];
        snprintf(name, sizeof name, "prince%d", choice);
        failed = failed || save_prince(argv[6], name, (uint8_t)choice);
    }
    return failed ? 1 : 0;
}
