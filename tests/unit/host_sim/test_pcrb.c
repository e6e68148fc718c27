#include "bounds/pcrb.h"
#include "port.h"
#include "unity.h"

#include <math.h>

static const struct mobility walker = {.width_m = 1000,
                                       .height_m = 1000,
                                       .margin_m = 50,
                                       .interval_s = 2,
                                       .speed_mps = 4,
                                       .speed_sd_mps = 0.8,
                                       .heading_sd_rad = 0.4,
                                       .memory = 0.9};

void setUp(void) {}
void tearDown(void) {}

static void assert_near(double expected, double actual, double relative)
{
    TEST_ASSERT_TRUE(fabs(expected - actual) <= relative * fabs(expected));
}

/* `steps` undisturbed steps to the east, each ending with `information`. */
static struct pcrb walk_east(const struct mobility *mobility, int steps, const struct information *information)
{
    struct mobility_state state = {.at = {60, 500}, .speed_mps = mobility->speed_mps};
    struct pcrb pcrb;
    pcrb_begin(&pcrb, mobility);
    pcrb_measure(&pcrb, information);
    for (int n = 0; n < steps; n++) {
        const struct mobility_state before = state;
        mobility_step(mobility, 0, 0, &state);
        pcrb_step(&pcrb, mobility, &before, &state);
        pcrb_measure(&pcrb, information);
    }
    return pcrb;
}

/* Steady state of a scalar random walk of variance q a step, measured with variance r. */
static double steady(double q, double r) { return sqrt(q * q / 4 + q * r) - q / 2; }

/* Without memory each coordinate is a random walk: after the first step, whose speed and heading are known. */
static void without_memory(void)
{
    struct mobility mobility = walker;
    mobility.memory = 0;
    const double variance_m2 = 25, qx = pow(2 * 0.8, 2), qy = pow(2 * 4 * 0.4, 2);
    const struct information both = {1 / variance_m2, 0, 1 / variance_m2}, x_only = {1 / variance_m2, 0, 0};
    const struct pcrb pcrb = walk_east(&mobility, 100, &both);
    assert_near(steady(qx, variance_m2), pcrb.covariance[0][0], 1e-9);
    assert_near(steady(qy, variance_m2), pcrb.covariance[1][1], 1e-9);
    assert_near(steady(qx, variance_m2) + steady(qy, variance_m2), pcrb_bound(&pcrb), 1e-9);
    const struct pcrb blind = walk_east(&mobility, 100, &x_only);
    assert_near(steady(qx, variance_m2), blind.covariance[0][0], 1e-9);
    assert_near(900.0 * 900.0 / 12 + 99 * qy, blind.covariance[1][1], 1e-9);
}

/* With nothing but memory the motion is known, and only the start is to be found: an average. */
static void without_disturbance(void)
{
    struct mobility mobility = walker;
    mobility.memory = 1;
    const struct information both = {0.04, 0, 0.04}, none = {0, 0, 0};
    const double prior = 12 / (900.0 * 900.0);
    const struct pcrb pcrb = walk_east(&mobility, 49, &both);
    assert_near(2 / (prior + 50 * 0.04), pcrb_bound(&pcrb), 1e-9);
    const struct pcrb blind = walk_east(&mobility, 49, &none);
    assert_near(2 / prior, pcrb_bound(&blind), 1e-12);
}

static void of_ranges_alone(void)
{
    const struct point target = {100, 200};
    struct information information = {0, 0, 0};
    information_add_range(&information, &target, &target, 5);
    TEST_ASSERT_TRUE(information.xx == 0 && information.xy == 0 && information.yy == 0);
    TEST_ASSERT_TRUE(isinf(information_bound(&information)));
    /* n nodes evenly around it: 4 sigma^2 / n */
    for (int i = 0; i < 7; i++) {
        const double angle = 0.3 + 2 * acos(-1) * i / 7;
        const struct point node = {100 + (10 + i) * cos(angle), 200 + (10 + i) * sin(angle)};
        information_add_range(&information, &target, &node, 5);
    }
    assert_near(4 * 25.0 / 7, information_bound(&information), 1e-12);
    const struct point line[] = {{90, 200}, {80, 200}, {120, 200}};
    struct information collinear = {0, 0, 0};
    for (int i = 0; i < 3; i++) {
        information_add_range(&collinear, &target, &line[i], 5);
    }
    TEST_ASSERT_TRUE(isinf(information_bound(&collinear)));
}

/* ---- against the whole walk at once ---- */

enum { STEPS = 9, UNKNOWNS = 2 + 2 * STEPS };

/* Where the walk is at steps 0 ... STEPS, as a function of its start and disturbances. */
static void walk(const struct mobility *mobility, const double *unknowns, struct mobility_state *states)
{
    states[0] = (struct mobility_state){.at = {unknowns[0], unknowns[1]},
                                        .speed_mps = mobility->speed_mps,
                                        .heading_rad = 0.6,
                                        .mean_heading_rad = 0.6};
    for (int n = 1; n <= STEPS; n++) {
        states[n] = states[n - 1];
        mobility_step(mobility, unknowns[2 * n], unknowns[2 * n + 1], &states[n]);
    }
}

/* a x = b, a positive definite, by Gauss. */
static void solve(double a[UNKNOWNS][UNKNOWNS], double b[UNKNOWNS])
{
    for (int i = 0; i < UNKNOWNS; i++) {
        for (int k = i + 1; k < UNKNOWNS; k++) {
            const double factor = a[k][i] / a[i][i];
            for (int j = i; j < UNKNOWNS; j++) {
                a[k][j] -= factor * a[i][j];
            }
            b[k] -= factor * b[i];
        }
    }
    for (int i = UNKNOWNS; i-- > 0;) {
        for (int j = i + 1; j < UNKNOWNS; j++) {
            b[i] -= a[i][j] * b[j];
        }
        b[i] /= a[i][i];
    }
}

/* The bound at the last step from the information on all unknowns together, with derivatives of the walk itself, not of its equations. */
static double bound_at_once(const struct mobility *mobility, const double *unknowns, const struct information *measured)
{
    static double slope[STEPS + 1][2][UNKNOWNS];
    for (int i = 0; i < UNKNOWNS; i++) {
        const double step = 1e-4;
        double moved[UNKNOWNS];
        struct mobility_state more[STEPS + 1], less[STEPS + 1];
        for (int j = 0; j < UNKNOWNS; j++) {
            moved[j] = unknowns[j];
        }
        moved[i] = unknowns[i] + step;
        walk(mobility, moved, more);
        moved[i] = unknowns[i] - step;
        walk(mobility, moved, less);
        for (int n = 0; n <= STEPS; n++) {
            slope[n][0][i] = (more[n].at.x_m - less[n].at.x_m) / (2 * step);
            slope[n][1][i] = (more[n].at.y_m - less[n].at.y_m) / (2 * step);
        }
    }
    double bound = 0;
    for (int axis = 0; axis < 2; axis++) {
        double total[UNKNOWNS][UNKNOWNS] = {{0}}, column[UNKNOWNS];
        for (int i = 0; i < UNKNOWNS; i++) {
            const double side_m = (i == 0 ? mobility->width_m : mobility->height_m) - 2 * mobility->margin_m;
            total[i][i] = i < 2 ? 12 / (side_m * side_m) : 1;
            for (int j = 0; j < UNKNOWNS; j++) {
                for (int n = 0; n <= STEPS; n++) {
                    const double xi = slope[n][0][i], yi = slope[n][1][i], xj = slope[n][0][j], yj = slope[n][1][j];
                    total[i][j] +=
                        measured[n].xx * xi * xj + measured[n].xy * (xi * yj + yi * xj) + measured[n].yy * yi * yj;
                }
            }
            column[i] = slope[STEPS][axis][i];
        }
        solve(total, column);
        for (int i = 0; i < UNKNOWNS; i++) {
            bound += slope[STEPS][axis][i] * column[i];
        }
    }
    return bound;
}

static void by_all_steps_at_once(void)
{
    struct mobility mobility = walker;
    mobility.width_m = 140;
    mobility.height_m = 125;
    int reflections_x = 0, reflections_y = 0;
    for (uint64_t seed = 1; seed <= 50; seed++) {
        double unknowns[UNKNOWNS];
        struct mobility_state states[STEPS + 1];
        struct information measured[STEPS + 1];
        unknowns[0] = 60 + 10 * recipe_uniform(seed, 1, 0);
        unknowns[1] = 55 + 10 * recipe_uniform(seed, 1, 1);
        for (int i = 2; i < UNKNOWNS; i++) {
            unknowns[i] = recipe_normal(seed, 2, (uint64_t)i);
        }
        walk(&mobility, unknowns, states);
        struct pcrb pcrb;
        pcrb_begin(&pcrb, &mobility);
        for (int n = 0; n <= STEPS; n++) {
            measured[n] = (struct information){0, 0, 0};
            const uint64_t nodes = (uint64_t)(4 * recipe_uniform(seed, 5, (uint64_t)n)); /* up to three */
            for (uint64_t i = 10 * (uint64_t)n; i < 10 * (uint64_t)n + nodes; i++) {
                const struct point node = {140 * recipe_uniform(seed, 3, i), 125 * recipe_uniform(seed, 4, i)};
                information_add_range(&measured[n], &states[n].at, &node, 3);
            }
            if (n > 0) {
                pcrb_step(&pcrb, &mobility, &states[n - 1], &states[n]);
            }
            pcrb_measure(&pcrb, &measured[n]);
            reflections_x += states[n].reflected_x;
            reflections_y += states[n].reflected_y;
        }
        assert_near(bound_at_once(&mobility, unknowns, measured), pcrb_bound(&pcrb), 1e-5);
    }
    TEST_ASSERT_TRUE(reflections_x > 20 && reflections_y > 20);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(without_memory);
    RUN_TEST(without_disturbance);
    RUN_TEST(of_ranges_alone);
    RUN_TEST(by_all_steps_at_once);
    port_exit(UNITY_END() > 0);
    return 0;
}
