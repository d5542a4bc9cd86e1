/* SPDX-License-Identifier: MIT */
#include <check.h>
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

#define FACET(a, b, c)                                                                                                 \
    "facet normal 0 0 1\n outer loop\n  vertex " a "\n  vertex " b "\n  vertex " c "\n endloop\nendfacet\n"
#define ONE FACET("0 0 0", "1 0 0", "0 1 0")
#define READ "0 0 0, 1 0 0, 0 1 0; f 0 1 2"

static const struct {
    const char *text, *expected;
} GOOD[] = {
    {"solid\n" ONE "endsolid\n", READ},
    {"solid\n" ONE "endsolid", READ},
    {"solid a name facet normal\n" ONE "endsolid a name\n\n", READ},
    {"solid a\r\nfacet normal nan -nan(ind) 1.#IND\r\nouter loop\r\nvertex 0 0 0\r\nvertex 1 0 0\r\nvertex 0 1 "
     "0\r\nendloop\r\nendfacet\r\nendsolid a\r\n",
     READ},
    {"SOLID X\nFACET NORMAL 0 0 1 OUTER LOOP VERTEX 0 0 0 VERTEX 1 0 0 Vertex 0 1 0 ENDLOOP ENDFACET\nENDSOLID X\n",
     READ},
    {"\n\t solid\n" ONE FACET("1 0 0", "1 1 0", "0 1 0") "endsolid\n", "0 0 0, 1 0 0, 0 1 0, 1 1 0; f 0 1 2, 1 3 2"},
    {"solid a\n" ONE "endsolid a\nsolid b\nendsolid b\nsolid c\n" FACET("0 0 0", "0 1 0", "5 5 5") "endsolid c\n",
     "0 0 0, 1 0 0, 0 1 0, 5 5 5; f 0 1 2, 0 2 3"},
    {"solid\n" FACET("0 -0 0", "1 0.0 0", "-0 0 -0e5") "endsolid\n", "0 -0 0, 1 0 0; f 0 1 0"},
    {"solid\n" FACET("nan 0 0", "nan 0 0", "inf 0 0") "endsolid\n", "nan 0 0, inf 0 0; f 0 0 1"},
};

START_TEST(all_that_text_allows_is_read)
{
    check_content(context, file_text("a.stl", GOOD[_i].text), GOOD[_i].expected);
}
END_TEST

static const struct {
    const char *text, *message;
} BAD[] = {
    {"", "an empty file"},
    {"mesh\n", "ends at byte 5: neither an STL text"},
    {"solid", "line 1: not \"facet\" or \"endsolid\""},
    {"solid\nendsolid\n", "without triangles"},
    {"solid\n" ONE, "line 9: not \"facet\" or \"endsolid\""},
    {"solid\n" ONE "endsolid\nfacet", "line 10: not \"solid\""},
    {"solid\nfacet norm 0 0 1\n", "line 2: not \"normal\""},
    {"solid\nfacet normal 0 0\n", "line 2: not \"normal\""},
    {"solid\nfacet normal 0 0 1\nouter\n", "not \"outer loop\""},
    {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n", "line 4: not \"vertex\""},
    {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1x\n", "line 4: not \"vertex\""},
    {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1\nvertex 0 0 1\nendloop\n", "line 6: not \"vertex\""},
    {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1\nvertex 0 0 1\nvertex 0 0 1\nvertex 0 0 1\nendloop\n",
     "line 7: not \"endloop\" after three vertices"},
    {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1\nvertex 0 0 1\nvertex 0 0 1\nendloop\nfacet\n",
     "line 8: not \"endfacet\""},
};

START_TEST(what_is_wrong_in_a_text_is_refused_with_its_line)
{
    check_refused(context, file_text("a.stl", BAD[_i].text), SPH_E_FORMAT, BAD[_i].message);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "a.stl"));
}
END_TEST

/* --- binary --- */

static layout binary(const char *header, uint32_t count, const float (*corners)[3], size_t written)
{
    layout l = {NULL, 0, 0};
    unsigned char start[80] = {0};
    memcpy(start, header, strlen(header));
    put_bytes(&l, start, sizeof start);
    put_little(&l, count, 4);
    for (size_t t = 0; t < written; ++t) {
        for (int i = 0; i < 3; ++i)
            put_little_float(&l, NAN); /* normals are not looked at */
        for (int i = 0; i < 9; ++i)
            put_little_float(&l, corners[3 * t + (size_t)i / 3][i % 3]);
        put_little(&l, 0xBEEF, 2);
    }
    return l;
}

static const char *write_layout(const char *name, layout *l)
{
    const char *path = file_write(name, l->bytes, l->size);
    layout_free(l);
    return path;
}

static const float SQUARE[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, -0.f}};
#define SQUARE_READ "0 0 0, 1 0 0, 0 1 0, 1 1 0; f 0 1 2, 1 3 2"

START_TEST(binary_files_are_told_by_their_size)
{
    static const char *const HEADERS[] = {"", "made by hand", "solid lies", "COLOR=xxxx"};
    layout l = binary(HEADERS[_i], 2, SQUARE, 2);
    check_content(context, write_layout("a.stl", &l), SQUARE_READ);
}
END_TEST

START_TEST(a_binary_file_that_goes_on_is_read_up_to_its_end)
{
    layout l = binary("solid", 2, SQUARE, 2);
    put_bytes(&l, "more", 4);
    check_content(context, write_layout("a.stl", &l), SQUARE_READ);
}
END_TEST

START_TEST(a_binary_file_that_is_too_short_is_refused_with_both_sizes)
{
    static const uint32_t COUNTS[] = {3, 0x7FFFFFFF, 0xFFFFFFFF};
    static const char *const MESSAGES[] = {"ends at byte 184: as a binary STL file of 3 triangles it would have 234",
                                           "of 2147483647 triangles it would have 107374182434",
                                           "of 4294967295 triangles it would have 214748364834"};
    layout l = binary("", COUNTS[_i], SQUARE, 2);
    check_refused(context, write_layout("a.stl", &l), SPH_E_FORMAT, MESSAGES[_i]);
    l = binary("", 0, SQUARE, 0);
    check_refused(context, write_layout("a.stl", &l), SPH_E_FORMAT, "without triangles");
}
END_TEST

/* --- welding and sequences --- */

START_TEST(welding_agrees_with_comparing_all_corners)
{
    enum { TRIANGLES = 300 };
    float corners[3 * TRIANGLES][3], xyz[9 * TRIANGLES];
    uint32_t expected[3 * TRIANGLES], count = 0;
    uint64_t state = 7;
    sph_status status;
    sph_animation *animation;
    layout l;
    for (size_t c = 0; c < 3 * TRIANGLES; ++c) {
        size_t other = 0;
        for (int i = 0; i < 3; ++i) {
            corners[c][i] = (float)(int)(test_random(&state) % 7) - 3;
            if (corners[c][i] == 0 && test_random(&state) % 2 == 0) corners[c][i] = -0.f;
        }
        while (corners[other][0] != corners[c][0] || corners[other][1] != corners[c][1] ||
               corners[other][2] != corners[c][2])
            ++other;
        expected[c] = other == c ? count++ : expected[other];
    }
    l = binary("", TRIANGLES, (const float(*)[3])corners, TRIANGLES);
    animation = open_one(context, write_layout("a.stl", &l), NULL, &status);
    ck_assert_int_eq(status, SPH_OK);
    ck_assert_uint_eq(sph_animation_vertex_count(animation), count);
    ck_assert_uint_eq(sph_animation_triangle_count(animation), TRIANGLES);
    ck_assert_int_eq(sph_animation_read_frame(animation, 0, xyz), SPH_OK);
    for (size_t c = 0; c < 3 * TRIANGLES; ++c) {
        const uint32_t v = sph_animation_triangles(animation)[c];
        ck_assert_uint_eq(v, expected[c]);
        for (size_t i = 0; i < 3; ++i)
            ck_assert_float_eq(xyz[3 * v + i], corners[c][i]);
    }
    sph_animation_destroy(animation);
}
END_TEST

/*
 * A strip of four triangles over six vertices in frame `frame`, as text or binary by turns. `order` says which
 * triangle stands where, `turn` with which corner the first one begins; in `touching` frames the last vertex lies on
 * the first.
 */
static void write_strip(unsigned frame, const unsigned order[4], unsigned turn, bool touching)
{
    float corners[12][3];
    char name[32];
    layout l;
    for (unsigned t = 0; t < 4; ++t)
        for (unsigned i = 0; i < 3; ++i) {
            const unsigned corner = t == 0 ? (i + turn) % 3 : i;
            unsigned v = order[t] + corner;
            if (touching && v == 5) v = 0;
            for (unsigned j = 0; j < 3; ++j)
                corners[3 * t + i][j] = coordinate(frame, v, j);
        }
    l = binary("", 4, (const float(*)[3])corners, 4);
    if (frame % 2 == 1) {
        char text[2000];
        size_t length = (size_t)snprintf(text, sizeof text, "solid odd\n");
        for (unsigned t = 0; t < 4; ++t) {
            length += (size_t)snprintf(text + length, sizeof text - length, "facet normal 0 0 0\nouter loop\n");
            for (unsigned c = 3 * t; c < 3 * t + 3; ++c)
                length += (size_t)snprintf(text + length, sizeof text - length, "vertex %.10f %.10f %.10f\n",
                                           (double)corners[c][0], (double)corners[c][1], (double)corners[c][2]);
            length += (size_t)snprintf(text + length, sizeof text - length, "endloop\nendfacet\n");
        }
        snprintf(text + length, sizeof text - length, "endsolid odd\n");
        l.size = 0;
        put_bytes(&l, text, strlen(text));
    }
    snprintf(name, sizeof name, "s%u.stl", frame);
    write_layout(name, &l);
}

static const unsigned IN_ORDER[4] = {0, 1, 2, 3};

START_TEST(a_sequence_comes_in_natural_order)
{
    sph_status status;
    sph_animation *animation;
    for (unsigned f = 0; f < 12; ++f)
        write_strip(f, IN_ORDER, 0, false);
    animation = open_one(context, file_path(_i == 0 ? "s%d.stl" : "s*.stl"), NULL, &status);
    check_frames(context, animation, 6, 12, 0, 1);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(what_touches_in_a_later_frame_stays_apart)
{
    sph_status status;
    sph_animation *animation;
    float xyz[18];
    for (unsigned f = 0; f < 4; ++f)
        write_strip(f, IN_ORDER, 0, f == 2);
    animation = open_one(context, file_path("s%d.stl"), NULL, &status);
    ck_assert_int_eq(status, SPH_OK);
    ck_assert_uint_eq(sph_animation_vertex_count(animation), 6);
    ck_assert_int_eq(sph_animation_read_frame(animation, 2, xyz), SPH_OK);
    for (unsigned j = 0; j < 3; ++j) {
        ck_assert_float_eq(xyz[15 + j], coordinate(2, 0, j));
        ck_assert_float_eq(xyz[12 + j], coordinate(2, 4, j));
    }
    ck_assert_int_eq(sph_animation_read_frame(animation, 3, xyz), SPH_OK);
    for (unsigned j = 0; j < 18; ++j)
        ck_assert_float_eq(xyz[j], coordinate(3, j / 3, j % 3));
    sph_animation_destroy(animation);
}
END_TEST

static void count_warnings(void *user, int32_t severity, const char *message)
{
    ck_assert_ptr_nonnull(strstr(message, "come apart"));
    *(size_t *)user += severity == SPH_LOG_WARNING;
}

START_TEST(what_touches_in_the_first_frame_stays_one_vertex_and_a_warning_tells)
{
    sph_context_options options;
    sph_context *own;
    sph_status status;
    sph_animation *animation;
    size_t warnings = 0;
    float xyz[18];
    sph_context_options_init(&options, sizeof options);
    options.log = count_warnings;
    options.log_user = &warnings;
    ck_assert_int_eq(sph_context_create(&options, &own), SPH_OK);
    for (unsigned f = 0; f < 4; ++f)
        write_strip(f, IN_ORDER, 0, f == 0);
    animation = open_one(own, file_path("s%d.stl"), NULL, &status);
    ck_assert_int_eq(status, SPH_OK);
    ck_assert_uint_eq(sph_animation_vertex_count(animation), 5);
    for (unsigned f = 1; f < 4; ++f) {
        ck_assert_int_eq(sph_animation_read_frame(animation, f, xyz), SPH_OK);
        for (unsigned j = 0; j < 15; ++j)
            ck_assert_float_eq(xyz[j], coordinate(f, j / 3, j % 3));
    }
    ck_assert_uint_eq(warnings, 1);
    sph_animation_destroy(animation);
    sph_context_destroy(own);
}
END_TEST

START_TEST(another_order_of_triangles_or_corners_is_refused_by_name)
{
    static const unsigned ORDERS[][4] = {{1, 0, 2, 3}, {0, 1, 3, 2}, {3, 2, 1, 0}, {0, 1, 2, 3}, {0, 1, 2, 3}};
    const unsigned turn = _i == 3 ? 1 : _i == 4 ? 2 : 0;
    for (unsigned f = 0; f < 4; ++f)
        write_strip(f, f == 2 ? ORDERS[_i] : IN_ORDER, f == 2 ? turn : 0, false);
    check_refused(context, file_path("s%d.stl"), SPH_E_FORMAT, "s2.stl: triangle ");
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "in another order"));
}
END_TEST

START_TEST(another_number_of_triangles_is_refused_with_what_differs)
{
    layout l = binary("", 2, SQUARE, 2);
    for (unsigned f = 0; f < 3; ++f)
        write_strip(f, IN_ORDER, 0, false);
    write_layout("s1.stl", &l);
    check_refused(context, file_path("s%d.stl"), SPH_E_FORMAT, "s1.stl: 4 vertices, but 6 in ");
}
END_TEST

int main(void)
{
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, all_that_text_allows_is_read, 0, (int)(sizeof GOOD / sizeof *GOOD));
    tcase_add_loop_test(tc, what_is_wrong_in_a_text_is_refused_with_its_line, 0, (int)(sizeof BAD / sizeof *BAD));
    tcase_add_loop_test(tc, binary_files_are_told_by_their_size, 0, 4);
    tcase_add_test(tc, a_binary_file_that_goes_on_is_read_up_to_its_end);
    tcase_add_loop_test(tc, a_binary_file_that_is_too_short_is_refused_with_both_sizes, 0, 3);
    tcase_add_test(tc, welding_agrees_with_comparing_all_corners);
    tcase_add_loop_test(tc, a_sequence_comes_in_natural_order, 0, 2);
    tcase_add_test(tc, what_touches_in_a_later_frame_stays_apart);
    tcase_add_test(tc, what_touches_in_the_first_frame_stays_one_vertex_and_a_warning_tells);
    tcase_add_loop_test(tc, another_order_of_triangles_or_corners_is_refused_by_name, 0, 5);
    tcase_add_test(tc, another_number_of_triangles_is_refused_with_what_differs);
    return run_suite(suite_create("io STL"), tc);
}
