// A sensor node: its converter sees a source pass by, and what has risen goes to the head.
// The samples are scripted; with a sensor at A0, converter() is analogRead(A0). The radio is the serial line, a frame a line.
#include <motehound.h>
#ifdef __AVR__
#include <avr/sleep.h>
#endif

static mh_sensor_config sensor;
static mh_collection_config routing = {30000, 100, 40, 3, 15000, 5, 20};
static mh_collection route;
static mh_mote_config config;
static mh_port port;
static mh_mote mote;
static mh_tick alarm_time, sample_time;

static int32_t converter() {
  static const int16_t counts[] = {0, 8, 60, 190, 300, 330, 310};
  return counts[sample_time / sensor.interval];
}

// What the mote asks of its board: the radio and one timer.
static void transmit(void *, mh_node_id destination, const uint8_t *frame, size_t length) {
  Serial.print(F("frame to "));
  Serial.print((int32_t)destination);
  Serial.print(F(": "));
  for (size_t i = 0; i < length; i++) {
    Serial.print(frame[i] >> 4, HEX);
    Serial.print(frame[i] & 15, HEX);
  }
  Serial.println();
}

static void set_alarm(void *, mh_tick time) { alarm_time = time; }

// What a neighbour nearer to the head sends from time to time.
static void hear_beacon() {
  mh_message beacon = {};
  uint8_t frame[MH_FRAME_MAX];
  size_t length;
  beacon.kind = MH_MESSAGE_BEACON;
  beacon.as.beacon.sender = 4;
  beacon.as.beacon.sink = 1;
  beacon.as.beacon.round = 1;
  beacon.as.beacon.hops = 1;
  beacon.as.beacon.tracking = 1;
  mh_wire_encode(mh_protocol_collection.types, &beacon, frame, &length);
  mh_mote_frame(&mote, millis(), frame, length);
}

void setup() {
  Serial.begin(115200);
  sensor.q20_per_count = 5125; // 10 bits for 0 to 5 g/m2
  sensor.counts_max = 1023;
  sensor.interval = 1000;
  sensor.threshold = MH_Q20(0.2f);
  config.id = 17;
  config.place.x_mm = 12000;
  config.place.y_mm = 9000;
  config.sensor = &sensor;
  config.protocol = &mh_protocol_collection;
  config.protocol_config = &routing;
  config.protocol_state = &route;
  port.transmit = transmit;
  port.set_alarm = set_alarm;
  sample_time = millis();
  if (mh_mote_init(&mote, &config, &port, NULL, sample_time) != MH_OK) {
    Serial.println(F("the configuration is refused"));
  }
  hear_beacon();
}

void loop() {
  const mh_tick now = millis();
  if (!mh_tick_before(now, alarm_time)) {
    mh_mote_alarm(&mote, now);
  }
  if (!mh_tick_before(now, sample_time)) {
    const mh_reading reading = {sample_time, converter(), 0};
    mh_mote_reading(&mote, now, &reading);
    sample_time += sensor.interval;
  }
  if (sample_time >= 7000) { // the script's end
    Serial.print(mote.counters.reports);
    Serial.println(F(" reports"));
    Serial.flush();
#ifdef __AVR__
    noInterrupts();
    sleep_enable();
    sleep_cpu();
#endif
    for (;;) {}
  }
}
