/* SPDX-License-Identifier: MIT */
#include "hierarchy_case.h"

sph_hierarchy_options default_options(void)
{
    sph_hierarchy_options options;
    sph_hierarchy_options_init(&options, sizeof options);
    return options;
}

sph_hierarchy *build(const sph_animation *animation, const sph_hierarchy_options *options)
{
    sph_hierarchy *h = NULL;
    const sph_status status = sph_hierarchy_create(animation, options, &h);
    ck_assert_msg(status == SPH_OK, "%s", sph_context_last_message(context));
    return h;
}

sph_hierarchy *build_mode(const sph_animation *animation, int32_t radius_mode)
{
    sph_hierarchy_options o = default_options();
    o.radius_mode = radius_mode;
    return build(animation, &o);
}

sph_hierarchy_options choose(unsigned choice)
{
    sph_hierarchy_options o = default_options();
    o.radius_mode = (int32_t)(choice % MODES);
    o.importance = choice / MODES % 2 == 0 ? SPH_IMPORTANCE_CURVATURE : SPH_IMPORTANCE_NONE;
    o.temporal_coherence = choice / MODES / 2 == 0 ? 0 : 0.02;
    return o;
}

sph_level_arrays arrays_of(const sph_level *level)
{
    sph_level_arrays arrays = {.struct_size = sizeof arrays};
    ck_assert_int_eq(sph_level_get_arrays(level, &arrays), SPH_OK);
    return arrays;
}

sph_level *make_level(uint32_t spheres, const float *centers, const float *radii, size_t edge_count,
                      const uint32_t *edges, size_t triangle_count, const uint32_t *triangles)
{
    const sph_level_arrays arrays = {.struct_size = sizeof arrays,
                                     .sphere_count = spheres,
                                     .frame_count = 1,
                                     .centers = centers,
                                     .radii = radii,
                                     .edge_count = edge_count,
                                     .edges = edges,
                                     .triangle_count = triangle_count,
                                     .triangles = triangles};
    sph_level *level = NULL;
    ck_assert_int_eq(sph_level_create_from_arrays(context, &arrays, &level), SPH_OK);
    return level;
}
