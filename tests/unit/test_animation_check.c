/* SPDX-License-Identifier: MIT */
/* The report: on meshes whose faults are known, and on random ones against counting by brute force. */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "runner.h"
#include "support.h"

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

static sph_animation_report check(const sph_animation *animation)
{
    sph_animation_report report;
    ck_assert_ptr_nonnull(animation);
    sph_animation_report_init(&report, sizeof report);
    ck_assert_int_eq(sph_animation_check(animation, &report), SPH_OK);
    ck_assert_uint_eq(report.struct_size, sizeof report);
    ck_assert_uint_eq(report.reserved0, 0);
    return report;
}

static sph_animation_report check_and_destroy(sph_animation *animation)
{
    const sph_animation_report report = check(animation);
    sph_animation_destroy(animation);
    return report;
}

/* Nothing wrong but what the arguments say. */
static void assert_clean(const sph_animation_report *r)
{
    ck_assert_uint_eq(r->non_finite_count, 0);
    ck_assert_uint_eq(r->repeated_index_count, 0);
    ck_assert_uint_eq(r->duplicate_triangle_count, 0);
    ck_assert_uint_eq(r->zero_area_count, 0);
    ck_assert_uint_eq(r->boundary_edge_count, 0);
    ck_assert_uint_eq(r->non_manifold_edge_count, 0);
    ck_assert_uint_eq(r->inconsistent_edge_count, 0);
    ck_assert_uint_eq(r->wire_edge_count, 0);
    ck_assert_uint_eq(r->component_count, 1);
    ck_assert_uint_eq(r->isolated_vertex_count, 0);
    ck_assert_uint_eq(r->coincident_vertex_count, 0);
    ck_assert_uint_eq(r->inward_component_count, 0);
}

static sph_animation *closed_shape(int which)
{
    switch (which) {
    case 0:
        return test_cube(context, 4);
    case 1:
        return test_sphere(context, 0, 4);
    case 2:
        return test_sphere(context, 3, 3);
    default:
        return test_torus(context, 12, 7, 4);
    }
}

START_TEST(closed_outward_shapes_are_clean)
{
    const sph_animation_report r = check_and_destroy(closed_shape(_i));
    assert_clean(&r);
}
END_TEST

/* Triangle t with its last two corners swapped, for t in [begin, end). */
static void flip(sph_animation *a, size_t begin, size_t end)
{
    const size_t m = sph_animation_triangle_count(a);
    uint32_t *t = test_malloc(m, 3 * sizeof *t);
    memcpy(t, sph_animation_triangles(a), m * 3 * sizeof *t);
    for (size_t i = begin; i < end && i < m; ++i) {
        const uint32_t v = t[3 * i + 1];
        t[3 * i + 1] = t[3 * i + 2];
        t[3 * i + 2] = v;
    }
    ck_assert_int_eq(sph_animation_set_triangles(a, t, m, 0), SPH_OK);
    free(t);
}

START_TEST(closed_inward_shapes_have_one_inward_component)
{
    sph_animation *a = closed_shape(_i);
    sph_animation_report r;
    flip(a, 0, SIZE_MAX);
    r = check_and_destroy(a);
    ck_assert_uint_eq(r.inward_component_count, 1);
    r.inward_component_count = 0;
    assert_clean(&r);
}
END_TEST

START_TEST(one_flipped_triangle_makes_three_inconsistent_edges)
{
    sph_animation *a = closed_shape(_i);
    sph_animation_report r;
    flip(a, 0, SIZE_MAX);
    flip(a, 5, 6);
    r = check_and_destroy(a);
    ck_assert_uint_eq(r.inconsistent_edge_count, 3);
    r.inconsistent_edge_count = 0;
    assert_clean(&r); /* not consistently wound: neither outward nor inward */
}
END_TEST

START_TEST(a_grid_has_its_outline_for_a_boundary)
{
    sph_animation_report r = check_and_destroy(test_grid(context, 7, 4, 3));
    ck_assert_uint_eq(r.boundary_edge_count, 2 * (7 + 4));
    r.boundary_edge_count = 0;
    assert_clean(&r);
}
END_TEST

START_TEST(non_finite_positions_are_counted_and_the_first_is_named)
{
    sph_animation *a = test_cube(context, 5);
    float xyz[24];
    sph_animation_report r;
    ck_assert_int_eq(sph_animation_read_frame(a, 2, xyz), SPH_OK);
    xyz[3 * 6] = NAN;
    xyz[3 * 6 + 1] = NAN; /* the same vertex counts once */
    xyz[3 * 4 + 2] = -INFINITY;
    ck_assert_int_eq(sph_animation_set_frame(a, 2, xyz, 0), SPH_OK);
    ck_assert_int_eq(sph_animation_read_frame(a, 4, xyz), SPH_OK);
    xyz[0] = INFINITY;
    ck_assert_int_eq(sph_animation_set_frame(a, 4, xyz, 0), SPH_OK);
    flip(a, 0, SIZE_MAX);
    r = check_and_destroy(a);
    ck_assert_uint_eq(r.non_finite_count, 3);
    ck_assert_uint_eq(r.first_non_finite_frame, 2);
    ck_assert_uint_eq(r.first_non_finite_vertex, 4);
    ck_assert_uint_eq(r.inward_component_count, 1); /* by the other frames */
    ck_assert_uint_eq(r.zero_area_count, 0);
    ck_assert_uint_eq(r.coincident_vertex_count, 0);
}
END_TEST

/* One frame of n vertices at distinct places in general position, so that only connectivity can be wrong. */
static sph_animation *spread(uint32_t n)
{
    sph_animation *a = test_soup(context, n, 0, 1, 99);
    ck_assert_ptr_nonnull(a);
    return a;
}

START_TEST(triangles_that_repeat_a_vertex_are_edges_or_nothing)
{
    static const uint32_t triangles[] = {0, 1, 2, 3, 3, 4, 5, 6, 5, 7, 7, 7, 1, 8, 8};
    static const uint32_t edges[] = {0, 3, 9, 9, 5, 5};
    sph_animation *a = spread(10);
    sph_animation_report r;
    ck_assert_int_eq(sph_animation_set_triangles(a, triangles, 5, 0), SPH_OK);
    ck_assert_int_eq(sph_animation_set_edges(a, edges, 3, 0), SPH_OK);
    r = check_and_destroy(a);
    ck_assert_uint_eq(r.repeated_index_count, 6);
    ck_assert_uint_eq(r.first_repeated_index, 1);
    ck_assert_uint_eq(r.zero_area_count, 4);
    ck_assert_uint_eq(r.first_zero_area_frame, 0);
    ck_assert_uint_eq(r.first_zero_area_triangle, 1);
    ck_assert_uint_eq(r.duplicate_triangle_count, 0);
    ck_assert_uint_eq(r.boundary_edge_count, 3);
    ck_assert_uint_eq(r.wire_edge_count, 4);       /* 34, 56, 18, 03 */
    ck_assert_uint_eq(r.component_count, 4);       /* 0 1 2 3 4 8, 5 6, 7, 9 */
    ck_assert_uint_eq(r.isolated_vertex_count, 2); /* 7, 9 */
}
END_TEST

START_TEST(the_first_repeated_edge_comes_after_all_triangles)
{
    static const uint32_t triangles[] = {0, 1, 2, 2, 1, 3};
    static const uint32_t edges[] = {0, 3, 1, 1};
    sph_animation *a = spread(4);
    sph_animation_report r;
    ck_assert_int_eq(sph_animation_set_triangles(a, triangles, 2, 0), SPH_OK);
    ck_assert_int_eq(sph_animation_set_edges(a, edges, 2, 0), SPH_OK);
    r = check_and_destroy(a);
    ck_assert_uint_eq(r.repeated_index_count, 1);
    ck_assert_uint_eq(r.first_repeated_index, 3);
}
END_TEST

START_TEST(duplicate_triangles_count_in_any_order_of_their_corners)
{
    static const uint32_t triangles[] = {0, 1, 2, 3, 1, 2, 2, 0, 1, 2, 1, 0, 1, 2, 3, 0, 1, 3};
    sph_animation *a = spread(4);
    sph_animation_report r;
    ck_assert_int_eq(sph_animation_set_triangles(a, triangles, 6, 0), SPH_OK);
    r = check_and_destroy(a);
    ck_assert_uint_eq(r.duplicate_triangle_count, 3);
    ck_assert_uint_eq(r.non_manifold_edge_count, 4); /* 01: 4, 12: 5, 02: 3, 13: 3 */
    ck_assert_uint_eq(r.inconsistent_edge_count, 1); /* 23, which 3 1 2 and 1 2 3 both run along from 2 to 3 */
    ck_assert_uint_eq(r.boundary_edge_count, 1);     /* 03 */
}
END_TEST

START_TEST(wire_edges_are_different_edges_of_no_triangle)
{
    static const uint32_t triangles[] = {0, 1, 2};
    static const uint32_t edges[] = {1, 0, 2, 3, 3, 2, 4, 3, 2, 3, 0, 2};
    sph_animation *a = spread(6);
    sph_animation_report r;
    ck_assert_int_eq(sph_animation_set_triangles(a, triangles, 1, 0), SPH_OK);
    ck_assert_int_eq(sph_animation_set_edges(a, edges, 6, 0), SPH_OK);
    r = check_and_destroy(a);
    ck_assert_uint_eq(r.wire_edge_count, 2);
    ck_assert_uint_eq(r.boundary_edge_count, 3);
    ck_assert_uint_eq(r.component_count, 2);
    ck_assert_uint_eq(r.isolated_vertex_count, 1);
}
END_TEST

START_TEST(zero_area_is_counted_by_frame_and_the_first_is_named)
{
    static const uint32_t triangles[] = {0, 1, 2, 1, 2, 3};
    static const float frames[3][12] = {{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0},
                                        {0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 1e-3f}, /* the first is a line */
                                        {5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5}};    /* all is one point */
    sph_animation *a;
    sph_animation_report r;
    ck_assert_int_eq(sph_animation_create(context, 4, 3, &a), SPH_OK);
    for (uint32_t f = 0; f < 3; ++f)
        ck_assert_int_eq(sph_animation_set_frame(a, f, frames[f], 0), SPH_OK);
    ck_assert_int_eq(sph_animation_set_triangles(a, triangles, 2, 0), SPH_OK);
    r = check_and_destroy(a);
    ck_assert_uint_eq(r.zero_area_count, 3);
    ck_assert_uint_eq(r.first_zero_area_frame, 1);
    ck_assert_uint_eq(r.first_zero_area_triangle, 0);
}
END_TEST

START_TEST(vertices_coincide_only_when_they_do_in_all_frames)
{
    static const float frames[2][15] = {{1, 2, 3, 1, 2, 3, 0, -0.0f, 0, 1, 2, 3, -0.0f, 0, 0},
                                        {4, 5, 6, 4, 5, 7, 9, 9, 9, 4, 5, 6, 9, 9, 9}};
    sph_animation *a;
    sph_animation_report r;
    ck_assert_int_eq(sph_animation_create(context, 5, 2, &a), SPH_OK);
    for (uint32_t f = 0; f < 2; ++f)
        ck_assert_int_eq(sph_animation_set_frame(a, f, frames[f], 0), SPH_OK);
    r = check_and_destroy(a);
    ck_assert_uint_eq(r.coincident_vertex_count, 2); /* 3 with 0, and 4 with 2 though their zeros differ in sign */
}
END_TEST

START_TEST(orientation_is_that_of_the_volume_summed_over_frames)
{
    sph_animation *a = test_cube(context, 2);
    float xyz[24], mirrored[24];
    ck_assert_int_eq(sph_animation_read_frame(a, 0, xyz), SPH_OK);
    for (size_t i = 0; i < 24; ++i)
        mirrored[i] = (_i == 0 ? 1.1f : 0.9f) * (i % 3 == 0 ? -xyz[i] : xyz[i]);
    ck_assert_int_eq(sph_animation_set_frame(a, 1, mirrored, 0), SPH_OK);
    ck_assert_uint_eq(check_and_destroy(a).inward_component_count, _i == 0 ? 1 : 0);
}
END_TEST

START_TEST(small_inward_cubes_far_out_are_seen)
{
    /* Two cubes of edge 2/1000 about (1000, 1000, 1000), the second inward; a wire joins them. */
    sph_animation *cube = test_cube(context, 1), *a;
    float xyz[48];
    uint32_t triangles[72];
    const uint32_t wire[2] = {7, 8};
    sph_animation_report r;
    ck_assert_int_eq(sph_animation_read_frame(cube, 0, xyz), SPH_OK);
    for (size_t i = 0; i < 24; ++i) {
        xyz[24 + i] = 1000.5f + xyz[i] / 1024;
        xyz[i] = 1000 + xyz[i] / 1024;
    }
    memcpy(triangles, sph_animation_triangles(cube), 36 * sizeof *triangles);
    for (size_t i = 0; i < 36; ++i)
        triangles[36 + i] = 8 + triangles[35 - i]; /* read backwards: turned over */
    sph_animation_destroy(cube);
    ck_assert_int_eq(sph_animation_create(context, 16, 1, &a), SPH_OK);
    ck_assert_int_eq(sph_animation_set_frame(a, 0, xyz, 0), SPH_OK);
    ck_assert_int_eq(sph_animation_set_triangles(a, triangles, 24, 0), SPH_OK);
    r = check(a);
    ck_assert_uint_eq(r.component_count, 2);
    ck_assert_uint_eq(r.inward_component_count, 1);
    ck_assert_int_eq(sph_animation_set_edges(a, wire, 1, 0), SPH_OK);
    r = check_and_destroy(a);
    ck_assert_uint_eq(r.component_count, 1);
    ck_assert_uint_eq(r.inward_component_count, 1);
}
END_TEST

START_TEST(a_two_sided_sheet_has_no_volume_and_is_not_inward)
{
    sph_animation *sheet = test_grid(context, 9, 9, 3), *a;
    const size_t m = sph_animation_triangle_count(sheet);
    uint32_t *triangles = test_malloc(2 * m, 3 * sizeof *triangles);
    sph_animation_report r;
    memcpy(triangles, sph_animation_triangles(sheet), 3 * m * sizeof *triangles);
    for (size_t i = 0; i < 3 * m; ++i)
        triangles[3 * m + i] = triangles[3 * m - 1 - i];
    a = sheet;
    ck_assert_int_eq(sph_animation_set_triangles(a, triangles, 2 * m, 0), SPH_OK);
    free(triangles);
    r = check_and_destroy(a);
    ck_assert_uint_eq(r.duplicate_triangle_count, m);
    ck_assert_uint_eq(r.inward_component_count, 0);
    ck_assert_uint_eq(r.boundary_edge_count, 0);
}
END_TEST

/* --- brute force --- */

static bool repeats(const uint32_t *v, size_t corners)
{
    return v[0] == v[1] || (corners == 3 && (v[0] == v[2] || v[1] == v[2]));
}

/* How often triangles run from a to b. */
static size_t runs(const sph_animation *an, uint32_t a, uint32_t b)
{
    const uint32_t *t = sph_animation_triangles(an);
    size_t count = 0;
    for (size_t i = 0; i < sph_animation_triangle_count(an); ++i)
        for (size_t k = 0; k < 3; ++k)
            if (!repeats(t + 3 * i, 3) && t[3 * i + k] == a && t[3 * i + (k + 1) % 3] == b) ++count;
    return count;
}

static bool is_pair(uint32_t p, uint32_t q, uint32_t a, uint32_t b)
{
    return (p == a && q == b) || (p == b && q == a);
}

/* Among the additional edges, or as a triangle of no other vertices. */
static bool has_wire(const sph_animation *an, uint32_t a, uint32_t b)
{
    const uint32_t *e = sph_animation_edges(an), *t = sph_animation_triangles(an);
    for (size_t i = 0; i < sph_animation_edge_count(an); ++i)
        if (is_pair(e[2 * i], e[2 * i + 1], a, b)) return true;
    for (size_t i = 0; i < sph_animation_triangle_count(an); ++i, t += 3)
        if (repeats(t, 3) && (is_pair(t[0], t[1], a, b) || is_pair(t[1], t[2], a, b))) return true;
    return false;
}

/* Labels spread along pairs until nothing changes. */
static void label(const sph_animation *an, bool with_wires, uint32_t *labels)
{
    const uint32_t n = sph_animation_vertex_count(an);
    for (uint32_t i = 0; i < n; ++i)
        labels[i] = i;
    for (bool changed = true; changed;) {
        changed = false;
        for (uint32_t a = 0; a < n; ++a)
            for (uint32_t b = 0; b < n; ++b)
                if (a != b && labels[a] < labels[b] &&
                    (runs(an, a, b) + runs(an, b, a) > 0 || (with_wires && has_wire(an, a, b)))) {
                    labels[b] = labels[a];
                    changed = true;
                }
    }
}

static void brute_edges(const sph_animation *an, sph_animation_report *r, uint32_t *labels, bool *open)
{
    const uint32_t n = sph_animation_vertex_count(an);
    label(an, false, labels);
    for (uint32_t a = 0; a < n; ++a) {
        bool alone = true;
        for (uint32_t b = 0; b < n; ++b) {
            const size_t up = runs(an, a, b), down = runs(an, b, a);
            if (a == b) continue;
            if (up + down > 0 || has_wire(an, a, b)) alone = false;
            if (up != down) open[labels[a]] = true;
            if (a > b) continue;
            r->boundary_edge_count += up + down == 1;
            r->non_manifold_edge_count += up + down >= 3;
            r->inconsistent_edge_count += up + down == 2 && up != 1;
            r->wire_edge_count += up + down == 0 && has_wire(an, a, b);
        }
        r->isolated_vertex_count += alone;
    }
}

static void brute_simplices(const sph_animation *an, sph_animation_report *r)
{
    const uint32_t *t = sph_animation_triangles(an), *e = sph_animation_edges(an);
    const size_t m = sph_animation_triangle_count(an);
    for (size_t i = m + sph_animation_edge_count(an); i-- > 0;)
        if (i < m ? repeats(t + 3 * i, 3) : repeats(e + 2 * (i - m), 2)) {
            ++r->repeated_index_count;
            r->first_repeated_index = i;
        }
    for (size_t i = 0; i < m; ++i) {
        bool seen = false;
        for (size_t j = 0; j < i; ++j) {
            size_t found = 0;
            for (size_t k = 0; k < 9; ++k)
                found += t[3 * i + k / 3] == t[3 * j + k % 3];
            if (found == 3 && !repeats(t + 3 * i, 3) && !repeats(t + 3 * j, 3)) seen = true;
        }
        r->duplicate_triangle_count += seen;
    }
}

static long double brute_volume(const float *xyz, const uint32_t *v)
{
    const float *a = xyz + 3 * v[0], *b = xyz + 3 * v[1], *c = xyz + 3 * v[2];
    return (long double)a[0] * b[1] * c[2] + (long double)a[1] * b[2] * c[0] + (long double)a[2] * b[0] * c[1] -
           (long double)a[2] * b[1] * c[0] - (long double)a[1] * b[0] * c[2] - (long double)a[0] * b[2] * c[1];
}

static void brute_inward(const sph_animation *an, sph_animation_report *r, const uint32_t *labels, const bool *open)
{
    const uint32_t n = sph_animation_vertex_count(an), frames = sph_animation_frame_count(an);
    const uint32_t *t = sph_animation_triangles(an);
    float *xyz = test_malloc(n, 3 * sizeof *xyz);
    for (uint32_t patch = 0; patch < n; ++patch) {
        long double volume = 0;
        if (open[patch]) continue;
        for (uint32_t f = 0; f < frames; ++f) {
            ck_assert_int_eq(sph_animation_read_frame(an, f, xyz), SPH_OK);
            for (size_t i = 0; i < sph_animation_triangle_count(an); ++i)
                if (!repeats(t + 3 * i, 3) && labels[t[3 * i]] == patch) volume += brute_volume(xyz, t + 3 * i);
        }
        r->inward_component_count += volume < -1e-9L;
    }
    free(xyz);
}

static bool coincide(float *const *frames, uint32_t frame_count, uint32_t a, uint32_t b)
{
    for (uint32_t f = 0; f < frame_count; ++f)
        for (size_t k = 0; k < 3; ++k)
            if (frames[f][3 * a + k] != frames[f][3 * b + k]) return false;
    return true;
}

static sph_animation_report brute_report(const sph_animation *an)
{
    const uint32_t n = sph_animation_vertex_count(an), frame_count = sph_animation_frame_count(an);
    sph_animation_report r = {.struct_size = sizeof r};
    uint32_t *labels = test_malloc(n, sizeof *labels);
    bool *open = test_malloc(n, sizeof *open);
    float **frames = test_malloc(frame_count, sizeof *frames);
    brute_simplices(an, &r);
    brute_edges(an, &r, labels, open);
    brute_inward(an, &r, labels, open);
    label(an, true, labels);
    for (uint32_t i = 0; i < n; ++i)
        r.component_count += labels[i] == i;
    for (uint32_t f = 0; f < frame_count; ++f) {
        frames[f] = test_malloc(n, 3 * sizeof **frames);
        ck_assert_int_eq(sph_animation_read_frame(an, f, frames[f]), SPH_OK);
    }
    for (uint32_t i = 0; i < n; ++i) {
        bool lower = false;
        for (uint32_t j = 0; j < i; ++j)
            lower = lower || coincide(frames, frame_count, i, j);
        r.coincident_vertex_count += lower;
    }
    for (uint32_t f = 0; f < frame_count; ++f)
        free(frames[f]);
    free(frames);
    free(open);
    free(labels);
    return r;
}

/* Few vertices on a coarse lattice, so that every fault occurs: coincidences, repeats, duplicates, edges of many
 * triangles. */
static sph_animation *random_mess(uint64_t seed)
{
    const uint32_t n = 2 + (uint32_t)(test_random(&seed) % 14), frames = 1 + (uint32_t)(test_random(&seed) % 3);
    const size_t m = test_random(&seed) % (2 * n), edges = test_random(&seed) % n;
    uint32_t indices[3 * 32];
    float xyz[3 * 16];
    sph_animation *a;
    ck_assert_int_eq(sph_animation_create(context, n, frames, &a), SPH_OK);
    for (uint32_t f = 0; f < frames; ++f) {
        for (size_t i = 0; i < 3 * (size_t)n; ++i)
            xyz[i] = (float)(test_random(&seed) % 2) - 0.5f;
        ck_assert_int_eq(sph_animation_set_frame(a, f, xyz, 0), SPH_OK);
    }
    for (size_t i = 0; i < 3 * m; ++i)
        indices[i] = (uint32_t)(test_random(&seed) % n);
    ck_assert_int_eq(sph_animation_set_triangles(a, indices, m, 0), SPH_OK);
    for (size_t i = 0; i < 2 * edges; ++i)
        indices[i] = (uint32_t)(test_random(&seed) % n);
    ck_assert_int_eq(sph_animation_set_edges(a, indices, edges, 0), SPH_OK);
    return a;
}

/* Tetrahedra, each wound by chance, that share vertices by chance: closed patches of all kinds. */
static sph_animation *random_tetrahedra(uint64_t seed)
{
    static const uint32_t faces[12] = {0, 1, 2, 0, 2, 3, 0, 3, 1, 3, 2, 1};
    sph_animation *a = test_soup(context, 24, 0, 2, seed + 1000);
    uint32_t indices[5 * 12];
    for (size_t i = 0; i < 5; ++i) {
        const uint32_t first = (uint32_t)(test_random(&seed) % 20);
        const bool turn = (test_random(&seed) & 1) != 0;
        for (size_t k = 0; k < 12; ++k)
            indices[12 * i + k] = first + faces[turn ? 11 - k : k];
    }
    ck_assert_int_eq(sph_animation_set_triangles(a, indices, 20, 0), SPH_OK);
    return a;
}

static void assert_like_brute_force(sph_animation *a, int seed)
{
    sph_animation_report got = check(a), want = brute_report(a);
#define ck_same(field)                                                                                                 \
    ck_assert_msg(got.field == want.field, "seed %d: " #field " is %llu, brute force says %llu", seed,                 \
                  (unsigned long long)got.field, (unsigned long long)want.field)
    ck_same(non_finite_count);
    ck_same(repeated_index_count);
    ck_same(first_repeated_index);
    ck_same(duplicate_triangle_count);
    ck_same(boundary_edge_count);
    ck_same(non_manifold_edge_count);
    ck_same(inconsistent_edge_count);
    ck_same(wire_edge_count);
    ck_same(component_count);
    ck_same(isolated_vertex_count);
    ck_same(coincident_vertex_count);
    ck_same(inward_component_count);
    sph_animation_destroy(a);
}

START_TEST(random_meshes_are_counted_as_by_brute_force)
{
    for (int seed = 0; seed < 300; ++seed) {
        assert_like_brute_force(random_mess((uint64_t)seed), seed);
        assert_like_brute_force(random_tetrahedra((uint64_t)seed), seed);
    }
}
END_TEST

/* --- the call --- */

START_TEST(check_rejects_bad_arguments)
{
    sph_animation *a = test_cube(context, 1);
    sph_animation_report r = {0};
    ck_assert_int_eq(sph_animation_check(a, &r), SPH_E_INVALID);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "not initialised"));
    ck_assert_int_eq(sph_animation_check(a, NULL), SPH_E_INVALID);
    sph_animation_report_init(&r, sizeof r);
    ck_assert_int_eq(sph_animation_check(NULL, &r), SPH_E_INVALID);
    sph_animation_report_init(NULL, sizeof r);
    memset(&r, 0xff, sizeof r);
    sph_animation_report_init(&r, sizeof r - 1); /* smaller than it ever was */
    ck_assert_uint_eq(r.struct_size, UINT32_MAX);
    sph_animation_destroy(a);
}
END_TEST

START_TEST(a_larger_report_of_a_newer_caller_is_filled_and_its_tail_zeroed)
{
    struct {
        sph_animation_report known;
        uint64_t tail, guard;
    } newer;
    sph_animation *a = test_cube(context, 1);
    newer.tail = newer.guard = 77;
    sph_animation_report_init(&newer.known, offsetof(__typeof__(newer), guard));
    newer.tail = 78;
    ck_assert_int_eq(sph_animation_check(a, &newer.known), SPH_OK);
    ck_assert_uint_eq(newer.known.struct_size, offsetof(__typeof__(newer), guard));
    ck_assert_uint_eq(newer.known.component_count, 1);
    ck_assert_uint_eq(newer.tail, 0);
    ck_assert_uint_eq(newer.guard, 77);
    sph_animation_destroy(a);
}
END_TEST

START_TEST(frames_from_a_source_give_the_same_report_in_one_pass)
{
    sph_animation *held = test_torus(context, 9, 5, 7), *pulled;
    test_source source = {.from = held};
    sph_animation_report want = check(held), got;
    pulled = test_pulled(context, &source);
    got = check_and_destroy(pulled);
    ck_assert_mem_eq(&got, &want, sizeof got);
    ck_assert_uint_eq(source.reads, 7);
    sph_animation_destroy(held);
}
END_TEST

START_TEST(progress_never_falls_and_may_cancel_at_any_call)
{
    test_progress progress = {0};
    sph_context *own = test_context_with_progress(test_progress_callback, &progress);
    sph_animation *a = test_torus(own, 8, 6, 5);
    sph_animation_report r;
    size_t calls;
    check(a);
    calls = progress.calls;
    ck_assert_uint_gt(calls, 5);
    ck_assert(!progress.fell);
    ck_assert_double_eq_tol(progress.last, 1, 1e-12);
    for (size_t n = 1; n <= calls; ++n) {
        progress = (test_progress){.cancel_at = n};
        sph_animation_report_init(&r, sizeof r);
        ck_assert_int_eq(sph_animation_check(a, &r), SPH_E_CANCELLED);
        ck_assert_uint_eq(progress.calls, n);
        ck_assert_uint_eq(r.component_count, 0);
    }
    sph_animation_destroy(a);
    sph_context_destroy(own);
}
END_TEST

static sph_status faulty_scenario(const sph_allocator *allocator, const sph_animation *model)
{
    sph_context *own = test_context_with_allocator(allocator);
    test_source source = {.from = model};
    sph_animation *a = own == NULL ? NULL : test_pulled(own, &source);
    sph_animation_report r;
    sph_status status = a == NULL ? SPH_E_NOMEM : SPH_OK;
    sph_animation_report_init(&r, sizeof r);
    if (status == SPH_OK) status = sph_animation_check(a, &r);
    if (status == SPH_OK) ck_assert_uint_eq(r.component_count, 1);
    if (status != SPH_OK) ck_assert_uint_eq(r.component_count, 0);
    sph_animation_destroy(a);
    sph_context_destroy(own);
    return status;
}

START_TEST(every_allocation_may_fail)
{
    sph_animation *model = test_torus(context, 8, 6, 3);
    for (size_t n = 1;; ++n) {
        test_faulty faulty = {.fail_at = n, .sticky = _i != 0};
        const sph_allocator allocator = test_faulty_allocator(&faulty);
        const sph_status status = faulty_scenario(&allocator, model);
        ck_assert_msg(faulty.live_blocks == 0, "leak of %zu bytes when allocation %zu fails", faulty.live_bytes, n);
        ck_assert(!faulty.misused);
        if (faulty.calls < n) {
            ck_assert_int_eq(status, SPH_OK);
            ck_assert_uint_gt(n, 15);
            break;
        }
        ck_assert_int_eq(status, SPH_E_NOMEM);
    }
    sph_animation_destroy(model);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("animation check");
    TCase *tc = tcase_create("check");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, closed_outward_shapes_are_clean, 0, 4);
    tcase_add_loop_test(tc, closed_inward_shapes_have_one_inward_component, 0, 4);
    tcase_add_loop_test(tc, one_flipped_triangle_makes_three_inconsistent_edges, 0, 4);
    tcase_add_test(tc, a_grid_has_its_outline_for_a_boundary);
    tcase_add_test(tc, non_finite_positions_are_counted_and_the_first_is_named);
    tcase_add_test(tc, triangles_that_repeat_a_vertex_are_edges_or_nothing);
    tcase_add_test(tc, the_first_repeated_edge_comes_after_all_triangles);
    tcase_add_test(tc, duplicate_triangles_count_in_any_order_of_their_corners);
    tcase_add_test(tc, wire_edges_are_different_edges_of_no_triangle);
    tcase_add_test(tc, zero_area_is_counted_by_frame_and_the_first_is_named);
    tcase_add_test(tc, vertices_coincide_only_when_they_do_in_all_frames);
    tcase_add_loop_test(tc, orientation_is_that_of_the_volume_summed_over_frames, 0, 2);
    tcase_add_test(tc, small_inward_cubes_far_out_are_seen);
    tcase_add_test(tc, a_two_sided_sheet_has_no_volume_and_is_not_inward);
    tcase_add_test(tc, random_meshes_are_counted_as_by_brute_force);
    tcase_add_test(tc, check_rejects_bad_arguments);
    tcase_add_test(tc, a_larger_report_of_a_newer_caller_is_filled_and_its_tail_zeroed);
    tcase_add_test(tc, frames_from_a_source_give_the_same_report_in_one_pass);
    tcase_add_test(tc, progress_never_falls_and_may_cancel_at_any_call);
    tcase_add_loop_test(tc, every_allocation_may_fail, 0, 2);
    return run_suite(suite, tc);
}
