/* SPDX-License-Identifier: MIT */
/*
 * The cursor: the simplices that are alive, kept as lists that change a little with every collapse. A simplex is named by its place in
 * the hierarchy's records; what a collapse ends is listed once, when the cursor is made.
 */
#include "hierarchy/simplices.h"

/* A set of places out of a fixed range: members side by side, and where each is. */
typedef struct place_set {
    uint32_t *members;
    uint32_t *where; /* per place; ABSENT */
    uint32_t count;
} place_set;

#define ABSENT UINT32_MAX

struct sph_cursor {
    sph__collapses h;
    uint32_t end; /* nodes alive are below */
    uint32_t edge_total, triangle_total;
    uint32_t *edge_young, *triangle_young; /* per place: the youngest vertex */
    uint32_t *edge_deaths, *triangle_deaths; /* places by the collapse that ends them */
    size_t *edge_death_starts, *triangle_death_starts; /* [C + 1] */
    uint32_t *edge_triangles; /* per edge: its triangles that are alive */
    place_set nodes, wires, triangles;
};

static void insert(place_set *set, uint32_t place)
{
    set->where[place] = set->count;
    set->members[set->count++] = place;
}

static void erase(place_set *set, uint32_t place)
{
    const uint32_t at = set->where[place], last = set->members[--set->count];
    set->members[at] = last;
    set->where[last] = at;
    set->where[place] = ABSENT;
}

static sph_status make_set(const sph_context *context, place_set *set, size_t range)
{
    set->members = sph__alloc(context, range, sizeof *set->members);
    set->where = sph__alloc(context, range, sizeof *set->where);
    if (set->members == NULL || set->where == NULL) return sph__fail_memory(context);
    memset(set->where, 0xff, range * sizeof *set->where);
    return SPH_OK;
}

/* The collapse that ends a node; C for roots. */
static uint32_t death_of(const sph__collapses *h, uint32_t node)
{
    return h->parents[node] == SPH__NO_NODE ? h->collapse_count : h->parents[node] - h->vertex_count;
}

static uint32_t earlier(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static uint32_t edge_death(const sph_cursor *c, size_t e)
{
    return earlier(death_of(&c->h, c->edge_young[e]), death_of(&c->h, c->h.edge_others[e]));
}

static uint32_t triangle_death(const sph_cursor *c, size_t t)
{
    const uint32_t *others = c->h.triangle_others + 2 * t;
    return earlier(death_of(&c->h, c->triangle_young[t]),
                   earlier(death_of(&c->h, others[0]), death_of(&c->h, others[1])));
}

/* Groups places by their death: counting sort, in the order of places. */
static sph_status group_deaths(const sph_cursor *c, uint32_t total, uint32_t (*death)(const sph_cursor *, size_t),
                               uint32_t **places, size_t **starts)
{
    const uint32_t groups = c->h.collapse_count + 1; /* the last never die */
    size_t sum = 0;
    *places = sph__alloc(c->h.context, total, sizeof **places);
    *starts = sph__zalloc(c->h.context, (size_t)groups + 1, sizeof **starts);
    if (*places == NULL || *starts == NULL) return sph__fail_memory(c->h.context);
    for (size_t i = 0; i < total; ++i) ++(*starts)[death(c, i) + 1];
    for (uint32_t g = 0; g < groups; ++g) {
        const size_t count = (*starts)[g + 1];
        (*starts)[g + 1] = sum;
        sum += count;
    }
    for (size_t i = 0; i < total; ++i) (*places)[(*starts)[death(c, i) + 1]++] = (uint32_t)i;
    return SPH_OK;
}

static sph_status name_young(const sph_context *context, const size_t *starts, uint32_t node_count, uint32_t **young)
{
    *young = sph__alloc(context, starts[node_count], sizeof **young);
    if (*young == NULL) return sph__fail_memory(context);
    for (uint32_t node = 0; node < node_count; ++node)
        for (size_t i = starts[node]; i < starts[node + 1]; ++i) (*young)[i] = node;
    return SPH_OK;
}

static void triangle_edges(const sph_cursor *c, size_t t, uint32_t edges[3])
{
    const uint32_t young = c->triangle_young[t], x = c->h.triangle_others[2 * t], y = c->h.triangle_others[2 * t + 1];
    edges[0] = (uint32_t)sph__collapses_find_edge(&c->h, young, x);
    edges[1] = (uint32_t)sph__collapses_find_edge(&c->h, young, y);
    edges[2] = (uint32_t)sph__collapses_find_edge(&c->h, x > y ? x : y, x > y ? y : x);
}

static void add_edge(sph_cursor *c, uint32_t e)
{
    c->edge_triangles[e] = 0;
    insert(&c->wires, e);
}

static void remove_edge(sph_cursor *c, uint32_t e)
{
    if (c->wires.where[e] != ABSENT) erase(&c->wires, e);
}

static void add_triangle(sph_cursor *c, uint32_t t)
{
    uint32_t edges[3];
    triangle_edges(c, t, edges);
    insert(&c->triangles, t);
    for (unsigned k = 0; k < 3; ++k)
        if (c->edge_triangles[edges[k]]++ == 0) erase(&c->wires, edges[k]);
}

static void remove_triangle(sph_cursor *c, uint32_t t)
{
    uint32_t edges[3];
    triangle_edges(c, t, edges);
    erase(&c->triangles, t);
    for (unsigned k = 0; k < 3; ++k)
        if (--c->edge_triangles[edges[k]] == 0) insert(&c->wires, edges[k]);
}

static void collapse(sph_cursor *c)
{
    const sph__collapses *h = &c->h;
    const uint32_t w = c->end++, t = w - h->vertex_count;
    for (size_t i = c->triangle_death_starts[t]; i < c->triangle_death_starts[t + 1]; ++i)
        remove_triangle(c, c->triangle_deaths[i]);
    for (size_t i = c->edge_death_starts[t]; i < c->edge_death_starts[t + 1]; ++i) remove_edge(c, c->edge_deaths[i]);
    for (unsigned k = 0; k < 2; ++k) erase(&c->nodes, h->children[2 * (size_t)t + k]);
    insert(&c->nodes, w);
    for (size_t i = h->edge_starts[w]; i < h->edge_starts[w + 1]; ++i) add_edge(c, (uint32_t)i);
    for (size_t i = h->triangle_starts[w]; i < h->triangle_starts[w + 1]; ++i) add_triangle(c, (uint32_t)i);
}

static void split(sph_cursor *c)
{
    const sph__collapses *h = &c->h;
    const uint32_t w = --c->end, t = w - h->vertex_count;
    for (size_t i = h->triangle_starts[w]; i < h->triangle_starts[w + 1]; ++i) remove_triangle(c, (uint32_t)i);
    for (size_t i = h->edge_starts[w]; i < h->edge_starts[w + 1]; ++i) remove_edge(c, (uint32_t)i);
    erase(&c->nodes, w);
    for (unsigned k = 0; k < 2; ++k) insert(&c->nodes, h->children[2 * (size_t)t + k]);
    for (size_t i = c->edge_death_starts[t]; i < c->edge_death_starts[t + 1]; ++i) add_edge(c, c->edge_deaths[i]);
    for (size_t i = c->triangle_death_starts[t]; i < c->triangle_death_starts[t + 1]; ++i)
        add_triangle(c, c->triangle_deaths[i]);
}

static sph_status make_tables(sph_cursor *c)
{
    const sph__collapses *h = &c->h;
    const uint32_t nodes = sph__collapses_node_count(h);
    sph_status status;
    if (h->edge_starts[nodes] >= ABSENT || h->triangle_starts[nodes] >= ABSENT)
        return sph__fail(h->context, SPH_E_LIMIT, "more than 2^32 - 2 simplices in all levels");
    c->edge_total = (uint32_t)h->edge_starts[nodes];
    c->triangle_total = (uint32_t)h->triangle_starts[nodes];
    status = name_young(h->context, h->edge_starts, nodes, &c->edge_young);
    if (status == SPH_OK) status = name_young(h->context, h->triangle_starts, nodes, &c->triangle_young);
    if (status == SPH_OK) status = group_deaths(c, c->edge_total, edge_death, &c->edge_deaths, &c->edge_death_starts);
    if (status == SPH_OK)
        status = group_deaths(c, c->triangle_total, triangle_death, &c->triangle_deaths, &c->triangle_death_starts);
    if (status == SPH_OK) status = make_set(h->context, &c->nodes, nodes);
    if (status == SPH_OK) status = make_set(h->context, &c->wires, c->edge_total);
    if (status == SPH_OK) status = make_set(h->context, &c->triangles, c->triangle_total);
    if (status != SPH_OK) return status;
    c->edge_triangles = sph__zalloc(h->context, c->edge_total, sizeof *c->edge_triangles);
    return c->edge_triangles == NULL ? sph__fail_memory(h->context) : SPH_OK;
}

sph_status sph__cursor_create(const sph__collapses *h, sph_cursor **out)
{
    sph_cursor *c;
    sph_status status;
    *out = NULL;
    c = sph__new(h->context, sizeof *c, SPH__CURSOR);
    if (c == NULL) return sph__fail_memory(h->context);
    c->h = *h;
    status = make_tables(c);
    if (status != SPH_OK) {
        sph_cursor_destroy(c);
        return status;
    }
    c->end = h->vertex_count;
    for (uint32_t v = 0; v < h->vertex_count; ++v) insert(&c->nodes, v);
    for (size_t e = 0; e < h->edge_starts[h->vertex_count]; ++e) add_edge(c, (uint32_t)e);
    for (size_t t = 0; t < h->triangle_starts[h->vertex_count]; ++t) add_triangle(c, (uint32_t)t);
    *out = c;
    return SPH_OK;
}

void sph_cursor_destroy(sph_cursor *c)
{
    SPH__OWN(c, SPH__CURSOR);
    const sph_context *context;
    if (c == NULL) return;
    context = c->h.context;
    sph__free(context, c->edge_young);
    sph__free(context, c->triangle_young);
    sph__free(context, c->edge_deaths);
    sph__free(context, c->triangle_deaths);
    sph__free(context, c->edge_death_starts);
    sph__free(context, c->triangle_death_starts);
    sph__free(context, c->edge_triangles);
    for (unsigned k = 0; k < 3; ++k) {
        place_set *set = k == 0 ? &c->nodes : k == 1 ? &c->wires : &c->triangles;
        sph__free(context, set->members);
        sph__free(context, set->where);
    }
    sph__free(context, c);
}

sph_status sph_cursor_move(sph_cursor *c, uint32_t sphere_count)
{
    SPH__OWN(c, SPH__CURSOR);
    uint32_t end;
    if (c == NULL) return SPH_E_INVALID;
    if (sphere_count > c->h.vertex_count || sphere_count < c->h.vertex_count - c->h.collapse_count)
        return sph__fail(c->h.context, SPH_E_INVALID, "%u spheres: the hierarchy has levels from %u to %u",
                         sphere_count, c->h.vertex_count - c->h.collapse_count, c->h.vertex_count);
    end = c->h.vertex_count + (c->h.vertex_count - sphere_count);
    while (c->end < end) collapse(c);
    while (c->end > end) split(c);
    return SPH_OK;
}

uint32_t sph_cursor_sphere_count(const sph_cursor *c)
{
    SPH__OWN(c, SPH__CURSOR);
    return c == NULL ? 0 : c->nodes.count;
}

size_t sph_cursor_edge_count(const sph_cursor *c)
{
    SPH__OWN(c, SPH__CURSOR);
    return c == NULL ? 0 : c->wires.count;
}

size_t sph_cursor_triangle_count(const sph_cursor *c)
{
    SPH__OWN(c, SPH__CURSOR);
    return c == NULL ? 0 : c->triangles.count;
}

static void read_nodes(const sph_cursor *c, uint32_t *nodes, sph__keyed *keys)
{
    for (uint32_t i = 0; i < c->nodes.count; ++i) keys[i] = (sph__keyed){c->nodes.members[i], 0};
    sph__sort(keys, c->nodes.count);
    for (uint32_t i = 0; i < c->nodes.count; ++i) nodes[i] = (uint32_t)keys[i].key;
}

sph_status sph_cursor_read(const sph_cursor *c, uint32_t *nodes, uint32_t *edges, uint32_t *triangles)
{
    SPH__OWN(c, SPH__CURSOR);
    size_t most;
    sph__keyed *keys;
    if (c == NULL) return SPH_E_INVALID;
    most = c->nodes.count > c->wires.count ? c->nodes.count : c->wires.count;
    most = most > c->triangles.count ? most : c->triangles.count;
    keys = sph__alloc(c->h.context, most, sizeof *keys);
    if (keys == NULL) return sph__fail_memory(c->h.context);
    if (nodes != NULL) read_nodes(c, nodes, keys);
    for (uint32_t i = 0; i < c->wires.count && edges != NULL; ++i) {
        edges[2 * (size_t)i] = c->h.edge_others[c->wires.members[i]];
        edges[2 * (size_t)i + 1] = c->edge_young[c->wires.members[i]];
    }
    for (uint32_t i = 0; i < c->triangles.count && triangles != NULL; ++i) {
        const size_t t = c->triangles.members[i];
        triangles[3 * (size_t)i] = c->triangle_young[t];
        triangles[3 * (size_t)i + 1] = c->h.triangle_others[2 * t];
        triangles[3 * (size_t)i + 2] = c->h.triangle_others[2 * t + 1];
    }
    if (edges != NULL) sph__order_edges(edges, c->wires.count, keys);
    if (triangles != NULL) sph__order_triangles(triangles, c->triangles.count, keys);
    sph__free(c->h.context, keys);
    return SPH_OK;
}
