/* SPDX-License-Identifier: MIT */
#include "skin_rig.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support.h"

static const double LENGTH = 6, RADIUS = 0.5, PI = 3.14159265358979323846;

static double bone_x(int bone)
{
    return LENGTH * (bone + 0.5) / RIG_BONES;
}

static void make_tube(skin_rig *rig)
{
    size_t t = 0;
    for (uint32_t v = 0; v < RIG_VERTICES; ++v) {
        const uint32_t ring = v / RIG_SIDES, side = v % RIG_SIDES;
        const double x = LENGTH * ring / (RIG_RINGS - 1), angle = 2 * PI * side / RIG_SIDES;
        const uint32_t next = ring * RIG_SIDES + (side + 1) % RIG_SIDES;
        double reach = (x - bone_x(0)) / (LENGTH / RIG_BONES);
        int first;
        rig->rest[v][0] = (float)x;
        rig->rest[v][1] = (float)(RADIUS * cos(angle));
        rig->rest[v][2] = (float)(RADIUS * sin(angle));
        reach = fmin(fmax(reach, 0), RIG_BONES - 1);
        first = (int)fmin(floor(reach), RIG_BONES - 2);
        memset(rig->weights[v], 0, sizeof rig->weights[v]);
        rig->weights[v][first + 1] = reach - first;
        rig->weights[v][first] = 1 - (reach - first);
        rig->labels[v] = (uint32_t)(first + (reach - first > 0.5));
        if (ring + 1 == RIG_RINGS) continue;
        memcpy(rig->triangles[t++], (uint32_t[3]){v, next, v + RIG_SIDES}, 3 * sizeof(uint32_t));
        memcpy(rig->triangles[t++], (uint32_t[3]){next, next + RIG_SIDES, v + RIG_SIDES}, 3 * sizeof(uint32_t));
    }
}

/* Around `axis` by `angle` (Rodrigues), then by `shift`, about the point `center`. */
static void rigid(const double axis[3], double angle, const double center[3], const double shift[3], double out[12])
{
    const double c = cos(angle), s = sin(angle);
    for (int a = 0; a < 3; ++a) {
        double moved = center[a] + shift[a];
        for (int b = 0; b < 3; ++b) {
            const double cross = a == b ? 0 : (b == (a + 1) % 3 ? -1 : 1) * axis[3 - a - b];
            out[4 * a + b] = (a == b ? c : 0) + (1 - c) * axis[a] * axis[b] + s * cross;
            moved -= out[4 * a + b] * center[b];
        }
        out[4 * a + 3] = moved;
    }
}

static void make_motion(skin_rig *rig, int motion, uint64_t seed)
{
    uint64_t state = seed;
    for (int b = 0; b < RIG_BONES; ++b) {
        double axis[3], turn[3], length = 0;
        const double center[3] = {bone_x(motion == RIG_BENDS ? b : 0), 0, 0};
        if (motion == RIG_TUMBLES) state = seed;
        for (int k = 0; k < 3; ++k) {
            axis[k] = 2 * test_random_unit(&state) - 1;
            turn[k] = 2 * test_random_unit(&state) - 1;
            length += axis[k] * axis[k];
        }
        for (int k = 0; k < 3; ++k)
            axis[k] /= sqrt(length);
        for (int f = 0; f < RIG_FRAMES; ++f) {
            double shift[3];
            for (int k = 0; k < 3; ++k)
                shift[k] = 0.5 * turn[k] * sin(0.4 * f * (k + 1));
            rigid(axis, 0.9 * sin(0.5 * f), center, shift, rig->transforms[f][b]);
        }
    }
}

static void pose(const skin_rig *rig, uint32_t frame, float xyz[RIG_VERTICES][3])
{
    for (uint32_t v = 0; v < RIG_VERTICES; ++v)
        for (int a = 0; a < 3; ++a) {
            double sum = 0;
            for (int b = 0; b < RIG_BONES; ++b) {
                const double *t = rig->transforms[frame][b] + 4 * a;
                sum += rig->weights[v][b] * (t[0] * (double)rig->rest[v][0] + t[1] * (double)rig->rest[v][1] +
                                             t[2] * (double)rig->rest[v][2] + t[3]);
            }
            xyz[v][a] = (float)sum;
        }
}

sph_animation *skin_rig_part(const skin_rig *rig, sph_context *context, uint32_t begin, uint32_t end)
{
    float(*xyz)[3] = test_malloc(RIG_VERTICES, sizeof *xyz);
    sph_animation *animation = NULL;
    sph_status status = sph_animation_create(context, RIG_VERTICES, end - begin, &animation);
    for (uint32_t f = begin; f < end && status == SPH_OK; ++f) {
        pose(rig, f, xyz);
        status = sph_animation_set_frame(animation, f - begin, xyz[0], 0);
    }
    if (status == SPH_OK) status = sph_animation_set_triangles(animation, rig->triangles[0], RIG_TRIANGLES, 0);
    free(xyz);
    if (status == SPH_OK) return animation;
    sph_animation_destroy(animation);
    return NULL;
}

static sph_level *make_level(const skin_rig *rig, sph_context *context)
{
    static const uint32_t EDGES[RIG_BONES - 1][2] = {{0, 1}, {1, 2}, {2, 3}};
    float centers[RIG_FRAMES][RIG_BONES][3], radii[RIG_BONES];
    sph_level *level = NULL;
    const sph_level_arrays arrays = {.struct_size = sizeof arrays,
                                     .sphere_count = RIG_BONES,
                                     .frame_count = RIG_FRAMES,
                                     .centers = centers[0][0],
                                     .radii = radii,
                                     .edge_count = RIG_BONES - 1,
                                     .edges = EDGES[0],
                                     .label_count = RIG_VERTICES,
                                     .labels = rig->labels};
    for (int b = 0; b < RIG_BONES; ++b) {
        radii[b] = (float)RADIUS;
        for (int f = 0; f < RIG_FRAMES; ++f)
            for (int k = 0; k < 3; ++k)
                centers[f][b][k] =
                    (float)(rig->transforms[f][b][4 * k] * bone_x(b) + rig->transforms[f][b][4 * k + 3]);
    }
    sph_level_create_from_arrays(context, &arrays, &level);
    return level;
}

void skin_rig_init(skin_rig *rig, sph_context *context, int motion, uint64_t seed)
{
    make_tube(rig);
    make_motion(rig, motion, seed);
    rig->level = make_level(rig, context);
    rig->animation = skin_rig_part(rig, context, 0, RIG_FRAMES);
}

void skin_rig_free(skin_rig *rig)
{
    sph_level_destroy(rig->level);
    sph_animation_destroy(rig->animation);
    rig->level = NULL;
    rig->animation = NULL;
}
