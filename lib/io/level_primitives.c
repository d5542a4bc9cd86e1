/* SPDX-License-Identifier: MIT */
/* Levels as primitives in JSON, and as medial meshes. */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "io/level_export.h"

enum { PRIMITIVES_VERSION = 1 };

void sph__io_export_double(sph__io_output *o, double value)
{
    char text[40];
    snprintf(text, sizeof text, "%.17g", value);
    for (char *p = text; *p != '\0'; ++p)
        if (*p == ',') *p = '.'; /* whatever the locale */
    sph__io_output_text(o, "%s", text);
}

void sph__io_export_notes(sph__io_output *o, const sph__io_export *e, const char *before, const char *after)
{
    sph__io_output_text(o, "%sa sphere-mesh of %u spheres, frame %u%s", before, (unsigned)e->a.sphere_count,
                        (unsigned)e->first_frame, after);
    if (e->coverage == NULL) return;
    if (e->coverage->uncovered_count == 0) {
        sph__io_output_text(o, "%sthe sphere-mesh contains every vertex of its mesh in every frame%s", before, after);
        return;
    }
    sph__io_output_text(o, "%sthe largest uncovered distance of its mesh over all frames is ", before);
    sph__io_export_double(o, e->coverage->distance);
    sph__io_output_text(o, ", in frame %u at vertex %u%s", (unsigned)e->coverage->frame,
                        (unsigned)e->coverage->vertex, after);
}

bool sph__io_export_is_flat(const uint32_t *simplex, uint32_t corners)
{
    return corners == 2 ? simplex[0] == simplex[1]
                        : simplex[0] == simplex[1] || simplex[1] == simplex[2] || simplex[2] == simplex[0];
}

bool *sph__io_export_used(const sph__io_export *e)
{
    bool *used = sph_context_allocate(e->context, e->a.sphere_count, sizeof *used);
    if (used == NULL) return NULL;
    memset(used, 0, e->a.sphere_count * sizeof *used);
    for (size_t i = 0; i < 2 * e->a.edge_count; ++i)
        used[e->a.edges[i]] = true;
    for (size_t i = 0; i < 3 * e->a.triangle_count; ++i)
        used[e->a.triangles[i]] = true;
    return used;
}

static bool *used_or_fail(sph__io_output *o, const sph__io_export *e)
{
    bool *used = sph__io_export_used(e);
    if (used == NULL && o->status == SPH_OK) o->status = sph__io_fail_memory(e->context, o->target);
    return used;
}

/* --- JSON --- */

static void put_coverage(sph__io_output *o, const sph_coverage *c)
{
    if (c == NULL) {
        sph__io_output_text(o, "\"coverage\":null,\n");
        return;
    }
    sph__io_output_text(o, "\"coverage\":{\"contains_all_vertices\":%s,\"largest_uncovered_distance\":",
                        c->uncovered_count == 0 ? "true" : "false");
    sph__io_export_double(o, c->distance);
    sph__io_output_text(o, ",\"frame\":%u,\"vertex\":%u,\"uncovered\":%" PRIu64 "},\n", (unsigned)c->frame,
                        (unsigned)c->vertex, c->uncovered_count);
}

static void put_point(sph__io_output *o, const float *p)
{
    for (int k = 0; k < 3; ++k) {
        sph__io_output_text(o, k == 0 ? "[" : ",");
        sph__io_output_float(o, p[k]);
    }
    sph__io_output_text(o, "]");
}

/* {"spheres":[...],"centers":[...],"radii":[...]} */
static void put_simplex(sph__io_output *o, const sph__io_export *e, size_t frame, const uint32_t *simplex, size_t corners)
{
    const float *centers = e->a.centers + 3 * frame * e->a.sphere_count;
    const float *radii = e->a.radii + (e->a.radii_per_frame ? frame * e->a.sphere_count : 0);
    for (size_t k = 0; k < corners; ++k)
        sph__io_output_text(o, "%s%u", k == 0 ? "{\"spheres\":[" : ",", (unsigned)simplex[k]);
    sph__io_output_text(o, "],\"centers\":[");
    for (size_t k = 0; k < corners; ++k) {
        if (k > 0) sph__io_output_text(o, ",");
        put_point(o, centers + 3 * (size_t)simplex[k]);
    }
    for (size_t k = 0; k < corners; ++k) {
        sph__io_output_text(o, k == 0 ? "],\"radii\":[" : ",");
        sph__io_output_float(o, radii[simplex[k]]);
    }
    sph__io_output_text(o, "]}");
}

static void put_simplices(sph__io_output *o, const sph__io_export *e, size_t frame, const char *name,
                          const uint32_t *indices, size_t count, size_t corners)
{
    sph__io_output_text(o, ",\n\"%s\":[", name);
    for (size_t i = 0; i < count; ++i) {
        sph__io_output_text(o, i == 0 ? "\n" : ",\n");
        put_simplex(o, e, frame, indices + corners * i, corners);
    }
    sph__io_output_text(o, "]");
}

static void put_frame(sph__io_output *o, const sph__io_export *e, size_t frame, const bool *used)
{
    bool first = true;
    sph__io_output_text(o, "%s{\"frame\":%u,\n\"spheres\":[", frame == 0 ? "" : ",\n",
                        (unsigned)(e->first_frame + frame * e->frame_step));
    for (uint32_t i = 0; i < e->a.sphere_count; ++i) {
        if (used[i]) continue;
        sph__io_output_text(o, first ? "\n" : ",\n");
        put_simplex(o, e, frame, &i, 1);
        first = false;
    }
    sph__io_output_text(o, "]");
    put_simplices(o, e, frame, "capsules", e->a.edges, e->a.edge_count, 2);
    put_simplices(o, e, frame, "triangles", e->a.triangles, e->a.triangle_count, 3);
    sph__io_output_text(o, "}");
}

void sph__io_export_primitives(sph__io_output *o, sph__io_export *e)
{
    bool *used = used_or_fail(o, e);
    if (used == NULL) return;
    sph__io_output_text(o, "{\"format\":\"sphmesh-primitives\",\"version\":%d,\"frames\":%u,\"spheres\":%u,\n",
                        PRIMITIVES_VERSION, (unsigned)e->a.frame_count, (unsigned)e->a.sphere_count);
    put_coverage(o, e->coverage);
    sph__io_output_text(o, "\"poses\":[\n");
    for (size_t f = 0; f < e->a.frame_count; ++f)
        put_frame(o, e, f, used);
    sph__io_output_text(o, "]}\n");
    sph_context_release(e->context, used);
}

/* --- medial meshes --- */

static void sift_down(uint64_t *keys, size_t root, size_t count)
{
    for (size_t child; (child = 2 * root + 1) < count; root = child) {
        const uint64_t key = keys[root];
        if (child + 1 < count && keys[child] < keys[child + 1]) ++child;
        if (key >= keys[child]) return;
        keys[root] = keys[child];
        keys[child] = key;
    }
}

/* Ascending and each once; returns how many. */
static size_t sort_unique(uint64_t *keys, size_t count)
{
    size_t kept = 0;
    for (size_t i = count / 2; i-- > 0;)
        sift_down(keys, i, count);
    for (size_t end = count; end-- > 1;) {
        const uint64_t key = keys[end];
        keys[end] = keys[0];
        keys[0] = key;
        sift_down(keys, 0, end);
    }
    for (size_t i = 0; i < count; ++i)
        if (kept == 0 || keys[kept - 1] != keys[i]) keys[kept++] = keys[i];
    return kept;
}

static void add_edge(uint64_t *keys, size_t *count, uint32_t a, uint32_t b)
{
    if (a != b) keys[(*count)++] = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

/* All edges, those of triangles too, as such files list them; NULL when out of memory. */
static uint64_t *list_edges(const sph__io_export *e, size_t *count)
{
    const sph_level_arrays *a = &e->a;
    uint64_t *keys = NULL;
    *count = 0;
    if (a->triangle_count < SIZE_MAX / 4 && a->edge_count < SIZE_MAX / 4)
        keys = sph_context_allocate(e->context, 3 * a->triangle_count + a->edge_count + 1, sizeof *keys);
    if (keys == NULL) return NULL;
    for (size_t i = 0; i < a->edge_count; ++i)
        add_edge(keys, count, a->edges[2 * i], a->edges[2 * i + 1]);
    for (size_t i = 0; i < 3 * a->triangle_count; ++i)
        add_edge(keys, count, a->triangles[i], a->triangles[i % 3 == 2 ? i - 2 : i + 1]);
    *count = sort_unique(keys, *count);
    return keys;
}

void sph__io_export_ma(sph__io_output *o, sph__io_export *e)
{
    const sph_level_arrays *a = &e->a;
    size_t edges, triangles = 0;
    uint64_t *keys = list_edges(e, &edges);
    if (keys == NULL) {
        if (o->status == SPH_OK) o->status = sph__io_fail_memory(e->context, o->target);
        return;
    }
    for (size_t i = 0; i < a->triangle_count; ++i)
        triangles += !sph__io_export_is_flat(a->triangles + 3 * i, 3);
    sph__io_output_text(o, "%u %zu %zu\n", (unsigned)a->sphere_count, edges, triangles);
    for (size_t i = 0; i < a->sphere_count; ++i) {
        sph__io_output_text(o, "v ");
        sph__io_output_floats(o, a->centers + 3 * i, 3);
        sph__io_output_text(o, " ");
        sph__io_output_float(o, a->radii[i]);
        sph__io_output_text(o, "\n");
    }
    for (size_t i = 0; i < edges; ++i)
        sph__io_output_text(o, "e %u %u\n", (unsigned)(keys[i] >> 32), (unsigned)(keys[i] & UINT32_MAX));
    for (size_t i = 0; i < a->triangle_count; ++i) {
        const uint32_t *t = a->triangles + 3 * i;
        if (!sph__io_export_is_flat(t, 3))
            sph__io_output_text(o, "f %u %u %u\n", (unsigned)t[0], (unsigned)t[1], (unsigned)t[2]);
    }
    /* at the end, where readers that know no comments have stopped */
    sph__io_export_notes(o, e, "# ", "\n");
    sph_context_release(e->context, keys);
}
