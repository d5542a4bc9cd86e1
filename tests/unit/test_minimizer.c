/* SPDX-License-Identifier: MIT */
#include <check.h>
#include <math.h>
#include <stdlib.h>

#include "quadric/minimizer.h"
#include "runner.h"
#include "support.h"

static uint64_t state;

static double uniform(double low, double high)
{
    return test_random_between(&state, low, high);
}

static void setup(void)
{
    state = 88172645463325252u;
}

/* --- one by one: values by hand --- */
typedef struct box_case {
    const char *name;
    double mu, nu, w2, beta1, beta3;
    bool degenerate;
    double radius_max, lambda, r, value;
} box_case;

static const box_case CASES[] = {
    {"no degenerate frame: the vertex of the parabola", 9, 9, 2, 9, 3, false, 5, 0, 1.5, -2.25},
    {"no degenerate frame: r clamped at 0", 0, 0, 2, 0, -3, false, 5, 0, 0, 0},
    {"no degenerate frame: r clamped at R", 0, 0, 2, 0, 3, false, 1, 0, 1, -2},
    {"no degenerate frame: no bound", 0, 0, 2, 0, 3, false, INFINITY, 0, 1.5, -2.25},
    {"no degenerate frame: R = 0", 0, 0, 2, 0, 3, false, 0, 0, 0, 0},
    {"no degenerate frame: W2 and beta3 zero", 0, 0, 0, 0, 0, false, 5, 0, 0, 0},
    {"kernel 0: inside", 4, 1, 1, 2.5, 1, true, 5, 0.5, 0.5, -0.875},
    {"kernel 0: inside, no bound", 4, 1, 1, 2.5, 1, true, INFINITY, 0.5, 0.5, -0.875},
    {"kernel 0: the side lambda = 0", 2, 0, 1, -1, 1, true, 5, 0, 1, -0.5},
    {"kernel 0: the side lambda = 1", 2, 1, 1, 5, 2, true, 5, 1, 1, -4.5},
    {"kernel 0: the side r = 0", 2, 1, 1, 1, -1, true, 5, 0.5, 0, -0.25},
    {"kernel 0: the side r = R", 2, 1, 1, 2, 9, true, 1, 0.5, 1, -8.75},
    {"kernel 0: the corner (0, 0)", 2, 0, 1, -1, -1, true, 5, 0, 0, 0},
    {"kernel 0: the corner (1, 0)", 2, 0, 1, 4, -1, true, 5, 1, 0, -3},
    {"kernel 0: the corner (0, R)", 2, 0, 1, -1, 4, true, 2, 0, 2, -6},
    {"kernel 0: the corner (1, R)", 2, 0, 1, 4, 4, true, 2, 1, 2, -9},
    {"kernel 0: R = 0", 2, 1, 1, 1, 9, true, 0, 0.5, 0, -0.25},
    /* (lambda + r - t)^2 / 2 */
    {"kernel 1: the line meets r = 0", 1, 1, 1, 0.25, 0.25, true, 5, 0.25, 0, -0.03125},
    {"kernel 1: the line first meets lambda = 1", 1, 1, 1, 3, 3, true, 5, 1, 2, -4.5},
    {"kernel 1: the line first meets lambda = 1, no bound", 1, 1, 1, 3, 3, true, INFINITY, 1, 2, -4.5},
    {"kernel 1: the line passes beyond the corner (1, R)", 1, 1, 1, 3, 3, true, 1, 1, 1, -4},
    {"kernel 1: the line passes before the corner (0, 0)", 1, 1, 1, -1, -1, true, 5, 0, 0, 0},
    /* (lambda - r - t)^2 / 2 */
    {"kernel 1: a falling line meets r = 0", 1, -1, 1, 0.75, -0.75, true, 5, 0.75, 0, -0.28125},
    {"kernel 1: a falling line first meets lambda = 0", 1, -1, 1, -2, 2, true, 5, 0, 2, -2},
    {"kernel 1: a falling line passes beyond the corner (1, 0)", 1, -1, 1, 2, -2, true, 5, 1, 0, -1.5},
    {"kernel 1: a falling line passes beyond the corner (0, R)", 1, -1, 1, -2, 2, true, 1, 0, 1, -1.5},
    {"kernel 1: only r matters", 0, 0, 2, 0, 3, true, 5, 0.5, 1.5, -2.25},
    {"kernel 1: only r matters, clamped at 0", 0, 0, 2, 0, -3, true, 5, 0.5, 0, 0},
    {"kernel 1: only r matters, clamped at R", 0, 0, 2, 0, 3, true, 1, 0.5, 1, -2},
    {"kernel 1: only lambda matters", 2, 0, 0, 0.5, 0, true, 5, 0.25, 0, -0.0625},
    {"kernel 1: only lambda matters, no bound", 2, 0, 0, 3, 0, true, INFINITY, 1, 0, -2},
    {"kernel 2", 0, 0, 0, 0, 0, true, 5, 0.5, 0, 0},
    {"kernel 2: no bound", 0, 0, 0, 0, 0, true, INFINITY, 0.5, 0, 0},
};

START_TEST(each_case_of_the_box_has_the_minimum_computed_by_hand)
{
    const box_case *c = &CASES[_i];
    /* Powers of two scale a problem exactly; nothing in it may depend on the units. */
    for (int exponent = -900; exponent <= 900; exponent += 300) {
        const double unit = ldexp(1.0, exponent);
        const sph__box box = {.mu = c->mu * unit,
                              .nu = c->nu * unit,
                              .w2 = c->w2 * unit,
                              .beta1 = c->beta1 * unit,
                              .beta3 = c->beta3 * unit,
                              .noise = SPH__NOISE_DOUBLE};
        const sph__box_minimum found = sph__box_minimize(&box, c->degenerate, c->radius_max);
        ck_assert_msg(fabs(found.lambda - c->lambda) <= 1e-14, "%s: lambda %g", c->name, found.lambda);
        ck_assert_msg(fabs(found.radius - c->r) <= 1e-14, "%s: r %g", c->name, found.radius);
        ck_assert_msg(fabs(found.value / unit - c->value) <= 1e-14, "%s: value %g", c->name, found.value);
    }
}
END_TEST

/* The same with coefficients that are zero but for what rounding leaves of terms of size 1. */
START_TEST(what_rounding_leaves_of_zero_counts_as_zero)
{
    for (int i = 0; i < 20000; ++i) {
        const double noise = i % 2 ? SPH__NOISE_DOUBLE : SPH__NOISE_FLOAT;
        const double e = 0.2 * noise;
        sph__box box = {.w2 = uniform(-e, e), .beta3 = uniform(-e, e), .w2_scale = 1, .cost_scale = 1, .noise = noise};
        sph__box_minimum found = sph__box_minimize(&box, false, INFINITY);
        ck_assert_double_eq(found.radius, 0.0);
        found = sph__box_minimize(&box, false, 1.0);
        ck_assert_double_eq(found.radius, 0.0);

        box.mu = uniform(-e, e);
        box.nu = uniform(-e, e);
        box.beta1 = uniform(-e, e);
        box.mu_scale = 1;
        found = sph__box_minimize(&box, true, i % 3 ? 1.0 : INFINITY);
        ck_assert_double_eq(found.radius, 0.0);
        ck_assert_double_eq(found.lambda, 0.5);

        /* Only r matters; then a line that meets r = 0 at lambda = 1/4. */
        box.w2 = 1;
        box.beta3 = 0.3;
        found = sph__box_minimize(&box, true, i % 3 ? 1.0 : INFINITY);
        ck_assert_double_eq_tol(found.radius, 0.3, 2 * e);
        ck_assert_double_eq(found.lambda, 0.5);
        box.mu += 1;
        box.nu += 1;
        box.beta1 += 0.25;
        box.beta3 = 0.25 + uniform(-e, e);
        found = sph__box_minimize(&box, true, i % 3 ? 1.0 : INFINITY);
        ck_assert_double_eq_tol(found.radius, 0.0, 1e-300);
        ck_assert_double_eq_tol(found.lambda, 0.25, 3 * e);
    }
}
END_TEST

/* --- against a nested ternary search --- */
static long double exact_value(const sph__box *b, long double l, long double r)
{
    return 0.5L * b->mu * l * l + (long double)b->nu * l * r + 0.5L * b->w2 * r * r - b->beta1 * l - b->beta3 * r;
}

static long double search_radius(const sph__box *b, long double l, long double low, long double high)
{
    for (int i = 0; i < 120; ++i) {
        const long double a = low + (high - low) / 3, c = high - (high - low) / 3;
        if (exact_value(b, l, a) <= exact_value(b, l, c))
            high = c;
        else
            low = a;
    }
    return exact_value(b, l, (low + high) / 2);
}

static long double search(const sph__box *b, long double radius_max)
{
    long double low = 0, high = 1;
    for (int i = 0; i < 90; ++i) {
        const long double a = low + (high - low) / 3, c = high - (high - low) / 3;
        if (search_radius(b, a, 0, radius_max) <= search_radius(b, c, 0, radius_max))
            high = c;
        else
            low = a;
    }
    return search_radius(b, (low + high) / 2, 0, radius_max);
}

/* C is a sum of `rank` outer products, some of them hardly different, and the vector is in its range. */
static sph__box random_box(int rank)
{
    sph__box box = {.noise = SPH__NOISE_DOUBLE};
    const double x = uniform(-1, 2), y = uniform(-2, 3);
    const double near = uniform(0, 1) < 0.3 ? pow(10.0, uniform(-5, 0)) : 1.0;
    double p = uniform(-2, 2), q = uniform(-2, 2);
    for (int i = 0; i < rank; ++i) {
        box.mu += p * p;
        box.nu += p * q;
        box.w2 += q * q;
        p += near * uniform(-2, 2);
        q += near * uniform(-2, 2);
    }
    box.beta1 = box.mu * x + box.nu * y;
    box.beta3 = box.nu * x + box.w2 * y;
    box.cost_scale = 0.5 * (box.beta1 * x + box.beta3 * y); /* what makes the least value 0 */
    return box;
}

START_TEST(random_boxes_agree_with_a_ternary_search)
{
    static const double bounds[] = {0.0, 0.1, 1.0, 3.0, INFINITY};
    for (int i = 0; i < 2000; ++i) {
        const sph__box box = random_box(i % 3);
        const double radius_max = bounds[i % 5];
        const sph__box_minimum found = sph__box_minimize(&box, true, radius_max);
        const double best = (double)search(&box, isinf(radius_max) ? 1e4L : radius_max);
        const double tolerance = 1e-12 * (1e-3 + box.mu + box.w2 + box.cost_scale);
        ck_assert(found.lambda >= 0 && found.lambda <= 1 && found.radius >= 0 && found.radius <= radius_max);
        ck_assert_double_eq_tol(found.value, (double)exact_value(&box, found.lambda, found.radius), tolerance);
        ck_assert_double_eq_tol(found.value, best, tolerance);
    }
}
END_TEST

START_TEST(any_input_whatever_gives_a_point_in_the_box)
{
    static const double odd[] = {0, -0.0, 1, -1, 1e308, -1e308, 5e-324, INFINITY, -INFINITY, (double)NAN};
    static const double bounds[] = {0, 5e-324, 1, 1e308, INFINITY};
    for (int i = 0; i < 20000; ++i) {
        double v[8], radius_max = bounds[i % 5];
        sph__box box;
        sph__box_minimum found;
        for (int j = 0; j < 8; ++j)
            v[j] = odd[(int)uniform(0, 10)];
        box = (sph__box){v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], SPH__NOISE_DOUBLE};
        found = sph__box_minimize(&box, i % 2, radius_max);
        ck_assert(found.lambda >= 0 && found.lambda <= 1 && (i % 2 || found.lambda == 0));
        ck_assert(found.radius >= 0 && found.radius <= radius_max && isfinite(found.radius));
    }
}
END_TEST

START_TEST(degenerate_matrices_are_told_from_regular_ones_at_any_scale)
{
    static const struct {
        double m[6];
        bool degenerate;
    } cases[] = {
        {{1, 0, 0, 1, 0, 1}, false},       {{2, 1, 0, 2, 0, 1}, false},   {{1, 0, 0, 1, 0, 1e-3}, false},
        {{1, 0, 0, 1e-2, 0, 1e-2}, false}, {{1, 0, 0, 1, 0, 0}, true},    {{1, 1, 1, 1, 1, 1}, true},
        {{0, 0, 0, 0, 0, 0}, true},        {{1, 0, 0, 1, 0, 1e-8}, true}, {{1, 0, 0, 1e-5, 0, 1e-5}, true},
        {{-1, 0, 0, -1, 0, -1}, true},     {{NAN, 0, 0, 1, 0, 1}, true},  {{INFINITY, 0, 0, 1, 0, 1}, true},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i)
        for (int exponent = -900; exponent <= 900; exponent += 300) {
            double m[6];
            for (int j = 0; j < 6; ++j)
                m[j] = ldexp(cases[i].m[j], exponent);
            ck_assert_msg(sph__is_degenerate(m) == cases[i].degenerate, "case %zu at 2^%d", i, exponent);
        }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("minimizer");
    TCase *tests = tcase_create("minimizer");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_loop_test(tests, each_case_of_the_box_has_the_minimum_computed_by_hand, 0,
                        (int)(sizeof CASES / sizeof *CASES));
    tcase_add_test(tests, what_rounding_leaves_of_zero_counts_as_zero);
    tcase_add_test(tests, random_boxes_agree_with_a_ternary_search);
    tcase_add_test(tests, any_input_whatever_gives_a_point_in_the_box);
    tcase_add_test(tests, degenerate_matrices_are_told_from_regular_ones_at_any_scale);
    suite_add_tcase(suite, tests);
    return run_all(suite);
}
