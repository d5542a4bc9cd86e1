/* SPDX-License-Identifier: MIT */
/* The example poses, and points with their places in them. */
#include <math.h>

#include "simplify/simplify.h"

static const double IDENTITY[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

/* Example pose `at` of `count`: the caller's, a frame of the skin, or NULL: the rest pose. */
static const double *example(const sph__simplifier *b, uint32_t at)
{
    const uint32_t frames = b->skin->frame_count;
    const size_t pitch = 12 * (size_t)b->skin->bone_count;
    uint64_t frame = at;
    if (b->o.poses != NULL) return b->o.poses + at * pitch;
    if (frames == 0 || b->o.method == SPH_SIMPLIFY_REST) return NULL;
    if (b->example_count < frames)
        frame = b->example_count == 1 ? 0 : ((uint64_t)at * (frames - 1)) / (b->example_count - 1);
    return b->skin->transforms + frame * pitch;
}

static void count_examples(sph__simplifier *b)
{
    uint32_t count = b->skin->frame_count;
    if (b->o.pose_limit != 0 && count > b->o.pose_limit) count = b->o.pose_limit;
    if (b->o.poses != NULL) count = b->o.pose_count;
    if (b->o.method == SPH_SIMPLIFY_REST || count == 0) {
        b->o.poses = b->o.method == SPH_SIMPLIFY_REST ? NULL : b->o.poses;
        count = 1;
    }
    b->example_count = count;
    b->example_stride = ((size_t)count + SPH__LANES - 1) / SPH__LANES * SPH__LANES;
}

/* The identity alone, where collapses look at the rest pose. */
static sph_status make_single(sph__simplifier *b)
{
    b->pose_count = 1;
    b->stride = SPH__LANES;
    b->transform_count = 1;
    b->transforms = sph__zalloc(b->context, 12 * (size_t)SPH__LANES, sizeof *b->transforms);
    if (b->transforms == NULL) return sph__fail_memory(b->context);
    for (size_t r = 0; r < 12; ++r)
        b->transforms[r * SPH__LANES] = IDENTITY[r];
    return SPH_OK;
}

sph_status sph__simplify_read_poses(sph__simplifier *b)
{
    const size_t bones = b->skin->bone_count;
    size_t rows;
    count_examples(b);
    if (!sph__multiply_size(b->example_stride * 12, bones, &rows)) return sph__fail_memory(b->context);
    b->examples = sph__zalloc(b->context, rows, sizeof *b->examples);
    if (b->examples == NULL) return sph__fail_memory(b->context);
    for (uint32_t j = 0; j < b->example_count; ++j) {
        const double *pose = example(b, j);
        double *chunk = b->examples + j / SPH__LANES * bones * 12 * SPH__LANES + j % SPH__LANES;
        for (size_t i = 0; i < 12 * bones; ++i)
            chunk[i * SPH__LANES] = pose == NULL ? IDENTITY[i % 12] : pose[i];
    }
    b->p->pose_count = b->example_count;
    if (b->o.method == SPH_SIMPLIFY_REST || b->o.method == SPH_SIMPLIFY_PULLED_BACK) return make_single(b);
    b->pose_count = b->example_count;
    b->stride = b->example_stride;
    b->transform_count = b->skin->bone_count;
    b->transforms = b->examples;
    return SPH_OK;
}

uint32_t sph__simplify_bone_count(const sph__simplifier *b, uint32_t point)
{
    const float *weights = b->weights + (size_t)point * b->wide;
    uint32_t count = 0;
    while (count < b->wide && weights[count] > 0)
        ++count;
    return count;
}

void sph__simplify_place(const sph__simplifier *b, uint32_t point, float *center)
{
    static const uint32_t BONE = 0;
    static const float ONE = 1;
    const float *rest = b->rest + 3 * (size_t)point;
    const double at[3] = {(double)rest[0], (double)rest[1], (double)rest[2]};
    if (b->transform_count == 1)
        sph__kernel_place(b->transforms, 1, b->stride, at, &BONE, &ONE, 1, center);
    else
        sph__kernel_place(b->transforms, b->transform_count, b->stride, at, b->bones + (size_t)point * b->wide,
                          b->weights + (size_t)point * b->wide, sph__simplify_bone_count(b, point), center);
}

static sph_status allocate(sph__simplifier *b)
{
    sph_progressive *p = b->p;
    const size_t most = 2 * (size_t)b->points;
    size_t slots, wide;
    if (!sph__multiply_size(most, p->slots, &slots) || !sph__multiply_size(most, b->wide, &wide))
        return sph__fail_memory(b->context);
    b->rest = sph__alloc(b->context, most, 3 * sizeof *b->rest);
    b->bones = sph__alloc(b->context, wide, sizeof *b->bones);
    b->weights = sph__alloc(b->context, wide, sizeof *b->weights);
    p->rest = sph__alloc(b->context, most, 3 * sizeof *p->rest);
    p->bones = sph__alloc(b->context, slots, sizeof *p->bones);
    p->weights = sph__alloc(b->context, slots, sizeof *p->weights);
    b->locked = sph__zalloc(b->context, most, 1);
    if (p->rest == NULL || p->bones == NULL || p->weights == NULL || b->locked == NULL || b->rest == NULL ||
        b->bones == NULL || b->weights == NULL)
        return sph__fail_memory(b->context);
    return SPH_OK;
}

/* The point of vertex v, which is the first of its own. */
static void set_point(sph__simplifier *b, uint32_t v, uint32_t *bones, double *weights)
{
    const uint32_t k = b->skin->influence_count;
    const size_t point = b->point_of[v];
    for (int side = 0; side < 2; ++side) {
        const uint32_t limit = side == 0 ? b->p->slots : b->wide;
        for (uint32_t s = 0; s < k; ++s) {
            bones[s] = b->skin->bones[(size_t)v * k + s];
            weights[s] = (double)b->skin->weights[(size_t)v * k + s];
        }
        sph__weights_order(bones, weights, k, limit, (side == 0 ? b->p->bones : b->bones) + point * limit,
                           (side == 0 ? b->p->weights : b->weights) + point * limit);
        memcpy((side == 0 ? b->p->rest : b->rest) + 3 * point, b->skin->rest + 3 * (size_t)v, 3 * sizeof *b->rest);
    }
}

sph_status sph__simplify_make_points(sph__simplifier *b)
{
    const uint32_t k = b->skin->influence_count;
    uint32_t next = 0;
    uint32_t *bones = sph__alloc(b->context, k, sizeof *bones);
    double *weights = sph__alloc(b->context, k, sizeof *weights);
    sph_status status = bones == NULL || weights == NULL ? sph__fail_memory(b->context) : allocate(b);
    for (uint32_t v = 0; v < b->n && status == SPH_OK; ++v) {
        if (b->point_of[v] == next) {
            set_point(b, v, bones, weights);
            ++next;
        }
        if (b->o.locked != NULL && b->o.locked[v]) b->locked[b->point_of[v]] = 1;
    }
    sph__free(b->context, bones);
    sph__free(b->context, weights);
    return status;
}
