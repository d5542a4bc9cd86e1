/* SPDX-License-Identifier: MIT */
/* B(i): the bones that may move a vertex are those of its cell and of the cells around it. */
#include "skin/skin.h"

static size_t list_pair(sph__keyed *pairs, size_t count, uint32_t a, uint32_t b)
{
    if (a == b) return count;
    pairs[count] = (sph__keyed){a, b};
    pairs[count + 1] = (sph__keyed){b, a};
    return count + 2;
}

/* Both directions of every pair of cells that an edge of the mesh joins; returns how many differ. */
static size_t find_pairs(sph__keyed *pairs, const uint32_t *labels, const uint32_t *triangles, size_t triangle_count,
                         const uint32_t *edges, size_t edge_count)
{
    size_t count = 0, kept = 0;
    for (size_t t = 0; t < triangle_count; ++t)
        for (int k = 0; k < 3; ++k)
            count = list_pair(pairs, count, labels[triangles[3 * t + k]], labels[triangles[3 * t + (k + 1) % 3]]);
    for (size_t e = 0; e < edge_count; ++e)
        count = list_pair(pairs, count, labels[edges[2 * e]], labels[edges[2 * e + 1]]);
    sph__sort(pairs, count);
    for (size_t i = 0; i < count; ++i)
        if (i == 0 || pairs[i].key != pairs[i - 1].key || pairs[i].item != pairs[i - 1].item) pairs[kept++] = pairs[i];
    return kept;
}

/* Cells within reach of `cell` into `found`, itself first, ring by ring. `marks` holds cell + 1 where seen. */
static uint32_t walk(const sph__keyed *pairs, const size_t *first, uint32_t cell, uint32_t rings, uint32_t *marks,
                     uint32_t *found)
{
    uint32_t count = 1, begin = 0;
    found[0] = cell;
    marks[cell] = cell + 1;
    for (uint32_t ring = 0; ring < rings && begin < count; ++ring) {
        const uint32_t end = count;
        for (; begin < end; ++begin)
            for (size_t i = first[found[begin]]; i < first[found[begin] + 1]; ++i) {
                const uint32_t other = (uint32_t)pairs[i].item;
                if (marks[other] == cell + 1) continue;
                marks[other] = cell + 1;
                found[count++] = other;
            }
    }
    return count;
}

static sph_status collect(sph__reach *reach, const sph__keyed *pairs, size_t pair_count, uint32_t rings)
{
    const uint32_t cells = reach->cell_count;
    size_t *first = sph__zalloc(reach->context, (size_t)cells + 1, sizeof *first);
    uint32_t *marks = sph__zalloc(reach->context, cells, sizeof *marks);
    uint32_t *found = sph__alloc(reach->context, cells, sizeof *found);
    sph__keyed *order = sph__alloc(reach->context, cells, sizeof *order);
    size_t capacity = 0, count = 0;
    bool fits = first != NULL && marks != NULL && found != NULL && order != NULL;
    for (size_t i = 0; i < pair_count && fits; ++i)
        ++first[pairs[i].key + 1];
    for (uint32_t c = 0; c < cells && fits; ++c)
        first[c + 1] += first[c];
    for (uint32_t c = 0; c < cells && fits; ++c) {
        const uint32_t near = walk(pairs, first, c, rings, marks, found);
        reach->starts[c] = count;
        fits = sph__reserve(reach->context, (void **)&reach->bones, &capacity, count + near, sizeof *reach->bones);
        if (!fits) break;
        for (uint32_t i = 0; i < near; ++i)
            order[i] = (sph__keyed){i == 0 ? 0 : (uint64_t)found[i] + 1, found[i]};
        sph__sort(order, near);
        for (uint32_t i = 0; i < near; ++i)
            reach->bones[count++] = (uint32_t)order[i].item;
        if (near > reach->most) reach->most = near;
    }
    if (fits) reach->starts[cells] = count;
    sph__free(reach->context, first);
    sph__free(reach->context, marks);
    sph__free(reach->context, found);
    sph__free(reach->context, order);
    return fits ? SPH_OK : sph__fail_memory(reach->context);
}

sph_status sph__reach_find(sph__reach *reach, const sph_context *context, uint32_t cell_count, const uint32_t *labels,
                           const uint32_t *triangles, size_t triangle_count, const uint32_t *edges, size_t edge_count,
                           uint32_t rings)
{
    sph__keyed *pairs;
    sph_status status;
    *reach = (sph__reach){.context = context, .cell_count = cell_count};
    reach->starts = sph__zalloc(context, (size_t)cell_count + 1, sizeof *reach->starts);
    pairs = sph__alloc(context, 6 * triangle_count + 2 * edge_count, sizeof *pairs); /* at most 2^31 simplices each */
    if (reach->starts == NULL || pairs == NULL) {
        sph__free(context, pairs);
        return sph__fail_memory(context);
    }
    status = collect(reach, pairs, find_pairs(pairs, labels, triangles, triangle_count, edges, edge_count), rings);
    sph__free(context, pairs);
    return status;
}

void sph__reach_free(sph__reach *reach)
{
    sph__free(reach->context, reach->starts);
    sph__free(reach->context, reach->bones);
    *reach = (sph__reach){0};
}
