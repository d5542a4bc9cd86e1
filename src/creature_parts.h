/* SPDX-License-Identifier: MIT */
/* What the creature's files share: its bones at rest, and the skin around them. */
#ifndef CREATURE_PARTS_H
#define CREATURE_PARTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct point {
    double x, y, z;
} point;

static inline point add(point a, point b)
{
    return (point){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline point subtract(point a, point b)
{
    return (point){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline point scale(point a, double s)
{
    return (point){a.x * s, a.y * s, a.z * s};
}

static inline double dot(point a, point b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* What a bone does in the walk. */
typedef enum role {
    ROLE_ROOT,
    ROLE_CHEST,
    ROLE_PELVIS,
    ROLE_NECK,
    ROLE_HEAD,
    ROLE_SNOUT,
    ROLE_EAR,
    ROLE_TAIL,
    ROLE_THIGH,
    ROLE_SHANK,
    ROLE_HOCK,
    ROLE_HIND_FOOT,
    ROLE_UPPER_ARM,
    ROLE_FOREARM,
    ROLE_PASTERN,
    ROLE_FORE_FOOT
} role;

/* A bone at rest, with the flesh around it: a segment whose radius goes from one end's to the other's. */
typedef struct bone {
    int parent; /* -1: the root; else of lower index */
    role role;
    point from, to; /* `from` is the joint that it turns about */
    double radius_from, radius_to;
    double phase; /* legs: of the step, in turns; tail: place along it */
    double side;  /* -1 left, 1 right, 0 in the middle */
} bone;

enum { BONE_COUNT = 29 };
extern const bone creature_bones[BONE_COUNT];

/* Signed distance (about) to one bone's flesh, and to the smooth union of all; negative inside. */
double creature_bone_distance(const bone *b, point p);
double creature_distance(point p);

/* The skin at rest. */
typedef struct skin {
    point *vertices;
    size_t vertex_count;
    uint32_t *triangles;
    size_t triangle_count;
} skin;

/* Polygonises the creature at rest; false when out of memory. Free with creature_skin_free(), also after a failure. */
bool creature_skin_make(skin *s, uint32_t resolution);
void creature_skin_free(skin *s);
/* Replaces each of the `width` values per vertex by a mean with its neighbours', `rounds` times; false: out of memory.
 */
bool creature_skin_smooth(const skin *s, double *values, size_t width, int rounds);

#endif
