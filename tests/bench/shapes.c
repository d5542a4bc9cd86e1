/* SPDX-License-Identifier: MIT */
#define _XOPEN_SOURCE 700

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bench.h"

enum { SAMBA_RINGS = 169, SAMBA_SIDES = 59, SAMBA_FRAMES = 175 };

bench_shape bench_shape_of(uint32_t n, uint32_t frames)
{
    uint32_t sides = (uint32_t)lround(sqrt(n / 2.5));
    if (sides < 8) sides = 8;
    return (bench_shape){.rings = n / sides, .sides = sides, .frames = frames};
}

/* Vertex (ring, side) of frame f: bumps all over, a bend that travels, and a breath. */
static void place(const bench_shape *s, uint32_t ring, uint32_t side, uint32_t frame, float xyz[3])
{
    const double phase = 2 * M_PI * frame / s->frames;
    const double a = 2 * M_PI * ring / s->rings, b = 2 * M_PI * side / s->sides;
    const double bump = 0.02 * sin(17 * a) * sin(9 * b) + 0.01 * sin(41 * a + 1) * sin(23 * b + 2);
    const double r = 0.25 + 0.08 * sin(3 * a + phase) + bump;
    xyz[0] = (float)((1 + r * cos(b)) * cos(a));
    xyz[1] = (float)((1 + r * cos(b)) * sin(a));
    xyz[2] = (float)(r * sin(b) + 0.3 * sin(2 * a + phase));
}

static sph_status read_frame(void *user, uint32_t frame, float *xyz)
{
    const bench_shape *s = user;
    for (uint32_t ring = 0; ring < s->rings; ++ring)
        for (uint32_t side = 0; side < s->sides; ++side, xyz += 3)
            place(s, ring, side, frame, xyz);
    return SPH_OK;
}

static uint32_t *make_triangles(bench_shape s, size_t count)
{
    uint32_t *triangles = calloc(count, 3 * sizeof *triangles), *t = triangles;
    for (uint32_t i = 0; i < s.rings * s.sides && triangles != NULL; ++i, t += 6) {
        const uint32_t ring = i / s.sides, side = i % s.sides, next = (ring + 1) % s.rings, up = (side + 1) % s.sides;
        const uint32_t two[6] = {i,
                                 next * s.sides + side,
                                 ring * s.sides + up,
                                 next * s.sides + side,
                                 next * s.sides + up,
                                 ring * s.sides + up};
        memcpy(t, two, sizeof two);
    }
    return triangles;
}

sph_animation *bench_torus(sph_context *context, bench_shape shape)
{
    const size_t triangle_count = 2 * (size_t)shape.rings * shape.sides;
    uint32_t *triangles = make_triangles(shape, triangle_count);
    bench_shape *kept = malloc(sizeof *kept);
    sph_animation *animation;
    if (triangles == NULL || kept == NULL) bench_die(NULL, "memory");
    *kept = shape;
    if (sph_animation_create_from_source(context, shape.rings * shape.sides, shape.frames,
                                         &(sph_frame_source){kept, read_frame, free}, &animation) != SPH_OK ||
        sph_animation_set_triangles(animation, triangles, triangle_count, 0) != SPH_OK)
        bench_die(context, "torus");
    free(triangles);
    return animation;
}

sph_animation *bench_samba(sph_context *context)
{
    char mesh[1024], cache[1024];
    const char *path = mesh;
    sph_io_open_options o;
    sph_animation *animation;
    if (bench.data == NULL || bench.tiny) return NULL;
    snprintf(mesh, sizeof mesh, "%s/samba.obj", bench.data);
    snprintf(cache, sizeof cache, "%s/samba.mdd", bench.data);
    if (access(mesh, R_OK) != 0 || access(cache, R_OK) != 0) return NULL;
    sph_io_open_options_init(&o, sizeof o);
    o.cache_path = cache;
    if (sph_io_open_animation(context, &path, 1, &o, &animation) != SPH_OK) bench_die(context, "samba");
    return animation;
}

sph_animation *bench_samba_or_torus(sph_context *context, const char **name)
{
    sph_animation *samba = bench_samba(context);
    *name = samba != NULL ? "samba" : "torus";
    if (samba != NULL) return samba;
    if (bench.tiny) return bench_torus(context, bench_shape_of(400, 20));
    return bench_torus(context, (bench_shape){SAMBA_RINGS, SAMBA_SIDES, SAMBA_FRAMES});
}

sph_animation *bench_hold(sph_context *context, const sph_animation *from)
{
    const uint32_t n = sph_animation_vertex_count(from), frames = sph_animation_frame_count(from);
    float *xyz = calloc(n, 3 * sizeof *xyz);
    sph_animation *held;
    if (xyz == NULL || sph_animation_create(context, n, frames, &held) != SPH_OK) bench_die(context, "animation");
    for (uint32_t f = 0; f < frames; ++f)
        if (sph_animation_read_frame(from, f, xyz) != SPH_OK || sph_animation_set_frame(held, f, xyz, 0) != SPH_OK)
            bench_die(context, "frames");
    if (sph_animation_set_triangles(held, sph_animation_triangles(from), sph_animation_triangle_count(from), 0) !=
        SPH_OK)
        bench_die(context, "triangles");
    free(xyz);
    return held;
}
