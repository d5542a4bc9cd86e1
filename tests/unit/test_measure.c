/* SPDX-License-Identifier: MIT */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "runner.h"
#include "support.h"

static sph_context *context;

static void setup(void)
{
    context = test_context();
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

/* --- frames, threads, failures --- */

/* A level of `frames` frames over the vertices of a coarse torus, that moves as the torus does. */
static sph_level *make_torus_level(sph_context *of, sph_animation *torus)
{
    const uint32_t n = sph_animation_vertex_count(torus), frames = sph_animation_frame_count(torus);
    float *centers = test_malloc((size_t)frames * n * 3, sizeof *centers), *radii = test_malloc(n, sizeof *radii);
    sph_level_arrays arrays = {.struct_size = sizeof arrays, .sphere_count = n, .frame_count = frames};
    sph_level *level = NULL;
    for (uint32_t f = 0; f < frames; ++f)
        ck_assert_int_eq(sph_animation_read_frame(torus, f, centers + (size_t)f * 3 * n), SPH_OK);
    for (uint32_t i = 0; i < n; ++i)
        radii[i] = 0.02f;
    arrays.centers = centers;
    arrays.radii = radii;
    arrays.triangles = sph_animation_triangles(torus);
    arrays.triangle_count = sph_animation_triangle_count(torus);
    sph_level_create_from_arrays(of, &arrays, &level);
    free(centers);
    free(radii);
    return level;
}

static sph_status measure_torus(sph_context *of, uint32_t frames, sph_distances *mean, sph_distances *per_frame)
{
    sph_animation *torus = test_torus(of, 12, 6, frames);
    sph_level *level = torus == NULL ? NULL : make_torus_level(of, torus);
    sph_measure_options options;
    sph_status status = SPH_E_NOMEM;
    sph_measure_options_init(&options, sizeof options);
    options.samples = 500;
    if (level != NULL) status = sph_measure_level(torus, level, &options, mean, per_frame);
    sph_level_destroy(level);
    sph_animation_destroy(torus);
    return status;
}

START_TEST(results_are_the_same_for_any_threads_and_executor)
{
    const sph_executor executors[] = {test_executor_reverse(), test_executor_scattered(), test_executor_threads()};
    sph_distances expected = {0}, expected_frames[5], d = {0}, frames[5];
    sph_context *one = test_context_with_threads(1);
    ck_assert_int_eq(measure_torus(one, 5, &expected, expected_frames), SPH_OK);
    sph_context_destroy(one);
    for (int i = 0; i < 5; ++i) {
        sph_context *other = i < 3 ? test_context_with_executor(&executors[i]) : test_context_with_threads((uint32_t)i);
        ck_assert_int_eq(measure_torus(other, 5, &d, frames), SPH_OK);
        ck_assert_mem_eq(&d, &expected, sizeof d);
        ck_assert_mem_eq(frames, expected_frames, sizeof frames);
        sph_context_destroy(other);
    }
}
END_TEST

START_TEST(means_are_those_of_the_frames_and_frames_can_be_chosen)
{
    sph_animation *torus = test_torus(context, 12, 6, 5);
    sph_level *level = make_torus_level(context, torus);
    sph_measure_options options;
    sph_distances all[5], mean, some[2];
    double sum = 0;
    sph_measure_options_init(&options, sizeof options);
    options.samples = 500;
    ck_assert_int_eq(sph_measure_level(torus, level, &options, &mean, all), SPH_OK);
    for (int f = 0; f < 5; ++f) {
        sum += all[f].hausdorff / 5;
        ck_assert_double_eq(all[f].hausdorff, fmax(all[f].max12, all[f].max21));
        ck_assert_double_eq_tol(all[f].mean12, 0.02, 1e-3); /* half the shell's thickness; more below concave edges */
        ck_assert_double_ge(all[f].mean12, 0.02 - 1e-5);
        ck_assert_double_eq_tol(all[f].mean21, 0.02, 1e-5);
    }
    ck_assert_double_eq_tol(mean.hausdorff, sum, 1e-12);
    options.first_frame = 1;
    options.frame_step = 2;
    options.frame_limit = 2;
    ck_assert_int_eq(sph_measure_level(torus, level, &options, &mean, some), SPH_OK);
    ck_assert_mem_eq(&some[0], &all[1], sizeof some[0]);
    ck_assert_mem_eq(&some[1], &all[3], sizeof some[1]);
    sph_level_destroy(level);
    sph_animation_destroy(torus);
}
END_TEST

START_TEST(every_allocation_may_fail) /* _i: 0 = fail once, 1 = fail from there on */
{
    for (size_t n = 1;; ++n) {
        test_faulty faulty = {.fail_at = n, .sticky = _i != 0};
        const sph_allocator allocator = test_faulty_allocator(&faulty);
        const sph_distances untouched = {.hausdorff = -1};
        sph_distances d = untouched;
        sph_context *own = test_context_with_allocator(&allocator);
        const sph_status status = own == NULL ? SPH_E_NOMEM : measure_torus(own, 1, &d, NULL);
        sph_context_destroy(own);
        ck_assert_uint_eq(faulty.live_blocks, 0);
        ck_assert(!faulty.misused);
        if (faulty.calls < n) {
            ck_assert_int_eq(status, SPH_OK);
            ck_assert_uint_gt(n, 20);
            return;
        }
        ck_assert_int_eq(status, SPH_E_NOMEM);
        ck_assert_mem_eq(&d, &untouched, sizeof d);
    }
}
END_TEST

START_TEST(progress_rises_and_may_cancel_at_any_call)
{
    for (size_t n = 0;; ++n) {
        test_progress progress = {.cancel_at = n};
        sph_context *own = test_context_with_progress(test_progress_callback, &progress);
        sph_animation *torus = test_torus(own, 12, 6, 5);
        sph_distances d = {.hausdorff = -1};
        sph_status status;
        progress.calls = 0;
        progress.last = 0;
        status = sph_measure_meshes(torus, torus, NULL, &d, NULL);
        ck_assert(!progress.fell);
        if (status == SPH_OK) ck_assert_uint_gt(progress.calls, 1);
        ck_assert_int_eq(status, n == 0 || progress.calls < n ? SPH_OK : SPH_E_CANCELLED);
        if (status != SPH_OK) ck_assert_double_eq(d.hausdorff, -1);
        sph_animation_destroy(torus);
        sph_context_destroy(own);
        if (n > 0 && status == SPH_OK) return;
    }
}
END_TEST

static void refused(const sph_animation *animation, const sph_level *level, const sph_measure_options *options,
                    const char *part)
{
    sph_distances d = {.hausdorff = -1};
    ck_assert_int_eq(sph_measure_level(animation, level, options, &d, NULL), SPH_E_INVALID);
    ck_assert_msg(strstr(sph_context_last_message(context), part) != NULL, "message: %s",
                  sph_context_last_message(context));
    ck_assert_double_eq(d.hausdorff, -1);
}

START_TEST(what_cannot_be_measured_is_refused_with_a_reason)
{
    const float center[3] = {0}, radius = 1, bad[24] = {[4] = NAN};
    sph_animation *cube = test_cube(context, 1), *two = test_cube(context, 2), *bare = NULL;
    sph_level *level = make_level(1, center, &radius, 0, NULL, 0, NULL);
    sph_measure_options options;
    sph_distances d;
    ck_assert_int_eq(sph_animation_create(context, 1, 1, &bare), SPH_OK);
    refused(bare, level, NULL, "no triangles");
    refused(two, level, NULL, "2 frames, the level 1");
    sph_measure_options_init(&options, sizeof options);
    options.samples = 0;
    refused(cube, level, &options, "0 samples");
    sph_measure_options_init(&options, sizeof options);
    options.first_frame = 1;
    refused(cube, level, &options, "first_frame is 1");
    sph_measure_options_init(&options, sizeof options);
    options.frame_step = 0;
    refused(cube, level, &options, "frame_step");
    sph_measure_options_init(&options, sizeof options);
    options.flags = 1;
    refused(cube, level, &options, "flags");
    memset(&options, 0, sizeof options);
    refused(cube, level, &options, "not initialised");
    ck_assert_int_eq(sph_animation_set_frame(cube, 0, bad, 0), SPH_OK);
    refused(cube, level, NULL, "vertex 1");
    ck_assert_int_eq(sph_measure_level(NULL, level, NULL, &d, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_measure_level(cube, NULL, NULL, &d, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_measure_level(cube, level, NULL, NULL, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_measure_meshes(NULL, cube, NULL, &d, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_measure_meshes(cube, two, NULL, &d, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_measure_meshes(two, bare, NULL, &d, NULL), SPH_E_INVALID);
    sph_level_destroy(level);
    sph_animation_destroy(bare);
    sph_animation_destroy(two);
    sph_animation_destroy(cube);
}
END_TEST

static sph_status failing_frame(void *user, uint32_t frame, float *xyz)
{
    (void)frame;
    memset(xyz, 0, 9 * sizeof *xyz);
    return --*(int *)user < 0 ? SPH_E_IO : SPH_OK;
}

START_TEST(a_failing_frame_source_ends_the_measure_with_its_status)
{
    const float center[9] = {0}, radius = 1;
    const uint32_t triangle[3] = {0, 1, 2};
    const sph_level_arrays arrays = {
        .struct_size = sizeof arrays, .sphere_count = 1, .frame_count = 3, .centers = center, .radii = &radius};
    for (int good = 0; good <= 4; ++good) {
        int left = good;
        const sph_frame_source source = {&left, failing_frame, NULL};
        sph_animation *animation = NULL;
        sph_level *level = NULL;
        sph_distances d;
        ck_assert_int_eq(sph_animation_create_from_source(context, 3, 3, &source, &animation), SPH_OK);
        ck_assert_int_eq(sph_animation_set_triangles(animation, triangle, 1, 0), SPH_OK);
        ck_assert_int_eq(sph_level_create_from_arrays(context, &arrays, &level), SPH_OK);
        ck_assert_int_eq(sph_measure_level(animation, level, NULL, &d, NULL), good < 4 ? SPH_E_IO : SPH_OK);
        if (good == 4) ck_assert_double_eq_tol(d.mean12, 1, 1e-5); /* a triangle of no area at the centre */
        sph_level_destroy(level);
        sph_animation_destroy(animation);
    }
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
    tcase_add_test(tc, results_are_the_same_for_any_threads_and_executor);
    tcase_add_test(tc, means_are_those_of_the_frames_and_frames_can_be_chosen);
    tcase_add_loop_test(tc, every_allocation_may_fail, 0, 2);
    tcase_add_test(tc, progress_rises_and_may_cancel_at_any_call);
    tcase_add_test(tc, what_cannot_be_measured_is_refused_with_a_reason);
    tcase_add_test(tc, a_failing_frame_source_ends_the_measure_with_its_status);
    return run_suite(suite, tc);
}
