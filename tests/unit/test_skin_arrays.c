/* SPDX-License-Identifier: MIT */
/* Skins made of the caller's arrays: what is refused, how weights are brought in order, and what the getters tell. */
#include <check.h>
#include <math.h>
#include <string.h>

#include "faults.h"
#include "runner.h"
#include "support.h"

enum { VERTICES = 4, BONES = 3, SLOTS = 3, FRAMES = 2 };

static sph_context *context;
static float rest[VERTICES][3], weights[VERTICES][SLOTS];
static uint32_t bones[VERTICES][SLOTS], triangles[2][3], links[3][2];
static double transforms[FRAMES][BONES][12];
static sph_skin_clip clips[2];
static sph_skin_arrays arrays;

static void setup(void)
{
    static const uint32_t BONE[VERTICES][SLOTS] = {{0, 1, 2}, {2, 2, 1}, {1, 0, 0}, {0, 2, 1}};
    static const float WEIGHT[VERTICES][SLOTS] = {
        {0.25f, 0.75f, 0}, {0.3f, 0.3f, 0.4f}, {1, 0, 0}, {1.0f / 3, 1.0f / 3, 1.0f / 3}};
    static const uint32_t TRIANGLE[2][3] = {{0, 1, 2}, {2, 1, 3}}, LINK[3][2] = {{2, 1}, {0, 1}, {1, 2}};
    context = test_context();
    memcpy(bones, BONE, sizeof bones);
    memcpy(weights, WEIGHT, sizeof weights);
    memcpy(triangles, TRIANGLE, sizeof triangles);
    memcpy(links, LINK, sizeof links);
    memset(transforms, 0, sizeof transforms);
    for (int v = 0; v < VERTICES; ++v)
        for (int c = 0; c < 3; ++c)
            rest[v][c] = (float)(v * (c + 1) % 3);
    for (int f = 0; f < FRAMES; ++f)
        for (int b = 0; b < BONES; ++b)
            for (int c = 0; c < 3; ++c) {
                transforms[f][b][5 * c] = 1;
                transforms[f][b][4 * c + 3] = f * (b + 1);
            }
    clips[0] = (sph_skin_clip){"walk", 0, 1, 24};
    clips[1] = (sph_skin_clip){NULL, 1, 1, 0};
    arrays = (sph_skin_arrays){.struct_size = sizeof arrays,
                               .vertex_count = VERTICES,
                               .bone_count = BONES,
                               .influence_count = SLOTS,
                               .frame_count = FRAMES,
                               .clip_count = 2,
                               .rest = rest[0],
                               .bones = bones[0],
                               .weights = weights[0],
                               .transforms = transforms[0][0],
                               .clips = clips,
                               .triangle_count = 2,
                               .triangles = triangles[0],
                               .link_count = 3,
                               .links = links[0]};
}

static void teardown(void)
{
    sph_context_destroy(context);
}

static sph_skin *make(void)
{
    sph_skin *skin = NULL;
    ck_assert_msg(sph_skin_create_from_arrays(context, &arrays, &skin) == SPH_OK, "%s",
                  sph_context_last_message(context));
    return skin;
}

static sph_skin_arrays get(const sph_skin *skin)
{
    sph_skin_arrays out = {.struct_size = sizeof out};
    ck_assert_int_eq(sph_skin_get_arrays(skin, &out), SPH_OK);
    return out;
}

START_TEST(weights_come_back_joined_sorted_and_with_sums_of_exactly_one)
{
    static const uint32_t BONE[VERTICES][SLOTS] = {{1, 0, 0}, {2, 1, 0}, {1, 0, 0}, {0, 1, 2}};
    static const double WEIGHT[VERTICES][SLOTS] = {{0.75, 0.25, 0}, {0.6, 0.4, 0}, {1, 0, 0}, {1.0 / 3, 1.0 / 3, 1.0 / 3}};
    sph_skin *skin = make();
    const sph_skin_arrays out = get(skin);
    for (int v = 0; v < VERTICES; ++v) {
        float up = 0, down = 0;
        for (int s = 0; s < SLOTS; ++s) {
            ck_assert_uint_eq(out.bones[SLOTS * v + s], BONE[v][s]);
            ck_assert_double_eq_tol((double)out.weights[SLOTS * v + s], WEIGHT[v][s], 1e-7);
            up += out.weights[SLOTS * v + s];
            down += out.weights[SLOTS * v + SLOTS - 1 - s];
        }
        ck_assert(up == 1 && down == 1);
    }
    sph_skin_destroy(skin);
}
END_TEST

START_TEST(parts_are_copies_that_outlive_arrays_and_context)
{
    sph_skin *skin = make();
    sph_skin_arrays out;
    sph_context_destroy(context);
    context = NULL;
    rest[1][1] = transforms[1][2][3] = 99;
    links[0][0] = 0;
    out = get(skin);
    ck_assert_double_eq(out.transforms[12 * (BONES + 2) + 3], 3);
    ck_assert(out.rest[4] == 2);
    ck_assert_uint_eq(out.link_count, 2);
    ck_assert_uint_eq(out.links[2], 1);
    ck_assert_uint_eq(out.links[3], 2);
    ck_assert_str_eq(out.clips[0].name, "walk");
    ck_assert_str_eq(out.clips[1].name, "");
    ck_assert_uint_eq(out.rigid, 1);
    ck_assert_uint_eq(sph_skin_vertex_count(skin), VERTICES);
    ck_assert_uint_eq(sph_skin_bone_count(skin), BONES);
    ck_assert_uint_eq(sph_skin_influence_count(skin), SLOTS);
    ck_assert_uint_eq(sph_skin_frame_count(skin), FRAMES);
    sph_skin_destroy(skin);
    sph_skin_destroy(NULL);
}
END_TEST

START_TEST(pivots_default_to_the_weighted_means_of_the_bones_vertices)
{
    sph_skin *skin = make();
    const sph_skin_arrays out = get(skin);
    for (int b = 0; b < BONES; ++b)
        for (int c = 0; c < 3; ++c) {
            double sum = 0, mass = 0;
            for (int i = 0; i < VERTICES * SLOTS; ++i) {
                const double weight = (double)weights[i / SLOTS][i % SLOTS];
                if (bones[i / SLOTS][i % SLOTS] != (uint32_t)b) continue;
                sum += weight * (double)rest[i / SLOTS][c];
                mass += weight;
            }
            ck_assert_double_eq_tol(out.pivots[3 * b + c], sum / mass, 1e-6);
        }
    sph_skin_destroy(skin);
}
END_TEST

START_TEST(a_scale_or_a_reflection_is_kept_and_is_not_rigid)
{
    sph_skin *skin;
    transforms[1][1][0] = _i ? -1 : 1.5;
    skin = make();
    ck_assert_uint_eq(get(skin).rigid, 0);
    ck_assert_double_eq(get(skin).transforms[12 * (BONES + 1)], _i ? -1 : 1.5);
    sph_skin_destroy(skin);
}
END_TEST

START_TEST(clips_left_out_are_one_of_all_frames_and_no_frames_are_none)
{
    sph_skin *skin;
    arrays.clip_count = 0;
    arrays.clips = NULL;
    skin = make();
    ck_assert_uint_eq(get(skin).clip_count, 1);
    ck_assert_uint_eq(get(skin).clips[0].frame_count, FRAMES);
    sph_skin_destroy(skin);
    arrays.frame_count = 0;
    arrays.transforms = NULL;
    skin = make();
    ck_assert_uint_eq(get(skin).clip_count, 0);
    ck_assert_ptr_null(get(skin).transforms);
    sph_skin_destroy(skin);
}
END_TEST

static void spoil_size(void) { --arrays.struct_size; }
static void spoil_bones(void) { arrays.bone_count = 0; }
static void spoil_slots(void) { arrays.influence_count = 0; }
static void spoil_null(void) { arrays.weights = NULL; }
static void spoil_rest(void) { rest[2][1] = NAN; }
static void spoil_transform(void) { transforms[1][0][3] = INFINITY; }
static void spoil_bone(void) { bones[3][1] = BONES; }
static void spoil_negative(void) { weights[1][0] = -0.25f; }
static void spoil_nan(void) { weights[1][0] = NAN; }
static void spoil_sum(void) { weights[0][1] = 0.5f; }
static void spoil_triangle(void) { triangles[1][2] = VERTICES; }
static void spoil_link(void) { links[2][0] = BONES; }
static void spoil_clip_gap(void) { clips[1].first_frame = 2; }
static void spoil_clip_end(void) { clips[1].frame_count = 2; }
static void spoil_rate(void) { clips[0].frames_per_second = -1; }

static const struct {
    void (*spoil)(void);
    const char *message;
} BAD[] = {{spoil_size, "struct_size"},      {spoil_bones, "0 bones"},         {spoil_slots, "0 influences"},
           {spoil_null, "NULL"},             {spoil_rest, "vertex 2"},         {spoil_transform, "bone 0 in frame 1"},
           {spoil_bone, "vertex 3"},         {spoil_negative, "vertex 1"},     {spoil_nan, "vertex 1"},
           {spoil_sum, "vertex 0"},          {spoil_triangle, "triangle 1"},   {spoil_link, "link 2"},
           {spoil_clip_gap, "clip 1"},       {spoil_clip_end, "clips have 3"}, {spoil_rate, "clip 0"}};

START_TEST(bad_arrays_are_refused_by_name)
{
    sph_skin *skin = (sph_skin *)context;
    BAD[_i].spoil();
    ck_assert_int_eq(sph_skin_create_from_arrays(context, &arrays, &skin), SPH_E_INVALID);
    ck_assert_ptr_null(skin);
    ck_assert_msg(strstr(sph_context_last_message(context), BAD[_i].message) != NULL, "%s",
                  sph_context_last_message(context));
}
END_TEST

START_TEST(measuring_gives_the_distances_that_were_put_in)
{
    /* Bone 1 alone moves vertex 2, by (2, 2, 2) in frame 1; the animation has it 0.5 further. */
    sph_skin *skin = make();
    sph_animation *animation = NULL;
    const sph_skin_source source = {NULL, NULL, 0};
    sph_skin_source sources[1] = {source};
    sph_skin_error overall, frames[FRAMES];
    ck_assert_int_eq(sph_skin_get_errors(skin, &overall, NULL), SPH_E_STATE);
    ck_assert_int_eq(sph_animation_create(context, VERTICES, FRAMES, &animation), SPH_OK);
    for (int f = 0; f < FRAMES; ++f) {
        float xyz[VERTICES][3];
        const sph_skin_arrays out = get(skin);
        for (int v = 0; v < VERTICES; ++v)
            for (int c = 0; c < 3; ++c) {
                double moved = 0;
                for (int s = 0; s < SLOTS; ++s)
                    moved += (double)out.weights[SLOTS * v + s] * f * (out.bones[SLOTS * v + s] + 1);
                xyz[v][c] = (float)((double)rest[v][c] + moved + (f == 1 && v == 2 && c == 1 ? 0.5 : 0));
            }
        ck_assert_int_eq(sph_animation_set_frame(animation, (uint32_t)f, xyz[0], 0), SPH_OK);
    }
    ck_assert_int_eq(sph_animation_set_triangles(animation, triangles[0], 2, 0), SPH_OK);
    sources[0].animation = animation;
    ck_assert_int_eq(sph_skin_measure(skin, sources, 1, &overall, frames), SPH_OK);
    ck_assert_double_eq_tol(frames[0].max, 0, 1e-6);
    ck_assert_double_eq_tol(frames[1].max, 0.5, 1e-6);
    ck_assert_double_eq_tol(frames[1].rmse, 0.25, 1e-6);
    ck_assert_double_eq_tol(overall.rmse, 0.25 / sqrt(2), 1e-6);
    ck_assert_double_eq_tol(overall.rmse_percent, 100 * overall.rmse / overall.diagonal, 1e-9);
    ck_assert_uint_eq(overall.max_vertex, 2);
    ck_assert_uint_eq(overall.max_frame, 1);
    ck_assert(frames[1].mse > 0 && frames[1].mse < 0.25 / (overall.diagonal * overall.diagonal));
    ck_assert_int_eq(sph_skin_measure(skin, sources, 0, &overall, frames), SPH_E_INVALID);
    sph_animation_destroy(animation);
    sph_skin_destroy(skin);
}
END_TEST

static sph_status create(sph_context *own, const void *user)
{
    sph_skin *skin = NULL;
    const sph_status status = sph_skin_create_from_arrays(own, user, &skin);
    ck_assert((skin != NULL) == (status == SPH_OK));
    sph_skin_destroy(skin);
    return status;
}

START_TEST(every_allocation_may_fail)
{
    check_every_allocation((test_faults){.work = create, .user = &arrays, .least = 10, .sticky = _i});
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("skin_arrays");
    TCase *tc = tcase_create("arrays");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_test(tc, weights_come_back_joined_sorted_and_with_sums_of_exactly_one);
    tcase_add_test(tc, parts_are_copies_that_outlive_arrays_and_context);
    tcase_add_test(tc, pivots_default_to_the_weighted_means_of_the_bones_vertices);
    tcase_add_loop_test(tc, a_scale_or_a_reflection_is_kept_and_is_not_rigid, 0, 2);
    tcase_add_test(tc, clips_left_out_are_one_of_all_frames_and_no_frames_are_none);
    tcase_add_loop_test(tc, bad_arrays_are_refused_by_name, 0, (int)(sizeof BAD / sizeof *BAD));
    tcase_add_test(tc, measuring_gives_the_distances_that_were_put_in);
    tcase_add_loop_test(tc, every_allocation_may_fail, 0, 2);
    return run_suite(suite, tc);
}
