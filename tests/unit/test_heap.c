/* SPDX-License-Identifier: MIT */
#include <check.h>
#include <math.h>
#include <stdlib.h>

#include "faults.h"
#include "numeric/heap.h"
#include "runner.h"

enum { ITEMS = 300, STEPS = 60000 };

static sph_context *context;
static uint64_t state;

static void setup(void)
{
    state = 88172645463325252u;
    ck_assert_int_eq(sph_context_create(NULL, &context), SPH_OK);
}

static void teardown(void)
{
    sph_context_destroy(context);
}

typedef struct entry {
    double key;
    uint64_t tie;
    uint32_t item;
    bool present;
} entry;

static int compare_entries(const void *left, const void *right)
{
    const entry *a = left, *b = right;
    if (isnan(a->key) != isnan(b->key)) return isnan(a->key) ? 1 : -1;
    if (!isnan(a->key) && a->key != b->key) return a->key < b->key ? -1 : 1;
    if (a->tie != b->tie) return a->tie < b->tie ? -1 : 1;
    return (a->item > b->item) - (a->item < b->item);
}

/* Few different keys and ties, so that every kind of tie happens; with infinities, both zeros and NaN. */
static entry random_entry(uint32_t item)
{
    static const double special[] = {0.0, -0.0, INFINITY, -INFINITY, (double)NAN, 1e-308, -1e308, 1.0};
    const uint64_t dice = test_random(&state) % 24;
    const double key = dice < 8 ? special[dice] : (double)(test_random(&state) % 9) - 4.0;
    return (entry){.key = key, .tie = (test_random(&state) % 3) << 32 | test_random(&state) % 3, .item = item, .present = true};
}

START_TEST(items_come_out_as_qsort_orders_them)
{
    static entry expected[ITEMS];
    sph__heap heap;
    sph__heap_init(&heap, context);
    for (uint32_t i = 0; i < ITEMS; ++i) {
        expected[i] = random_entry(i);
        ck_assert_int_eq(sph__heap_set(&heap, i, expected[i].key, expected[i].tie), SPH_OK);
    }
    qsort(expected, ITEMS, sizeof *expected, compare_entries);
    for (uint32_t i = 0; i < ITEMS; ++i) {
        uint32_t top, item;
        ck_assert_uint_eq(sph__heap_count(&heap), ITEMS - i);
        ck_assert(sph__heap_top(&heap, &top));
        ck_assert(sph__heap_pop(&heap, &item));
        ck_assert_uint_eq(top, item);
        ck_assert_uint_eq(item, expected[i].item);
    }
    ck_assert(!sph__heap_pop(&heap, NULL));
    sph__heap_free(&heap);
}
END_TEST

static void check_against(const sph__heap *heap, const entry *entries)
{
    const entry *best = NULL;
    uint32_t top = 12345;
    size_t count = 0;
    for (uint32_t i = 0; i < ITEMS; ++i) {
        if (!entries[i].present) continue;
        ++count;
        if (best == NULL || compare_entries(&entries[i], best) < 0) best = &entries[i];
    }
    ck_assert_uint_eq(sph__heap_count(heap), count);
    ck_assert_int_eq(sph__heap_top(heap, &top), best != NULL);
    ck_assert_uint_eq(top, best != NULL ? best->item : 12345);
}

START_TEST(the_first_items_are_those_that_qsort_puts_first)
{
    static entry expected[ITEMS];
    static uint32_t first[SPH__HEAP_FIRST + 1];
    sph__heap heap;
    sph__heap_init(&heap, context);
    ck_assert_uint_eq(sph__heap_first(&heap, first, 5), 0);
    for (uint32_t i = 0; i < ITEMS; ++i) {
        expected[i] = random_entry(i);
        ck_assert_int_eq(sph__heap_set(&heap, i, expected[i].key, expected[i].tie), SPH_OK);
        if (i == 2) ck_assert_uint_eq(sph__heap_first(&heap, first, 5), 3);
    }
    qsort(expected, ITEMS, sizeof *expected, compare_entries);
    for (size_t most = 0; most <= SPH__HEAP_FIRST; most += most < 8 ? 1 : 31) {
        ck_assert_uint_eq(sph__heap_first(&heap, first, most), most);
        for (size_t i = 0; i < most; ++i)
            ck_assert_uint_eq(first[i], expected[i].item);
    }
    ck_assert_uint_eq(sph__heap_first(&heap, first, ITEMS), SPH__HEAP_FIRST);
    ck_assert_uint_eq(sph__heap_count(&heap), ITEMS);
    sph__heap_free(&heap);
}
END_TEST

START_TEST(items_added_at_once_come_out_in_the_same_order)
{
    static entry expected[ITEMS];
    sph__heap heap;
    sph__heap_init(&heap, context);
    ck_assert_int_eq(sph__heap_reserve(&heap, ITEMS), SPH_OK);
    sph__heap_order(&heap);
    for (uint32_t i = 0; i < ITEMS; ++i) {
        expected[i] = random_entry(i);
        sph__heap_append(&heap, i, expected[i].key, expected[i].tie);
        if (i % 60 == 1) sph__heap_order(&heap);
    }
    sph__heap_order(&heap);
    qsort(expected, ITEMS, sizeof *expected, compare_entries);
    for (uint32_t i = 0; i < ITEMS; ++i) {
        uint32_t item;
        ck_assert(sph__heap_pop(&heap, &item));
        ck_assert_uint_eq(item, expected[i].item);
    }
    ck_assert_uint_eq(sph__heap_count(&heap), 0);
    sph__heap_free(&heap);
}
END_TEST

START_TEST(any_mixture_of_operations_agrees_with_a_plain_array)
{
    static entry entries[ITEMS];
    sph__heap heap;
    memset(entries, 0, sizeof entries);
    sph__heap_init(&heap, context);
    for (int step = 0; step < STEPS; ++step) {
        const uint32_t item = (uint32_t)(test_random(&state) % ITEMS);
        const uint64_t what = test_random(&state) % 1000;
        if (what < 550) {
            entries[item] = random_entry(item);
            ck_assert_int_eq(sph__heap_set(&heap, item, entries[item].key, entries[item].tie), SPH_OK);
            ck_assert(sph__heap_contains(&heap, item));
        } else if (what < 800) {
            ck_assert_int_eq(sph__heap_remove(&heap, item), entries[item].present);
            entries[item].present = false;
        } else if (what < 999) {
            uint32_t popped;
            if (sph__heap_pop(&heap, &popped)) entries[popped].present = false;
        } else {
            sph__heap_clear(&heap);
            memset(entries, 0, sizeof entries);
        }
        ck_assert_int_eq(sph__heap_contains(&heap, item), entries[item].present);
        if (entries[item].present && !isnan(entries[item].key))
            ck_assert_double_eq(sph__heap_key(&heap, item), entries[item].key);
        else
            ck_assert_double_nan(sph__heap_key(&heap, item));
        check_against(&heap, entries);
    }
    sph__heap_free(&heap);
    ck_assert_uint_eq(sph__heap_count(&heap), 0);
    ck_assert_int_eq(sph__heap_set(&heap, 3, 1.0, 0), SPH_OK);
    sph__heap_free(&heap);
}
END_TEST

START_TEST(items_never_seen_are_absent_and_the_last_number_is_refused)
{
    sph__heap heap;
    uint32_t item = 7;
    sph__heap_init(&heap, context);
    ck_assert(!sph__heap_top(&heap, &item));
    ck_assert(!sph__heap_remove(&heap, 5));
    ck_assert(!sph__heap_contains(&heap, UINT32_MAX));
    ck_assert_int_eq(sph__heap_set(&heap, UINT32_MAX, 0.0, 0), SPH_E_LIMIT);
    ck_assert_str_ne(sph_context_last_message(context), "");
    sph__heap_clear(&heap);
    ck_assert_uint_eq(item, 7);
    sph__heap_free(&heap);
}
END_TEST

/* Fills a heap; where an insertion fails, the heap must be as before and still work. `user` says whether places are
 * reserved. */
static sph_status fill(sph_context *fallible, const void *user)
{
    const bool reserve = *(const bool *)user;
    sph__heap heap;
    sph_status status = SPH_OK;
    uint32_t inserted = 0, item;
    sph__heap_init(&heap, fallible);
    if (reserve) status = sph__heap_reserve(&heap, 500);
    for (; status == SPH_OK && inserted < 500; ++inserted) {
        status = sph__heap_set(&heap, inserted, -(double)inserted, 0);
        if (status != SPH_OK) break;
        ck_assert(!reserve || heap.place_capacity == 500);
    }
    ck_assert_uint_eq(sph__heap_count(&heap), inserted);
    for (uint32_t i = inserted; i > 0; --i) {
        ck_assert(sph__heap_pop(&heap, &item));
        ck_assert_uint_eq(item, i - 1);
    }
    sph__heap_free(&heap);
    return status;
}

START_TEST(every_allocation_may_fail)
{
    const bool reserve = _i >= 2;
    check_every_allocation((test_faults){.work = fill, .user = &reserve, .least = 3, .sticky = _i % 2});
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("heap");
    TCase *tests = tcase_create("heap");
    tcase_add_checked_fixture(tests, setup, teardown);
    tcase_add_test(tests, items_come_out_as_qsort_orders_them);
    tcase_add_test(tests, the_first_items_are_those_that_qsort_puts_first);
    tcase_add_test(tests, items_added_at_once_come_out_in_the_same_order);
    tcase_add_test(tests, any_mixture_of_operations_agrees_with_a_plain_array);
    tcase_add_test(tests, items_never_seen_are_absent_and_the_last_number_is_refused);
    tcase_add_loop_test(tests, every_allocation_may_fail, 0, 4);
    suite_add_tcase(suite, tests);
    return run_all(suite);
}
