/* SPDX-License-Identifier: MIT */
/* The keys of a rig: every joint relative to its parent, as floats. */
#include <math.h>
#include <string.h>

#include "io/affine.h"
#include "io/rig.h"

/* Where a joint is in the world, by what its file says: all that was rounded above it is made good by what is below. */
typedef struct pose {
    double turn[9], place[3];
} pose;

static const double RIGID = 1e-6;

static bool is_rigid(const double t[12])
{
    for (int a = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b) {
            const double d = t[4 * a] * t[4 * b] + t[4 * a + 1] * t[4 * b + 1] + t[4 * a + 2] * t[4 * b + 2];
            if (!(fabs(d - (a == b)) <= RIGID)) return false;
        }
    return sph__io_determinant(t) > 0;
}

static sph_status check_rigid(const sph__rig *rig)
{
    const sph_skin_arrays *s = &rig->skin;
    for (size_t i = 0; i < (size_t)s->frame_count * s->bone_count && s->rigid == 0; ++i)
        if (!is_rigid(s->transforms + 12 * i))
            return sph__io_fail(rig->context, SPH_E_UNSUPPORTED,
                                "%s: bone %zu scales, shears or mirrors in frame %zu; only turns and moves are written",
                                sph__io_shown(rig->path), i % s->bone_count, i / s->bone_count);
    return SPH_OK;
}

static void normalize(double q[4])
{
    const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int k = 0; k < 4; ++k)
        q[k] /= length;
}

/* From the largest of the four, which is at least a half (Shepperd 1978). */
static void quaternion(const double r[9], double q[4])
{
    const double trace = r[0] + r[4] + r[8];
    int i = 3;
    double most = trace;
    for (int k = 0; k < 3; ++k)
        if (r[4 * k] > most) {
            most = r[4 * k];
            i = k;
        }
    if (i == 3) {
        q[0] = r[7] - r[5];
        q[1] = r[2] - r[6];
        q[2] = r[3] - r[1];
        q[3] = 1 + trace;
    } else {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        q[i] = 1 + 2 * r[4 * i] - trace;
        q[j] = r[3 * i + j] + r[3 * j + i];
        q[k] = r[3 * i + k] + r[3 * k + i];
        q[3] = r[3 * k + j] - r[3 * j + k];
    }
    normalize(q);
}

static void rotation(const double q[4], double r[9])
{
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    const double out[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
                           2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                           2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
    memcpy(r, out, sizeof out);
}

/* What the file will have the joint do in this frame, and where that puts it. `key` has the turn, then the place. */
static void make_key(const pose *parent, const double t[12], const double at[3], const float *previous, float turn[4],
                     float move[3], pose *out)
{
    double local[9], q[4], off[3], sign;
    for (int r = 0; r < 3; ++r) {
        off[r] = t[4 * r] * at[0] + t[4 * r + 1] * at[1] + t[4 * r + 2] * at[2] + t[4 * r + 3] - parent->place[r];
        for (int c = 0; c < 3; ++c)
            local[3 * r + c] = parent->turn[r] * t[c] + parent->turn[3 + r] * t[4 + c] + parent->turn[6 + r] * t[8 + c];
    }
    quaternion(local, q);
    sign = q[3];
    if (previous != NULL)
        sign = q[0] * (double)previous[0] + q[1] * (double)previous[1] + q[2] * (double)previous[2] +
               q[3] * (double)previous[3];
    for (int k = 0; k < 4; ++k) {
        turn[k] = (float)(sign < 0 ? -q[k] : q[k]);
        q[k] = (double)turn[k];
    }
    normalize(q);
    rotation(q, local);
    for (int r = 0; r < 3; ++r)
        move[r] = (float)(parent->turn[r] * off[0] + parent->turn[3 + r] * off[1] + parent->turn[6 + r] * off[2]);
    for (int r = 0; r < 3; ++r) {
        out->place[r] = parent->place[r];
        for (int c = 0; c < 3; ++c) {
            out->place[r] += parent->turn[3 * r + c] * (double)move[c];
            out->turn[3 * r + c] = parent->turn[3 * r] * local[c] + parent->turn[3 * r + 1] * local[3 + c] +
                                   parent->turn[3 * r + 2] * local[6 + c];
        }
    }
}

/* Joints as the file has them: inverse bind matrices are floats, and all else follows from these. */
static void joint_place(const sph__rig *rig, uint32_t joint, double at[3])
{
    for (int k = 0; k < 3; ++k)
        at[k] = (double)(float)rig->joints.positions[3 * (size_t)joint + k];
}

static void make_frame(const sph__rig *rig, const sph_skin_clip *clip, uint32_t frame, pose *poses)
{
    static const pose STILL = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    const sph_skeleton_arrays *a = &rig->joints;
    const size_t bones = a->bone_count, count = clip->frame_count;
    const double *transforms = rig->skin.transforms + 12 * bones * (clip->first_frame + (size_t)frame);
    float *keys = rig->keys + 7 * bones * clip->first_frame;
    for (uint32_t i = 0; i < a->joint_count; ++i) {
        const uint32_t j = a->order[i], parent = a->parents[j];
        float *turns = keys + 7 * count * j, *turn = turns + 4 * (size_t)frame;
        double at[3];
        if (j == sph__rig_root(rig)) {
            poses[j] = STILL;
            continue;
        }
        joint_place(rig, j, at);
        make_key(parent == SPH_NO_JOINT ? &STILL : &poses[parent], transforms + 12 * (size_t)j, at,
                 frame == 0 ? NULL : turn - 4, turn, turns + 4 * count + 3 * (size_t)frame, &poses[j]);
    }
}

/* Translations at rest, so that their sums along the tree, in floats, are the places of the inverse bind matrices. */
static void make_rest(sph__rig *rig, pose *poses)
{
    const sph_skeleton_arrays *a = &rig->joints;
    for (uint32_t i = 0; i < a->joint_count; ++i) {
        const uint32_t j = a->order[i], parent = a->parents[j];
        double at[3];
        joint_place(rig, j, at);
        for (int k = 0; k < 3; ++k) {
            const double above = parent == SPH_NO_JOINT ? 0 : poses[parent].place[k];
            const float move = (float)(at[k] - above);
            rig->rest[3 * (size_t)j + k] = move;
            poses[j].place[k] = above + (double)move;
        }
    }
}

/* Numbers beyond what a float holds would make a file that nobody reads. */
static sph_status check_rest(const sph__rig *rig)
{
    for (size_t i = 0; i < 3 * (size_t)rig->joints.joint_count; ++i)
        if (!isfinite(rig->rest[i]))
            return sph__io_fail(rig->context, SPH_E_LIMIT, "%s: joint %zu is farther away than a float holds",
                                sph__io_shown(rig->path), i / 3);
    return SPH_OK;
}

static sph_status check_clip(const sph__rig *rig, const sph_skin_clip *clip)
{
    const size_t bones = rig->joints.bone_count, size = 7 * (size_t)clip->frame_count;
    const float *keys = rig->keys + 7 * bones * clip->first_frame;
    for (size_t i = 0; i < bones * size; ++i)
        if (!isfinite(keys[i]))
            return sph__io_fail(rig->context, SPH_E_LIMIT, "%s: bone %zu moves farther away than a float holds",
                                sph__io_shown(rig->path), i / size);
    return SPH_OK;
}

sph_status sph__rig_report(const sph__rig *rig, const char *stage, double half, const sph_skin_clip *clip)
{
    const double share = half + 0.5 * (double)clip->first_frame / rig->skin.frame_count;
    return sph_context_report_progress(rig->context, stage, rig->reported + (1 - rig->reported) * share);
}

sph_status sph__rig_make_keys(sph__rig *rig)
{
    const size_t joints = rig->joints.joint_count, bones = rig->joints.bone_count;
    const size_t frames = rig->skin.frame_count;
    sph_status status = check_rigid(rig);
    pose *poses;
    if (status != SPH_OK) return status;
    poses = sph_context_allocate(rig->context, joints, sizeof *poses);
    rig->rest = sph_context_allocate(rig->context, joints, 3 * sizeof *rig->rest);
    rig->keys = frames != 0 && bones > SIZE_MAX / frames
                    ? NULL
                    : sph_context_allocate(rig->context, bones * frames, 7 * sizeof *rig->keys);
    if (poses == NULL || rig->rest == NULL || rig->keys == NULL) {
        status = sph__io_fail_memory(rig->context, rig->path);
    } else {
        make_rest(rig, poses);
        status = check_rest(rig);
        for (uint32_t c = 0; c < rig->skin.clip_count && status == SPH_OK; ++c) {
            const sph_skin_clip *clip = &rig->skin.clips[c];
            status = sph__rig_report(rig, "keys", 0, clip);
            for (uint32_t f = 0; f < clip->frame_count && status == SPH_OK; ++f)
                make_frame(rig, clip, f, poses);
            if (status == SPH_OK) status = check_clip(rig, clip);
        }
    }
    sph_context_release(rig->context, poses);
    return status;
}
