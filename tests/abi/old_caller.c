/* SPDX-License-Identifier: MIT */
/*
 * A caller of yesterday: compiled against first/, the headers as they were first given out, and linked with the library
 * of today. first/ never changes while the soname stays.
 */
#include <stdio.h>
#include <stdlib.h>

#include <sphmesh/io.h>
#include <sphmesh/sphmesh.h>

/* An octahedron in two frames. */
static const float FRAMES[2][6][3] = {
    {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
    {{2, 0, 0}, {-2, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
};
static const uint32_t TRIANGLES[8][3] = {
    {0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5},
};

static int failures;
static size_t live, allocations;
static unsigned reports;

static void expect(int true_it_is, const char *what)
{
    if (true_it_is) return;
    ++failures;
    fprintf(stderr, "not so: %s\n", what);
}

/* The structs of the old headers end where something of the caller's own begins: nothing may be written there. */
#define GUARDED(type, name)                                                                                            \
    struct {                                                                                                           \
        type options;                                                                                                  \
        unsigned char guard[64];                                                                                       \
    } name = {.guard = {0x5a, 0x5a, 0x5a, 0x5a, 0x5a, 0x5a, 0x5a, 0x5a}}
#define EXPECT_GUARD(name)                                                                                             \
    for (unsigned guard_ = 0; guard_ < 64; ++guard_)                                                                   \
    expect((name).guard[guard_] == (guard_ < 8 ? 0x5a : 0), "what follows " #name " is left alone")

static void *allocate(void *user, size_t size, size_t alignment)
{
    void *memory = NULL;
    (void)user;
    if (posix_memalign(&memory, alignment < sizeof(void *) ? sizeof(void *) : alignment, size) != 0) return NULL;
    live += size;
    ++allocations;
    return memory;
}

static void release(void *user, void *memory, size_t size)
{
    (void)user;
    live -= size;
    free(memory);
}

static bool progress(void *user, const char *stage, double fraction)
{
    (void)user;
    ++reports;
    return stage != NULL && fraction >= 0 && fraction <= 1;
}

static sph_context *make_context(void)
{
    GUARDED(sph_context_options, o);
    sph_context *context = NULL;
    sph_context_options_init(&o.options, sizeof o.options);
    EXPECT_GUARD(o);
    o.options.allocator = (sph_allocator){NULL, allocate, release};
    o.options.progress = progress;
    o.options.thread_count = 1;
    expect(sph_context_create(&o.options, &context) == SPH_OK, "a context is made");
    return context;
}

static sph_animation *make_animation(sph_context *context)
{
    GUARDED(sph_animation_report, report);
    sph_animation *animation = NULL;
    expect(sph_animation_create(context, 6, 2, &animation) == SPH_OK, "an animation is made");
    expect(sph_animation_set_triangles(animation, TRIANGLES[0], 8, 0) == SPH_OK, "triangles are taken");
    for (uint32_t f = 0; f < 2; ++f)
        expect(sph_animation_set_frame(animation, f, FRAMES[f][0], 0) == SPH_OK, "a frame is taken");
    sph_animation_report_init(&report.options, sizeof report.options);
    expect(sph_animation_check(animation, &report.options) == SPH_OK, "the animation is checked");
    EXPECT_GUARD(report);
    expect(report.options.component_count == 1 && report.options.boundary_edge_count == 0, "the report counts");
    return animation;
}

static sph_hierarchy *make_hierarchy(const sph_animation *animation)
{
    GUARDED(sph_hierarchy_options, o);
    sph_hierarchy *hierarchy = NULL;
    sph_collapse collapse;
    sph_hierarchy_options_init(&o.options, sizeof o.options);
    EXPECT_GUARD(o);
    o.options.width_directions = 13;
    expect(sph_hierarchy_create(animation, &o.options, &hierarchy) == SPH_OK, "a hierarchy is made");
    expect(sph_hierarchy_collapse_count(hierarchy) == 5, "one sphere is left");
    expect(sph_hierarchy_collapse(hierarchy, 4, &collapse) == SPH_OK && collapse.node == 10, "a collapse is told");
    return hierarchy;
}

static void query_level(const sph_level *level)
{
    static const float POINT[3] = {0, 0, 0};
    GUARDED(sph_query_options, o);
    sph_query *query = NULL;
    sph_nearest nearest;
    sph_sweep sweep = {.from = {-9, 0, 0}, .to = {9, 0, 0}, .radius = 0.25F};
    sph_hit hit;
    sph_query_options_init(&o.options, sizeof o.options);
    EXPECT_GUARD(o);
    expect(sph_query_create(level, &o.options, &query) == SPH_OK, "a query is made");
    expect(sph_query_pose_frame(query, 0) == SPH_OK, "a query is posed");
    expect(sph_query_nearest(query, POINT, 0, 1, &nearest) == SPH_OK, "the nearest point is found");
    expect(nearest.distance < 0.5, "the centre of the body is not far outside");
    expect(sph_query_cast(query, &sweep, 1, &hit) == SPH_OK && hit.hit == 1, "a sphere on its way hits");
    sph_query_destroy(query);
}

static void use_level(const sph_animation *animation, const sph_hierarchy *hierarchy)
{
    GUARDED(sph_level_arrays, arrays);
    GUARDED(sph_surface_options, so);
    GUARDED(sph_measure_options, mo);
    sph_distances mean;
    sph_surface *surface = NULL;
    sph_level *level = NULL;
    arrays.options.struct_size = sizeof arrays.options;
    expect(sph_level_create(hierarchy, 3, &level) == SPH_OK, "a level is made");
    expect(sph_level_get_arrays(level, &arrays.options) == SPH_OK, "a level shows its arrays");
    EXPECT_GUARD(arrays);
    expect(arrays.options.sphere_count == 3 && arrays.options.label_count == 6, "the level counts");
    query_level(level);
    sph_surface_options_init(&so.options, sizeof so.options);
    EXPECT_GUARD(so);
    so.options.resolution = 16;
    expect(sph_surface_create(level, &so.options, &surface) == SPH_OK, "a surface is made");
    sph_surface_destroy(surface);
    sph_measure_options_init(&mo.options, sizeof mo.options);
    EXPECT_GUARD(mo);
    mo.options.samples = 3000;
    expect(sph_measure_level(animation, level, &mo.options, &mean, NULL) == SPH_OK, "a level is measured");
    sph_level_destroy(level);
}

int main(void)
{
    GUARDED(sph_io_open_options, open);
    sph_context *context = make_context();
    sph_animation *animation = make_animation(context);
    sph_hierarchy *hierarchy = make_hierarchy(animation);
    use_level(animation, hierarchy);
    sph_io_open_options_init(&open.options, sizeof open.options);
    EXPECT_GUARD(open);
    expect(sph_version() >= SPH_VERSION && sph_version() / 1000000 == SPH_VERSION_MAJOR, "the library is not older");
    sph_hierarchy_destroy(hierarchy);
    sph_animation_destroy(animation);
    sph_context_destroy(context);
    expect(live == 0 && allocations > 10, "all memory came from the caller and went back");
    expect(reports > 0, "progress was reported");
    printf("%s\n", failures == 0 ? "the caller of yesterday runs" : "the caller of yesterday fails");
    return failures != 0;
}
