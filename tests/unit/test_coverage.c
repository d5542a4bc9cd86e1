/* SPDX-License-Identifier: MIT */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "runner.h"
#include "solid.h"
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

/* --- animations of given points --- */

static sph_animation *points(sph_context *of, const float *xyz, uint32_t count, uint32_t frames)
{
    sph_animation *animation = NULL;
    if (sph_animation_create(of, count, frames, &animation) != SPH_OK) return NULL;
    for (uint32_t f = 0; f < frames; ++f)
        sph_animation_set_frame(animation, f, xyz + 3 * (size_t)count * f, 0);
    return animation;
}

static sph_coverage measure(const sph_animation *animation, const sph_level *level)
{
    sph_coverage c = {.struct_size = sizeof c};
    ck_assert_msg(sph_coverage_measure(animation, level, &c) == SPH_OK, "%s", sph_context_last_message(context));
    return c;
}

static sph_level *inflate(const sph_animation *animation, const sph_level *level, double margin, sph_inflation *out)
{
    sph_inflation_options o;
    sph_level *inflated = NULL;
    sph_inflation_options_init(&o, sizeof o);
    o.margin = margin;
    *out = (sph_inflation){.struct_size = sizeof *out};
    ck_assert_msg(sph_coverage_inflate(animation, level, &o, out, &inflated) == SPH_OK, "%s",
                  sph_context_last_message(context));
    return inflated;
}

static sph_level_arrays arrays_of(const sph_level *level)
{
    sph_level_arrays a = {.struct_size = sizeof a};
    ck_assert_int_eq(sph_level_get_arrays(level, &a), SPH_OK);
    return a;
}

/* --- the largest uncovered distance --- */

/* A ball, a capsule along x, and a thick triangle in the plane z = 0, each of radius 1/2. */
static const test_solid SOLIDS[3] = {
    {.sphere_count = 1, .centers = {{1, 2, 3}}, .radii = {0.5f}},
    {.sphere_count = 2, .centers = {{0, 0, 0}, {2, 0, 0}}, .radii = {0.5f, 0.5f}, .edge_count = 1, .edges = {{0, 1}}},
    {.sphere_count = 3,
     .centers = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}},
     .radii = {0.5f, 0.5f, 0.5f},
     .triangle_count = 1,
     .triangles = {{0, 1, 2}}}};
/* Points, and how far they are outside. */
static const float OUTSIDE[3][3][4] = {{{1, 2, 5, 1.5f}, {2, 2, 3, 0.5f}, {1, 2, 3.25f, 0}},
                                       {{1, 2, 0, 1.5f}, {-1, 0, 0, 0.5f}, {1.5f, 0.25f, 0, 0}},
                                       {{0.5f, 0.5f, 2, 1.5f}, {0.5f, -1, 0, 0.5f}, {0.5f, 0.5f, -0.4375f, 0}}};

START_TEST(the_uncovered_distance_is_that_of_the_closed_form)
{
    sph_level *level = test_solid_level(context, &SOLIDS[_i]);
    for (int i = 0; i < 3; ++i) {
        const float *p = OUTSIDE[_i][i];
        sph_animation *animation = points(context, p, 1, 1);
        const sph_coverage c = measure(animation, level);
        ck_assert_double_eq_tol(c.distance, p[3], 1e-13);
        ck_assert_uint_eq(c.uncovered_count, p[3] > 0);
        sph_animation_destroy(animation);
    }
    sph_level_destroy(level);
}
END_TEST

static test_solid random_solid(uint64_t *state)
{
    test_solid s = {.sphere_count = 9, .edge_count = 5, .triangle_count = 4};
    for (uint32_t i = 0; i < s.sphere_count; ++i) {
        const double r = test_random_unit(state);
        for (int k = 0; k < 3; ++k)
            s.centers[i][k] = (float)test_random_unit(state);
        s.radii[i] = (float)(r < 0.3 ? 0 : 0.3 * r * r);
    }
    for (uint32_t i = 0; i < s.edge_count; ++i)
        for (int k = 0; k < 2; ++k)
            s.edges[i][k] = (uint32_t)(test_random(state) % 9);
    for (uint32_t i = 0; i < s.triangle_count; ++i)
        for (int k = 0; k < 3; ++k)
            s.triangles[i][k] = (uint32_t)(test_random(state) % 9);
    return s;
}

enum { POINTS = 40, FRAMES = 3 };

static void random_points(uint64_t *state, float *xyz, size_t count)
{
    for (size_t i = 0; i < 3 * count; ++i)
        xyz[i] = (float)(1.4 * test_random_unit(state) - 0.2);
}

/* The same solid in all frames. */
static sph_level *still_level(sph_context *of, const test_solid *s, uint32_t frames, uint32_t per_frame)
{
    float centers[FRAMES * TEST_SOLID_SPHERES * 3], radii[FRAMES * TEST_SOLID_SPHERES];
    const sph_level_arrays a = {.struct_size = sizeof a,
                                .sphere_count = s->sphere_count,
                                .frame_count = frames,
                                .radii_per_frame = per_frame,
                                .centers = centers,
                                .radii = radii,
                                .edge_count = s->edge_count,
                                .edges = s->edges[0],
                                .triangle_count = s->triangle_count,
                                .triangles = s->triangles[0]};
    sph_level *level = NULL;
    for (uint32_t f = 0; f < frames; ++f) {
        memcpy(centers + 3 * (size_t)f * s->sphere_count, s->centers, 12 * (size_t)s->sphere_count);
        memcpy(radii + (size_t)f * s->sphere_count, s->radii, 4 * (size_t)s->sphere_count);
    }
    sph_level_create_from_arrays(of, &a, &level);
    return level;
}

START_TEST(the_uncovered_distance_is_that_of_brute_force)
{
    uint64_t state = 1 + (uint64_t)_i;
    const test_solid s = random_solid(&state);
    float xyz[3 * POINTS * FRAMES];
    double largest = 0;
    uint32_t count = 0, doubtful = 0;
    sph_animation *animation;
    sph_level *level = still_level(context, &s, FRAMES, 0);
    sph_coverage c;
    random_points(&state, xyz, POINTS * FRAMES);
    animation = points(context, xyz, POINTS, FRAMES);
    c = measure(animation, level);
    for (size_t i = 0; i < POINTS * FRAMES; ++i) {
        const double x[3] = {xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]}, d = test_solid_distance(&s, x);
        if (i == c.frame * POINTS + c.vertex) ck_assert_double_eq_tol(fmax(d, 0), c.distance, 1e-7);
        largest = fmax(largest, d);
        count += d > 1e-7;
        doubtful += fabs(d) <= 1e-7;
    }
    ck_assert_double_eq_tol(c.distance, largest, 1e-7);
    ck_assert_uint_ge(c.uncovered_count, count);
    ck_assert_uint_le(c.uncovered_count, count + doubtful);
    sph_animation_destroy(animation);
    sph_level_destroy(level);
}
END_TEST

/* Spheres of no radius at the vertices contain them, without any tolerance. */
START_TEST(the_finest_level_contains_its_vertices_and_does_not_grow)
{
    sph_animation *animation = test_sphere(context, 2, 4);
    sph_hierarchy *hierarchy = NULL;
    sph_level *level = NULL, *inflated;
    sph_inflation i;
    sph_coverage c;
    ck_assert_int_eq(sph_hierarchy_create(animation, NULL, &hierarchy), SPH_OK);
    ck_assert_int_eq(sph_level_create(hierarchy, sph_animation_vertex_count(animation), &level), SPH_OK);
    c = measure(animation, level);
    ck_assert_double_eq(c.distance, 0);
    ck_assert_uint_eq(c.uncovered_count, 0);
    inflated = inflate(animation, level, 0, &i);
    ck_assert_uint_eq(i.grown_count, 0);
    ck_assert_uint_eq(i.rounds, 1);
    ck_assert_mem_eq(arrays_of(inflated).radii, arrays_of(level).radii,
                     4 * (size_t)sph_animation_vertex_count(animation));
    sph_level_destroy(inflated);
    sph_level_destroy(level);
    sph_hierarchy_destroy(hierarchy);
    sph_animation_destroy(animation);
}
END_TEST

/* --- inflation --- */

START_TEST(a_ball_grows_to_its_farthest_vertex)
{
    static const float xyz[] = {0, 0, 1.5f, 0.3f, 0, 0, 0, -1.25f, 0};
    const test_solid ball = {.sphere_count = 1, .radii = {1}};
    sph_animation *animation = points(context, xyz, 3, 1);
    sph_level *level = test_solid_level(context, &ball), *inflated;
    for (int i = 0; i < 2; ++i) {
        const double margin = 0.1 * i;
        sph_inflation n;
        float r;
        inflated = inflate(animation, level, margin, &n);
        r = arrays_of(inflated).radii[0];
        ck_assert_double_ge(r, 1.5 + margin);
        ck_assert_double_le(r, 1.5002 + margin);
        ck_assert_uint_eq(n.grown_count, 1);
        ck_assert_double_eq_tol(n.max_growth, r - 1.0, 1e-12);
        ck_assert_double_eq_tol(n.mean_growth, r - 1.0, 1e-12);
        ck_assert_double_eq_tol(n.volume_before, 4 * M_PI / 3, 0.1);
        ck_assert_double_eq_tol(n.volume_after, 4 * M_PI / 3 * pow(r, 3), 0.2);
        sph_level_destroy(inflated);
    }
    sph_level_destroy(level);
    sph_animation_destroy(animation);
}
END_TEST

/* Only what is concerned grows, and by equal parts where a vertex is over the middle. */
START_TEST(growth_is_least_and_local)
{
    static const float xyz[] = {1, 0, 0.7f, 9, 0, 0.4f};
    const test_solid chain = {.sphere_count = 4,
                              .centers = {{0, 0, 0}, {2, 0, 0}, {8, 0, 0}, {10, 0, 0}},
                              .radii = {0.5f, 0.5f, 0.5f, 0.5f},
                              .edge_count = 2,
                              .edges = {{0, 1}, {2, 3}}};
    sph_animation *animation = points(context, xyz, 2, 1);
    sph_level *level = test_solid_level(context, &chain);
    sph_inflation n;
    sph_level *inflated = inflate(animation, level, 0, &n);
    const float *r = arrays_of(inflated).radii;
    ck_assert_double_eq_tol(r[0], 0.7, 5e-4);
    ck_assert_double_eq_tol(r[1], 0.7, 5e-4);
    ck_assert_float_eq(r[2], 0.5f);
    ck_assert_float_eq(r[3], 0.5f);
    ck_assert_uint_eq(n.grown_count, 2);
    sph_level_destroy(inflated);
    sph_level_destroy(level);
    sph_animation_destroy(animation);
}
END_TEST

static void check_contains(const sph_level *level, const test_solid *original, const float *xyz, double margin)
{
    const sph_level_arrays a = arrays_of(level);
    for (size_t f = 0; f < a.frame_count; ++f) {
        test_solid s = *original;
        for (size_t i = 0; i < s.sphere_count; ++i) {
            s.radii[i] = a.radii[i + (a.radii_per_frame ? f * s.sphere_count : 0)];
            ck_assert_float_ge(s.radii[i], original->radii[i]);
        }
        for (size_t i = 0; i < POINTS; ++i) {
            const float *p = xyz + 3 * (f * POINTS + i);
            const double x[3] = {p[0], p[1], p[2]};
            ck_assert_double_le(test_solid_distance(&s, x), 1e-8 - margin);
        }
    }
}

START_TEST(inflated_levels_contain_every_vertex_by_brute_force)
{
    const uint32_t per_frame = _i % 2;
    const double margin = _i % 3 == 0 ? 0.01 : 0;
    uint64_t state = 50 + (uint64_t)_i;
    const test_solid s = random_solid(&state);
    float xyz[3 * POINTS * FRAMES];
    sph_animation *animation;
    sph_level *level = still_level(context, &s, FRAMES, per_frame), *inflated;
    sph_inflation n;
    sph_coverage before;
    random_points(&state, xyz, POINTS * FRAMES);
    animation = points(context, xyz, POINTS, FRAMES);
    before = measure(animation, level);
    inflated = inflate(animation, level, margin, &n);
    check_contains(inflated, &s, xyz, margin);
    ck_assert_uint_eq(measure(animation, inflated).uncovered_count, 0);
    ck_assert_double_eq(measure(animation, inflated).distance, 0);
    ck_assert_uint_eq(arrays_of(inflated).radii_per_frame, per_frame);
    ck_assert_mem_eq(arrays_of(inflated).centers, arrays_of(level).centers, 12 * (size_t)FRAMES * s.sphere_count);
    ck_assert_mem_eq(arrays_of(inflated).triangles, arrays_of(level).triangles, 12 * (size_t)s.triangle_count);
    /* growing all radii by the uncovered distance would do too: this must be less in sum */
    ck_assert_double_le(n.mean_growth, before.distance + margin + 1e-3);
    ck_assert_double_ge(n.max_growth, 0);
    sph_level_destroy(inflated);
    sph_level_destroy(level);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(without_rounds_it_still_contains_every_vertex)
{
    uint64_t state = 99;
    const test_solid s = random_solid(&state);
    float xyz[3 * POINTS * FRAMES];
    sph_inflation_options o;
    sph_animation *animation;
    sph_level *level = still_level(context, &s, FRAMES, 0), *inflated = NULL, *least;
    sph_inflation quick = {.struct_size = sizeof quick}, slow;
    random_points(&state, xyz, POINTS * FRAMES);
    animation = points(context, xyz, POINTS, FRAMES);
    sph_inflation_options_init(&o, sizeof o);
    o.rounds = 0;
    ck_assert_int_eq(sph_coverage_inflate(animation, level, &o, &quick, &inflated), SPH_OK);
    check_contains(inflated, &s, xyz, 0);
    least = inflate(animation, level, 0, &slow);
    ck_assert_double_lt(slow.mean_growth, quick.mean_growth);
    sph_level_destroy(least);
    sph_level_destroy(inflated);
    sph_level_destroy(level);
    sph_animation_destroy(animation);
}
END_TEST

/* --- what every call keeps to --- */

static sph_status work(sph_context *of, sph_level **out)
{
    uint64_t state = 7;
    const test_solid s = random_solid(&state);
    float xyz[3 * POINTS * FRAMES];
    sph_level *level = still_level(of, &s, FRAMES, 0);
    sph_animation *animation;
    sph_coverage c = {.struct_size = sizeof c};
    sph_inflation n = {.struct_size = sizeof n};
    sph_status status = SPH_E_NOMEM;
    random_points(&state, xyz, POINTS * FRAMES);
    animation = points(of, xyz, POINTS, FRAMES);
    *out = NULL;
    if (level != NULL && animation != NULL) status = sph_coverage_measure(animation, level, &c);
    if (status == SPH_OK) status = sph_coverage_inflate(animation, level, NULL, &n, out);
    sph_animation_destroy(animation);
    sph_level_destroy(level);
    return status;
}

START_TEST(the_result_is_the_same_for_any_threads_and_executor)
{
    const sph_executor executors[] = {test_executor_reverse(), test_executor_scattered(), test_executor_threads()};
    sph_context *one = test_context_with_threads(1);
    sph_level *expected, *level;
    ck_assert_int_eq(work(one, &expected), SPH_OK);
    sph_context_destroy(one); /* the level keeps it */
    for (int i = 0; i < 5; ++i) {
        sph_context *other = i < 3 ? test_context_with_executor(&executors[i]) : test_context_with_threads((uint32_t)i);
        ck_assert_int_eq(work(other, &level), SPH_OK);
        ck_assert_mem_eq(arrays_of(level).radii, arrays_of(expected).radii, 4 * (size_t)arrays_of(level).sphere_count);
        sph_level_destroy(level);
        sph_context_destroy(other);
    }
    sph_level_destroy(expected);
}
END_TEST

START_TEST(every_allocation_may_fail)
{
    for (size_t n = 1;; ++n) {
        test_faulty faulty = {.fail_at = n, .sticky = _i};
        const sph_allocator allocator = test_faulty_allocator(&faulty);
        sph_context *own = test_context_with_allocator(&allocator);
        sph_level *level = NULL;
        const sph_status status = own == NULL ? SPH_E_NOMEM : work(own, &level);
        ck_assert((status == SPH_OK) == (level != NULL));
        sph_level_destroy(level);
        sph_context_destroy(own);
        ck_assert_uint_eq(faulty.live_blocks, 0);
        ck_assert(!faulty.misused);
        if (faulty.calls < n) {
            ck_assert_int_eq(status, SPH_OK);
            ck_assert_uint_gt(n, 20);
            return;
        }
        ck_assert_int_eq(status, SPH_E_NOMEM);
    }
}
END_TEST

START_TEST(progress_may_cancel_at_any_call)
{
    for (size_t n = 0;; ++n) {
        test_progress progress = {.cancel_at = n};
        sph_context *own = test_context_with_progress(test_progress_callback, &progress);
        sph_level *level;
        const sph_status status = work(own, &level);
        if (status == SPH_OK) ck_assert_uint_gt(progress.calls, 3);
        ck_assert_int_eq(status, n == 0 || progress.calls < n ? SPH_OK : SPH_E_CANCELLED);
        sph_level_destroy(level);
        sph_context_destroy(own);
        if (n > 0 && status == SPH_OK) return;
    }
}
END_TEST

static void refused(sph_status status, sph_status expected, const char *part)
{
    ck_assert_int_eq(status, expected);
    ck_assert_msg(strstr(sph_context_last_message(context), part) != NULL, "message: %s",
                  sph_context_last_message(context));
}

START_TEST(what_is_wrong_is_refused_with_a_reason)
{
    float xyz[6] = {3e38f, 3e38f, 3e38f, 0, NAN, 0};
    sph_animation *far = points(context, xyz, 1, 1), *two = points(context, xyz, 1, 2), *bad = points(context, xyz, 2, 1);
    sph_level *level = test_solid_level(context, &SOLIDS[0]), *out = level;
    sph_coverage c = {.struct_size = sizeof c};
    sph_inflation_options o;
    refused(sph_coverage_measure(two, level, &c), SPH_E_INVALID, "2 frames, the level 1");
    refused(sph_coverage_measure(bad, level, &c), SPH_E_INVALID, "vertex 1");
    refused(sph_coverage_measure(far, NULL, &c), SPH_E_INVALID, "NULL");
    refused(sph_coverage_measure(far, level, NULL), SPH_E_INVALID, "sph_coverage");
    c.struct_size = 3;
    refused(sph_coverage_measure(far, level, &c), SPH_E_INVALID, "struct_size");
    ck_assert_int_eq(sph_coverage_measure(NULL, level, &c), SPH_E_INVALID);
    sph_inflation_options_init(&o, sizeof o);
    refused(sph_coverage_inflate(far, level, &o, NULL, &out), SPH_E_LIMIT, "would need a radius of");
    ck_assert_ptr_null(out);
    refused(sph_coverage_inflate(far, level, &o, NULL, NULL), SPH_E_INVALID, "no place");
    o.margin = NAN;
    refused(sph_coverage_inflate(far, level, &o, NULL, &out), SPH_E_INVALID, "margin");
    o.margin = -1;
    refused(sph_coverage_inflate(far, level, &o, NULL, &out), SPH_E_INVALID, "margin");
    sph_inflation_options_init(&o, sizeof o);
    o.rounds = 1001;
    refused(sph_coverage_inflate(far, level, &o, NULL, &out), SPH_E_INVALID, "1001");
    memset(&o, 0, sizeof o);
    refused(sph_coverage_inflate(far, level, &o, NULL, &out), SPH_E_INVALID, "not initialised");
    sph_level_destroy(level);
    sph_animation_destroy(far);
    sph_animation_destroy(two);
    sph_animation_destroy(bad);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("coverage");
    TCase *tests = tcase_create("coverage");
    tcase_add_checked_fixture(tests, setup, teardown);
    tcase_add_loop_test(tests, the_uncovered_distance_is_that_of_the_closed_form, 0, 3);
    tcase_add_loop_test(tests, the_uncovered_distance_is_that_of_brute_force, 0, 8);
    tcase_add_test(tests, the_finest_level_contains_its_vertices_and_does_not_grow);
    tcase_add_test(tests, a_ball_grows_to_its_farthest_vertex);
    tcase_add_test(tests, growth_is_least_and_local);
    tcase_add_loop_test(tests, inflated_levels_contain_every_vertex_by_brute_force, 0, 8);
    tcase_add_test(tests, without_rounds_it_still_contains_every_vertex);
    tcase_add_test(tests, the_result_is_the_same_for_any_threads_and_executor);
    tcase_add_loop_test(tests, every_allocation_may_fail, 0, 2);
    tcase_add_test(tests, progress_may_cancel_at_any_call);
    tcase_add_test(tests, what_is_wrong_is_refused_with_a_reason);
    suite_add_tcase(suite, tests);
    return run_all(suite);
}
