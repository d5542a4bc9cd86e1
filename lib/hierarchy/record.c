/* SPDX-License-Identifier: MIT */
/* What is kept of simplices: each with its youngest vertex. */
#include "hierarchy/collapses.h"

static sph_status reserve(sph__births *births, const sph_context *context, uint32_t edges, uint32_t triangles)
{
    const uint32_t most = edges > triangles ? edges : triangles;
    if (!sph__reserve(context, (void **)&births->edges, &births->edge_capacity, births->edge_count + edges,
                      sizeof *births->edges) ||
        !sph__reserve(context, (void **)&births->triangles, &births->triangle_capacity,
                      births->triangle_count + 2 * (size_t)triangles, sizeof *births->triangles) ||
        !sph__reserve(context, (void **)&births->keys, &births->key_capacity, most, sizeof *births->keys))
        return sph__fail_memory(context);
    return SPH_OK;
}

/* Brings the keys into order, which are all different. It is found by counting how many are below each,
 * which has no branches to mispredict, unless there are too few or too many. */
enum { FEW = 5, MANY = 12 };

static void order(sph__keyed *keys, size_t count)
{
    uint64_t few[MANY], items[MANY];
    if (count < FEW || count > MANY) {
        sph__sort(keys, count);
        return;
    }
    for (size_t i = 0; i < count; ++i) {
        few[i] = keys[i].key;
        items[i] = keys[i].item;
    }
    for (size_t i = 0; i < count; ++i) {
        size_t before = 0;
        for (size_t j = 0; j < count; ++j) before += few[j] < few[i];
        keys[before].key = few[i];
        keys[before].item = items[i];
    }
}

static void add_edges(sph__births *births, const sph__connectivity *mesh, uint32_t node)
{
    const uint32_t *edges = sph__edges_of(mesh, node);
    const uint32_t count = sph__edge_count_of(mesh, node);
    size_t kept = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t other = sph__edge_other(mesh, edges[i], node);
        births->keys[kept] = (sph__keyed){other, 0};
        kept += other < node;
    }
    order(births->keys, kept);
    for (size_t i = 0; i < kept; ++i)
        births->edges[births->edge_count++] = (uint32_t)births->keys[i].key;
}

static void add_triangles(sph__births *births, const sph__connectivity *mesh, uint32_t node)
{
    const uint32_t *triangles = sph__triangles_of(mesh, node);
    const uint32_t count = sph__triangle_count_of(mesh, node);
    size_t kept = 0;
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t others[2];
        sph__triangle_others(mesh, triangles[i], node, others);
        births->keys[kept] = (sph__keyed){(uint64_t)others[0] << 32 | others[1], triangles[i]};
        kept += (others[0] < node) & (others[1] < node);
    }
    order(births->keys, kept);
    for (size_t i = 0; i < kept; ++i) {
        births->triangles[births->triangle_count++] = (uint32_t)(births->keys[i].key >> 32);
        births->triangles[births->triangle_count++] = (uint32_t)births->keys[i].key;
    }
}

sph_status sph__births_add(sph__births *births, const sph__connectivity *mesh, uint32_t node)
{
    const sph_status status = reserve(births, mesh->context, sph__edge_count_of(mesh, node),
                                      sph__triangle_count_of(mesh, node));
    if (status != SPH_OK) return status;
    add_edges(births, mesh, node);
    add_triangles(births, mesh, node);
    births->edge_starts[node + 1] = births->edge_count;
    births->triangle_starts[node + 1] = births->triangle_count / 2;
    return SPH_OK;
}

/* Collapses bring somewhat more than twice as many simplices as there are at the start: room for what is likely. */
static sph_status reserve_all(sph__births *births, const sph__connectivity *mesh)
{
    const size_t edges = (size_t)mesh->edge_count / 2 * 7, triangles = (size_t)mesh->triangle_count * 8;
    return sph__reserve(mesh->context, (void **)&births->edges, &births->edge_capacity, edges, sizeof *births->edges) &&
                   sph__reserve(mesh->context, (void **)&births->triangles, &births->triangle_capacity, triangles,
                                sizeof *births->triangles)
               ? SPH_OK
               : sph__fail_memory(mesh->context);
}

sph_status sph__births_add_leaves(sph__births *births, const sph__connectivity *mesh, uint32_t count)
{
    sph_status status = reserve_all(births, mesh);
    births->edge_starts[0] = births->triangle_starts[0] = 0;
    for (uint32_t v = 0; v < count && status == SPH_OK; ++v)
        status = sph__births_add(births, mesh, v);
    return status;
}

void sph__births_free(sph__births *births, const sph_context *context)
{
    sph__free(context, births->edges);
    sph__free(context, births->triangles);
    sph__free(context, births->keys);
    *births = (sph__births){0};
}

void sph__list_roots(const uint32_t *parents, uint32_t node_count, uint32_t *roots, uint32_t root_count)
{
    for (uint32_t node = 0, count = 0; node < node_count && count < root_count; ++node)
        if (parents[node] == SPH__NO_NODE) roots[count++] = node;
}

size_t sph__collapses_find_edge(const sph__collapses *h, uint32_t node, uint32_t other)
{
    size_t low = h->edge_starts[node], high = h->edge_starts[node + 1];
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (h->edge_others[middle] == other) return middle;
        if (h->edge_others[middle] < other)
            low = middle + 1;
        else
            high = middle;
    }
    return SIZE_MAX;
}
