/* SPDX-License-Identifier: MIT */
/* Skinned glTF: what the format asks for, read from the bytes. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "rig_case.h"
#include "runner.h"

static rig_file file;

static json_int_t attribute(const char *name)
{
    char full[64];
    snprintf(full, sizeof full, "meshes/0/primitives/0/attributes/%s", name);
    return rig_integer(&file, full);
}

START_TEST(weights_have_a_sum_of_exactly_one_and_name_each_joint_once)
{
    static const json_int_t TYPES[] = {5126, 5121, 5123};
    static const double ONE[] = {1, 255, 65535};
    sph_skin *made;
    rig_input_make(&input, 120, 12, 9);
    for (uint32_t s = 0; s < 9; ++s)
        input.bones[9 * 8 + s] = 11 - s; /* a vertex that uses all slots */
    made = save(SPH_SKELETON_TREE, 0, _i);
    rig_open(&file, path);
    ck_assert_int_eq(attribute("JOINTS_3"), -1);
    for (uint32_t v = 0; v < 120; ++v) {
        double sum = 0;
        bool named[12] = {false};
        for (unsigned s = 0; s < 12; ++s) {
            char joints[16], weights[16];
            double weight, joint;
            snprintf(joints, sizeof joints, "JOINTS_%u", s / 4);
            snprintf(weights, sizeof weights, "WEIGHTS_%u", s / 4);
            ck_assert_int_eq(rig_component_type(&file, attribute(joints)), 5121);
            ck_assert_int_eq(rig_component_type(&file, attribute(weights)), TYPES[_i]);
            weight = rig_number(&file, attribute(weights), v, s % 4);
            joint = rig_number(&file, attribute(joints), v, s % 4);
            sum += weight;
            ck_assert(joint >= 0 && joint < 12);
            if (weight > 0) {
                ck_assert(!named[(int)joint]);
                named[(int)joint] = true;
            } else {
                ck_assert_double_eq(joint, 0);
            }
            if (s < skin.influence_count)
                ck_assert_double_le(fabs(weight - ONE[_i] * (double)skin.weights[v * skin.influence_count + s]),
                                    _i == 0 ? 0 : 1);
        }
        ck_assert_double_eq(sum, ONE[_i]);
    }
    rig_close(&file);
    sph_skin_destroy(made);
}
END_TEST

/* Nine slots of which no vertex uses more than the first few; two hundred bones and three hundred. */
START_TEST(sets_joints_and_indices_are_no_wider_than_needed)
{
    static const uint32_t BONES[] = {256, 257};
    sph_skin *made;
    rig_input_make(&input, 120, BONES[_i], 9);
    for (uint32_t v = 0; v < 120; ++v)
        for (uint32_t s = 0; s < 9; ++s)
            input.weights[9 * v + s] = s < 4 ? 0.25f : 0;
    input.bones[0] = BONES[_i] - 1;
    made = save(SPH_SKELETON_TREE, 0, SPH_IO_WEIGHTS_U8);
    rig_open(&file, path);
    ck_assert_int_eq(attribute("JOINTS_1"), -1);
    ck_assert_int_eq(attribute("WEIGHTS_1"), -1);
    ck_assert_int_eq(rig_component_type(&file, attribute("JOINTS_0")), _i == 0 ? 5121 : 5123);
    ck_assert_int_eq(rig_component_type(&file, rig_integer(&file, "meshes/0/primitives/0/indices")), 5123);
    rig_close(&file);
    sph_skin_destroy(made);
}
END_TEST

/* The last number of 16 bits ends a strip in some readers, and may not be an index. */
START_TEST(more_than_65535_vertices_take_wide_indices)
{
    const uint32_t n = _i == 0 ? 65535 : 65536, triangle[3] = {n - 3, n - 2, n - 1};
    sph_skin_arrays a = {.struct_size = sizeof a,
                         .vertex_count = n,
                         .bone_count = 1,
                         .influence_count = 1,
                         .triangle_count = 1,
                         .triangles = triangle};
    float *rest = test_malloc(n, 3 * sizeof *rest), *weights = test_malloc(n, sizeof *weights);
    uint32_t *bones = test_malloc(n, sizeof *bones);
    sph_skin *made = NULL;
    for (uint32_t v = 0; v < n; ++v) {
        rest[3 * v] = rest[3 * v + 1] = rest[3 * v + 2] = (float)(v % 7);
        weights[v] = 1;
        bones[v] = 0;
    }
    a.rest = rest, a.weights = weights, a.bones = bones;
    ck_assert_int_eq(sph_skin_create_from_arrays(context, &a, &made), SPH_OK);
    ck_assert_int_eq(sph_io_save_rig(context, made, NULL, NULL, path), SPH_OK);
    rig_open(&file, path);
    ck_assert_int_eq(rig_component_type(&file, rig_integer(&file, "meshes/0/primitives/0/indices")),
                     _i == 0 ? 5123 : 5125);
    for (unsigned k = 0; k < 3; ++k)
        ck_assert_double_eq(rig_number(&file, rig_integer(&file, "meshes/0/primitives/0/indices"), k, 0), triangle[k]);
    ck_assert_int_eq(json_integer_value(rig_value(&file, "bufferViews/5/byteOffset")) % 4, 0); /* after three numbers */
    rig_close(&file);
    sph_skin_destroy(made);
    free(rest);
    free(weights);
    free(bones);
}
END_TEST

START_TEST(keys_are_unit_quaternions_without_a_jump_of_sign_at_rising_times)
{
    static const double RATE[] = {24, 30};
    sph_skin *made;
    rig_input_make(&input, 60, 9, 4);
    made = save(SPH_SKELETON_TREE, 0, SPH_IO_WEIGHTS_FLOAT);
    rig_open(&file, path);
    for (int c = 0; c < 2; ++c) {
        const uint32_t frames = skin.clips[c].frame_count;
        char name[64];
        json_int_t times;
        snprintf(name, sizeof name, "animations/%d/samplers/0/input", c);
        times = rig_integer(&file, name);
        ck_assert_uint_eq(rig_count(&file, times), frames);
        for (uint32_t f = 0; f < frames; ++f)
            ck_assert_double_eq(rig_number(&file, times, f, 0), (double)(float)(f / RATE[c]));
        for (int s = 0; s < 18; ++s) {
            json_int_t output;
            snprintf(name, sizeof name, "animations/%d/samplers/%d/input", c, s);
            ck_assert_int_eq(rig_integer(&file, name), times);
            snprintf(name, sizeof name, "animations/%d/channels/%d/target/node", c, s);
            ck_assert_int_eq(rig_integer(&file, name), s / 2);
            snprintf(name, sizeof name, "animations/%d/samplers/%d/output", c, s);
            output = rig_integer(&file, name);
            ck_assert_uint_eq(rig_count(&file, output), frames);
            ck_assert_str_eq(rig_type(&file, output), s % 2 == 0 ? "VEC4" : "VEC3");
            for (uint32_t f = 0; f < frames && s % 2 == 0; ++f) {
                double length = 0, along = 0;
                for (unsigned k = 0; k < 4; ++k) {
                    length += pow(rig_number(&file, output, f, k), 2);
                    along += rig_number(&file, output, f, k) * (f == 0 ? k == 3 : rig_number(&file, output, f - 1, k));
                }
                ck_assert_double_eq_tol(length, 1, 3e-7);
                ck_assert_double_ge(along, 0);
            }
        }
    }
    rig_close(&file);
    sph_skin_destroy(made);
}
END_TEST

/* JSON's numbers of two accessors against their content. */
START_TEST(bounds_that_the_format_asks_for_are_those_of_the_numbers)
{
    static const char *const ACCESSOR[] = {"meshes/0/primitives/0/attributes/POSITION",
                                           "animations/1/samplers/0/input"};
    sph_skin *made;
    json_int_t accessor;
    rig_input_make(&input, 60, 9, 4);
    made = save(SPH_SKELETON_TREE, 0, SPH_IO_WEIGHTS_FLOAT);
    rig_open(&file, path);
    accessor = rig_integer(&file, ACCESSOR[_i]);
    for (unsigned k = 0; k < (_i == 0 ? 3 : 1); ++k) {
        double low = INFINITY, high = -INFINITY;
        char name[64];
        for (size_t e = 0; e < rig_count(&file, accessor); ++e) {
            low = fmin(low, rig_number(&file, accessor, e, k));
            high = fmax(high, rig_number(&file, accessor, e, k));
        }
        snprintf(name, sizeof name, "accessors/%d/min/%u", (int)accessor, k);
        ck_assert_double_eq((double)(float)json_number_value(rig_value(&file, name)), low);
        snprintf(name, sizeof name, "accessors/%d/max/%u", (int)accessor, k);
        ck_assert_double_eq((double)(float)json_number_value(rig_value(&file, name)), high);
    }
    rig_close(&file);
    sph_skin_destroy(made);
}
END_TEST

/* 0, 1: a tree, without and with a root above it; 2, 3: a list. */
START_TEST(the_mesh_is_at_the_scene_s_root_and_all_joints_have_one_root)
{
    json_t *nodes, *joints;
    bool child[16] = {false};
    unsigned roots = 0;
    json_int_t top, mesh;
    sph_skin *made;
    rig_input_make(&input, 60, 9, 4);
    made = save(_i & 2 ? SPH_SKELETON_FLAT : SPH_SKELETON_TREE, _i & 1, SPH_IO_WEIGHTS_FLOAT);
    rig_open(&file, path);
    nodes = rig_value(&file, "nodes");
    joints = rig_value(&file, "skins/0/joints");
    ck_assert_uint_eq(json_array_size(joints), _i & 1 ? 10 : 9);
    ck_assert_uint_eq(rig_count(&file, rig_integer(&file, "skins/0/inverseBindMatrices")), json_array_size(joints));
    ck_assert_uint_eq(json_array_size(rig_value(&file, "scenes/0/nodes")), 2);
    top = rig_integer(&file, "scenes/0/nodes/0");
    mesh = rig_integer(&file, "scenes/0/nodes/1");
    ck_assert_int_eq(rig_integer(&file, "skins/0/skeleton"), top);
    ck_assert_uint_eq(json_array_size(nodes), (size_t)mesh + 1);
    ck_assert_uint_eq(json_object_size(json_array_get(nodes, (size_t)mesh)), 3); /* name, mesh, skin: no transform */
    for (size_t i = 0; i < json_array_size(nodes); ++i) {
        const json_t *children = json_object_get(json_array_get(nodes, i), "children");
        for (size_t c = 0; c < json_array_size(children); ++c) {
            const size_t node = (size_t)json_integer_value(json_array_get(children, c));
            ck_assert(node < json_array_size(nodes) && !child[node]);
            child[node] = true;
        }
    }
    for (size_t i = 0; i < json_array_size(nodes); ++i)
        roots += !child[i];
    ck_assert_uint_eq(roots, 2);
    ck_assert(!child[top] && !child[mesh]);
    if (_i == 2) ck_assert_str_eq(json_string_value(rig_value(&file, "nodes/9/name")), "rig");
    if (_i & 1) ck_assert_str_eq(json_string_value(rig_value(&file, "nodes/9/name")), "root");
    rig_close(&file);
    sph_skin_destroy(made);
}
END_TEST

/* The corners of a cube, whichever way its sides are cut: the diagonals. And no triangle at all: upward. */
START_TEST(normals_are_weighed_by_angle)
{
    static const uint32_t BONE[9] = {0};
    sph_animation *cube = test_cube(context, 1);
    float rest[27] = {0}, weights[9];
    sph_skin_arrays a = {.struct_size = sizeof a,
                         .vertex_count = 9,
                         .bone_count = 1,
                         .influence_count = 1,
                         .rest = rest,
                         .bones = BONE,
                         .weights = weights,
                         .triangle_count = 12,
                         .triangles = sph_animation_triangles(cube)};
    sph_skin *made = NULL;
    ck_assert_int_eq(sph_animation_read_frame(cube, 0, rest), SPH_OK);
    for (int v = 0; v < 9; ++v)
        weights[v] = 1;
    ck_assert_int_eq(sph_skin_create_from_arrays(context, &a, &made), SPH_OK);
    ck_assert_int_eq(sph_io_save_rig(context, made, NULL, NULL, path), SPH_OK);
    rig_open(&file, path);
    for (size_t v = 0; v < 8; ++v)
        for (unsigned k = 0; k < 3; ++k)
            ck_assert_double_eq_tol(rig_number(&file, attribute("NORMAL"), v, k), (double)rest[3 * v + k] / sqrt(3),
                                    1e-6);
    for (unsigned k = 0; k < 3; ++k)
        ck_assert_double_eq(rig_number(&file, attribute("NORMAL"), 8, k), k == 1);
    rig_close(&file);
    sph_skin_destroy(made);
    sph_animation_destroy(cube);
}
END_TEST

START_TEST(names_of_clips_are_written_whatever_they_hold)
{
    sph_skin *made;
    json_t *name;
    rig_input_make(&input, 40, 5, 4);
    input.clips[0].name = "a \"b\"\\\n\x01 \xC3\xA9 \xF0\x9F\x90\x8E \xFF\xC0\xAF";
    made = save(SPH_SKELETON_TREE, 0, SPH_IO_WEIGHTS_FLOAT);
    rig_open(&file, path);
    name = rig_value(&file, "animations/0/name");
    ck_assert_str_eq(json_string_value(name),
                     "a \"b\"\\\n\x01 \xC3\xA9 \xF0\x9F\x90\x8E \xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD");
    rig_close(&file);
    sph_skin_destroy(made);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("io_rig_bytes");
    TCase *tc = tcase_create("rig");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, weights_have_a_sum_of_exactly_one_and_name_each_joint_once, 0, 3);
    tcase_add_loop_test(tc, sets_joints_and_indices_are_no_wider_than_needed, 0, 2);
    tcase_add_loop_test(tc, more_than_65535_vertices_take_wide_indices, 0, 2);
    tcase_add_test(tc, keys_are_unit_quaternions_without_a_jump_of_sign_at_rising_times);
    tcase_add_loop_test(tc, bounds_that_the_format_asks_for_are_those_of_the_numbers, 0, 2);
    tcase_add_loop_test(tc, the_mesh_is_at_the_scene_s_root_and_all_joints_have_one_root, 0, 4);
    tcase_add_test(tc, normals_are_weighed_by_angle);
    tcase_add_test(tc, names_of_clips_are_written_whatever_they_hold);
    return run_suite(suite, tc);
}
