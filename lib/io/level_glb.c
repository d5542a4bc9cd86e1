/* SPDX-License-Identifier: MIT */
/*
 * A level as a GLB that any viewer plays. Every sphere is a node that an animation moves, with one small sphere for a
 * mesh that they all share. Triangles and edges are a skinned mesh whose vertices are all at the origin of a joint: the
 * same nodes are its joints, so it follows them without data of its own.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "io/level_glb.h"

enum { GRID = 6, SIDE = (GRID + 1) * (GRID + 1), BALL_VERTICES = 6 * SIDE, BALL_CORNERS = 6 * GRID * GRID * 6 };
enum { JOINT_LIMIT = 65535, FRAMES_PER_SECOND = 30 };

/* What has no bytes has no view. */
static void add_view(sph__io_glb *w, int which, uint64_t size, int target)
{
    if (size != 0) w->view[which] = sph__io_gltf_add_view(&w->file, size, target);
}

static void add_accessor(sph__io_glb *w, int which, uint64_t offset, int type, const char *width, size_t count,
                         const char *more)
{
    (void)sph__io_gltf_add_accessor(&w->file, w->view[which], offset, type, width, count, more);
}

static bool has_simplices(const sph_level_arrays *a)
{
    return a->triangle_count + a->edge_count > 0;
}

static void describe_buffers(sph__io_glb *w)
{
    const sph_level_arrays *a = w->a;
    const uint64_t joints = has_simplices(a) ? a->sphere_count : 0, frames = a->frame_count > 1 ? a->frame_count : 0;
    add_view(w, BALL, BALL_VERTICES * 12, SPH__GLTF_VERTICES);
    add_view(w, BALL_INDICES, BALL_CORNERS * 2, SPH__GLTF_INDICES);
    add_view(w, ORIGINS, joints * 12, SPH__GLTF_VERTICES);
    add_view(w, JOINTS, joints * 8, SPH__GLTF_VERTICES);
    add_view(w, WEIGHTS, joints * 16, SPH__GLTF_VERTICES);
    add_view(w, TRIANGLES, (uint64_t)a->triangle_count * 12, SPH__GLTF_INDICES);
    add_view(w, EDGES, (uint64_t)a->edge_count * 8, SPH__GLTF_INDICES);
    add_view(w, TIMES, frames * 4, 0);
    add_view(w, CENTERS, frames * a->sphere_count * 12, 0);
    add_view(w, SCALES, a->radii_per_frame ? frames * a->sphere_count * 12 : 0, 0);
}

static void describe_accessors(sph__io_glb *w)
{
    const sph_level_arrays *a = w->a;
    char last[SPH__IO_FLOAT_TEXT], range[96];
    (void)sph__io_format_float(last, (float)(a->frame_count - 1) / FRAMES_PER_SECOND);
    snprintf(range, sizeof range, ",\"min\":[0],\"max\":[%s]", last);
    add_accessor(w, BALL, 0, SPH__GLTF_FLOAT, "VEC3", BALL_VERTICES, ",\"min\":[-1,-1,-1],\"max\":[1,1,1]");
    add_accessor(w, BALL_INDICES, 0, SPH__GLTF_U16, "SCALAR", BALL_CORNERS, "");
    if (has_simplices(a)) {
        add_accessor(w, ORIGINS, 0, SPH__GLTF_FLOAT, "VEC3", a->sphere_count, ",\"min\":[0,0,0],\"max\":[0,0,0]");
        add_accessor(w, JOINTS, 0, SPH__GLTF_U16, "VEC4", a->sphere_count, "");
        add_accessor(w, WEIGHTS, 0, SPH__GLTF_FLOAT, "VEC4", a->sphere_count, "");
    }
    if (a->triangle_count > 0) add_accessor(w, TRIANGLES, 0, SPH__GLTF_U32, "SCALAR", 3 * a->triangle_count, "");
    if (a->edge_count > 0) add_accessor(w, EDGES, 0, SPH__GLTF_U32, "SCALAR", 2 * a->edge_count, "");
    if (a->frame_count > 1) {
        add_accessor(w, TIMES, 0, SPH__GLTF_FLOAT, "SCALAR", a->frame_count, range);
        for (uint32_t i = 0; i < a->sphere_count; ++i)
            add_accessor(w, CENTERS, (uint64_t)i * a->frame_count * 12, SPH__GLTF_FLOAT, "VEC3", a->frame_count, "");
        for (uint32_t i = 0; i < a->sphere_count && a->radii_per_frame; ++i)
            add_accessor(w, SCALES, (uint64_t)i * a->frame_count * 12, SPH__GLTF_FLOAT, "VEC3", a->frame_count, "");
    }
}

/* Node 0 holds the spheres, 1 to K, as the joints of a skin must have a common root; K + 1 shows the simplices. */
static void describe_nodes(sph__io_glb *w)
{
    const sph_level_arrays *a = w->a;
    const uint32_t first = a->sphere_count + 1 + has_simplices(a); /* node that is free */
    sph__io_text_add(&w->file.json, ",\"scene\":0,\"scenes\":[{\"nodes\":[0");
    if (has_simplices(a)) sph__io_text_add(&w->file.json, ",%u", (unsigned)a->sphere_count + 1);
    if (w->of != NULL) sph__io_glb_scene_extras(w, first);
    sph__io_text_add(&w->file.json, "%s}],\"nodes\":[{\"name\":\"spheres\",\"children\":[", w->of == NULL ? "]" : "");
    for (uint32_t i = 0; i < a->sphere_count; ++i)
        sph__io_text_add(&w->file.json, "%s%u", i == 0 ? "" : ",", (unsigned)i + 1);
    sph__io_text_add(&w->file.json, "]}");
    for (uint32_t i = 0; i < a->sphere_count; ++i) {
        sph__io_text_add(&w->file.json, ",{\"mesh\":0,\"translation\":[");
        for (int k = 0; k < 3; ++k) {
            if (k > 0) sph__io_text_add(&w->file.json, ",");
            sph__io_text_float(&w->file.json, a->centers[3 * (size_t)i + k]);
        }
        sph__io_text_add(&w->file.json, "],\"scale\":[");
        for (int k = 0; k < 3; ++k) {
            if (k > 0) sph__io_text_add(&w->file.json, ",");
            sph__io_text_float(&w->file.json, a->radii[i]);
        }
        sph__io_text_add(&w->file.json, "]");
        if (w->of != NULL) sph__io_glb_sphere_extras(w, i);
        sph__io_text_add(&w->file.json, "}");
    }
    if (has_simplices(a)) sph__io_text_add(&w->file.json, ",{\"name\":\"simplices\",\"mesh\":1,\"skin\":0}");
    if (w->of != NULL) sph__io_glb_primitives(w, first);
    sph__io_text_add(&w->file.json, "]");
}

static void describe_meshes(sph__io_glb *w)
{
    static const char ATTRIBUTES[] = "{\"attributes\":{\"POSITION\":2,\"JOINTS_0\":3,\"WEIGHTS_0\":4},\"material\":1,";
    const sph_level_arrays *a = w->a;
    sph__io_text_add(
        &w->file.json,
        ",\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.9,0.55,0.2,1],\"metallicFactor\":0}},"
        "{\"doubleSided\":true,\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.25,0.5,0.8,1],");
    sph__io_text_add(
        &w->file.json,
        "\"metallicFactor\":0}}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":0},"
        "\"indices\":1,\"material\":0}]}");
    if (has_simplices(a)) {
        sph__io_text_add(&w->file.json, ",{\"primitives\":[");
        if (a->triangle_count > 0)
            sph__io_text_add(&w->file.json, "%s\"indices\":5}%s", ATTRIBUTES, a->edge_count > 0 ? "," : "");
        if (a->edge_count > 0)
            sph__io_text_add(&w->file.json, "%s\"indices\":%d,\"mode\":1}", ATTRIBUTES, a->triangle_count > 0 ? 6 : 5);
        sph__io_text_add(&w->file.json, "]}],\"skins\":[{\"skeleton\":0,\"joints\":[");
        for (uint32_t i = 0; i < a->sphere_count; ++i)
            sph__io_text_add(&w->file.json, "%s%u", i == 0 ? "" : ",", (unsigned)i + 1);
        sph__io_text_add(&w->file.json, "]}");
    }
    sph__io_text_add(&w->file.json, "]");
}

static void describe_animation(sph__io_glb *w)
{
    const sph_level_arrays *a = w->a;
    const unsigned channels = a->sphere_count * (a->radii_per_frame ? 2 : 1);
    const unsigned times = w->file.accessor_count - channels - 1;
    if (a->frame_count < 2) return;
    sph__io_text_add(&w->file.json, ",\"animations\":[{\"channels\":[");
    for (unsigned i = 0; i < channels; ++i)
        sph__io_text_add(&w->file.json, "%s{\"sampler\":%u,\"target\":{\"node\":%u,\"path\":\"%s\"}}",
                         i == 0 ? "" : ",", i, i % a->sphere_count + 1, i < a->sphere_count ? "translation" : "scale");
    sph__io_text_add(&w->file.json, "],\"samplers\":[");
    for (unsigned i = 0; i < channels; ++i)
        sph__io_text_add(&w->file.json, "%s{\"input\":%u,\"output\":%u}", i == 0 ? "" : ",", times, times + 1 + i);
    sph__io_text_add(&w->file.json, "]}]");
}

/* --- bytes --- */

/* The six sides of a cube, each a grid blown up to the unit sphere. */
static void put_ball(sph__io_output *o)
{
    for (unsigned i = 0; i < BALL_VERTICES; ++i) {
        const unsigned side = i / SIDE, axis = side / 2;
        const float sign = side % 2 == 0 ? 1 : -1;
        const float u = sign * (2 * (float)(i % SIDE % (GRID + 1)) / GRID - 1);
        const float v = 2 * (float)(i % SIDE / (GRID + 1)) / GRID - 1, length = sqrtf(1 + u * u + v * v);
        float p[3];
        p[axis] = sign / length;
        p[(axis + 1) % 3] = u / length;
        p[(axis + 2) % 3] = v / length;
        for (int k = 0; k < 3; ++k)
            sph__io_put_float(o, p[k]);
    }
    for (unsigned cell = 0; cell < 6 * GRID * GRID; ++cell) {
        const unsigned corner = cell / (GRID * GRID) * SIDE + cell % (GRID * GRID) / GRID * (GRID + 1) + cell % GRID;
        const unsigned corners[6] = {0, 1, GRID + 2, 0, GRID + 2, GRID + 1};
        for (int k = 0; k < 6; ++k)
            sph__io_put(o, corner + corners[k], 2);
    }
}

static void put_simplices(sph__io_output *o, const sph_level_arrays *a)
{
    const uint32_t count = has_simplices(a) ? a->sphere_count : 0;
    for (uint32_t i = 0; i < 3 * count; ++i)
        sph__io_put_float(o, 0);
    for (uint32_t i = 0; i < 4 * count; ++i)
        sph__io_put(o, i % 4 == 0 ? i / 4 : 0, 2);
    for (uint32_t i = 0; i < 4 * count; ++i)
        sph__io_put_float(o, i % 4 == 0 ? 1 : 0);
    for (size_t i = 0; i < 3 * a->triangle_count; ++i)
        sph__io_put(o, a->triangles[i], 4);
    for (size_t i = 0; i < 2 * a->edge_count; ++i)
        sph__io_put(o, a->edges[i], 4);
}

static void put_motion(sph__io_output *o, const sph_level_arrays *a)
{
    if (a->frame_count < 2) return;
    for (uint32_t f = 0; f < a->frame_count; ++f)
        sph__io_put_float(o, (float)f / FRAMES_PER_SECOND);
    for (uint32_t i = 0; i < a->sphere_count; ++i)
        for (uint32_t f = 0; f < a->frame_count; ++f)
            for (int k = 0; k < 3; ++k)
                sph__io_put_float(o, a->centers[3 * ((size_t)f * a->sphere_count + i) + k]);
    for (uint32_t i = 0; i < a->sphere_count && a->radii_per_frame; ++i)
        for (uint32_t f = 0; f < a->frame_count; ++f)
            for (int k = 0; k < 3; ++k)
                sph__io_put_float(o, a->radii[(size_t)f * a->sphere_count + i]);
}

static void describe(sph__io_glb *w)
{
    describe_buffers(w);
    describe_accessors(w);
    describe_nodes(w);
    describe_meshes(w);
    describe_animation(w);
    sph__io_gltf_close_json(&w->file, NULL);
}

static void write_glb(sph__io_output *output, const sph_level_arrays *arrays, const sph__io_export *of)
{
    sph_context *context = output->context;
    sph__io_glb w = {.a = arrays, .of = of};
    sph_status status = SPH_OK;
    sph__io_gltf_writer_open(&w.file, context);
    if (arrays->sphere_count > JOINT_LIMIT)
        status = sph__io_fail(context, SPH_E_LIMIT, "%s: %u spheres, a GLB takes %d", sph__io_shown(output->target),
                              (unsigned)arrays->sphere_count, JOINT_LIMIT);
    else if (of != NULL && (w.used = sph__io_export_used(of)) == NULL)
        status = sph__io_fail_memory(context, output->target);
    if (status == SPH_OK) {
        describe(&w);
        status = sph__io_gltf_check(&w.file, output->target);
    }
    if (status == SPH_OK) {
        sph__io_gltf_put_head(output, &w.file.json, w.file.binary);
        put_ball(output);
        put_simplices(output, arrays);
        put_motion(output, arrays);
    } else if (output->status == SPH_OK) {
        output->status = status;
    }
    sph__io_gltf_writer_release(&w.file);
    sph_context_release(context, w.used);
}

void sph__io_level_glb_write(sph__io_output *output, const sph_level_arrays *arrays)
{
    write_glb(output, arrays, NULL);
}

void sph__io_export_glb(sph__io_output *output, sph__io_export *e)
{
    write_glb(output, &e->a, e);
}
