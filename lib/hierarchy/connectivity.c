/* SPDX-License-Identifier: MIT */
#include "hierarchy/connectivity.h"

/* An edge as a key: lower vertex first. */
static uint64_t edge_key(uint32_t a, uint32_t b)
{
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

/* Pairs (a, b) by their lower vertex: counted where there are no keys yet, else put where that vertex's next one goes. */
static void sort_in(sph__keyed *keys, size_t *ends, uint32_t a, uint32_t b)
{
    const uint32_t low = a < b ? a : b, high = a < b ? b : a;
    if (a == b) return;
    if (keys == NULL)
        ++ends[low];
    else
        keys[ends[low]++] = (sph__keyed){high, 0};
}

static void sort_in_all(sph__keyed *keys, size_t *ends, const uint32_t *triangles, size_t triangle_count,
                        const uint32_t *edges, size_t edge_count)
{
    for (size_t t = 0; t < triangle_count; ++t) {
        const uint32_t *corner = triangles + 3 * t;
        for (unsigned k = 0; k < 3; ++k) sort_in(keys, ends, corner[k], corner[(k + 1) % 3]);
    }
    for (size_t e = 0; e < edge_count; ++e) sort_in(keys, ends, edges[2 * e], edges[2 * e + 1]);
}

/* From counts to where each begins. */
static void begin_each(size_t *counts, size_t count)
{
    for (size_t v = 0, sum = 0; v < count; ++v) {
        const size_t here = counts[v];
        counts[v] = sum;
        sum += here;
    }
}

/* Leaves each once, with its lower end as the item; returns how many there are. */
static size_t unite_pairs(sph__keyed *keys, const size_t *ends, uint32_t vertex_count)
{
    size_t unique = 0;
    for (size_t v = 0, i = 0; v < vertex_count; ++v) {
        const size_t first = unique;
        sph__sort(keys + i, ends[v] - i);
        for (; i < ends[v]; ++i)
            if (unique == first || keys[i].key != keys[unique - 1].key) keys[unique++] = (sph__keyed){keys[i].key, v};
    }
    return unique;
}

static sph_status make_edges(sph__connectivity *c, uint32_t vertex_count, const uint32_t *triangles,
                             size_t triangle_count, const uint32_t *edges, size_t edge_count)
{
    sph__keyed *keys = sph__alloc(c->context, 3 * triangle_count + edge_count, sizeof *keys);
    size_t *ends = sph__zalloc(c->context, vertex_count, sizeof *ends);
    if (keys != NULL && ends != NULL) {
        size_t unique;
        sort_in_all(NULL, ends, triangles, triangle_count, edges, edge_count);
        begin_each(ends, vertex_count);
        sort_in_all(keys, ends, triangles, triangle_count, edges, edge_count);
        unique = unite_pairs(keys, ends, vertex_count);
        c->edges = unique > UINT32_MAX - 1 ? NULL : sph__alloc(c->context, unique, sizeof *c->edges);
        if (c->edges != NULL) c->edge_count = (uint32_t)unique;
        for (uint32_t i = 0; i < c->edge_count; ++i) {
            c->edges[i] = (sph__edge){{(uint32_t)keys[i].item, (uint32_t)keys[i].key}, SPH__NO_COST};
        }
    }
    sph__free(c->context, keys);
    sph__free(c->context, ends);
    return c->edges == NULL ? sph__fail_memory(c->context) : SPH_OK;
}

static bool names_one_twice(const uint32_t p[3])
{
    return p[0] == p[1] || p[1] == p[2] || p[2] == p[0];
}

static unsigned lowest_corner(const uint32_t p[3])
{
    return p[0] < p[1] ? (p[0] < p[2] ? 0 : 2) : (p[1] < p[2] ? 1 : 2);
}

/* Set in what triangles are sorted by where the two windings are told apart, and this is the other one. */
#define OTHER_WINDING (UINT64_C(1) << 63)

/* Marks triangles that have the same corners as one before: `keys` of those of each lowest corner, next to each other. */
static void mark_doubles(sph__keyed *keys, const size_t *ends, uint32_t vertex_count, uint8_t *doubles)
{
    for (size_t v = 0, i = 0; v < vertex_count; i = ends[v++]) {
        sph__sort(keys + i, ends[v] - i);
        for (size_t j = i + 1; j < ends[v]; ++j) {
            const uint64_t sides = (keys[j].item ^ keys[j - 1].item) & OTHER_WINDING;
            doubles[keys[j].item & ~OTHER_WINDING] = keys[j].key == keys[j - 1].key && sides == 0;
        }
    }
}

static void find_doubles(const sph__connectivity *c, uint32_t vertex_count, const uint32_t *triangles,
                         size_t triangle_count, sph__keyed *keys, size_t *ends, uint8_t *doubles)
{
    for (size_t t = 0; t < triangle_count; ++t) {
        const uint32_t *p = triangles + 3 * t;
        if (!names_one_twice(p)) ++ends[p[lowest_corner(p)]];
    }
    begin_each(ends, vertex_count);
    for (size_t t = 0; t < triangle_count; ++t) {
        const uint32_t *p = triangles + 3 * t;
        const unsigned low = lowest_corner(p);
        const uint32_t next = p[(low + 1) % 3], previous = p[(low + 2) % 3];
        const uint64_t winding = c->two_sided && next > previous ? OTHER_WINDING : 0;
        if (!names_one_twice(p)) keys[ends[p[low]]++] = (sph__keyed){edge_key(next, previous), winding | t};
    }
    mark_doubles(keys, ends, vertex_count, doubles);
}

/* Triangles with three different corners, the first of those with the same ones, in the order of the input. */
static sph_status make_triangles(sph__connectivity *c, uint32_t vertex_count, const uint32_t *triangles,
                                 size_t triangle_count, uint32_t *numbers)
{
    sph__keyed *keys = sph__alloc(c->context, triangle_count, sizeof *keys);
    size_t *ends = sph__zalloc(c->context, vertex_count, sizeof *ends);
    uint8_t *doubles = sph__zalloc(c->context, triangle_count, sizeof *doubles);
    sph_status status = SPH_OK;
    c->triangles = sph__alloc(c->context, triangle_count, sizeof *c->triangles);
    if (keys == NULL || ends == NULL || doubles == NULL || c->triangles == NULL) {
        status = sph__fail_memory(c->context);
    } else {
        find_doubles(c, vertex_count, triangles, triangle_count, keys, ends, doubles);
        for (size_t t = 0; t < triangle_count; ++t) {
            if (names_one_twice(triangles + 3 * t) || doubles[t]) continue;
            if (numbers != NULL) numbers[c->triangle_count] = (uint32_t)t;
            memcpy(c->triangles[c->triangle_count++], triangles + 3 * t, sizeof *c->triangles);
        }
    }
    sph__free(c->context, keys);
    sph__free(c->context, ends);
    sph__free(c->context, doubles);
    return status;
}

static sph_status list_incidences(sph__connectivity *c, uint32_t vertex_count)
{
    uint32_t *counts = sph__zalloc(c->context, vertex_count, sizeof *counts);
    sph_status status = SPH_OK;
    if (counts == NULL) return sph__fail_memory(c->context);
    for (uint32_t e = 0; e < c->edge_count; ++e)
        for (unsigned k = 0; k < 2; ++k) ++counts[c->edges[e].ends[k]];
    status = sph__lists_lay_out(&c->node_edges, counts, vertex_count);
    for (uint32_t e = 0; e < c->edge_count && status == SPH_OK; ++e)
        for (unsigned k = 0; k < 2 && status == SPH_OK; ++k) status = sph__list_add(&c->node_edges, c->edges[e].ends[k], e);
    memset(counts, 0, vertex_count * sizeof *counts);
    for (uint32_t t = 0; t < c->triangle_count; ++t)
        for (unsigned k = 0; k < 3; ++k) ++counts[c->triangles[t][k]];
    if (status == SPH_OK) status = sph__lists_lay_out(&c->node_triangles, counts, vertex_count);
    for (uint32_t t = 0; t < c->triangle_count && status == SPH_OK; ++t)
        for (unsigned k = 0; k < 3 && status == SPH_OK; ++k)
            status = sph__list_add(&c->node_triangles, c->triangles[t][k], t);
    sph__free(c->context, counts);
    return status;
}

sph_status sph__connectivity_init(sph__connectivity *c, const sph_context *context, uint32_t vertex_count,
                                  const uint32_t *triangles, size_t triangle_count, const uint32_t *edges,
                                  size_t edge_count, bool two_sided, uint32_t *numbers)
{
    const size_t node_count = 2 * (size_t)vertex_count;
    sph_status status;
    *c = (sph__connectivity){.context = context, .two_sided = two_sided};
    status = make_edges(c, vertex_count, triangles, triangle_count, edges, edge_count);
    if (status == SPH_OK) status = make_triangles(c, vertex_count, triangles, triangle_count, numbers);
    if (status == SPH_OK) status = sph__lists_init(&c->node_edges, context, node_count);
    if (status == SPH_OK) status = sph__lists_init(&c->node_triangles, context, node_count);
    if (status == SPH_OK) {
        c->mark_stamps = sph__zalloc(context, node_count, sizeof *c->mark_stamps);
        if (c->mark_stamps == NULL) status = sph__fail_memory(context);
    }
    if (status == SPH_OK) status = list_incidences(c, vertex_count);
    if (status != SPH_OK) sph__connectivity_free(c);
    return status;
}

void sph__connectivity_free(sph__connectivity *c)
{
    const sph_context *context = c->context;
    if (context == NULL) return;
    sph__free(context, c->edges);
    sph__free(context, c->triangles);
    if (c->node_edges.context != NULL) sph__lists_free(&c->node_edges);
    if (c->node_triangles.context != NULL) sph__lists_free(&c->node_triangles);
    sph__free(context, c->removed);
    sph__free(context, c->mark_stamps);
    sph__free(context, c->keys);
    *c = (sph__connectivity){0};
}

/* Removes triangle t from the lists of its corners other than those given. */
static void unlist_triangle(sph__connectivity *c, uint32_t t, uint32_t except1, uint32_t except2)
{
    for (unsigned k = 0; k < 3; ++k) {
        const uint32_t x = c->triangles[t][k];
        if (x != except1 && x != except2) sph__list_remove(&c->node_triangles, x, t);
    }
}

/* Moves the triangles of `from` to w; those that also have `gone` vanish. */
static sph_status move_triangles(sph__connectivity *c, uint32_t from, uint32_t gone, uint32_t w)
{
    const uint32_t count = sph__list_count(&c->node_triangles, from);
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t t = sph__list_items(&c->node_triangles, from)[i];
        uint32_t *corner = c->triangles[t];
        if (corner[0] == gone || corner[1] == gone || corner[2] == gone) {
            unlist_triangle(c, t, from, gone);
            continue;
        }
        for (unsigned k = 0; k < 3; ++k)
            if (corner[k] == from) corner[k] = w;
        const sph_status status = sph__list_add(&c->node_triangles, w, t);
        if (status != SPH_OK) return status;
    }
    sph__list_drop(&c->node_triangles, from);
    return SPH_OK;
}

/* Of triangles of w with the same other corners the first stays. */
static sph_status unite_triangles(sph__connectivity *c, uint32_t w)
{
    const uint32_t count = sph__list_count(&c->node_triangles, w);
    const uint32_t *items = sph__list_items(&c->node_triangles, w);
    if (!sph__reserve(c->context, (void **)&c->keys, &c->key_capacity, count, sizeof *c->keys))
        return sph__fail_memory(c->context);
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t others[2];
        sph__triangle_others(c, items[i], w, others);
        c->keys[i] = (sph__keyed){c->two_sided ? (uint64_t)others[0] << 32 | others[1] : edge_key(others[0], others[1]),
                                  items[i]};
    }
    sph__sort(c->keys, count);
    for (uint32_t i = 1; i < count; ++i)
        if (c->keys[i].key == c->keys[i - 1].key) unlist_triangle(c, (uint32_t)c->keys[i].item, w, w);
    c->node_triangles.lists[w].count = 0;
    for (uint32_t i = 0; i < count; ++i)
        if (i == 0 || c->keys[i].key != c->keys[i - 1].key)
            c->node_triangles.arena[c->node_triangles.lists[w].offset + c->node_triangles.lists[w].count++] =
                (uint32_t)c->keys[i].item;
    return SPH_OK;
}

static sph_status move_edges(sph__connectivity *c, uint32_t from, uint32_t gone, uint32_t w)
{
    const uint32_t count = sph__list_count(&c->node_edges, from);
    if (!sph__reserve(c->context, (void **)&c->removed, &c->removed_capacity, c->removed_count + count,
                      sizeof *c->removed))
        return sph__fail_memory(c->context);
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t e = sph__list_items(&c->node_edges, from)[i];
        const uint32_t x = sph__edge_other(c, e, from);
        sph_status status;
        if (x == gone) {
            if (from < gone) c->removed[c->removed_count++] = e; /* both ends list it: count it once */
            continue;
        }
        if (c->mark_stamps[x] == w) {
            sph__list_remove(&c->node_edges, x, e);
            c->removed[c->removed_count++] = e;
            continue;
        }
        c->mark_stamps[x] = w;
        c->edges[e].ends[c->edges[e].ends[0] == from ? 0 : 1] = w;
        status = sph__list_add(&c->node_edges, w, e);
        if (status != SPH_OK) return status;
    }
    sph__list_drop(&c->node_edges, from);
    return SPH_OK;
}

sph_status sph__connectivity_collapse(sph__connectivity *c, uint32_t u, uint32_t v, uint32_t w)
{
    sph_status status;
    c->removed_count = 0;
    status = move_triangles(c, u, v, w);
    if (status == SPH_OK) status = move_triangles(c, v, u, w);
    if (status == SPH_OK) status = unite_triangles(c, w);
    if (status == SPH_OK) status = move_edges(c, u, v, w);
    if (status == SPH_OK) status = move_edges(c, v, u, w);
    return status;
}
