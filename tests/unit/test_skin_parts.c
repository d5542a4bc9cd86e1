/* SPDX-License-Identifier: MIT */
/* Parts of the decomposition: bone heat, visibility, the geodesic filter, and weights of a mixed goal. */
#include <check.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "animation/animation.h"
#include "skin/filter.h"
#include "skin/heat.h"
#include "skin/learn.h"
#include "skin/visible.h"
#include "runner.h"
#include "skin_rig.h"
#include "support.h"

static sph_context *context;
static skin_rig rig;
static sph__reach reach;
static double pivots[RIG_BONES][3];

static void setup(void)
{
    context = test_context();
    skin_rig_init(&rig, context, RIG_BENDS, 3);
    ck_assert_int_eq(sph__reach_find(&reach, context, RIG_BONES, rig.labels, rig.triangles[0], RIG_TRIANGLES, NULL, 0, 9),
                     SPH_OK);
    for (int b = 0; b < RIG_BONES; ++b)
        pivots[b][0] = 0.75 + 1.5 * b;
}

static void teardown(void)
{
    sph__reach_free(&reach);
    skin_rig_free(&rig);
    sph_context_destroy(context);
}

static sph__progress quiet(void)
{
    sph__progress progress;
    sph__progress_begin(&progress, context);
    sph__progress_part(&progress, 1);
    return progress;
}

/* --- bone heat --- */

static double cotangent(const float *apex, const float *a, const float *b)
{
    double u[3], v[3], dot = 0, cross = 0;
    for (int k = 0; k < 3; ++k) {
        u[k] = (double)a[k] - (double)apex[k];
        v[k] = (double)b[k] - (double)apex[k];
        dot += u[k] * v[k];
    }
    for (int k = 0; k < 3; ++k) {
        const double c = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
        cross += c * c;
    }
    return dot / sqrt(cross);
}

/* The dense system; from inside a tube every bone is seen, and the nearest is known. */
static void solve_dense(double *weights)
{
    enum { N = RIG_VERTICES };
    double *m = calloc(N * N, sizeof *m), *areas = calloc(N, sizeof *areas);
    lapack_int *order = calloc(N, sizeof *order);
    ck_assert(m != NULL && areas != NULL && order != NULL);
    sph__cell_areas(rig.triangles[0], RIG_TRIANGLES, rig.rest[0], N, areas);
    for (size_t t = 0; t < RIG_TRIANGLES; ++t)
        for (int c = 0; c < 3; ++c) {
            const uint32_t *corner = rig.triangles[t], a = corner[(c + 1) % 3], b = corner[(c + 2) % 3];
            const double half = 0.5 * cotangent(rig.rest[corner[c]], rig.rest[a], rig.rest[b]);
            m[a * N + b] -= half;
            m[b * N + a] -= half;
            m[a * N + a] += half;
            m[b * N + b] += half;
        }
    memset(weights, 0, N * RIG_BONES * sizeof *weights);
    for (size_t v = 0; v < N; ++v) {
        double d2[RIG_BONES], least = INFINITY, rate;
        uint32_t count = 0;
        for (int b = 0; b < RIG_BONES; ++b) {
            d2[b] = 0;
            for (int k = 0; k < 3; ++k)
                d2[b] += ((double)rig.rest[v][k] - pivots[b][k]) * ((double)rig.rest[v][k] - pivots[b][k]);
            least = fmin(least, d2[b]);
        }
        rate = areas[v] / least;
        m[v * N + v] += rate;
        for (int b = 0; b < RIG_BONES; ++b)
            count += d2[b] <= 1.0002 * least;
        for (int b = 0; b < RIG_BONES; ++b)
            if (d2[b] <= 1.0002 * least) weights[v * RIG_BONES + b] = rate / count;
    }
    ck_assert_int_eq(LAPACKE_dgesv(LAPACK_ROW_MAJOR, N, RIG_BONES, m, N, order, weights, RIG_BONES), 0);
    free(m);
    free(areas);
    free(order);
}

START_TEST(bone_heat_agrees_with_a_dense_solution_and_sums_to_one)
{
    double dense[RIG_VERTICES * RIG_BONES], *rows = calloc(RIG_VERTICES * RIG_BONES, sizeof *rows);
    const sph__heat_input in = {.context = context,
                                .n = RIG_VERTICES,
                                .bones = RIG_BONES,
                                .rest = rig.rest[0],
                                .labels = rig.labels,
                                .triangles = rig.triangles[0],
                                .triangle_count = RIG_TRIANGLES,
                                .pivots = pivots[0],
                                .scale = 6,
                                .reach = &reach};
    sph__progress progress = quiet();
    ck_assert_uint_eq(reach.most, RIG_BONES);
    ck_assert_int_eq(sph__heat_weights(&in, rows, &progress), SPH_OK);
    solve_dense(dense);
    for (size_t v = 0; v < RIG_VERTICES; ++v) {
        double sum = 0;
        for (size_t i = 0; i < RIG_BONES; ++i) {
            const uint32_t bone = reach.bones[reach.starts[rig.labels[v]] + i];
            ck_assert_double_eq_tol(rows[v * RIG_BONES + i], dense[v * RIG_BONES + bone], 1e-6);
            sum += rows[v * RIG_BONES + i];
        }
        ck_assert_double_eq_tol(sum, 1, 1e-6);
    }
    free(rows);
}
END_TEST

/* Signed volume of a tetrahedron, six times. */
static double volume(const double *a, const double *b, const double *c, const double *d)
{
    double u[3], v[3], w[3];
    for (int k = 0; k < 3; ++k) {
        u[k] = b[k] - a[k];
        v[k] = c[k] - a[k];
        w[k] = d[k] - a[k];
    }
    return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
}

/* By signs of volumes, over all triangles; *close says that a sign is in doubt. */
static bool sees(uint32_t vertex, const double point[3], bool *close)
{
    double p[3], x[3][3];
    bool free_way = true;
    for (int k = 0; k < 3; ++k)
        p[k] = (double)rig.rest[vertex][k];
    *close = false;
    for (size_t t = 0; t < RIG_TRIANGLES; ++t) {
        const uint32_t *c = rig.triangles[t];
        double sides[3], from, to;
        if (c[0] == vertex || c[1] == vertex || c[2] == vertex) continue;
        for (int i = 0; i < 9; ++i)
            x[i / 3][i % 3] = (double)rig.rest[c[i / 3]][i % 3];
        from = volume(x[0], x[1], x[2], p);
        to = volume(x[0], x[1], x[2], point);
        if (fabs(from) < 1e-9) continue; /* the vertex is in the triangle's plane, and none of its corners */
        for (int i = 0; i < 3; ++i) {
            sides[i] = volume(p, point, x[i], x[(i + 1) % 3]);
            *close = *close || (from * to < 0 && fabs(sides[i]) < 1e-9);
        }
        *close = *close || fabs(to) < 1e-9;
        if (from * to < 0 && ((sides[0] > 0 && sides[1] > 0 && sides[2] > 0) ||
                              (sides[0] < 0 && sides[1] < 0 && sides[2] < 0)))
            free_way = false;
    }
    return free_way;
}

START_TEST(visibility_agrees_with_a_test_of_all_triangles)
{
    sph__occluder occluder;
    uint64_t state = 1;
    uint32_t seen = 0, hidden = 0;
    ck_assert_int_eq(sph__occluder_init(&occluder, context, rig.rest[0], rig.triangles[0], RIG_TRIANGLES), SPH_OK);
    for (int i = 0; i < 4000; ++i) {
        const uint32_t vertex = (uint32_t)(test_random(&state) % RIG_VERTICES);
        const double point[3] = {8 * test_random_unit(&state) - 1, 2 * test_random_unit(&state) - 1,
                                 2 * test_random_unit(&state) - 1};
        bool close;
        const bool expected = sees(vertex, point, &close);
        if (close) continue;
        ck_assert_int_eq(sph__occluder_sees(&occluder, vertex, point), expected);
        seen += expected;
        hidden += !expected;
    }
    ck_assert(seen > 300 && hidden > 300);
    sph__occluder_free(&occluder);
}
END_TEST

/* --- the filter and mixed weights --- */

static void make_problem(sph__problem *p)
{
    static const sph_skin_source NONE;
    sph_skin_source source = NONE;
    sph__problem_input in = {.context = context,
                             .source_count = 1,
                             .n = RIG_VERTICES,
                             .bones = RIG_BONES,
                             .frames = RIG_FRAMES,
                             .limit = 2,
                             .labels = rig.labels,
                             .reach = &reach,
                             .rest = rig.rest[0],
                             .pivots = pivots[0]};
    sph__progress progress = quiet();
    source.animation = rig.animation;
    in.sources = &source;
    ck_assert_int_eq(sph__problem_init(p, &in, &progress), SPH_OK);
    for (size_t v = 0; v < p->n; ++v) { /* what the rig has not: steps */
        const uint32_t own = p->set[v];
        p->now.count[v] = 2;
        p->now.places[2 * v] = own;
        p->now.places[2 * v + 1] = (own + 1) % RIG_BONES;
        p->now.weights[2 * v] = 0.6 + 0.3 * (double)(v % 2);
        p->now.weights[2 * v + 1] = 1 - p->now.weights[2 * v];
    }
}

/* Shortest ways between all vertices along edges (Floyd and Warshall). */
static double *all_distances(void)
{
    enum { N = RIG_VERTICES };
    double *d = test_malloc(N * N, sizeof *d);
    for (size_t i = 0; i < N * N; ++i)
        d[i] = i / N == i % N ? 0 : INFINITY;
    for (size_t t = 0; t < RIG_TRIANGLES; ++t)
        for (int c = 0; c < 3; ++c) {
            const uint32_t a = rig.triangles[t][c], b = rig.triangles[t][(c + 1) % 3];
            double sum = 0;
            for (int k = 0; k < 3; ++k)
                sum += ((double)rig.rest[a][k] - (double)rig.rest[b][k]) *
                       ((double)rig.rest[a][k] - (double)rig.rest[b][k]);
            d[a * N + b] = d[b * N + a] = sqrt(sum);
        }
    for (size_t k = 0; k < N; ++k)
        for (size_t i = 0; i < N; ++i)
            for (size_t j = 0; j < N; ++j)
                d[i * N + j] = fmin(d[i * N + j], d[i * N + k] + d[k * N + j]);
    return d;
}

static sph__filter make_filter(const sph__problem *p, double sigma)
{
    const sph__filter_input in = {.context = context,
                                  .problem = p,
                                  .rest = rig.rest[0],
                                  .triangles = rig.triangles[0],
                                  .triangle_count = RIG_TRIANGLES,
                                  .sigma = sigma};
    sph__progress progress = quiet();
    sph__filter filter;
    ck_assert_int_eq(sph__filter_init(&filter, &in, &progress), SPH_OK);
    return filter;
}

START_TEST(filtered_weights_are_gaussian_means_over_ways_along_edges)
{
    const double sigma = 0.25;
    double areas[RIG_VERTICES], *distances = all_distances(), *smooth;
    sph__problem p;
    sph__filter filter;
    make_problem(&p);
    filter = make_filter(&p, sigma);
    smooth = test_malloc((size_t)p.n * p.most, sizeof *smooth);
    ck_assert_int_eq(sph__filter_apply(&filter, &p, smooth), SPH_OK);
    sph__cell_areas(rig.triangles[0], RIG_TRIANGLES, rig.rest[0], RIG_VERTICES, areas);
    for (size_t v = 0; v < p.n; ++v) {
        double sum = 0, means[RIG_BONES] = {0};
        for (size_t o = 0; o < p.n; ++o) {
            const double d = distances[p.vertex[v] * RIG_VERTICES + p.vertex[o]];
            const double share = d <= 3 * sigma ? exp(-0.5 * d * d / (sigma * sigma)) * areas[p.vertex[o]] : 0;
            sum += share;
            for (int s = 0; s < 2; ++s)
                means[p.now.places[2 * o + s]] += share * p.now.weights[2 * o + s];
        }
        for (int b = 0; b < RIG_BONES; ++b)
            ck_assert_double_eq_tol(smooth[v * p.most + b], means[b] / sum, 1e-6);
    }
    free(distances);
    free(smooth);
    sph__filter_free(&filter);
    sph__problem_free(&p);
}
END_TEST

START_TEST(no_vertex_goal_rises_in_a_mixed_step_and_shares_say_which_way_it_leans)
{
    double *smooth, *share;
    sph__learn_change *changes;
    sph__influences next = {0};
    sph__problem p;
    sph__filter filter;
    make_problem(&p);
    filter = make_filter(&p, 0.25);
    smooth = test_malloc((size_t)p.n * p.most, sizeof *smooth);
    share = test_malloc(p.n, sizeof *share);
    changes = test_malloc(p.n, sizeof *changes);
    ck_assert_int_eq(sph__filter_apply(&filter, &p, smooth), SPH_OK);
    ck_assert_int_eq(sph__influences_allocate(&p, &next), SPH_OK);
    for (size_t v = 0; v < p.n; ++v)
        share[v] = (double)(v % 5) / 5;
    {
        const sph__learn_goal goal = {_i * 1e-3, smooth, share};
        ck_assert_int_eq(sph__learn_weights(&p, &goal, &next, changes), SPH_OK);
    }
    for (size_t v = 0; v < p.n; ++v) {
        double sum = 0;
        ck_assert(changes[v].goal_after <= changes[v].goal_before * (1 + 1e-12) + 1e-15);
        ck_assert_uint_le(next.count[v], 2);
        for (uint32_t s = 0; s < next.count[v]; ++s)
            sum += next.weights[2 * v + s];
        ck_assert_double_eq_tol(sum, 1, 1e-14);
        if (share[v] == 0 && _i > 0) ck_assert(changes[v].distance < 1e-20); /* nothing but the weights before counts */
    }
    free(smooth);
    free(share);
    free(changes);
    sph__influences_free(&p, &next);
    sph__filter_free(&filter);
    sph__problem_free(&p);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("skin_parts");
    TCase *tc = tcase_create("parts");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_test(tc, bone_heat_agrees_with_a_dense_solution_and_sums_to_one);
    tcase_add_test(tc, visibility_agrees_with_a_test_of_all_triangles);
    tcase_add_test(tc, filtered_weights_are_gaussian_means_over_ways_along_edges);
    tcase_add_loop_test(tc, no_vertex_goal_rises_in_a_mixed_step_and_shares_say_which_way_it_leans, 1, 4);
    return run_suite(suite, tc);
}
