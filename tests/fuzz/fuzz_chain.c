/* SPDX-License-Identifier: MIT */
/*
 * Animations made from bytes - degenerate, non-manifold, tiny, huge, of one vertex, without triangles - through the whole
 * chain: hierarchy, cursor, level, queries, coverage, surface. What must hold of any result is checked.
 */
#include <math.h>

#include "fuzz.h"

enum { VERTEX_LIMIT = 40, FRAME_LIMIT = 5, TRIANGLE_LIMIT = 90, EDGE_LIMIT = 6 };

/* Values where arithmetic is tested, and a small grid, on which points coincide. */
static float coordinate(fuzz_bytes *b, float scale)
{
    static const float AWKWARD[] = {0.0F,    -0.0F,   1e-45F,    1e-38F,    1e-20F, 1e-7F,    1.0F,     0.33333334F,
                                    1.0001F, 1e7F,    1e15F,     1e18F,     3e38F,  INFINITY, -INFINITY, NAN};
    const uint8_t kind = fuzz_byte(b);
    if (kind >= 240) return AWKWARD[kind - 240];
    return scale * (float)((int)(kind % 16) - 8);
}

static sph_animation *make_animation(sph_context *context, fuzz_bytes *b)
{
    static const float SCALES[] = {1.0F, 1e-3F, 1e-15F, 1e6F, 1e15F, 1e-40F, 0.1F, 3.0F};
    const uint32_t n = 1 + fuzz_below(b, VERTEX_LIMIT), frames = 1 + fuzz_below(b, FRAME_LIMIT);
    const uint32_t triangles = fuzz_below(b, TRIANGLE_LIMIT), edges = fuzz_below(b, EDGE_LIMIT);
    const float scale = SCALES[fuzz_below(b, 8)];
    uint32_t indices[3 * TRIANGLE_LIMIT];
    sph_animation *animation = NULL;
    if (sph_animation_create(context, n, frames, &animation) != SPH_OK) return NULL;
    for (uint32_t i = 0; i < 3 * triangles; ++i) indices[i] = fuzz_below(b, n);
    FUZZ_CHECK(sph_animation_set_triangles(animation, indices, triangles, 0) == SPH_OK);
    for (uint32_t i = 0; i < 2 * edges; ++i) indices[i] = fuzz_below(b, n);
    FUZZ_CHECK(sph_animation_set_edges(animation, indices, edges, 0) == SPH_OK);
    for (uint32_t f = 0; f < frames; ++f) {
        float frame[3 * VERTEX_LIMIT];
        for (uint32_t i = 0; i < 3 * n; ++i) frame[i] = coordinate(b, scale);
        FUZZ_CHECK(sph_animation_set_frame(animation, f, frame, 0) == SPH_OK);
    }
    return animation;
}

static sph_status build(const sph_animation *animation, fuzz_bytes *b, sph_hierarchy **h)
{
    sph_hierarchy_options o;
    sph_hierarchy_options_init(&o, sizeof o);
    o.radius_mode = (int32_t)fuzz_below(b, 3);
    o.importance = (int32_t)fuzz_below(b, 2);
    o.temporal_coherence = fuzz_below(b, 4) == 0 ? 0.05 : 0;
    o.width_directions = 3 + fuzz_below(b, 5);
    o.orientation = (int32_t)fuzz_below(b, 2);
    return sph_hierarchy_create(animation, &o, h);
}

/* Every collapse unites two that lived, no error falls, every sphere is finite, and one is left per component. */
static void check_hierarchy(const sph_animation *animation, const sph_hierarchy *h)
{
    const uint32_t n = sph_hierarchy_vertex_count(h), collapses = sph_hierarchy_collapse_count(h);
    uint8_t dead[2 * VERTEX_LIMIT] = {0};
    double error = 0;
    sph_animation_report report;
    sph_animation_report_init(&report, sizeof report);
    FUZZ_CHECK(sph_animation_check(animation, &report) == SPH_OK);
    FUZZ_CHECK(n - collapses == report.component_count);
    for (uint32_t t = 0; t < collapses; ++t) {
        float centers[FRAME_LIMIT][3], radii[FRAME_LIMIT];
        sph_collapse c;
        FUZZ_CHECK(sph_hierarchy_collapse(h, t, &c) == SPH_OK);
        FUZZ_CHECK(c.node == n + t && c.u < c.v && c.v < c.node && !dead[c.u] && !dead[c.v]);
        dead[c.u] = dead[c.v] = 1;
        FUZZ_CHECK(c.cost >= 0 && isfinite(c.cost) && c.error >= error && isfinite(c.error));
        error = c.error;
        FUZZ_CHECK(sph_hierarchy_sphere(h, c.node, centers[0], radii) == SPH_OK);
        for (uint32_t f = 0; f < sph_hierarchy_frame_count(h); ++f) {
            FUZZ_CHECK(isfinite(radii[f]) && radii[f] >= 0);
            for (unsigned k = 0; k < 3; ++k) FUZZ_CHECK(isfinite(centers[f][k]));
        }
    }
}

/* A ray that hits ends on the solid, and a point is as far away as the casts say that it must be at least. */
static void check_queries(const sph_level *level, fuzz_bytes *b)
{
    sph_query_options o;
    sph_query *query = NULL;
    sph_query_options_init(&o, sizeof o);
    if (sph_query_create(level, &o, &query) != SPH_OK) return;
    if (sph_query_pose_frame(query, 0) == SPH_OK) {
        sph_sweep sweep = {.radius = 0.25F * (float)fuzz_below(b, 3)};
        sph_hit hit = {0};
        sph_nearest nearest = {0};
        uint8_t any = 0;
        for (unsigned k = 0; k < 3; ++k) {
            sweep.from[k] = (float)((int)fuzz_below(b, 33) - 16);
            sweep.to[k] = (float)((int)fuzz_below(b, 33) - 16);
        }
        if (sph_query_cast(query, &sweep, 1, &hit) == SPH_OK) {
            FUZZ_CHECK(hit.s >= 0 && hit.s <= 1 && hit.depth >= 0);
            FUZZ_CHECK(sph_query_cast_any(query, &sweep, 1, &any) == SPH_OK && any == hit.hit);
            for (unsigned k = 0; k < 3 && hit.hit; ++k) FUZZ_CHECK(isfinite(hit.contact.normal[k]));
        }
        if (sph_query_nearest(query, sweep.from, 0, 1, &nearest) == SPH_OK) FUZZ_CHECK(isfinite(nearest.distance));
    }
    sph_query_destroy(query);
}

static void check_surface(const sph_level *level)
{
    sph_surface_options o;
    sph_surface *surface = NULL;
    sph_surface_options_init(&o, sizeof o);
    o.resolution = 6;
    o.frame_limit = 1;
    o.memory_limit = UINT64_C(64) << 20;
    if (sph_surface_create(level, &o, &surface) == SPH_OK) {
        const uint32_t vertices = sph_surface_vertex_count(surface, 0);
        const uint32_t *triangles = sph_surface_triangles(surface, 0);
        for (size_t i = 0; i < 3 * sph_surface_triangle_count(surface, 0); ++i) FUZZ_CHECK(triangles[i] < vertices);
    }
    sph_surface_destroy(surface);
}

static void use_levels(const sph_animation *animation, const sph_hierarchy *h, fuzz_bytes *b)
{
    const uint32_t n = sph_hierarchy_vertex_count(h), collapses = sph_hierarchy_collapse_count(h);
    for (unsigned i = 0; i < 2; ++i) {
        const uint32_t count = n - fuzz_below(b, collapses + 1);
        sph_coverage coverage = {.struct_size = sizeof coverage};
        sph_level *level = NULL;
        FUZZ_CHECK(sph_level_create(h, count, &level) == SPH_OK);
        FUZZ_CHECK(sph_level_sphere_count(level) == count);
        if (sph_coverage_measure(animation, level, &coverage) == SPH_OK) FUZZ_CHECK(coverage.distance >= 0);
        check_queries(level, b);
        if (i == 0) check_surface(level);
        FUZZ_CHECK(sph_level_optimize_connectivity(level, animation) != SPH_E_INVALID);
        sph_level_destroy(level);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_bytes b = {data, size};
    fuzz_patience patience = {.reports_left = 100000};
    sph_context *context = fuzz_context(&patience);
    const uint64_t idle = sph_context_memory_used(context);
    sph_animation *animation = make_animation(context, &b);
    sph_hierarchy *h = NULL;
    sph_status status = SPH_E_NOMEM;
    FUZZ_CHECK(animation != NULL);
    status = build(animation, &b, &h);
    FUZZ_CHECK((h != NULL) == (status == SPH_OK));
    FUZZ_CHECK(status == SPH_OK || status == SPH_E_INVALID);
    if (status == SPH_OK) {
        check_hierarchy(animation, h);
        use_levels(animation, h, &b);
    }
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
    fuzz_end(context, status, idle);
    return 0;
}
