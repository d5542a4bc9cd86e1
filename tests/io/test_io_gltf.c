/* SPDX-License-Identifier: MIT */
/* Baked glTF against poses that are known in closed form. */
#include <check.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "glb.h"
#include "runner.h"
#include "support.h"

#define SCENE "\"scenes\":[{\"nodes\":[0]}],"
static const double PI = 3.14159265358979323846, TOLERANCE = 1e-6;
static const double TRIANGLE[9] = {2, 0, 0, 0, 3, 0, 0, 0, 4};
static const double TWO_TIMES[2] = {0, 1};

static sph_context *context;
static glb file;
static float xyz[300];

static void setup(void)
{
    context = test_context();
    file = (glb){.view_count = 0};
    files_setup();
}

static void teardown(void)
{
    glb_free(&file);
    files_teardown();
    sph_context_destroy(context);
}

/* Writes and opens the file; not welded. */
static sph_animation *bake(const char *rest, const char *clip, uint32_t vertices, uint32_t frames)
{
    sph_io_open_options o;
    sph_status status;
    sph_animation *a;
    sph_io_open_options_init(&o, sizeof o);
    o.weld = SPH_IO_WELD_NONE;
    o.clip = clip;
    o.fps = 10;
    a = open_one(context, glb_write(&file, "a.glb", rest), &o, &status);
    ck_assert_msg(status == SPH_OK, "%s", sph_context_last_message(context));
    ck_assert_uint_eq(sph_animation_vertex_count(a), vertices);
    ck_assert_uint_eq(sph_animation_frame_count(a), frames);
    return a;
}

static void read(const sph_animation *a, uint32_t frame)
{
    ck_assert_int_eq(sph_animation_read_frame(a, frame, xyz), SPH_OK);
}

static void check_vertex(uint32_t v, double x, double y, double z)
{
    const double wanted[3] = {x, y, z};
    for (int k = 0; k < 3; ++k)
        ck_assert_msg(fabs((double)xyz[3 * v + k] - wanted[k]) <= TOLERANCE, "vertex %u axis %d: %.9g, not %.9g", v, k,
                      (double)xyz[3 * v + k], wanted[k]);
}

static const char *text(const char *format, ...) __attribute__((format(printf, 1, 2)));

static const char *text(const char *format, ...)
{
    static char buffer[4096];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(buffer, sizeof buffer, format, arguments);
    va_end(arguments);
    return buffer;
}

/* Positions, joints and weights of one triangle that hangs on joint 0 altogether. */
static void put_skinned_triangle(void)
{
    static const double JOINTS[12] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    static const double WEIGHTS[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    glb_floats(&file, "VEC3", 3, TRIANGLE);
    glb_numbers(&file, GLB_U8, "VEC4", 3, JOINTS, "");
    glb_floats(&file, "VEC4", 3, WEIGHTS);
}

#define SKINNED "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"JOINTS_0\":1,\"WEIGHTS_0\":2}}]}],"

/* _i 0: the second key as it is; 1: its negative, which is the same rotation, and must not be gone to the long way. */
START_TEST(a_bone_turns_at_constant_speed_about_its_joint)
{
    const double sign = _i == 0 ? 1 : -1, half = sqrt(0.5);
    const double turns[8] = {0, 0, 0, 1, 0, 0, sign * half, sign * half};
    static const double BIND[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1};
    sph_animation *a;
    put_skinned_triangle();
    glb_floats(&file, "MAT4", 1, BIND);
    glb_floats(&file, "SCALAR", 2, TWO_TIMES);
    glb_floats(&file, "VEC4", 2, turns);
    /* The mesh's own node is far away, and does not count. */
    a = bake("\"scenes\":[{\"nodes\":[0,1]}],\"nodes\":[{\"mesh\":0,\"skin\":0,\"translation\":[9,9,9]},"
             "{\"translation\":[1,0,0]}]," SKINNED "\"skins\":[{\"joints\":[1],\"inverseBindMatrices\":3}],"
             "\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{\"node\":1,\"path\":\"rotation\"}}],"
             "\"samplers\":[{\"input\":4,\"output\":5}]}]",
             NULL, 3, 11);
    for (uint32_t f = 0; f <= 10; ++f) {
        const double angle = PI / 2 * f / 10, c = cos(angle), s = sin(angle);
        read(a, f);
        check_vertex(0, 1 + c, s, 0);
        check_vertex(1, 1 - c - 3 * s, -s + 3 * c, 0);
        check_vertex(2, 1 - c, -s, 4);
    }
    sph_animation_destroy(a);
}
END_TEST

/* Two meshes with skins of their own; the first has two sets of joints, five of them on one vertex. */
START_TEST(two_skins_and_two_sets_of_joints_blend_by_their_weights)
{
    static const double JOINTS_0[12] = {0, 1, 2, 3, 0, 0, 0, 0, 1, 0, 9, 9}, JOINTS_1[12] = {4, 0, 0, 0};
    static const double WEIGHTS_0[12] = {10, 20, 30, 15, 255, 0, 0, 0, 51, 204, 0, 0}, WEIGHTS_1[12] = {25, 0, 0, 0};
    static const double SECOND[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    static const double SHORT_WEIGHTS[12] = {65535, 0, 0, 0, 65535, 0, 0, 0, 32768, 0, 0, 0};
    sph_animation *a;
    glb_floats(&file, "VEC3", 3, TRIANGLE);
    glb_numbers(&file, GLB_U8, "VEC4", 3, JOINTS_0, "");
    glb_numbers(&file, GLB_U8, "VEC4", 3, WEIGHTS_0, ",\"normalized\":true");
    glb_numbers(&file, GLB_U16, "VEC4", 3, JOINTS_1, "");
    glb_numbers(&file, GLB_U8, "VEC4", 3, WEIGHTS_1, ",\"normalized\":true");
    glb_numbers(&file, GLB_U16, "VEC4", 3, SECOND, "");
    glb_numbers(&file, GLB_U16, "VEC4", 3, SHORT_WEIGHTS, ",\"normalized\":true");
    a = bake("\"scenes\":[{\"nodes\":[0,1]}],\"nodes\":[{\"mesh\":0,\"skin\":0},{\"mesh\":1,\"skin\":1},"
             "{\"translation\":[1,0,0]},{\"translation\":[0,1,0]},{\"translation\":[0,0,1]},"
             "{\"translation\":[0,10,0]},{\"translation\":[100,0,0]}],"
             "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"JOINTS_0\":1,\"WEIGHTS_0\":2,"
             "\"JOINTS_1\":3,\"WEIGHTS_1\":4}}]},"
             "{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"JOINTS_0\":5,\"WEIGHTS_0\":6}}]}],"
             "\"skins\":[{\"joints\":[2,3,4,5,6]},{\"joints\":[4,2]}]",
             NULL, 6, 1);
    read(a, 0);
    check_vertex(0, 2 + 0.1 + 25, 0.2 + 1.5, 0.3); /* weights of 10 20 30 15 25 in 100 */
    check_vertex(1, 1, 3, 0);
    check_vertex(2, 0.8, 0.2, 4);
    check_vertex(3, 3, 0, 0); /* joint 1 of the second skin is node 2 */
    check_vertex(4, 1, 3, 0);
    check_vertex(5, 1, 0, 4); /* weights that do not sum to one are made to */
    sph_animation_destroy(a);
}
END_TEST

START_TEST(a_vertex_without_weights_hangs_on_its_first_joint)
{
    static const double NONE[12] = {0}, JOINTS[12] = {1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0};
    sph_animation *a;
    glb_floats(&file, "VEC3", 3, TRIANGLE);
    glb_numbers(&file, GLB_U8, "VEC4", 3, JOINTS, "");
    glb_floats(&file, "VEC4", 3, NONE);
    a = bake(SCENE "\"nodes\":[{\"mesh\":0,\"skin\":0},{},{\"translation\":[0,0,5]}]," SKINNED
                   "\"skins\":[{\"joints\":[1,2]}]",
             NULL, 3, 1);
    read(a, 0);
    check_vertex(0, 2, 0, 5);
    check_vertex(1, 0, 3, 5);
    check_vertex(2, 0, 0, 4);
    sph_animation_destroy(a);
}
END_TEST

/* A cubic between two keys with its own derivatives for tangents is met everywhere. */
START_TEST(a_cubic_spline_is_the_polynomial_of_its_keys_and_tangents)
{
    double keys[2][3][3];
    static const double TIMES[2] = {0.5, 2.5};
    sph_animation *a;
    for (int k = 0; k < 2; ++k) {
        const double t = TIMES[k];
        const double value[3] = {t * t * t - 2 * t, 3 * t * t + 1, 5 - t}, slope[3] = {3 * t * t - 2, 6 * t, -1};
        for (int i = 0; i < 3; ++i) {
            keys[k][0][i] = k == 0 ? 77 : slope[i]; /* no key comes before the first: its tangent is not used */
            keys[k][1][i] = value[i];
            keys[k][2][i] = k == 1 ? 77 : slope[i];
        }
    }
    glb_floats(&file, "VEC3", 3, TRIANGLE);
    glb_floats(&file, "SCALAR", 2, TIMES);
    glb_floats(&file, "VEC3", 6, &keys[0][0][0]);
    a = bake(SCENE "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
                   "\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"translation\"}}],"
                   "\"samplers\":[{\"input\":1,\"output\":2,\"interpolation\":\"CUBICSPLINE\"}]}]",
             NULL, 3, 26);
    for (uint32_t f = 0; f <= 25; ++f) {
        const double t = f < 5 ? 0.5 : f / 10.0; /* before the first key its value stands */
        const double scale = t * t * t - 2 * t;
        read(a, f);
        ck_assert_double_eq_tol((double)xyz[0] - 2, scale, 2e-6);
        ck_assert_double_eq_tol((double)xyz[4] - 3, 3 * t * t + 1, 3e-6);
        ck_assert_double_eq_tol((double)xyz[8] - 4, 5 - t, 2e-6);
    }
    sph_animation_destroy(a);
}
END_TEST

START_TEST(steps_keep_a_value_until_the_next_key)
{
    static const double TIMES[3] = {0, 0.25, 0.5}, SCALES[9] = {1, 1, 1, 2, 3, 4, 5, 5, 5};
    sph_animation *a;
    glb_floats(&file, "VEC3", 3, TRIANGLE);
    glb_floats(&file, "SCALAR", 3, TIMES);
    glb_floats(&file, "VEC3", 3, SCALES);
    a = bake(SCENE "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
                   "\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"scale\"}}],"
                   "\"samplers\":[{\"input\":1,\"output\":2,\"interpolation\":\"STEP\"}]}]",
             NULL, 3, 6);
    for (uint32_t f = 0; f < 6; ++f) {
        const double *s = SCALES + 3 * (f < 3 ? 0 : f < 5 ? 1 : 2);
        read(a, f);
        check_vertex(0, 2 * s[0], 0, 0);
        check_vertex(1, 0, 3 * s[1], 0);
        check_vertex(2, 0, 0, 4 * s[2]);
    }
    sph_animation_destroy(a);
}
END_TEST

/* The second target is sparse with nothing below it: only one vertex moves. Weights are bytes. */
START_TEST(morph_targets_add_up_by_their_weights)
{
    static const double MOVES[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, WEIGHTS[4] = {0, 255, 255, 51}, MOVE[3] = {7, 8, 9};
    static const unsigned char INDEX[1] = {2};
    uint32_t index_view, value_view;
    layout value = {NULL, 0, 0};
    sph_animation *a;
    glb_floats(&file, "VEC3", 3, TRIANGLE);
    glb_floats(&file, "VEC3", 3, MOVES);
    glb_floats(&file, "SCALAR", 2, TWO_TIMES);
    glb_numbers(&file, GLB_U8, "SCALAR", 4, WEIGHTS, ",\"normalized\":true");
    index_view = glb_view(&file, INDEX, 1, 0);
    for (int i = 0; i < 3; ++i)
        put_little_float(&value, (float)MOVE[i]);
    value_view = glb_view(&file, value.bytes, value.size, 0);
    layout_free(&value);
    put_bytes(&file.accessors, ",", 1);
    {
        const char *sparse = text("{\"componentType\":5126,\"type\":\"VEC3\",\"count\":3,\"sparse\":{\"count\":1,"
                                  "\"indices\":{\"bufferView\":%u,\"componentType\":5121},\"values\":"
                                  "{\"bufferView\":%u}}}",
                                  index_view, value_view);
        put_bytes(&file.accessors, sparse, strlen(sparse));
    }
    a = bake(SCENE "\"nodes\":[{\"mesh\":0,\"translation\":[0,0,-1]}],"
                   "\"meshes\":[{\"weights\":[0.5,0.5],\"primitives\":[{\"attributes\":{\"POSITION\":0},"
                   "\"targets\":[{\"POSITION\":1},{\"POSITION\":4}]}]}],"
                   "\"animations\":[{\"name\":\"talk\",\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,"
                   "\"path\":\"weights\"}}],\"samplers\":[{\"input\":2,\"output\":3}]}]",
             "talk", 3, 11);
    for (uint32_t f = 0; f <= 10; ++f) {
        const double t = f / 10.0, first = t, second = 1 - 0.8 * t;
        read(a, f);
        check_vertex(0, 2 + first, 0, -1);
        check_vertex(1, 0, 3 + first, -1);
        check_vertex(2, 7 * second, 8 * second, 3 + first + 9 * second);
    }
    sph_animation_destroy(a);
}
END_TEST

/* Grandparent turns by 180 degrees, parent has a matrix, the mesh's node a scale. */
START_TEST(animated_nodes_above_a_mesh_move_it)
{
    static const double TURNS[12] = {0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, -1}, TIMES[3] = {0, 1, 2};
    sph_animation *a;
    glb_floats(&file, "VEC3", 3, TRIANGLE);
    glb_floats(&file, "SCALAR", 3, TIMES);
    glb_floats(&file, "VEC4", 3, TURNS);
    a = bake("\"scene\":0,\"scenes\":[{\"nodes\":[2]}],\"nodes\":[{\"mesh\":0,\"scale\":[2,2,2]},"
             "{\"children\":[0],\"matrix\":[0,0,-1,0, 0,1,0,0, 1,0,0,0, 5,6,7,1]},{\"children\":[1]}],"
             "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
             "\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{\"node\":2,\"path\":\"rotation\"}}],"
             "\"samplers\":[{\"input\":1,\"output\":2}]}]",
             NULL, 3, 21);
    for (uint32_t f = 0; f <= 20; ++f) {
        const double angle = f <= 10 ? PI * f / 10 : PI + PI * (f - 10) / 10, c = cos(angle), s = sin(angle);
        /* the matrix takes (x, y, z) to (z + 5, y + 6, -x + 7) */
        static const double MOVED[3][3] = {{5, 6, 3}, {5, 12, 7}, {13, 6, 7}};
        read(a, f);
        for (uint32_t v = 0; v < 3; ++v)
            if (f <= 10)
                check_vertex(v, MOVED[v][0] * c - MOVED[v][1] * s, MOVED[v][0] * s + MOVED[v][1] * c, MOVED[v][2]);
        if (f == 20) check_vertex(0, 5, 6, 3);
    }
    sph_animation_destroy(a);
}
END_TEST

START_TEST(all_clips_come_one_after_another_or_one_by_name_or_number)
{
    static const double UP[6] = {0, 0, 0, 0, 1, 0}, ASIDE[6] = {0, 0, 0, 3, 0, 0}, TIMES[2] = {0, 0.3};
    static const char REST[] =
        SCENE "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
              "\"animations\":[{\"name\":\"up\",\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,"
              "\"path\":\"translation\"}}],\"samplers\":[{\"input\":1,\"output\":3}]},"
              "{\"name\":\"\\u00e0 c\\u00f4t\\u00e9\",\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,"
              "\"path\":\"translation\"}}],\"samplers\":[{\"input\":2,\"output\":4}]}]";
    static const struct {
        const char *clip;
        uint32_t frames;
    } CASES[] = {{NULL, 15}, {"up", 11}, {"0", 11}, {"\xC3\xA0 c\xC3\xB4t\xC3\xA9", 4}, {"1", 4}};
    sph_animation *a;
    glb_floats(&file, "VEC3", 3, TRIANGLE);
    glb_floats(&file, "SCALAR", 2, TWO_TIMES);
    glb_floats(&file, "SCALAR", 2, TIMES);
    glb_floats(&file, "VEC3", 2, UP);
    glb_floats(&file, "VEC3", 2, ASIDE);
    a = bake(REST, CASES[_i].clip, 3, CASES[_i].frames);
    for (uint32_t f = 0; f < CASES[_i].frames; ++f) {
        const bool aside = CASES[_i].frames == 4 || f > 10;
        const double t = (aside && f > 10 ? f - 11 : f) / 10.0;
        read(a, f);
        check_vertex(0, 2 + (aside ? 10 * t : 0), aside ? 0 : t, 0);
    }
    sph_animation_destroy(a);
}
END_TEST

static void count_clips(void *user, const sph_io_clip *clip)
{
    ck_assert_uint_eq(clip->struct_size, sizeof *clip);
    *(unsigned *)user += clip->frame_count * (strcmp(clip->name, "run") == 0 ? 1 : 100);
}

START_TEST(clips_are_listed_with_their_frames)
{
    static const double TIMES[2] = {0.5, 1.5}, PLACES[6] = {0};
    unsigned sum = 0;
    glb_floats(&file, "VEC3", 3, TRIANGLE);
    glb_floats(&file, "SCALAR", 2, TIMES);
    glb_floats(&file, "VEC3", 2, PLACES);
    ck_assert_int_eq(sph_io_list_clips(context,
                                       glb_write(&file, "a.glb",
                                                 "\"animations\":[{\"name\":\"run\",\"channels\":[],\"samplers\":"
                                                 "[{\"input\":1,\"output\":2}]},{\"channels\":[],\"samplers\":[]}]"),
                                       10, count_clips, &sum),
                     SPH_OK);
    ck_assert_uint_eq(sum, 16 + 100);
    ck_assert_int_eq(sph_io_list_clips(context, write_obj("a.obj", 3, 0), 0, count_clips, &sum), SPH_OK);
    ck_assert_int_eq(sph_io_list_clips(context, NULL, 0, count_clips, &sum), SPH_E_INVALID);
    ck_assert_uint_eq(sum, 16 + 100);
}
END_TEST

int main(void)
{
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, a_bone_turns_at_constant_speed_about_its_joint, 0, 2);
    tcase_add_test(tc, two_skins_and_two_sets_of_joints_blend_by_their_weights);
    tcase_add_test(tc, a_vertex_without_weights_hangs_on_its_first_joint);
    tcase_add_test(tc, a_cubic_spline_is_the_polynomial_of_its_keys_and_tangents);
    tcase_add_test(tc, steps_keep_a_value_until_the_next_key);
    tcase_add_test(tc, morph_targets_add_up_by_their_weights);
    tcase_add_test(tc, animated_nodes_above_a_mesh_move_it);
    tcase_add_loop_test(tc, all_clips_come_one_after_another_or_one_by_name_or_number, 0, 5);
    tcase_add_test(tc, clips_are_listed_with_their_frames);
    return run_suite(suite_create("io glTF"), tc);
}
