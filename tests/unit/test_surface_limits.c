/* SPDX-License-Identifier: MIT */
#include <check.h>
#include <math.h>
#include <string.h>

#include "faults.h"
#include "runner.h"
#include "support.h"
#include "surface_shapes.h"

static sph_context *context;

static void setup(void)
{
    context = test_context();
}

static void teardown(void)
{
    sph_context_destroy(context);
}

static void same_surface(const sph_surface *a, uint32_t i, const sph_surface *b, uint32_t j)
{
    const size_t n = sph_surface_vertex_count(a, i), m = sph_surface_triangle_count(a, i);
    ck_assert_uint_gt(n, 0);
    ck_assert_uint_eq(n, sph_surface_vertex_count(b, j));
    ck_assert_uint_eq(m, sph_surface_triangle_count(b, j));
    ck_assert_mem_eq(sph_surface_positions(a, i), sph_surface_positions(b, j), 12 * n);
    ck_assert_mem_eq(sph_surface_normals(a, i), sph_surface_normals(b, j), 12 * n);
    ck_assert_mem_eq(sph_surface_triangles(a, i), sph_surface_triangles(b, j), 12 * m);
}

/* A star whose branches move: in frame 2 they touch. */
static sph_level *make_moving(sph_context *of)
{
    shape s = {0};
    float centers[3 * 3 * MOST_SPHERES];
    sph_level_arrays arrays = {.struct_size = sizeof arrays, .frame_count = 3, .centers = centers};
    sph_level *level = NULL;
    add_star(&s, 5, 0.1);
    for (uint32_t f = 0; f < 3; ++f)
        for (uint32_t i = 0; i < 3 * s.spheres; ++i)
            centers[3 * s.spheres * f + i] = s.centers[i] * (1 + 0.1f * (float)(f * (i % 4)));
    arrays.sphere_count = s.spheres;
    arrays.radii = s.radii;
    arrays.edge_count = s.edges;
    arrays.edges = s.edge;
    sph_level_create_from_arrays(of, &arrays, &level);
    return level;
}

static sph_status extract_moving(sph_context *of, sph_surface **out)
{
    sph_surface_options o;
    sph_level *level = make_moving(of);
    sph_status status = SPH_E_NOMEM;
    sph_surface_options_init(&o, sizeof o);
    o.resolution = 20;
    *out = NULL;
    if (level != NULL) status = sph_surface_create(level, &o, out);
    sph_level_destroy(level);
    return status;
}

START_TEST(surfaces_are_the_same_for_any_threads_and_executor)
{
    const sph_executor executors[] = {test_executor_reverse(), test_executor_scattered(), test_executor_threads()};
    sph_context *one = test_context_with_threads(1);
    sph_surface *expected, *surface;
    ck_assert_int_eq(extract_moving(one, &expected), SPH_OK);
    sph_context_destroy(one); /* the surface keeps it */
    for (int i = 0; i < 5; ++i) {
        sph_context *other = i < 3 ? test_context_with_executor(&executors[i]) : test_context_with_threads((uint32_t)i);
        ck_assert_int_eq(extract_moving(other, &surface), SPH_OK);
        for (uint32_t f = 0; f < 3; ++f)
            same_surface(surface, f, expected, f);
        sph_surface_destroy(surface);
        sph_context_destroy(other);
    }
    sph_surface_destroy(expected);
}
END_TEST

START_TEST(a_frame_is_the_same_alone_and_in_a_sequence)
{
    sph_level *level = make_moving(context);
    sph_surface *all = NULL, *some = NULL;
    sph_surface_options o;
    sph_surface_options_init(&o, sizeof o);
    o.resolution = 20;
    ck_assert_int_eq(sph_surface_create(level, &o, &all), SPH_OK);
    ck_assert_uint_eq(sph_surface_frame_count(all), 3);
    o.first_frame = 1;
    o.frame_limit = 1;
    ck_assert_int_eq(sph_surface_create(level, &o, &some), SPH_OK);
    ck_assert_uint_eq(sph_surface_frame_count(some), 1);
    same_surface(some, 0, all, 1);
    sph_surface_destroy(some);
    o = (sph_surface_options){o.struct_size, 0, 20, 0, 2, 0, o.memory_limit};
    ck_assert_int_eq(sph_surface_create(level, &o, &some), SPH_OK);
    ck_assert_uint_eq(sph_surface_frame_count(some), 2);
    same_surface(some, 1, all, 2);
    ck_assert_double_eq(sph_surface_cell(some), sph_surface_cell(all));
    sph_surface_destroy(some);
    sph_surface_destroy(all);
    sph_level_destroy(level);
}
END_TEST

static sph_status extract_and_destroy(sph_context *own, const void *user)
{
    sph_surface *surface = NULL;
    const sph_status status = extract_moving(own, &surface);
    (void)user;
    ck_assert((status == SPH_OK) == (surface != NULL));
    sph_surface_destroy(surface);
    return status;
}

START_TEST(every_allocation_may_fail)
{
    check_every_allocation((test_faults){.work = extract_and_destroy, .least = 20, .sticky = _i});
}
END_TEST

START_TEST(progress_rises_and_may_cancel_at_any_call)
{
    check_every_cancel((test_faults){.work = extract_and_destroy, .least = 11});
}
END_TEST

START_TEST(memory_stays_within_its_limit)
{
    shape s;
    sph_surface_options o;
    test_faulty faulty = {0};
    const sph_allocator allocator = test_faulty_allocator(&faulty);
    sph_context *own = test_context_with_allocator(&allocator);
    sph_level *level;
    uint64_t limit = 1000;
    sph_status status = SPH_E_LIMIT;
    make_shape(STAR, &s);
    level = make_level(own, &s);
    sph_surface_options_init(&o, sizeof o);
    o.resolution = 30;
    for (; status != SPH_OK; limit += limit / 4) {
        sph_surface *surface;
        const size_t before = faulty.live_bytes;
        faulty.peak_bytes = before;
        o.memory_limit = limit;
        status = sph_surface_create(level, &o, &surface);
        ck_assert(status == SPH_OK || status == SPH_E_LIMIT);
        ck_assert((status == SPH_OK) == (surface != NULL));
        /* what depends on the level alone is not counted */
        ck_assert_uint_lt(faulty.peak_bytes - before, limit + 50000);
        sph_surface_destroy(surface);
    }
    ck_assert_uint_gt(limit, 100000);
    sph_level_destroy(level);
    sph_context_destroy(own);
    ck_assert_uint_eq(faulty.live_blocks, 0);
}
END_TEST

static void refused(const sph_level *level, const sph_surface_options *o, sph_status expected, const char *part)
{
    sph_surface *surface = NULL;
    ck_assert_int_eq(sph_surface_create(level, o, &surface), expected);
    ck_assert_ptr_null(surface);
    ck_assert_msg(strstr(sph_context_last_message(context), part) != NULL, "message: %s",
                  sph_context_last_message(context));
}

START_TEST(what_cannot_be_extracted_is_refused_with_a_reason)
{
    shape s;
    sph_level *level, *huge;
    sph_surface_options o;
    sph_surface *surface;
    make_shape(SPHERE, &s);
    level = make_level(context, &s);
    s.radii[0] = 2e38f;
    huge = make_level(context, &s);
    sph_surface_options_init(&o, sizeof o);
    o.resolution = 0;
    refused(level, &o, SPH_E_INVALID, "0 cells");
    o.resolution = 4097;
    refused(level, &o, SPH_E_INVALID, "4097");
    sph_surface_options_init(&o, sizeof o);
    o.first_frame = 1;
    refused(level, &o, SPH_E_INVALID, "first_frame is 1");
    sph_surface_options_init(&o, sizeof o);
    o.frame_step = 0;
    refused(level, &o, SPH_E_INVALID, "frame_step");
    sph_surface_options_init(&o, sizeof o);
    o.flags = 1;
    refused(level, &o, SPH_E_INVALID, "flags");
    memset(&o, 0, sizeof o);
    refused(level, &o, SPH_E_INVALID, "not initialised");
    refused(huge, NULL, SPH_E_LIMIT, "too far");
    ck_assert_int_eq(sph_surface_create(NULL, NULL, &surface), SPH_E_INVALID);
    ck_assert_int_eq(sph_surface_create(level, NULL, NULL), SPH_E_INVALID);
    sph_surface_destroy(NULL);
    sph_level_destroy(level);
    sph_level_destroy(huge);
}
END_TEST

START_TEST(getters_take_null_and_any_index)
{
    shape s;
    sph_surface *surface;
    make_shape(SPHERE, &s);
    surface = extract(context, &s, 4);
    ck_assert_uint_eq(sph_surface_frame_count(NULL), 0);
    ck_assert_double_eq(sph_surface_cell(NULL), 0);
    ck_assert_double_eq(sph_surface_cell(surface), 0.5);
    for (int i = 0; i < 2; ++i) {
        const sph_surface *of = i == 0 ? NULL : surface;
        ck_assert_uint_eq(sph_surface_vertex_count(of, 1), 0);
        ck_assert_uint_eq(sph_surface_triangle_count(of, 1), 0);
        ck_assert_ptr_null(sph_surface_positions(of, 1));
        ck_assert_ptr_null(sph_surface_normals(of, 1));
        ck_assert_ptr_null(sph_surface_triangles(of, 1));
    }
    sph_surface_destroy(surface);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("surface_limits");
    TCase *limits = tcase_create("limits");
    tcase_add_checked_fixture(limits, setup, teardown);
    tcase_add_test(limits, surfaces_are_the_same_for_any_threads_and_executor);
    tcase_add_test(limits, a_frame_is_the_same_alone_and_in_a_sequence);
    tcase_add_loop_test(limits, every_allocation_may_fail, 0, 2);
    tcase_add_test(limits, progress_rises_and_may_cancel_at_any_call);
    tcase_add_test(limits, memory_stays_within_its_limit);
    tcase_add_test(limits, what_cannot_be_extracted_is_refused_with_a_reason);
    tcase_add_test(limits, getters_take_null_and_any_index);
    suite_add_tcase(suite, limits);
    return run_all(suite);
}
