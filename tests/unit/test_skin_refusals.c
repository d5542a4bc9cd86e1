/* SPDX-License-Identifier: MIT */
/* What callers of a decomposition get wrong. */
#include <check.h>
#include <math.h>
#include <string.h>

#include "runner.h"
#include "skin_rig.h"
#include "support.h"

static sph_context *context;
static skin_rig rig;
static sph_skin_options o;
static sph_skin_source source;

static void setup(void)
{
    context = test_context();
    skin_rig_init(&rig, context, RIG_BENDS, 7);
    sph_skin_options_init(&o, sizeof o);
    source = (sph_skin_source){rig.animation, "clip", 25};
}

static void teardown(void)
{
    skin_rig_free(&rig);
    sph_context_destroy(context);
}

static const uint32_t BAD_BONE[RIG_VERTICES] = {RIG_BONES};
static const uint32_t FAR_BONE[RIG_VERTICES] = {3}; /* of vertex 0, at the other end */
static const float BAD_WEIGHT[RIG_VERTICES] = {1, NAN}, WEIGHT[RIG_VERTICES] = {1};
static const uint8_t LOCKED[RIG_VERTICES] = {1};

static void spoil_flags(void) { o.flags = 2; }
static void spoil_mode(void) { o.mode = 3; }
static void spoil_limit(void) { o.influence_limit = 0; }
static void spoil_tolerance(void) { o.tolerance = NAN; }
static void spoil_error(void) { o.error_limit = -1; }
static void spoil_smoothness(void) { o.smoothness = INFINITY; }
static void spoil_filter(void) { o.filter_radius = -0.1; }
static void spoil_minor(void) { o.minor_bone = NAN; }
static void spoil_size(void) { o.struct_size = 8; }
static void spoil_half(void) { o.initial_weights = WEIGHT; }
static void spoil_lock(void) { o.locked_bones = LOCKED; }
static void spoil_transform(void)
{
    rig.transforms[2][1][0] += 0.5;
    o.initial_transforms = rig.transforms[0][0];
}
static void spoil_start(const uint32_t *bones, const float *weights)
{
    o.initial_influence_count = 1;
    o.initial_bones = bones;
    o.initial_weights = weights;
}
static void spoil_bone(void) { spoil_start(BAD_BONE, WEIGHT); }
static void spoil_weight(void) { spoil_start(FAR_BONE, BAD_WEIGHT); }
static void spoil_reach(void)
{
    spoil_start(FAR_BONE, WEIGHT);
    o.locked_vertices = LOCKED;
}
static void spoil_source(void) { source.animation = NULL; }
static void spoil_rate(void) { source.frames_per_second = NAN; }
static void spoil_frame(void)
{
    float xyz[RIG_VERTICES][3] = {{0}};
    xyz[9][1] = NAN;
    sph_animation_set_frame(rig.animation, 4, xyz[0], 0);
}
static void spoil_vertices(void)
{
    sph_animation_destroy(rig.animation);
    rig.animation = test_cube(context, RIG_FRAMES);
    source.animation = rig.animation;
}

static const struct {
    void (*spoil)(void);
    const char *message;
} BAD[] = {{spoil_flags, "flags"},
           {spoil_mode, "mode is 3"},
           {spoil_limit, "influence_limit"},
           {spoil_tolerance, "tolerance"},
           {spoil_error, "error_limit"},
           {spoil_smoothness, "smoothness"},
           {spoil_filter, "filter_radius"},
           {spoil_minor, "minor_bone"},
           {spoil_size, "struct_size"},
           {spoil_half, "initial weights"},
           {spoil_lock, "locked bones"},
           {spoil_transform, "bone 1 in frame 2"},
           {spoil_bone, "bone 4 of 4"},
           {spoil_weight, "vertex 1"},
           {spoil_reach, "vertex 0 is locked"},
           {spoil_source, "source 0"},
           {spoil_rate, "source 0"},
           {spoil_frame, "vertex 9"},
           {spoil_vertices, "8 vertices"}};

START_TEST(bad_input_is_refused_by_name)
{
    sph_skin *skin = (sph_skin *)context;
    BAD[_i].spoil();
    ck_assert_int_eq(sph_skin_create(rig.level, &source, 1, &o, &skin), SPH_E_INVALID);
    ck_assert_ptr_null(skin);
    ck_assert_msg(strstr(sph_context_last_message(context), BAD[_i].message) != NULL, "%s",
                  sph_context_last_message(context));
}
END_TEST

START_TEST(missing_arguments_are_refused)
{
    sph_skin *skin = NULL;
    ck_assert_int_eq(sph_skin_create(NULL, &source, 1, &o, &skin), SPH_E_INVALID);
    ck_assert_int_eq(sph_skin_create(rig.level, NULL, 1, &o, &skin), SPH_E_INVALID);
    ck_assert_int_eq(sph_skin_create(rig.level, &source, 0, &o, &skin), SPH_E_INVALID);
    ck_assert_int_eq(sph_skin_create(rig.level, &source, 1, &o, NULL), SPH_E_INVALID);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("skin_refusals");
    TCase *tc = tcase_create("refusals");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, bad_input_is_refused_by_name, 0, (int)(sizeof BAD / sizeof *BAD));
    tcase_add_test(tc, missing_arguments_are_refused);
    return run_suite(suite, tc);
}
