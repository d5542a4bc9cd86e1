/* SPDX-License-Identifier: MIT */
#include "weld_case.h"

#include <stdlib.h>
#include <string.h>

#include "context_case.h"

float *read_all(const sph_animation *a)
{
    const size_t n = sph_animation_vertex_count(a), frames = sph_animation_frame_count(a);
    float *xyz = test_malloc(frames * n, 3 * sizeof *xyz);
    for (uint32_t f = 0; f < frames; ++f)
        ck_assert_int_eq(sph_animation_read_frame(a, f, xyz + f * n * 3), SPH_OK);
    return xyz;
}

sph_animation *taken_apart(const sph_animation *a)
{
    const size_t n = sph_animation_vertex_count(a), m = sph_animation_triangle_count(a);
    const uint32_t frames = sph_animation_frame_count(a), *t = sph_animation_triangles(a);
    float *xyz = read_all(a), *corners = test_malloc(3 * m, 3 * sizeof *corners);
    uint32_t *indices = test_malloc(3 * m, sizeof *indices);
    sph_animation *apart;
    ck_assert_int_eq(sph_animation_create(context, (uint32_t)(3 * m), frames, &apart), SPH_OK);
    for (uint32_t f = 0; f < frames; ++f) {
        for (size_t i = 0; i < 3 * m; ++i)
            memcpy(corners + 3 * i, xyz + (f * n + t[i]) * 3, 3 * sizeof *xyz);
        ck_assert_int_eq(sph_animation_set_frame(apart, f, corners, 0), SPH_OK);
    }
    for (size_t i = 0; i < 3 * m; ++i)
        indices[i] = (uint32_t)i;
    ck_assert_int_eq(sph_animation_set_triangles(apart, indices, m, 0), SPH_OK);
    free(indices);
    free(corners);
    free(xyz);
    return apart;
}
