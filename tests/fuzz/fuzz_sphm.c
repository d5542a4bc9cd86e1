/* SPDX-License-Identifier: MIT */
/* Containers of hierarchies and levels: what is accepted is whole, and comes back the same when written and read again. */
#include <math.h>

#include "fuzz.h"

/* CRC-32C a bit at a time, on its own: the library's is not asked about itself. */
static uint32_t crc32c(uint32_t sum, const uint8_t *bytes, size_t size)
{
    sum = ~sum;
    for (size_t i = 0; i < size; ++i) {
        sum ^= bytes[i];
        for (unsigned bit = 0; bit < 8; ++bit) sum = sum >> 1 ^ ((sum & 1) != 0 ? UINT32_C(0x82F63B78) : 0);
    }
    return ~sum;
}

static uint64_t number(const uint8_t *bytes, unsigned size)
{
    uint64_t value = 0;
    for (unsigned i = size; i-- > 0;) value = value << 8 | bytes[i];
    return value;
}

static void put_sum(uint8_t *bytes, uint32_t sum)
{
    for (unsigned i = 0; i < 4; ++i) bytes[i] = (uint8_t)(sum >> 8 * i);
}

/* Makes checksums and size right (docs/formats.md): no fuzzer would, and everything behind them would go untested. */
static void repair(uint8_t *data, size_t size)
{
    enum { HEADER = 32, ENTRY = 24 };
    uint64_t chunks, value = size;
    if (size < HEADER) return;
    for (unsigned i = 0; i < 8; ++i, value >>= 8) data[16 + i] = (uint8_t)value;
    chunks = number(data + 24, 4);
    if (chunks > (size - HEADER) / ENTRY) return;
    for (uint64_t i = 0; i < chunks; ++i) {
        uint8_t *entry = data + HEADER + ENTRY * i;
        const uint64_t offset = number(entry + 8, 8), length = number(entry + 16, 8);
        if (offset <= size && length <= size - offset) put_sum(entry + 4, crc32c(0, data + offset, length));
    }
    put_sum(data + 28, crc32c(crc32c(0, data, 28), data + HEADER, ENTRY * chunks));
}

static void check_level(const sph_level *level)
{
    sph_level_arrays a = {.struct_size = sizeof a};
    FUZZ_CHECK(sph_level_get_arrays(level, &a) == SPH_OK);
    FUZZ_CHECK(a.sphere_count > 0 && a.frame_count > 0);
    for (size_t i = 0; i < 2 * a.edge_count; ++i) FUZZ_CHECK(a.edges[i] < a.sphere_count);
    for (size_t i = 0; i < 3 * a.triangle_count; ++i) FUZZ_CHECK(a.triangles[i] < a.sphere_count);
    for (size_t i = 0; i < a.label_count; ++i) FUZZ_CHECK(a.labels[i] < a.sphere_count || a.labels[i] == SPH_NO_SPHERE);
}

/* Down to the coarsest level, to the finest, and to one between. */
static void walk(const sph_hierarchy *h, uint32_t between)
{
    const uint32_t n = sph_hierarchy_vertex_count(h), coarsest = n - sph_hierarchy_collapse_count(h);
    const uint32_t stops[] = {coarsest, n, coarsest + between % (n - coarsest + 1)};
    sph_cursor *cursor = NULL;
    sph_level *level = NULL;
    if (sph_cursor_create(h, &cursor) != SPH_OK) return; /* out of memory */
    for (unsigned i = 0; i < 3; ++i) {
        FUZZ_CHECK(sph_cursor_move(cursor, stops[i]) == SPH_OK);
        FUZZ_CHECK(sph_cursor_sphere_count(cursor) == stops[i]);
        if (sph_level_create(h, stops[i], &level) == SPH_OK) {
            check_level(level);
            FUZZ_CHECK(sph_level_sphere_count(level) == stops[i]);
        }
        sph_level_destroy(level);
    }
    sph_cursor_destroy(cursor);
}

/* What is accepted is written and read again, with the same bytes. */
static sph_status load_hierarchy(sph_context *context, const uint8_t *data, size_t size)
{
    sph_hierarchy *h = NULL, *again = NULL;
    fuzz_buffer first = {0}, second = {0};
    const sph_status status = sph_hierarchy_read(context, data, size, &h);
    FUZZ_CHECK((h != NULL) == (status == SPH_OK));
    if (status == SPH_OK) {
        walk(h, data[size - 1]);
        FUZZ_CHECK(sph_hierarchy_write(h, fuzz_append, &first) == SPH_OK);
        FUZZ_CHECK(sph_hierarchy_read(context, first.data, first.size, &again) == SPH_OK);
        FUZZ_CHECK(sph_hierarchy_write(again, fuzz_append, &second) == SPH_OK);
        FUZZ_CHECK(first.size == second.size && memcmp(first.data, second.data, first.size) == 0);
    }
    sph_hierarchy_destroy(again);
    sph_hierarchy_destroy(h);
    free(first.data);
    free(second.data);
    return status;
}

static sph_status load_level(sph_context *context, const uint8_t *data, size_t size)
{
    sph_level *level = NULL, *again = NULL;
    fuzz_buffer first = {0}, second = {0};
    const sph_status status = sph_level_read(context, data, size, &level);
    FUZZ_CHECK((level != NULL) == (status == SPH_OK));
    if (status == SPH_OK) {
        check_level(level);
        FUZZ_CHECK(sph_level_write(level, fuzz_append, &first) == SPH_OK);
        FUZZ_CHECK(sph_level_read(context, first.data, first.size, &again) == SPH_OK);
        FUZZ_CHECK(sph_level_write(again, fuzz_append, &second) == SPH_OK);
        FUZZ_CHECK(first.size == second.size && memcmp(first.data, second.data, first.size) == 0);
    }
    sph_level_destroy(again);
    sph_level_destroy(level);
    free(first.data);
    free(second.data);
    return status;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_patience patience = {.reports_left = 100000};
    sph_context *context = fuzz_context(&patience);
    const uint64_t idle = sph_context_memory_used(context);
    uint8_t *repaired = malloc(size == 0 ? 1 : size);
    FUZZ_CHECK(repaired != NULL);
    if (size > 0) memcpy(repaired, data, size);
    if (size > 0 && data[size - 1] % 16 != 15) repair(repaired, size);
    fuzz_end(context, load_hierarchy(context, repaired, size), idle);
    context = fuzz_context(&patience);
    fuzz_end(context, load_level(context, repaired, size), idle);
    free(repaired);
    return 0;
}
