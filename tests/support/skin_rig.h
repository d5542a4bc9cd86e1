/* SPDX-License-Identifier: MIT */
/* A tube along x that four bones move by known weights and known rigid motions: what a decomposition is to find. */
#ifndef SPH_TEST_SKIN_RIG_H
#define SPH_TEST_SKIN_RIG_H

#include <sphmesh/sphmesh.h>

enum {
    RIG_RINGS = 41,
    RIG_SIDES = 10,
    RIG_VERTICES = RIG_RINGS * RIG_SIDES,
    RIG_TRIANGLES = 2 * (RIG_RINGS - 1) * RIG_SIDES,
    RIG_BONES = 4,
    RIG_FRAMES = 13
};

typedef struct skin_rig {
    float rest[RIG_VERTICES][3];
    uint32_t triangles[RIG_TRIANGLES][3];
    double weights[RIG_VERTICES][RIG_BONES]; /* hats over the bones: at most two of a vertex are not 0 */
    double transforms[RIG_FRAMES][RIG_BONES][12];
    uint32_t labels[RIG_VERTICES]; /* the bone of the largest weight */
    sph_level *level;              /* one sphere per bone, linked in a row */
    sph_animation *animation;
} skin_rig;

/* What moves the bones: nothing in frame 0. */
enum { RIG_BENDS, /* every bone in its own way */ RIG_TUMBLES /* all bones alike: the tube is rigid */ };

/* NULL members where the library fails. */
void skin_rig_init(skin_rig *rig, sph_context *context, int motion, uint64_t seed);
void skin_rig_free(skin_rig *rig);

/* The rig's level and animation with frames [begin, end) alone. */
sph_animation *skin_rig_part(const skin_rig *rig, sph_context *context, uint32_t begin, uint32_t end);

#endif
