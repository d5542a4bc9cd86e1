/* SPDX-License-Identifier: MIT */
#include "hierarchy/connectivity.h"

/* An edge as a key: lower vertex first. */
static uint64_t edge_key(uint32_t a, uint32_t b)
{
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

/* Pairs (a, b) by their lower vertex: counted where there are none yet, else the higher put where that one's next goes. */
static void sort_in(uint32_t *highs, size_t *ends, uint32_t a, uint32_t b)
{
    const uint32_t low = a < b ? a : b, high = a < b ? b : a;
    if (a == b) return;
    if (highs == NULL)
        ++ends[low];
    else
        highs[ends[low]++] = high;
}

static void sort_in_all(uint32_t *highs, size_t *ends, const uint32_t *triangles, size_t triangle_count,
                        const uint32_t *edges, size_t edge_count)
{
    for (size_t t = 0; t < triangle_count; ++t) {
        const uint32_t *corner = triangles + 3 * t;
        for (unsigned k = 0; k < 3; ++k) sort_in(highs, ends, corner[k], corner[(k + 1) % 3]);
    }
    for (size_t e = 0; e < edge_count; ++e) sort_in(highs, ends, edges[2 * e], edges[2 * e + 1]);
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

/* Leaves each pair once, the lower ends' numbers becoming those of how many there are; returns how many in all. */
static size_t unite_pairs(uint32_t *highs, size_t *ends, uint32_t vertex_count, sph__node *nodes)
{
    size_t unique = 0;
    for (size_t v = 0, i = 0; v < vertex_count; ++v) {
        const size_t end = ends[v];
        for (; i < end; ++i) {
            const uint32_t high = highs[i];
            if (nodes[high].mark == v + 1) continue;
            nodes[high].mark = (uint32_t)v + 1;
            highs[unique++] = high;
        }
        ends[v] = unique;
    }
    for (size_t v = 0; v < vertex_count; ++v) nodes[v].mark = 0;
    return unique;
}

static sph_status make_edges(sph__connectivity *c, uint32_t vertex_count, const uint32_t *triangles,
                             size_t triangle_count, const uint32_t *edges, size_t edge_count)
{
    uint32_t *highs = sph__alloc(c->context, 3 * triangle_count + edge_count, sizeof *highs);
    size_t *ends = sph__zalloc(c->context, vertex_count, sizeof *ends);
    if (highs != NULL && ends != NULL) {
        size_t unique;
        sort_in_all(NULL, ends, triangles, triangle_count, edges, edge_count);
        begin_each(ends, vertex_count);
        sort_in_all(highs, ends, triangles, triangle_count, edges, edge_count);
        unique = unite_pairs(highs, ends, vertex_count, c->nodes);
        c->edges = unique > UINT32_MAX - 1 ? NULL : sph__alloc(c->context, unique, sizeof *c->edges);
        if (c->edges != NULL) c->edge_count = (uint32_t)unique;
        for (uint32_t i = 0, v = 0; i < c->edge_count; ++i) {
            while (i >= ends[v]) ++v;
            c->edges[i] = (sph__edge){{v, highs[i]}, SPH__NO_COST};
        }
    }
    sph__free(c->context, highs);
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

static bool count_item(sph__list *list)
{
    if (list->count == SPH__LIST_MOST) return false;
    ++list->count;
    return true;
}

/* Lays out the lists, whose items have been counted: both of a node side by side, which mostly is one cache line. */
static sph_status lay_out(sph__connectivity *c, uint32_t vertex_count)
{
    size_t steps = 0;
    sph_status status;
    for (uint32_t v = 0; v < vertex_count; ++v)
        steps += sph__list_steps(c->nodes[v].edges.count) + sph__list_steps(c->nodes[v].triangles.count);
    status = sph__lists_init(&c->lists, c->context, steps + steps / 4); /* some will grow */
    for (uint32_t v = 0; v < vertex_count && status == SPH_OK; ++v) {
        sph__node *node = &c->nodes[v];
        const size_t edges = node->edges.count, triangles = node->triangles.count;
        node->edges.count = node->triangles.count = 0;
        status = sph__list_reserve(&c->lists, &node->edges, edges);
        if (status == SPH_OK) status = sph__list_reserve(&c->lists, &node->triangles, triangles);
    }
    return status;
}

static sph_status list_incidences(sph__connectivity *c, uint32_t vertex_count)
{
    bool fits = true;
    sph_status status;
    for (uint32_t e = 0; e < c->edge_count; ++e)
        for (unsigned k = 0; k < 2; ++k) fits &= count_item(&c->nodes[c->edges[e].ends[k]].edges);
    for (uint32_t t = 0; t < c->triangle_count; ++t)
        for (unsigned k = 0; k < 3; ++k) fits &= count_item(&c->nodes[c->triangles[t][k]].triangles);
    status = fits ? lay_out(c, vertex_count) : sph__fail_memory(c->context);
    for (uint32_t e = 0; e < c->edge_count && status == SPH_OK; ++e)
        for (unsigned k = 0; k < 2; ++k) sph__list_put(&c->lists, &c->nodes[c->edges[e].ends[k]].edges, e);
    for (uint32_t t = 0; t < c->triangle_count && status == SPH_OK; ++t)
        for (unsigned k = 0; k < 3; ++k) sph__list_put(&c->lists, &c->nodes[c->triangles[t][k]].triangles, t);
    return status;
}

sph_status sph__connectivity_init(sph__connectivity *c, const sph_context *context, uint32_t vertex_count,
                                  const uint32_t *triangles, size_t triangle_count, const uint32_t *edges,
                                  size_t edge_count, bool two_sided, uint32_t *numbers)
{
    const size_t node_count = 2 * (size_t)vertex_count;
    sph_status status;
    *c = (sph__connectivity){.context = context, .two_sided = two_sided};
    c->nodes = sph__zalloc(context, node_count, sizeof *c->nodes);
    status = c->nodes == NULL ? sph__fail_memory(context) : SPH_OK;
    if (status == SPH_OK) status = make_edges(c, vertex_count, triangles, triangle_count, edges, edge_count);
    if (status == SPH_OK) status = make_triangles(c, vertex_count, triangles, triangle_count, numbers);
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
    sph__lists_free(&c->lists);
    sph__free(context, c->nodes);
    sph__free(context, c->removed);
    sph__free(context, c->keys);
    *c = (sph__connectivity){0};
}

/* --- a collapse --- */

/* The lists of u become those of w. */
static sph_status take_lists(sph__connectivity *c, uint32_t u, uint32_t v, uint32_t w)
{
    sph__node *from = &c->nodes[u], *to = &c->nodes[w];
    const size_t edges = (size_t)from->edges.count + c->nodes[v].edges.count;
    const size_t triangles = (size_t)from->triangles.count + c->nodes[v].triangles.count;
    to->edges = from->edges;
    to->triangles = from->triangles;
    from->edges = from->triangles = (sph__list){0};
    c->removed_count = 0;
    return sph__reserve(c->context, (void **)&c->removed, &c->removed_capacity, edges, sizeof *c->removed) &&
                   sph__reserve(c->context, (void **)&c->keys, &c->key_capacity, triangles, sizeof *c->keys)
               ? SPH_OK
               : sph__fail_memory(c->context);
}

/* Renames the end `from` of an edge; returns the other. */
static uint32_t rename_end(sph__edge *edge, uint32_t from, uint32_t to)
{
    const uint32_t other = edge->ends[0] ^ edge->ends[1] ^ from;
    edge->ends[0] = edge->ends[0] == from ? to : edge->ends[0];
    edge->ends[1] = edge->ends[1] == from ? to : edge->ends[1];
    return other;
}

/* The edges of u and v, to w; of those to a neighbour of both that of u stays. */
static sph_status move_edges(sph__connectivity *c, uint32_t u, uint32_t v, uint32_t w)
{
    sph__list *list = &c->nodes[w].edges;
    const uint32_t count = list->count;
    uint32_t *items = sph__edges_of(c, w);
    sph_status status = SPH_OK;
    list->count = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t e = items[i], x = rename_end(&c->edges[e], u, w);
        if (x == v) {
            c->removed[c->removed_count++] = e;
        } else {
            c->nodes[x].mark = w;
            sph__list_put(&c->lists, list, e);
        }
    }
    for (uint32_t i = 0; i < sph__edge_count_of(c, v) && status == SPH_OK; ++i) {
        const uint32_t e = sph__edges_of(c, v)[i], x = rename_end(&c->edges[e], v, w);
        if (x == w) continue; /* the one that collapses */
        if (c->nodes[x].mark == w) {
            c->nodes[x].mark |= SPH__SHARED;
            __builtin_prefetch(sph__edges_of(c, x));
            __builtin_prefetch(sph__triangles_of(c, x));
            c->removed[c->removed_count++] = e;
        } else {
            status = sph__list_add(&c->lists, list, e);
        }
    }
    sph__list_drop(&c->lists, &c->nodes[v].edges);
    return status;
}

/* Takes what was removed from the lists of the neighbours. */
static void unlist_edges(sph__connectivity *c, uint32_t w)
{
    for (size_t i = 0; i < c->removed_count; ++i) {
        const uint32_t x = sph__edge_other(c, c->removed[i], w);
        if (x != w) sph__list_remove(&c->lists, &c->nodes[x].edges, c->removed[i]);
    }
}

/* Removes triangle t from the lists of its corners other than those given. */
static void unlist_triangle(sph__connectivity *c, uint32_t t, uint32_t except1, uint32_t except2)
{
    for (unsigned k = 0; k < 3; ++k) {
        const uint32_t x = c->triangles[t][k];
        if (x != except1 && x != except2) sph__list_remove(&c->lists, &c->nodes[x].triangles, t);
    }
}

/* Renames the corner `from` of a triangle; false where it has `gone` as well, and vanishes. */
static bool rename_corner(sph__connectivity *c, uint32_t t, uint32_t from, uint32_t gone, uint32_t w)
{
    uint32_t *corner = c->triangles[t];
    if ((corner[0] == gone) | (corner[1] == gone) | (corner[2] == gone)) return false;
    for (unsigned k = 0; k < 3; ++k) corner[k] = corner[k] == from ? w : corner[k];
    return true;
}

static sph_status move_triangles(sph__connectivity *c, uint32_t u, uint32_t v, uint32_t w)
{
    sph__list *list = &c->nodes[w].triangles;
    const uint32_t count = list->count;
    uint32_t *items = sph__triangles_of(c, w);
    size_t vanished = 0;
    sph_status status = SPH_OK;
    list->count = 0;
    for (uint32_t i = 0; i < count; ++i)
        if (rename_corner(c, items[i], u, v, w))
            sph__list_put(&c->lists, list, items[i]);
        else
            c->keys[vanished++].item = items[i];
    for (uint32_t i = 0; i < sph__triangle_count_of(c, v) && status == SPH_OK; ++i) {
        const uint32_t t = sph__triangles_of(c, v)[i];
        if (rename_corner(c, t, v, u, w)) status = sph__list_add(&c->lists, list, t);
    }
    sph__list_drop(&c->lists, &c->nodes[v].triangles);
    while (vanished-- > 0) unlist_triangle(c, (uint32_t)c->keys[vanished].item, u, v);
    return status;
}

/* Triangles of the same corners came from u and from v, so their other corners were neighbours of both. */
static bool may_be_double(const sph__connectivity *c, uint32_t w)
{
    const uint32_t *items = sph__triangles_of(c, w), shared = w | SPH__SHARED;
    bool any = false;
    for (uint32_t i = 0; i < sph__triangle_count_of(c, w); ++i) {
        uint32_t x[2];
        sph__triangle_others(c, items[i], w, x);
        any |= c->nodes[x[0]].mark == shared && c->nodes[x[1]].mark == shared;
    }
    return any;
}

/* Of triangles of w with the same other corners the first stays; they come to be in order. */
static void unite_triangles(sph__connectivity *c, uint32_t w)
{
    const uint32_t count = sph__triangle_count_of(c, w);
    uint32_t *items = sph__triangles_of(c, w), kept = 0;
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t others[2];
        sph__triangle_others(c, items[i], w, others);
        c->keys[i] = (sph__keyed){c->two_sided ? (uint64_t)others[0] << 32 | others[1] : edge_key(others[0], others[1]),
                                  items[i]};
    }
    sph__sort(c->keys, count);
    for (uint32_t i = 0; i < count; ++i)
        if (i == 0 || c->keys[i].key != c->keys[i - 1].key)
            items[kept++] = (uint32_t)c->keys[i].item;
        else
            unlist_triangle(c, (uint32_t)c->keys[i].item, w, w);
    c->nodes[w].triangles.count = kept;
}

sph_status sph__connectivity_collapse(sph__connectivity *c, uint32_t u, uint32_t v, uint32_t w)
{
    sph_status status = take_lists(c, u, v, w);
    if (status == SPH_OK) status = move_edges(c, u, v, w);
    if (status == SPH_OK) status = move_triangles(c, u, v, w);
    if (status != SPH_OK) return status;
    unlist_edges(c, w);
    if (c->two_sided || may_be_double(c, w)) unite_triangles(c, w);
    return SPH_OK;
}
