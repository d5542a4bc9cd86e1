/* SPDX-License-Identifier: MIT */
/* Poses corrected by implicit skinning: a tube bent and twisted, and what must hold whatever the pose. */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "implicit_case.h"
#include "runner.h"

static const double DEGREE = 0.017453292519943296;
enum { POSES = 5 };
static tube t;
static sph_context *context;
static sph_skin *skin;
static sph_deformer *deformer;
static float blended[TUBE_VERTICES][3], corrected[TUBE_VERTICES][3], all[2][POSES][TUBE_VERTICES][3];

static void setup(void)
{
    context = test_context();
    tube_init(&t);
    skin = tube_skin(&t, context);
    ck_assert_int_eq(sph_deformer_create(skin, NULL, &deformer), SPH_OK);
}

static void teardown(void)
{
    sph_deformer_destroy(deformer);
    sph_skin_destroy(skin);
    sph_context_destroy(context);
}

static sph_tracker *make_tracker(sph_skin *of, int32_t operation, int32_t evaluation, uint32_t flags)
{
    sph_implicit *implicit = tube_implicit(of, &t, operation);
    sph_tracker *tracker = NULL;
    sph_tracker_options o;
    sph_tracker_options_init(&o, sizeof o);
    o.evaluation = evaluation;
    o.flags = flags;
    if (implicit != NULL) (void)sph_tracker_create(implicit, of, &o, &tracker);
    sph_implicit_destroy(implicit);
    return tracker;
}

static void pose(sph_tracker *tracker, double transforms[2][12])
{
    ck_assert_int_eq(sph_tracker_pose(tracker, transforms[0], 1, corrected[0], NULL, NULL), SPH_OK);
}

static void blend(double transforms[2][12], int32_t method)
{
    ck_assert_int_eq(sph_deformer_pose(deformer, transforms[0], 1, method, blended[0], NULL), SPH_OK);
}

static double volume_of(float xyz[][3])
{
    return mesh_volume(xyz[0], t.triangles[0], TUBE_TRIANGLES);
}

static uint64_t pairs_of(float xyz[][3])
{
    uint64_t pairs = UINT64_MAX;
    ck_assert_int_eq(sph_mesh_intersections(context, TUBE_VERTICES, xyz[0], TUBE_TRIANGLES, t.triangles[0], &pairs),
                     SPH_OK);
    return pairs;
}

/* The mean distance of the middle ring from its own middle. */
static double middle_radius(float xyz[][3])
{
    double center[3] = {0, 0, 0}, sum = 0;
    const size_t first = (size_t)(TUBE_RINGS / 2) * TUBE_SIDES;
    for (size_t i = 0; i < 3 * TUBE_SIDES; ++i)
        center[i % 3] += (double)xyz[first + i / 3][i % 3] / TUBE_SIDES;
    for (size_t i = 0; i < TUBE_SIDES; ++i)
        sum += hypot(hypot((double)xyz[first + i][0] - center[0], (double)xyz[first + i][1] - center[1]),
                     (double)xyz[first + i][2] - center[2]) /
               TUBE_SIDES;
    return sum;
}

/* _i: operation, and whether exactly */
START_TEST(the_rest_pose_stays_and_goes_along_with_any_rigid_motion)
{
    sph_tracker *tracker = make_tracker(skin, _i % 3, _i / 3, 0);
    double transforms[2][12], both[2][12], most = 0;
    tube_pose(0, 0, transforms);
    pose(tracker, transforms);
    for (size_t i = 0; i < 3 * TUBE_VERTICES; ++i)
        most = fmax(most, fabs((double)corrected[i / 3][i % 3] - (double)t.rest[i / 3][i % 3]));
    ck_assert_double_le(most, 1e-4 * 8.2);
    tube_pose(1.1, 0.7, transforms);
    memcpy(both[0], transforms[1], sizeof both[0]);
    memcpy(both[1], transforms[1], sizeof both[1]);
    both[0][3] = both[1][3] = 5;
    pose(tracker, both);
    blend(both, SPH_POSE_LINEAR);
    for (size_t i = 0; i < 3 * TUBE_VERTICES; ++i)
        most = fmax(most, fabs((double)corrected[i / 3][i % 3] - (double)blended[i / 3][i % 3]));
    ck_assert_double_le(most, 1e-4 * 8.2);
    sph_tracker_destroy(tracker);
}
END_TEST

START_TEST(a_bent_tube_keeps_more_of_its_volume_and_its_fold_does_not_intersect)
{
    static const double ANGLES[] = {20, 40, 60, 80, 100, 120};
    static const double SHARES[] = {0.5, 0.4, 0.5, 0.65, 0.75, 0.99}; /* of what linear blending loses */
    const double rest = volume_of(t.rest), angle = ANGLES[_i % 6];
    sph_tracker *tracker = make_tracker(skin, SPH_OPERATION_UNION, _i / 6, 0);
    double transforms[2][12];
    tube_pose(angle * DEGREE, 0, transforms);
    pose(tracker, transforms);
    blend(transforms, SPH_POSE_LINEAR);
    ck_assert_uint_eq(pairs_of(corrected), 0);
    ck_assert_double_lt(rest - volume_of(corrected), SHARES[_i % 6] * (rest - volume_of(blended)));
    ck_assert_double_lt(volume_of(corrected), 1.001 * rest);
    if (angle > 70) ck_assert_uint_gt(pairs_of(blended), 50);
    sph_tracker_destroy(tracker);
}
END_TEST

/* _i: operation */
START_TEST(a_twisted_tube_keeps_its_section)
{
    sph_tracker *tracker = make_tracker(skin, _i, SPH_EVALUATION_TABLE, 0);
    for (double angle = 30; angle < 175; angle += 30) {
        double transforms[2][12];
        tube_pose(0, angle * DEGREE, transforms);
        pose(tracker, transforms);
        blend(transforms, SPH_POSE_LINEAR);
        ck_assert_double_eq_tol(middle_radius(corrected), 1, 0.02);
        ck_assert_double_eq_tol(middle_radius(blended), cos(angle * DEGREE / 2), 0.01); /* the candy wrapper */
        ck_assert_double_eq_tol(volume_of(corrected), volume_of(t.rest), 0.01 * volume_of(t.rest));
        ck_assert_uint_eq(pairs_of(corrected), 0);
    }
    sph_tracker_destroy(tracker);
}
END_TEST

/* _i: operation, and where vertices start from */
START_TEST(there_are_never_more_intersections_than_before)
{
    sph_implicit *implicit = tube_implicit(skin, &t, _i % 3);
    sph_tracker *tracker;
    sph_tracker_options o;
    sph_tracker_report report;
    uint64_t random = 5;
    sph_tracker_options_init(&o, sizeof o);
    o.method = _i / 3;
    o.flags = SPH_TRACKER_COUNTED;
    ck_assert_int_eq(sph_tracker_create(implicit, skin, &o, &tracker), SPH_OK);
    for (int k = 0; k < 10; ++k) {
        double transforms[2][12];
        uint64_t before;
        tube_pose(2.9 * test_random_unit(&random), 3 * test_random_unit(&random), transforms);
        blend(transforms, _i / 3);
        before = pairs_of(blended);
        ck_assert_int_eq(sph_tracker_pose(tracker, transforms[0], 1, corrected[0], NULL, &report), SPH_OK);
        ck_assert_uint_le(pairs_of(corrected), before);
        ck_assert_uint_eq(report.pairs_before, before);
        ck_assert_uint_eq(report.pairs_after, pairs_of(corrected));
    }
    sph_tracker_destroy(tracker);
    sph_implicit_destroy(implicit);
}
END_TEST

static void fill_poses(double transforms[POSES][2][12])
{
    for (int k = 0; k < POSES; ++k)
        tube_pose(0.5 * k, 0.2 * k, transforms[k]);
}

START_TEST(poses_come_out_the_same_one_by_one_together_and_on_any_executor)
{
    const sph_executor executors[] = {test_executor_reverse(), test_executor_scattered(), test_executor_threads()};
    double transforms[POSES][2][12];
    sph_tracker *tracker = make_tracker(skin, SPH_OPERATION_BLEND, _i, 0);
    fill_poses(transforms);
    ck_assert_int_eq(sph_tracker_pose(tracker, transforms[0][0], POSES, all[0][0][0], NULL, NULL), SPH_OK);
    for (int k = 0; k < POSES; ++k) {
        pose(tracker, transforms[k]);
        ck_assert_mem_eq(corrected, all[0][k], sizeof corrected);
    }
    sph_tracker_destroy(tracker);
    for (int e = 0; e < 3; ++e) {
        sph_context *other = test_context_with_executor(&executors[e]);
        sph_skin *same = tube_skin(&t, other);
        tracker = make_tracker(same, SPH_OPERATION_BLEND, _i, 0);
        ck_assert_int_eq(sph_tracker_pose(tracker, transforms[0][0], POSES, all[1][0][0], NULL, NULL), SPH_OK);
        ck_assert_mem_eq(all[0], all[1], sizeof all[0]);
        sph_tracker_destroy(tracker);
        sph_skin_destroy(same);
        sph_context_destroy(other);
    }
}
END_TEST

START_TEST(tables_are_near_what_is_exact)
{
    sph_implicit *implicit = tube_implicit(skin, &t, _i);
    double transforms[2][12], most = 0, mean = 0;
    uint64_t random = 3;
    tube_pose(1, 0, transforms);
    for (int k = 0; k < 3000; ++k) {
        double p[3], f[2];
        for (int c = 0; c < 3; ++c)
            p[c] = 4 * test_random_unit(&random) - 2;
        for (int32_t e = 0; e < 2; ++e)
            ck_assert_int_eq(sph_implicit_evaluate(implicit, transforms[0], e, 1, p, f + e, NULL, NULL), SPH_OK);
        most = fmax(most, fabs(f[0] - f[1]));
        mean += fabs(f[0] - f[1]) / 3000;
    }
    ck_assert_double_le(mean, 2e-3);
    ck_assert_double_le(most, 0.05);
    sph_implicit_destroy(implicit);
}
END_TEST

START_TEST(vertices_along_seams_stay_together)
{
    enum { CORNERS = 3 * TUBE_TRIANGLES };
    static float rest[CORNERS][3], weights[CORNERS][2], out[CORNERS][3];
    static uint32_t bones[CORNERS][2], triangles[CORNERS];
    sph_skin_arrays arrays = t.arrays;
    sph_skin *apart = NULL;
    sph_tracker *tracker, *whole = make_tracker(skin, SPH_OPERATION_UNION, 0, 0);
    double transforms[2][12];
    for (uint32_t i = 0; i < CORNERS; ++i) {
        const uint32_t v = t.triangles[i / 3][i % 3];
        memcpy(rest[i], t.rest[v], sizeof rest[i]);
        memcpy(weights[i], t.weights[v], sizeof weights[i]);
        memcpy(bones[i], t.bones[v], sizeof bones[i]);
        triangles[i] = i;
    }
    arrays.vertex_count = CORNERS;
    arrays.rest = rest[0];
    arrays.weights = weights[0];
    arrays.bones = bones[0];
    arrays.triangles = triangles;
    ck_assert_int_eq(sph_skin_create_from_arrays(context, &arrays, &apart), SPH_OK);
    tracker = make_tracker(apart, SPH_OPERATION_UNION, 0, 0);
    tube_pose(1.6, 0.3, transforms);
    ck_assert_int_eq(sph_tracker_pose(tracker, transforms[0], 1, out[0], NULL, NULL), SPH_OK);
    pose(whole, transforms);
    for (uint32_t i = 0; i < CORNERS; ++i)
        ck_assert_mem_eq(out[i], corrected[t.triangles[i / 3][i % 3]], sizeof out[i]);
    sph_tracker_destroy(tracker);
    sph_tracker_destroy(whole);
    sph_skin_destroy(apart);
}
END_TEST

START_TEST(no_vertex_flies_away_whatever_bones_do)
{
    static const double STRETCHES[][3] = {{0, 0, 0},  {1, 1, 0},       {1e-9, 1e-9, 1e-9}, {3, 0.2, 1},
                                          {-1, 1, 1}, {1e6, 1e6, 1e6}, {1e-30, 1, 1},      {0.5, 0.5, 0.5}};
    sph_tracker *tracker = make_tracker(skin, SPH_OPERATION_UNION, _i % 2, 0);
    double transforms[2][12];
    sph_tracker_report report;
    tube_pose(1.2, 0, transforms);
    for (int k = 0; k < 12; ++k)
        if (k % 4 != 3) transforms[1][k] *= STRETCHES[_i / 2][k % 4];
    ck_assert_int_eq(sph_tracker_pose(tracker, transforms[0], 1, corrected[0], NULL, &report), SPH_OK);
    blend(transforms, SPH_POSE_DUAL_QUATERNION);
    for (size_t v = 0; v < TUBE_VERTICES; ++v) {
        double far = 0;
        for (int c = 0; c < 3; ++c) {
            ck_assert(isfinite(corrected[v][c]));
            far = hypot(far, (double)corrected[v][c] - (double)blended[v][c]);
        }
        ck_assert_double_le(far, 2 * 1.5); /* the parts' radii are 1.4 at most */
    }
    ck_assert_double_le(report.farthest, 2 * 1.5);
    sph_tracker_destroy(tracker);
}
END_TEST

int main(void)
{
    Suite *s = suite_create("implicit_tracker");
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, the_rest_pose_stays_and_goes_along_with_any_rigid_motion, 0, 6);
    tcase_add_loop_test(tc, a_bent_tube_keeps_more_of_its_volume_and_its_fold_does_not_intersect, 0, 12);
    tcase_add_loop_test(tc, a_twisted_tube_keeps_its_section, 0, 3);
    tcase_add_loop_test(tc, there_are_never_more_intersections_than_before, 0, 6);
    tcase_add_loop_test(tc, poses_come_out_the_same_one_by_one_together_and_on_any_executor, 0, 2);
    tcase_add_loop_test(tc, tables_are_near_what_is_exact, 0, 3);
    tcase_add_test(tc, vertices_along_seams_stay_together);
    tcase_add_loop_test(tc, no_vertex_flies_away_whatever_bones_do, 0, 16);
    return run_suite(s, tc);
}
