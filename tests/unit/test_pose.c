/* SPDX-License-Identifier: MIT */
/* Vertices moved by transforms of bones: closed forms, and the formulas written out plainly in doubles. */
#include <check.h>
#include <math.h>
#include <string.h>

#include "faults.h"
#include "pose_case.h"
#include "runner.h"

static const int32_t METHODS[2] = {SPH_POSE_LINEAR, SPH_POSE_DUAL_QUATERNION};

START_TEST(identities_leave_every_bit_of_the_rest_pose)
{
    for (int b = 0; b < BONES; ++b)
        memcpy(transforms[0][b], IDENTITY, sizeof IDENTITY);
    pose(METHODS[_i], 1);
    for (int v = 0; v < VERTICES; ++v) {
        const double n[3] = {(double)normals[v][0], (double)normals[v][1], (double)normals[v][2]};
        if (METHODS[_i] == SPH_POSE_LINEAR) ck_assert_mem_eq(moved[0][v], rest[v], sizeof rest[v]);
        for (int k = 0; k < 3; ++k)
            ck_assert_float_eq(moved[0][v][k], rest[v][k]);
        check_point(turned[0][v], n, 2e-7);
    }
}
END_TEST

START_TEST(one_motion_of_all_bones_is_that_motion_also_where_it_scales_shears_and_mirrors)
{
    static const double STRETCH[3][9] = {
        {1, 0, 0, 0, 1, 0, 0, 0, 1}, {2, 0.3, 0, 0, 0.7, 0.1, -0.2, 0, 1.1}, {-1, 0, 0, 0, 1, 0.4, 0, 0, 1}};
    for (int f = 0; f < 3; ++f) {
        double rigid[12];
        random_rigid(2, rigid);
        for (int b = 0; b < BONES; ++b)
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 4; ++c) {
                    double sum = c == 3 ? rigid[4 * r + 3] : 0;
                    for (int k = 0; k < 3 && c < 3; ++k)
                        sum += rigid[4 * r + k] * STRETCH[f][3 * k + c];
                    transforms[f][b][4 * r + c] = sum;
                }
    }
    pose(METHODS[_i], 3);
    for (int f = 0; f < 3; ++f)
        for (int v = 0; v < VERTICES; ++v) {
            const double p[3] = {(double)rest[v][0], (double)rest[v][1], (double)rest[v][2]};
            double q[3], n[3];
            apply(transforms[f][0], p, q);
            check_point(moved[f][v], q, 1e-6);
            turn_normal(transforms[f][0], normals[v], n);
            check_point(turned[f][v], n, 1e-6);
        }
}
END_TEST

/* Lengths whose squares a double does not hold, small or large, change no direction; beyond those there is none. */
START_TEST(normals_are_those_of_the_turn_however_much_the_transforms_scale)
{
    static const double SCALES[4] = {1e-120, 1e-70, 1e75, 1e200};
    double rigid[12];
    random_rigid(2, rigid);
    for (int f = 0; f < 4; ++f)
        for (int b = 0; b < BONES; ++b)
            for (int i = 0; i < 12; ++i)
                transforms[f][b][i] = i % 4 == 3 ? 0 : SCALES[f] * rigid[i];
    pose(METHODS[_i], 4);
    for (int f = 0; f < 4; ++f)
        for (int v = 0; v < VERTICES; ++v) {
            double n[3];
            turn_normal(rigid, normals[v], n);
            for (int k = 0; k < 3 && f == 3; ++k)
                n[k] = 0;
            check_point(turned[f][v], n, 1e-6);
        }
}
END_TEST

START_TEST(vertices_of_one_bone_follow_it)
{
    for (int v = 0; v < VERTICES; ++v)
        for (int s = 0; s < SLOTS; ++s)
            weights[v][s] = s == v % SLOTS;
    transforms[2][1][0] *= 3; /* and a bone that stretches */
    pose(METHODS[_i], POSES);
    for (int f = 0; f < POSES; ++f)
        for (int v = 0; v < VERTICES; ++v) {
            const double p[3] = {(double)rest[v][0], (double)rest[v][1], (double)rest[v][2]};
            double q[3];
            apply(transforms[f][bones[v][v % SLOTS]], p, q);
            check_point(moved[f][v], q, 1e-6);
        }
}
END_TEST

START_TEST(linear_blends_are_the_weighted_means_of_moved_points)
{
    for (int i = 0; i < 12 * BONES; ++i) /* affine, not rigid */
        transforms[1][i / 12][i % 12] += uniform(-0.2, 0.2);
    pose(SPH_POSE_LINEAR, POSES);
    for (int f = 0; f < POSES; ++f)
        for (int v = 0; v < VERTICES; ++v) {
            const double p[3] = {(double)rest[v][0], (double)rest[v][1], (double)rest[v][2]};
            double q[3], mean[3] = {0, 0, 0}, blend[12] = {0}, n[3];
            for (int s = 0; s < SLOTS; ++s) {
                apply(transforms[f][bones[v][s]], p, q);
                for (int k = 0; k < 3; ++k)
                    mean[k] += (double)weights[v][s] * q[k];
                for (int k = 0; k < 12; ++k)
                    blend[k] += (double)weights[v][s] * transforms[f][bones[v][s]][k];
            }
            check_point(moved[f][v], mean, 1e-6);
            turn_normal(blend, normals[v], n);
            check_point(turned[f][v], n, 1e-5);
        }
}
END_TEST

/* f(a T + (1 - a) U) = a f(T) + (1 - a) f(U) */
START_TEST(linear_blends_are_linear_in_the_transforms)
{
    for (int i = 0; i < 12 * BONES; ++i)
        transforms[2][i / 12][i % 12] = 0.3 * transforms[0][i / 12][i % 12] + 0.7 * transforms[1][i / 12][i % 12];
    pose(SPH_POSE_LINEAR, 3);
    for (int v = 0; v < VERTICES; ++v)
        for (int k = 0; k < 3; ++k)
            ck_assert_double_eq_tol((double)moved[2][v][k], 0.3 * (double)moved[0][v][k] + 0.7 * (double)moved[1][v][k],
                                    1e-6);
}
END_TEST

START_TEST(poses_come_out_the_same_one_by_one_together_and_on_any_executor)
{
    const sph_executor executors[3] = {test_executor_reverse(), test_executor_scattered(), test_executor_threads()};
    static float other[POSES][VERTICES][3];
    pose(METHODS[_i], POSES);
    for (int e = 0; e < 3; ++e) {
        sph_deformer *deformer;
        sph_context_destroy(context);
        context = test_context_with_executor(&executors[e]);
        deformer = make();
        for (int f = 0; f < POSES; ++f)
            ck_assert_int_eq(sph_deformer_pose(deformer, transforms[f][0], 1, METHODS[_i], other[f][0], NULL), SPH_OK);
        ck_assert_mem_eq(other, moved, sizeof moved);
        ck_assert_int_eq(sph_deformer_pose(deformer, transforms[0][0], POSES, METHODS[_i], NULL, other[0][0]), SPH_OK);
        ck_assert_mem_eq(other, turned, sizeof turned);
        sph_deformer_destroy(deformer);
    }
}
END_TEST

START_TEST(posing_allocates_nothing)
{
    test_faulty faulty = {0};
    const sph_allocator allocator = test_faulty_allocator(&faulty);
    sph_deformer *deformer;
    size_t calls;
    sph_context_destroy(context);
    context = test_context_with_allocator(&allocator);
    deformer = make();
    calls = faulty.calls;
    for (int m = 0; m < 2; ++m)
        ck_assert_int_eq(sph_deformer_pose(deformer, transforms[0][0], POSES, METHODS[m], moved[0][0], turned[0][0]),
                         SPH_OK);
    ck_assert_uint_eq(faulty.calls, calls);
    sph_deformer_destroy(deformer);
    sph_context_destroy(context);
    context = NULL;
    ck_assert_uint_eq(faulty.live_blocks, 0);
}
END_TEST

static sph_status make_and_pose(sph_context *own, const void *user)
{
    sph_skin *skin = NULL;
    sph_deformer *deformer = NULL;
    sph_status status = sph_skin_create_from_arrays(own, &arrays, &skin);
    (void)user;
    if (status == SPH_OK) status = sph_deformer_create(skin, NULL, &deformer);
    if (status == SPH_OK) status = sph_pose_from_spheres(skin, NULL, pivots[0], transforms[0][0]);
    sph_deformer_destroy(deformer);
    sph_skin_destroy(skin);
    return status;
}

START_TEST(any_allocation_may_fail)
{
    static const uint32_t LINKS[2][2] = {{0, 1}, {1, 2}};
    arrays.link_count = 2;
    arrays.links = LINKS[0];
    check_every_allocation((test_faults){.work = make_and_pose, .least = 20, .sticky = _i});
}
END_TEST

START_TEST(what_is_wrong_is_said)
{
    sph_deformer_options o;
    sph_skin *skin = NULL;
    sph_deformer *deformer = NULL;
    ck_assert_int_eq(sph_skin_create_from_arrays(context, &arrays, &skin), SPH_OK);
    ck_assert_int_eq(sph_deformer_create(NULL, NULL, &deformer), SPH_E_INVALID);
    ck_assert_int_eq(sph_deformer_create(skin, NULL, NULL), SPH_E_INVALID);
    sph_deformer_options_init(&o, sizeof o);
    o.normals = normals[0];
    normals[7][1] = NAN;
    ck_assert_int_eq(sph_deformer_create(skin, &o, &deformer), SPH_E_INVALID);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "normal 7"));
    o.normals = NULL;
    o.flags = 1;
    ck_assert_int_eq(sph_deformer_create(skin, &o, &deformer), SPH_E_INVALID);
    ck_assert_int_eq(sph_deformer_create(skin, NULL, &deformer), SPH_OK);
    ck_assert_int_eq(sph_deformer_pose(NULL, transforms[0][0], 1, 0, moved[0][0], NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_deformer_pose(deformer, NULL, 1, 0, moved[0][0], NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_deformer_pose(deformer, transforms[0][0], 1, 2, moved[0][0], NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_deformer_pose(deformer, transforms[0][0], SIZE_MAX / 100, 0, moved[0][0], NULL),
                     SPH_E_INVALID);
    ck_assert_int_eq(sph_deformer_pose(deformer, transforms[0][0], 1, 0, moved[0][0], turned[0][0]), SPH_E_STATE);
    moved[0][0][0] = 123;
    transforms[2][4][6] = INFINITY;
    ck_assert_int_eq(sph_deformer_pose(deformer, transforms[0][0], 3, 0, moved[0][0], NULL), SPH_E_INVALID);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "bone 4 in pose 2"));
    ck_assert_float_eq(moved[0][0][0], 123);
    ck_assert_int_eq(sph_deformer_pose(deformer, transforms[0][0], 0, 0, NULL, NULL), SPH_OK);
    sph_deformer_destroy(deformer);
    sph_deformer_destroy(NULL);
    sph_skin_destroy(skin);
}
END_TEST

START_TEST(normals_of_a_sphere_without_given_ones_point_outward)
{
    sph_animation *sphere = test_sphere(context, 3, 1);
    const uint32_t n = sph_animation_vertex_count(sphere);
    sph_skin *skin = NULL;
    sph_deformer *deformer = NULL;
    ck_assert_uint_le(n, VERTICES);
    ck_assert_int_eq(sph_animation_read_frame(sphere, 0, rest[0]), SPH_OK);
    arrays.vertex_count = n;
    arrays.triangle_count = sph_animation_triangle_count(sphere);
    arrays.triangles = sph_animation_triangles(sphere);
    ck_assert_int_eq(sph_skin_create_from_arrays(context, &arrays, &skin), SPH_OK);
    ck_assert_int_eq(sph_deformer_create(skin, NULL, &deformer), SPH_OK);
    for (int b = 0; b < BONES; ++b)
        memcpy(transforms[0][b], IDENTITY, sizeof IDENTITY);
    ck_assert_int_eq(sph_deformer_pose(deformer, transforms[0][0], 1, 0, NULL, turned[0][0]), SPH_OK);
    for (uint32_t v = 0; v < n; ++v) {
        const double expected[3] = {(double)rest[v][0], (double)rest[v][1], (double)rest[v][2]};
        check_point(turned[0][v], expected, 0.05);
    }
    sph_deformer_destroy(deformer);
    sph_skin_destroy(skin);
    sph_animation_destroy(sphere);
}
END_TEST

/* A skin that was solved for: what the deformer gives must be off the input by as much as the solver says. */
START_TEST(a_solved_skin_is_reconstructed_with_the_errors_that_it_reports)
{
    enum { FRAMES = 6 };
    sph_animation *torus = test_torus(context, 24, 10, FRAMES);
    sph_hierarchy *hierarchy = NULL;
    sph_level *level = NULL;
    sph_skin *skin = NULL;
    sph_deformer *deformer = NULL;
    sph_skin_arrays a = {.struct_size = sizeof a};
    sph_skin_error errors[FRAMES];
    const sph_skin_source source = {torus, NULL, 0};
    ck_assert_int_eq(sph_hierarchy_create(torus, NULL, &hierarchy), SPH_OK);
    ck_assert_int_eq(sph_level_create(hierarchy, 12, &level), SPH_OK);
    ck_assert_int_eq(sph_skin_create(level, &source, 1, NULL, &skin), SPH_OK);
    ck_assert_int_eq(sph_skin_get_arrays(skin, &a), SPH_OK);
    ck_assert_int_eq(sph_skin_get_errors(skin, NULL, errors), SPH_OK);
    ck_assert_int_eq(sph_deformer_create(skin, NULL, &deformer), SPH_OK);
    ck_assert_int_eq(sph_deformer_pose(deformer, a.transforms, FRAMES, SPH_POSE_LINEAR, moved[0][0], NULL), SPH_OK);
    for (uint32_t f = 0; f < FRAMES; ++f) {
        const float *got = moved[0][0] + 3 * (size_t)f * a.vertex_count;
        double sum = 0, most = 0;
        ck_assert_int_eq(sph_animation_read_frame(torus, f, rest[0]), SPH_OK);
        for (uint32_t v = 0; v < a.vertex_count; ++v) {
            double square = 0;
            for (int k = 0; k < 3; ++k)
                square += pow((double)got[3 * v + k] - (double)rest[v][k], 2);
            sum += square;
            most = fmax(most, sqrt(square));
        }
        ck_assert_double_eq_tol(sqrt(sum / a.vertex_count), errors[f].rmse, 1e-6);
        ck_assert_double_eq_tol(most, errors[f].max, 1e-6);
    }
    sph_deformer_destroy(deformer);
    sph_skin_destroy(skin);
    sph_level_destroy(level);
    sph_hierarchy_destroy(hierarchy);
    sph_animation_destroy(torus);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("pose");
    TCase *tc = tcase_create("pose");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, identities_leave_every_bit_of_the_rest_pose, 0, 2);
    tcase_add_loop_test(tc, one_motion_of_all_bones_is_that_motion_also_where_it_scales_shears_and_mirrors, 0, 2);
    tcase_add_loop_test(tc, normals_are_those_of_the_turn_however_much_the_transforms_scale, 0, 2);
    tcase_add_loop_test(tc, vertices_of_one_bone_follow_it, 0, 2);
    tcase_add_test(tc, linear_blends_are_the_weighted_means_of_moved_points);
    tcase_add_test(tc, linear_blends_are_linear_in_the_transforms);
    tcase_add_loop_test(tc, poses_come_out_the_same_one_by_one_together_and_on_any_executor, 0, 2);
    tcase_add_test(tc, posing_allocates_nothing);
    tcase_add_loop_test(tc, any_allocation_may_fail, 0, 2);
    tcase_add_test(tc, what_is_wrong_is_said);
    tcase_add_test(tc, normals_of_a_sphere_without_given_ones_point_outward);
    tcase_add_test(tc, a_solved_skin_is_reconstructed_with_the_errors_that_it_reports);
    return run_suite(suite, tc);
}
