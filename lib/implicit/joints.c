/* SPDX-License-Identifier: MIT */
/* Which parts meet at a joint, where it is, and how their meshes meet there. */
#include <math.h>

#include "implicit/setup.h"
#include "numeric/vector.h"

/* A joint farther from the middle of the opening than this part of its size is no place to close it about. */
static const double OFF_CENTER = 0.75;

static bool has_part(const sph__setup *s, uint32_t bone)
{
    return s->starts[bone + 1] > s->starts[bone];
}

static uint64_t pair_key(uint32_t a, uint32_t b)
{
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

static void add_joint(sph__setup *s, uint32_t a, uint32_t b, uint32_t upper, const double position[3])
{
    sph_implicit_joint *j = s->joints + s->joint_count;
    *j =
        (sph_implicit_joint){.struct_size = sizeof *j, .operation = s->options->operation, .strength = SPH_BULGE_LIMIT};
    j->bones[0] = a < b ? a : b;
    j->bones[1] = a < b ? b : a;
    sph__copy3(position, j->position);
    sph_theta_curve_preset(&j->curve, j->operation);
    s->upper[s->joint_count++] = upper;
}

/* To the nearest bone above that has a part. */
static void join_parents(sph__setup *s)
{
    const uint32_t bones = s->skin->bone_count, *parents = s->options->parents;
    for (uint32_t b = 0; b < bones; ++b) {
        uint32_t above = parents[b];
        if (!has_part(s, b)) continue;
        while (above != SPH__NO_PART && !has_part(s, above))
            above = parents[above];
        if (above != SPH__NO_PART) add_joint(s, b, above, b, s->skin->pivots + 3 * (size_t)b);
    }
}

/* Where two spheres meet, between their centres in proportion to their radii. */
static void join_links(sph__setup *s)
{
    const sph_skin *skin = s->skin;
    for (size_t i = 0; i < skin->link_count; ++i) {
        const uint32_t a = skin->links[2 * i], b = skin->links[2 * i + 1];
        const double sum = skin->radii[a] + skin->radii[b], share = sum > 0 ? skin->radii[a] / sum : 0.5;
        double position[3];
        if (!has_part(s, a) || !has_part(s, b)) continue;
        for (int c = 0; c < 3; ++c)
            position[c] = skin->pivots[3 * (size_t)a + c] +
                          share * (skin->pivots[3 * (size_t)b + c] - skin->pivots[3 * (size_t)a + c]);
        add_joint(s, a, b, SPH__NO_PART, position);
    }
}

static sph_status check_parents(const sph__setup *s)
{
    const uint32_t bones = s->skin->bone_count, *parents = s->options->parents;
    for (uint32_t b = 0; b < bones; ++b) {
        uint32_t slow = b, fast = b;
        if (parents[b] != SPH__NO_PART && parents[b] >= bones)
            return sph__fail(s->skin->context, SPH_E_INVALID, "bone %u hangs on bone %u, of %u", (unsigned)b,
                             (unsigned)parents[b], (unsigned)bones);
        for (;;) { /* of two that go up the one at twice the pace meets the other again only in a circle */
            for (int i = 0; i < 2 && fast != SPH__NO_PART && fast < bones; ++i)
                fast = parents[fast];
            if (fast == SPH__NO_PART || fast >= bones) break;
            slow = parents[slow];
            if (slow == fast)
                return sph__fail(s->skin->context, SPH_E_INVALID, "the parents of bone %u run in a circle",
                                 (unsigned)b);
        }
    }
    return SPH_OK;
}

/* The caller's own take the place of those of the same bones. */
static sph_status override_joints(sph__setup *s)
{
    const uint32_t own = s->joint_count;
    for (size_t i = 0; i < s->options->joint_count; ++i) {
        const sph_implicit_joint *given = s->options->joints + i;
        const sph_status status = sph__joint_check(s->skin->context, given, s->skin->bone_count, "joint", i);
        uint32_t at = 0;
        if (status != SPH_OK) return status;
        while (at < own &&
               pair_key(s->joints[at].bones[0], s->joints[at].bones[1]) != pair_key(given->bones[0], given->bones[1]))
            ++at;
        if (at == own) {
            if (!has_part(s, given->bones[0]) || !has_part(s, given->bones[1])) continue;
            add_joint(s, given->bones[0], given->bones[1], SPH__NO_PART, given->position);
            at = s->joint_count - 1;
        }
        sph__copy3(given->position, s->joints[at].position);
        s->joints[at].operation = given->operation;
        s->joints[at].strength = given->strength;
        s->joints[at].curve = given->curve;
    }
    return SPH_OK;
}

/* In order of their bones, each pair once: the last that was given. */
static sph_status sort_joints(sph__setup *s)
{
    const uint32_t count = s->joint_count;
    sph__keyed *keys = sph__alloc(s->skin->context, count, sizeof *keys);
    sph_implicit_joint *joints = sph__alloc(s->skin->context, count, sizeof *joints);
    uint32_t *upper = sph__alloc(s->skin->context, count, sizeof *upper);
    if (keys != NULL && joints != NULL && upper != NULL) {
        for (uint32_t i = 0; i < count; ++i)
            keys[i] = (sph__keyed){pair_key(s->joints[i].bones[0], s->joints[i].bones[1]), i};
        sph__sort(keys, count);
        s->joint_count = 0;
        for (uint32_t i = 0; i < count; ++i) {
            if (i + 1 < count && keys[i].key == keys[i + 1].key) continue;
            joints[s->joint_count] = s->joints[keys[i].item];
            upper[s->joint_count++] = s->upper[keys[i].item];
        }
        memcpy(s->joints, joints, s->joint_count * sizeof *joints);
        memcpy(s->upper, upper, s->joint_count * sizeof *upper);
    }
    sph__free(s->skin->context, keys);
    sph__free(s->skin->context, joints);
    sph__free(s->skin->context, upper);
    return keys == NULL || joints == NULL || upper == NULL ? sph__fail_memory(s->skin->context) : SPH_OK;
}

/* --- openings --- */

static double node_distance(const sph__shell *s, size_t node, const double p[3])
{
    double q[3];
    for (int c = 0; c < 3; ++c)
        q[c] = (double)s->rest[3 * node + c];
    return sph__distance(p, q);
}

/* The joint of two parts, which are sorted; NULL where there is none. */
static sph__opening *opening_of(const sph__setup *s, uint32_t a, uint32_t b)
{
    const uint64_t key = pair_key(a, b);
    uint32_t low = 0, high = s->joint_count;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (pair_key(s->joints[middle].bones[0], s->joints[middle].bones[1]) < key)
            low = middle + 1;
        else
            high = middle;
    }
    if (low == s->joint_count || pair_key(s->joints[low].bones[0], s->joints[low].bones[1]) != key) return NULL;
    return s->openings + low;
}

typedef void corner_fn(const sph__shell *s, sph__opening *opening, uint32_t node);

static void add_corner(const sph__shell *s, sph__opening *o, uint32_t node)
{
    ++o->corner_count;
    for (int c = 0; c < 3; ++c)
        o->center[c] += (double)s->rest[3 * (size_t)node + c];
}

static void reach_corner(const sph__shell *s, sph__opening *o, uint32_t node)
{
    o->reach = fmax(o->reach, node_distance(s, node, o->center));
}

/* Both ends of all edges between two joined parts. */
static void visit_openings(const sph__setup *s, corner_fn *visit)
{
    for (uint32_t i = 0; i < s->shell.node_count; ++i)
        for (size_t k = s->shell.starts[i]; k < s->shell.starts[i + 1]; ++k) {
            const uint32_t other = s->shell.ring[k], a = s->shell.parts[i], b = s->shell.parts[other];
            sph__opening *o = a == b ? NULL : opening_of(s, a, b);
            if (o != NULL) visit(&s->shell, o, i);
        }
}

static void place_opening(const sph__setup *s, uint32_t joint)
{
    sph__opening *o = s->openings + joint;
    const sph_implicit_joint *j = s->joints + joint;
    if (sph__distance(o->center, j->position) <= OFF_CENTER * o->reach) sph__copy3(j->position, o->center);
    o->distance = INFINITY;
    for (int i = 0; i < 2; ++i)
        for (size_t n = s->node_starts[j->bones[i]]; n < s->node_starts[j->bones[i] + 1]; ++n)
            o->distance = fmin(o->distance, node_distance(&s->shell, n, o->center));
    o->reach = 0;
}

sph_status sph__setup_joints(sph__setup *s)
{
    const sph_context *context = s->skin->context;
    const size_t own = s->options->parents != NULL ? s->skin->bone_count : s->skin->link_count;
    sph_status status = SPH_OK;
    if (own + s->options->joint_count > UINT32_MAX || own + s->options->joint_count < own)
        return sph__fail(context, SPH_E_INVALID, "%zu joints are too many", s->options->joint_count);
    s->joints = sph__alloc(context, own + s->options->joint_count, sizeof *s->joints);
    s->upper = sph__alloc(context, own + s->options->joint_count, sizeof *s->upper);
    s->openings = sph__zalloc(context, own + s->options->joint_count, sizeof *s->openings);
    if (s->joints == NULL || s->upper == NULL || s->openings == NULL) return sph__fail_memory(context);
    if (s->options->parents != NULL) {
        status = check_parents(s);
        if (status == SPH_OK) join_parents(s);
    } else {
        join_links(s);
    }
    if (status == SPH_OK) status = override_joints(s);
    if (status == SPH_OK) status = sort_joints(s);
    if (status != SPH_OK) return status;
    visit_openings(s, add_corner);
    for (uint32_t j = 0; j < s->joint_count; ++j)
        for (int c = 0; c < 3 && s->openings[j].corner_count > 0; ++c)
            s->openings[j].center[c] /= s->openings[j].corner_count;
    visit_openings(s, reach_corner);
    for (uint32_t j = 0; j < s->joint_count; ++j)
        place_opening(s, j);
    visit_openings(s, reach_corner);
    return SPH_OK;
}
