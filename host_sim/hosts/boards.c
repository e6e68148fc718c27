#include "hosts/boards.h"

#include "frame_kinds.h"
#include "motehound/acoustic.h"
#include "motehound/cluster.h"
#include "motehound/fixed.h"
#include "motehound/pftl.h"
#include "motehound/prince.h"
#include "motehound/settings.h"
#include "reals.h"
#include "scenario/text.h"

#if !MH_REAL_FIXED
#include "motehound/cv.h"
#endif

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    MESSAGE_MAX = 2 * MH_LINE_TO_BOARD_MAX + 2,
    READ_MAX = 512,
    MESSAGES_PER_EVENT = 1000,
    IDENTIFY_TRIES = 100,
    TEXT_MAX = 40
};

/* How long a board may be silent, and how long before it is asked again who it is: it may have been starting. */
static const double patience_s = 20, start_s = 0.1;

/* What an event has led to so far. */
struct outcome {
    bool done, reported;
    enum mh_message_kind sent;
    struct mh_line_done answer;
};

/* One mote on its board. */
struct board {
    uint32_t index;
    struct host_mote what;
    const struct board_kind *kind;
    struct board_line line;
    bool open, up, started;     /* the board runs; the mote is on; it has been on */
    bool identifies;            /* the next DONE is that of an IDENTIFY */
    sim_time alarm, busy_until; /* busy: with what came before, had it taken its time */
    struct mh_line_receiver receiver;
    uint8_t message[MH_LINE_FROM_BOARD_MAX], read[READ_MAX];
    size_t read_at, read_count;
    struct mh_line_identity identity;
    char texts[4][TEXT_MAX];    /* of the identity */
    struct host_totals counted; /* as last told */
    struct board_result result;
};

struct boards {
    struct host native;
    const char *images;
    struct board *list[BOARDS_MAX];
    size_t count;
    struct frame_kinds kinds;
    struct host_totals past;   /* events, and the counters of motes that have started anew */
    struct host_event *events; /* of a window, those of the motes of this process ... */
    uint32_t *receivers;       /* ... and the receivers of their frames */
    size_t event_capacity, receiver_capacity;
    /* during run() */
    sim_time now;
    struct host_actions *actions;
    char *error;
    size_t error_size;
};

/* ---- which and where ---- */

int emulation_parse(struct emulation *emulation, const char *text, char *error, size_t error_size)
{
    for (const char *at = text;; at++) {
        const size_t length = strcspn(at, ",");
        char *end;
        const unsigned long node = strtoul(at, &end, 10);
        const size_t name = length - (size_t)(end - at) - 1;
        struct emulated_node *entry = &emulation->list[emulation->count];
        if (*at < '0' || *at > '9' || *end != '=' || node >= MH_BROADCAST) {
            return fail(error, error_size, "--emulate: expected NODE=BOARD, found '%.*s'", (int)length, at);
        }
        if (emulation->count == BOARDS_MAX) {
            return fail(error, error_size, "--emulate: expected at most %d nodes, found more", BOARDS_MAX);
        }
        if (emulation_board(emulation, (mh_node_id)node)) {
            return fail(error, error_size, "--emulate: expected each node once, found %lu again", node);
        }
        snprintf(entry->board, sizeof entry->board, "%.*s", (int)name, end + 1);
        if (name >= sizeof entry->board || !board_kind_find(entry->board)) {
            return fail(error, error_size, "--emulate: expected a board, %s, found '%.*s'", BOARD_NAMES, (int)name,
                        end + 1);
        }
        entry->node = (mh_node_id)node;
        emulation->count++;
        at += length;
        if (*at == '\0') {
            return 0;
        }
    }
}

const char *emulation_board(const struct emulation *emulation, mh_node_id node)
{
    for (size_t i = 0; emulation && i < emulation->count; i++) {
        if (emulation->list[i].node == node) {
            return emulation->list[i].board;
        }
    }
    return NULL;
}

const char *emulation_images(void)
{
    const char *named = getenv("MOTEHOUND_IMAGES");
    return named ? named : MOTEHOUND_IMAGE_FOLDER;
}

void board_results_add(struct board_results *results, const struct board_result *result)
{
    for (size_t i = 0; i < results->count; i++) {
        struct board_result *known = &results->list[i];
        if (known->node == result->node && strcmp(known->image, result->image) == 0) {
            known->events += result->events;
            known->cycles += result->cycles;
            known->cycles_max = known->cycles_max > result->cycles_max ? known->cycles_max : result->cycles_max;
            step_cycles_add(&known->steps, &result->steps);
            known->missed += result->missed;
            known->overlapped += result->overlapped;
            known->stack = known->stack > result->stack ? known->stack : result->stack;
            return;
        }
    }
    if (results->count < BOARDS_MAX) {
        results->list[results->count++] = *result;
    }
}

static int trouble(struct boards *boards, const struct board *board, const char *what)
{
    return fail(boards->error, boards->error_size, "node %lu on board %s %s, at %.3f s; image %s",
                (unsigned long)board->what.id, board->what.board, what, (double)boards->now / SIM_TIME_PER_S,
                board->result.image);
}

/* ---- messages to a board ---- */

struct message {
    struct mh_line_sender sender;
    struct mh_line_fields fields;
    uint8_t bytes[MESSAGE_MAX];
    size_t count;
};

static void put(void *context, uint8_t byte)
{
    struct message *message = context;
    if (message->count < MESSAGE_MAX) {
        message->bytes[message->count++] = byte;
    }
}

static void begin(struct message *message, enum mh_line_kind kind)
{
    message->count = 0;
    message->sender = (struct mh_line_sender){.put = put, .context = message};
    message->fields = mh_line_write(&message->sender);
    mh_line_begin(&message->sender, kind);
}

static void put_number(struct message *message, uint32_t number) { mh_line_u32(&message->fields, &number); }

/* An event begins: with the mote's time, now. */
static void begin_event(const struct boards *boards, const struct board *board, struct message *message,
                        enum mh_line_kind kind)
{
    begin(message, kind);
    put_number(message, local_clock_tick(&board->what.clock, boards->now));
}

/* ---- messages from a board ---- */

static struct host_action *act(struct boards *boards, const struct board *board, enum host_action_kind kind)
{
    struct host_action *action = host_actions_add(boards->actions);
    if (!action) {
        fail(boards->error, boards->error_size, "out of memory");
        return NULL;
    }
    action->time = boards->now;
    action->kind = kind;
    action->mote = board->index;
    return action;
}

static int take_frame(struct boards *boards, const struct board *board, struct mh_line_fields *fields,
                      struct outcome *outcome)
{
    uint32_t destination = 0;
    const uint8_t *bytes = NULL;
    uint16_t length = 0;
    mh_line_u32(fields, &destination);
    mh_line_bytes(fields, &bytes, &length);
    if (fields->broken || length > MH_FRAME_MAX) {
        return trouble(boards, board, "sends a frame that is none");
    }
    struct host_action *action = act(boards, board, HOST_TRANSMIT);
    if (!action) {
        return -1;
    }
    outcome->sent = frame_kind(&boards->kinds, bytes, length);
    action->as.transmit.destination = destination;
    action->as.transmit.length = (uint8_t)length;
    memcpy(action->as.transmit.bytes, bytes, length);
    return 0;
}

static int take_clock(struct boards *boards, const struct board *board, struct mh_line_fields *fields)
{
    bool known = false;
    mh_tick shown = 0;
    uint8_t fraction = 0;
    mh_line_bool(fields, &known);
    mh_line_u32(fields, &shown);
    mh_line_u8(fields, &fraction);
    struct host_action *action = act(boards, board, HOST_CLOCK);
    if (!action) {
        return -1;
    }
    action->as.clock_error_s = known ? host_clock_error_s(shown, fraction, boards->now) : (double)NAN;
    return 0;
}

static int take_fault(struct boards *boards, const struct board *board, struct mh_line_fields *fields)
{
    static const char *const causes[] = {"nothing known", "a processor fault", "its stack ran over", "its watchdog",
                                         "a check of the program's own"};
    uint8_t cause = 0;
    uint32_t address = 0;
    char text[100];
    mh_line_u8(fields, &cause);
    mh_line_u32(fields, &address);
    snprintf(text, sizeof text, "has started anew: %s at 0x%lx",
             causes[cause < sizeof causes / sizeof causes[0] ? cause : 0], (unsigned long)address);
    return trouble(boards, board, text);
}

/* A text of a message, which outlives the message. */
static void keep(const char **text, char copy[TEXT_MAX])
{
    snprintf(copy, TEXT_MAX, "%s", *text);
    *text = copy;
}

/* One message of the board: what its mote does goes to the actions, what else there is to the outcome. `starts`: it runs free until it has been asked who it
 * is, and what it does until then is of no account. */
static int take(struct boards *boards, struct board *board, bool starts, struct outcome *outcome)
{
    struct mh_line_fields fields = mh_line_read(&board->receiver);
    struct host_action *action;
    mh_tick time = 0;
    const uint8_t kind = board->receiver.bytes[0];
    if (starts && kind != MH_LINE_IDENTITY && kind != MH_LINE_DONE && kind != MH_LINE_FAULT) {
        return 0;
    }
    switch (kind) {
    case MH_LINE_IDENTITY:
        board->identifies = true;
        mh_line_identity(&fields, &board->identity);
        if (mh_line_complete(&fields)) {
            keep(&board->identity.board, board->texts[0]);
            keep(&board->identity.protocol, board->texts[1]);
            keep(&board->identity.tracker, board->texts[2]);
            keep(&board->identity.library, board->texts[3]);
        }
        break;
    case MH_LINE_TRANSMIT:
        return take_frame(boards, board, &fields, outcome);
    case MH_LINE_SET_ALARM:
        mh_line_u32(&fields, &time);
        board->alarm = host_alarm_time(&board->what.clock, boards->now, time);
        break;
    case MH_LINE_REPORT:
        action = act(boards, board, HOST_REPORT);
        if (!action) {
            return -1;
        }
        action->as.estimate = (struct mh_estimate){.states = 0};
        mh_line_estimate(&fields, &action->as.estimate, board->result.fixed);
        outcome->reported = true;
        break;
    case MH_LINE_SLEEP:
        action = act(boards, board, HOST_SLEEP);
        if (!action) {
            return -1;
        }
        action->as.may_sleep = false;
        mh_line_bool(&fields, &action->as.may_sleep);
        break;
    case MH_LINE_SENSE:
        if (!act(boards, board, HOST_SENSE)) {
            return -1;
        }
        break;
    case MH_LINE_CLOCK:
        if (take_clock(boards, board, &fields) != 0) {
            return -1;
        }
        break;
    case MH_LINE_COUNTERS:
        board->counted = (struct host_totals){.events = 0};
        mh_line_counters(&fields, &board->counted.motes, &board->counted.heads, &board->counted.protocols);
        break;
    case MH_LINE_DONE:
        mh_line_done(&fields, &outcome->answer);
        outcome->done = board->identifies == starts; /* else of an IDENTIFY that was given up */
        board->identifies = false;
        break;
    case MH_LINE_FAULT:
        return take_fault(boards, board, &fields);
    default:
        return trouble(boards, board, "says what no board says");
    }
    return mh_line_complete(&fields) ? 0 : trouble(boards, board, "sends a message of the wrong length or content");
}

/* The next message -> board->receiver. Returns 1, 0 if none comes within wait_s, or -1. */
static int receive(struct boards *boards, struct board *board, double wait_s)
{
    char why[300];
    for (;;) {
        if (board->read_at == board->read_count) {
            const long count = board->line.get(board->line.state, board->read, READ_MAX, wait_s, why, sizeof why);
            if (count <= 0) {
                return count == 0 ? 0 : trouble(boards, board, why);
            }
            board->read_at = 0;
            board->read_count = (size_t)count;
        }
        if (mh_line_take(&board->receiver, board->read[board->read_at++])) {
            return 1;
        }
    }
}

/* Send the message and take what comes until the board is done. With wait_s it need not answer: then outcome->done is false. */
static int ask(struct boards *boards, struct board *board, struct message *message, double wait_s,
               struct outcome *outcome)
{
    char why[300];
    *outcome = (struct outcome){.sent = MH_MESSAGE_KINDS};
    mh_line_end(&message->sender);
    if (board->line.put(board->line.state, message->bytes, message->count, why, sizeof why) != 0) {
        return trouble(boards, board, why);
    }
    for (int messages = 0; !outcome->done; messages++) {
        const int came = receive(boards, board, wait_s > 0 ? wait_s : patience_s);
        if (came < 0 || (came > 0 && take(boards, board, wait_s > 0, outcome) != 0)) {
            return -1;
        }
        if (came == 0 && wait_s > 0) {
            return 0;
        }
        if (came == 0 || messages == MESSAGES_PER_EVENT) {
            return trouble(boards, board, came == 0 ? "does not answer" : "does not come to an end");
        }
    }
    if (wait_s <= 0 && board->receiver.damaged > 0) {
        return trouble(boards, board, "sends what is no message");
    }
    board->line.rest(board->line.state);
    return 0;
}

/* ---- configuration ---- */

struct named_settings {
    const char *name;
    mh_settings *settings;
};

static const struct named_settings protocols[] = {{"direct", mh_settings_direct},
                                                  {"collection", mh_settings_collection},
                                                  {"cluster", mh_settings_cluster},
                                                  {"prince", mh_settings_prince},
#if !MH_REAL_FIXED
                                                  {"fixed", mh_settings_fixed},
                                                  {"token", mh_settings_token},
#endif
                                                  {NULL, NULL}};

static const struct named_settings trackers[] = {{"luo", mh_settings_luo},
                                                 {"pftl", mh_settings_pftl},
                                                 {"centroid", mh_settings_centroid},
                                                 {"acoustic", mh_settings_acoustic},
                                                 {"dm", mh_settings_acoustic},
                                                 {"ml", mh_settings_acoustic},
#if !MH_REAL_FIXED
                                                 {"range", mh_settings_range},
                                                 {"diffusion", mh_settings_diffusion},
                                                 {"gas", mh_settings_gas},
                                                 {"gas_small", mh_settings_gas},
                                                 {"gas_ekf", mh_settings_gas},
                                                 {"gas_ukf", mh_settings_gas},
                                                 {"cv_ukf", mh_settings_cv},
                                                 {"cv_ekf", mh_settings_cv},
#endif
                                                 {NULL, NULL}};

static mh_settings *find(const struct named_settings *list, const char *name)
{
    for (; list->name && strcmp(list->name, name) != 0; list++) {}
    return list->settings;
}

static int configured(struct boards *boards, struct board *board, struct message *message, const char *part)
{
    struct outcome outcome;
    if (ask(boards, board, message, 0, &outcome) != 0) {
        return -1;
    }
    if (outcome.answer.status != MH_OK) {
        char what[100];
        if (outcome.answer.status == MH_ERR_CAPACITY) {
            snprintf(what, sizeof what, "does not take its configuration: more than its image has room for: %s", part);
            return trouble(boards, board, what);
        }
        snprintf(what, sizeof what, "does not take its configuration (%s: status %d)", part,
                 (int)outcome.answer.status);
        return trouble(boards, board, what);
    }
    return 0;
}

/* Send one part; `settings` with `values` says what. */
#define CONFIGURE(part, name, settings, values)                                                                        \
    do {                                                                                                               \
        begin(&message, MH_LINE_CONFIGURE);                                                                            \
        put_number(&message, part);                                                                                    \
        settings(&message.fields, values);                                                                             \
        if (configured(boards, board, &message, name) != 0) {                                                          \
            return -1;                                                                                                 \
        }                                                                                                              \
    } while (0)

/* An entry of a list begins. */
static void begin_entry(struct message *message, enum mh_line_part part, uint32_t number)
{
    begin(message, MH_LINE_CONFIGURE);
    put_number(message, part);
    put_number(message, number);
}

/* The entries that concern a mote: a target that begins where it is not heard means nothing to it. */
static int tell_entries(struct boards *boards, struct board *board)
{
    const struct mh_prince_config *prince = board->what.protocol_config;
    const uint32_t range_mm = (uint32_t)mh_real_times(prince->radio_range_m, 1000);
    uint32_t told = 0;
    for (uint8_t i = 0; i < prince->entry_count; i++) {
        struct mh_prince_entry entry = prince->entries[i];
        struct message message;
        if (mh_place_within(&board->what.place, &entry.place, range_mm)) {
            begin_entry(&message, MH_LINE_PROTOCOL_ENTRY, told++);
            mh_settings_prince_entry(&message.fields, &entry);
            if (configured(boards, board, &message, "protocol.entries") != 0) {
                return -1;
            }
        }
    }
    return 0;
}

#if !MH_REAL_FIXED
static int tell_clusters(struct boards *boards, struct board *board)
{
    const struct mh_fixed_config *fixed = board->what.protocol_config;
    uint32_t told = 0;
    for (uint8_t i = 0; i < fixed->cluster_count; i++) {
        for (uint8_t k = 0; k < fixed->clusters[i].count; k++) {
            struct mh_fixed_member member = fixed->clusters[i].members[k];
            struct message message;
            begin_entry(&message, MH_LINE_PROTOCOL_ENTRY, told++);
            mh_settings_fixed_member(&message.fields, &i, &member);
            if (configured(boards, board, &message, "clusters") != 0) {
                return -1;
            }
        }
    }
    return 0;
}

static int tell_noise(struct boards *boards, struct board *board)
{
    const struct mh_cv_config *cv = board->what.head->tracker_config;
    for (uint32_t i = 0; i < cv->noise_count; i++) {
        struct mh_cv_noise noise = cv->noise[i];
        struct message message;
        begin_entry(&message, MH_LINE_TRACKER_ENTRY, i);
        mh_settings_cv_noise(&message.fields, &noise);
        if (configured(boards, board, &message, "noise of clusters") != 0) {
            return -1;
        }
    }
    return 0;
}
#endif

/* What protocol, tracker and centre of fixed clusters, and `prince`, know besides. */
static int configure_lists(struct boards *boards, struct board *board)
{
    const struct host_mote *what = &board->what;
    if (what->protocol == &mh_protocol_prince) {
        return tell_entries(boards, board);
    }
#if !MH_REAL_FIXED
    struct message message;
    if (what->protocol == &mh_protocol_fixed && tell_clusters(boards, board) != 0) {
        return -1;
    }
    if (what->centre) {
        CONFIGURE(MH_LINE_CENTRE, "fusion centre", mh_settings_fusion_centre, (void *)what->centre_config);
    }
    if (what->head && find(trackers, what->head->tracker->name) == mh_settings_cv) {
        return tell_noise(boards, board);
    }
#endif
    return 0;
}

static int configure(struct boards *boards, struct board *board)
{
    const struct host_mote *what = &board->what;
    struct mh_mote_config mote = {.id = what->id, .place = what->place};
    struct message message;
    mh_settings *settings = find(protocols, what->protocol->name);
    /* what is sent is not changed: the functions are for both directions */
    CONFIGURE(MH_LINE_MOTE, "mote", mh_settings_mote, &mote);
    CONFIGURE(MH_LINE_PROTOCOL, "protocol", settings, (void *)what->protocol_config);
    if (what->sensor) {
        CONFIGURE(MH_LINE_SENSOR, "sensor", mh_settings_sensor, (struct mh_sensor_config *)what->sensor);
    }
    if (what->head) {
        settings = find(trackers, what->head->tracker->name);
        CONFIGURE(MH_LINE_HEAD, "head", mh_settings_head, (struct mh_head_config *)what->head);
        CONFIGURE(MH_LINE_TRACKER, "tracker", settings, (void *)what->head->tracker_config);
    }
    if (what->sync) {
        CONFIGURE(MH_LINE_CLOCK_KEEPING, "clock", mh_settings_clock, (struct mh_clock_config *)what->sync);
    }
    return configure_lists(boards, board);
}

/* ---- the board's beginning ---- */

static int check_mote(struct boards *boards, const struct board *board)
{
    const struct host_mote *what = &board->what;
    char text[200];
    if (!find(protocols, what->protocol->name)) {
        snprintf(text, sizeof text, "cannot be told the configuration of the protocol %s", what->protocol->name);
        return trouble(boards, board, text);
    }
    if (what->head && !find(trackers, what->head->tracker->name)) {
        snprintf(text, sizeof text, "cannot be told the configuration of the tracker %s", what->head->tracker->name);
        return trouble(boards, board, text);
    }
    return 0;
}

/* Any board can be had in fixed point; a simulator in fixed point has no other. */
static bool is_fixed(const char *board) { return MH_REAL_FIXED || strstr(board, "-fixed"); }

/* The image for what the mote is -> board->result.image. */
static int choose_image(struct boards *boards, struct board *board)
{
    const struct host_mote *what = &board->what;
    char *path = board->result.image, names[2][110];
    if (what->head) {
        snprintf(names[0], sizeof names[0], "cluster_head_%.40s", what->head->tracker->name);
        snprintf(names[1], sizeof names[1], "cluster_head_%.40s_%.40s", what->head->tracker->name,
                 what->protocol->name);
    } else if (what->centre) {
        snprintf(names[0], sizeof names[0], "cluster_head_ci");
        snprintf(names[1], sizeof names[1], "cluster_head_ci_%.40s", what->protocol->name);
    } else {
        const bool is_usual = strcmp(what->protocol->name, "collection") == 0;
        snprintf(names[1], sizeof names[1], "sensor_node_%.40s", what->protocol->name);
        snprintf(names[0], sizeof names[0], "sensor_node%s%.40s", is_usual ? "" : "_",
                 is_usual ? "" : what->protocol->name);
    }
    for (int i = 1; i >= 0; i--) {
        snprintf(path, BOARD_IMAGE_MAX, "%.250s/%.30s%s/%.100s", boards->images, what->board,
                 MH_REAL_FIXED && !strstr(what->board, "-fixed") ? "-fixed" : "", names[i]);
        if (access(path, R_OK) == 0) {
            return 0;
        }
    }
    return fail(boards->error, boards->error_size,
                "node %lu on board %s: no image %s; `tools/images %s` builds it, `--images DIR` says where it is",
                (unsigned long)what->id, what->board, path, board->kind->name);
}

static int check_identity(struct boards *boards, struct board *board)
{
    const struct host_mote *what = &board->what;
    const struct mh_line_identity *identity = &board->identity;
    const char *tracker = what->head ? what->head->tracker->name : identity->tracker;
    const bool fixed = is_fixed(what->board);
    char text[300] = "";
    if (identity->version != MH_LINE_VERSION || strcmp(identity->library, MOTEHOUND_VERSION) != 0) {
        snprintf(text, sizeof text, "has an image of version %.40s (line %u), expected %s (line %u)", identity->library,
                 identity->version, MOTEHOUND_VERSION, MH_LINE_VERSION);
    } else if (board->kind->machine && strcmp(identity->board, board->kind->name) != 0) {
        snprintf(text, sizeof text, "has an image of the board %.40s", identity->board);
    } else if (!identity->self_test_passed) {
        snprintf(text, sizeof text, "fails its self-test");
    } else if (identity->fixed != fixed) {
        snprintf(text, sizeof text, "has an image in %s, expected %s", arithmetic_name(identity->fixed),
                 arithmetic_name(fixed));
    } else if (strcmp(identity->protocol, what->protocol->name) != 0) {
        snprintf(text, sizeof text, "has an image of the protocol %.40s, expected %s", identity->protocol,
                 what->protocol->name);
    } else if (strcmp(identity->tracker, tracker) != 0) {
        snprintf(text, sizeof text, "has an image of the tracker '%.40s', expected '%s'", identity->tracker, tracker);
    } else if (what->sensor && !identity->senses) {
        snprintf(text, sizeof text, "has an image without a sensor");
    } else if (what->sync && !identity->keeps_time) {
        snprintf(text, sizeof text, "has an image that keeps no network time");
    } else {
        struct board_result *result = &board->result;
        result->node = what->id;
        snprintf(result->board, sizeof result->board, "%s", what->board);
        result->fixed = identity->fixed;
        result->rate_hz = board->kind->rate_hz;
        result->ram = identity->ram_size;
        result->variables = identity->ram_static;
        result->reports_max = identity->reports_max;
        result->neighbours_max = identity->neighbours_max;
        return 0;
    }
    return trouble(boards, board, text);
}

static int open_board(struct boards *boards, struct board *board)
{
    char why[500];
    if (check_mote(boards, board) != 0 || choose_image(boards, board) != 0) {
        return -1;
    }
    if (board_open(&board->line, board->kind, board->result.image, why, sizeof why) != 0) {
        return fail(boards->error, boards->error_size, "node %lu on board %s: %s", (unsigned long)board->what.id,
                    board->what.board, why);
    }
    board->open = true;
    mh_line_receiver_init(&board->receiver, board->message, sizeof board->message);
    struct outcome outcome = {.done = false};
    for (int i = 0; i < IDENTIFY_TRIES && !outcome.done; i++) {
        struct message message;
        begin(&message, MH_LINE_IDENTIFY);
        if (ask(boards, board, &message, start_s, &outcome) != 0) {
            return -1;
        }
    }
    if (!outcome.done) {
        return trouble(boards, board, "does not say who it is");
    }
    board->receiver.damaged = 0; /* whatever was on the line as it started */
    return check_identity(boards, board) != 0 ? -1 : configure(boards, board);
}

/* ---- what happens to a mote ---- */

/* Cycles of the board's clock as work of its processor. */
static uint64_t work(const struct board *board, uint32_t cycles)
{
    const unsigned shift = board->kind->instruction_shift;
    return shift > 0 ? (uint64_t)(cycles * (1e9 / board->identity.cycles_per_s) / (1u << shift)) : cycles;
}

static mh_tick interval_of(const struct host_mote *what)
{
    return what->head ? what->head->interval : what->sensor ? what->sensor->interval : MH_TICKS_PER_S;
}

/* The event has taken its time: count it, and tell what it has cost. `heard`: the frame's kind, if it was one. */
static int conclude(struct boards *boards, struct board *board, const struct outcome *outcome,
                    enum mh_message_kind heard, bool sampled)
{
    struct board_result *result = &board->result;
    const uint64_t cycles = work(board, outcome->answer.cycles);
    const double us = 1e6 * (double)cycles / result->rate_hz;
    result->events++;
    result->cycles += cycles;
    result->cycles_max = result->cycles_max > cycles ? result->cycles_max : cycles;
    result->stack = result->stack > outcome->answer.stack ? result->stack : outcome->answer.stack;
    if (outcome->reported) {
        step_cycles_count(&result->steps, cycles);
    }
    result->missed += us * MH_TICKS_PER_S > 1e6 * (double)interval_of(&board->what);
    result->overlapped += boards->now < board->busy_until;
    const sim_time begins = boards->now < board->busy_until ? board->busy_until : boards->now;
    board->busy_until = begins + (sim_time)us;
    struct host_action *action = act(boards, board, HOST_WORK);
    if (!action) {
        return -1;
    }
    action->as.work.duration_us = (uint32_t)llround(fmin(us, 1e9));
    action->as.work.message = (uint8_t)(heard != MH_MESSAGE_KINDS ? heard : outcome->sent);
    action->as.work.localises = sampled || outcome->reported;
    return 0;
}

static int ask_counters(struct boards *boards, struct board *board)
{
    struct message message;
    struct outcome outcome;
    begin(&message, MH_LINE_COUNT);
    return ask(boards, board, &message, 0, &outcome);
}

/* Its configuration is one of a simulated mote, so it is sound: its image has less room. The parameters that ask for room are named. */
static int does_not_start(struct boards *boards, const struct board *board, enum mh_status status)
{
    const struct host_mote *what = &board->what;
    mh_settings *const tracker = what->head ? find(trackers, what->head->tracker->name) : NULL;
    char parameters[200] = "", text[300];
    size_t length = 0;
    if (what->protocol == &mh_protocol_cluster) {
        const struct mh_cluster_config *cluster = what->protocol_config;
        length += (size_t)snprintf(parameters, sizeof parameters, ", protocol.members %u", cluster->election.members);
    }
    if (tracker == mh_settings_pftl) {
        const struct mh_pftl_config *pftl = what->head->tracker_config;
        snprintf(parameters + length, sizeof parameters - length, ", tracker.particles %u", pftl->particles);
    }
    if (tracker == mh_settings_acoustic) {
        const struct mh_acoustic_config *acoustic = what->head->tracker_config;
        snprintf(parameters, sizeof parameters, "%s%s",
                 acoustic->separation == MH_SEPARATION_JOINT ? ", tracker.separation joint (expected none)" : "",
                 acoustic->group.mode != MH_GROUP_NONE ? ", tracker.groups (expected none)" : "");
    }
    if (status != MH_ERR_ARGUMENT || parameters[0] == '\0') {
        snprintf(text, sizeof text, "does not come up (status %d)", (int)status);
    } else {
        snprintf(text, sizeof text, "does not come up: more than its image has room for:%s", parameters + 1);
    }
    return trouble(boards, board, text);
}

static int start(struct boards *boards, struct board *board)
{
    struct message message;
    struct outcome outcome;
    if (!board->open && open_board(boards, board) != 0) {
        return -1;
    }
    if (board->started) {
        if (ask_counters(boards, board) != 0) {
            return -1;
        }
        host_totals_add(&boards->past, &board->counted.motes, &board->counted.heads, &board->counted.protocols);
    }
    if (boards->now > 0) {
        local_clock_restart(&board->what.clock, boards->now);
    }
    board->alarm = SIM_TIME_NEVER;
    board->up = board->started = true;
    begin_event(boards, board, &message, MH_LINE_START);
    if (ask(boards, board, &message, 0, &outcome) != 0) {
        return -1;
    }
    if (outcome.answer.status != MH_OK) {
        return does_not_start(boards, board, outcome.answer.status);
    }
    return conclude(boards, board, &outcome, MH_MESSAGE_KINDS, false);
}

static int happen(struct boards *boards, struct board *board, const struct host_event *event)
{
    struct message message;
    struct outcome outcome;
    const uint8_t *bytes;
    uint16_t length;
    enum mh_message_kind heard = MH_MESSAGE_KINDS;
    boards->now = event->time;
    boards->past.events++;
    if (event->kind == HOST_START) {
        return start(boards, board);
    }
    if (!board->up) {
        return 0;
    }
    switch (event->kind) {
    case HOST_STOP:
        board->up = false;
        board->alarm = SIM_TIME_NEVER;
        begin(&message, MH_LINE_STOP);
        break;
    case HOST_READING:
        begin_event(boards, board, &message, MH_LINE_READING);
        put_number(&message, (uint32_t)event->as.reading.counts);
        put_number(&message, event->as.reading.target);
        break;
    case HOST_FRAME:
        begin_event(boards, board, &message, MH_LINE_FRAME);
        bytes = event->as.frame.bytes;
        length = event->as.frame.length;
        mh_line_bytes(&message.fields, &bytes, &length);
        heard = frame_kind(&boards->kinds, bytes, length);
        break;
    case HOST_SENT:
        begin_event(boards, board, &message, MH_LINE_SENT);
        put_number(&message, event->as.sent);
        break;
    default:
        begin_event(boards, board, &message, MH_LINE_PROBE);
        break;
    }
    return ask(boards, board, &message, 0, &outcome) != 0
               ? -1
               : conclude(boards, board, &outcome, heard, event->kind == HOST_READING);
}

static int alarm_comes(struct boards *boards, struct board *board)
{
    struct message message;
    struct outcome outcome;
    boards->now = board->alarm;
    boards->past.events++;
    board->alarm = SIM_TIME_NEVER;
    begin_event(boards, board, &message, MH_LINE_ALARM);
    return ask(boards, board, &message, 0, &outcome) != 0 ? -1
                                                          : conclude(boards, board, &outcome, MH_MESSAGE_KINDS, false);
}

static bool concerns(const struct host_event *event, uint32_t mote)
{
    if (event->kind != HOST_FRAME) {
        return event->mote == mote;
    }
    for (uint32_t i = 0; i < event->as.frame.count; i++) {
        if (event->as.frame.receivers[i] == mote) {
            return true;
        }
    }
    return false;
}

/* Its part of the window: alarms in between, after events of the same time. */
static int run_board(struct boards *boards, struct board *board, sim_time until, const struct host_event *events,
                     size_t count)
{
    int status = 0;
    for (size_t i = 0; i <= count && status == 0; i++) {
        const bool is_event = i < count;
        if (is_event && !concerns(&events[i], board->index)) {
            continue;
        }
        while (status == 0 && board->alarm < (is_event ? events[i].time : until)) {
            status = alarm_comes(boards, board);
        }
        if (is_event && status == 0) {
            status = happen(boards, board, &events[i]);
        }
    }
    return status;
}

/* ---- the motes of this process ---- */

static bool is_on_board(const struct boards *boards, uint32_t mote)
{
    for (size_t i = 0; i < boards->count; i++) {
        if (boards->list[i]->index == mote) {
            return true;
        }
    }
    return false;
}

/* Room for `count` elements; the old ones are not kept. */
static void *make_room(void *list, size_t *capacity, size_t count, size_t size)
{
    if (count <= *capacity) {
        return list;
    }
    free(list);
    *capacity = 2 * count;
    return malloc(*capacity * size);
}

/* The window's events without the motes on boards -> boards->events. Returns how many, or -1. */
static long native_events(struct boards *boards, const struct host_event *events, size_t count)
{
    size_t receivers = 0, taken = 0, kept = 0;
    for (size_t i = 0; i < count; i++) {
        receivers += events[i].kind == HOST_FRAME ? events[i].as.frame.count : 0;
    }
    boards->events = make_room(boards->events, &boards->event_capacity, count + 1, sizeof *boards->events);
    boards->receivers =
        make_room(boards->receivers, &boards->receiver_capacity, receivers + 1, sizeof *boards->receivers);
    if (!boards->events || !boards->receivers) {
        boards->event_capacity = boards->events ? boards->event_capacity : 0;
        boards->receiver_capacity = boards->receivers ? boards->receiver_capacity : 0;
        return -1;
    }
    for (size_t i = 0; i < count; i++) {
        struct host_event event = events[i];
        if (event.kind == HOST_FRAME) {
            uint32_t *to = boards->receivers + taken;
            event.as.frame.count = 0;
            for (uint32_t r = 0; r < events[i].as.frame.count; r++) {
                if (!is_on_board(boards, events[i].as.frame.receivers[r])) {
                    to[event.as.frame.count++] = events[i].as.frame.receivers[r];
                }
            }
            event.as.frame.receivers = to;
            taken += event.as.frame.count;
        }
        if (event.kind == HOST_FRAME ? event.as.frame.count > 0 : !is_on_board(boards, event.mote)) {
            boards->events[kept++] = event;
        }
    }
    return (long)kept;
}

/* ---- the table ---- */

static int add(void *state, uint32_t mote, const struct host_mote *what)
{
    struct boards *boards = state;
    if (!what->board) {
        return boards->native.add(boards->native.state, mote, what);
    }
    struct board *board = boards->count < BOARDS_MAX ? calloc(1, sizeof *board) : NULL;
    if (!board) {
        return -1;
    }
    board->index = mote;
    board->what = *what;
    board->kind = board_kind_find(what->board);
    board->alarm = SIM_TIME_NEVER;
    boards->list[boards->count++] = board;
    return 0;
}

static sim_time next(const void *state)
{
    const struct boards *boards = state;
    sim_time earliest = boards->native.next(boards->native.state);
    for (size_t i = 0; i < boards->count; i++) {
        earliest = boards->list[i]->alarm < earliest ? boards->list[i]->alarm : earliest;
    }
    return earliest;
}

static int run(void *state, sim_time until, const struct host_event *events, size_t count, struct host_actions *actions,
               char *error, size_t error_size)
{
    struct boards *boards = state;
    const struct host *native = &boards->native;
    if (boards->count == 0) {
        return native->run(native->state, until, events, count, actions, error, error_size);
    }
    boards->actions = actions;
    boards->error = error;
    boards->error_size = error_size;
    for (size_t i = 0; i < boards->count; i++) {
        if (run_board(boards, boards->list[i], until, events, count) != 0) {
            return -1;
        }
    }
    const long kept = native_events(boards, events, count);
    if (kept < 0) {
        return fail(error, error_size, "out of memory");
    }
    return native->run(native->state, until, boards->events, (size_t)kept, actions, error, error_size);
}

static int count_all(void *state, struct host_totals *totals, char *error, size_t error_size)
{
    struct boards *boards = state;
    boards->error = error;
    boards->error_size = error_size;
    totals->events += boards->past.events;
    host_totals_add(totals, &boards->past.motes, &boards->past.heads, &boards->past.protocols);
    for (size_t i = 0; i < boards->count; i++) {
        struct board *board = boards->list[i];
        if (!board->started) {
            continue;
        }
        if (ask_counters(boards, board) != 0) {
            return -1;
        }
        host_totals_add(totals, &board->counted.motes, &board->counted.heads, &board->counted.protocols);
        if (totals->boards) {
            board_results_add(totals->boards, &board->result);
        }
    }
    return boards->native.count(boards->native.state, totals, error, error_size);
}

static void destroy(void *state)
{
    struct boards *boards = state;
    for (size_t i = 0; i < boards->count; i++) {
        struct board *board = boards->list[i];
        if (board->open) {
            board->line.close(board->line.state);
        }
        free(board);
    }
    if (boards->native.destroy) {
        boards->native.destroy(boards->native.state);
    }
    free(boards->events);
    free(boards->receivers);
    free(boards);
}

int host_boards(struct host *host, uint32_t count, const uint32_t *order, const struct mh_protocol *protocol,
                const char *images)
{
    struct boards *boards = calloc(1, sizeof *boards);
    if (!boards) {
        return -1;
    }
    boards->images = images;
    frame_kinds_learn(&boards->kinds);
    if (host_in_process(&boards->native, count, order, protocol) != 0) {
        free(boards);
        return -1;
    }
    *host = (struct host){boards, add, next, run, count_all, destroy};
    return 0;
}
