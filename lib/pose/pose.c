/* SPDX-License-Identifier: MIT */
/* Transforms of bones become moved vertices. */
#include "pose/pose.h"

#include <math.h>

#include "numeric/rotation.h"

enum { VERTEX_BLOCK = 1024 };

/* What a bone does beyond turning and moving is left out where it is no more than the rounding of floats. */
static const double STRETCH_TOLERANCE = 1e-7;

static void set_columns(const double transform[12], double *palette)
{
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r)
            palette[4 * c + r] = r < 3 ? transform[4 * r + c] : 0;
}

/* Half the product of a translation and a rotation. */
static void set_dual(const double t[3], const double q[4], double dual[4])
{
    dual[0] = 0.5 * (t[0] * q[3] + t[1] * q[2] - t[2] * q[1]);
    dual[1] = 0.5 * (t[1] * q[3] + t[2] * q[0] - t[0] * q[2]);
    dual[2] = 0.5 * (t[2] * q[3] + t[0] * q[1] - t[1] * q[0]);
    dual[3] = -0.5 * (t[0] * q[0] + t[1] * q[1] + t[2] * q[2]);
}

/* linear = rotation stretch; how far the stretch is from the identity. */
static double divide(const double linear[9], double rotation[9], double stretch[9])
{
    double most = 0;
    sph__nearest_rotation(linear, rotation);
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) {
            stretch[3 * a + b] =
                rotation[a] * linear[b] + rotation[3 + a] * linear[3 + b] + rotation[6 + a] * linear[6 + b];
            most = fmax(most, fabs(stretch[3 * a + b] - (a == b)));
        }
    return most;
}

/* Whether it is a rotation; most bones are, and need no dividing. */
static bool is_rotation(const double m[9])
{
    for (int a = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b) {
            const double dot = m[3 * a] * m[3 * b] + m[3 * a + 1] * m[3 * b + 1] + m[3 * a + 2] * m[3 * b + 2];
            if (!(fabs(dot - (a == b)) <= STRETCH_TOLERANCE)) return false;
        }
    return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
               m[2] * (m[3] * m[7] - m[4] * m[6]) >
           0;
}

/* The pivot is where the stretch leaves what it finds: so the result does not depend on where the origin is. */
static bool prepare_dual(const double t[12], const double pivot[3], double *palette)
{
    const double linear[9] = {t[0], t[1], t[2], t[4], t[5], t[6], t[8], t[9], t[10]};
    double rotation[9], stretch[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, first[12], shift[3];
    bool stretched = false;
    if (is_rotation(linear))
        memcpy(rotation, linear, sizeof rotation);
    else
        stretched = divide(linear, rotation, stretch) > STRETCH_TOLERANCE;
    for (int r = 0; r < 3; ++r) {
        shift[r] = t[4 * r + 3];
        first[4 * r + 3] = pivot[r];
        for (int c = 0; c < 3; ++c) {
            shift[r] += (linear[3 * r + c] - rotation[3 * r + c]) * pivot[c];
            first[4 * r + c] = stretch[3 * r + c];
            first[4 * r + 3] -= stretch[3 * r + c] * pivot[c];
        }
    }
    set_columns(first, palette);
    sph__quaternion_from_rotation(rotation, palette + SPH__BONE_REAL);
    set_dual(shift, palette + SPH__BONE_REAL, palette + SPH__BONE_DUAL);
    return stretched;
}

bool sph__pose_prepare(const sph_deformer *deformer, const double *transforms, int32_t method, double *palette)
{
    bool stretched = false;
    for (size_t b = 0; b < deformer->bone_count; ++b) {
        double *bone = palette + SPH__BONE_SIZE * b;
        if (method == SPH_POSE_LINEAR)
            set_columns(transforms + 12 * b, bone);
        else if (prepare_dual(transforms + 12 * b, deformer->pivots + 3 * b, bone))
            stretched = true;
    }
    return stretched;
}

/* A batch of poses, as the blocks of their vertices. */
typedef struct batch {
    const sph_deformer *deformer;
    int32_t method;
    size_t blocks; /* of one pose */
    float *positions, *normals;
} batch;

static void move_block(void *argument, size_t begin, size_t end)
{
    const batch *b = argument;
    const sph_deformer *d = b->deformer;
    const size_t n = d->vertex_count;
    for (size_t i = begin; i < end; ++i) {
        const size_t pose = i / b->blocks, first = i % b->blocks * VERTEX_BLOCK;
        const size_t last = n - first < VERTEX_BLOCK ? n : first + VERTEX_BLOCK;
        const double *palette = d->palette + SPH__BONE_SIZE * pose * d->bone_count;
        float *positions = b->positions == NULL ? NULL : b->positions + 3 * n * pose;
        float *normals = b->normals == NULL ? NULL : b->normals + 3 * n * pose;
        if (b->method == SPH_POSE_LINEAR)
            sph__pose_kernel_linear(d, palette, first, last, positions, normals);
        else
            sph__pose_kernel_dual(d, palette, d->stretched[pose], first, last, positions, normals);
    }
}

static sph_status check_transforms(const sph_deformer *d, const double *transforms, size_t pose_count)
{
    for (size_t i = 0; i < 12 * pose_count * d->bone_count; ++i)
        if (!isfinite(transforms[i]))
            return sph__fail(d->context, SPH_E_INVALID, "the transform of bone %zu in pose %zu is not finite",
                             i / 12 % d->bone_count, i / 12 / d->bone_count);
    return SPH_OK;
}

static sph_status check(const sph_deformer *d, const double *transforms, size_t pose_count, int32_t method,
                        const float *normals)
{
    size_t bytes;
    if (transforms == NULL && pose_count != 0)
        return sph__fail(d->context, SPH_E_INVALID, "sph_deformer_pose: the transforms are NULL");
    if (method != SPH_POSE_LINEAR && method != SPH_POSE_DUAL_QUATERNION)
        return sph__fail(d->context, SPH_E_INVALID, "sph_deformer_pose: method is %d", (int)method);
    if (!sph__multiply_size(pose_count, 12 * sizeof(double) * d->bone_count, &bytes) ||
        !sph__multiply_size(pose_count, 3 * sizeof(float) * d->vertex_count, &bytes))
        return sph__fail(d->context, SPH_E_INVALID, "sph_deformer_pose: %zu poses are too many", pose_count);
    if (normals != NULL && d->normals == NULL)
        return sph__fail(d->context, SPH_E_STATE, "normals of a skin that has no triangles, and was given none");
    return check_transforms(d, transforms, pose_count);
}

sph_status sph_deformer_pose(sph_deformer *deformer, const double *transforms, size_t pose_count, int32_t method,
                             float *positions, float *normals)
{
    SPH__OWN(deformer, SPH__DEFORMER);
    batch b = {.deformer = deformer, .method = method};
    sph__progress progress;
    sph_status status;
    if (deformer == NULL) return SPH_E_INVALID;
    if ((status = check(deformer, transforms, pose_count, method, normals)) != SPH_OK) return status;
    sph__progress_begin(&progress, deformer->context);
    sph__progress_part(&progress, 1);
    b.blocks = ((size_t)deformer->vertex_count + VERTEX_BLOCK - 1) / VERTEX_BLOCK;
    for (size_t pose = 0; pose < pose_count && status == SPH_OK; pose += SPH__POSE_BATCH) {
        const size_t count = pose_count - pose < SPH__POSE_BATCH ? pose_count - pose : SPH__POSE_BATCH;
        const size_t at = 3 * (size_t)deformer->vertex_count * pose, bones = deformer->bone_count;
        if (pose_count > SPH__POSE_BATCH)
            status = sph__progress_report(&progress, "posing", (double)pose / (double)pose_count);
        if (status != SPH_OK) return status;
        b.positions = positions == NULL ? NULL : positions + at;
        b.normals = normals == NULL ? NULL : normals + at;
        for (size_t i = 0; i < count; ++i)
            deformer->stretched[i] = sph__pose_prepare(deformer, transforms + 12 * bones * (pose + i), method,
                                                       deformer->palette + SPH__BONE_SIZE * bones * i);
        sph__parallel_for(deformer->context, count * b.blocks, 1, move_block, &b);
    }
    return status;
}
