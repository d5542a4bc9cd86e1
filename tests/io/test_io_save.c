/* SPDX-License-Identifier: MIT */
/* Writers: files are whole or not there; OBJ with PC2 or MDD; hierarchies. */
#include <check.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "faults.h"
#include "files.h"
#include "runner.h"

static sph_context *context;

static void setup(void)
{
    context = test_context();
    files_setup();
}

static void teardown(void)
{
    files_teardown();
    sph_context_destroy(context);
}

static sph_level *make_level(void)
{
    static const float CENTERS[] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, RADII[] = {1, 0.25f, 0};
    static const uint32_t TRIANGLE[] = {0, 1, 2};
    const sph_level_arrays a = {sizeof a, 3, 1, 0, CENTERS, RADII, 0, NULL, 1, TRIANGLE, 0, NULL};
    sph_level *level;
    ck_assert_int_eq(sph_level_create_from_arrays(context, &a, &level), SPH_OK);
    return level;
}

START_TEST(a_folder_that_is_not_there_is_named_and_nothing_is_left)
{
    sph_level *level = make_level();
    ck_assert_int_eq(sph_io_save_level(context, level, file_path("none/l.json")), SPH_E_IO);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "none/l.json: cannot be written: No such file"));
    ck_assert_int_eq(sph_io_save_level(context, level, ""), SPH_E_UNSUPPORTED);
    ck_assert_uint_eq(file_count(), 0);
    sph_level_destroy(level);
}
END_TEST

START_TEST(what_is_no_file_is_not_replaced)
{
    sph_level *level = make_level();
    struct stat found;
    ck_assert_int_eq(mkdir(file_path("d.json"), 0777), 0);
    ck_assert_int_eq(sph_io_save_level(context, level, file_path("d.json")), SPH_E_IO);
    ck_assert_int_eq(mkfifo(file_path("p.json"), 0666), 0);
    ck_assert_int_eq(sph_io_save_level(context, level, file_path("p.json")), SPH_E_IO);
    ck_assert_int_eq(stat(file_path("p.json"), &found), 0);
    ck_assert(S_ISFIFO(found.st_mode));
    ck_assert_uint_eq(file_count(), 2);
    sph_level_destroy(level);
}
END_TEST

START_TEST(a_link_stays_and_what_it_points_to_is_replaced_with_its_mode)
{
    sph_level *level = make_level(), *back = NULL;
    const char *target = file_text("target.json", "old"), *link = file_path("link.json");
    struct stat found;
    ck_assert_int_eq(chmod(target, 0640), 0);
    ck_assert_int_eq(symlink("target.json", link), 0);
    ck_assert_int_eq(sph_io_save_level(context, level, link), SPH_OK);
    ck_assert_int_eq(lstat(link, &found), 0);
    ck_assert(S_ISLNK(found.st_mode));
    ck_assert_int_eq(stat(target, &found), 0);
    ck_assert_int_eq(found.st_mode & 0777, 0640);
    ck_assert_int_eq(sph_io_load_level(context, target, &back), SPH_OK);
    ck_assert_uint_eq(file_count(), 2);
    sph_level_destroy(back);
    sph_level_destroy(level);
}
END_TEST

/* A frame source that fails halfway: both files of before are as they were. */
START_TEST(a_failing_source_leaves_the_old_files_and_no_other)
{
    sph_animation *inner = test_sphere(context, 2, 5), *animation;
    test_source source = {.from = inner, .fail_at = (size_t)_i + 1, .failure = SPH_E_IO};
    unsigned char *text;
    size_t size;
    file_text("a.obj", "old obj");
    file_text("a.pc2", "old pc2");
    animation = test_pulled(context, &source);
    ck_assert_int_eq(sph_io_save_obj_pc2(context, animation, 0, 1, file_path("a.obj"), file_path("a.pc2")), SPH_E_IO);
    text = file_read(file_path("a.obj"), &size);
    ck_assert_str_eq((const char *)text, "old obj");
    free(text);
    text = file_read(file_path("a.pc2"), &size);
    ck_assert_str_eq((const char *)text, "old pc2");
    free(text);
    ck_assert_uint_eq(file_count(), 2);
    sph_animation_destroy(animation);
    sph_animation_destroy(inner);
}
END_TEST

/* RLIMIT_FSIZE makes writing fail after so many bytes, as a full disk does. */
START_TEST(a_disk_that_is_full_after_any_number_of_bytes_leaves_the_old_files)
{
    sph_animation *animation = test_sphere(context, 3, 5); /* 642 vertices: 38 KB and more than one buffer of OBJ */
    const struct rlimit limit = {(rlim_t)_i * 8192, RLIM_INFINITY};
    unsigned char *text;
    size_t size;
    sph_status status;
    file_text("a.obj", "old obj");
    file_text("a.pc2", "old pc2");
    signal(SIGXFSZ, SIG_IGN); /* each test has a process of its own */
    ck_assert_int_eq(setrlimit(RLIMIT_FSIZE, &limit), 0);
    status = sph_io_save_obj_pc2(context, animation, 0, 1, file_path("a.obj"), file_path("a.pc2"));
    ck_assert_int_eq(status, SPH_E_IO);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "cannot be written: File too large"));
    text = file_read(file_path("a.obj"), &size);
    ck_assert_str_eq((const char *)text, "old obj");
    free(text);
    text = file_read(file_path("a.pc2"), &size);
    ck_assert_str_eq((const char *)text, "old pc2");
    free(text);
    ck_assert_uint_eq(file_count(), 2);
    sph_animation_destroy(animation);
}
END_TEST

static sph_status save_both(sph_context *own, const void *user)
{
    sph_animation *animation = test_sphere(own, 1, 4);
    const sph_status status = sph_io_save_obj_pc2(own, animation, 0, 1, file_path("a.obj"), file_path("a.pc2"));
    (void)user;
    ck_assert_uint_eq(file_count(), status == SPH_OK ? 2 : 0);
    sph_animation_destroy(animation);
    return status;
}

START_TEST(saving_may_be_cancelled_at_any_report)
{
    check_every_cancel((test_faults){.work = save_both, .least = 4});
}
END_TEST

START_TEST(an_animation_comes_back_from_obj_and_pc2_with_the_same_bits)
{
    sph_animation *animation = test_torus(context, 12, 8, 5), *back;
    const char *obj = file_path("a.obj"), *pc2 = file_path("a.pc2");
    const uint32_t n = sph_animation_vertex_count(animation), edges[] = {0, 5, 7, 2};
    float *a = test_malloc(3 * n, sizeof *a), *b = test_malloc(3 * n, sizeof *b);
    unsigned char *bytes;
    layout head = {NULL, 0, 0};
    size_t size;
    sph_io_open_options options;
    sph_status status;
    ck_assert_int_eq(sph_animation_set_edges(animation, edges, 2, 0), SPH_OK);
    ck_assert_int_eq(sph_io_save_obj_pc2(context, animation, 3, 0.5, obj, pc2), SPH_OK);
    ck_assert_uint_eq(file_count(), 2);
    sph_io_open_options_init(&options, sizeof options);
    for (int with_cache = 0; with_cache < 2; ++with_cache) {
        options.cache_path = with_cache ? pc2 : NULL;
        back = open_one(context, obj, &options, &status);
        ck_assert_int_eq(status, SPH_OK);
        ck_assert_uint_eq(sph_animation_frame_count(back), with_cache ? 5 : 1);
        for (uint32_t f = 0; f < (with_cache ? 5U : 1U); ++f) {
            ck_assert_int_eq(sph_animation_read_frame(animation, f, a), SPH_OK);
            ck_assert_int_eq(sph_animation_read_frame(back, f, b), SPH_OK);
            ck_assert_mem_eq(a, b, 3 * n * sizeof *a);
        }
        ck_assert_uint_eq(sph_animation_triangle_count(back), sph_animation_triangle_count(animation));
        ck_assert_mem_eq(sph_animation_triangles(back), sph_animation_triangles(animation),
                         12 * sph_animation_triangle_count(animation));
        ck_assert_uint_eq(sph_animation_edge_count(back), 2);
        ck_assert_mem_eq(sph_animation_edges(back), edges, sizeof edges);
        sph_animation_destroy(back);
    }
    put_bytes(&head, "POINTCACHE2\0\1\0\0\0", 16);
    put_little(&head, n, 4);
    put_little_float(&head, 3);
    put_little_float(&head, 0.5f);
    put_little(&head, 5, 4);
    bytes = file_read(pc2, &size);
    ck_assert_uint_eq(size, 32 + 5 * 12 * (size_t)n);
    ck_assert_mem_eq(bytes, head.bytes, 32);
    free(bytes);
    free(a);
    free(b);
    layout_free(&head);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(an_animation_comes_back_from_obj_and_mdd_with_the_same_bits)
{
    enum { FRAMES = 3 };
    sph_animation *animation = test_torus(context, 7, 5, FRAMES), *back;
    const char *obj = file_path("a.obj"), *mdd = file_path("a.mdd");
    const uint32_t n = sph_animation_vertex_count(animation);
    float *xyz = test_malloc(3 * n, sizeof *xyz);
    layout expected = {NULL, 0, 0};
    unsigned char *bytes;
    size_t size;
    sph_io_open_options options;
    sph_status status;
    ck_assert_int_eq(sph_io_save_obj_mdd(context, animation, 0.5, 24, obj, mdd), SPH_OK);
    ck_assert_uint_eq(file_count(), 2);
    put_big(&expected, FRAMES, 4);
    put_big(&expected, n, 4);
    for (unsigned f = 0; f < FRAMES; ++f)
        put_big_float(&expected, (float)(0.5 + f / 24.0));
    for (uint32_t f = 0; f < FRAMES; ++f) {
        ck_assert_int_eq(sph_animation_read_frame(animation, f, xyz), SPH_OK);
        for (uint32_t i = 0; i < 3 * n; ++i)
            put_big_float(&expected, xyz[i]);
    }
    bytes = file_read(mdd, &size);
    ck_assert_uint_eq(size, expected.size);
    ck_assert_mem_eq(bytes, expected.bytes, size);
    sph_io_open_options_init(&options, sizeof options);
    options.cache_path = mdd;
    back = open_one(context, obj, &options, &status);
    ck_assert_uint_eq(sph_animation_frame_count(back), FRAMES);
    sph_animation_destroy(back);
    free(bytes);
    free(xyz);
    layout_free(&expected);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(a_failing_source_leaves_the_old_mdd_too)
{
    sph_animation *inner = test_sphere(context, 1, 3), *animation;
    test_source source = {.from = inner, .fail_at = 2, .failure = SPH_E_IO};
    unsigned char *text;
    size_t size;
    file_text("a.mdd", "old mdd");
    animation = test_pulled(context, &source);
    ck_assert_int_eq(sph_io_save_obj_mdd(context, animation, 0, 1, file_path("a.obj"), file_path("a.mdd")), SPH_E_IO);
    text = file_read(file_path("a.mdd"), &size);
    ck_assert_str_eq((const char *)text, "old mdd");
    free(text);
    ck_assert_uint_eq(file_count(), 1);
    sph_animation_destroy(animation);
    sph_animation_destroy(inner);
}
END_TEST

static sph_status keep(void *user, const void *bytes, size_t size)
{
    put_bytes(user, bytes, size);
    return SPH_OK;
}

START_TEST(a_hierarchy_comes_back_from_its_file)
{
    sph_animation *animation = test_torus(context, 10, 6, 4);
    const char *path = file_path("h.sphm");
    sph_hierarchy *h, *read, *back = NULL;
    sph_level *level;
    layout a = {NULL, 0, 0}, b = {NULL, 0, 0};
    unsigned char *bytes;
    size_t size;
    int32_t kind = 0;
    ck_assert_int_eq(sph_hierarchy_create(animation, NULL, &h), SPH_OK);
    ck_assert_int_eq(sph_io_save_hierarchy(context, h, path), SPH_OK);
    ck_assert_int_eq(sph_io_identify(context, path, &kind), SPH_OK);
    ck_assert_int_eq(kind, SPH_IO_HIERARCHY);
    ck_assert_msg(sph_io_load_hierarchy(context, path, &read) == SPH_OK, "%s", sph_context_last_message(context));
    ck_assert_int_eq(sph_hierarchy_write(h, keep, &a), SPH_OK);
    ck_assert_int_eq(sph_hierarchy_write(read, keep, &b), SPH_OK);
    bytes = file_read(path, &size);
    ck_assert_uint_eq(a.size, size);
    ck_assert_uint_eq(b.size, size);
    ck_assert_mem_eq(a.bytes, bytes, size);
    ck_assert_mem_eq(b.bytes, bytes, size);
    ck_assert_uint_eq(file_count(), 1);
    ck_assert_int_eq(sph_io_load_level(context, path, &level), SPH_E_FORMAT);
    ck_assert_ptr_nonnull(
        strstr(sph_context_last_message(context), "h.sphm: byte 12: the container holds a hierarchy"));
    bytes[size - 20] ^= 1;
    ck_assert_int_eq(sph_io_load_hierarchy(context, file_write("bad.sphm", bytes, size), &back), SPH_E_FORMAT);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "bad.sphm: bytes "));
    ck_assert_int_eq(sph_io_load_hierarchy(context, file_path("none.sphm"), &back), SPH_E_IO);
    ck_assert_ptr_null(back);
    ck_assert_int_eq(sph_io_save_hierarchy(context, h, file_path("none/h.sphm")), SPH_E_IO);
    free(bytes);
    layout_free(&a);
    layout_free(&b);
    sph_animation_destroy(animation);
    sph_hierarchy_destroy(h);
    sph_hierarchy_destroy(read);
}
END_TEST

START_TEST(arguments_are_checked)
{
    sph_level *level = make_level(), *back = level;
    sph_animation *animation = test_cube(context, 1);
    const char *path = file_path("x.json"), *other = file_path("y.json");
    sph_hierarchy *hierarchy = (sph_hierarchy *)level;
    int32_t kind;
    ck_assert_int_eq(sph_io_save_level(NULL, level, path), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_level(context, NULL, path), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_level(context, level, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_load_level(NULL, path, &back), SPH_E_INVALID);
    ck_assert_ptr_null(back);
    ck_assert_int_eq(sph_io_load_level(context, NULL, &back), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_load_level(context, path, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_identify(context, path, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_identify(NULL, path, &kind), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_pc2(NULL, animation, 0, 1, path, other), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_pc2(context, NULL, 0, 1, path, other), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_pc2(context, animation, 0, 1, NULL, other), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_pc2(context, animation, 0, 1, path, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_pc2(context, animation, 0, 1, path, path), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_pc2(context, animation, NAN, 1, path, other), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_pc2(context, animation, 1e300, 1, path, other), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_pc2(context, animation, 0, 0, path, other), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_pc2(context, animation, 0, -1, path, other), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_pc2(context, animation, 0, INFINITY, path, other), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_mdd(NULL, animation, 0, 1, path, other), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_mdd(context, NULL, 0, 1, path, other), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_mdd(context, animation, 0, 1, path, path), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_mdd(context, animation, INFINITY, 1, path, other), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_mdd(context, animation, 0, 0, path, other), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_mdd(context, animation, 0, NAN, path, other), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_hierarchy(context, NULL, path), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_load_hierarchy(NULL, path, &hierarchy), SPH_E_INVALID);
    ck_assert_ptr_null(hierarchy);
    ck_assert_int_eq(sph_io_load_hierarchy(context, NULL, &hierarchy), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_load_hierarchy(context, path, NULL), SPH_E_INVALID);
    ck_assert_uint_eq(file_count(), 0);
    sph_animation_destroy(animation);
    sph_level_destroy(level);
}
END_TEST

/* What is read back: vertices and triangles with the same bits; normals are not read. */
START_TEST(a_surface_comes_back_from_obj_ply_and_glb)
{
    const char *path = file_path(_i == 0 ? "s.obj" : _i == 1 ? "s.ply" : "s.glb");
    const sph_surface_options options = {sizeof options, 0, 12, 0, 1, 0, 1 << 24};
    sph_level *level = make_level();
    sph_surface *surface;
    sph_animation *animation;
    float *xyz;
    size_t vertices, triangles;
    ck_assert_int_eq(sph_surface_create(level, &options, &surface), SPH_OK);
    vertices = sph_surface_vertex_count(surface, 0);
    triangles = sph_surface_triangle_count(surface, 0);
    ck_assert_int_eq(sph_io_save_surface(context, surface, 0, path), SPH_OK);
    ck_assert_msg(sph_io_open_animation(context, &path, 1, NULL, &animation) == SPH_OK, "%s",
                  sph_context_last_message(context));
    ck_assert_uint_eq(sph_animation_vertex_count(animation), vertices);
    ck_assert_uint_eq(sph_animation_triangle_count(animation), triangles);
    ck_assert_mem_eq(sph_animation_triangles(animation), sph_surface_triangles(surface, 0), 12 * triangles);
    xyz = test_malloc(vertices, 12);
    ck_assert_int_eq(sph_animation_read_frame(animation, 0, xyz), SPH_OK);
    ck_assert_mem_eq(xyz, sph_surface_positions(surface, 0), 12 * vertices);
    free(xyz);
    ck_assert_int_eq(sph_io_save_surface(context, surface, 1, path), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_surface(context, surface, 0, file_path("s.stl")), SPH_E_UNSUPPORTED);
    ck_assert_int_eq(sph_io_save_surface(context, surface, 0, file_path("none/s.ply")), SPH_E_IO);
    ck_assert_int_eq(sph_io_save_surface(context, NULL, 0, path), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_surface(NULL, surface, 0, path), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_surface(context, surface, 0, NULL), SPH_E_INVALID);
    ck_assert_uint_eq(file_count(), 1);
    sph_animation_destroy(animation);
    sph_surface_destroy(surface);
    sph_level_destroy(level);
}
END_TEST

int main(void)
{
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_test(tc, a_hierarchy_comes_back_from_its_file);
    tcase_add_test(tc, a_folder_that_is_not_there_is_named_and_nothing_is_left);
    tcase_add_test(tc, what_is_no_file_is_not_replaced);
    tcase_add_test(tc, a_link_stays_and_what_it_points_to_is_replaced_with_its_mode);
    tcase_add_loop_test(tc, a_failing_source_leaves_the_old_files_and_no_other, 0, 5);
    tcase_add_loop_test(tc, a_disk_that_is_full_after_any_number_of_bytes_leaves_the_old_files, 0, 5);
    tcase_add_test(tc, saving_may_be_cancelled_at_any_report);
    tcase_add_test(tc, an_animation_comes_back_from_obj_and_pc2_with_the_same_bits);
    tcase_add_test(tc, an_animation_comes_back_from_obj_and_mdd_with_the_same_bits);
    tcase_add_test(tc, a_failing_source_leaves_the_old_mdd_too);
    tcase_add_loop_test(tc, a_surface_comes_back_from_obj_ply_and_glb, 0, 3);
    tcase_add_test(tc, arguments_are_checked);
    setenv("CK_FORK", "yes", 1); /* whatever the caller's: limits of the process are set */
    return run_suite(suite_create("io writers"), tc);
}
