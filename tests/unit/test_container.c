/* SPDX-License-Identifier: MIT */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "base/container.h"
#include "runner.h"
#include "support.h"

static sph_context *context;
static unsigned char written[4096];
static size_t written_size;

static void setup(void)
{
    context = test_context();
    written_size = 0;
}

static void teardown(void)
{
    sph_context_destroy(context);
}

static sph_status keep(void *user, const void *bytes, size_t size)
{
    ck_assert_ptr_eq(user, written);
    ck_assert_uint_le(size, sizeof written - written_size);
    memcpy(written + written_size, bytes, size);
    written_size += size;
    return SPH_OK;
}

/* Bit by bit, straight from the definition. */
static uint32_t plain_crc(const unsigned char *bytes, size_t size)
{
    uint32_t value = 0xFFFFFFFF;
    for (size_t i = 0; i < size; ++i) {
        value ^= bytes[i];
        for (int bit = 0; bit < 8; ++bit)
            value = (value & 1) != 0 ? value >> 1 ^ 0x82F63B78 : value >> 1;
    }
    return ~value;
}

START_TEST(the_checksum_gives_the_known_values)
{
    sph__crc32c crc;
    unsigned char bytes[32];
    sph__crc32c_init(&crc);
    ck_assert_uint_eq(sph__crc32c_add(&crc, 0, "", 0), 0);
    ck_assert_uint_eq(sph__crc32c_add(&crc, 0, "123456789", 9), 0xE3069283); /* the usual check value */
    memset(bytes, 0, 32);                                                    /* these four: RFC 3720, B.4 */
    ck_assert_uint_eq(sph__crc32c_add(&crc, 0, bytes, 32), 0x8A9136AA);
    memset(bytes, 0xFF, 32);
    ck_assert_uint_eq(sph__crc32c_add(&crc, 0, bytes, 32), 0x62A8AB43);
    for (unsigned i = 0; i < 32; ++i)
        bytes[i] = (unsigned char)i;
    ck_assert_uint_eq(sph__crc32c_add(&crc, 0, bytes, 32), 0x46DD794E);
    for (unsigned i = 0; i < 32; ++i)
        bytes[i] = (unsigned char)(31 - i);
    ck_assert_uint_eq(sph__crc32c_add(&crc, 0, bytes, 32), 0x113FDB5C);
}
END_TEST

START_TEST(the_checksum_may_be_taken_in_parts)
{
    sph__crc32c crc;
    unsigned char bytes[61];
    uint64_t state = 1;
    sph__crc32c_init(&crc);
    for (size_t i = 0; i < sizeof bytes; ++i)
        bytes[i] = (unsigned char)test_random(&state);
    for (size_t i = 0; i <= sizeof bytes; ++i) {
        const uint32_t first = sph__crc32c_add(&crc, 0, bytes, i);
        ck_assert_uint_eq(sph__crc32c_add(&crc, first, bytes + i, sizeof bytes - i), plain_crc(bytes, sizeof bytes));
        ck_assert_uint_eq(first, plain_crc(bytes, i));
    }
}
END_TEST

static const uint32_t A = SPH__TAG('A', 'A', 'A', 'A'), B = SPH__TAG('B', 'B', 'B', 'B'),
                      C = SPH__TAG('C', 'C', 'C', 'C');
static const uint32_t NUMBERS[3] = {1, 0x01020304, 0xFFFFFFFF};
static const double REALS[2] = {1, -0.5};

static void write_sample(void)
{
    const sph__chunk chunks[] = {{A, 4, NUMBERS, 3, 0, 0}, {B, 8, REALS, 2, 0, 0}, {C, 1, NULL, 0, 0, 0}};
    ck_assert_int_eq(sph__container_write(context, SPH__CONTAINER_LEVEL, chunks, 3, keep, written), SPH_OK);
}

static void put(unsigned char *p, unsigned size, uint64_t value)
{
    for (unsigned i = 0; i < size; ++i)
        p[i] = (unsigned char)(value >> 8 * i);
}

/* The layout of docs/formats.md, byte by byte. */
START_TEST(a_container_is_laid_out_as_documented)
{
    unsigned char expected[144] = {0x89, 'S', 'P', 'H', 0x0D, 0x0A, 0x1A, 0x0A, 1, 0, 0, 0, 2, 0, 0, 0};
    put(expected + 16, 8, 144); /* 32 + 3 * 24 = 104, padded to 112; 12 padded to 16; 16; 0 */
    put(expected + 24, 4, 3);
    memcpy(expected + 32, "AAAA", 4);
    put(expected + 40, 8, 112);
    put(expected + 48, 8, 12);
    memcpy(expected + 56, "BBBB", 4);
    put(expected + 64, 8, 128);
    put(expected + 72, 8, 16);
    memcpy(expected + 80, "CCCC", 4);
    put(expected + 88, 8, 144);
    memcpy(expected + 112, "\1\0\0\0\4\3\2\1\xFF\xFF\xFF\xFF", 12);
    memcpy(expected + 128, "\0\0\0\0\0\0\xF0\x3F\0\0\0\0\0\0\xE0\xBF", 16);
    put(expected + 36, 4, plain_crc(expected + 112, 12));
    put(expected + 60, 4, plain_crc(expected + 128, 16));
    put(expected + 84, 4, plain_crc(expected, 0));
    {
        unsigned char head[100];
        memcpy(head, expected, 28);
        memcpy(head + 28, expected + 32, 72);
        put(expected + 28, 4, plain_crc(head, 100));
    }
    write_sample();
    ck_assert_uint_eq(written_size, sizeof expected);
    ck_assert_mem_eq(written, expected, sizeof expected);
}
END_TEST

START_TEST(what_was_written_is_read_at_any_alignment)
{
    sph__container container;
    uint32_t numbers[3];
    double reals[2];
    size_t count;
    unsigned char *shifted = test_malloc(4097, 1);
    write_sample();
    memcpy(shifted + 1, written, written_size);
    ck_assert_int_eq(sph__container_open(context, shifted + 1, written_size, SPH__CONTAINER_LEVEL, &container), SPH_OK);
    ck_assert_int_eq(sph__container_count(&container, A, 4, &count), SPH_OK);
    ck_assert_uint_eq(count, 3);
    ck_assert_int_eq(sph__container_copy(&container, A, 4, 3, numbers), SPH_OK);
    ck_assert_mem_eq(numbers, NUMBERS, sizeof NUMBERS);
    ck_assert_int_eq(sph__container_copy(&container, B, 8, 2, reals), SPH_OK);
    ck_assert_mem_eq(reals, REALS, sizeof REALS);
    ck_assert_int_eq(sph__container_copy(&container, C, 4, 0, numbers), SPH_OK);
    ck_assert_int_eq(sph__container_copy(&container, A, 4, 2, numbers), SPH_E_FORMAT);
    ck_assert_int_eq(sph__container_count(&container, A, 8, &count), SPH_E_FORMAT);
    ck_assert_int_eq(sph__container_count(&container, SPH__TAG('D', 'D', 'D', 'D'), 4, &count), SPH_E_FORMAT);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "DDDD"));
    free(shifted);
}
END_TEST

static sph_status open_copy(const unsigned char *bytes, size_t size)
{
    sph__container container;
    unsigned char *copy = malloc(size); /* exact: the address sanitizer sees a look beyond it */
    sph_status status;
    if (size != 0) memcpy(copy, bytes, size);
    status = sph__container_open(context, copy, size, SPH__CONTAINER_LEVEL, &container);
    free(copy);
    return status;
}

START_TEST(a_change_of_any_bit_is_noticed)
{
    write_sample();
    for (size_t i = 0; i < written_size; ++i)
        for (int bit = 0; bit < 8; ++bit) {
            sph_status status;
            written[i] ^= (unsigned char)(1 << bit);
            status = open_copy(written, written_size);
            ck_assert_msg(status == SPH_E_FORMAT || (i / 2 == 4 && status == SPH_E_VERSION), "byte %zu bit %d: %d", i,
                          bit, (int)status);
            ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "byte"));
            written[i] ^= (unsigned char)(1 << bit);
        }
}
END_TEST

START_TEST(a_container_of_any_other_length_is_refused)
{
    write_sample();
    for (size_t size = 0; size < written_size; ++size)
        ck_assert_int_eq(open_copy(written, size), SPH_E_FORMAT);
    ck_assert_int_eq(open_copy(written, written_size), SPH_OK);
    ck_assert_int_eq(open_copy(written, written_size + 1), SPH_E_FORMAT);
}
END_TEST

static void seal(void)
{
    unsigned char head[4096];
    memcpy(head, written, 28);
    memcpy(head + 28, written + 32, 72);
    put(written + 28, 4, plain_crc(head, 100));
}

/* Sizes that would wrap around, under a checksum that is right. */
START_TEST(absurd_sizes_are_refused)
{
    static const uint64_t SIZES[] = {UINT64_MAX, UINT64_MAX - 15, UINT64_MAX - 127, INT64_MAX, (uint64_t)1 << 32, 33,
                                     17};
    for (size_t i = 0; i < sizeof SIZES / sizeof *SIZES; ++i)
        for (size_t field = 40; field <= 72; field += 8) {
            written_size = 0;
            if (field == 56) continue; /* a name and a checksum */
            write_sample();
            put(written + field, 8, SIZES[i]);
            seal();
            ck_assert_int_eq(open_copy(written, written_size), SPH_E_FORMAT);
        }
    for (uint64_t count = 4; count <= UINT32_MAX; count *= 3) {
        written_size = 0;
        write_sample();
        put(written + 24, 4, count);
        seal();
        ck_assert_int_eq(open_copy(written, written_size), SPH_E_FORMAT);
    }
}
END_TEST

START_TEST(a_chunk_may_not_come_twice)
{
    write_sample();
    memcpy(written + 80, "AAAA", 4);
    seal();
    ck_assert_int_eq(open_copy(written, written_size), SPH_E_FORMAT);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "second"));
}
END_TEST

START_TEST(newer_versions_are_told_apart_from_damage)
{
    write_sample();
    put(written + 10, 2, 7); /* minor */
    seal();
    ck_assert_int_eq(open_copy(written, written_size), SPH_OK);
    put(written + 8, 2, 2); /* major: nothing after it needs to make sense */
    ck_assert_int_eq(open_copy(written, written_size), SPH_E_VERSION);
    ck_assert_int_eq(open_copy(written, 32), SPH_E_VERSION);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "version 2.7"));
}
END_TEST

START_TEST(a_transfer_as_text_is_named)
{
    unsigned char text[200];
    write_sample();
    memcpy(text, written, 4);
    memcpy(text + 4, written + 5, written_size - 5); /* CR LF became LF */
    ck_assert_int_eq(open_copy(text, written_size - 1), SPH_E_FORMAT);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "text"));
    memcpy(text, written, written_size);
    text[0] &= 0x7F; /* seven bits */
    ck_assert_int_eq(open_copy(text, written_size), SPH_E_FORMAT);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "text"));
}
END_TEST

START_TEST(another_kind_is_refused_by_name)
{
    sph__container container;
    write_sample();
    ck_assert_int_eq(sph__container_open(context, written, written_size, SPH__CONTAINER_HIERARCHY, &container),
                     SPH_E_FORMAT);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "a level, not a hierarchy"));
}
END_TEST

static sph_status stop(void *user, const void *bytes, size_t size)
{
    size_t *left = user;
    (void)bytes;
    (void)size;
    return (*left)-- == 0 ? SPH_E_CANCELLED : SPH_OK;
}

START_TEST(what_the_writer_answers_is_handed_on)
{
    const sph__chunk chunks[] = {{A, 4, NUMBERS, 3, 0, 0}, {B, 8, REALS, 2, 0, 0}};
    for (size_t calls = 0;; ++calls) {
        size_t left = calls;
        const sph_status status = sph__container_write(context, SPH__CONTAINER_LEVEL, chunks, 2, stop, &left);
        if (status == SPH_OK) {
            ck_assert_uint_ge(calls, 3);
            return;
        }
        ck_assert_int_eq(status, SPH_E_CANCELLED);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("container");
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_test(tc, the_checksum_gives_the_known_values);
    tcase_add_test(tc, the_checksum_may_be_taken_in_parts);
    tcase_add_test(tc, a_container_is_laid_out_as_documented);
    tcase_add_test(tc, what_was_written_is_read_at_any_alignment);
    tcase_add_test(tc, a_change_of_any_bit_is_noticed);
    tcase_add_test(tc, a_container_of_any_other_length_is_refused);
    tcase_add_test(tc, absurd_sizes_are_refused);
    tcase_add_test(tc, a_chunk_may_not_come_twice);
    tcase_add_test(tc, newer_versions_are_told_apart_from_damage);
    tcase_add_test(tc, a_transfer_as_text_is_named);
    tcase_add_test(tc, another_kind_is_refused_by_name);
    tcase_add_test(tc, what_the_writer_answers_is_handed_on);
    return run_suite(suite, tc);
}
