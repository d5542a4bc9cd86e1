/* SPDX-License-Identifier: MIT */
/* What may be done from several threads at once is done from several threads at once, and gives what one alone gets. */
#include <check.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "runner.h"
#include "support.h"

enum { THREADS = 3, FRAMES = 3 };

typedef struct bytes {
    unsigned char *data;
    size_t size, capacity;
} bytes;

static sph_status keep(void *user, const void *data, size_t size)
{
    bytes *b = user;
    if (b->size + size > b->capacity) {
        b->capacity = 2 * (b->size + size);
        b->data = realloc(b->data, b->capacity);
        if (b->data == NULL) abort();
    }
    memcpy(b->data + b->size, data, size);
    b->size += size;
    return SPH_OK;
}

static bool same(const bytes *a, const bytes *b)
{
    return a->size == b->size && a->size > 0 && memcmp(a->data, b->data, a->size) == 0;
}

/* Everything from an animation to a level, written. Checks are made by the thread that joins. */
typedef struct job {
    sph_context *context;
    const sph_animation *animation; /* NULL: makes its own */
    sph_status status;
    bytes hierarchy, level;
} job;

static void *build(void *argument)
{
    job *j = argument;
    sph_animation *own = j->animation == NULL ? test_torus(j->context, 14, 8, FRAMES) : NULL;
    const sph_animation *animation = own != NULL ? own : j->animation;
    sph_hierarchy *h = NULL;
    sph_level *level = NULL;
    j->status = sph_hierarchy_create(animation, NULL, &h);
    if (j->status == SPH_OK) j->status = sph_hierarchy_write(h, keep, &j->hierarchy);
    if (j->status == SPH_OK) j->status = sph_level_create(h, 12, &level);
    if (j->status == SPH_OK) j->status = sph_level_optimize_connectivity(level, animation);
    if (j->status == SPH_OK) j->status = sph_level_write(level, keep, &j->level);
    sph_level_destroy(level);
    sph_hierarchy_destroy(h);
    sph_animation_destroy(own);
    return NULL;
}

static void run(void *(*body)(void *), void *jobs, size_t size)
{
    pthread_t threads[THREADS];
    for (size_t i = 0; i < THREADS; ++i)
        ck_assert_int_eq(pthread_create(&threads[i], NULL, body, (char *)jobs + i * size), 0);
    for (size_t i = 0; i < THREADS; ++i) pthread_join(threads[i], NULL);
}

static void build_at_once(job jobs[THREADS])
{
    run(build, jobs, sizeof *jobs);
    for (unsigned i = 0; i < THREADS; ++i) {
        ck_assert_int_eq(jobs[i].status, SPH_OK);
        ck_assert(same(&jobs[i].hierarchy, &jobs[0].hierarchy));
        ck_assert(same(&jobs[i].level, &jobs[0].level));
    }
    for (unsigned i = 0; i < THREADS; ++i) {
        free(jobs[i].hierarchy.data);
        free(jobs[i].level.data);
    }
}

/* _i: threads of each context. */
START_TEST(hierarchies_with_contexts_of_their_own_are_built_at_once)
{
    job jobs[THREADS] = {{0}};
    for (unsigned i = 0; i < THREADS; ++i) jobs[i].context = test_context_with_threads((uint32_t)_i);
    build_at_once(jobs);
    for (unsigned i = 0; i < THREADS; ++i) sph_context_destroy(jobs[i].context);
}
END_TEST

START_TEST(hierarchies_of_one_context_and_one_animation_are_built_at_once)
{
    sph_context *context = test_context_with_threads((uint32_t)_i);
    sph_animation *animation = test_torus(context, 14, 8, FRAMES);
    job jobs[THREADS] = {{0}};
    for (unsigned i = 0; i < THREADS; ++i) jobs[i] = (job){.context = context, .animation = animation};
    sph_context_destroy(context); /* the animation keeps it */
    build_at_once(jobs);
    sph_animation_destroy(animation);
}
END_TEST

/* Readers of one set of handles. */
typedef struct reader {
    const sph_animation *animation;
    const sph_hierarchy *hierarchy;
    const sph_level *level;
    const sph_query *query;
    sph_status status;
    double hits, distance;
    uint32_t surface_vertices;
} reader;

static void *read_all(void *argument)
{
    reader *r = argument;
    sph_cursor *cursor = NULL;
    sph_surface *surface = NULL;
    sph_surface_options so;
    sph_measure_options mo;
    sph_distances mean;
    sph_hit hit;
    const sph_sweep sweep = {.from = {-3, 0.9F, 0}, .to = {3, 0.9F, 0.1F}, .radius = 0.05F};
    r->status = sph_cursor_create(r->hierarchy, &cursor);
    if (r->status == SPH_OK) r->status = sph_cursor_move(cursor, 10);
    sph_cursor_destroy(cursor);
    for (unsigned i = 0; i < 100 && r->status == SPH_OK; ++i) {
        r->status = sph_query_cast(r->query, &sweep, 1, &hit);
        r->hits += hit.s;
    }
    sph_surface_options_init(&so, sizeof so);
    so.resolution = 12;
    so.frame_limit = 1;
    if (r->status == SPH_OK) r->status = sph_surface_create(r->level, &so, &surface);
    r->surface_vertices = sph_surface_vertex_count(surface, 0);
    sph_surface_destroy(surface);
    sph_measure_options_init(&mo, sizeof mo);
    mo.samples = 3000;
    mo.frame_limit = 1;
    if (r->status == SPH_OK) r->status = sph_measure_level(r->animation, r->level, &mo, &mean, NULL);
    r->distance = mean.hausdorff;
    return NULL;
}

START_TEST(one_set_of_handles_is_read_at_once)
{
    sph_context *context = test_context_with_threads((uint32_t)_i);
    sph_animation *animation = test_torus(context, 14, 8, FRAMES);
    sph_hierarchy *h = NULL;
    sph_level *level = NULL;
    sph_query *query = NULL;
    reader readers[THREADS];
    ck_assert_int_eq(sph_hierarchy_create(animation, NULL, &h), SPH_OK);
    ck_assert_int_eq(sph_level_create(h, 12, &level), SPH_OK);
    ck_assert_int_eq(sph_query_create(level, NULL, &query), SPH_OK);
    ck_assert_int_eq(sph_query_pose_frame(query, 1), SPH_OK);
    for (unsigned i = 0; i < THREADS; ++i)
        readers[i] = (reader){.animation = animation, .hierarchy = h, .level = level, .query = query};
    run(read_all, readers, sizeof *readers);
    for (unsigned i = 0; i < THREADS; ++i) {
        ck_assert_int_eq(readers[i].status, SPH_OK);
        ck_assert_double_eq(readers[i].hits, readers[0].hits);
        ck_assert_double_eq(readers[i].distance, readers[0].distance);
        ck_assert_uint_eq(readers[i].surface_vertices, readers[0].surface_vertices);
    }
    ck_assert_uint_gt(readers[0].surface_vertices, 20);
    ck_assert_double_lt(readers[0].hits, 100); /* it does hit */
    sph_query_destroy(query);
    sph_level_destroy(level);
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
    sph_context_destroy(context);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("threads");
    TCase *tc = tcase_create("threads");
    tcase_add_loop_test(tc, hierarchies_with_contexts_of_their_own_are_built_at_once, 1, 4);
    tcase_add_loop_test(tc, hierarchies_of_one_context_and_one_animation_are_built_at_once, 1, 4);
    tcase_add_loop_test(tc, one_set_of_handles_is_read_at_once, 1, 4);
    return run_suite(suite, tc);
}
