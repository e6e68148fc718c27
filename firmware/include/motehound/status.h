/* What every Motehound function that can fail returns.
 *
 * Rule of the whole library: when a function returns anything but MH_OK its outputs are untouched and its state is as
 * if the call had not happened, unless its own comment says otherwise. */
#ifndef MOTEHOUND_STATUS_H
#define MOTEHOUND_STATUS_H

enum mh_status {
    MH_OK = 0,
    MH_NONE,           /* nothing to give yet; not an error (no position at this instant, nobody to ask) */
    MH_ERR_ARGUMENT,   /* a null pointer, or a configuration value outside its documented range */
    MH_ERR_NOT_FINITE, /* NaN or infinity in an input */
    MH_ERR_RANGE,      /* a finite input outside its documented range */
    MH_ERR_TIME,       /* an input older than what is already settled */
    MH_ERR_REPEATED,   /* an input that was taken before */
    MH_ERR_CAPACITY,   /* a fixed table is full; config.h names the constant that sizes it */
    MH_ERR_TOO_FEW,    /* fewer inputs than the problem has unknowns */
    MH_ERR_SINGULAR,   /* the geometry does not determine the answer */
    MH_ERR_CORRUPT,    /* a frame whose check sum, length or content is wrong */
    MH_ERR_UNKNOWN,    /* a frame of a message type that this build does not know */
    MH_ERR_NO_ROUTE    /* no next hop is known */
};

#endif
