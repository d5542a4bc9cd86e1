/* SPDX-License-Identifier: MIT */
/* Files that Blender 3.4 wrote (fixtures/make_blender.py), against the formula of the object that it was told to make.
 */
#include <check.h>
#include <stdio.h>
#include <string.h>

#include "files.h"
#include "runner.h"
#include "support.h"

enum { N = 11, M = 16, FRAMES = 4 };

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

static const char *fixture(const char *name)
{
    static char path[3][1024];
    static int next;
    const char *folder = getenv("SPH_FIXTURES");
    ck_assert_msg(folder != NULL, "SPH_FIXTURES is not set");
    next = (next + 1) % 3;
    snprintf(path[next], sizeof path[next], "%s/%s", folder, name);
    return path[next];
}

static void check_house(const sph_animation *animation, uint32_t frames, bool y_up)
{
    static const float REST[N][3] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0},  {-1, 1, 0}, {-1, -1, 2}, {1, -1, 2},
                                     {1, 1, 2},   {-1, 1, 2}, {0, -1, 3}, {0, 1, 3},  {0, 0, 4}};
    static const float SHARE[FRAMES] = {0, 0.25f, 0.5f, 1};
    static const uint32_t TRIANGLES[M][3] = {{3, 2, 1}, {3, 1, 0}, {0, 1, 5}, {0, 5, 8}, {0, 8, 4}, {2, 3, 7},
                                             {2, 7, 9}, {2, 9, 6}, {1, 2, 6}, {1, 6, 5}, {3, 0, 4}, {3, 4, 7},
                                             {5, 6, 9}, {5, 9, 8}, {7, 4, 8}, {7, 8, 9}};
    static const uint32_t EDGE[2] = {9, 10};
    float xyz[3 * N];
    ck_assert_msg(animation != NULL, "%s", sph_context_last_message(context));
    ck_assert_uint_eq(sph_animation_vertex_count(animation), N);
    ck_assert_uint_eq(sph_animation_frame_count(animation), frames);
    ck_assert_uint_eq(sph_animation_triangle_count(animation), M);
    ck_assert_mem_eq(sph_animation_triangles(animation), TRIANGLES, M * 12);
    ck_assert_uint_eq(sph_animation_edge_count(animation), 1);
    ck_assert_mem_eq(sph_animation_edges(animation), EDGE, sizeof EDGE);
    for (uint32_t f = 0; f < frames; ++f) {
        ck_assert_int_eq(sph_animation_read_frame(animation, f, xyz), SPH_OK);
        for (uint32_t i = 0; i < N; ++i) {
            const float z = REST[i][2] + SHARE[f] * (float)i / 4, y = REST[i][1];
            ck_assert_float_eq(xyz[3 * i], REST[i][0]);
            ck_assert_float_eq(xyz[3 * i + 1], y_up ? z : y);
            ck_assert_float_eq(xyz[3 * i + 2], y_up ? -y : z);
        }
    }
}

START_TEST(blenders_obj_with_its_caches_is_read)
{
    sph_io_open_options options;
    sph_status status;
    sph_animation *animation;
    sph_io_open_options_init(&options, sizeof options);
    options.cache_path = _i / 2 == 0 ? NULL : fixture(_i / 2 == 1 ? "blender.pc2" : "blender.mdd");
    options.up_axis = _i % 2 == 0 ? SPH_UP_Y : SPH_UP_Z;
    animation = open_one(context, fixture("blender.obj"), &options, &status);
    check_house(animation, _i / 2 == 0 ? 1 : FRAMES, _i % 2 == 1);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(blenders_obj_sequence_is_read)
{
    sph_status status;
    sph_animation *animation = open_one(context, fixture(_i == 0 ? "blender_%d.obj" : "blender_?.obj"), NULL, &status);
    check_house(animation, FRAMES, true); /* exported with y up */
    sph_animation_destroy(animation);
}
END_TEST

/* What is written here is what Blender wrote, byte for byte, where the same things are said. */
START_TEST(our_pc2_is_blenders_pc2)
{
    sph_io_open_options options;
    sph_status status;
    sph_animation *animation;
    unsigned char *ours, *theirs;
    size_t size, their_size;
    const char *pc2 = file_path("a.pc2");
    sph_io_open_options_init(&options, sizeof options);
    options.cache_path = fixture("blender.mdd");
    animation = open_one(context, fixture("blender.obj"), &options, &status);
    ck_assert_int_eq(sph_io_save_obj_pc2(context, animation, 1, 1, file_path("a.obj"), pc2), SPH_OK);
    ours = file_read(pc2, &size);
    theirs = file_read(fixture("blender.pc2"), &their_size);
    ck_assert_uint_eq(size, their_size);
    ck_assert_mem_eq(ours, theirs, size);
    free(ours);
    free(theirs);
    sph_animation_destroy(animation);
}
END_TEST

int main(void)
{
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, blenders_obj_with_its_caches_is_read, 0, 6);
    tcase_add_loop_test(tc, blenders_obj_sequence_is_read, 0, 2);
    tcase_add_test(tc, our_pc2_is_blenders_pc2);
    return run_suite(suite_create("io Blender"), tc);
}
