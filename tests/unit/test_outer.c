/* SPDX-License-Identifier: MIT */
/* The outer surface of a posed level against brute force, and against shapes whose cavities are known. */
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "hierarchy_case.h"
#include "measure/measure.h"
#include "numeric/vector.h"
#include "runner.h"

enum { SPHERES = 9, MOST_SIMPLICES = 12, SAMPLES = 40000, QUERIES = 300, RANDOM_LEVELS = 24 };

static sph__outer outer;
static uint64_t state;

static void setup_outer(void)
{
    setup();
    outer = (sph__outer){0};
}

static void teardown_outer(void)
{
    sph__outer_free(&outer);
    teardown();
}

static double between(double low, double high)
{
    return test_random_between(&state, low, high);
}

static void pose(uint32_t spheres, const float *centers, const float *radii, size_t edge_count, const uint32_t *edges,
                 size_t triangle_count, const uint32_t *triangles, uint32_t samples)
{
    const double shift[2] = {0.3, 0.7};
    sph_level *level = make_level(spheres, centers, radii, edge_count, edges, triangle_count, triangles);
    ck_assert_int_eq(sph__outer_init(&outer, level), SPH_OK);
    ck_assert_int_eq(sph__outer_pose(&outer, centers, radii, 0, samples, shift), SPH_OK);
    sph_level_destroy(level);
}

/* Random triangles and wires over random spheres; some radii 0. */
static void pose_random(int index)
{
    float centers[3 * SPHERES], radii[SPHERES];
    uint32_t triangles[3 * MOST_SIMPLICES], edges[2 * MOST_SIMPLICES];
    const size_t triangle_count = (size_t)(index % 4) * 2, edge_count = (size_t)(index % 3) * 3;
    state = (uint64_t)index + 100;
    for (int i = 0; i < SPHERES; ++i) {
        for (int k = 0; k < 3; ++k)
            centers[3 * i + k] = (float)between(-1, 1);
        radii[i] = between(0, 1) < 0.15 ? 0 : (float)between(0.05, 0.45);
    }
    for (size_t i = 0; i < 3 * triangle_count; ++i)
        triangles[i] = (uint32_t)between(0, SPHERES);
    for (size_t i = 0; i < 2 * edge_count; ++i)
        edges[i] = (uint32_t)between(0, SPHERES);
    pose(SPHERES, centers, radii, edge_count, edges, triangle_count, triangles, 10000);
}

/* --- brute force: points of the boundary, found by projecting points on to primitives --- */

static double samples[SAMPLES][3];

/* The boundary point of a random primitive nearest to y, where no primitive covers it. */
static bool project(const double y[3], uint32_t primitive, double point[3])
{
    sph__contact c;
    sph__primitive_closest(&outer.solid.primitives[primitive], y, &c);
    for (uint32_t i = 0; i < outer.solid.primitive_count; ++i)
        if (sph__primitive_distance(&outer.solid.primitives[i], c.point) < -1e-9) return false;
    sph__copy3(c.point, point);
    return true;
}

static int sample_boundary(void)
{
    int count = 0;
    for (int i = 0; i < SAMPLES; ++i) {
        const double y[3] = {between(-1.5, 1.5), between(-1.5, 1.5), between(-1.5, 1.5)};
        const uint32_t primitive = (uint32_t)between(0, outer.solid.primitive_count);
        count += project(y, primitive, samples[count]);
    }
    return count;
}

/* From the nearest sample, by random steps that get smaller; a few times, as one walk may end in the wrong crease. */
static double nearest_by_brute_force(const double x[3], int count)
{
    double first = DBL_MAX, start[3] = {0}, best;
    for (int i = 0; i < count; ++i) {
        const double d = sph__distance(x, samples[i]);
        if (d >= first) continue;
        first = d;
        sph__copy3(samples[i], start);
    }
    best = first;
    for (int walk = 0; walk < 4; ++walk) {
        double at[3], here = first;
        sph__copy3(start, at);
        for (double width = 0.1; width > 1e-7; width *= 0.985) {
            double y[3], point[3];
            for (int k = 0; k < 3; ++k)
                y[k] = at[k] + between(-width, width);
            if (!project(y, (uint32_t)between(0, outer.solid.primitive_count), point)) continue;
            if (sph__distance(x, point) >= here) continue;
            here = sph__distance(x, point);
            sph__copy3(point, at);
        }
        best = fmin(best, here);
    }
    return best;
}

START_TEST(distance_from_within_reaches_the_nearest_boundary_of_the_union)
{
    const double tolerance = 1e-5; /* the skin, and the descent's */
    int count, exact = 0, inside = 0;
    pose_random(_i);
    count = sample_boundary();
    ck_assert(!outer.has_cavities);
    for (int i = 0; i < QUERIES; ++i) {
        const double x[3] = {between(-1.2, 1.2), between(-1.2, 1.2), between(-1.2, 1.2)};
        double distance, brute;
        if (sph__solid_distance(&outer.solid, x, NULL) > -1e-4) continue;
        distance = sph__outer_distance(&outer, x);
        brute = nearest_by_brute_force(x, count);
        ck_assert_double_le(distance, brute + tolerance);
        ck_assert_double_ge(distance, brute - 0.05); /* brute force may end at another crease */
        exact += fabs(distance - brute) < 1e-4;
        ++inside;
    }
    ck_assert_int_ge(exact, inside * 8 / 10);
}
END_TEST

START_TEST(distance_from_outside_is_that_to_the_nearest_primitive)
{
    pose_random(_i);
    for (int i = 0; i < QUERIES; ++i) {
        const double x[3] = {between(-1.5, 1.5), between(-1.5, 1.5), between(-1.5, 1.5)};
        double least = DBL_MAX;
        for (uint32_t k = 0; k < outer.solid.primitive_count; ++k)
            least = fmin(least, sph__primitive_distance(&outer.solid.primitives[k], x));
        if (least > 0) ck_assert_double_eq_tol(sph__outer_distance(&outer, x), least + outer.skin, 1e-12);
    }
}
END_TEST

START_TEST(points_of_the_surface_lie_on_it_and_are_spread_evenly)
{
    enum { CELLS = 8 };
    double counts[CELLS] = {0}, expected[CELLS] = {0}, sum = 0;
    pose_random(_i);
    for (uint32_t i = 0; i < outer.outer_count; ++i) {
        double x[3];
        sph__outer_point(&outer, i, x);
        ck_assert_double_eq_tol(sph__solid_distance(&outer.solid, x, NULL), -outer.skin, 2e-7 * outer.size);
        if (i < outer.extreme_begin) counts[(x[0] > 0) + 2 * (x[1] > 0) + 4 * (x[2] > 0)] += 1;
    }
    /* the same from far more points with another start */
    {
        const double shift[2] = {0.123, 0.456};
        const double area = sph__patches_area(&outer.solid);
        const uint32_t kept = outer.extreme_begin;
        outer.point_count = 0;
        ck_assert(sph__patches_sample(&outer, area, 400000, shift));
        for (uint32_t i = 0; i < outer.point_count; ++i) {
            const double *x = outer.points[i].position;
            expected[(x[0] > 0) + 2 * (x[1] > 0) + 4 * (x[2] > 0)] += 1;
            sum += 1;
        }
        for (int i = 0; i < CELLS; ++i)
            ck_assert_double_eq_tol(counts[i] / kept, expected[i] / sum, 0.005);
        ck_assert_double_eq_tol(outer.area, area * sum / 400000, 0.01 * outer.area);
    }
}
END_TEST

/* --- an icosahedron of triangles --- */

static float corners[13 * 3];
static uint32_t faces[20 * 3];
static float thickness[13];
static double edge_length, inradius;

/* Corners at even permutations of (0, +-1, +-golden ratio); faces are the triples at the least mutual distance. */
static void set_icosahedron(float radius)
{
    const double golden = (1 + sqrt(5)) / 2;
    int face = 0;
    for (int i = 0; i < 12; ++i) {
        const double a = i & 1 ? 1 : -1, b = i & 2 ? golden : -golden;
        corners[3 * i + i / 4] = 0;
        corners[3 * i + (i / 4 + 1) % 3] = (float)a;
        corners[3 * i + (i / 4 + 2) % 3] = (float)b;
        thickness[i] = radius;
    }
    edge_length = 2;
    inradius = golden * golden / sqrt(3);
    for (uint32_t a = 0; a < 12; ++a)
        for (uint32_t b = a + 1; b < 12; ++b)
            for (uint32_t c = b + 1; c < 12; ++c) {
                double longest = 0;
                const uint32_t t[4] = {a, b, c, a};
                for (int k = 0; k < 3; ++k) {
                    double d = 0;
                    for (int l = 0; l < 3; ++l)
                        d += pow((double)corners[3 * t[k] + (uint32_t)l] - corners[3 * t[k + 1] + (uint32_t)l], 2);
                    longest = fmax(longest, sqrt(d));
                }
                if (longest > edge_length * 1.01) continue;
                for (int k = 0; k < 3; ++k)
                    faces[3 * face + k] = t[k];
                ++face;
            }
    ck_assert_int_eq(face, 20);
}

static double icosahedron_area(void)
{
    return 5 * sqrt(3) * edge_length * edge_length;
}

/* Area of the boundary of everything within `radius` of the icosahedron (Steiner). */
static double offset_area(double radius)
{
    const double turn = M_PI - acos(-sqrt(5) / 3);
    return icosahedron_area() + 30 * edge_length * turn * radius + 4 * M_PI * radius * radius;
}

/* Height of x above the plane of the face that sees it from highest, less that of the plane. */
static double height(const double x[3])
{
    double most = -DBL_MAX;
    for (int i = 0; i < 20; ++i) {
        double n[3] = {0}, length;
        for (int k = 0; k < 9; ++k)
            n[k % 3] += corners[3 * faces[3 * i + k / 3] + (uint32_t)(k % 3)];
        length = sph__norm(n);
        most = fmax(most, sph__dot(n, x) / length - inradius);
    }
    return most;
}

static const float SHELL_RADII[] = {0, 1e-4f, 0.05f, 0.4f};

START_TEST(the_inner_side_of_a_closed_shell_does_not_count)
{
    const float radius = SHELL_RADII[_i];
    const double center[3] = {0.01, 0.02, 0.03};
    set_icosahedron(radius);
    pose(12, corners, thickness, 0, NULL, 20, faces, 10000);
    ck_assert(outer.has_cavities);
    ck_assert_double_eq_tol(outer.area, offset_area(radius), 0.005 * outer.area);
    for (uint32_t i = 0; i < outer.outer_count; ++i) {
        double x[3];
        sph__outer_point(&outer, i, x);
        ck_assert_double_ge(height(x), -1e-6);
    }
    ck_assert_double_eq_tol(sph__outer_distance(&outer, center), -height(center) + radius, 1e-5);
    state = 5;
    for (int i = 0; i < 500; ++i) { /* in the cavity, in the shell, and between */
        double x[3], expected;
        do
            for (int k = 0; k < 3; ++k)
                x[k] = between(-1.9, 1.9);
        while (height(x) >= radius);
        expected = fabs(radius - height(x));
        if (height(x) > 0) continue; /* where edges and corners round the offset it is not that simple */
        ck_assert_double_eq_tol(sph__outer_distance(&outer, x), expected, 2e-5);
    }
}
END_TEST

START_TEST(what_floats_in_a_closed_shell_does_not_count)
{
    const double x[3] = {0.3, 0, 0};
    set_icosahedron(0.05f);
    corners[36] = corners[37] = corners[38] = 0;
    thickness[12] = 0.5f;
    pose(13, corners, thickness, 0, NULL, 20, faces, 10000);
    ck_assert_double_eq_tol(outer.area, offset_area(0.05f), 0.005 * outer.area);
    ck_assert_double_eq_tol(sph__outer_distance(&outer, x), -height(x) + 0.05, 1e-5);
}
END_TEST

START_TEST(a_shell_with_a_missing_triangle_is_open_and_both_its_sides_count)
{
    const float radius = SHELL_RADII[_i];
    const double x[3] = {0, 0, 0};
    set_icosahedron(radius);
    pose(12, corners, thickness, 0, NULL, 19, faces, 10000);
    ck_assert(!outer.has_cavities);
    ck_assert_double_gt(outer.area, 1.5 * icosahedron_area());
    ck_assert_double_eq_tol(sph__outer_distance(&outer, x), inradius - radius, 1e-5);
    if (radius == 0) ck_assert_double_eq_tol(outer.area, 2 * 19 / 20.0 * icosahedron_area(), 0.001 * outer.area);
}
END_TEST

START_TEST(an_open_sheet_has_two_sides)
{
    const float centers[] = {0, 0, 0, 2, 0, 0, 2, 3, 0, 0, 3, 0};
    const float radii[4] = {0};
    const uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
    const double above[3] = {1, 1, 0.25}, beside[3] = {-0.5, 1, 0};
    pose(4, centers, radii, 0, NULL, 2, triangles, 5000);
    ck_assert(!outer.has_cavities);
    ck_assert_double_eq_tol(outer.area, 12, 0.001);
    ck_assert_double_eq_tol(sph__outer_distance(&outer, above), 0.25, 1e-9);
    ck_assert_double_eq_tol(sph__outer_distance(&outer, beside), 0.5, 1e-9);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("outer");
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup_outer, teardown_outer);
    tcase_add_loop_test(tc, distance_from_within_reaches_the_nearest_boundary_of_the_union, 0, RANDOM_LEVELS);
    tcase_add_loop_test(tc, distance_from_outside_is_that_to_the_nearest_primitive, 0, RANDOM_LEVELS);
    tcase_add_loop_test(tc, points_of_the_surface_lie_on_it_and_are_spread_evenly, 0, 8);
    tcase_add_loop_test(tc, the_inner_side_of_a_closed_shell_does_not_count, 0, 4);
    tcase_add_test(tc, what_floats_in_a_closed_shell_does_not_count);
    tcase_add_loop_test(tc, a_shell_with_a_missing_triangle_is_open_and_both_its_sides_count, 0, 4);
    tcase_add_test(tc, an_open_sheet_has_two_sides);
    return run_suite(suite, tc);
}
