/* SPDX-License-Identifier: MIT */
/* The report on random meshes against counting by brute force. */
#include <stdlib.h>

#include "check_case.h"
#include "context_case.h"
#include "runner.h"

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

int main(void)
{
    Suite *suite = suite_create("animation check random");
    TCase *tc = tcase_create("random");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_test(tc, random_meshes_are_counted_as_by_brute_force);
    return run_suite(suite, tc);
}
