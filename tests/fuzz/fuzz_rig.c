/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <unistd.h>

#include "fuzz.h"
#include "fuzz_rig.h"

enum { PATH_SIZE = 128, SIZE_LIMIT = 100000, CLIP_LIMIT = 4 };

static void check_skin(const sph_skin *skin, sph_skin_arrays *a)
{
    *a = (sph_skin_arrays){.struct_size = sizeof *a};
    FUZZ_CHECK(sph_skin_get_arrays(skin, a) == SPH_OK);
    FUZZ_CHECK(a->vertex_count > 0 && a->bone_count > 0 && a->influence_count > 0);
    for (size_t i = 0; i < 3 * (size_t)a->vertex_count; ++i)
        FUZZ_CHECK(isfinite(a->rest[i]));
    for (size_t v = 0; v < a->vertex_count; ++v) {
        double sum = 0;
        for (size_t k = v * a->influence_count; k < (v + 1) * a->influence_count; ++k) {
            FUZZ_CHECK(a->bones[k] < a->bone_count && a->weights[k] >= 0);
            FUZZ_CHECK(k == v * a->influence_count || a->weights[k] <= a->weights[k - 1]);
            sum += (double)a->weights[k];
        }
        FUZZ_CHECK(sum == 1);
    }
    for (size_t i = 0; i < 12 * (size_t)a->frame_count * a->bone_count; ++i)
        FUZZ_CHECK(isfinite(a->transforms[i]));
    for (size_t i = 0; i < 3 * a->triangle_count; ++i)
        FUZZ_CHECK(a->triangles[i] < a->vertex_count);
    for (size_t i = 0; i < a->link_count; ++i)
        FUZZ_CHECK(a->links[2 * i] < a->links[2 * i + 1] && a->links[2 * i + 1] < a->bone_count);
}

/* Every joint comes after its parent, and frame 0 relative to parents is frame 0. */
static void use_skeleton(const sph_skin *skin, const sph_skin_arrays *a)
{
    sph_skeleton *skeleton = NULL;
    sph_skeleton_arrays s = {.struct_size = sizeof s};
    if (sph_skeleton_create(skin, NULL, &skeleton) == SPH_OK) {
        double *locals, *back;
        FUZZ_CHECK(sph_skeleton_get_arrays(skeleton, &s) == SPH_OK && s.bone_count == a->bone_count);
        locals = calloc(12 * (size_t)s.joint_count, sizeof *locals);
        back = calloc(12 * (size_t)s.joint_count, sizeof *back);
        FUZZ_CHECK(locals != NULL && back != NULL);
        for (size_t i = 0; i < s.joint_count; ++i)
            FUZZ_CHECK(s.order[i] < s.joint_count && (s.parents[i] < s.joint_count || s.parents[i] == SPH_NO_JOINT));
        if (a->frame_count > 0 && sph_skeleton_get_locals(skeleton, a->transforms, locals) == SPH_OK)
            (void)sph_skeleton_get_transforms(skeleton, locals, back);
        free(locals);
        free(back);
    }
    sph_skeleton_destroy(skeleton);
}

static void use_deformer(const sph_skin *skin, const sph_skin_arrays *a)
{
    sph_deformer *deformer = NULL;
    if (sph_deformer_create(skin, NULL, &deformer) == SPH_OK) {
        float *xyz = calloc(6 * (size_t)a->vertex_count, sizeof *xyz), *normals = xyz + 3 * (size_t)a->vertex_count;
        FUZZ_CHECK(xyz != NULL);
        for (int32_t method = SPH_POSE_LINEAR; a->frame_count > 0 && method <= SPH_POSE_DUAL_QUATERNION; ++method)
            if (sph_deformer_pose(deformer, a->transforms, 1, method, xyz, a->triangle_count > 0 ? normals : NULL) ==
                SPH_OK)
                for (size_t i = 3 * (size_t)a->vertex_count; i < 6 * (size_t)a->vertex_count; ++i)
                    FUZZ_CHECK(xyz[i] >= -1.001F && xyz[i] <= 1.001F);
        free(xyz);
    }
    sph_deformer_destroy(deformer);
}

void fuzz_use_skin(const sph_skin *skin)
{
    sph_skin_arrays a;
    check_skin(skin, &a);
    if (a.vertex_count > SIZE_LIMIT || a.bone_count > SIZE_LIMIT) return;
    use_skeleton(skin, &a);
    use_deformer(skin, &a);
}

/* Reads one clip at its own rate, or the pose at rest where `clip` is NULL: the same mesh, and `frames` frames. */
static void read_back(sph_context *context, const char *path, const sph_skin_arrays *a, const char *clip, double fps,
                      uint32_t frames)
{
    sph_io_open_rig_options o;
    sph_skin_arrays b;
    sph_io_rig *again = NULL;
    sph_status status;
    sph_io_open_rig_options_init(&o, sizeof o);
    o.clip = clip;
    o.fps = fps;
    status = sph_io_open_rig(context, path, &o, &again);
    FUZZ_CHECK(status == SPH_OK || status == SPH_E_NOMEM || status == SPH_E_CANCELLED);
    if (status == SPH_OK) {
        check_skin(sph_io_rig_skin(again), &b);
        FUZZ_CHECK(b.vertex_count <= a->vertex_count && b.triangle_count == a->triangle_count);
        for (size_t i = 0; i < 3 * a->triangle_count; ++i) /* vertices of no triangle are left out */
            FUZZ_CHECK(memcmp(a->rest + 3 * (size_t)a->triangles[i], b.rest + 3 * (size_t)b.triangles[i], 12) == 0);
        FUZZ_CHECK(b.frame_count == frames);
    }
    sph_io_rig_destroy(again);
}

void fuzz_save_skin(sph_context *context, const sph_skin *skin)
{
    char path[PATH_SIZE];
    const char *folder = getenv("TMPDIR");
    sph_skin_arrays a;
    check_skin(skin, &a);
    if (a.vertex_count > SIZE_LIMIT || a.bone_count > SIZE_LIMIT || a.triangle_count == 0) return;
    if (folder == NULL || strlen(folder) > PATH_SIZE / 2) folder = "/tmp";
    snprintf(path, sizeof path, "%s/sphmesh-fuzz-%ld-saved.glb", folder, (long)getpid());
    if (sph_io_save_rig(context, skin, NULL, NULL, path) != SPH_OK) return;
    for (uint32_t i = 0; i < a.clip_count && i < CLIP_LIMIT; ++i) {
        char number[16];
        const double fps = a.clips[i].frames_per_second;
        snprintf(number, sizeof number, "%u", i);
        read_back(context, path, &a, number, fps > 0 ? fps : 30, a.clips[i].frame_count);
    }
    if (a.frame_count == 0) read_back(context, path, &a, NULL, 0, 1);
    unlink(path);
}

void fuzz_use_rig(sph_context *context, const sph_io_rig *rig)
{
    sph_io_rig_arrays r = {.struct_size = sizeof r};
    const sph_skin *skin = sph_io_rig_skin(rig);
    sph_skin_arrays a;
    check_skin(skin, &a);
    FUZZ_CHECK(sph_io_rig_get_arrays(rig, &r) == SPH_OK && r.bone_count == a.bone_count);
    FUZZ_CHECK(r.frame_count == a.frame_count && a.frame_count > 0);
    for (size_t i = 0; i < r.bone_count; ++i) {
        FUZZ_CHECK(r.names[i] != NULL);
        FUZZ_CHECK(r.parents[i] == SPH_NO_JOINT || (r.parents[i] < r.bone_count && r.parents[i] != i));
    }
    for (size_t i = 0; i < 2 * r.edge_count; ++i)
        FUZZ_CHECK(r.edges[i] < a.vertex_count);
    fuzz_use_skin(skin);
    fuzz_save_skin(context, skin);
}
