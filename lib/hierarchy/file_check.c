/* SPDX-License-Identifier: MIT */
/*
 * What must hold of a hierarchy for walking it to be safe: nodes form a forest, every simplex is alive when it is born,
 * and a triangle's edges are there. Then each is born before it dies, and the cursor never looks for what is not there.
 */
#include <math.h>

#include "hierarchy/file.h"

static sph_status bad(const sph__container *c, uint32_t tag, uint32_t size, size_t index, const char *what)
{
    return sph__fail(c->context, SPH_E_FORMAT, "byte %zu: %s", sph__container_byte(c, tag, size, index), what);
}

static sph_status check_spheres(const sph__container *c, const sph_hierarchy *h)
{
    const size_t nodes = sph__node_count(h), frames = h->frame_count, row = h->radii_per_frame ? frames : 1;
    const size_t stride = h->radii_per_frame ? h->stride : 1;
    for (size_t i = 0; i < 3 * nodes; ++i)
        for (size_t f = 0; f < frames; ++f)
            if (!isfinite(h->centers[i * h->stride + f]))
                return bad(c, SPH__CHUNK_CENTERS, 4, i * frames + f, "a centre that is not finite");
    for (size_t i = 0; i < nodes; ++i)
        for (size_t f = 0; f < row; ++f)
            if (!isfinite(h->radii[i * stride + f]) || h->radii[i * stride + f] < 0)
                return bad(c, SPH__CHUNK_RADII, 4, i * row + f, "a radius that is negative or not finite");
    if (!isfinite(h->bounding_diagonal) || h->bounding_diagonal < 0)
        return bad(c, SPH__CHUNK_META, 8, 4, "a bounding diagonal that is negative or not finite");
    return SPH_OK;
}

/* Fills in the parents. Each node has one at most, and is older than it: so there are as many roots as there should be.
 */
static sph_status check_collapses(const sph__container *c, sph_hierarchy *h)
{
    const uint32_t nodes = sph__node_count(h);
    for (uint32_t i = 0; i < nodes; ++i)
        h->parents[i] = SPH__NO_NODE;
    h->first_forced = h->collapse_count;
    for (uint32_t t = 0; t < h->collapse_count; ++t) {
        const uint32_t *uv = h->children + 2 * (size_t)t, node = h->vertex_count + t;
        if (uv[0] >= uv[1] || uv[1] >= node || h->parents[uv[0]] != SPH__NO_NODE || h->parents[uv[1]] != SPH__NO_NODE)
            return bad(c, SPH__CHUNK_CHILDREN, 4, 2 * (size_t)t, "a collapse of nodes that are not there");
        h->parents[uv[0]] = h->parents[uv[1]] = node;
        if (!isfinite(h->costs[t])) return bad(c, SPH__CHUNK_COSTS, 8, t, "a cost that is not finite");
        if (!isfinite(h->errors[t]) || h->errors[t] < (t == 0 ? 0 : h->errors[t - 1]))
            return bad(c, SPH__CHUNK_ERRORS, 8, t, "an error that falls or is not finite");
        if (h->forced[t] > 1) return bad(c, SPH__CHUNK_FORCED, 1, t, "neither 0 nor 1");
        if (h->forced[t] && h->first_forced == h->collapse_count) h->first_forced = t;
    }
    return SPH_OK;
}

/* Whether `other` is alive when the younger `node` is born. */
static bool meets(const sph_hierarchy *h, uint32_t node, uint32_t other)
{
    return other < node && h->parents[other] > node;
}

static sph_status check_edges(const sph__container *c, const sph_hierarchy *h)
{
    for (uint32_t node = 0; node < sph__node_count(h); ++node)
        for (size_t e = h->edge_starts[node]; e < h->edge_starts[node + 1]; ++e)
            if (!meets(h, node, h->edge_others[e]) ||
                (e > h->edge_starts[node] && h->edge_others[e] <= h->edge_others[e - 1]))
                return bad(c, SPH__CHUNK_EDGES, 4, e, "an edge that cannot be");
    return SPH_OK;
}

static bool has_edge(const sph__collapses *h, uint32_t a, uint32_t b)
{
    return sph__collapses_find_edge(h, a > b ? a : b, a > b ? b : a) != SIZE_MAX;
}

static sph_status check_triangles(const sph__container *c, const sph_hierarchy *h)
{
    const sph__collapses edges = sph__hierarchy_collapses(h);
    for (uint32_t node = 0; node < sph__node_count(h); ++node)
        for (size_t t = h->triangle_starts[node]; t < h->triangle_starts[node + 1]; ++t) {
            const uint32_t x = h->triangle_others[2 * t], y = h->triangle_others[2 * t + 1];
            if (x == y || !meets(h, node, x) || !meets(h, node, y) || !has_edge(&edges, node, x) || !has_edge(&edges, node, y) ||
                !has_edge(&edges, x, y))
                return bad(c, SPH__CHUNK_TRIANGLES, 4, 2 * t, "a triangle that cannot be");
        }
    return SPH_OK;
}

sph_status sph__hierarchy_check(const sph__container *container, sph_hierarchy *hierarchy)
{
    sph_status status = check_spheres(container, hierarchy);
    if (status == SPH_OK) status = check_collapses(container, hierarchy);
    if (status == SPH_OK) status = check_edges(container, hierarchy);
    if (status == SPH_OK) status = check_triangles(container, hierarchy);
    return status;
}
