/* SPDX-License-Identifier: MIT */
/* Programs over the simplex against every support tried in turn, and against the conditions of a minimum. */
#include <check.h>
#include <lapacke.h>
#include <math.h>
#include <string.h>

#include "numeric/simplex_qp.h"
#include "runner.h"
#include "support.h"

enum { MOST = SPH__SIMPLEX_QP_MOST };

typedef struct program {
    uint32_t count, stride;
    double h[MOST * MOST], b[MOST];
} program;

/* H = A'A of `rank` rows, times `scale`. */
static program make_program(uint64_t *state, uint32_t count, uint32_t rank, double scale)
{
    program p = {.count = count, .stride = count};
    double a[MOST][MOST];
    for (uint32_t r = 0; r < rank; ++r)
        for (uint32_t i = 0; i < count; ++i)
            a[r][i] = 2 * test_random_unit(state) - 1;
    for (uint32_t i = 0; i < count; ++i) {
        p.b[i] = scale * (test_random_unit(state) - 0.3);
        for (uint32_t k = 0; k < count; ++k)
            for (uint32_t r = 0; r < rank; ++r)
                p.h[i * p.stride + k] += scale * a[r][i] * a[r][k];
    }
    return p;
}

/* The least value over one support by its linear system, or infinity where a weight is negative or it is singular. */
static double value_of_support(const program *p, uint32_t support, double *w)
{
    double matrix[8 * 8] = {0}, right[8] = {0};
    uint32_t place[8], count = 0;
    lapack_int pivots[8];
    for (uint32_t i = 0; i < p->count; ++i)
        if (support >> i & 1) place[count++] = i;
    for (uint32_t i = 0; i < count; ++i) {
        for (uint32_t k = 0; k < count; ++k)
            matrix[i * (count + 1) + k] = p->h[place[i] * p->stride + place[k]];
        matrix[i * (count + 1) + count] = matrix[count * (count + 1) + i] = 1;
        right[i] = p->b[place[i]];
    }
    right[count] = 1;
    if (LAPACKE_dgesv(LAPACK_ROW_MAJOR, (lapack_int)count + 1, 1, matrix, (lapack_int)count + 1, pivots, right, 1) != 0)
        return INFINITY;
    memset(w, 0, p->count * sizeof *w);
    for (uint32_t i = 0; i < count; ++i) {
        if (!(right[i] >= -1e-12)) return INFINITY;
        w[place[i]] = fmax(right[i], 0);
    }
    return sph__simplex_qp_value(p->h, p->stride, p->b, p->count, w);
}

static void check_feasible(const program *p, const double *w)
{
    double sum = 0;
    for (uint32_t i = 0; i < p->count; ++i) {
        ck_assert(w[i] >= 0);
        sum += w[i];
    }
    ck_assert_double_eq_tol(sum, 1, 1e-14);
}

START_TEST(values_are_those_of_the_best_support_of_all)
{
    uint64_t state = 1;
    for (int i = 0; i < 3000; ++i) {
        const uint32_t count = 1 + (uint32_t)(test_random(&state) % 6);
        const double scale = pow(10, 12 * test_random_unit(&state) - 6);
        const program p = make_program(&state, count, count + 2, scale);
        double w[MOST] = {0}, best = INFINITY, other[MOST];
        sph__simplex_qp_room room;
        uint32_t steps;
        w[test_random(&state) % count] = 1;
        steps = sph__simplex_qp(p.h, p.stride, p.b, count, NULL, w, &room);
        ck_assert_uint_le(steps, 16 + 8 * count);
        check_feasible(&p, w);
        for (uint32_t support = 1; support < 1u << count; ++support)
            best = fmin(best, value_of_support(&p, support, other));
        ck_assert_msg(sph__simplex_qp_value(p.h, p.stride, p.b, count, w) <= best + 1e-9 * scale, "program %d", i);
    }
}
END_TEST

START_TEST(variables_that_are_not_allowed_stay_zero_and_the_rest_is_best)
{
    uint64_t state = 2;
    for (int i = 0; i < 1000; ++i) {
        const uint32_t count = 2 + (uint32_t)(test_random(&state) % 5);
        const uint32_t start = (uint32_t)(test_random(&state) % count);
        const program p = make_program(&state, count, count + 2, 1);
        double w[MOST] = {0}, best = INFINITY, other[MOST];
        uint8_t allowed[MOST];
        uint32_t mask = 1u << start;
        sph__simplex_qp_room room;
        for (uint32_t k = 0; k < count; ++k) {
            allowed[k] = k == start || test_random(&state) % 2;
            mask |= (uint32_t)allowed[k] << k;
        }
        w[start] = 1;
        sph__simplex_qp(p.h, p.stride, p.b, count, allowed, w, &room);
        check_feasible(&p, w);
        for (uint32_t support = 1; support < 1u << count; ++support)
            if ((support & ~mask) == 0) best = fmin(best, value_of_support(&p, support, other));
        for (uint32_t k = 0; k < count; ++k)
            ck_assert(allowed[k] || w[k] == 0);
        ck_assert(sph__simplex_qp_value(p.h, p.stride, p.b, count, w) <= best + 1e-9);
    }
}
END_TEST

/* Singular ones too: no direction along which the value falls may be left, whichever minimum was taken. */
START_TEST(no_slope_is_left_in_large_and_singular_programs_and_values_never_rise)
{
    uint64_t state = 3;
    for (int i = 0; i < 300; ++i) {
        const uint32_t count = 2 + (uint32_t)(test_random(&state) % (MOST - 1));
        const uint32_t rank = 1 + (uint32_t)(test_random(&state) % count);
        const program p = make_program(&state, count, rank, 1);
        const bool linear = i % 2;
        const double *b = linear ? p.b : NULL;
        double w[MOST] = {0}, before, mean = 0, slope[MOST], sum = 0;
        sph__simplex_qp_room room;
        for (uint32_t k = 0; k < count; ++k)
            sum += w[k] = test_random(&state) % 3 ? 0 : test_random_unit(&state);
        if (sum == 0) sum = w[0] = 1;
        for (uint32_t k = 0; k < count; ++k)
            w[k] /= sum;
        before = sph__simplex_qp_value(p.h, p.stride, b, count, w);
        const uint32_t steps = sph__simplex_qp(p.h, p.stride, b, count, NULL, w, &room);
        check_feasible(&p, w);
        ck_assert(sph__simplex_qp_value(p.h, p.stride, b, count, w) <= before + 1e-12);
        for (uint32_t k = 0; k < count; ++k) {
            slope[k] = linear ? -p.b[k] : 0;
            for (uint32_t q = 0; q < count; ++q)
                slope[k] += p.h[k * count + q] * w[q];
            mean += slope[k] * w[k];
        }
        for (uint32_t k = 0; k < count; ++k)
            ck_assert_msg(slope[k] - mean >= -1e-6, "program %d: slope %g of %u, rank %u, w %g steps %u", i, slope[k] - mean, count, rank, w[k], steps);
    }
}
END_TEST

START_TEST(a_flat_program_leaves_the_start)
{
    const double h[4] = {0};
    double w[2] = {0.25, 0.75};
    sph__simplex_qp_room room;
    sph__simplex_qp(h, 2, NULL, 2, NULL, w, &room);
    ck_assert_double_eq(w[0], 0.25);
    ck_assert_double_eq(w[1], 0.75);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("simplex_qp");
    TCase *tc = tcase_create("programs");
    tcase_add_test(tc, values_are_those_of_the_best_support_of_all);
    tcase_add_test(tc, variables_that_are_not_allowed_stay_zero_and_the_rest_is_best);
    tcase_add_test(tc, no_slope_is_left_in_large_and_singular_programs_and_values_never_rise);
    tcase_add_test(tc, a_flat_program_leaves_the_start);
    return run_suite(suite, tc);
}
