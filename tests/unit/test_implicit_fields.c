/* SPDX-License-Identifier: MIT */
/* Fields and operators of implicit skinning against what defines them. */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "implicit_case.h"
#include "runner.h"

static const double PI = 3.14159265358979323846, UNION = 0.78539816339744831;
static tube t;
static sph_context *context;
static sph_skin *skin;
static sph_implicit *implicit;

static void setup(void)
{
    context = test_context();
    tube_init(&t);
    skin = tube_skin(&t, context);
    implicit = tube_implicit(skin, &t, SPH_OPERATION_UNION);
    ck_assert_ptr_nonnull(implicit);
}

static void teardown(void)
{
    sph_implicit_destroy(implicit);
    sph_skin_destroy(skin);
    sph_context_destroy(context);
}

static double compose(int32_t operation, double theta, double f, double g)
{
    const double values[2] = {f, g};
    double result;
    return sph_operation_compose(operation, 0.5, theta, values, &result, NULL) == SPH_OK ? result : NAN;
}

/* --- operators: _i is the operation --- */

START_TEST(operators_do_not_mind_the_order_of_fields)
{
    for (double theta = 0; theta <= UNION; theta += UNION / 7)
        for (double f = 0; f <= 1; f += 0.0625)
            for (double g = 0; g <= 1; g += 0.0625)
                ck_assert_double_eq(compose(_i, theta, f, g), compose(_i, theta, g, f));
}
END_TEST

START_TEST(operators_are_never_below_the_larger_field_and_the_union_is_it)
{
    for (double theta = 0; theta <= UNION; theta += UNION / 7)
        for (double f = 0; f <= 1; f += 0.03125)
            for (double g = 0; g <= 1; g += 0.03125) {
                const double value = compose(_i, theta, f, g), large = fmax(f, g);
                ck_assert_double_ge(value, large - 1e-15);
                ck_assert_double_le(value, 1);
                if (large > 0.7 || _i == SPH_OPERATION_UNION) ck_assert_double_eq(value, large);
                ck_assert_double_eq(compose(_i, UNION, f, g), large);
            }
}
END_TEST

/* k of the definition, written out. */
static double least_partner(double theta, double c)
{
    const double tangent = tan(theta);
    return c <= 0.5 ? c * tangent : (7 - 5 * tangent) * c / 2 + 7 * (tangent - 1) / 4;
}

START_TEST(operators_are_the_larger_field_where_the_other_is_below_k_of_it)
{
    for (double theta = 0.05; theta < UNION; theta += 0.1)
        for (double f = 0.05; f < 0.7; f += 0.05) {
            const double k = least_partner(theta, f);
            ck_assert_double_eq(compose(_i, theta, f, 0.999 * k), f);
            if (_i != SPH_OPERATION_UNION) ck_assert_double_gt(compose(_i, theta, f, k + 0.1 * (f - k)), f);
        }
}
END_TEST

START_TEST(operators_solve_their_equation)
{
    for (double theta = 0; theta < UNION; theta += UNION / 9)
        for (double f = 0.02; f < 0.7; f += 0.03)
            for (double g = 0.02; g <= f; g += 0.03) {
                const double value = compose(_i, theta, f, g), k = least_partner(theta, value);
                const double dx = f - k, dy = g - k, s = dy / dx;
                const double p = _i == SPH_OPERATION_BULGE && dy > 0 ? 1 - 0.5 * (1 - s) * exp(1 - 1 / s) : 1;
                if (_i == SPH_OPERATION_UNION || g < least_partner(theta, f)) continue;
                ck_assert_double_ge(dy, -1e-9);
                ck_assert_double_eq_tol(sqrt(dx * dx + dy * dy), (value - k) * p, 1e-9);
            }
}
END_TEST

START_TEST(operators_have_no_jumps)
{
    const double h = 1e-6;
    double most = 0;
    for (double theta = 0; theta <= UNION; theta += UNION / 30)
        for (double f = 0; f < 1 - h; f += 0.017)
            for (double g = 0; g < 1 - h; g += 0.013) {
                const double value = compose(_i, theta, f, g);
                most = fmax(most, fabs(compose(_i, theta, f + h, g) - value));
                most = fmax(most, fabs(compose(_i, fmin(theta + h, UNION), f, g) - value));
            }
    ck_assert_double_le(most, 20 * h);
}
END_TEST

START_TEST(slopes_of_operators_are_those_of_finite_differences)
{
    const double h = 1e-6;
    for (double theta = 0.02; theta < UNION; theta += 0.07)
        for (double f = 0.021; f < 0.95; f += 0.0371)
            for (double g = 0.013; g < 0.95; g += 0.0413) {
                const double at[2] = {f, g};
                double value, slopes[2], by[2];
                ck_assert_int_eq(sph_operation_compose(_i, 0.5, theta, at, &value, slopes), SPH_OK);
                for (int k = 0; k < 2; ++k) {
                    const double df = k == 0 ? h : 0, dg = k == 1 ? h : 0;
                    by[k] = (compose(_i, theta, f + df, g + dg) - compose(_i, theta, f - df, g - dg)) / (2 * h);
                    ck_assert_double_ge(slopes[k], -1e-9);
                }
                if (fabs(f - g) < 1e-3 || fabs(value - 0.5) < 1e-3 || fabs(value - 0.7) < 2e-2) continue; /* creases */
                if (fabs(fmin(f, g) - least_partner(theta, fmax(f, g))) < 1e-2) continue;
                ck_assert_double_eq_tol(slopes[0], by[0], 1e-4);
                ck_assert_double_eq_tol(slopes[1], by[1], 1e-4);
            }
}
END_TEST

START_TEST(curves_meet_their_knots_and_are_flat_there)
{
    sph_theta_curve c;
    sph_theta_curve_preset(&c, _i);
    for (int k = 0; k < 3; ++k) {
        ck_assert_double_eq_tol(sph_theta_curve_at(&c, c.angles[k]), c.thetas[k], 1e-12);
        for (int side = -1; side <= 1; side += 2)
            ck_assert_double_eq_tol(sph_theta_curve_at(&c, c.angles[k] + side * 1e-3), c.thetas[k], 1e-9);
    }
    ck_assert_double_eq(sph_theta_curve_at(&c, PI), c.thetas[2]);
    for (double a = 0; a < PI; a += 0.01) {
        const double theta = sph_theta_curve_at(&c, a);
        ck_assert(theta >= 0 && theta <= UNION + 1e-12);
        ck_assert_double_eq_tol(sph_theta_curve_at(&c, a + 1e-6), theta, 1e-5);
    }
    if (_i == SPH_OPERATION_BLEND) { /* union when straight and from a right angle on, blend at half of it */
        ck_assert_double_eq_tol(sph_theta_curve_at(&c, 0), UNION, 1e-12);
        ck_assert_double_eq_tol(sph_theta_curve_at(&c, PI / 4), 0, 1e-12);
        ck_assert_double_eq_tol(sph_theta_curve_at(&c, 2), UNION, 1e-12);
    }
}
END_TEST

/* --- fields --- */

START_TEST(fields_interpolate_their_samples_and_normals)
{
    for (uint32_t b = 0; b < 2; ++b) {
        sph_implicit_part p = {.struct_size = sizeof p};
        double distance, gradient[3];
        ck_assert_int_eq(sph_implicit_get_part(implicit, b, &p), SPH_OK);
        ck_assert_uint_eq(p.sample_count, 51);
        ck_assert_uint_eq(p.closing_count, 1);
        for (uint32_t i = 0; i < p.sample_count; ++i) {
            ck_assert_int_eq(sph_implicit_distances(implicit, b, 1, p.samples + 3 * i, &distance, gradient), SPH_OK);
            ck_assert_double_eq_tol(distance, 0, 1e-8);
            for (int c = 0; c < 3; ++c)
                ck_assert_double_eq_tol(gradient[c], p.normals[3 * i + c], 1e-8);
        }
        /* closed beyond the joint, facing the other part */
        ck_assert_double_eq_tol(p.samples[3 * (p.sample_count - 1)], b == 0 ? 1.0 : -1.0, 0.02);
        ck_assert_double_eq_tol(p.normals[3 * (p.sample_count - 1)], b == 0 ? 1.0 : -1.0, 1e-5);
    }
}
END_TEST

START_TEST(samples_keep_their_distance_and_stay_on_the_part)
{
    sph_implicit_part p = {.struct_size = sizeof p};
    double least = INFINITY;
    ck_assert_int_eq(sph_implicit_get_part(implicit, 0, &p), SPH_OK);
    for (uint32_t i = 0; i + 1 < p.sample_count; ++i) {
        const double *x = p.samples + 3 * i;
        ck_assert_double_le(x[0], 0);
        ck_assert_double_le(hypot(x[1], x[2]), 1 + 1e-6);
        for (uint32_t k = 0; k < i; ++k)
            least = fmin(
                least, hypot(hypot(x[0] - p.samples[3 * k], x[1] - p.samples[3 * k + 1]), x[2] - p.samples[3 * k + 2]));
    }
    /* discs of half the distance fit onto the area, at a density that random samples do not reach */
    ck_assert_double_gt(50 * PI * least * least / 4, 0.4 * (2 * PI * 4 + PI));
}
END_TEST

START_TEST(fields_are_a_half_on_the_surface_one_deep_inside_and_nothing_far_away)
{
    for (size_t v = 0; v < TUBE_VERTICES; ++v) {
        const double p[3] = {(double)t.rest[v][0], (double)t.rest[v][1], (double)t.rest[v][2]};
        double f, g[3];
        uint32_t bone;
        ck_assert_int_eq(sph_implicit_evaluate(implicit, NULL, SPH_EVALUATION_EXACT, 1, p, &f, g, &bone), SPH_OK);
        if (fabs(p[0]) < 3) ck_assert_double_eq_tol(f, 0.5, 0.04); /* it rounds the rims at the ends */
        if (fabs(p[0]) < 3) ck_assert_double_lt(g[1] * p[1] + g[2] * p[2], 0);
        ck_assert_uint_lt(bone, 2);
    }
    {
        static const double POINTS[3][3] = {{-2, 0, 0}, {0, 9, 0}, {30, 0, 0}};
        double f[3], g[3][3];
        uint32_t bones[3];
        ck_assert_int_eq(sph_implicit_evaluate(implicit, NULL, SPH_EVALUATION_EXACT, 3, POINTS[0], f, g[0], bones),
                         SPH_OK);
        ck_assert_double_gt(f[0], 0.9);
        ck_assert_double_eq(f[1], 0);
        ck_assert_double_eq(f[2], 0);
        ck_assert_uint_eq(bones[1], UINT32_MAX);
    }
}
END_TEST

/* _i is the operation. */
START_TEST(gradients_of_the_composed_field_are_those_of_finite_differences)
{
    sph_implicit *own = tube_implicit(skin, &t, _i);
    double transforms[2][12];
    uint64_t state = 7;
    const double h = 1e-5;
    int compared = 0;
    ck_assert_ptr_nonnull(own);
    if (_i != SPH_OPERATION_UNION) { /* theta is held: let it be constant, so that all of the gradient is seen */
        sph_implicit_joint j = {.struct_size = sizeof j};
        ck_assert_int_eq(sph_implicit_get_joint(own, 0, &j), SPH_OK);
        j.curve.thetas[0] = j.curve.thetas[1] = j.curve.thetas[2] = 0.2;
        ck_assert_int_eq(sph_implicit_set_joint(own, 0, &j), SPH_OK);
    }
    tube_pose(1, 0.4, transforms);
    for (int i = 0; i < 2000; ++i) {
        double x[7][3], f[7], g[7][3];
        uint32_t bones[7];
        for (int c = 0; c < 21; ++c)
            x[c / 3][c % 3] = c < 3 ? 3 * test_random_unit(&state) - 1.5 : x[0][c % 3];
        for (int k = 0; k < 6; ++k)
            x[1 + k][k / 2] += k % 2 == 0 ? h : -h;
        ck_assert_int_eq(sph_implicit_evaluate(own, transforms[0], SPH_EVALUATION_EXACT, 7, x[0], f, g[0], bones),
                         SPH_OK);
        if (f[0] < 0.02 || f[0] > 0.68 || fabs(f[0] - 0.5) < 1e-3) continue;
        bool crease = false;
        for (int k = 1; k < 7; ++k)
            for (int c = 0; c < 3; ++c)
                crease = crease || fabs(g[k][c] - g[0][c]) > 1e-2;
        if (crease) continue;
        ++compared;
        for (int c = 0; c < 3; ++c)
            ck_assert_double_eq_tol(g[0][c], (f[1 + 2 * c] - f[2 + 2 * c]) / (2 * h), 2e-4);
    }
    ck_assert_int_gt(compared, 400);
    sph_implicit_destroy(own);
}
END_TEST

int main(void)
{
    Suite *s = suite_create("implicit_fields");
    TCase *operators = tcase_create("operators"), *fields = tcase_create("fields");
    tcase_add_loop_test(operators, operators_do_not_mind_the_order_of_fields, 0, 3);
    tcase_add_loop_test(operators, operators_are_never_below_the_larger_field_and_the_union_is_it, 0, 3);
    tcase_add_loop_test(operators, operators_are_the_larger_field_where_the_other_is_below_k_of_it, 0, 3);
    tcase_add_loop_test(operators, operators_solve_their_equation, 0, 3);
    tcase_add_loop_test(operators, operators_have_no_jumps, 0, 3);
    tcase_add_loop_test(operators, slopes_of_operators_are_those_of_finite_differences, 0, 3);
    tcase_add_loop_test(operators, curves_meet_their_knots_and_are_flat_there, 0, 3);
    tcase_add_checked_fixture(fields, setup, teardown);
    tcase_add_test(fields, fields_interpolate_their_samples_and_normals);
    tcase_add_test(fields, samples_keep_their_distance_and_stay_on_the_part);
    tcase_add_test(fields, fields_are_a_half_on_the_surface_one_deep_inside_and_nothing_far_away);
    tcase_add_loop_test(fields, gradients_of_the_composed_field_are_those_of_finite_differences, 0, 3);
    suite_add_tcase(s, operators);
    return run_suite(s, fields);
}
