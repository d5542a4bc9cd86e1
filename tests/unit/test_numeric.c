/* SPDX-License-Identifier: MIT */
#include <check.h>
#include <float.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>

#include "numeric/numeric.h"
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

static void random_vector(double a[3])
{
    for (int i = 0; i < 3; ++i)
        a[i] = uniform(-1, 1);
}

/* A sum of outer products of weights that differ by up to `decades`. */
static void random_matrix(double m[6], int count, double decades)
{
    double a[3];
    for (int i = 0; i < 6; ++i)
        m[i] = 0;
    for (int i = 0; i < count; ++i) {
        random_vector(a);
        sph__sym3_add_outer(pow(10, uniform(-decades, 0)), a, m);
    }
}

static void unpack(const double m[6], double full[9])
{
    static const int places[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    for (int i = 0; i < 9; ++i)
        full[i] = m[places[i]];
}

static double norm(const double m[6])
{
    double sum = 0;
    for (int i = 0; i < 6; ++i)
        sum += fabs(m[i]);
    return sum;
}

START_TEST(solutions_agree_with_lapack)
{
    for (int i = 0; i < 5000; ++i) {
        double m[6], full[9], b[3], x[3], expected[3], residual[3], condition, values[3], copy[9];
        lapack_int pivots[3];
        sph__sym3_factor factor;
        random_matrix(m, 3 + i % 5, i % 4);
        random_vector(b);
        unpack(m, full);
        unpack(m, copy);
        ck_assert_int_eq(LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'N', 'U', 3, copy, 3, values), 0);
        condition = values[2] / fabs(values[0]);
        if (condition > 1e12) continue;
        for (int j = 0; j < 3; ++j)
            expected[j] = b[j];
        ck_assert_int_eq(LAPACKE_dsysv(LAPACK_ROW_MAJOR, 'U', 3, 1, full, 3, pivots, expected, 1), 0);
        ck_assert(sph__sym3_factorize(m, &factor));
        sph__sym3_solve(&factor, b, x);
        for (int j = 0; j < 3; ++j)
            ck_assert_double_eq_tol(x[j], expected[j], 1e-14 * condition * sph__length(expected));
        /* Backward stable: the residual is small whatever the condition. */
        sph__sym3_apply(m, x, residual);
        sph__subtract(residual, b, residual);
        ck_assert_double_le(sph__length(residual), 1e-14 * norm(m) * sph__length(x));
        sph__sym3_solve(&factor, b, b);
        ck_assert_double_eq(b[0], x[0]);
    }
}
END_TEST

START_TEST(matrices_that_are_not_positive_are_refused)
{
    static const double bad[][6] = {{0, 0, 0, 0, 0, 0},    {1, 0, 0, 1, 0, 0},       {1, 1, 1, 1, 1, 1},
                                    {-1, 0, 0, -1, 0, -1}, {1, 0, 0, 1, 0, -1},      {1, 2, 0, 1, 0, 1},
                                    {NAN, 0, 0, 1, 0, 1},  {1, NAN, NAN, 1, NAN, 1}, {1, 0, 0, 1, 0, NAN}};
    sph__sym3_factor factor;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i)
        ck_assert_msg(!sph__sym3_factorize(bad[i], &factor), "matrix %zu", i);
}
END_TEST

START_TEST(determinant_and_adjugate_agree_with_lapack)
{
    for (int i = 0; i < 2000; ++i) {
        double m[6], full[9], adjugate[6], expected = 1, product[3], column[3], adjugate_full[9];
        lapack_int pivots[3];
        for (int j = 0; j < 6; ++j)
            m[j] = uniform(-1, 1);
        unpack(m, full);
        ck_assert_int_ge(LAPACKE_dgetrf(LAPACK_ROW_MAJOR, 3, 3, full, 3, pivots), 0);
        for (int j = 0; j < 3; ++j)
            expected *= full[4 * j] * (pivots[j] == j + 1 ? 1 : -1);
        ck_assert_double_eq_tol(sph__sym3_determinant(m), expected, 1e-14);
        sph__sym3_adjugate(m, adjugate);
        unpack(adjugate, adjugate_full);
        for (int j = 0; j < 3; ++j) {
            for (int k = 0; k < 3; ++k)
                column[k] = adjugate_full[3 * k + j];
            sph__sym3_apply(m, column, product);
            for (int k = 0; k < 3; ++k)
                ck_assert_double_eq_tol(product[k], j == k ? expected : 0.0, 1e-14);
        }
        sph__sym3_adjugate(m, m);
        ck_assert_double_eq(m[4], adjugate[4]);
    }
}
END_TEST

static void check_eigen(const double m[6])
{
    double full[9], expected[3], values[3], vectors[3][3], alone[3], product[3];
    const double tolerance = 2e-15 * norm(m) + DBL_MIN;
    unpack(m, full);
    ck_assert_int_eq(LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'N', 'U', 3, full, 3, expected), 0);
    sph__sym3_eigen(m, values, vectors);
    sph__sym3_eigen(m, alone, NULL);
    for (int j = 0; j < 3; ++j) {
        ck_assert_double_eq_tol(values[j], expected[j], tolerance);
        ck_assert_double_eq(values[j], alone[j]);
        ck_assert_double_eq_tol(sph__length(vectors[j]), 1.0, 1e-14);
        sph__sym3_apply(m, vectors[j], product);
        for (int k = 0; k < 3; ++k)
            ck_assert_double_eq_tol(product[k], values[j] * vectors[j][k], 2 * tolerance);
    }
    ck_assert_double_le(values[0], values[1]);
    ck_assert_double_le(values[1], values[2]);
    ck_assert_double_eq_tol(sph__dot(vectors[0], vectors[1]), 0.0, 1e-14);
    sph__cross(vectors[0], vectors[1], product);
    ck_assert_double_gt(sph__dot(product, vectors[2]), 0.99);
}

START_TEST(eigenvalues_agree_with_lapack)
{
    static const double special[][6] = {
        {0, 0, 0, 0, 0, 0},       {3, 0, 0, 2, 0, 1},         {1, 1, 1, 1, 1, 1},
        {2, 0, 0, 2, 0, 2},       {0, 1, 0, 0, 0, 0},         {1, 1e-160, 0, 1, 0, 1},
        {1, 1e-9, 1e-9, 1, 0, 1}, {1, 1e-20, 0, 1e-40, 0, 0}, {1, 1e-12, 0, 0, 1e-9, 0}};
    for (size_t i = 0; i < sizeof special / sizeof *special; ++i)
        check_eigen(special[i]);
    for (int i = 0; i < 5000; ++i) {
        double m[6];
        const double unit = pow(10, (i % 5) * 60 - 120);
        random_matrix(m, i % 7, i % 11);
        for (int j = 0; j < 6; ++j)
            m[j] *= unit;
        check_eigen(m);
    }
}
END_TEST

START_TEST(eigenvalues_of_what_is_not_finite_end)
{
    const double m[6] = {NAN, 1, INFINITY, 0, -INFINITY, 2};
    double values[3], vectors[3][3];
    sph__sym3_eigen(m, values, vectors);
}
END_TEST

START_TEST(lengths_neither_overflow_nor_vanish)
{
    for (int exponent = -1000; exponent <= 1000; exponent += 100) {
        double a[3] = {ldexp(3, exponent), 0, ldexp(-4, exponent)}, unit[3] = {a[0], a[1], a[2]};
        ck_assert_double_eq(sph__length(a), ldexp(5, exponent));
        ck_assert(sph__normalize(unit));
        ck_assert_double_eq_tol(unit[0], 0.6, 1e-15);
        ck_assert_double_eq_tol(unit[2], -0.8, 1e-15);
    }
}
END_TEST

START_TEST(vectors_without_a_direction_are_not_normalized)
{
    double bad[][3] = {{0, 0, 0}, {NAN, 0, 1}, {1, NAN, 0}, {INFINITY, 0, 0}, {0, 1, -INFINITY}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i) {
        const double before = bad[i][2];
        ck_assert(!sph__normalize(bad[i]));
        ck_assert(bad[i][2] == before);
        ck_assert_int_eq(sph__is_finite3(bad[i]), i == 0);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("numeric");
    TCase *tests = tcase_create("numeric");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, solutions_agree_with_lapack);
    tcase_add_test(tests, matrices_that_are_not_positive_are_refused);
    tcase_add_test(tests, determinant_and_adjugate_agree_with_lapack);
    tcase_add_test(tests, eigenvalues_agree_with_lapack);
    tcase_add_test(tests, eigenvalues_of_what_is_not_finite_end);
    tcase_add_test(tests, lengths_neither_overflow_nor_vanish);
    tcase_add_test(tests, vectors_without_a_direction_are_not_normalized);
    suite_add_tcase(suite, tests);
    return run_all(suite);
}
