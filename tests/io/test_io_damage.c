/* SPDX-License-Identifier: MIT */
/*
 * Every sample cut at every length, with bytes changed at random, with numbers that are absurd, and with allocations
 * that fail. The readers get copies that end where their memory ends, so that the address sanitizer sees any look
 * beyond.
 */
#include <check.h>
#include <stdio.h>
#include <string.h>

#include "files.h"
#include "io/io.h"
#include "runner.h"
#include "support.h"

enum { OBJ, PC2, MDD, JSON, SPHM, SAMPLE_COUNT };
static const char *const NAMES[SAMPLE_COUNT] = {"a.obj", "a.pc2", "a.mdd", "a.json", "a.sphm"};

static sph_context *context;
static test_faulty memory;
static layout samples[SAMPLE_COUNT];

static const char OBJ_TEXT[] =
    "# a comment\r\nmtllib x.mtl\nv 0 0 0\nv 1.25 0 -1e-3 1 0.5 0.5\nv 0 1 \\\n 0\nv 1 1 1.#INF\nvn 0 0 1\n"
    "f 1/1/1 2//2 3/3\nf -1 -2 -3 -4\nl 1 2 3\n";

static sph_level *sample_level(sph_context *of)
{
    static const float CENTERS[] = {0, 1.5f, 2, 3, 4, 5, 6, 7, 8, 9, 10, 1e-7f}, RADII[] = {0.5f, 0.25f, 1, 2};
    static const uint32_t EDGE[] = {0, 1}, TRIANGLE[] = {0, 1, 1}, LABELS[] = {1, SPH_NO_SPHERE, 0};
    const sph_level_arrays a = {sizeof a, 2, 2, 1, CENTERS, RADII, 1, EDGE, 1, TRIANGLE, 3, LABELS};
    sph_level *level;
    ck_assert_int_eq(sph_level_create_from_arrays(of, &a, &level), SPH_OK);
    return level;
}

static void load_sample(int kind, const char *path)
{
    size_t size;
    unsigned char *bytes = file_read(path, &size);
    put_bytes(&samples[kind], bytes, size);
    free(bytes);
}

static void setup(void)
{
    sph_level *level;
    sph_allocator allocator;
    memory = (test_faulty){.fail_at = 0};
    allocator = test_faulty_allocator(&memory);
    context = test_context_with_allocator(&allocator);
    files_setup();
    level = sample_level(context);
    put_bytes(&samples[OBJ], OBJ_TEXT, sizeof OBJ_TEXT - 1);
    put_pc2(&samples[PC2], 4, 3);
    put_mdd(&samples[MDD], 4, 3);
    for (int i = JSON; i < SAMPLE_COUNT; ++i) {
        ck_assert_int_eq(sph_io_save_level(context, level, file_path(NAMES[i])), SPH_OK);
        load_sample(i, file_path(NAMES[i]));
    }
    sph_level_destroy(level);
}

static void teardown(void)
{
    for (int i = 0; i < SAMPLE_COUNT; ++i)
        layout_free(&samples[i]);
    files_teardown();
    sph_context_destroy(context);
    ck_assert_uint_eq(memory.live_blocks, 0);
    ck_assert(!memory.misused);
}

/* Reads from exact memory; whether it succeeds or not, nothing is left over and no index is out of range. */
static sph_status read_exact(int kind, const unsigned char *bytes, size_t size)
{
    unsigned char *copy = exact_copy(bytes, size);
    const sph__io_map map = {copy, size};
    const size_t before = memory.live_blocks;
    sph__io_mesh mesh = {.context = context};
    sph__io_cache cache = {.map = map};
    sph_level *level = NULL;
    sph_status status;
    switch (kind) {
    case OBJ:
        status = sph__io_read_obj(NAMES[kind], &map, &mesh, NULL);
        for (size_t i = 0; status == SPH_OK && i < 3 * mesh.triangle_count; ++i)
            ck_assert_uint_lt(mesh.triangles[i], mesh.vertex_count);
        for (size_t i = 0; status == SPH_OK && i < 2 * mesh.edge_count; ++i)
            ck_assert_uint_lt(mesh.edges[i], mesh.vertex_count);
        sph__io_mesh_release(&mesh);
        break;
    case JSON:
        status = sph__io_level_json_read(context, NAMES[kind], &map, &level);
        break;
    case SPHM:
        status = sph_level_read(context, copy, size, &level);
        break;
    default:
        status = sph__io_cache_interpret(context, NAMES[kind], &cache);
        if (status == SPH_OK) {
            ck_assert_uint_le(cache.offset, size);
            ck_assert_uint_le((uint64_t)cache.vertex_count * 12 * cache.frame_count, size - cache.offset);
        }
        break;
    }
    if (kind >= JSON) ck_assert_int_eq(level == NULL, status != SPH_OK);
    if (status != SPH_OK) ck_assert_str_ne(sph_context_last_message(context), "");
    sph_level_destroy(level);
    ck_assert_uint_eq(memory.live_blocks, before);
    free(copy);
    return status;
}

START_TEST(a_sample_cut_at_any_length_is_refused_or_read_within_its_bytes)
{
    const layout *l = &samples[_i];
    ck_assert_int_eq(read_exact(_i, l->bytes, l->size), SPH_OK);
    for (size_t size = 0; size < l->size; ++size) {
        const sph_status status = read_exact(_i, l->bytes, size);
        const bool text_end = _i == JSON && size + 1 == l->size; /* only the last newline is missing */
        if (_i != OBJ && !text_end) ck_assert_msg(status == SPH_E_FORMAT, "cut at %zu: %d", size, (int)status);
        ck_assert(status == SPH_OK || status == SPH_E_FORMAT);
    }
}
END_TEST

START_TEST(a_sample_with_random_damage_is_refused_or_read_within_its_bytes)
{
    const layout *l = &samples[_i];
    uint64_t state = (uint64_t)_i + 1;
    for (int round = 0; round < 5000; ++round) {
        unsigned char *damaged = exact_copy(l->bytes, l->size);
        const unsigned changes = 1 + (unsigned)(test_random(&state) % 4);
        sph_status status;
        memory.peak_bytes = memory.live_bytes;
        for (unsigned i = 0; i < changes; ++i) {
            const size_t place = test_random(&state) % l->size;
            const uint64_t value = test_random(&state);
            /* Text mostly gets other text, which comes further than noise. */
            damaged[place] = _i == OBJ || _i == JSON ? (unsigned char)"0123456789-+.e[]{},:\"\\/ \nvfl#"[value % 30]
                                                     : (unsigned char)value;
        }
        status = read_exact(_i, damaged, l->size);
        ck_assert(status == SPH_OK || status == SPH_E_FORMAT || status == SPH_E_VERSION || status == SPH_E_UNSUPPORTED);
        ck_assert_uint_le(memory.peak_bytes - memory.live_bytes, 64 * l->size + 65536);
        free(damaged);
    }
}
END_TEST

/* Any 32 bits of a binary header replaced by what overflows; under right checksums that is test_container's affair. */
START_TEST(absurd_numbers_in_a_header_take_no_memory)
{
    static const uint32_t NUMBERS[] = {0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x00000080, 0xFFFFFF7F, 0x20000000,
                                       0x15555556, 0x55555515, 0x40000000, 1,          0};
    const int kind = _i == 0 ? PC2 : _i == 1 ? MDD : SPHM;
    layout *l = &samples[kind];
    for (size_t place = 0; place + 4 <= l->size && place <= 176; place += 4)
        for (size_t i = 0; i < sizeof NUMBERS / sizeof *NUMBERS; ++i)
            for (size_t second = place + 4; second <= place + 16 && second + 4 <= l->size; second += 4) {
                unsigned char *damaged = exact_copy(l->bytes, l->size);
                memcpy(damaged + place, &NUMBERS[i], 4);
                memcpy(damaged + second, &NUMBERS[i], 4);
                memory.peak_bytes = memory.live_bytes;
                (void)read_exact(kind, damaged, l->size);
                ck_assert_uint_le(memory.peak_bytes - memory.live_bytes, 65536);
                free(damaged);
            }
}
END_TEST

/* --- allocations that fail --- */

static sph_status open_sample(sph_context *own, int kind)
{
    const char *path = file_path("m.obj");
    sph_io_open_options options;
    sph_animation *animation = NULL;
    sph_level *level = NULL;
    sph_status status;
    float xyz[12];
    sph_io_open_options_init(&options, sizeof options);
    if (kind >= JSON) {
        status = sph_io_load_level(own, file_path(NAMES[kind]), &level);
        if (status == SPH_OK) status = sph_io_save_level(own, level, file_path(kind == JSON ? "out.json" : "out.sphm"));
        sph_level_destroy(level);
        return status;
    }
    if (kind == OBJ) path = file_path("s%d.obj");
    if (kind != OBJ) options.cache_path = file_path(NAMES[kind]);
    status = sph_io_open_animation(own, &path, 1, &options, &animation);
    ck_assert_int_eq(animation == NULL, status != SPH_OK);
    if (status == SPH_OK) status = sph_animation_read_frame(animation, 1, xyz);
    if (status == SPH_OK)
        status = sph_io_save_obj_pc2(own, animation, 0, 1, file_path("out.obj"), file_path("out.pc2"));
    sph_animation_destroy(animation);
    return status;
}

START_TEST(every_allocation_may_fail)
{
    const int kind = _i / 2;
    write_obj("m.obj", 4, 0);
    for (unsigned f = 0; f < 3; ++f) {
        char name[16];
        snprintf(name, sizeof name, "s%u.obj", f);
        write_obj(name, 4, f);
    }
    if (kind == PC2 || kind == MDD) file_write(NAMES[kind], samples[kind].bytes, samples[kind].size);
    for (size_t n = 1;; ++n) {
        test_faulty faulty = {.fail_at = 0, .sticky = _i % 2 == 1};
        const sph_allocator allocator = test_faulty_allocator(&faulty);
        sph_context *own = test_context_with_allocator(&allocator);
        sph_status status;
        faulty.fail_at = faulty.calls + n;
        status = open_sample(own, kind);
        sph_context_destroy(own);
        ck_assert_uint_eq(faulty.live_blocks, 0);
        ck_assert(!faulty.misused);
        if (faulty.calls < faulty.fail_at) { /* it was never reached: all allocations have had their turn */
            ck_assert_int_eq(status, SPH_OK);
            ck_assert_uint_gt(n, 5);
            return;
        }
        ck_assert_int_eq(status, SPH_E_NOMEM);
    }
}
END_TEST

int main(void)
{
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, a_sample_cut_at_any_length_is_refused_or_read_within_its_bytes, 0, SAMPLE_COUNT);
    tcase_add_loop_test(tc, a_sample_with_random_damage_is_refused_or_read_within_its_bytes, 0, SAMPLE_COUNT);
    tcase_add_loop_test(tc, absurd_numbers_in_a_header_take_no_memory, 0, 3);
    tcase_add_loop_test(tc, every_allocation_may_fail, 0, 2 * SAMPLE_COUNT);
    return run_suite(suite_create("io damage"), tc);
}
