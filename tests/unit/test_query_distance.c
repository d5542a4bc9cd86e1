/* SPDX-License-Identifier: MIT */
/* Distances against the definition of the solid, and what is inside. */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "runner.h"
#include "solid.h"
#include "support.h"

static sph_context *context;
static uint64_t state;

static void setup(void)
{
    context = test_context();
    state = 7;
}

static void teardown(void)
{
    sph_context_destroy(context);
}

static double between(double low, double high)
{
    return low + (high - low) * test_random_unit(&state);
}

static uint32_t below(uint32_t count)
{
    return (uint32_t)(test_random(&state) % count);
}

static void random_solid(test_solid *s)
{
    memset(s, 0, sizeof *s);
    s->sphere_count = 5;
    for (uint32_t i = 0; i < 5; ++i) {
        for (int k = 0; k < 3; ++k)
            s->centers[i][k] = (float)between(-1, 1);
        s->radii[i] = below(4) ? (float)between(0, 0.5) : 0;
        if (below(6) == 0) memcpy(s->centers[i], s->centers[0], sizeof s->centers[i]);
    }
    s->edge_count = 1;
    s->edges[0][0] = below(5);
    s->edges[0][1] = below(5);
    s->triangle_count = 1;
    for (int i = 0; i < 3; ++i)
        s->triangles[0][i] = below(5);
}

START_TEST(distances_are_what_the_definition_says)
{
    static const double SCALES[4] = {1, 1e-35, 1e30, 3};
    for (int turn = 0; turn < 800; ++turn) {
        const double scale = SCALES[below(4)];
        test_solid s;
        sph_level *level;
        sph_query *q;
        float points[6][3];
        sph_nearest nearest[6];
        double size;
        random_solid(&s);
        for (uint32_t i = 0; i < 5; ++i) {
            for (int k = 0; k < 3; ++k)
                s.centers[i][k] = (float)(scale * s.centers[i][k]);
            s.radii[i] = (float)(scale * s.radii[i]);
        }
        size = test_solid_size(&s);
        for (int i = 0; i < 6; ++i)
            for (int k = 0; k < 3; ++k)
                points[i][k] = (float)(scale * (i == 5 ? 100 : 1) * between(-1.5, 1.5));
        memcpy(points[4], s.centers[1], sizeof points[4]); /* on the skeleton */
        level = test_solid_level(context, &s);
        ck_assert_int_eq(sph_query_create(level, NULL, &q), SPH_OK);
        ck_assert_int_eq(sph_query_nearest(q, points[0], 0, 6, nearest), SPH_OK);
        for (int i = 0; i < 6; ++i) {
            const double x[3] = {points[i][0], points[i][1], points[i][2]};
            const double want = test_solid_distance(&s, x), slack = 3e-7 * (size + fabs(want));
            const sph_contact *c = &nearest[i].contact;
            double gap = 0, radius = 0, center[3] = {0, 0, 0};
            uint8_t inside = 2;
            ck_assert_double_eq_tol(nearest[i].distance, want, slack);
            for (int k = 0; k < 3; ++k)
                gap += (c->point[k] - x[k]) / size * ((c->point[k] - x[k]) / size);
            ck_assert_double_eq_tol(size * sqrt(gap), fabs(want), slack);
            for (int j = 0; j < 3 && c->spheres[j] != SPH_NO_SPHERE; ++j) {
                for (int k = 0; k < 3; ++k)
                    center[k] += c->weights[j] * s.centers[c->spheres[j]][k];
                radius += c->weights[j] * s.radii[c->spheres[j]];
            }
            for (int k = 0; k < 3; ++k)
                ck_assert_double_eq_tol(c->point[k], center[k] + radius * c->normal[k], slack);
            ck_assert_int_eq(sph_query_contains(q, points[i], 0, 1, SPH_CAVITY_SPACE, &inside), SPH_OK);
            if (fabs(want) > slack) ck_assert_uint_eq(inside, want < 0);
        }
        sph_query_destroy(q);
        sph_level_destroy(level);
    }
}
END_TEST

START_TEST(on_a_skeleton_the_nearest_point_is_on_the_boundary_of_the_hull)
{
    const test_solid s = {
        .sphere_count = 2, .edge_count = 1, .edges = {{0, 1}}, .centers = {{0, 0, 0}, {0, 0, 4}}, .radii = {1, 1}};
    sph_level *level = test_solid_level(context, &s);
    const float points[2][3] = {{0, 0, 0}, {0, 0, 2}};
    sph_nearest n[2];
    sph_query *q;
    ck_assert_int_eq(sph_query_create(level, NULL, &q), SPH_OK);
    ck_assert_int_eq(sph_query_nearest(q, points[0], 0, 2, n), SPH_OK);
    for (int i = 0; i < 2; ++i) {
        const double x[3] = {n[i].contact.point[0], n[i].contact.point[1], n[i].contact.point[2]};
        ck_assert_double_eq_tol(n[i].distance, -1, 1e-9);
        ck_assert_double_eq_tol(test_solid_distance(&s, x), 0, 1e-6);
    }
    sph_query_destroy(q);
    sph_level_destroy(level);
}
END_TEST

/* --- cavities --- */

/* A shell of thick triangles: an icosahedron, with `hole` its first triangle left out; radii may be 0. */
static sph_level *make_shell(float radius, bool hole)
{
    static const uint32_t FACES[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                          {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                          {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                          {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    test_solid s = {.sphere_count = 12};
    const float t = 1.618034f;
    for (uint32_t i = 0; i < 12; ++i) {
        const float a = i % 2 ? 1 : -1, b = i % 4 < 2 ? t : -t;
        const uint32_t k = i / 4; /* the axis that is 0: z, x, y */
        s.centers[i][k == 0 ? 0 : k == 1 ? 1 : 2] = a;
        s.centers[i][k == 0 ? 1 : k == 1 ? 2 : 0] = b;
        s.radii[i] = radius;
    }
    s.triangle_count = hole ? 19 : 20;
    memcpy(s.triangles, FACES[hole], s.triangle_count * sizeof FACES[0]);
    return test_solid_level(context, &s);
}

/* A shell with corners of length `size`, on the icosahedron whose coordinates the shell above uses. */
START_TEST(a_closed_shell_is_hollow_only_when_asked)
{
    static const float RADII[3] = {0.2f, 0.01f, 0};
    sph_level *level = make_shell(RADII[_i], false);
    sph_query *q;
    int cavity = 0, outside = 0;
    ck_assert_int_eq(sph_query_create(level, NULL, &q), SPH_OK);
    for (int turn = 0; turn < 4000; ++turn) {
        const float x[3] = {(float)between(-2.5, 2.5), (float)between(-2.5, 2.5), (float)between(-2.5, 2.5)};
        const double length = sqrt((double)x[0] * x[0] + (double)x[1] * x[1] + (double)x[2] * x[2]);
        sph_nearest n;
        uint8_t solid = 2, space = 2;
        ck_assert_int_eq(sph_query_nearest(q, x, 0, 1, &n), SPH_OK);
        ck_assert_int_eq(sph_query_contains(q, x, 0, 1, SPH_CAVITY_SOLID, &solid), SPH_OK);
        ck_assert_int_eq(sph_query_contains(q, x, 0, 1, SPH_CAVITY_SPACE, &space), SPH_OK);
        ck_assert_uint_eq(space, n.distance <= 0);
        if (n.distance <= 0) {
            ck_assert_uint_eq(solid, 1);
        } else if (length < 1.5) { /* the sphere within has a radius of 1.5115 */
            ck_assert_uint_eq(solid, 1);
            ++cavity;
        } else if (length > 1.903) { /* beyond all corners */
            ck_assert_uint_eq(solid, 0);
            ++outside;
        }
    }
    ck_assert_int_gt(cavity, 100);
    ck_assert_int_gt(outside, 100);
    sph_query_destroy(q);
    sph_level_destroy(level);
}
END_TEST

START_TEST(a_shell_with_a_hole_has_no_cavity)
{
    sph_level *level = make_shell(0.05f, true);
    sph_query *q;
    ck_assert_int_eq(sph_query_create(level, NULL, &q), SPH_OK);
    for (int turn = 0; turn < 2000; ++turn) {
        const float x[3] = {(float)between(-2, 2), (float)between(-2, 2), (float)between(-2, 2)};
        uint8_t solid = 2, space = 2;
        ck_assert_int_eq(sph_query_contains(q, x, 0, 1, SPH_CAVITY_SOLID, &solid), SPH_OK);
        ck_assert_int_eq(sph_query_contains(q, x, 0, 1, SPH_CAVITY_SPACE, &space), SPH_OK);
        ck_assert_msg(solid == space, "%g %g %g", x[0], x[1], x[2]);
    }
    sph_query_destroy(q);
    sph_level_destroy(level);
}
END_TEST

START_TEST(a_new_pose_has_cavities_of_its_own)
{
    sph_level *level = make_shell(0.1f, false);
    sph_level_arrays arrays = {.struct_size = sizeof arrays};
    float centers[12][3];
    const float middle[3] = {0, 0, 0};
    uint8_t inside = 2;
    sph_query *q;
    ck_assert_int_eq(sph_level_get_arrays(level, &arrays), SPH_OK);
    ck_assert_int_eq(sph_query_create(level, NULL, &q), SPH_OK);
    ck_assert_int_eq(sph_query_contains(q, middle, 0, 1, SPH_CAVITY_SOLID, &inside), SPH_OK);
    ck_assert_uint_eq(inside, 1);
    for (int i = 0; i < 12; ++i)
        for (int k = 0; k < 3; ++k)
            centers[i][k] = arrays.centers[3 * i + k] + (k == 2 ? 10.0f : 0);
    ck_assert_int_eq(sph_query_pose_centers(q, centers[0], 0, NULL), SPH_OK);
    ck_assert_int_eq(sph_query_contains(q, middle, 0, 1, SPH_CAVITY_SOLID, &inside), SPH_OK);
    ck_assert_uint_eq(inside, 0);
    sph_query_destroy(q);
    sph_level_destroy(level);
}
END_TEST

int main(void)
{
    Suite *s = suite_create("query_distance");
    TCase *tc = tcase_create("query_distance");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_set_timeout(tc, 60);
    tcase_add_test(tc, distances_are_what_the_definition_says);
    tcase_add_test(tc, on_a_skeleton_the_nearest_point_is_on_the_boundary_of_the_hull);
    tcase_add_loop_test(tc, a_closed_shell_is_hollow_only_when_asked, 0, 3);
    tcase_add_test(tc, a_shell_with_a_hole_has_no_cavity);
    tcase_add_test(tc, a_new_pose_has_cavities_of_its_own);
    return run_suite(s, tc);
}
