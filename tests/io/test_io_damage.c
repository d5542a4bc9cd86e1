/* SPDX-License-Identifier: MIT */
/*
 * Every sample cut at every length, with bytes changed at random, with numbers that are absurd, and with allocations
 * that fail. The readers get copies that end where their memory ends, so that the address sanitizer sees any look
 * beyond.
 */
#include <check.h>
#include <stdio.h>
#include <string.h>

#include "faults.h"
#include "files.h"
#include "io/io.h"
#include "runner.h"
#include "support.h"

enum { OBJ, PLY, PLY_LITTLE, PLY_BIG, OFF, STL, STL_BINARY, PC2, MDD, JSON, SPHM, SAMPLE_COUNT };
static const char *const NAMES[SAMPLE_COUNT] = {"a.obj", "a.ply", "l.ply", "b.ply",  "a.off", "a.stl",
                                                "b.stl", "a.pc2", "a.mdd", "a.json", "a.sphm"};

static sph_context *context;
static test_faulty memory;
static layout samples[SAMPLE_COUNT];

static const char OBJ_TEXT[] =
    "# a comment\r\nmtllib x.mtl\nv 0 0 0\nv 1.25 0 -1e-3 1 0.5 0.5\nv 0 1 \\\n 0\nv 1 1 1.#INF\nvn 0 0 1\n"
    "f 1/1/1 2//2 3/3\nf -1 -2 -3 -4\nl 1 2 3\n";

#define PLY_HEADER(format)                                                                                             \
    "ply\nformat " format " 1.0\ncomment x\nelement vertex 4\nproperty float x\nproperty double y\nproperty short z\n" \
    "element face 2\nproperty uchar flags\nproperty list uchar int vertex_indices\nelement edge 1\nproperty uint "     \
    "vertex1\nproperty int vertex2\nelement bag 2\nproperty list short float a\nend_header\n"
static const char PLY_TEXT[] =
    PLY_HEADER("ascii") "0 0 0\n1.25 1e-3 0\n0 1 0\n1 1 7\n9 3 0 1 2\n9 4 3 2 1 0\n3 1\n2 0 0.5\n1 1\n";
static const char OFF_TEXT[] =
    "# a comment\nCOFF\n4 2 5 # counts\n0 0 0 1 1 1 1\n1.25 0 -1e-3 255 0 0\n0 1 0\n1 1 0\n3 "
    "0 1 2 0.5 0.5 0.5\n4 3 2 1 0\n";
static const char STL_TEXT[] =
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1.25 0 -1e-3\nvertex 0 1 0\nendloop\nendfacet\n"
    "facet normal 0 0 1 outer loop\nvertex 1.25 0 -1e-3\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid";

/* The content of PLY_TEXT. */
static void put_ply(layout *l, bool big)
{
    static const char LITTLE[] = PLY_HEADER("binary_little_endian"), BIG[] = PLY_HEADER("binary_big_endian");
    static const uint32_t FACES[2][5] = {{3, 0, 1, 2, 0}, {4, 3, 2, 1, 0}};
    void (*put)(layout *, uint64_t, unsigned) = big ? put_big : put_little;
    put_bytes(l, big ? BIG : LITTLE, big ? sizeof BIG - 1 : sizeof LITTLE - 1);
    for (unsigned v = 0; v < 4; ++v) {
        put(l, 0x3FA00000, 4);                   /* 1.25 */
        put(l, UINT64_C(0x4059000000000000), 8); /* 100 */
        put(l, v, 2);
    }
    for (unsigned f = 0; f < 2; ++f) {
        put(l, 9, 1);
        put(l, FACES[f][0], 1);
        for (unsigned i = 0; i < FACES[f][0]; ++i)
            put(l, FACES[f][1 + i], 4);
    }
    put(l, 3, 4);
    put(l, 1, 4);
    for (unsigned count = 1; count < 3; ++count) {
        put(l, count, 2);
        for (unsigned i = 0; i < count; ++i)
            put(l, 0x3FA00000, 4);
    }
}

static void put_stl(layout *l)
{
    static const float CORNERS[18] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    for (unsigned i = 0; i < 20; ++i)
        put_little(l, 0, 4);
    put_little(l, 2, 4);
    for (unsigned t = 0; t < 2; ++t) {
        for (unsigned i = 0; i < 3; ++i)
            put_little_float(l, 0);
        for (unsigned i = 0; i < 9; ++i)
            put_little_float(l, CORNERS[9 * t + i]);
        put_little(l, 0, 2);
    }
}

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
    put_bytes(&samples[PLY], PLY_TEXT, sizeof PLY_TEXT - 1);
    put_ply(&samples[PLY_LITTLE], false);
    put_ply(&samples[PLY_BIG], true);
    put_bytes(&samples[OFF], OFF_TEXT, sizeof OFF_TEXT - 1);
    put_bytes(&samples[STL], STL_TEXT, sizeof STL_TEXT - 1);
    put_stl(&samples[STL_BINARY]);
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

static sph__io_read_fn *const READERS[] = {sph__io_read_obj, sph__io_read_ply, sph__io_read_ply, sph__io_read_ply,
                                           sph__io_read_off, sph__io_read_stl, sph__io_read_stl};

static bool is_text(int kind)
{
    return kind == OBJ || kind == PLY || kind == OFF || kind == STL || kind == JSON;
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
    case PLY:
    case PLY_LITTLE:
    case PLY_BIG:
    case OFF:
    case STL:
    case STL_BINARY:
        status = READERS[kind](NAMES[kind], &map, &mesh, NULL);
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
        /* Only the last newline is missing, or the end of a line that is passed over. */
        const bool text_end = (_i == PLY && size + 3 >= l->size) || ((_i == JSON || _i == OFF) && size + 1 == l->size);
        /* A header's word that is cut is another word. */
        const bool refused = status == SPH_E_FORMAT || (_i >= PLY && _i <= PLY_BIG && status == SPH_E_UNSUPPORTED);
        ck_assert_msg(refused || ((_i == OBJ || text_end) && status == SPH_OK), "cut at %zu: %d", size, (int)status);
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
            damaged[place] =
                is_text(_i) ? (unsigned char)"0123456789-+.e[]{},:\"\\/ \nvfl#"[value % 30] : (unsigned char)value;
        }
        status = read_exact(_i, damaged, l->size);
        ck_assert(status == SPH_OK || status == SPH_E_FORMAT || status == SPH_E_VERSION ||
                  status == SPH_E_UNSUPPORTED || status == SPH_E_LIMIT);
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
    static const int KINDS[] = {PC2, MDD, SPHM, STL_BINARY, PLY_LITTLE, PLY_BIG};
    const int kind = KINDS[_i];
    layout *l = &samples[kind];
    for (size_t place = 0; place + 4 <= l->size && (place <= 176 || kind <= STL_BINARY); place += 4)
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

START_TEST(absurd_counts_in_a_text_take_no_memory)
{
    static const char *const COUNTS[] = {"99",         "2147483647",           "2147483648", "4294967295",
                                         "4294967296", "18446744073709551615", "-1",         "99999999999999999999999"};
    static const struct {
        int kind;
        const char *before, *after; /* of the count */
    } PLACES[] = {{PLY, "element vertex ", "\n"},
                  {PLY, "element face ", "\n"},
                  {PLY, "element edge ", "\n"},
                  {PLY, "element bag ", "\n"},
                  {PLY, "9 ", " 0 1 2"},
                  {PLY_LITTLE, "element vertex ", "\n"},
                  {PLY_LITTLE, "element face ", "\n"},
                  {PLY_BIG, "element edge ", "\n"},
                  {PLY_BIG, "element bag ", "\n"},
                  {OFF, "COFF\n", " 2 5"},
                  {OFF, "COFF\n4 ", " 5 #"},
                  {OFF, "1 1 0\n", " 0 1 2"}};
    for (size_t i = 0; i < sizeof COUNTS / sizeof *COUNTS; ++i) {
        const layout *l = &samples[PLACES[_i].kind];
        unsigned char *text = test_malloc(l->size + 1, 1);
        const char *at, *rest;
        layout changed = {NULL, 0, 0};
        sph_status status;
        memcpy(text, l->bytes, l->size);
        text[l->size] = '\0';
        at = strstr((char *)text, PLACES[_i].before);
        ck_assert_ptr_nonnull(at);
        at += strlen(PLACES[_i].before);
        rest = strstr(at, PLACES[_i].after);
        ck_assert_ptr_nonnull(rest);
        put_bytes(&changed, text, (size_t)(at - (char *)text));
        put_bytes(&changed, COUNTS[i], strlen(COUNTS[i]));
        put_bytes(&changed, l->bytes + (rest - (char *)text), l->size - (size_t)(rest - (char *)text));
        memory.peak_bytes = memory.live_bytes;
        status = read_exact(PLACES[_i].kind, changed.bytes, changed.size);
        ck_assert_msg(status == SPH_E_FORMAT, "%s%s: %d", PLACES[_i].before, COUNTS[i], (int)status);
        ck_assert_uint_le(memory.peak_bytes - memory.live_bytes, 16384);
        layout_free(&changed);
        free(text);
    }
}
END_TEST

/* --- allocations that fail --- */

/* `user` holds the kind. */
static sph_status open_sample(sph_context *own, const void *user)
{
    const int kind = *(const int *)user;
    const bool sequence = kind < PC2;
    const char *ending = strrchr(NAMES[kind], '.');
    char pattern[32];
    const char *path;
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
    snprintf(pattern, sizeof pattern, "s%%d%s", ending);
    path = file_path(sequence ? pattern : "m.obj");
    if (!sequence) options.cache_path = file_path(NAMES[kind]);
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
        snprintf(name, sizeof name, "s%u%s", f, strrchr(NAMES[kind], '.'));
        if (kind == OBJ)
            write_obj(name, 4, f);
        else if (kind < PC2)
            file_write(name, samples[kind].bytes, samples[kind].size);
    }
    if (kind == PC2 || kind == MDD) file_write(NAMES[kind], samples[kind].bytes, samples[kind].size);
    check_every_allocation((test_faults){.work = open_sample, .user = &kind, .least = 6, .sticky = _i % 2});
}
END_TEST

int main(void)
{
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, a_sample_cut_at_any_length_is_refused_or_read_within_its_bytes, 0, SAMPLE_COUNT);
    tcase_add_loop_test(tc, a_sample_with_random_damage_is_refused_or_read_within_its_bytes, 0, SAMPLE_COUNT);
    tcase_add_loop_test(tc, absurd_numbers_in_a_header_take_no_memory, 0, 6);
    tcase_add_loop_test(tc, absurd_counts_in_a_text_take_no_memory, 0, 12);
    tcase_add_loop_test(tc, every_allocation_may_fail, 0, 2 * SAMPLE_COUNT);
    return run_suite(suite_create("io damage"), tc);
}
