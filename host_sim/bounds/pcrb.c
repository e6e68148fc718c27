#include "bounds/pcrb.h"

#include <math.h>

enum { X, Y, SPEED, HEADING, STATES };

void information_add_range(struct information *information, const struct point *target, const struct point *node,
                           double sd_m)
{
    const double x = target->x_m - node->x_m, y = target->y_m - node->y_m;
    const double scale = (x * x + y * y) * sd_m * sd_m;
    if (scale > 0) {
        information->xx += x * x / scale;
        information->xy += x * y / scale;
        information->yy += y * y / scale;
    }
}

double information_bound(const struct information *information)
{
    const double determinant = information->xx * information->yy - information->xy * information->xy;
    return determinant > 0 ? (information->xx + information->yy) / determinant : (double)INFINITY;
}

void pcrb_begin(struct pcrb *pcrb, const struct mobility *mobility)
{
    const double x_m = mobility->width_m - 2 * mobility->margin_m, y_m = mobility->height_m - 2 * mobility->margin_m;
    *pcrb = (struct pcrb){{{0}}};
    pcrb->covariance[X][X] = x_m * x_m / 12;
    pcrb->covariance[Y][Y] = y_m * y_m / 12;
}

void pcrb_step(struct pcrb *pcrb, const struct mobility *mobility, const struct mobility_state *before,
               const struct mobility_state *after)
{
    const double c = mobility->interval_s * cos(before->heading_rad),
                 s = mobility->interval_s * sin(before->heading_rad);
    const double v = before->speed_mps, alpha = mobility->memory, noise = 1 - alpha * alpha;
    const double mirror_x = after->reflected_x ? -1 : 1, mirror_y = after->reflected_y ? -1 : 1;
    const double jacobian[STATES][STATES] = {{mirror_x, 0, mirror_x * c, -mirror_x * v * s},
                                             {0, mirror_y, mirror_y * s, mirror_y * v * c},
                                             {0, 0, alpha, 0},
                                             {0, 0, 0, mirror_x * mirror_y * alpha}};
    double half[STATES][STATES] = {{0}}; /* F P */
    for (int i = 0; i < STATES; i++) {
        for (int j = 0; j < STATES; j++) {
            for (int k = 0; k < STATES; k++) {
                half[i][j] += jacobian[i][k] * pcrb->covariance[k][j];
            }
        }
    }
    for (int i = 0; i < STATES; i++) {
        for (int j = 0; j <= i; j++) {
            double sum = 0;
            for (int k = 0; k < STATES; k++) {
                sum += half[i][k] * jacobian[j][k];
            }
            pcrb->covariance[i][j] = pcrb->covariance[j][i] = sum;
        }
    }
    pcrb->covariance[SPEED][SPEED] += noise * mobility->speed_sd_mps * mobility->speed_sd_mps;
    pcrb->covariance[HEADING][HEADING] += noise * mobility->heading_sd_rad * mobility->heading_sd_rad;
}

/* P - P C' (I + J A)^-1 J C P, where C takes the position out of the state and A = C P C': holds for a singular J too. */
void pcrb_measure(struct pcrb *pcrb, const struct information *information)
{
    double(*p)[STATES] = pcrb->covariance;
    const struct information j = *information;
    const double a = 1 + j.xx * p[X][X] + j.xy * p[X][Y], b = j.xx * p[X][Y] + j.xy * p[Y][Y];
    const double c = j.xy * p[X][X] + j.yy * p[X][Y], d = 1 + j.xy * p[X][Y] + j.yy * p[Y][Y];
    const double determinant = a * d - b * c;
    const double xx = (d * j.xx - b * j.xy) / determinant, xy = (d * j.xy - b * j.yy) / determinant;
    const double yy = (a * j.yy - c * j.xy) / determinant;
    double x[STATES], y[STATES];
    for (int k = 0; k < STATES; k++) {
        x[k] = p[X][k];
        y[k] = p[Y][k];
    }
    for (int k = 0; k < STATES; k++) {
        for (int l = 0; l <= k; l++) {
            p[k][l] -= xx * x[k] * x[l] + xy * (x[k] * y[l] + y[k] * x[l]) + yy * y[k] * y[l];
            p[l][k] = p[k][l];
        }
    }
}

double pcrb_bound(const struct pcrb *pcrb) { return pcrb->covariance[X][X] + pcrb->covariance[Y][Y]; }

struct pcrb_of_walk pcrb_of_walk(const struct mobility *mobility, uint64_t seed, size_t steps, size_t skip,
                                 const struct deployment *deployment, double range_m, double sd_m)
{
    struct pcrb pcrb;
    struct mobility_state state = mobility_start(mobility, seed);
    double sum = 0, snapshot_sum = 0;
    size_t count = 0, snapshots = 0;
    pcrb_begin(&pcrb, mobility);
    for (size_t n = 0; n <= steps; n++) {
        if (n > 0) {
            const struct mobility_state before = state;
            mobility_next(mobility, seed, n, &state);
            pcrb_step(&pcrb, mobility, &before, &state);
        }
        struct information information = {0, 0, 0};
        size_t nodes = 0;
        for (size_t i = 0; i < deployment->count; i++) {
            const struct point node = {deployment->nodes[i].x_m, deployment->nodes[i].y_m};
            const double x_m = node.x_m - state.at.x_m, y_m = node.y_m - state.at.y_m;
            if (x_m * x_m + y_m * y_m <= range_m * range_m) {
                information_add_range(&information, &state.at, &node, sd_m);
                nodes++;
            }
        }
        pcrb_measure(&pcrb, &information);
        if (n >= skip) {
            sum += pcrb_bound(&pcrb);
            count++;
        }
        if (n >= skip && nodes >= 3) {
            snapshot_sum += information_bound(&information);
            snapshots++;
        }
    }
    return (struct pcrb_of_walk){.pcrb_m = count > 0 ? sqrt(sum / (double)count) : (double)NAN,
                                 .snapshot_m = snapshots > 0 ? sqrt(snapshot_sum / (double)snapshots) : (double)NAN};
}
