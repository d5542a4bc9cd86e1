/* SPDX-License-Identifier: MIT */
/* Distances of meshes and levels against those of spheres and of points, which are known. */
#include <math.h>
#include <stdlib.h>

#include "hierarchy_case.h"
#include "runner.h"

/* --- a globe: a sphere of `rings` by 2 * `rings` quadrilaterals --- */

enum { RINGS = 100, AROUND = 2 * RINGS, GLOBE_VERTICES = (RINGS + 1) * AROUND, GLOBE_TRIANGLES = 2 * RINGS * AROUND };

static void fill_globe(const double center[3], double radius, float *xyz, uint32_t *triangles)
{
    for (uint32_t i = 0; i <= RINGS; ++i)
        for (uint32_t j = 0; j < AROUND; ++j) {
            const double t = M_PI * i / RINGS, p = 2 * M_PI * j / AROUND;
            float *v = xyz + 3 * (i * AROUND + j);
            v[0] = (float)(center[0] + radius * sin(t) * cos(p));
            v[1] = (float)(center[1] + radius * sin(t) * sin(p));
            v[2] = (float)(center[2] + radius * cos(t));
        }
    for (uint32_t i = 0; i < RINGS; ++i)
        for (uint32_t j = 0; j < AROUND; ++j) {
            uint32_t *t = triangles + 6 * (i * AROUND + j);
            const uint32_t a = i * AROUND + j, b = i * AROUND + (j + 1) % AROUND, c = a + AROUND, d = b + AROUND;
            const uint32_t two[6] = {a, c, d, a, d, b};
            memcpy(t, two, sizeof two);
        }
}

static sph_animation *make_globe(const double center[3], double radius)
{
    static float xyz[3 * GLOBE_VERTICES];
    static uint32_t triangles[3 * GLOBE_TRIANGLES];
    sph_animation *animation = NULL;
    fill_globe(center, radius, xyz, triangles);
    ck_assert_int_eq(sph_animation_create(context, GLOBE_VERTICES, 1, &animation), SPH_OK);
    ck_assert_int_eq(sph_animation_set_frame(animation, 0, xyz, 0), SPH_OK);
    ck_assert_int_eq(sph_animation_set_triangles(animation, triangles, GLOBE_TRIANGLES, 0), SPH_OK);
    return animation;
}

static const double ORIGIN[3] = {0, 0, 0};

static sph_distances measure(const sph_animation *animation, const sph_level *level)
{
    sph_distances d = {0};
    ck_assert_msg(sph_measure_level(animation, level, NULL, &d, NULL) == SPH_OK, "%s",
                  sph_context_last_message(context));
    return d;
}

/* Concentric spheres: every distance is the difference of radii, but for the chords of the mesh. */
START_TEST(concentric_spheres_are_the_difference_of_radii_apart)
{
    static const float radii[] = {0.9f, 1.0f, 1.1f, 0};
    const float center[3] = {0, 0, 0};
    sph_animation *globe = make_globe(ORIGIN, 1);
    sph_level *level = make_level(1, center, &radii[_i], 0, NULL, 0, NULL);
    const sph_distances d = measure(globe, level);
    const double gap = fabs(1.0 - radii[_i]), chord = 1 - cos(M_PI / RINGS);
    ck_assert_double_eq_tol(d.mean12, gap, chord);
    ck_assert_double_eq_tol(d.mean21, gap, chord);
    ck_assert_double_eq_tol(d.hausdorff, gap, chord);
    ck_assert_double_eq_tol(d.area1, 4 * M_PI, 0.01);
    ck_assert_double_eq_tol(d.area2, 4 * M_PI * radii[_i] * radii[_i], 0.001);
    sph_level_destroy(level);
    sph_animation_destroy(globe);
}
END_TEST

/* --- soups of small triangles around a level, whose distances are known one by one --- */

enum { SOUP = 600 };
static double soup[SOUP][3];

/* Equal triangles so small that each is a point. */
static sph_animation *make_soup(void)
{
    static float xyz[9 * SOUP];
    static uint32_t triangles[3 * SOUP];
    sph_animation *animation = NULL;
    for (int i = 0; i < SOUP; ++i)
        for (int k = 0; k < 3; ++k) {
            for (int l = 0; l < 3; ++l)
                xyz[9 * i + 3 * k + l] = (float)(soup[i][l] + (k == l ? 1e-4 : 0));
            triangles[3 * i + k] = (uint32_t)(3 * i + k);
        }
    ck_assert_int_eq(sph_animation_create(context, 3 * SOUP, 1, &animation), SPH_OK);
    ck_assert_int_eq(sph_animation_set_frame(animation, 0, xyz, 0), SPH_OK);
    ck_assert_int_eq(sph_animation_set_triangles(animation, triangles, SOUP, 0), SPH_OK);
    return animation;
}

/* A tapered capsule, and a tilted thick triangle whose faces no axis is at right angles to. */
static const float SHAPE_CENTERS[2][9] = {{0, 0, 0, 1, 0.5f, -0.3f, 0, 0, 0},
                                          {0, 0, 0, 1, 0.2f, 0.4f, -0.2f, 1.1f, 0.7f}};
static const float SHAPE_RADII[2][3] = {{0.4f, 0.15f, 0}, {0.3f, 0.1f, 0.2f}};
static const uint32_t SHAPE_SIMPLEX[3] = {0, 1, 2};

/* Signed, by the definition: the least over interpolated spheres. */
static double distance_to_shape(int shape, const double x[3])
{
    enum { GRID = 400 };
    const float *c = SHAPE_CENTERS[shape], *r = SHAPE_RADII[shape];
    double best = 1e300;
    for (int i = 0; i <= GRID; ++i)
        for (int j = 0; j <= (shape == 0 ? 0 : GRID - i); ++j) {
            const double b1 = (double)i / GRID, b2 = (double)j / GRID, b0 = 1 - b1 - b2;
            double d = 0;
            for (int k = 0; k < 3; ++k)
                d += pow(x[k] - b0 * c[k] - b1 * c[3 + k] - b2 * c[6 + k], 2);
            best = fmin(best, sqrt(d) - b0 * r[0] - b1 * r[1] - b2 * r[2]);
        }
    return best;
}

/* Points on both sides of the shape's surface: the mean and the largest distance are known. */
START_TEST(distances_to_a_tapered_capsule_and_a_tilted_thick_triangle_are_exact)
{
    uint64_t state = 11;
    double sum = 0, most = 0;
    sph_animation *animation;
    sph_distances d;
    sph_level *level = _i == 0 ? make_level(2, SHAPE_CENTERS[0], SHAPE_RADII[0], 1, SHAPE_SIMPLEX, 0, NULL)
                               : make_level(3, SHAPE_CENTERS[1], SHAPE_RADII[1], 0, NULL, 1, SHAPE_SIMPLEX);
    for (int i = 0; i < SOUP; ++i) {
        double distance;
        for (int k = 0; k < 3; ++k)
            soup[i][k] = 2.4 * test_random_unit(&state) - 0.9;
        distance = fabs(distance_to_shape(_i, soup[i]));
        sum += distance;
        most = fmax(most, distance);
    }
    animation = make_soup();
    d = measure(animation, level);
    ck_assert_double_eq_tol(d.mean12, sum / SOUP, 2e-4); /* the triangles' size */
    ck_assert_double_eq_tol(d.max12, most, 2e-4);
    ck_assert_double_eq(d.hausdorff, fmax(d.max12, d.max21));
    sph_level_destroy(level);
    sph_animation_destroy(animation);
}
END_TEST

/* The same number from the other side: a level of tiny spheres at the soup's points against a globe. */
START_TEST(distances_from_a_level_to_a_mesh_are_exact)
{
    enum { COUNT = 50 };
    float centers[3 * COUNT], radii[COUNT];
    double sum = 0, most = 0;
    uint64_t state = 5;
    sph_animation *globe = make_globe(ORIGIN, 1);
    sph_level *level;
    sph_distances d;
    for (int i = 0; i < COUNT; ++i) {
        double length = 0;
        for (int k = 0; k < 3; ++k) {
            centers[3 * i + k] = (float)(3 * test_random_unit(&state) - 1.5);
            length += (double)centers[3 * i + k] * centers[3 * i + k];
        }
        radii[i] = 0.001f;
        sum += fabs(sqrt(length) - 1);
        most = fmax(most, fabs(sqrt(length) - 1));
    }
    level = make_level(COUNT, centers, radii, 0, NULL, 0, NULL);
    d = measure(globe, level);
    ck_assert_double_eq_tol(d.mean21, sum / COUNT, 1e-3);
    ck_assert_double_eq_tol(d.max21, most, 2e-3);
    sph_level_destroy(level);
    sph_animation_destroy(globe);
}
END_TEST

START_TEST(a_mesh_measured_against_itself_is_at_distance_zero)
{
    sph_animation *torus = test_torus(context, 40, 20, 3);
    sph_distances d;
    ck_assert_int_eq(sph_measure_meshes(torus, torus, NULL, &d, NULL), SPH_OK);
    ck_assert_double_lt(d.hausdorff, 1e-7);
    ck_assert_double_eq(d.area1, d.area2);
    sph_animation_destroy(torus);
}
END_TEST

/* A globe moved by t: the nearest point of the other is along the line to its centre. */
START_TEST(globes_apart_have_the_distances_of_spheres_apart)
{
    const double t = 0.3, center[3] = {t, 0, 0};
    sph_animation *a = make_globe(ORIGIN, 1), *b = make_globe(center, 1);
    sph_distances d;
    double mean = 0;
    for (int i = 0; i < 100000; ++i) { /* | |x - t| - 1 | over the sphere: even in the height along t */
        const double z = -1 + (i + 0.5) / 50000;
        mean += fabs(sqrt(1 - 2 * t * z + t * t) - 1) / 100000;
    }
    ck_assert_int_eq(sph_measure_meshes(a, b, NULL, &d, NULL), SPH_OK);
    ck_assert_double_eq_tol(d.mean12, mean, 1e-3);
    ck_assert_double_eq_tol(d.mean21, mean, 1e-3);
    ck_assert_double_eq_tol(d.hausdorff, t, 1e-3);
    sph_animation_destroy(a);
    sph_animation_destroy(b);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("measure");
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, concentric_spheres_are_the_difference_of_radii_apart, 0, 4);
    tcase_add_loop_test(tc, distances_to_a_tapered_capsule_and_a_tilted_thick_triangle_are_exact, 0, 2);
    tcase_add_test(tc, distances_from_a_level_to_a_mesh_are_exact);
    tcase_add_test(tc, a_mesh_measured_against_itself_is_at_distance_zero);
    tcase_add_test(tc, globes_apart_have_the_distances_of_spheres_apart);
    return run_suite(suite, tc);
}
