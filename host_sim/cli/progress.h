/* A progress bar on standard error, if that is a terminal; else nothing. */
#ifndef MOTEHOUND_SIM_PROGRESS_H
#define MOTEHOUND_SIM_PROGRESS_H

#include <stdbool.h>
#include <time.h>

struct progress {
    bool shown;
    struct timespec begin;
};

void progress_begin(struct progress *progress);

/* Runs done of all, and the time left at the pace so far. `context` is the struct progress. */
void progress_show(void *context, unsigned done, unsigned runs);

void progress_end(struct progress *progress);

#endif
