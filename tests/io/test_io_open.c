/* SPDX-License-Identifier: MIT */
/* Sequences, and the options of sph_io_open_animation. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "files.h"
#include "runner.h"
#include "support.h"

static sph_context *context;
static sph_io_open_options options;

static void setup(void)
{
    context = test_context();
    files_setup();
    sph_io_open_options_init(&options, sizeof options);
}

static void teardown(void)
{
    files_teardown();
    sph_context_destroy(context);
}

START_TEST(names_sort_as_people_count)
{
    const char *names[] = {"s10",     "s2", "s1",   "s01", "s2a10", "s2a9", "a", "s", "s99999999999999999999999999",
                           "s100000", "t1", "s002", "",    "S3",    "s2"};
    static const char *const SORTED[] = {"",   "S3", "a",    "s",     "s01", "s1",      "s002",
                                         "s2", "s2", "s2a9", "s2a10", "s10", "s100000", "s99999999999999999999999999",
                                         "t1"};
    sph_io_sort_natural(names, 15);
    for (size_t i = 0; i < 15; ++i)
        ck_assert_str_eq(names[i], SORTED[i]);
    sph_io_sort_natural(NULL, 3);
    sph_io_sort_natural(names, 0);
}
END_TEST

START_TEST(any_shuffle_of_numbered_names_sorts_back)
{
    enum { COUNT = 300 };
    static char text[COUNT][16];
    const char *names[COUNT];
    uint64_t state = 5;
    for (size_t i = 0; i < COUNT; ++i) {
        snprintf(text[i], sizeof text[i], "f_%zu.obj", i);
        names[i] = text[i];
    }
    for (int round = 0; round < 20; ++round) {
        const size_t count = 1 + test_random(&state) % COUNT;
        for (size_t i = count; i-- > 1;) {
            const size_t j = test_random(&state) % (i + 1);
            const char *name = names[i];
            names[i] = names[j];
            names[j] = name;
        }
        sph_io_sort_natural(names, count);
        for (size_t i = 0; i < count; ++i)
            ck_assert_ptr_eq(names[i], text[i]);
    }
}
END_TEST

/* wolf_0.obj ... wolf_11.obj, frame by frame. */
static void write_sequence(uint32_t vertices, uint32_t frames, const char *format)
{
    for (uint32_t f = 0; f < frames; ++f) {
        char name[64];
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
        snprintf(name, sizeof name, format, f);
#pragma GCC diagnostic pop
        write_obj(name, vertices, f);
    }
}

START_TEST(a_sequence_is_named_by_pattern_glob_or_list_and_comes_in_natural_order)
{
    const char *paths[12];
    sph_status status;
    sph_animation *animation = NULL;
    write_sequence(5, 12, _i == 1 ? "wolf_%04u.obj" : "wolf_%u.obj");
    file_text("wolf_.obj", "v");
    file_text("wolf_1.objx", "v");
    file_text("wolf_1x.obj2", "v");
    file_text("wolf_01.obj1", "v");
    if (_i == 0) animation = open_one(context, file_path("wolf_%d.obj"), NULL, &status);
    if (_i == 1) animation = open_one(context, file_path("wolf_%04d.obj"), NULL, &status);
    if (_i == 2) animation = open_one(context, file_path("wolf_*[0-9].obj"), NULL, &status);
    if (_i == 3) {
        for (unsigned i = 0; i < 12; ++i) {
            char name[64];
            snprintf(name, sizeof name, "wolf_%u.obj", (i * 5 + 3) % 12);
            paths[i] = file_path(name);
        }
        status = sph_io_open_animation(context, paths, 12, NULL, &animation);
    }
    ck_assert_int_eq(status, SPH_OK);
    check_frames(context, animation, 5, 12, 0, 1);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(a_padded_pattern_takes_padded_names_only)
{
    sph_status status;
    sph_animation *animation;
    write_sequence(5, 3, "s%04u.obj");
    write_obj("s1.obj", 6, 0);
    write_obj("s00001.obj", 6, 0);
    animation = open_one(context, file_path("s%04d.obj"), NULL, &status);
    check_frames(context, animation, 5, 3, 0, 1);
    sph_animation_destroy(animation);
    ck_assert_ptr_null(open_one(context, file_path("x%04d.obj"), NULL, &status));
    ck_assert_int_eq(status, SPH_E_IO);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "no file has such a name"));
    ck_assert_ptr_null(open_one(context, file_path("x*.obj"), NULL, &status));
    ck_assert_int_eq(status, SPH_E_IO);
    ck_assert_ptr_null(open_one(context, file_path("x%d/x%d.obj"), NULL, &status));
    ck_assert_int_eq(status, SPH_E_UNSUPPORTED);
    ck_assert_ptr_null(open_one(context, file_path("x%d_%d.obj"), NULL, &status));
    ck_assert_int_eq(status, SPH_E_UNSUPPORTED);
}
END_TEST

START_TEST(a_file_whose_name_looks_like_a_pattern_is_that_file)
{
    sph_status status;
    sph_animation *animation = open_one(context, write_obj("a%d[1]*.obj", 4, 0), NULL, &status);
    check_frames(context, animation, 4, 1, 0, 1);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(frames_scale_and_axis_are_applied)
{
    float xyz[15];
    sph_status status;
    sph_animation *animation;
    const char *path = write_obj("m.obj", 5, 0);
    options.first_frame = 2;
    options.frame_step = 3;
    if (_i < 3) {
        options.cache_path = write_cache("c.pc2", 5, 12);
    } else {
        write_sequence(5, 12, "w%u.obj");
        path = file_path("w%d.obj");
    }
    if (_i == 1) options.end_frame = 9;
    if (_i == 2) options.end_frame = 8;
    animation = open_one(context, path, &options, &status);
    check_frames(context, animation, 5, _i == 1 ? 3 : _i == 2 ? 2 : 4, 2, 3); /* 2 5 8 (11) */
    sph_animation_destroy(animation);
    options.up_axis = SPH_UP_Z;
    options.scale = -0.5;
    animation = open_one(context, path, &options, &status);
    ck_assert_int_eq(sph_animation_read_frame(animation, 1, xyz), SPH_OK);
    for (uint32_t i = 0; i < 5; ++i) {
        ck_assert_float_eq(xyz[3 * i], -0.5f * coordinate(5, i, 0));
        ck_assert_float_eq(xyz[3 * i + 1], -0.5f * coordinate(5, i, 2));
        ck_assert_float_eq(xyz[3 * i + 2], 0.5f * coordinate(5, i, 1));
    }
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(one_mesh_alone_is_scaled_and_turned_too)
{
    float xyz[12];
    sph_status status;
    sph_animation *animation;
    options.up_axis = SPH_UP_Z;
    options.scale = 2;
    animation = open_one(context, write_obj("m.obj", 4, 0), &options, &status);
    ck_assert_int_eq(sph_animation_read_frame(animation, 0, xyz), SPH_OK);
    ck_assert_float_eq(xyz[4], 2 * coordinate(0, 1, 2));
    ck_assert_float_eq(xyz[5], -2 * coordinate(0, 1, 1));
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(frames_that_are_not_there_are_refused)
{
    sph_status status;
    const char *path = write_obj("m.obj", 5, 0);
    options.cache_path = write_cache("c.pc2", 5, 12);
    options.first_frame = _i == 0 ? 12 : 3;
    options.end_frame = _i == 0 ? 0 : _i == 1 ? 13 : 3;
    ck_assert_ptr_null(open_one(context, path, &options, &status));
    ck_assert_int_eq(status, SPH_E_INVALID);
    if (_i < 2) ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "there are 12"));
}
END_TEST

START_TEST(frames_that_are_not_taken_need_not_be_right)
{
    sph_status status;
    sph_animation *animation;
    write_sequence(5, 5, "w%u.obj");
    file_text("w3.obj", "v x");
    options.end_frame = 3;
    animation = open_one(context, file_path("w%d.obj"), &options, &status);
    check_frames(context, animation, 5, 3, 0, 1);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(a_mesh_that_is_not_the_first_ones_is_refused_with_what_differs)
{
    static const struct {
        const char *text, *message;
    } CASES[] = {{"v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n", "w2.obj: 3 vertices, but 4 in "},
                 {"v 0 0 0\nv 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n", "w2.obj: 1 triangles, but 2 in "},
                 {"v 0 0 0\nv 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n\nf 2 4 3\n",
                  "w2.obj: line 7: triangle 1 is (2 4 3), but (2 3 4) in "},
                 {"v 0 0 0\nv 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\nf 2 3 4\nl 1 2\n", "w2.obj: 1 edges, but 0 in "},
                 {"v 0 0 0\nv 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\nf 2 3 9\n", "w2.obj: line 6: vertex index 9"}};
    sph_status status;
    write_sequence(4, 4, "w%u.obj");
    file_text("w2.obj", CASES[_i].text);
    ck_assert_ptr_null(open_one(context, file_path("w%d.obj"), NULL, &status));
    ck_assert_int_eq(status, SPH_E_FORMAT);
    ck_assert_msg(strstr(sph_context_last_message(context), CASES[_i].message) != NULL, "%s",
                  sph_context_last_message(context));
}
END_TEST

START_TEST(other_wire_edges_are_refused)
{
    sph_status status;
    file_text("w0.obj", "v 0 0 0\nv 0 0 0\nv 0 0 0\nl 1 2 3\n");
    file_text("w1.obj", "v 0 0 0\nv 0 0 0\nv 0 0 0\nl 1 2 1\n");
    ck_assert_ptr_null(open_one(context, file_path("w%d.obj"), NULL, &status));
    ck_assert_int_eq(status, SPH_E_FORMAT);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "w1.obj: edge 1 "));
}
END_TEST

START_TEST(a_file_that_changes_later_is_noticed_when_its_frame_is_read)
{
    float xyz[12];
    sph_status status;
    sph_animation *animation;
    write_sequence(4, 3, "w%u.obj");
    animation = open_one(context, file_path("w%d.obj"), NULL, &status);
    check_frames(context, animation, 4, 3, 0, 1);
    write_obj("w1.obj", 5, 1);
    ck_assert_int_eq(sph_animation_read_frame(animation, 1, xyz), SPH_E_FORMAT);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "5 vertices, but 4 in"));
    ck_assert_int_eq(sph_animation_read_frame(animation, 2, xyz), SPH_OK);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(an_animation_outlives_the_callers_context)
{
    sph_status status;
    sph_context *own = test_context();
    sph_animation *animation;
    options.cache_path = write_cache("c.mdd", 5, 3);
    animation = open_one(own, write_obj("m.obj", 5, 0), &options, &status);
    sph_context_destroy(own);
    check_frames(context, animation, 5, 3, 0, 1);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(a_cache_with_a_sequence_is_refused)
{
    sph_status status;
    write_sequence(5, 3, "w%u.obj");
    options.cache_path = write_cache("c.mdd", 5, 3);
    ck_assert_ptr_null(open_one(context, file_path("w%d.obj"), &options, &status));
    ck_assert_int_eq(status, SPH_E_INVALID);
}
END_TEST

START_TEST(options_and_arguments_are_checked)
{
    const char *path = write_obj("m.obj", 4, 0), *none = NULL;
    sph_animation *animation = (sph_animation *)&options;
    const struct sph_io_open_options unset = {0};
    sph_status status;
    ck_assert_int_eq(sph_io_open_animation(NULL, &path, 1, NULL, &animation), SPH_E_INVALID);
    ck_assert_ptr_null(animation);
    ck_assert_int_eq(sph_io_open_animation(context, NULL, 1, NULL, &animation), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_open_animation(context, &path, 0, NULL, &animation), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_open_animation(context, &path, 1, NULL, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_open_animation(context, &none, 1, NULL, &animation), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_open_animation(context, &path, 1, &unset, &animation), SPH_E_INVALID);
#define REFUSED(field, bad)                                                                                            \
    do {                                                                                                               \
        sph_io_open_options_init(&options, sizeof options);                                                            \
        options.field = bad;                                                                                           \
        ck_assert_ptr_null(open_one(context, path, &options, &status));                                                \
        ck_assert_int_eq(status, SPH_E_INVALID);                                                                       \
    } while (0)
    REFUSED(flags, 1);
    REFUSED(frame_step, 0);
    REFUSED(up_axis, 2);
    REFUSED(up_axis, -1);
    REFUSED(scale, 0);
    REFUSED(scale, NAN);
    REFUSED(scale, INFINITY);
#undef REFUSED
    {
        struct {
            sph_io_open_options known;
            uint64_t unknown;
        } newer;
        sph_io_open_options_init(&newer.known, sizeof newer);
        animation = open_one(context, path, &newer.known, &status);
        ck_assert_int_eq(status, SPH_OK);
        sph_animation_destroy(animation);
        newer.unknown = 1;
        ck_assert_ptr_null(open_one(context, path, &newer.known, &status));
        ck_assert_int_eq(status, SPH_E_VERSION);
    }
}
END_TEST

/* The end of the name decides where the content does not. */
START_TEST(files_tell_what_they_are)
{
    static const char *const CASES[][3] = {
        {"a.obj", "v 0 0 0\n", "OBJ"}, {"b", "v 0 0 0\n", "OBJ"},     {"c.obj", "ply\nformat", "PLY"},
        {"d.STL", "", "STL"},          {"e.dat", "Ogawa", "Alembic"}, {"f.abc", "\x89HDF\r\n\x1A\n", "Alembic (HDF5)"},
        {"g", "glTF", "binary glTF"},  {"h.fbx", "", "FBX"},
    };
    sph_io_description d = {.struct_size = sizeof d};
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; ++i) {
        ck_assert_int_eq(sph_io_describe(context, file_text(CASES[i][0], CASES[i][1]), &d), SPH_OK);
        ck_assert_str_eq(d.format, CASES[i][2]);
        ck_assert_uint_eq(d.file_count, 1);
        ck_assert_uint_eq(d.point_count, 0);
    }
    ck_assert_int_eq(sph_io_describe(context, write_cache("a.mdd", 7, 3), &d), SPH_OK);
    ck_assert_str_eq(d.format, "MDD");
    ck_assert_uint_eq(d.point_count, 7);
    ck_assert_uint_eq(d.frame_count, 3);
    write_obj("s1.obj", 3, 0);
    write_obj("s12.obj", 3, 0);
    ck_assert_int_eq(sph_io_describe(context, file_path("s*.obj"), &d), SPH_OK);
    ck_assert_uint_eq(d.file_count, 2);
    ck_assert_int_eq(sph_io_describe(context, file_text("n.txt", "dear reader"), &d), SPH_E_UNSUPPORTED);
    ck_assert_int_eq(sph_io_describe(context, file_text("x.pc2", "POINTCACHE2"), &d), SPH_E_FORMAT);
    ck_assert_int_eq(sph_io_describe(context, file_path("none"), &d), SPH_E_IO);
    ck_assert_int_eq(sph_io_describe(context, NULL, &d), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_describe(context, "a.obj", NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_describe(NULL, "a.obj", &d), SPH_E_INVALID);
}
END_TEST

int main(void)
{
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_test(tc, names_sort_as_people_count);
    tcase_add_test(tc, any_shuffle_of_numbered_names_sorts_back);
    tcase_add_loop_test(tc, a_sequence_is_named_by_pattern_glob_or_list_and_comes_in_natural_order, 0, 4);
    tcase_add_test(tc, a_padded_pattern_takes_padded_names_only);
    tcase_add_test(tc, a_file_whose_name_looks_like_a_pattern_is_that_file);
    tcase_add_loop_test(tc, frames_scale_and_axis_are_applied, 0, 4);
    tcase_add_test(tc, one_mesh_alone_is_scaled_and_turned_too);
    tcase_add_loop_test(tc, frames_that_are_not_there_are_refused, 0, 3);
    tcase_add_test(tc, frames_that_are_not_taken_need_not_be_right);
    tcase_add_loop_test(tc, a_mesh_that_is_not_the_first_ones_is_refused_with_what_differs, 0, 5);
    tcase_add_test(tc, other_wire_edges_are_refused);
    tcase_add_test(tc, a_file_that_changes_later_is_noticed_when_its_frame_is_read);
    tcase_add_test(tc, an_animation_outlives_the_callers_context);
    tcase_add_test(tc, a_cache_with_a_sequence_is_refused);
    tcase_add_test(tc, options_and_arguments_are_checked);
    tcase_add_test(tc, files_tell_what_they_are);
    return run_suite(suite_create("io opening"), tc);
}
