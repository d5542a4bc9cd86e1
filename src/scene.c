/* SPDX-License-Identifier: MIT */
#include "scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"

static const double LINE = 0.0025; /* half the thickness of lines, of the box's diagonal */

/* A file before it is a figure: levels need the box first, which says how thick a line is. */
typedef struct source {
    sph_hierarchy *hierarchy;
    sph_level *level;
} source;

typedef struct sources {
    source *items;
    size_t count;
    sph_animation *input, *overlay;
} sources;

bool scene_is_level(const char *path)
{
    return name_ends(path, ".json") || name_ends(path, ".sphm");
}

static void box_clear(box *b)
{
    for (int k = 0; k < 3; ++k) {
        b->low[k] = INFINITY;
        b->high[k] = -INFINITY;
    }
}

/* `radii` may be NULL. */
static void box_add(box *b, const float *xyz, const float *radii, size_t count)
{
    for (size_t i = 0; i < 3 * count; ++i) {
        const double r = radii == NULL ? 0 : radii[i / 3];
        b->low[i % 3] = fmin(b->low[i % 3], xyz[i] - r);
        b->high[i % 3] = fmax(b->high[i % 3], xyz[i] + r);
    }
}

static sph_status boxes_of_animation(session *s, const sph_animation *a, box *boxes)
{
    const uint32_t n = sph_animation_vertex_count(a), frames = sph_animation_frame_count(a);
    float *xyz = sph_context_allocate(s->context, n, 3 * sizeof *xyz);
    sph_status status = xyz == NULL ? sph_context_fail(s->context, SPH_E_NOMEM, "out of memory") : SPH_OK;
    for (uint32_t f = 0; f < frames && status == SPH_OK; ++f) {
        status = sph_animation_read_frame(a, f, xyz);
        if (status == SPH_OK) box_add(&boxes[f], xyz, NULL, n);
    }
    sph_context_release(s->context, xyz);
    return status;
}

static sph_status boxes_of_hierarchy(session *s, const sph_hierarchy *h, box *boxes)
{
    const uint32_t n = sph_hierarchy_vertex_count(h), frames = sph_hierarchy_frame_count(h);
    float *xyz = sph_context_allocate(s->context, frames, 3 * sizeof *xyz);
    sph_status status = xyz == NULL ? sph_context_fail(s->context, SPH_E_NOMEM, "out of memory") : SPH_OK;
    for (uint32_t i = 0; i < n && status == SPH_OK; ++i) {
        status = sph_hierarchy_sphere(h, i, xyz, NULL);
        for (uint32_t f = 0; f < frames && status == SPH_OK; ++f)
            box_add(&boxes[f], xyz + 3 * (size_t)f, NULL, 1);
    }
    sph_context_release(s->context, xyz);
    return status;
}

static sph_status boxes_of_level(const sph_level *level, uint32_t frames, box *boxes)
{
    sph_level_arrays a = {.struct_size = sizeof a};
    const sph_status status = sph_level_get_arrays(level, &a);
    for (uint32_t f = 0; f < frames && status == SPH_OK; ++f)
        box_add(&boxes[f], a.centers + (size_t)f * a.sphere_count * 3,
                a.radii + (a.radii_per_frame ? (size_t)f * a.sphere_count : 0), a.sphere_count);
    return status;
}

/* The box in every frame, of what comes first: overlay, input, the first hierarchy, all levels. */
static sph_status find_boxes(session *s, const sources *from, box **boxes, uint32_t *frames)
{
    const sph_animation *a = from->overlay != NULL ? from->overlay : from->input;
    const sph_hierarchy *h = NULL;
    sph_status status = SPH_OK;
    *frames = a != NULL ? sph_animation_frame_count(a) : UINT32_MAX;
    for (size_t i = from->count; i-- > 0 && a == NULL;)
        h = from->items[i].hierarchy != NULL ? from->items[i].hierarchy : h;
    if (h != NULL) *frames = sph_hierarchy_frame_count(h);
    for (size_t i = 0; i < from->count && a == NULL && h == NULL; ++i)
        if (sph_level_frame_count(from->items[i].level) < *frames)
            *frames = sph_level_frame_count(from->items[i].level);
    *boxes = sph_context_allocate(s->context, *frames, sizeof **boxes);
    if (*boxes == NULL) return sph_context_fail(s->context, SPH_E_NOMEM, "out of memory");
    for (uint32_t f = 0; f < *frames; ++f)
        box_clear(&(*boxes)[f]);
    if (a != NULL) return boxes_of_animation(s, a, *boxes);
    if (h != NULL) return boxes_of_hierarchy(s, h, *boxes);
    for (size_t i = 0; i < from->count && status == SPH_OK; ++i)
        status = boxes_of_level(from->items[i].level, *frames, *boxes);
    return status;
}

static sph_status frame_scene(session *s, const sources *from, scene *sc)
{
    box *boxes = NULL;
    uint32_t frames = 0;
    sph_status status = find_boxes(s, from, &boxes, &frames);
    if (status == SPH_OK) sc->middles = sph_context_allocate(s->context, frames, 3 * sizeof *sc->middles);
    if (status == SPH_OK && sc->middles == NULL) status = sph_context_fail(s->context, SPH_E_NOMEM, "out of memory");
    sc->middle_count = frames;
    sc->ground = INFINITY;
    sc->mean = (box){{0, 0, 0}, {0, 0, 0}};
    for (uint32_t f = 0; f < frames && status == SPH_OK; ++f) {
        sc->ground = fmin(sc->ground, boxes[f].low[1]);
        for (int k = 0; k < 3; ++k) {
            sc->mean.low[k] += boxes[f].low[k] / frames;
            sc->mean.high[k] += boxes[f].high[k] / frames;
            sc->middles[3 * (size_t)f + (size_t)k] = (boxes[f].low[k] + boxes[f].high[k]) / 2;
        }
    }
    sph_context_release(s->context, boxes);
    if (status != SPH_OK) return status;
    if (!isfinite(box_diagonal(&sc->mean)))
        return sph_context_fail(s->context, SPH_E_INVALID, "a position is not finite: there is nothing to aim at");
    for (int k = 0; k < 3 && !(box_diagonal(&sc->mean) > 0); ++k) { /* a single point */
        sc->mean.low[k] -= 1;
        sc->mean.high[k] += 1;
    }
    return SPH_OK;
}

static int open_source(session *s, const scene_options *o, const char *path, source *out)
{
    int32_t kind = SPH_IO_LEVEL;
    sph_status status = SPH_OK;
    if (name_ends(path, ".sphm")) status = sph_io_identify(s->context, path, &kind);
    if (status == SPH_OK && kind == SPH_IO_HIERARCHY) {
        if (o->count_count == 0)
            return failure("%s: holds a hierarchy; say which of its levels, as in --levels 46,20,10", path);
        status = sph_io_load_hierarchy(s->context, path, &out->hierarchy);
        return status == SPH_OK ? DONE : session_fail(s, status, path);
    }
    if (status != SPH_OK) return session_fail(s, status, path);
    return load_level(s, path, &out->level);
}

static int open_mesh(session *s, const scene_options *o, const arguments *paths, sph_animation **out)
{
    const sph_status status = input_open(s, &o->input, paths, &o->input.frames, out);
    return status == SPH_OK ? DONE : session_fail(s, status, paths->items[0]);
}

static int open_sources(session *s, const scene_options *o, const arguments *paths, sources *from)
{
    arguments meshes = {calloc(paths->count + 1, sizeof *meshes.items), 0}, overlay = {&meshes.items[paths->count], 1};
    int result = DONE;
    from->items = calloc(paths->count, sizeof *from->items);
    if (meshes.items == NULL || (from->items == NULL && paths->count > 0)) result = failure("out of memory");
    for (size_t i = 0; i < paths->count && result == DONE; ++i) {
        if (!scene_is_level(paths->items[i]))
            meshes.items[meshes.count++] = paths->items[i];
        else
            result = open_source(s, o, paths->items[i], &from->items[from->count++]);
    }
    if (result == DONE && meshes.count > 0) result = open_mesh(s, o, &meshes, &from->input);
    if (result == DONE && o->overlay != NULL) {
        meshes.items[paths->count] = o->overlay;
        result = open_mesh(s, o, &overlay, &from->overlay);
    }
    free(meshes.items);
    return result;
}

static sph_status add_level(session *s, scene *sc, const sph_level *level)
{
    return figure_of_level(&sc->figures[sc->figure_count++], s->context, level, LINE * box_diagonal(&sc->mean));
}

static sph_status add_levels(session *s, const scene_options *o, scene *sc, const sph_hierarchy *h)
{
    sph_status status = SPH_OK;
    for (size_t i = 0; i < o->count_count && status == SPH_OK; ++i) {
        sph_level *level = NULL;
        status = sph_level_create(h, o->counts[i], &level);
        if (status == SPH_OK) status = add_level(s, sc, level);
        sph_level_destroy(level);
    }
    return status;
}

static sph_status colour_by_bones(session *s, const char *path, figure *f)
{
    sph_io_rig *rig = NULL;
    sph_status status = sph_io_open_rig(s->context, path, NULL, &rig);
    if (status == SPH_OK) status = figure_colour_by_bones(f, s->context, sph_io_rig_skin(rig));
    sph_io_rig_destroy(rig);
    return status;
}

/* The input first, then levels in the order in which they were named. */
static sph_status make_figures(session *s, const scene_options *o, sources *from, scene *sc)
{
    const double line = LINE * box_diagonal(&sc->mean);
    sph_status status = SPH_OK;
    if (from->input != NULL) {
        status = figure_of_animation(&sc->figures[sc->figure_count++], s->context, from->input, line);
        from->input = NULL;
        if (status == SPH_OK && o->bones != NULL) status = colour_by_bones(s, o->bones, &sc->figures[0]);
    }
    if (from->overlay != NULL && status == SPH_OK) {
        status = figure_of_animation(&sc->overlay, s->context, from->overlay, line);
        from->overlay = NULL;
    }
    for (size_t i = 0; i < from->count && status == SPH_OK; ++i)
        status = from->items[i].hierarchy != NULL ? add_levels(s, o, sc, from->items[i].hierarchy)
                                                  : add_level(s, sc, from->items[i].level);
    return status;
}

/* A level that is to be seen through the overlay must have its frames. */
static int check_frames(const scene *sc)
{
    for (size_t i = 0; i < sc->figure_count && sc->overlay.query != NULL; ++i)
        if (sc->figures[i].frame_count != sc->overlay.frame_count)
            return failure("--overlay: it has %u frames, a level %u; --input-frames A:B:STEP picks those that the "
                           "level was built from",
                           sc->overlay.frame_count, sc->figures[i].frame_count);
    return DONE;
}

int scene_open(session *s, const scene_options *o, const arguments *paths, scene *sc)
{
    sources from = {0};
    int result;
    sph_status status;
    *sc = (scene){0};
    result = open_sources(s, o, paths, &from);
    if (result == DONE) {
        sc->figures = calloc(paths->count * (o->count_count + 1) + 1, sizeof *sc->figures);
        if (sc->figures == NULL) result = failure("out of memory");
    }
    if (result == DONE) {
        status = frame_scene(s, &from, sc);
        if (status == SPH_OK) status = make_figures(s, o, &from, sc);
        if (status != SPH_OK) result = session_fail(s, status, NULL);
    }
    if (result == DONE) result = check_frames(sc);
    for (size_t i = 0; i < from.count; ++i) {
        sph_hierarchy_destroy(from.items[i].hierarchy);
        sph_level_destroy(from.items[i].level);
    }
    sph_animation_destroy(from.input);
    sph_animation_destroy(from.overlay);
    free(from.items);
    return result;
}

void scene_close(session *s, scene *sc)
{
    for (size_t i = 0; i < sc->figure_count; ++i)
        figure_close(&sc->figures[i], s->context);
    figure_close(&sc->overlay, s->context);
    sph_context_release(s->context, sc->middles);
    free(sc->figures);
    *sc = (scene){0};
}
