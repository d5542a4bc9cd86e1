/* SPDX-License-Identifier: MIT */
/* Levels of a rigged file: read back they are those of the progressive mesh; and memory may end anywhere on the way. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "../unit/simplify_case.h"
#include "faults.h"
#include "files.h"
#include "runner.h"

/* A rig's file, its levels, and a file of two of them. */
static sph_status make(sph_context *context, const char *rig, const char *chain, sph_io_rig_levels **out)
{
    simplify_case c = make_tube(context, 8, 5);
    uint32_t numbers[2] = {0, 12};
    sph_status status = c.skin == NULL ? SPH_E_NOMEM : sph_io_save_rig(context, c.skin, NULL, NULL, rig);
    if (status == SPH_OK) status = sph_io_open_rig_levels(context, rig, NULL, NULL, out);
    ck_assert((*out != NULL) == (status == SPH_OK));
    if (status == SPH_OK) status = sph_io_rig_levels_save(*out, numbers, 2, chain);
    free_case(&c);
    return status;
}

START_TEST(a_level_is_read_back_as_it_was)
{
    const char *rig = file_path("rig.glb"), *chain = file_path("chain.glb"), *alone = file_path("alone.glb");
    sph_context *context = test_context();
    sph_io_rig_levels *levels = NULL;
    sph_io_rig *back = NULL;
    ck_assert_int_eq(make(context, rig, chain, &levels), SPH_OK);
    for (uint32_t level = 0; level < 30; level += 7) {
        sph_skin *skin = level_of(sph_io_rig_levels_progressive(levels), level);
        const sph_skin_arrays a = arrays_of(skin);
        sph_skin_arrays b;
        size_t found = 0;
        ck_assert_int_eq(sph_io_rig_levels_save(levels, &level, 1, alone), SPH_OK);
        ck_assert_int_eq(sph_io_open_rig(context, alone, NULL, &back), SPH_OK);
        b = arrays_of(sph_io_rig_skin(back));
        ck_assert_uint_eq(a.vertex_count, b.vertex_count);
        ck_assert_uint_eq(a.triangle_count, b.triangle_count);
        ck_assert_uint_eq(a.frame_count, b.frame_count);
        ck_assert_mem_eq(a.transforms, b.transforms, 12 * sizeof(double) * a.frame_count * a.bone_count);
        for (size_t i = 0; i < 3 * a.triangle_count; ++i) { /* vertices come in the order of their first use */
            const size_t v = a.triangles[i], w = b.triangles[i];
            found += memcmp(a.rest + 3 * v, b.rest + 3 * w, 3 * sizeof(float)) == 0;
            for (uint32_t s = 0; s < b.influence_count; ++s) {
                ck_assert_uint_eq(a.bones[v * a.influence_count + s], b.bones[w * b.influence_count + s]);
                ck_assert(a.weights[v * a.influence_count + s] == b.weights[w * b.influence_count + s]);
            }
        }
        ck_assert_uint_eq(found, 3 * a.triangle_count);
        sph_io_rig_destroy(back);
        sph_skin_destroy(skin);
    }
    sph_io_rig_levels_destroy(levels);
    sph_context_destroy(context);
}
END_TEST

static sph_status make_and_destroy(sph_context *context, const void *user)
{
    sph_io_rig_levels *levels = NULL;
    const sph_status status = make(context, file_path("rig.glb"), file_path("chain.glb"), &levels);
    (void)user;
    sph_io_rig_levels_destroy(levels);
    ck_assert_uint_le(file_count(), 2); /* nothing half-written is left */
    return status;
}

/* _i: once, or from there on. */
START_TEST(every_allocation_may_fail)
{
    check_every_allocation((test_faults){.work = make_and_destroy, .least = 200, .sticky = _i, .thinning = 60});
}
END_TEST

START_TEST(what_cannot_be_written_is_refused)
{
    const char *rig = file_path("rig.glb"), *chain = file_path("chain.glb");
    sph_context *context = test_context();
    sph_io_rig_levels *levels = NULL, *none;
    sph_simplify_options o;
    const float normals[3] = {0, 0, 1};
    uint32_t numbers[2] = {12, 12}, last;
    ck_assert_int_eq(make(context, rig, chain, &levels), SPH_OK);
    last = sph_progressive_collapse_count(sph_io_rig_levels_progressive(levels));
    ck_assert_int_eq(sph_io_rig_levels_save(levels, numbers, 2, chain), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_rig_levels_save(levels, numbers, 0, chain), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_rig_levels_save(levels, numbers, 65, chain), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_rig_levels_save(levels, numbers, 1, file_path("x.gltf")), SPH_E_UNSUPPORTED);
    ck_assert_int_eq(sph_io_rig_levels_save(levels, &last, 1, chain), SPH_E_LIMIT);
    numbers[0] = last + 1;
    ck_assert_int_eq(sph_io_rig_levels_save(levels, numbers, 1, chain), SPH_E_INVALID);
    sph_simplify_options_init(&o, sizeof o);
    o.normals = normals;
    ck_assert_int_eq(sph_io_open_rig_levels(context, rig, NULL, &o, &none), SPH_E_INVALID);
    ck_assert_ptr_null(none);
    sph_io_rig_levels_destroy(levels);
    sph_context_destroy(context);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("io_rig_levels");
    TCase *tc = tcase_create("levels");
    tcase_add_checked_fixture(tc, files_setup, files_teardown);
    tcase_add_test(tc, a_level_is_read_back_as_it_was);
    tcase_add_loop_test(tc, every_allocation_may_fail, 0, 2);
    tcase_add_test(tc, what_cannot_be_written_is_refused);
    return run_suite(suite, tc);
}
