#include "clock_network.h"

#include "engine/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const int64_t frame_us = 2376; /* 1 ms to begin, 43 bytes at 250 kbit/s */
static const int64_t second_us = 1000000;

void clock_network_make(struct clock_network *network, const struct clock_case *c)
{
    memset(network, 0, sizeof *network);
    network->c = *c;
    const uint8_t sent_q8 = (uint8_t)(c->backoff_us > 0 ? 128 : frame_us % 1000 * 256 / 1000);
    network->root = (struct mh_clock_config){.root = true, .period = c->period, .wait = c->wait, .sent_q8 = sent_q8};
    network->other = (struct mh_clock_config){.period = c->period, .wait = c->wait, .sent_q8 = sent_q8};
    for (uint32_t i = 0; i < c->motes; i++) {
        struct clock_mote *mote = &network->motes[i];
        if (i > 0) {
            mote->local = local_clock_draw(c->seed, i, c->offset_s, c->drift_ppm, c->wander_ppm);
        }
        mote->ends = -1;
        mh_clock_init(&mote->clock, i > 0 ? &network->other : &network->root, i, local_clock_tick(&mote->local, 0));
    }
}

double clock_network_error_ms(const struct clock_network *network, uint32_t mote, int64_t now)
{
    const struct clock_mote *m = &network->motes[mote];
    const sim_time middle = (sim_time)(now / 1000 * 1000 + 500);
    uint8_t fraction;
    const mh_tick shown = mh_clock_network(&m->clock, local_clock_tick(&m->local, middle), &fraction);
    return mh_ticks_between((mh_tick)(middle / 1000), shown) + fraction / 256.0 - 0.5;
}

static void land(struct clock_network *network, uint32_t sender)
{
    struct clock_mote *from = &network->motes[sender];
    const struct random_stream stream = random_stream(network->c.seed, RANDOM_RADIO_LOSS);
    mh_clock_sent(&from->clock, local_clock_tick(&from->local, (sim_time)network->now), MH_SENT_OK);
    from->ends = -1;
    for (uint32_t i = 0; i < network->c.motes; i++) {
        struct clock_mote *to = &network->motes[i];
        const uint32_t distance = i > sender ? i - sender : sender - i;
        if (distance == 0 || distance > network->c.reach || to->dead ||
            random_uniform(stream, network->draws++) < network->c.loss) {
            continue;
        }
        mh_clock_message(&to->clock, local_clock_tick(&to->local, (sim_time)network->now), &from->frame);
    }
}

/* When something happens to `mote`, and what: its frame ends, or else its timer. INT64_MAX: nothing. */
static int64_t next_of(const struct clock_network *network, const struct clock_mote *mote)
{
    mh_tick due;
    if (mote->ends >= 0) {
        return mote->ends;
    }
    if (mote->dead || !mh_clock_due(&mote->clock, &due)) {
        return INT64_MAX;
    }
    const int64_t time = local_clock_time_of(&mote->local, (sim_time)network->now, due);
    return time > network->now ? time : network->now;
}

static void step(struct clock_network *network, uint32_t index)
{
    struct clock_mote *mote = &network->motes[index];
    struct mh_message message;
    if (mote->ends >= 0) {
        land(network, index);
    } else if (mh_clock_timer(&mote->clock, local_clock_tick(&mote->local, (sim_time)network->now), &message)) {
        mote->frame = message.as.sync;
        const struct random_stream stream = random_stream(network->c.seed, RANDOM_DEPLOYMENT);
        mote->ends =
            network->now + frame_us + (int64_t)(network->c.backoff_us * random_uniform(stream, network->frames));
        network->frames++;
    }
}

size_t clock_network_run(struct clock_network *network, double end_s, double *errors_ms, uint32_t *motes_of_errors)
{
    size_t count = 0;
    const int64_t end = (int64_t)(end_s * 1e6);
    int64_t second = network->now / second_us + 1;
    for (;;) {
        int64_t next = second * second_us;
        uint32_t who = UINT32_MAX;
        for (uint32_t i = 0; i < network->c.motes; i++) {
            const int64_t time = next_of(network, &network->motes[i]);
            if (time < next) {
                next = time;
                who = i;
            }
        }
        if (next >= end) {
            network->now = end;
            return count;
        }
        network->now = next;
        if (who != UINT32_MAX) {
            step(network, who);
            continue;
        }
        if (network->second) {
            network->second(network, second);
        }
        for (uint32_t i = 1; i < network->c.motes && errors_ms && (double)second >= network->c.settle_s; i++) {
            if (!network->motes[i].dead) {
                motes_of_errors[count] = i;
                errors_ms[count++] = fabs(clock_network_error_ms(network, i, network->now));
            }
        }
        second++;
    }
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double clock_quantile(double *values, size_t count, double share)
{
    qsort(values, count, sizeof *values, ascending);
    return values[(size_t)(share * (double)(count - 1))];
}
