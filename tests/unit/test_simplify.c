/* SPDX-License-Identifier: MIT */
/* Levels of skinned meshes against what is known of them in advance. */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "runner.h"
#include "simplify_case.h"

static sph_context *context;

static void setup(void)
{
    context = test_context();
}

static void teardown(void)
{
    sph_context_destroy(context);
}

static sph_simplify_options defaults(void)
{
    sph_simplify_options o;
    sph_simplify_options_init(&o, sizeof o);
    return o;
}

/* The places where the beam cannot do without vertices: the corners of four rings. */
START_TEST(what_can_be_simplified_exactly_stays_exact_and_keeps_its_joint)
{
    sph_skin *beam = make_beam(context, 17, 3), *reduced;
    sph_progressive *p = simplify(beam, NULL);
    const uint32_t points = sph_progressive_point_count(p);
    sph_skin_arrays a;
    uint32_t seen[4] = {0, 0, 0, 0};
    ck_assert_uint_eq(points, 17 * 12 + 2);
    ck_assert_double_lt(figures_of(p, points - 16).max_error, 5e-5);
    ck_assert_double_gt(figures_of(p, points - 15).max_error, 1e-3);
    reduced = level_of(p, points - 16);
    a = arrays_of(reduced);
    ck_assert_uint_eq(a.vertex_count, 16);
    for (size_t v = 0; v < 16; ++v) {
        const float *x = a.rest + 3 * v;
        const int ring = fabsf(x[0] + 2) < 1e-4F ? 0 : fabsf(x[0]) < 1e-4F ? 1 : fabsf(x[0] - 0.25F) < 1e-4F ? 2 : 3;
        if (ring == 3) ck_assert_float_eq_tol(x[0], 2, 1e-4);
        ck_assert_float_eq_tol(fabsf(x[1]), 0.5, 1e-4);
        ck_assert_float_eq_tol(fabsf(x[2]), 0.5, 1e-4);
        ck_assert_uint_eq(a.bones[v * a.influence_count], ring > 1);
        ck_assert_float_eq_tol(a.weights[v * a.influence_count], 1, 1e-4);
        ++seen[ring];
    }
    for (int ring = 0; ring < 4; ++ring)
        ck_assert_uint_eq(seen[ring], 4);
    sph_skin_destroy(reduced);
    sph_progressive_destroy(p);
    sph_skin_destroy(beam);
}
END_TEST

/* A skin on one bone, whose poses turn and shift it, and its simplification in the rest pose alone. */
START_TEST(with_one_bone_it_is_the_simplification_of_the_rest_pose)
{
    simplify_case c = make_tube(context, 14, 11);
    sph_skin_arrays a = arrays_of(c.skin);
    sph_simplify_options o = defaults();
    double poses[5][12];
    uint32_t *bones = test_malloc(a.vertex_count, sizeof *bones);
    float *weights = test_malloc(a.vertex_count, sizeof *weights);
    sph_progressive *skinned, *still;
    sph_skin *rigid = NULL;
    for (uint32_t v = 0; v < a.vertex_count; ++v) {
        bones[v] = 0;
        weights[v] = 1;
    }
    for (int j = 0; j < 5; ++j) {
        const double s = sin(j), k = cos(j);
        memcpy(poses[j], (double[12]){k, -s, 0, j, s, k, 0, -2, 0, 0, 1, 0.5 * j}, sizeof poses[j]);
    }
    a.bone_count = a.influence_count = 1;
    a.bones = bones;
    a.weights = weights;
    a.frame_count = 0;
    a.clip_count = 0;
    a.link_count = 0;
    a.pivots = a.radii = NULL;
    ck_assert_int_eq(sph_skin_create_from_arrays(context, &a, &rigid), SPH_OK);
    o.poses = poses[0];
    o.pose_count = 5;
    skinned = simplify(rigid, &o);
    o = defaults();
    o.method = SPH_SIMPLIFY_REST;
    still = simplify(rigid, &o);
    ck_assert_uint_eq(sph_progressive_collapse_count(skinned), sph_progressive_collapse_count(still));
    for (uint32_t level = 0; level < 130; level += 13) {
        sph_skin *x = level_of(skinned, level), *y = level_of(still, level);
        const sph_skin_arrays ax = arrays_of(x), ay = arrays_of(y);
        ck_assert_uint_eq(ax.vertex_count, ay.vertex_count);
        ck_assert_uint_eq(ax.triangle_count, ay.triangle_count);
        ck_assert_mem_eq(ax.triangles, ay.triangles, 3 * ax.triangle_count * sizeof *ax.triangles);
        for (size_t i = 0; i < 3 * (size_t)ax.vertex_count; ++i)
            ck_assert_float_eq_tol(ax.rest[i], ay.rest[i], 1e-3);
        ck_assert_double_eq_tol(figures_of(skinned, level).error, figures_of(still, level).error, 1e-5);
        sph_skin_destroy(x);
        sph_skin_destroy(y);
    }
    sph_progressive_destroy(skinned);
    sph_progressive_destroy(still);
    sph_skin_destroy(rigid);
    free(bones);
    free(weights);
    free_case(&c);
}
END_TEST

/* _i: influences. */
START_TEST(weights_are_weights_at_all_levels_and_as_few_as_asked_for)
{
    simplify_case c = make_tube(context, 24, 12);
    sph_simplify_options o = defaults();
    sph_progressive *p;
    o.influence_limit = (uint32_t)_i;
    p = simplify(c.skin, &o);
    ck_assert_uint_eq(sph_progressive_influence_count(p), (uint32_t)_i);
    for (uint32_t level = 0; figures_of(p, level).triangle_count > 0; level += 20) {
        sph_skin *skin = level_of(p, level);
        const sph_skin_arrays a = arrays_of(skin);
        ck_assert_uint_eq(a.influence_count, (uint32_t)_i);
        for (size_t v = 0; v < a.vertex_count; ++v) {
            double sum = 0;
            for (uint32_t s = 0; s < a.influence_count; ++s) {
                ck_assert_float_ge(a.weights[v * a.influence_count + s], 0);
                ck_assert_uint_lt(a.bones[v * a.influence_count + s], 3);
                sum += (double)a.weights[v * a.influence_count + s];
            }
            ck_assert(sum == 1);
        }
        sph_skin_destroy(skin);
        if (level + 20 > sph_progressive_collapse_count(p)) break;
    }
    sph_progressive_destroy(p);
    free_case(&c);
}
END_TEST

START_TEST(the_first_level_is_the_input)
{
    simplify_case c = make_tube(context, 10, 8);
    const sph_skin_arrays before = arrays_of(c.skin);
    sph_simplify_options o = defaults();
    float *normals = test_malloc(before.vertex_count, 3 * sizeof *normals);
    float *attributes = test_malloc(before.vertex_count, 2 * sizeof *attributes);
    uint32_t *vertices = test_malloc(before.vertex_count, sizeof *vertices);
    uint32_t *triangles = test_malloc(before.triangle_count, sizeof *triangles);
    sph_progressive *p;
    sph_skin *level;
    sph_skin_arrays a;
    o.normals = c.normals;
    o.attributes = c.attributes;
    o.attribute_count = 2;
    p = simplify(c.skin, &o);
    level = level_of(p, 0);
    a = arrays_of(level);
    ck_assert_uint_eq(sph_progressive_point_count(p), 10 * 8);
    ck_assert_uint_eq(a.vertex_count, before.vertex_count);
    ck_assert_uint_eq(a.triangle_count, before.triangle_count);
    ck_assert_mem_eq(a.rest, before.rest, 3 * (size_t)a.vertex_count * sizeof *a.rest);
    ck_assert_mem_eq(a.weights, before.weights, 3 * (size_t)a.vertex_count * sizeof *a.weights);
    ck_assert_mem_eq(a.transforms, before.transforms, TUBE_FRAMES * 3 * 12 * sizeof *a.transforms);
    ck_assert_int_eq(sph_progressive_get_attributes(p, 0, normals, attributes, vertices, triangles), SPH_OK);
    ck_assert_mem_eq(normals, c.normals, 3 * (size_t)a.vertex_count * sizeof *normals);
    ck_assert_mem_eq(attributes, c.attributes, 2 * (size_t)a.vertex_count * sizeof *attributes);
    for (uint32_t i = 0; i < a.vertex_count; ++i)
        ck_assert_uint_eq(vertices[i], i);
    for (uint32_t t = 0; t < a.triangle_count; ++t) {
        const uint32_t *x = a.triangles + 3 * (size_t)t, *y = before.triangles + 3 * (size_t)t;
        ck_assert_uint_eq(triangles[t], t);
        ck_assert((x[0] == y[0] && x[1] == y[1] && x[2] == y[2]) || (x[0] == y[1] && x[1] == y[2] && x[2] == y[0]) ||
                  (x[0] == y[2] && x[1] == y[0] && x[2] == y[1]));
    }
    sph_skin_destroy(level);
    sph_progressive_destroy(p);
    free(normals);
    free(attributes);
    free(vertices);
    free(triangles);
    free_case(&c);
}
END_TEST

/* No triangle goes over the seam, where the texture would run backwards through all of itself. */
START_TEST(texture_stays_cut_at_its_seam_and_normals_keep_their_length)
{
    simplify_case c = make_tube(context, 30, 16);
    sph_simplify_options o = defaults();
    sph_progressive *p;
    o.normals = c.normals;
    o.attributes = c.attributes;
    o.attribute_count = 2;
    p = simplify(c.skin, &o);
    for (uint32_t level = 0; figures_of(p, level).point_count > 60; level += 30) {
        sph_skin *skin = level_of(p, level);
        const sph_skin_arrays a = arrays_of(skin);
        float *normals = test_malloc(a.vertex_count, 3 * sizeof *normals);
        float *uv = test_malloc(a.vertex_count, 2 * sizeof *uv);
        ck_assert_uint_eq(a.vertex_count, figures_of(p, level).vertex_count);
        ck_assert_uint_gt(a.vertex_count, figures_of(p, level).point_count);
        ck_assert_int_eq(sph_progressive_get_attributes(p, level, normals, uv, NULL, NULL), SPH_OK);
        for (size_t v = 0; v < a.vertex_count; ++v) {
            const float *x = a.rest + 3 * v, *n = normals + 3 * v;
            double turn = atan2((double)x[2], (double)x[1]) / 6.283185307179586 - (double)uv[2 * v];
            turn -= floor(turn + 0.5);
            ck_assert_double_lt(fabs(turn), 0.05); /* the texture is where it was */
            ck_assert_float_eq_tol(uv[2 * v + 1], x[0] / 4 + 0.5F, 0.05);
            ck_assert_float_eq_tol(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-5);
        }
        for (size_t i = 0; i < 3 * a.triangle_count; ++i) {
            const float u = uv[2 * (size_t)a.triangles[i]];
            const float next = uv[2 * (size_t)a.triangles[i % 3 == 2 ? i - 2 : i + 1]];
            ck_assert_float_lt(fabsf(u - next), 0.6);
        }
        free(normals);
        free(uv);
        sph_skin_destroy(skin);
    }
    sph_progressive_destroy(p);
    free_case(&c);
}
END_TEST

START_TEST(locked_vertices_are_in_all_levels_as_they_are)
{
    simplify_case c = make_tube(context, 16, 9);
    const sph_skin_arrays before = arrays_of(c.skin);
    sph_simplify_options o = defaults();
    uint8_t *locked = test_malloc(before.vertex_count, 1);
    sph_progressive *p;
    sph_skin *skin;
    sph_skin_arrays a;
    uint32_t count = 0;
    for (uint32_t v = 0; v < before.vertex_count; ++v)
        count += locked[v] = v % 10 < 9 && v / 10 % 5 == 0; /* every fifth ring, its seam's vertices by one of two */
    o.locked = locked;
    p = simplify(c.skin, &o);
    skin = level_of(p, sph_progressive_collapse_count(p));
    a = arrays_of(skin);
    ck_assert_uint_eq(count, 36);
    ck_assert_uint_eq(sph_progressive_point_count(p) - sph_progressive_collapse_count(p), count);
    for (uint32_t v = 0; v < before.vertex_count; ++v) {
        bool found = false;
        for (uint32_t i = 0; i < a.vertex_count && locked[v] && !found; ++i)
            found = memcmp(before.rest + 3 * (size_t)v, a.rest + 3 * (size_t)i, 3 * sizeof(float)) == 0 &&
                    memcmp(before.weights + 3 * (size_t)v, a.weights + 3 * (size_t)i, 3 * sizeof(float)) == 0;
        ck_assert(found || !locked[v]);
    }
    sph_skin_destroy(skin);
    sph_progressive_destroy(p);
    free(locked);
    free_case(&c);
}
END_TEST

/* Levels by a jump against the cursor, which goes collapse by collapse; and counts that never rise. */
START_TEST(levels_cursor_and_figures_agree)
{
    simplify_case c = make_tube(context, 12, 8);
    sph_progressive *p = simplify(c.skin, NULL);
    const uint32_t points = sph_progressive_point_count(p), last = sph_progressive_collapse_count(p);
    sph_cursor *cursor = NULL;
    ck_assert_int_eq(sph_progressive_create_cursor(p, &cursor), SPH_OK);
    ck_assert_uint_eq(points, 12 * 8);
    for (uint32_t level = 0; level <= last; ++level) {
        const sph_progressive_level now = figures_of(p, level), before = figures_of(p, level > 0 ? level - 1 : 0);
        uint32_t found;
        ck_assert_int_eq(sph_cursor_move(cursor, points - level), SPH_OK);
        ck_assert_uint_eq(sph_cursor_triangle_count(cursor), now.triangle_count);
        ck_assert_uint_eq(now.point_count, points - level);
        ck_assert_uint_le(now.vertex_count, before.vertex_count);
        ck_assert_uint_le(now.triangle_count, before.triangle_count);
        ck_assert_double_ge(now.error, before.error);
        ck_assert_double_ge(now.max_error, now.error * 0.999 - 1e-12);
        ck_assert_int_eq(sph_progressive_find_vertices(p, now.vertex_count, &found), SPH_OK);
        ck_assert_uint_le(found, level);
        ck_assert_uint_eq(figures_of(p, found).vertex_count, now.vertex_count);
        ck_assert_int_eq(sph_progressive_find_triangles(p, now.triangle_count, &found), SPH_OK);
        ck_assert_uint_eq(figures_of(p, found).triangle_count, now.triangle_count);
        ck_assert_int_eq(sph_progressive_find_error(p, now.error, &found), SPH_OK);
        ck_assert_uint_ge(found, level);
        ck_assert_double_eq(figures_of(p, found).error, now.error);
        if (now.triangle_count > 0) {
            sph_skin *skin = level_of(p, level);
            ck_assert_uint_eq(arrays_of(skin).triangle_count, now.triangle_count);
            ck_assert_uint_eq(sph_skin_vertex_count(skin), now.vertex_count);
            sph_skin_destroy(skin);
        }
    }
    sph_cursor_destroy(cursor);
    sph_progressive_destroy(p);
    free_case(&c);
}
END_TEST

/* Both methods measure themselves by the same formula, over the same poses. */
START_TEST(optimised_weights_are_no_worse_than_blended_ones)
{
    simplify_case c = make_tube(context, 40, 20);
    sph_simplify_options o = defaults();
    sph_progressive *best = simplify(c.skin, &o), *blended;
    o.method = SPH_SIMPLIFY_POSITION;
    blended = simplify(c.skin, &o);
    for (uint32_t keep = 40; keep <= 400; keep *= 2)
        ck_assert_double_lt(figures_of(best, 800 - keep).error, figures_of(blended, 800 - keep).error);
    sph_progressive_destroy(best);
    sph_progressive_destroy(blended);
    free_case(&c);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("simplify");
    TCase *tc = tcase_create("levels");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_test(tc, what_can_be_simplified_exactly_stays_exact_and_keeps_its_joint);
    tcase_add_test(tc, with_one_bone_it_is_the_simplification_of_the_rest_pose);
    tcase_add_loop_test(tc, weights_are_weights_at_all_levels_and_as_few_as_asked_for, 1, 4);
    tcase_add_test(tc, the_first_level_is_the_input);
    tcase_add_test(tc, texture_stays_cut_at_its_seam_and_normals_keep_their_length);
    tcase_add_test(tc, locked_vertices_are_in_all_levels_as_they_are);
    tcase_add_test(tc, levels_cursor_and_figures_agree);
    tcase_add_test(tc, optimised_weights_are_no_worse_than_blended_ones);
    return run_suite(suite, tc);
}
