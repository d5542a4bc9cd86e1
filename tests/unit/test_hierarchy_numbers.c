/* SPDX-License-Identifier: MIT */
/* Hierarchies whose numbers are known: costs, errors, centres, and the bound of radii. */
#include <math.h>
#include <stdlib.h>

#include "awkward.h"
#include "hierarchy_case.h"
#include "runner.h"

/* Twice the area of a triangle. */
static double double_area(float (*xyz)[3], const uint32_t corner[3])
{
    double e[2][3], squared = 0;
    for (unsigned i = 0; i < 6; ++i)
        e[i / 3][i % 3] = (double)xyz[corner[1 + i / 3]][i % 3] - (double)xyz[corner[0]][i % 3];
    for (unsigned k = 0; k < 3; ++k)
        squared += pow(e[0][(k + 1) % 3] * e[1][(k + 2) % 3] - e[0][(k + 2) % 3] * e[1][(k + 1) % 3], 2);
    return sqrt(squared);
}

/* A flat sheet in any frame is a plane: no sphere of it costs anything. */
START_TEST(flat_sheets_cost_nothing)
{
    sph_animation *animation = awkward(context, AWKWARD_FLAT, (unsigned)_i + 1);
    sph_hierarchy_options o = default_options();
    sph_hierarchy *h = build(animation, &o);
    for (uint32_t t = 0; t < sph_hierarchy_collapse_count(h); ++t) {
        sph_collapse c;
        ck_assert_int_eq(sph_hierarchy_collapse(h, t, &c), SPH_OK);
        ck_assert_double_le(c.error, 1e-6 * sph_hierarchy_bounding_diagonal(h));
    }
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
}
END_TEST

/* The planes of a cube touch the sphere inside it, of radius 1; of half that where the bound says so. */
START_TEST(a_cube_becomes_the_sphere_inside_it)
{
    static const double FACTORS[] = {0.75, 0.25, 100, 1e308};
    sph_animation *animation = test_cube(context, 1);
    sph_hierarchy_options o = default_options();
    sph_hierarchy *h;
    sph_collapse c;
    float center[3], radius;
    o.importance = SPH_IMPORTANCE_NONE;
    o.radius_factor = FACTORS[_i];
    h = build(animation, &o);
    ck_assert_int_eq(sph_hierarchy_collapse(h, 6, &c), SPH_OK);
    ck_assert_int_eq(sph_hierarchy_sphere(h, c.node, center, &radius), SPH_OK);
    for (unsigned k = 0; k < 3; ++k)
        ck_assert_float_le(fabsf(center[k]), 1e-4f);
    if (_i == 1) { /* width: 2, or a little more in directions beside the axes */
        ck_assert_float_ge(radius, 0.5f);
        ck_assert_float_le(radius, 0.6f);
        ck_assert_double_eq_tol(c.cost, 24 * (1 - radius) * (1 - radius), 1e-4); /* 24: the cube's area */
    } else {
        ck_assert_float_le(fabsf(radius - 1), 1e-4f);
        ck_assert_double_le(c.cost, 1e-4);
    }
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
}
END_TEST

/* The error of a level: the costs of its spheres over the area of all frames. */
START_TEST(errors_are_root_mean_square_distances)
{
    sph_animation *animation = awkward(context, _i == 0 ? AWKWARD_TORUS : AWKWARD_SOUP, 3);
    sph_hierarchy_options o = default_options();
    const uint32_t n = sph_animation_vertex_count(animation), *corner = sph_animation_triangles(animation);
    float(*xyz)[3] = test_malloc(n, sizeof *xyz);
    double *costs = test_malloc(2 * (size_t)n, sizeof *costs), area = 0, sum = 0, error = 0;
    sph_hierarchy *h;
    for (uint32_t f = 0; f < 3; ++f) {
        ck_assert_int_eq(sph_animation_read_frame(animation, f, xyz[0]), SPH_OK);
        for (size_t t = 0; t < sph_animation_triangle_count(animation); ++t)
            area += double_area(xyz, corner + 3 * t) / 2;
    }
    o.importance = SPH_IMPORTANCE_NONE;
    h = build(animation, &o);
    for (uint32_t t = 0; t < sph_hierarchy_collapse_count(h); ++t) {
        sph_collapse c;
        ck_assert_int_eq(sph_hierarchy_collapse(h, t, &c), SPH_OK);
        costs[c.node] = c.cost;
        sum += c.cost - costs[c.u] - costs[c.v];
        error = fmax(error, sqrt(fmax(sum, 0) / area));
        ck_assert_double_eq_tol(c.error, error, 1e-9 + 1e-6 * error);
    }
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
    free(xyz);
    free(costs);
}
END_TEST

/* Where the attachment is all that counts, a sphere is at the area-weighted mean of its vertices (Eq. 11-12). */
START_TEST(strong_coherence_puts_centres_at_area_weighted_means)
{
    sph_animation *animation = test_torus(context, 8, 6, 5);
    const uint32_t *corner = sph_animation_triangles(animation);
    sph_hierarchy_options o = default_options();
    float xyz[48][3], centers[5][3];
    sph_hierarchy *h;
    o.temporal_coherence = 1e9;
    h = build(animation, &o);
    ck_assert_int_eq(sph_hierarchy_sphere(h, 48 + 46, centers[0], NULL), SPH_OK);
    for (uint32_t f = 0; f < 5; ++f) {
        double mean[3] = {0, 0, 0}, total = 0;
        ck_assert_int_eq(sph_animation_read_frame(animation, f, xyz[0]), SPH_OK);
        for (size_t t = 0; t < 96; ++t) {
            const double weight = double_area(xyz, corner + 3 * t);
            for (unsigned i = 0; i < 9; ++i)
                mean[i % 3] += weight * (double)xyz[corner[3 * t + i / 3]][i % 3] / 3;
            total += weight;
        }
        for (unsigned k = 0; k < 3; ++k)
            ck_assert_double_eq_tol((double)centers[f][k], mean[k] / total, 1e-5);
    }
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
}
END_TEST

/* --- the radius bound --- */

/* Extent in a frame and direction of the cells of the vertices that `inside` marks. */
static double extent_of(const sph_animation *animation, float (*xyz)[3], const unsigned char *inside, const double k[3])
{
    const uint32_t n = sph_animation_vertex_count(animation), *corner = sph_animation_triangles(animation);
    double *x = test_malloc(n, sizeof *x), low = INFINITY, high = -INFINITY;
    for (uint32_t v = 0; v < n; ++v) {
        x[v] = k[0] * (double)xyz[v][0] + k[1] * (double)xyz[v][1] + k[2] * (double)xyz[v][2];
        if (inside[v]) low = fmin(low, x[v]);
        if (inside[v]) high = fmax(high, x[v]);
    }
    for (size_t t = 0; t < sph_animation_triangle_count(animation); ++t, corner += 3)
        for (unsigned c = 0; c < 3; ++c) {
            const double a = x[corner[c]], b = x[corner[(c + 1) % 3]], d = x[corner[(c + 2) % 3]];
            const double points[3] = {(a + b) / 2, (a + d) / 2, (a + b + d) / 3};
            for (unsigned i = 0; i < 3 && inside[corner[c]]; ++i) {
                low = fmin(low, points[i]);
                high = fmax(high, points[i]);
            }
        }
    free(x);
    return high - low;
}

/*
 * With 1,024 evenly spread directions none is further than 0.12 from one of the library's (a hexagonal grid of as many
 * would have 0.05), so that the library's width is at most that much of the diameter above one taken in any directions.
 */
START_TEST(radii_stay_within_the_width_of_their_regions)
{
    enum { DIRECTIONS = 200 };
    sph_animation *animation = awkward(context, _i == 0 ? AWKWARD_TORUS : _i == 1 ? AWKWARD_SOUP : AWKWARD_WHISKERS, 3);
    const uint32_t n = sph_animation_vertex_count(animation);
    float(*xyz)[3] = test_malloc(n, sizeof *xyz), radii[3];
    unsigned char *inside = test_malloc(n, 1);
    uint32_t *members = test_malloc(2 * (size_t)n, sizeof *members); /* to which node a vertex belongs by now */
    sph_hierarchy_options o = default_options();
    unsigned at_bound = 0;
    sph_hierarchy *h;
    o.width_directions = 1024;
    o.radius_factor = 0.4;
    h = build(animation, &o);
    for (uint32_t v = 0; v < n; ++v)
        members[v] = v;
    for (uint32_t t = 0; t < sph_hierarchy_collapse_count(h); ++t) {
        double width = INFINITY;
        sph_collapse c;
        ck_assert_int_eq(sph_hierarchy_collapse(h, t, &c), SPH_OK);
        for (uint32_t v = 0; v < n; ++v) {
            if (members[v] == c.u || members[v] == c.v) members[v] = c.node;
            inside[v] = members[v] == c.node;
        }
        for (uint32_t f = 0; f < 3; ++f) {
            uint64_t state = 99;
            double least = INFINITY, diameter = 0;
            ck_assert_int_eq(sph_animation_read_frame(animation, f, xyz[0]), SPH_OK);
            for (unsigned j = 0; j < DIRECTIONS; ++j) {
                const double z = 2 * test_random_unit(&state) - 1, a = 6.2831853 * test_random_unit(&state);
                const double k[3] = {sqrt(1 - z * z) * cos(a), sqrt(1 - z * z) * sin(a), z};
                const double extent = extent_of(animation, xyz, inside, k);
                least = fmin(least, extent);
                diameter = fmax(diameter, extent);
            }
            width = fmin(width, least + 0.12 * diameter * 1.1);
        }
        ck_assert_int_eq(sph_hierarchy_sphere(h, c.node, NULL, radii), SPH_OK);
        ck_assert_double_le((double)radii[0], o.radius_factor * width);
        at_bound += (double)radii[0] > 0.6 * o.radius_factor * width;
    }
    ck_assert_uint_gt(at_bound, 0); /* or it was no test */
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
    free(xyz);
    free(inside);
    free(members);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("hierarchy numbers");
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, flat_sheets_cost_nothing, 0, 9);
    tcase_add_loop_test(tc, a_cube_becomes_the_sphere_inside_it, 0, 4);
    tcase_add_loop_test(tc, errors_are_root_mean_square_distances, 0, 2);
    tcase_add_test(tc, strong_coherence_puts_centres_at_area_weighted_means);
    tcase_add_loop_test(tc, radii_stay_within_the_width_of_their_regions, 0, 3);
    return run_suite(suite, tc);
}
