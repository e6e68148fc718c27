/* What a tracker makes of a recording, beside the truth that was recorded with it. */
#ifndef REPLAYED_H
#define REPLAYED_H

#include "motehound/estimate.h"

#include <stdbool.h>
#include <stdio.h>

enum { TRUTH_MAX = 12000, COMPARED_MAX = 12000 };

struct replayed {
    double truth[TRUTH_MAX][3]; /* time in the recording's unit, m, m; in order of time */
    int truth_count;
    int row; /* of the truth, for the time before */
    double squares, errors[COMPARED_MAX], nees[COMPARED_MAX];
    int compared, silent, starts;
};

/* Open the file `name` of the folder of recordings; NULL if it is not there. Its first line is skipped. */
FILE *replayed_open(const char *name);

/* Skip the rest of a line. */
void replayed_skip_line(FILE *file);

/* An estimate, or NULL for none, at `time`, the truth between two rows of which is taken to be on the straight line between them. */
void replayed_compare(struct replayed *replayed, double time, const struct mh_estimate *estimate);

/* What was found, in one line; sorts errors and nees. */
struct replayed_figures {
    double rmse_m, median_m, nees_median, nees_mean;
    char text[200];
} replayed_figures(struct replayed *replayed);

#endif
