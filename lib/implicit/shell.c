/* SPDX-License-Identifier: MIT */
#include "implicit/shell.h"

#include <math.h>

#include "implicit/implicit.h"
#include "numeric/vector.h"

void sph__shell_free(sph__shell *s)
{
    sph__free(s->context, s->nodes);
    sph__free(s->context, s->vertices);
    sph__free(s->context, s->parts);
    sph__free(s->context, s->rest);
    sph__free(s->context, s->triangles);
    sph__free(s->context, s->normals);
    sph__free(s->context, s->starts);
    sph__free(s->context, s->ring);
    sph__free(s->context, s->shares);
}

/* --- welding --- */

static uint64_t mix(uint64_t hash, const void *bytes, size_t size)
{
    uint32_t word;
    for (size_t i = 0; i + sizeof word <= size; i += sizeof word) {
        memcpy(&word, (const char *)bytes + i, sizeof word);
        hash = (hash ^ word) * UINT64_C(0x9e3779b97f4a7c15);
        hash ^= hash >> 29;
    }
    return hash;
}

static bool is_same(const sph_skin *skin, size_t a, size_t b)
{
    const size_t k = skin->influence_count;
    const float *p = skin->rest + 3 * a, *q = skin->rest + 3 * b;
    return p[0] == q[0] && p[1] == q[1] && p[2] == q[2] &&
           memcmp(skin->bones + k * a, skin->bones + k * b, k * sizeof *skin->bones) == 0 &&
           memcmp(skin->weights + k * a, skin->weights + k * b, k * sizeof *skin->weights) == 0;
}

static uint64_t hash_vertex(const sph_skin *skin, size_t v)
{
    const size_t k = skin->influence_count;
    const float p[3] = {skin->rest[3 * v] + 0.0f, skin->rest[3 * v + 1] + 0.0f, skin->rest[3 * v + 2] + 0.0f};
    uint64_t hash = mix(0, p, sizeof p); /* -0 has become 0 */
    hash = mix(hash, skin->bones + k * v, k * sizeof *skin->bones);
    return mix(hash, skin->weights + k * v, k * sizeof *skin->weights);
}

/* The lowest vertex like each, into `leaders`. Of equal hashes the lowest vertex comes first. */
static void find_leaders(const sph_skin *skin, sph__keyed *keys, uint32_t *leaders)
{
    const size_t n = skin->vertex_count;
    size_t first = 0;
    for (size_t v = 0; v < n; ++v)
        keys[v] = (sph__keyed){hash_vertex(skin, v), v};
    sph__sort(keys, n);
    for (size_t i = 0; i < n; ++i) {
        if (keys[i].key != keys[first].key) first = i;
        leaders[keys[i].item] = (uint32_t)keys[is_same(skin, keys[first].item, keys[i].item) ? first : i].item;
    }
}

/* --- order --- */

static uint64_t spread(uint64_t x)
{
    x &= 0x3ff; /* 10 bits, two zeros between each */
    x = (x | x << 16) & UINT64_C(0x30000ff);
    x = (x | x << 8) & UINT64_C(0x300f00f);
    x = (x | x << 4) & UINT64_C(0x30c30c3);
    return (x | x << 2) & UINT64_C(0x9249249);
}

/* Along a curve through cells of the box, within each part. */
static void order_nodes(sph__shell *s, const sph_skin *skin, const uint32_t *parts, sph__keyed *keys,
                        const uint32_t *leaders)
{
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    double box[3];
    for (size_t i = 0; i < 3 * (size_t)skin->vertex_count; ++i) {
        low[i % 3] = fminf(low[i % 3], skin->rest[i]);
        high[i % 3] = fmaxf(high[i % 3], skin->rest[i]);
    }
    for (int c = 0; c < 3; ++c)
        box[c] = (double)high[c] - (double)low[c];
    s->diagonal = sph__norm(box);
    s->node_count = 0;
    for (size_t v = 0; v < skin->vertex_count; ++v) {
        const uint32_t part = parts != NULL ? parts[v] : skin->bones[v * skin->influence_count];
        uint64_t code = 0;
        if (leaders[v] != v) continue;
        for (int c = 0; c < 3; ++c) {
            const double u = box[c] > 0 ? ((double)skin->rest[3 * v + c] - (double)low[c]) / box[c] : 0;
            code |= spread((uint64_t)(u * 1023)) << c;
        }
        keys[s->node_count++] = (sph__keyed){(uint64_t)part << 32 | code, v};
    }
    sph__sort(keys, s->node_count);
}

static void fill_nodes(sph__shell *s, const sph_skin *skin, const sph__keyed *keys, const uint32_t *leaders)
{
    for (uint32_t i = 0; i < s->node_count; ++i) {
        const size_t v = keys[i].item;
        s->vertices[i] = (uint32_t)v;
        s->parts[i] = (uint32_t)(keys[i].key >> 32);
        s->nodes[v] = i;
        for (int c = 0; c < 3; ++c)
            s->rest[3 * (size_t)i + c] = skin->rest[3 * v + c] + 0.0f;
    }
    for (size_t v = 0; v < skin->vertex_count; ++v)
        s->nodes[v] = s->nodes[leaders[v]];
}

static sph_status make_nodes(sph__shell *s, const sph_skin *skin, const uint32_t *parts)
{
    const size_t n = skin->vertex_count;
    sph__keyed *keys = sph__alloc(s->context, n, sizeof *keys);
    uint32_t *leaders = sph__alloc(s->context, n, sizeof *leaders);
    s->nodes = sph__alloc(s->context, n, sizeof *s->nodes);
    s->vertices = sph__alloc(s->context, n, sizeof *s->vertices);
    s->parts = sph__alloc(s->context, n, sizeof *s->parts);
    s->rest = sph__alloc(s->context, n, 3 * sizeof *s->rest);
    if (keys != NULL && leaders != NULL && s->nodes != NULL && s->vertices != NULL && s->parts != NULL &&
        s->rest != NULL) {
        find_leaders(skin, keys, leaders);
        order_nodes(s, skin, parts, keys, leaders);
        fill_nodes(s, skin, keys, leaders);
    }
    sph__free(s->context, keys);
    sph__free(s->context, leaders);
    return keys == NULL || leaders == NULL || s->nodes == NULL || s->vertices == NULL || s->parts == NULL ||
                   s->rest == NULL
               ? sph__fail_memory(s->context)
               : SPH_OK;
}

/* --- triangles, rings, normals --- */

static void add_normal(sph__shell *s, const uint32_t *corner)
{
    double p[3][3], u[3], v[3], area[3];
    for (int i = 0; i < 9; ++i)
        p[i / 3][i % 3] = (double)s->rest[3 * (size_t)corner[i / 3] + i % 3];
    sph__subtract(p[1], p[0], u);
    sph__subtract(p[2], p[0], v);
    sph__cross(u, v, area);
    for (int i = 0; i < 9; ++i)
        s->normals[3 * (size_t)corner[i / 3] + i % 3] += area[i % 3];
}

static sph_status make_triangles(sph__shell *s, const sph_skin *skin)
{
    s->triangles = sph__alloc(s->context, skin->triangle_count, 3 * sizeof *s->triangles);
    s->normals = sph__zalloc(s->context, s->node_count, 3 * sizeof *s->normals);
    if (s->triangles == NULL || s->normals == NULL) return sph__fail_memory(s->context);
    for (size_t t = 0; t < skin->triangle_count; ++t) {
        uint32_t *corner = s->triangles + 3 * s->triangle_count;
        for (int c = 0; c < 3; ++c)
            corner[c] = s->nodes[skin->triangles[3 * t + c]];
        if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) continue;
        add_normal(s, corner);
        ++s->triangle_count;
    }
    for (uint32_t i = 0; i < s->node_count; ++i) {
        double *normal = s->normals + 3 * (size_t)i;
        const double length = sph__norm(normal);
        for (int c = 0; c < 3; ++c)
            normal[c] = length > 0 && isfinite(length) ? normal[c] / length : 0;
    }
    return SPH_OK;
}

/* Both directions of all edges, sorted, each once. */
static sph_status make_rings(sph__shell *s)
{
    const size_t most = 6 * s->triangle_count; /* of indices that fit in memory three at a time, twice */
    sph__keyed *keys = sph__alloc(s->context, most, sizeof *keys);
    size_t count = 0;
    s->starts = sph__zalloc(s->context, (size_t)s->node_count + 1, sizeof *s->starts);
    if (keys == NULL || s->starts == NULL) {
        sph__free(s->context, keys);
        return sph__fail_memory(s->context);
    }
    for (size_t i = 0; i < 3 * s->triangle_count; ++i) {
        const uint64_t a = s->triangles[i], b = s->triangles[i % 3 == 2 ? i - 2 : i + 1];
        keys[2 * i] = (sph__keyed){a << 32 | b, 0};
        keys[2 * i + 1] = (sph__keyed){b << 32 | a, 0};
    }
    sph__sort(keys, most);
    for (size_t i = 0; i < most; ++i)
        if (i == 0 || keys[i].key != keys[i - 1].key) keys[count++].key = keys[i].key;
    s->ring = sph__alloc(s->context, count, sizeof *s->ring);
    for (size_t i = 0; i < count && s->ring != NULL; ++i) {
        ++s->starts[(keys[i].key >> 32) + 1];
        s->ring[i] = (uint32_t)keys[i].key;
    }
    for (size_t i = 0; i < s->node_count; ++i)
        s->starts[i + 1] += s->starts[i];
    sph__free(s->context, keys);
    return s->ring == NULL ? sph__fail_memory(s->context) : SPH_OK;
}

sph_status sph__shell_init(sph__shell *shell, const sph_skin *skin, const uint32_t *parts)
{
    size_t bytes;
    sph_status status;
    *shell = (sph__shell){.context = skin->context, .vertex_count = skin->vertex_count};
    if (skin->triangle_count == 0) return sph__fail(skin->context, SPH_E_STATE, "the skin has no triangles");
    if (!sph__multiply_size(skin->triangle_count, 6 * sizeof(sph__keyed), &bytes))
        return sph__fail_memory(skin->context);
    status = make_nodes(shell, skin, parts);
    if (status == SPH_OK) status = make_triangles(shell, skin);
    if (status == SPH_OK) status = make_rings(shell);
    return status;
}
