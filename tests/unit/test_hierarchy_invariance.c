/* SPDX-License-Identifier: MIT */
/* What must not change a hierarchy, or change it in a known way. */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "awkward.h"
#include "runner.h"
#include "support.h"

enum { MODES = 3, FRAMES = 9, SEEDS = 20 };

static sph_context *context;

static void setup(void)
{
    context = test_context();
    ck_assert_ptr_nonnull(context);
}

static void teardown(void)
{
    sph_context_destroy(context);
}

static sph_hierarchy_options default_options(void)
{
    sph_hierarchy_options options;
    sph_hierarchy_options_init(&options, sizeof options);
    return options;
}

static sph_hierarchy *build(const sph_animation *animation, const sph_hierarchy_options *options)
{
    sph_hierarchy *h = NULL;
    ck_assert_int_eq(sph_hierarchy_create(animation, options, &h), SPH_OK);
    return h;
}

/* The options number `choice`: modes, importances, with coherence and without. */
enum { CHOICES = MODES * 4 };
static sph_hierarchy_options choose(unsigned choice)
{
    sph_hierarchy_options o = default_options();
    o.radius_mode = (int32_t)(choice % MODES);
    o.importance = choice / MODES % 2 == 0 ? SPH_IMPORTANCE_CURVATURE : SPH_IMPORTANCE_NONE;
    o.temporal_coherence = choice / MODES / 2 == 0 ? 0 : 0.02;
    return o;
}

static void check_same_levels(const sph_hierarchy *a, const sph_hierarchy *b)
{
    const uint32_t count = sph_hierarchy_vertex_count(a) - sph_hierarchy_collapse_count(a) / 2;
    sph_level_arrays x = {.struct_size = sizeof x}, y = {.struct_size = sizeof y};
    sph_level *p, *q;
    ck_assert_int_eq(sph_level_create(a, count, &p), SPH_OK);
    ck_assert_int_eq(sph_level_create(b, count, &q), SPH_OK);
    ck_assert_int_eq(sph_level_get_arrays(p, &x), SPH_OK);
    ck_assert_int_eq(sph_level_get_arrays(q, &y), SPH_OK);
    ck_assert_uint_eq(x.edge_count, y.edge_count);
    ck_assert_uint_eq(x.triangle_count, y.triangle_count);
    if (x.edge_count != 0) ck_assert_mem_eq(x.edges, y.edges, 2 * x.edge_count * sizeof *x.edges);
    for (size_t t = 0; t < x.triangle_count; ++t)
        ck_assert_uint_eq(x.triangles[3 * t] + x.triangles[3 * t + 1] + x.triangles[3 * t + 2],
                          y.triangles[3 * t] + y.triangles[3 * t + 1] + y.triangles[3 * t + 2]);
    ck_assert_mem_eq(x.labels, y.labels, x.label_count * sizeof *x.labels);
    sph_level_destroy(p);
    sph_level_destroy(q);
}

/* That b is a, with lengths times `size` and costs times size^4 `weight`: bit by bit. */
static void check_same(const sph_hierarchy *a, const sph_hierarchy *b, double size, double weight)
{
    const uint32_t collapses = sph_hierarchy_collapse_count(a), frames = sph_hierarchy_frame_count(a);
    const uint32_t nodes = sph_hierarchy_vertex_count(a) + collapses;
    float *spheres[2][2];
    for (unsigned i = 0; i < 4; ++i)
        spheres[i / 2][i % 2] = test_malloc(frames, 3 * sizeof(float));
    ck_assert_uint_eq(collapses, sph_hierarchy_collapse_count(b));
    ck_assert_uint_eq(nodes - collapses, sph_hierarchy_vertex_count(b));
    ck_assert_uint_eq(frames, sph_hierarchy_frame_count(b));
    ck_assert_uint_eq(sph_hierarchy_first_forced(a), sph_hierarchy_first_forced(b));
    ck_assert_uint_eq(sph_hierarchy_evaluation_count(a), sph_hierarchy_evaluation_count(b));
    ck_assert_double_eq(sph_hierarchy_bounding_diagonal(a) * size, sph_hierarchy_bounding_diagonal(b));
    for (uint32_t t = 0; t < collapses; ++t) {
        sph_collapse x, y;
        ck_assert_int_eq(sph_hierarchy_collapse(a, t, &x), SPH_OK);
        ck_assert_int_eq(sph_hierarchy_collapse(b, t, &y), SPH_OK);
        ck_assert_msg(x.u == y.u && x.v == y.v && x.node == y.node && x.forced == y.forced,
                      "collapse %u: (%u, %u) and (%u, %u)", t, x.u, x.v, y.u, y.v);
        ck_assert_double_eq(x.cost * size * size * size * size * weight, y.cost);
        ck_assert_double_eq(x.error * size, y.error);
    }
    for (uint32_t node = 0; node < nodes; ++node) {
        ck_assert_int_eq(sph_hierarchy_sphere(a, node, spheres[0][0], spheres[0][1]), SPH_OK);
        ck_assert_int_eq(sph_hierarchy_sphere(b, node, spheres[1][0], spheres[1][1]), SPH_OK);
        for (uint32_t i = 0; i < 3 * frames; ++i)
            ck_assert_float_eq((float)((double)spheres[0][0][i] * size), spheres[1][0][i]);
        for (uint32_t f = 0; f < frames; ++f)
            ck_assert_float_eq((float)((double)spheres[0][1][f] * size), spheres[1][1][f]);
    }
    check_same_levels(a, b);
    for (unsigned i = 0; i < 4; ++i)
        free(spheres[i / 2][i % 2]);
}

START_TEST(scaling_by_a_power_of_two_scales_the_result)
{
    static const double SIZES[] = {0x1p-90, 0x1p-11, 0x1p5, 0x1p50};
    for (unsigned choice = 0; choice < CHOICES; ++choice) {
        const sph_hierarchy_options o = choose(choice);
        sph_animation *plain = awkward(context, (unsigned)_i, FRAMES);
        sph_hierarchy *h = build(plain, &o);
        for (unsigned i = 0; i < sizeof SIZES / sizeof *SIZES; ++i) {
            sph_animation *scaled =
                awkward_animation(context, (unsigned)_i, (awkward_options){.frames = FRAMES, .scale = SIZES[i]});
            sph_hierarchy *g = build(scaled, &o);
            check_same(h, g, SIZES[i], 1);
            sph_hierarchy_destroy(g);
            sph_animation_destroy(scaled);
        }
        sph_hierarchy_destroy(h);
        sph_animation_destroy(plain);
    }
}
END_TEST

/* Coherence is weighed by area alone, so it has to grow with the weights. */
START_TEST(scaling_all_weights_by_a_power_of_two_scales_the_costs)
{
    static const double FACTORS[] = {0x1p-100, 0x1p-3, 0x1p90};
    sph_animation *animation = awkward(context, (unsigned)_i, FRAMES);
    const uint32_t n = sph_animation_vertex_count(animation);
    float *weights = test_malloc(n, FRAMES * sizeof *weights), *scaled = test_malloc(n, FRAMES * sizeof *scaled);
    uint64_t state = 17;
    for (size_t i = 0; i < FRAMES * (size_t)n; ++i)
        weights[i] = (float)(0.5 + test_random_unit(&state));
    for (unsigned choice = 0; choice < 4 * MODES; ++choice) {
        sph_hierarchy_options o = choose(choice);
        sph_hierarchy *h;
        o.importance_frame_stride = o.importance == SPH_IMPORTANCE_NONE ? 0 : n;
        o.importance = SPH_IMPORTANCE_CALLER;
        o.importance_weights = weights;
        h = build(animation, &o);
        o.importance_weights = scaled;
        for (unsigned k = 0; k < sizeof FACTORS / sizeof *FACTORS; ++k) {
            const sph_hierarchy_options before = o;
            sph_hierarchy *g;
            for (size_t i = 0; i < FRAMES * (size_t)n; ++i)
                scaled[i] = (float)((double)weights[i] * FACTORS[k]);
            o.temporal_coherence *= FACTORS[k];
            if (o.temporal_coherence > 1e12) break; /* where it saturates */
            g = build(animation, &o);
            check_same(h, g, 1, FACTORS[k]);
            sph_hierarchy_destroy(g);
            o = before;
        }
        sph_hierarchy_destroy(h);
    }
    sph_animation_destroy(animation);
    free(weights);
    free(scaled);
}
END_TEST

START_TEST(weights_of_one_are_no_weights)
{
    sph_animation *animation = awkward(context, (unsigned)_i, FRAMES);
    const uint32_t n = sph_animation_vertex_count(animation);
    float *weights = test_malloc((size_t)n + 3, FRAMES * sizeof *weights);
    sph_hierarchy_options o = default_options();
    sph_hierarchy *plain, *h;
    for (size_t i = 0; i < FRAMES * ((size_t)n + 3); ++i)
        weights[i] = i % (n + 3) < n ? 1 : -1;
    for (o.radius_mode = 0; o.radius_mode < MODES; ++o.radius_mode) {
        o.importance = SPH_IMPORTANCE_NONE;
        o.importance_weights = NULL;
        plain = build(animation, &o);
        o.importance = SPH_IMPORTANCE_CALLER;
        o.importance_weights = weights;
        for (unsigned per_frame = 0; per_frame < 2; ++per_frame) {
            o.importance_frame_stride = per_frame * ((size_t)n + 3);
            h = build(animation, &o);
            check_same(plain, h, 1, 1);
            sph_hierarchy_destroy(h);
        }
        sph_hierarchy_destroy(plain);
    }
    free(weights);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(threads_and_executors_leave_every_bit)
{
    const sph_executor executors[] = {test_executor_reverse(), test_executor_scattered(), test_executor_threads()};
    sph_context *others[] = {test_context_with_threads(1),
                             test_context_with_threads(2),
                             test_context_with_threads(5),
                             test_context_with_executor(&executors[0]),
                             test_context_with_executor(&executors[1]),
                             test_context_with_executor(&executors[2])};
    for (unsigned kind = 0; kind <= AWKWARD_KIND_COUNT; ++kind) { /* the last one has enough vertices for many blocks */
        const sph_hierarchy_options o = choose((unsigned)_i);
        sph_animation *animation =
            kind < AWKWARD_KIND_COUNT ? awkward(context, kind, FRAMES) : test_sphere(context, 3, 2);
        sph_hierarchy *h = build(animation, &o);
        for (unsigned i = 0; i < sizeof others / sizeof *others; ++i) {
            sph_animation *same =
                kind < AWKWARD_KIND_COUNT ? awkward(others[i], kind, FRAMES) : test_sphere(others[i], 3, 2);
            sph_hierarchy *g = build(same, &o);
            check_same(h, g, 1, 1);
            sph_hierarchy_destroy(g);
            sph_animation_destroy(same);
        }
        sph_hierarchy_destroy(h);
        sph_animation_destroy(animation);
    }
    for (unsigned i = 0; i < sizeof others / sizeof *others; ++i)
        sph_context_destroy(others[i]);
}
END_TEST

START_TEST(a_frame_source_gives_what_stored_frames_give)
{
    sph_animation *animation = awkward(context, (unsigned)_i, FRAMES);
    test_source source = {.from = animation};
    sph_animation *pulled = test_pulled(context, &source);
    sph_hierarchy *h = build(animation, NULL), *g = build(pulled, NULL);
    ck_assert_uint_eq(source.reads, FRAMES); /* each once */
    check_same(h, g, 1, 1);
    sph_hierarchy_destroy(h);
    sph_hierarchy_destroy(g);
    sph_animation_destroy(pulled);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(a_hierarchy_outlives_its_animation_and_context)
{
    sph_context *own = test_context();
    sph_animation *animation = test_torus(own, 8, 6, 3), *same = test_torus(context, 8, 6, 3);
    sph_hierarchy *h = build(animation, NULL), *g = build(same, NULL);
    sph_animation_destroy(animation);
    sph_context_destroy(own);
    check_same(h, g, 1, 1);
    sph_hierarchy_destroy(h);
    sph_hierarchy_destroy(g);
    sph_animation_destroy(same);
}
END_TEST

/* --- orientation --- */

static const unsigned CLOSED[] = {AWKWARD_CUBE,     AWKWARD_SPHERE,   AWKWARD_TORUS,
                                  AWKWARD_SQUASHED, AWKWARD_WHISKERS, AWKWARD_COLLAPSING};
enum { CLOSED_COUNT = sizeof CLOSED / sizeof *CLOSED };

START_TEST(a_component_inside_out_gives_the_same_spheres)
{
    const awkward_options in = {.frames = FRAMES, .inward = true}, out = {.frames = FRAMES};
    sph_animation *inward = awkward_animation(context, CLOSED[_i], in);
    sph_animation *outward = awkward_animation(context, CLOSED[_i], out);
    for (unsigned choice = 0; choice < CHOICES; ++choice) {
        sph_hierarchy_options o = choose(choice);
        sph_hierarchy *h = build(outward, &o), *g = build(inward, &o);
        if (CLOSED[_i] != AWKWARD_SQUASHED) check_same(h, g, 1, 1); /* that one has no volume to tell by */
        sph_hierarchy_destroy(g);
        o.orientation = SPH_ORIENTATION_AS_GIVEN;
        g = build(outward, &o);
        check_same(h, g, 1, 1);
        sph_hierarchy_destroy(g);
        sph_hierarchy_destroy(h);
    }
    sph_animation_destroy(inward);
    sph_animation_destroy(outward);
}
END_TEST

/* Seen as they are wound, the planes of an inside-out sphere are touched from without: by no sphere of positive radius.
 */
START_TEST(orientation_as_given_leaves_a_component_inside_out)
{
    sph_animation *inward = awkward_animation(context, AWKWARD_SPHERE, (awkward_options){.frames = 1, .inward = true});
    sph_hierarchy_options o = default_options();
    const uint32_t root = 2 * sph_animation_vertex_count(inward) - 2;
    float radius;
    sph_hierarchy *h = build(inward, &o);
    ck_assert_int_eq(sph_hierarchy_sphere(h, root, NULL, &radius), SPH_OK);
    ck_assert_float_ge(radius, 0.85f); /* 1, but for the facets */
    sph_hierarchy_destroy(h);
    o.orientation = SPH_ORIENTATION_AS_GIVEN;
    h = build(inward, &o);
    ck_assert_int_eq(sph_hierarchy_sphere(h, root, NULL, &radius), SPH_OK);
    ck_assert_float_eq(radius, 0);
    sph_hierarchy_destroy(h);
    sph_animation_destroy(inward);
}
END_TEST

/* --- what keeps the collapses, if not every bit: on meshes of no symmetry, so that no two edges cost the same --- */

/* A soup on the grid of 1/1024, of which `copies` frames are taken in the order that `order` says, moved. */
static sph_animation *make_soup(uint64_t seed, unsigned frames, const unsigned *order, unsigned count,
                                const float *shift)
{
    sph_animation *soup = test_soup(context, 30, 70, frames, seed), *animation = NULL;
    float xyz[30][3];
    ck_assert_int_eq(sph_animation_create(context, 30, count, &animation), SPH_OK);
    for (unsigned f = 0; f < count; ++f) {
        ck_assert_int_eq(sph_animation_read_frame(soup, order[f], xyz[0]), SPH_OK);
        for (unsigned i = 0; i < 90; ++i) {
            float *x = &xyz[i / 3][i % 3];
            *x = (float)floor((double)*x * 1024) / 1024 + shift[i % 3];
        }
        ck_assert_int_eq(sph_animation_set_frame(animation, f, xyz[0], 0), SPH_OK);
    }
    ck_assert_int_eq(sph_animation_set_triangles(animation, sph_animation_triangles(soup), 70, 0), SPH_OK);
    sph_animation_destroy(soup);
    return animation;
}

static const float NOWHERE[3] = {0, 0, 0};
static const unsigned NATURAL[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};

/* The same collapses, at costs that agree to 32 bits or so. */
static void check_alike(const sph_hierarchy *a, const sph_hierarchy *b, double weight)
{
    ck_assert_uint_eq(sph_hierarchy_collapse_count(a), sph_hierarchy_collapse_count(b));
    for (uint32_t t = 0; t < sph_hierarchy_collapse_count(a); ++t) {
        sph_collapse x, y;
        ck_assert_int_eq(sph_hierarchy_collapse(a, t, &x), SPH_OK);
        ck_assert_int_eq(sph_hierarchy_collapse(b, t, &y), SPH_OK);
        ck_assert_msg(x.u == y.u && x.v == y.v, "collapse %u: (%u, %u) and (%u, %u)", t, x.u, x.v, y.u, y.v);
        ck_assert_double_eq_tol(x.cost * weight, y.cost, 1e-4 * x.cost * weight + 1e-6);
        ck_assert_double_eq_tol(x.error, y.error, 1e-4);
    }
}

START_TEST(moving_the_whole_keeps_the_collapses)
{
    static const float FAR[3] = {16, -4, 8};
    const unsigned choice = (unsigned)_i % CHOICES;
    const sph_hierarchy_options o = choose(choice);
    sph_animation *here = make_soup(1000 + (uint64_t)_i, 3, NATURAL, 3, NOWHERE);
    sph_animation *there = make_soup(1000 + (uint64_t)_i, 3, NATURAL, 3, FAR);
    sph_hierarchy *h = build(here, &o), *g = build(there, &o);
    check_alike(h, g, 1);
    sph_hierarchy_destroy(h);
    sph_hierarchy_destroy(g);
    sph_animation_destroy(here);
    sph_animation_destroy(there);
}
END_TEST

START_TEST(repeating_a_frame_multiplies_the_costs_alone)
{
    static const unsigned COPIES[] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    const sph_hierarchy_options o = choose((unsigned)_i % CHOICES);
    sph_animation *once = make_soup(2000 + (uint64_t)_i, 1, COPIES, 1, NOWHERE);
    sph_animation *often = make_soup(2000 + (uint64_t)_i, 1, COPIES, 10, NOWHERE);
    sph_hierarchy *h = build(once, &o), *g = build(often, &o);
    check_alike(h, g, 10);
    sph_hierarchy_destroy(h);
    sph_hierarchy_destroy(g);
    sph_animation_destroy(once);
    sph_animation_destroy(often);
}
END_TEST

START_TEST(frames_may_come_in_any_order)
{
    static const unsigned ORDER[] = {4, 1, 9, 0, 7, 6, 2, 8, 3, 5};
    const sph_hierarchy_options o = choose((unsigned)_i % CHOICES);
    sph_animation *natural = make_soup(3000 + (uint64_t)_i, 10, NATURAL, 10, NOWHERE);
    sph_animation *shuffled = make_soup(3000 + (uint64_t)_i, 10, ORDER, 10, NOWHERE);
    sph_hierarchy *h = build(natural, &o), *g = build(shuffled, &o);
    check_alike(h, g, 1);
    sph_hierarchy_destroy(h);
    sph_hierarchy_destroy(g);
    sph_animation_destroy(natural);
    sph_animation_destroy(shuffled);
}
END_TEST

/* One frame has one radius, however it is asked for. */
START_TEST(with_one_frame_radii_per_frame_are_the_constant_ones)
{
    sph_animation *animation = make_soup(4000 + (uint64_t)_i, 1, NATURAL, 1, NOWHERE);
    sph_hierarchy_options o = choose((unsigned)_i % 4 * MODES);
    sph_hierarchy *constant = build(animation, &o), *per_frame;
    o.radius_mode = SPH_RADIUS_PER_FRAME;
    per_frame = build(animation, &o);
    check_alike(constant, per_frame, 1);
    for (uint32_t node = 0; node < 30 + sph_hierarchy_collapse_count(constant); ++node) {
        float a[4], b[4];
        ck_assert_int_eq(sph_hierarchy_sphere(constant, node, a, a + 3), SPH_OK);
        ck_assert_int_eq(sph_hierarchy_sphere(per_frame, node, b, b + 3), SPH_OK);
        for (unsigned k = 0; k < 4; ++k)
            ck_assert_float_le(fabsf(a[k] - b[k]), 2e-3f);
    }
    sph_hierarchy_destroy(constant);
    sph_hierarchy_destroy(per_frame);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(a_radius_factor_of_zero_is_radius_zero)
{
    sph_animation *animation = make_soup(5000 + (uint64_t)_i, 10, NATURAL, 10, NOWHERE);
    sph_hierarchy_options o = default_options();
    sph_hierarchy *zero, *bounded;
    o.radius_mode = SPH_RADIUS_ZERO;
    zero = build(animation, &o);
    o.radius_factor = 0;
    for (o.radius_mode = 0; o.radius_mode < 2; ++o.radius_mode) {
        bounded = build(animation, &o);
        for (uint32_t node = 0; node < 30 + sph_hierarchy_collapse_count(bounded); ++node) {
            float radii[10];
            ck_assert_int_eq(sph_hierarchy_sphere(bounded, node, NULL, radii), SPH_OK);
            for (unsigned f = 0; f < 10; ++f)
                ck_assert_float_eq(radii[f], 0);
        }
        if (o.radius_mode == SPH_RADIUS_CONSTANT) check_alike(zero, bounded, 1);
        sph_hierarchy_destroy(bounded);
    }
    sph_hierarchy_destroy(zero);
    sph_animation_destroy(animation);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("hierarchy invariance");
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, scaling_by_a_power_of_two_scales_the_result, 0, AWKWARD_KIND_COUNT);
    tcase_add_loop_test(tc, scaling_all_weights_by_a_power_of_two_scales_the_costs, 0, AWKWARD_KIND_COUNT);
    tcase_add_loop_test(tc, weights_of_one_are_no_weights, 0, AWKWARD_KIND_COUNT);
    tcase_add_loop_test(tc, threads_and_executors_leave_every_bit, 0, CHOICES);
    tcase_add_loop_test(tc, a_frame_source_gives_what_stored_frames_give, 0, AWKWARD_KIND_COUNT);
    tcase_add_test(tc, a_hierarchy_outlives_its_animation_and_context);
    tcase_add_loop_test(tc, a_component_inside_out_gives_the_same_spheres, 0, CLOSED_COUNT);
    tcase_add_test(tc, orientation_as_given_leaves_a_component_inside_out);
    tcase_add_loop_test(tc, moving_the_whole_keeps_the_collapses, 0, SEEDS);
    tcase_add_loop_test(tc, repeating_a_frame_multiplies_the_costs_alone, 0, SEEDS);
    tcase_add_loop_test(tc, frames_may_come_in_any_order, 0, SEEDS);
    tcase_add_loop_test(tc, with_one_frame_radii_per_frame_are_the_constant_ones, 0, SEEDS);
    tcase_add_loop_test(tc, a_radius_factor_of_zero_is_radius_zero, 0, SEEDS);
    return run_suite(suite, tc);
}
