#include "engine/random.h"
#include "port.h"
#include "scenarios.h"
#include "unity.h"
#include "world/field.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double pi = 3.141592653589793;
static char error[200];
static struct field field;

void setUp(void) { field = (struct field){0}; }
void tearDown(void) { field_free(&field); }

/* E1(x), the exponential integral: its series for small x, its continued fraction (Lentz) for large. */
static double exponential_integral(double x)
{
    if (x < 1.5) {
        double sum = -0.57721566490153286 - log(x), term = -1;
        for (int n = 1; n < 60; n++) {
            term *= -x / n;
            sum += term / n;
        }
        return sum;
    }
    double b = x + 1, c = 1e300, d = 1 / b, h = d;
    for (int i = 1; i < 300; i++) {
        const double a = -(double)i * i;
        b += 2;
        d = 1 / (a * d + b);
        c = b + a / c;
        h *= c * d;
    }
    return h * exp(-x);
}

static void exponential_integral_is_right(void) /* Abramowitz and Stegun, table 5.1 */
{
    TEST_ASSERT_TRUE(fabs(exponential_integral(0.5) - 0.559773595) < 1e-9);
    TEST_ASSERT_TRUE(fabs(exponential_integral(1.0) - 0.219383934) < 1e-9);
    TEST_ASSERT_TRUE(fabs(exponential_integral(2.0) - 0.048900511) < 1e-9);
}

static void still_source_has_its_closed_form(void)
{
    struct scenario scenario = e1();
    scenario.source.path = PATH_STILL;
    scenario.source.duration_s = 200;
    scenario.source.diffusion_m2ps = 0.7;
    TEST_ASSERT_EQUAL_INT(0, field_make(&field, &scenario, 0, error, sizeof error));
    double worst = 0;
    for (double t = 0.1; t < 200; t *= 1.7) {
        TEST_ASSERT_EQUAL_INT(0, field_prepare(&field, t));
        for (double r = 0.002; r < 100; r *= 1.3) {
            const double exact = 100 / (4 * pi * 0.7) * exponential_integral(r * r / (4 * 0.7 * t));
            if (exact > 1e-9) {
                worst = fmax(worst, fabs(field_concentration(&field, 0.6 * r, 0.8 * r) / exact - 1));
            }
        }
    }
    printf("still source: worst relative error %.2g\n", worst);
    TEST_ASSERT_TRUE(worst < 1e-9);
}

/* The same integral by adaptive Simpson in ln(age). */
struct integrand {
    const struct scenario *scenario;
    const struct trajectory *path;
    double x, y, t;
};

static double kernel(const struct integrand *f, double ln_age)
{
    const double s = exp(ln_age), d = f->scenario->source.diffusion_m2ps, tau = f->t - s;
    const struct point p = trajectory_position(f->path, tau);
    const double r2 = (f->x - p.x_m) * (f->x - p.x_m) + (f->y - p.y_m) * (f->y - p.y_m);
    const double mu =
        f->scenario->source.release_gps *
        (1 + f->scenario->source.release_variation * sin(2 * pi * tau / f->scenario->source.release_period_s));
    return mu / (4 * pi * d) * exp(-r2 / (4 * d * s));
}

static double adapt(const struct integrand *f, double a, double b, double fa, double fm, double fb, double whole,
                    double tolerance, int depth)
{
    const double m = 0.5 * (a + b), flm = kernel(f, 0.5 * (a + m)), frm = kernel(f, 0.5 * (m + b));
    const double left = (m - a) / 6 * (fa + 4 * flm + fm), right = (b - m) / 6 * (fm + 4 * frm + fb);
    const double change = left + right - whole;
    if (depth <= 0 || fabs(change) <= 15 * tolerance) {
        return left + right + change / 15;
    }
    return adapt(f, a, m, fa, flm, fm, left, tolerance / 2, depth - 1) +
           adapt(f, m, b, fm, frm, fb, right, tolerance / 2, depth - 1);
}

static double integrate(const struct integrand *f, double tolerance)
{
    double sum = 0;
    for (size_t i = 0; i < f->path->count; i++) { /* from break to break */
        const struct leg *leg = &f->path->legs[i];
        if (f->t <= leg->start_s) {
            break;
        }
        const double oldest = log(f->t - leg->start_s),
                     youngest = log(fmax(f->t - leg->start_s - leg->duration_s, 1e-8));
        enum { PIECES = 16 };
        for (int k = 0; k < PIECES; k++) {
            const double a = youngest + (oldest - youngest) * k / PIECES,
                         b = youngest + (oldest - youngest) * (k + 1) / PIECES;
            const double fa = kernel(f, a), fm = kernel(f, 0.5 * (a + b)), fb = kernel(f, b);
            sum += adapt(f, a, b, fa, fm, fb, (b - a) / 6 * (fa + 4 * fm + fb), tolerance / PIECES, 40);
        }
    }
    return sum;
}

/* Worst relative error over random places and times where C > 1e-9 g/m2, near the path and far from it. */
static double worst_error(const struct scenario *scenario, unsigned places)
{
    TEST_ASSERT_EQUAL_INT(0, field_make(&field, scenario, 0, error, sizeof error));
    const struct random_stream stream = random_stream(42, RANDOM_DEPLOYMENT);
    double worst = 0;
    unsigned judged = 0;
    for (unsigned i = 0; i < places; i++) {
        const double t = field.trajectory.duration_s * (1.1 * random_uniform(stream, 4 * i) + 1e-3);
        struct point p = {80 * random_uniform(stream, 4 * i + 1), 80 * random_uniform(stream, 4 * i + 2)};
        if (i % 2) { /* 2 mm to 20 m from some place of the path */
            const struct point on = trajectory_position(&field.trajectory, t * random_uniform(stream, 4 * i + 3));
            const double r = 2e-3 * exp(9.2 * random_uniform(stream, 4 * i + 1)), angle = 80 * p.y_m;
            p = (struct point){on.x_m + r * cos(angle), on.y_m + r * sin(angle)};
        }
        TEST_ASSERT_EQUAL_INT(0, field_prepare(&field, t));
        const double c = field_concentration(&field, p.x_m, p.y_m);
        const struct integrand f = {scenario, &field.trajectory, p.x_m, p.y_m, t};
        const double exact = integrate(&f, 1e-13 * fmax(c, 1e-9));
        if (exact > 1e-9) {
            worst = fmax(worst, fabs(c / exact - 1));
            judged++;
        }
    }
    TEST_ASSERT_TRUE(judged > places / 2);
    field_free(&field);
    return worst;
}

static void moving_source_against_adaptive_quadrature(void)
{
    for (int scene = 0; scene < 2; scene++) {
        for (double speed = 0.25; speed <= 8; speed *= 2) {
            struct scenario scenario = scene ? e2() : e1();
            scenario.source.speed_mps = speed;
            const double worst = worst_error(&scenario, 200);
            printf("E%d at %g m/s: worst relative error %.2g\n", scene + 1, speed, worst);
            TEST_ASSERT_TRUE(worst < 1e-9);
        }
    }
}

static void diffusion_and_release_may_vary(void)
{
    struct scenario scenario = e2();
    scenario.source.diffusion_m2ps = 0.1;
    double worst = worst_error(&scenario, 200);
    scenario.source.diffusion_m2ps = 5;
    worst = fmax(worst, worst_error(&scenario, 200));
    scenario.source.diffusion_m2ps = 1;
    scenario.source.release_variation = 0.95;
    for (double period = 1; period < 200; period *= 5) {
        scenario.source.release_period_s = period;
        worst = fmax(worst, worst_error(&scenario, 200));
    }
    printf("D 0.1 and 5, varying release: worst relative error %.2g\n", worst);
    TEST_ASSERT_TRUE(worst < 1e-9);
}

static void nothing_before_the_release_and_finite_at_the_source(void)
{
    const struct scenario scenario = e1();
    TEST_ASSERT_EQUAL_INT(0, field_make(&field, &scenario, 0, error, sizeof error));
    TEST_ASSERT_EQUAL_INT(0, field_prepare(&field, 0));
    TEST_ASSERT_TRUE(field_concentration(&field, 0, 0) == 0);
    TEST_ASSERT_EQUAL_INT(0, field_prepare(&field, 10));
    const struct point at = trajectory_position(&field.trajectory, 10);
    const double c = field_concentration(&field, at.x_m, at.y_m);
    TEST_ASSERT_TRUE(isfinite(c) && c > 100);
}

/* Mass is kept: the integral of C over the plane is what was released. */
static void mass_is_kept(void)
{
    const struct scenario scenario = e1();
    TEST_ASSERT_EQUAL_INT(0, field_make(&field, &scenario, 0, error, sizeof error));
    TEST_ASSERT_EQUAL_INT(0, field_prepare(&field, 20));
    double mass = 0;
    for (double x = -60.125; x < 80; x += 0.25) {
        for (double y = -60.125; y < 80; y += 0.25) {
            mass += field_concentration(&field, x, y) * 0.25 * 0.25;
        }
    }
    TEST_ASSERT_TRUE(fabs(mass / 2000 - 1) < 1e-3); /* the peak is a logarithmic spike */
}

/* The known answers' field: layout r2 with seed 0, E1, as float. */
static void known_answers(void)
{
    enum { NODES = 1280, INSTANTS = 97 };
    static float places[NODES][2], readings[INSTANTS][NODES];
    FILE *x = fopen(MOTEHOUND_KNOWN_ANSWERS "/luo/g1_X.f32", "rb"),
         *c = fopen(MOTEHOUND_KNOWN_ANSWERS "/luo/g1_C.f32", "rb");
    TEST_ASSERT_TRUE(x && c);
    TEST_ASSERT_EQUAL_UINT(NODES, fread(places, sizeof places[0], NODES, x));
    TEST_ASSERT_EQUAL_UINT(INSTANTS, fread(readings, sizeof readings[0], INSTANTS, c));
    fclose(x);
    fclose(c);
    const struct scenario scenario = e1();
    TEST_ASSERT_EQUAL_INT(0, field_make(&field, &scenario, 0, error, sizeof error));
    for (int p = 0; p < INSTANTS; p++) {
        TEST_ASSERT_EQUAL_INT(0, field_prepare(&field, p));
        for (int i = 0; i < NODES; i++) {
            const double value = field_concentration(&field, (double)places[i][0], (double)places[i][1]);
            const double expected = (double)readings[p][i];
            TEST_ASSERT_TRUE(fabs(value - expected) <= 1e-9 + 2e-5 * expected); /* places are rounded to 4e-6 m */
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(exponential_integral_is_right);
    RUN_TEST(still_source_has_its_closed_form);
    RUN_TEST(moving_source_against_adaptive_quadrature);
    RUN_TEST(diffusion_and_release_may_vary);
    RUN_TEST(nothing_before_the_release_and_finite_at_the_source);
    RUN_TEST(mass_is_kept);
    RUN_TEST(known_answers);
    port_exit(UNITY_END() > 0);
    return 0;
}
