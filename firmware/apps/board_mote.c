#include "board_mote.h"

#include "console.h"
#include "fault.h"

static struct {
    struct board_mote *board;
    struct mh_mote mote;
    struct mh_line_receiver receiver;
    uint8_t message[MH_LINE_TO_BOARD_MAX];
    bool passed;    /* the self-test */
    bool free;      /* the board's own clock is the mote's */
    bool running;   /* the mote has begun */
    bool alarm_set; /* runs free: at `alarm` */
    mh_tick alarm, sample;
    uint32_t outside; /* cycles of the present event that went into the line */
} self;

/* ---- to the line ---- */

static void put(void *context, uint8_t byte)
{
    (void)context;
    port_uart_put(byte);
}

static struct mh_line_sender sender = {put, 0, 0};

/* What an event sends does not count as its work. */
static uint32_t begin_message(enum mh_line_kind kind)
{
    const uint32_t began = port_cycles();
    mh_line_begin(&sender, kind);
    return began;
}

static void end_message(uint32_t began)
{
    mh_line_end(&sender);
    self.outside += port_cycles() - began;
}

static void send_number(enum mh_line_kind kind, uint32_t number)
{
    const uint32_t began = begin_message(kind);
    struct mh_line_fields fields = mh_line_write(&sender);
    mh_line_u32(&fields, &number);
    end_message(began);
}

/* ---- what the mote asks of the board ---- */

static void transmit(void *context, mh_node_id destination, const uint8_t *frame, size_t length)
{
    (void)context;
    const uint32_t began = begin_message(MH_LINE_TRANSMIT);
    struct mh_line_fields fields = mh_line_write(&sender);
    uint16_t bytes = (uint16_t)length;
    mh_line_u32(&fields, &destination);
    mh_line_bytes(&fields, &frame, &bytes);
    end_message(began);
}

static void set_alarm(void *context, mh_tick time)
{
    (void)context;
    if (self.free) {
        self.alarm = time;
        self.alarm_set = true;
    } else {
        send_number(MH_LINE_SET_ALARM, time);
    }
}

void board_report(void *context, const struct mh_estimate *estimate)
{
    (void)context;
    if (self.free) {
        const struct mh_place place = mh_place_from_offset(&estimate->origin, estimate->position);
        put_number((int32_t)estimate->time);
        put_text(" ms: x ");
        put_number(place.x_mm);
        put_text(" mm, y ");
        put_number(place.y_mm);
        put_text(" mm\n");
    }
    const uint32_t began = begin_message(MH_LINE_REPORT);
    struct mh_line_fields fields = mh_line_write(&sender);
    mh_line_estimate(&fields, (struct mh_estimate *)estimate, MH_REAL_FIXED); /* written, it is only read */
    end_message(began);
}

static void sleep(void *context, bool may_sleep)
{
    (void)context;
    send_number(MH_LINE_SLEEP, may_sleep);
}

static void sense(void *context)
{
    (void)context;
    end_message(begin_message(MH_LINE_SENSE));
}

static enum mh_status begin(mh_tick now)
{
    static struct mh_port port = {transmit, set_alarm, NULL, sleep, sense};
    port.report = self.board->report;
    const enum mh_status status =
        self.passed ? mh_mote_init(&self.mote, &self.board->mote, &port, NULL, now) : MH_ERR_CORRUPT;
    self.running = status == MH_OK;
    return status;
}

/* ---- from the line ---- */

static enum mh_status identify(void)
{
    const struct board_mote *board = self.board;
    struct mh_line_identity identity = {
        .version = MH_LINE_VERSION,
        .fixed = MH_REAL_FIXED,
        .self_test_passed = self.passed,
        .senses = board->sensor != NULL,
        .keeps_time = board->clock != NULL,
        .board = MOTEHOUND_BOARD,
        .protocol = board->mote.protocol->name,
        .tracker = board->head ? board->head->tracker->name : "",
        .library = MOTEHOUND_VERSION,
        .reports_max = MH_REPORTS_MAX,
        .neighbours_max = MH_NEIGHBOURS_MAX,
        .cycles_per_s = port_cycles_per_s(),
        .ram_size = port_ram_size(),
        .ram_static = port_static_ram(),
    };
    const uint32_t began = begin_message(MH_LINE_IDENTITY);
    struct mh_line_fields fields = mh_line_write(&sender);
    mh_line_identity(&fields, &identity);
    end_message(began);
    return MH_OK;
}

static enum mh_status take_entry(struct mh_line_fields *fields,
                                 enum mh_status (*take)(struct mh_line_fields *, uint16_t))
{
    uint16_t number = UINT16_MAX;
    mh_line_u16(fields, &number);
    const enum mh_status status = take(fields, number);
    return status == MH_OK && !mh_line_complete(fields) ? MH_ERR_CORRUPT : status;
}

static enum mh_status configure(struct mh_line_fields *fields)
{
    struct board_mote *board = self.board;
    uint8_t part = UINT8_MAX;
    mh_line_u8(fields, &part);
    if (part == MH_LINE_MOTE) {
        mh_settings_mote(fields, &board->mote);
    } else if (part == MH_LINE_SENSOR && board->sensor) {
        mh_settings_sensor(fields, board->sensor);
        board->mote.sensor = board->sensor;
    } else if (part == MH_LINE_PROTOCOL && board->protocol_settings) {
        board->protocol_settings(fields, board->protocol);
    } else if (part == MH_LINE_HEAD && board->head) {
        mh_settings_head(fields, board->head);
        board->mote.head = board->head;
    } else if (part == MH_LINE_TRACKER && board->tracker_settings) {
        board->tracker_settings(fields, board->tracker);
    } else if (part == MH_LINE_CLOCK_KEEPING && board->clock) {
        mh_settings_clock(fields, board->clock_config);
        board->mote.clock = board->clock;
    } else if (part == MH_LINE_CENTRE && board->centre_settings) {
        board->centre_settings(fields, board->centre);
    } else if (part == MH_LINE_PROTOCOL_ENTRY && board->protocol_entry) {
        return take_entry(fields, board->protocol_entry);
    } else if (part == MH_LINE_TRACKER_ENTRY && board->tracker_entry) {
        return take_entry(fields, board->tracker_entry);
    } else {
        return MH_ERR_ARGUMENT;
    }
    return mh_line_complete(fields) ? MH_OK : MH_ERR_CORRUPT;
}

static enum mh_status take_reading(struct mh_line_fields *fields, mh_tick now)
{
    struct mh_reading reading = {now, 0, 0};
    mh_line_i32(fields, &reading.counts);
    mh_line_u8(fields, &reading.target);
    return mh_line_complete(fields) ? mh_mote_reading(&self.mote, now, &reading) : MH_ERR_CORRUPT;
}

static enum mh_status take_frame(struct mh_line_fields *fields, mh_tick now)
{
    const uint8_t *frame;
    uint16_t length;
    mh_line_bytes(fields, &frame, &length);
    return mh_mote_frame(&self.mote, now, frame, length);
}

static enum mh_status take_sent(struct mh_line_fields *fields, mh_tick now)
{
    uint8_t outcome = UINT8_MAX;
    mh_line_u8(fields, &outcome);
    if (!mh_line_complete(fields) || outcome > MH_SENT_BUSY) {
        return MH_ERR_CORRUPT;
    }
    mh_mote_sent(&self.mote, now, (enum mh_sent)outcome);
    return MH_OK;
}

static enum mh_status tell_clock(mh_tick now)
{
    const struct mh_mote_config *config = self.mote.config;
    bool knows = true;
    uint32_t network = now;
    uint8_t fraction = 128;
    if (config->clock) {
        knows = mh_clock_synchronised(config->clock_state);
        network = config->clock->network(config->clock_state, now, &fraction);
    }
    const uint32_t began = begin_message(MH_LINE_CLOCK);
    struct mh_line_fields fields = mh_line_write(&sender);
    mh_line_bool(&fields, &knows);
    mh_line_u32(&fields, &network);
    mh_line_u8(&fields, &fraction);
    end_message(began);
    return MH_OK;
}

static enum mh_status tell_counters(void)
{
    const struct mh_mote_config *config = self.mote.config;
    struct mh_head_counters head = {0};
    struct mh_protocol_counters protocol = {.retries = 0};
    if (config->protocol->count) {
        config->protocol->count(config->protocol_state, &protocol);
    }
    const uint32_t began = begin_message(MH_LINE_COUNTERS);
    struct mh_line_fields fields = mh_line_write(&sender);
    mh_line_counters(&fields, &self.mote.counters, config->head ? &config->head_state->counters : &head, &protocol);
    end_message(began);
    return MH_OK;
}

/* An event of the mote, at the time that the message names, or now. */
static enum mh_status take_event(enum mh_line_kind kind, struct mh_line_fields *fields)
{
    mh_tick now = 0;
    if (kind != MH_LINE_COUNT) {
        mh_line_u32(fields, &now);
    }
    if (fields->broken) {
        return MH_ERR_CORRUPT;
    }
    if (kind == MH_LINE_START) {
        return begin(now);
    }
    if (!self.running) {
        return MH_ERR_ARGUMENT;
    }
    if (self.free) {
        now = port_ticks();
    }
    switch (kind) {
    case MH_LINE_READING:
        return take_reading(fields, now);
    case MH_LINE_FRAME:
        return take_frame(fields, now);
    case MH_LINE_SENT:
        return take_sent(fields, now);
    case MH_LINE_ALARM:
        mh_mote_alarm(&self.mote, now);
        return MH_OK;
    case MH_LINE_PROBE:
        return tell_clock(now);
    case MH_LINE_COUNT:
        return tell_counters();
    default:
        return MH_ERR_UNKNOWN;
    }
}

/* The clock is at the other end of the line from now, and the mote has what is configured. */
static void begin_lock_step(void)
{
    if (self.free) {
        self.free = false;
        port_watchdog_stop();
        self.board->mote.sensor = NULL;
        self.board->mote.head = NULL;
        self.board->mote.clock = NULL;
    }
    self.running = false;
}

static void take_message(void)
{
    const enum mh_line_kind kind = (enum mh_line_kind)self.receiver.bytes[0];
    struct mh_line_fields fields = mh_line_read(&self.receiver);
    if (kind <= MH_LINE_STOP) {
        begin_lock_step();
    }
    self.outside = 0;
    const uint32_t began = port_cycles();
    struct mh_line_done done = {.status = kind == MH_LINE_IDENTIFY    ? identify()
                                          : kind == MH_LINE_CONFIGURE ? configure(&fields)
                                          : kind == MH_LINE_STOP      ? MH_OK
                                                                      : take_event(kind, &fields)};
    done.cycles = port_cycles() - began - self.outside;
    done.stack = port_stack_deepest();
    mh_line_begin(&sender, MH_LINE_DONE);
    fields = mh_line_write(&sender);
    mh_line_done(&fields, &done);
    mh_line_end(&sender);
}

/* ---- by the board's own clock ---- */

static void tell_start(const struct fault_record *record)
{
    put_text("motehound " MOTEHOUND_VERSION ", ");
    put_name(self.board->mote.protocol->name);
    if (self.board->head) {
        put_text(" ");
        put_name(self.board->head->tracker->name);
    }
    if (self.passed) {
        put_text(", self-test passed\n");
    } else {
        put_text(", self-test FAILED\n");
    }
    if (record->cause != PORT_FAULT_NONE) {
        put_text("after fault ");
        put_number(record->cause);
        put_text(" at ");
        put_number((int32_t)record->address);
        put_text(", fault number ");
        put_number(record->count);
        put_text("\n");
        mh_line_begin(&sender, MH_LINE_FAULT);
        struct mh_line_fields fields = mh_line_write(&sender);
        uint32_t reason = record->cause, address = record->address;
        mh_line_u32(&fields, &reason);
        mh_line_u32(&fields, &address);
        mh_line_end(&sender);
    }
}

/* The next sampling instant, a whole multiple of the interval in the network's time. */
static mh_tick next_sample(mh_tick now)
{
    const struct mh_mote_config *config = self.mote.config;
    const mh_tick interval = config->sensor->interval;
    const mh_tick network = config->clock ? config->clock->network(config->clock_state, now, NULL) : now;
    const mh_tick next = network - network % interval + interval;
    return config->clock ? config->clock->local(config->clock_state, next) : next;
}

static void run_free(void)
{
    const mh_tick now = port_ticks();
    if (self.alarm_set && !mh_tick_before(now, self.alarm)) {
        self.alarm_set = false;
        mh_mote_alarm(&self.mote, now);
    }
    if (self.board->samples && !mh_tick_before(now, self.sample)) {
        self.sample = next_sample(now);
        sense(NULL);
    }
}

int board_mote_run(struct board_mote *board)
{
    struct fault_record record;
    fault_begin(&record);
    port_stack_paint();
    port_timer_begin();
    port_uart_begin();
    mh_line_receiver_init(&self.receiver, self.message, sizeof self.message);
    self.board = board;
    self.passed = board->self_test();
    self.free = true;
    tell_start(&record);
    port_watchdog_start();
    (void)begin(port_ticks());
    for (;;) {
        port_watchdog_feed();
        const int byte = port_uart_get();
        if (byte >= 0 && mh_line_take(&self.receiver, (uint8_t)byte)) {
            take_message();
        }
        if (self.free && self.running) {
            run_free();
        }
        if (!port_stack_intact()) {
            port_fault(PORT_FAULT_STACK, 0);
        }
        if (byte < 0) {
            port_wait();
        }
    }
}
