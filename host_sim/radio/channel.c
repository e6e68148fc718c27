#include "radio/channel.h"

#include <math.h>
#include <stdlib.h>

static double seconds(sim_time time) { return (double)time / SIM_TIME_PER_S; }

/* The next state of a receiver's process. */
static void alternate(struct channel *channel, struct channel_burst *burst, uint64_t receiver)
{
    const double u = random_uniform(channel->burst_stream, burst->states++ * channel->places + receiver);
    burst->bad = !burst->bad;
    const double mean_s = burst->bad ? channel->config.bad_s : channel->config.good_s;
    burst->until += (sim_time)(-log1p(-u) * mean_s * SIM_TIME_PER_S) + 1;
}

/* A receiver begins in either state as often as it is in it. */
static void begin(struct channel *channel, struct channel_burst *burst, uint64_t receiver)
{
    const double u = random_uniform(channel->burst_stream, burst->states++ * channel->places + receiver);
    burst->bad = u >= channel->config.bad_s / (channel->config.good_s + channel->config.bad_s); /* turns at once */
    alternate(channel, burst, receiver);
}

int channel_make(struct channel *channel, const struct channel_config *config, size_t places, uint64_t seed)
{
    const struct faults *faults = &config->faults;
    *channel = (struct channel){.config = *config,
                                .loss_stream = random_stream(seed, RANDOM_RADIO_LOSS),
                                .burst_stream = random_stream(seed, RANDOM_RADIO_BURST),
                                .places = places};
    channel->quiet = !(config->loss > 0) && !(config->bad_s > 0) && !faults_include(faults, FAULT_PARTITION) &&
                     !faults_include(faults, FAULT_JAM) && !faults_include(faults, FAULT_MUTE);
    if (!(config->bad_s > 0)) {
        return 0;
    }
    channel->bursts = calloc(places, sizeof *channel->bursts);
    for (size_t i = 0; channel->bursts && i < places; i++) {
        begin(channel, &channel->bursts[i], i);
    }
    return channel->bursts ? 0 : -1;
}

void channel_free(struct channel *channel)
{
    free(channel->bursts);
    *channel = (struct channel){0};
}

static double loss_of(struct channel *channel, const struct passage *passage)
{
    if (!channel->bursts) {
        return channel->config.loss;
    }
    struct channel_burst *burst = &channel->bursts[passage->receiver->index];
    while (burst->until <= passage->end) {
        alternate(channel, burst, passage->receiver->index);
    }
    return burst->bad ? channel->config.burst_loss : channel->config.loss;
}

/* What is broken at that time. */
static enum loss_reason broken(const struct channel *channel, const struct passage *passage, double time_s)
{
    const struct faults *faults = &channel->config.faults;
    const struct place *from = passage->sender, *to = passage->receiver;
    const uint64_t head = channel->places - 1;
    if ((from->index == head || to->index == head) && faults_are_on(faults, FAULT_MUTE, time_s)) {
        return LOSS_MUTE;
    }
    if (faults_part(faults, time_s, from->x_m, from->y_m, to->x_m, to->y_m)) {
        return LOSS_PARTITION;
    }
    return faults_jam(faults, time_s, to->x_m, to->y_m) ? LOSS_JAMMED : LOSS_NONE;
}

enum loss_reason channel_verdict(struct channel *channel, const struct passage *passage)
{
    enum loss_reason reason = broken(channel, passage, seconds(passage->start));
    if (reason == LOSS_NONE) {
        reason = broken(channel, passage, seconds(passage->end));
    }
    if (reason != LOSS_NONE) {
        return reason;
    }
    const uint64_t draw = passage->number * channel->places + passage->receiver->index;
    return random_uniform(channel->loss_stream, draw) < loss_of(channel, passage) ? LOSS_RANDOM : LOSS_NONE;
}
