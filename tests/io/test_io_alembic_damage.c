/* SPDX-License-Identifier: MIT */
/*
 * The Alembic fixtures cut at every length, with bytes changed at random, with places and counts replaced by absurd
 * ones and by each other (so that groups hold themselves), and with allocations that fail. The reader gets copies that
 * end where their memory ends.
 */
#include <check.h>
#include <stdio.h>
#include <string.h>

#include "faults.h"
#include "files.h"
#include "io/io.h"
#include "runner.h"
#include "support.h"

enum { SAMPLE_COUNT = 3 };
static const char *const NAMES[SAMPLE_COUNT] = {"operations", "scene", "times"};

static sph_context *context;
static test_faulty memory;
static unsigned char *sample;
static size_t sample_size;

static void setup(void)
{
    sph_allocator allocator;
    memory = (test_faulty){.fail_at = 0};
    allocator = test_faulty_allocator(&memory);
    context = test_context_with_allocator(&allocator);
    files_setup();
    sample = NULL;
}

static void load(int i)
{
    char path[1024];
    ck_assert_msg(getenv("SPH_FIXTURES") != NULL, "SPH_FIXTURES is not set");
    snprintf(path, sizeof path, "%s/alembic_%s.abc", getenv("SPH_FIXTURES"), NAMES[i]);
    sample = file_read(path, &sample_size);
}

static void teardown(void)
{
    free(sample);
    files_teardown();
    sph_context_destroy(context);
    ck_assert_uint_eq(memory.live_blocks, 0);
    ck_assert(!memory.misused);
}

/* Reads from exact memory, and some frames; nothing is left over and no index is out of range. */
static sph_status read_exact(const unsigned char *bytes, size_t size)
{
    unsigned char *copy = exact_copy(bytes, size);
    const sph__io_map map = {copy, size};
    const size_t before = memory.live_blocks;
    sph__io_mesh mesh = {.context = context};
    sph__io_abc *a = NULL;
    sph_status status = sph__io_abc_open("a.abc", &map, 0, NULL, true, &mesh, &a);
    if (status == SPH_OK) {
        const uint32_t count = sph__io_abc_frame_count(a);
        float *xyz = test_malloc(3 * mesh.vertex_count, sizeof *xyz);
        bool good = count > 0; /* one assertion for all: each costs a write */
        for (size_t i = 0; i < 3 * mesh.triangle_count; ++i)
            good = good && mesh.triangles[i] < mesh.vertex_count;
        for (uint32_t f = 0; f < count && f < 4; ++f)
            good = good && sph__io_abc_read(a, f, xyz) == SPH_OK;
        ck_assert(good && sph__io_abc_read(a, count - 1, xyz) == SPH_OK);
        free(xyz);
    } else {
        ck_assert(a == NULL && sph_context_last_message(context)[0] != '\0');
    }
    sph__io_abc_close(a);
    sph__io_mesh_release(&mesh);
    ck_assert_uint_eq(memory.live_blocks, before);
    free(copy);
    return status;
}

/* The same, and that it takes no more memory than a file of its size may. */
static bool read_damaged(const unsigned char *bytes, size_t size)
{
    sph_status status;
    memory.peak_bytes = memory.live_bytes;
    status = read_exact(bytes, size);
    ck_assert_msg(status == SPH_OK || status == SPH_E_FORMAT || status == SPH_E_UNSUPPORTED || status == SPH_E_LIMIT,
                  "%d: %s", (int)status, sph_context_last_message(context));
    ck_assert_uint_le(memory.peak_bytes - memory.live_bytes, (size_t)1 << 27);
    return status == SPH_OK;
}

START_TEST(an_archive_cut_at_any_length_is_refused)
{
    load(_i);
    ck_assert_msg(read_exact(sample, sample_size) == SPH_OK, "%s", sph_context_last_message(context));
    for (size_t size = 0; size < sample_size; ++size)
        ck_assert_int_eq(read_exact(sample, size), SPH_E_FORMAT);
}
END_TEST

START_TEST(an_archive_with_random_damage_is_refused_or_read_within_its_bytes)
{
    uint64_t state = (uint64_t)_i + 1;
    size_t read = 0;
    load(_i);
    for (int round = 0; round < 2500; ++round) {
        unsigned char *damaged = exact_copy(sample, sample_size);
        const unsigned changes = 1 + (unsigned)(test_random(&state) % 3);
        for (unsigned i = 0; i < changes; ++i) {
            const size_t place = test_random(&state) % sample_size;
            damaged[place] = (unsigned char)test_random(&state);
        }
        read += read_damaged(damaged, sample_size);
        free(damaged);
    }
    ck_assert_uint_gt(read, 100); /* else the damage went no further than the first check */
}
END_TEST

static void put(unsigned char *at, uint64_t value)
{
    for (int i = 0; i < 8; ++i)
        at[i] = (unsigned char)(value >> 8 * i);
}

static uint64_t get(const unsigned char *at)
{
    uint64_t value = 0;
    for (int i = 8; i-- > 0;)
        value = value << 8 | at[i];
    return value;
}

START_TEST(absurd_places_and_counts_are_refused_or_read_within_the_bytes)
{
    const uint64_t data = (uint64_t)1 << 63;
    load(_i);
    for (size_t place = 0; place + 8 <= sample_size; place += _i == 1 ? 1 : 3) {
        const uint64_t root = get(sample + 8), top = get(sample + root + 8 + 16);
        const uint64_t numbers[] = {0,          1,           data,        data | 16,         root,
                                    top,        data | root, sample_size, INT64_MAX,         INT64_MAX - 7,
                                    UINT64_MAX, UINT32_MAX,  1U << 31,    (uint64_t)1 << 61, place,
                                    place - 8};
        for (size_t i = 0; i < sizeof numbers / sizeof *numbers; ++i) {
            unsigned char *damaged = exact_copy(sample, sample_size);
            put(damaged + place, numbers[i]);
            (void)read_damaged(damaged, sample_size);
            free(damaged);
        }
    }
}
END_TEST

/* Every reference that is one in its place by every other that is: groups that hold themselves, each other, or data. */
START_TEST(groups_in_circles_end)
{
    uint64_t places[2000];
    size_t sites[2000], count = 0;
    load(_i);
    for (size_t place = 16; place + 8 <= sample_size && count < 2000; ++place) {
        const uint64_t value = get(sample + place), target = value & ~((uint64_t)1 << 63);
        if (target < 16 || target >= sample_size || (value != target && target == 0)) continue;
        sites[count] = place;
        places[count++] = value;
    }
    ck_assert_uint_gt(count, 30);
    for (size_t i = 0; i < count; ++i)
        for (size_t j = (i * 7) % 13; j < count; j += 13) {
            unsigned char *damaged = exact_copy(sample, sample_size);
            put(damaged + sites[i], places[j]);
            (void)read_damaged(damaged, sample_size);
            free(damaged);
        }
}
END_TEST

/* `user` is the file's path. */
static sph_status open_and_list(sph_context *own, const void *user)
{
    const char *path = user;
    sph_animation *animation = NULL;
    sph_status status = sph_io_open_animation(own, &path, 1, NULL, &animation);
    ck_assert_int_eq(animation == NULL, status != SPH_OK);
    sph_animation_destroy(animation);
    if (status == SPH_OK) status = sph_io_list_objects(own, path, NULL, NULL, NULL, NULL);
    return status;
}

START_TEST(every_allocation_may_fail)
{
    const char *path;
    load(_i / 2);
    path = file_write("a.abc", sample, sample_size);
    check_every_allocation((test_faults){.work = open_and_list, .user = path, .least = 11, .sticky = _i % 2});
}
END_TEST

int main(void)
{
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_set_timeout(tc, 0);
    tcase_add_loop_test(tc, an_archive_cut_at_any_length_is_refused, 0, SAMPLE_COUNT);
    tcase_add_loop_test(tc, an_archive_with_random_damage_is_refused_or_read_within_its_bytes, 0, SAMPLE_COUNT);
    tcase_add_loop_test(tc, absurd_places_and_counts_are_refused_or_read_within_the_bytes, 0, SAMPLE_COUNT);
    tcase_add_loop_test(tc, groups_in_circles_end, 0, SAMPLE_COUNT);
    tcase_add_loop_test(tc, every_allocation_may_fail, 0, 2 * SAMPLE_COUNT);
    return run_suite(suite_create("io Alembic damage"), tc);
}
