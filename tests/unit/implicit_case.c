/* SPDX-License-Identifier: MIT */
#include "implicit_case.h"

#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

static void set_weights(tube *t, size_t v)
{
    const double x = (double)t->rest[v][0], u = x < -1 ? 0 : x > 1 ? 1 : (x + 1) / 2, w = u * u * (3 - 2 * u);
    t->bones[v][0] = 0;
    t->bones[v][1] = 1;
    t->weights[v][0] = (float)(1 - w);
    t->weights[v][1] = (float)w;
}

static void set_triangles(tube *t)
{
    size_t at = 0;
    const uint32_t first = TUBE_RINGS * TUBE_SIDES, last = first + 1;
    for (uint32_t r = 0; r + 1 < TUBE_RINGS; ++r)
        for (uint32_t s = 0; s < TUBE_SIDES; ++s) {
            const uint32_t a = r * TUBE_SIDES + s, b = r * TUBE_SIDES + (s + 1) % TUBE_SIDES;
            const uint32_t c = a + TUBE_SIDES, d = b + TUBE_SIDES;
            const uint32_t two[2][3] = {{a, b, c}, {b, d, c}};
            memcpy(t->triangles[at], two, sizeof two);
            at += 2;
        }
    for (uint32_t s = 0; s < TUBE_SIDES; ++s) {
        const uint32_t next = (s + 1) % TUBE_SIDES, end = (TUBE_RINGS - 1) * TUBE_SIDES;
        const uint32_t two[2][3] = {{first, next, s}, {last, end + s, end + next}};
        memcpy(t->triangles[at], two, sizeof two);
        at += 2;
    }
}

void tube_init(tube *t)
{
    memset(t, 0, sizeof *t);
    for (size_t v = 0; v < TUBE_VERTICES; ++v) {
        const size_t ring = v / TUBE_SIDES;
        const double angle = 2 * PI * (double)(v % TUBE_SIDES) / TUBE_SIDES,
                     x = -4 + 8.0 * (double)ring / (TUBE_RINGS - 1);
        const bool center = v >= (size_t)TUBE_RINGS * TUBE_SIDES;
        t->rest[v][0] = (float)(!center ? x : v + 1 < TUBE_VERTICES ? -4 : 4);
        t->rest[v][1] = (float)(center ? 0 : cos(angle));
        t->rest[v][2] = (float)(center ? 0 : sin(angle));
        set_weights(t, v);
    }
    set_triangles(t);
    t->pivots[0][0] = -4;
    t->parents[0] = UINT32_MAX;
    t->arrays = (sph_skin_arrays){.struct_size = sizeof t->arrays,
                                  .vertex_count = TUBE_VERTICES,
                                  .bone_count = 2,
                                  .influence_count = 2,
                                  .rest = t->rest[0],
                                  .bones = t->bones[0],
                                  .weights = t->weights[0],
                                  .pivots = t->pivots[0],
                                  .triangle_count = TUBE_TRIANGLES,
                                  .triangles = t->triangles[0]};
}

sph_skin *tube_skin(const tube *t, sph_context *context)
{
    sph_skin *skin = NULL;
    (void)sph_skin_create_from_arrays(context, &t->arrays, &skin);
    return skin;
}

sph_implicit *tube_implicit(const sph_skin *skin, const tube *t, int32_t operation)
{
    sph_implicit *implicit = NULL;
    sph_implicit_options o;
    sph_implicit_options_init(&o, sizeof o);
    o.parents = t->parents;
    o.operation = operation;
    o.operator_table_size = 48; /* as good here, and sooner there */
    (void)sph_implicit_create(skin, &o, &implicit);
    return implicit;
}

void tube_pose(double bend, double twist, double transforms[2][12])
{
    static const double IDENTITY[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    const double c = cos(bend), s = sin(bend), d = cos(twist), t = sin(twist);
    const double second[12] = {c, -s * d, s * t, 0, s, c * d, -c * t, 0, 0, t, d, 0};
    memcpy(transforms[0], IDENTITY, sizeof IDENTITY);
    memcpy(transforms[1], second, sizeof second);
}

double mesh_volume(const float *positions, const uint32_t *triangles, size_t triangle_count)
{
    double sum = 0;
    for (size_t t = 0; t < triangle_count; ++t) {
        const float *p = positions + 3 * (size_t)triangles[3 * t], *q = positions + 3 * (size_t)triangles[3 * t + 1];
        const float *r = positions + 3 * (size_t)triangles[3 * t + 2];
        for (int c = 0; c < 3; ++c) {
            const int i = (c + 1) % 3, k = (c + 2) % 3;
            sum += (double)p[c] * ((double)q[i] * (double)r[k] - (double)q[k] * (double)r[i]) / 6;
        }
    }
    return sum;
}
