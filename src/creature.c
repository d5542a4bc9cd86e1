/* SPDX-License-Identifier: MIT */
/* The creature's walk: an analytic cycle of joint angles, and smooth skinning of the skin at rest. */
#include "creature.h"

#include <stdlib.h>

#include "creature_parts.h"

/* Bones whose flesh is this much further than the nearest have no hold on a vertex. */
static const double REACH = 0.12;
enum { WEIGHT_ROUNDS = 4 };

/* A rigid motion of rest space. */
typedef struct motion {
    double turn[3][3];
    point shift;
} motion;

/* Sine of an angle in turns: by a polynomial of our own, so that all machines agree on the last bit. */
static double wave(double turns)
{
    double x = turns - (double)(long)turns, square, term, sum;
    if (x < 0) x += 1;
    if (x > 0.75)
        x -= 1;
    else if (x > 0.25)
        x = 0.5 - x;
    x *= 6.283185307179586;
    square = x * x;
    sum = term = x;
    for (int k = 2; k <= 18; k += 2) {
        term *= -square / (k * (k + 1));
        sum += term;
    }
    return sum;
}

/* 1 while a foot swings forward, 0 while it stands, smooth between. */
static double swing(double turns)
{
    const double raised = 0.5 + 0.5 * wave(turns + 0.25);
    return raised * raised;
}

static point turn_point(const motion *m, point p)
{
    return (point){m->turn[0][0] * p.x + m->turn[0][1] * p.y + m->turn[0][2] * p.z,
                   m->turn[1][0] * p.x + m->turn[1][1] * p.y + m->turn[1][2] * p.z,
                   m->turn[2][0] * p.x + m->turn[2][1] * p.y + m->turn[2][2] * p.z};
}

static void multiply(double out[3][3], double a[3][3], double b[3][3])
{
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            out[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
}

/* The angles of one bone in radians: about y (to the side), z (up and down), x (roll). */
typedef struct angles {
    double yaw, pitch, roll;
} angles;

static angles leg_angles(const bone *b, double step)
{
    const double t = step + b->phase, lift = swing(t);
    switch (b->role) {
    case ROLE_THIGH:
        return (angles){0, 0.42 * wave(t) + 0.06, 0.05 * b->side};
    case ROLE_SHANK:
        return (angles){0, 0.20 - 0.75 * lift, 0};
    case ROLE_HOCK:
        return (angles){0, -0.22 + 0.85 * lift, 0};
    case ROLE_HIND_FOOT:
        return (angles){0, -0.30 * wave(t) - 0.55 * lift, 0};
    case ROLE_UPPER_ARM:
        return (angles){0, 0.38 * wave(t), 0.04 * b->side};
    case ROLE_FOREARM:
        return (angles){0, -0.12 + 0.75 * lift, 0};
    case ROLE_PASTERN:
        return (angles){0, 0.08 - 1.0 * lift, 0};
    default:
        return (angles){0, -0.25 * wave(t) - 0.35 * lift, 0};
    }
}

/* `loop` is the whole animation, 0 to 1: two strides, while the back bends once to either side. */
static angles bone_angles(const bone *b, double loop)
{
    const double step = 2 * loop;
    switch (b->role) {
    case ROLE_ROOT:
        return (angles){0.06 * wave(loop + 0.25), 0.03 * wave(2 * step), 0.05 * wave(step)};
    case ROLE_CHEST:
        return (angles){0.30 * wave(loop), 0.09 * wave(2 * step + 0.1), -0.04 * wave(step)};
    case ROLE_PELVIS:
        return (angles){-0.34 * wave(loop) + 0.06 * wave(step), 0.08 * wave(2 * step), 0.06 * wave(step)};
    case ROLE_NECK:
        return (angles){0.22 * wave(loop + 0.05), 0.07 * wave(2 * step + 0.3), 0};
    case ROLE_HEAD:
        return (angles){0.25 * wave(loop + 0.1), 0.10 * wave(step + 0.2), 0.15 * wave(loop + 0.2)};
    case ROLE_SNOUT:
        return (angles){0, 0, 0};
    case ROLE_EAR:
        return (angles){0, 0.25 * wave(2 * step + 0.2 * b->side), 0.12 * b->side * wave(step)};
    case ROLE_TAIL:
        return (angles){0.30 * wave(step - b->phase), 0.12 * wave(loop - b->phase), 0};
    default:
        return leg_angles(b, step);
    }
}

/* Its parent's motion, after a turn about the joint. */
static motion bone_motion(const motion *parent, point joint, angles a)
{
    const double cy = wave(a.yaw / 6.283185307179586 + 0.25), sy = wave(a.yaw / 6.283185307179586);
    const double cz = wave(a.pitch / 6.283185307179586 + 0.25), sz = wave(a.pitch / 6.283185307179586);
    const double cx = wave(a.roll / 6.283185307179586 + 0.25), sx = wave(a.roll / 6.283185307179586);
    double yaw[3][3] = {{cy, 0, sy}, {0, 1, 0}, {-sy, 0, cy}}, pitch[3][3] = {{cz, -sz, 0}, {sz, cz, 0}, {0, 0, 1}};
    double roll[3][3] = {{1, 0, 0}, {0, cx, -sx}, {0, sx, cx}}, both[3][3], own[3][3];
    motion m, local = {.shift = {0, 0, 0}};
    double parents[3][3];
    multiply(both, yaw, pitch);
    multiply(own, both, roll);
    for (int i = 0; i < 9; ++i) {
        local.turn[i / 3][i % 3] = own[i / 3][i % 3];
        parents[i / 3][i % 3] = parent->turn[i / 3][i % 3];
    }
    multiply(m.turn, parents, own);
    m.shift = add(turn_point(parent, subtract(joint, turn_point(&local, joint))), parent->shift);
    return m;
}

static void pose(motion motions[BONE_COUNT], double loop)
{
    const motion rest = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0.02 * wave(4 * loop + 0.1), 0.03 * wave(loop + 0.5)}};
    for (int i = 0; i < BONE_COUNT; ++i) {
        const bone *b = &creature_bones[i];
        motions[i] = bone_motion(b->parent < 0 ? &rest : &motions[b->parent], b->from, bone_angles(b, loop));
    }
}

/* Hold of every bone on every vertex, from the nearness of its flesh; sums to 1 per vertex. NULL: out of memory. */
static double *make_weights(const skin *s)
{
    double *weights = malloc(s->vertex_count * BONE_COUNT * sizeof *weights);
    if (weights == NULL) return NULL;
    for (size_t i = 0; i < s->vertex_count; ++i) {
        double *w = weights + i * BONE_COUNT, least = 1e30, sum = 0;
        for (int k = 0; k < BONE_COUNT; ++k) {
            w[k] = creature_bone_distance(&creature_bones[k], s->vertices[i]);
            if (w[k] < least) least = w[k];
        }
        for (int k = 0; k < BONE_COUNT; ++k) {
            const double near = 1 - (w[k] - least) / REACH;
            w[k] = near > 0 ? near * near : 0;
            sum += w[k];
        }
        for (int k = 0; k < BONE_COUNT; ++k)
            w[k] /= sum;
    }
    if (creature_skin_smooth(s, weights, BONE_COUNT, WEIGHT_ROUNDS)) return weights;
    free(weights);
    return NULL;
}

static void skin_frame(const skin *s, const double *weights, double loop, float *xyz)
{
    motion motions[BONE_COUNT];
    pose(motions, loop);
    for (size_t i = 0; i < s->vertex_count; ++i) {
        const double *w = weights + i * BONE_COUNT;
        point p = {0, 0, 0};
        for (int k = 0; k < BONE_COUNT; ++k)
            if (w[k] > 0) p = add(p, scale(add(turn_point(&motions[k], s->vertices[i]), motions[k].shift), w[k]));
        xyz[3 * i] = (float)p.x;
        xyz[3 * i + 1] = (float)p.y;
        xyz[3 * i + 2] = (float)p.z;
    }
}

sph_status creature_create(sph_context *context, uint32_t frame_count, uint32_t resolution, sph_animation **out)
{
    sph_status status = SPH_E_NOMEM;
    double *weights = NULL;
    float *xyz = NULL;
    skin s = {0};
    *out = NULL;
    if (frame_count < 1 || frame_count > CREATURE_FRAMES_MAX || resolution < CREATURE_RESOLUTION_MIN ||
        resolution > CREATURE_RESOLUTION_MAX)
        return sph_context_fail(context, SPH_E_INVALID, "the creature's frames or resolution are out of range");
    if (!creature_skin_make(&s, resolution) || (weights = make_weights(&s)) == NULL ||
        (xyz = malloc(3 * s.vertex_count * sizeof *xyz)) == NULL) {
        sph_context_fail(context, status, "out of memory while making the creature");
        goto done;
    }
    status = sph_animation_create(context, (uint32_t)s.vertex_count, frame_count, out);
    if (status == SPH_OK) status = sph_animation_set_triangles(*out, s.triangles, s.triangle_count, 0);
    for (uint32_t f = 0; status == SPH_OK && f < frame_count; ++f) {
        skin_frame(&s, weights, (double)f / frame_count, xyz);
        status = sph_animation_set_frame(*out, f, xyz, 0);
    }
done:
    if (status != SPH_OK) {
        sph_animation_destroy(*out);
        *out = NULL;
    }
    creature_skin_free(&s);
    free(weights);
    free(xyz);
    return status;
}
