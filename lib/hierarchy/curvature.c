/* SPDX-License-Identifier: MIT */
/*
 * Importance from curvature. Per vertex and frame the tensor of curvature is estimated from the dihedral angles of the
 * edges around the vertex (no cotangents: slivers do no harm); docs/importance.md tells why it is tamed as it is.
 */
#include <math.h>

#include "hierarchy/build.h"
#include "hierarchy/lanes.h"

typedef struct tensor_sums {
    sph__v8d t[6], area;
} tensor_sums;

SPH__INLINE void take_length(const sph__v8d x[3], sph__v8d *length)
{
    *length = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
    for (size_t l = 0; l < SPH__LANES; ++l) (*length)[l] = sqrt((*length)[l]);
}

/* Twice the area vector of (p, q, r). */
SPH__INLINE void area_vector(const float *p, const float *q, const float *r, size_t s, size_t i, sph__v8d n[3])
{
    sph__v8d e[3], f[3];
    for (size_t k = 0; k < 3; ++k) {
        const sph__v8d o = sph__load(p, k * s + i);
        e[k] = sph__load(q, k * s + i) - o;
        f[k] = sph__load(r, k * s + i) - o;
    }
    n[0] = e[1] * f[2] - e[2] * f[1];
    n[1] = e[2] * f[0] - e[0] * f[2];
    n[2] = e[0] * f[1] - e[1] * f[0];
}

/* Adds the edge p-q with its triangles (p, q, r) and (p, x, q): half its length times its angle, along it. `sums` are
 * seven rows: the tensor and the area of p's cell (that of (p, q, r)). `x` NULL: no second triangle. */
SPH__CLONES static void add_spoke(const float *p, const float *q, const float *r, const float *x, size_t s, double *sums)
{
    for (size_t i = 0; i < s; i += SPH__LANES) {
        sph__v8d n[3], m[3], d[3], e[3], length, other, edge, angle, sign, dot, scale;
        area_vector(p, q, r, s, i, n);
        take_length(n, &length);
        *(sph__v8d *)(sums + 6 * s + i) += length * (1.0 / 6.0);
        if (x == NULL) continue;
        area_vector(p, x, q, s, i, m);
        take_length(m, &other);
        for (size_t k = 0; k < 3; ++k) {
            n[k] = sph__select(length > 0, n[k] / length, length);
            m[k] = sph__select(other > 0, m[k] / other, other);
            d[k] = n[k] - m[k];
            e[k] = sph__load(q, k * s + i) - sph__load(p, k * s + i);
        }
        take_length(e, &edge);
        take_length(d, &angle); /* 2 sin(angle / 2) */
        dot = (n[1] * m[2] - n[2] * m[1]) * e[0] + (n[2] * m[0] - n[0] * m[2]) * e[1] +
              (n[0] * m[1] - n[1] * m[0]) * e[2];
        sign = sph__select(dot > 0, edge * 0 - 1.0, edge * 0 + 1.0);
        scale = sph__select((edge > 0) & (length > 0) & (other > 0), 0.5 * angle * sign / edge, edge * 0);
        *(sph__v8d *)(sums + 0 * s + i) += scale * e[0] * e[0];
        *(sph__v8d *)(sums + 1 * s + i) += scale * e[0] * e[1];
        *(sph__v8d *)(sums + 2 * s + i) += scale * e[0] * e[2];
        *(sph__v8d *)(sums + 3 * s + i) += scale * e[1] * e[1];
        *(sph__v8d *)(sums + 4 * s + i) += scale * e[1] * e[2];
        *(sph__v8d *)(sums + 5 * s + i) += scale * e[2] * e[2];
    }
}

static void spoke_corners(const uint32_t *corner, uint32_t v, uint32_t *next, uint32_t *previous)
{
    const unsigned at = corner[0] == v ? 0 : corner[1] == v ? 1 : 2;
    *next = corner[(at + 1) % 3];
    *previous = corner[(at + 2) % 3];
}

/* The other triangle (v, x, q) of the edge from v to q; SPH__NO_NODE where there is none. */
static uint32_t find_opposite(const sph__builder *b, uint32_t v, uint32_t q)
{
    for (size_t i = b->cell_starts[v]; i < b->cell_starts[v + 1]; ++i) {
        uint32_t next, previous;
        spoke_corners(b->cells + 3 * (size_t)b->vertex_cells[i], v, &next, &previous);
        if (previous == q) return next;
    }
    return SPH__NO_NODE;
}

/* The tensor and area rows around v. */
static void vertex_tensor(const sph__builder *b, uint32_t v, double *sums)
{
    const float *p = sph__node_center(b, v);
    memset(sums, 0, 7 * b->stride * sizeof *sums);
    for (size_t i = b->cell_starts[v]; i < b->cell_starts[v + 1]; ++i) {
        uint32_t next, previous, x;
        spoke_corners(b->cells + 3 * (size_t)b->vertex_cells[i], v, &next, &previous);
        x = find_opposite(b, v, next);
        add_spoke(p, sph__node_center(b, next), sph__node_center(b, previous),
                  x == SPH__NO_NODE ? NULL : sph__node_center(b, x), b->stride, sums);
    }
}

/* The median of values, which are reordered. */
static float median(float *values, uint32_t count)
{
    uint32_t low = 0, high = count - 1;
    const uint32_t middle = count / 2;
    while (low < high) { /* Hoare's selection */
        const float pivot = values[low + (high - low) / 2];
        uint32_t i = low, j = high;
        for (;;) {
            while (values[i] < pivot) ++i;
            while (values[j] > pivot) --j;
            if (i >= j) break;
            const float swapped = values[i];
            values[i++] = values[j];
            values[j--] = swapped;
        }
        if (middle <= j)
            high = j;
        else
            low = j + 1;
    }
    return values[middle];
}

sph_status sph__curvature_importance(sph__builder *b)
{
    const size_t s = b->stride;
    const double bbd = b->h->bounding_diagonal;
    double *sums = sph__alloc(b->context, 7, s * sizeof *sums);
    float *values = sph__alloc(b->context, s, sizeof *values);
    b->importance = sph__alloc(b->context, b->n, sizeof *b->importance);
    if (sums == NULL || values == NULL || b->importance == NULL) {
        sph__free(b->context, sums);
        sph__free(b->context, values);
        return sph__fail_memory(b->context);
    }
    for (uint32_t v = 0; v < b->n; ++v) {
        vertex_tensor(b, v, sums);
        for (uint32_t f = 0; f < b->frames; ++f) {
            const double *t = sums + f;
            const double a = t[6 * s];
            const double squared = t[0] * t[0] + t[3 * s] * t[3 * s] + t[5 * s] * t[5 * s] +
                                   2 * (t[s] * t[s] + t[2 * s] * t[2 * s] + t[4 * s] * t[4 * s]);
            values[f] = a > 0 ? (float)sqrt(1 + bbd * bbd * squared / (a * a)) : 1;
        }
        b->importance[v] = median(values, b->frames);
    }
    sph__free(b->context, sums);
    sph__free(b->context, values);
    return SPH_OK;
}
