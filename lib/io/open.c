/* SPDX-License-Identifier: MIT */
/* sph_io_open_animation: files become the frames of an animation. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "io/io.h"

/* Behind an animation whose frames stay in files: a point cache, or the meshes of a sequence. */
typedef struct source {
    sph_context *context; /* the animation keeps it alive */
    sph_io_open_options options;
    uint32_t frame_count; /* selected */
    size_t vertex_count;
    sph__io_names names;  /* the selected meshes; the first one gives the triangles */
    sph__io_mesh first;   /* of a sequence its counts, triangles and edges stay; with a cache nothing does */
    sph__io_mesh scratch; /* the mesh of a sequence that was read last */
    sph__io_cache cache;
    bool has_cache;
    sph__io_gltf *baked;
    sph__io_abc *archive;
    sph__io_map map; /* of the archive */
} source;

enum { OPEN_OPTIONS_V1 = offsetof(sph_io_open_options, scale) + sizeof(double) };
_Static_assert(sizeof(void *) != 8 || OPEN_OPTIONS_V1 == 40, "a field of 0.1 moved");

static const sph_io_open_options OPEN_DEFAULTS = {
    .struct_size = sizeof(sph_io_open_options), .frame_step = 1, .up_axis = SPH_UP_Y, .scale = 1};

void sph_io_open_options_init(sph_io_open_options *options, size_t size)
{
    sph__io_options_init(options, size, &OPEN_DEFAULTS, sizeof OPEN_DEFAULTS, OPEN_OPTIONS_V1);
}

static sph_status read_options(sph_context *context, const sph_io_open_options *in, sph_io_open_options *o)
{
    sph_status status;
    *o = OPEN_DEFAULTS;
    status = sph__io_options_read(context, "sph_io_open_options", in, o, sizeof *o, OPEN_OPTIONS_V1);
    if (status != SPH_OK) return status;
    if (o->flags != 0) return sph__io_fail(context, SPH_E_INVALID, "sph_io_open_options: flags must be 0");
    if (o->frame_step == 0) return sph__io_fail(context, SPH_E_INVALID, "the step between frames is 0");
    if (o->end_frame != 0 && o->end_frame <= o->first_frame)
        return sph__io_fail(context, SPH_E_INVALID, "frames %u to before %u: none", (unsigned)o->first_frame,
                            (unsigned)o->end_frame);
    if (o->up_axis != SPH_UP_Y && o->up_axis != SPH_UP_Z)
        return sph__io_fail(context, SPH_E_INVALID, "up_axis is %d, not y (%d) or z (%d)", (int)o->up_axis, SPH_UP_Y,
                            SPH_UP_Z);
    if (!isfinite(o->scale) || o->scale == 0)
        return sph__io_fail(context, SPH_E_INVALID, "scale is %g: it must be finite and not 0", o->scale);
    if (!isfinite(o->fps) || o->fps < 0)
        return sph__io_fail(context, SPH_E_INVALID, "%g frames per second: not finite, or negative", o->fps);
    if (o->weld < SPH_IO_WELD_AUTO || o->weld > SPH_IO_WELD_ALL)
        return sph__io_fail(context, SPH_E_INVALID, "sph_io_open_options: weld is %d", (int)o->weld);
    if (o->space != SPH_IO_SPACE_LOCAL && o->space != SPH_IO_SPACE_WORLD)
        return sph__io_fail(context, SPH_E_INVALID, "sph_io_open_options: space is %d", (int)o->space);
    return SPH_OK;
}

/* How many of `available` frames the options select. */
static sph_status select_frames(source *s, size_t available, const char *path)
{
    const sph_io_open_options *o = &s->options;
    const size_t end = o->end_frame == 0 ? available : o->end_frame;
    if (available > INT32_MAX)
        return sph__io_fail(s->context, SPH_E_LIMIT, "%s: more than 2^31 - 1 frames", sph__io_shown(path));
    if (o->first_frame >= available || end > available)
        return sph__io_fail(s->context, SPH_E_INVALID, "%s: frames %u to before %zu are asked for, but there %s %zu",
                            sph__io_shown(path), (unsigned)o->first_frame, end, available == 1 ? "is" : "are",
                            available);
    s->frame_count = (uint32_t)((end - o->first_frame - 1) / o->frame_step + 1);
    return SPH_OK;
}

static void transform(const source *s, size_t vertex_count, float *xyz)
{
    const double scale = s->options.scale;
    if (s->options.up_axis == SPH_UP_Z)
        for (size_t i = 0; i < vertex_count; ++i) {
            const float y = xyz[3 * i + 1];
            xyz[3 * i + 1] = xyz[3 * i + 2];
            xyz[3 * i + 2] = -y;
        }
    if (scale != 1)
        for (size_t i = 0; i < 3 * vertex_count; ++i)
            xyz[i] = (float)(xyz[i] * scale);
}

/* The line or byte of a triangle, by reading the file once more; 0 where that fails. */
static size_t find_place(source *s, const char *path, size_t triangle)
{
    size_t place = triangle;
    return sph__io_read_mesh(path, &s->scratch, &place) == SPH_OK ? place : 0;
}

static sph_status check_triangles(source *s, const char *path)
{
    const sph__io_mesh *a = &s->first, *b = &s->scratch;
    const uint32_t base = b->first_index;
    uint32_t corners[3];
    size_t i = 0, j;
    if (memcmp(a->triangles, b->triangles, 3 * sizeof(uint32_t) * a->triangle_count) == 0) return SPH_OK;
    while (a->triangles[i] == b->triangles[i])
        ++i;
    j = i / 3;
    memcpy(corners, b->triangles + 3 * j, sizeof corners);
    return sph__io_fail(s->context, SPH_E_FORMAT, "%s: %s %zu: triangle %zu is (%u %u %u), but (%u %u %u) in %s",
                        sph__io_shown(path), b->binary ? "byte" : "line", find_place(s, path, j), j,
                        (unsigned)(corners[0] + base), (unsigned)(corners[1] + base), (unsigned)(corners[2] + base),
                        (unsigned)(a->triangles[3 * j] + base), (unsigned)(a->triangles[3 * j + 1] + base),
                        (unsigned)(a->triangles[3 * j + 2] + base), sph__io_shown(s->names.names[0]));
}

static sph_status fail_count(source *s, const char *path, size_t count, const char *what, size_t first)
{
    return sph__io_fail(s->context, SPH_E_FORMAT, "%s: %zu %s, but %zu in %s", sph__io_shown(path), count, what, first,
                        sph__io_shown(s->names.names[0]));
}

/* Reads a mesh of the sequence into the scratch mesh and compares it with the first one. */
static sph_status read_like_first(source *s, const char *path)
{
    const sph__io_mesh *a = &s->first, *b = &s->scratch;
    sph_status status = sph__io_read_mesh(path, &s->scratch, NULL);
    if (status != SPH_OK) return status;
    if (a->vertex_count != b->vertex_count) return fail_count(s, path, b->vertex_count, "vertices", a->vertex_count);
    if (a->triangle_count != b->triangle_count)
        return fail_count(s, path, b->triangle_count, "triangles", a->triangle_count);
    if (a->edge_count != b->edge_count) return fail_count(s, path, b->edge_count, "edges", a->edge_count);
    if (a->triangle_count != 0 && (status = check_triangles(s, path)) != SPH_OK) return status;
    for (size_t i = 0; i < 2 * a->edge_count; ++i)
        if (a->edges[i] != b->edges[i])
            return sph__io_fail(s->context, SPH_E_FORMAT, "%s: edge %zu is not the one of %s", sph__io_shown(path),
                                i / 2, sph__io_shown(s->names.names[0]));
    return SPH_OK;
}

static sph_status read_frame(void *user, uint32_t frame, float *xyz)
{
    source *s = user;
    if (frame >= s->frame_count)
        return sph__io_fail(s->context, SPH_E_INVALID, "frame %u of %u", (unsigned)frame, (unsigned)s->frame_count);
    if (s->has_cache) {
        sph__io_cache_read(&s->cache, s->options.first_frame + frame * s->options.frame_step, xyz);
    } else if (s->baked != NULL) {
        sph__io_gltf_read(s->baked, s->options.first_frame + frame * s->options.frame_step, xyz);
    } else if (s->archive != NULL) {
        const sph_status status =
            sph__io_abc_read(s->archive, s->options.first_frame + frame * s->options.frame_step, xyz);
        if (status != SPH_OK) return status;
    } else {
        const sph_status status = read_like_first(s, s->names.names[frame]);
        if (status != SPH_OK) return status;
        memcpy(xyz, s->scratch.positions, 3 * sizeof(float) * s->scratch.vertex_count);
    }
    transform(s, s->vertex_count, xyz);
    return SPH_OK;
}

static void destroy_source(void *user)
{
    source *s = user;
    if (s == NULL) return;
    sph__io_names_release(&s->names);
    sph__io_mesh_release(&s->first);
    sph__io_mesh_release(&s->scratch);
    sph__io_cache_close(&s->cache);
    sph__io_gltf_close(s->baked);
    sph__io_abc_close(s->archive);
    sph__io_map_close(&s->map);
    sph_context_release(s->context, s);
}

/* Of the files only the selected ones stay. */
static sph_status select_names(source *s)
{
    sph__io_names *n = &s->names;
    const sph_status status = select_frames(s, n->count, n->names[0]);
    const size_t step = s->options.frame_step;
    size_t next = s->options.first_frame, kept = 0;
    if (status != SPH_OK) return status;
    for (size_t i = 0; i < n->count; ++i) {
        if (i == next && kept < s->frame_count) {
            n->names[kept++] = n->names[i];
            next += step;
        } else {
            sph_context_release(s->context, (void *)(uintptr_t)n->names[i]);
        }
    }
    n->count = kept;
    return SPH_OK;
}

static sph_status open_cache(source *s)
{
    const char *mesh = s->names.names[0], *path = s->options.cache_path;
    sph_status status = sph__io_cache_open(s->context, path, &s->cache);
    if (status != SPH_OK) return status;
    s->has_cache = true;
    if ((status = sph__io_read_mesh(mesh, &s->first, NULL)) != SPH_OK) return status;
    if (s->cache.vertex_count != s->first.vertex_count)
        return sph__io_fail(s->context, SPH_E_FORMAT, "%s has frames of %u points, but %s has %zu vertices",
                            sph__io_shown(path), (unsigned)s->cache.vertex_count, sph__io_shown(mesh),
                            s->first.vertex_count);
    return select_frames(s, s->cache.frame_count, path);
}

static sph_status open_sequence(source *s)
{
    sph_status status = select_names(s);
    if (status == SPH_OK) status = sph__io_read_mesh(s->names.names[0], &s->first, NULL);
    s->scratch.to = &s->first;
    for (size_t i = 1; i < s->names.count && status == SPH_OK; ++i) {
        status = sph_context_report_progress(s->context, "opening files", (double)i / (double)s->names.count);
        if (status == SPH_OK) status = read_like_first(s, s->names.names[i]);
    }
    return status;
}

/* A glTF or an Alembic alone; s->baked and s->archive stay NULL where the file is neither. */
static sph_status open_animated(source *s)
{
    const sph_io_open_options *o = &s->options;
    const char *path = s->names.names[0];
    sph__io_read_fn *read;
    sph_status status = sph__io_map_open(s->context, path, &s->map);
    if (status != SPH_OK) return status;
    status = sph__io_find_reader(s->context, path, &s->map, &read);
    if (status == SPH_OK && read == sph__io_read_gltf) {
        status = sph__io_gltf_open(path, &s->map, o->fps == 0 ? SPH__IO_FPS : o->fps, o->clip, &s->first, &s->baked);
        if (status == SPH_OK) status = select_frames(s, sph__io_gltf_frame_count(s->baked), path);
    } else if (status == SPH_OK && read == sph__io_read_abc) {
        status =
            sph__io_abc_open(path, &s->map, o->fps, o->object, o->space == SPH_IO_SPACE_WORLD, &s->first, &s->archive);
        if (status == SPH_OK) status = select_frames(s, sph__io_abc_frame_count(s->archive), path);
    }
    if (s->archive == NULL) sph__io_map_close(&s->map);
    return status;
}

/* Choices within a file, of files that have none. */
static sph_status check_choices(const source *s)
{
    const sph_io_open_options *o = &s->options;
    if (o->clip != NULL && s->baked == NULL)
        return sph__io_fail(s->context, SPH_E_INVALID, "clip '%.80s' of what is not one glTF, read without a cache",
                            o->clip);
    if (o->object != NULL && s->archive == NULL)
        return sph__io_fail(s->context, SPH_E_INVALID,
                            "object '%.80s' of what is not one Alembic, read without a cache", o->object);
    return SPH_OK;
}

static sph_status open_source(source *s, const char *const *paths, size_t path_count)
{
    sph_status status = sph__io_expand(&s->names, paths, path_count);
    if (status == SPH_OK && s->names.count == 1 && s->options.cache_path == NULL) status = open_animated(s);
    if (status == SPH_OK) status = check_choices(s);
    if (status != SPH_OK || s->baked != NULL || s->archive != NULL) return status;
    if (s->options.cache_path == NULL) return open_sequence(s);
    if (s->names.count != 1)
        return sph__io_fail(s->context, SPH_E_INVALID, "a point cache goes with one mesh, not with %zu",
                            s->names.count);
    return open_cache(s);
}

/* One mesh alone is held by the animation itself. */
static bool is_single(const source *s)
{
    return !s->has_cache && s->baked == NULL && s->archive == NULL && s->frame_count == 1;
}

/* Takes the source over, but for a single mesh. */
static sph_status create_animation(source *s, sph_animation **out)
{
    const uint32_t n = (uint32_t)(s->vertex_count = s->first.vertex_count);
    const sph_frame_source pulled = {s, read_frame, destroy_source};
    sph_status status;
    if (!is_single(s)) {
        sph_context_release(s->context, s->first.positions); /* each frame brings its own */
        s->first.positions = NULL;
        s->first.vertex_capacity = 0;
        return sph_animation_create_from_source(s->context, n, s->frame_count, &pulled, out);
    }
    status = sph_animation_create(s->context, n, 1, out);
    if (status == SPH_OK) {
        transform(s, n, s->first.positions);
        status = sph_animation_set_frame(*out, 0, s->first.positions, 0);
    }
    return status;
}

static sph_status make_animation(source *s, sph_animation **out)
{
    const bool single = is_single(s);
    uint32_t *triangles = s->first.triangles, *edges = s->first.edges;
    const size_t triangle_count = s->first.triangle_count, edge_count = s->first.edge_count;
    sph_status status = create_animation(s, out);
    if (status == SPH_OK) status = sph_animation_set_triangles(*out, triangles, triangle_count, 0);
    if (status == SPH_OK) status = sph_animation_set_edges(*out, edges, edge_count, 0);
    if (status != SPH_OK) {
        sph_animation_destroy(*out);
        *out = NULL;
    }
    if (single)
        destroy_source(s); /* else the animation has done it, or will */
    else if (status == SPH_OK && (s->has_cache || s->baked != NULL || s->archive != NULL))
        sph__io_mesh_release(&s->first);
    return status;
}

/* Puts the welded animation in the place of *animation. */
static sph_status weld(sph_animation **animation)
{
    sph_animation *welded;
    const sph_status status = sph_animation_weld(*animation, 0, NULL, &welded);
    sph_animation_destroy(*animation);
    *animation = welded;
    return status;
}

sph_status sph_io_open_animation(sph_context *context, const char *const *paths, size_t path_count,
                                 const sph_io_open_options *options, sph_animation **out)
{
    SPH__IO_OWN(context, sph_context_memory_used);
    sph_io_open_options o;
    sph_status status;
    source *s;
    bool welds;
    if (out != NULL) *out = NULL;
    if (context == NULL || paths == NULL || path_count == 0 || out == NULL)
        return sph_context_fail(context, SPH_E_INVALID,
                                "sph_io_open_animation: an argument is NULL, or there is no path");
    for (size_t i = 0; i < path_count; ++i)
        if (paths[i] == NULL) return sph__io_fail(context, SPH_E_INVALID, "sph_io_open_animation: path %zu is NULL", i);
    if ((status = read_options(context, options, &o)) != SPH_OK) return status;
    s = sph_context_allocate(context, 1, sizeof *s);
    if (s == NULL) return sph_context_fail(context, SPH_E_NOMEM, "out of memory");
    *s = (source){.context = context,
                  .options = o,
                  .names.context = context,
                  .first.context = context,
                  .scratch.context = context};
    if ((status = open_source(s, paths, path_count)) != SPH_OK) {
        destroy_source(s);
        return status;
    }
    s->options.cache_path = s->options.clip = s->options.object = NULL; /* the caller's */
    welds = o.weld == SPH_IO_WELD_ALL || (o.weld == SPH_IO_WELD_AUTO && s->baked != NULL);
    status = make_animation(s, out);
    return status == SPH_OK && welds ? weld(out) : status;
}
