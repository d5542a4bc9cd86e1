/* SPDX-License-Identifier: MIT */
/* Real animated meshes, from the folder that SPHMESH_DATA names; without it these tests are skipped. */
#include <check.h>
#include <math.h>
#include <stdio.h>

#include "files.h"
#include "runner.h"
#include "support.h"

static const struct {
    const char *mesh, *cache;
    uint32_t vertices, frames;
    size_t triangles;
} DATA[] = {{"horse-gallop.obj", "horse-gallop.pc2", 8431, 48, 16843},
            {"samba.obj", "samba.mdd", 9971, 175, 19938},
            {"bone-anim.obj", "bone-anim.pc2", 754, 400, 1504},
            {"wolf/wolf_%d.obj", NULL, 5075, 21, 10018},
            {"wolf/wolf_*.obj", NULL, 5075, 21, 10018}};
enum { DATA_COUNT = sizeof DATA / sizeof *DATA };

static char paths[2][1024];

static const char *data_path(int slot, const char *name)
{
    snprintf(paths[slot], sizeof paths[slot], "%s/%s", getenv("SPHMESH_DATA"), name);
    return paths[slot];
}

START_TEST(a_real_sequence_opens_with_the_counts_of_its_description)
{
    sph_context *context = test_context();
    sph_io_open_options options;
    sph_animation *animation;
    sph_animation_report report;
    sph_status status;
    sph_io_open_options_init(&options, sizeof options);
    if (DATA[_i].cache != NULL) options.cache_path = data_path(1, DATA[_i].cache);
    animation = open_one(context, data_path(0, DATA[_i].mesh), &options, &status);
    ck_assert_msg(status == SPH_OK, "%s", sph_context_last_message(context));
    ck_assert_uint_eq(sph_animation_vertex_count(animation), DATA[_i].vertices);
    ck_assert_uint_eq(sph_animation_frame_count(animation), DATA[_i].frames);
    ck_assert_uint_eq(sph_animation_triangle_count(animation), DATA[_i].triangles);
    sph_animation_report_init(&report, sizeof report);
    ck_assert_int_eq(sph_animation_check(animation, &report), SPH_OK);
    ck_assert_uint_eq(report.non_finite_count, 0);
    sph_animation_destroy(animation);
    sph_context_destroy(context);
}
END_TEST

/* A cache's first frame, where it is the mesh's own pose, says that points and vertices are in one order. */
START_TEST(the_first_frame_of_a_cache_is_near_its_mesh)
{
    sph_context *context = test_context();
    sph_io_open_options options;
    sph_status status;
    sph_animation *alone, *with_cache;
    double a = 0, b = 0;
    if (DATA[_i].cache != NULL) {
        sph_io_open_options_init(&options, sizeof options);
        options.cache_path = data_path(1, DATA[_i].cache);
        options.end_frame = 1;
        alone = open_one(context, data_path(0, DATA[_i].mesh), NULL, &status);
        with_cache = open_one(context, data_path(0, DATA[_i].mesh), &options, &status);
        ck_assert_int_eq(sph_animation_bounding_diagonal(alone, &a), SPH_OK);
        ck_assert_int_eq(sph_animation_bounding_diagonal(with_cache, &b), SPH_OK);
        ck_assert_double_gt(a, b / 2);
        ck_assert_double_lt(a, b * 2);
        sph_animation_destroy(alone);
        sph_animation_destroy(with_cache);
    }
    sph_context_destroy(context);
}
END_TEST

static unsigned char *archive_frames(const char *path, const sph_io_open_options *options, uint32_t vertices,
                                     uint32_t frames)
{
    sph_context *context = test_context();
    sph_status status;
    sph_animation *animation = open_one(context, path, options, &status);
    float *xyz = test_malloc(3 * (size_t)vertices * frames, sizeof *xyz);
    ck_assert_msg(status == SPH_OK, "%s", sph_context_last_message(context));
    ck_assert_uint_eq(sph_animation_vertex_count(animation), vertices);
    ck_assert_uint_eq(sph_animation_frame_count(animation), frames);
    for (uint32_t f = 0; f < frames; ++f)
        ck_assert_int_eq(sph_animation_read_frame(animation, f, xyz + 3 * (size_t)vertices * f), SPH_OK);
    sph_animation_destroy(animation);
    sph_context_destroy(context);
    return (unsigned char *)xyz;
}

/* Another parser read the cache out of the archive, and its mesh is that of the archive as OBJ. */
START_TEST(an_archive_has_the_frames_and_triangles_that_another_parser_read)
{
    sph_context *context = test_context();
    sph_io_open_options options;
    sph_status status;
    sph_animation *a, *b;
    unsigned char *ours, *theirs;
    sph_io_open_options_init(&options, sizeof options);
    ours = archive_frames(data_path(0, "bone-anim.abc"), &options, 754, 400);
    options.cache_path = data_path(1, "bone-anim.pc2");
    theirs = archive_frames(data_path(0, "bone-anim.obj"), &options, 754, 400);
    ck_assert_mem_eq(ours, theirs, (size_t)400 * 754 * 12);
    a = open_one(context, data_path(0, "bone-anim.abc"), NULL, &status);
    b = open_one(context, data_path(0, "bone-anim.obj"), NULL, &status);
    ck_assert_uint_eq(sph_animation_triangle_count(a), sph_animation_triangle_count(b));
    ck_assert_mem_eq(sph_animation_triangles(a), sph_animation_triangles(b), (size_t)1504 * 12);
    free(ours);
    free(theirs);
    sph_animation_destroy(a);
    sph_animation_destroy(b);
    sph_context_destroy(context);
}
END_TEST

int main(void)
{
    TCase *tc = tcase_create("all");
    if (getenv("SPHMESH_DATA") == NULL) {
        puts("1..0 # SKIP SPHMESH_DATA is not set: no real meshes to read");
        return EXIT_SUCCESS;
    }
    tcase_add_loop_test(tc, a_real_sequence_opens_with_the_counts_of_its_description, 0, DATA_COUNT);
    tcase_add_loop_test(tc, the_first_frame_of_a_cache_is_near_its_mesh, 0, DATA_COUNT);
    tcase_add_test(tc, an_archive_has_the_frames_and_triangles_that_another_parser_read);
    return run_suite(suite_create("io real data"), tc);
}
