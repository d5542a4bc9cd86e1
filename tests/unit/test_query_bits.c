/* SPDX-License-Identifier: MIT */
/* One call or many, tree or not, after whatever poses: the same bits. */
#include <check.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "runner.h"
#include "support.h"

enum { SPHERES = 900, SIMPLICES = 700, FRAMES = 3, SWEEPS = 1500 };

/* What is asked, and the answers. */
typedef struct answers {
    sph_hit hits[SWEEPS];
    sph_nearest nearest[SWEEPS];
    uint8_t any[SWEEPS], inside[SWEEPS];
} answers;

static sph_context *context;
static uint64_t state;
static float centers[FRAMES][SPHERES][3], radii[SPHERES];
static uint32_t edges[SIMPLICES][2], triangles[SIMPLICES][3];
static sph_sweep sweeps[SWEEPS];
static answers *given[2];

static double between(double low, double high)
{
    return low + (high - low) * test_random_unit(&state);
}

static uint32_t below(uint32_t count)
{
    return (uint32_t)(test_random(&state) % count);
}

/* The same spheres again and again: equal hits on several simplices. */
static void make_spheres(void)
{
    for (uint32_t i = 0; i < SPHERES; ++i) {
        for (int k = 0; k < 3; ++k)
            centers[0][i][k] = (float)between(-1, 1);
        radii[i] = below(4) ? (float)between(0, 0.03) : 0;
    }
    for (uint32_t i = 0; i < SIMPLICES; ++i) {
        edges[i][0] = triangles[i][0] = i;
        edges[i][1] = i + 1;
        triangles[i][1] = i + 1 + below(3);
        triangles[i][2] = i + 2 + below(20);
        for (int k = 0; k < 3; ++k)
            centers[0][i + 1][k] = 0.8f * centers[0][i][k] + 0.3f * (centers[0][i + 1][k] - 0.1f);
    }
    for (uint32_t f = 1; f < FRAMES; ++f) /* nothing stays where it was */
        for (uint32_t i = 0; i < SPHERES; ++i)
            for (int k = 0; k < 3; ++k)
                centers[f][i][k] = centers[0][i][(k + (int)f) % 3] + (float)between(-0.05, 0.05);
}

/* Long ones and short ones, some in place, some from within, some from afar, some much bigger than the level. */
static void make_sweeps(void)
{
    for (size_t i = 0; i < SWEEPS; ++i) {
        sph_sweep *w = &sweeps[i];
        for (int k = 0; k < 3; ++k) {
            w->from[k] = (float)between(-1.2, 1.2);
            w->to[k] = i % 2 ? (float)between(-1.2, 1.2) : w->from[k] + (float)between(-0.02, 0.02);
        }
        w->radius = i % 3 ? (float)between(0, 0.05) : 0;
        w->reserved0 = 0;
        switch (below(12)) {
        case 0:
            memcpy(w->to, w->from, sizeof w->to);
            break;
        case 1:
            memcpy(w->from, centers[0][below(SIMPLICES)], sizeof w->from);
            break;
        case 2:
            w->from[0] = 1e20f;
            break;
        case 3:
            w->from[below(3)] = 5000;
            w->radius = 4999;
            break;
        default:
            break;
        }
    }
}

/* `simplices` of each kind. */
static sph_level *make_level(uint32_t simplices)
{
    const sph_level_arrays arrays = {.struct_size = sizeof arrays,
                                     .sphere_count = simplices + 25 < SPHERES ? simplices + 25 : SPHERES,
                                     .frame_count = 1,
                                     .centers = centers[0][0],
                                     .radii = radii,
                                     .edge_count = simplices,
                                     .edges = edges[0],
                                     .triangle_count = simplices,
                                     .triangles = triangles[0]};
    sph_level *level = NULL;
    ck_assert_int_eq(sph_level_create_from_arrays(context, &arrays, &level), SPH_OK);
    return level;
}

static sph_query *make_query(const sph_level *level, int32_t search)
{
    sph_query_options options;
    sph_query *q = NULL;
    sph_query_options_init(&options, sizeof options);
    options.search = search;
    ck_assert_int_eq(sph_query_create(level, &options, &q), SPH_OK);
    return q;
}

/* `batch` at a time. */
static void ask(const sph_query *q, size_t batch, answers *a)
{
    memset(a, 7, sizeof *a);
    for (size_t i = 0; i < SWEEPS; i += batch) {
        const size_t count = SWEEPS - i < batch ? SWEEPS - i : batch;
        ck_assert_int_eq(sph_query_cast(q, sweeps + i, count, a->hits + i), SPH_OK);
        ck_assert_int_eq(sph_query_cast_any(q, sweeps + i, count, a->any + i), SPH_OK);
        ck_assert_int_eq(sph_query_nearest(q, sweeps[i].from, sizeof *sweeps, count, a->nearest + i), SPH_OK);
        ck_assert_int_eq(sph_query_contains(q, sweeps[i].from, sizeof *sweeps, count, SPH_CAVITY_SPACE, a->inside + i),
                         SPH_OK);
    }
}

static void compare(const answers *a, const answers *b)
{
    size_t hits = 0;
    for (size_t i = 0; i < SWEEPS; ++i) {
        ck_assert_msg(memcmp(&a->hits[i], &b->hits[i], sizeof a->hits[i]) == 0, "sweep %zu: %.17g, %.17g", i,
                      a->hits[i].s, b->hits[i].s);
        ck_assert_mem_eq(&a->nearest[i], &b->nearest[i], sizeof a->nearest[i]);
        ck_assert_uint_eq(a->any[i], a->hits[i].hit);
        ck_assert_uint_eq(b->any[i], a->hits[i].hit);
        ck_assert_uint_eq(a->inside[i], b->inside[i]);
        hits += a->hits[i].hit;
    }
    ck_assert_uint_gt(hits, SWEEPS / 20);
    ck_assert_uint_lt(hits, SWEEPS - SWEEPS / 20);
}

static void setup(void)
{
    context = test_context();
    state = 20160301;
    make_spheres();
    make_sweeps();
    for (int i = 0; i < 2; ++i)
        given[i] = test_malloc(1, sizeof *given[i]);
}

static void teardown(void)
{
    for (int i = 0; i < 2; ++i)
        free(given[i]);
    sph_context_destroy(context);
}

static const uint32_t SIZES[] = {10, 30, 120, 400, SIMPLICES};

START_TEST(a_batch_has_the_bits_of_single_calls)
{
    static const size_t BATCHES[] = {7, 8, 33, 256, 257, SWEEPS};
    sph_level *level = make_level(SIZES[_i]);
    sph_query *q = make_query(level, SPH_SEARCH_AUTO);
    ask(q, 1, given[0]);
    for (size_t i = 0; i < sizeof BATCHES / sizeof *BATCHES; ++i) {
        ask(q, BATCHES[i], given[1]);
        compare(given[0], given[1]);
    }
    sph_query_destroy(q);
    sph_level_destroy(level);
}
END_TEST

START_TEST(the_tree_has_the_bits_of_the_exhaustive_search)
{
    sph_level *level = make_level(SIZES[_i]);
    sph_query *all = make_query(level, SPH_SEARCH_EXHAUSTIVE), *tree = make_query(level, SPH_SEARCH_TREE);
    ask(all, SWEEPS, given[0]);
    ask(tree, SWEEPS, given[1]);
    compare(given[0], given[1]);
    sph_query_destroy(all);
    sph_query_destroy(tree);
    sph_level_destroy(level);
}
END_TEST

/* A tree that was built on other places. */
START_TEST(a_tree_that_was_refitted_has_them_too)
{
    sph_level *level = make_level(SIZES[_i]);
    sph_query *all = make_query(level, SPH_SEARCH_EXHAUSTIVE), *tree = make_query(level, SPH_SEARCH_TREE);
    for (uint32_t f = FRAMES; f-- > 0;) {
        ck_assert_int_eq(sph_query_pose_centers(all, centers[f][0], 0, NULL), SPH_OK);
        ck_assert_int_eq(sph_query_pose_centers(tree, centers[f][0], 0, NULL), SPH_OK);
        ask(all, SWEEPS, given[0]);
        ask(tree, SWEEPS, given[1]);
        compare(given[0], given[1]);
    }
    sph_query_destroy(tree); /* back where it began: nothing is left of the poses between */
    tree = make_query(level, SPH_SEARCH_TREE);
    ask(tree, SWEEPS, given[1]);
    compare(given[0], given[1]);
    sph_query_destroy(all);
    sph_query_destroy(tree);
    sph_level_destroy(level);
}
END_TEST

START_TEST(batches_allocate_nothing)
{
    test_faulty faulty = {0};
    const sph_allocator allocator = test_faulty_allocator(&faulty);
    sph_level *level;
    sph_query *q;
    size_t before;
    sph_context_destroy(context);
    context = test_context_with_allocator(&allocator);
    level = make_level(SIZES[_i]);
    q = make_query(level, SPH_SEARCH_AUTO);
    before = faulty.calls;
    ask(q, SWEEPS, given[0]);
    ck_assert_int_eq(sph_query_pose_centers(q, centers[1][0], 0, NULL), SPH_OK);
    ask(q, 100, given[0]);
    ck_assert_uint_eq(faulty.calls, before);
    sph_query_destroy(q);
    sph_level_destroy(level);
    sph_context_destroy(context);
    ck_assert_uint_eq(faulty.live_blocks, 0);
    context = test_context();
}
END_TEST

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
enum { STACK = 1 << 18 };

typedef struct work {
    sph_query *query; /* NULL: do nothing */
    unsigned char *stack;
} work;

static void *do_work(void *user)
{
    const work *w = user;
    if (w->query == NULL) return NULL;
    ask(w->query, SWEEPS, given[0]);
    ask(w->query, 1, given[0]);
    return NULL;
}

/* How much of its stack a thread has written to. */
static size_t stack_of(work w)
{
    pthread_attr_t attributes;
    pthread_t thread;
    size_t untouched = 0;
    memset(w.stack, 0xa5, STACK);
    ck_assert_int_eq(pthread_attr_init(&attributes), 0);
    ck_assert_int_eq(pthread_attr_setstack(&attributes, w.stack, STACK), 0);
    ck_assert_int_eq(pthread_create(&thread, &attributes, do_work, &w), 0);
    ck_assert_int_eq(pthread_join(thread, NULL), 0);
    pthread_attr_destroy(&attributes);
    while (untouched < STACK && w.stack[untouched] == 0xa5)
        ++untouched;
    return STACK - untouched;
}

/* Threads of engines' jobs have small stacks. */
START_TEST(a_call_needs_less_than_32_kB_of_stack)
{
    sph_level *level = make_level(SIZES[_i]);
    work w = {.stack = aligned_alloc(4096, STACK)};
    sph_query *q = make_query(level, SPH_SEARCH_AUTO);
    size_t base, all;
    ck_assert_ptr_nonnull(w.stack);
    ask(q, SWEEPS, given[0]); /* whatever happens at first has happened */
    ask(q, 1, given[0]);
    base = stack_of(w);
    w.query = q;
    all = stack_of(w);
    ck_assert_msg(all - base < 32 * 1024, "%zu bytes", all - base);
    free(w.stack);
    sph_query_destroy(q);
    sph_level_destroy(level);
}
END_TEST
#endif

int main(void)
{
    enum { SIZE_COUNT = sizeof SIZES / sizeof *SIZES };
    Suite *s = suite_create("query_bits");
    TCase *tc = tcase_create("query_bits");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, a_batch_has_the_bits_of_single_calls, 0, SIZE_COUNT);
    tcase_add_loop_test(tc, the_tree_has_the_bits_of_the_exhaustive_search, 0, SIZE_COUNT);
    tcase_add_loop_test(tc, a_tree_that_was_refitted_has_them_too, 0, SIZE_COUNT);
    tcase_add_loop_test(tc, batches_allocate_nothing, 0, SIZE_COUNT);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    tcase_add_loop_test(tc, a_call_needs_less_than_32_kB_of_stack, 0, SIZE_COUNT);
#endif
    return run_suite(s, tc);
}
