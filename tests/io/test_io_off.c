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

#define THREE "0 0 0\n1 0 0\n0 1 0\n"
#define READ "0 0 0, 1 0 0, 0 1 0; f 0 1 2"

static const struct {
    const char *text, *expected;
} GOOD[] = {
    {"OFF\n3 1 0\n" THREE "3 0 1 2\n", READ},
    {"OFF\n3 1 0\n" THREE "3 0 1 2", READ},
    {"OFF 3 1 3\n" THREE "3 0 1 2\n", READ},
    {"OFF3 1 3\n" THREE "3 0 1 2\n", READ},
    {"OFF\n3 1\n" THREE "3 0 1 2\n", READ},
    {"OFF\r\n3 1 0\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n3 0 1 2\r\n", READ},
    {"# first\n\n  # second\nOFF # third\n# fourth\n3 1 0 # fifth\n\n0 0 0# sixth\n# 9 9 9\n1 0 0\n\t 0 1 0 \n3 0 1 2 "
     "# last\n# end\n\n",
     READ},
    {"OFF\n5 2 0\n" THREE "2 2 2\n3 3 3\n4 0 1 2 3\n5 4 3 2 1 0 255 128 0\n",
     "0 0 0, 1 0 0, 0 1 0, 2 2 2, 3 3 3; f 0 1 2, 0 2 3, 4 3 2, 4 2 1, 4 1 0"},
    {"OFF\n1 0 0\n1e0 -2.5 .5\n", "1 -2.5 0.5"},
    {"OFF\n1 0 0\n1 2 3 255 0 0\n", "1 2 3"}, /* colours that the keyword does not speak of */
    {"COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 0.5 0.5 0.5 1\n0 1 0 1 2 3\n3 0 1 2 0.5 0.5 0.5\n", READ},
    {"NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2 7\n", READ},
    {"CNOFF\n1 0 0\n1 2 3 0 0 1 9 9 9 9\n", "1 2 3"},
    {"STOFF\n1 0 0\n1 2 3 0.5 0.5\n", "1 2 3"},
    {"STCNOFF\n1 0 0\n1 2 3 0 0 1 9 9 9 9 0.5 0.5\n", "1 2 3"},
    {"OFF\n1 0 0\n1 2 3\nand more\n", "1 2 3"},
};

START_TEST(all_that_off_allows_is_read)
{
    check_content(context, file_text("a.off", GOOD[_i].text), GOOD[_i].expected);
}
END_TEST

static const struct {
    const char *text, *message;
} BAD[] = {
    {"", "line 1: an empty file"},
    {"# nothing\n", "line 2: an empty file"},
    {"3 1 0\n" THREE "3 0 1 2\n", "line 1: not an OFF file"},
    {"OFFSET\n", "line 1: not an OFF file"},
    {"OFF\n", "line 2: the number of vertices"},
    {"OFF\nx 1 0\n", "line 2: the number of vertices"},
    {"OFF\n-3 1 0\n", "line 2: the number of vertices"},
    {"OFF\n2147483648 1 0\n", "line 2: the number of vertices"},
    {"OFF\n3\n", "line 3: the number of faces"},
    {"OFF\n3 1 x\n", "line 2: the number of edges"},
    {"OFF\n3 1 0 0\n", "line 2: more than the numbers"},
    {"OFF\n0 0 0\n", "without vertices"},
    {"OFF\n2000000000 0 0\n1 2 3\n", "too short for 2000000000 vertices and 0 faces"},
    {"OFF\n1 2000000000 0\n1 2 3\n", "too short for 1 vertices and 2000000000 faces"},
    {"OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n   ", "line 4: a vertex of fewer than 3"},
    {"OFF\n3 1 0\n0 0 0\n1 0 x\n0 1 0\n3 0 1 2\n", "line 4: a vertex with something that is not a number"},
    {"OFF\n1 0 0\n1 2 3 4 5 6 7 8 9 10 11 12 13\n", "line 3: a vertex of more than 12"},
    {"OFF\n3 1 0\n" THREE "3 0 1 3\n", "line 6: vertex index 3, but there are 3 vertices"},
    {"OFF\n3 1 0\n" THREE "3 0 1 -1\n", "line 6: vertex index -1, but"},
    {"OFF\n3 1 0\n" THREE "3 0 1 18446744073709551616\n", "line 6: vertex index"},
    {"OFF\n3 1 0\n" THREE "3 0 1 1.5\n", "line 6: not a vertex index"},
    {"OFF\n3 1 0\n" THREE "4 0 1 2\n", "line 6: a face with fewer vertices"},
    {"OFF\n3 1 0\n" THREE "2 0 1   \n", "line 6: a face of fewer than 3"},
    {"OFF\n3 1 0\n" THREE "x 0 1 2\n", "line 6: a face without its count"},
    {"OFF\n3 2 0\n0.0000000 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "line 7: ends before face 1 of 2"},
    {"OFF\n3 0 0\n0.0000000 0 0\n1 0 0\n", "line 5: ends before vertex 2 of 3"},
};

START_TEST(what_is_wrong_is_refused_with_its_line)
{
    check_refused(context, file_text("a.off", BAD[_i].text), SPH_E_FORMAT, BAD[_i].message);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "a.off"));
}
END_TEST

START_TEST(what_is_not_read_is_refused_by_name)
{
    static const char *const CASES[][2] = {{"OFF BINARY\n", "binary OFF"},     {"COFF  BINARY\n\1\2\3", "binary OFF"},
                                           {"4OFF\n1 0 0\n1 2 3 4\n", "4OFF"}, {"C4OFF\n1 0 0\n1 2 3 4\n", "4OFF"},
                                           {"nOFF 2\n1 0 0\n1 2\n", "nOFF"},   {"4nOFF 2\n1 0 0\n1 2\n", "4OFF"}};
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; ++i)
        check_refused(context, file_text("a.off", CASES[i][0]), SPH_E_UNSUPPORTED, CASES[i][1]);
}
END_TEST

START_TEST(the_content_decides_where_the_name_does_not)
{
    static const char *const KEYWORDS[] = {"OFF", "COFF", "NOFF", "CNOFF", "STOFF", "STCOFF", "STNOFF", "STCNOFF"};
    for (size_t i = 0; i < sizeof KEYWORDS / sizeof *KEYWORDS; ++i) {
        char text[100];
        snprintf(text, sizeof text, "%s\n1 0 0\n1 2 3\n", KEYWORDS[i]);
        check_content(context, file_text("mesh.txt", text), "1 2 3");
    }
}
END_TEST

static void write_frame(unsigned frame, const char *faces)
{
    char name[32], text[400];
    size_t length = (size_t)snprintf(text, sizeof text, "%sOFF\n4 2 0\n", frame % 2 == 1 ? "# odd\n" : "");
    for (uint32_t i = 0; i < 12; ++i)
        length += (size_t)snprintf(text + length, sizeof text - length, "%.10f%c",
                                   (double)coordinate(frame, i / 3, i % 3), i % 3 == 2 ? '\n' : ' ');
    snprintf(text + length, sizeof text - length, "%s", faces);
    snprintf(name, sizeof name, "s%u.off", frame);
    file_text(name, text);
}

START_TEST(a_sequence_comes_in_natural_order)
{
    sph_status status;
    sph_animation *animation;
    for (unsigned f = 0; f < 12; ++f)
        write_frame(f, "3 0 1 2\n3 1 2 3\n");
    animation = open_one(context, file_path(_i == 0 ? "s%d.off" : "s*.off"), NULL, &status);
    check_frames(context, animation, 4, 12, 0, 1);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(another_order_of_vertices_is_named_with_its_line)
{
    for (unsigned f = 0; f < 3; ++f)
        write_frame(f, f == 1 ? "3 0 1 2\n3 0 2 3\n" : "3 0 1 2\n3 1 2 3\n");
    check_refused(context, file_path("s%d.off"), SPH_E_FORMAT,
                  "s1.off: line 9: triangle 1 is (0 2 3), but (1 2 3) in ");
}
END_TEST

int main(void)
{
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, all_that_off_allows_is_read, 0, (int)(sizeof GOOD / sizeof *GOOD));
    tcase_add_loop_test(tc, what_is_wrong_is_refused_with_its_line, 0, (int)(sizeof BAD / sizeof *BAD));
    tcase_add_test(tc, what_is_not_read_is_refused_by_name);
    tcase_add_test(tc, the_content_decides_where_the_name_does_not);
    tcase_add_loop_test(tc, a_sequence_comes_in_natural_order, 0, 2);
    tcase_add_test(tc, another_order_of_vertices_is_named_with_its_line);
    return run_suite(suite_create("io OFF"), tc);
}
