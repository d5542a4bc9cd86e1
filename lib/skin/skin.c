/* SPDX-License-Identifier: MIT */
/* The handle: its memory, and what it tells. */
#include "skin/skin.h"

#include <math.h>

void sph_skin_destroy(sph_skin *skin)
{
    SPH__OWN(skin, SPH__SKIN);
    sph_context *context;
    if (skin == NULL) return;
    context = skin->context;
    sph__free(context, skin->rest);
    sph__free(context, skin->bones);
    sph__free(context, skin->weights);
    sph__free(context, skin->transforms);
    sph__free(context, skin->clips);
    sph__free(context, skin->names);
    sph__free(context, skin->pivots);
    sph__free(context, skin->radii);
    sph__free(context, skin->triangles);
    sph__free(context, skin->links);
    sph__free(context, skin->errors);
    sph__free(context, skin);
    sph__context_release(context);
}

sph_status sph__skin_allocate(sph_context *context, const sph_skin_arrays *sizes, sph_skin **out)
{
    const size_t n = sizes->vertex_count, bones = sizes->bone_count;
    size_t slots, poses;
    sph_skin *skin;
    *out = NULL;
    if (!sph__multiply_size(n, sizes->influence_count, &slots) ||
        !sph__multiply_size(bones, sizes->frame_count, &poses))
        return sph__fail_memory(context);
    skin = sph__new(context, sizeof *skin, SPH__SKIN);
    if (skin == NULL) return sph__fail_memory(context);
    skin->context = sph__context_retain(context);
    skin->vertex_count = sizes->vertex_count;
    skin->bone_count = sizes->bone_count;
    skin->influence_count = sizes->influence_count;
    skin->frame_count = sizes->frame_count;
    skin->triangle_count = sizes->triangle_count;
    skin->link_count = sizes->link_count;
    skin->rest = sph__zalloc(context, n, 3 * sizeof *skin->rest);
    skin->bones = sph__zalloc(context, slots, sizeof *skin->bones);
    skin->weights = sph__zalloc(context, slots, sizeof *skin->weights);
    skin->transforms = sph__zalloc(context, poses, 12 * sizeof *skin->transforms);
    skin->pivots = sph__zalloc(context, bones, 3 * sizeof *skin->pivots);
    skin->radii = sph__zalloc(context, bones, sizeof *skin->radii);
    skin->triangles = sph__zalloc(context, sizes->triangle_count, 3 * sizeof *skin->triangles);
    skin->links = sph__zalloc(context, sizes->link_count, 2 * sizeof *skin->links);
    if (skin->rest == NULL || skin->bones == NULL || skin->weights == NULL || skin->transforms == NULL ||
        skin->pivots == NULL || skin->radii == NULL || skin->triangles == NULL || skin->links == NULL) {
        sph_skin_destroy(skin);
        return sph__fail_memory(context);
    }
    *out = skin;
    return SPH_OK;
}

sph_status sph__skin_set_clips(sph_skin *skin, const sph_skin_clip *clips, uint32_t count)
{
    size_t bytes = 0;
    char *at;
    for (uint32_t c = 0; c < count; ++c)
        bytes += (clips[c].name == NULL ? 0 : strlen(clips[c].name)) + 1;
    skin->clips = sph__zalloc(skin->context, count, sizeof *skin->clips);
    skin->names = at = sph__zalloc(skin->context, bytes, 1);
    if (skin->clips == NULL || skin->names == NULL) return sph__fail_memory(skin->context);
    for (uint32_t c = 0; c < count; ++c) {
        const size_t length = clips[c].name == NULL ? 0 : strlen(clips[c].name);
        if (length != 0) memcpy(at, clips[c].name, length);
        skin->clips[c] = clips[c];
        skin->clips[c].name = at;
        at += length + 1;
    }
    skin->clip_count = count;
    return SPH_OK;
}

size_t sph__skin_order_links(uint32_t *links, size_t count, sph__keyed *keys)
{
    size_t kept = 0;
    for (size_t i = 0; i < count; ++i) {
        const uint32_t a = links[2 * i], b = links[2 * i + 1];
        keys[i] = (sph__keyed){a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a, i};
    }
    sph__sort(keys, count);
    for (size_t i = 0; i < count; ++i) {
        const uint32_t a = (uint32_t)(keys[i].key >> 32), b = (uint32_t)keys[i].key;
        if (a == b || (i > 0 && keys[i].key == keys[i - 1].key)) continue;
        links[2 * kept] = a;
        links[2 * kept++ + 1] = b;
    }
    return kept;
}

bool sph__skin_is_rigid(const double t[12])
{
    const double tolerance = 1e-6;
    double determinant;
    for (int a = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b) {
            const double dot = t[4 * a] * t[4 * b] + t[4 * a + 1] * t[4 * b + 1] + t[4 * a + 2] * t[4 * b + 2];
            if (!(fabs(dot - (a == b)) <= tolerance)) return false;
        }
    determinant = t[0] * (t[5] * t[10] - t[6] * t[9]) - t[1] * (t[4] * t[10] - t[6] * t[8]) +
                  t[2] * (t[4] * t[9] - t[5] * t[8]);
    return determinant > 0;
}

uint32_t sph_skin_vertex_count(const sph_skin *skin)
{
    SPH__OWN(skin, SPH__SKIN);
    return skin == NULL ? 0 : skin->vertex_count;
}

uint32_t sph_skin_bone_count(const sph_skin *skin)
{
    SPH__OWN(skin, SPH__SKIN);
    return skin == NULL ? 0 : skin->bone_count;
}

uint32_t sph_skin_influence_count(const sph_skin *skin)
{
    SPH__OWN(skin, SPH__SKIN);
    return skin == NULL ? 0 : skin->influence_count;
}

uint32_t sph_skin_frame_count(const sph_skin *skin)
{
    SPH__OWN(skin, SPH__SKIN);
    return skin == NULL ? 0 : skin->frame_count;
}

sph_status sph_skin_get_arrays(const sph_skin *skin, sph_skin_arrays *arrays)
{
    SPH__OWN(skin, SPH__SKIN);
    if (skin == NULL || arrays == NULL)
        return sph__fail(skin == NULL ? NULL : skin->context, SPH_E_INVALID,
                         "sph_skin_get_arrays: an argument is NULL");
    if (arrays->struct_size != sizeof *arrays)
        return sph__fail(skin->context, SPH_E_INVALID, "sph_skin_arrays: struct_size is %u, not %zu",
                         (unsigned)arrays->struct_size, sizeof *arrays);
    *arrays = (sph_skin_arrays){.struct_size = sizeof *arrays,
                                .vertex_count = skin->vertex_count,
                                .bone_count = skin->bone_count,
                                .influence_count = skin->influence_count,
                                .frame_count = skin->frame_count,
                                .clip_count = skin->clip_count,
                                .rest = skin->rest,
                                .bones = skin->bones,
                                .weights = skin->weights,
                                .transforms = skin->frame_count == 0 ? NULL : skin->transforms,
                                .clips = skin->clip_count == 0 ? NULL : skin->clips,
                                .pivots = skin->pivots,
                                .radii = skin->radii,
                                .triangle_count = skin->triangle_count,
                                .triangles = skin->triangle_count == 0 ? NULL : skin->triangles,
                                .link_count = skin->link_count,
                                .links = skin->link_count == 0 ? NULL : skin->links,
                                .rigid = skin->rigid};
    return SPH_OK;
}

sph_status sph_skin_get_errors(const sph_skin *skin, sph_skin_error *overall, sph_skin_error *per_frame)
{
    SPH__OWN(skin, SPH__SKIN);
    if (skin == NULL) return SPH_E_INVALID;
    if (skin->errors == NULL)
        return sph__fail(skin->context, SPH_E_STATE, "the skin was made from arrays: nothing was measured");
    if (overall != NULL) *overall = skin->errors[skin->frame_count];
    if (per_frame != NULL) memcpy(per_frame, skin->errors, skin->frame_count * sizeof *per_frame);
    return SPH_OK;
}
