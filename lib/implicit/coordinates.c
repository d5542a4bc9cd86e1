/* SPDX-License-Identifier: MIT */
/* Mean value coordinates of a node in the ring around it, in its tangent plane (Hormann and Floater 2006). */
#include <math.h>

#include "implicit/shell.h"
#include "numeric/vector.h"

enum { RING_LIMIT = 64 };

/* Coordinates of fans that fold over in the plane may be of any size; such nodes go without. */
static const double SHARE_LIMIT = 1.0;

typedef struct fan {
    uint32_t count;
    uint32_t nodes[RING_LIMIT];
    double x[RING_LIMIT], y[RING_LIMIT]; /* in the plane, about the node */
} fan;

/* The edges across from the node, in order around it; false where they are no single closed ring. */
static bool walk_ring(const sph__shell *s, const size_t *around, size_t count, uint32_t node, fan *f)
{
    uint32_t from[RING_LIMIT] = {0}, to[RING_LIMIT] = {0};
    if (count < 3 || count > RING_LIMIT) return false;
    for (size_t i = 0; i < count; ++i) {
        const uint32_t *corner = s->triangles + 3 * around[i];
        const int at = corner[0] == node ? 0 : corner[1] == node ? 1 : 2;
        from[i] = corner[(at + 1) % 3];
        to[i] = corner[(at + 2) % 3];
    }
    f->count = (uint32_t)count;
    f->nodes[0] = from[0];
    for (size_t i = 0, edge = 0; i < count; ++i) {
        size_t next = count;
        for (size_t k = 0; k < count; ++k)
            if (from[k] == to[edge]) {
                if (next != count) return false;
                next = k;
            }
        if (next == count || (next == 0) != (i + 1 == count)) return false;
        edge = next;
        if (i + 1 < count) f->nodes[i + 1] = from[edge];
    }
    return true;
}

static void flatten(const sph__shell *s, uint32_t node, fan *f)
{
    const double *normal = s->normals + 3 * (size_t)node;
    double u[3], v[3];
    sph__perpendicular(normal, u);
    sph__cross(normal, u, v);
    for (uint32_t i = 0; i < f->count; ++i) {
        double p[3];
        for (int c = 0; c < 3; ++c)
            p[c] = (double)s->rest[3 * (size_t)f->nodes[i] + c] - (double)s->rest[3 * (size_t)node + c];
        f->x[i] = sph__dot(u, p);
        f->y[i] = sph__dot(v, p);
    }
}

/* The tangent of half the angle from point i to the next. */
static double half_tangent(const fan *f, uint32_t i)
{
    const uint32_t k = (i + 1) % f->count;
    const double lengths = hypot(f->x[i], f->y[i]) * hypot(f->x[k], f->y[k]);
    return (f->x[i] * f->y[k] - f->y[i] * f->x[k]) / (lengths + f->x[i] * f->x[k] + f->y[i] * f->y[k]);
}

static bool find_coordinates(const fan *f, double out[RING_LIMIT])
{
    double sum = 0;
    for (uint32_t i = 0; i < f->count; ++i) {
        out[i] = (half_tangent(f, i) + half_tangent(f, (i + f->count - 1) % f->count)) / hypot(f->x[i], f->y[i]);
        sum += out[i];
    }
    for (uint32_t i = 0; i < f->count; ++i) {
        out[i] /= sum;
        if (!(fabs(out[i]) <= SHARE_LIMIT)) return false;
    }
    return true;
}

static void share_node(const sph__shell *s, const size_t *around, size_t count, uint32_t node)
{
    const size_t begin = s->starts[node], end = s->starts[node + 1];
    double coordinates[RING_LIMIT];
    fan f;
    if (end - begin != count || sph__norm(s->normals + 3 * (size_t)node) < 0.5 ||
        !walk_ring(s, around, count, node, &f))
        return;
    flatten(s, node, &f);
    if (!find_coordinates(&f, coordinates)) return;
    for (size_t i = begin; i < end; ++i)
        for (uint32_t k = 0; k < f.count; ++k)
            if (f.nodes[k] == s->ring[i]) s->shares[i] = (float)coordinates[k];
}

sph_status sph__shell_find_shares(sph__shell *s)
{
    size_t *starts = sph__zalloc(s->context, (size_t)s->node_count + 2, sizeof *starts);
    size_t *around = sph__alloc(s->context, s->triangle_count, 3 * sizeof *around);
    s->shares = sph__zalloc(s->context, s->starts[s->node_count], sizeof *s->shares);
    if (starts != NULL && around != NULL && s->shares != NULL) {
        size_t *next = starts + 1;
        for (size_t i = 0; i < 3 * s->triangle_count; ++i)
            ++starts[s->triangles[i] + 2];
        for (size_t i = 0; i < s->node_count; ++i)
            next[i + 1] += next[i];
        for (size_t i = 0; i < 3 * s->triangle_count; ++i)
            around[next[s->triangles[i]]++] = i / 3;
        for (uint32_t i = 0; i < s->node_count; ++i)
            share_node(s, around + starts[i], starts[i + 1] - starts[i], i);
    }
    sph__free(s->context, starts);
    sph__free(s->context, around);
    return starts == NULL || around == NULL || s->shares == NULL ? sph__fail_memory(s->context) : SPH_OK;
}
