/* SPDX-License-Identifier: MIT */
/*
 * Every public function, called by a careless caller: nothing crashes, a handle comes out exactly where the status is good,
 * and all memory comes back. The calls are made from the headers, so that no function can be forgotten.
 */
#include <check.h>
#include <dirent.h>
#include <time.h>
#include <unistd.h>

#include "calls.h"
#include "runner.h"
#include "support.h"

enum { SCRATCHES = 8, SCRATCH_SIZE = 1 << 17, ROUNDS = 80, CALLS_PER_FIXTURE = 10 };

api_fixture fixture;
bool api_files_are_there;

static union scratch_block {
    unsigned char bytes[SCRATCH_SIZE];
    max_align_t aligned;
} *scratches;
static char path[64];

uint32_t pick(uint64_t *random, uint32_t below)
{
    return (uint32_t)(test_random(random) >> 33) % below;
}

size_t small(uint64_t *random)
{
    static const size_t SMALL[] = {0, 1, 2, 3, 4, 7, 12, 30};
    return SMALL[pick(random, 8)];
}

size_t odd_stride(uint64_t *random)
{
    static const size_t STRIDES[] = {0, 0, 1, 3, 4, 12, 16, 48};
    return STRIDES[pick(random, 8)];
}

uint32_t odd_uint32(uint64_t *random)
{
    static const uint32_t ODD[] = {0, 1, 2, 3, 4, 5, 9, UINT32_MAX};
    return ODD[pick(random, 8)];
}

int32_t odd_int32(uint64_t *random)
{
    static const int32_t ODD[] = {0, 1, 2, 3, -1, INT32_MAX, INT32_MIN, 7};
    return ODD[pick(random, 8)];
}

double odd_number(uint64_t *random)
{
    static const double ODD[] = {0, 1, 0.5, -1, 1e300, 1e-300, INFINITY, NAN};
    return ODD[pick(random, 8)];
}

const char *text(uint64_t *random)
{
    static const char *const TEXTS[] = {NULL, "", "/nowhere/a.obj", "a", "%s%n", "\xff\xfe", "/", path};
    static const char *const FILES[] = {"in.glb", "in.sphm", "in.json", "in.obj"};
    static const char *const ENDINGS[] = {".obj", ".pc2", ".mdd", ".sphm", ".json", ".glb", ".ply", ".nothing"};
    snprintf(path, sizeof path, "test-api-%ld%s", (long)getpid(), ENDINGS[pick(random, 8)]);
    return api_files_are_there && pick(random, 2) == 0 ? FILES[pick(random, 4)] : TEXTS[pick(random, 8)];
}

const char **names(uint64_t *random)
{
    static const char *list[32];
    for (unsigned i = 0; i < 32; ++i) list[i] = i % 2 == 0 ? "s10.obj" : "s2.obj";
    return pick(random, 8) == 0 ? NULL : list;
}

void *scratch(uint64_t *random)
{
    unsigned char *block = scratches[pick(random, SCRATCHES)].bytes;
    const uint32_t kind = pick(random, 4);
    float *numbers = (float *)(void *)block;
    memset(block, 0, SCRATCH_SIZE);
    for (unsigned i = 0; kind > 0 && i < 1024; ++i)
        numbers[i] = kind == 1 ? (float)i * 0.25F : kind == 2 ? (float)pick(random, 9) - 4 : (float)odd_number(random);
    return block;
}

void *room(size_t size)
{
    enum { ROOMS = 64, ROOM_SIZE = 2048 };
    static union {
        unsigned char bytes[ROOM_SIZE];
        max_align_t aligned;
    } rooms[ROOMS];
    static unsigned last;
    CHECK(size <= ROOM_SIZE);
    last = (last + 1) % ROOMS;
    return memset(rooms[last].bytes, 0, ROOM_SIZE);
}

static void make_skin(void)
{
    const sph_skin_source source = {.animation = fixture.animation};
    sph_implicit_options implicit_options;
    sph_skin_options o;
    sph_skin_options_init(&o, sizeof o);
    sph_implicit_options_init(&implicit_options, sizeof implicit_options);
    implicit_options.table_size = 8;
    implicit_options.sample_count = 8;
    o.round_limit = 1;
    ck_assert_int_eq(sph_skin_create(fixture.level, &source, 1, &o, &fixture.skin), SPH_OK);
    ck_assert_int_eq(sph_skeleton_create(fixture.skin, NULL, &fixture.skeleton), SPH_OK);
    ck_assert_int_eq(sph_deformer_create(fixture.skin, NULL, &fixture.deformer), SPH_OK);
    ck_assert_int_eq(sph_progressive_create(fixture.skin, NULL, &fixture.progressive), SPH_OK);
    ck_assert_int_eq(sph_implicit_create(fixture.skin, &implicit_options, &fixture.implicit), SPH_OK);
    ck_assert_int_eq(sph_tracker_create(fixture.implicit, fixture.skin, NULL, &fixture.tracker), SPH_OK);
}

void api_make_context(void)
{
    sph_context_options o;
    sph_context_options_init(&o, sizeof o);
    o.thread_count = 1;
    o.memory_limit = UINT64_C(512) << 20;
    ck_assert_int_eq(sph_context_create(&o, &fixture.context), SPH_OK);
}

void api_make_handles(void)
{
    sph_surface_options so;
    fixture.animation = test_cube(fixture.context, 2);
    ck_assert_int_eq(sph_quadric_create(fixture.context, 2, &fixture.quadric), SPH_OK);
    ck_assert_int_eq(sph_hierarchy_create(fixture.animation, NULL, &fixture.hierarchy), SPH_OK);
    ck_assert_int_eq(sph_cursor_create(fixture.hierarchy, &fixture.cursor), SPH_OK);
    ck_assert_int_eq(sph_level_create(fixture.hierarchy, 5, &fixture.level), SPH_OK);
    ck_assert_int_eq(sph_query_create(fixture.level, NULL, &fixture.query), SPH_OK);
    ck_assert_int_eq(sph_query_pose_frame(fixture.query, 0), SPH_OK);
    sph_surface_options_init(&so, sizeof so);
    so.resolution = 4;
    ck_assert_int_eq(sph_surface_create(fixture.level, &so, &fixture.surface), SPH_OK);
    make_skin();
}

void api_make_file_handles(void)
{
    sph_io_spill_options o;
    sph_io_spill_options_init(&o, sizeof o);
    o.memory_limit = UINT64_C(8) << 30;
    o.folder = "/tmp";
    ck_assert_int_eq(sph_io_save_rig(fixture.context, fixture.skin, NULL, NULL, "fixture.glb"), SPH_OK);
    ck_assert_int_eq(sph_io_open_rig(fixture.context, "fixture.glb", NULL, &fixture.io_rig), SPH_OK);
    ck_assert_int_eq(sph_io_open_rig_levels(fixture.context, "fixture.glb", NULL, NULL, &fixture.io_rig_levels), SPH_OK);
    ck_assert_int_eq(sph_io_spill_create(fixture.context, &o, &fixture.io_spill), SPH_OK);
}

void api_destroy_handles(void)
{
    sph_io_spill_destroy(fixture.io_spill);
    sph_io_rig_levels_destroy(fixture.io_rig_levels);
    sph_io_rig_destroy(fixture.io_rig);
    sph_progressive_destroy(fixture.progressive);
    sph_tracker_destroy(fixture.tracker);
    sph_implicit_destroy(fixture.implicit);
    sph_deformer_destroy(fixture.deformer);
    sph_skeleton_destroy(fixture.skeleton);
    sph_skin_destroy(fixture.skin);
    sph_surface_destroy(fixture.surface);
    sph_query_destroy(fixture.query);
    sph_level_destroy(fixture.level);
    sph_cursor_destroy(fixture.cursor);
    sph_hierarchy_destroy(fixture.hierarchy);
    sph_quadric_destroy(fixture.quadric);
    sph_animation_destroy(fixture.animation);
    fixture = (api_fixture){.context = fixture.context};
}

static void set_up(void)
{
    api_make_context();
    api_make_handles();
}

static void tear_down(void)
{
    api_destroy_handles();
    sph_context_destroy(fixture.context);
}

void api_make_scratches(void)
{
    ck_assert_ptr_nonnull(scratches = test_malloc(SCRATCHES, sizeof *scratches));
}

void api_free_scratches(void)
{
    unlink(path);
    free(scratches);
}

START_TEST(a_careless_caller_harms_nothing)
{
    const api_call *call = &API_CALLS[_i];
    uint64_t random = 1000 + (uint64_t)_i;
    const clock_t enough = clock() + CLOCKS_PER_SEC / 3; /* of what takes long, fewer calls are made */
    api_make_scratches();
    for (unsigned round = 0; round < ROUNDS && (round % CALLS_PER_FIXTURE != 0 || clock() < enough); ++round) {
        if (round % CALLS_PER_FIXTURE == 0) set_up();
        call->run(&random);
        if (round % CALLS_PER_FIXTURE == CALLS_PER_FIXTURE - 1) tear_down();
    }
    api_free_scratches();
}
END_TEST

/* Removes the files that the calls have left, and their folder. */
static void clear(const char *folder)
{
    DIR *listing = opendir(folder);
    const struct dirent *entry;
    while (listing != NULL && (entry = readdir(listing)) != NULL) unlink(entry->d_name);
    if (listing != NULL) closedir(listing);
    if (chdir("/") == 0) rmdir(folder);
}

int main(void)
{
    char folder[] = "/tmp/test-api-XXXXXX";
    Suite *suite = suite_create("api");
    TCase *tc = tcase_create("api");
    int result;
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, a_careless_caller_harms_nothing, 0, (int)API_CALL_COUNT);
    api_add_failure_tests(tc);
    api_add_foreign_tests(tc);
    if (mkdtemp(folder) == NULL || chdir(folder) != 0) return 1;
    result = run_suite(suite, tc);
    clear(folder);
    return result;
}
