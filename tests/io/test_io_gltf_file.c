/* SPDX-License-Identifier: MIT */
/* glTF as files: where bytes come from, what primitives become, and what is refused. */
#include <check.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "glb.h"
#include "runner.h"
#include "support.h"

#define SCENE "\"scenes\":[{\"nodes\":[0]}],"
static const double SQUARE[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};

static sph_context *context;
static glb file;
static sph_io_open_options options;
static float xyz[300];

static void setup(void)
{
    context = test_context();
    file = (glb){.view_count = 0};
    sph_io_open_options_init(&options, sizeof options);
    files_setup();
}

static void teardown(void)
{
    glb_free(&file);
    files_teardown();
    sph_context_destroy(context);
}

static sph_animation *open_path(const char *path, uint32_t vertices, size_t triangles)
{
    sph_status status;
    sph_animation *a = open_one(context, path, &options, &status);
    ck_assert_msg(status == SPH_OK, "%s", sph_context_last_message(context));
    ck_assert_uint_eq(sph_animation_vertex_count(a), vertices);
    ck_assert_uint_eq(sph_animation_triangle_count(a), triangles);
    ck_assert_int_eq(sph_animation_read_frame(a, 0, xyz), SPH_OK);
    return a;
}

static void check_triangles(const sph_animation *a, const uint32_t *wanted)
{
    for (size_t i = 0; i < 3 * sph_animation_triangle_count(a); ++i)
        ck_assert_uint_eq(sph_animation_triangles(a)[i], wanted[i]);
}

/* --- primitives --- */

static const struct {
    int mode;
    double corners[7];
    uint32_t corner_count;
    uint32_t vertices, triangles, wanted[9];
    uint32_t edges, ends[8];
} MODES[] = {
    {4, {2, 1, 0, 0, 3, 2, 1}, 7, 4, 2, {2, 1, 0, 0, 3, 2}, 0, {0}}, /* the seventh corner is no triangle */
    {5, {0, 1, 2, 3}, 4, 4, 2, {0, 1, 2, 2, 1, 3}, 0, {0}},
    {5, {0, 1, 2, 2, 3, 0}, 6, 4, 2, {0, 1, 2, 3, 2, 0}, 0, {0}}, /* the turn of the strip has no area */
    {6, {0, 1, 2, 3}, 4, 4, 2, {0, 1, 2, 0, 2, 3}, 0, {0}},
    {4, {1, 2, 3}, 3, 3, 1, {0, 1, 2}, 0, {0}}, /* vertex 0 is not used */
    {1, {0, 1, 2, 3}, 4, 4, 0, {0}, 2, {0, 1, 2, 3}},
    {2, {0, 1, 2}, 3, 3, 0, {0}, 3, {0, 1, 1, 2, 2, 0}},
    {3, {0, 1, 2}, 3, 3, 0, {0}, 2, {0, 1, 1, 2}},
};

START_TEST(primitives_of_all_modes_become_triangles_and_edges)
{
    char rest[512];
    sph_animation *a;
    glb_floats(&file, "VEC3", 4, SQUARE);
    glb_numbers(&file, GLB_U8, "SCALAR", MODES[_i].corner_count, MODES[_i].corners, "");
    snprintf(rest, sizeof rest,
             "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"mode\":%d,\"attributes\":{\"POSITION\":0},"
             "\"indices\":1}]}]",
             MODES[_i].mode);
    options.weld = SPH_IO_WELD_NONE;
    a = open_path(glb_write(&file, "a.glb", rest), MODES[_i].vertices, MODES[_i].triangles);
    check_triangles(a, MODES[_i].wanted);
    ck_assert_uint_eq(sph_animation_edge_count(a), MODES[_i].edges);
    for (size_t i = 0; i < 2 * MODES[_i].edges; ++i)
        ck_assert_uint_eq(sph_animation_edges(a)[i], MODES[_i].ends[i]);
    sph_animation_destroy(a);
}
END_TEST

/* Two primitives side by side share an edge; the second node mirrors its mesh. */
START_TEST(meshes_are_joined_welded_at_seams_and_wound_outward_when_mirrored)
{
    static const double LOWER[3] = {0, 1, 2}, UPPER[3] = {0, 2, 3};
    static const char REST[] = "\"nodes\":[{\"mesh\":0},{\"mesh\":0,\"scale\":[-1,1,1],\"translation\":[9,0,0]}],"
                               "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1},"
                               "{\"attributes\":{\"POSITION\":0},\"indices\":2}]}]";
    static const uint32_t APART[] = {0, 1, 2, 3, 4, 5, 6, 8, 7, 9, 11, 10};
    static const uint32_t WELDED[] = {0, 1, 2, 0, 2, 3, 4, 6, 5, 4, 7, 6};
    sph_animation *a;
    glb_floats(&file, "VEC3", 4, SQUARE);
    glb_numbers(&file, GLB_U16, "SCALAR", 3, LOWER, "");
    glb_numbers(&file, GLB_U32, "SCALAR", 3, UPPER, "");
    options.weld = _i == 0 ? SPH_IO_WELD_NONE : SPH_IO_WELD_AUTO;
    a = open_path(glb_write(&file, "a.glb", REST), _i == 0 ? 12 : 8, 4);
    check_triangles(a, _i == 0 ? APART : WELDED);
    ck_assert_float_eq(xyz[_i == 0 ? 21 : 15], 8); /* the mirrored square's second corner */
    sph_animation_destroy(a);
}
END_TEST

/* --- bytes --- */

static const char ONE_MESH[] =
    "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]";

START_TEST(positions_may_be_small_integers_interleaved_with_other_things)
{
    layout l = {NULL, 0, 0};
    sph_animation *a;
    static const int VALUES[3][3] = {{32767, 0, -32768}, {-32767, 16384, 0}, {0, 0, 0}};
    uint32_t view;
    for (int v = 0; v < 3; ++v) {
        put_little(&l, 0xABCD, 2);
        for (int k = 0; k < 3; ++k)
            put_little(&l, (uint64_t)(int64_t)VALUES[v][k], 2);
        if (v < 2) put_little(&l, 0xEF01, 4); /* the last element need not be followed by a whole stride */
    }
    view = glb_view(&file, l.bytes, l.size, 12);
    layout_free(&l);
    glb_accessor(&file, view, GLB_I16, "VEC3", 3, ",\"byteOffset\":2,\"normalized\":true");
    a = open_path(glb_write(&file, "a.glb", ONE_MESH), 3, 1);
    ck_assert_float_eq(xyz[0], 1);
    ck_assert_float_eq(xyz[2], -1);
    ck_assert_float_eq(xyz[3], -1);
    ck_assert_float_eq_tol(xyz[4], 16384 / 32767.0f, 1e-7f);
    sph_animation_destroy(a);
}
END_TEST

START_TEST(a_sparse_accessor_replaces_elements_of_what_is_below)
{
    static const double INDICES[2] = {0, 2}, VALUES[6] = {5, 6, 7, 8, 9, 10};
    static const float WANTED[9] = {5, 6, 7, 1, 0, 0, 8, 9, 10};
    char more[160];
    sph_animation *a;
    glb_numbers(&file, GLB_U32, "SCALAR", 2, INDICES, "");
    glb_floats(&file, "VEC3", 2, VALUES);
    glb_floats(&file, "VEC3", 4, SQUARE);
    snprintf(more, sizeof more,
             ",\"sparse\":{\"count\":2,\"indices\":{\"bufferView\":0,\"componentType\":5125},"
             "\"values\":{\"bufferView\":1}}");
    glb_accessor(&file, 2, GLB_F32, "VEC3", 3, more);
    a = open_path(
        glb_write(&file, "a.glb",
                  "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":3}}]}]"),
        3, 1);
    for (int i = 0; i < 9; ++i)
        ck_assert_float_eq(xyz[i], WANTED[i]);
    sph_animation_destroy(a);
}
END_TEST

/* The floats 0, 1 and 0.5 again and again. */
START_TEST(buffers_may_be_files_beside_it_or_in_base64)
{
    static const double CORNERS[9] = {0, 1, 0.5, 1, 0.5, 0, 0.5, 0, 1};
    static const char *const URIS[] = {
        "some%20where/my%2Ebin",
        "data:application/octet-stream;base64,AAAAAAAAgD8AAAA/AACAPwAAAD8AAAAAAAAAPwAAAAAAAIA\\/",
        "data:;base64,AAAAAAAAgD8AAAA_AACAPwAAAD8AAAAAAAAAPwAAAAAAAIA_"};
    layout l = {NULL, 0, 0};
    sph_animation *a;
    glb_floats(&file, "VEC3", 3, CORNERS);
    glb_json(&file, ONE_MESH, URIS[_i], &l);
    if (_i == 0) {
        ck_assert_int_eq(mkdir(file_path("some where"), 0700), 0);
        file_write("some where/my.bin", file.binary.bytes, file.binary.size);
    }
    a = open_path(file_write("a.gltf", l.bytes, l.size), 3, 1);
    for (int i = 0; i < 9; ++i)
        ck_assert_float_eq(xyz[i], (float)CORNERS[i]);
    sph_animation_destroy(a);
    layout_free(&l);
}
END_TEST

START_TEST(frames_scale_and_axis_are_chosen_as_for_other_formats)
{
    static const double TIMES[2] = {0, 1}, PLACES[6] = {0, 0, 0, 0, 3, 0};
    sph_animation *a;
    glb_floats(&file, "VEC3", 3, SQUARE);
    glb_floats(&file, "SCALAR", 2, TIMES);
    glb_floats(&file, "VEC3", 2, PLACES);
    options.first_frame = 10;
    options.frame_step = 10;
    options.scale = 2;
    options.up_axis = SPH_UP_Z;
    a = open_path(
        glb_write(&file, "a.glb",
                  "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
                  "\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"translation\"}}],"
                  "\"samplers\":[{\"input\":1,\"output\":2}]}]"),
        3, 1);
    ck_assert_uint_eq(sph_animation_frame_count(a), 3); /* 10, 20 and 30 of 31 */
    for (uint32_t f = 0; f < 3; ++f) {
        ck_assert_int_eq(sph_animation_read_frame(a, f, xyz), SPH_OK);
        ck_assert_float_eq_tol(xyz[0], 0, 1e-6f);
        ck_assert_float_eq_tol(xyz[2], -2 * ((float)f + 1), 1e-5f);
    }
    sph_animation_destroy(a);
}
END_TEST

START_TEST(with_a_cache_a_gltf_is_the_mesh_at_rest)
{
    sph_animation *a;
    glb_floats(&file, "VEC3", 3, SQUARE);
    options.cache_path = write_cache("a.pc2", 3, 4);
    a = open_path(glb_write(&file, "a.glb", ONE_MESH), 3, 1);
    check_frames(context, a, 3, 4, 0, 1);
    sph_animation_destroy(a);
}
END_TEST

/* --- refusals --- */

#define MESH "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]"
#define ZEROS "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA"
#define POSITIONS                                                                                                      \
    "\"buffers\":[{\"byteLength\":48,\"uri\":\"data:;base64," ZEROS ZEROS                                              \
    "\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":48}],"
#define ACCESSOR(more) "\"accessors\":[{\"componentType\":5126,\"type\":\"VEC3\"," more "}]"
#define NODES "\"nodes\":[{\"mesh\":0}]"
#define ASSET "\"asset\":{\"version\":\"2.0\"},"

static const struct {
    const char *json, *message;
    sph_status status;
} REFUSED[] = {
    {"{}", "no asset", SPH_E_FORMAT},
    {"{\"asset\":{\"version\":\"1.0\"}}", "version", SPH_E_UNSUPPORTED},
    {"{\"asset\":{\"version\":\"2.1\",\"minVersion\":\"2.1\"}}", "version", SPH_E_UNSUPPORTED},
    {"{" ASSET "\"extensionsRequired\":[\"KHR_materials_unlit\",\"KHR_draco_mesh_compression\"]}",
     "KHR_draco_mesh_compression", SPH_E_UNSUPPORTED},
    {"{" ASSET "\"extensionsRequired\":[\"EXT_meshopt_compression\"]}", "EXT_meshopt_compression", SPH_E_UNSUPPORTED},
    {"{" ASSET "\"nodes\":[{\"mesh\":0}]}", "index 0 of meshes, of which there are 0", SPH_E_FORMAT},
    {"{" ASSET "\"nodes\":[{\"children\":[1]},{\"children\":[2]},{\"children\":[1]}]}", "node 1 is a child twice",
     SPH_E_FORMAT},
    {"{" ASSET "\"nodes\":[{},{\"children\":[2]},{\"children\":[1]}]}", "node 1 is its own ancestor", SPH_E_FORMAT},
    {"{" ASSET "\"nodes\":[{\"children\":[0]}]}", "node 0 is its own ancestor", SPH_E_FORMAT},
    {"{" ASSET "\"nodes\":[{}],\"scenes\":[{\"nodes\":[0,0]}]}", "in the scene twice", SPH_E_FORMAT},
    {"{" ASSET "\"nodes\":[{}]}", "no triangles", SPH_E_FORMAT},
    {"{" ASSET "\"nodes\":[{\"translation\":[1,2]}]}", "translation has 2 numbers, not 3", SPH_E_FORMAT},
    {"{" ASSET "\"nodes\":[{\"scale\":[1,1,1e39]}]}", "beyond what a float holds", SPH_E_FORMAT},
    {"{" ASSET "\"nodes\":[4]}", "nodes 0 is not an object", SPH_E_FORMAT},
    {"{" ASSET NODES "," MESH "," POSITIONS ACCESSOR("\"count\":5,\"bufferView\":0") "}", "5 elements of 12 bytes",
     SPH_E_FORMAT},
    {"{" ASSET NODES "," MESH "," POSITIONS ACCESSOR("\"count\":9007199254740991,\"bufferView\":0") "}", "elements",
     SPH_E_FORMAT},
    {"{" ASSET NODES "," MESH
     "," POSITIONS ACCESSOR("\"count\":3,\"bufferView\":0,\"byteOffset\":9007199254740991") "}",
     "from byte 9007199254740991", SPH_E_FORMAT},
    {"{" ASSET NODES "," MESH "," POSITIONS ACCESSOR("\"count\":3,\"bufferView\":-1") "}", "index -1 of bufferViews",
     SPH_E_FORMAT},
    {"{" ASSET NODES "," MESH "," POSITIONS ACCESSOR("\"count\":2000000000") "}", "far more memory", SPH_E_LIMIT},
    {"{" ASSET NODES "," MESH
     ",\"buffers\":[{\"byteLength\":48}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":48}]," ACCESSOR(
         "\"count\":3,\"bufferView\":0") "}",
     "buffer 0 has no bytes", SPH_E_FORMAT},
    {"{" ASSET NODES "," MESH ",\"buffers\":[{\"byteLength\":48,\"uri\":\"none.bin\"}],"
     "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48}]," ACCESSOR("\"count\":3,\"bufferView\":0") "}",
     "none.bin: cannot be opened", SPH_E_IO},
    {"{" ASSET NODES "," MESH ",\"buffers\":[{\"byteLength\":48,\"uri\":\"http://x/y.bin\"}],"
     "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48}]," ACCESSOR("\"count\":3,\"bufferView\":0") "}",
     "only files beside it", SPH_E_UNSUPPORTED},
    {"{" ASSET NODES "," MESH ",\"buffers\":[{\"byteLength\":48,\"uri\":\"data:;base64,AAA*\"}],"
     "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48}]," ACCESSOR("\"count\":3,\"bufferView\":0") "}",
     "character 3 of the data: URI", SPH_E_FORMAT},
    {"{" ASSET NODES "," MESH ",\"buffers\":[{\"byteLength\":48,\"uri\":\"data:;base64,AAAA\"}],"
     "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48}]," ACCESSOR("\"count\":3,\"bufferView\":0") "}",
     "buffer 0 of 48 bytes, but there are 3", SPH_E_FORMAT},
    {"{" ASSET "\"nodes\":[{}]}x", "something after the end", SPH_E_FORMAT},
    {"{" ASSET "\"nodes\":[{}]", "not , or }", SPH_E_FORMAT},
};

START_TEST(what_is_wrong_is_refused_by_name_or_byte)
{
    sph_status status;
    ck_assert_ptr_null(open_one(context, file_text("a.gltf", REFUSED[_i].json), NULL, &status));
    ck_assert_msg(strstr(sph_context_last_message(context), REFUSED[_i].message) != NULL, "%s",
                  sph_context_last_message(context));
    ck_assert_int_eq(status, REFUSED[_i].status);
}
END_TEST

START_TEST(a_clip_that_is_not_there_is_refused_with_those_that_are)
{
    static const double TIME[1] = {0}, PLACE[3] = {0};
    sph_status status;
    const char *path;
    glb_floats(&file, "VEC3", 3, SQUARE);
    glb_floats(&file, "SCALAR", 1, TIME);
    glb_floats(&file, "VEC3", 1, PLACE);
    path = glb_write(&file, "a.glb",
                     "\"nodes\":[{\"mesh\":0}]," MESH ",\"animations\":[{\"name\":\"run\",\"channels\":[{\"sampler\":0,"
                     "\"target\":{\"node\":0,\"path\":\"translation\"}}],\"samplers\":[{\"input\":1,\"output\":2}]},"
                     "{\"name\":\"hop\",\"channels\":[],\"samplers\":[]}]");
    options.clip = "jump";
    ck_assert_ptr_null(open_one(context, path, &options, &status));
    ck_assert_int_eq(status, SPH_E_INVALID);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "no clip 'jump': it has run, hop"));
    ck_assert_ptr_null(open_one(context, write_obj("a.obj", 3, 0), &options, &status));
    ck_assert_int_eq(status, SPH_E_INVALID);
    options.clip = NULL;
    options.fps = -1;
    ck_assert_ptr_null(open_one(context, path, &options, &status));
    ck_assert_int_eq(status, SPH_E_INVALID);
}
END_TEST

/* --- levels --- */

/* Its balls lie on the spheres in every frame, and its simplices join their centres. _i: radii per frame. */
START_TEST(a_level_written_as_glb_moves_as_the_level_does)
{
    enum { BALL = 294, SPHERES = 3, FRAMES = 2 };
    static const float CENTERS[] = {0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 1, 2, 0.5f, 0, 0, 3, -1};
    static const float RADII[] = {1, 0.25f, 0.5f, 2, 0.125f, 0.75f};
    static const uint32_t EDGE[] = {0, 1}, TRIANGLE[] = {0, 1, 2};
    const sph_level_arrays arrays = {sizeof arrays, SPHERES, FRAMES,   _i == 1, CENTERS, RADII, 1,
                                     EDGE,          1,       TRIANGLE, 0,       NULL};
    const char *path = file_path("l.glb");
    sph_level *level;
    sph_animation *a;
    float *all = test_malloc(3 * (BALL * SPHERES + 5), sizeof *all);
    ck_assert_int_eq(sph_level_create_from_arrays(context, &arrays, &level), SPH_OK);
    ck_assert_int_eq(sph_io_save_level(context, level, path), SPH_OK);
    options.weld = SPH_IO_WELD_NONE;
    a = open_one(context, path, &options, &(sph_status){SPH_OK});
    ck_assert_msg(a != NULL, "%s", sph_context_last_message(context));
    ck_assert_uint_eq(sph_animation_vertex_count(a), BALL * SPHERES + 5); /* 3 of the triangle, 2 of the edge */
    ck_assert_uint_eq(sph_animation_edge_count(a), 1);
    ck_assert_uint_eq(sph_animation_frame_count(a), FRAMES);
    for (uint32_t f = 0; f < FRAMES; ++f) {
        const float *c = CENTERS + (size_t)f * 3 * SPHERES, *r = RADII + (_i == 1 ? f * SPHERES : 0);
        ck_assert_int_eq(sph_animation_read_frame(a, f, all), SPH_OK);
        for (uint32_t v = 0; v < BALL * SPHERES; ++v) {
            double square = 0;
            for (int k = 0; k < 3; ++k) {
                const double d = (double)all[3 * v + k] - (double)c[3 * (v / BALL) + k];
                square += d * d;
            }
            ck_assert_double_eq_tol(square, (double)r[v / BALL] * (double)r[v / BALL], 1e-5);
        }
        for (uint32_t i = 0; i < 15; ++i)
            ck_assert_float_eq_tol(all[3 * BALL * SPHERES + i], c[i < 9 ? i : i - 9], 1e-6f);
    }
    sph_animation_destroy(a);
    sph_level_destroy(level);
    free(all);
}
END_TEST

int main(void)
{
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, primitives_of_all_modes_become_triangles_and_edges, 0, (int)(sizeof MODES / sizeof *MODES));
    tcase_add_loop_test(tc, meshes_are_joined_welded_at_seams_and_wound_outward_when_mirrored, 0, 2);
    tcase_add_test(tc, positions_may_be_small_integers_interleaved_with_other_things);
    tcase_add_test(tc, a_sparse_accessor_replaces_elements_of_what_is_below);
    tcase_add_loop_test(tc, buffers_may_be_files_beside_it_or_in_base64, 0, 3);
    tcase_add_test(tc, frames_scale_and_axis_are_chosen_as_for_other_formats);
    tcase_add_test(tc, with_a_cache_a_gltf_is_the_mesh_at_rest);
    tcase_add_loop_test(tc, what_is_wrong_is_refused_by_name_or_byte, 0, (int)(sizeof REFUSED / sizeof *REFUSED));
    tcase_add_test(tc, a_clip_that_is_not_there_is_refused_with_those_that_are);
    tcase_add_loop_test(tc, a_level_written_as_glb_moves_as_the_level_does, 0, 2);
    return run_suite(suite_create("io glTF files"), tc);
}
