/* SPDX-License-Identifier: MIT */
#include <unistd.h>

#include <sphmesh/io.h>

#include "fuzz_write.h"

enum { PATH_SIZE = 128 };

/* A name of this process's own; each ending has its own text. */
static const char *path_of(char path[PATH_SIZE], const char *ending)
{
    const char *folder = getenv("TMPDIR");
    if (folder == NULL || strlen(folder) > PATH_SIZE / 2) folder = "/tmp";
    snprintf(path, PATH_SIZE, "%s/sphmesh-fuzz-%ld-written.%s", folder, (long)getpid(), ending);
    return path;
}

static bool same_bytes(const void *a, const void *b, size_t size)
{
    return size == 0 || memcmp(a, b, size) == 0;
}

static void check_same_level(const sph_level *first, const sph_level *second)
{
    sph_level_arrays a = {.struct_size = sizeof a}, b = {.struct_size = sizeof b};
    size_t spheres;
    FUZZ_CHECK(sph_level_get_arrays(first, &a) == SPH_OK && sph_level_get_arrays(second, &b) == SPH_OK);
    FUZZ_CHECK(a.sphere_count == b.sphere_count && a.frame_count == b.frame_count);
    FUZZ_CHECK(a.radii_per_frame == b.radii_per_frame && a.label_count == b.label_count);
    FUZZ_CHECK(a.edge_count == b.edge_count && a.triangle_count == b.triangle_count);
    spheres = (size_t)a.sphere_count * a.frame_count;
    FUZZ_CHECK(same_bytes(a.centers, b.centers, 12 * spheres));
    FUZZ_CHECK(same_bytes(a.radii, b.radii, 4 * (a.radii_per_frame != 0 ? spheres : a.sphere_count)));
    FUZZ_CHECK(same_bytes(a.edges, b.edges, 8 * a.edge_count));
    FUZZ_CHECK(same_bytes(a.triangles, b.triangles, 12 * a.triangle_count));
    FUZZ_CHECK(same_bytes(a.labels, b.labels, 4 * a.label_count));
}

void fuzz_save_level(sph_context *context, const sph_level *level)
{
    static const char *const WHOLE[] = {"sphm", "json"}, *const PARTS[] = {"obj", "ply", "glb"};
    char path[PATH_SIZE];
    for (unsigned i = 0; i < 2; ++i) {
        sph_level *again = NULL;
        FUZZ_CHECK(sph_io_save_level(context, level, path_of(path, WHOLE[i])) == SPH_OK);
        FUZZ_CHECK(sph_io_load_level(context, path, &again) == SPH_OK);
        check_same_level(level, again);
        sph_level_destroy(again);
        unlink(path);
    }
    for (unsigned i = 0; i < 3; ++i) {
        const char *paths[] = {path_of(path, PARTS[i])};
        sph_animation *mesh = NULL;
        if (sph_io_save_level(context, level, path) == SPH_OK) {
            const sph_status status = sph_io_open_animation(context, paths, 1, NULL, &mesh);
            FUZZ_CHECK(i == 2 || status == SPH_OK);
            if (i < 2) FUZZ_CHECK(sph_animation_vertex_count(mesh) == sph_level_sphere_count(level));
        }
        sph_animation_destroy(mesh);
        unlink(path);
    }
}

void fuzz_export_level(sph_context *context, const sph_level *level, uint8_t choice)
{
    sph_io_export_options o;
    sph_io_export_report report = {.struct_size = sizeof report};
    char path[PATH_SIZE];
    sph_io_export_options_init(&o, sizeof o);
    o.format = SPH_IO_EXPORT_PRIMITIVES + choice % SPH_IO_EXPORT_GLB;
    o.cover_solid = choice / SPH_IO_EXPORT_GLB % 2;
    if (sph_io_export_level(context, level, path_of(path, "any"), &o, &report) == SPH_OK) {
        FUZZ_CHECK(report.frame_count > 0 && access(path, R_OK) == 0 && report.gap >= 0);
        FUZZ_CHECK(report.sphere_count + report.capsule_count + report.triangle_count > 0);
        if (o.format == SPH_IO_EXPORT_GLB) {
            const char *paths[] = {path_of(path, "glb")};
            char from[PATH_SIZE];
            sph_animation *mesh = NULL;
            FUZZ_CHECK(rename(path_of(from, "any"), path) == 0);
            FUZZ_CHECK(sph_io_open_animation(context, paths, 1, NULL, &mesh) != SPH_E_FORMAT);
            sph_animation_destroy(mesh);
        }
    }
    unlink(path);
}

static void check_same_animation(const sph_animation *first, const sph_animation *second)
{
    const uint32_t n = sph_animation_vertex_count(first), frames = sph_animation_frame_count(first);
    const size_t triangles = sph_animation_triangle_count(first);
    float *a = malloc(12 * (size_t)n), *b = malloc(12 * (size_t)n);
    FUZZ_CHECK(a != NULL && b != NULL);
    FUZZ_CHECK(sph_animation_vertex_count(second) == n && sph_animation_frame_count(second) == frames);
    FUZZ_CHECK(sph_animation_triangle_count(second) == triangles);
    FUZZ_CHECK(same_bytes(sph_animation_triangles(first), sph_animation_triangles(second), 12 * triangles));
    for (uint32_t f = 0; f < frames; ++f) {
        FUZZ_CHECK(sph_animation_read_frame(first, f, a) == SPH_OK && sph_animation_read_frame(second, f, b) == SPH_OK);
        FUZZ_CHECK(same_bytes(a, b, 12 * (size_t)n));
    }
    free(a);
    free(b);
}

void fuzz_save_animation(sph_context *context, const sph_animation *animation, bool mdd)
{
    char obj[PATH_SIZE], cache[PATH_SIZE];
    const char *paths[] = {path_of(obj, "obj")};
    sph_io_open_options o;
    sph_animation *again = NULL;
    sph_io_open_options_init(&o, sizeof o);
    o.cache_path = path_of(cache, mdd ? "mdd" : "pc2");
    FUZZ_CHECK((mdd ? sph_io_save_obj_mdd(context, animation, 0, 24, obj, cache)
                    : sph_io_save_obj_pc2(context, animation, 0, 1, obj, cache)) == SPH_OK);
    FUZZ_CHECK(sph_io_open_animation(context, paths, 1, &o, &again) == SPH_OK);
    check_same_animation(animation, again);
    sph_animation_destroy(again);
    unlink(obj);
    unlink(cache);
}

/* The same animation in another context. */
static sph_animation *copy_of(const sph_animation *from, sph_context *context)
{
    const uint32_t n = sph_animation_vertex_count(from), frames = sph_animation_frame_count(from);
    float *xyz = malloc(12 * (size_t)n);
    sph_animation *copy = NULL;
    FUZZ_CHECK(xyz != NULL && sph_animation_create(context, n, frames, &copy) == SPH_OK);
    for (uint32_t f = 0; f < frames; ++f)
        FUZZ_CHECK(sph_animation_read_frame(from, f, xyz) == SPH_OK &&
                   sph_animation_set_frame(copy, f, xyz, 0) == SPH_OK);
    FUZZ_CHECK(sph_animation_set_triangles(copy, sph_animation_triangles(from), sph_animation_triangle_count(from),
                                           0) == SPH_OK);
    FUZZ_CHECK(sph_animation_set_edges(copy, sph_animation_edges(from), sph_animation_edge_count(from), 0) == SPH_OK);
    free(xyz);
    return copy;
}

void fuzz_compare_spilled(const sph_animation *animation, const sph_hierarchy *hierarchy, fuzz_build_fn *build,
                          const fuzz_bytes *bytes)
{
    sph_io_spill_options o;
    sph_context_options c;
    fuzz_bytes b = *bytes;
    fuzz_patience patience = {.reports_left = 100000};
    sph_context *host = fuzz_context(&patience), *context = NULL;
    sph_io_spill *spill = NULL;
    sph_animation *copy;
    sph_hierarchy *again = NULL;
    fuzz_buffer first = {0}, second = {0};
    sph_io_spill_options_init(&o, sizeof o);
    o.memory_limit = SPH_IO_SPILL_LEAST;
    o.least_size = 1;
    o.folder = getenv("TMPDIR");
    FUZZ_CHECK(sph_io_spill_create(host, &o, &spill) == SPH_OK);
    sph_context_options_init(&c, sizeof c);
    c.thread_count = 1;
    sph_io_spill_get_allocator(spill, &c.allocator);
    FUZZ_CHECK(sph_context_create(&c, &context) == SPH_OK);
    copy = copy_of(animation, context);
    FUZZ_CHECK(build(copy, &b, &again) == SPH_OK);
    FUZZ_CHECK(sph_hierarchy_write(hierarchy, fuzz_append, &first) == SPH_OK);
    FUZZ_CHECK(sph_hierarchy_write(again, fuzz_append, &second) == SPH_OK);
    FUZZ_CHECK(first.size == second.size && memcmp(first.data, second.data, first.size) == 0);
    free(first.data);
    free(second.data);
    sph_hierarchy_destroy(again);
    sph_animation_destroy(copy);
    sph_context_destroy(context);
    sph_io_spill_destroy(spill);
    sph_context_destroy(host);
}
