/* SPDX-License-Identifier: MIT */
/*
 * Every public function while memory runs out, at each of its allocations, that one alone and all from there on, and
 * while progress says no at each of its reports: a clean status, nothing lost, and handles that are what they were and
 * go on working. The table says which functions take memory, so that a new one is either in it or found to take none.
 */
#include <time.h>

#include "calls.h"
#include "support.h"

enum { SEEDS = 160, ENOUGH = 4, DENSE = 48 };

/* Calls that are found to take memory. The others are asserted to take none. */
static const char *const TAKE_MEMORY[] = {
    "sph_animation_check",
    "sph_animation_create",
    "sph_animation_create_from_positions",
    "sph_animation_create_from_source",
    "sph_animation_set_edges",
    "sph_animation_set_triangles",
    "sph_animation_weld",
    "sph_context_allocate",
    "sph_coverage_inflate",
    "sph_coverage_measure",
    "sph_cursor_create",
    "sph_cursor_read",
    "sph_deformer_create",
    "sph_hierarchy_create",
    "sph_hierarchy_write",
    "sph_implicit_create",
    "sph_implicit_evaluate",
    "sph_implicit_write",
    "sph_io_describe",
    "sph_io_export_level",
    "sph_io_list_clips",
    "sph_io_load_hierarchy",
    "sph_io_load_implicit",
    "sph_io_load_level",
    "sph_io_open_rig",
    "sph_io_open_rig_levels",
    "sph_io_rig_levels_save",
    "sph_io_save_hierarchy",
    "sph_io_save_implicit",
    "sph_io_save_level",
    "sph_io_save_mesh",
    "sph_io_save_obj_mdd",
    "sph_io_save_obj_pc2",
    "sph_io_save_rig",
    "sph_io_save_surface",
    "sph_level_create",
    "sph_level_create_from_arrays",
    "sph_level_extract",
    "sph_level_optimize_connectivity",
    "sph_measure_level",
    "sph_measure_meshes",
    "sph_mesh_intersections",
    "sph_pose_from_spheres",
    "sph_progressive_create",
    "sph_progressive_create_cursor",
    "sph_progressive_get_attributes",
    "sph_progressive_get_skin",
    "sph_quadric_create",
    "sph_query_contains",
    "sph_query_create",
    "sph_skeleton_create",
    "sph_skeleton_get_transforms",
    "sph_skin_create",
    "sph_skin_measure",
    "sph_surface_create",
    "sph_tracker_create",
    "sph_tracker_pose",
};

static test_faulty faulty;
static test_progress progress;

static bool takes_memory(const char *name)
{
    for (size_t i = 0; i < sizeof TAKE_MEMORY / sizeof *TAKE_MEMORY; ++i)
        if (strcmp(name, TAKE_MEMORY[i]) == 0) return true;
    return false;
}

static sph_status add_to_sum(void *user, const void *bytes, size_t size)
{
    uint64_t *sum = user;
    for (size_t i = 0; i < size; ++i)
        *sum = (*sum ^ ((const unsigned char *)bytes)[i]) * UINT64_C(0x100000001b3);
    return SPH_OK;
}

/* Of what handles hold that can be written out. */
static uint64_t state(void)
{
    uint64_t sum = UINT64_C(0xcbf29ce484222325);
    float positions[24];
    CHECK(sph_level_write(fixture.level, add_to_sum, &sum) == SPH_OK);
    CHECK(sph_hierarchy_write(fixture.hierarchy, add_to_sum, &sum) == SPH_OK);
    CHECK(sph_animation_read_frame(fixture.animation, 1, positions) == SPH_OK);
    (void)add_to_sum(&sum, positions, sizeof positions);
    (void)add_to_sum(&sum, sph_animation_triangles(fixture.animation),
                     12 * sph_animation_triangle_count(fixture.animation));
    return sum;
}

static void make_fixture(void)
{
    sph_context_options o;
    faulty = (test_faulty){0};
    progress = (test_progress){0};
    sph_context_options_init(&o, sizeof o);
    o.thread_count = 1;
    o.memory_limit = UINT64_C(512) << 20;
    o.allocator = test_faulty_allocator(&faulty);
    o.progress = test_progress_callback;
    o.progress_user = &progress;
    ck_assert_int_eq(sph_context_create(&o, &fixture.context), SPH_OK);
    api_make_handles();
    ck_assert_int_eq(sph_io_save_rig(fixture.context, fixture.skin, NULL, NULL, "in.glb"), SPH_OK);
    ck_assert_int_eq(sph_io_save_level(fixture.context, fixture.level, "in.sphm"), SPH_OK);
    ck_assert_int_eq(sph_io_save_level(fixture.context, fixture.level, "in.json"), SPH_OK);
    ck_assert_int_eq(sph_io_save_level(fixture.context, fixture.level, "in.obj"), SPH_OK);
    api_make_file_handles();
    (void)sph_context_fail(fixture.context, SPH_E_INVALID, "a thread's first message takes memory");
    api_files_are_there = true;
    progress.fell = false; /* each of these calls began anew */
}

static sph_status run(const api_call *call, uint64_t seed)
{
    progress.last = 0;
    return call->run(&seed);
}

/* The first arguments with which the call succeeds and takes memory, or those of a few more that take it more often; 0
 * where there are none. */
static uint64_t find_seed(const api_call *call, size_t *most)
{
    uint64_t best = 0;
    unsigned good = 0;
    *most = 0;
    for (uint64_t seed = 1; seed <= SEEDS && good < ENOUGH; ++seed) {
        const size_t before = faulty.calls;
        const sph_status status = run(call, seed);
        if (status != SPH_OK || faulty.calls == before) continue;
        ++good;
        if (faulty.calls - before > *most) {
            *most = faulty.calls - before;
            best = seed;
        }
    }
    return best;
}

static void fail_memory(const api_call *call, uint64_t seed, bool sticky, clock_t enough)
{
    const uint64_t before = state();
    const size_t live = faulty.live_bytes;
    for (size_t n = 1; clock() < enough; n += n < DENSE ? 1 : n / 8) {
        sph_status status;
        bool reached;
        faulty.fail_at = faulty.calls + n;
        faulty.sticky = sticky;
        status = run(call, seed);
        reached = faulty.calls >= faulty.fail_at;
        faulty.fail_at = 0;
        ck_assert_msg(status == SPH_OK || status == SPH_E_NOMEM, "%s: status %d when allocation %zu fails", call->name,
                      (int)status, n);
        if (status != SPH_OK) {
            ck_assert_msg(faulty.live_bytes == live, "%s: %zu bytes, not %zu, after allocation %zu failed", call->name,
                          faulty.live_bytes, live, n);
            ck_assert_msg(state() == before, "%s changes a handle when allocation %zu fails", call->name, n);
        }
        if (!reached || status == SPH_OK) return;
    }
}

static void cancel(const api_call *call, uint64_t seed, clock_t enough)
{
    const uint64_t before = state();
    const size_t live = faulty.live_bytes;
    for (size_t n = 1; clock() < enough; n += n < DENSE ? 1 : n / 8) {
        sph_status status;
        progress.calls = 0;
        progress.cancel_at = n;
        status = run(call, seed);
        progress.cancel_at = 0;
        if (progress.calls < n) return;
        ck_assert_msg(status == SPH_E_CANCELLED, "%s: status %d when report %zu says no", call->name, (int)status, n);
        ck_assert_msg(faulty.live_bytes == live && state() == before, "%s is not as it was after report %zu",
                      call->name, n);
    }
}

START_TEST(what_fails_or_is_cancelled_leaves_all_as_it_was)
{
    const api_call *call = &API_CALLS[_i];
    const clock_t enough = clock() + CLOCKS_PER_SEC / 3;
    uint64_t seed;
    size_t most;
    api_make_scratches();
    make_fixture();
    seed = find_seed(call, &most);
    ck_assert_msg((most > 0) == takes_memory(call->name), "%s %s memory, the table says otherwise", call->name,
                  most > 0 ? "takes" : "takes no");
    if (seed != 0) {
        for (unsigned sticky = 0; sticky < 2; ++sticky)
            fail_memory(call, seed, sticky != 0, enough);
        cancel(call, seed, enough);
    }
    api_destroy_handles();
    sph_context_destroy(fixture.context);
    ck_assert_msg(faulty.live_blocks == 0 && !faulty.misused, "%s: %zu blocks are left", call->name,
                  faulty.live_blocks);
    ck_assert_msg(!progress.fell, "%s: a fraction of progress falls", call->name);
    api_free_scratches();
}
END_TEST

void api_add_failure_tests(TCase *tc)
{
    tcase_add_loop_test(tc, what_fails_or_is_cancelled_leaves_all_as_it_was, 0, (int)API_CALL_COUNT);
}
