/* SPDX-License-Identifier: MIT */
/* Levels of some frames, and without labels, against the spheres that the hierarchy tells of and whole levels. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "runner.h"
#include "support.h"

enum { FRAMES = 37 }; /* more than two tiles of the copy, and no multiple */

static sph_context *context;
static sph_hierarchy *hierarchy;

/* Loop index 0: one radius per sphere; 1: radii per frame. */
static void build(int mode)
{
    sph_hierarchy_options o;
    sph_animation *torus;
    context = test_context();
    torus = test_torus(context, 12, 7, FRAMES);
    sph_hierarchy_options_init(&o, sizeof o);
    o.radius_mode = mode == 0 ? SPH_RADIUS_CONSTANT : SPH_RADIUS_PER_FRAME;
    ck_assert_int_eq(sph_hierarchy_create(torus, &o, &hierarchy), SPH_OK);
    sph_animation_destroy(torus);
}

static void teardown(void)
{
    sph_hierarchy_destroy(hierarchy);
    sph_context_destroy(context);
}

static sph_level *extract(uint32_t spheres, const sph_level_options *o)
{
    sph_level *level = NULL;
    ck_assert_int_eq(sph_level_extract(hierarchy, spheres, o, &level), SPH_OK);
    ck_assert_ptr_nonnull(level);
    return level;
}

static sph_level_arrays arrays_of(const sph_level *level)
{
    sph_level_arrays a = {.struct_size = sizeof a};
    ck_assert_int_eq(sph_level_get_arrays(level, &a), SPH_OK);
    return a;
}

/* The spheres of a level are those of the cursor's nodes, in the frames asked for. */
static void check_spheres(const sph_level_arrays *a, uint32_t first)
{
    float centers[3 * FRAMES], radii[FRAMES];
    uint32_t *nodes = test_malloc(a->sphere_count, sizeof *nodes);
    sph_cursor *cursor;
    ck_assert_int_eq(sph_cursor_create(hierarchy, &cursor), SPH_OK);
    ck_assert_int_eq(sph_cursor_move(cursor, a->sphere_count), SPH_OK);
    ck_assert_int_eq(sph_cursor_read(cursor, nodes, NULL, NULL), SPH_OK);
    for (uint32_t i = 0; i < a->sphere_count; ++i) {
        ck_assert_int_eq(sph_hierarchy_sphere(hierarchy, nodes[i], centers, radii), SPH_OK);
        for (uint32_t f = 0; f < a->frame_count; ++f) {
            const size_t at = (size_t)f * a->sphere_count + i;
            ck_assert_mem_eq(a->centers + 3 * at, centers + 3 * (first + f), 3 * sizeof(float));
            ck_assert_mem_eq(a->radii + (a->radii_per_frame ? at : i), radii + first + f, sizeof(float));
        }
    }
    sph_cursor_destroy(cursor);
    free(nodes);
}

START_TEST(spheres_are_those_of_the_hierarchy_in_the_frames_asked_for)
{
    static const uint32_t RANGES[][2] = {{0, 0}, {0, 1}, {5, 17}, {16, 16}, {FRAMES - 1, 0}, {20, 0}};
    build(_i);
    for (size_t r = 0; r < sizeof RANGES / sizeof *RANGES; ++r) {
        sph_level_options o;
        sph_level_options_init(&o, sizeof o);
        o.first_frame = RANGES[r][0];
        o.frame_count = RANGES[r][1];
        for (uint32_t spheres = 1; spheres <= 84; spheres += 83) {
            sph_level *level = extract(spheres, &o);
            const sph_level_arrays a = arrays_of(level);
            ck_assert_uint_eq(a.frame_count, RANGES[r][1] != 0 ? RANGES[r][1] : FRAMES - RANGES[r][0]);
            check_spheres(&a, RANGES[r][0]);
            sph_level_destroy(level);
        }
    }
    teardown();
}
END_TEST

START_TEST(a_level_without_labels_is_the_whole_level_in_all_else)
{
    sph_level_options o;
    build(_i);
    sph_level_options_init(&o, sizeof o);
    o.labels = SPH_LABELS_NONE;
    for (uint32_t spheres = 1; spheres <= 84; ++spheres) {
        sph_level *bare = extract(spheres, &o), *whole = extract(spheres, NULL);
        const sph_level_arrays a = arrays_of(bare), b = arrays_of(whole);
        ck_assert_uint_eq(a.label_count, 0);
        ck_assert_uint_eq(b.label_count, 84);
        ck_assert_uint_eq(a.edge_count, b.edge_count);
        ck_assert_uint_eq(a.triangle_count, b.triangle_count);
        ck_assert_mem_eq(a.centers, b.centers, 3 * sizeof(float) * FRAMES * spheres);
        ck_assert_mem_eq(a.edges, b.edges, 2 * sizeof(uint32_t) * a.edge_count);
        ck_assert_mem_eq(a.triangles, b.triangles, 3 * sizeof(uint32_t) * a.triangle_count);
        sph_level_destroy(bare);
        sph_level_destroy(whole);
    }
    teardown();
}
END_TEST

static void refuses(const sph_level_options *o, sph_status expected, const char *word)
{
    sph_level *level = (sph_level *)&level;
    ck_assert_int_eq(sph_level_extract(hierarchy, 10, o, &level), expected);
    ck_assert_ptr_null(level);
    ck_assert_msg(strstr(sph_context_last_message(context), word) != NULL, "'%s' has no '%s'",
                  sph_context_last_message(context), word);
}

START_TEST(options_out_of_range_are_refused_and_named)
{
    sph_level_options o, changed;
    sph_level *level = NULL;
    struct {
        sph_level_options known;
        uint32_t later;
    } newer = {.later = 1};
    build(0);
    sph_level_options_init(&o, sizeof o);
    changed = o;
    changed.first_frame = FRAMES;
    refuses(&changed, SPH_E_INVALID, "37");
    changed = o;
    changed.first_frame = 1;
    changed.frame_count = FRAMES;
    refuses(&changed, SPH_E_INVALID, "37");
    changed.frame_count = UINT32_MAX;
    refuses(&changed, SPH_E_INVALID, "37");
    changed = o;
    changed.labels = 2;
    refuses(&changed, SPH_E_INVALID, "labels");
    changed = o;
    changed.flags = 1;
    refuses(&changed, SPH_E_INVALID, "flags");
    changed = (sph_level_options){0};
    refuses(&changed, SPH_E_INVALID, "struct_size");
    newer.known = o;
    newer.known.struct_size = sizeof newer;
    refuses(&newer.known, SPH_E_VERSION, "version");
    ck_assert_int_eq(sph_level_extract(hierarchy, 0, &o, &level), SPH_E_INVALID);
    ck_assert_int_eq(sph_level_extract(hierarchy, 85, &o, &level), SPH_E_INVALID);
    ck_assert_int_eq(sph_level_extract(NULL, 10, &o, &level), SPH_E_INVALID);
    ck_assert_int_eq(sph_level_extract(hierarchy, 10, &o, NULL), SPH_E_INVALID);
    teardown();
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("level_extract");
    TCase *cases = tcase_create("all");
    tcase_add_loop_test(cases, spheres_are_those_of_the_hierarchy_in_the_frames_asked_for, 0, 2);
    tcase_add_loop_test(cases, a_level_without_labels_is_the_whole_level_in_all_else, 0, 2);
    tcase_add_test(cases, options_out_of_range_are_refused_and_named);
    suite_add_tcase(suite, cases);
    return run_all(suite);
}
