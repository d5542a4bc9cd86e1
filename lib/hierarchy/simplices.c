/* SPDX-License-Identifier: MIT */
#include "hierarchy/simplices.h"

void sph__order_edges(uint32_t *edges, size_t count, sph__keyed *keys)
{
    for (size_t i = 0; i < count; ++i) {
        const uint32_t a = edges[2 * i], b = edges[2 * i + 1];
        keys[i] = (sph__keyed){a < b ? a : b, a < b ? b : a};
    }
    sph__sort(keys, count);
    for (size_t i = 0; i < count; ++i) {
        edges[2 * i] = (uint32_t)keys[i].key;
        edges[2 * i + 1] = (uint32_t)keys[i].item;
    }
}

void sph__order_triangles(uint32_t *triangles, size_t count, sph__keyed *keys)
{
    for (size_t i = 0; i < count; ++i) {
        const uint32_t *t = triangles + 3 * i;
        const unsigned first = t[0] < t[1] ? (t[0] < t[2] ? 0 : 2) : (t[1] < t[2] ? 1 : 2);
        keys[i] = (sph__keyed){(uint64_t)t[first] << 32 | t[(first + 1) % 3], t[(first + 2) % 3]};
    }
    sph__sort(keys, count);
    for (size_t i = 0; i < count; ++i) {
        triangles[3 * i] = (uint32_t)(keys[i].key >> 32);
        triangles[3 * i + 1] = (uint32_t)keys[i].key;
        triangles[3 * i + 2] = (uint32_t)keys[i].item;
    }
}

void sph__simplices_free(const sph_context *context, sph__simplices *s)
{
    sph__free(context, s->nodes);
    sph__free(context, s->places);
    sph__free(context, s->edges);
    sph__free(context, s->triangles);
    *s = (sph__simplices){0};
}

/* The jump under way: all edges of the level, grouped by their younger end. */
typedef struct jump {
    const sph__collapses *h;
    uint32_t end;
    sph__simplices *out;
    sph__keyed *keys;
    size_t *starts;  /* [nodes + 1] into others */
    uint32_t *others;
    uint8_t *covered; /* per edge: a triangle has it */
} jump;

static sph_status list_nodes(jump *j)
{
    const sph__collapses *h = j->h;
    size_t count = 0;
    for (uint32_t t = j->end - h->vertex_count; t < h->collapse_count; ++t)
        for (unsigned k = 0; k < 2; ++k)
            if (h->children[2 * (size_t)t + k] < j->end) j->keys[count++] = (sph__keyed){h->children[2 * (size_t)t + k], 0};
    for (uint32_t i = 0; i < h->root_count; ++i)
        if (h->roots[i] < j->end) j->keys[count++] = (sph__keyed){h->roots[i], 0};
    sph__sort(j->keys, count);
    for (size_t i = 0; i < count; ++i) {
        j->out->nodes[i] = (uint32_t)j->keys[i].key;
        j->out->places[j->keys[i].key] = (uint32_t)i;
    }
    return count == j->out->node_count ? SPH_OK : sph__fail(h->context, SPH_E_INVALID, "the hierarchy is damaged");
}

static sph_status list_edges(jump *j)
{
    const sph__collapses *h = j->h;
    size_t most = 0, count = 0;
    for (uint32_t i = 0; i < j->out->node_count; ++i) {
        const uint32_t node = j->out->nodes[i];
        most += h->edge_starts[node + 1] - h->edge_starts[node];
    }
    j->others = sph__alloc(h->context, most, sizeof *j->others);
    j->covered = sph__zalloc(h->context, most, sizeof *j->covered);
    if (j->others == NULL || j->covered == NULL) return sph__fail_memory(h->context);
    for (uint32_t i = 0; i < j->out->node_count; ++i) {
        const uint32_t node = j->out->nodes[i];
        j->starts[i] = count;
        for (size_t e = h->edge_starts[node]; e < h->edge_starts[node + 1]; ++e)
            if (sph__node_alive(h->parents, h->edge_others[e], j->end)) j->others[count++] = h->edge_others[e];
    }
    j->starts[j->out->node_count] = count;
    return SPH_OK;
}

static void cover_edge(jump *j, uint32_t a, uint32_t b)
{
    const uint32_t young = a > b ? a : b, old = a > b ? b : a, place = j->out->places[young];
    size_t low = j->starts[place], high = j->starts[place + 1];
    while (high - low > 8) {
        const size_t middle = low + (high - low) / 2;
        if (j->others[middle] <= old)
            low = middle;
        else
            high = middle;
    }
    for (; low < high; ++low)
        if (j->others[low] == old) j->covered[low] = 1;
}

static sph_status list_triangles(jump *j)
{
    const sph__collapses *h = j->h;
    size_t most = 0, count = 0;
    for (uint32_t i = 0; i < j->out->node_count; ++i) {
        const uint32_t node = j->out->nodes[i];
        most += h->triangle_starts[node + 1] - h->triangle_starts[node];
    }
    j->out->triangles = sph__alloc(h->context, most, 3 * sizeof *j->out->triangles);
    if (j->out->triangles == NULL) return sph__fail_memory(h->context);
    for (uint32_t i = 0; i < j->out->node_count; ++i) {
        const uint32_t node = j->out->nodes[i];
        for (size_t t = h->triangle_starts[node]; t < h->triangle_starts[node + 1]; ++t) {
            const uint32_t x = h->triangle_others[2 * t], y = h->triangle_others[2 * t + 1];
            uint32_t *corner = j->out->triangles + 3 * count;
            if (!sph__node_alive(h->parents, x, j->end) || !sph__node_alive(h->parents, y, j->end)) continue;
            corner[0] = node;
            corner[1] = x;
            corner[2] = y;
            cover_edge(j, node, x);
            cover_edge(j, x, y);
            cover_edge(j, y, node);
            ++count;
        }
    }
    j->out->triangle_count = count;
    return SPH_OK;
}

static sph_status list_wire_edges(jump *j)
{
    const size_t all = j->starts[j->out->node_count];
    j->out->edges = sph__alloc(j->h->context, all, 2 * sizeof *j->out->edges);
    if (j->out->edges == NULL) return sph__fail_memory(j->h->context);
    for (uint32_t i = 0; i < j->out->node_count; ++i)
        for (size_t e = j->starts[i]; e < j->starts[i + 1]; ++e) {
            if (j->covered[e]) continue;
            j->out->edges[2 * j->out->edge_count] = j->others[e];
            j->out->edges[2 * j->out->edge_count++ + 1] = j->out->nodes[i];
        }
    return SPH_OK;
}

static sph_status order_simplices(jump *j)
{
    const size_t most = j->out->edge_count > j->out->triangle_count ? j->out->edge_count : j->out->triangle_count;
    sph__free(j->h->context, j->keys);
    j->keys = sph__alloc(j->h->context, most, sizeof *j->keys);
    if (j->keys == NULL) return sph__fail_memory(j->h->context);
    sph__order_edges(j->out->edges, j->out->edge_count, j->keys);
    sph__order_triangles(j->out->triangles, j->out->triangle_count, j->keys);
    return SPH_OK;
}

sph_status sph__simplices_jump(const sph__collapses *h, uint32_t end, sph__simplices *simplices)
{
    const uint32_t count = h->vertex_count - (end - h->vertex_count);
    jump j = {.h = h, .end = end, .out = simplices};
    sph_status status = SPH_OK;
    *simplices = (sph__simplices){.node_count = count};
    j.keys = sph__alloc(h->context, count, sizeof *j.keys);
    j.starts = sph__alloc(h->context, (size_t)count + 1, sizeof *j.starts);
    simplices->nodes = sph__alloc(h->context, count, sizeof *simplices->nodes);
    simplices->places = sph__alloc(h->context, end, sizeof *simplices->places);
    if (j.keys == NULL || j.starts == NULL || simplices->nodes == NULL || simplices->places == NULL)
        status = sph__fail_memory(h->context);
    if (status == SPH_OK) status = list_nodes(&j);
    if (status == SPH_OK) status = list_edges(&j);
    if (status == SPH_OK) status = list_triangles(&j);
    if (status == SPH_OK) status = list_wire_edges(&j);
    if (status == SPH_OK) status = order_simplices(&j);
    sph__free(h->context, j.keys);
    sph__free(h->context, j.starts);
    sph__free(h->context, j.others);
    sph__free(h->context, j.covered);
    if (status != SPH_OK) sph__simplices_free(h->context, simplices);
    return status;
}
