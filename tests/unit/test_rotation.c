/* SPDX-License-Identifier: MIT */
/* Nearest rotations against the singular value decomposition of LAPACK. */
#include <check.h>
#include <lapacke.h>
#include <math.h>
#include <string.h>

#include "numeric/rotation.h"
#include "runner.h"
#include "support.h"

static void random_matrix(uint64_t *state, double m[9])
{
    for (int i = 0; i < 9; ++i)
        m[i] = 2 * test_random_unit(state) - 1;
}

static double determinant(const double m[9])
{
    return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
}

/* U diag(1, 1, det UV') V' in `rotation`; the singular values, the last with that sign, in `values`. */
static void oracle(const double m[9], double rotation[9], double values[3])
{
    double a[9], u[9], vt[9], superb[2], sign;
    memcpy(a, m, sizeof a);
    ck_assert_int_eq(LAPACKE_dgesvd(LAPACK_ROW_MAJOR, 'A', 'A', 3, 3, a, 3, values, u, 3, vt, 3, superb), 0);
    sign = determinant(u) * determinant(vt) > 0 ? 1 : -1;
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k)
            rotation[3 * i + k] = u[3 * i] * vt[k] + u[3 * i + 1] * vt[3 + k] + sign * u[3 * i + 2] * vt[6 + k];
    values[2] *= sign;
}

static void check_proper(const double r[9])
{
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k)
            ck_assert_double_eq_tol(r[3 * i] * r[3 * k] + r[3 * i + 1] * r[3 * k + 1] + r[3 * i + 2] * r[3 * k + 2],
                                    i == k, 1e-14);
    ck_assert_double_eq_tol(determinant(r), 1, 1e-14);
}

static double trace_of(const double r[9], const double m[9])
{
    double sum = 0;
    for (int i = 0; i < 9; ++i)
        sum += r[i] * m[i];
    return sum;
}

/* The trace always agrees; the rotation itself where it is well determined. */
static void check_matrix(const double m[9])
{
    double r[9], expected[9], values[3], scale = 0;
    for (int i = 0; i < 9; ++i)
        scale = fmax(scale, fabs(m[i]));
    sph__nearest_rotation(m, r);
    check_proper(r);
    oracle(m, expected, values);
    ck_assert_double_eq_tol(trace_of(r, m), values[0] + values[1] + values[2], 1e-13 * scale);
    for (int i = 0; i < 9 && values[1] + values[2] > 1e-9 * scale; ++i)
        ck_assert_double_eq_tol(r[i], expected[i], 1e-13 * scale / (values[1] + values[2]));
}

START_TEST(rotations_agree_with_lapack_reflections_included)
{
    uint64_t state = 1;
    for (int i = 0; i < 20000; ++i) {
        const double scale = pow(10, 20 * test_random_unit(&state) - 10);
        double m[9];
        random_matrix(&state, m);
        for (int k = 0; k < 9; ++k)
            m[k] *= scale;
        check_matrix(m);
    }
}
END_TEST

START_TEST(flat_and_almost_flat_matrices_give_proper_rotations_of_largest_trace)
{
    uint64_t state = 2;
    for (int i = 0; i < 5000; ++i) {
        const double thin = i % 2 ? 0 : pow(10, -16 * test_random_unit(&state));
        double m[9], n[9];
        random_matrix(&state, m);
        random_matrix(&state, n);
        for (int k = 0; k < 3; ++k) /* rank 2, or 1 for every third */
            for (int c = 0; c < 3; ++c)
                m[3 * k + c] = n[k] * n[3 + c] + (i % 3 ? m[k] * m[3 + c] : 0) + thin * m[3 * k + c];
        check_matrix(m);
    }
}
END_TEST

START_TEST(a_rotation_is_its_own_nearest_and_its_quaternion_tells_it)
{
    uint64_t state = 3;
    for (int i = 0; i < 2000; ++i) {
        double m[9], r[9], again[9], q[4];
        random_matrix(&state, m);
        sph__nearest_rotation(m, r);
        sph__nearest_rotation(r, again);
        for (int k = 0; k < 9; ++k)
            ck_assert_double_eq_tol(again[k], r[k], 1e-14);
        sph__quaternion_from_rotation(r, q);
        ck_assert_double_eq_tol(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1, 1e-14);
        sph__rotation_from_quaternion(q, again);
        for (int k = 0; k < 9; ++k)
            ck_assert_double_eq_tol(again[k], r[k], 1e-14);
    }
}
END_TEST

START_TEST(nothing_gives_the_identity)
{
    const double zero[9] = {0};
    double r[9];
    sph__nearest_rotation(zero, r);
    for (int i = 0; i < 9; ++i)
        ck_assert_double_eq(r[i], i % 4 == 0);
}
END_TEST

START_TEST(eigenvalues_of_four_rows_agree_with_lapack)
{
    uint64_t state = 4;
    for (int i = 0; i < 5000; ++i) {
        double m[16], a[16], expected[4], values[4], vectors[16];
        for (int k = 0; k < 4; ++k)
            for (int c = k; c < 4; ++c)
                m[4 * k + c] = m[4 * c + k] = 2 * test_random_unit(&state) - 1;
        memcpy(a, m, sizeof a);
        ck_assert_int_eq(LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'N', 'U', 4, a, 4, expected), 0);
        sph__sym4_eigen(m, values, vectors);
        for (int k = 0; k < 4; ++k) {
            ck_assert_double_eq_tol(values[k], expected[3 - k], 1e-14);
            for (int c = 0; c < 4; ++c) {
                double image = 0;
                for (int q = 0; q < 4; ++q)
                    image += m[4 * c + q] * vectors[4 * k + q];
                ck_assert_double_eq_tol(image, values[k] * vectors[4 * k + c], 1e-13);
            }
        }
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("rotation");
    TCase *tc = tcase_create("rotations");
    tcase_add_test(tc, rotations_agree_with_lapack_reflections_included);
    tcase_add_test(tc, flat_and_almost_flat_matrices_give_proper_rotations_of_largest_trace);
    tcase_add_test(tc, a_rotation_is_its_own_nearest_and_its_quaternion_tells_it);
    tcase_add_test(tc, nothing_gives_the_identity);
    tcase_add_test(tc, eigenvalues_of_four_rows_agree_with_lapack);
    return run_suite(suite, tc);
}
