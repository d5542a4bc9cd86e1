/* SPDX-License-Identifier: MIT */
/* Hierarchies in `.sphm` containers. */
#include "hierarchy/file.h"

#include "hierarchy/lanes.h"

enum { META_COUNT = 5, VERTEX_LIMIT = 1 << 30, CHUNK_COUNT = 11 };

/* Numbers per row of centres and radii in the file, and rows. */
static size_t radius_row(const sph_hierarchy *h)
{
    return h->radii_per_frame ? h->frame_count : 1;
}

/* --- writing --- */

/* Simplices per node, from where each node's begin. */
static uint32_t *list_counts(const sph_hierarchy *h, const size_t *starts)
{
    const uint32_t nodes = sph__node_count(h);
    uint32_t *counts = sph__alloc(h->context, nodes, sizeof *counts);
    for (uint32_t i = 0; i < nodes && counts != NULL; ++i)
        counts[i] = (uint32_t)(starts[i + 1] - starts[i]);
    return counts;
}

static sph_status write_chunks(const sph_hierarchy *h, const uint32_t *edge_counts, const uint32_t *triangle_counts,
                               sph_write_fn *write, void *user)
{
    const size_t nodes = sph__node_count(h), frames = h->frame_count, collapses = h->collapse_count;
    uint64_t meta[META_COUNT] = {h->vertex_count, frames, collapses, h->radii_per_frame};
    const sph__chunk chunks[CHUNK_COUNT] = {
        {SPH__CHUNK_META, 8, meta, META_COUNT, 0, 0},
        {SPH__CHUNK_CENTERS, 4, h->centers, nodes * 3 * frames, frames, h->stride},
        {SPH__CHUNK_RADII, 4, h->radii, nodes * radius_row(h), radius_row(h), h->radii_per_frame ? h->stride : 1},
        {SPH__CHUNK_CHILDREN, 4, h->children, 2 * collapses, 0, 0},
        {SPH__CHUNK_COSTS, 8, h->costs, collapses, 0, 0},
        {SPH__CHUNK_ERRORS, 8, h->errors, collapses, 0, 0},
        {SPH__CHUNK_FORCED, 1, h->forced, collapses, 0, 0},
        {SPH__CHUNK_EDGE_COUNTS, 4, edge_counts, nodes, 0, 0},
        {SPH__CHUNK_EDGES, 4, h->edge_others, h->edge_starts[nodes], 0, 0},
        {SPH__CHUNK_TRIANGLE_COUNTS, 4, triangle_counts, nodes, 0, 0},
        {SPH__CHUNK_TRIANGLES, 4, h->triangle_others, 2 * h->triangle_starts[nodes], 0, 0},
    };
    memcpy(&meta[4], &h->bounding_diagonal, sizeof meta[4]);
    return sph__container_write(h->context, SPH__CONTAINER_HIERARCHY, chunks, CHUNK_COUNT, write, user);
}

sph_status sph_hierarchy_write(const sph_hierarchy *h, sph_write_fn *write, void *user)
{
    SPH__OWN(h, SPH__HIERARCHY);
    uint32_t *edge_counts, *triangle_counts;
    sph_status status;
    if (h == NULL || write == NULL)
        return sph__fail(h == NULL ? NULL : h->context, SPH_E_INVALID, "sph_hierarchy_write: an argument is NULL");
    edge_counts = list_counts(h, h->edge_starts);
    triangle_counts = list_counts(h, h->triangle_starts);
    status = edge_counts == NULL || triangle_counts == NULL
                 ? sph__fail_memory(h->context)
                 : write_chunks(h, edge_counts, triangle_counts, write, user);
    sph__free(h->context, edge_counts);
    sph__free(h->context, triangle_counts);
    return status;
}

/* --- reading --- */

static sph_status read_meta(const sph__container *c, sph_hierarchy *h)
{
    uint64_t meta[META_COUNT];
    const sph_status status = sph__container_copy(c, SPH__CHUNK_META, 8, META_COUNT, meta);
    if (status != SPH_OK) return status;
    if (meta[0] < 1 || meta[0] > VERTEX_LIMIT || meta[1] < 1 || meta[1] > INT32_MAX || meta[2] >= meta[0] ||
        meta[3] > 1)
        return sph__fail(c->context, SPH_E_FORMAT, "byte %zu: the counts are out of range",
                         sph__container_byte(c, SPH__CHUNK_META, 8, 0));
    h->vertex_count = (uint32_t)meta[0];
    h->frame_count = (uint32_t)meta[1];
    h->collapse_count = (uint32_t)meta[2];
    h->radii_per_frame = (uint32_t)meta[3];
    memcpy(&h->bounding_diagonal, &meta[4], sizeof meta[4]);
    h->stride = (h->frame_count + SPH__LANES - 1) / SPH__LANES * SPH__LANES;
    return SPH_OK;
}

/* A chunk of rows into new memory; its length is checked before any is asked for. */
static sph_status read_rows(const sph__container *c, uint32_t tag, uint32_t size, size_t rows, size_t row,
                            size_t stride, void **out)
{
    size_t count, wanted, room;
    sph_status status = sph__container_count(c, tag, size, &count);
    if (status != SPH_OK) return status;
    if (!sph__multiply_size(rows, row, &wanted) || wanted != count)
        return sph__fail(c->context, SPH_E_FORMAT, "byte %zu: chunk %.4s holds %zu numbers, not %zu times %zu",
                         sph__container_byte(c, tag, size, 0), (const char *)&tag, count, rows, row);
    if (!sph__multiply_size(rows, stride, &room) || (*out = sph__alloc(c->context, room, size)) == NULL)
        return sph__fail_memory(c->context);
    return sph__container_copy_rows(c, tag, size, count, row, stride, *out);
}

static sph_status read_array(const sph__container *c, uint32_t tag, uint32_t size, size_t count, void **out)
{
    return read_rows(c, tag, size, 1, count, count, out);
}

/* Counts per node to where each node's simplices begin, then the simplices of `width` numbers. */
static sph_status read_simplices(const sph__container *c, const uint32_t tags[2], size_t nodes, size_t width,
                                 size_t **starts, uint32_t **others)
{
    void *counts = NULL, *numbers = NULL;
    sph_status status = read_array(c, tags[0], 4, nodes, &counts);
    if (status == SPH_OK && (*starts = sph__alloc(c->context, nodes + 1, sizeof **starts)) == NULL)
        status = sph__fail_memory(c->context);
    if (status == SPH_OK) {
        (*starts)[0] = 0;
        for (size_t i = 0; i < nodes; ++i)
            (*starts)[i + 1] = (*starts)[i] + ((const uint32_t *)counts)[i];
        status = read_rows(c, tags[1], 4, (*starts)[nodes], width, width, &numbers);
        *others = numbers;
    }
    sph__free(c->context, counts);
    return status;
}

static sph_status read_spheres(const sph__container *c, sph_hierarchy *h)
{
    const size_t nodes = sph__node_count(h), row = radius_row(h);
    void *memory = NULL;
    sph_status status = read_rows(c, SPH__CHUNK_CENTERS, 4, 3 * nodes, h->frame_count, h->stride, &memory);
    h->centers = memory;
    memory = NULL;
    if (status == SPH_OK)
        status = read_rows(c, SPH__CHUNK_RADII, 4, nodes, row, h->radii_per_frame ? h->stride : 1, &memory);
    h->radii = memory;
    return status;
}

static sph_status read_collapses(const sph__container *c, sph_hierarchy *h)
{
    void *children = NULL, *costs = NULL, *errors = NULL, *forced = NULL;
    sph_status status = read_array(c, SPH__CHUNK_CHILDREN, 4, 2 * (size_t)h->collapse_count, &children);
    if (status == SPH_OK) status = read_array(c, SPH__CHUNK_COSTS, 8, h->collapse_count, &costs);
    if (status == SPH_OK) status = read_array(c, SPH__CHUNK_ERRORS, 8, h->collapse_count, &errors);
    if (status == SPH_OK) status = read_array(c, SPH__CHUNK_FORCED, 1, h->collapse_count, &forced);
    h->children = children;
    h->costs = costs;
    h->errors = errors;
    h->forced = forced;
    return status;
}

static sph_status read_chunks(const sph__container *c, sph_hierarchy *h)
{
    static const uint32_t EDGES[2] = {SPH__CHUNK_EDGE_COUNTS, SPH__CHUNK_EDGES},
                          TRIANGLES[2] = {SPH__CHUNK_TRIANGLE_COUNTS, SPH__CHUNK_TRIANGLES};
    const size_t nodes = sph__node_count(h);
    sph_status status = read_spheres(c, h);
    if (status == SPH_OK) status = read_collapses(c, h);
    if (status == SPH_OK) status = read_simplices(c, EDGES, nodes, 1, &h->edge_starts, &h->edge_others);
    if (status == SPH_OK) status = read_simplices(c, TRIANGLES, nodes, 2, &h->triangle_starts, &h->triangle_others);
    if (status != SPH_OK) return status;
    h->parents = sph__alloc(c->context, nodes, sizeof *h->parents);
    return h->parents == NULL ? sph__fail_memory(c->context) : SPH_OK;
}

sph_status sph_hierarchy_read(sph_context *context, const void *bytes, size_t size, sph_hierarchy **out)
{
    SPH__OWN(context, SPH__CONTEXT);
    sph__container container;
    sph_hierarchy *h;
    sph_status status;
    if (out != NULL) *out = NULL;
    if (context == NULL || bytes == NULL || out == NULL)
        return sph__fail(context, SPH_E_INVALID, "sph_hierarchy_read: an argument is NULL");
    status = sph__container_open(context, bytes, size, SPH__CONTAINER_HIERARCHY, &container);
    if (status != SPH_OK) return status;
    h = sph__new(context, sizeof *h, SPH__HIERARCHY);
    if (h == NULL) return sph__fail_memory(context);
    h->context = sph__context_retain(context);
    status = read_meta(&container, h);
    if (status == SPH_OK) status = read_chunks(&container, h);
    if (status == SPH_OK) status = sph__hierarchy_check(&container, h);
    if (status == SPH_OK) status = sph__hierarchy_list_roots(h);
    if (status != SPH_OK) {
        sph_hierarchy_destroy(h);
        return status;
    }
    *out = h;
    return SPH_OK;
}
