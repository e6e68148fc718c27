/* Image of a node that follows a target by its sound together with its neighbours, as head when its turn comes: a microphone, a radio and one timer, joined by the mote.
 * For boards like the Mica2: ATmega128, 4 KB of RAM.
 *
 * The main loop is that of a real node. What is scripted here, so that it runs under an emulator, is the hardware: the clock is a counter, the microphone
 * hears a target that goes to and fro, and the frames are those of eight neighbours, who answer when this node asks. Four times the target comes, and the head
 * before this one names it as prince; this node localises the target, and names one of its neighbours, who takes over. The last time nobody does, and the target turns back:
 * then it is for this node to find out, and to find the target again. */
#include "console.h"
#include "motehound/acoustic.h"
#include "motehound/mote.h"
#include "motehound/sound_fix.h"

#include <string.h>

enum {
    SELF = 1,
    TARGET = 1601,
    NEIGHBOURS = 8,
    FIRST = 100 /* the neighbours are FIRST, FIRST + 1, ... */,
    STRANGER = 999
};
enum { WEST, EAST }; /* the neighbours at the ends of the target's way */
enum { RANGE_M = 40, RADIO_M = 140, SPEED_MPS = 10, END_M = 120, TURN_M = 30, WAY_Y_M = 6 };
#define LEG 24000uL /* ticks: from one end to the other */
enum { LEGS = 4, WAKE = 3000, WINDOW = 300, SLOT = 20 };
#define GOOD_MM 8000u

static struct mh_acoustic_config tracking;
static struct mh_acoustic tracker;
static struct mh_head gathering;
static struct mh_prince_config routing;
static struct mh_prince route;
static const struct mh_head_config head = {&mh_tracker_acoustic, &tracking, &tracker, 0, 1000, 500, 0, false, 0};
static const struct mh_sensor_config sensor = {/* 10 bits for 64 times the least that is reported */
                                               .q20_per_count = 65536,
                                               .counts_max = 1023,
                                               .interval = 1,
                                               .report_always = true};
static const struct mh_mote_config config = {.id = SELF,
                                             .sensor = &sensor,
                                             .head = &head,
                                             .protocol = &mh_protocol_prince,
                                             .protocol_config = &routing,
                                             .protocol_state = &route,
                                             .head_state = &gathering};
static struct mh_mote mote;
static mh_tick alarm_time;
static bool sample_wanted;

/* ---- the target and the neighbours, scripted ---- */

static const struct {
    int8_t x_m, y_m;
} places[NEIGHBOURS] = {{-75, 10}, {75, -10}, {-25, 20}, {-30, -22}, {25, -18}, {28, 24}, {4, 38}, {60, 12}};

static mh_tick present;
static struct mh_random random_numbers;
static int16_t generation;                         /* of the last fix of any head */
static int32_t prince;                             /* that this node has named */
static mh_locate_t query;                          /* the last of this node, which neighbours answer from ... */
static mh_tick answered_from;                      /* ... then on */
static enum { NOTHING, ASK, SUCCEED, WAKEN } next; /* what the prince that this node has named says, ... */
static mh_tick next_time;                          /* ... and when */
static uint8_t fixes, good, answers;

static bool is_last_leg(mh_tick now) { return now / LEG == LEGS - 1; }
static bool goes_west(mh_tick now) { return now / LEG % 2 == 1; }

static struct mh_place target_at(mh_tick now)
{
    const int32_t way_mm = (int32_t)(now % LEG) * SPEED_MPS;
    int32_t x_mm = END_M * 1000L - way_mm;
    if (is_last_leg(now) && x_mm < TURN_M * -1000L) {
        x_mm = TURN_M * -2000L - x_mm;
    }
    const struct mh_place place = {goes_west(now) ? x_mm : -x_mm, WAY_Y_M * 1000L, 0};
    return place;
}

static struct mh_place place_of(uint8_t neighbour)
{
    const struct mh_place place = {places[neighbour].x_m * 1000L, places[neighbour].y_m * 1000L, 0};
    return place;
}

/* What is heard at `place`, noise and all. */
static mh_real energy(const struct mh_place *place, mh_tick now)
{
    const struct mh_place target = target_at(now);
    const struct mh_vec2 way = mh_place_relative(&target, place);
    mh_real noise = -2;
    for (uint8_t i = 0; i < 4; i++) {
        noise += mh_random_unit(&random_numbers); /* standard deviation 1 / sqrt(3) */
    }
    return mh_sound_energy(&tracking.sound, way.x * way.x + way.y * way.y) *
           mh_exp(1.732f * tracking.sound.source_sd * noise);
}

/* A neighbour has sent it to all. */
static void hear(const struct mh_message *message)
{
    uint8_t frame[MH_FRAME_MAX];
    size_t length;
    if (mh_wire_encode(mh_protocol_prince.types, message, frame, &length) == MH_OK) {
        (void)mh_mote_frame(&mote, present, frame, length);
    }
}

static void hear_hello(uint8_t neighbour)
{
    const struct mh_place place = place_of(neighbour);
    const struct mh_message message = {
        .kind = MH_MESSAGE_HELLO, .as.hello = {.sender = FIRST + neighbour, .x_mm = place.x_mm, .y_mm = place.y_mm}};
    hear(&message);
}

/* A neighbour has just found the target, and names who is next. */
static void hear_awake(int32_t neighbour, int32_t next_prince, int16_t enters_cs)
{
    const struct mh_place place = place_of((uint8_t)(neighbour - FIRST)), target = target_at(present);
    const struct mh_vec2 velocity = {goes_west(present) ? -SPEED_MPS : SPEED_MPS, 0};
    struct mh_message message = {.kind = MH_MESSAGE_AWAKE};
    mh_awake_t *awake = &message.as.awake;
    uint8_t bytes[MH_TRACK_BYTES_MAX];
    size_t length;
    /* the neighbour's track; this node's tracker keeps nothing from one fix to the next */
    if (mh_tracker_acoustic.init(&tracker, &tracking, head.interval) != MH_OK ||
        mh_acoustic_begin(&tracker, TARGET, present, &target, velocity, 2, 1) != MH_OK ||
        mh_tracker_acoustic.save(&tracker, bytes, &length) != MH_OK || length > sizeof awake->data) {
        return;
    }
    awake->sender = neighbour;
    awake->target = TARGET;
    awake->generation = ++generation;
    awake->time_ms = (int32_t)present;
    awake->x_mm = target.x_mm;
    awake->y_mm = target.y_mm;
    awake->vx_cmps = (int16_t)(velocity.x * 100);
    awake->head_x_dm = (int16_t)((place.x_mm - target.x_mm) / 100);
    awake->head_y_dm = (int16_t)((place.y_mm - target.y_mm) / 100);
    awake->prince = next_prince;
    awake->enters_cs = enters_cs;
    awake->members = 1;
    awake->length = (uint8_t)length;
    memcpy(awake->data, bytes, length);
    hear(&message);
}

static void hear_answer(uint8_t neighbour)
{
    const struct mh_place place = place_of(neighbour);
    const mh_real heard = energy(&place, (mh_tick)query.time_ms);
    const struct mh_message message = {.kind = MH_MESSAGE_SOUND,
                                       .as.sound = {.sender = FIRST + neighbour,
                                                    .asker = SELF,
                                                    .target = query.target,
                                                    .time_ms = query.time_ms,
                                                    .x_mm = place.x_mm,
                                                    .y_mm = place.y_mm,
                                                    .value_q20 = mh_q20_from_real(heard),
                                                    .share = 255}};
    if (heard >= 1) {
        hear(&message);
    }
}

/* The prince that this node has named takes over. */
static void hear_next(void)
{
    struct mh_message message = {.kind = MH_MESSAGE_LOCATE};
    switch (next) {
    case ASK:
        message.as.locate.sender = prince;
        message.as.locate.target = TARGET;
        message.as.locate.generation = (int16_t)(generation + 1);
        message.as.locate.time_ms = (int32_t)present;
        message.as.locate.kind = MH_LOCATE_PRINCE;
        next = SUCCEED;
        next_time += WINDOW;
        hear(&message);
        break;
    case SUCCEED:
        message.kind = MH_MESSAGE_SUCCEED;
        message.as.succeed.sender = prince;
        message.as.succeed.head = SELF;
        message.as.succeed.target = TARGET;
        message.as.succeed.generation = (int16_t)(generation + 1);
        next = WAKEN;
        next_time += SLOT;
        hear(&message);
        break;
    default:
        next = NOTHING;
        hear_awake(prince, STRANGER, 500);
        break;
    }
}

static void neighbours_speak(void)
{
    const mh_tick of_leg = present % LEG, since = present - answered_from;
    if (present > 0 && present <= NEIGHBOURS * SLOT && present % SLOT == 0) {
        hear_hello((uint8_t)(present / SLOT - 1));
    } else if (of_leg == WAKE) {
        hear_awake(goes_west(present) ? FIRST + EAST : FIRST + WEST, SELF, (END_M - RANGE_M - WAKE / 100) * 10);
    } else if (query.time_ms != 0 && since > 0 && since <= NEIGHBOURS * SLOT && since % SLOT == 0) {
        hear_answer((uint8_t)(since / SLOT - 1));
    } else if (next != NOTHING && !mh_tick_before(present, next_time)) {
        hear_next();
    }
}

/* ---- what the mote asks of the board ---- */

static void transmit(void *context, mh_node_id destination, const uint8_t *frame, size_t length)
{
    struct mh_message message;
    (void)context;
    (void)destination;
    if (mh_wire_decode(mh_protocol_prince.types, frame, length, &message) != MH_OK) {
        return;
    }
    if (message.kind == MH_MESSAGE_LOCATE) {
        query = message.as.locate;
        answered_from = present;
    } else if (message.kind == MH_MESSAGE_AWAKE) {
        generation = message.as.awake.generation;
        prince = message.as.awake.prince;
        next = prince == -1 || is_last_leg(present) ? NOTHING : ASK;
        next_time = (mh_tick)message.as.awake.time_ms + (mh_tick)message.as.awake.enters_cs * 10;
    }
    answers = (uint8_t)(answers + (message.kind == MH_MESSAGE_SOUND));
}

static void set_alarm(void *context, mh_tick time)
{
    (void)context;
    alarm_time = time;
}

static void sense(void *context)
{
    (void)context;
    sample_wanted = true;
}

static void report(void *context, const struct mh_estimate *estimate)
{
    const struct mh_place place = mh_place_from_offset(&estimate->origin, estimate->position);
    const struct mh_place target = target_at(estimate->time);
    const uint32_t error_mm = mh_place_distance_mm(&place, &target);
    (void)context;
    put_named("", (int32_t)estimate->time);
    put_named(" ms: ", (int32_t)error_mm);
    put_named(" mm off, by ", estimate->measurements);
    port_puts(" nodes\n");
    fixes++;
    good = (uint8_t)(good + (error_mm <= GOOD_MM));
}

/* ---- the processor ---- */

#ifdef __AVR__
#include <avr/io.h>

extern uint8_t __heap_start[]; /* the end of the variables */

static void start_counter(void) { TCCR1B = _BV(CS11) | _BV(CS10); } /* one each 64 cycles */
static uint16_t counter(void) { return TCNT1; }
static uint16_t variables(void) { return (uint16_t)(__heap_start - (uint8_t *)RAMSTART); }
#else
static void start_counter(void) {}
static uint16_t counter(void) { return 0; }
static uint16_t variables(void) { return 0; }
#endif

/* Five reports whose place is known: docs/sound.md. */
static bool knows_the_answer(void)
{
    static const struct mh_heard heard[] = {
        {{30, 0}, 4.6f}, {{0, 0}, 3.9f}, {{10, 35}, 2.6f}, {{45, 30}, 1.45f}, {{-20, 20}, 1.1f}};
    struct mh_vec2 place;
    return mh_sound_fix(&tracking.sound, heard, 5, NULL, &place, NULL) == MH_OK && mh_abs(place.x - 16.41f) < 0.02f &&
           mh_abs(place.y - 11.88f) < 0.02f;
}

static bool begin(void)
{
    static const struct mh_port port = {.transmit = transmit, .set_alarm = set_alarm, .report = report, .sense = sense};
    mh_random_init(&random_numbers, 1);
    mh_acoustic_config_default(&tracking, RANGE_M);
    tracking.separation = MH_SEPARATION_NONE; /* one target */
    mh_prince_config_default(&routing, MH_PRINCE_NAMED, true, RANGE_M, RADIO_M);
    routing.port = &mh_mote_prince;
    return knows_the_answer() && mh_mote_init(&mote, &config, &port, NULL, 0) == MH_OK;
}

static void take_sample(void)
{
    const mh_real heard = energy(&config.place, present);
    const struct mh_reading reading = {present, (int32_t)mh_min(heard * 16.0f, 1023), 0};
    sample_wanted = false;
    (void)mh_mote_reading(&mote, present, &reading);
}

static int judge(void)
{
    const struct mh_prince_counters *counted = &route.counters;
    put_named("as prince: ", (int32_t)counted->princes);
    put_named(", competing: ", (int32_t)counted->competitions);
    put_named(", watchdog: ", (int32_t)counted->watchdogs);
    put_named(", answers: ", answers);
    const bool passed = fixes == LEGS + 1 && good == fixes && counted->princes == LEGS && counted->competitions == 1 &&
                        counted->watchdogs == 1 && answers > 0;
    port_puts(passed ? "\npassed\n" : "\nfailed\n");
    return passed ? 0 : 1;
}

int main(void)
{
    uint16_t longest = 0;
    port_stack_paint();
    start_counter();
    if (!begin()) {
        return 1;
    }
    for (; present < LEGS * LEG; present++) { /* on a board: for ever, asleep until an interrupt */
        neighbours_speak();
        if (!mh_tick_before(present, alarm_time)) {
            const uint16_t before = counter();
            mh_mote_alarm(&mote, present);
            const uint16_t took = (uint16_t)(counter() - before);
            longest = took > longest ? took : longest;
        }
        if (sample_wanted) {
            take_sample();
        }
    }
    put_named("state: ", (int32_t)(sizeof mote + sizeof route + sizeof gathering + sizeof tracker));
    put_named(" bytes; all variables: ", variables());
    put_named(", stack: ", (int32_t)port_stack_used());
    put_named("; longest event: ", longest * 64L);
    port_puts(" cycles\n");
    return judge();
}
