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

#define THREE "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
#define THREE_READ "0 0 0, 1 0 0, 0 1 0"
#define FIVE THREE "v 2 2 2\nv 3 3 3\n"
#define FIVE_READ THREE_READ ", 2 2 2, 3 3 3"

static const struct {
    const char *text, *expected;
} GOOD[] = {
    {THREE "f 1 2 3\n", THREE_READ "; f 0 1 2"},
    {THREE "f 1 2 3", THREE_READ "; f 0 1 2"},
    {"v 1 2 3", "1 2 3"},
    {"\xEF\xBB\xBFv 1 2 3", "1 2 3"},
    {"v 1 2 3 1.0\nv 1 2 3 0.5 0.5 0.5\nv 4 5 6 1 0 0 1", "1 2 3, 1 2 3, 4 5 6"},
    {"v 1 2 3#a comment\nv 4 5 6 # 7\n#v 7 8 9\n", "1 2 3, 4 5 6"},
    {"v\t1\t2 \t 3 \t\r\nv 4 5 6\r\n\r\n", "1 2 3, 4 5 6"},
    {"v 1 2 3\rv 4 5 6\rf 1 2 1\r", "1 2 3, 4 5 6; f 0 1 0"},
    {"  v 1 2 3\n\t\tv 4 5 6", "1 2 3, 4 5 6"},
    {"v 1 \\\n2 3\nv 4 5\\\r\n 6", "1 2 3, 4 5 6"},
    {THREE "f 1 \\\n 2 \\\n 3\n", THREE_READ "; f 0 1 2"},
    {THREE "f 1/1 2/2 3/3\n", THREE_READ "; f 0 1 2"},
    {THREE "f 1//4 2//5 3//6\n", THREE_READ "; f 0 1 2"},
    {THREE "f 1/7/4 2/8/5 3/9/6\n", THREE_READ "; f 0 1 2"},
    {THREE "f 1/ 2// 3/-1/-1\n", THREE_READ "; f 0 1 2"},
    {THREE "f -3 -2 -1\nv 5 5 5\nf -1 -2 -4\n", THREE_READ ", 5 5 5; f 0 1 2, 3 2 0"},
    {THREE "f -3/-3/-3 -2/-2/-2 -1/-1/-1\n", THREE_READ "; f 0 1 2"},
    {FIVE "f 1 2 3 4\nf 5 4 3 2 1\n", FIVE_READ "; f 0 1 2, 0 2 3, 4 3 2, 4 2 1, 4 1 0"},
    {"f 1 2 3\n" THREE, THREE_READ "; f 0 1 2"}, /* before its vertices */
    {FIVE "l 1 2\nl 3/1 4/2 5/3\n", FIVE_READ "; l 0 1, 2 3, 3 4"},
    {THREE "f 1 1 2\nl 3 3\n", THREE_READ "; f 0 0 1; l 2 2"},
    {"mtllib a.mtl\no thing\ng a b\ns off\nvn 0 0 1\nvt 0 0\nvp 1 1\nusemtl x\n" THREE "f 1 2 3\np 1\ncurv 0 1 1 2\n"
     "fo 1 2 3\nvertex 1\nfoo\n",
     THREE_READ "; f 0 1 2"},
    {"o C:\\\nv 1 2 3\n# C:\\dir\\\nv 4 5 6\n", "1 2 3, 4 5 6"}, /* a backslash that ends a name takes nothing back */
    {"v 1e0 -2.5E+1 +.5\n", "1 -25 0.5"},
    {"v nan inf -inf\n", "nan inf -inf"},
    {"v 1.#INF 1.#IND 1\n", "inf nan 1"},
    {"\n\n\n v 1 2 3", "1 2 3"},
};

START_TEST(all_that_obj_allows_is_read)
{
    check_content(context, file_text("a.obj", GOOD[_i].text), GOOD[_i].expected);
}
END_TEST

static const struct {
    const char *text, *message;
} BAD[] = {
    {"", "without vertices"},
    {"# nothing\n", "without vertices"},
    {"v 1 2\n", "line 1: a vertex of fewer than 3"},
    {"v", "line 1: a vertex of fewer than 3"},
    {"v\nv 1 2 3", "line 1: a vertex of fewer than 3"},
    {"v 1 2 3\nv 1 2 x\n", "line 2: a vertex with something that is not a number"},
    {"v 1 2 3abc\n", "line 1: a vertex with something that is not a number"},
    {"v 1 2 3 abc\n", "line 1: a vertex with something that is not a number"},
    {"v 1,5 2 3\n", "line 1: a vertex with something that is not a number"},
    {"v 1 2 3 4 5 6 7 8 9\n", "line 1: a vertex of more than 8"},
    {THREE "f 1 2\n", "line 4: a face of fewer than 3"},
    {THREE "f\n", "line 4: a face of fewer than 3"},
    {THREE "f 1 2 4\n", "line 4: vertex index 4, but there are 3 vertices"},
    {THREE "f 1 2 0\n", "line 4: vertex index 0"},
    {THREE "f 1 2 -4\n", "line 4: vertex index -4, but only 3 vertices"},
    {THREE "f 1 2 x\n", "line 4: not a vertex index"},
    {THREE "f 1 2 3x\n", "line 4: not a vertex index"},
    {THREE "f 1 2 3/1/1/1\n", "line 4: not a vertex index"},
    {THREE "f 1 2 3.5\n", "line 4: not a vertex index"},
    {THREE "f 1 2 2147483648\n", "line 4: a vertex index beyond 2^31 - 1"},
    {THREE "f 1 2 18446744073709551617\n", "line 4: a vertex index beyond 2^31 - 1"},
    {THREE "f 1 2 -18446744073709551617\n", "line 4: a vertex index beyond 2^31 - 1"},
    {THREE "\r\n\r\nf 1 \\\n2 9\n", "line 7: vertex index 9"},
    {THREE "l 1\n", "line 4: a line element of fewer than 2"},
    {THREE "l 1 7\n", "line 4: vertex index 7"},
    {"f 1 2 3\n", "without vertices"},
};

START_TEST(what_is_wrong_is_refused_with_its_line)
{
    check_refused(context, file_text("a.obj", BAD[_i].text), SPH_E_FORMAT, BAD[_i].message);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "a.obj"));
}
END_TEST

START_TEST(the_content_decides_where_the_name_does_not)
{
    sph_status status;
    sph_animation_destroy(open_one(context, file_text("mesh.txt", "# made by hand\n" THREE), NULL, &status));
    ck_assert_int_eq(status, SPH_OK);
    sph_animation_destroy(open_one(context, file_text("mesh.OBJ", THREE), NULL, &status));
    ck_assert_int_eq(status, SPH_OK);
    ck_assert_ptr_null(open_one(context, file_text("notes.txt", "dear reader\n" THREE), NULL, &status));
    ck_assert_int_eq(status, SPH_E_UNSUPPORTED);
}
END_TEST

START_TEST(formats_that_are_not_read_are_refused_by_name)
{
    static const char *const CASES[][3] = {{"a.abc", "\x89HDF\r\n\x1A\n", "Alembic"},
                                           {"a.fbx", "Kaydara FBX Binary  ", "FBX"},
                                           {"a.usda", "#usda 1.0\n", "USD"},
                                           {"a.xyz", "1 2 3\n", "not a format that is known"},
                                           {"a.pc2", "POINTCACHE2", "point cache (PC2)"}};
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; ++i) {
        sph_status status;
        ck_assert_ptr_null(open_one(context, file_text(CASES[i][0], CASES[i][1]), NULL, &status));
        ck_assert_int_eq(status, SPH_E_UNSUPPORTED);
        ck_assert_msg(strstr(sph_context_last_message(context), CASES[i][2]) != NULL, "%s",
                      sph_context_last_message(context));
    }
}
END_TEST

START_TEST(what_cannot_be_opened_is_named_with_the_reason)
{
    sph_status status;
    ck_assert_ptr_null(open_one(context, file_path("none.obj"), NULL, &status));
    ck_assert_int_eq(status, SPH_E_IO);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "none.obj: cannot be opened: No such file"));
    ck_assert_ptr_null(open_one(context, file_path(""), NULL, &status));
    ck_assert_int_eq(status, SPH_E_IO);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "a directory"));
    ck_assert_ptr_null(open_one(context, "/dev/null", NULL, &status));
    ck_assert_int_eq(status, SPH_E_IO);
}
END_TEST

int main(void)
{
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, all_that_obj_allows_is_read, 0, (int)(sizeof GOOD / sizeof *GOOD));
    tcase_add_loop_test(tc, what_is_wrong_is_refused_with_its_line, 0, (int)(sizeof BAD / sizeof *BAD));
    tcase_add_test(tc, the_content_decides_where_the_name_does_not);
    tcase_add_test(tc, formats_that_are_not_read_are_refused_by_name);
    tcase_add_test(tc, what_cannot_be_opened_is_named_with_the_reason);
    return run_suite(suite_create("io OBJ"), tc);
}
