/* SPDX-License-Identifier: MIT */
/* Skinned glTF: what our own reader makes of it, and what is refused or fails. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "faults.h"
#include "rig_case.h"
#include "runner.h"

/* --- read back --- */

/* That the clip's frames, baked at their own rate, are the skin's from `first` on. */
static void check_clip(const char *clip, double fps, uint32_t first, uint32_t count, double tolerance)
{
    static float xyz[3 * RIG_VERTICES_MOST];
    sph_io_open_options o;
    sph_animation *animation;
    sph_status status;
    sph_io_open_options_init(&o, sizeof o);
    o.clip = clip;
    o.fps = fps;
    o.weld = SPH_IO_WELD_NONE;
    animation = open_one(context, path, &o, &status);
    ck_assert_msg(status == SPH_OK, "%s", sph_context_last_message(context));
    ck_assert_uint_eq(sph_animation_vertex_count(animation), skin.vertex_count);
    ck_assert_uint_eq(sph_animation_frame_count(animation), count);
    ck_assert_mem_eq(sph_animation_triangles(animation), skin.triangles, 12 * skin.triangle_count);
    for (uint32_t f = 0; f < count; ++f) {
        ck_assert_int_eq(sph_animation_read_frame(animation, f, xyz), SPH_OK);
        for (uint32_t v = 0; v < skin.vertex_count; ++v) {
            double p[3];
            rig_vertex(&skin, first + f, v, p);
            for (int k = 0; k < 3; ++k)
                ck_assert_msg(fabs((double)xyz[3 * v + (unsigned)k] - p[k]) <= tolerance,
                              "frame %u vertex %u axis %d: %.9g, not %.9g", f, v, k, (double)xyz[3 * v + (unsigned)k],
                              p[k]);
        }
    }
    sph_animation_destroy(animation);
}

typedef struct seen_clips {
    char names[2][16];
    unsigned count;
} seen_clips;

static void see_clip(void *user, const sph_io_clip *clip)
{
    seen_clips *s = user;
    ck_assert_uint_lt(s->count, 2);
    snprintf(s->names[s->count++], sizeof s->names[0], "%s", clip->name);
}

/* 0, 1: a tree, without and with a root above it; 2, 3: a list. 4 to 7: as .gltf and .bin. */
START_TEST(our_own_reader_gives_back_every_frame_of_every_clip)
{
    seen_clips seen = {.count = 0};
    sph_skin *made;
    rig_input_make(&input, 120, 9, 4);
    if (_i >= 4) path = file_path("a rig + \xC3\xA9.gltf");
    made = save(_i & 2 ? SPH_SKELETON_FLAT : SPH_SKELETON_TREE, _i & 1, SPH_IO_WEIGHTS_FLOAT);
    ck_assert_uint_eq(file_count(), _i >= 4 ? 2 : 1);
    ck_assert_int_eq(sph_io_list_clips(context, path, 24, see_clip, &seen), SPH_OK);
    ck_assert_uint_eq(seen.count, 2);
    ck_assert_str_eq(seen.names[0], "walk");
    ck_assert_str_eq(seen.names[1], "clip_1");
    check_clip("walk", 24, 0, 10, 1e-6);
    check_clip("1", 30, 10, 5, 1e-6);
    sph_skin_destroy(made);
}
END_TEST

/* 300 joints that hang on one another: rounding in one is made good in the next. */
START_TEST(a_long_chain_is_as_exact_as_a_short_one)
{
    sph_skin *made;
    rig_input_make(&input, 100, 300, 2);
    input.clips[0].frames_per_second = 32; /* exact times: at others every joint is a little beside its key */
    made = save(SPH_SKELETON_TREE, 0, SPH_IO_WEIGHTS_FLOAT);
    check_clip("walk", 32, 0, 10, 5e-7);
    sph_skin_destroy(made);
}
END_TEST

START_TEST(many_influences_in_any_kind_of_weights_are_as_exact_as_their_numbers)
{
    static const double TOLERANCE[] = {1e-6, 2.0 / 255, 2.0 / 65535};
    sph_skin *made;
    rig_input_make(&input, 120, 12, 9);
    made = save(SPH_SKELETON_TREE, 0, _i);
    check_clip("walk", 24, 0, 10, 4 * TOLERANCE[_i]);
    sph_skin_destroy(made);
}
END_TEST

START_TEST(a_skin_without_frames_is_a_rig_at_rest)
{
    sph_skin *made;
    rig_file file;
    rig_input_make(&input, 40, 5, 4);
    input.arrays.frame_count = input.arrays.clip_count = 0;
    made = save(SPH_SKELETON_TREE, 0, SPH_IO_WEIGHTS_FLOAT);
    rig_open(&file, path);
    ck_assert_ptr_null(rig_value(&file, "animations"));
    rig_close(&file);
    for (uint32_t i = 0; i < 12 * 5; ++i)
        input.transforms[i] = i % 12 % 5 == 0;
    input.arrays.frame_count = 1;
    sph_skin_destroy(made);
    made = rig_skin(context, &input);
    ck_assert_int_eq(sph_skin_get_arrays(made, &skin), SPH_OK);
    check_clip(NULL, 30, 0, 1, 1e-6);
    sph_skin_destroy(made);
}
END_TEST

/* --- failures --- */

static void refuses(sph_status expected, const char *message, const sph_io_rig_options *o, const char *to)
{
    sph_skin *made = rig_skin(context, &input);
    const sph_status status = sph_io_save_rig(context, made, NULL, o, to);
    ck_assert_msg(status == expected, "%d: %s", (int)status, sph_context_last_message(context));
    ck_assert_msg(strstr(sph_context_last_message(context), message) != NULL, "%s", sph_context_last_message(context));
    ck_assert_uint_eq(file_count(), 0);
    sph_skin_destroy(made);
}

START_TEST(what_cannot_be_written_is_refused_by_name)
{
    sph_io_rig_options good, o;
    sph_skin *made;
    sph_skeleton *other = NULL;
    sph_io_rig_options_init(&good, sizeof good);
    rig_input_make(&input, 40, 5, 4);
    refuses(SPH_E_UNSUPPORTED, "rig.fbx", NULL, file_path("rig.fbx"));
    refuses(SPH_E_IO, "No such file", NULL, file_path("nowhere/rig.glb"));
    refuses(SPH_E_IO, "No such file", NULL, file_path("nowhere/rig.gltf"));
    o = good, o.weights = 3, refuses(SPH_E_INVALID, "weights is 3", &o, path);
    o = good, o.frames_per_second = 0, refuses(SPH_E_INVALID, "0 frames per second", &o, path);
    o = good, o.frames_per_second = NAN, refuses(SPH_E_INVALID, "frames per second", &o, path);
    o = good, o.flags = 1, refuses(SPH_E_INVALID, "flags", &o, path);
    o = good, o.struct_size = 4, refuses(SPH_E_INVALID, "struct_size", &o, path);
    input.clips[1].frames_per_second = 1e9;
    refuses(SPH_E_INVALID, "clip 1", NULL, path);
    input.clips[1].frames_per_second = 0;
    made = rig_skin(context, &input);
    ck_assert_int_eq(sph_skeleton_create(made, NULL, &other), SPH_OK);
    sph_skin_destroy(made);
    input.transforms[12 * (5 * 7 + 3)] *= 1.01;
    refuses(SPH_E_UNSUPPORTED, "bone 3 scales, shears or mirrors in frame 7", NULL, path);
    rig_input_make(&input, 40, 5, 4);
    input.transforms[12 * (5 * 7 + 3) + 11] = 1e39; /* no float: JSON has no word for what it would become */
    refuses(SPH_E_LIMIT, "bone 3 moves farther away than a float holds", NULL, path);
    rig_input_make(&input, 40, 5, 4);
    input.pivots[3 * 2] = -1e39;
    refuses(SPH_E_LIMIT, "is farther away than a float holds", NULL, path);
    rig_input_make(&input, 40, 6, 4);
    made = rig_skin(context, &input);
    ck_assert_int_eq(sph_io_save_rig(context, made, other, NULL, path), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_rig(context, NULL, other, NULL, path), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_rig(context, made, other, NULL, NULL), SPH_E_INVALID);
    ck_assert_uint_eq(file_count(), 0);
    sph_skeleton_destroy(other);
    sph_skin_destroy(made);
}
END_TEST

/* Memory that fails, and a host that cancels, at every place: nothing is left, in the folder or in memory. */
static sph_status save_anew(sph_context *own, const void *user)
{
    sph_skin *made = rig_skin(own, &input);
    sph_status status = SPH_E_NOMEM;
    (void)user;
    if (made != NULL) status = sph_io_save_rig(own, made, NULL, NULL, path);
    sph_skin_destroy(made);
    ck_assert_uint_eq(file_count(), status != SPH_OK ? 0 : strstr(path, ".gltf") == NULL ? 1 : 2);
    return status;
}

START_TEST(whatever_fails_leaves_no_file_behind) /* _i: once, or from there on; in one file, or two */
{
    rig_input_make(&input, 40, 5, 4);
    path = file_path(_i / 2 == 0 ? "rig.glb" : "rig.gltf");
    check_every_allocation((test_faults){.work = save_anew, .least = 40, .sticky = _i % 2});
}
END_TEST

/* `user` is the skeleton; NULL: the call makes its own. */
static sph_status save_again(sph_context *own, const void *user)
{
    sph_skin *made = rig_skin(own, &input);
    const sph_status status = sph_io_save_rig(own, made, user, NULL, path);
    unsigned char *bytes;
    size_t size;
    sph_skin_destroy(made);
    ck_assert_uint_eq(file_count(), 1);
    bytes = file_read(path, &size);
    if (status != SPH_OK) {
        ck_assert_uint_eq(size, 6);
        ck_assert_mem_eq(bytes, "before", 6);
    } else {
        ck_assert_uint_gt(size, 6);
    }
    free(bytes);
    return status;
}

START_TEST(progress_rises_and_cancelling_leaves_what_was_there)
{
    sph_skeleton *skeleton = NULL;
    sph_skin *made;
    rig_input_make(&input, 40, 5, 4);
    made = rig_skin(context, &input);
    if (_i == 1) ck_assert_int_eq(sph_skeleton_create(made, NULL, &skeleton), SPH_OK);
    file_text("rig.glb", "before");
    check_every_cancel((test_faults){.work = save_again, .user = skeleton, .least = 4});
    sph_skeleton_destroy(skeleton);
    sph_skin_destroy(made);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("io_rig");
    TCase *tc = tcase_create("rig");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, our_own_reader_gives_back_every_frame_of_every_clip, 0, 8);
    tcase_add_test(tc, a_long_chain_is_as_exact_as_a_short_one);
    tcase_add_loop_test(tc, many_influences_in_any_kind_of_weights_are_as_exact_as_their_numbers, 0, 3);
    tcase_add_test(tc, a_skin_without_frames_is_a_rig_at_rest);
    tcase_add_test(tc, what_cannot_be_written_is_refused_by_name);
    tcase_add_loop_test(tc, whatever_fails_leaves_no_file_behind, 0, 4);
    tcase_add_loop_test(tc, progress_rises_and_cancelling_leaves_what_was_there, 0, 2);
    return run_suite(suite, tc);
}
