/* SPDX-License-Identifier: MIT */
/* Levels of real animated meshes, from the folder that SPHMESH_DATA names; without it these tests are skipped. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sphmesh/io.h>

#include "awkward.h"
#include "runner.h"
#include "simplicial.h"
#include "support.h"

/* A few frames of each will do: what is tested is the connectivity. */
static const struct {
    const char *mesh, *cache;
    uint32_t step;
} DATA[] = {{"horse-gallop.obj", "horse-gallop.pc2", 12},
            {"samba.obj", "samba.mdd", 60},
            {"bone-anim.obj", "bone-anim.pc2", 50},
            {"wolf/wolf_%d.obj", NULL, 7}};
enum { DATA_COUNT = sizeof DATA / sizeof *DATA };

static sph_context *context;

static sph_animation *open_data(unsigned which)
{
    char mesh[1024], cache[1024];
    const char *path = mesh;
    sph_io_open_options options;
    sph_animation *animation = NULL;
    sph_status status;
    sph_io_open_options_init(&options, sizeof options);
    snprintf(mesh, sizeof mesh, "%s/%s", getenv("SPHMESH_DATA"), DATA[which].mesh);
    if (DATA[which].cache != NULL) {
        snprintf(cache, sizeof cache, "%s/%s", getenv("SPHMESH_DATA"), DATA[which].cache);
        options.cache_path = cache;
    }
    options.frame_step = DATA[which].step;
    status = sph_io_open_animation(context, &path, 1, &options, &animation);
    ck_assert_msg(status == SPH_OK, "%s", sph_context_last_message(context));
    return animation;
}

/* For every vertex the sphere that holds it among `count`, by climbing from each. */
static uint32_t *climb(const sph_hierarchy *h, uint32_t count)
{
    const uint32_t n = sph_hierarchy_vertex_count(h), end = 2 * n - count;
    uint32_t *parents = test_malloc(end, sizeof *parents), *labels = test_malloc(n, sizeof *labels), place = 0;
    for (uint32_t node = 0; node < end; ++node)
        parents[node] = UINT32_MAX;
    for (uint32_t t = 0; t < end - n; ++t) {
        sph_collapse c;
        ck_assert_int_eq(sph_hierarchy_collapse(h, t, &c), SPH_OK);
        parents[c.u] = parents[c.v] = c.node;
    }
    for (uint32_t v = 0; v < n; ++v)
        for (labels[v] = v; parents[labels[v]] != UINT32_MAX;)
            labels[v] = parents[labels[v]];
    for (uint32_t node = 0; node < end; ++node)
        parents[node] = parents[node] == UINT32_MAX ? place++ : UINT32_MAX;
    ck_assert_uint_eq(place, count);
    for (uint32_t v = 0; v < n; ++v)
        labels[v] = parents[labels[v]];
    free(parents);
    return labels;
}

static void check_cursor(sph_cursor *cursor, const sph_level_arrays *a)
{
    uint32_t *nodes = test_malloc(a->sphere_count, 4), *edges = test_malloc(a->edge_count, 8);
    uint32_t *triangles = test_malloc(a->triangle_count, 12);
    ck_assert_int_eq(sph_cursor_move(cursor, a->sphere_count), SPH_OK);
    ck_assert_uint_eq(sph_cursor_edge_count(cursor), a->edge_count);
    ck_assert_uint_eq(sph_cursor_triangle_count(cursor), a->triangle_count);
    ck_assert_int_eq(sph_cursor_read(cursor, nodes, edges, triangles), SPH_OK);
    for (size_t i = 0; i < 2 * a->edge_count; ++i)
        ck_assert_uint_eq(edges[i], nodes[a->edges[i]]);
    for (size_t i = 0; i < 3 * a->triangle_count; ++i)
        ck_assert_uint_eq(triangles[i], nodes[a->triangles[i]]);
    free(nodes);
    free(edges);
    free(triangles);
}

static void check_simplices(const sph_animation *animation, const sph_level *level, const uint32_t *labels)
{
    sph_level_arrays a = {.struct_size = sizeof a};
    simplicial expected, found;
    const char *wrong;
    ck_assert_int_eq(sph_level_get_arrays(level, &a), SPH_OK);
    if (labels != NULL) ck_assert_mem_eq(labels, a.labels, a.label_count * sizeof *labels);
    expected = simplicial_of_labels(animation, a.labels, a.sphere_count);
    found = simplicial_of_level(&a, &wrong);
    ck_assert_msg(wrong == NULL, "%u spheres: %s", a.sphere_count, wrong);
    ck_assert_msg(simplicial_equal(&expected, &found), "%u spheres: other simplices", a.sphere_count);
    if (labels != NULL) ck_assert_uint_eq(simplicial_components(&found), test_component_count(animation));
    simplicial_free(&expected);
    simplicial_free(&found);
}

/* From the finest level to the coarsest by steps, and every one of the last; the cursor jumps between both ends. */
START_TEST(levels_of_real_meshes_are_the_image_of_the_input)
{
    sph_animation *animation = open_data((unsigned)_i);
    const uint32_t n = sph_animation_vertex_count(animation), least = test_component_count(animation);
    sph_hierarchy *h;
    sph_cursor *cursor;
    ck_assert_int_eq(sph_hierarchy_create(animation, NULL, &h), SPH_OK);
    ck_assert_uint_eq(n - sph_hierarchy_collapse_count(h), least);
    ck_assert_int_eq(sph_cursor_create(h, &cursor), SPH_OK);
    for (uint32_t count = n, back = 0;; back = !back) {
        const uint32_t here = back ? n - (count - least) : count;
        uint32_t *labels = climb(h, here);
        sph_level_arrays a = {.struct_size = sizeof a};
        sph_level *level;
        ck_assert_int_eq(sph_level_create(h, here, &level), SPH_OK);
        ck_assert_int_eq(sph_level_get_arrays(level, &a), SPH_OK);
        check_simplices(animation, level, labels);
        check_cursor(cursor, &a);
        sph_level_destroy(level);
        free(labels);
        if (count == least && back) break;
        if (back) count -= count > least + 60 ? (count - least) / 12 : 1;
    }
    sph_cursor_destroy(cursor);
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(optimised_levels_of_real_meshes_are_the_duals_of_their_labels)
{
    static const uint32_t COUNTS[] = {20, 40, 46, 200, 700};
    sph_animation *animation = open_data((unsigned)_i);
    sph_hierarchy *h;
    ck_assert_int_eq(sph_hierarchy_create(animation, NULL, &h), SPH_OK);
    for (unsigned i = 0; i < sizeof COUNTS / sizeof *COUNTS; ++i) {
        sph_level *level;
        ck_assert_int_eq(sph_level_create(h, COUNTS[i], &level), SPH_OK);
        ck_assert_int_eq(sph_level_optimize_connectivity(level, animation), SPH_OK);
        check_simplices(animation, level, NULL);
        sph_level_destroy(level);
    }
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(a_real_mesh_collapses_alike_at_any_size)
{
    static const double SIZES[] = {0x1p-70, 0x1p40};
    sph_animation *animation = open_data((unsigned)_i), *scaled;
    const uint32_t n = sph_animation_vertex_count(animation), frames = sph_animation_frame_count(animation);
    float *xyz = test_malloc(n, 3 * sizeof *xyz);
    sph_hierarchy *h, *g;
    ck_assert_int_eq(sph_hierarchy_create(animation, NULL, &h), SPH_OK);
    for (unsigned i = 0; i < sizeof SIZES / sizeof *SIZES; ++i) {
        ck_assert_int_eq(sph_animation_create(context, n, frames, &scaled), SPH_OK);
        for (uint32_t f = 0; f < frames; ++f) {
            ck_assert_int_eq(sph_animation_read_frame(animation, f, xyz), SPH_OK);
            for (size_t k = 0; k < 3 * (size_t)n; ++k)
                xyz[k] = (float)((double)xyz[k] * SIZES[i]);
            ck_assert_int_eq(sph_animation_set_frame(scaled, f, xyz, 0), SPH_OK);
        }
        ck_assert_int_eq(sph_animation_set_triangles(scaled, sph_animation_triangles(animation),
                                                     sph_animation_triangle_count(animation), 0),
                         SPH_OK);
        ck_assert_int_eq(sph_hierarchy_create(scaled, NULL, &g), SPH_OK);
        for (uint32_t t = 0; t < sph_hierarchy_collapse_count(h); ++t) {
            sph_collapse x, y;
            ck_assert_int_eq(sph_hierarchy_collapse(h, t, &x), SPH_OK);
            ck_assert_int_eq(sph_hierarchy_collapse(g, t, &y), SPH_OK);
            ck_assert(x.u == y.u && x.v == y.v && x.forced == y.forced);
            ck_assert_double_eq(x.error * SIZES[i], y.error);
        }
        sph_hierarchy_destroy(g);
        sph_animation_destroy(scaled);
    }
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
    free(xyz);
}
END_TEST

static void setup(void)
{
    context = test_context();
}

static void teardown(void)
{
    sph_context_destroy(context);
}

int main(void)
{
    Suite *suite;
    TCase *tc;
    if (getenv("SPHMESH_DATA") == NULL) {
        puts("1..0 # SKIP SPHMESH_DATA names no folder of real animated meshes");
        return EXIT_SUCCESS;
    }
    suite = suite_create("level data");
    tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, levels_of_real_meshes_are_the_image_of_the_input, 0, DATA_COUNT);
    tcase_add_loop_test(tc, optimised_levels_of_real_meshes_are_the_duals_of_their_labels, 0, DATA_COUNT);
    tcase_add_loop_test(tc, a_real_mesh_collapses_alike_at_any_size, 0, DATA_COUNT);
    return run_suite(suite, tc);
}
