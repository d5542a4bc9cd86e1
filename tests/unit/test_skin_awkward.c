/* SPDX-License-Identifier: MIT */
/* Decomposition of inputs without areas, triangles, neighbours or sense. */
#include <check.h>
#include <math.h>

#include "awkward.h"
#include "runner.h"
#include "support.h"

static void check_skin(const sph_skin *skin, const char *name)
{
    sph_skin_arrays a = {.struct_size = sizeof a};
    sph_skin_error e;
    ck_assert_int_eq(sph_skin_get_arrays(skin, &a), SPH_OK);
    ck_assert_int_eq(sph_skin_get_errors(skin, &e, NULL), SPH_OK);
    ck_assert_msg(isfinite(e.rmse) && isfinite(e.mse) && e.max <= e.diagonal, "%s: %g", name, e.max);
    ck_assert_uint_eq(a.rigid, 1);
    for (size_t v = 0; v < a.vertex_count; ++v) {
        float sum = 0;
        for (size_t s = 0; s < a.influence_count; ++s)
            sum += a.weights[v * a.influence_count + s];
        ck_assert_msg(sum == 1, "%s: vertex %zu", name, v);
        for (int k = 0; k < 3; ++k)
            ck_assert(isfinite(a.rest[3 * v + k]));
    }
}

/* _i: the mode */
START_TEST(every_kind_of_input_gives_a_skin_at_every_kind_of_level)
{
    for (unsigned kind = 0; kind < AWKWARD_KIND_COUNT; ++kind) {
        sph_context *context = test_context_with_threads(1);
        sph_animation *animation = awkward(context, kind, 9);
        sph_hierarchy *hierarchy = NULL;
        uint32_t n, collapses;
        ck_assert_int_eq(sph_hierarchy_create(animation, NULL, &hierarchy), SPH_OK);
        n = sph_animation_vertex_count(animation);
        collapses = sph_hierarchy_collapse_count(hierarchy);
        for (uint32_t part = 0; part <= 2; ++part) {
            const sph_skin_source source = {animation, NULL, 0};
            sph_skin_options o;
            sph_level *level = NULL;
            sph_skin *skin = NULL;
            sph_skin_options_init(&o, sizeof o);
            o.mode = _i;
            o.rings = part + 1;
            o.round_limit = 6;
            ck_assert_int_eq(sph_level_create(hierarchy, n - collapses * (2 - part) / 2, &level), SPH_OK);
            ck_assert_msg(sph_skin_create(level, &source, 1, &o, &skin) == SPH_OK, "%s: %s", awkward_name(kind),
                          sph_context_last_message(context));
            check_skin(skin, awkward_name(kind));
            sph_skin_destroy(skin);
            sph_level_destroy(level);
        }
        sph_hierarchy_destroy(hierarchy);
        sph_animation_destroy(animation);
        sph_context_destroy(context);
    }
}
END_TEST

START_TEST(of_more_bones_within_reach_than_can_be_weighed_the_nearest_are)
{
    sph_context *context = test_context_with_threads(1);
    sph_animation *animation = test_sphere(context, 2, 5);
    const sph_skin_source source = {animation, NULL, 0};
    sph_hierarchy *hierarchy = NULL;
    sph_level *level = NULL;
    sph_skin *skin = NULL;
    sph_skin_options o;
    sph_skin_options_init(&o, sizeof o);
    o.mode = _i;
    o.rings = 50; /* all 90 */
    o.round_limit = 3;
    ck_assert_int_eq(sph_hierarchy_create(animation, NULL, &hierarchy), SPH_OK);
    ck_assert_int_eq(sph_level_create(hierarchy, 90, &level), SPH_OK);
    ck_assert_int_eq(sph_skin_create(level, &source, 1, &o, &skin), SPH_OK);
    check_skin(skin, "sphere");
    sph_skin_destroy(skin);
    sph_level_destroy(level);
    sph_hierarchy_destroy(hierarchy);
    sph_animation_destroy(animation);
    sph_context_destroy(context);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("skin_awkward");
    TCase *tc = tcase_create("inputs");
    tcase_add_loop_test(tc, every_kind_of_input_gives_a_skin_at_every_kind_of_level, 0, 3);
    tcase_add_loop_test(tc, of_more_bones_within_reach_than_can_be_weighed_the_nearest_are, 0, 3);
    return run_suite(suite, tc);
}
