/* SPDX-License-Identifier: MIT */
/* Options of hierarchies, and what is refused. */
#include <math.h>
#include <stdio.h>

#include "awkward.h"
#include "hierarchy_case.h"
#include "runner.h"

START_TEST(options_have_the_documented_defaults)
{
    const sph_hierarchy_options o = default_options();
    ck_assert_uint_eq(o.struct_size, sizeof o);
    ck_assert_uint_eq(o.flags, 0);
    ck_assert_int_eq(o.importance, SPH_IMPORTANCE_CURVATURE);
    ck_assert_int_eq(o.radius_mode, SPH_RADIUS_CONSTANT);
    ck_assert_double_eq(o.radius_factor, 0.75);
    ck_assert_double_eq(o.temporal_coherence, 0);
    ck_assert_uint_eq(o.width_directions, 30);
    ck_assert_int_eq(o.orientation, SPH_ORIENTATION_OUTWARD);
    ck_assert_ptr_null(o.importance_weights);
    ck_assert_uint_eq(o.importance_frame_stride, 0);
}
END_TEST

START_TEST(a_newer_callers_options_are_read_and_its_settings_refused)
{
    struct {
        sph_hierarchy_options known;
        uint64_t newer;
    } o;
    sph_animation *animation = test_cube(context, 2);
    sph_hierarchy *h;
    memset(&o, 0xff, sizeof o);
    sph_hierarchy_options_init(&o.known, sizeof o);
    ck_assert_uint_eq(o.known.struct_size, sizeof o);
    ck_assert_uint_eq(o.newer, 0);
    ck_assert_double_eq(o.known.radius_factor, 0.75);
    sph_hierarchy_destroy(build(animation, &o.known));
    o.newer = 1;
    ck_assert_int_eq(sph_hierarchy_create(animation, &o.known, &h), SPH_E_VERSION);
    ck_assert_ptr_null(h);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(options_that_are_too_small_or_raw_are_refused)
{
    sph_hierarchy_options o = {0};
    sph_animation *animation = test_cube(context, 2);
    sph_hierarchy *h = (sph_hierarchy *)&o;
    ck_assert_int_eq(sph_hierarchy_create(animation, &o, &h), SPH_E_INVALID);
    ck_assert_ptr_null(h);
    for (uint32_t size = 0; size < sizeof o; ++size) {
        o = default_options();
        o.struct_size = size;
        ck_assert_int_eq(sph_hierarchy_create(animation, &o, &h), SPH_E_INVALID);
        memset(&o, 0x5a, sizeof o);
        sph_hierarchy_options_init(&o, size); /* does not write beyond */
        for (size_t i = size; i < sizeof o; ++i)
            ck_assert_uint_eq(((unsigned char *)&o)[i], 0x5a);
    }
    sph_hierarchy_options_init(NULL, sizeof o);
    sph_animation_destroy(animation);
}
END_TEST

static const float WEIGHT = 1;

static const struct {
    const char *named; /* in the message */
    size_t offset;
    size_t size;
    int32_t integer;
    double real;
} BAD_OPTIONS[] = {
    {"flags", offsetof(sph_hierarchy_options, flags), 4, 1, 0},
    {"importance", offsetof(sph_hierarchy_options, importance), 4, -1, 0},
    {"importance", offsetof(sph_hierarchy_options, importance), 4, 3, 0},
    {"importance", offsetof(sph_hierarchy_options, importance), 4, INT32_MIN, 0},
    {"importance_weights", offsetof(sph_hierarchy_options, importance), 4, SPH_IMPORTANCE_CALLER, 0},
    {"radius_mode", offsetof(sph_hierarchy_options, radius_mode), 4, -1, 0},
    {"radius_mode", offsetof(sph_hierarchy_options, radius_mode), 4, 3, 0},
    {"orientation", offsetof(sph_hierarchy_options, orientation), 4, -1, 0},
    {"orientation", offsetof(sph_hierarchy_options, orientation), 4, 2, 0},
    {"width_directions", offsetof(sph_hierarchy_options, width_directions), 4, 2, 0},
    {"width_directions", offsetof(sph_hierarchy_options, width_directions), 4, 0, 0},
    {"width_directions", offsetof(sph_hierarchy_options, width_directions), 4, 1025, 0},
    {"width_directions", offsetof(sph_hierarchy_options, width_directions), 4, -1, 0},
    {"radius_factor", offsetof(sph_hierarchy_options, radius_factor), 8, 0, -1e-300},
    {"radius_factor", offsetof(sph_hierarchy_options, radius_factor), 8, 0, (double)NAN},
    {"radius_factor", offsetof(sph_hierarchy_options, radius_factor), 8, 0, (double)INFINITY},
    {"temporal_coherence", offsetof(sph_hierarchy_options, temporal_coherence), 8, 0, -1},
    {"temporal_coherence", offsetof(sph_hierarchy_options, temporal_coherence), 8, 0, (double)NAN},
    {"temporal_coherence", offsetof(sph_hierarchy_options, temporal_coherence), 8, 0, (double)INFINITY},
};
enum { BAD_OPTION_COUNT = sizeof BAD_OPTIONS / sizeof *BAD_OPTIONS };

START_TEST(a_bad_option_is_refused_and_the_message_names_it)
{
    sph_hierarchy_options o = default_options();
    sph_animation *animation = test_cube(context, 2);
    sph_hierarchy *h = (sph_hierarchy *)&o;
    const void *value = BAD_OPTIONS[_i].size == 4 ? (const void *)&BAD_OPTIONS[_i].integer : &BAD_OPTIONS[_i].real;
    memcpy((char *)&o + BAD_OPTIONS[_i].offset, value, BAD_OPTIONS[_i].size);
    ck_assert_int_eq(sph_hierarchy_create(animation, &o, &h), SPH_E_INVALID);
    ck_assert_ptr_null(h);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), BAD_OPTIONS[_i].named));
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(weights_without_their_mode_are_refused)
{
    sph_hierarchy_options o = default_options();
    sph_animation *animation = awkward(context, AWKWARD_SINGLE_VERTEX, 1);
    sph_hierarchy *h;
    o.importance_weights = &WEIGHT;
    ck_assert_int_eq(sph_hierarchy_create(animation, &o, &h), SPH_E_INVALID);
    o.importance = SPH_IMPORTANCE_CALLER;
    sph_hierarchy_destroy(build(animation, &o));
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(null_and_numbers_out_of_range_are_answered)
{
    sph_animation *animation = test_cube(context, 2);
    sph_hierarchy *h = (sph_hierarchy *)animation;
    sph_collapse collapse;
    uint32_t count = 77;
    ck_assert_int_eq(sph_hierarchy_create(NULL, NULL, &h), SPH_E_INVALID);
    ck_assert_ptr_null(h);
    ck_assert_int_eq(sph_hierarchy_create(animation, NULL, NULL), SPH_E_INVALID);
    ck_assert_uint_eq(sph_hierarchy_vertex_count(NULL) + sph_hierarchy_frame_count(NULL), 0);
    ck_assert_uint_eq(sph_hierarchy_collapse_count(NULL) + sph_hierarchy_first_forced(NULL), 0);
    ck_assert_uint_eq(sph_hierarchy_evaluation_count(NULL), 0);
    ck_assert_double_eq(sph_hierarchy_bounding_diagonal(NULL), 0);
    ck_assert_int_eq(sph_hierarchy_collapse(NULL, 0, &collapse), SPH_E_INVALID);
    ck_assert_int_eq(sph_hierarchy_sphere(NULL, 0, NULL, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_hierarchy_count_for_error(NULL, 1, &count), SPH_E_INVALID);
    sph_hierarchy_destroy(NULL);
    h = build(animation, NULL);
    ck_assert_int_eq(sph_hierarchy_collapse(h, 0, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_hierarchy_collapse(h, sph_hierarchy_collapse_count(h), &collapse), SPH_E_INVALID);
    ck_assert_int_eq(sph_hierarchy_collapse(h, UINT32_MAX, &collapse), SPH_E_INVALID);
    ck_assert_int_eq(sph_hierarchy_sphere(h, 15, NULL, NULL), SPH_E_INVALID); /* 8 + 7 */
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "15"));
    ck_assert_int_eq(sph_hierarchy_sphere(h, 14, NULL, NULL), SPH_OK);
    ck_assert_int_eq(sph_hierarchy_count_for_error(h, -1, &count), SPH_E_INVALID);
    ck_assert_int_eq(sph_hierarchy_count_for_error(h, (double)NAN, &count), SPH_E_INVALID);
    ck_assert_int_eq(sph_hierarchy_count_for_error(h, 1, NULL), SPH_E_INVALID);
    ck_assert_uint_eq(count, 77);
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
}
END_TEST

/* --- input that is refused --- */

static const struct {
    float value;
    uint32_t frame, vertex, axis;
} BAD_COORDINATES[] = {{NAN, 0, 0, 0},     {NAN, 2, 7, 2},    {INFINITY, 1, 3, 1}, {-INFINITY, 0, 5, 0},
                       {3.4e38f, 1, 0, 0}, {-1e20f, 2, 6, 2}, {2e19f, 0, 7, 2}};
enum { BAD_COORDINATE_COUNT = sizeof BAD_COORDINATES / sizeof *BAD_COORDINATES };

START_TEST(a_bad_coordinate_is_refused_and_the_message_names_frame_and_vertex)
{
    sph_animation *animation = test_cube(context, 3);
    sph_hierarchy *h = (sph_hierarchy *)animation;
    float xyz[8][3];
    char text[64];
    ck_assert_int_eq(sph_animation_read_frame(animation, BAD_COORDINATES[_i].frame, xyz[0]), SPH_OK);
    xyz[BAD_COORDINATES[_i].vertex][BAD_COORDINATES[_i].axis] = BAD_COORDINATES[_i].value;
    ck_assert_int_eq(sph_animation_set_frame(animation, BAD_COORDINATES[_i].frame, xyz[0], 0), SPH_OK);
    ck_assert_int_eq(sph_hierarchy_create(animation, NULL, &h), SPH_E_INVALID);
    ck_assert_ptr_null(h);
    snprintf(text, sizeof text, "frame %u", BAD_COORDINATES[_i].frame);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), text));
    snprintf(text, sizeof text, "vertex %u", BAD_COORDINATES[_i].vertex);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), text));
    sph_animation_destroy(animation);
}
END_TEST

static const float BAD_WEIGHTS[] = {-1, -1e-40f, NAN, INFINITY, -INFINITY};
enum { BAD_WEIGHT_COUNT = sizeof BAD_WEIGHTS / sizeof *BAD_WEIGHTS };

START_TEST(a_bad_weight_is_refused_and_the_message_names_frame_and_vertex)
{
    sph_animation *animation = test_cube(context, 3);
    sph_hierarchy_options o = default_options();
    sph_hierarchy *h;
    float weights[3 * 10];
    for (unsigned i = 0; i < 30; ++i)
        weights[i] = i % 10 < 8 ? 1 : -5; /* what lies between is not read */
    o.importance = SPH_IMPORTANCE_CALLER;
    o.importance_weights = weights;
    o.importance_frame_stride = 10;
    sph_hierarchy_destroy(build(animation, &o));
    weights[25] = BAD_WEIGHTS[_i];
    ck_assert_int_eq(sph_hierarchy_create(animation, &o, &h), SPH_E_INVALID);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "frame 2"));
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "vertex 5"));
    o.importance_frame_stride = 0; /* then only the first eight count */
    sph_hierarchy_destroy(build(animation, &o));
    weights[3] = BAD_WEIGHTS[_i];
    ck_assert_int_eq(sph_hierarchy_create(animation, &o, &h), SPH_E_INVALID);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "vertex 3"));
    sph_animation_destroy(animation);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("hierarchy options");
    TCase *tc = tcase_create("options");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_test(tc, options_have_the_documented_defaults);
    tcase_add_test(tc, a_newer_callers_options_are_read_and_its_settings_refused);
    tcase_add_test(tc, options_that_are_too_small_or_raw_are_refused);
    tcase_add_loop_test(tc, a_bad_option_is_refused_and_the_message_names_it, 0, BAD_OPTION_COUNT);
    tcase_add_test(tc, weights_without_their_mode_are_refused);
    tcase_add_test(tc, null_and_numbers_out_of_range_are_answered);
    tcase_add_loop_test(tc, a_bad_coordinate_is_refused_and_the_message_names_frame_and_vertex, 0,
                        BAD_COORDINATE_COUNT);
    tcase_add_loop_test(tc, a_bad_weight_is_refused_and_the_message_names_frame_and_vertex, 0, BAD_WEIGHT_COUNT);
    return run_suite(suite, tc);
}
