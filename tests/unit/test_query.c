/* SPDX-License-Identifier: MIT */
/* The handle and its poses. */
#include <check.h>
#include <float.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "faults.h"
#include "runner.h"
#include "solid.h"
#include "support.h"

static sph_context *context;
static sph_level *level;

/* Two frames of three spheres: a triangle, and a wire edge to a fourth. */
static const float CENTERS[2][4][3] = {{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {5, 0, 0}},
                                       {{0, 0, 1}, {2, 0, 3}, {0, 2, 5}, {5, 8, 0}}};
static const float RADII[2][4] = {{0.5f, 0.25f, 0.5f, 1}, {1, 0.5f, 0.25f, 2}};
static const uint32_t EDGE[2] = {3, 1}, TRIANGLE[3] = {2, 0, 1};

static sph_level *make_level(sph_context *from, uint32_t radii_per_frame)
{
    const sph_level_arrays arrays = {sizeof arrays, 4, 2,   radii_per_frame, CENTERS[0][0], RADII[0], 1, EDGE, 1,
                                     TRIANGLE,      0, NULL};
    sph_level *out = NULL;
    sph_level_create_from_arrays(from, &arrays, &out);
    return out;
}

static void setup(void)
{
    context = test_context();
    level = make_level(context, 0);
}

static void teardown(void)
{
    sph_level_destroy(level);
    sph_context_destroy(context);
}

static sph_query *make_query(const sph_level *of)
{
    sph_query *q = NULL;
    ck_assert_int_eq(sph_query_create(of, NULL, &q), SPH_OK);
    return q;
}

static sph_nearest ask(const sph_query *q, float x, float y, float z)
{
    const float point[3] = {x, y, z};
    sph_nearest n;
    ck_assert_int_eq(sph_query_nearest(q, point, 0, 1, &n), SPH_OK);
    return n;
}

START_TEST(a_new_handle_is_posed_at_frame_0_and_outlives_level_and_context)
{
    sph_context *own = test_context();
    sph_level *of = make_level(own, 0);
    sph_query *q = make_query(of);
    sph_level_destroy(of);
    sph_context_destroy(own);
    ck_assert_double_eq_tol(ask(q, 0, 0, -3).distance, 2.5, 1e-12);
    sph_query_destroy(q);
    sph_query_destroy(NULL);
}
END_TEST

START_TEST(contacts_name_spheres_in_the_order_in_which_the_level_lists_them)
{
    sph_query *q = make_query(level);
    sph_nearest n = ask(q, 5, 0, -9);
    ck_assert_uint_eq(n.contact.kind, SPH_SIMPLEX_EDGE);
    ck_assert_uint_eq(n.contact.simplex, 0);
    ck_assert_mem_eq(n.contact.spheres, EDGE, sizeof EDGE);
    ck_assert_uint_eq(n.contact.spheres[2], SPH_NO_SPHERE);
    ck_assert_double_eq_tol(n.contact.weights[0], 1, 0.2);
    n = ask(q, -1, 3, 0);
    ck_assert_uint_eq(n.contact.kind, SPH_SIMPLEX_TRIANGLE);
    ck_assert_mem_eq(n.contact.spheres, TRIANGLE, sizeof TRIANGLE);
    ck_assert_double_eq_tol(n.contact.weights[0], 1, 1e-12);
    sph_query_destroy(q);
}
END_TEST

/* The same, posed by the caller with what the library should have come to. */
static void check_pose(const sph_query *q, const sph_query *other)
{
    static const float POINTS[4][3] = {{0, 0, 9}, {1, 1, 1}, {-3, 2, 0}, {4, 4, -1}};
    sph_nearest a[4], b[4];
    ck_assert_int_eq(sph_query_nearest(q, POINTS[0], 0, 4, a), SPH_OK);
    ck_assert_int_eq(sph_query_nearest(other, POINTS[0], 0, 4, b), SPH_OK);
    ck_assert_mem_eq(a, b, sizeof a);
}

START_TEST(a_time_between_frames_interpolates_centres_and_radii)
{
    sph_level *varying = make_level(context, 1);
    sph_query *q = make_query(_i ? varying : level), *other = make_query(level);
    struct {
        float x[3];
        int tag;
    } centers[4];
    float radii[4];
    for (int step = 0; step <= 4; ++step) {
        const float t = (float)step / 4;
        for (int i = 0; i < 4; ++i) {
            for (int k = 0; k < 3; ++k)
                centers[i].x[k] = CENTERS[0][i][k] + t * (CENTERS[1][i][k] - CENTERS[0][i][k]);
            radii[i] = _i ? RADII[0][i] + t * (RADII[1][i] - RADII[0][i]) : RADII[0][i];
        }
        ck_assert_int_eq(sph_query_pose_time(q, t), SPH_OK);
        ck_assert_int_eq(sph_query_pose_centers(other, centers[0].x, sizeof centers[0], _i ? radii : NULL), SPH_OK);
        check_pose(q, other);
    }
    ck_assert_int_eq(sph_query_pose_frame(q, 1), SPH_OK);
    check_pose(q, other);
    sph_query_destroy(q);
    sph_query_destroy(other);
    sph_level_destroy(varying);
}
END_TEST

START_TEST(a_pose_that_is_refused_leaves_the_old_one)
{
    sph_level *varying = make_level(context, 1);
    sph_query *q = make_query(level), *other = make_query(varying);
    float centers[4][3] = {{0}}, radii[4] = {0};
    ck_assert_int_eq(sph_query_pose_frame(q, 1), SPH_OK);
    ck_assert_int_eq(sph_query_pose_frame(other, 1), SPH_OK);
    ck_assert_int_eq(sph_query_pose_frame(q, 2), SPH_E_INVALID);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "frame 2 of 2"));
    ck_assert_int_eq(sph_query_pose_time(q, 1.001), SPH_E_INVALID);
    ck_assert_int_eq(sph_query_pose_time(q, -0.001), SPH_E_INVALID);
    ck_assert_int_eq(sph_query_pose_time(q, NAN), SPH_E_INVALID);
    ck_assert_int_eq(sph_query_pose_centers(q, NULL, 0, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_query_pose_centers(q, centers[0], 11, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_query_pose_centers(q, centers[0], SIZE_MAX / 2, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_query_pose_centers(other, centers[0], 0, NULL), SPH_E_INVALID);
    radii[3] = -1;
    ck_assert_int_eq(sph_query_pose_centers(q, centers[0], 0, radii), SPH_E_INVALID);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "sphere 3"));
    radii[3] = INFINITY;
    ck_assert_int_eq(sph_query_pose_centers(q, centers[0], 0, radii), SPH_E_INVALID);
    radii[3] = 1;
    centers[2][1] = NAN;
    ck_assert_int_eq(sph_query_pose_centers(q, centers[0], 0, radii), SPH_E_INVALID);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "point 2"));
    ck_assert_double_eq_tol(ask(q, 8, 16, -3).distance, sqrt(82) - 1, 1e-12);
    ck_assert_double_eq_tol(ask(other, 8, 16, -3).distance, sqrt(82) - 2, 1e-12);
    sph_query_destroy(q);
    sph_query_destroy(other);
    sph_level_destroy(varying);
}
END_TEST

START_TEST(bad_options_and_missing_arguments_are_refused)
{
    sph_query *q = (sph_query *)&context;
    sph_query_options options;
    sph_nearest n;
    sph_hit hit;
    uint8_t flag;
    const float point[3] = {0, 0, 0};
    const sph_sweep sweep = {{0}, {0}, 0, 0};
    sph_query_options_init(&options, sizeof options);
    options.search = 3;
    ck_assert_int_eq(sph_query_create(level, &options, &q), SPH_E_INVALID);
    ck_assert_ptr_null(q);
    sph_query_options_init(&options, sizeof options);
    options.flags = 1;
    ck_assert_int_eq(sph_query_create(level, &options, &q), SPH_E_INVALID);
    memset(&options, 0, sizeof options);
    ck_assert_int_eq(sph_query_create(level, &options, &q), SPH_E_INVALID);
    ck_assert_int_eq(sph_query_create(NULL, NULL, &q), SPH_E_INVALID);
    ck_assert_int_eq(sph_query_create(level, NULL, NULL), SPH_E_INVALID);
    q = make_query(level);
    ck_assert_int_eq(sph_query_pose_frame(NULL, 0), SPH_E_INVALID);
    ck_assert_int_eq(sph_query_pose_time(NULL, 0), SPH_E_INVALID);
    ck_assert_int_eq(sph_query_cast(NULL, &sweep, 1, &hit), SPH_E_INVALID);
    ck_assert_int_eq(sph_query_cast(q, NULL, 1, &hit), SPH_E_INVALID);
    ck_assert_int_eq(sph_query_cast(q, &sweep, 1, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_query_cast(q, NULL, 0, NULL), SPH_OK);
    ck_assert_int_eq(sph_query_cast_any(q, NULL, 1, &flag), SPH_E_INVALID);
    ck_assert_int_eq(sph_query_nearest(NULL, point, 0, 1, &n), SPH_E_INVALID);
    ck_assert_int_eq(sph_query_nearest(q, NULL, 0, 1, &n), SPH_E_INVALID);
    ck_assert_int_eq(sph_query_nearest(q, point, 8, 1, &n), SPH_E_INVALID);
    ck_assert_int_eq(sph_query_nearest(q, NULL, 0, 0, NULL), SPH_OK);
    ck_assert_int_eq(sph_query_contains(q, point, 0, 1, 2, &flag), SPH_E_INVALID);
    ck_assert_int_eq(sph_query_contains(q, point, 0, 1, 0, NULL), SPH_E_INVALID);
    sph_query_destroy(q);
}
END_TEST

static sph_status create_and_ask(sph_context *own, const void *user)
{
    sph_level *of = make_level(own, 0);
    const float point[3] = {0.6f, 0.6f, 0.9f};
    sph_query_options options;
    sph_query *q = NULL;
    uint8_t inside = 2;
    sph_status status = SPH_E_NOMEM;
    (void)user;
    sph_query_options_init(&options, sizeof options);
    options.search = SPH_SEARCH_TREE;
    if (of != NULL) status = sph_query_create(of, &options, &q);
    if (status == SPH_OK) status = sph_query_contains(q, point, 0, 1, SPH_CAVITY_SOLID, &inside);
    if (status == SPH_OK) ck_assert_uint_eq(inside, 0);
    sph_query_destroy(q);
    sph_level_destroy(of);
    return status;
}

START_TEST(every_allocation_may_fail)
{
    check_every_allocation((test_faults){.work = create_and_ask, .least = 10, .sticky = _i});
}
END_TEST

START_TEST(queries_allocate_nothing)
{
    test_faulty faulty = {0};
    const sph_allocator allocator = test_faulty_allocator(&faulty);
    sph_context *own = test_context_with_allocator(&allocator);
    sph_level *of = make_level(own, 0);
    sph_query *q = make_query(of);
    const sph_sweep sweep = {{-9, 0, 0}, {9, 0, 0}, 0.1f, 0};
    const float motion[3] = {1, 0, 0};
    sph_hit hit;
    sph_nearest n;
    sph_gap gap;
    uint8_t flag;
    const size_t before = faulty.calls;
    ck_assert_int_eq(sph_query_pose_time(q, 0.5), SPH_OK);
    ck_assert_int_eq(sph_query_cast(q, &sweep, 1, &hit), SPH_OK);
    ck_assert_int_eq(sph_query_cast_any(q, &sweep, 1, &flag), SPH_OK);
    ck_assert_int_eq(sph_query_nearest(q, sweep.from, 0, 1, &n), SPH_OK);
    ck_assert_int_eq(sph_query_contains(q, sweep.from, 0, 1, SPH_CAVITY_SPACE, &flag), SPH_OK);
    ck_assert_int_eq(sph_query_between(q, q, &gap), SPH_OK);
    ck_assert_int_eq(sph_query_cast_between(q, motion, q, &gap), SPH_OK);
    ck_assert_uint_eq(faulty.calls, before);
    sph_query_destroy(q);
    sph_level_destroy(of);
    sph_context_destroy(own);
}
END_TEST

/* --- threads --- */

enum { THREADS = 4, ASKED = 2000 };

typedef struct job {
    const sph_query *query;
    sph_hit hits[ASKED];
    uint8_t inside[ASKED];
} job;

static sph_sweep sweeps[ASKED];

static void *work(void *argument)
{
    job *j = argument;
    if (sph_query_contains(j->query, sweeps[0].from, sizeof sweeps[0], ASKED, SPH_CAVITY_SOLID, j->inside) != SPH_OK)
        return NULL;
    return sph_query_cast(j->query, sweeps, ASKED, j->hits) == SPH_OK ? j : NULL;
}

START_TEST(any_number_of_threads_may_ask_one_handle)
{
    job *jobs = test_malloc(THREADS, sizeof *jobs);
    sph_query *q = make_query(level);
    pthread_t threads[THREADS];
    uint64_t state = 5;
    for (int i = 0; i < ASKED; ++i) {
        for (int k = 0; k < 3; ++k) {
            sweeps[i].from[k] = (float)(8 * test_random_unit(&state) - 2);
            sweeps[i].to[k] = (float)(8 * test_random_unit(&state) - 2);
        }
        sweeps[i].radius = 0.1f;
    }
    ck_assert_int_eq(sph_query_pose_time(q, 0.3), SPH_OK);
    for (int i = 0; i < THREADS; ++i) {
        jobs[i].query = q;
        ck_assert_int_eq(pthread_create(&threads[i], NULL, work, &jobs[i]), 0);
    }
    for (int i = 0; i < THREADS; ++i) {
        void *result;
        ck_assert_int_eq(pthread_join(threads[i], &result), 0);
        ck_assert_ptr_eq(result, &jobs[i]);
        ck_assert_mem_eq(jobs[i].hits, jobs[0].hits, sizeof jobs[0].hits);
        ck_assert_mem_eq(jobs[i].inside, jobs[0].inside, sizeof jobs[0].inside);
    }
    sph_query_destroy(q);
    free(jobs);
}
END_TEST

int main(void)
{
    Suite *s = suite_create("query");
    TCase *tc = tcase_create("query");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_set_timeout(tc, 60);
    tcase_add_test(tc, a_new_handle_is_posed_at_frame_0_and_outlives_level_and_context);
    tcase_add_test(tc, contacts_name_spheres_in_the_order_in_which_the_level_lists_them);
    tcase_add_loop_test(tc, a_time_between_frames_interpolates_centres_and_radii, 0, 2);
    tcase_add_test(tc, a_pose_that_is_refused_leaves_the_old_one);
    tcase_add_test(tc, bad_options_and_missing_arguments_are_refused);
    tcase_add_loop_test(tc, every_allocation_may_fail, 0, 2);
    tcase_add_test(tc, queries_allocate_nothing);
    tcase_add_test(tc, any_number_of_threads_may_ask_one_handle);
    return run_suite(s, tc);
}
