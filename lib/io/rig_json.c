/* SPDX-License-Identifier: MIT */
/* What a rig's glTF says of its bytes. Nodes are the joints, by number; then, over several roots, one for all; then the
 * mesh. */
#include <float.h>
#include <stdio.h>

#include "io/rig.h"

static const char *width_of(unsigned components)
{
    static const char *const WIDTHS[] = {"SCALAR", "", "VEC3", "VEC4"};
    return WIDTHS[components - 1];
}

/* A view with one accessor. */
static unsigned add_array(sph__io_gltf_writer *w, int type, unsigned size, unsigned components, size_t count,
                          int target, const char *more)
{
    const unsigned view = sph__io_gltf_add_view(w, (uint64_t)size * components * count, target);
    return sph__io_gltf_add_accessor(w, view, 0, type, width_of(components), count, more);
}

/* ,"min":[..],"max":[..] of the rest pose */
static void describe_bounds(const sph__rig *rig, sph__io_text *t)
{
    float low[3] = {FLT_MAX, FLT_MAX, FLT_MAX}, high[3] = {-FLT_MAX, -FLT_MAX, -FLT_MAX};
    for (size_t i = 0; i < 3 * (size_t)rig->skin.vertex_count; ++i) {
        const float x = rig->skin.rest[i];
        if (x < low[i % 3]) low[i % 3] = x;
        if (x > high[i % 3]) high[i % 3] = x;
    }
    sph__io_text_add(t, ",\"min\":");
    sph__io_text_floats(t, low, 3);
    sph__io_text_add(t, ",\"max\":");
    sph__io_text_floats(t, high, 3);
    sph__io_text_bytes(t, "", 1);
}

static void describe_mesh(const sph__rig *rig, sph__io_gltf_writer *w)
{
    const size_t n = rig->skin.vertex_count, corners = 3 * rig->skin.triangle_count;
    const int32_t kind = rig->options.weights;
    const char *normalized = kind == SPH_IO_WEIGHTS_FLOAT ? "" : ",\"normalized\":true";
    const int type = kind == SPH_IO_WEIGHTS_FLOAT ? SPH__GLTF_FLOAT
                     : kind == SPH_IO_WEIGHTS_U8  ? SPH__GLTF_U8
                                                  : SPH__GLTF_U16;
    const unsigned size = kind == SPH_IO_WEIGHTS_FLOAT ? 4 : kind == SPH_IO_WEIGHTS_U8 ? 1 : 2;
    sph__io_text *t = &w->json, bounds = {.context = rig->context};
    describe_bounds(rig, &bounds);
    if (bounds.failed) {
        t->failed = true;
    } else {
        sph__io_text_add(t, ",\"meshes\":[{\"name\":\"mesh\",\"primitives\":[{\"material\":0,\"attributes\":{");
        sph__io_text_add(t, "\"POSITION\":%u,",
                         add_array(w, SPH__GLTF_FLOAT, 4, 3, n, SPH__GLTF_VERTICES, bounds.text));
        sph__io_text_add(t, "\"NORMAL\":%u", add_array(w, SPH__GLTF_FLOAT, 4, 3, n, SPH__GLTF_VERTICES, ""));
    }
    sph__io_text_release(&bounds);
    for (unsigned s = 0; s < rig->set_count; ++s) {
        sph__io_text_add(t, ",\"JOINTS_%u\":%u", s,
                         add_array(w, rig->wide_joints ? SPH__GLTF_U16 : SPH__GLTF_U8, rig->wide_joints ? 2 : 1, 4, n,
                                   SPH__GLTF_VERTICES, ""));
        sph__io_text_add(t, ",\"WEIGHTS_%u\":%u", s, add_array(w, type, size, 4, n, SPH__GLTF_VERTICES, normalized));
    }
    if (corners == 0)
        sph__io_text_add(t, "},\"mode\":0}]}]");
    else
        sph__io_text_add(t, "},\"indices\":%u}]}]",
                         add_array(w, rig->wide_indices ? SPH__GLTF_U32 : SPH__GLTF_U16, rig->wide_indices ? 4 : 2, 1,
                                   corners, SPH__GLTF_INDICES, ""));
    sph__io_text_add(t, ",\"materials\":[{\"doubleSided\":true,\"pbrMetallicRoughness\":{"
                        "\"baseColorFactor\":[0.8,0.8,0.8,1],\"metallicFactor\":0,\"roughnessFactor\":0.7}}]");
}

/* The joint that all others hang on, or the node that stands in for it. */
static uint32_t top_node(const sph__rig *rig)
{
    uint32_t roots = 0;
    for (uint32_t j = 0; j < rig->joints.joint_count; ++j)
        roots += rig->joints.parents[j] == SPH_NO_JOINT;
    return roots == 1 ? rig->joints.order[0] : rig->joints.joint_count;
}

/* ,"children":[..] of a joint, or of the node above all; none where there are none. */
static void describe_children(const uint32_t *starts, const uint32_t *children, uint32_t node, sph__io_text *t)
{
    for (uint32_t i = starts[node]; i < starts[node + 1]; ++i)
        sph__io_text_add(t, "%s%u", i == starts[node] ? ",\"children\":[" : ",", (unsigned)children[i]);
    if (starts[node] < starts[node + 1]) sph__io_text_add(t, "]");
}

static void describe_joint(const sph__rig *rig, uint32_t joint, sph__io_text *t)
{
    if (joint == sph__rig_root(rig))
        sph__io_text_add(t, "{\"name\":\"root\"");
    else
        sph__io_text_add(t, "{\"name\":\"bone_%u\"", (unsigned)joint);
    sph__io_text_add(t, ",\"translation\":");
    sph__io_text_floats(t, rig->rest + 3 * (size_t)joint, 3);
}

/* Children of each joint, and of none: in rising order, by counting. */
static void list_children(const sph__rig *rig, uint32_t *starts, uint32_t *children)
{
    const uint32_t count = rig->joints.joint_count;
    for (uint32_t j = 0; j < count + 3; ++j)
        starts[j] = 0;
    for (uint32_t j = 0; j < count; ++j) {
        const uint32_t parent = rig->joints.parents[j];
        ++starts[(parent == SPH_NO_JOINT ? count : parent) + 2];
    }
    for (uint32_t j = 2; j < count + 3; ++j)
        starts[j] += starts[j - 1];
    for (uint32_t j = 0; j < count; ++j) {
        const uint32_t parent = rig->joints.parents[j];
        children[starts[(parent == SPH_NO_JOINT ? count : parent) + 1]++] = j;
    }
}

static void describe_nodes(const sph__rig *rig, sph__io_gltf_writer *w)
{
    const uint32_t count = rig->joints.joint_count, top = top_node(rig), mesh = count + (top == count);
    uint32_t *starts = sph_context_allocate(rig->context, (size_t)count + 3, sizeof *starts);
    uint32_t *children = sph_context_allocate(rig->context, count, sizeof *children);
    sph__io_text *t = &w->json;
    if (starts == NULL || children == NULL) {
        t->failed = true;
    } else {
        list_children(rig, starts, children);
        sph__io_text_add(t, ",\"scene\":0,\"scenes\":[{\"nodes\":[%u,%u]}],\"nodes\":[", (unsigned)top, (unsigned)mesh);
        for (uint32_t j = 0; j < count; ++j) {
            sph__io_text_add(t, "%s", j == 0 ? "" : ",");
            describe_joint(rig, j, t);
            describe_children(starts, children, j, t);
            sph__io_text_add(t, "}");
        }
        if (top == count) {
            sph__io_text_add(t, ",{\"name\":\"rig\"");
            describe_children(starts, children, count, t);
            sph__io_text_add(t, "}");
        }
        sph__io_text_add(t, ",{\"name\":\"mesh\",\"mesh\":0,\"skin\":0}]");
    }
    sph_context_release(rig->context, starts);
    sph_context_release(rig->context, children);
}

static void describe_skin(const sph__rig *rig, sph__io_gltf_writer *w)
{
    const uint32_t count = rig->joints.joint_count;
    const unsigned view = sph__io_gltf_add_view(w, (uint64_t)count * 64, 0);
    sph__io_text *t = &w->json;
    sph__io_text_add(t, ",\"skins\":[{\"name\":\"skin\",\"skeleton\":%u,\"inverseBindMatrices\":%u,\"joints\":[",
                     (unsigned)top_node(rig),
                     sph__io_gltf_add_accessor(w, view, 0, SPH__GLTF_FLOAT, "MAT4", count, ""));
    for (uint32_t j = 0; j < count; ++j)
        sph__io_text_add(t, "%s%u", j == 0 ? "" : ",", (unsigned)j);
    sph__io_text_add(t, "]}]");
}

double sph__rig_rate(const sph__rig *rig, const sph_skin_clip *clip)
{
    return clip->frames_per_second > 0 ? clip->frames_per_second : rig->options.frames_per_second;
}

static void describe_clip(const sph__rig *rig, const sph_skin_clip *clip, sph__io_gltf_writer *w)
{
    const uint32_t frames = clip->frame_count, bones = rig->joints.bone_count;
    const float last = (float)((frames - 1) / sph__rig_rate(rig, clip));
    char text[SPH__IO_FLOAT_TEXT], range[64];
    unsigned times, view;
    sph__io_text *t = &w->json;
    (void)sph__io_format_float(text, last);
    snprintf(range, sizeof range, ",\"min\":[0],\"max\":[%s]", text);
    times = add_array(w, SPH__GLTF_FLOAT, 4, 1, frames, 0, range);
    view = sph__io_gltf_add_view(w, (uint64_t)bones * frames * 28, 0);
    sph__io_text_add(t, "\"channels\":[");
    for (uint32_t i = 0; i < 2 * bones; ++i)
        sph__io_text_add(t, "%s{\"sampler\":%u,\"target\":{\"node\":%u,\"path\":\"%s\"}}", i == 0 ? "" : ",",
                         (unsigned)i, (unsigned)(i / 2), i % 2 == 0 ? "rotation" : "translation");
    sph__io_text_add(t, "],\"samplers\":[");
    for (uint32_t i = 0; i < 2 * bones; ++i) {
        const uint64_t offset = ((uint64_t)i / 2 * 28 + (i % 2 == 0 ? 0 : 16)) * frames;
        const unsigned output =
            sph__io_gltf_add_accessor(w, view, offset, SPH__GLTF_FLOAT, i % 2 == 0 ? "VEC4" : "VEC3", frames, "");
        sph__io_text_add(t, "%s{\"input\":%u,\"output\":%u}", i == 0 ? "" : ",", times, output);
    }
    sph__io_text_add(t, "]}");
}

void sph__rig_describe(const sph__rig *rig, sph__io_gltf_writer *w, const char *uri)
{
    sph__io_text *t = &w->json;
    describe_mesh(rig, w);
    describe_nodes(rig, w);
    describe_skin(rig, w);
    for (uint32_t c = 0; c < rig->skin.clip_count; ++c) {
        const sph_skin_clip *clip = &rig->skin.clips[c];
        sph__io_text_add(t, "%s{\"name\":", c == 0 ? ",\"animations\":[" : ",");
        if (clip->name[0] != '\0')
            sph__io_text_string(t, clip->name);
        else
            sph__io_text_add(t, "\"clip_%u\"", (unsigned)c);
        sph__io_text_add(t, ",");
        describe_clip(rig, clip, w);
    }
    if (rig->skin.clip_count != 0) sph__io_text_add(t, "]");
    sph__io_gltf_close_json(w, uri);
}
