/* SPDX-License-Identifier: MIT */
#include "hierarchy/connectivity.h"

/* An edge as a key: lower vertex first. */
static uint64_t edge_key(uint32_t a, uint32_t b)
{
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

static size_t add_key(sph__keyed *keys, size_t count, uint32_t a, uint32_t b)
{
    if (a == b) return count;
    keys[count] = (sph__keyed){edge_key(a, b), 0};
    return count + 1;
}

static sph_status make_edges(sph__connectivity *c, const uint32_t *triangles, size_t triangle_count,
                             const uint32_t *edges, size_t edge_count)
{
    size_t count = 0, unique = 0;
    sph__keyed *keys = sph__alloc(c->context, 3 * triangle_count + edge_count, sizeof *keys);
    if (keys == NULL) return sph__fail_memory(c->context);
    for (size_t t = 0; t < triangle_count; ++t) {
        const uint32_t *corner = triangles + 3 * t;
        for (unsigned k = 0; k < 3; ++k) count = add_key(keys, count, corner[k], corner[(k + 1) % 3]);
    }
    for (size_t e = 0; e < edge_count; ++e) count = add_key(keys, count, edges[2 * e], edges[2 * e + 1]);
    sph__sort(keys, count);
    for (size_t i = 0; i < count; ++i)
        if (i == 0 || keys[i].key != keys[i - 1].key) keys[unique++] = keys[i];
    c->edges = unique > UINT32_MAX - 1 ? NULL : sph__alloc(c->context, unique, sizeof *c->edges);
    if (c->edges != NULL) {
        c->edge_count = (uint32_t)unique;
        for (size_t i = 0; i < unique; ++i) {
            c->edges[i][0] = (uint32_t)(keys[i].key >> 32);
            c->edges[i][1] = (uint32_t)keys[i].key;
        }
    }
    sph__free(c->context, keys);
    return c->edges == NULL ? sph__fail_memory(c->context) : SPH_OK;
}

/* Which way round the corners run from the lowest: to the highest next, or not. */
static uint32_t winding_of(const uint32_t p[3])
{
    const unsigned first = p[0] < p[1] ? (p[0] < p[2] ? 0 : 2) : (p[1] < p[2] ? 1 : 2);
    return p[(first + 1) % 3] > p[(first + 2) % 3];
}

static bool same_corners(const uint32_t a[3], const uint32_t b[3])
{
    for (unsigned k = 0; k < 3; ++k)
        if (a[k] != b[0] && a[k] != b[1] && a[k] != b[2]) return false;
    return true;
}

/* Set in what triangles are sorted by where the two windings are told apart, and this is the other one. */
#define OTHER_WINDING UINT32_C(0x80000000)

/* Triangles with three different corners, the first of those with the same ones. Sorted by two corners and then compared
 * within the group by a second sort on the third. */
static sph_status make_triangles(sph__connectivity *c, const uint32_t *triangles, size_t triangle_count, uint32_t *numbers)
{
    size_t count = 0;
    sph__keyed *keys = sph__alloc(c->context, triangle_count, sizeof *keys);
    uint32_t *third = sph__alloc(c->context, triangle_count, sizeof *third);
    c->triangles = sph__alloc(c->context, triangle_count, sizeof *c->triangles);
    if (keys == NULL || third == NULL || c->triangles == NULL) {
        sph__free(c->context, keys);
        sph__free(c->context, third);
        return sph__fail_memory(c->context);
    }
    for (size_t t = 0; t < triangle_count; ++t) {
        const uint32_t *p = triangles + 3 * t;
        const uint32_t low = p[0] < p[1] ? (p[0] < p[2] ? p[0] : p[2]) : (p[1] < p[2] ? p[1] : p[2]);
        const uint32_t high = p[0] > p[1] ? (p[0] > p[2] ? p[0] : p[2]) : (p[1] > p[2] ? p[1] : p[2]);
        if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) continue;
        third[t] = p[0] ^ p[1] ^ p[2] ^ low ^ high;
        keys[count] = (sph__keyed){(uint64_t)low << 32 | high, (uint64_t)third[t] << 32 | t};
        if (c->two_sided && winding_of(p)) keys[count].item |= OTHER_WINDING;
        ++count;
    }
    sph__sort(keys, count);
    for (size_t i = 1, kept = 0; i < count; ++i) {
        const uint32_t ta = (uint32_t)keys[kept].item & ~OTHER_WINDING, tb = (uint32_t)keys[i].item & ~OTHER_WINDING;
        const bool same_side = (((uint32_t)keys[kept].item ^ (uint32_t)keys[i].item) & OTHER_WINDING) == 0;
        if (same_side && same_corners(triangles + 3 * (size_t)ta, triangles + 3 * (size_t)tb))
            keys[i].key = UINT64_MAX; /* not the first */
        else
            kept = i;
    }
    for (size_t i = 0; i < count; ++i) {
        keys[i].item = (uint32_t)keys[i].item & ~OTHER_WINDING;
        if (keys[i].key != UINT64_MAX) keys[i].key = keys[i].item;
    }
    sph__sort(keys, count); /* back into the order of the input */
    for (size_t i = 0; i < count && keys[i].key != UINT64_MAX; ++i) {
        if (numbers != NULL) numbers[i] = (uint32_t)keys[i].item;
        memcpy(c->triangles[c->triangle_count++], triangles + 3 * keys[i].item, sizeof *c->triangles);
    }
    sph__free(c->context, keys);
    sph__free(c->context, third);
    return SPH_OK;
}

static sph_status list_incidences(sph__connectivity *c)
{
    sph_status status = SPH_OK;
    for (uint32_t e = 0; e < c->edge_count && status == SPH_OK; ++e)
        for (unsigned k = 0; k < 2 && status == SPH_OK; ++k) status = sph__list_add(&c->node_edges, c->edges[e][k], e);
    for (uint32_t t = 0; t < c->triangle_count && status == SPH_OK; ++t)
        for (unsigned k = 0; k < 3 && status == SPH_OK; ++k)
            status = sph__list_add(&c->node_triangles, c->triangles[t][k], t);
    return status;
}

sph_status sph__connectivity_init(sph__connectivity *c, const sph_context *context, uint32_t vertex_count,
                                  const uint32_t *triangles, size_t triangle_count, const uint32_t *edges,
                                  size_t edge_count, bool two_sided, uint32_t *numbers)
{
    const size_t node_count = 2 * (size_t)vertex_count;
    sph_status status;
    *c = (sph__connectivity){.context = context, .two_sided = two_sided};
    status = make_edges(c, triangles, triangle_count, edges, edge_count);
    if (status == SPH_OK) status = make_triangles(c, triangles, triangle_count, numbers);
    if (status == SPH_OK) status = sph__lists_init(&c->node_edges, context, node_count);
    if (status == SPH_OK) status = sph__lists_init(&c->node_triangles, context, node_count);
    if (status == SPH_OK) {
        c->mark_stamps = sph__zalloc(context, node_count, sizeof *c->mark_stamps);
        if (c->mark_stamps == NULL) status = sph__fail_memory(context);
    }
    if (status == SPH_OK) status = list_incidences(c);
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
        c->edges[e][c->edges[e][0] == from ? 0 : 1] = w;
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
