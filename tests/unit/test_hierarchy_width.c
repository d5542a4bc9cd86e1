/* SPDX-License-Identifier: MIT */
/* The radius bound, against widths taken from all points of all cells in all frames and directions. */
#include <check.h>
#include <math.h>
#include <stdlib.h>

#include "hierarchy/hierarchy.h"
#include "runner.h"
#include "support.h"

enum { VERTICES = 60, TRIANGLES = 90, MOST_DIRECTIONS = 60, MOST_FRAMES = 64, SEEDS = 150 };

/* Least and greatest coordinate of a region along each direction of each frame. */
typedef struct extents {
    double low[MOST_FRAMES][MOST_DIRECTIONS], high[MOST_FRAMES][MOST_DIRECTIONS];
} extents;

static void widen(extents *e, uint32_t frame, uint32_t count, double (*directions)[3], const double x[3])
{
    for (uint32_t j = 0; j < count; ++j) {
        const double along = directions[j][0] * x[0] + directions[j][1] * x[1] + directions[j][2] * x[2];
        e->low[frame][j] = fmin(e->low[frame][j], along);
        e->high[frame][j] = fmax(e->high[frame][j], along);
    }
}

/* The points of a vertex's cell: itself, and the midpoints and centroids of its triangles. */
static void make_leaf(extents *e, uint32_t v, uint32_t frame, float (*xyz)[3], const uint32_t *corners, uint32_t count,
                      double (*directions)[3])
{
    double x[3];
    for (uint32_t j = 0; j < count; ++j) {
        e->low[frame][j] = INFINITY;
        e->high[frame][j] = -INFINITY;
    }
    for (unsigned k = 0; k < 3; ++k)
        x[k] = xyz[v][k];
    widen(e, frame, count, directions, x);
    for (size_t t = 0; t < TRIANGLES; ++t) {
        const uint32_t *c = corners + 3 * t;
        if (c[0] != v && c[1] != v && c[2] != v) continue;
        for (unsigned i = 0; i < 4; ++i) {
            for (unsigned k = 0; k < 3; ++k)
                x[k] = i < 3 ? ((double)xyz[v][k] + (double)xyz[c[i]][k]) / 2
                             : ((double)xyz[c[0]][k] + (double)xyz[c[1]][k] + (double)xyz[c[2]][k]) / 3;
            widen(e, frame, count, directions, x);
        }
    }
}

static void unite(extents *e, const extents *other, uint32_t frames, uint32_t count)
{
    for (uint32_t f = 0; f < frames; ++f)
        for (uint32_t j = 0; j < count; ++j) {
            e->low[f][j] = fmin(e->low[f][j], other->low[f][j]);
            e->high[f][j] = fmax(e->high[f][j], other->high[f][j]);
        }
}

static double width_in_frame(const extents *e, uint32_t frame, uint32_t count)
{
    double width = INFINITY;
    for (uint32_t j = 0; j < count; ++j)
        width = fmin(width, e->high[frame][j] - e->low[frame][j]);
    return width;
}

/* A soup that is stretched and shaken anew in each frame, so that regions are thin now here, now there. */
static sph_animation *make_animation(sph_context *context, uint32_t frames, uint64_t seed)
{
    sph_animation *soup = test_soup(context, VERTICES, TRIANGLES, 1, seed), *animation;
    float rest[VERTICES][3], xyz[VERTICES][3];
    ck_assert_int_eq(sph_animation_create(context, VERTICES, frames, &animation), SPH_OK);
    ck_assert_int_eq(sph_animation_read_frame(soup, 0, rest[0]), SPH_OK);
    for (uint32_t f = 0; f < frames; ++f) {
        const double shake = test_random_unit(&seed);
        const double stretch[3] = {0.2 + test_random_unit(&seed), 0.2 + test_random_unit(&seed), 1};
        for (unsigned i = 0; i < 3 * VERTICES; ++i)
            xyz[i / 3][i % 3] =
                (float)(((double)rest[i / 3][i % 3] + shake * test_random_unit(&seed)) * stretch[i % 3]);
        ck_assert_int_eq(sph_animation_set_frame(animation, f, xyz[0], 0), SPH_OK);
    }
    ck_assert_int_eq(sph_animation_set_triangles(animation, sph_animation_triangles(soup), TRIANGLES, 0), SPH_OK);
    sph_animation_destroy(soup);
    return animation;
}

static extents *make_leaves(const sph_animation *animation, uint32_t count, double (*directions)[3])
{
    extents *leaves = test_malloc(2 * VERTICES, sizeof *leaves);
    float xyz[VERTICES][3];
    for (uint32_t f = 0; f < sph_animation_frame_count(animation); ++f) {
        ck_assert_int_eq(sph_animation_read_frame(animation, f, xyz[0]), SPH_OK);
        for (uint32_t v = 0; v < VERTICES; ++v)
            make_leaf(&leaves[v], v, f, xyz, sph_animation_triangles(animation), count, directions);
    }
    return leaves;
}

/* Returns how many spheres are as large as they may be. */
static unsigned check_radii(sph_context *context, int32_t mode, uint32_t frames, uint64_t seed)
{
    sph_animation *animation = make_animation(context, frames, seed);
    double directions[MOST_DIRECTIONS][3];
    sph_hierarchy_options o;
    sph_hierarchy *h;
    extents *regions;
    unsigned at_bound = 0;
    sph_hierarchy_options_init(&o, sizeof o);
    o.radius_mode = mode;
    o.radius_factor = 0.05 + 0.3 * (double)(seed % 3);
    o.width_directions = seed % 2 == 0 ? MOST_DIRECTIONS : 16;
    sph__width_directions(o.width_directions, directions);
    regions = make_leaves(animation, o.width_directions, directions);
    ck_assert_int_eq(sph_hierarchy_create(animation, &o, &h), SPH_OK);
    for (uint32_t t = 0; t < sph_hierarchy_collapse_count(h); ++t) {
        double least = INFINITY;
        float radii[MOST_FRAMES];
        sph_collapse c;
        ck_assert_int_eq(sph_hierarchy_collapse(h, t, &c), SPH_OK);
        regions[c.node] = regions[c.u];
        unite(&regions[c.node], &regions[c.v], frames, o.width_directions);
        ck_assert_int_eq(sph_hierarchy_sphere(h, c.node, NULL, radii), SPH_OK);
        for (uint32_t f = 0; f < frames; ++f) {
            const double width = width_in_frame(&regions[c.node], f, o.width_directions);
            least = fmin(least, width);
            if (mode == SPH_RADIUS_CONSTANT) continue;
            ck_assert_double_le((double)radii[f], o.radius_factor * width * (1 + 1e-6));
            at_bound += (double)radii[f] > o.radius_factor * width * (1 - 1e-6);
        }
        if (mode != SPH_RADIUS_CONSTANT) continue;
        ck_assert_double_le((double)radii[0], o.radius_factor * least * (1 + 1e-6));
        at_bound += (double)radii[0] > o.radius_factor * least * (1 - 1e-6);
    }
    free(regions);
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
    return at_bound;
}

START_TEST(no_radius_is_more_than_its_share_of_the_width)
{
    static const uint32_t FRAMES[] = {1, 2, 3, 8, 17, MOST_FRAMES};
    sph_context *context = test_context();
    unsigned at_bound = 0;
    for (uint64_t seed = 0; seed < SEEDS; ++seed)
        at_bound += check_radii(context, _i % 2 == 0 ? SPH_RADIUS_CONSTANT : SPH_RADIUS_PER_FRAME, FRAMES[_i / 2],
                                (uint64_t)_i << 32 | seed);
    ck_assert_uint_gt(at_bound, 100);
    sph_context_destroy(context);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("hierarchy width");
    TCase *tc = tcase_create("all");
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, no_radius_is_more_than_its_share_of_the_width, 0, 12);
    return run_suite(suite, tc);
}
