/* SPDX-License-Identifier: MIT */
/* Set-ups of implicit skinning: parts and joints, edits, files, refusals, awkward skins, and memory that runs out. */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "faults.h"
#include "implicit_case.h"
#include "runner.h"

static tube t;
static sph_context *context;
static sph_skin *skin;

static void setup(void)
{
    context = test_context();
    tube_init(&t);
    skin = tube_skin(&t, context);
}

static void teardown(void)
{
    sph_skin_destroy(skin);
    sph_context_destroy(context);
}

typedef struct bytes {
    unsigned char *data;
    size_t size;
} bytes;

static sph_status keep(void *user, const void *data, size_t size)
{
    bytes *b = user;
    unsigned char *more = realloc(b->data, b->size + size);
    if (more == NULL) return SPH_E_NOMEM;
    memcpy(more + b->size, data, size);
    b->data = more;
    b->size += size;
    return SPH_OK;
}

START_TEST(joints_may_be_overridden_and_edited)
{
    sph_implicit_joint own = {.struct_size = sizeof own,
                              .operation = SPH_OPERATION_BULGE,
                              .bones = {1, 0},
                              .position = {0.25, 0, 0},
                              .strength = 0.3},
                       got = {.struct_size = sizeof got};
    sph_implicit_options o;
    sph_implicit *implicit;
    sph_implicit_part part = {.struct_size = sizeof part};
    sph_theta_curve_preset(&own.curve, SPH_OPERATION_BULGE);
    own.curve.thetas[2] = 0.1;
    sph_implicit_options_init(&o, sizeof o);
    o.parents = t.parents;
    o.joints = &own;
    o.joint_count = 1;
    o.operator_table_size = 16;
    ck_assert_int_eq(sph_implicit_create(skin, &o, &implicit), SPH_OK);
    ck_assert_uint_eq(sph_implicit_bone_count(implicit), 2);
    ck_assert_uint_eq(sph_implicit_joint_count(implicit), 1);
    ck_assert_int_eq(sph_implicit_get_joint(implicit, 0, &got), SPH_OK);
    ck_assert_int_eq(got.operation, SPH_OPERATION_BULGE);
    ck_assert_uint_eq(got.bones[0], 0);
    ck_assert_double_eq(got.position[0], 0.25);
    ck_assert_double_eq(got.strength, 0.3);
    ck_assert_double_eq(got.curve.thetas[2], 0.1);
    ck_assert_int_eq(sph_implicit_get_part(implicit, 0, &part), SPH_OK); /* closed a radius beyond where the joint is */
    ck_assert_double_eq_tol(part.samples[3 * (part.sample_count - 1)], 1.25, 0.02);
    got.strength = 0.51;
    ck_assert_int_eq(sph_implicit_set_joint(implicit, 0, &got), SPH_E_INVALID);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "strength"));
    got.strength = 0.2;
    got.operation = SPH_OPERATION_BLEND;
    ck_assert_int_eq(sph_implicit_set_joint(implicit, 0, &got), SPH_OK);
    ck_assert_int_eq(sph_implicit_get_joint(implicit, 0, &own), SPH_OK);
    ck_assert_int_eq(own.operation, SPH_OPERATION_BLEND);
    sph_implicit_destroy(implicit);
}
END_TEST

START_TEST(set_ups_come_back_from_files_as_they_were)
{
    sph_implicit *implicit = tube_implicit(skin, &t, _i), *back = NULL;
    bytes b = {NULL, 0}, again = {NULL, 0};
    double transforms[2][12], p[3], f[2], g[2][3];
    uint64_t random = 4;
    tube_pose(0.8, 0.2, transforms);
    ck_assert_int_eq(sph_implicit_write(implicit, keep, &b), SPH_OK);
    ck_assert_int_eq(sph_implicit_read(context, b.data, b.size, &back), SPH_OK);
    ck_assert_int_eq(sph_implicit_write(back, keep, &again), SPH_OK);
    ck_assert_uint_eq(again.size, b.size);
    ck_assert_mem_eq(again.data, b.data, b.size);
    for (int k = 0; k < 300; ++k) {
        for (int c = 0; c < 3; ++c)
            p[c] = 3 * test_random_unit(&random) - 1.5;
        for (int32_t e = 0; e < 2; ++e) {
            ck_assert_int_eq(sph_implicit_evaluate(implicit, transforms[0], e, 1, p, f, g[0], NULL), SPH_OK);
            ck_assert_int_eq(sph_implicit_evaluate(back, transforms[0], e, 1, p, f + 1, g[1], NULL), SPH_OK);
            ck_assert_mem_eq(f, f + 1, sizeof *f);
            ck_assert_mem_eq(g[0], g[1], sizeof g[0]);
        }
    }
    sph_implicit_destroy(back);
    for (size_t cut = 0; cut < b.size; cut += b.size / 37 + 1)
        ck_assert_int_eq(sph_implicit_read(context, b.data, cut, &back), SPH_E_FORMAT);
    for (size_t at = 0; at < b.size; at += b.size / 53 + 1) { /* no byte changes without being noticed */
        b.data[at] ^= 0x40;
        ck_assert_int_ne(sph_implicit_read(context, b.data, b.size, &back), SPH_OK);
        ck_assert_ptr_null(back);
        b.data[at] ^= 0x40;
    }
    free(b.data);
    free(again.data);
    sph_implicit_destroy(implicit);
}
END_TEST

START_TEST(what_is_wrong_is_said)
{
    static const uint32_t circle[2] = {1, 0}, high[2] = {UINT32_MAX, 7};
    static uint32_t parts[TUBE_VERTICES];
    sph_implicit_options o;
    sph_implicit *implicit;
    sph_skin *other;
    sph_tracker *tracker;
    sph_skin_arrays arrays = t.arrays;
    double transforms[2][12];
    static float xyz[TUBE_VERTICES][3];
    sph_implicit_options_init(&o, sizeof o);
    o.parents = circle;
    ck_assert_int_eq(sph_implicit_create(skin, &o, &implicit), SPH_E_INVALID);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "circle"));
    o.parents = high;
    ck_assert_int_eq(sph_implicit_create(skin, &o, &implicit), SPH_E_INVALID);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "bone 1 hangs on bone 7"));
    o.parents = t.parents;
    parts[9] = 2;
    o.parts = parts;
    ck_assert_int_eq(sph_implicit_create(skin, &o, &implicit), SPH_E_INVALID);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "vertex 9"));
    o.parts = NULL;
    o.sample_count = 3;
    ck_assert_int_eq(sph_implicit_create(skin, &o, &implicit), SPH_E_INVALID);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "sample_count"));
    arrays.triangle_count = 0;
    ck_assert_int_eq(sph_skin_create_from_arrays(context, &arrays, &other), SPH_OK);
    ck_assert_int_eq(sph_implicit_create(other, NULL, &implicit), SPH_E_STATE);
    ck_assert_ptr_null(implicit);
    implicit = tube_implicit(skin, &t, SPH_OPERATION_UNION);
    ck_assert_int_eq(sph_tracker_create(implicit, other, NULL, &tracker), SPH_E_STATE);
    ck_assert_int_eq(sph_tracker_create(implicit, skin, NULL, &tracker), SPH_OK);
    tube_pose(0.5, 0, transforms);
    transforms[1][7] = NAN;
    ck_assert_int_eq(sph_tracker_pose(tracker, transforms[0], 1, xyz[0], NULL, NULL), SPH_E_INVALID);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "bone 1 in pose 0"));
    sph_tracker_destroy(tracker);
    sph_implicit_destroy(implicit);
    sph_skin_destroy(other);
}
END_TEST

/* Several components, open and inside out, with spikes, flat and empty parts, triangles used three times and none. */
static sph_skin *make_awkward(uint64_t random)
{
    enum { N = 120, T = 200, J = 7 };
    static float rest[N][3], weights[N][2];
    static uint32_t bones[N][2], triangles[T][3];
    static double pivots[J][3];
    sph_skin_arrays a = {.struct_size = sizeof a,
                         .vertex_count = N,
                         .bone_count = J,
                         .influence_count = 2,
                         .rest = rest[0],
                         .bones = bones[0],
                         .weights = weights[0],
                         .pivots = pivots[0],
                         .triangle_count = T,
                         .triangles = triangles[0]};
    sph_skin *made = NULL;
    for (int i = 0; i < N; ++i) {
        const double w = test_random_unit(&random);
        for (int c = 0; c < 3; ++c)
            rest[i][c] = (float)(i % 4 == 3 && c == 2 ? 0 : floor(6 * test_random_unit(&random)) / 6);
        bones[i][0] = (uint32_t)(test_random(&random) % (J - 1)); /* the last has nothing */
        bones[i][1] = (bones[i][0] + 1) % J;
        weights[i][0] = (float)w;
        weights[i][1] = (float)(1 - w);
    }
    for (int i = 0; i < 3 * T; ++i)
        triangles[i / 3][i % 3] = i % 9 < 2 ? (uint32_t)(i / 9 % N) : (uint32_t)(test_random(&random) % N);
    ck_assert_int_eq(sph_skin_create_from_arrays(context, &a, &made), SPH_OK);
    return made;
}

START_TEST(awkward_skins_are_posed_without_harm)
{
    enum { N = 120, J = 7 };
    static const uint32_t parents[J] = {UINT32_MAX, 0, 1, 6, 3, 4, 0};
    sph_skin *awkward = make_awkward((uint64_t)_i + 1);
    uint64_t random = (uint64_t)_i, before, after;
    sph_implicit_options o;
    sph_implicit *implicit;
    sph_tracker *tracker;
    sph_deformer *deformer;
    sph_skin_arrays a = {.struct_size = sizeof a};
    float xyz[N][3], plain[N][3], normals[N][3];
    ck_assert_int_eq(sph_skin_get_arrays(awkward, &a), SPH_OK);
    sph_implicit_options_init(&o, sizeof o);
    o.parents = _i % 2 == 0 ? parents : NULL;
    o.table_size = 12;
    ck_assert_int_eq(sph_implicit_create(awkward, &o, &implicit), SPH_OK);
    ck_assert_int_eq(sph_tracker_create(implicit, awkward, NULL, &tracker), SPH_OK);
    ck_assert_int_eq(sph_deformer_create(awkward, NULL, &deformer), SPH_OK);
    for (int k = 0; k < 4; ++k) {
        double transforms[J][12];
        for (int i = 0; i < 12 * J; ++i)
            transforms[i / 12][i % 12] = 2 * test_random_unit(&random) - 1;
        ck_assert_int_eq(sph_tracker_pose(tracker, transforms[0], 1, xyz[0], normals[0], NULL), SPH_OK);
        ck_assert_int_eq(sph_deformer_pose(deformer, transforms[0], 1, SPH_POSE_DUAL_QUATERNION, plain[0], NULL),
                         SPH_OK);
        for (int i = 0; i < 3 * N; ++i) {
            ck_assert(isfinite(xyz[i / 3][i % 3]) && isfinite(normals[i / 3][i % 3]));
            ck_assert_double_le(fabs((double)xyz[i / 3][i % 3] - (double)plain[i / 3][i % 3]), 2);
        }
        ck_assert_int_eq(sph_mesh_intersections(context, N, plain[0], a.triangle_count, a.triangles, &before), SPH_OK);
        ck_assert_int_eq(sph_mesh_intersections(context, N, xyz[0], a.triangle_count, a.triangles, &after), SPH_OK);
        ck_assert_uint_le(after, before);
    }
    sph_deformer_destroy(deformer);
    sph_tracker_destroy(tracker);
    sph_implicit_destroy(implicit);
    sph_skin_destroy(awkward);
}
END_TEST

/* Everything that allocates. */
static sph_status make_and_use(sph_context *own, const void *user)
{
    static float xyz[TUBE_VERTICES][3];
    sph_skin *of = tube_skin(&t, own);
    sph_implicit_options o;
    sph_implicit *implicit = NULL, *back = NULL;
    sph_tracker *tracker = NULL;
    bytes b = {NULL, 0};
    double transforms[2][12];
    sph_status status = of == NULL ? SPH_E_NOMEM : SPH_OK;
    (void)user;
    sph_implicit_options_init(&o, sizeof o);
    o.parents = t.parents;
    o.sample_count = 8;
    o.table_size = o.operator_table_size = 8;
    o.operation = SPH_OPERATION_BLEND;
    tube_pose(1.5, 0, transforms);
    if (status == SPH_OK) status = sph_implicit_create(of, &o, &implicit);
    if (status == SPH_OK) status = sph_tracker_create(implicit, of, NULL, &tracker);
    if (status == SPH_OK) status = sph_tracker_pose(tracker, transforms[0], 1, xyz[0], NULL, NULL);
    if (status == SPH_OK) status = sph_implicit_write(implicit, keep, &b);
    if (status == SPH_OK) status = sph_implicit_read(own, b.data, b.size, &back);
    free(b.data);
    sph_tracker_destroy(tracker);
    sph_implicit_destroy(implicit);
    sph_implicit_destroy(back);
    sph_skin_destroy(of);
    return status;
}

START_TEST(any_allocation_may_fail)
{
    check_every_allocation((test_faults){.work = make_and_use, .least = 60, .sticky = _i, .thinning = 60});
}
END_TEST

int main(void)
{
    Suite *s = suite_create("implicit_set_up");
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_set_timeout(tc, 60);
    tcase_add_test(tc, joints_may_be_overridden_and_edited);
    tcase_add_loop_test(tc, set_ups_come_back_from_files_as_they_were, 0, 3);
    tcase_add_test(tc, what_is_wrong_is_said);
    tcase_add_loop_test(tc, awkward_skins_are_posed_without_harm, 0, 6);
    tcase_add_loop_test(tc, any_allocation_may_fail, 0, 2);
    return run_suite(s, tc);
}
