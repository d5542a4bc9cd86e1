/* SPDX-License-Identifier: MIT */
/* Decomposition of animations whose rig is known, and what every result must satisfy. */
#include <check.h>
#include <math.h>
#include <string.h>

#include "runner.h"
#include "skin_rig.h"
#include "support.h"

static sph_context *context;
static skin_rig rig;

static void setup(void)
{
    context = test_context_with_threads(1);
    skin_rig_init(&rig, context, RIG_BENDS, 7);
}

static void teardown(void)
{
    skin_rig_free(&rig);
    sph_context_destroy(context);
}

static sph_skin_options options(int32_t mode)
{
    sph_skin_options o;
    sph_skin_options_init(&o, sizeof o);
    o.mode = mode;
    return o;
}

static sph_skin *solve(const sph_skin_options *o)
{
    const sph_skin_source source = {rig.animation, "clip", 25};
    sph_skin *skin = NULL;
    ck_assert_msg(sph_skin_create(rig.level, &source, 1, o, &skin) == SPH_OK, "%s", sph_context_last_message(context));
    return skin;
}

static sph_skin_arrays get(const sph_skin *skin)
{
    sph_skin_arrays out = {.struct_size = sizeof out};
    ck_assert_int_eq(sph_skin_get_arrays(skin, &out), SPH_OK);
    return out;
}

static sph_skin_error error_of(const sph_skin *skin)
{
    sph_skin_error e;
    ck_assert_int_eq(sph_skin_get_errors(skin, &e, NULL), SPH_OK);
    return e;
}

/* A vertex' weights by bone. */
static void row_of(const sph_skin_arrays *a, size_t v, double row[RIG_BONES])
{
    memset(row, 0, RIG_BONES * sizeof *row);
    for (size_t s = 0; s < a->influence_count; ++s)
        row[a->bones[v * a->influence_count + s]] += (double)a->weights[v * a->influence_count + s];
}

/* --- recovery --- */

START_TEST(an_exact_rig_is_reconstructed_to_a_ten_thousandth_without_being_told_anything)
{
    sph_skin_options o = options(SPH_SKIN_ANIMATION);
    sph_skin *skin;
    o.round_limit = 400;
    o.tolerance = 1e-4;
    o.rest_interval = (uint32_t)_i; /* with the rest pose as it is, and with another every round */
    skin = solve(&o);
    ck_assert_msg(error_of(skin).rmse_percent < 1e-2, "%g %%", error_of(skin).rmse_percent);
    sph_skin_destroy(skin);
}
END_TEST

START_TEST(known_weights_give_the_known_transforms)
{
    sph_skin_options o = options(SPH_SKIN_GEOMETRIC);
    uint32_t bones[RIG_VERTICES][RIG_BONES];
    float weights[RIG_VERTICES][RIG_BONES];
    sph_skin *skin;
    for (int v = 0; v < RIG_VERTICES; ++v)
        for (uint32_t b = 0; b < RIG_BONES; ++b) {
            bones[v][b] = b;
            weights[v][b] = (float)rig.weights[v][b];
        }
    o.initial_influence_count = RIG_BONES;
    o.initial_bones = bones[0];
    o.initial_weights = weights[0];
    o.rest_interval = 0;
    o.round_limit = 1000;
    o.tolerance = 0;
    skin = solve(&o);
    for (int f = 0; f < RIG_FRAMES; ++f)
        for (int b = 0; b < RIG_BONES; ++b)
            for (int k = 0; k < 12; ++k)
                ck_assert_double_eq_tol(get(skin).transforms[(f * RIG_BONES + b) * 12 + k], rig.transforms[f][b][k],
                                        1e-4);
    ck_assert(error_of(skin).max_percent < 1e-3);
    sph_skin_destroy(skin);
}
END_TEST

START_TEST(known_transforms_give_the_known_weights_and_stay)
{
    static const uint8_t ALL[RIG_BONES] = {1, 1, 1, 1};
    sph_skin_options o = options(SPH_SKIN_ANIMATION);
    sph_skin_arrays a;
    sph_skin *skin;
    o.initial_transforms = rig.transforms[0][0];
    o.locked_bones = ALL;
    o.rest_interval = 0;
    skin = solve(&o);
    a = get(skin);
    for (int f = 0; f < RIG_FRAMES; ++f)
        for (int b = 0; b < RIG_BONES; ++b)
            for (int k = 0; k < 12; ++k)
                ck_assert_double_eq_tol(a.transforms[(f * RIG_BONES + b) * 12 + k], rig.transforms[f][b][k], 1e-12);
    for (size_t v = 0; v < RIG_VERTICES; ++v) {
        double row[RIG_BONES];
        row_of(&a, v, row);
        for (int b = 0; b < RIG_BONES; ++b)
            ck_assert_double_eq_tol(row[b], rig.weights[v][b], 1e-4);
    }
    sph_skin_destroy(skin);
}
END_TEST

/* --- what always holds --- */

/* Bones within `rings` steps of a vertex' own cell: here cells lie in a row. */
static bool within_reach(size_t v, uint32_t bone, uint32_t rings)
{
    const int steps = (int)rig.labels[v] - (int)bone;
    return (uint32_t)(steps < 0 ? -steps : steps) <= rings;
}

START_TEST(weights_are_a_partition_within_reach_and_transforms_are_rotations)
{
    static const uint32_t LIMITS[5] = {1, 2, 3, 4, 9}, RINGS[5] = {1, 0, 1, 3, 2};
    for (int i = 0; i < 5; ++i) {
        sph_skin_options o = options(_i);
        sph_skin_arrays a;
        sph_skin *skin;
        o.influence_limit = LIMITS[i];
        o.rings = RINGS[i];
        o.round_limit = 8;
        skin = solve(&o);
        a = get(skin);
        ck_assert_uint_eq(a.influence_count, LIMITS[i] < RIG_BONES ? LIMITS[i] : RIG_BONES);
        ck_assert_uint_eq(a.rigid, 1);
        for (size_t v = 0; v < RIG_VERTICES; ++v) {
            float sum = 0;
            for (size_t s = v * a.influence_count; s < (v + 1) * a.influence_count; ++s) {
                ck_assert(a.weights[s] >= 0);
                ck_assert(a.weights[s] == 0 || within_reach(v, a.bones[s], RINGS[i]));
                sum += a.weights[s];
            }
            ck_assert(sum == 1);
        }
        for (size_t t = 0; t < RIG_FRAMES * RIG_BONES; ++t) {
            const double *m = a.transforms + 12 * t;
            const double determinant = m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
                                       m[2] * (m[4] * m[9] - m[5] * m[8]);
            ck_assert_double_eq_tol(determinant, 1, 1e-12);
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 3; ++c)
                    ck_assert_double_eq_tol(m[4 * r] * m[4 * c] + m[4 * r + 1] * m[4 * c + 1] + m[4 * r + 2] * m[4 * c + 2],
                                            r == c, 1e-12);
        }
        sph_skin_destroy(skin);
    }
}
END_TEST

typedef struct descent {
    double energy, first;
    uint32_t steps, rises, kinds;
} descent;

static void watch(void *user, uint32_t round, int32_t step, double energy)
{
    descent *d = user;
    (void)round;
    if (d->steps++ == 0) d->first = energy;
    else if (energy > d->energy + 1e-13 * d->first) ++d->rises;
    d->energy = energy;
    d->kinds |= 1u << step;
}

START_TEST(no_step_raises_the_energy)
{
    for (uint32_t k = 1; k <= 3; ++k) {
        sph_skin_options o = options(_i % 2 ? SPH_SKIN_ANIMATION : SPH_SKIN_GEOMETRIC);
        descent d = {0};
        sph_skin *skin;
        o.influence_limit = k;
        o.rings = 2;
        o.flags = _i / 2 ? SPH_SKIN_UNIFORM : 0;
        o.minor_bone = 0;
        o.rest_interval = 3;
        o.tolerance = 0;
        o.step = watch;
        o.step_user = &d;
        skin = solve(&o);
        ck_assert_uint_gt(d.steps, 20);
        ck_assert_uint_eq(d.rises, 0);
        ck_assert(d.energy < d.first);
        ck_assert_uint_eq(d.kinds >> SPH_SKIN_STEP_START & 1, 1);
        ck_assert_uint_eq(d.kinds >> SPH_SKIN_STEP_TRANSFORMS & 1, 1);
        ck_assert_uint_eq(d.kinds >> SPH_SKIN_STEP_WEIGHTS & 1, (uint32_t)(_i % 2));
        ck_assert_uint_eq(d.kinds >> SPH_SKIN_STEP_REST & 1, 1);
        sph_skin_destroy(skin);
    }
}
END_TEST

/* --- modes --- */

/* Largest difference of a weight along a side of a triangle. */
static double roughness(const sph_skin_arrays *a)
{
    double most = 0;
    for (size_t i = 0; i < 3 * a->triangle_count; ++i) {
        double one[RIG_BONES], other[RIG_BONES];
        row_of(a, a->triangles[i], one);
        row_of(a, a->triangles[i % 3 == 2 ? i - 2 : i + 1], other);
        for (int b = 0; b < RIG_BONES; ++b)
            most = fmax(most, fabs(one[b] - other[b]));
    }
    return most;
}

START_TEST(of_a_rigid_animation_mixed_weights_keep_several_bones_that_fade_into_each_other)
{
    sph_skin_options o = options(SPH_SKIN_MIXED);
    double sums[RIG_BONES] = {0};
    sph_skin_arrays a;
    sph_skin *skin;
    skin_rig_free(&rig);
    skin_rig_init(&rig, context, RIG_TUMBLES, 5);
    skin = solve(&o);
    a = get(skin);
    ck_assert(error_of(skin).max_percent < 1e-3);
    for (size_t v = 0; v < RIG_VERTICES; ++v) {
        double row[RIG_BONES];
        row_of(&a, v, row);
        for (int b = 0; b < RIG_BONES; ++b)
            sums[b] += row[b];
    }
    for (int b = 0; b < RIG_BONES; ++b)
        ck_assert(sums[b] > 0.1 * RIG_VERTICES);
    ck_assert_msg(roughness(&a) < 0.25, "%g", roughness(&a)); /* 40 rings share 3 transitions */
    sph_skin_destroy(skin);
}
END_TEST

START_TEST(of_a_rigid_animation_one_bone_is_all_that_reconstruction_needs)
{
    static const float CENTER[RIG_FRAMES][3] = {{3, 0, 0}};
    static const float RADIUS = 0.5f;
    static const uint32_t LABELS[RIG_VERTICES] = {0};
    const sph_level_arrays arrays = {.struct_size = sizeof arrays,
                                     .sphere_count = 1,
                                     .frame_count = RIG_FRAMES,
                                     .centers = CENTER[0],
                                     .radii = &RADIUS,
                                     .label_count = RIG_VERTICES,
                                     .labels = LABELS};
    const sph_skin_options o = options(SPH_SKIN_ANIMATION);
    sph_skin *skin;
    skin_rig_free(&rig);
    skin_rig_init(&rig, context, RIG_TUMBLES, 5);
    sph_level_destroy(rig.level);
    ck_assert_int_eq(sph_level_create_from_arrays(context, &arrays, &rig.level), SPH_OK);
    skin = solve(&o);
    ck_assert(error_of(skin).max_percent < 1e-3);
    sph_skin_destroy(skin);
}
END_TEST

START_TEST(animation_weights_reconstruct_better_than_mixed_and_those_better_than_geometric)
{
    double rmse[3];
    for (int32_t mode = 0; mode < 3; ++mode) {
        const sph_skin_options o = options(mode);
        sph_skin *skin = solve(&o);
        rmse[mode] = error_of(skin).rmse;
        sph_skin_destroy(skin);
    }
    ck_assert(rmse[SPH_SKIN_ANIMATION] < rmse[SPH_SKIN_MIXED]);
    ck_assert(rmse[SPH_SKIN_MIXED] < rmse[SPH_SKIN_GEOMETRIC]);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("skin");
    TCase *tc = tcase_create("decomposition");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, an_exact_rig_is_reconstructed_to_a_ten_thousandth_without_being_told_anything, 0, 2);
    tcase_add_test(tc, known_weights_give_the_known_transforms);
    tcase_add_test(tc, known_transforms_give_the_known_weights_and_stay);
    tcase_add_loop_test(tc, weights_are_a_partition_within_reach_and_transforms_are_rotations, 0, 3);
    tcase_add_loop_test(tc, no_step_raises_the_energy, 0, 4);
    tcase_add_test(tc, of_a_rigid_animation_mixed_weights_keep_several_bones_that_fade_into_each_other);
    tcase_add_test(tc, of_a_rigid_animation_one_bone_is_all_that_reconstruction_needs);
    tcase_add_test(tc, animation_weights_reconstruct_better_than_mixed_and_those_better_than_geometric);
    return run_suite(suite, tc);
}
