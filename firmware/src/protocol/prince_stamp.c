#include "prince_node.h"

void mh_prince_detect(struct mh_prince *p, struct mh_prince_row *row)
{
    (void)p;
    (void)row;
}

void mh_prince_say_detection(struct mh_prince *p, struct mh_prince_row *row)
{
    (void)p;
    (void)row;
}

void mh_prince_decide_first(struct mh_prince *p, struct mh_prince_row *row)
{
    (void)p;
    (void)row;
}

void mh_prince_hear_detection(struct mh_prince *p, const mh_detection_t *detection)
{
    (void)p;
    (void)detection;
}

void mh_prince_hear_suppress(struct mh_prince *p, const mh_suppress_t *suppress)
{
    (void)p;
    (void)suppress;
}

void mh_prince_release(struct mh_prince *p, struct mh_prince_row *row)
{
    (void)p;
    (void)row;
}
