/* SPDX-License-Identifier: MIT */
/*
 * Where the library is built with handle-checks: every public function, given for each of its handles one of every
 * other kind, and ones that were destroyed, refuses it, says so, and harms neither.
 */
#include "calls.h"
#include "support.h"

#if defined(SPH_HANDLE_CHECKS)

enum { KINDS = sizeof(api_fixture) / sizeof(void *), TRIES = 16 };

typedef struct named_handle {
    const char *kind;
    void *handle;
} named_handle;

static void list_handles(named_handle list[KINDS])
{
    const named_handle all[] = {{"context", fixture.context},
                                {"animation", fixture.animation},
                                {"quadric", fixture.quadric},
                                {"hierarchy", fixture.hierarchy},
                                {"cursor", fixture.cursor},
                                {"level", fixture.level},
                                {"query", fixture.query},
                                {"surface", fixture.surface},
                                {"skin", fixture.skin},
                                {"skeleton", fixture.skeleton},
                                {"deformer", fixture.deformer},
                                {"io_rig", fixture.io_rig},
                                {"io_spill", fixture.io_spill},
                                {"progressive", fixture.progressive},
                                {"implicit", fixture.implicit},
                                {"tracker", fixture.tracker},
                                {"io_rig_levels", fixture.io_rig_levels}};
    _Static_assert(sizeof all / sizeof *all == KINDS, "a kind of handle is missing in this list");
    memcpy(list, all, sizeof all);
}

/* What else is given is careless: without a context, say, nothing can be said, but not each time. */
static void refuses(const api_foreign_call *call, const named_handle *given, const char *state)
{
    static const char BEFORE[] = "nothing was said";
    uint64_t random = 77;
    bool said = !call->has_status || strncmp(given->kind, "io_", 3) == 0 || strncmp(call->kind, "io_", 3) == 0;
    for (unsigned i = 0; i == 0 || (!said && i < TRIES); ++i) {
        sph_status status;
        (void)sph_context_fail(fixture.context, SPH_E_INVALID, BEFORE);
        status = call->run(&random, given->handle);
        ck_assert_msg(status != SPH_OK, "%s takes a %s %s for a %s", call->name, state, given->kind, call->kind);
        said = said || strcmp(sph_context_last_message(fixture.context), BEFORE) != 0;
    }
    ck_assert_msg(said, "%s says nothing of a %s %s for a %s", call->name, state, given->kind, call->kind);
}

START_TEST(a_handle_of_another_kind_or_a_destroyed_one_is_refused)
{
    named_handle dead[KINDS], living[KINDS];
    api_make_scratches();
    api_make_context();
    api_make_handles();
    api_make_file_handles();
    list_handles(dead);
    api_destroy_handles();
    api_make_handles();
    api_make_file_handles();
    list_handles(living);
    for (size_t i = 0; i < API_FOREIGN_CALL_COUNT; ++i) {
        const api_foreign_call *call = &API_FOREIGN_CALLS[i];
        if (strcmp(living[_i].kind, call->kind) != 0) refuses(call, &living[_i], "living");
        if (dead[_i].handle != fixture.context) refuses(call, &dead[_i], "destroyed");
    }
    api_destroy_handles();
    sph_context_destroy(fixture.context);
    api_free_scratches();
}
END_TEST

/* The other way into the library: a handle within a struct. */
START_TEST(a_level_among_the_sources_of_a_skin_is_refused)
{
    sph_skin_source source = {0};
    sph_skin *skin = NULL;
    api_make_context();
    api_make_handles();
    source.animation = (const sph_animation *)(const void *)fixture.level;
    ck_assert_int_eq(sph_skin_create(fixture.level, &source, 1, NULL, &skin), SPH_E_INVALID);
    ck_assert_ptr_null(skin);
    api_destroy_handles();
    sph_context_destroy(fixture.context);
}
END_TEST

START_TEST(the_message_names_both_kinds_and_the_function)
{
    api_make_context();
    api_make_handles();
    ck_assert_uint_eq(sph_level_sphere_count((const sph_level *)(const void *)fixture.skin), 0);
    ck_assert_str_eq(sph_context_last_message(fixture.context),
                     "sph_level_sphere_count: a sph_skin is given in place of a sph_level");
    api_destroy_handles();
    sph_context_destroy(fixture.context);
}
END_TEST

void api_add_foreign_tests(TCase *tc)
{
    tcase_add_loop_test(tc, a_handle_of_another_kind_or_a_destroyed_one_is_refused, 0, KINDS);
    tcase_add_test(tc, a_level_among_the_sources_of_a_skin_is_refused);
    tcase_add_test(tc, the_message_names_both_kinds_and_the_function);
}

#else

void api_add_foreign_tests(TCase *tc)
{
    (void)tc; /* such a build does not look at handles, and must not be given foreign ones */
}

#endif
