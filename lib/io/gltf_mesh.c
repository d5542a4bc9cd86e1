/* SPDX-License-Identifier: MIT */
/* The meshes of the scene, joined: triangles and edges, and the vertices that they use. */
#include <string.h>

#include "io/gltf.h"

enum { POINTS, LINES, LINE_LOOP, LINE_STRIP, TRIANGLES, TRIANGLE_STRIP, TRIANGLE_FAN, MODE_COUNT };
enum { VERTEX_LIMIT = INT32_MAX };

/* A primitive of a mesh at a node, while it is read. */
typedef struct part {
    sph__gltf_document *d;
    sph__io_gltf *g;
    sph__io_mesh *mesh;
    const sph__gltf_node *node;
    uint32_t primitive; /* in the JSON */
    uint64_t mode;
    sph__gltf_accessor positions;
    uint32_t *corners; /* vertices of the primitive as its mode takes them */
    size_t corner_count;
    uint32_t *places; /* of a vertex of the primitive among those that are used */
    uint32_t *used;
    size_t used_count;
} part;

static sph_status read_corners(part *p)
{
    sph__gltf_document *d = p->d;
    sph__gltf_accessor a;
    uint32_t index;
    sph_status status = sph__gltf_get_index(d, p->primitive, "indices", SPH__GLTF_ACCESSORS, &index);
    if (status != SPH_OK) return status;
    if (index == SPH__GLTF_NONE) {
        p->corner_count = p->positions.count;
        if ((status = sph__gltf_allocate(d, p->corner_count, sizeof(uint32_t), &p->corners)) != SPH_OK) return status;
        for (size_t i = 0; i < p->corner_count; ++i)
            p->corners[i] = (uint32_t)i;
        return SPH_OK;
    }
    if ((status = sph__gltf_accessor_open(d, index, 1, &a)) != SPH_OK) return status;
    if (a.type != SPH__GLTF_U8 && a.type != SPH__GLTF_U16 && a.type != SPH__GLTF_U32)
        return sph__gltf_fail(d, a.value, "indices of type %d", a.type);
    p->corner_count = a.count;
    if ((status = sph__gltf_allocate(d, p->corner_count, sizeof(uint32_t), &p->corners)) != SPH_OK) return status;
    for (uint32_t i = 0; i < a.count; ++i) {
        sph__gltf_accessor_integers(&a, i, &p->corners[i]);
        if (p->corners[i] >= p->positions.count)
            return sph__gltf_fail(d, a.value, "index %u is vertex %u, but there are %u", (unsigned)i,
                                  (unsigned)p->corners[i], (unsigned)p->positions.count);
    }
    return SPH_OK;
}

/* How many of the corners make whole triangles or lines. */
static size_t whole_corners(const part *p)
{
    const size_t n = p->corner_count;
    if (p->mode == TRIANGLES) return n - n % 3;
    if (p->mode == LINES) return n - n % 2;
    return n < (p->mode > TRIANGLES ? 3u : 2u) ? 0 : n;
}

/* Finds the vertices that are used, in their order, and gives the corners their places. */
static sph_status compact(part *p)
{
    const uint32_t first = (uint32_t)p->g->vertex_count;
    sph_status status = sph__gltf_allocate(p->d, p->positions.count, sizeof(uint32_t), &p->places);
    size_t next = 0;
    if (status != SPH_OK) return status;
    memset(p->places, 0, p->positions.count * sizeof(uint32_t));
    p->corner_count = whole_corners(p);
    for (size_t i = 0; i < p->corner_count; ++i) {
        p->used_count += p->places[p->corners[i]] == 0;
        p->places[p->corners[i]] = 1;
    }
    if (p->used_count > VERTEX_LIMIT - p->g->vertex_count)
        return sph__io_fail(p->d->context, SPH_E_LIMIT, "%s: more than 2^31 - 1 vertices", sph__io_shown(p->d->path));
    if ((status = sph__gltf_allocate(p->d, p->used_count, sizeof(uint32_t), &p->used)) != SPH_OK) return status;
    for (uint32_t v = 0; v < p->positions.count; ++v)
        if (p->places[v] != 0) {
            p->places[v] = first + (uint32_t)next;
            p->used[next++] = v;
        }
    for (size_t i = 0; i < p->corner_count; ++i)
        p->corners[i] = p->places[p->corners[i]];
    return SPH_OK;
}

static sph_status add_positions(part *p)
{
    sph__io_mesh *mesh = p->mesh;
    sph_status status = SPH_OK;
    for (size_t i = 0; i < p->used_count && status == SPH_OK; ++i) {
        status = sph__gltf_push(p->d, &mesh->positions, &mesh->vertex_capacity, mesh->vertex_count, 3 * sizeof(float));
        if (status == SPH_OK)
            sph__gltf_accessor_floats(&p->positions, p->used[i], mesh->positions + 3 * mesh->vertex_count++);
    }
    return status;
}

static sph_status add_edge(part *p, uint32_t a, uint32_t b)
{
    sph__io_mesh *mesh = p->mesh;
    sph_status status =
        sph__gltf_push(p->d, &mesh->edges, &mesh->edge_capacity, mesh->edge_count, 2 * sizeof(uint32_t));
    if (status != SPH_OK) return status;
    mesh->edges[2 * mesh->edge_count] = a;
    mesh->edges[2 * mesh->edge_count++ + 1] = b;
    return SPH_OK;
}

static sph_status add_triangle(part *p, uint32_t a, uint32_t b, uint32_t c)
{
    sph__io_mesh *mesh = p->mesh;
    uint32_t *triangle;
    sph_status status =
        sph__gltf_push(p->d, &mesh->triangles, &mesh->triangle_capacity, mesh->triangle_count, 3 * sizeof(uint32_t));
    if (status != SPH_OK) return status;
    triangle = mesh->triangles + 3 * mesh->triangle_count++;
    triangle[0] = a;
    triangle[1] = b;
    triangle[2] = c;
    return SPH_OK;
}

/* Strips have triangles without area where they turn a corner: these are left out. */
static sph_status add_strip_triangle(part *p, const uint32_t *c, bool odd)
{
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) return SPH_OK;
    return odd ? add_triangle(p, c[1], c[0], c[2]) : add_triangle(p, c[0], c[1], c[2]);
}

static sph_status add_simplices(part *p)
{
    const uint32_t *c = p->corners;
    const size_t n = p->corner_count;
    sph_status status = SPH_OK;
    if (p->mode == LINES || p->mode == LINE_STRIP || p->mode == LINE_LOOP) {
        for (size_t i = 0; i + 1 < n && status == SPH_OK; i += p->mode == LINES ? 2 : 1)
            status = add_edge(p, c[i], c[i + 1]);
        return status == SPH_OK && p->mode == LINE_LOOP && n > 2 ? add_edge(p, c[n - 1], c[0]) : status;
    }
    for (size_t i = 0; i + 2 < n && status == SPH_OK; i += p->mode == TRIANGLES ? 3 : 1)
        if (p->mode == TRIANGLES)
            status = add_triangle(p, c[i], c[i + 1], c[i + 2]);
        else if (p->mode == TRIANGLE_STRIP)
            status = add_strip_triangle(p, c + i, i % 2 == 1);
        else
            status = add_triangle(p, c[0], c[i + 1], c[i + 2]);
    return status;
}

/* Whether what moves the vertices of a part mirrors most of them at rest. */
static bool is_mirrored(const sph__io_gltf *g, size_t first, size_t end)
{
    double sum = 0;
    for (size_t i = g->first_influence[first]; i < g->first_influence[end]; ++i) {
        const double d = sph__io_determinant(g->palette[g->influences[i].bone].m);
        sum += d < 0 ? -(double)g->influences[i].weight : d > 0 ? (double)g->influences[i].weight : 0;
    }
    return sum < 0;
}

/* Mirrored triangles are wound the other way round. */
static sph_status turn_mirrored(sph__gltf_document *d, sph__io_gltf *g, sph__io_mesh *mesh)
{
    const sph_status status = sph__gltf_allocate(d, g->bone_count, sizeof *g->palette, &g->palette);
    if (status != SPH_OK) return status;
    sph__gltf_pose(g, NULL, 0);
    for (size_t k = 0; k < g->part_count; ++k) {
        const bool last = k + 1 == g->part_count;
        const size_t end = last ? mesh->triangle_count : g->parts[k + 1].first_triangle;
        if (!is_mirrored(g, g->parts[k].first_vertex, last ? g->vertex_count : g->parts[k + 1].first_vertex)) continue;
        g->parts[k].mirrored = true;
        for (size_t i = g->parts[k].first_triangle; i < end; ++i) {
            const uint32_t b = mesh->triangles[3 * i + 1];
            mesh->triangles[3 * i + 1] = mesh->triangles[3 * i + 2];
            mesh->triangles[3 * i + 2] = b;
        }
    }
    return SPH_OK;
}

static sph_status add_part(part *p)
{
    sph__io_gltf *g = p->g;
    const size_t first = g->vertex_count;
    const uint32_t count = p->positions.count, *used;
    sph_status status = read_corners(p);
    if (status == SPH_OK) status = compact(p);
    if (status != SPH_OK || p->used_count == 0) return status;
    if ((status = add_positions(p)) != SPH_OK) return status;
    status = sph__gltf_push(p->d, &g->parts, &g->part_capacity, g->part_count, sizeof *g->parts);
    if (status != SPH_OK) return status;
    g->parts[g->part_count++] = (sph__gltf_part){.first_vertex = first,
                                                 .first_triangle = p->mesh->triangle_count,
                                                 .node = (uint32_t)(p->node - g->nodes),
                                                 .primitive = p->primitive,
                                                 .used = p->used,
                                                 .used_count = p->used_count};
    p->used = NULL; /* the scene has it now */
    used = g->parts[g->part_count - 1].used;
    g->vertex_count = p->mesh->vertex_count;
    status = add_simplices(p);
    if (status == SPH_OK)
        status = sph__gltf_read_influences(p->d, g, p->primitive, p->node, used, p->used_count, count);
    if (status == SPH_OK)
        status = sph__gltf_read_targets(p->d, g, p->primitive, p->node, used, p->used_count, count, first);
    return status;
}

static sph_status read_primitive(part *p)
{
    sph__gltf_document *d = p->d;
    uint32_t attributes, index;
    sph_status status = sph__gltf_get_unsigned(d, p->primitive, "mode", &p->mode);
    if (status == SPH_OK) status = sph__gltf_get_kind(d, p->primitive, "attributes", '{', &attributes);
    if (status != SPH_OK) return status;
    if (p->mode >= MODE_COUNT || attributes == 0)
        return sph__gltf_fail(d, p->primitive, "a primitive without attributes, or of mode %llu",
                              (unsigned long long)p->mode);
    status = sph__gltf_get_index(d, attributes, "POSITION", SPH__GLTF_ACCESSORS, &index);
    if (status != SPH_OK) return status;
    if (p->mode == POINTS || index == SPH__GLTF_NONE) {
        sph_context_log(d->context, SPH_LOG_WARNING, "a glTF has points, or a mesh without positions: left out");
        return SPH_OK;
    }
    if ((status = sph__gltf_accessor_open(d, index, 3, &p->positions)) != SPH_OK) return status;
    status = add_part(p);
    sph_context_release(d->context, p->corners);
    sph_context_release(d->context, p->places);
    sph_context_release(d->context, p->used);
    return status;
}

sph_status sph__gltf_read_meshes(sph__gltf_document *d, sph__io_gltf *g, sph__io_mesh *mesh)
{
    sph_status status = sph__gltf_push(d, &g->first_influence, &g->first_influence_capacity, 0, sizeof(size_t));
    if (status != SPH_OK) return status;
    g->first_influence[0] = 0;
    for (uint32_t i = 0; i < g->drawn_count && status == SPH_OK; ++i) {
        const sph__gltf_node *node = &g->nodes[g->drawn[i]];
        const uint32_t object = d->lists[SPH__GLTF_MESHES].values[node->mesh];
        uint32_t array, value;
        if ((status = sph__gltf_get_kind(d, object, "primitives", '[', &array)) != SPH_OK) return status;
        if (array == 0) return sph__gltf_fail(d, object, "mesh %u has no primitives", (unsigned)node->mesh);
        value = array + 1;
        for (uint32_t k = 0; k < d->values[array].count && status == SPH_OK; ++k, value = d->values[value].next) {
            part p = {.d = d, .g = g, .mesh = mesh, .node = node, .primitive = value, .mode = TRIANGLES};
            status = read_primitive(&p);
        }
    }
    if (status == SPH_OK && mesh->vertex_count == 0)
        status = sph__io_fail(d->context, SPH_E_FORMAT, "%s: its scene has no triangles", sph__io_shown(d->path));
    return status == SPH_OK ? turn_mirrored(d, g, mesh) : status;
}
