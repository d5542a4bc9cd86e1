/* SPDX-License-Identifier: MIT */
#include "coverage_case.h"

sph_animation *points(sph_context *of, const float *xyz, uint32_t count, uint32_t frames)
{
    sph_animation *animation = NULL;
    if (sph_animation_create(of, count, frames, &animation) != SPH_OK) return NULL;
    for (uint32_t f = 0; f < frames; ++f)
        sph_animation_set_frame(animation, f, xyz + 3 * (size_t)count * f, 0);
    return animation;
}

sph_coverage measure(const sph_animation *animation, const sph_level *level)
{
    sph_coverage c = {.struct_size = sizeof c};
    ck_assert_msg(sph_coverage_measure(animation, level, &c) == SPH_OK, "%s", sph_context_last_message(context));
    return c;
}

sph_level *inflate(const sph_animation *animation, const sph_level *level, double margin, sph_inflation *out)
{
    sph_inflation_options o;
    sph_level *inflated = NULL;
    sph_inflation_options_init(&o, sizeof o);
    o.margin = margin;
    *out = (sph_inflation){.struct_size = sizeof *out};
    ck_assert_msg(sph_coverage_inflate(animation, level, &o, out, &inflated) == SPH_OK, "%s",
                  sph_context_last_message(context));
    return inflated;
}

const test_solid SOLIDS[3] = {
    {.sphere_count = 1, .centers = {{1, 2, 3}}, .radii = {0.5f}},
    {.sphere_count = 2, .centers = {{0, 0, 0}, {2, 0, 0}}, .radii = {0.5f, 0.5f}, .edge_count = 1, .edges = {{0, 1}}},
    {.sphere_count = 3,
     .centers = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}},
     .radii = {0.5f, 0.5f, 0.5f},
     .triangle_count = 1,
     .triangles = {{0, 1, 2}}}};

test_solid random_solid(uint64_t *state)
{
    test_solid s = {.sphere_count = 9, .edge_count = 5, .triangle_count = 4};
    for (uint32_t i = 0; i < s.sphere_count; ++i) {
        const double r = test_random_unit(state);
        for (int k = 0; k < 3; ++k)
            s.centers[i][k] = (float)test_random_unit(state);
        s.radii[i] = (float)(r < 0.3 ? 0 : 0.3 * r * r);
    }
    for (uint32_t i = 0; i < s.edge_count; ++i)
        for (int k = 0; k < 2; ++k)
            s.edges[i][k] = (uint32_t)(test_random(state) % 9);
    for (uint32_t i = 0; i < s.triangle_count; ++i)
        for (int k = 0; k < 3; ++k)
            s.triangles[i][k] = (uint32_t)(test_random(state) % 9);
    return s;
}

void random_points(uint64_t *state, float *xyz, size_t count)
{
    for (size_t i = 0; i < 3 * count; ++i)
        xyz[i] = (float)(1.4 * test_random_unit(state) - 0.2);
}

sph_level *still_level(sph_context *of, const test_solid *s, uint32_t frames, uint32_t per_frame)
{
    float centers[FRAMES * TEST_SOLID_SPHERES * 3], radii[FRAMES * TEST_SOLID_SPHERES];
    const sph_level_arrays a = {.struct_size = sizeof a,
                                .sphere_count = s->sphere_count,
                                .frame_count = frames,
                                .radii_per_frame = per_frame,
                                .centers = centers,
                                .radii = radii,
                                .edge_count = s->edge_count,
                                .edges = s->edges[0],
                                .triangle_count = s->triangle_count,
                                .triangles = s->triangles[0]};
    sph_level *level = NULL;
    for (uint32_t f = 0; f < frames; ++f) {
        memcpy(centers + 3 * (size_t)f * s->sphere_count, s->centers, 12 * (size_t)s->sphere_count);
        memcpy(radii + (size_t)f * s->sphere_count, s->radii, 4 * (size_t)s->sphere_count);
    }
    sph_level_create_from_arrays(of, &a, &level);
    return level;
}
