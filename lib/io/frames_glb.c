/* SPDX-License-Identifier: MIT */
/* Frames of one mesh as a GLB: the first frame, each frame's offsets from it as a morph target, and their weights. */
#include <math.h>

#include "io/gltf_write.h"

enum { FRAME_LIMIT = 4096 };

typedef struct frames {
    const sph_io_frames *f;
    sph__io_gltf_writer w;
} frames;

/* Offsets of a frame from the first. */
static float offset_of(const sph_io_frames *f, uint32_t frame, size_t i)
{
    return frame == 0 ? f->positions[i] : f->positions[3 * (size_t)f->vertex_count * frame + i] - f->positions[i];
}

/* Accessor of a frame, with the bounds that the format wants. */
static unsigned add_frame(frames *s, unsigned view, uint64_t offset, uint32_t frame)
{
    float low[3] = {0, 0, 0}, high[3] = {0, 0, 0};
    sph__io_text more = {.context = s->w.json.context};
    unsigned accessor;
    for (size_t i = 0; i < 3 * (size_t)s->f->vertex_count; ++i) {
        const float x = offset_of(s->f, frame, i);
        if (i < 3 || x < low[i % 3]) low[i % 3] = x;
        if (i < 3 || x > high[i % 3]) high[i % 3] = x;
    }
    sph__io_text_add(&more, ",\"min\":");
    sph__io_text_floats(&more, low, 3);
    sph__io_text_add(&more, ",\"max\":");
    sph__io_text_floats(&more, high, 3);
    sph__io_text_bytes(&more, "", 1);
    if (more.failed) s->w.json.failed = true;
    accessor = sph__io_gltf_add_accessor(&s->w, view, offset, SPH__GLTF_FLOAT, "VEC3", s->f->vertex_count,
                                         more.failed ? "" : more.text);
    sph__io_text_release(&more);
    return accessor;
}

static void describe(frames *s, const char *name)
{
    const sph_io_frames *f = s->f;
    const uint64_t size = 12 * (uint64_t)f->vertex_count, count = f->frame_count;
    const float end = (float)((double)(count - 1) / f->frames_per_second);
    sph__io_text *json = &s->w.json;
    unsigned view = sph__io_gltf_add_view(&s->w, size, SPH__GLTF_VERTICES), first = add_frame(s, view, 0, 0), times;
    sph__io_text more = {.context = json->context};
    view = sph__io_gltf_add_view(&s->w, 12 * (uint64_t)f->triangle_count, SPH__GLTF_INDICES);
    (void)sph__io_gltf_add_accessor(&s->w, view, 0, SPH__GLTF_U32, "SCALAR", 3 * f->triangle_count, "");
    sph__io_text_add(json, ",\"scene\":0,\"scenes\":"
                           "[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"name\":");
    sph__io_text_string(json, name);
    sph__io_text_add(json, ",\"primitives\":[{\"attributes\":{\"POSITION\":%u},\"indices\":%u", first, first + 1);
    if (count > 1) {
        sph__io_text_add(json, ",\"targets\":[");
        view = sph__io_gltf_add_view(&s->w, size * (count - 1), SPH__GLTF_VERTICES);
        for (uint32_t frame = 1; frame < count; ++frame)
            sph__io_text_add(json, "%s{\"POSITION\":%u}", frame == 1 ? "" : ",",
                             add_frame(s, view, size * (frame - 1), frame));
        sph__io_text_add(json, "]");
    }
    sph__io_text_add(json, "}]}]");
    if (count < 2) return;
    sph__io_text_add(&more, ",\"min\":[0],\"max\":");
    sph__io_text_floats(&more, &end, 1);
    sph__io_text_bytes(&more, "", 1);
    if (more.failed) json->failed = true;
    view = sph__io_gltf_add_view(&s->w, 4 * count, 0);
    times = sph__io_gltf_add_accessor(&s->w, view, 0, SPH__GLTF_FLOAT, "SCALAR", count, more.failed ? "" : more.text);
    sph__io_text_release(&more);
    view = sph__io_gltf_add_view(&s->w, 4 * count * (count - 1), 0);
    (void)sph__io_gltf_add_accessor(&s->w, view, 0, SPH__GLTF_FLOAT, "SCALAR", count * (count - 1), "");
    sph__io_text_add(json, ",\"animations\":[{\"name\":");
    sph__io_text_string(json, name);
    sph__io_text_add(json,
                     ",\"samplers\":[{\"input\":%u,\"output\":%u}],\"channels\":[{\"sampler\":0,\"target\":"
                     "{\"node\":0,\"path\":\"weights\"}}]}]",
                     times, times + 1);
}

static void put_binary(const frames *s, sph__io_output *o)
{
    const sph_io_frames *f = s->f;
    const size_t numbers = 3 * (size_t)f->vertex_count;
    for (size_t i = 0; i < numbers; ++i)
        sph__io_put_float(o, f->positions[i]);
    for (size_t i = 0; i < 3 * f->triangle_count; ++i)
        sph__io_put(o, f->triangles[i], 4);
    for (uint32_t frame = 1; frame < f->frame_count; ++frame)
        for (size_t i = 0; i < numbers; ++i)
            sph__io_put_float(o, offset_of(f, frame, i));
    if (f->frame_count < 2) return;
    for (uint32_t frame = 0; frame < f->frame_count; ++frame)
        sph__io_put_float(o, (float)((double)frame / f->frames_per_second));
    for (uint32_t frame = 0; frame < f->frame_count; ++frame)
        for (uint32_t target = 1; target < f->frame_count; ++target)
            sph__io_put_float(o, target == frame ? 1.0f : 0.0f);
}

static sph_status check(sph_context *context, const sph_io_frames *f, const char *path)
{
    if (context == NULL || f == NULL || path == NULL || f->positions == NULL || f->triangles == NULL)
        return sph__io_fail(context, SPH_E_INVALID, "sph_io_save_frames_glb: an argument is NULL");
    if (f->struct_size != sizeof *f || f->vertex_count == 0 || f->frame_count == 0 || f->triangle_count == 0 ||
        f->triangle_count > UINT32_MAX / 12 || !(f->frames_per_second > 0) || !isfinite(f->frames_per_second))
        return sph__io_fail(context, SPH_E_INVALID, "sph_io_frames: a count or a rate is out of range");
    if (f->frame_count > FRAME_LIMIT)
        return sph__io_fail(context, SPH_E_LIMIT, "%s: %u frames, at most %d can be morph targets", sph__io_shown(path),
                            (unsigned)f->frame_count, FRAME_LIMIT);
    for (size_t i = 0; i < 3 * (size_t)f->vertex_count * f->frame_count; ++i)
        if (!isfinite(f->positions[i]))
            return sph__io_fail(context, SPH_E_INVALID, "vertex %zu of frame %zu is not finite",
                                i / 3 % f->vertex_count, i / 3 / f->vertex_count);
    for (size_t i = 0; i < 3 * f->triangle_count; ++i)
        if (f->triangles[i] >= f->vertex_count)
            return sph__io_fail(context, SPH_E_INVALID, "triangle %zu names vertex %u, of %u", i / 3,
                                (unsigned)f->triangles[i], (unsigned)f->vertex_count);
    return SPH_OK;
}

sph_status sph_io_save_frames_glb(sph_context *context, const sph_io_frames *f, const char *path)
{
    frames s = {.f = f};
    sph__io_output output;
    sph_status status = check(context, f, path);
    if (status != SPH_OK) return status;
    sph__io_gltf_writer_open(&s.w, context);
    describe(&s, f->name == NULL ? "" : f->name);
    sph__io_gltf_close_json(&s.w, NULL);
    status = sph__io_gltf_check(&s.w, path);
    if (status == SPH_OK) status = sph__io_output_open(context, path, &output);
    if (status == SPH_OK) {
        sph__io_gltf_put_head(&output, &s.w.json, s.w.binary);
        put_binary(&s, &output);
        status = output.status;
        if (status == SPH_OK) status = sph__io_output_finish(&output);
        if (status == SPH_OK) status = sph__io_output_commit(&output);
        sph__io_output_release(&output);
    }
    sph__io_gltf_writer_release(&s.w);
    return status;
}
