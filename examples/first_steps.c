/* SPDX-License-Identifier: MIT */
/* A torus that breathes becomes a hierarchy of animated spheres; its level of 24 spheres is printed. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <sphmesh/sphmesh.h>

enum { AROUND = 48, ACROSS = 16, VERTICES = AROUND * ACROSS, FRAMES = 10, SPHERES = 24 };

static sph_status make_torus(sph_animation *torus)
{
    static float xyz[VERTICES][3];
    static uint32_t triangles[2 * VERTICES][3];
    for (uint32_t i = 0; i < VERTICES; ++i) {
        const uint32_t row = i / ACROSS, next_row = (row + 1) % AROUND, next = (i + 1) % ACROSS;
        const uint32_t b = next_row * ACROSS + i % ACROSS, c = next_row * ACROSS + next, d = row * ACROSS + next;
        const uint32_t both[2][3] = {{i, b, c}, {i, c, d}};
        memcpy(triangles[2 * i], both, sizeof both);
    }
    for (uint32_t frame = 0; frame < FRAMES; ++frame) {
        for (uint32_t i = 0; i < VERTICES; ++i) {
            const double turn = 6.283185307179586, a = turn * (i / ACROSS) / AROUND, b = turn * (i % ACROSS) / ACROSS;
            const double tube = 0.4 + 0.1 * sin(2 * a + turn * frame / FRAMES), ring = 2 + tube * cos(b);
            xyz[i][0] = (float)(ring * cos(a)), xyz[i][1] = (float)(tube * sin(b)), xyz[i][2] = (float)(-ring * sin(a));
        }
        const sph_status status = sph_animation_set_frame(torus, frame, xyz[0], 0);
        if (status != SPH_OK) return status;
    }
    return sph_animation_set_triangles(torus, triangles[0], 2 * VERTICES, 0);
}

static sph_status print_level(const sph_level *level)
{
    sph_level_arrays a = {.struct_size = sizeof a};
    const sph_status status = sph_level_get_arrays(level, &a);
    for (uint32_t i = 0; i < a.sphere_count; ++i) /* none where it failed */
        printf("%2u: radius %.3f at %6.3f %6.3f %6.3f in frame 0\n", i, a.radii[i], a.centers[3 * i],
               a.centers[3 * i + 1], a.centers[3 * i + 2]);
    printf("%zu triangles, %zu wire edges\n", a.triangle_count, a.edge_count);
    return status;
}

int main(void)
{
    sph_context *context = NULL;
    sph_animation *torus = NULL;
    sph_hierarchy *hierarchy = NULL;
    sph_level *level = NULL;
    if (sph_context_create(NULL, &context) != SPH_OK) return 1;
    const bool done = sph_animation_create(context, VERTICES, FRAMES, &torus) == SPH_OK &&
                      make_torus(torus) == SPH_OK && sph_hierarchy_create(torus, NULL, &hierarchy) == SPH_OK &&
                      sph_level_create(hierarchy, SPHERES, &level) == SPH_OK && print_level(level) == SPH_OK;
    if (!done) fprintf(stderr, "%s\n", sph_context_last_message(context));
    sph_level_destroy(level), sph_hierarchy_destroy(hierarchy), sph_animation_destroy(torus);
    sph_context_destroy(context);
    return done ? 0 : 1;
}
