/* SPDX-License-Identifier: MIT */
/*
 * Collapses that are worked out ahead on several threads, and leaves whose quadrics come and go: neither may change a bit.
 * The meshes are large enough for both: thousands of edges, and more leaves than there is room for.
 */
#include <check.h>
#include <stdlib.h>

#include "runner.h"
#include "support.h"

enum { FRAMES = 33, EXECUTORS = 3 };

static sph_context *context;

static void setup(void)
{
    context = test_context_with_threads(1);
    ck_assert_ptr_nonnull(context);
}

static void teardown(void)
{
    sph_context_destroy(context);
}

typedef sph_animation *make_fn(sph_context *context);

static sph_animation *make_sphere(sph_context *c)
{
    return test_sphere(c, 4, FRAMES);
}

static sph_animation *make_torus(sph_context *c)
{
    return test_torus(c, 40, 36, FRAMES);
}

/* Flat panels, whose costs are nothing but rounding, and borders. */
static sph_animation *make_grid(sph_context *c)
{
    return test_grid(c, 40, 30, 2);
}

static sph_animation *make_soup(sph_context *c)
{
    return test_soup(c, 400, 900, 5, 7);
}

static make_fn *const MAKERS[] = {make_sphere, make_torus, make_grid, make_soup};
enum { MAKER_COUNT = sizeof MAKERS / sizeof *MAKERS };

static sph_hierarchy *build(sph_context *c, make_fn *make, int32_t radius_mode)
{
    sph_animation *animation = make(c);
    sph_hierarchy_options o;
    sph_hierarchy *h = NULL;
    sph_hierarchy_options_init(&o, sizeof o);
    o.radius_mode = radius_mode;
    ck_assert_int_eq(sph_hierarchy_create(animation, &o, &h), SPH_OK);
    sph_animation_destroy(animation);
    return h;
}

static void check_same(const sph_hierarchy *a, const sph_hierarchy *b)
{
    const uint32_t collapses = sph_hierarchy_collapse_count(a), frames = sph_hierarchy_frame_count(a);
    const uint32_t nodes = sph_hierarchy_vertex_count(a) + collapses;
    float *centers[2] = {test_malloc(frames, 3 * sizeof(float)), test_malloc(frames, 3 * sizeof(float))};
    float *radii[2] = {test_malloc(frames, sizeof(float)), test_malloc(frames, sizeof(float))};
    ck_assert_uint_eq(collapses, sph_hierarchy_collapse_count(b));
    ck_assert_uint_eq(sph_hierarchy_evaluation_count(a), sph_hierarchy_evaluation_count(b));
    ck_assert_uint_eq(sph_hierarchy_first_forced(a), sph_hierarchy_first_forced(b));
    for (uint32_t t = 0; t < collapses; ++t) {
        sph_collapse x, y;
        ck_assert_int_eq(sph_hierarchy_collapse(a, t, &x), SPH_OK);
        ck_assert_int_eq(sph_hierarchy_collapse(b, t, &y), SPH_OK);
        ck_assert_msg(x.u == y.u && x.v == y.v && x.forced == y.forced, "collapse %u: (%u, %u) and (%u, %u)", t, x.u,
                      x.v, y.u, y.v);
        ck_assert_double_eq(x.cost, y.cost);
        ck_assert_double_eq(x.error, y.error);
    }
    for (uint32_t node = 0; node < nodes; ++node) {
        ck_assert_int_eq(sph_hierarchy_sphere(a, node, centers[0], radii[0]), SPH_OK);
        ck_assert_int_eq(sph_hierarchy_sphere(b, node, centers[1], radii[1]), SPH_OK);
        ck_assert_mem_eq(centers[0], centers[1], frames * 3 * sizeof(float));
        ck_assert_mem_eq(radii[0], radii[1], frames * sizeof(float));
    }
    for (unsigned i = 0; i < 2; ++i) {
        free(centers[i]);
        free(radii[i]);
    }
}

START_TEST(any_number_of_threads_gives_the_same_bits)
{
    static const uint32_t THREADS[] = {2, 3, 7};
    sph_hierarchy *alone = build(context, MAKERS[_i], SPH_RADIUS_CONSTANT);
    for (unsigned i = 0; i < sizeof THREADS / sizeof *THREADS; ++i) {
        sph_context *several = test_context_with_threads(THREADS[i]);
        sph_hierarchy *together = build(several, MAKERS[_i], SPH_RADIUS_CONSTANT);
        check_same(alone, together);
        sph_hierarchy_destroy(together);
        sph_context_destroy(several);
    }
    sph_hierarchy_destroy(alone);
}
END_TEST

START_TEST(any_executor_gives_the_same_bits)
{
    const sph_executor executors[EXECUTORS] = {test_executor_reverse(), test_executor_scattered(),
                                               test_executor_threads()};
    sph_context *other = test_context_with_executor(&executors[_i]);
    for (int32_t mode = SPH_RADIUS_CONSTANT; mode <= SPH_RADIUS_ZERO; mode += SPH_RADIUS_ZERO - SPH_RADIUS_CONSTANT) {
        sph_hierarchy *alone = build(context, make_torus, mode), *together = build(other, make_torus, mode);
        check_same(alone, together);
        sph_hierarchy_destroy(alone);
        sph_hierarchy_destroy(together);
    }
    sph_context_destroy(other);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("hierarchy_ahead");
    TCase *tests = tcase_create("hierarchy_ahead");
    tcase_add_checked_fixture(tests, setup, teardown);
    tcase_set_timeout(tests, 0);
    tcase_add_loop_test(tests, any_number_of_threads_gives_the_same_bits, 0, MAKER_COUNT);
    tcase_add_loop_test(tests, any_executor_gives_the_same_bits, 0, EXECUTORS);
    suite_add_tcase(suite, tests);
    return run_all(suite);
}
