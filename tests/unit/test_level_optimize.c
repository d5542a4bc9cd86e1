/* SPDX-License-Identifier: MIT */
/* Connectivity optimisation against its definition: all candidates of all vertices in all frames. */
#include <math.h>
#include <stdlib.h>

#include "awkward.h"
#include "hierarchy_case.h"
#include "runner.h"
#include "simplicial.h"

enum { FRAMES = 9 };

/* The sum over frames of the signed distance from every vertex to every sphere: [n][K]. */
static double *all_distances(const sph_animation *animation, const sph_level_arrays *a)
{
    const uint32_t n = sph_animation_vertex_count(animation);
    double *sums = test_malloc((size_t)n * a->sphere_count, sizeof *sums);
    float(*xyz)[3] = test_malloc(n, sizeof *xyz);
    for (uint32_t f = 0; f < a->frame_count; ++f) {
        ck_assert_int_eq(sph_animation_read_frame(animation, f, xyz[0]), SPH_OK);
        for (uint32_t v = 0; v < n; ++v)
            for (uint32_t s = 0; s < a->sphere_count; ++s) {
                const size_t at = (size_t)f * a->sphere_count + s;
                double squared = 0;
                for (unsigned k = 0; k < 3; ++k)
                    squared += pow((double)xyz[v][k] - (double)a->centers[3 * at + k], 2);
                sums[(size_t)v * a->sphere_count + s] += sqrt(squared) - (double)a->radii[a->radii_per_frame ? at : s];
            }
    }
    free(xyz);
    return sums;
}

/*
 * Optimises `level` and checks its labels and simplices; spheres may not change. Labels are compared by what they cost,
 * as sums that are equal but for rounding may go either way; those that are clearly cheapest have no choice.
 */
static void optimize_and_check(sph_level *level, const sph_animation *animation)
{
    const sph_level_arrays old = arrays_of(level);
    const uint32_t n = sph_animation_vertex_count(animation), spheres = old.sphere_count;
    const char *wrong;
    simplicial before = simplicial_of_level(&old, &wrong), expected, found;
    uint32_t *labels = test_malloc(n, sizeof *labels);
    double *sums = all_distances(animation, &old);
    sph_level_arrays a;
    ck_assert_msg(wrong == NULL, "before: %s", wrong);
    memcpy(labels, old.labels, n * sizeof *labels);
    ck_assert_int_eq(sph_level_optimize_connectivity(level, animation), SPH_OK);
    a = arrays_of(level);
    ck_assert(a.centers == old.centers && a.radii == old.radii);
    ck_assert_uint_eq(a.sphere_count, spheres);
    ck_assert_uint_eq(a.label_count, n);
    for (uint32_t v = 0; v < n; ++v) {
        const double *sum = sums + (size_t)v * spheres;
        double least;
        if (labels[v] == SPH_NO_SPHERE) {
            ck_assert_uint_eq(a.labels[v], SPH_NO_SPHERE);
            continue;
        }
        least = sum[labels[v]];
        for (uint32_t s = 0; s < spheres; ++s)
            if (simplicial_has_edge(&before, labels[v], s)) least = fmin(least, sum[s]);
        ck_assert_uint_lt(a.labels[v], spheres);
        ck_assert(a.labels[v] == labels[v] || simplicial_has_edge(&before, labels[v], a.labels[v]));
        ck_assert_double_le(sum[a.labels[v]], least + 1e-9 * (fabs(least) + 1));
        if (sum[labels[v]] <= least) ck_assert_uint_eq(a.labels[v], labels[v]); /* its own, of equals */
    }
    expected = simplicial_of_labels(animation, a.labels, spheres);
    found = simplicial_of_level(&a, &wrong);
    ck_assert_msg(wrong == NULL, "%u spheres: %s", spheres, wrong);
    ck_assert_msg(simplicial_equal(&expected, &found), "%u spheres: not the duals of the labels", spheres);
    simplicial_free(&before);
    simplicial_free(&expected);
    simplicial_free(&found);
    free(labels);
    free(sums);
}

START_TEST(vertices_go_to_their_nearest_neighbour_and_simplices_follow)
{
    const unsigned kind = (unsigned)_i % AWKWARD_KIND_COUNT;
    sph_animation *animation = awkward(context, kind, _i < AWKWARD_KIND_COUNT ? 1 : FRAMES);
    for (int32_t mode = 0; mode < MODES; ++mode) {
        sph_hierarchy *h = build_mode(animation, mode);
        const uint32_t n = sph_hierarchy_vertex_count(h), least = n - sph_hierarchy_collapse_count(h);
        for (uint32_t count = least; count <= n; count += 1 + count / 8) {
            sph_level *level;
            ck_assert_int_eq(sph_level_create(h, count, &level), SPH_OK);
            optimize_and_check(level, animation);
            optimize_and_check(level, animation); /* and from there again */
            sph_level_destroy(level);
        }
        sph_hierarchy_destroy(h);
    }
    sph_animation_destroy(animation);
}
END_TEST

/* Spheres are the vertices: none is nearer than a vertex's own. Nor is any in the coarsest level. */
START_TEST(the_finest_and_the_coarsest_level_are_optimal)
{
    sph_animation *animation = awkward(context, (unsigned)_i, FRAMES);
    sph_hierarchy *h = build_mode(animation, SPH_RADIUS_CONSTANT);
    const uint32_t n = sph_hierarchy_vertex_count(h);
    for (unsigned end = 0; end < 2; ++end) {
        const uint32_t count = end == 0 ? n : n - sph_hierarchy_collapse_count(h);
        sph_level *level, *untouched;
        sph_level_arrays a, b;
        ck_assert_int_eq(sph_level_create(h, count, &level), SPH_OK);
        ck_assert_int_eq(sph_level_create(h, count, &untouched), SPH_OK);
        ck_assert_int_eq(sph_level_optimize_connectivity(level, animation), SPH_OK);
        a = arrays_of(level);
        b = arrays_of(untouched);
        ck_assert_mem_eq(a.labels, b.labels, n * sizeof *a.labels);
        ck_assert_uint_eq(a.edge_count, b.edge_count);
        ck_assert_uint_eq(a.triangle_count, b.triangle_count);
        if (a.edge_count != 0) ck_assert_mem_eq(a.edges, b.edges, 2 * a.edge_count * sizeof *a.edges);
        sph_level_destroy(level);
        sph_level_destroy(untouched);
    }
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(what_no_sphere_holds_stays_free)
{
    sph_animation *animation = test_torus(context, 9, 6, FRAMES);
    sph_hierarchy *h = build_mode(animation, SPH_RADIUS_CONSTANT);
    sph_level *level, *holes;
    sph_level_arrays a;
    uint32_t labels[54];
    ck_assert_int_eq(sph_level_create(h, 12, &level), SPH_OK);
    a = arrays_of(level);
    memcpy(labels, a.labels, sizeof labels);
    for (unsigned v = 0; v < 54; v += 5)
        labels[v] = SPH_NO_SPHERE;
    a.labels = labels;
    ck_assert_int_eq(sph_level_create_from_arrays(context, &a, &holes), SPH_OK);
    optimize_and_check(holes, animation);
    for (unsigned v = 0; v < 54; ++v)
        labels[v] = SPH_NO_SPHERE;
    sph_level_destroy(holes);
    ck_assert_int_eq(sph_level_create_from_arrays(context, &a, &holes), SPH_OK);
    optimize_and_check(holes, animation);
    a = arrays_of(holes);
    ck_assert_uint_eq(a.edge_count + a.triangle_count, 0);
    sph_level_destroy(holes);
    sph_level_destroy(level);
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
}
END_TEST

/* A caller's level may name spheres twice and triangles that the animation has not. */
START_TEST(a_callers_level_may_be_any)
{
    static const float centers[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                       radii[4] = {0.1f, 0.2f, 0.3f, 0.4f};
    static const uint32_t edges[4][2] = {{0, 0}, {1, 0}, {0, 1}, {3, 3}},
                          triangles[3][3] = {{0, 1, 2}, {2, 1, 0}, {2, 2, 3}};
    sph_animation *animation = test_soup(context, 40, 80, 1, 5);
    sph_level_arrays a = {sizeof a, 4, 1, 0, centers[0], radii, 4, edges[0], 3, triangles[0], 40, NULL};
    uint32_t labels[40];
    double *sums = all_distances(animation, &a);
    sph_level *level;
    for (unsigned v = 0; v < 40; ++v)
        labels[v] = v % 4;
    a.labels = labels;
    ck_assert_int_eq(sph_level_create_from_arrays(context, &a, &level), SPH_OK);
    ck_assert_int_eq(sph_level_optimize_connectivity(level, animation), SPH_OK);
    a = arrays_of(level);
    for (unsigned v = 0; v < 40; ++v) {
        uint32_t best = labels[v];
        for (uint32_t s = 0; s < 4; ++s) { /* 3 is next to 2 alone */
            const bool next = labels[v] == 3 ? s >= 2 : labels[v] == 2 || s != 3;
            if (next && sums[4 * v + s] < sums[4 * v + best]) best = s;
        }
        ck_assert_uint_eq(a.labels[v], best);
    }
    optimize_and_check(level, animation);
    sph_level_destroy(level);
    sph_animation_destroy(animation);
    free(sums);
}
END_TEST

START_TEST(threads_and_executors_leave_every_bit)
{
    sph_context *others[OTHERS];
    sph_level *first = NULL;
    make_others(others);
    for (unsigned i = 0; i < OTHERS; ++i) {
        sph_animation *animation = test_sphere(others[i], 4, 3);
        sph_hierarchy *h = build_mode(animation, SPH_RADIUS_ZERO);
        sph_level *level;
        ck_assert_int_eq(sph_level_create(h, 60, &level), SPH_OK);
        ck_assert_int_eq(sph_level_optimize_connectivity(level, animation), SPH_OK);
        if (first == NULL) {
            first = level;
        } else {
            const sph_level_arrays a = arrays_of(first), b = arrays_of(level);
            ck_assert_mem_eq(a.labels, b.labels, a.label_count * sizeof *a.labels);
            ck_assert_uint_eq(a.triangle_count, b.triangle_count);
            ck_assert_mem_eq(a.triangles, b.triangles, 3 * a.triangle_count * sizeof *a.triangles);
            sph_level_destroy(level);
        }
        sph_hierarchy_destroy(h);
        sph_animation_destroy(animation);
    }
    sph_level_destroy(first);
    for (unsigned i = 0; i < OTHERS; ++i)
        sph_context_destroy(others[i]);
}
END_TEST

static void check_refused(sph_level *level, const sph_animation *animation, const char *text)
{
    const sph_level_arrays before = arrays_of(level);
    sph_level_arrays after;
    ck_assert_int_eq(sph_level_optimize_connectivity(level, animation), SPH_E_INVALID);
    ck_assert_msg(strstr(sph_context_last_message(context), text) != NULL, "'%s' is not in '%s'", text,
                  sph_context_last_message(context));
    after = arrays_of(level);
    ck_assert_mem_eq(&before, &after, sizeof before);
}

START_TEST(another_animation_is_refused_and_the_message_says_both_counts)
{
    sph_animation *animation = test_torus(context, 9, 6, 3), *frames = test_torus(context, 9, 6, 4);
    sph_animation *vertices = test_torus(context, 9, 7, 3);
    sph_hierarchy *h = build_mode(animation, SPH_RADIUS_CONSTANT);
    sph_level *level, *unlabelled;
    sph_level_arrays a;
    float xyz[54][3];
    ck_assert_int_eq(sph_level_create(h, 12, &level), SPH_OK);
    check_refused(level, frames, "3");
    check_refused(level, frames, "4");
    check_refused(level, vertices, "54");
    check_refused(level, vertices, "63");
    a = arrays_of(level);
    a.label_count = 0;
    a.labels = NULL;
    ck_assert_int_eq(sph_level_create_from_arrays(context, &a, &unlabelled), SPH_OK);
    check_refused(unlabelled, animation, "labels");
    ck_assert_int_eq(sph_animation_read_frame(animation, 2, xyz[0]), SPH_OK);
    xyz[33][1] = NAN;
    ck_assert_int_eq(sph_animation_set_frame(animation, 2, xyz[0], 0), SPH_OK);
    check_refused(level, animation, "frame 2");
    check_refused(level, animation, "vertex 33");
    sph_level_destroy(unlabelled);
    sph_level_destroy(level);
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
    sph_animation_destroy(frames);
    sph_animation_destroy(vertices);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("level optimisation");
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, vertices_go_to_their_nearest_neighbour_and_simplices_follow, 0, 2 * AWKWARD_KIND_COUNT);
    tcase_add_loop_test(tc, the_finest_and_the_coarsest_level_are_optimal, 0, AWKWARD_KIND_COUNT);
    tcase_add_test(tc, what_no_sphere_holds_stays_free);
    tcase_add_test(tc, a_callers_level_may_be_any);
    tcase_add_test(tc, threads_and_executors_leave_every_bit);
    tcase_add_test(tc, another_animation_is_refused_and_the_message_says_both_counts);
    return run_suite(suite, tc);
}
