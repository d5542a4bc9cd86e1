/* SPDX-License-Identifier: MIT */
/* Point caches. */
#include <check.h>
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

START_TEST(a_mesh_with_a_cache_has_the_frames_of_the_cache)
{
    const char *mesh = write_obj("m.obj", 5, 0);
    sph_status status;
    sph_animation *animation;
    options.cache_path = write_cache(_i == 0 ? "c.pc2" : _i == 1 ? "c.mdd" : _i == 2 ? "pc2.bin" : "mdd.bin", 5, 7);
    animation = open_one(context, mesh, &options, &status);
    check_frames(context, animation, 5, 7, 0, 1);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(a_cache_of_another_mesh_is_refused_with_both_counts)
{
    const char *mesh = write_obj("m.obj", 5, 0);
    sph_status status;
    options.cache_path = write_cache(_i == 0 ? "c.pc2" : "c.mdd", 6, 7);
    ck_assert_ptr_null(open_one(context, mesh, &options, &status));
    ck_assert_int_eq(status, SPH_E_FORMAT);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "6 points"));
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "5 vertices"));
}
END_TEST

/* A frame may end where the file and its last page end: a look beyond it would be a fault. */
START_TEST(a_cache_that_ends_with_its_page_is_read_within_it)
{
    const uint32_t n = _i == 0 ? 68 : 170, frames = _i == 0 ? 10 : 2;
    const char *mesh = write_obj("m.obj", n, 0);
    sph_status status;
    sph_animation *animation;
    size_t size;
    options.cache_path = write_cache(_i == 0 ? "c.pc2" : "c.mdd", n, frames);
    free(file_read(options.cache_path, &size));
    ck_assert_uint_eq(size % 4096, 0);
    animation = open_one(context, mesh, &options, &status);
    check_frames(context, animation, n, frames, 0, 1);
    check_frames(context, animation, n, frames, 0, 1); /* again, after its pages were given back */
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(bad_caches_are_refused_with_the_reason)
{
    static const struct {
        const char *name;
        size_t at;
        uint32_t value;
        sph_status status;
        const char *message;
    } CASES[] = {{"c.pc2", 12, 2, SPH_E_UNSUPPORTED, "byte 12: PC2 version 2"},
                 {"c.pc2", 16, 0, SPH_E_FORMAT, "7 frames of 0 points"},
                 {"c.pc2", 16, 0x80000000, SPH_E_FORMAT, "7 frames of -2147483648 points"},
                 {"c.pc2", 16, 0x7FFFFFFF, SPH_E_FORMAT, "within frame 0"},
                 {"c.pc2", 28, 0x7FFFFFFF, SPH_E_FORMAT, "within frame 7: its header says 2147483647 frames"},
                 {"c.pc2", 28, 0xFFFFFFFF, SPH_E_FORMAT, "-1 frames"},
                 {"c.pc2", 28, 8, SPH_E_FORMAT, "within frame 7"},
                 {"c.pc2", 0, 0, SPH_E_FORMAT, "byte 0: not a PC2 file"},
                 {"c.mdd", 0, 0, SPH_E_FORMAT, "0 frames of 5 points"},
                 {"c.mdd", 0, 0xFFFFFFFF, SPH_E_FORMAT, "-1 frames"},
                 {"c.mdd", 4, 0xFFFFFF7F, SPH_E_FORMAT, "7 frames of 2147483647 points would take"},
                 {"c.mdd", 4, 0x06000000, SPH_E_FORMAT, "7 frames of 6 points would take 540 bytes, it has 456"}};
    const char *mesh = write_obj("m.obj", 5, 0);
    size_t size;
    unsigned char *bytes = file_read(write_cache(CASES[_i].name, 5, 7), &size);
    sph_status status;
    memcpy(bytes + CASES[_i].at, &CASES[_i].value, 4); /* as this machine, which is little-endian, has it */
    options.cache_path = file_write(CASES[_i].name, bytes, size);
    ck_assert_ptr_null(open_one(context, mesh, &options, &status));
    ck_assert_int_eq(status, CASES[_i].status);
    ck_assert_msg(strstr(sph_context_last_message(context), CASES[_i].message) != NULL, "%s",
                  sph_context_last_message(context));
    free(bytes);
}
END_TEST

int main(void)
{
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, a_mesh_with_a_cache_has_the_frames_of_the_cache, 0, 4);
    tcase_add_loop_test(tc, a_cache_of_another_mesh_is_refused_with_both_counts, 0, 2);
    tcase_add_loop_test(tc, a_cache_that_ends_with_its_page_is_read_within_it, 0, 2);
    tcase_add_loop_test(tc, bad_caches_are_refused_with_the_reason, 0, 12);
    return run_suite(suite_create("io caches"), tc);
}
