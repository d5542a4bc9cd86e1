/* SPDX-License-Identifier: MIT */
/* Memory in a temporary file: blocks keep what is in them, whatever is taken away, and nothing is left behind. */
#include <check.h>
#include <string.h>

#include "faults.h"
#include "files.h"
#include "runner.h"
#include "support.h"

enum { MEBIBYTE = 1 << 20, LIMIT = 16 * MEBIBYTE };

static test_faulty faulty;
static sph_context *plain;
static sph_io_spill *spill;
static sph_allocator memory;

static sph_io_spill_options options(const char *folder)
{
    sph_io_spill_options o;
    sph_io_spill_options_init(&o, sizeof o);
    o.memory_limit = LIMIT;
    o.folder = folder;
    return o;
}

static void open_spill(void)
{
    const sph_io_spill_options o = options("/var/tmp"); /* the folder of the tests may be in memory */
    ck_assert_int_eq(sph_io_spill_create(plain, &o, &spill), SPH_OK);
    sph_io_spill_get_allocator(spill, &memory);
}

static void setup(void)
{
    sph_allocator counted;
    faulty = (test_faulty){0};
    counted = test_faulty_allocator(&faulty);
    plain = test_context_with_allocator(&counted);
    spill = NULL;
    files_setup();
}

static void teardown(void)
{
    sph_io_spill_destroy(spill);
    sph_context_destroy(plain);
    ck_assert_uint_eq(faulty.live_blocks, 0);
    ck_assert(!faulty.misused);
    files_teardown();
}

static sph_io_spill_figures figures(void)
{
    sph_io_spill_figures f = {.struct_size = sizeof f};
    ck_assert_int_eq(sph_io_spill_get_figures(spill, &f), SPH_OK);
    return f;
}

/* --- blocks by hand --- */

typedef struct block {
    unsigned char *bytes;
    size_t size;
    uint64_t seed;
} block;

static void fill(block *b)
{
    uint64_t state = b->seed;
    for (size_t i = 0; i + 8 <= b->size; i += 8) {
        const uint64_t word = test_random(&state);
        memcpy(b->bytes + i, &word, 8);
    }
}

static void check(const block *b)
{
    uint64_t state = b->seed;
    size_t wrong = 0;
    for (size_t i = 0; i + 8 <= b->size; i += 8) {
        const uint64_t word = test_random(&state);
        wrong += memcmp(b->bytes + i, &word, 8) != 0;
    }
    ck_assert_uint_eq(wrong, 0);
}

static block take(size_t size, uint64_t seed)
{
    block b = {memory.allocate(memory.user, size, 64), size, seed};
    ck_assert_ptr_nonnull(b.bytes);
    ck_assert_uint_eq((uintptr_t)b.bytes % 64, 0);
    fill(&b);
    return b;
}

START_TEST(blocks_keep_what_is_in_them_through_a_long_life)
{
    enum { BLOCKS = 40, ROUNDS = 600 };
    block blocks[BLOCKS] = {{0}};
    uint64_t state = 1, live = 0, most = 0;
    open_spill();
    for (int round = 0; round < ROUNDS; ++round) {
        block *b = &blocks[test_random(&state) % BLOCKS];
        if (b->bytes != NULL) {
            check(b);
            memory.release(memory.user, b->bytes, b->size);
            live -= b->size;
            *b = (block){0};
        } else {
            /* from a word to three megabytes, on both sides of what goes to the file */
            *b = take((size_t)8 << test_random(&state) % 18, round);
            live += b->size;
            most = live > most ? live : most;
        }
        if (round % 50 == 0) sph_io_spill_trim(spill);
    }
    for (int i = 0; i < BLOCKS; ++i) {
        if (blocks[i].bytes == NULL) continue;
        check(&blocks[i]);
        memory.release(memory.user, blocks[i].bytes, blocks[i].size);
    }
    ck_assert_uint_eq(figures().live_bytes, 0);
    ck_assert_uint_le(figures().peak_live_bytes, most);
    ck_assert_uint_gt(figures().peak_live_bytes, 0);
    /* what is given back is used again: the file holds what was alive at once, and its gaps */
    ck_assert_uint_le(figures().file_bytes, 2 * most + 16 * MEBIBYTE);
}
END_TEST

START_TEST(much_more_than_the_limit_stays_readable_while_little_is_resident)
{
    enum { BLOCKS = 96 };
    block blocks[BLOCKS];
    open_spill();
    for (int i = 0; i < BLOCKS; ++i)
        blocks[i] = take(MEBIBYTE, (uint64_t)i);
    sph_io_spill_trim(spill);
    ck_assert_uint_gt(figures().trims, 0);
    ck_assert_uint_lt(figures().resident_bytes, (uint64_t)BLOCKS * MEBIBYTE / 2);
    for (int i = BLOCKS; i-- > 0;)
        check(&blocks[i]);
    for (int i = 0; i < BLOCKS; ++i)
        memory.release(memory.user, blocks[i].bytes, blocks[i].size);
}
END_TEST

static void fill_range(void *argument, size_t begin, size_t end)
{
    block *blocks = argument;
    for (size_t i = begin; i < end; ++i)
        blocks[i] = take(200000 + i, i);
}

START_TEST(threads_take_blocks_at_once)
{
    enum { BLOCKS = 64 };
    block blocks[BLOCKS];
    sph_executor executor;
    open_spill();
    sph_io_spill_get_executor(spill, &executor);
    executor.parallel_for(executor.user, BLOCKS, 1, fill_range, blocks);
    for (int i = 0; i < BLOCKS; ++i) {
        check(&blocks[i]);
        memory.release(memory.user, blocks[i].bytes, blocks[i].size);
    }
    ck_assert_uint_eq(figures().live_bytes, 0);
}
END_TEST

/* --- hierarchies --- */

typedef struct bytes {
    unsigned char *at;
    size_t size;
} bytes;

static sph_status append(void *user, const void *from, size_t size)
{
    bytes *to = user;
    to->at = realloc(to->at, to->size + size);
    ck_assert_ptr_nonnull(to->at);
    memcpy(to->at + to->size, from, size);
    to->size += size;
    return SPH_OK;
}

static bytes build(sph_context *context)
{
    sph_animation *torus = test_torus(context, 30, 20, 40);
    sph_hierarchy *h = NULL;
    bytes result = {0};
    ck_assert_int_eq(sph_hierarchy_create(torus, NULL, &h), SPH_OK);
    ck_assert_int_eq(sph_hierarchy_write(h, append, &result), SPH_OK);
    sph_hierarchy_destroy(h);
    sph_animation_destroy(torus);
    return result;
}

START_TEST(a_hierarchy_is_the_same_to_the_bit)
{
    sph_context_options o;
    sph_context *limited;
    bytes here, there;
    open_spill();
    sph_context_options_init(&o, sizeof o);
    sph_io_spill_get_allocator(spill, &o.allocator);
    sph_io_spill_get_executor(spill, &o.executor);
    ck_assert_int_eq(sph_context_create(&o, &limited), SPH_OK);
    here = build(limited);
    there = build(plain);
    ck_assert_uint_gt(figures().peak_live_bytes, 0);
    ck_assert_uint_eq(here.size, there.size);
    ck_assert_mem_eq(here.at, there.at, here.size);
    free(here.at);
    free(there.at);
    sph_context_destroy(limited);
    ck_assert_uint_eq(figures().live_bytes, 0);
}
END_TEST

/* --- what goes wrong --- */

START_TEST(what_cannot_be_had_is_null_and_the_message_says_why)
{
    open_spill();
    ck_assert_ptr_null(memory.allocate(memory.user, SIZE_MAX / 4, 64));
    ck_assert_str_ne(sph_context_last_message(plain), "");
    ck_assert_uint_eq(figures().live_bytes, 0);
}
END_TEST

static void refused(const sph_io_spill_options *o, sph_status expected, const char *words)
{
    spill = (sph_io_spill *)&faulty;
    ck_assert_int_eq(sph_io_spill_create(plain, o, &spill), expected);
    ck_assert_ptr_null(spill);
    ck_assert_msg(strstr(sph_context_last_message(plain), words) != NULL, "'%s' has no '%s'",
                  sph_context_last_message(plain), words);
}

START_TEST(options_that_make_no_sense_are_refused_and_named)
{
    struct {
        sph_io_spill_options known;
        uint64_t later;
    } newer = {.later = 1};
    sph_io_spill_options o = options(file_path("none"));
    refused(&o, SPH_E_IO, file_path("none"));
    o = options(file_text("file", "text"));
    refused(&o, SPH_E_IO, "Not a directory");
    o = options(NULL);
    o.memory_limit = SPH_IO_SPILL_LEAST - 1;
    refused(&o, SPH_E_INVALID, "16777215");
    o = options(NULL);
    o.least_size = 0;
    refused(&o, SPH_E_INVALID, "least_size");
    o = options(NULL);
    o.flags = 1;
    refused(&o, SPH_E_INVALID, "flags");
    o = (sph_io_spill_options){0};
    refused(&o, SPH_E_INVALID, "initialised");
    newer.known = options(NULL);
    newer.known.struct_size = sizeof newer;
    refused(&newer.known, SPH_E_VERSION, "does not know");
    refused(NULL, SPH_E_INVALID, "NULL");
    o = options(NULL);
    ck_assert_int_eq(sph_io_spill_create(plain, &o, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_spill_create(NULL, &o, &spill), SPH_E_INVALID);
    ck_assert_int_eq(sph_io_spill_get_figures(NULL, NULL), SPH_E_INVALID);
    sph_io_spill_destroy(NULL);
    sph_io_spill_trim(NULL);
}
END_TEST

static sph_status create_and_destroy(sph_context *own, const void *user)
{
    const sph_io_spill_options o = options("/var/tmp");
    sph_io_spill *made = NULL;
    const sph_status status = sph_io_spill_create(own, &o, &made);
    (void)user;
    ck_assert((made != NULL) == (status == SPH_OK));
    sph_io_spill_destroy(made);
    return status;
}

START_TEST(every_allocation_of_a_spill_may_fail)
{
    check_every_allocation((test_faults){.work = create_and_destroy, .least = 3, .sticky = _i});
}
END_TEST

int main(void)
{
    TCase *tc = tcase_create("spill");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_test(tc, blocks_keep_what_is_in_them_through_a_long_life);
    tcase_add_test(tc, much_more_than_the_limit_stays_readable_while_little_is_resident);
    tcase_add_test(tc, threads_take_blocks_at_once);
    tcase_add_test(tc, a_hierarchy_is_the_same_to_the_bit);
    tcase_add_test(tc, what_cannot_be_had_is_null_and_the_message_says_why);
    tcase_add_test(tc, options_that_make_no_sense_are_refused_and_named);
    tcase_add_loop_test(tc, every_allocation_of_a_spill_may_fail, 0, 2);
    return run_suite(suite_create("io_spill"), tc);
}
