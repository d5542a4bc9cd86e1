/* SPDX-License-Identifier: MIT */
/* Levels for other tools: what tests/cli/test_export.py cannot reach from the program. */
#include <check.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "faults.h"
#include "files.h"
#include "runner.h"
#include "support.h"

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

static const char *const NAMES[] = {"e.json", "e.ma", "e.srdf", "e.yaml", "e.yml", "e.urdf", "e.glb"};
enum { NAME_COUNT = sizeof NAMES / sizeof *NAMES };

/* Two frames with radii of their own; a triangle, a wire, a sphere alone, and simplices that name a sphere twice. */
static sph_level *make_level(sph_context *of)
{
    static const float CENTERS[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 2, 3, 3, 3,
                                    0, 0, 0, 1, 0, 1, 0, 1, 1, 0, 0, 3, 4, 4, 4e-6f};
    static const float RADII[] = {0.25f, 0.125f, 0.5f, 0, 0.75f, 0.5f, 0.25f, 0.5f, 0, 1e-5f};
    static const uint32_t EDGES[] = {0, 3, 2, 2}, TRIANGLES[] = {0, 1, 2, 1, 1, 2};
    const sph_level_arrays a = {.struct_size = sizeof a,
                                .sphere_count = 5,
                                .frame_count = 2,
                                .radii_per_frame = 1,
                                .centers = CENTERS,
                                .radii = RADII,
                                .edge_count = 2,
                                .edges = EDGES,
                                .triangle_count = 2,
                                .triangles = TRIANGLES};
    sph_level *level = NULL;
    sph_level_create_from_arrays(of, &a, &level);
    return level;
}

START_TEST(radii_per_frame_are_those_of_the_frame)
{
    sph_level *level = make_level(context);
    sph_io_export_options o;
    sph_io_export_report r = {.struct_size = sizeof r};
    const char *path = file_path("e.json");
    json_t *root;
    sph_io_export_options_init(&o, sizeof o);
    o.first_frame = 1;
    ck_assert_msg(sph_io_export_level(context, level, path, &o, &r) == SPH_OK, "%s", sph_context_last_message(context));
    ck_assert_uint_eq(r.frame_count, 1);
    ck_assert_uint_eq(r.sphere_count, 1);
    ck_assert_uint_eq(r.capsule_count, 2);
    ck_assert_uint_eq(r.triangle_count, 2);
    root = json_load_file(path, JSON_REJECT_DUPLICATES, NULL);
    ck_assert_ptr_nonnull(root);
    for (int i = 0; i < 2; ++i) {
        static const char *const KINDS[] = {"spheres", "triangles"};
        static const double FIRST[] = {1e-5f, 0.5};
        const json_t *pose = json_array_get(json_object_get(root, "poses"), 0);
        const json_t *simplex = json_array_get(json_object_get(pose, KINDS[i]), 0);
        ck_assert_int_eq(json_integer_value(json_object_get(pose, "frame")), 1);
        ck_assert_float_eq((float)json_number_value(json_array_get(json_object_get(simplex, "radii"), 0)),
                           (float)FIRST[i]);
    }
    json_decref(root);
    sph_level_destroy(level);
}
END_TEST

START_TEST(a_medial_mesh_leaves_out_what_names_a_sphere_twice)
{
    sph_level *level = make_level(context);
    const char *path = file_path("e.ma");
    size_t size;
    unsigned char *bytes;
    static const char *const EXPECTED = "5 4 1\nv 0 0 0 0.25\nv 1 0 0 0.125\nv 0 1 0 0.5\nv 0 0 2 0\nv 3 3 3 0.75\n"
                                        "e 0 1\ne 0 2\ne 0 3\ne 1 2\nf 0 1 2\n# a sphere-mesh of 5 spheres, frame 0\n";
    ck_assert_int_eq(sph_io_export_level(context, level, path, NULL, NULL), SPH_OK);
    bytes = file_read(path, &size);
    ck_assert_uint_eq(size, strlen(EXPECTED));
    ck_assert_mem_eq(bytes, EXPECTED, size);
    free(bytes);
    sph_level_destroy(level);
}
END_TEST

/* A tapered capsule and one sphere in it: how far apart and how large spheres on it may be follows by hand. */
START_TEST(spheres_of_a_cylinder_cover_it_as_the_circle_through_the_middle_does)
{
    static const float CENTERS[] = {0, 0, 0, 4, 0, 0}, RADII[] = {1, 1};
    static const uint32_t EDGE[] = {0, 1};
    const sph_level_arrays a = {.struct_size = sizeof a,
                                .sphere_count = 2,
                                .frame_count = 1,
                                .centers = CENTERS,
                                .radii = RADII,
                                .edge_count = 1,
                                .edges = EDGE};
    sph_level *level = NULL;
    sph_io_export_options o;
    sph_io_export_report r = {.struct_size = sizeof r};
    ck_assert_int_eq(sph_level_create_from_arrays(context, &a, &level), SPH_OK);
    sph_io_export_options_init(&o, sizeof o);
    o.cover_solid = 1;
    for (int i = 1; i < 5; ++i) {
        const double half = 2.0 / i, wanted = sqrt(1 + half * half) - 1; /* half the way from one to the next */
        o.gap = wanted * 1.000001;
        ck_assert_int_eq(sph_io_export_level(context, level, file_path("e.srdf"), &o, &r), SPH_OK);
        ck_assert_uint_eq(r.sphere_count, (uint64_t)i + 1);
        ck_assert_double_eq_tol(r.gap, wanted, 1e-9);
    }
    sph_level_destroy(level);
}
END_TEST

/* `user` is the file's name. */
static sph_status export(sph_context *own, const void *user)
{
    sph_level *level = make_level(own);
    sph_io_export_options o;
    sph_status status = SPH_E_NOMEM;
    sph_io_export_options_init(&o, sizeof o);
    o.first_frame = 1;
    if (level != NULL) status = sph_io_export_level(own, level, file_path(user), &o, NULL);
    sph_level_destroy(level);
    ck_assert_uint_eq(file_count(), status == SPH_OK);
    return status;
}

START_TEST(every_allocation_may_fail_and_leaves_no_file)
{
    check_every_allocation((test_faults){.work = export, .user = NAMES[_i / 2], .least = 8, .sticky = _i % 2});
}
END_TEST

static void refused(const sph_level *level, const char *name, const sph_io_export_options *o, sph_status expected,
                    const char *part)
{
    ck_assert_int_eq(sph_io_export_level(context, level, file_path(name), o, NULL), expected);
    ck_assert_msg(strstr(sph_context_last_message(context), part) != NULL, "message: %s",
                  sph_context_last_message(context));
    ck_assert_uint_eq(file_count(), 0);
}

#define REFUSED(field, value, name, status, part)                                                                      \
    do {                                                                                                               \
        sph_io_export_options_init(&o, sizeof o);                                                                      \
        o.field = value;                                                                                               \
        refused(level, name, &o, status, part);                                                                        \
    } while (0)

START_TEST(what_cannot_be_exported_is_refused_with_a_reason)
{
    sph_level *level = make_level(context);
    const sph_coverage bad = {.struct_size = 1};
    sph_io_export_options o;
    sph_io_export_report r = {.struct_size = 1};
    refused(level, "e.txt", NULL, SPH_E_UNSUPPORTED, "e.txt");
    refused(NULL, "e.ma", NULL, SPH_E_INVALID, "NULL");
    ck_assert_int_eq(sph_io_export_level(context, level, file_path("e.ma"), NULL, &r), SPH_E_INVALID);
    REFUSED(format, 77, "e.ma", SPH_E_INVALID, "e.ma");
    REFUSED(first_frame, 2, "e.ma", SPH_E_INVALID, "2 frames");
    REFUSED(frame_limit, 2, "e.ma", SPH_E_INVALID, "holds one");
    REFUSED(frame_step, 0, "e.ma", SPH_E_INVALID, "step");
    REFUSED(gap, NAN, "e.srdf", SPH_E_INVALID, "gap");
    REFUSED(gap, -1, "e.srdf", SPH_E_INVALID, "gap");
    REFUSED(gap, 1e-9, "e.srdf", SPH_E_LIMIT, "1000000 spheres");
    REFUSED(name, "a\"b", "e.srdf", SPH_E_INVALID, "name of a link");
    REFUSED(name, "", "e.srdf", SPH_E_INVALID, "name of a link");
    REFUSED(coverage, &bad, "e.srdf", SPH_E_INVALID, "sph_coverage");
    REFUSED(flags, 1, "e.srdf", SPH_E_INVALID, "flags");
    REFUSED(cover_solid, 2, "e.srdf", SPH_E_INVALID, "cover_solid");
    memset(&o, 0, sizeof o);
    refused(level, "e.ma", &o, SPH_E_INVALID, "not initialised");
    sph_level_destroy(level);
}
END_TEST

START_TEST(a_format_may_be_named_whatever_the_ending)
{
    sph_level *level = make_level(context);
    sph_io_export_options o;
    size_t size;
    unsigned char *bytes;
    sph_io_export_options_init(&o, sizeof o);
    o.format = SPH_IO_EXPORT_SRDF;
    ck_assert_int_eq(sph_io_export_level(context, level, file_path("robot.txt"), &o, NULL), SPH_OK);
    bytes = file_read(file_path("robot.txt"), &size);
    ck_assert_mem_eq(bytes, "<?xml", 5);
    free(bytes);
    sph_level_destroy(level);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("io_export");
    TCase *tests = tcase_create("export");
    tcase_add_checked_fixture(tests, setup, teardown);
    tcase_add_test(tests, radii_per_frame_are_those_of_the_frame);
    tcase_add_test(tests, a_medial_mesh_leaves_out_what_names_a_sphere_twice);
    tcase_add_test(tests, spheres_of_a_cylinder_cover_it_as_the_circle_through_the_middle_does);
    tcase_add_loop_test(tests, every_allocation_may_fail_and_leaves_no_file, 0, 2 * NAME_COUNT);
    tcase_add_test(tests, what_cannot_be_exported_is_refused_with_a_reason);
    tcase_add_test(tests, a_format_may_be_named_whatever_the_ending);
    return run_suite(suite, tests);
}
