/* SPDX-License-Identifier: MIT */
/* sph_io_save_rig: a skin as a glTF that engines open. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "io/rig.h"

enum { OPTIONS_V1 = offsetof(sph_io_rig_options, frames_per_second) + sizeof(double) };
/* Node numbers and indices of joints are 16 bits; the keys of more frames than this no longer rise in floats. */
enum { JOINT_LIMIT = 65536, FRAME_LIMIT = 1 << 22, NARROW_JOINTS = 256, NARROW_VERTICES = 65535 };

static const sph_io_rig_options DEFAULTS = {
    .struct_size = sizeof(sph_io_rig_options), .weights = SPH_IO_WEIGHTS_FLOAT, .frames_per_second = SPH__IO_FPS};

void sph_io_rig_options_init(sph_io_rig_options *options, size_t size)
{
    sph__io_options_init(options, size, &DEFAULTS, sizeof DEFAULTS, OPTIONS_V1);
}

static sph_status read_options(sph_context *context, const sph_io_rig_options *in, sph_io_rig_options *o)
{
    sph_status status;
    *o = DEFAULTS;
    status = sph__io_options_read(context, "sph_io_rig_options", in, o, sizeof *o, OPTIONS_V1);
    if (status != SPH_OK) return status;
    if (o->flags != 0 || o->reserved0 != 0)
        return sph__io_fail(context, SPH_E_INVALID, "sph_io_rig_options: flags and reserved0 must be 0");
    if (o->weights < SPH_IO_WEIGHTS_FLOAT || o->weights > SPH_IO_WEIGHTS_U16)
        return sph__io_fail(context, SPH_E_INVALID, "sph_io_rig_options: weights is %d", (int)o->weights);
    if (!isfinite((float)o->frames_per_second) || !((float)o->frames_per_second > 0))
        return sph__io_fail(context, SPH_E_INVALID, "sph_io_rig_options: %g frames per second", o->frames_per_second);
    return SPH_OK;
}

static sph_status check_limits(const sph__rig *rig)
{
    if (rig->joints.bone_count != rig->skin.bone_count)
        return sph__io_fail(rig->context, SPH_E_INVALID, "the skeleton has %u bones, the skin %u",
                            (unsigned)rig->joints.bone_count, (unsigned)rig->skin.bone_count);
    if (rig->joints.joint_count > JOINT_LIMIT)
        return sph__io_fail(rig->context, SPH_E_LIMIT, "%s: %u joints, a glTF takes %d", sph__io_shown(rig->path),
                            (unsigned)rig->joints.joint_count, JOINT_LIMIT);
    for (uint32_t c = 0; c < rig->skin.clip_count; ++c) {
        const sph_skin_clip *clip = &rig->skin.clips[c];
        const double rate = sph__rig_rate(rig, clip);
        if (clip->frame_count > FRAME_LIMIT)
            return sph__io_fail(rig->context, SPH_E_LIMIT, "%s: clip %u has %u frames, more than %d",
                                sph__io_shown(rig->path), (unsigned)c, (unsigned)clip->frame_count, FRAME_LIMIT);
        if (!(1e-6 <= rate && rate <= 1e6))
            return sph__io_fail(rig->context, SPH_E_INVALID, "%s: clip %u has %g frames per second",
                                sph__io_shown(rig->path), (unsigned)c, rate);
    }
    return SPH_OK;
}

static void put_indices(const sph__rig *rig, sph__io_output *o)
{
    const size_t corners = 3 * rig->skin.triangle_count;
    for (size_t i = 0; i < corners; ++i)
        sph__io_put(o, rig->skin.triangles[i], rig->wide_indices ? 4 : 2);
    if (!rig->wide_indices && corners % 2 != 0) sph__io_put(o, 0, 2);
}

/* A matrix is written column by column. */
static void put_inverse_binds(const sph__rig *rig, sph__io_output *o)
{
    for (size_t j = 0; j < rig->joints.joint_count; ++j)
        for (int i = 0; i < 16; ++i)
            sph__io_put_float(o,
                              i >= 12 && i < 15 ? (float)-rig->joints.positions[3 * j + (size_t)i - 12] : i % 5 == 0);
}

static sph_status put_clip(const sph__rig *rig, const sph_skin_clip *clip, sph__io_output *o)
{
    const size_t size = (size_t)7 * rig->joints.bone_count, begin = size * clip->first_frame;
    const sph_status status = sph__rig_report(rig, "writing", 0.5, clip);
    for (uint32_t f = 0; f < clip->frame_count; ++f)
        sph__io_put_float(o, (float)(f / sph__rig_rate(rig, clip)));
    for (size_t i = begin; i < begin + size * clip->frame_count; ++i)
        sph__io_put_float(o, rig->keys[i]);
    return status;
}

static sph_status put_binary(const sph__rig *rig, sph__io_output *o)
{
    sph_status status;
    for (size_t i = 0; i < 3 * (size_t)rig->skin.vertex_count; ++i)
        sph__io_put_float(o, rig->skin.rest[i]);
    status = sph__rig_put_normals(rig, o);
    for (unsigned s = 0; s < rig->set_count; ++s) {
        sph__rig_put_joints(rig, s, o);
        sph__rig_put_weights(rig, s, o);
    }
    put_indices(rig, o);
    put_inverse_binds(rig, o);
    for (uint32_t c = 0; c < rig->skin.clip_count && status == SPH_OK; ++c)
        status = put_clip(rig, &rig->skin.clips[c], o);
    return status;
}

static sph_status write_glb(const sph__rig *rig, sph__io_gltf_writer *w)
{
    sph__io_output o = {.file = -1};
    sph_status status;
    sph__rig_describe(rig, w, NULL);
    status = sph__io_gltf_check(w, rig->path);
    if (status == SPH_OK) status = sph__io_output_open(rig->context, rig->path, &o);
    if (status == SPH_OK) {
        sph__io_gltf_put_head(&o, &w->json, w->binary);
        status = put_binary(rig, &o);
    }
    if (status == SPH_OK) status = sph__io_output_finish(&o);
    if (status == SPH_OK) status = sph__io_output_commit(&o);
    sph__io_output_release(&o);
    return status;
}

/* The path of the buffer beside a .gltf, and the same name as a URI; both to be released. */
static bool name_buffer(const sph__rig *rig, char **path, char **uri)
{
    static const char PLAIN[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~";
    const size_t stem = strlen(rig->path) - 4; /* with the dot, without gltf */
    const char *slash = strrchr(rig->path, '/'), *name;
    char *out;
    *path = sph_context_allocate(rig->context, stem + 4, 1);
    *uri = sph_context_allocate(rig->context, stem + 4, 3);
    if (*path == NULL || *uri == NULL) return false;
    memcpy(*path, rig->path, stem);
    memcpy(*path + stem, "bin", 4);
    name = slash == NULL ? *path : *path + (slash + 1 - rig->path);
    for (out = *uri; *name != '\0'; ++name)
        if (strchr(PLAIN, *name) != NULL)
            *out++ = *name;
        else
            out += snprintf(out, 4, "%%%02X", (unsigned)(unsigned char)*name);
    *out = '\0';
    return true;
}

static sph_status write_pair(const sph__rig *rig, sph__io_gltf_writer *w)
{
    sph__io_output json = {.file = -1}, binary = {.file = -1};
    char *path = NULL, *uri = NULL;
    sph_status status = SPH_OK;
    if (!name_buffer(rig, &path, &uri)) status = sph__io_fail_memory(rig->context, rig->path);
    if (status == SPH_OK) {
        sph__rig_describe(rig, w, uri);
        status = sph__io_gltf_check(w, rig->path);
    }
    if (status == SPH_OK) status = sph__io_output_open(rig->context, rig->path, &json);
    if (status == SPH_OK) status = sph__io_output_open(rig->context, path, &binary);
    if (status == SPH_OK) {
        sph__io_output_bytes(&json, w->json.text, w->json.length);
        status = put_binary(rig, &binary);
    }
    if (status == SPH_OK) status = sph__io_output_finish(&json);
    if (status == SPH_OK) status = sph__io_output_finish(&binary);
    if (status == SPH_OK) status = sph__io_output_commit(&binary);
    if (status == SPH_OK) status = sph__io_output_commit(&json);
    sph__io_output_release(&json);
    sph__io_output_release(&binary);
    sph_context_release(rig->context, path);
    sph_context_release(rig->context, uri);
    return status;
}

static sph_status save(sph__rig *rig)
{
    sph__io_gltf_writer w;
    sph_status status = check_limits(rig);
    if (status != SPH_OK) return status;
    rig->set_count = (unsigned)((sph__rig_count_influences(rig) + SPH__RIG_SET - 1) / SPH__RIG_SET);
    rig->wide_joints = rig->joints.joint_count > NARROW_JOINTS;
    rig->wide_indices = rig->skin.vertex_count > NARROW_VERTICES; /* the last number of 16 bits is none */
    status = sph__rig_make_keys(rig);
    sph__io_gltf_writer_open(&w, rig->context);
    if (status == SPH_OK) status = sph__io_has_ending(rig->path, "glb") ? write_glb(rig, &w) : write_pair(rig, &w);
    sph__io_gltf_writer_release(&w);
    sph_context_release(rig->context, rig->keys);
    sph_context_release(rig->context, rig->rest);
    return status;
}

sph_status sph_io_save_rig(sph_context *context, const sph_skin *skin, const sph_skeleton *skeleton,
                           const sph_io_rig_options *options, const char *path)
{
    SPH__IO_OWN(context, sph_context_memory_used);
    SPH__IO_OWN(skin, sph_skin_vertex_count);
    sph__rig rig = {.context = context,
                    .path = path,
                    .skin = {.struct_size = sizeof rig.skin},
                    .joints = {.struct_size = sizeof rig.joints}};
    sph_skeleton *own = NULL;
    sph_status status;
    if (context == NULL || skin == NULL || path == NULL)
        return sph_context_fail(context, SPH_E_INVALID, "a rig to save, or its path, is NULL");
    if (!sph__io_has_ending(path, "glb") && !sph__io_has_ending(path, "gltf"))
        return sph__io_fail(context, SPH_E_UNSUPPORTED, "%s: rigs are written as .glb or .gltf", sph__io_shown(path));
    status = read_options(context, options, &rig.options);
    if (status == SPH_OK && skeleton == NULL) {
        status = sph_skeleton_create(skin, NULL, &own);
        skeleton = own;
        rig.reported = 1;
    }
    if (status == SPH_OK) status = sph_skin_get_arrays(skin, &rig.skin);
    if (status == SPH_OK) status = sph_skeleton_get_arrays(skeleton, &rig.joints);
    if (status == SPH_OK) status = save(&rig);
    sph_skeleton_destroy(own);
    return status;
}
