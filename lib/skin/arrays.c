/* SPDX-License-Identifier: MIT */
/* Skins from the caller's arrays. */
#include <math.h>

#include "skin/skin.h"

static const double SUM_TOLERANCE = 1e-2;

static sph_status check_counts(const sph_context *context, const sph_skin_arrays *a)
{
    if (a->struct_size != sizeof *a)
        return sph__fail(context, SPH_E_INVALID, "sph_skin_arrays: struct_size is %u, not %zu",
                         (unsigned)a->struct_size, sizeof *a);
    if (a->reserved0 != 0) return sph__fail(context, SPH_E_INVALID, "sph_skin_arrays: reserved0 must be 0");
    if (a->vertex_count == 0 || a->bone_count == 0 || a->influence_count == 0)
        return sph__fail(context, SPH_E_INVALID,
                         "a skin of %u vertices, %u bones and %u influences per vertex: all must be above 0",
                         (unsigned)a->vertex_count, (unsigned)a->bone_count, (unsigned)a->influence_count);
    if (a->rest == NULL || a->bones == NULL || a->weights == NULL || (a->frame_count != 0 && a->transforms == NULL) ||
        (a->clip_count != 0 && a->clips == NULL) || (a->triangle_count != 0 && a->triangles == NULL) ||
        (a->link_count != 0 && a->links == NULL))
        return sph__fail(context, SPH_E_INVALID, "sph_skin_arrays: an array is NULL");
    return SPH_OK;
}

static sph_status check_clips(const sph_context *context, const sph_skin_arrays *a)
{
    uint64_t at = 0;
    for (uint32_t c = 0; c < a->clip_count; ++c) {
        const sph_skin_clip *clip = &a->clips[c];
        if (clip->frame_count == 0 || clip->first_frame != at)
            return sph__fail(context, SPH_E_INVALID, "clip %u has %u frames from frame %u on; it should begin at %llu",
                             (unsigned)c, (unsigned)clip->frame_count, (unsigned)clip->first_frame,
                             (unsigned long long)at);
        if (!isfinite(clip->frames_per_second) || clip->frames_per_second < 0)
            return sph__fail(context, SPH_E_INVALID, "clip %u has %g frames per second", (unsigned)c,
                             clip->frames_per_second);
        at += clip->frame_count;
    }
    if (a->clip_count != 0 && at != a->frame_count)
        return sph__fail(context, SPH_E_INVALID, "the clips have %llu frames, the skin %u", (unsigned long long)at,
                         (unsigned)a->frame_count);
    return SPH_OK;
}

static sph_status check_values(const sph_context *context, const sph_skin_arrays *a)
{
    const size_t bones = a->bone_count;
    for (size_t i = 0; i < 3 * (size_t)a->vertex_count; ++i)
        if (!isfinite(a->rest[i]))
            return sph__fail(context, SPH_E_INVALID, "vertex %zu of the rest pose is not finite", i / 3);
    for (size_t i = 0; i < 12 * bones * a->frame_count; ++i)
        if (!isfinite(a->transforms[i]))
            return sph__fail(context, SPH_E_INVALID, "the transform of bone %zu in frame %zu is not finite",
                             i / 12 % bones, i / 12 / bones);
    for (size_t b = 0; b < bones; ++b) {
        if (a->pivots != NULL && !(isfinite(a->pivots[3 * b]) && isfinite(a->pivots[3 * b + 1]) &&
                                   isfinite(a->pivots[3 * b + 2])))
            return sph__fail(context, SPH_E_INVALID, "the pivot of bone %zu is not finite", b);
        if (a->radii != NULL && !(isfinite(a->radii[b]) && a->radii[b] >= 0))
            return sph__fail(context, SPH_E_INVALID, "the radius of bone %zu is %g", b, a->radii[b]);
    }
    return SPH_OK;
}

static sph_status check_indices(const sph_context *context, const sph_skin_arrays *a)
{
    for (size_t i = 0; i < 3 * a->triangle_count; ++i)
        if (a->triangles[i] >= a->vertex_count)
            return sph__fail(context, SPH_E_INVALID, "triangle %zu names vertex %u of %u", i / 3,
                             (unsigned)a->triangles[i], (unsigned)a->vertex_count);
    for (size_t i = 0; i < 2 * a->link_count; ++i)
        if (a->links[i] >= a->bone_count)
            return sph__fail(context, SPH_E_INVALID, "link %zu names bone %u of %u", i / 2, (unsigned)a->links[i],
                             (unsigned)a->bone_count);
    return SPH_OK;
}

static sph_status set_weights(sph_skin *skin, const sph_skin_arrays *a)
{
    const uint32_t k = skin->influence_count;
    uint32_t *bones = sph__alloc(skin->context, k, sizeof *bones);
    double *weights = sph__alloc(skin->context, k, sizeof *weights);
    sph_status status = bones == NULL || weights == NULL ? sph__fail_memory(skin->context) : SPH_OK;
    for (size_t v = 0; v < skin->vertex_count && status == SPH_OK; ++v) {
        double sum = 0;
        for (uint32_t s = 0; s < k && status == SPH_OK; ++s) {
            bones[s] = a->bones[v * k + s];
            weights[s] = (double)a->weights[v * k + s];
            sum += weights[s];
            if (!(weights[s] >= 0 && isfinite(weights[s])))
                status = sph__fail(skin->context, SPH_E_INVALID, "weight %u of vertex %zu is %g", (unsigned)s, v,
                                   weights[s]);
            else if (bones[s] >= skin->bone_count)
                status = sph__fail(skin->context, SPH_E_INVALID, "weight %u of vertex %zu names bone %u of %u",
                                   (unsigned)s, v, (unsigned)bones[s], (unsigned)skin->bone_count);
        }
        if (status == SPH_OK && !(fabs(sum - 1) <= SUM_TOLERANCE))
            status = sph__fail(skin->context, SPH_E_INVALID, "the weights of vertex %zu sum to %g", v, sum);
        if (status == SPH_OK)
            sph__weights_order(bones, weights, k, k, skin->bones + v * k, skin->weights + v * k);
    }
    sph__free(skin->context, bones);
    sph__free(skin->context, weights);
    return status;
}

/* Where none are given: the mean of a bone's vertices, each as heavy as its weight. */
static sph_status set_pivots(sph_skin *skin, const double *pivots)
{
    const uint32_t k = skin->influence_count;
    double *sums;
    if (pivots != NULL) {
        memcpy(skin->pivots, pivots, skin->bone_count * 3 * sizeof *pivots);
        return SPH_OK;
    }
    sums = sph__zalloc(skin->context, skin->bone_count, sizeof *sums);
    if (sums == NULL) return sph__fail_memory(skin->context);
    for (size_t i = 0; i < (size_t)skin->vertex_count * k; ++i) {
        const uint32_t bone = skin->bones[i];
        sums[bone] += (double)skin->weights[i];
        for (int c = 0; c < 3; ++c)
            skin->pivots[3 * bone + c] += (double)skin->weights[i] * (double)skin->rest[3 * (i / k) + c];
    }
    for (size_t b = 0; b < skin->bone_count; ++b)
        for (int c = 0; c < 3 && sums[b] > 0; ++c)
            skin->pivots[3 * b + c] /= sums[b];
    sph__free(skin->context, sums);
    return SPH_OK;
}

static sph_status set_links(sph_skin *skin, const sph_skin_arrays *a)
{
    sph__keyed *keys;
    if (a->link_count == 0) return SPH_OK;
    keys = sph__alloc(skin->context, a->link_count, sizeof *keys);
    if (keys == NULL) return sph__fail_memory(skin->context);
    memcpy(skin->links, a->links, a->link_count * 2 * sizeof *a->links);
    skin->link_count = sph__skin_order_links(skin->links, a->link_count, keys);
    sph__free(skin->context, keys);
    return SPH_OK;
}

static sph_status fill(sph_skin *skin, const sph_skin_arrays *a)
{
    const sph_skin_clip all = {NULL, 0, a->frame_count, 0};
    const size_t poses = (size_t)a->frame_count * a->bone_count; /* sph__skin_allocate found that it fits */
    sph_status status;
    memcpy(skin->rest, a->rest, skin->vertex_count * 3 * sizeof *a->rest);
    if (poses != 0) memcpy(skin->transforms, a->transforms, poses * 12 * sizeof *a->transforms);
    if (a->triangle_count != 0) memcpy(skin->triangles, a->triangles, a->triangle_count * 3 * sizeof *a->triangles);
    if (a->radii != NULL) memcpy(skin->radii, a->radii, skin->bone_count * sizeof *a->radii);
    skin->rigid = 1;
    for (size_t i = 0; i < poses; ++i)
        if (!sph__skin_is_rigid(a->transforms + 12 * i)) skin->rigid = 0;
    status = set_weights(skin, a);
    if (status == SPH_OK) status = set_pivots(skin, a->pivots);
    if (status == SPH_OK) status = set_links(skin, a);
    if (status != SPH_OK) return status;
    if (a->clip_count != 0) return sph__skin_set_clips(skin, a->clips, a->clip_count);
    return sph__skin_set_clips(skin, &all, a->frame_count != 0);
}

sph_status sph_skin_create_from_arrays(sph_context *context, const sph_skin_arrays *arrays, sph_skin **out)
{
    SPH__OWN(context, SPH__CONTEXT);
    sph_skin *skin = NULL;
    sph_status status;
    if (out != NULL) *out = NULL;
    if (context == NULL || arrays == NULL || out == NULL)
        return sph__fail(context, SPH_E_INVALID, "sph_skin_create_from_arrays: an argument is NULL");
    if ((status = check_counts(context, arrays)) != SPH_OK || (status = check_clips(context, arrays)) != SPH_OK)
        return status;
    if ((status = sph__skin_allocate(context, arrays, &skin)) != SPH_OK) return status;
    status = check_values(context, arrays);
    if (status == SPH_OK) status = check_indices(context, arrays);
    if (status == SPH_OK) status = fill(skin, arrays);
    if (status != SPH_OK) {
        sph_skin_destroy(skin);
        return status;
    }
    *out = skin;
    return SPH_OK;
}
