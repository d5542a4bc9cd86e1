/* SPDX-License-Identifier: MIT */
/* What the hierarchy keeps of its simplices: each with its youngest vertex. */
#include "hierarchy/build.h"

static sph_status reserve(sph__builder *b, uint32_t edges, uint32_t triangles)
{
    sph__births *births = &b->births;
    const uint32_t most = edges > triangles ? edges : triangles;
    if (!sph__reserve(b->context, (void **)&births->edges, &births->edge_capacity, births->edge_count + edges,
                      sizeof *births->edges) ||
        !sph__reserve(b->context, (void **)&births->triangles, &births->triangle_capacity,
                      births->triangle_count + 2 * (size_t)triangles, sizeof *births->triangles) ||
        !sph__reserve(b->context, (void **)&b->keys, &b->key_capacity, most, sizeof *b->keys))
        return sph__fail_memory(b->context);
    return SPH_OK;
}

static void record_edges(sph__builder *b, uint32_t node)
{
    const uint32_t *edges = sph__list_items(&b->mesh.node_edges, node);
    const uint32_t count = sph__list_count(&b->mesh.node_edges, node);
    size_t kept = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t other = sph__edge_other(&b->mesh, edges[i], node);
        if (other < node) b->keys[kept++] = (sph__keyed){other, 0};
    }
    sph__sort(b->keys, kept);
    for (size_t i = 0; i < kept; ++i) b->births.edges[b->births.edge_count++] = (uint32_t)b->keys[i].key;
}

static void record_triangles(sph__builder *b, uint32_t node)
{
    const uint32_t *triangles = sph__list_items(&b->mesh.node_triangles, node);
    const uint32_t count = sph__list_count(&b->mesh.node_triangles, node);
    size_t kept = 0;
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t others[2];
        sph__triangle_others(&b->mesh, triangles[i], node, others);
        if (others[0] < node && others[1] < node)
            b->keys[kept++] = (sph__keyed){(uint64_t)others[0] << 32 | others[1], 0};
    }
    sph__sort(b->keys, kept);
    for (size_t i = 0; i < kept; ++i) {
        b->births.triangles[b->births.triangle_count++] = (uint32_t)(b->keys[i].key >> 32);
        b->births.triangles[b->births.triangle_count++] = (uint32_t)b->keys[i].key;
    }
}

sph_status sph__record_births(sph__builder *b, uint32_t node)
{
    const sph_status status =
        reserve(b, sph__list_count(&b->mesh.node_edges, node), sph__list_count(&b->mesh.node_triangles, node));
    if (status != SPH_OK) return status;
    record_edges(b, node);
    record_triangles(b, node);
    b->h->edge_starts[node + 1] = b->births.edge_count;
    b->h->triangle_starts[node + 1] = b->births.triangle_count / 2;
    return SPH_OK;
}

sph_status sph__record_leaves(sph__builder *b)
{
    sph_status status = SPH_OK;
    b->h->edge_starts[0] = b->h->triangle_starts[0] = 0;
    for (uint32_t v = 0; v < b->n && status == SPH_OK; ++v) status = sph__record_births(b, v);
    return status;
}
