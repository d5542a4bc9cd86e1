/* SPDX-License-Identifier: MIT */
/* Making the handle: copies of the level, the simplices, the tree over them. */
#include "query/query.h"

#include <float.h>
#include <math.h>

static const sph_query_options DEFAULTS = {.search = SPH_SEARCH_AUTO};

void sph_query_options_init(sph_query_options *options, size_t size)
{
    sph__options_init(options, size, &DEFAULTS, sizeof DEFAULTS, sizeof DEFAULTS);
}

static sph_status read_options(const sph_context *context, const sph_query_options *in, sph_query_options *out)
{
    sph_status status;
    *out = DEFAULTS;
    status = sph__options_read(context, "sph_query_options", in, out, sizeof *out, sizeof *out);
    if (status != SPH_OK) return status;
    if (out->flags != 0 || out->reserved0 != 0)
        return sph__fail(context, SPH_E_INVALID, "sph_query_options: flags and reserved0 must be 0");
    if (out->search < SPH_SEARCH_AUTO || out->search > SPH_SEARCH_TREE)
        return sph__fail(context, SPH_E_INVALID, "sph_query_options: search is %d", (int)out->search);
    return SPH_OK;
}

void sph_query_destroy(sph_query *q)
{
    SPH__OWN(q, SPH__QUERY);
    sph_context *context;
    if (q == NULL) return;
    context = q->context;
    sph__query_cavities_destroy(q);
    sph__solid_free(&q->solid);
    sph__free(context, q->bounds.rows);
    sph__free(context, q->frame_centers);
    sph__free(context, q->frame_radii);
    sph__free(context, q->simplices);
    sph__free(context, q->numbers);
    sph__free(context, q->shared);
    sph__free(context, q->leaf_bounds);
    sph__free(context, q->fans);
    sph__free(context, q->parts);
    sph__free(context, q);
    sph__context_release(context);
}

/* --- which simplex of the level a primitive is --- */

/* Corners in ascending order, each once; returns their number. */
static int32_t sort_corners(const uint32_t *from, size_t count, uint32_t to[3])
{
    int32_t kept = 0;
    for (size_t i = 0; i < count; ++i) {
        int32_t place = 0;
        while (place < kept && to[place] < from[i])
            ++place;
        if (place < kept && to[place] == from[i]) continue;
        for (int32_t k = kept; k > place; --k)
            to[k] = to[k - 1];
        to[place] = from[i];
        ++kept;
    }
    return kept;
}

/* The order of the primitives of a solid: more corners first, then by corners. */
static int compare(int32_t count, const uint32_t *corners, int32_t other_count, const uint32_t *other)
{
    if (count != other_count) return count > other_count ? -1 : 1;
    for (int32_t k = 0; k < count; ++k)
        if (corners[k] != other[k]) return corners[k] < other[k] ? -1 : 1;
    return 0;
}

/* The primitive with these corners, or UINT32_MAX: an edge of a triangle, say, is none. */
static uint32_t find_primitive(const sph__solid *solid, int32_t count, const uint32_t *corners)
{
    uint32_t begin = 0, end = solid->primitive_count;
    while (begin < end) {
        const uint32_t half = begin + (end - begin) / 2;
        const int order = compare(solid->corner_counts[half], solid->corners[half], count, corners);
        if (order == 0) return half;
        if (order < 0)
            begin = half + 1;
        else
            end = half;
    }
    return UINT32_MAX;
}

/* Names the primitives that the rows of a list are; the first row of equal ones. */
static void name_simplices(sph_query *q, const uint32_t *rows, size_t count, size_t width, uint32_t kind)
{
    for (size_t i = 0; i < count; ++i) {
        const uint32_t *row = rows + width * i;
        uint32_t corners[3], p, kept = 0;
        const int32_t corner_count = sort_corners(row, width, corners);
        sph__query_simplex *s;
        if (corner_count < 2 || (p = find_primitive(&q->solid, corner_count, corners)) == UINT32_MAX) continue;
        s = &q->simplices[p];
        if (s->kind != SPH_SIMPLEX_NONE) continue;
        s->kind = kind;
        s->number = (uint32_t)i;
        for (size_t k = 0; k < width; ++k)
            if ((kept < 1 || s->spheres[0] != row[k]) && (kept < 2 || s->spheres[1] != row[k]))
                s->spheres[kept++] = row[k];
    }
}

static void find_simplices(sph_query *q, const sph_level *level)
{
    for (uint32_t i = 0; i < q->primitive_count; ++i) {
        sph__query_simplex *s = &q->simplices[i];
        *s = (sph__query_simplex){{SPH_NO_SPHERE, SPH_NO_SPHERE, SPH_NO_SPHERE}, 0, SPH_SIMPLEX_NONE, {3, 3, 3}};
        if (q->solid.corner_counts[i] > 1) continue;
        s->kind = SPH_SIMPLEX_SPHERE;
        s->number = s->spheres[0] = q->solid.corners[i][0];
    }
    name_simplices(q, level->edges, level->edge_count, 2, SPH_SIMPLEX_EDGE);
    name_simplices(q, level->triangles, level->triangle_count, 3, SPH_SIMPLEX_TRIANGLE);
    for (uint32_t i = 0; i < q->primitive_count; ++i)
        for (int k = 0; k < 3; ++k)
            for (int32_t j = 0; j < q->solid.corner_counts[i]; ++j)
                if (q->solid.corners[i][j] == q->simplices[i].spheres[k]) q->simplices[i].corner[k] = (uint8_t)j;
}

/* --- the tree --- */

/* The frame in which the centres are spread most: neighbours there are neighbours in all. */
static uint32_t widest_frame(const sph_query *q)
{
    uint32_t best = 0;
    double most = -1;
    for (uint32_t f = 0; f < q->frame_count; ++f) {
        const float *c = q->frame_centers + 3 * (size_t)f * q->sphere_count;
        double sum = 0;
        for (int k = 0; k < 3; ++k) {
            float low = c[k], high = c[k];
            for (uint32_t i = 1; i < q->sphere_count; ++i) {
                low = fminf(low, c[3 * (size_t)i + (size_t)k]);
                high = fmaxf(high, c[3 * (size_t)i + (size_t)k]);
            }
            sum += ((double)high - low) * ((double)high - low);
        }
        if (sum <= most) continue;
        most = sum;
        best = f;
    }
    return best;
}

/* Puts the primitives into the order of leaves. */
static sph_status put_in_order(sph_query *q, const uint32_t *order)
{
    sph__solid *s = &q->solid;
    uint32_t(*corners)[3] = sph__alloc(q->context, q->primitive_count, sizeof *corners);
    sph__query_simplex *simplices = sph__alloc(q->context, q->primitive_count, sizeof *simplices);
    int32_t *counts = sph__alloc(q->context, q->primitive_count, sizeof *counts);
    const bool done = corners != NULL && simplices != NULL && counts != NULL;
    for (uint32_t i = 0; done && i < q->primitive_count; ++i) {
        const uint32_t p = order[i];
        memcpy(corners[i], s->corners[p], sizeof *corners);
        simplices[i] = q->simplices[p];
        counts[i] = s->corner_counts[p];
        q->numbers[i] = p;
    }
    if (done) {
        memcpy(s->corners, corners, q->primitive_count * sizeof *corners);
        memcpy(q->simplices, simplices, q->primitive_count * sizeof *simplices);
        memcpy(s->corner_counts, counts, q->primitive_count * sizeof *counts);
    }
    sph__free(q->context, corners);
    sph__free(q->context, simplices);
    sph__free(q->context, counts);
    return done ? SPH_OK : sph__fail_memory(q->context);
}

static sph_status build_tree(sph_query *q)
{
    sph__box_tree *tree = &q->solid.tree;
    sph_status status;
    if (sph__box_tree_reserve(tree, q->context, q->primitive_count, SPH__QUERY_LEAF) != SPH_OK)
        return sph__fail_memory(q->context);
    sph_query_pose_frame(q, widest_frame(q));
    sph__box_tree_build(tree, q->solid.boxes, q->primitive_count, SPH__QUERY_LEAF);
    status = put_in_order(q, tree->order);
    for (uint32_t i = 0; i < q->primitive_count; ++i)
        tree->order[i] = i;
    return status;
}

/* Where all is searched, for many casts at a time. */
static sph_status build_leaves(sph_query *q)
{
    uint32_t *order = sph__alloc(q->context, q->primitive_count, sizeof *order);
    sph_status status = order != NULL ? SPH_OK : sph__fail_memory(q->context);
    for (uint32_t i = 0; order != NULL && i < q->primitive_count; ++i)
        order[i] = i;
    if (status == SPH_OK) status = sph__query_leaves_build(q, order);
    if (status == SPH_OK) status = put_in_order(q, order);
    sph__free(q->context, order);
    return status;
}

/* --- parts that primitives share --- */

/* An edge, or a sphere as an edge from itself to itself, of the primitive in a slot, as the bit of parts.h. */
static sph__keyed part_of(const sph_query *q, uint32_t slot, int32_t a, int32_t b, uint32_t bit)
{
    const uint32_t *corners = q->solid.corners[slot], first = corners[a], second = corners[b];
    return (sph__keyed){first < second ? (uint64_t)first << 32 | second : (uint64_t)second << 32 | first,
                        (uint64_t)q->numbers[slot] << 32 | bit};
}

/* Of those that have a part in common all but the one with the lowest number are told. */
static sph_status mark_shared(sph_query *q)
{
    sph__keyed *parts = sph__alloc(q->context, q->primitive_count, 6 * sizeof *parts);
    uint32_t *slots = sph__alloc(q->context, q->primitive_count, sizeof *slots);
    size_t count = 0;
    for (uint32_t i = 0; parts != NULL && slots != NULL && i < q->primitive_count; ++i) {
        const int32_t corners = q->solid.corner_counts[i];
        slots[q->numbers[i]] = i;
        for (int32_t k = 0; k < corners; ++k) {
            parts[count++] = part_of(q, i, k, k, (uint32_t)k);
            if (corners == 3 || (corners == 2 && k == 0))
                parts[count++] = part_of(q, i, k, (k + 1) % corners, 3 + (uint32_t)k);
        }
    }
    if (count > 0) sph__sort(parts, count);
    for (size_t i = 1; i < count; ++i)
        if (parts[i].key == parts[i - 1].key)
            q->shared[slots[parts[i].item >> 32]] |= (uint8_t)(1u << (parts[i].item & 7));
    sph__free(q->context, parts);
    sph__free(q->context, slots);
    return count > 0 ? SPH_OK : sph__fail_memory(q->context);
}

/* --- creation --- */

static bool allocate_bounds(sph_query *q)
{
    sph__query_bounds *b = &q->bounds;
    /* rows start at different places of a cache's sets */
    const size_t stride = ((size_t)q->primitive_count + SPH__QUERY_LANES) / SPH__QUERY_LANES * SPH__QUERY_LANES + 16;
    float *row = b->rows = sph__zalloc(q->context, SPH__QUERY_ROWS * stride, sizeof *row);
    if (row == NULL) return false;
    b->stride = stride;
    for (int k = 0; k < 3; ++k) {
        b->low[k] = row;
        b->high[k] = row + stride;
        for (size_t i = 0; i < stride; ++i) { /* nothing meets those that no primitive will have */
            b->low[k][i] = 1e15f;
            b->high[k][i] = 1e15f;
        }
        row += 2 * stride;
    }
    for (int k = 0; k < 3; ++k)
        b->normal[k] = row + (size_t)k * stride;
    b->slab_low = row + 3 * stride;
    b->slab_high = row + 4 * stride;
    return true;
}

static sph_status allocate(sph_query *q, const sph_level *level)
{
    const size_t spheres = level->sphere_count;
    size_t all; /* fits: the level holds as many */
    if (!sph__multiply_size(spheres, level->frame_count, &all)) return SPH_E_NOMEM;
    q->frame_centers = sph__alloc(q->context, 3 * all, sizeof *q->frame_centers);
    q->frame_radii = sph__alloc(q->context, level->radii_per_frame ? all : spheres, sizeof *q->frame_radii);
    q->simplices = sph__alloc(q->context, q->primitive_count, sizeof *q->simplices);
    q->numbers = sph__alloc(q->context, q->primitive_count, sizeof *q->numbers);
    q->shared = sph__zalloc(q->context, q->primitive_count, sizeof *q->shared);
    q->fans = sph__alloc(q->context, q->primitive_count, sizeof *q->fans);
    q->parts = sph__alloc(q->context, q->primitive_count, sizeof *q->parts);
    if (q->frame_centers == NULL || q->frame_radii == NULL || q->simplices == NULL || q->numbers == NULL ||
        q->shared == NULL || q->fans == NULL || q->parts == NULL)
        return SPH_E_NOMEM;
    memcpy(q->frame_centers, level->centers, 3 * all * sizeof *q->frame_centers);
    memcpy(q->frame_radii, level->radii, (level->radii_per_frame ? all : spheres) * sizeof *q->frame_radii);
    if (!allocate_bounds(q)) return SPH_E_NOMEM;
    return sph__query_cavities_create(q) ? SPH_OK : SPH_E_NOMEM;
}

static sph_status fill(sph_query *q, const sph_level *level, const sph_query_options *options)
{
    sph_status status = sph__solid_init(&q->solid, level);
    if (status != SPH_OK) return status;
    q->sphere_count = level->sphere_count;
    q->frame_count = level->frame_count;
    q->radii_per_frame = level->radii_per_frame != 0;
    q->primitive_count = q->solid.primitive_count;
    if (allocate(q, level) != SPH_OK) return sph__fail_memory(q->context);
    find_simplices(q, level);
    for (uint32_t i = 0; i < q->primitive_count; ++i)
        q->numbers[i] = i;
    q->is_exhaustive = options->search == SPH_SEARCH_EXHAUSTIVE ||
                       (options->search == SPH_SEARCH_AUTO && q->primitive_count < SPH__QUERY_TREE_FROM);
    if (!q->is_exhaustive && (status = build_tree(q)) != SPH_OK) return status;
    if (q->is_exhaustive && q->primitive_count <= SPH__QUERY_MANY && (status = build_leaves(q)) != SPH_OK)
        return status;
    if ((status = mark_shared(q)) != SPH_OK) return status;
    return sph_query_pose_frame(q, 0);
}

sph_status sph_query_create(const sph_level *level, const sph_query_options *options, sph_query **out)
{
    SPH__OWN(level, SPH__LEVEL);
    sph_query_options read;
    sph_query *q;
    sph_status status;
    if (out != NULL) *out = NULL;
    if (level == NULL || out == NULL)
        return sph__fail(level == NULL ? NULL : level->context, SPH_E_INVALID, "sph_query_create: an argument is NULL");
    if ((status = read_options(level->context, options, &read)) != SPH_OK) return status;
    if ((q = sph__new(level->context, sizeof *q, SPH__QUERY)) == NULL) return sph__fail_memory(level->context);
    q->context = sph__context_retain(level->context);
    if ((status = fill(q, level, &read)) != SPH_OK) {
        sph_query_destroy(q);
        return status;
    }
    *out = q;
    return SPH_OK;
}
