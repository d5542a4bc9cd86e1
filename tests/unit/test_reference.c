/* SPDX-License-Identifier: MIT */
/* The reference that the library is compared to, held against definitions, known answers and brute force. */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cases.h"
#include "runner.h"
#include "support.h"

typedef reference_real real;

static double noise(uint64_t *state)
{
    return 2 * test_random_unit(state) - 1;
}

static void random_vector(uint64_t *state, real out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = noise(state);
}

static void normalise(real a[3])
{
    const real length = sqrtl(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    for (int i = 0; i < 3; ++i)
        a[i] /= length;
}

START_TEST(quadric_is_the_sum_of_its_planes_wherever_its_origin)
{
    uint64_t state = 1;
    for (int trial = 0; trial < 100; ++trial) {
        struct reference_quadric part = {0}, sum = {0};
        const real origin[3] = {0.3L, -2, 1};
        real q[3], expected = 0, r = noise(&state);
        random_vector(&state, q);
        for (int k = 0; k < 6; ++k) {
            real p[3], n[3], shifted[3], weight = test_random_unit(&state), height = 0;
            random_vector(&state, p);
            random_vector(&state, n);
            normalise(n);
            for (int i = 0; i < 3; ++i) {
                shifted[i] = p[i] - origin[i];
                height += n[i] * (p[i] - q[i]);
            }
            reference_quadric_add_plane(k < 3 ? &part : &sum, k < 3 ? shifted : p, n, weight);
            expected += weight * (height - r) * (height - r);
        }
        reference_quadric_add(&sum, &part, origin);
        reference_quadric_add_attachment(&sum, origin, 0.5L);
        for (int i = 0; i < 3; ++i)
            expected += 0.5L * (q[i] - origin[i]) * (q[i] - origin[i]);
        ck_assert(fabsl(reference_quadric_evaluate(&sum, q, r) - expected) < 1e-15L * 30);
    }
}
END_TEST

START_TEST(sphere_inscribed_in_a_tetrahedron_costs_nothing)
{
    struct reference_quadric quadric = {0};
    struct reference_minimum minimum;
    const real planes[4][3] = {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {1, 1, 1}};
    const real inradius = 1 / (3 + sqrtl(3));
    real nowhere[1][3] = {{0}}, center[1][3];
    for (int k = 0; k < 4; ++k) {
        const real p[3] = {k == 3, 0, 0};
        real n[3] = {planes[k][0], planes[k][1], planes[k][2]};
        normalise(n);
        reference_quadric_add_plane(&quadric, p, n, 1);
    }
    reference_quadric_minimise(&quadric, 1, nowhere, nowhere, 10, &minimum, center);
    ck_assert(fabsl(minimum.radius - inradius) < 1e-15L);
    ck_assert(fabsl(minimum.cost) < 1e-15L);
    for (int i = 0; i < 3; ++i)
        ck_assert(fabsl(center[0][i] - inradius) < 1e-15L);
    reference_quadric_minimise(&quadric, 1, nowhere, nowhere, 0.1L, &minimum, center);
    ck_assert(minimum.radius == 0.1L);
    ck_assert(minimum.cost > 1e-3L);
}
END_TEST

enum { FRAMES = 4 };

/* Planes that all hold one direction leave that direction open; none at all leave everything open. */
static void random_frame(struct reference_quadric *quadric, int kind, uint64_t *state)
{
    real axis[3];
    random_vector(state, axis);
    normalise(axis);
    for (int k = 0; k < kind * 3; ++k) {
        real p[3], n[3], along = 0;
        random_vector(state, p);
        random_vector(state, n);
        for (int i = 0; i < 3; ++i)
            along += n[i] * axis[i];
        for (int i = 0; i < 3 && kind < 3; ++i)
            n[i] -= along * axis[i];
        if (kind == 1) memcpy(n, axis, sizeof n); /* parallel planes */
        normalise(n);
        reference_quadric_add_plane(quadric, p, n, test_random_unit(state) + 0.1);
    }
}

static real evaluate(const struct reference_quadric *quadrics, real (*centers)[3], real radius)
{
    real sum = 0;
    for (int f = 0; f < FRAMES; ++f)
        sum += reference_quadric_evaluate(&quadrics[f], centers[f], radius);
    return sum;
}

START_TEST(no_sphere_that_is_allowed_costs_less_than_the_minimum)
{
    uint64_t state = 2;
    int clamped = 0, inside = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        struct reference_quadric quadrics[FRAMES] = {0};
        struct reference_minimum minimum;
        real u[FRAMES][3], v[FRAMES][3], best[FRAMES][3], bound = trial % 5 == 0 ? 0 : test_random_unit(&state);
        for (int f = 0; f < FRAMES; ++f) {
            random_frame(&quadrics[f], trial % 3 == 0 ? trial / 3 % 4 : (int)(test_random(&state) % 4), &state);
            random_vector(&state, u[f]);
            random_vector(&state, v[f]);
        }
        reference_quadric_minimise(quadrics, FRAMES, u, v, bound, &minimum, best);
        ck_assert(minimum.radius >= 0 && minimum.radius <= bound);
        ck_assert(minimum.lambda >= 0 && minimum.lambda <= 1);
        clamped += minimum.radius == 0 || minimum.radius == bound;
        inside += minimum.radius > 0 && minimum.radius < bound;
        ck_assert(fabsl(evaluate(quadrics, best, minimum.radius) - minimum.cost) < 1e-14L);
        for (int guess = 0; guess < 60; ++guess) {
            const real size = powl(0.1L, guess % 6);
            real lambda = minimum.lambda + size * noise(&state), r = minimum.radius + size * noise(&state);
            real centers[FRAMES][3];
            lambda = lambda < 0 ? 0 : lambda > 1 ? 1 : lambda;
            r = r < 0 ? 0 : r > bound ? bound : r;
            for (int f = 0; f < FRAMES; ++f)
                for (int i = 0; i < 3; ++i)
                    centers[f][i] = reference_quadric_is_degenerate(&quadrics[f])
                                        ? u[f][i] + lambda * (v[f][i] - u[f][i])
                                        : best[f][i] + size * noise(&state);
            ck_assert_msg(evaluate(quadrics, centers, r) >= minimum.cost - 1e-14L, "trial %d: %Lg below %Lg by %Lg",
                          trial, evaluate(quadrics, centers, r), minimum.cost,
                          minimum.cost - evaluate(quadrics, centers, r));
        }
    }
    ck_assert_int_gt(clamped, 100);
    ck_assert_int_gt(inside, 100);
}
END_TEST

START_TEST(flat_frames_take_the_middle_of_the_segment_and_no_radius_where_nothing_pulls)
{
    struct reference_quadric quadrics[2] = {0};
    struct reference_minimum minimum;
    real u[2][3] = {{0, 0, 0}, {1, 1, 1}}, v[2][3] = {{2, 0, 0}, {1, 3, 1}}, centers[2][3];
    reference_quadric_minimise(quadrics, 2, u, v, 1, &minimum, centers);
    ck_assert(minimum.lambda == 0.5L && minimum.radius == 0 && minimum.cost == 0);
    ck_assert(centers[0][0] == 1 && centers[1][1] == 2);
    ck_assert_uint_eq(minimum.degenerate_frames, 2);
    for (int f = 0; f < 2; ++f) { /* now a plane that holds both segments: the radius is known, the place is not */
        const real n[3] = {0, 0, 1};
        reference_quadric_add_plane(&quadrics[f], u[f], n, 1);
    }
    reference_quadric_minimise(quadrics, 2, u, v, 1, &minimum, centers);
    ck_assert(minimum.lambda == 0.5L && minimum.radius == 0 && minimum.cost == 0);
}
END_TEST

static double total_weight(const struct reference_input *input)
{
    double total = 0;
    for (uint32_t f = 0; f < input->frame_count; ++f)
        for (size_t t = 0; t < input->triangle_count; ++t) {
            const uint32_t *c = input->triangles + 3 * t;
            double p[3][3], n[3];
            for (int i = 0; i < 3; ++i)
                for (int k = 0; k < 3; ++k)
                    p[i][k] = input->positions[3 * ((size_t)f * input->vertex_count + c[i]) + (size_t)k];
            for (int k = 0; k < 3; ++k) {
                const int a = (k + 1) % 3, b = (k + 2) % 3;
                n[k] = (p[1][a] - p[0][a]) * (p[2][b] - p[0][b]) - (p[1][b] - p[0][b]) * (p[2][a] - p[0][a]);
            }
            total += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]); /* = 2 area */
        }
    return total;
}

/* Spheres near the one that was found, and as the rules want them, must not cost less. */
static void check_optimal(const struct reference *reference, const struct reference_input *input,
                          const struct reference_edge *edge, uint64_t *state, const char *name)
{
    const uint32_t frame_count = input->frame_count;
    const struct reference_sphere *u = reference_node(reference, edge->u), *v = reference_node(reference, edge->v);
    struct reference_sphere other = {test_malloc(frame_count, sizeof *other.centers),
                                     test_malloc(frame_count, sizeof *other.radii)};
    const double extent = reference_extent(reference, edge->u, edge->v);
    const double tiny = 1e-12 * extent * extent * (reference_weight(reference, edge->u, edge->v) + 1e-3);
    ck_assert(fabs(reference_cost(reference, edge->u, edge->v, &edge->sphere) - edge->cost) <= tiny);
    for (int guess = 0; guess < 12; ++guess) {
        const double size = extent * pow(0.1, guess % 4), step = size * noise(state);
        const double lambda = test_random_unit(state);
        for (uint32_t f = 0; f < frame_count; ++f) {
            const double bound = reference_radius_bound(reference, edge->u, edge->v, f);
            const bool degenerate = reference_is_degenerate(reference, edge->u, edge->v, f);
            other.radii[f] = fmin(fmax(edge->sphere.radii[f] + step, 0), bound);
            for (int i = 0; i < 3; ++i)
                other.centers[f][i] = degenerate ? u->centers[f][i] + lambda * (v->centers[f][i] - u->centers[f][i])
                                                 : edge->sphere.centers[f][i] + size * noise(state);
        }
        ck_assert_msg(reference_cost(reference, edge->u, edge->v, &other) >= edge->cost - tiny, "%s, edge %u %u", name,
                      edge->u, edge->v);
    }
    free(other.centers);
    free(other.radii);
}

START_TEST(hierarchy_keeps_its_rules)
{
    static const uint32_t frame_counts[4] = {1, 2, 3, 8};
    const enum reference_radius_mode mode = (enum reference_radius_mode)(_i % 3);
    const enum case_shape shape = (enum case_shape)(_i / 3);
    uint64_t state = (uint64_t)_i + 1;
    struct case_mesh mesh;
    struct reference_input input;
    struct reference *reference;
    const struct reference_edge *edge;
    bool forced, *dead;
    double error = 0, weight = 0;
    size_t collapses = 0, was_refused = 0;
    case_create(&mesh, shape, (enum case_motion)(_i % CASE_MOTION_COUNT), frame_counts[_i % 4], 1);
    input = case_input(&mesh);
    input.radius_mode = mode;
    input.temporal_coherence = _i % 5 == 0 ? 0.1 : 0;
    dead = calloc(2 * mesh.vertex_count, sizeof *dead);
    ck_assert(dead != NULL);
    reference = reference_create(&input);
    while ((edge = reference_next(reference, &forced)) != NULL) {
        struct reference_collapse collapse;
        ck_assert(edge->u < edge->v && !dead[edge->u] && !dead[edge->v]);
        ck_assert(forced == (reference_least_turn(reference, edge->u, edge->v, &edge->sphere) < 0) &&
                  edge->refused == forced);
        for (uint32_t f = 0; f < input.frame_count; ++f) {
            ck_assert(edge->sphere.radii[f] >= 0);
            ck_assert(mode != REFERENCE_RADIUS_ZERO || edge->sphere.radii[f] == 0);
            ck_assert(mode != REFERENCE_RADIUS_CONSTANT || edge->sphere.radii[f] == edge->sphere.radii[0]);
        }
        if (collapses % 4 == 0) check_optimal(reference, &input, edge, &state, mesh.name);
        for (uint32_t i = 0; i < mesh.vertex_count + collapses;
             ++i) /* nothing cheaper was passed over without reason */
            for (uint32_t j = i + 1; j < mesh.vertex_count + collapses; ++j) {
                const struct reference_edge *other = dead[i] || dead[j] ? NULL : reference_find(reference, i, j);
                if (other == NULL) continue;
                was_refused += other->refused;
                ck_assert(other->refused || (!forced && other->cost >= edge->cost));
            }
        weight = reference_weight(reference, edge->u, edge->v);
        dead[edge->u] = dead[edge->v] = true;
        reference_collapse(reference, edge->u, edge->v, forced, NULL, &collapse);
        ck_assert_uint_eq(collapse.node, mesh.vertex_count + collapses);
        ck_assert(collapse.error >= error && isfinite(collapse.error));
        error = collapse.error;
        ++collapses;
        reference_collapse_free(&collapse);
    }
    ck_assert_uint_eq(collapses, mesh.vertex_count - mesh.components);
    ck_assert_uint_eq(reference_triangle_count(reference), 0);
    ck_assert_uint_eq(reference_edge_count(reference), 0);
    if (mesh.components == 1) ck_assert_double_eq_tol(weight, total_weight(&input), 1e-9 * (weight + 1));
    if (shape == CASE_SOUP) ck_assert_uint_gt(was_refused, 0);
    reference_destroy(reference);
    case_free(&mesh);
    free(dead);
}
END_TEST

START_TEST(importance_scales_the_planes_of_its_vertex_and_frame)
{
    struct case_mesh mesh;
    struct reference_input input;
    struct reference_result plain, weighted;
    float *importance;
    case_create(&mesh, CASE_TORUS, CASE_WAVE, 3, 3);
    input = case_input(&mesh);
    importance = test_malloc((size_t)mesh.vertex_count * 3, sizeof *importance);
    for (size_t i = 0; i < 3 * (size_t)mesh.vertex_count; ++i)
        importance[i] = 4;
    reference_run(&input, &plain);
    input.importance = importance;
    reference_run(&input, &weighted);
    ck_assert_uint_eq(plain.collapse_count, weighted.collapse_count);
    for (size_t t = 0; t < plain.collapse_count; ++t) {
        ck_assert_uint_eq(plain.collapses[t].u, weighted.collapses[t].u);
        ck_assert_uint_eq(plain.collapses[t].v, weighted.collapses[t].v);
        ck_assert_double_eq_tol(4 * plain.collapses[t].cost, weighted.collapses[t].cost,
                                1e-9 * weighted.collapses[t].cost);
        ck_assert_double_eq_tol(plain.collapses[t].error, weighted.collapses[t].error, 1e-9 * plain.collapses[t].error);
    }
    reference_result_free(&weighted);
    reference_result_free(&plain);
    free(importance);
    case_free(&mesh);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("reference");
    TCase *tcase = tcase_create("reference");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, quadric_is_the_sum_of_its_planes_wherever_its_origin);
    tcase_add_test(tcase, sphere_inscribed_in_a_tetrahedron_costs_nothing);
    tcase_add_test(tcase, no_sphere_that_is_allowed_costs_less_than_the_minimum);
    tcase_add_test(tcase, flat_frames_take_the_middle_of_the_segment_and_no_radius_where_nothing_pulls);
    tcase_add_loop_test(tcase, hierarchy_keeps_its_rules, 0, 3 * CASE_SHAPE_COUNT);
    tcase_add_test(tcase, importance_scales_the_planes_of_its_vertex_and_frame);
    return run_suite(suite, tcase);
}
