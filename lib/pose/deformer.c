/* SPDX-License-Identifier: MIT */
/* The deformer: its memory, options and normals. */
#include <math.h>

#include "numeric/vector.h"
#include "pose/pose.h"
#include "skin/skin.h"

static const sph_deformer_options DEFAULTS = {.struct_size = sizeof(sph_deformer_options)};
enum { OPTIONS_V1 = offsetof(sph_deformer_options, normals) + sizeof(const float *) };
_Static_assert(sizeof(void *) != 8 || OPTIONS_V1 == 16, "a field of 0.1 moved");

void sph_deformer_options_init(sph_deformer_options *options, size_t size)
{
    sph__options_init(options, size, &DEFAULTS, sizeof DEFAULTS, OPTIONS_V1);
}

void sph_deformer_destroy(sph_deformer *deformer)
{
    SPH__OWN(deformer, SPH__DEFORMER);
    sph_context *context;
    if (deformer == NULL) return;
    context = deformer->context;
    sph__free(context, deformer->rest);
    sph__free(context, deformer->normals);
    sph__free(context, deformer->bones);
    sph__free(context, deformer->weights);
    sph__free(context, deformer->pivots);
    sph__free(context, deformer->palette);
    sph__free(context, deformer);
    sph__context_release(context);
}

static sph_status allocate(sph_deformer *d, const sph_skin *skin, bool normals)
{
    const size_t n = skin->vertex_count, bones = skin->bone_count, slots = n * skin->influence_count;
    d->rest = sph__alloc(d->context, n, 3 * sizeof *d->rest);
    d->normals = normals ? sph__zalloc(d->context, n, 3 * sizeof *d->normals) : NULL;
    d->bones = sph__alloc(d->context, slots, sizeof *d->bones);
    d->weights = sph__alloc(d->context, slots, sizeof *d->weights);
    d->pivots = sph__alloc(d->context, bones, 3 * sizeof *d->pivots);
    d->palette = sph__alloc(d->context, bones, (size_t)SPH__POSE_BATCH * SPH__BONE_SIZE * sizeof *d->palette);
    if (d->rest == NULL || (normals && d->normals == NULL) || d->bones == NULL || d->weights == NULL ||
        d->pivots == NULL || d->palette == NULL)
        return sph__fail_memory(d->context);
    memcpy(d->rest, skin->rest, 3 * n * sizeof *d->rest);
    memcpy(d->bones, skin->bones, slots * sizeof *d->bones);
    memcpy(d->weights, skin->weights, slots * sizeof *d->weights);
    memcpy(d->pivots, skin->pivots, 3 * bones * sizeof *d->pivots);
    return SPH_OK;
}

static sph_status copy_normals(sph_deformer *d, const float *normals)
{
    for (size_t i = 0; i < 3 * (size_t)d->vertex_count; ++i) {
        if (!isfinite(normals[i])) return sph__fail(d->context, SPH_E_INVALID, "normal %zu is not finite", i / 3);
        d->normals[i] = normals[i];
    }
    return SPH_OK;
}

/* Twice the area of a triangle along its normal. */
static void measure_triangle(const sph_skin *skin, const uint32_t *corner, double out[3])
{
    double u[3], v[3];
    for (int c = 0; c < 3; ++c) {
        const double origin = (double)skin->rest[3 * (size_t)corner[0] + c];
        u[c] = (double)skin->rest[3 * (size_t)corner[1] + c] - origin;
        v[c] = (double)skin->rest[3 * (size_t)corner[2] + c] - origin;
    }
    sph__cross(u, v, out);
}

/* Sums are taken in doubles, as large and small triangles may meet. */
static sph_status sum_normals(sph_deformer *d, const sph_skin *skin)
{
    double *sums = sph__zalloc(d->context, d->vertex_count, 3 * sizeof *sums);
    if (sums == NULL) return sph__fail_memory(d->context);
    for (size_t t = 0; t < skin->triangle_count; ++t) {
        const uint32_t *corner = skin->triangles + 3 * t;
        double area[3];
        measure_triangle(skin, corner, area);
        for (int i = 0; i < 9; ++i)
            sums[3 * (size_t)corner[i / 3] + i % 3] += area[i % 3];
    }
    for (size_t v = 0; v < d->vertex_count; ++v) {
        const double length = sph__norm(sums + 3 * v);
        for (int c = 0; c < 3 && length > 0 && isfinite(length); ++c)
            d->normals[3 * v + c] = (float)(sums[3 * v + c] / length);
    }
    sph__free(d->context, sums);
    return SPH_OK;
}

sph_status sph_deformer_create(const sph_skin *skin, const sph_deformer_options *options, sph_deformer **out)
{
    SPH__OWN(skin, SPH__SKIN);
    sph_deformer_options o = DEFAULTS;
    sph_deformer *d;
    sph_status status;
    if (out != NULL) *out = NULL;
    if (skin == NULL || out == NULL)
        return sph__fail(skin == NULL ? NULL : skin->context, SPH_E_INVALID,
                         "sph_deformer_create: an argument is NULL");
    status = sph__options_read(skin->context, "sph_deformer_options", options, &o, sizeof o, OPTIONS_V1);
    if (status != SPH_OK) return status;
    if (o.flags != 0) return sph__fail(skin->context, SPH_E_INVALID, "sph_deformer_options: flags must be 0");
    d = sph__new(skin->context, sizeof *d, SPH__DEFORMER);
    if (d == NULL) return sph__fail_memory(skin->context);
    d->context = sph__context_retain(skin->context);
    d->vertex_count = skin->vertex_count;
    d->bone_count = skin->bone_count;
    d->influence_count = skin->influence_count;
    status = allocate(d, skin, o.normals != NULL || skin->triangle_count != 0);
    if (status == SPH_OK && d->normals != NULL)
        status = o.normals != NULL ? copy_normals(d, o.normals) : sum_normals(d, skin);
    if (status != SPH_OK) {
        sph_deformer_destroy(d);
        return status;
    }
    *out = d;
    return SPH_OK;
}
