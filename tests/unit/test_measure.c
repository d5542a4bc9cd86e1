/* SPDX-License-Identifier: MIT */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <sphmesh/measure.h>

static sph_context *context;

static void setup(void)
{
    ck_assert_int_eq(sph_context_create(NULL, &context), SPH_OK);
}

static void teardown(void)
{
    sph_context_destroy(context);
}

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

static sph_level *make_level(uint32_t spheres, const float *centers, const float *radii, size_t edge_count,
                             const uint32_t *edges, size_t triangle_count, const uint32_t *triangles)
{
    const sph_level_arrays arrays = {.struct_size = sizeof arrays,
                                     .sphere_count = spheres,
                                     .frame_count = 1,
                                     .centers = centers,
                                     .radii = radii,
                                     .edge_count = edge_count,
                                     .edges = edges,
                                     .triangle_count = triangle_count,
                                     .triangles = triangles};
    sph_level *level = NULL;
    ck_assert_int_eq(sph_level_create_from_arrays(context, &arrays, &level), SPH_OK);
    return level;
}

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

int main(void)
{
    Suite *suite = suite_create("measure");
    TCase *tc = tcase_create("all");
    SRunner *runner;
    int failed;
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, concentric_spheres_are_the_difference_of_radii_apart, 0, 4);
    suite_add_tcase(suite, tc);
    runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
