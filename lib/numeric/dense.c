/* SPDX-License-Identifier: MIT */
#include "numeric/dense.h"

#include <math.h>

static void swap_rows(double *a, size_t n, size_t i, size_t k)
{
    for (size_t c = 0; c < n && i != k; ++c) {
        const double held = a[i * n + c];
        a[i * n + c] = a[k * n + c];
        a[k * n + c] = held;
    }
}

static size_t find_pivot(const double *a, size_t n, size_t column)
{
    size_t best = column;
    for (size_t r = column + 1; r < n; ++r)
        if (fabs(a[r * n + column]) > fabs(a[best * n + column])) best = r;
    return best;
}

bool sph__dense_factorize(double *a, size_t n, double least, uint32_t *order)
{
    double most = 0;
    for (size_t i = 0; i < n * n; ++i)
        most = fmax(most, fabs(a[i]));
    for (size_t i = 0; i < n; ++i)
        order[i] = (uint32_t)i;
    for (size_t c = 0; c < n; ++c) {
        const size_t pivot = find_pivot(a, n, c);
        const uint32_t held = order[c];
        if (!(fabs(a[pivot * n + c]) > least * most)) return false;
        swap_rows(a, n, c, pivot);
        order[c] = order[pivot];
        order[pivot] = held;
        for (size_t r = c + 1; r < n; ++r) {
            const double factor = a[r * n + c] /= a[c * n + c];
            for (size_t k = c + 1; k < n && factor != 0; ++k)
                a[r * n + k] -= factor * a[c * n + k];
        }
    }
    return true;
}

void sph__dense_solve(const double *factors, size_t n, const uint32_t *order, const double *b, double *x)
{
    for (size_t r = 0; r < n; ++r) {
        double sum = b[order[r]];
        for (size_t c = 0; c < r; ++c)
            sum -= factors[r * n + c] * x[c];
        x[r] = sum;
    }
    for (size_t r = n; r-- > 0;) {
        double sum = x[r];
        for (size_t c = r + 1; c < n; ++c)
            sum -= factors[r * n + c] * x[c];
        x[r] = sum / factors[r * n + r];
    }
}
