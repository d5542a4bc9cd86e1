/* SPDX-License-Identifier: MIT */
/* The creature's bones at rest and the flesh around them. */
#include <math.h>

#include "creature_parts.h"

/* Flesh of two bones flows together within this distance. */
static const double BLEND = 0.09;

#define HIND_LEG(first, z, step, s)                                                                                    \
    {5, ROLE_THIGH, {-0.60, 0.94, 0.75 * z}, {-0.47, 0.57, z}, 0.19, 0.105, step, s},                                  \
        {first, ROLE_SHANK, {-0.47, 0.57, z}, {-0.73, 0.31, z}, 0.105, 0.06, step, s},                                 \
        {first + 1, ROLE_HOCK, {-0.73, 0.31, z}, {-0.67, 0.07, z}, 0.06, 0.06, step, s},                               \
    {                                                                                                                  \
        first + 2, ROLE_HIND_FOOT, {-0.67, 0.07, z}, {-0.52, 0.05, z}, 0.065, 0.06, step, s                            \
    }

#define FORE_LEG(first, z, step, s)                                                                                    \
    {1, ROLE_UPPER_ARM, {0.52, 0.90, 0.75 * z}, {0.40, 0.57, z}, 0.17, 0.10, step, s},                                 \
        {first, ROLE_FOREARM, {0.40, 0.57, z}, {0.47, 0.27, z}, 0.095, 0.06, step, s},                                 \
        {first + 1, ROLE_PASTERN, {0.47, 0.27, z}, {0.46, 0.07, z}, 0.06, 0.06, step, s},                              \
    {                                                                                                                  \
        first + 2, ROLE_FORE_FOOT, {0.46, 0.07, z}, {0.61, 0.05, z}, 0.065, 0.06, step, s                              \
    }

const bone creature_bones[BONE_COUNT] = {
    {-1, ROLE_ROOT, {0.15, 1.00, 0}, {-0.20, 1.00, 0}, 0.24, 0.205, 0, 0},
    {0, ROLE_CHEST, {0.15, 1.00, 0}, {0.50, 0.98, 0}, 0.24, 0.27, 0, 0},
    {1, ROLE_NECK, {0.52, 1.05, 0}, {0.74, 1.24, 0}, 0.20, 0.14, 0, 0},
    {2, ROLE_NECK, {0.74, 1.24, 0}, {0.93, 1.46, 0}, 0.14, 0.115, 0, 0},
    {3, ROLE_HEAD, {0.95, 1.49, 0}, {1.08, 1.46, 0}, 0.165, 0.14, 0, 0},
    {0, ROLE_PELVIS, {-0.20, 1.00, 0}, {-0.58, 0.99, 0}, 0.205, 0.22, 0, 0},
    {5, ROLE_TAIL, {-0.74, 1.06, 0}, {-1.02, 1.02, 0}, 0.075, 0.065, 0.00, 0},
    {6, ROLE_TAIL, {-1.02, 1.02, 0}, {-1.29, 0.94, 0}, 0.065, 0.085, 0.08, 0},
    {7, ROLE_TAIL, {-1.29, 0.94, 0}, {-1.54, 0.89, 0}, 0.085, 0.075, 0.16, 0},
    {8, ROLE_TAIL, {-1.54, 0.89, 0}, {-1.78, 0.91, 0}, 0.075, 0.04, 0.24, 0},
    HIND_LEG(10, -0.20, 0.00, -1),
    HIND_LEG(14, 0.20, 0.50, 1),
    FORE_LEG(18, -0.19, 0.25, -1),
    FORE_LEG(22, 0.19, 0.75, 1),
    {4, ROLE_EAR, {0.91, 1.58, -0.10}, {0.86, 1.85, -0.18}, 0.085, 0.045, 0, -1},
    {4, ROLE_EAR, {0.91, 1.58, 0.10}, {0.86, 1.85, 0.18}, 0.085, 0.045, 0, 1},
    {4, ROLE_SNOUT, {1.08, 1.44, 0}, {1.37, 1.37, 0}, 0.10, 0.065, 0, 0},
};

double creature_bone_distance(const bone *b, point p)
{
    const point along = subtract(b->to, b->from), away = subtract(p, b->from);
    double t = dot(away, along) / dot(along, along);
    point rest;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    rest = subtract(away, scale(along, t));
    return sqrt(dot(rest, rest)) - (b->radius_from + t * (b->radius_to - b->radius_from));
}

double creature_distance(point p)
{
    double least = 1e30;
    for (int i = 0; i < BONE_COUNT; ++i) {
        const double d = creature_bone_distance(&creature_bones[i], p);
        const double gap = least > d ? least - d : d - least;
        const double overlap = gap < BLEND ? (BLEND - gap) / BLEND : 0;
        least = (least < d ? least : d) - overlap * overlap * BLEND / 4;
    }
    return least;
}
