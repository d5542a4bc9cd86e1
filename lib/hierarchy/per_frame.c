/* SPDX-License-Identifier: MIT */
/*
 * Radii that vary over time (Fig. 5): each frame is a problem of its own, with its own lambda, radius and radius bound.
 * Frame by frame and in double precision: this is for study, not the path that must be fast.
 */
#include <math.h>

#include "hierarchy/build.h"
#include "quadric/minimizer.h"

/* The united quadric of one frame, relative to the sphere of u. */
typedef struct frame_quadric {
    double m[6], n[3], b[3], d[3], w, s, c; /* s: the scalar B */
} frame_quadric;

static float *entry(float *block, size_t row, size_t frame)
{
    return block + sph__block_place(SPH__BLOCK_ROWS, row, frame);
}

static double radius_of(const sph__builder *b, uint32_t node, size_t f)
{
    return (double)b->h->radii[node * b->stride + f];
}

static void multiply(const double m[6], const double x[3], double y[3])
{
    y[0] = m[0] * x[0] + m[1] * x[1] + m[2] * x[2];
    y[1] = m[1] * x[0] + m[3] * x[1] + m[4] * x[2];
    y[2] = m[2] * x[0] + m[4] * x[1] + m[5] * x[2];
}

static double dot(const double x[3], const double y[3])
{
    return x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
}

static void load_frame(const sph__builder *b, uint32_t node, size_t f, frame_quadric *q)
{
    float *block = b->slots[b->mesh.nodes[node].slot].block;
    const size_t s = b->stride;
    for (size_t k = 0; k < 6; ++k) q->m[k] = *entry(block, SPH__M00 + k, f);
    for (size_t k = 0; k < 3; ++k) {
        q->n[k] = *entry(block, SPH__N0 + k, f);
        q->b[k] = *entry(block, SPH__B0 + k, f);
    }
    q->w = block[SPH__BLOCK_ROWS * s + f];
    q->s = block[(SPH__BLOCK_ROWS + 1) * s + f];
    q->c = block[(SPH__BLOCK_ROWS + 2) * s + f];
}

static void add_attachment(const sph__builder *b, uint32_t u, uint32_t v, size_t f, frame_quadric *q)
{
    const size_t s = b->stride;
    const float *mu = b->means + b->mesh.nodes[u].slot * 4 * s + f, *mv = b->means + b->mesh.nodes[v].slot * 4 * s + f;
    const double au = mu[3 * s], av = mv[3 * s], area = au + av, weight = 2 * b->coherence * area;
    if (!(area > 0)) return;
    for (size_t k = 0; k < 3; ++k) {
        const double x = mu[k * s] + av / area * ((double)mv[k * s] - mu[k * s]) - sph__node_center(b, u)[k * s + f];
        q->b[k] += weight * x;
        q->c += 0.5 * weight * x * x;
    }
    q->m[0] += weight;
    q->m[3] += weight;
    q->m[5] += weight;
}

static void unite_frame(const sph__builder *b, uint32_t u, uint32_t v, size_t f, bool attach, frame_quadric *q)
{
    const double offset = radius_of(b, v, f) - radius_of(b, u, f);
    frame_quadric a;
    double t[3];
    load_frame(b, u, f, q);
    load_frame(b, v, f, &a);
    for (size_t k = 0; k < 3; ++k)
        q->d[k] = (double)sph__node_center(b, v)[k * b->stride + f] - sph__node_center(b, u)[k * b->stride + f];
    multiply(a.m, q->d, t);
    q->c += a.c + dot(a.b, q->d) + 0.5 * dot(t, q->d) + offset * (dot(a.n, q->d) + a.s + 0.5 * offset * a.w);
    q->s += a.s + dot(a.n, q->d) + offset * a.w;
    q->w += a.w;
    for (size_t k = 0; k < 3; ++k) {
        q->b[k] += a.b[k] + t[k] + offset * a.n[k];
        q->n[k] += a.n[k];
    }
    for (size_t k = 0; k < 6; ++k) q->m[k] += a.m[k];
    if (attach) add_attachment(b, u, v, f, q);
}

/* M^-1 x for a regular M. */
static void solve(const double m[6], const double x[3], double y[3])
{
    const double a[6] = {m[3] * m[5] - m[4] * m[4], m[2] * m[4] - m[1] * m[5], m[1] * m[4] - m[2] * m[3],
                         m[0] * m[5] - m[2] * m[2], m[1] * m[2] - m[0] * m[4], m[0] * m[3] - m[1] * m[1]};
    const double inverse = 1 / (m[0] * a[0] + m[1] * a[1] + m[2] * a[2]);
    multiply(a, x, y);
    for (size_t k = 0; k < 3; ++k) y[k] *= inverse;
}

/* The minimum of one frame; the centre relative to that of u. */
static sph__minimum minimize_frame(const frame_quadric *q, double u_radius, double radius_max, double center[3])
{
    const bool degenerate = sph__is_degenerate(q->m);
    sph__sums sums = {.b = q->s, .c = q->c, .w = q->w, .degenerate = degenerate};
    sph__minimum minimum;
    double x[3] = {0, 0, 0}, y[3] = {0, 0, 0};
    if (degenerate) {
        multiply(q->m, q->d, x);
        sums.mu = dot(x, q->d);
        sums.nu = dot(q->n, q->d);
        sums.b1 = dot(q->b, q->d);
        sums.mu_scale = (q->m[0] + q->m[3] + q->m[5]) * dot(q->d, q->d);
    } else {
        solve(q->m, q->n, x);
        solve(q->m, q->b, y);
        sums.nn = dot(q->n, x);
        sums.nb = dot(q->n, y);
        sums.bb = dot(q->b, y);
    }
    minimum = sph__sums_minimize(&sums, u_radius, radius_max);
    for (size_t k = 0; k < 3; ++k)
        center[k] = degenerate ? minimum.lambda * q->d[k] : y[k] - (minimum.radius - u_radius) * x[k];
    return minimum;
}

double sph__per_frame_cost(const sph__builder *b, uint32_t u, uint32_t v, const double *widths)
{
    double cost = 0;
    for (size_t f = 0; f < b->frames; ++f) {
        frame_quadric q;
        double center[3];
        unite_frame(b, u, v, f, b->coherence > 0, &q);
        cost += minimize_frame(&q, radius_of(b, u, f), widths == NULL ? INFINITY : b->radius_factor * widths[f], center).cost;
    }
    return cost;
}

void sph__per_frame_sphere(sph__builder *b, uint32_t u, uint32_t v, const double *widths)
{
    for (size_t f = 0; f < b->frames; ++f) {
        frame_quadric q;
        double center[3];
        sph__minimum minimum;
        unite_frame(b, u, v, f, b->coherence > 0, &q);
        minimum = minimize_frame(&q, radius_of(b, u, f), b->radius_factor * widths[f], center);
        b->new_radii[f] = (float)minimum.radius;
        for (size_t k = 0; k < 3; ++k)
            b->new_center[k * b->stride + f] = (float)(center[k] + sph__node_center(b, u)[k * b->stride + f]);
    }
}

/* The united quadric relative to the sphere in new_center and new_radii, into the block of u; returns its cost. */
double sph__per_frame_unite(sph__builder *b, uint32_t u, uint32_t v)
{
    float *block = b->slots[b->mesh.nodes[u].slot].block;
    const size_t s = b->stride;
    double cost = 0;
    for (size_t f = 0; f < b->frames; ++f) {
        const double r = (double)b->new_radii[f] - radius_of(b, u, f);
        frame_quadric q;
        double x[3], t[3], c;
        unite_frame(b, u, v, f, false, &q);
        for (size_t k = 0; k < 3; ++k) x[k] = (double)b->new_center[k * s + f] - sph__node_center(b, u)[k * s + f];
        multiply(q.m, x, t);
        c = q.c + 0.5 * dot(t, x) - dot(q.b, x) + r * (dot(q.n, x) + 0.5 * r * q.w - q.s);
        for (size_t k = 0; k < 6; ++k) *entry(block, SPH__M00 + k, f) = (float)q.m[k];
        for (size_t k = 0; k < 3; ++k) {
            *entry(block, SPH__N0 + k, f) = (float)q.n[k];
            *entry(block, SPH__B0 + k, f) = (float)(q.b[k] - t[k] - r * q.n[k]);
        }
        block[SPH__BLOCK_ROWS * s + f] = (float)q.w;
        block[(SPH__BLOCK_ROWS + 1) * s + f] = (float)(q.s - dot(q.n, x) - r * q.w);
        block[(SPH__BLOCK_ROWS + 2) * s + f] = c > 0 ? (float)c : 0;
        cost += c > 0 ? c : 0;
    }
    return cost;
}

/* Leaves keep W per frame: the trace of M is 2 w n.n summed, which is W. */
sph_status sph__per_frame_start(sph__builder *b)
{
    const size_t s = b->stride;
    b->new_radii = sph__zalloc(b->context, s, sizeof *b->new_radii);
    b->union_widths = sph__zalloc(b->context, s, sizeof *b->union_widths);
    if (b->new_radii == NULL || b->union_widths == NULL) return sph__fail_memory(b->context);
    b->exact_edge = SPH__NO_NODE;
    for (uint32_t v = 0; v < b->n; ++v) {
        float *block = b->slots[v].block;
        for (size_t f = 0; f < s; ++f) {
            block[SPH__BLOCK_ROWS * s + f] = *entry(block, SPH__M00, f) + *entry(block, SPH__M11, f) + *entry(block, SPH__M22, f);
            block[(SPH__BLOCK_ROWS + 1) * s + f] = block[(SPH__BLOCK_ROWS + 2) * s + f] = 0;
        }
    }
    return SPH_OK;
}
