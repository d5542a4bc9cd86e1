/* SPDX-License-Identifier: MIT */
#include <check.h>
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

/* --- text --- */

#define START "ply\nformat ascii 1.0\n"
#define XYZ "property float x\nproperty float y\nproperty float z\n"
#define CORNERS "property list uchar int vertex_indices\n"
#define HEADER START "element vertex 3\n" XYZ "element face 1\n" CORNERS "end_header\n"
#define THREE "0 0 0\n1 0 0\n0 1 0\n"
#define READ "0 0 0, 1 0 0, 0 1 0; f 0 1 2"

static const struct {
    const char *text, *expected;
} GOOD[] = {
    {HEADER THREE "3 0 1 2\n", READ},
    {HEADER THREE "3 0 1 2", READ},
    {HEADER "\n" THREE "  \n\t3\t0  1 2 \n\n", READ},
    {"ply\r\nformat ascii 1.0\r\nelement vertex 3\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\n"
     "element face 1\r\nproperty list uchar int vertex_index\r\nend_header\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n3 0 1 2\r\n",
     READ},
    {"ply\rformat ascii 1.0\relement vertex 1\rproperty float x\rproperty float y\rproperty float z\r"
     "end_header\r1 2 3\r",
     "1 2 3"},
    {START "comment made by hand\nobj_info format none\nelement vertex 1\ncomment element face 7\n" XYZ
           "end_header\n1e0 -2.5 +.5\n",
     "1 -2.5 0.5"},
    {START
     "element vertex 2\nproperty uchar red\nproperty double z\nproperty float confidence\nproperty int y\nproperty "
     "list uchar float w\nproperty short x\nend_header\n255 3 nan 2 2 9 9 1\n0 6.5 x 5 0 4\n",
     "1 2 3, 4 5 6.5"},
    {START "element face 2\n" CORNERS "element vertex 5\n" XYZ "end_header\n4 0 1 2 3\n5 4 3 2 1 0\n" THREE
           "2 2 2\n3 3 3\n",
     "0 0 0, 1 0 0, 0 1 0, 2 2 2, 3 3 3; f 0 1 2, 0 2 3, 4 3 2, 4 2 1, 4 1 0"},
    {START
     "element camera 2\nproperty float view_x\nproperty list uchar int what\nelement nothing 4000\nelement vertex "
     "3\n" XYZ "element edge 2\nproperty uchar red\nproperty int vertex2\nproperty int vertex1\nelement face 1\n"
     "property list uchar float texcoord\n" CORNERS "property uchar flags\nend_header\n1 2 3 4\nanything at all\n" THREE
     "9 1 0\n9 2 1\n2 0.5 0.5 3 0 1 2 7\n",
     READ "; l 0 1, 1 2"},
    {START "element vertex 3\n" XYZ "element edge 1\nproperty int from\nelement face 1\nproperty list float double "
           "vertex_indices\nend_header\n" THREE "8\n3 0 1 2.0\n",
     READ},
    {START "element vertex 1\n" XYZ "element tristrips 0\n" CORNERS "end_header\n1 2 3\nand more\n", "1 2 3"},
    {START "element vertex 1\nproperty float32 x\nproperty float64 y\nproperty int8 z\nend_header\n1 nan inf\n",
     "1 nan inf"},
};

START_TEST(all_that_text_allows_is_read)
{
    check_content(context, file_text("a.ply", GOOD[_i].text), GOOD[_i].expected);
    check_content(context, file_text("named.obj", GOOD[_i].text), GOOD[_i].expected);
}
END_TEST

static const struct {
    const char *text, *message;
} BAD[] = {
    {"", "line 1: not a PLY file"},
    {"plywood\n", "line 1: not a PLY file"},
    {"ply\n", "line 2: the file ends within the header"},
    {"ply\nend_header\n", "line 2: a header without format"},
    {"ply\nelement vertex 1\n", "line 2: the format is missing"},
    {START "format ascii 1.0\nend_header\n", "line 3: the format for a second time"},
    {START "vertex 3\n", "line 3: unknown in a header: \"vertex\""},
    {START "element vertex\n", "line 3: an element without"},
    {START "element vertex -3\n", "line 3: an element without"},
    {START "element vertex 3x\n", "line 3: an element without"},
    {START "element vertex 2147483648\n", "line 3: an element without"},
    {START "element vertex 99999999999999999999999\n", "line 3: an element without"},
    {START "property float x\n", "line 3: a property before any element"},
    {START "element vertex 1\n" XYZ "property int x\n", "line 7: a property that was there before"},
    {START "element vertex 1\n" XYZ "element vertex 1\n", "line 7: an element that was there before"},
    {START "element vertex 1\nproperty float\n", "line 4: a property without a name"},
    {START "element vertex 1\nproperty list uchar float x\n", "line 4: a list where one number belongs"},
    {START "element face 1\nproperty int vertex_index\n", "line 4: corners that are not a list"},
    {START "element vertex 1\nproperty float x\nproperty float y\nend_header\n1 2\n", "vertices without x, y and z"},
    {START "element vertex 1\n" XYZ "element face 1\nproperty int a\nend_header\n1 2 3\n4\n",
     "faces without vertex_ind"},
    {START "element face 0\n" CORNERS "end_header\n", "without vertices"},
    {START "element vertex 0\n" XYZ "end_header\n", "without vertices"},
    {START "end_header\n", "without vertices"},
    {START "element vertex 2000000000\n" XYZ "end_header\n1 2 3\n",
     "its header says 2000000000 of element vertex, for wh"},
    {START "element vertex 1\n" XYZ "element face 3\n" CORNERS "end_header\n1 2 3\n3 0 0 0\n3 0 0 0\n",
     "its header says 3 of element face, for which it is too short"},
    {HEADER "0 0 0\n1 0 0 1\n0 1 0\n3 0 1 2\n", "line 11: more values than the header has properties"},
    {HEADER "0 0 0\n1 0\n0 1 0\n3 0 1 2\n\n\n", "line 11: a vertex with a coordinate that is missing"},
    {HEADER "0 0 0\n1 0 x\n0 1 0\n3 0 1 2\n", "line 11: a vertex with a coordinate that is missing or not a number"},
    {HEADER "0 0 0\n1 0 1,5\n0 1 0\n3 0 1 2\n", "line 11: a vertex with a coordinate"},
    {HEADER THREE "3 0 1 3\n", "line 13: vertex index 3, but there are 3 vertices"},
    {HEADER THREE "3 0 1 -1\n", "line 13: vertex index -1, but"},
    {HEADER THREE "3 0 1 4294967296\n", "line 13: vertex index 4294967296, but"},
    {HEADER THREE "3 0 1 2 0\n", "line 13: more values"},
    {HEADER THREE "4 0 1 2\n", "line 13: a face with fewer vertices"},
    {HEADER THREE "3 0 1 2.5\n", "line 13: a face with fewer vertices than its count says, or with something"},
    {HEADER THREE "2 0 1    \n", "line 13: a face of fewer than 3"},
    {HEADER THREE "-3 0 1 2\n", "line 13: a list without its count"},
    {HEADER THREE "x 0 1 2\n", "line 13: a list without its count"},
    {HEADER "0 0 0\n1 0 0\n0 1.000000000000000000 0\n\n\n", "ends at byte 193, within face 0 of 1"},
    {START "element vertex 3\n" XYZ "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n" THREE
           "1 3\n",
     "line 14: vertex index 3, but"},
    {START "element vertex 1\n" XYZ "property list uchar int a\nend_header\n1 2 3 2 1\n",
     "line 9: a list that is shorter"},
    {START "element vertex 1\n" XYZ "property int a\nend_header\n1 2 3   \n", "line 9: fewer values"},
};

START_TEST(what_is_wrong_in_a_text_is_refused_with_its_line)
{
    check_refused(context, file_text("a.ply", BAD[_i].text), SPH_E_FORMAT, BAD[_i].message);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "a.ply"));
}
END_TEST

START_TEST(what_is_not_read_is_refused_by_name)
{
    check_refused(context, file_text("a.ply", "ply\nformat binary 1.0\n"), SPH_E_UNSUPPORTED, "\"binary\"");
    check_refused(context, file_text("a.ply", "ply\nformat ascii 2.0\n"), SPH_E_UNSUPPORTED, "\"2.0\"");
    check_refused(context, file_text("a.ply", START "element vertex 1\nproperty long x\n"), SPH_E_UNSUPPORTED,
                  "line 4: an unknown type, \"long\"");
    check_refused(context,
                  file_text("a.ply", START "element vertex 1\n" XYZ "element tristrips 1\n" CORNERS
                                           "end_header\n1 2 3\n3 0 0 0\n"),
                  SPH_E_UNSUPPORTED, "triangle strips");
}
END_TEST

/* --- binary --- */

enum { TYPE_COUNT = 8 };
static const struct {
    const char *name;
    unsigned size;
    bool real;
} TYPES[TYPE_COUNT] = {{"char", 1, false}, {"uint8", 1, false},  {"int16", 2, false}, {"ushort", 2, false},
                       {"int", 4, false},  {"uint32", 4, false}, {"float", 4, true},  {"float64", 8, true}};

static void put(layout *l, bool big, unsigned type, double value)
{
    uint64_t bits = (uint64_t)(int64_t)value;
    if (TYPES[type].real && TYPES[type].size == 4) {
        const float single = (float)value;
        uint32_t single_bits;
        memcpy(&single_bits, &single, sizeof single);
        bits = single_bits;
    } else if (TYPES[type].real) {
        memcpy(&bits, &value, sizeof bits);
    }
    if (big)
        put_big(l, bits, TYPES[type].size);
    else
        put_little(l, bits, TYPES[type].size);
}

static void put_text(layout *l, const char *text)
{
    put_bytes(l, text, strlen(text));
}

static const char *write_layout(const char *name, layout *l)
{
    const char *path = file_write(name, l->bytes, l->size);
    layout_free(l);
    return path;
}

/* A triangle and a quadrilateral over four vertices, as binary with these types. */
static layout binary_mesh(bool big, unsigned coordinate_type, unsigned count_type, unsigned index_type,
                          bool faces_first, bool extras)
{
    static const double XYZ_VALUES[4][3] = {{0, 0, 0}, {1, 0, 2}, {0, 1, 100}, {7, 8, 9}};
    static const int FACES[2][5] = {{3, 0, 1, 2, 0}, {4, 3, 2, 1, 0}};
    layout l = {NULL, 0, 0};
    char header[1000];
    snprintf(header, sizeof header, "ply\nformat binary_%s_endian 1.0\ncomment by hand\n", big ? "big" : "little");
    put_text(&l, header);
    for (int part = 0; part < 2; ++part) {
        const bool faces = faces_first == (part == 0);
        const char *c = TYPES[coordinate_type].name;
        if (faces)
            snprintf(header, sizeof header, "element face 2\n%sproperty list %s %s vertex_indices\n",
                     extras ? "property list ushort double texcoord\nproperty uchar flags\n" : "",
                     TYPES[count_type].name, TYPES[index_type].name);
        else
            snprintf(header, sizeof header, "element vertex 4\n%sproperty %s y\nproperty %s x\n%sproperty %s z\n%s",
                     extras ? "property uchar red\n" : "", c, c, extras ? "property double weight\n" : "", c,
                     extras && count_type == 1 ? "property list char short bones\n" : "");
        put_text(&l, header);
    }
    put_text(&l, extras ? "element thing 3\nproperty double a\nproperty char b\nelement bag 2\nproperty list int short "
                          "c\nelement edge 1\nproperty ushort vertex1\nproperty float vertex2\nend_header\n"
                        : "end_header\n");
    for (int part = 0; part < 2; ++part) {
        if (faces_first == (part == 0)) {
            for (int f = 0; f < 2; ++f) {
                if (extras) {
                    put(&l, big, 3, 2);
                    put(&l, big, 7, 0.25);
                    put(&l, big, 7, 0.75);
                    put(&l, big, 1, 255);
                }
                put(&l, big, count_type, FACES[f][0]);
                for (int i = 0; i < FACES[f][0]; ++i)
                    put(&l, big, index_type, FACES[f][1 + i]);
            }
            continue;
        }
        for (int v = 0; v < 4; ++v) {
            if (extras) put(&l, big, 1, 200);
            put(&l, big, coordinate_type, XYZ_VALUES[v][1]);
            put(&l, big, coordinate_type, XYZ_VALUES[v][0]);
            if (extras) put(&l, big, 7, 1e300);
            put(&l, big, coordinate_type, XYZ_VALUES[v][2]);
            if (extras && count_type == 1) {
                put(&l, big, 0, v);
                for (int i = 0; i < v; ++i)
                    put(&l, big, 2, -3);
            }
        }
    }
    if (extras) {
        for (int i = 0; i < 27; ++i)
            put(&l, big, 1, 10);
        put(&l, big, 4, 0);
        put(&l, big, 4, 1);
        put(&l, big, 2, 1);
        put(&l, big, 3, 3);
        put(&l, big, 6, 1);
    }
    return l;
}

#define BINARY_READ "0 0 0, 1 0 2, 0 1 100, 7 8 9; f 0 1 2, 3 2 1, 3 1 0"

START_TEST(binary_of_every_type_in_both_byte_orders_is_read)
{
    const bool big = _i / TYPE_COUNT == 1;
    const unsigned type = (unsigned)_i % TYPE_COUNT;
    for (unsigned other = 0; other < TYPE_COUNT; ++other)
        for (unsigned variant = 0; variant < 4; ++variant) {
            layout l = binary_mesh(big, type, other, (type + other) % TYPE_COUNT, variant % 2 == 1, variant / 2 == 1);
            check_content(context, write_layout("a.ply", &l), variant / 2 == 1 ? BINARY_READ "; l 3 1" : BINARY_READ);
        }
}
END_TEST

START_TEST(the_first_byte_of_an_element_may_be_a_line_feed)
{
    static const char *const HEADERS[] = {
        "ply\rformat binary_little_endian 1.0\relement vertex 1\rproperty char x\rproperty char y\rproperty char "
        "z\rend_header\r",
        "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty char x\nproperty char y\nproperty char "
        "z\nend_header\n",
        "ply\r\nformat binary_little_endian 1.0\r\nelement vertex 1\r\nproperty char x\r\nproperty char y\r\nproperty "
        "char z\r\nend_header\r\n"};
    for (int i = 0; i < 3; ++i) {
        layout l = {NULL, 0, 0};
        put_text(&l, HEADERS[i]);
        put_bytes(&l, "\n\r\xFF", 3);
        check_content(context, write_layout("a.ply", &l), "10 13 -1");
    }
}
END_TEST

/* Sets one number of the sample at its end: count and corners of the last face. */
static void check_damage(unsigned from_end, uint32_t value, unsigned size, const char *message)
{
    layout l = binary_mesh(false, 6, 1, 4, false, false);
    for (unsigned i = 0; i < size; ++i)
        l.bytes[l.size - from_end + i] = (unsigned char)(value >> 8 * i);
    check_refused(context, write_layout("a.ply", &l), SPH_E_FORMAT, message);
}

START_TEST(what_is_wrong_in_a_binary_file_is_refused_with_its_byte)
{
    char message[100];
    layout l = binary_mesh(false, 6, 1, 4, false, false);
    const size_t size = l.size;
    layout_free(&l);
    snprintf(message, sizeof message, "byte %zu: vertex index 4, but there are 4 vertices", size - 4);
    check_damage(4, 4, 4, message);
    check_damage(4, 0xFFFFFFFF, 4, "vertex index -1, but there are 4 vertices");
    snprintf(message, sizeof message, "byte %zu: vertex index 1000, but", size - 29);
    check_damage(29, 1000, 4, message);
    snprintf(message, sizeof message, "byte %zu: a face of fewer than 3", size - 17);
    check_damage(17, 2, 1, message);
    snprintf(message, sizeof message, "ends at byte %zu, within face 1 of 2", size);
    check_damage(17, 5, 1, message);
    check_damage(17, 255, 1, message);
}
END_TEST

START_TEST(a_file_that_goes_on_is_read_up_to_its_end)
{
    layout l = binary_mesh(true, 6, 1, 4, false, false);
    put_text(&l, "more");
    check_content(context, write_layout("a.ply", &l), BINARY_READ);
}
END_TEST

/* --- sequences --- */

static const char *write_frame(unsigned frame, unsigned encoding, uint32_t second_corner)
{
    char name[32], text[400];
    layout l = {NULL, 0, 0};
    snprintf(name, sizeof name, "s_%u.ply", frame);
    snprintf(text, sizeof text, "ply\nformat %s 1.0\nelement vertex 4\n" XYZ "element face 2\n" CORNERS "end_header\n",
             encoding == 0   ? "ascii"
             : encoding == 1 ? "binary_little_endian"
                             : "binary_big_endian");
    put_text(&l, text);
    for (uint32_t i = 0; i < 12; ++i) {
        snprintf(text, sizeof text, "%.10f%c", (double)coordinate(frame, i / 3, i % 3), i % 3 == 2 ? '\n' : ' ');
        if (encoding == 0)
            put_text(&l, text);
        else
            put(&l, encoding == 2, 6, (double)coordinate(frame, i / 3, i % 3));
    }
    for (uint32_t f = 0; f < 2; ++f) {
        const uint32_t b = f == 1 ? second_corner : 1;
        snprintf(text, sizeof text, "3 %u %u %u\n", f, b, f + 2);
        if (encoding == 0) put_text(&l, text);
        if (encoding == 0) continue;
        put(&l, encoding == 2, 1, 3);
        put(&l, encoding == 2, 4, f);
        put(&l, encoding == 2, 4, b);
        put(&l, encoding == 2, 4, f + 2);
    }
    return write_layout(name, &l);
}

START_TEST(a_sequence_of_any_flavours_comes_in_natural_order)
{
    sph_status status;
    sph_animation *animation;
    for (unsigned f = 0; f < 12; ++f)
        write_frame(f, f % 3, 2);
    animation = open_one(context, file_path(_i == 0 ? "s_%d.ply" : "s_*.ply"), NULL, &status);
    check_frames(context, animation, 4, 12, 0, 1);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(another_order_of_vertices_is_named_with_its_place)
{
    static const char *const MESSAGES[] = {"s_2.ply: line 15: triangle 1 is (1 0 3), but (1 2 3) in ",
                                           "s_2.ply: byte 230: triangle 1 is (1 0 3), but (1 2 3) in ",
                                           "s_2.ply: byte 227: triangle 1 is (1 0 3), but (1 2 3) in "};
    for (unsigned f = 0; f < 4; ++f)
        write_frame(f, (unsigned)_i, f == 2 ? 0 : 2);
    check_refused(context, file_path("s_%d.ply"), SPH_E_FORMAT, MESSAGES[_i]);
}
END_TEST

int main(void)
{
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, all_that_text_allows_is_read, 0, (int)(sizeof GOOD / sizeof *GOOD));
    tcase_add_loop_test(tc, what_is_wrong_in_a_text_is_refused_with_its_line, 0, (int)(sizeof BAD / sizeof *BAD));
    tcase_add_test(tc, what_is_not_read_is_refused_by_name);
    tcase_add_loop_test(tc, binary_of_every_type_in_both_byte_orders_is_read, 0, 2 * TYPE_COUNT);
    tcase_add_test(tc, the_first_byte_of_an_element_may_be_a_line_feed);
    tcase_add_test(tc, what_is_wrong_in_a_binary_file_is_refused_with_its_byte);
    tcase_add_test(tc, a_file_that_goes_on_is_read_up_to_its_end);
    tcase_add_loop_test(tc, a_sequence_of_any_flavours_comes_in_natural_order, 0, 2);
    tcase_add_loop_test(tc, another_order_of_vertices_is_named_with_its_place, 0, 3);
    return run_suite(suite_create("io PLY"), tc);
}
