/* SPDX-License-Identifier: MIT */
/* What callers ask of a decomposition: locks, starts, clips, stops. */
#include <check.h>
#include <math.h>
#include <string.h>

#include "faults.h"
#include "runner.h"
#include "skin_rig.h"
#include "support.h"

static sph_context *context;
static skin_rig rig;
static sph_skin_options o;
static sph_skin_source source;

static void begin(sph_context *with)
{
    context = with;
    skin_rig_init(&rig, context, RIG_BENDS, 7);
    sph_skin_options_init(&o, sizeof o);
    source = (sph_skin_source){rig.animation, "clip", 25};
}

static void setup(void)
{
    begin(test_context_with_threads(1));
}

static void teardown(void)
{
    skin_rig_free(&rig);
    sph_context_destroy(context);
}

static sph_skin *solve(void)
{
    sph_skin *skin = NULL;
    ck_assert_msg(sph_skin_create(rig.level, &source, 1, &o, &skin) == SPH_OK, "%s", sph_context_last_message(context));
    return skin;
}

static sph_skin_arrays get(const sph_skin *skin)
{
    sph_skin_arrays out = {.struct_size = sizeof out};
    ck_assert_int_eq(sph_skin_get_arrays(skin, &out), SPH_OK);
    return out;
}

static void check_same(const sph_skin *one, const sph_skin *other)
{
    const sph_skin_arrays a = get(one), b = get(other);
    const size_t slots = (size_t)a.vertex_count * a.influence_count;
    ck_assert_uint_eq(a.frame_count, b.frame_count);
    ck_assert_mem_eq(a.rest, b.rest, a.vertex_count * 3 * sizeof *a.rest);
    ck_assert_mem_eq(a.bones, b.bones, slots * sizeof *a.bones);
    ck_assert_mem_eq(a.weights, b.weights, slots * sizeof *a.weights);
    ck_assert_mem_eq(a.transforms, b.transforms, (size_t)a.frame_count * a.bone_count * 12 * sizeof *a.transforms);
}

START_TEST(results_do_not_depend_on_threads_or_executors)
{
    sph_skin *one, *other;
    skin_rig first = rig;
    sph_context *own = context;
    const sph_executor executor = _i == 0 ? test_executor_reverse() : test_executor_threads();
    o.mode = SPH_SKIN_MIXED;
    o.round_limit = 7;
    one = solve();
    begin(_i == 2 ? test_context_with_threads(5) : test_context_with_executor(&executor));
    o.round_limit = 7;
    other = solve();
    check_same(one, other);
    sph_skin_destroy(one);
    sph_skin_destroy(other);
    skin_rig_free(&first);
    sph_context_destroy(own);
}
END_TEST

START_TEST(clips_of_one_mesh_are_solved_as_one_animation_and_keep_their_names)
{
    sph_skin *whole, *parts = NULL;
    sph_animation *a = skin_rig_part(&rig, context, 0, 5), *b = skin_rig_part(&rig, context, 5, RIG_FRAMES);
    const sph_skin_source two[2] = {{a, "walk", 24}, {b, NULL, 0}};
    o.round_limit = 7;
    whole = solve();
    ck_assert_int_eq(sph_skin_create(rig.level, two, 2, &o, &parts), SPH_OK);
    check_same(whole, parts);
    ck_assert_uint_eq(get(parts).clip_count, 2);
    ck_assert_str_eq(get(parts).clips[0].name, "walk");
    ck_assert_double_eq(get(parts).clips[0].frames_per_second, 24);
    ck_assert_uint_eq(get(parts).clips[0].frame_count, 5);
    ck_assert_str_eq(get(parts).clips[1].name, "");
    ck_assert_uint_eq(get(parts).clips[1].first_frame, 5);
    sph_skin_destroy(whole);
    sph_skin_destroy(parts);
    sph_animation_destroy(a);
    sph_animation_destroy(b);
}
END_TEST

START_TEST(errors_are_those_that_measuring_finds)
{
    sph_skin *skin;
    sph_skin_error own, measured, frames[RIG_FRAMES], again[RIG_FRAMES];
    o.round_limit = 5;
    skin = solve();
    ck_assert_int_eq(sph_skin_get_errors(skin, &own, frames), SPH_OK);
    ck_assert_int_eq(sph_skin_measure(skin, &source, 1, &measured, again), SPH_OK);
    ck_assert_mem_eq(&own, &measured, sizeof own);
    ck_assert_mem_eq(frames, again, sizeof frames);
    ck_assert(own.max > 0 && own.max >= own.rmse);
    sph_skin_destroy(skin);
}
END_TEST

START_TEST(locked_vertices_keep_weights_and_positions_in_every_mode)
{
    uint32_t bones[RIG_VERTICES][2];
    float weights[RIG_VERTICES][2];
    uint8_t locked[RIG_VERTICES] = {0};
    sph_skin_arrays a;
    sph_skin *skin;
    for (uint32_t v = 0; v < RIG_VERTICES; ++v) {
        bones[v][0] = rig.labels[v];
        bones[v][1] = rig.labels[v] == 0 ? 1 : rig.labels[v] - 1;
        weights[v][0] = 0.75f;
        weights[v][1] = 0.25f;
        locked[v] = v % 3 == 0;
    }
    o.mode = _i;
    o.initial_influence_count = 2;
    o.initial_bones = bones[0];
    o.initial_weights = weights[0];
    o.locked_vertices = locked;
    o.rest_interval = 1;
    o.round_limit = 12;
    skin = solve();
    a = get(skin);
    for (uint32_t v = 0; v < RIG_VERTICES; v += 3) {
        ck_assert_uint_eq(a.bones[4 * v], bones[v][0]);
        ck_assert_uint_eq(a.bones[4 * v + 1], bones[v][1]);
        ck_assert(a.weights[4 * v] == 0.75f && a.weights[4 * v + 1] == 0.25f && a.weights[4 * v + 2] == 0);
        for (int k = 0; k < 3; ++k)
            ck_assert_double_eq_tol((double)a.rest[3 * v + k], (double)rig.rest[v][k], 1e-6);
    }
    sph_skin_destroy(skin);
}
END_TEST

START_TEST(locked_bones_keep_their_transforms_and_the_others_follow)
{
    const uint8_t locked[RIG_BONES] = {0, 1, 0, 1};
    double moved[RIG_FRAMES][RIG_BONES][12];
    sph_skin_arrays a;
    sph_skin *skin;
    memcpy(moved, rig.transforms, sizeof moved);
    for (int f = 0; f < RIG_FRAMES; ++f)
        for (int b = 0; b < RIG_BONES; ++b)
            moved[f][b][3] += 0.25;
    o.initial_transforms = moved[0][0];
    o.locked_bones = locked;
    o.round_limit = 6;
    o.minor_bone = 1e9; /* a lock is stronger */
    skin = solve();
    a = get(skin);
    for (int f = 1; f < RIG_FRAMES; ++f) /* in frame 0 all are alike */
        for (int b = 0; b < RIG_BONES; ++b) {
            double off = 0;
            for (int k = 0; k < 12; ++k)
                off = fmax(off, fabs(a.transforms[(f * RIG_BONES + b) * 12 + k] - moved[f][b][k]));
            ck_assert(locked[b] ? off < 1e-12 : off > 1e-3);
        }
    sph_skin_destroy(skin);
}
END_TEST

static void count_rounds(void *user, uint32_t round, int32_t step, double energy)
{
    (void)step;
    (void)energy;
    *(uint32_t *)user = round + 1;
}

START_TEST(rounds_stop_at_the_error_that_is_asked_for_and_at_the_limit)
{
    uint32_t rounds = 0;
    sph_skin *skin;
    sph_skin_error e;
    o.mode = SPH_SKIN_ANIMATION;
    o.step = count_rounds;
    o.step_user = &rounds;
    o.tolerance = 0;
    o.error_limit = 0.2;
    skin = solve();
    sph_skin_get_errors(skin, &e, NULL);
    ck_assert(e.rmse_percent <= 0.2 && e.rmse_percent > 0.02);
    ck_assert_uint_lt(rounds, 60);
    sph_skin_destroy(skin);
    o.error_limit = 0;
    o.round_limit = 9;
    skin = solve();
    ck_assert_uint_eq(rounds, 9);
    sph_skin_destroy(skin);
}
END_TEST

/* trace(R'S) of the linear parts: the larger, the nearer. */
static double likeness(const double *one, const double *other)
{
    double sum = 0;
    for (int k = 0; k < 12; ++k)
        sum += k % 4 == 3 ? 0 : one[k] * other[k];
    return sum;
}

/* Bone 1 has half of two vertices, and lies between 0 and 2; bone 3 has as little, and lies beside 2. */
START_TEST(bones_of_little_influence_take_the_mean_pose_of_their_neighbours)
{
    uint32_t bones[RIG_VERTICES][2];
    float weights[RIG_VERTICES][2];
    sph_skin_arrays a;
    sph_skin *skin;
    for (uint32_t v = 0; v < RIG_VERTICES; ++v) {
        bones[v][0] = rig.labels[v] < 2 ? 0 : 2;
        bones[v][1] = rig.labels[v] < 2 ? 1 : 3;
        weights[v][1] = v < 2 || v >= RIG_VERTICES - 2 ? 0.5f : 0;
        weights[v][0] = 1 - weights[v][1];
    }
    o.mode = SPH_SKIN_GEOMETRIC;
    o.rings = 3;
    o.initial_influence_count = 2;
    o.initial_bones = bones[0];
    o.initial_weights = weights[0];
    o.round_limit = 100;
    o.tolerance = 0;
    skin = solve();
    a = get(skin);
    for (int f = 0; f < RIG_FRAMES; ++f) {
        const double *t = a.transforms + f * RIG_BONES * 12, *pivot = a.pivots + 3;
        ck_assert_double_eq_tol(likeness(t, t + 12), likeness(t + 12, t + 24), 1e-6);
        ck_assert(likeness(t, t + 12) >= likeness(t, t + 24) - 1e-9);
        for (int r = 0; r < 3; ++r) {
            double at[3];
            for (int b = 0; b < 3; ++b) {
                const double *row = t + 12 * b + 4 * r;
                at[b] = row[0] * pivot[0] + row[1] * pivot[1] + row[2] * pivot[2] + row[3];
            }
            ck_assert_double_eq_tol(at[1], 0.5 * (at[0] + at[2]), 1e-6);
        }
        for (int k = 0; k < 12; ++k)
            ck_assert_double_eq_tol(t[36 + k], t[24 + k], 1e-9);
    }
    sph_skin_destroy(skin);
}
END_TEST

/* `user` holds the limit of rounds. */
static sph_status solve_in(sph_context *own, const void *user)
{
    skin_rig other;
    sph_skin_source from;
    sph_skin *skin = (sph_skin *)own;
    sph_status status = SPH_E_NOMEM;
    skin_rig_init(&other, own, RIG_BENDS, 7);
    from = (sph_skin_source){other.animation, "clip", 25};
    o.round_limit = *(const uint32_t *)user;
    if (other.level != NULL && other.animation != NULL) {
        status = sph_skin_create(other.level, &from, 1, &o, &skin);
        ck_assert((skin != NULL) == (status == SPH_OK));
        sph_skin_destroy(skin);
    }
    skin_rig_free(&other);
    return status;
}

START_TEST(progress_rises_and_any_report_may_cancel)
{
    const uint32_t rounds = 3;
    check_every_cancel((test_faults){.work = solve_in, .user = &rounds, .least = 11});
}
END_TEST

START_TEST(every_allocation_may_fail)
{
    const uint32_t rounds = 2;
    check_every_allocation((test_faults){.work = solve_in, .user = &rounds, .least = 60, .sticky = _i, .thinning = 32});
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("skin_options");
    TCase *tc = tcase_create("options");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, results_do_not_depend_on_threads_or_executors, 0, 3);
    tcase_add_test(tc, clips_of_one_mesh_are_solved_as_one_animation_and_keep_their_names);
    tcase_add_test(tc, errors_are_those_that_measuring_finds);
    tcase_add_loop_test(tc, locked_vertices_keep_weights_and_positions_in_every_mode, 0, 3);
    tcase_add_test(tc, locked_bones_keep_their_transforms_and_the_others_follow);
    tcase_add_test(tc, rounds_stop_at_the_error_that_is_asked_for_and_at_the_limit);
    tcase_add_test(tc, bones_of_little_influence_take_the_mean_pose_of_their_neighbours);
    tcase_add_test(tc, progress_rises_and_any_report_may_cancel);
    tcase_add_loop_test(tc, every_allocation_may_fail, 0, 2);
    return run_suite(suite, tc);
}
