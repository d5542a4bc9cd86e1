/* SPDX-License-Identifier: MIT */
/* Hermite radial basis functions: d(x) = sum lambda r^3 + 3 r beta.(x - v), 0 with the given gradient at the samples.
 */
#include <math.h>

#include "implicit/implicit.h"
#include "numeric/dense.h"
#include "numeric/vector.h"

/* Pivots below this part of the largest number are rounding. */
static const double LEAST_PIVOT = 1e-13;
/* How far values and gradients may be off at the samples, in units of the part's size; else there is no field. */
static const double FIT_TOLERANCE = 1e-7;
enum { REFINEMENTS = 2 };

/* The place of a sample, scaled. */
static void scaled(const sph__field *f, size_t i, double p[3])
{
    for (int c = 0; c < 3; ++c)
        p[c] = (f->samples[3 * i + c] - f->origin[c]) / f->scale;
}

/* Value and gradient at sample i by lambda and beta of sample k: four rows of four. */
static void fill_pair(const sph__field *f, size_t i, size_t k, double *a)
{
    const size_t n = 4 * (size_t)f->count;
    double p[3], q[3], x[3], r;
    scaled(f, i, p);
    scaled(f, k, q);
    sph__subtract(p, q, x);
    r = sph__norm(x);
    a[0] = r * r * r;
    for (size_t c = 0; c < 3; ++c) {
        a[1 + c] = a[(1 + c) * n] = 3 * r * x[c];
        for (size_t d = 0; d < 3; ++d)
            a[(1 + c) * n + 1 + d] = r > 0 ? 3 * (x[c] * x[d] / r + (c == d ? r : 0)) : 0;
    }
}

static void fill_system(const sph__field *f, double *a, double *b)
{
    const size_t n = 4 * (size_t)f->count;
    for (size_t i = 0; i < f->count; ++i) {
        for (size_t k = 0; k < f->count; ++k)
            fill_pair(f, i, k, a + 4 * i * n + 4 * k);
        b[4 * i] = 0;
        memcpy(b + 4 * i + 1, f->normals + 3 * i, 3 * sizeof *b);
    }
}

/* residual = b - A x; its largest number. */
static double find_residual(const double *a, const double *b, const double *x, size_t n, double *residual)
{
    double most = 0;
    for (size_t r = 0; r < n; ++r) {
        double sum = b[r];
        for (size_t c = 0; c < n; ++c)
            sum -= a[r * n + c] * x[c];
        residual[r] = sum;
        if (!(fabs(sum) <= most)) most = fabs(sum);
    }
    return most;
}

static bool solve(const double *a, double *factors, double *numbers, uint32_t *order, size_t n)
{
    double *b = numbers, *x = numbers + n, *residual = numbers + 2 * n, *step = numbers + 3 * n, off;
    memcpy(factors, a, n * n * sizeof *a);
    if (!sph__dense_factorize(factors, n, LEAST_PIVOT, order)) return false;
    sph__dense_solve(factors, n, order, b, x);
    for (int i = 0; i < REFINEMENTS; ++i) {
        (void)find_residual(a, b, x, n, residual);
        sph__dense_solve(factors, n, order, residual, step);
        for (size_t k = 0; k < n; ++k)
            x[k] += step[k];
    }
    off = find_residual(a, b, x, n, residual);
    return off <= FIT_TOLERANCE; /* false for a NaN */
}

bool sph__field_fit(const sph_context *context, sph__field *field, bool *out_of_memory)
{
    const size_t n = 4 * (size_t)field->count;
    double *a = sph__alloc(context, n * n, sizeof *a), *factors = sph__alloc(context, n * n, sizeof *factors);
    double *numbers = sph__alloc(context, n, 4 * sizeof *numbers);
    uint32_t *order = sph__alloc(context, n, sizeof *order);
    bool fitted = false;
    field->centers = sph__zalloc(context, field->count, 8 * sizeof *field->centers);
    *out_of_memory = a == NULL || factors == NULL || numbers == NULL || order == NULL || field->centers == NULL;
    if (!*out_of_memory) {
        fill_system(field, a, numbers);
        fitted = solve(a, factors, numbers, order, n);
        for (size_t i = 0; i < field->count && fitted; ++i) {
            scaled(field, i, field->centers + 8 * i);
            memcpy(field->centers + 8 * i + 3, numbers + n + 4 * i, 4 * sizeof *numbers);
        }
    }
    sph__free(context, a);
    sph__free(context, factors);
    sph__free(context, numbers);
    sph__free(context, order);
    return fitted;
}
