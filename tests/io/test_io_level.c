/* SPDX-License-Identifier: MIT */
/* Levels as files: JSON against Jansson, .sphm against its documented bytes, and that files are whole or not there. */
#include <check.h>
#include <jansson.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

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

START_TEST(a_level_as_obj_has_its_first_frame_and_its_simplices)
{
    static const float CENTERS[] = {0, 0, 0, 1.5f, 0, 0, 0, 0.1f, 0, 9, 9, 9, 9, 9, 9, 9, 9, 9},
                       RADII[] = {1, 0.25f, 0};
    static const uint32_t EDGE[] = {2, 0}, TRIANGLE[] = {0, 1, 2};
    const sph_level_arrays a = {sizeof a, 3, 2, 0, CENTERS, RADII, 1, EDGE, 1, TRIANGLE, 0, NULL};
    const char *path = file_path("l.obj");
    sph_level *level;
    unsigned char *text;
    size_t size;
    ck_assert_int_eq(sph_level_create_from_arrays(context, &a, &level), SPH_OK);
    ck_assert_int_eq(sph_io_save_level(context, level, path), SPH_OK);
    text = file_read(path, &size);
    ck_assert_str_eq((const char *)text, "# a sphere-mesh: 3 spheres, frame 0 of 2\nv 0 0 0 # radius 1\n"
                                         "v 1.5 0 0 # radius 0.25\nv 0 0.1 0 # radius 0\nf 1 2 3\nl 3 1\n");
    free(text);
    sph_level_destroy(level);
}
END_TEST

START_TEST(other_endings_are_refused)
{
    sph_level *level = make_level(3, 1, 0, true), *back;
    int32_t kind = 77;
    static const char *const NAMES[] = {"l.ply", "l", "json", "l.json.gz", "l.glb"};
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
    bytes[12] = 3;
    ck_assert_int_eq(sph_io_identify(context, file_write("3.sphm", bytes, size), &kind), SPH_E_FORMAT);
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

/* --- files that are whole or not there --- */

START_TEST(a_folder_that_is_not_there_is_named_and_nothing_is_left)
{
    sph_level *level = make_level(3, 1, 0, true);
    ck_assert_int_eq(sph_io_save_level(context, level, file_path("none/l.json")), SPH_E_IO);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "none/l.json: cannot be written: No such file"));
    ck_assert_int_eq(sph_io_save_level(context, level, ""), SPH_E_UNSUPPORTED);
    ck_assert_uint_eq(file_count(), 0);
    sph_level_destroy(level);
}
END_TEST

START_TEST(what_is_no_file_is_not_replaced)
{
    sph_level *level = make_level(3, 1, 0, true);
    struct stat found;
    ck_assert_int_eq(mkdir(file_path("d.json"), 0777), 0);
    ck_assert_int_eq(sph_io_save_level(context, level, file_path("d.json")), SPH_E_IO);
    ck_assert_int_eq(mkfifo(file_path("p.json"), 0666), 0);
    ck_assert_int_eq(sph_io_save_level(context, level, file_path("p.json")), SPH_E_IO);
    ck_assert_int_eq(stat(file_path("p.json"), &found), 0);
    ck_assert(S_ISFIFO(found.st_mode));
    ck_assert_uint_eq(file_count(), 2);
    sph_level_destroy(level);
}
END_TEST

START_TEST(a_link_stays_and_what_it_points_to_is_replaced_with_its_mode)
{
    sph_level *level = make_level(3, 1, 0, true), *back = NULL;
    const char *target = file_text("target.json", "old"), *link = file_path("link.json");
    struct stat found;
    ck_assert_int_eq(chmod(target, 0640), 0);
    ck_assert_int_eq(symlink("target.json", link), 0);
    ck_assert_int_eq(sph_io_save_level(context, level, link), SPH_OK);
    ck_assert_int_eq(lstat(link, &found), 0);
    ck_assert(S_ISLNK(found.st_mode));
    ck_assert_int_eq(stat(target, &found), 0);
    ck_assert_int_eq(found.st_mode & 0777, 0640);
    ck_assert_int_eq(sph_io_load_level(context, target, &back), SPH_OK);
    ck_assert_uint_eq(file_count(), 2);
    sph_level_destroy(back);
    sph_level_destroy(level);
}
END_TEST

/* A frame source that fails halfway: both files of before are as they were. */
START_TEST(a_failing_source_leaves_the_old_files_and_no_other)
{
    sph_animation *inner = test_sphere(context, 2, 5), *animation;
    test_source source = {.from = inner, .fail_at = (size_t)_i + 1, .failure = SPH_E_IO};
    unsigned char *text;
    size_t size;
    file_text("a.obj", "old obj");
    file_text("a.pc2", "old pc2");
    animation = test_pulled(context, &source);
    ck_assert_int_eq(sph_io_save_obj_pc2(context, animation, 0, 1, file_path("a.obj"), file_path("a.pc2")), SPH_E_IO);
    text = file_read(file_path("a.obj"), &size);
    ck_assert_str_eq((const char *)text, "old obj");
    free(text);
    text = file_read(file_path("a.pc2"), &size);
    ck_assert_str_eq((const char *)text, "old pc2");
    free(text);
    ck_assert_uint_eq(file_count(), 2);
    sph_animation_destroy(animation);
    sph_animation_destroy(inner);
}
END_TEST

/* RLIMIT_FSIZE makes writing fail after so many bytes, as a full disk does. */
START_TEST(a_disk_that_is_full_after_any_number_of_bytes_leaves_the_old_files)
{
    sph_animation *animation = test_sphere(context, 3, 5); /* 642 vertices: 38 KB and more than one buffer of OBJ */
    const struct rlimit limit = {(rlim_t)_i * 8192, RLIM_INFINITY};
    unsigned char *text;
    size_t size;
    sph_status status;
    file_text("a.obj", "old obj");
    file_text("a.pc2", "old pc2");
    signal(SIGXFSZ, SIG_IGN); /* each test has a process of its own */
    ck_assert_int_eq(setrlimit(RLIMIT_FSIZE, &limit), 0);
    status = sph_io_save_obj_pc2(context, animation, 0, 1, file_path("a.obj"), file_path("a.pc2"));
    ck_assert_int_eq(status, SPH_E_IO);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "cannot be written: File too large"));
    text = file_read(file_path("a.obj"), &size);
    ck_assert_str_eq((const char *)text, "old obj");
    free(text);
    text = file_read(file_path("a.pc2"), &size);
    ck_assert_str_eq((const char *)text, "old pc2");
    free(text);
    ck_assert_uint_eq(file_count(), 2);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(saving_may_be_cancelled_at_any_frame)
{
    test_progress progress = {.cancel_at = (size_t)_i + 1};
    sph_context *own = test_context_with_progress(test_progress_callback, &progress);
    sph_animation *animation = test_sphere(own, 1, 4);
    ck_assert_int_eq(sph_io_save_obj_pc2(own, animation, 0, 1, file_path("a.obj"), file_path("a.pc2")),
                     SPH_E_CANCELLED);
    ck_assert_uint_eq(file_count(), 0);
    ck_assert(!progress.fell);
    sph_animation_destroy(animation);
    sph_context_destroy(own);
}
END_TEST

START_TEST(an_animation_comes_back_from_obj_and_pc2_with_the_same_bits)
{
    sph_animation *animation = test_torus(context, 12, 8, 5), *back;
    const char *obj = file_path("a.obj"), *pc2 = file_path("a.pc2");
    const uint32_t n = sph_animation_vertex_count(animation), edges[] = {0, 5, 7, 2};
    float *a = test_malloc(3 * n, sizeof *a), *b = test_malloc(3 * n, sizeof *b);
    unsigned char *bytes;
    layout head = {NULL, 0, 0};
    size_t size;
    sph_io_open_options options;
    sph_status status;
    ck_assert_int_eq(sph_animation_set_edges(animation, edges, 2, 0), SPH_OK);
    ck_assert_int_eq(sph_io_save_obj_pc2(context, animation, 3, 0.5, obj, pc2), SPH_OK);
    ck_assert_uint_eq(file_count(), 2);
    sph_io_open_options_init(&options, sizeof options);
    for (int with_cache = 0; with_cache < 2; ++with_cache) {
        options.cache_path = with_cache ? pc2 : NULL;
        back = open_one(context, obj, &options, &status);
        ck_assert_int_eq(status, SPH_OK);
        ck_assert_uint_eq(sph_animation_frame_count(back), with_cache ? 5 : 1);
        for (uint32_t f = 0; f < (with_cache ? 5U : 1U); ++f) {
            ck_assert_int_eq(sph_animation_read_frame(animation, f, a), SPH_OK);
            ck_assert_int_eq(sph_animation_read_frame(back, f, b), SPH_OK);
            ck_assert_mem_eq(a, b, 3 * n * sizeof *a);
        }
        ck_assert_uint_eq(sph_animation_triangle_count(back), sph_animation_triangle_count(animation));
        ck_assert_mem_eq(sph_animation_triangles(back), sph_animation_triangles(animation),
                         12 * sph_animation_triangle_count(animation));
        ck_assert_uint_eq(sph_animation_edge_count(back), 2);
        ck_assert_mem_eq(sph_animation_edges(back), edges, sizeof edges);
        sph_animation_destroy(back);
    }
    put_bytes(&head, "POINTCACHE2\0\1\0\0\0", 16);
    put_little(&head, n, 4);
    put_little_float(&head, 3);
    put_little_float(&head, 0.5f);
    put_little(&head, 5, 4);
    bytes = file_read(pc2, &size);
    ck_assert_uint_eq(size, 32 + 5 * 12 * (size_t)n);
    ck_assert_mem_eq(bytes, head.bytes, 32);
    free(bytes);
    free(a);
    free(b);
    layout_free(&head);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(arguments_are_checked)
{
    sph_level *level = make_level(3, 1, 0, true), *back = level;
    sph_animation *animation = test_cube(context, 1);
    const char *path = file_path("x.json"), *other = file_path("y.json");
    int32_t kind;
    ck_assert_int_eq(sph_io_save_level(NULL, level, path), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_level(context, NULL, path), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_level(context, level, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_load_level(NULL, path, &back), SPH_E_INVALID);
    ck_assert_ptr_null(back);
    ck_assert_int_eq(sph_io_load_level(context, NULL, &back), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_load_level(context, path, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_identify(context, path, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_identify(NULL, path, &kind), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_pc2(NULL, animation, 0, 1, path, other), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_pc2(context, NULL, 0, 1, path, other), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_pc2(context, animation, 0, 1, NULL, other), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_pc2(context, animation, 0, 1, path, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_pc2(context, animation, 0, 1, path, path), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_pc2(context, animation, NAN, 1, path, other), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_pc2(context, animation, 1e300, 1, path, other), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_pc2(context, animation, 0, 0, path, other), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_pc2(context, animation, 0, -1, path, other), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_save_obj_pc2(context, animation, 0, INFINITY, path, other), SPH_E_INVALID);
    ck_assert_uint_eq(file_count(), 0);
    sph_animation_destroy(animation);
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
    tcase_add_test(tc, a_level_as_obj_has_its_first_frame_and_its_simplices);
    tcase_add_test(tc, other_endings_are_refused);
    tcase_add_test(tc, a_sphm_file_tells_what_it_holds);
    tcase_add_test(tc, a_sphm_level_has_the_documented_bytes);
    tcase_add_test(tc, a_folder_that_is_not_there_is_named_and_nothing_is_left);
    tcase_add_test(tc, what_is_no_file_is_not_replaced);
    tcase_add_test(tc, a_link_stays_and_what_it_points_to_is_replaced_with_its_mode);
    tcase_add_loop_test(tc, a_failing_source_leaves_the_old_files_and_no_other, 0, 5);
    tcase_add_loop_test(tc, a_disk_that_is_full_after_any_number_of_bytes_leaves_the_old_files, 0, 5);
    tcase_add_loop_test(tc, saving_may_be_cancelled_at_any_frame, 0, 4);
    tcase_add_test(tc, an_animation_comes_back_from_obj_and_pc2_with_the_same_bits);
    tcase_add_test(tc, arguments_are_checked);
    return run_suite(suite_create("io levels and writers"), tc);
}
