/* Why frames are lost. */
#ifndef MOTEHOUND_SIM_LOSS_H
#define MOTEHOUND_SIM_LOSS_H

/* The first ones happen at a receiver and count once for each; the last three at the sender, once for a frame that it gives up. */
enum loss_reason {
    LOSS_COLLISION, /* interference was too strong */
    LOSS_RANDOM,    /* the channel's own loss process */
    LOSS_DEAF,      /* the receiver was sending itself */
    LOSS_ASLEEP,
    LOSS_DEAD, /* the receiver, or the sender before the frame was out */
    LOSS_JAMMED,
    LOSS_PARTITION,
    LOSS_MUTE,  /* the radio of the head is out of order */
    LOSS_RANGE, /* the addressee is out of range */
    LOSS_BUSY,  /* the channel was never free */
    LOSS_NO_ACK,
    LOSS_QUEUE, /* the radio was full */
    LOSS_REASONS,
    LOSS_NONE = LOSS_REASONS
};

/* A reason that happens at a receiver. */
#define LOSS_AT_RECEIVER(reason) ((reason) < LOSS_BUSY)

#endif
