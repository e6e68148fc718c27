#include "replayed.h"

#include <math.h>
#include <stdlib.h>

FILE *replayed_open(const char *name)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", MOTEHOUND_SHARED_DATA, name);
    FILE *file = fopen(path, "r");
    if (file) {
        replayed_skip_line(file);
    }
    return file;
}

void replayed_skip_line(FILE *file)
{
    for (int c = fgetc(file); c != '\n' && c != EOF;) {
        c = fgetc(file);
    }
}

void replayed_compare(struct replayed *replayed, double time, const struct mh_estimate *e)
{
    while (replayed->row + 2 < replayed->truth_count && replayed->truth[replayed->row + 1][0] < time) {
        replayed->row++;
    }
    const double *a = replayed->truth[replayed->row], *b = replayed->truth[replayed->row + 1];
    if (time < a[0] || time > b[0]) {
        return;
    }
    if (!e) {
        replayed->silent++;
        return;
    }
    replayed->starts += (e->flags & MH_ESTIMATE_STARTED) != 0;
    const double share = (time - a[0]) / (b[0] - a[0]);
    const double ex = (double)e->position.x + 0.001 * e->origin.x_mm - a[1] - share * (b[1] - a[1]);
    const double ey = (double)e->position.y + 0.001 * e->origin.y_mm - a[2] - share * (b[2] - a[2]);
    const double xx = (double)e->covariance.xx, xy = (double)e->covariance.xy, yy = (double)e->covariance.yy;
    if (replayed->compared < COMPARED_MAX) {
        replayed->squares += ex * ex + ey * ey;
        replayed->errors[replayed->compared] = hypot(ex, ey);
        replayed->nees[replayed->compared++] = (yy * ex * ex - 2 * xy * ex * ey + xx * ey * ey) / (xx * yy - xy * xy);
    }
}

static int by_value(const void *a, const void *b)
{
    const double left = *(const double *)a, right = *(const double *)b;
    return (left > right) - (left < right);
}

struct replayed_figures replayed_figures(struct replayed *replayed)
{
    const size_t count = (size_t)replayed->compared;
    double sum = 0;
    qsort(replayed->errors, count, sizeof replayed->errors[0], by_value);
    qsort(replayed->nees, count, sizeof replayed->nees[0], by_value);
    for (size_t i = 0; i < count; i++) {
        sum += replayed->nees[i];
    }
    struct replayed_figures figures = {.rmse_m = sqrt(replayed->squares / (double)count),
                                       .median_m = replayed->errors[count / 2],
                                       .nees_median = replayed->nees[count / 2],
                                       .nees_mean = sum / (double)count};
    snprintf(figures.text, sizeof figures.text,
             "rmse %.3f m, median %.3f m over %d instants, %d without a position, %d starts, NEES median %.2f (1.39 is "
             "exact), mean %.2f (2)",
             figures.rmse_m, figures.median_m, replayed->compared, replayed->silent, replayed->starts,
             figures.nees_median, figures.nees_mean);
    return figures;
}
