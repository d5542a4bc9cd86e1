/* SPDX-License-Identifier: MIT */
/* Levels as files: JSON against Jansson, .sphm against its documented bytes. */
#include <check.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "files.h"
#include "runner.h"
#include "support.h"

static sph_context *context;

static void setup(void)
{
    context = test_context();
    files_setup();
}

static void teardown(void)
{
    files_teardown();
    sph_context_destroy(context);
}

/* A level with values that are hard to print. */
static sph_level *make_level(uint32_t spheres, uint32_t frames, uint32_t per_frame, bool simplices)
{
    static const float HARD[] = {0.1f, 1.0f / 3, 16777216, 3.4028235e38f, 1e-45f, 1.17549435e-38f, 123456.789f, 5e-5f};
    static const uint32_t EDGES[] = {0, 1, 2, 0}, TRIANGLES[] = {0, 1, 2, 2, 1, 0}, LABELS[] = {0, SPH_NO_SPHERE, 2, 1};
    float *centers = test_malloc((size_t)spheres * frames * 3, sizeof *centers);
    float *radii = test_malloc((size_t)spheres * frames, sizeof *radii);
    uint64_t state = 7;
    sph_level *level = NULL;
    sph_level_arrays a = {.struct_size = sizeof a,
                          .sphere_count = spheres,
                          .frame_count = frames,
                          .radii_per_frame = per_frame,
                          .centers = centers,
                          .radii = radii};
    for (size_t i = 0; i < (size_t)spheres * frames * 3; ++i)
        centers[i] = i < 16 ? HARD[i % 8] * (i < 8 ? 1.0f : -1.0f) : (float)test_random_unit(&state);
    for (size_t i = 0; i < (size_t)spheres * frames; ++i)
        radii[i] = (float)test_random_unit(&state);
    if (simplices) {
        a.edge_count = 2;
        a.edges = EDGES;
        a.triangle_count = 2;
        a.triangles = TRIANGLES;
        a.label_count = 4;
        a.labels = LABELS;
    }
    ck_assert_int_eq(sph_level_create_from_arrays(context, &a, &level), SPH_OK);
    free(centers);
    free(radii);
    return level;
}

static sph_level_arrays arrays_of(const sph_level *level)
{
    sph_level_arrays a = {.struct_size = sizeof a};
    ck_assert_int_eq(sph_level_get_arrays(level, &a), SPH_OK);
    return a;
}

static void check_equal(const sph_level *x, const sph_level *y)
{
    const sph_level_arrays a = arrays_of(x), b = arrays_of(y);
    ck_assert_uint_eq(a.sphere_count, b.sphere_count);
    ck_assert_uint_eq(a.frame_count, b.frame_count);
    ck_assert_uint_eq(a.radii_per_frame, b.radii_per_frame);
    ck_assert_uint_eq(a.edge_count, b.edge_count);
    ck_assert_uint_eq(a.triangle_count, b.triangle_count);
    ck_assert_uint_eq(a.label_count, b.label_count);
    ck_assert_mem_eq(a.centers, b.centers, sizeof(float) * 3 * a.sphere_count * a.frame_count);
    ck_assert_mem_eq(a.radii, b.radii, sizeof(float) * a.sphere_count * (a.radii_per_frame ? a.frame_count : 1));
    ck_assert_mem_eq(a.edges, b.edges, a.edge_count * 8);
    ck_assert_mem_eq(a.triangles, b.triangles, a.triangle_count * 12);
    if (a.label_count != 0) ck_assert_mem_eq(a.labels, b.labels, a.label_count * 4);
}

START_TEST(a_level_comes_back_with_the_same_bits)
{
    const char *const endings[] = {"l.json", "l.sphm", "l.JSON", "l.SPHM"};
    sph_level *level = make_level(_i & 8 ? 1 : 5, _i & 8 ? 1 : 4, (_i & 4) != 0, !(_i & 8)), *back = NULL;
    const char *path = file_path(endings[_i & 3]);
    ck_assert_int_eq(sph_io_save_level(context, level, path), SPH_OK);
    ck_assert_msg(sph_io_load_level(context, path, &back) == SPH_OK, "%s", sph_context_last_message(context));
    check_equal(level, back);
    ck_assert_uint_eq(file_count(), 1); /* no other file was left */
    sph_level_destroy(back);
    sph_level_destroy(level);
}
END_TEST

static void check_numbers(const json_t *list, const float *values, size_t count)
{
    ck_assert_uint_eq(json_array_size(list), count);
    for (size_t i = 0; i < count; ++i)
        ck_assert_float_eq((float)json_number_value(json_array_get(list, i)), values[i]);
}

static void check_simplices(const json_t *list, const uint32_t *indices, size_t count, size_t corners)
{
    ck_assert_uint_eq(json_array_size(list), count);
    for (size_t i = 0; i < count * corners; ++i)
        ck_assert_int_eq(json_integer_value(json_array_get(json_array_get(list, i / corners), i % corners)),
                         indices[i]);
}

START_TEST(jansson_reads_the_json_that_is_written)
{
    sph_level *level = make_level(5, 4, (uint32_t)_i, true);
    const sph_level_arrays a = arrays_of(level);
    const char *path = file_path("l.json");
    json_error_t error;
    json_t *root;
    ck_assert_int_eq(sph_io_save_level(context, level, path), SPH_OK);
    root = json_load_file(path, JSON_REJECT_DUPLICATES, &error);
    ck_assert_msg(root != NULL, "%d: %s", error.position, error.text);
    ck_assert_str_eq(json_string_value(json_object_get(root, "format")), "sphmesh-level");
    ck_assert_int_eq(json_integer_value(json_object_get(root, "version")), 1);
    ck_assert_int_eq(json_integer_value(json_object_get(root, "frames")), 4);
    ck_assert_int_eq(json_integer_value(json_object_get(root, "spheres")), 5);
    ck_assert_uint_eq(json_array_size(json_object_get(root, "centers")), 4);
    for (size_t f = 0; f < 4; ++f) {
        const json_t *frame = json_array_get(json_object_get(root, "centers"), f);
        ck_assert_uint_eq(json_array_size(frame), 5);
        for (size_t i = 0; i < 5; ++i)
            check_numbers(json_array_get(frame, i), a.centers + 3 * (5 * f + i), 3);
        if (_i == 1) check_numbers(json_array_get(json_object_get(root, "radii"), f), a.radii + 5 * f, 5);
    }
    if (_i == 0) check_numbers(json_object_get(root, "radii"), a.radii, 5);
    check_simplices(json_object_get(root, "edges"), a.edges, 2, 2);
    check_simplices(json_object_get(root, "triangles"), a.triangles, 2, 3);
    ck_assert_uint_eq(json_array_size(json_object_get(root, "labels")), 4);
    ck_assert_int_eq(json_integer_value(json_array_get(json_object_get(root, "labels"), 1)), -1);
    ck_assert_int_eq(json_integer_value(json_array_get(json_object_get(root, "labels"), 2)), 2);
    json_decref(root);
    sph_level_destroy(level);
}
END_TEST

/* Jansson's own writing, in whatever form it likes. */
START_TEST(json_that_jansson_writes_is_read)
{
    static const size_t FORMS[] = {JSON_INDENT(3), JSON_COMPACT, JSON_SORT_KEYS | JSON_ENSURE_ASCII,
                                   JSON_REAL_PRECISION(9) | JSON_PRESERVE_ORDER};
    sph_level *level = make_level(5, 4, 1, true), *back = NULL;
    const char *path = file_path("l.json");
    json_t *root;
    ck_assert_int_eq(sph_io_save_level(context, level, path), SPH_OK);
    root = json_load_file(path, 0, NULL);
    json_object_set_new(root, "note: \"caf\u00e9\"", json_pack("{s:[n,b,s,{}],s:f}", "a\\\n", 1, "\u20ac", "x", 1.5));
    ck_assert_int_eq(json_dump_file(root, path, FORMS[_i]), 0);
    json_decref(root);
    ck_assert_msg(sph_io_load_level(context, path, &back) == SPH_OK, "%s", sph_context_last_message(context));
    check_equal(level, back);
    sph_level_destroy(back);
    sph_level_destroy(level);
}
END_TEST

#define HEAD "{\"format\":\"sphmesh-level\",\"version\":1,\"frames\":1,\"spheres\":2"
#define BODY ",\"radii\":[1,2],\"centers\":[[[0,0,0],[1,1,1]]]"

START_TEST(the_least_json_is_enough)
{
    sph_level *level = NULL;
    const char *path = file_text("a.json", " \n" HEAD BODY "}\r\n\t ");
    ck_assert_msg(sph_io_load_level(context, path, &level) == SPH_OK, "%s", sph_context_last_message(context));
    ck_assert_uint_eq(sph_level_sphere_count(level), 2);
    sph_level_destroy(level);
}
END_TEST

static const struct {
    const char *text;
    sph_status status;
    const char *message;
} BAD[] = {
    {"", SPH_E_FORMAT, "byte 0: not a JSON object"},
    {"[]", SPH_E_FORMAT, "byte 0: not a JSON object"},
    {"{}", SPH_E_FORMAT, "no \"format\""},
    {HEAD BODY, SPH_E_FORMAT, "not , or }"},
    {HEAD BODY "} x", SPH_E_FORMAT, "more after the end"},
    {HEAD BODY ",}", SPH_E_FORMAT, "not a string"},
    {HEAD "}", SPH_E_FORMAT, "no \"radii\""},
    {HEAD BODY ",\"frames\":1}", SPH_E_FORMAT, "a field that was there before"},
    {"{\"format\":\"other\"}", SPH_E_FORMAT, "the format is not sphmesh-level"},
    {"{\"format\":\"sphmesh-level\",\"version\":2}", SPH_E_VERSION, "version 2 of the format, only 1"},
    {"{\"version\":1.5}", SPH_E_FORMAT, "not an integer"},
    {"{\"frames\":99999999999999999999}", SPH_E_FORMAT, "not an integer, or too large"},
    {"{\"version\":0}", SPH_E_FORMAT, "not a version"},
    {HEAD ",\"radii\":[1],\"centers\":[[[0,0,0],[1,1,1]]]}", SPH_E_FORMAT, "1 radii in a frame, not 2"},
    {HEAD ",\"radii\":[[1,2],[1,2]],\"centers\":[[[0,0,0],[1,1,1]]]}", SPH_E_FORMAT, "2 frames of radii, not 1"},
    {HEAD ",\"radii\":[[1,2],[1]],\"centers\":[]}", SPH_E_FORMAT, "frames with different numbers of radii"},
    {HEAD ",\"radii\":[1,[2]],\"centers\":[]}", SPH_E_FORMAT, "radii with and without frames"},
    {HEAD ",\"radii\":[[1],2],\"centers\":[]}", SPH_E_FORMAT, "radii with and without frames"},
    {HEAD ",\"radii\":[1,2],\"centers\":[]}", SPH_E_FORMAT, "0 frames of centres, not 1"},
    {HEAD ",\"radii\":[1,2],\"centers\":[[[0,0,0]]]}", SPH_E_FORMAT, "1 centres in a frame, not 2"},
    {HEAD ",\"radii\":[1,2],\"centers\":[[[0,0]]]}", SPH_E_FORMAT, "a centre without 3 coordinates"},
    {HEAD ",\"radii\":[1,2],\"centers\":[[[0,0,0]],[]]}", SPH_E_FORMAT, "frames with different numbers of centres"},
    {HEAD ",\"radii\":[1,1e39]}", SPH_E_FORMAT, "a number that a float cannot hold"},
    {HEAD ",\"radii\":[1,NaN]}", SPH_E_FORMAT, "not a number"},
    {HEAD ",\"radii\":[01]}", SPH_E_FORMAT, "not a number"},
    {HEAD ",\"radii\":[1.]}", SPH_E_FORMAT, "not a number"},
    {HEAD ",\"radii\":[.5]}", SPH_E_FORMAT, "not a number"},
    {HEAD ",\"radii\":[1e]}", SPH_E_FORMAT, "not a number"},
    {HEAD ",\"radii\":[+1]}", SPH_E_FORMAT, "not a number"},
    {HEAD ",\"radii\":[-]}", SPH_E_FORMAT, "not a number"},
    {HEAD ",\"radii\":[-1,1],\"centers\":[[[0,0,0],[1,1,1]]]}", SPH_E_FORMAT, "radius of sphere 0"},
    {HEAD BODY ",\"edges\":[[0,1,1]]}", SPH_E_FORMAT, "an edge without 2 ends"},
    {HEAD BODY ",\"edges\":[[0,2]]}", SPH_E_FORMAT, "edge 0 names sphere 2 of 2"},
    {HEAD BODY ",\"edges\":[[0,-1]]}", SPH_E_FORMAT, "an index out of range"},
    {HEAD BODY ",\"edges\":[[0,4294967296]]}", SPH_E_FORMAT, "an index out of range"},
    {HEAD BODY ",\"triangles\":[[0,1]]}", SPH_E_FORMAT, "a triangle without 3 corners"},
    {HEAD BODY ",\"triangles\":[[0,1,5]]}", SPH_E_FORMAT, "triangle 0 names sphere 5"},
    {HEAD BODY ",\"labels\":[0,2]}", SPH_E_FORMAT, "label 1 names sphere 2"},
    {HEAD BODY ",\"labels\":[-2]}", SPH_E_FORMAT, "an index out of range"},
    {HEAD BODY ",\"labels\":[4294967295]}", SPH_E_FORMAT, "an index out of range"},
    {HEAD BODY ",\"x\":\"\\q\"}", SPH_E_FORMAT, "not an escape"},
    {HEAD BODY ",\"x\":\"\\u12g4\"}", SPH_E_FORMAT, "not an escape"},
    {HEAD BODY ",\"x\":\"\n\"}", SPH_E_FORMAT, "a control character"},
    {HEAD BODY ",\"x\":\"", SPH_E_FORMAT, "a string without an end"},
    {HEAD BODY ",\"x\":tru}", SPH_E_FORMAT, "not a value"},
    {HEAD BODY ",\"x\"}", SPH_E_FORMAT, "not :"},
    {"{\"frames\":0,\"format\":\"sphmesh-level\",\"version\":1,\"spheres\":1,\"radii\":[],\"centers\":[]}",
     SPH_E_FORMAT, "0 frames of 1 spheres"},
    {"{\"frames\":4294967295,\"format\":\"sphmesh-level\",\"version\":1,\"spheres\":4294967295,\"radii\":[],"
     "\"centers\":[]}",
     SPH_E_FORMAT, "0 frames of centres, not 4294967295"},
};

START_TEST(wrong_json_is_refused_with_what_and_where)
{
    sph_level *level = (sph_level *)&context;
    const char *path = file_text("a.json", BAD[_i].text);
    ck_assert_int_eq(sph_io_load_level(context, path, &level), BAD[_i].status);
    ck_assert_ptr_null(level);
    ck_assert_msg(strstr(sph_context_last_message(context), BAD[_i].message) != NULL, "«%s», not «%s»",
                  sph_context_last_message(context), BAD[_i].message);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "a.json"));
}
END_TEST

START_TEST(nesting_without_end_is_refused)
{
    layout l = {NULL, 0, 0};
    sph_level *level;
    put_bytes(&l, "{\"x\":", 5);
    for (int i = 0; i < 1000000; ++i)
        put_bytes(&l, _i == 0 ? "[" : "{\"a\":", _i == 0 ? 1 : 5);
    ck_assert_int_eq(sph_io_load_level(context, file_write("a.json", l.bytes, l.size), &level), SPH_E_FORMAT);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "nested too deep"));
    layout_free(&l);
}
END_TEST

START_TEST(a_level_as_a_mesh_has_its_first_frame_and_its_simplices)
{
    static const char *const TEXTS[] = {
        "# a sphere-mesh: 3 spheres, frame 0 of 2\nv 0 0 0 # radius 1\n"
        "v 1.5 0 0 # radius 0.25\nv 0 0.1 0 # radius 0\nf 1 2 3\nl 3 1\n",
        "ply\nformat ascii 1.0\ncomment a sphere-mesh: 3 spheres, frame 0 of 2\nelement vertex 3\nproperty float x\n"
        "property float y\nproperty float z\nproperty float radius\nelement face 1\nproperty list uchar int "
        "vertex_indices\nelement edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n0 0 0 1\n1.5 0 0 "
        "0.25\n0 0.1 0 0\n3 0 1 2\n2 0\n"};
    static const float CENTERS[] = {0, 0, 0, 1.5f, 0, 0, 0, 0.1f, 0, 9, 9, 9, 9, 9, 9, 9, 9, 9},
                       RADII[] = {1, 0.25f, 0};
    static const uint32_t EDGE[] = {2, 0}, TRIANGLE[] = {0, 1, 2};
    const sph_level_arrays a = {sizeof a, 3, 2, 0, CENTERS, RADII, 1, EDGE, 1, TRIANGLE, 0, NULL};
    const char *path = file_path(_i == 0 ? "l.obj" : "l.ply");
    sph_level *level;
    unsigned char *text;
    size_t size;
    ck_assert_int_eq(sph_level_create_from_arrays(context, &a, &level), SPH_OK);
    ck_assert_int_eq(sph_io_save_level(context, level, path), SPH_OK);
    text = file_read(path, &size);
    ck_assert_str_eq((const char *)text, TEXTS[_i]);
    free(text);
    sph_level_destroy(level);
}
END_TEST

START_TEST(other_endings_are_refused)
{
    sph_level *level = make_level(3, 1, 0, true), *back;
    int32_t kind = 77;
    static const char *const NAMES[] = {"l.off", "l", "json", "l.json.gz", "l.gltf"};
    for (size_t i = 0; i < 5; ++i) {
        ck_assert_int_eq(sph_io_save_level(context, level, file_path(NAMES[i])), SPH_E_UNSUPPORTED);
        ck_assert_int_eq(sph_io_load_level(context, file_text(NAMES[i], "x"), &back), SPH_E_UNSUPPORTED);
    }
    ck_assert_int_eq(sph_io_load_level(context, file_text("l.sphm", "{}"), &back), SPH_E_FORMAT);
    ck_assert_int_eq(sph_io_identify(context, file_text("l.sphm", "{}"), &kind), SPH_E_FORMAT);
    ck_assert_int_eq(kind, 77);
    sph_level_destroy(level);
}
END_TEST

START_TEST(a_sphm_file_tells_what_it_holds)
{
    sph_level *level = make_level(3, 2, 0, true);
    const char *path = file_path("l.sphm");
    unsigned char *bytes;
    size_t size;
    int32_t kind = 0;
    ck_assert_int_eq(sph_io_save_level(context, level, path), SPH_OK);
    ck_assert_int_eq(sph_io_identify(context, path, &kind), SPH_OK);
    ck_assert_int_eq(kind, SPH_IO_LEVEL);
    bytes = file_read(path, &size);
    bytes[12] = 4;
    ck_assert_int_eq(sph_io_identify(context, file_write("4.sphm", bytes, size), &kind), SPH_E_FORMAT);
    bytes[12] = 1;
    ck_assert_int_eq(sph_io_identify(context, file_write("1.sphm", bytes, size), &kind), SPH_OK);
    ck_assert_int_eq(kind, SPH_IO_HIERARCHY);
    bytes[8] = 2;
    ck_assert_int_eq(sph_io_identify(context, file_write("v.sphm", bytes, size), &kind), SPH_E_VERSION);
    ck_assert_int_eq(sph_io_identify(context, file_write("s.sphm", bytes, 31), &kind), SPH_E_FORMAT);
    ck_assert_int_eq(sph_io_identify(context, file_path("none.sphm"), &kind), SPH_E_IO);
    free(bytes);
    sph_level_destroy(level);
}
END_TEST

/* docs/formats.md, laid out here by hand; only the checksums are taken from the file. */
START_TEST(a_sphm_level_has_the_documented_bytes)
{
    static const float CENTERS[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, RADII[] = {0.5f, 0.25f};
    static const uint32_t EDGE[] = {0, 1}, LABELS[] = {1, SPH_NO_SPHERE, 0};
    static const uint64_t META[] = {2, 2, 0, 1, 0, 3};
    static const struct {
        const char *name;
        uint64_t size;
    } CHUNKS[] = {{"META", 48}, {"CENT", 48}, {"RADI", 8}, {"EDGE", 8}, {"TRIA", 0}, {"LABL", 12}};
    const sph_level_arrays a = {sizeof a, 2, 2, 0, CENTERS, RADII, 1, EDGE, 0, NULL, 3, LABELS};
    const char *path = file_path("l.sphm");
    layout l = {NULL, 0, 0};
    sph_level *level;
    unsigned char *bytes;
    size_t size;
    uint64_t offset = 32 + 6 * 24; /* a multiple of 16 */
    ck_assert_int_eq(sph_level_create_from_arrays(context, &a, &level), SPH_OK);
    ck_assert_int_eq(sph_io_save_level(context, level, path), SPH_OK);
    bytes = file_read(path, &size);
    put_bytes(&l, "\x89SPH\r\n\x1A\n\1\0\0\0\2\0\0\0", 16);
    put_little(&l, 320, 8);
    put_little(&l, 6, 4);
    put_bytes(&l, bytes + 28, 4);
    for (size_t i = 0; i < 6; ++i) {
        put_bytes(&l, CHUNKS[i].name, 4);
        put_bytes(&l, bytes + l.size, 4);
        put_little(&l, offset, 8);
        put_little(&l, CHUNKS[i].size, 8);
        offset += (CHUNKS[i].size + 15) / 16 * 16;
    }
    for (size_t i = 0; i < 6; ++i)
        put_little(&l, META[i], 8);
    for (size_t i = 0; i < 12; ++i)
        put_little_float(&l, CENTERS[i]);
    put_little_float(&l, 0.5f);
    put_little_float(&l, 0.25f);
    put_little(&l, 0, 8);
    put_little(&l, 0, 4);
    put_little(&l, 1, 4);
    put_little(&l, 0, 8);
    put_little(&l, 1, 4);
    put_little(&l, 0xFFFFFFFF, 4);
    put_little(&l, 0, 4);
    put_little(&l, 0, 4);
    ck_assert_uint_eq(l.size, 320);
    ck_assert_uint_eq(size, 320);
    ck_assert_mem_eq(bytes, l.bytes, 320);
    free(bytes);
    layout_free(&l);
    sph_level_destroy(level);
}
END_TEST

int main(void)
{
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, a_level_comes_back_with_the_same_bits, 0, 16);
    tcase_add_loop_test(tc, jansson_reads_the_json_that_is_written, 0, 2);
    tcase_add_loop_test(tc, json_that_jansson_writes_is_read, 0, 4);
    tcase_add_test(tc, the_least_json_is_enough);
    tcase_add_loop_test(tc, wrong_json_is_refused_with_what_and_where, 0, (int)(sizeof BAD / sizeof *BAD));
    tcase_add_loop_test(tc, nesting_without_end_is_refused, 0, 2);
    tcase_add_loop_test(tc, a_level_as_a_mesh_has_its_first_frame_and_its_simplices, 0, 2);
    tcase_add_test(tc, other_endings_are_refused);
    tcase_add_test(tc, a_sphm_file_tells_what_it_holds);
    tcase_add_test(tc, a_sphm_level_has_the_documented_bytes);
    return run_suite(suite_create("io levels"), tc);
}
