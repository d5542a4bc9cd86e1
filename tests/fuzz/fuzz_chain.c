/* SPDX-License-Identifier: MIT */
/*
 * Animations made from bytes - degenerate, non-manifold, tiny, huge, of one vertex, without triangles - through the
 * whole chain: hierarchy, cursor, level, and one of what levels are for: queries and surfaces, skins, containment,
 * distances, every file that is written. What must hold of any result is checked.
 */
#include <math.h>

#include "fuzz.h"
#include "fuzz_rig.h"
#include "fuzz_write.h"

enum { VERTEX_LIMIT = 40, FRAME_LIMIT = 5, TRIANGLE_LIMIT = 90, EDGE_LIMIT = 6 };

/* Values where arithmetic is tested, and a small grid, on which points coincide. */
static float coordinate(fuzz_bytes *b, float scale)
{
    static const float AWKWARD[] = {0.0F,    -0.0F, 1e-45F, 1e-38F, 1e-20F, 1e-7F,    1.0F,      0.33333334F,
                                    1.0001F, 1e7F,  1e15F,  1e18F,  3e38F,  INFINITY, -INFINITY, NAN};
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
    for (uint32_t i = 0; i < 3 * triangles; ++i)
        indices[i] = fuzz_below(b, n);
    FUZZ_CHECK(sph_animation_set_triangles(animation, indices, triangles, 0) == SPH_OK);
    for (uint32_t i = 0; i < 2 * edges; ++i)
        indices[i] = fuzz_below(b, n);
    FUZZ_CHECK(sph_animation_set_edges(animation, indices, edges, 0) == SPH_OK);
    for (uint32_t f = 0; f < frames; ++f) {
        float frame[3 * VERTEX_LIMIT];
        for (uint32_t i = 0; i < 3 * n; ++i)
            frame[i] = coordinate(b, scale);
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
            for (unsigned k = 0; k < 3; ++k)
                FUZZ_CHECK(isfinite(centers[f][k]));
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
            for (unsigned k = 0; k < 3 && hit.hit; ++k)
                FUZZ_CHECK(isfinite(hit.contact.normal[k]));
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
        for (size_t i = 0; i < 3 * sph_surface_triangle_count(surface, 0); ++i)
            FUZZ_CHECK(triangles[i] < vertices);
    }
    sph_surface_destroy(surface);
}

/* What has grown until it contains everything does, and no radius is smaller. */
static void check_inflation(const sph_animation *animation, const sph_level *level)
{
    sph_inflation_options o;
    sph_coverage coverage = {.struct_size = sizeof coverage};
    sph_level_arrays before = {.struct_size = sizeof before}, after = {.struct_size = sizeof after};
    sph_level *inflated = NULL;
    sph_inflation_options_init(&o, sizeof o);
    o.rounds = 2;
    if (sph_coverage_inflate(animation, level, &o, NULL, &inflated) == SPH_OK) {
        FUZZ_CHECK(sph_coverage_measure(animation, inflated, &coverage) == SPH_OK && coverage.uncovered_count == 0);
        FUZZ_CHECK(sph_level_get_arrays(level, &before) == SPH_OK && sph_level_get_arrays(inflated, &after) == SPH_OK);
        for (uint32_t i = 0; i < before.sphere_count; ++i)
            FUZZ_CHECK(after.radii[i] >= before.radii[i]);
    }
    sph_level_destroy(inflated);
}

static void check_skin(sph_context *context, const sph_animation *animation, const sph_level *level, fuzz_bytes *b)
{
    const sph_skin_source source = {.animation = animation, .name = "clip", .frames_per_second = 30};
    sph_skin_options o;
    sph_skin *skin = NULL;
    sph_skin_error ended, measured;
    sph_skin_options_init(&o, sizeof o);
    o.mode = (int32_t)fuzz_below(b, 3);
    o.influence_limit = 1 + fuzz_below(b, 4);
    o.round_limit = fuzz_below(b, 3);
    o.flags = fuzz_below(b, 2) != 0 ? SPH_SKIN_UNIFORM : 0;
    o.rings = fuzz_below(b, 3);
    if (sph_skin_create(level, &source, 1, &o, &skin) == SPH_OK) {
        FUZZ_CHECK(sph_skin_get_errors(skin, &ended, NULL) == SPH_OK);
        FUZZ_CHECK(isfinite(ended.rmse) && ended.rmse >= 0 && ended.max >= 0);
        if (sph_skin_measure(skin, &source, 1, &measured, NULL) == SPH_OK)
            FUZZ_CHECK(fabs(measured.rmse - ended.rmse) <= 1e-9 * (ended.rmse + ended.diagonal));
        fuzz_use_skin(skin);
        fuzz_save_skin(context, skin);
    }
    sph_skin_destroy(skin);
}

static void check_distances(const sph_animation *animation, const sph_level *level)
{
    static const double ROUNDED = 1 + 1e-12; /* of a mean of equal numbers */
    sph_measure_options o;
    sph_distances mean;
    sph_measure_options_init(&o, sizeof o);
    o.samples = 200;
    o.frame_limit = 1;
    if (sph_measure_level(animation, level, &o, &mean, NULL) != SPH_OK) return;
    FUZZ_CHECK(mean.mean12 >= 0 && mean.mean12 <= mean.max12 * ROUNDED);
    FUZZ_CHECK(mean.mean21 >= 0 && mean.mean21 <= mean.max21 * ROUNDED);
    FUZZ_CHECK(isfinite(mean.hausdorff) && mean.hausdorff >= mean.max12 && mean.hausdorff >= mean.max21);
}

static void use_level(sph_context *context, const sph_animation *animation, sph_level *level, fuzz_bytes *b)
{
    enum { QUERIES, SURFACES, SKINS, GROWTH, DISTANCES, FILES, EXPORTS, USES };
    sph_coverage coverage = {.struct_size = sizeof coverage};
    switch (fuzz_below(b, USES)) {
    case QUERIES:
        if (sph_coverage_measure(animation, level, &coverage) == SPH_OK) FUZZ_CHECK(coverage.distance >= 0);
        check_queries(level, b);
        break;
    case SURFACES:
        check_surface(level);
        break;
    case SKINS:
        check_skin(context, animation, level, b);
        break;
    case GROWTH:
        check_inflation(animation, level);
        break;
    case DISTANCES:
        check_distances(animation, level);
        break;
    case FILES:
        fuzz_save_level(context, level);
        break;
    default:
        fuzz_export_level(context, level, fuzz_byte(b));
        break;
    }
    FUZZ_CHECK(sph_level_optimize_connectivity(level, animation) != SPH_E_INVALID);
}

static void use_levels(sph_context *context, const sph_animation *animation, const sph_hierarchy *h, fuzz_bytes *b)
{
    const uint32_t n = sph_hierarchy_vertex_count(h), collapses = sph_hierarchy_collapse_count(h);
    for (unsigned i = 0; i < 2; ++i) {
        const uint32_t count = n - fuzz_below(b, collapses + 1);
        sph_level *level = NULL;
        FUZZ_CHECK(sph_level_create(h, count, &level) == SPH_OK);
        FUZZ_CHECK(sph_level_sphere_count(level) == count);
        use_level(context, animation, level, b);
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
    fuzz_bytes options_at = b;
    sph_status status = SPH_E_NOMEM;
    FUZZ_CHECK(animation != NULL);
    status = build(animation, &b, &h);
    FUZZ_CHECK((h != NULL) == (status == SPH_OK));
    FUZZ_CHECK(status == SPH_OK || status == SPH_E_INVALID);
    if (status == SPH_OK) {
        check_hierarchy(animation, h);
        use_levels(context, animation, h, &b);
        if (fuzz_below(&b, 8) == 1) fuzz_save_animation(context, animation, fuzz_below(&b, 2) == 1);
        if (fuzz_below(&b, 64) == 1) fuzz_compare_spilled(animation, h, build, &options_at);
    }
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
    fuzz_end(context, status, idle);
    return 0;
}
