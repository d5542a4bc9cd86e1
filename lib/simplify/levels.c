/* SPDX-License-Identifier: MIT */
/* What a progressive mesh tells, and its levels. */
#include "hierarchy/simplices.h"
#include "simplify/simplify.h"

uint32_t sph_progressive_collapse_count(const sph_progressive *p)
{
    SPH__OWN(p, SPH__PROGRESSIVE);
    return p == NULL ? 0 : p->collapse_count;
}

double sph_progressive_bounding_diagonal(const sph_progressive *p)
{
    SPH__OWN(p, SPH__PROGRESSIVE);
    return p == NULL ? 0 : p->bounding_diagonal;
}

uint32_t sph_progressive_pose_count(const sph_progressive *p)
{
    SPH__OWN(p, SPH__PROGRESSIVE);
    return p == NULL ? 0 : p->pose_count;
}

uint32_t sph_progressive_point_count(const sph_progressive *p)
{
    SPH__OWN(p, SPH__PROGRESSIVE);
    return p == NULL ? 0 : p->point_count;
}

uint32_t sph_progressive_influence_count(const sph_progressive *p)
{
    SPH__OWN(p, SPH__PROGRESSIVE);
    return p == NULL ? 0 : p->slots;
}

uint32_t sph_progressive_attribute_count(const sph_progressive *p)
{
    SPH__OWN(p, SPH__PROGRESSIVE);
    return p == NULL ? 0 : p->attribute_count;
}

static sph_status check_level(const sph_progressive *p, uint32_t level)
{
    if (level <= p->collapse_count) return SPH_OK;
    return sph__fail(p->context, SPH_E_INVALID, "level %u: there are levels 0 to %u", (unsigned)level,
                     (unsigned)p->collapse_count);
}

sph_status sph_progressive_get_level(const sph_progressive *p, uint32_t level, sph_progressive_level *out)
{
    SPH__OWN(p, SPH__PROGRESSIVE);
    sph_status status;
    if (p == NULL || out == NULL)
        return sph__fail(p == NULL ? NULL : p->context, SPH_E_INVALID,
                         "sph_progressive_get_level: an argument is NULL");
    if (out->struct_size != sizeof *out)
        return sph__fail(p->context, SPH_E_INVALID, "sph_progressive_level: struct_size is %u, not %zu",
                         (unsigned)out->struct_size, sizeof *out);
    if ((status = check_level(p, level)) != SPH_OK) return status;
    *out = (sph_progressive_level){.struct_size = sizeof *out,
                                   .collapse_count = level,
                                   .vertex_count = p->vertex_counts[level],
                                   .point_count = p->point_count - level,
                                   .triangle_count = p->triangle_counts[level],
                                   .forced = p->first_forced <= level,
                                   .error = p->errors[level],
                                   .max_error = p->max_errors[level]};
    return SPH_OK;
}

/* The first level at which the falling counts are at most `most`; above C where there is none. */
static uint32_t find_count(const uint32_t *counts, uint32_t collapse_count, uint32_t most)
{
    uint32_t low = 0, high = collapse_count + 1;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (counts[middle] > most)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static sph_status find(const sph_progressive *p, const uint32_t *counts, uint32_t most, const char *what,
                       uint32_t *level)
{
    const uint32_t found = find_count(counts, p->collapse_count, most);
    if (found > p->collapse_count)
        return sph__fail(p->context, SPH_E_LIMIT, "no level has as few as %u %s: the coarsest has %u", (unsigned)most,
                         what, (unsigned)counts[p->collapse_count]);
    *level = found;
    return SPH_OK;
}

sph_status sph_progressive_find_vertices(const sph_progressive *p, uint32_t vertex_count, uint32_t *level)
{
    SPH__OWN(p, SPH__PROGRESSIVE);
    if (p == NULL || level == NULL)
        return sph__fail(p == NULL ? NULL : p->context, SPH_E_INVALID,
                         "sph_progressive_find_vertices: an argument is NULL");
    return find(p, p->vertex_counts, vertex_count, "vertices", level);
}

sph_status sph_progressive_find_triangles(const sph_progressive *p, uint32_t triangle_count, uint32_t *level)
{
    SPH__OWN(p, SPH__PROGRESSIVE);
    if (p == NULL || level == NULL)
        return sph__fail(p == NULL ? NULL : p->context, SPH_E_INVALID,
                         "sph_progressive_find_triangles: an argument is NULL");
    return find(p, p->triangle_counts, triangle_count, "triangles", level);
}

sph_status sph_progressive_find_error(const sph_progressive *p, double max_error, uint32_t *level)
{
    SPH__OWN(p, SPH__PROGRESSIVE);
    uint32_t low = 0, high;
    if (p == NULL || level == NULL || !(max_error >= 0))
        return sph__fail(p == NULL ? NULL : p->context, SPH_E_INVALID,
                         "sph_progressive_find_error: an argument is NULL, or max_error is not >= 0");
    high = p->collapse_count + 1;
    while (low < high) { /* the first level whose error is too large */
        const uint32_t middle = low + (high - low) / 2;
        if (p->errors[middle] <= max_error)
            low = middle + 1;
        else
            high = middle;
    }
    *level = low == 0 ? 0 : low - 1;
    return SPH_OK;
}

sph__collapses sph__progressive_collapses(const sph_progressive *p)
{
    return (sph__collapses){.context = p->context,
                            .vertex_count = p->point_count,
                            .collapse_count = p->collapse_count,
                            .root_count = p->point_count - p->collapse_count,
                            .children = p->children,
                            .parents = p->parents,
                            .roots = p->roots,
                            .edge_starts = p->edge_starts,
                            .edge_others = p->edge_others,
                            .triangle_starts = p->triangle_starts,
                            .triangle_others = p->triangle_others};
}

sph_status sph_progressive_create_cursor(const sph_progressive *p, sph_cursor **out)
{
    SPH__OWN(p, SPH__PROGRESSIVE);
    sph__collapses collapses;
    if (out != NULL) *out = NULL;
    if (p == NULL || out == NULL)
        return sph__fail(p == NULL ? NULL : p->context, SPH_E_INVALID,
                         "sph_progressive_create_cursor: an argument is NULL");
    collapses = sph__progressive_collapses(p);
    return sph__cursor_create(&collapses, out);
}

sph_status sph_progressive_point(const sph_progressive *p, uint32_t point, float rest[3], uint32_t *bones,
                                 float *weights)
{
    SPH__OWN(p, SPH__PROGRESSIVE);
    const size_t slots = p == NULL ? 0 : p->slots;
    if (p == NULL) return SPH_E_INVALID;
    if (point >= p->point_count + p->collapse_count)
        return sph__fail(p->context, SPH_E_INVALID, "point %u of %u", (unsigned)point,
                         (unsigned)(p->point_count + p->collapse_count));
    if (rest != NULL) memcpy(rest, p->rest + 3 * (size_t)point, 3 * sizeof *rest);
    if (bones != NULL) memcpy(bones, p->bones + point * slots, slots * sizeof *bones);
    if (weights != NULL) memcpy(weights, p->weights + point * slots, slots * sizeof *weights);
    return SPH_OK;
}

/* A level laid out: its vertices are wedges, in their order; its triangles are in that of the input's. */
typedef struct layout {
    uint32_t vertex_count;
    size_t triangle_count;
    uint32_t *wedges;    /* [vertex_count] */
    uint32_t *triangles; /* [triangle_count][3], vertices */
    uint32_t *numbers;   /* [triangle_count], of the input's */
} layout;

static void layout_free(const sph_context *context, layout *l)
{
    sph__free(context, l->wedges);
    sph__free(context, l->triangles);
    sph__free(context, l->numbers);
}

/* Where a triangle of points is recorded: with its youngest corner, the others ascending. */
static size_t find_triangle(const sph_progressive *p, const uint32_t *corner)
{
    const unsigned at = corner[0] > corner[1] ? (corner[0] > corner[2] ? 0 : 2) : (corner[1] > corner[2] ? 1 : 2);
    const uint64_t key = (uint64_t)corner[(at + 1) % 3] << 32 | corner[(at + 2) % 3];
    size_t low = p->triangle_starts[corner[at]], high = p->triangle_starts[corner[at] + 1];
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        const uint32_t *others = p->triangle_others + 2 * middle;
        if (((uint64_t)others[0] << 32 | others[1]) <= key)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* The wedges that the triangles have, in order; the triangles get their places. */
static sph_status number_wedges(const sph_progressive *p, layout *l)
{
    const size_t corners = 3 * l->triangle_count;
    uint32_t at = 0;
    sph__keyed *keys = sph__alloc(p->context, corners, sizeof *keys);
    if (keys == NULL) return sph__fail_memory(p->context);
    for (size_t i = 0; i < corners; ++i)
        keys[i] = (sph__keyed){l->triangles[i], i};
    sph__sort(keys, corners);
    for (size_t i = 0; i < corners; ++i) {
        if (i > 0 && keys[i].key != keys[i - 1].key) ++at;
        l->wedges[at] = (uint32_t)keys[i].key;
        l->triangles[keys[i].item] = at;
    }
    sph__free(p->context, keys);
    return SPH_OK;
}

static sph_status lay_out(const sph_progressive *p, uint32_t level, const sph__simplices *simplices, layout *l)
{
    const size_t count = simplices->triangle_count;
    sph__keyed *keys = sph__alloc(p->context, count, sizeof *keys);
    l->vertex_count = p->vertex_counts[level];
    l->triangle_count = count;
    l->wedges = sph__alloc(p->context, l->vertex_count, sizeof *l->wedges);
    l->triangles = sph__alloc(p->context, count, 3 * sizeof *l->triangles);
    l->numbers = sph__alloc(p->context, count, sizeof *l->numbers);
    if (keys == NULL || l->wedges == NULL || l->triangles == NULL || l->numbers == NULL) {
        sph__free(p->context, keys);
        return sph__fail_memory(p->context);
    }
    for (size_t i = 0; i < count; ++i) {
        const size_t place = find_triangle(p, simplices->triangles + 3 * i);
        keys[i] = (sph__keyed){p->triangle_sources[place], place};
    }
    sph__sort(keys, count);
    for (size_t i = 0; i < count; ++i) {
        l->numbers[i] = (uint32_t)keys[i].key;
        memcpy(l->triangles + 3 * i, p->triangle_wedges + 3 * keys[i].item, 3 * sizeof *l->triangles);
    }
    sph__free(p->context, keys);
    return number_wedges(p, l);
}

static sph_status open_level(const sph_progressive *p, uint32_t level, layout *l)
{
    const sph__collapses collapses = sph__progressive_collapses(p);
    sph__simplices simplices;
    sph_status status = check_level(p, level);
    *l = (layout){.vertex_count = 0};
    if (status == SPH_OK) status = sph__simplices_jump(&collapses, p->point_count + level, &simplices);
    if (status != SPH_OK) return status;
    status = lay_out(p, level, &simplices, l);
    sph__simplices_free(p->context, &simplices);
    if (status != SPH_OK) layout_free(p->context, l);
    return status;
}

static sph_status make_skin(const sph_progressive *p, const layout *l, sph_skin **out)
{
    const size_t slots = p->slots;
    sph_skin_arrays a = {.struct_size = sizeof a};
    float *rest = sph__alloc(p->context, l->vertex_count, 3 * sizeof *rest);
    float *weights = sph__alloc(p->context, l->vertex_count, slots * sizeof *weights);
    uint32_t *bones = sph__alloc(p->context, l->vertex_count, slots * sizeof *bones);
    sph_status status = rest == NULL || weights == NULL || bones == NULL ? sph__fail_memory(p->context)
                                                                         : sph_skin_get_arrays(p->frame, &a);
    for (size_t i = 0; i < l->vertex_count && status == SPH_OK; ++i)
        status = sph_progressive_point(p, p->wedge_points[l->wedges[i]], rest + 3 * i, bones + slots * i,
                                       weights + slots * i);
    a.vertex_count = l->vertex_count;
    a.influence_count = p->slots;
    a.rest = rest;
    a.bones = bones;
    a.weights = weights;
    a.triangle_count = l->triangle_count;
    a.triangles = l->triangles;
    if (status == SPH_OK) status = sph_skin_create_from_arrays(p->context, &a, out);
    sph__free(p->context, rest);
    sph__free(p->context, weights);
    sph__free(p->context, bones);
    return status;
}

sph_status sph_progressive_get_skin(const sph_progressive *p, uint32_t level, sph_skin **out)
{
    SPH__OWN(p, SPH__PROGRESSIVE);
    layout l;
    sph_status status;
    if (out != NULL) *out = NULL;
    if (p == NULL || out == NULL)
        return sph__fail(p == NULL ? NULL : p->context, SPH_E_INVALID, "sph_progressive_get_skin: an argument is NULL");
    if ((status = check_level(p, level)) != SPH_OK) return status;
    if (p->triangle_counts[level] == 0)
        return sph__fail(p->context, SPH_E_LIMIT, "level %u has no triangles left", (unsigned)level);
    if ((status = open_level(p, level, &l)) != SPH_OK) return status;
    status = make_skin(p, &l, out);
    layout_free(p->context, &l);
    return status;
}

sph_status sph_progressive_get_attributes(const sph_progressive *p, uint32_t level, float *normals, float *attributes,
                                          uint32_t *vertex_sources, uint32_t *triangle_sources)
{
    SPH__OWN(p, SPH__PROGRESSIVE);
    const size_t size = p == NULL ? 0 : p->value_count, count = p == NULL ? 0 : p->attribute_count;
    layout l;
    sph_status status;
    if (p == NULL) return SPH_E_INVALID;
    if ((status = open_level(p, level, &l)) != SPH_OK) return status;
    for (size_t i = 0; i < l.vertex_count; ++i) {
        const float *values = size == 0 ? NULL : p->values + l.wedges[i] * size;
        for (size_t c = 0; c < 3 && normals != NULL; ++c)
            normals[3 * i + c] = size > count ? values[c] : 0;
        if (attributes != NULL && count != 0)
            memcpy(attributes + i * count, values + size - count, count * sizeof *values);
        if (vertex_sources != NULL) vertex_sources[i] = p->wedge_sources[l.wedges[i]];
    }
    if (triangle_sources != NULL) memcpy(triangle_sources, l.numbers, l.triangle_count * sizeof *l.numbers);
    layout_free(p->context, &l);
    return SPH_OK;
}
