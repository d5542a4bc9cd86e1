/* SPDX-License-Identifier: MIT */
/* Poses of bones as poses of joints relative to their parents, and back. */
#include <math.h>

#include "numeric/affine.h"
#include "skeleton/skeleton.h"

/* out = a b; `out` is neither */
static void multiply(const double a[12], const double b[12], double out[12])
{
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 4; ++c)
            out[4 * r + c] =
                a[4 * r] * b[c] + a[4 * r + 1] * b[4 + c] + a[4 * r + 2] * b[8 + c] + (c == 3 ? a[4 * r + 3] : 0);
}

/* The joint's place in the pose: its bone's transform, after the joint has been put where it is at rest. */
static void world_of(const sph_skeleton *s, const double *transforms, uint32_t joint, double world[12])
{
    static const double IDENTITY[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    if (joint == s->bone_count) {
        memcpy(world, IDENTITY, sizeof IDENTITY);
        return;
    }
    memcpy(world, transforms + 12 * (size_t)joint, 12 * sizeof *world);
    for (int r = 0; r < 3; ++r) {
        const double *row = transforms + 12 * (size_t)joint + 4 * r, *at = s->positions + 3 * (size_t)joint;
        world[4 * r + 3] = row[0] * at[0] + row[1] * at[1] + row[2] * at[2] + row[3];
    }
}

static sph_status check(const sph_skeleton *s, const double *matrices, uint32_t count, const char *what)
{
    for (size_t i = 0; i < 12 * (size_t)count; ++i)
        if (!isfinite(matrices[i]))
            return sph__fail(s->context, SPH_E_INVALID, "the transform of %s %zu is not finite", what, i / 12);
    return SPH_OK;
}

sph_status sph_skeleton_get_locals(const sph_skeleton *skeleton, const double *transforms, double *locals)
{
    SPH__OWN(skeleton, SPH__SKELETON);
    sph_status status;
    if (skeleton == NULL || transforms == NULL || locals == NULL)
        return sph__fail(skeleton == NULL ? NULL : skeleton->context, SPH_E_INVALID,
                         "sph_skeleton_get_locals: an argument is NULL");
    status = check(skeleton, transforms, skeleton->bone_count, "bone");
    for (uint32_t j = 0; j < skeleton->joint_count && status == SPH_OK; ++j) {
        const uint32_t parent = skeleton->parents[j];
        double *local = locals + 12 * (size_t)j, world[12], above[12], inverse[12];
        if (parent == SPH_NO_JOINT || parent == skeleton->bone_count) {
            world_of(skeleton, transforms, j, local);
            continue;
        }
        world_of(skeleton, transforms, j, world);
        world_of(skeleton, transforms, parent, above);
        if (!sph__affine_invert(above, inverse))
            return sph__fail(skeleton->context, SPH_E_INVALID, "the transform of bone %u cannot be inverted",
                             (unsigned)parent);
        multiply(inverse, world, local);
    }
    return status;
}

sph_status sph_skeleton_get_transforms(const sph_skeleton *skeleton, const double *locals, double *transforms)
{
    SPH__OWN(skeleton, SPH__SKELETON);
    double *worlds;
    sph_status status;
    if (skeleton == NULL || locals == NULL || transforms == NULL)
        return sph__fail(skeleton == NULL ? NULL : skeleton->context, SPH_E_INVALID,
                         "sph_skeleton_get_transforms: an argument is NULL");
    status = check(skeleton, locals, skeleton->joint_count, "joint");
    if (status != SPH_OK) return status;
    worlds = sph__alloc(skeleton->context, skeleton->joint_count, 12 * sizeof *worlds);
    if (worlds == NULL) return sph__fail_memory(skeleton->context);
    for (uint32_t i = 0; i < skeleton->joint_count; ++i) {
        const uint32_t j = skeleton->order[i], parent = skeleton->parents[j];
        double *world = worlds + 12 * (size_t)j;
        if (parent == SPH_NO_JOINT)
            memcpy(world, locals + 12 * (size_t)j, 12 * sizeof *world);
        else
            multiply(worlds + 12 * (size_t)parent, locals + 12 * (size_t)j, world);
        if (j < skeleton->bone_count)
            multiply(world, skeleton->inverse_bind + 12 * (size_t)j, transforms + 12 * (size_t)j);
    }
    sph__free(skeleton->context, worlds);
    return SPH_OK;
}
