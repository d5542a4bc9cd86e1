/* SPDX-License-Identifier: MIT */
/* What a rig says of each vertex: normals, joints, weights. */
#include <math.h>

#include "io/affine.h"
#include "io/rig.h"

static void corner(const float *xyz, uint32_t vertex, double out[3])
{
    for (int k = 0; k < 3; ++k)
        out[k] = (double)xyz[3 * (size_t)vertex + k];
}

/* Makes it a unit vector; false where it has no length. */
static bool normalize(double a[3])
{
    const double size = fmax(fabs(a[0]), fmax(fabs(a[1]), fabs(a[2])));
    double length;
    if (!(size > 0) || !isfinite(size)) return false;
    for (int k = 0; k < 3; ++k)
        a[k] /= size;
    length = sqrt(sph__io_dot(a, a));
    for (int k = 0; k < 3; ++k)
        a[k] /= length;
    return true;
}

static void add_triangle(const float *xyz, const uint32_t triangle[3], double *sums)
{
    double p[3][3], side[3][3], normal[3];
    for (int i = 0; i < 3; ++i)
        corner(xyz, triangle[i], p[i]);
    for (int i = 0; i < 3; ++i) { /* from corner i to the next */
        for (int k = 0; k < 3; ++k)
            side[i][k] = p[(i + 1) % 3][k] - p[i][k];
        if (!normalize(side[i])) return;
    }
    for (int k = 0; k < 3; ++k) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        normal[k] = side[0][a] * side[1][b] - side[0][b] * side[1][a];
    }
    if (!normalize(normal)) return;
    for (int i = 0; i < 3; ++i) {
        const double angle = acos(fmax(-1, fmin(1, -sph__io_dot(side[i], side[(i + 2) % 3]))));
        for (int k = 0; k < 3; ++k)
            sums[3 * (size_t)triangle[i] + k] += angle * normal[k];
    }
}

sph_status sph__rig_put_normals(const sph__rig *rig, sph__io_output *o)
{
    const size_t n = rig->skin.vertex_count;
    double *sums = sph_context_allocate(rig->context, n, 3 * sizeof *sums);
    if (sums == NULL) return sph__io_fail_memory(rig->context, rig->path);
    for (size_t i = 0; i < 3 * n; ++i)
        sums[i] = 0;
    for (size_t t = 0; t < rig->skin.triangle_count; ++t)
        add_triangle(rig->skin.rest, rig->skin.triangles + 3 * t, sums);
    for (size_t v = 0; v < n; ++v) {
        static const double UP[3] = {0, 1, 0};
        const double *normal = normalize(sums + 3 * v) ? sums + 3 * v : UP;
        for (int k = 0; k < 3; ++k)
            sph__io_put_float(o, (float)normal[k]);
    }
    sph_context_release(rig->context, sums);
    return SPH_OK;
}

/* --- weights --- */

/* The number that stands for a weight of one; 0: weights are floats. */
static uint32_t unit(const sph__rig *rig)
{
    return rig->options.weights == SPH_IO_WEIGHTS_U8    ? UINT8_MAX
           : rig->options.weights == SPH_IO_WEIGHTS_U16 ? UINT16_MAX
                                                        : 0;
}

/*
 * The whole numbers of a vertex's weights, whose sum is exactly one: rounded down, what is left going one by one to the
 * largest remainders. They fall as the weights do, so that those that are 0 come last. Slots are looked at in turn, as
 * there may be any number of them: this is number `slot`.
 */
static uint32_t whole(const float *weights, uint32_t count, uint32_t one, uint32_t slot)
{
    const double own = (double)weights[slot] * one, rest = own - floor(own);
    uint32_t left = one, before = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const double value = (double)weights[i] * one, other = value - floor(value);
        left -= (uint32_t)floor(value);
        before += other > rest || (other == rest && i < slot);
    }
    return (uint32_t)floor(own) + (before < left);
}

static uint32_t weight_of(const sph__rig *rig, size_t vertex, uint32_t slot)
{
    const uint32_t k = rig->skin.influence_count;
    return slot < k ? whole(rig->skin.weights + vertex * k, k, unit(rig), slot) : 0;
}

static bool is_used(const sph__rig *rig, size_t vertex, uint32_t slot)
{
    const uint32_t k = rig->skin.influence_count;
    if (slot >= k || !(rig->skin.weights[vertex * k + slot] > 0)) return false;
    return unit(rig) == 0 || weight_of(rig, vertex, slot) > 0;
}

uint32_t sph__rig_count_influences(const sph__rig *rig)
{
    uint32_t most = 1;
    for (size_t v = 0; v < rig->skin.vertex_count; ++v)
        for (uint32_t s = most; s < rig->skin.influence_count; ++s)
            if (is_used(rig, v, s)) most = s + 1;
    return most;
}

void sph__rig_put_joints(const sph__rig *rig, unsigned set, sph__io_output *o)
{
    const uint32_t k = rig->skin.influence_count;
    for (size_t v = 0; v < rig->skin.vertex_count; ++v)
        for (uint32_t s = set * SPH__RIG_SET; s < (set + 1) * SPH__RIG_SET; ++s)
            sph__io_put(o, is_used(rig, v, s) ? rig->skin.bones[v * k + s] : 0, rig->wide_joints ? 2 : 1);
}

void sph__rig_put_weights(const sph__rig *rig, unsigned set, sph__io_output *o)
{
    const uint32_t k = rig->skin.influence_count;
    for (size_t v = 0; v < rig->skin.vertex_count; ++v)
        for (uint32_t s = set * SPH__RIG_SET; s < (set + 1) * SPH__RIG_SET; ++s) {
            if (unit(rig) == 0)
                sph__io_put_float(o, s < k ? rig->skin.weights[v * k + s] : 0);
            else
                sph__io_put(o, weight_of(rig, v, s), unit(rig) == UINT8_MAX ? 1 : 2);
        }
}
