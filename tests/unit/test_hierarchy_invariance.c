/* SPDX-License-Identifier: MIT */
/* What must not change a bit of a hierarchy, or change all in a known way. */
#include <math.h>
#include <stdlib.h>

#include "awkward.h"
#include "hierarchy_case.h"
#include "runner.h"

enum { FRAMES = 9 };

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
    sph_context *others[OTHERS];
    make_others(others);
    for (unsigned kind = 0; kind <= AWKWARD_KIND_COUNT; ++kind) { /* the last one has enough vertices for many blocks */
        const sph_hierarchy_options o = choose((unsigned)_i);
        sph_animation *animation =
            kind < AWKWARD_KIND_COUNT ? awkward(context, kind, FRAMES) : test_sphere(context, 3, 2);
        sph_hierarchy *h = build(animation, &o);
        for (unsigned i = 0; i < OTHERS; ++i) {
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
    for (unsigned i = 0; i < OTHERS; ++i)
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
    return run_suite(suite, tc);
}
