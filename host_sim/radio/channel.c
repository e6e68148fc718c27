#include "radio/channel.h"

enum loss_reason channel_verdict(struct channel *channel, const struct passage *passage)
{
    const uint64_t draw = passage->number * channel->places + passage->receiver->index;
    return channel->loss > 0 && random_uniform(channel->stream, draw) < channel->loss ? LOSS_RANDOM : LOSS_NONE;
}
