/* SPDX-License-Identifier: MIT */
/* Hierarchies, cursors and levels when memory, the frame source or the host's patience ends. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "awkward.h"
#include "faults.h"
#include "runner.h"
#include "support.h"

enum { MODES = 3 };

/* Small, but with refused edges, wires, duplicates and several components among them. */
static const unsigned KINDS[] = {AWKWARD_SINGLE_VERTEX, AWKWARD_WIRES,      AWKWARD_DUPLICATES, AWKWARD_BOOK,
                                 AWKWARD_DENSE_SOUP,    AWKWARD_COMPONENTS, AWKWARD_COLLAPSING};
enum { KIND_COUNT = sizeof KINDS / sizeof *KINDS };

static sph_hierarchy_options choose(int32_t mode, double coherence)
{
    sph_hierarchy_options o;
    sph_hierarchy_options_init(&o, sizeof o);
    o.radius_mode = mode;
    o.temporal_coherence = coherence;
    o.width_directions = 5;
    return o;
}

/* Everything that a hierarchy is made for. */
static sph_status use(const sph_hierarchy *h, const sph_animation *animation)
{
    const uint32_t n = sph_hierarchy_vertex_count(h), middle = n - sph_hierarchy_collapse_count(h) / 2;
    uint32_t *nodes = test_malloc(n, sizeof *nodes);
    sph_cursor *cursor = NULL;
    sph_level *level = NULL;
    sph_status status = sph_cursor_create(h, &cursor);
    ck_assert((cursor != NULL) == (status == SPH_OK));
    if (status == SPH_OK) status = sph_cursor_move(cursor, middle);
    if (status == SPH_OK) status = sph_cursor_read(cursor, nodes, NULL, NULL);
    if (status == SPH_OK) status = sph_level_create(h, middle, &level);
    ck_assert((level != NULL) == (status == SPH_OK));
    if (status == SPH_OK) status = sph_level_optimize_connectivity(level, animation);
    sph_level_destroy(level);
    sph_cursor_destroy(cursor);
    free(nodes);
    return status;
}

typedef struct build {
    unsigned kind;
    sph_hierarchy_options options;
} build;

static sph_status build_and_use(sph_context *context, const void *user)
{
    const build *b = user;
    sph_animation *animation = awkward(context, b->kind, 2);
    sph_hierarchy *h = NULL;
    sph_status status = SPH_E_NOMEM;
    if (animation != NULL) {
        status = sph_hierarchy_create(animation, &b->options, &h);
        ck_assert((h != NULL) == (status == SPH_OK));
        if (status == SPH_OK) status = use(h, animation);
    }
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
    return status;
}

/* _i: the kind, the radius mode, and whether an allocation fails once or all do from there on. */
START_TEST(every_allocation_may_fail)
{
    const build b = {KINDS[_i / (2 * MODES)], choose(_i / 2 % MODES, _i % 2 == 0 ? 0.02 : 0)};
    check_every_allocation((test_faults){.work = build_and_use, .user = &b, .least = 20, .sticky = _i % 2});
}
END_TEST

static sph_status build_alone(sph_context *context, const void *user)
{
    sph_animation *animation = test_torus(context, 40, 25, 5);
    sph_hierarchy *h = (sph_hierarchy *)animation;
    const sph_status status = sph_hierarchy_create(animation, user, &h);
    ck_assert((h != NULL) == (status == SPH_OK));
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
    return status;
}

START_TEST(building_may_be_cancelled_at_every_report)
{
    const sph_hierarchy_options o = choose((int32_t)_i, 0.02);
    check_every_cancel((test_faults){.work = build_alone, .user = &o, .least = 20, .complete = true});
}
END_TEST

START_TEST(a_frame_source_may_fail_at_every_frame)
{
    static const sph_status FAILURES[] = {SPH_E_IO, SPH_E_FORMAT, SPH_E_CANCELLED, 1234};
    sph_context *plain = test_context();
    sph_animation *stored = awkward(plain, AWKWARD_WHISKERS, 9);
    for (size_t n = 1; n <= 9; ++n) {
        test_faulty faulty = {0};
        const sph_allocator allocator = test_faulty_allocator(&faulty);
        sph_context *context = test_context_with_allocator(&allocator);
        test_source source = {.from = stored, .fail_at = n, .failure = FAILURES[_i]};
        sph_animation *pulled = test_pulled(context, &source);
        sph_hierarchy *h = (sph_hierarchy *)pulled;
        ck_assert_int_eq(sph_hierarchy_create(pulled, NULL, &h), FAILURES[_i]);
        ck_assert_ptr_null(h);
        ck_assert_uint_eq(source.reads, n);
        sph_animation_destroy(pulled);
        sph_context_destroy(context);
        ck_assert_uint_eq(source.destroys, 1);
        ck_assert_uint_eq(faulty.live_blocks, 0);
    }
    sph_animation_destroy(stored);
    sph_context_destroy(plain);
}
END_TEST

static void read_level(const sph_level *level, sph_level_arrays *arrays)
{
    *arrays = (sph_level_arrays){.struct_size = sizeof *arrays};
    ck_assert_int_eq(sph_level_get_arrays(level, arrays), SPH_OK);
}

/* A failed optimisation leaves the level as it was: not even its memory has moved. */
START_TEST(a_level_is_unchanged_when_its_optimisation_fails)
{
    for (size_t n = 1;; ++n) {
        test_faulty faulty = {0};
        const sph_allocator allocator = test_faulty_allocator(&faulty);
        test_progress progress = {0};
        sph_context_options options;
        sph_context *context;
        sph_animation *animation, *pulled;
        test_source source = {.failure = SPH_E_IO};
        sph_hierarchy *h;
        sph_level *level;
        sph_level_arrays before, after;
        sph_status status, expected = SPH_E_NOMEM;
        bool reached;
        sph_context_options_init(&options, sizeof options);
        options.allocator = allocator;
        options.progress = test_progress_callback;
        options.progress_user = &progress;
        ck_assert_int_eq(sph_context_create(&options, &context), SPH_OK);
        animation = awkward(context, AWKWARD_WHISKERS, 9);
        ck_assert_int_eq(sph_hierarchy_create(animation, NULL, &h), SPH_OK);
        ck_assert_int_eq(sph_level_create(h, 12, &level), SPH_OK);
        source.from = animation;
        pulled = test_pulled(context, &source);
        read_level(level, &before);
        progress = (test_progress){0};
        faulty.calls = 0;
        if (_i < 2) {
            faulty.fail_at = n;
            faulty.sticky = _i == 1;
        } else if (_i == 2) {
            progress.cancel_at = n;
            expected = SPH_E_CANCELLED;
        } else {
            source.fail_at = n;
            expected = SPH_E_IO;
        }
        status = sph_level_optimize_connectivity(level, pulled);
        reached = (_i < 2 ? faulty.calls : _i == 2 ? progress.calls : source.reads) >= n;
        faulty.fail_at = 0;
        read_level(level, &after);
        if (reached) ck_assert_mem_eq(&before, &after, sizeof before);
        sph_level_destroy(level);
        sph_hierarchy_destroy(h);
        sph_animation_destroy(pulled);
        sph_animation_destroy(animation);
        sph_context_destroy(context);
        ck_assert_uint_eq(faulty.live_blocks, 0);
        ck_assert(!progress.fell && !faulty.misused);
        ck_assert_int_eq(status, reached ? expected : SPH_OK);
        if (!reached) {
            ck_assert_uint_gt(n, 5);
            return;
        }
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("hierarchy failures");
    TCase *tc = tcase_create("all");
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, every_allocation_may_fail, 0, KIND_COUNT * 2 * MODES);
    tcase_add_loop_test(tc, building_may_be_cancelled_at_every_report, 0, MODES);
    tcase_add_loop_test(tc, a_frame_source_may_fail_at_every_frame, 0, 4);
    tcase_add_loop_test(tc, a_level_is_unchanged_when_its_optimisation_fails, 0, 4);
    return run_suite(suite, tc);
}
