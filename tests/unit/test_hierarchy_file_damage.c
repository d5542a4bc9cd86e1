/* SPDX-License-Identifier: MIT */
/* Hierarchies of damaged bytes: none, however made, that a later call could stumble over. */
#include <stdio.h>
#include <stdlib.h>

#include "base/container.h"
#include "hierarchy_case.h"
#include "hierarchy_file_case.h"
#include "runner.h"

/* Walks all of what was read: under the sanitizers nothing may happen. */
static void walk(const sph_hierarchy *h)
{
    const uint32_t n = sph_hierarchy_vertex_count(h), least = n - sph_hierarchy_collapse_count(h);
    sph_cursor *cursor;
    ck_assert_int_eq(sph_cursor_create(h, &cursor), SPH_OK);
    for (int round = 0; round < 2; ++round)
        for (int up = 0; up < 2; ++up) {
            uint32_t *nodes, *edges, *triangles;
            ck_assert_int_eq(sph_cursor_move(cursor, up ? n : least), SPH_OK);
            ck_assert_int_eq(sph_cursor_move(cursor, (n + least) / 2), SPH_OK);
            nodes = test_malloc(n, 4);
            edges = test_malloc(sph_cursor_edge_count(cursor) + 1, 8);
            triangles = test_malloc(sph_cursor_triangle_count(cursor) + 1, 12);
            ck_assert_int_eq(sph_cursor_read(cursor, nodes, edges, triangles), SPH_OK);
            for (size_t i = 0; i < 3 * sph_cursor_triangle_count(cursor); ++i)
                ck_assert_uint_lt(triangles[i], 2 * n - least);
            free(nodes);
            free(edges);
            free(triangles);
        }
    sph_cursor_destroy(cursor);
    for (uint32_t k = least; k <= n; k += 1 + (n - least) / 5) {
        sph_level *level;
        sph_level_arrays a;
        ck_assert_int_eq(sph_level_create(h, k, &level), SPH_OK);
        a = arrays_of(level);
        for (size_t i = 0; i < a.label_count; ++i)
            ck_assert_uint_lt(a.labels[i], k);
        for (size_t i = 0; i < 3 * a.triangle_count; ++i)
            ck_assert_uint_lt(a.triangles[i], k);
        for (size_t i = 0; i < 2 * a.edge_count; ++i)
            ck_assert_uint_lt(a.edges[i], k);
        sph_level_destroy(level);
    }
}

static uint64_t get(const unsigned char *p, unsigned size)
{
    uint64_t value = 0;
    for (unsigned i = size; i-- > 0;)
        value = value << 8 | p[i];
    return value;
}

static void put(unsigned char *p, unsigned size, uint64_t value)
{
    for (unsigned i = 0; i < size; ++i)
        p[i] = (unsigned char)(value >> 8 * i);
}

/* Makes all checksums right again, so that what is wrong comes to the checks behind them. */
static void seal(unsigned char *data)
{
    sph__crc32c crc;
    uint32_t sum;
    const uint64_t count = get(data + 24, 4);
    sph__crc32c_init(&crc);
    for (uint64_t i = 0; i < count; ++i) {
        unsigned char *entry = data + 32 + 24 * i;
        put(entry + 4, 4, sph__crc32c_add(&crc, 0, data + get(entry + 8, 8), get(entry + 16, 8)));
    }
    sum = sph__crc32c_add(&crc, 0, data, 28);
    put(data + 28, 4, sph__crc32c_add(&crc, sum, data + 32, 24 * count));
}

/* Reads a copy that ends where its memory ends; walks what comes of it. True when something came of it. */
static bool read_and_walk(const unsigned char *data, size_t size)
{
    unsigned char *copy = malloc(size);
    sph_hierarchy *h = (sph_hierarchy *)&context;
    sph_status status;
    if (size != 0) memcpy(copy, data, size);
    status = sph_hierarchy_read(context, copy, size, &h);
    free(copy);
    ck_assert_int_eq(h == NULL, status != SPH_OK);
    if (status == SPH_OK) {
        walk(h);
        sph_hierarchy_destroy(h);
        return true;
    }
    ck_assert_int_eq(status, SPH_E_FORMAT);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "byte"));
    return false;
}

START_TEST(a_hierarchy_cut_at_any_length_is_refused)
{
    sph_hierarchy *h = make_hierarchy(context, 0, SPH_RADIUS_CONSTANT);
    bytes b = write_all(h);
    for (size_t size = 0; size < b.size; ++size)
        ck_assert(!read_and_walk(b.data, size));
    ck_assert(read_and_walk(b.data, b.size));
    free(b.data);
    sph_hierarchy_destroy(h);
}
END_TEST

/* Indices become other indices, small ones mostly: many of these pass, and must be harmless. */
START_TEST(a_hierarchy_with_other_numbers_under_right_checksums_is_refused_or_can_be_walked)
{
    sph_hierarchy *h = make_hierarchy(context, _i, SPH_RADIUS_CONSTANT);
    bytes b = write_all(h);
    const uint64_t first = 32 + 24 * get(b.data + 24, 4);
    uint64_t state = (uint64_t)_i + 1;
    size_t passed = 0;
    for (int round = 0; round < 1000; ++round) {
        unsigned char *damaged = test_malloc(b.size, 1);
        const unsigned changes = 1 + (unsigned)(test_random(&state) % 3);
        memcpy(damaged, b.data, b.size);
        for (unsigned i = 0; i < changes; ++i) {
            const unsigned char *entry = b.data + 32 + 24 * (test_random(&state) % get(b.data + 24, 4));
            const uint64_t offset = get(entry + 8, 8), numbers = get(entry + 16, 8) / 4;
            const uint64_t value = test_random(&state);
            if (numbers == 0) continue;
            put(damaged + offset + 4 * (test_random(&state) % numbers), 4,
                value % 4 == 0 ? test_random(&state) : value / 4 % (2 * sph_hierarchy_vertex_count(h)));
        }
        ck_assert_uint_le(first, b.size);
        seal(damaged);
        passed += read_and_walk(damaged, b.size);
        free(damaged);
    }
    ck_assert_uint_gt(passed, 0);
    free(b.data);
    sph_hierarchy_destroy(h);
}
END_TEST

/* Each chunk's length and each count of META replaced by what is absurd. */
START_TEST(absurd_counts_are_refused_without_memory_for_them)
{
    static const uint64_t NUMBERS[] = {0,
                                       1,
                                       7,
                                       9,
                                       0x7FFFFFFF,
                                       0x80000000,
                                       UINT32_MAX,
                                       (uint64_t)1 << 32,
                                       INT64_MAX,
                                       UINT64_MAX,
                                       UINT64_MAX / 12,
                                       0x5555555555555556};
    test_faulty memory = {.fail_at = 0};
    const sph_allocator allocator = test_faulty_allocator(&memory);
    sph_context *own = test_context_with_allocator(&allocator);
    sph_hierarchy *h = make_hierarchy(context, 0, SPH_RADIUS_CONSTANT), *back;
    bytes b = write_all(h);
    const uint64_t meta = get(b.data + 32 + 8, 8);
    for (size_t field = 0; field < 4; ++field)
        for (size_t second = field; second < 4; ++second)
            for (size_t i = 0; i < sizeof NUMBERS / sizeof *NUMBERS; ++i) {
                unsigned char *damaged = test_malloc(b.size, 1);
                sph_status status;
                memcpy(damaged, b.data, b.size);
                put(damaged + meta + 8 * field, 8, NUMBERS[i]);
                put(damaged + meta + 8 * second, 8, NUMBERS[i]);
                seal(damaged);
                memory.peak_bytes = memory.live_bytes;
                status = sph_hierarchy_read(own, damaged, b.size, &back);
                ck_assert(status == SPH_E_FORMAT ||
                          status == SPH_OK); /* a radius per frame is no change for one frame */
                ck_assert_uint_le(memory.peak_bytes - memory.live_bytes, 10 * b.size + 65536);
                sph_hierarchy_destroy(back);
                free(damaged);
            }
    sph_context_destroy(own);
    ck_assert_uint_eq(memory.live_blocks, 0);
    free(b.data);
    sph_hierarchy_destroy(h);
}
END_TEST

static unsigned char *chunk_at(const bytes *b, const char *name)
{
    for (uint64_t i = 0; i < get(b->data + 24, 4); ++i)
        if (memcmp(b->data + 32 + 24 * i, name, 4) == 0) return b->data + get(b->data + 32 + 24 * i + 8, 8);
    ck_abort_msg("no chunk %s", name);
}

START_TEST(what_is_wrong_is_named_with_its_byte)
{
    static const struct {
        const char *chunk;
        size_t size, number; /* bytes of a number of the chunk; 32 bits to replace */
        uint32_t value;
        const char *message;
    } CASES[] = {{"CENT", 4, 3, 0x7FC00000, "a centre that is not finite"},
                 {"RADI", 4, 2, 0xBF800000, "a radius that is negative"},
                 {"RADI", 4, 2, 0x7F800000, "a radius that is negative or not finite"},
                 {"CHIL", 4, 0, 100, "a collapse of nodes that are not there"},
                 {"COST", 8, 1, 0x7FF80000, "a cost that is not finite"},
                 {"ERRO", 8, 3, 0x7FF80000, "an error that falls"},
                 {"ERRO", 8, 1, 0xFFF00000, "an error that falls"},
                 {"FORC", 1, 0, 2, "neither 0 nor 1"},
                 {"EDGE", 4, 0, 7, "an edge that cannot be"},
                 {"TRIA", 4, 0, 7, "a triangle that cannot be"},
                 {"META", 8, 9, 0x7FF00000, "a bounding diagonal"}};
    sph_hierarchy *h = make_hierarchy(context, 0, SPH_RADIUS_CONSTANT), *back;
    bytes b = write_all(h);
    char byte[32];
    size_t place;
    put(chunk_at(&b, CASES[_i].chunk) + 4 * CASES[_i].number, 4, CASES[_i].value);
    seal(b.data);
    ck_assert_int_eq(sph_hierarchy_read(context, b.data, b.size, &back), SPH_E_FORMAT);
    ck_assert_msg(strstr(sph_context_last_message(context), CASES[_i].message) != NULL, "%s",
                  sph_context_last_message(context));
    place = (size_t)(chunk_at(&b, CASES[_i].chunk) - b.data) + 4 * CASES[_i].number / CASES[_i].size * CASES[_i].size;
    snprintf(byte, sizeof byte, "byte %zu: ", place);
    ck_assert_msg(strstr(sph_context_last_message(context), byte) != NULL, "%s, not %s",
                  sph_context_last_message(context), byte);
    free(b.data);
    sph_hierarchy_destroy(h);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("hierarchy file damage");
    TCase *tc = tcase_create("damage");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_test(tc, a_hierarchy_cut_at_any_length_is_refused);
    tcase_add_loop_test(tc, a_hierarchy_with_other_numbers_under_right_checksums_is_refused_or_can_be_walked, 0,
                        MESH_COUNT);
    tcase_add_test(tc, absurd_counts_are_refused_without_memory_for_them);
    tcase_add_loop_test(tc, what_is_wrong_is_named_with_its_byte, 0, 11);
    return run_suite(suite, tc);
}
