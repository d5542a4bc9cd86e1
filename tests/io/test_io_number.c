/* SPDX-License-Identifier: MIT */
/* Against the C library's strtof, which is exact, in the C locale. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/io.h"
#include "runner.h"
#include "support.h"

static uint32_t bits_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static float float_of(uint32_t bits)
{
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Exactly as long as the text, so that the address sanitizer sees a look beyond it. */
static void check_text(const char *text)
{
    const size_t length = strlen(text);
    char *copy = malloc(length), *end;
    float value = -1;
    const float expected = strtof(text, &end);
    const char *after;
    memcpy(copy, text, length);
    after = sph__io_parse_float(copy, copy + length, &value);
    ck_assert_msg(after == copy + (end - text), "%s: read %td bytes, strtof %td", text, after - copy, end - text);
    ck_assert_msg(bits_of(value) == bits_of(expected) || (isnan(value) && isnan(expected)), "%s: %.9g, strtof %.9g",
                  text, (double)value, (double)expected);
    free(copy);
}

static const char *const TEXTS[] = {
    "0",
    "-0",
    "+0.0",
    "1",
    "-1.5",
    "+2",
    ".5",
    "5.",
    "-.25e1",
    "1e5",
    "1E+5",
    "1e-5",
    "1e",
    "1e+",
    "1ex",
    "12abc",
    "3.4028234e38",
    "3.4028235e38",
    "3.4028236e38",
    "340282346638528859811704183484516925440",
    "1e39",
    "-1e39",
    "1e400",
    "1e-400",
    "1e999999999999999999999999",
    "1e-999999999999999999999999",
    "0e999999999999999999999",
    "340282356779733661637539395458142568447",
    "340282356779733661637539395458142568448",
    "340282356779733661637539395458142568449",
    "1.1754943508222875e-38",
    "1.17549429e-38",
    "1.4e-45",
    "7e-46",
    "7.1e-46",
    "7.00649232162408535461864791644958065640130970938257885878534141944895541342930300743319094181060791015625e-46",
    "7.00649232162408535461864791644958065640130970938257885878534141944895541342930300743319094181060791015624e-46",
    "7."
    "006492321624085354618647916449580656401309709382578858785341419448955413429303007433190941810607910156250000000001"
    "e-46",
    "16777217",
    "16777217.0000000000000000000000000000000000000001",
    "16777216.9999999999999999999999999999999999999",
    "33554433",
    "33554434",
    "33554435",
    "1.00000005960464477539062",
    "1.000000059604644775390625",
    "1.000000059604644775390626",
    "1.00000017881393432617187499",
    "1.000000178813934326171875",
    "1.00000017881393432617187501",
    "0.000000000000000000000000000000000000000000000000000000000000000000000001e72",
    "100000000000000000000000000000000000000000000000000000000000000000000000000e-74",
    "12345678901234567890123456789",
    "0.1234567890123456789012345678901234567890",
    "9007199254740993",
    "nan",
    "NAN",
    "-nan",
    "inf",
    "-Inf",
    "INFINITY",
    "infinit",
    "nan(123)",
    "nan(12",
    "1.2.3",
    "1,5",
    "00000000000000000000000000000000000000000001.5",
    "1.175494350822287507968736537222245677819e-38",
    "5.877471754111437539843682686111228389093e-39"};

START_TEST(a_number_is_read_as_strtof_reads_it)
{
    check_text(TEXTS[_i]);
}
END_TEST

START_TEST(what_is_no_number_is_refused)
{
    static const char *const BAD[] = {"", "-", "+", ".", "-.", "e5", "x", "--1", "in", "na", " 1", ".e1"};
    for (size_t i = 0; i < sizeof BAD / sizeof *BAD; ++i) {
        float value = 7;
        ck_assert_ptr_null(sph__io_parse_float(BAD[i], BAD[i] + strlen(BAD[i]), &value));
    }
}
END_TEST

START_TEST(what_old_windows_libraries_print_is_read)
{
    static const char *const TEXT[] = {"1.#INF", "-1.#INF00", "1.#QNAN", "-1.#IND", "1.#SNAN0"};
    for (size_t i = 0; i < 5; ++i) {
        const char *end = TEXT[i] + strlen(TEXT[i]);
        float value = 0;
        ck_assert_ptr_eq(sph__io_parse_float(TEXT[i], end, &value), end);
        if (i < 2)
            ck_assert(isinf(value) && (value < 0) == (i == 1));
        else
            ck_assert(isnan(value));
    }
    {
        static const char COMMENT[] = "3.#a comment";
        float value = 0;
        ck_assert_ptr_eq(sph__io_parse_float(COMMENT, COMMENT + sizeof COMMENT - 1, &value), COMMENT + 2);
        ck_assert(value == 3);
    }
}
END_TEST

START_TEST(random_decimals_of_any_length_are_read_as_strtof_reads_them)
{
    uint64_t state = 1;
    for (int i = 0; i < 100000; ++i) {
        char text[80];
        const unsigned digits = 1 + test_random(&state) % 40, point = test_random(&state) % (digits + 1);
        unsigned length = 0;
        for (unsigned d = 0; d < digits; ++d) {
            if (d == point) text[length++] = '.';
            text[length++] = (char)('0' + test_random(&state) % 10);
        }
        snprintf(text + length, sizeof text - length, "e%d", (int)(test_random(&state) % 100) - 65);
        check_text(text);
    }
}
END_TEST

/* Floats themselves, and the half-way points to their neighbours with all their digits, a little less, a little more.
 */
START_TEST(half_way_points_go_to_the_even_neighbour)
{
    uint64_t state = 2;
    for (int i = 0; i < 20000; ++i) {
        const uint32_t bits = (uint32_t)(test_random(&state) % 0x7F800000);
        const double middle = ((double)float_of(bits) + (double)float_of(bits + 1)) / 2; /* exact */
        char text[400];
        if (!isfinite(middle)) continue;
        snprintf(text, sizeof text, "%.150e", middle);
        check_text(text);
        text[strchr(text, 'e') - text - 1] = '1';
        check_text(text);
        snprintf(text, sizeof text, "%.17e", (double)float_of(bits));
        check_text(text);
        snprintf(text, sizeof text, "%.8e", middle);
        check_text(text);
    }
}
END_TEST

static void check_written(uint32_t bits)
{
    const float value = float_of(bits);
    char text[SPH__IO_FLOAT_TEXT], *end;
    const size_t length = sph__io_format_float(text, value);
    float back = -1;
    ck_assert_uint_eq(strlen(text), length);
    ck_assert_msg(bits_of(strtof(text, &end)) == bits && *end == '\0', "%.9g was written as %s", (double)value, text);
    ck_assert_ptr_eq(sph__io_parse_float(text, text + length, &back), text + length);
    ck_assert_uint_eq(bits_of(back), bits);
}

START_TEST(every_float_reads_back_as_it_was_written)
{
    uint64_t state = 3;
    for (int i = 0; i < 150000; ++i)
        check_written((uint32_t)test_random(&state) & 0xFF7FFFFF);
    for (uint32_t i = 0; i < 2000; ++i)
        check_written(i); /* the least */
    for (uint32_t i = 0; i < 2000; ++i)
        check_written(0x7F7FFFFF - i); /* the largest */
    for (uint32_t e = 1; e < 255; ++e) /* around powers of two */
        for (uint32_t i = 0; i < 3; ++i)
            check_written((e << 23) - 1 + i);
}
END_TEST

START_TEST(short_numbers_are_written_short)
{
    static const struct {
        float value;
        const char *text;
    } CASES[] = {{0, "0"},
                 {1, "1"},
                 {-1, "-1"},
                 {0.5f, "0.5"},
                 {-0.0f, "-0"},
                 {0.1f, "0.1"},
                 {100, "100"},
                 {123456, "123456"},
                 {1e9f, "1e+09"},
                 {1e-5f, "0.00001"},
                 {1e-6f, "1e-06"},
                 {1.5e-7f, "1.5e-07"},
                 {0.001f, "0.001"},
                 {1e8f, "100000000"},
                 {3.4028235e38f, "3.4028235e+38"},
                 {16777216, "16777216"},
                 {1.0f / 3, "0.33333334"}};
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; ++i) {
        char text[SPH__IO_FLOAT_TEXT];
        ck_assert_uint_eq(sph__io_format_float(text, CASES[i].value), strlen(CASES[i].text));
        ck_assert_str_eq(text, CASES[i].text);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("io numbers");
    TCase *tc = tcase_create("all");
    tcase_add_loop_test(tc, a_number_is_read_as_strtof_reads_it, 0, (int)(sizeof TEXTS / sizeof *TEXTS));
    tcase_add_test(tc, what_is_no_number_is_refused);
    tcase_add_test(tc, what_old_windows_libraries_print_is_read);
    tcase_add_test(tc, random_decimals_of_any_length_are_read_as_strtof_reads_them);
    tcase_add_test(tc, half_way_points_go_to_the_even_neighbour);
    tcase_add_test(tc, every_float_reads_back_as_it_was_written);
    tcase_add_test(tc, short_numbers_are_written_short);
    return run_suite(suite, tc);
}
