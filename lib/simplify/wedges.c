/* SPDX-License-Identifier: MIT */
/* What differs between vertices of one place - normals, texture - along the collapses. */
#include <math.h>

#include "simplify/simplify.h"

static uint32_t corner_at(const sph__simplifier *b, uint32_t t, uint32_t point)
{
    const uint32_t *corner = b->mesh.triangles[t];
    return corner[0] == point ? 0 : corner[1] == point ? 1 : 2;
}

/* The place of a wedge in the list around a collapse; adds it. */
static uint32_t find_around(sph__simplifier *b, size_t *count, uint32_t wedge, uint32_t side)
{
    for (size_t i = 0; i < *count; ++i)
        if (b->around[i].wedge == wedge && b->around[i].side == side) return (uint32_t)i;
    b->around[*count] = (sph__wedge){wedge, (uint32_t)*count, SPH__NO_NODE, side};
    return (uint32_t)(*count)++;
}

static uint32_t class_of(const sph__simplifier *b, uint32_t i)
{
    while (b->around[i].class_of != i)
        i = b->around[i].class_of;
    return i;
}

static void join(const sph__simplifier *b, uint32_t i, uint32_t k)
{
    const uint32_t p = class_of(b, i), q = class_of(b, k);
    b->around[p > q ? p : q].class_of = p < q ? p : q;
}

/* The mean of a class's values on either side, blended; where there is but one side, that. */
static void blend_values(const sph__simplifier *b, size_t count, uint32_t class, double t, float *out)
{
    const size_t size = b->p->value_count;
    uint32_t members[2] = {0, 0};
    for (size_t i = 0; i < count; ++i)
        if (class_of(b, (uint32_t)i) == class) ++members[b->around[i].side];
    for (size_t q = 0; q < size; ++q) {
        double sums[2] = {0, 0};
        for (size_t i = 0; i < count; ++i)
            if (class_of(b, (uint32_t)i) == class)
                sums[b->around[i].side] += (double)b->p->values[b->around[i].wedge * size + q];
        for (int s = 0; s < 2; ++s)
            if (members[s] > 0) sums[s] /= members[s];
        out[q] = (float)(members[0] == 0 ? sums[1] : members[1] == 0 ? sums[0] : sums[0] + t * (sums[1] - sums[0]));
    }
    if (b->o.normals != NULL) {
        const double length =
            sqrt((double)out[0] * (double)out[0] + (double)out[1] * (double)out[1] + (double)out[2] * (double)out[2]);
        for (int c = 0; c < 3 && length > 0; ++c)
            out[c] = (float)((double)out[c] / length);
    }
}

static sph_status make_wedge(sph__simplifier *b, size_t count, uint32_t class, uint32_t w, double t)
{
    sph_progressive *p = b->p;
    const size_t at = b->wedge_count, size = p->value_count;
    if (at >= SPH__NO_NODE) return sph__fail(b->context, SPH_E_LIMIT, "more than 2^32 - 1 vertices in all levels");
    if (!sph__reserve(b->context, (void **)&p->values, &b->value_capacity, (at + 1) * size, sizeof(float)) ||
        !sph__reserve(b->context, (void **)&p->wedge_points, &b->point_capacity, at + 1, sizeof *p->wedge_points) ||
        !sph__reserve(b->context, (void **)&p->wedge_sources, &b->source_capacity, at + 1, sizeof *p->wedge_sources) ||
        !sph__reserve(b->context, (void **)&b->uses, &b->use_capacity, at + 1, sizeof *b->uses))
        return sph__fail_memory(b->context);
    if (size != 0) blend_values(b, count, class, t, p->values + at * size);
    p->wedge_points[at] = w;
    p->wedge_sources[at] = p->wedge_sources[b->around[class].wedge];
    b->uses[at] = 0;
    b->around[class].made = (uint32_t)at;
    ++b->wedge_count;
    return SPH_OK;
}

static void use(sph__simplifier *b, uint32_t wedge)
{
    if (b->uses[wedge]++ == 0) ++b->vertex_count;
}

static void unuse(sph__simplifier *b, uint32_t wedge)
{
    if (--b->uses[wedge] == 0) --b->vertex_count;
}

/* The triangles of u, then those of v that are not of u as well. */
static sph_status list_triangles(sph__simplifier *b, uint32_t u, uint32_t v, size_t *count)
{
    const size_t most = (size_t)sph__triangle_count_of(&b->mesh, u) + sph__triangle_count_of(&b->mesh, v);
    *count = 0;
    if (!sph__reserve(b->context, (void **)&b->moved, &b->moved_capacity, most + 1, sizeof *b->moved) ||
        !sph__reserve(b->context, (void **)&b->around, &b->around_capacity, most + 1, sizeof *b->around))
        return sph__fail_memory(b->context);
    for (unsigned side = 0; side < 2; ++side) {
        const uint32_t point = side == 0 ? u : v;
        for (uint32_t i = 0; i < sph__triangle_count_of(&b->mesh, point); ++i) {
            const uint32_t t = sph__triangles_of(&b->mesh, point)[i], *corner = b->mesh.triangles[t];
            if (side == 1 && (corner[0] == u || corner[1] == u || corner[2] == u)) continue;
            b->moved[(*count)++] = t;
        }
    }
    b->moved[*count] = SPH__NO_NODE;
    return SPH_OK;
}

static bool has_corner(const sph__simplifier *b, uint32_t t, uint32_t point)
{
    const uint32_t *corner = b->mesh.triangles[t];
    return corner[0] == point || corner[1] == point || corner[2] == point;
}

sph_status sph__wedges_unite(sph__simplifier *b, uint32_t u, uint32_t v, uint32_t w, double t)
{
    size_t triangles, count = 0;
    sph_status status = list_triangles(b, u, v, &triangles);
    for (size_t i = 0; i < triangles && status == SPH_OK; ++i) {
        const uint32_t triangle = b->moved[i];
        const bool at_u = has_corner(b, triangle, u), at_v = has_corner(b, triangle, v);
        const uint32_t side = at_u ? 0 : 1;
        const uint32_t first = find_around(b, &count, b->corners[triangle][corner_at(b, triangle, at_u ? u : v)], side);
        if (at_u && at_v) join(b, first, find_around(b, &count, b->corners[triangle][corner_at(b, triangle, v)], 1));
    }
    for (size_t i = 0; i < triangles && status == SPH_OK; ++i) {
        const uint32_t triangle = b->moved[i];
        const bool at_u = has_corner(b, triangle, u), at_v = has_corner(b, triangle, v);
        uint32_t *corner, class;
        if (at_u && at_v) continue;
        corner = &b->corners[triangle][corner_at(b, triangle, at_u ? u : v)];
        class = class_of(b, find_around(b, &count, *corner, at_u ? 0 : 1));
        if (b->around[class].made == SPH__NO_NODE) status = make_wedge(b, count, class, w, t);
        if (status != SPH_OK) return status;
        unuse(b, *corner);
        *corner = b->around[class].made;
        use(b, *corner);
    }
    return status;
}

void sph__wedges_settle(sph__simplifier *b, uint32_t w)
{
    const uint32_t *alive = sph__triangles_of(&b->mesh, w);
    for (uint32_t i = 0; i < sph__triangle_count_of(&b->mesh, w); ++i)
        b->stamps[alive[i]] = w;
    for (size_t i = 0; b->moved[i] != SPH__NO_NODE; ++i) {
        if (b->stamps[b->moved[i]] == w) continue;
        for (unsigned k = 0; k < 3; ++k)
            unuse(b, b->corners[b->moved[i]][k]);
        --b->triangle_count;
    }
}

sph_status sph__wedges_record(sph__simplifier *b, uint32_t point)
{
    sph_progressive *p = b->p;
    const size_t first = b->births.triangle_starts[point], end = b->births.triangle_starts[point + 1];
    if (!sph__reserve(b->context, (void **)&p->triangle_wedges, &b->corner_capacity, 3 * end, sizeof(uint32_t)) ||
        !sph__reserve(b->context, (void **)&p->triangle_sources, &b->number_capacity, end, sizeof(uint32_t)))
        return sph__fail_memory(b->context);
    for (size_t i = first; i < end; ++i) {
        const uint32_t t = (uint32_t)b->births.keys[i - first].item, at = corner_at(b, t, point);
        for (unsigned k = 0; k < 3; ++k)
            p->triangle_wedges[3 * i + k] = b->corners[t][(at + k) % 3];
        p->triangle_sources[i] = b->numbers[t];
    }
    return SPH_OK;
}
