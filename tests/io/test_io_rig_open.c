/* SPDX-License-Identifier: MIT */
/* Rigs that are read: posed by the core they are what the baker, which shares no arithmetic with it, makes of the file.
 */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "faults.h"
#include "glb.h"
#include "runner.h"
#include "support.h"

enum { FRAMES = 17, VERTICES = 12 };

static sph_context *context;
static glb file;
static sph_io_open_rig_options options;

static void setup(void)
{
    context = test_context();
    file = (glb){.view_count = 0};
    sph_io_open_rig_options_init(&options, sizeof options);
    options.fps = 10;
    files_setup();
}

static void teardown(void)
{
    glb_free(&file);
    files_teardown();
    sph_context_destroy(context);
}

/* Numbers 0 to 12: vertices with two sets of joints, five of them on one; bind matrices; and the keys of two clips. */
static void put_arrays(void)
{
    static const double XYZ[18] = {0, 0, 0, 1, 0.5, 0, 0, 1, 2, 3, 1, 0, 2, 2, 2, -1, 0, 1};
    static const double JOINTS_0[24] = {0, 1, 2, 1, 2, 0, 0, 0, 1, 2, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 2, 1, 0, 0};
    static const double WEIGHTS_0[24] = {0.1, 0.2, 0.3, 0.15, 1,   0,   0, 0, 0.5,  0.5,  0, 0,
                                         0.3, 0.7, 0,   0,    0.9, 0.1, 0, 0, 0.25, 0.75, 0, 0};
    static const double JOINTS_1[24] = {2}, WEIGHTS_1[24] = {0.25};
    static const double BINDS[48] = {1, 0, 0, 0, 0,   1,   0,  0, 0, 0, 1, 0, -1, 0, 0, 1, 0, 2, 0, 0, -2, 0, 0, 0,
                                     0, 0, 2, 0, 0.4, 0.6, -2, 1, 1, 0, 0, 0, 0,  1, 0, 0, 0, 0, 1, 0, 0,  0, 3, 1};
    static const double TIMES[3] = {0, 0.4, 1}, TURNS[12] = {0, 0, 0, 1, 0.6, 0, 0, 0.8, 0, 0.28, 0, -0.96};
    static const double SCALES[9] = {2, 1, 1, 1, 1, 1, 0.5, 3, 1}, SHORT_TIMES[2] = {0, 0.5};
    static const double MOVES[18] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 0, 3, 0, 0, 0, 1}; /* a cubic's */
    glb_floats(&file, "VEC3", 6, XYZ);
    glb_numbers(&file, GLB_U8, "VEC4", 6, JOINTS_0, "");
    glb_floats(&file, "VEC4", 6, WEIGHTS_0);
    glb_numbers(&file, GLB_U16, "VEC4", 6, JOINTS_1, "");
    glb_floats(&file, "VEC4", 6, WEIGHTS_1);
    glb_floats(&file, "MAT4", 3, BINDS);
    glb_floats(&file, "SCALAR", 3, TIMES);
    glb_floats(&file, "VEC4", 3, TURNS);
    glb_floats(&file, "VEC3", 3, SCALES);
    glb_floats(&file, "SCALAR", 2, SHORT_TIMES);
    glb_floats(&file, "VEC3", 6, MOVES);
}

#define ROOM "\"scenes\":[{\"nodes\":[0,1,4]}],"
#define NODES                                                                                                          \
    "\"nodes\":[{\"mesh\":0,\"skin\":0},{\"name\":\"hip\",\"translation\":[1,0,0],\"children\":[2]},"                  \
    "{\"rotation\":[0,0,0.6,0.8],\"children\":[3]},{\"name\":\"knee\",\"scale\":[2,1,1],\"children\":[5]},"            \
    "{\"name\":\"tail\"},{\"name\":\"hat\",\"mesh\":1,\"translation\":[0,5,0]}],"                                      \
    "\"skins\":[{\"joints\":[1,3,4],\"inverseBindMatrices\":5}],"
#define MESHES                                                                                                         \
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"JOINTS_0\":1,\"WEIGHTS_0\":2,\"JOINTS_1\":3,"      \
    "\"WEIGHTS_1\":4}}]},{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]"
#define CLIPS                                                                                                          \
    ",\"animations\":[{\"name\":\"walk\",\"channels\":[{\"sampler\":0,\"target\":{\"node\":1,\"path\":\"rotation\"}}," \
    "{\"sampler\":1,\"target\":{\"node\":3,\"path\":\"scale\"}}],\"samplers\":[{\"input\":6,\"output\":7},"            \
    "{\"input\":6,\"output\":8}]},{\"name\":\"jump\",\"channels\":[{\"sampler\":0,\"target\":{\"node\":4,"             \
    "\"path\":\"translation\"}}],\"samplers\":[{\"input\":9,\"output\":10,\"interpolation\":\"CUBICSPLINE\"}]}]"

static const char *write_rig(bool clips)
{
    put_arrays();
    return glb_write(&file, "rig.glb", clips ? ROOM NODES MESHES CLIPS : ROOM NODES MESHES);
}

static sph_io_rig *open_rig(const char *path)
{
    sph_io_rig *rig = NULL;
    ck_assert_msg(sph_io_open_rig(context, path, &options, &rig) == SPH_OK, "%s", sph_context_last_message(context));
    return rig;
}

static sph_skin_arrays skin_of(const sph_io_rig *rig)
{
    sph_skin_arrays a = {.struct_size = sizeof a};
    ck_assert_int_eq(sph_skin_get_arrays(sph_io_rig_skin(rig), &a), SPH_OK);
    return a;
}

static sph_io_rig_arrays parts_of(const sph_io_rig *rig)
{
    sph_io_rig_arrays a = {.struct_size = sizeof a};
    ck_assert_int_eq(sph_io_rig_get_arrays(rig, &a), SPH_OK);
    return a;
}

/* That every posed frame is the baked one, to `tolerance` of the size of the baked one. */
static void check_baked(const char *path, double tolerance)
{
    sph_io_open_options o;
    sph_status status;
    sph_animation *baked;
    sph_io_rig *rig = open_rig(path);
    const sph_skin_arrays a = skin_of(rig);
    sph_deformer *deformer = NULL;
    const size_t n = 3 * (size_t)a.vertex_count;
    float *expected = test_malloc(n, sizeof *expected), *got = test_malloc(n, sizeof *got);
    sph_io_open_options_init(&o, sizeof o);
    o.fps = options.fps;
    o.clip = options.clip;
    o.first_frame = options.first_frame;
    o.end_frame = options.end_frame;
    o.frame_step = options.frame_step;
    o.weld = SPH_IO_WELD_NONE;
    baked = open_one(context, path, &o, &status);
    ck_assert_int_eq(status, SPH_OK);
    ck_assert_uint_eq(sph_animation_vertex_count(baked), a.vertex_count);
    ck_assert_uint_eq(sph_animation_frame_count(baked), a.frame_count);
    ck_assert_uint_eq(sph_animation_triangle_count(baked), a.triangle_count);
    ck_assert_mem_eq(sph_animation_triangles(baked), a.triangles, a.triangle_count * 3 * sizeof *a.triangles);
    ck_assert_int_eq(sph_deformer_create(sph_io_rig_skin(rig), NULL, &deformer), SPH_OK);
    for (uint32_t f = 0; f < a.frame_count; ++f) {
        double size = 0;
        ck_assert_int_eq(sph_animation_read_frame(baked, f, expected), SPH_OK);
        ck_assert_int_eq(
            sph_deformer_pose(deformer, a.transforms + (size_t)12 * a.bone_count * f, 1, SPH_POSE_LINEAR, got, NULL),
            SPH_OK);
        for (size_t i = 0; i < n; ++i)
            size = fmax(size, fabs((double)expected[i]));
        for (size_t i = 0; i < n; ++i)
            ck_assert_msg(fabs((double)got[i] - (double)expected[i]) <= tolerance * size,
                          "frame %u, vertex %zu: %.9g, not %.9g", (unsigned)f, i / 3, (double)got[i],
                          (double)expected[i]);
    }
    sph_deformer_destroy(deformer);
    sph_animation_destroy(baked);
    sph_io_rig_destroy(rig);
    free(expected);
    free(got);
}

START_TEST(posed_frames_are_the_baked_ones)
{
    check_baked(write_rig(true), 3e-7);
}
END_TEST

START_TEST(frames_that_are_chosen_are_those_of_the_baker)
{
    const char *path = write_rig(true);
    options.first_frame = 4;
    options.frame_step = 3;
    check_baked(path, 3e-7);
    options.end_frame = 12;
    check_baked(path, 3e-7);
    options = (sph_io_open_rig_options){sizeof options, 0, "jump", 24.7, 1, 5, 2, 0};
    check_baked(path, 3e-7);
}
END_TEST

START_TEST(a_rig_without_clips_is_posed_at_rest)
{
    sph_io_rig *rig;
    const char *path = write_rig(false);
    check_baked(path, 3e-7);
    rig = open_rig(path);
    ck_assert_uint_eq(skin_of(rig).clip_count, 1);
    ck_assert_uint_eq(skin_of(rig).frame_count, 1);
    ck_assert_mem_eq(parts_of(rig).joints, parts_of(rig).joints_rest, 4 * 12 * sizeof(double));
    sph_io_rig_destroy(rig);
}
END_TEST

START_TEST(clips_are_those_of_the_file_and_of_the_frames_chosen)
{
    const char *path = write_rig(true);
    sph_io_rig *rig = open_rig(path);
    sph_skin_arrays a = skin_of(rig);
    ck_assert_uint_eq(a.clip_count, 2);
    ck_assert_str_eq(a.clips[0].name, "walk");
    ck_assert_str_eq(a.clips[1].name, "jump");
    ck_assert_uint_eq(a.clips[1].first_frame, 11);
    ck_assert_uint_eq(a.clips[1].frame_count, 6);
    ck_assert_double_eq(a.clips[1].frames_per_second, 10);
    sph_io_rig_destroy(rig);
    options.first_frame = 4; /* 4 7 10 | 13 16 */
    options.frame_step = 3;
    rig = open_rig(path);
    a = skin_of(rig);
    ck_assert_uint_eq(a.clip_count, 2);
    ck_assert_uint_eq(a.clips[0].frame_count, 3);
    ck_assert_uint_eq(a.clips[1].frame_count, 2);
    ck_assert_double_eq_tol(a.clips[0].frames_per_second, 10.0 / 3, 1e-12);
    sph_io_rig_destroy(rig);
    options.first_frame = 12;
    rig = open_rig(path);
    ck_assert_uint_eq(skin_of(rig).clip_count, 1);
    ck_assert_str_eq(skin_of(rig).clips[0].name, "jump");
    sph_io_rig_destroy(rig);
}
END_TEST

START_TEST(joints_have_names_parents_and_places)
{
    static const char *const NAMES[4] = {"hip", "knee", "tail", "hat"};
    static const uint32_t JOINT[4] = {1, 3, 4, 5}, PARENTS[4] = {SPH_NO_JOINT, 0, SPH_NO_JOINT, 1};
    static const double PIVOTS[4][3] = {{1, 0, 0}, {-0.3, 0.2, 1}, {0, 0, -3}, {0, 0, 0}};
    sph_io_rig *rig = open_rig(write_rig(true));
    const sph_io_rig_arrays p = parts_of(rig);
    const sph_skin_arrays a = skin_of(rig);
    ck_assert_uint_eq(p.bone_count, 4);
    ck_assert_uint_eq(p.frame_count, FRAMES);
    ck_assert_uint_eq(p.morphs, 0);
    ck_assert_uint_eq(a.influence_count, 5);
    ck_assert_uint_eq(a.vertex_count, VERTICES);
    ck_assert_uint_eq(a.link_count, 2);
    for (int b = 0; b < 4; ++b) {
        ck_assert_str_eq(p.names[b], NAMES[b]);
        ck_assert_uint_eq(p.nodes[b], JOINT[b]);
        ck_assert_uint_eq(p.parents[b], PARENTS[b]);
        for (int k = 0; k < 3; ++k)
            ck_assert_double_eq_tol(a.pivots[3 * b + k], PIVOTS[b][k], 1e-6);
    }
    ck_assert_double_eq(p.joints_rest[3], 1);       /* the hip's translation */
    for (size_t i = 0; i < (size_t)FRAMES * 4; ++i) /* A = joint times inverse bind */
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 4; ++c) {
                const double *j = p.joints + 12 * i + 4 * r, *m = p.inverse_bind + 12 * (i % 4) + c;
                ck_assert_double_eq_tol(a.transforms[12 * i + 4 * r + c],
                                        j[0] * m[0] + j[1] * m[4] + j[2] * m[8] + (c == 3 ? j[3] : 0), 1e-12);
            }
    sph_io_rig_destroy(rig);
}
END_TEST

/* The rest pose has them with their weights at rest; what a clip does to them cannot be had, and is said. */
START_TEST(morph_targets_stay_at_rest)
{
    static const double XYZ[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, DELTAS[9] = {0, 0, 2, 0, 0, 0, 0, 4, 0};
    static const double TIMES[2] = {0, 1}, WEIGHTS[2] = {0, 1};
    sph_io_rig *rig;
    glb_floats(&file, "VEC3", 3, XYZ);
    glb_floats(&file, "VEC3", 3, DELTAS);
    glb_floats(&file, "SCALAR", 2, TIMES);
    glb_floats(&file, "SCALAR", 2, WEIGHTS);
    rig = open_rig(
        glb_write(&file, "morph.glb",
                  "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"weights\":[0.5],\"primitives\":"
                  "[{\"attributes\":{\"POSITION\":0},\"targets\":[{\"POSITION\":1}]}]}],\"animations\":[{\"channels\":["
                  "{\"sampler\":0,"
                  "\"target\":{\"node\":0,\"path\":\"weights\"}}],\"samplers\":[{\"input\":2,\"output\":3}]}]"));
    ck_assert_uint_eq(parts_of(rig).morphs, 1);
    ck_assert_float_eq(skin_of(rig).rest[2], 1);
    ck_assert_float_eq(skin_of(rig).rest[7], 3);
    sph_io_rig_destroy(rig);
}
END_TEST

static void refuses(const char *path, sph_status expected, const char *message)
{
    sph_io_rig *rig = NULL;
    ck_assert_int_eq(sph_io_open_rig(context, path, &options, &rig), expected);
    ck_assert_ptr_null(rig);
    ck_assert_msg(strstr(sph_context_last_message(context), message) != NULL, "%s", sph_context_last_message(context));
}

START_TEST(what_is_wrong_is_said)
{
    const sph_io_open_rig_options good = options;
    const char *path = write_rig(true);
    sph_io_rig *rig = NULL;
    sph_io_rig_arrays arrays = {.struct_size = 3};
    ck_assert_int_eq(sph_io_open_rig(context, NULL, NULL, &rig), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_open_rig(context, path, NULL, NULL), SPH_E_INVALID);
    options.clip = "fly";
    refuses(path, SPH_E_INVALID, "no clip 'fly': it has walk, jump");
    options = good;
    options.first_frame = FRAMES;
    refuses(path, SPH_E_INVALID, "there are 17");
    options = good;
    options.frame_step = 0;
    refuses(path, SPH_E_INVALID, "step");
    options = good;
    options.fps = NAN;
    refuses(path, SPH_E_INVALID, "frames per second");
    options = good;
    options.flags = 1;
    refuses(path, SPH_E_INVALID, "flags");
    options = good;
    options.fps = 4e6;
    refuses(path, SPH_E_LIMIT, "poses of bones");
    options = good;
    refuses(file_text("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), SPH_E_UNSUPPORTED, "no glTF");
    refuses(file_path("missing.glb"), SPH_E_IO, "missing.glb");
    rig = open_rig(path);
    ck_assert_int_eq(sph_io_rig_get_arrays(rig, &arrays), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_rig_get_arrays(NULL, &arrays), SPH_E_INVALID);
    ck_assert_ptr_null(sph_io_rig_skin(NULL));
    sph_io_rig_destroy(rig);
    sph_io_rig_destroy(NULL);
}
END_TEST

START_TEST(a_rig_outlives_its_context)
{
    test_faulty counted = {0};
    const sph_allocator allocator = test_faulty_allocator(&counted);
    sph_context *other = test_context_with_allocator(&allocator);
    sph_io_rig *rig = NULL;
    ck_assert_int_eq(sph_io_open_rig(other, write_rig(true), &options, &rig), SPH_OK);
    sph_context_destroy(other);
    ck_assert_str_eq(parts_of(rig).names[1], "knee");
    sph_io_rig_destroy(rig);
    ck_assert_uint_eq(counted.live_blocks, 0);
}
END_TEST

/* `user` is the file's path. */
static sph_status open_and_destroy(sph_context *own, const void *user)
{
    sph_io_rig *rig = NULL;
    const sph_status status = sph_io_open_rig(own, user, &options, &rig);
    ck_assert((rig != NULL) == (status == SPH_OK));
    sph_io_rig_destroy(rig);
    return status;
}

START_TEST(any_allocation_may_fail)
{
    const char *path = write_rig(true);
    check_every_allocation((test_faults){.work = open_and_destroy, .user = path, .least = 60, .sticky = _i});
}
END_TEST

START_TEST(meshes_come_back_as_they_were_saved)
{
    static const float XYZ[9] = {0, 0.1f, 0, 1, 0, -3e-9f, 0, 1e20f, 0}, NORMALS[9] = {0, 0, 1, 0, 0, 1, 0, 0, 1};
    static const uint32_t TRIANGLE[3] = {2, 0, 1}, BAD[3] = {0, 1, 3};
    const char *path = file_path(_i / 2 == 0 ? "m.obj" : "m.ply");
    sph_status status;
    sph_animation *a;
    float back[9];
    ck_assert_int_eq(sph_io_save_mesh(context, 3, XYZ, _i % 2 == 0 ? NULL : NORMALS, 1, TRIANGLE, path), SPH_OK);
    a = open_one(context, path, NULL, &status);
    ck_assert_int_eq(status, SPH_OK);
    ck_assert_int_eq(sph_animation_read_frame(a, 0, back), SPH_OK);
    ck_assert_mem_eq(back, XYZ, sizeof back);
    ck_assert_mem_eq(sph_animation_triangles(a), TRIANGLE, sizeof TRIANGLE);
    sph_animation_destroy(a);
    ck_assert_int_eq(sph_io_save_mesh(context, 3, XYZ, NULL, 1, BAD, path), SPH_E_INVALID);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "triangle 0 names vertex 3"));
    ck_assert_int_eq(sph_io_save_mesh(context, 3, NULL, NULL, 1, TRIANGLE, path), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_mesh(context, 3, XYZ, NULL, 1, TRIANGLE, file_path("m.stl")), SPH_E_UNSUPPORTED);
}
END_TEST

START_TEST(rigs_of_others_are_posed_as_they_are_baked)
{
    static const char *const NAMES[] = {"fox.glb", "robot.glb"};
    const char *folder = getenv("SPHMESH_DATA");
    char path[4096];
    if (folder == NULL) {
        fputs("# SPHMESH_DATA is not set: no rigs of others\n", stderr);
        return;
    }
    snprintf(path, sizeof path, "%s/%s", folder, NAMES[_i]);
    options.frame_step = 29;
    check_baked(path, 1e-6);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("io_rig_open");
    TCase *tc = tcase_create("io_rig_open");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_test(tc, posed_frames_are_the_baked_ones);
    tcase_add_test(tc, frames_that_are_chosen_are_those_of_the_baker);
    tcase_add_test(tc, a_rig_without_clips_is_posed_at_rest);
    tcase_add_test(tc, clips_are_those_of_the_file_and_of_the_frames_chosen);
    tcase_add_test(tc, joints_have_names_parents_and_places);
    tcase_add_test(tc, morph_targets_stay_at_rest);
    tcase_add_test(tc, what_is_wrong_is_said);
    tcase_add_test(tc, a_rig_outlives_its_context);
    tcase_add_loop_test(tc, any_allocation_may_fail, 0, 2);
    tcase_add_loop_test(tc, meshes_come_back_as_they_were_saved, 0, 4);
    tcase_add_loop_test(tc, rigs_of_others_are_posed_as_they_are_baked, 0, 2);
    return run_suite(suite, tc);
}
