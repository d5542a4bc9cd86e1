/* SPDX-License-Identifier: MIT */
#include <check.h>
#include <math.h>
#include <string.h>

#include <sphmesh/level.h>

#include "runner.h"

static sph_context *context;
static float centers[2 * 3 * 3] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1};
static float radii[6] = {0.1f, 0.2f, 0, 0.3f, 0.4f, 0.5f};
static uint32_t edges[2] = {0, 2}, triangles[3] = {0, 1, 2}, labels[4] = {0, 1, 2, SPH_NO_SPHERE};
static sph_level_arrays arrays;

static void setup(void)
{
    ck_assert_int_eq(sph_context_create(NULL, &context), SPH_OK);
    arrays = (sph_level_arrays){sizeof arrays, 3, 2, 0, centers, radii, 1, edges, 1, triangles, 4, labels};
}

static void teardown(void)
{
    sph_context_destroy(context);
}

START_TEST(a_level_gives_back_copies_of_what_it_was_made_of)
{
    sph_level *level = NULL;
    sph_level_arrays got = {.struct_size = sizeof got};
    arrays.radii_per_frame = (uint32_t)_i;
    ck_assert_int_eq(sph_level_create_from_arrays(context, &arrays, &level), SPH_OK);
    ck_assert_uint_eq(sph_level_sphere_count(level), 3);
    ck_assert_uint_eq(sph_level_frame_count(level), 2);
    ck_assert_int_eq(sph_level_get_arrays(level, &got), SPH_OK);
    ck_assert_ptr_ne(got.centers, centers);
    ck_assert_mem_eq(got.centers, centers, sizeof centers);
    ck_assert_mem_eq(got.radii, radii, (_i ? 6 : 3) * sizeof(float));
    ck_assert_mem_eq(got.edges, edges, sizeof edges);
    ck_assert_mem_eq(got.triangles, triangles, sizeof triangles);
    ck_assert_mem_eq(got.labels, labels, sizeof labels);
    ck_assert_uint_eq(got.radii_per_frame, (uint32_t)_i);
    sph_level_destroy(level);
}
END_TEST

START_TEST(a_level_keeps_its_context_alive)
{
    sph_level *level = NULL;
    sph_context *own = NULL;
    ck_assert_int_eq(sph_context_create(NULL, &own), SPH_OK);
    ck_assert_int_eq(sph_level_create_from_arrays(own, &arrays, &level), SPH_OK);
    sph_context_destroy(own);
    ck_assert_uint_eq(sph_level_sphere_count(level), 3);
    sph_level_destroy(level);
}
END_TEST

static void refused(const char *part_of_message)
{
    sph_level *level = (sph_level *)&arrays;
    ck_assert_int_eq(sph_level_create_from_arrays(context, &arrays, &level), SPH_E_INVALID);
    ck_assert_ptr_null(level);
    ck_assert_msg(strstr(sph_context_last_message(context), part_of_message) != NULL, "message: %s",
                  sph_context_last_message(context));
}

START_TEST(a_bad_level_is_refused_and_the_message_names_what_is_bad)
{
    float bad_centers[18], bad_radii[6];
    uint32_t bad_edges[2] = {0, 3}, bad_triangles[3] = {7, 1, 2}, bad_labels[4] = {0, 1, 2, 3};
    memcpy(bad_centers, centers, sizeof centers);
    memcpy(bad_radii, radii, sizeof radii);
    bad_centers[3 * 3 + 4] = NAN;
    bad_radii[5] = -1;
    arrays.centers = bad_centers;
    refused("centre of sphere 1 in frame 1");
    arrays.centers = centers;
    arrays.radii = bad_radii;
    arrays.radii_per_frame = 1;
    refused("radius of sphere 2 in frame 1");
    arrays.radii = radii;
    arrays.edges = bad_edges;
    refused("edge 0 names sphere 3 of 3");
    arrays.edges = edges;
    arrays.triangles = bad_triangles;
    refused("triangle 0 names sphere 7 of 3");
    arrays.triangles = triangles;
    arrays.labels = bad_labels;
    refused("label 3 names sphere 3 of 3");
    arrays.labels = NULL;
    refused("NULL");
    arrays.labels = labels;
    arrays.struct_size = 4;
    refused("struct_size");
    arrays.struct_size = sizeof arrays;
    arrays.sphere_count = 0;
    refused("0 spheres");
    arrays.sphere_count = 3;
    arrays.radii_per_frame = 2;
    refused("radii_per_frame");
}
END_TEST

START_TEST(null_is_answered_and_never_read)
{
    sph_level *level = NULL;
    ck_assert_int_eq(sph_level_create_from_arrays(NULL, &arrays, &level), SPH_E_INVALID);
    ck_assert_int_eq(sph_level_create_from_arrays(context, NULL, &level), SPH_E_INVALID);
    ck_assert_int_eq(sph_level_create_from_arrays(context, &arrays, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_level_get_arrays(NULL, &arrays), SPH_E_INVALID);
    ck_assert_uint_eq(sph_level_sphere_count(NULL), 0);
    ck_assert_uint_eq(sph_level_frame_count(NULL), 0);
    sph_level_destroy(NULL);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("level arrays");
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, a_level_gives_back_copies_of_what_it_was_made_of, 0, 2);
    tcase_add_test(tc, a_level_keeps_its_context_alive);
    tcase_add_test(tc, a_bad_level_is_refused_and_the_message_names_what_is_bad);
    tcase_add_test(tc, null_is_answered_and_never_read);
    return run_suite(suite, tc);
}
