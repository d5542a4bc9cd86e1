/* SPDX-License-Identifier: MIT */
/* Every level of a hierarchy against what follows from the input and the collapses alone. */
#include <math.h>
#include <stdlib.h>

#include "awkward.h"
#include "hierarchy_case.h"
#include "runner.h"
#include "simplicial.h"

enum { MOST_FRAMES = 9 };

/* --- the tree, followed from the collapses --- */

typedef struct tree {
    const sph_hierarchy *h;
    uint32_t n, end;   /* nodes below `end` have been born */
    uint32_t *holders; /* [n]: the node that holds each vertex */
    uint32_t *places;  /* [2 n]: of each living node among them; UINT32_MAX */
    uint32_t *labels;  /* [n] */
} tree;

static void number(tree *t)
{
    uint32_t count = 0;
    for (uint32_t node = 0; node < 2 * t->n; ++node)
        t->places[node] = UINT32_MAX;
    for (uint32_t v = 0; v < t->n; ++v)
        t->places[t->holders[v]] = 0;
    for (uint32_t node = 0; node < 2 * t->n; ++node)
        if (t->places[node] == 0) t->places[node] = count++;
    for (uint32_t v = 0; v < t->n; ++v)
        t->labels[v] = t->places[t->holders[v]];
}

static tree plant(const sph_hierarchy *h)
{
    const uint32_t n = sph_hierarchy_vertex_count(h);
    tree t = {h, n, n, test_malloc(n, 4), test_malloc(n, 8), test_malloc(n, 4)};
    for (uint32_t v = 0; v < n; ++v)
        t.holders[v] = v;
    number(&t);
    return t;
}

/* The next collapse, in places of the level before it. */
static void grow(tree *t, uint32_t *u, uint32_t *v)
{
    sph_collapse c;
    ck_assert_int_eq(sph_hierarchy_collapse(t->h, t->end - t->n, &c), SPH_OK);
    *u = t->places[c.u];
    *v = t->places[c.v];
    ck_assert_uint_lt(*u, t->n); /* both are alive */
    ck_assert_uint_lt(*v, t->n);
    for (uint32_t i = 0; i < t->n; ++i)
        if (t->holders[i] == c.u || t->holders[i] == c.v) t->holders[i] = c.node;
    ++t->end;
    number(t);
}

static void fell(tree *t)
{
    free(t->holders);
    free(t->places);
    free(t->labels);
}

/* --- one level --- */

static sph_hierarchy *build_oriented(const sph_animation *animation, int32_t mode, int32_t orientation)
{
    sph_hierarchy_options o = default_options();
    o.radius_mode = mode;
    o.orientation = orientation;
    return build(animation, &o);
}

static void check_level_spheres(const tree *t, const sph_level_arrays *a)
{
    const uint32_t frames = sph_hierarchy_frame_count(t->h);
    float centers[MOST_FRAMES][3], radii[MOST_FRAMES];
    for (uint32_t node = 0; node < t->end; ++node) {
        const uint32_t place = t->places[node];
        if (place == UINT32_MAX) continue;
        ck_assert_int_eq(sph_hierarchy_sphere(t->h, node, centers[0], radii), SPH_OK);
        for (uint32_t f = 0; f < frames; ++f) {
            const size_t at = (size_t)f * a->sphere_count + place;
            ck_assert_mem_eq(a->centers + 3 * at, centers[f], sizeof centers[f]);
            ck_assert_float_eq(a->radii[a->radii_per_frame ? at : place], radii[f]);
        }
    }
}

/* That each triangle is wound as one of the input that lies under it. */
static void check_winding(const sph_animation *animation, const uint32_t *labels, const sph_level_arrays *a)
{
    const uint32_t *input = sph_animation_triangles(animation);
    for (size_t i = 0; i < a->triangle_count; ++i) {
        const uint32_t *t = a->triangles + 3 * i;
        bool found = false;
        for (size_t j = 0; j < sph_animation_triangle_count(animation) && !found; ++j)
            for (unsigned k = 0; k < 3; ++k)
                found |= labels[input[3 * j + k]] == t[0] && labels[input[3 * j + (k + 1) % 3]] == t[1] &&
                         labels[input[3 * j + (k + 2) % 3]] == t[2];
        ck_assert_msg(found, "triangle %zu of %u spheres has another winding than the input's", i, a->sphere_count);
    }
}

/* That the cursor has the level of `a`, in node numbers. */
static void check_cursor(const sph_cursor *cursor, const tree *t, const sph_level_arrays *a)
{
    uint32_t *nodes = test_malloc(a->sphere_count, sizeof *nodes);
    uint32_t *edges = test_malloc(a->edge_count, 2 * sizeof *edges);
    uint32_t *triangles = test_malloc(a->triangle_count, 3 * sizeof *triangles);
    ck_assert_uint_eq(sph_cursor_sphere_count(cursor), a->sphere_count);
    ck_assert_uint_eq(sph_cursor_edge_count(cursor), a->edge_count);
    ck_assert_uint_eq(sph_cursor_triangle_count(cursor), a->triangle_count);
    ck_assert_int_eq(sph_cursor_read(cursor, nodes, edges, triangles), SPH_OK);
    for (uint32_t i = 0; i < a->sphere_count; ++i)
        ck_assert_uint_eq(t->places[nodes[i]], i); /* so they ascend */
    for (size_t i = 0; i < 2 * a->edge_count; ++i)
        ck_assert_uint_eq(edges[i], nodes[a->edges[i]]);
    for (size_t i = 0; i < 3 * a->triangle_count; ++i)
        ck_assert_uint_eq(triangles[i], nodes[a->triangles[i]]);
    for (size_t i = 0; i < a->edge_count; ++i) {
        const uint32_t *e = edges + 2 * i;
        ck_assert_uint_lt(e[0], e[1]);
        ck_assert(i == 0 || e[-2] < e[0] || (e[-2] == e[0] && e[-1] < e[1]));
    }
    for (size_t i = 0; i < a->triangle_count; ++i) {
        const uint32_t *c = triangles + 3 * i;
        ck_assert(c[0] < c[1] && c[0] < c[2]);
        ck_assert(i == 0 || c[-3] < c[0] || (c[-3] == c[0] && (c[-2] < c[1] || (c[-2] == c[1] && c[-1] < c[2]))));
    }
    free(nodes);
    free(edges);
    free(triangles);
}

static simplicial check_level(const tree *t, const sph_animation *animation, const sph_level_arrays *a)
{
    simplicial expected = simplicial_of_labels(animation, t->labels, a->sphere_count), found;
    const char *wrong;
    ck_assert_uint_eq(a->label_count, t->n);
    ck_assert_mem_eq(a->labels, t->labels, t->n * sizeof *t->labels);
    found = simplicial_of_level(a, &wrong);
    ck_assert_msg(wrong == NULL, "%u spheres: %s", a->sphere_count, wrong);
    ck_assert_msg(simplicial_equal(&expected, &found),
                  "%u spheres: %zu edges and %zu triangles, not %zu and %zu, or others", a->sphere_count,
                  found.edge_count, found.triangle_count, expected.edge_count, expected.triangle_count);
    ck_assert_uint_eq(simplicial_components(&found), test_component_count(animation));
    check_level_spheres(t, a);
    simplicial_free(&expected);
    return found;
}

/* All levels from the finest to the coarsest, with the cursor beside them. */
static void check_all_levels(const sph_animation *animation, int32_t mode, int32_t orientation)
{
    sph_hierarchy *h = build_oriented(animation, mode, orientation);
    const uint32_t n = sph_hierarchy_vertex_count(h), least = n - sph_hierarchy_collapse_count(h);
    tree t = plant(h);
    simplicial before = {0};
    uint32_t u = 0, v = 0;
    sph_cursor *cursor;
    ck_assert_int_eq(sph_cursor_create(h, &cursor), SPH_OK);
    ck_assert_uint_eq(sph_cursor_sphere_count(cursor), n);
    for (uint32_t count = n; count >= least; --count) {
        sph_level *level;
        sph_level_arrays a;
        simplicial here;
        if (count < n) grow(&t, &u, &v);
        ck_assert_int_eq(sph_level_create(h, count, &level), SPH_OK);
        a = arrays_of(level);
        ck_assert_uint_eq(a.sphere_count, count);
        ck_assert_uint_eq(a.radii_per_frame, mode == SPH_RADIUS_PER_FRAME);
        here = check_level(&t, animation, &a);
        ck_assert_int_eq(sph_cursor_move(cursor, count), SPH_OK);
        check_cursor(cursor, &t, &a);
        if (orientation == SPH_ORIENTATION_AS_GIVEN) check_winding(animation, t.labels, &a);
        if (count < n) {
            ck_assert_msg(simplicial_has_edge(&before, u, v), "a collapse without an edge");
            ck_assert_int_eq(simplicial_euler(&here) - simplicial_euler(&before),
                             simplicial_euler_change(&before, u, v));
        }
        simplicial_free(&before);
        before = here;
        sph_level_destroy(level);
    }
    simplicial_free(&before);
    sph_cursor_destroy(cursor);
    sph_hierarchy_destroy(h);
    fell(&t);
}

START_TEST(every_level_is_the_image_of_the_input)
{
    const unsigned kind = (unsigned)_i % AWKWARD_KIND_COUNT;
    sph_animation *animation = awkward(context, kind, _i < AWKWARD_KIND_COUNT ? 1 : MOST_FRAMES);
    for (int32_t mode = 0; mode < MODES; ++mode)
        check_all_levels(animation, mode, SPH_ORIENTATION_AS_GIVEN);
    check_all_levels(animation, SPH_RADIUS_CONSTANT, SPH_ORIENTATION_OUTWARD);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(every_level_of_a_random_mesh_is_the_image_of_the_input)
{
    uint64_t state = (uint64_t)_i;
    const uint32_t n = 3 + (uint32_t)(test_random(&state) % 30);
    sph_animation *animation = test_soup(context, n, test_random(&state) % 80, 2, state);
    uint32_t edges[20];
    for (unsigned e = 0; e < 20; ++e)
        edges[e] = (uint32_t)(test_random(&state) % n);
    ck_assert_int_eq(sph_animation_set_edges(animation, edges, test_random(&state) % 10, 0), SPH_OK);
    check_all_levels(animation, SPH_RADIUS_CONSTANT, SPH_ORIENTATION_AS_GIVEN);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(a_level_outlives_all_that_it_was_made_from)
{
    sph_context *own = test_context();
    sph_animation *animation = test_torus(own, 9, 6, 2);
    sph_hierarchy *h = build_mode(animation, SPH_RADIUS_CONSTANT);
    sph_level *level;
    sph_level_arrays a;
    ck_assert_int_eq(sph_level_create(h, 20, &level), SPH_OK);
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
    sph_context_destroy(own);
    a = arrays_of(level);
    for (size_t i = 0; i < 54; ++i)
        ck_assert_uint_lt(a.labels[i], 20);
    for (size_t i = 0; i < 120; ++i)
        ck_assert(isfinite(a.centers[i]));
    sph_level_destroy(level);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("level");
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, every_level_is_the_image_of_the_input, 0, 2 * AWKWARD_KIND_COUNT);
    tcase_add_loop_test(tc, every_level_of_a_random_mesh_is_the_image_of_the_input, 0, 60);
    tcase_add_test(tc, a_level_outlives_all_that_it_was_made_from);
    return run_suite(suite, tc);
}
