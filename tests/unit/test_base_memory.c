/* SPDX-License-Identifier: MIT */
/* Options of callers of any age, and memory. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "base/base.h"
#include "runner.h"
#include "support.h"

/* --- options --- */

/* A struct as it was at first, and as it has grown twice. */
typedef struct grown {
    uint32_t struct_size;
    uint32_t flags;
    double first;
    double late; /* appended */
    uint64_t latest;
} grown;
enum { GROWN_V1 = offsetof(grown, late) };
static const grown GROWN_DEFAULTS = {sizeof(grown), 0, 1.5, 2.5, 7};

START_TEST(an_older_callers_struct_is_not_overrun_and_gets_defaults)
{
    grown in, out = GROWN_DEFAULTS;
    memset(&in, 0xee, sizeof in);
    sph__options_init(&in, GROWN_V1, &GROWN_DEFAULTS, sizeof in, GROWN_V1);
    ck_assert_uint_eq(in.struct_size, GROWN_V1);
    ck_assert(in.first == 1.5);
    for (size_t i = GROWN_V1; i < sizeof in; ++i)
        ck_assert_uint_eq(((unsigned char *)&in)[i], 0xee);
    in.first = 9;
    ck_assert_int_eq(sph__options_read(NULL, "grown", &in, &out, sizeof out, GROWN_V1), SPH_OK);
    ck_assert(out.first == 9 && out.late == 2.5 && out.latest == 7);
    ck_assert_uint_eq(out.struct_size, sizeof out);
}
END_TEST

START_TEST(a_newer_callers_tail_must_be_unset)
{
    struct {
        grown known;
        uint64_t unknown;
    } in;
    sph_context *context = test_context();
    grown out = GROWN_DEFAULTS;
    memset(&in, 0xee, sizeof in);
    sph__options_init(&in, sizeof in, &GROWN_DEFAULTS, sizeof in.known, GROWN_V1);
    ck_assert_uint_eq(in.known.struct_size, sizeof in);
    ck_assert_uint_eq(in.unknown, 0);
    in.known.latest = 8;
    ck_assert_int_eq(sph__options_read(context, "grown", &in, &out, sizeof out, GROWN_V1), SPH_OK);
    ck_assert_uint_eq(out.latest, 8);
    for (size_t byte = 0; byte < sizeof in.unknown; ++byte) {
        in.unknown = UINT64_C(1) << 8 * byte;
        ck_assert_int_eq(sph__options_read(context, "grown", &in, &out, sizeof out, GROWN_V1), SPH_E_VERSION);
        ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "grown"));
    }
    sph_context_destroy(context);
}
END_TEST

START_TEST(structs_that_were_not_initialised_are_refused)
{
    grown in = {0}, out = GROWN_DEFAULTS;
    ck_assert_int_eq(sph__options_read(NULL, "grown", NULL, &out, sizeof out, GROWN_V1), SPH_OK);
    ck_assert_int_eq(sph__options_read(NULL, "grown", &in, &out, sizeof out, GROWN_V1), SPH_E_INVALID);
    in.struct_size = GROWN_V1 - 1;
    ck_assert_int_eq(sph__options_read(NULL, "grown", &in, &out, sizeof out, GROWN_V1), SPH_E_INVALID);
    in.struct_size = UINT32_MAX; /* rubbish: would be read far beyond its end */
    ck_assert_int_eq(sph__options_read(NULL, "grown", &in, &out, sizeof out, GROWN_V1), SPH_E_INVALID);
    ck_assert_mem_eq(&out, &GROWN_DEFAULTS, sizeof out);
    sph__options_init(&in, GROWN_V1 - 1, &GROWN_DEFAULTS, sizeof in, GROWN_V1);
    sph__options_init(&in, SIZE_MAX, &GROWN_DEFAULTS, sizeof in, GROWN_V1);
    ck_assert_uint_eq(in.struct_size, UINT32_MAX);
    sph__options_init(NULL, sizeof in, &GROWN_DEFAULTS, sizeof in, GROWN_V1);
}
END_TEST

static void *some_allocate(void *user, size_t size, size_t alignment)
{
    (void)user;
    return aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

START_TEST(context_create_refuses_bad_options)
{
    sph_context_options good, o;
    sph_context *context = (sph_context *)&o;
    sph_context_options_init(&good, sizeof good);
    ck_assert_uint_eq(good.struct_size, sizeof good);
#define ck_refused(change)                                                                                             \
    do {                                                                                                               \
        o = good;                                                                                                      \
        change;                                                                                                        \
        context = (sph_context *)&o;                                                                                   \
        ck_assert_int_eq(sph_context_create(&o, &context), SPH_E_INVALID);                                             \
        ck_assert_ptr_null(context);                                                                                   \
    } while (0)
    ck_refused(memset(&o, 0, sizeof o));
    ck_refused(o.flags = 1);
    ck_refused(o.reserved0 = 1);
    ck_refused(o.allocator.allocate = some_allocate);
    ck_refused(o.allocator.user = &o);
    ck_refused(o.executor.user = &o);
    ck_refused(o.thread_count = 257);
    ck_assert_int_eq(sph_context_create(&good, NULL), SPH_E_INVALID);
    sph_context_destroy(NULL);
}
END_TEST

/* --- memory --- */

START_TEST(context_creation_may_run_out_of_memory)
{
    for (size_t n = 1;; ++n) {
        test_faulty faulty = {.fail_at = n, .sticky = _i == 1};
        sph_context_options o;
        sph_context *context;
        sph_status status;
        sph_context_options_init(&o, sizeof o);
        o.allocator = test_faulty_allocator(&faulty);
        o.thread_count = 3;
        status = sph_context_create(&o, &context);
        if (faulty.calls >= n) {
            ck_assert_int_eq(status, SPH_E_NOMEM);
            ck_assert_ptr_null(context);
        }
        sph_context_destroy(context);
        ck_assert_uint_eq(faulty.live_blocks, 0);
        ck_assert(!faulty.misused);
        if (faulty.calls < n) {
            ck_assert_int_eq(status, SPH_OK);
            ck_assert_uint_gt(n, 2);
            return;
        }
    }
}
END_TEST

START_TEST(sizes_that_overflow_are_out_of_memory)
{
    test_faulty faulty = {0};
    const sph_allocator allocator = test_faulty_allocator(&faulty);
    sph_context *context = test_context_with_allocator(&allocator);
    const size_t calls = faulty.calls;
    size_t product;
    ck_assert_ptr_null(sph__alloc(context, SIZE_MAX, 2));
    ck_assert_ptr_null(sph__alloc(context, SIZE_MAX / 2 + 1, 2));
    ck_assert_ptr_null(sph__alloc(context, SIZE_MAX, 1));
    ck_assert_ptr_null(sph__alloc(context, SIZE_MAX - SPH__ALIGN + 1, 1));
    ck_assert_ptr_null(sph__alloc(context, PTRDIFF_MAX, 1));
    ck_assert_ptr_null(sph__zalloc(context, SIZE_MAX, SIZE_MAX));
    ck_assert_ptr_null(sph_context_allocate(context, SIZE_MAX / 3, 4));
    ck_assert_ptr_null(sph_context_allocate(NULL, 1, 1));
    ck_assert_uint_eq(faulty.calls, calls); /* the host is not asked */
    ck_assert(sph__multiply_size(SIZE_MAX, 1, &product) && product == SIZE_MAX);
    ck_assert(sph__multiply_size(0, SIZE_MAX, &product) && product == 0);
    ck_assert(!sph__multiply_size((size_t)1 << 32, (size_t)1 << (sizeof(size_t) * 8 - 32), &product));
    sph_context_release(context, NULL);
    sph_context_destroy(context);
    ck_assert_uint_eq(faulty.live_blocks, 0);
}
END_TEST

START_TEST(memory_is_aligned_zeroed_and_grows)
{
    test_faulty faulty = {0};
    const sph_allocator allocator = test_faulty_allocator(&faulty);
    sph_context *context = test_context_with_allocator(&allocator);
    void *empty = sph__alloc(context, 0, 8);
    unsigned char *bytes = sph__zalloc(context, 100, 1);
    void *array = NULL;
    size_t capacity = 0;
    ck_assert_ptr_nonnull(empty);
    ck_assert_uint_eq((uintptr_t)bytes % 64, 0);
    for (size_t i = 0; i < 100; ++i)
        ck_assert_uint_eq(bytes[i], 0);
    for (size_t i = 0; i < 100; ++i)
        bytes[i] = (unsigned char)i;
    bytes = sph__realloc(context, bytes, 1000, 1);
    for (size_t i = 0; i < 100; ++i)
        ck_assert_uint_eq(bytes[i], i);
    bytes = sph__realloc(context, bytes, 10, 1);
    for (size_t i = 0; i < 10; ++i)
        ck_assert_uint_eq(bytes[i], i);
    ck_assert_ptr_null(sph__realloc(context, bytes, SIZE_MAX, 2));
    ck_assert_uint_eq(bytes[9], 9);
    for (size_t n = 1; n < 1000; ++n) {
        ck_assert(sph__reserve(context, &array, &capacity, n, sizeof(size_t)));
        ck_assert_uint_ge(capacity, n);
        ((size_t *)array)[n - 1] = n;
    }
    for (size_t n = 1; n < 1000; ++n)
        ck_assert_uint_eq(((size_t *)array)[n - 1], n);
    ck_assert(!sph__reserve(context, &array, &capacity, SIZE_MAX, sizeof(size_t)));
    ck_assert_uint_ge(capacity, 999);
    ck_assert_uint_eq(((size_t *)array)[998], 999);
    ck_assert_uint_lt(faulty.calls, 30); /* it doubles */
    sph__free(context, array);
    sph__free(context, bytes);
    sph__free(context, empty);
    sph__free(context, NULL);
    sph_context_destroy(context);
    ck_assert(faulty.live_blocks == 0 && !faulty.misused);
}
END_TEST

START_TEST(the_last_handle_takes_the_context_along)
{
    test_faulty faulty = {0};
    const sph_allocator allocator = test_faulty_allocator(&faulty);
    sph_context *context = test_context_with_allocator(&allocator);
    ck_assert_ptr_eq(sph__context_retain(context), context);
    sph_context_destroy(context);
    ck_assert_uint_gt(faulty.live_blocks, 0);
    ck_assert_int_eq(sph_context_fail(context, SPH_E_IO, "alive"), SPH_E_IO);
    sph__context_release(context);
    ck_assert_uint_eq(faulty.live_blocks, 0);
    sph__context_release(NULL);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("base memory");
    TCase *tc = tcase_create("options and memory");
    tcase_add_test(tc, an_older_callers_struct_is_not_overrun_and_gets_defaults);
    tcase_add_test(tc, a_newer_callers_tail_must_be_unset);
    tcase_add_test(tc, structs_that_were_not_initialised_are_refused);
    tcase_add_test(tc, context_create_refuses_bad_options);
    tcase_add_loop_test(tc, context_creation_may_run_out_of_memory, 0, 2);
    tcase_add_test(tc, sizes_that_overflow_are_out_of_memory);
    tcase_add_test(tc, memory_is_aligned_zeroed_and_grows);
    tcase_add_test(tc, the_last_handle_takes_the_context_along);
    return run_suite(suite, tc);
}
