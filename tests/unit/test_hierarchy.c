/* SPDX-License-Identifier: MIT */
/* What holds of the hierarchy of any input. */
#include <math.h>
#include <stdlib.h>

#include "awkward.h"
#include "hierarchy_case.h"
#include "runner.h"

static const unsigned FRAMES[] = {1, 7, 8, 9, 40};
enum { FRAME_CHOICES = sizeof FRAMES / sizeof *FRAMES };

/* The largest distance of two vertices in any frame: no width of any region, and so no radius, can be more. */
static double largest_distance(const sph_animation *animation)
{
    const uint32_t n = sph_animation_vertex_count(animation);
    float(*xyz)[3] = test_malloc(n, sizeof *xyz);
    double largest = 0;
    for (uint32_t f = 0; f < sph_animation_frame_count(animation); ++f) {
        ck_assert_int_eq(sph_animation_read_frame(animation, f, xyz[0]), SPH_OK);
        for (uint32_t i = 0; i < n; ++i)
            for (uint32_t j = 0; j < i; ++j) {
                const double x = (double)xyz[i][0] - (double)xyz[j][0], y = (double)xyz[i][1] - (double)xyz[j][1];
                const double z = (double)xyz[i][2] - (double)xyz[j][2];
                largest = fmax(largest, sqrt(x * x + y * y + z * z));
            }
    }
    free(xyz);
    return largest;
}

/* Leaves are the input's vertices. What is smaller than the whole by more than 32 bits hold may be lost. */
static void check_leaves(const sph_hierarchy *h, const sph_animation *animation)
{
    const double tiny = 0x1p-125 * sph_hierarchy_bounding_diagonal(h);
    const uint32_t n = sph_animation_vertex_count(animation), frames = sph_animation_frame_count(animation);
    float(*xyz)[3] = test_malloc(n, sizeof *xyz), (*centers)[3] = test_malloc(frames, sizeof *centers);
    float *radii = test_malloc(frames, sizeof *radii);
    for (uint32_t f = 0; f < frames; ++f) {
        ck_assert_int_eq(sph_animation_read_frame(animation, f, xyz[0]), SPH_OK);
        for (uint32_t v = 0; v < n; ++v) {
            ck_assert_int_eq(sph_hierarchy_sphere(h, v, centers[0], radii), SPH_OK);
            for (unsigned k = 0; k < 3; ++k)
                ck_assert_double_le(fabs((double)centers[f][k] - (double)xyz[v][k]), tiny);
            ck_assert_float_eq(radii[f], 0);
        }
    }
    free(xyz);
    free(centers);
    free(radii);
}

static void check_spheres(const sph_hierarchy *h, int32_t mode, double radius_most)
{
    const uint32_t frames = sph_hierarchy_frame_count(h);
    const uint32_t nodes = sph_hierarchy_vertex_count(h) + sph_hierarchy_collapse_count(h);
    float(*centers)[3] = test_malloc(frames, sizeof *centers), *radii = test_malloc(frames, sizeof *radii);
    for (uint32_t node = 0; node < nodes; ++node) {
        ck_assert_int_eq(sph_hierarchy_sphere(h, node, centers[0], radii), SPH_OK);
        for (uint32_t f = 0; f < frames; ++f) {
            for (unsigned k = 0; k < 3; ++k)
                ck_assert(isfinite(centers[f][k]));
            ck_assert(isfinite(radii[f]) && radii[f] >= 0);
            ck_assert_double_le((double)radii[f], radius_most * (1 + 1e-5));
            if (mode == SPH_RADIUS_ZERO) ck_assert_float_eq(radii[f], 0);
            if (mode == SPH_RADIUS_CONSTANT) ck_assert_float_eq(radii[f], radii[0]);
        }
    }
    free(centers);
    free(radii);
}

/* That collapses are a forest over the vertices, and their numbers sane. */
static void check_collapses(const sph_hierarchy *h)
{
    const uint32_t n = sph_hierarchy_vertex_count(h), collapses = sph_hierarchy_collapse_count(h);
    unsigned char *united = test_malloc(n + (size_t)collapses, 1);
    uint32_t first_forced = collapses;
    double error = 0;
    for (uint32_t t = 0; t < collapses; ++t) {
        sph_collapse c;
        ck_assert_int_eq(sph_hierarchy_collapse(h, t, &c), SPH_OK);
        ck_assert_uint_eq(c.node, n + t);
        ck_assert_uint_lt(c.u, c.v);
        ck_assert_uint_lt(c.v, c.node);
        ck_assert_msg(!united[c.u] && !united[c.v], "a node is united twice");
        united[c.u] = united[c.v] = 1;
        ck_assert(isfinite(c.cost) && c.cost >= 0);
        ck_assert(isfinite(c.error) && c.error >= error);
        ck_assert_uint_le(c.forced, 1);
        if (c.forced && first_forced == collapses) first_forced = t;
        error = c.error;
    }
    ck_assert_uint_eq(sph_hierarchy_first_forced(h), first_forced);
    free(united);
}

static void check_hierarchy(const sph_hierarchy *h, const sph_animation *animation, const sph_hierarchy_options *o)
{
    double diagonal = -1;
    const double bound = o->radius_factor * largest_distance(animation);
    ck_assert_uint_eq(sph_hierarchy_vertex_count(h), sph_animation_vertex_count(animation));
    ck_assert_uint_eq(sph_hierarchy_frame_count(h), sph_animation_frame_count(animation));
    ck_assert_uint_eq(sph_hierarchy_vertex_count(h) - sph_hierarchy_collapse_count(h), test_component_count(animation));
    ck_assert_uint_ge(sph_hierarchy_evaluation_count(h), sph_hierarchy_collapse_count(h));
    ck_assert_int_eq(sph_animation_bounding_diagonal(animation, &diagonal), SPH_OK);
    ck_assert_double_le(fabs(diagonal - sph_hierarchy_bounding_diagonal(h)), 1e-12 * diagonal);
    check_leaves(h, animation);
    check_collapses(h);
    check_spheres(h, o->radius_mode, bound);
}

/* Builds with every radius mode and importance, and checks. */
static void check_animation(sph_animation *animation, double coherence)
{
    ck_assert_ptr_nonnull(animation);
    for (int32_t mode = 0; mode < MODES; ++mode)
        for (int32_t importance = SPH_IMPORTANCE_NONE; importance <= SPH_IMPORTANCE_CURVATURE; ++importance) {
            sph_hierarchy_options o = default_options();
            sph_hierarchy *h;
            o.radius_mode = mode;
            o.importance = importance;
            o.temporal_coherence = coherence;
            h = build(animation, &o);
            check_hierarchy(h, animation, &o);
            sph_hierarchy_destroy(h);
        }
    sph_animation_destroy(animation);
}

START_TEST(every_input_comes_down_to_one_sphere_per_component)
{
    const unsigned kind = (unsigned)_i % AWKWARD_KIND_COUNT, frames = FRAMES[_i / AWKWARD_KIND_COUNT];
    check_animation(awkward(context, kind, frames), 0);
}
END_TEST

static const awkward_options PLACES[] = {{.frames = 3, .scale = 1e8},
                                         {.frames = 3, .scale = 2e16},
                                         {.frames = 3, .scale = 1e-20},
                                         {.frames = 3, .scale = 1e-37},
                                         {.frames = 3, .scale = 1e-44},
                                         {.frames = 3, .scale = 1, .shift = 1e5},
                                         {.frames = 3, .scale = 1, .shift = -1e9},
                                         {.frames = 3, .scale = 1e-3, .shift = 1e17}};
enum { PLACE_COUNT = sizeof PLACES / sizeof *PLACES };

START_TEST(inputs_of_any_size_anywhere_are_accepted)
{
    check_animation(awkward_animation(context, (unsigned)_i % AWKWARD_KIND_COUNT, PLACES[_i / AWKWARD_KIND_COUNT]), 0);
}
END_TEST

/* One frame small beyond all measure of the others, and far from them. */
START_TEST(frames_of_very_different_sizes_are_accepted)
{
    static const double SIZES[] = {1e-30, 1, 2e16, 0, 1e-44, 1e5};
    const unsigned kind = (unsigned)_i;
    sph_animation *animation = awkward(context, kind, 6);
    const uint32_t n = sph_animation_vertex_count(animation);
    float *xyz = test_malloc(n, 3 * sizeof *xyz);
    for (uint32_t f = 0; f < 6; ++f) {
        ck_assert_int_eq(sph_animation_read_frame(animation, f, xyz), SPH_OK);
        for (size_t i = 0; i < 3 * (size_t)n; ++i)
            xyz[i] = (float)((double)xyz[i] * SIZES[f]);
        ck_assert_int_eq(sph_animation_set_frame(animation, f, xyz, 0), SPH_OK);
    }
    free(xyz);
    check_animation(animation, 0);
}
END_TEST

/* All but a point in one frame, at the limit of coordinates: normalising the small frame may not overflow the other. */
START_TEST(a_small_mesh_that_jumps_far_away_stays_finite)
{
    sph_animation *animation = awkward_animation(context, AWKWARD_CUBE, (awkward_options){.frames = 2, .scale = 1e-30});
    float xyz[8][3];
    for (unsigned i = 0; i < 24; ++i)
        xyz[i / 3][i % 3] = 1e18f;
    ck_assert_int_eq(sph_animation_set_frame(animation, 1, xyz[0], 0), SPH_OK);
    check_animation(animation, 0);
}
END_TEST

START_TEST(temporal_coherence_keeps_everything_sane)
{
    static const double DELTAS[] = {1e-9, 0.02, 10, 1e300};
    const unsigned kind = (unsigned)_i % AWKWARD_KIND_COUNT;
    check_animation(awkward(context, kind, 9), DELTAS[_i / AWKWARD_KIND_COUNT]);
}
END_TEST

START_TEST(weights_of_zero_cost_nothing)
{
    sph_animation *animation = test_torus(context, 8, 6, 3);
    sph_hierarchy_options o = default_options();
    float weights[48] = {0};
    o.importance = SPH_IMPORTANCE_CALLER;
    o.importance_weights = weights;
    for (int32_t mode = 0; mode < MODES; ++mode) {
        sph_hierarchy *h;
        o.radius_mode = mode;
        h = build(animation, &o);
        check_hierarchy(h, animation, &o);
        for (uint32_t t = 0; t < sph_hierarchy_collapse_count(h); ++t) {
            sph_collapse c;
            ck_assert_int_eq(sph_hierarchy_collapse(h, t, &c), SPH_OK);
            ck_assert_double_eq(c.cost, 0);
            ck_assert_double_eq(c.error, 0);
        }
        sph_hierarchy_destroy(h);
    }
    sph_animation_destroy(animation);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("hierarchy");
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, every_input_comes_down_to_one_sphere_per_component, 0, AWKWARD_KIND_COUNT * FRAME_CHOICES);
    tcase_add_loop_test(tc, inputs_of_any_size_anywhere_are_accepted, 0, AWKWARD_KIND_COUNT * PLACE_COUNT);
    tcase_add_loop_test(tc, frames_of_very_different_sizes_are_accepted, 0, AWKWARD_KIND_COUNT);
    tcase_add_test(tc, a_small_mesh_that_jumps_far_away_stays_finite);
    tcase_add_loop_test(tc, temporal_coherence_keeps_everything_sane, 0, AWKWARD_KIND_COUNT * 4);
    tcase_add_test(tc, weights_of_zero_cost_nothing);
    return run_suite(suite, tc);
}
