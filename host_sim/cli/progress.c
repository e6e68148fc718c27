#include "cli/progress.h"

#include <stdio.h>
#include <unistd.h>

void progress_begin(struct progress *progress)
{
    progress->shown = isatty(STDERR_FILENO) == 1;
    clock_gettime(CLOCK_MONOTONIC, &progress->begin);
}

void progress_show(void *context, unsigned done, unsigned runs)
{
    enum { WIDTH = 30 };
    const struct progress *progress = context;
    if (!progress->shown) {
        return;
    }
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    const double passed =
        difftime(now.tv_sec, progress->begin.tv_sec) + 1e-9 * (double)(now.tv_nsec - progress->begin.tv_nsec);
    const unsigned full = done * WIDTH / runs;
    fprintf(stderr, "\r[%.*s%.*s] %u of %u runs", (int)full, "##############################", (int)(WIDTH - full),
            "..............................", done, runs);
    if (done > 0 && done < runs) {
        const unsigned long left = (unsigned long)(passed / done * (runs - done) + 0.5);
        fprintf(stderr, ", %lu:%02lu left", left / 60, left % 60);
    }
    fputs("\033[K", stderr);
    fflush(stderr);
}

void progress_end(struct progress *progress)
{
    if (progress->shown) {
        fputs("\r\033[K", stderr);
        fflush(stderr);
    }
}
