/* SPDX-License-Identifier: MIT */
/* The loops of conjugate gradients, for eight right-hand sides side by side. */
#include "hierarchy/lanes.h"
#include "skin/heat.h"

typedef sph__v8d v8d;

SPH__CLONES static void apply(const sph__heat_matrix *m, const v8d *x, v8d *out)
{
    for (size_t i = 0; i < m->n; ++i) {
        v8d sum = x[i] * m->diagonal[i];
        for (size_t e = m->starts[i]; e < m->starts[i + 1]; ++e)
            sum += x[m->columns[e]] * m->entries[e];
        out[i] = sum;
    }
}

void sph__heat_kernel_apply(const sph__heat_matrix *m, const double *x, double *out)
{
    apply(m, (const v8d *)x, (v8d *)out);
}

SPH__CLONES static void dot(const v8d *a, const v8d *b, size_t n, v8d *out)
{
    v8d sum = {0};
    for (size_t i = 0; i < n; ++i)
        sum += a[i] * b[i];
    *out = sum;
}

void sph__heat_kernel_dot(const double *a, const double *b, size_t n, double dots[SPH__HEAT_LANES])
{
    v8d sum;
    dot((const v8d *)a, (const v8d *)b, n, &sum);
    memcpy(dots, &sum, sizeof sum);
}

SPH__CLONES static void add(v8d *to, const v8d *scale, const v8d *from, size_t n)
{
    const v8d s = *scale;
    for (size_t i = 0; i < n; ++i)
        to[i] += s * from[i];
}

void sph__heat_kernel_add(double *to, const double scale[SPH__HEAT_LANES], const double *from, size_t n)
{
    v8d s;
    memcpy(&s, scale, sizeof s);
    add((v8d *)to, &s, (const v8d *)from, n);
}
