/* SPDX-License-Identifier: MIT */
/* Which triangles belong to which bone, and which side of them is outside. */
#include <math.h>

#include "implicit/setup.h"
#include "numeric/vector.h"

/* A component whose volume is less than this part of what its area could hold is no solid, and faces as it does. */
static const double LEAST_VOLUME = 1e-3;

/* That of two corners or more, else of the first. */
static uint32_t find_owner(const sph__shell *s, const uint32_t *corner)
{
    const uint32_t a = s->parts[corner[0]], b = s->parts[corner[1]], c = s->parts[corner[2]];
    return b == c ? b : a;
}

static void sort_triangles(sph__setup *s)
{
    const uint32_t bones = s->skin->bone_count;
    size_t *next = s->starts + 1; /* of part b at b, in front of its start; it becomes its end */
    for (size_t t = 0; t < s->shell.triangle_count; ++t) {
        s->owners[t] = find_owner(&s->shell, s->shell.triangles + 3 * t);
        if (s->owners[t] < bones) ++s->starts[s->owners[t] + 2];
    }
    for (size_t b = 0; b < bones; ++b)
        next[b + 1] += next[b];
    for (size_t t = 0; t < s->shell.triangle_count; ++t)
        if (s->owners[t] < bones) s->members[next[s->owners[t]]++] = (uint32_t)t;
}

static void count_nodes(sph__setup *s)
{
    const uint32_t bones = s->skin->bone_count;
    for (uint32_t i = 0; i < s->shell.node_count; ++i)
        if (s->shell.parts[i] < bones) ++s->node_starts[s->shell.parts[i] + 1];
    for (size_t b = 0; b < bones; ++b)
        s->node_starts[b + 1] += s->node_starts[b];
    for (size_t v = 0; v < s->shell.vertex_count; ++v) {
        const uint32_t part = s->shell.parts[s->shell.nodes[v]];
        if (part < bones) ++s->implicit->fields[part].vertex_count;
    }
}

/* --- inside and outside --- */

static uint32_t find(uint32_t *leaders, uint32_t i)
{
    while (leaders[i] != i) {
        leaders[i] = leaders[leaders[i]];
        i = leaders[i];
    }
    return i;
}

/* A component's moments, at its lowest node. */
typedef struct solid {
    double center[3], weight, volume, area;
} solid;

static void corners_of(const sph__shell *s, size_t t, const double from[3], double p[3][3])
{
    for (size_t i = 0; i < 9; ++i)
        p[i / 3][i % 3] = (double)s->rest[3 * (size_t)s->triangles[3 * t + i / 3] + i % 3] - from[i % 3];
}

static void measure_solids(const sph__shell *s, uint32_t *leaders, solid *solids)
{
    for (uint32_t i = 0; i < s->node_count; ++i)
        leaders[i] = i;
    for (size_t i = 0; i < 3 * s->triangle_count; ++i) {
        const uint32_t a = find(leaders, s->triangles[i]), b = find(leaders, s->triangles[i % 3 == 2 ? i - 2 : i + 1]);
        leaders[a > b ? a : b] = a > b ? b : a;
    }
    for (uint32_t i = 0; i < s->node_count; ++i) {
        solid *o = solids + find(leaders, i);
        o->weight += 1;
        for (int c = 0; c < 3; ++c)
            o->center[c] += (double)s->rest[3 * (size_t)i + c];
    }
    for (uint32_t i = 0; i < s->node_count; ++i)
        for (int c = 0; c < 3 && solids[i].weight > 0; ++c)
            solids[i].center[c] /= solids[i].weight;
    for (size_t t = 0; t < s->triangle_count; ++t) {
        solid *o = solids + find(leaders, s->triangles[3 * t]);
        double p[3][3], u[3], v[3], area[3];
        corners_of(s, t, o->center, p);
        sph__subtract(p[1], p[0], u);
        sph__subtract(p[2], p[0], v);
        sph__cross(u, v, area);
        o->volume += sph__dot(p[0], area) / 6;
        o->area += 0.5 * sph__norm(area);
    }
}

static sph_status find_signs(sph__setup *s)
{
    const sph__shell *shell = &s->shell;
    uint32_t *leaders = sph__alloc(shell->context, shell->node_count, sizeof *leaders);
    solid *solids = sph__zalloc(shell->context, shell->node_count, sizeof *solids);
    if (leaders != NULL && solids != NULL) {
        measure_solids(shell, leaders, solids);
        for (uint32_t i = 0; i < shell->node_count; ++i) {
            const solid *o = solids + find(leaders, i);
            s->signs[i] = o->volume < -LEAST_VOLUME * o->area * sqrt(o->area) ? -1 : 1;
        }
    }
    sph__free(shell->context, leaders);
    sph__free(shell->context, solids);
    return leaders == NULL || solids == NULL ? sph__fail_memory(shell->context) : SPH_OK;
}

sph_status sph__setup_parts(sph__setup *s)
{
    const sph_context *context = s->skin->context;
    const size_t bones = s->skin->bone_count;
    s->owners = sph__alloc(context, s->shell.triangle_count, sizeof *s->owners);
    s->members = sph__alloc(context, s->shell.triangle_count, sizeof *s->members);
    s->starts = sph__zalloc(context, bones + 2, sizeof *s->starts);
    s->node_starts = sph__zalloc(context, bones + 1, sizeof *s->node_starts);
    s->signs = sph__alloc(context, s->shell.node_count, sizeof *s->signs);
    if (s->owners == NULL || s->members == NULL || s->starts == NULL || s->node_starts == NULL || s->signs == NULL)
        return sph__fail_memory(context);
    sort_triangles(s);
    count_nodes(s);
    return find_signs(s);
}
