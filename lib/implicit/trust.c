/* SPDX-License-Identifier: MIT */
/*
 * Bones that come apart at a joint, as those of spheres do, leave a gap between their fields that nothing fills: what
 * these say of it is worth the less, the wider it is.
 */
#include <math.h>

#include "implicit/tracker.h"
#include "numeric/vector.h"
#include "pose/pose.h"
#include "skin/skin.h"

/* A gap of this part of the limb's thickness leaves half the trust. */
static const double GAP_LIMIT = 0.25;

static double gap_at(const sph__track *t, const uint32_t bones[2], const double p[3])
{
    double a[3], b[3];
    sph__transform_point(t->transforms + 12 * (size_t)bones[0], p, a);
    sph__transform_point(t->transforms + 12 * (size_t)bones[1], p, b);
    return sph__distance(a, b);
}

void sph__trust_joints(const sph_tracker *tracker, sph__track *t)
{
    for (uint32_t j = 0; j < tracker->implicit->joint_count; ++j) {
        const sph_implicit_joint *joint = &tracker->implicit->joints[j].given;
        const double size = tracker->joint_sizes[j], gap = gap_at(t, joint->bones, joint->position);
        const double part = size > 0 ? gap / (GAP_LIMIT * size) : 0;
        t->trust[j] = isfinite(part) ? 1 / (1 + part * part) : 0;
    }
}

/* The joint of two bones; they are in order. */
static uint32_t find_joint(const sph_implicit *implicit, uint32_t a, uint32_t b)
{
    const uint64_t key = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
    uint32_t low = 0, high = implicit->joint_count;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2, *bones = implicit->joints[middle].given.bones;
        const uint64_t there = (uint64_t)bones[0] << 32 | bones[1];
        if (there == key) return middle;
        if (there < key)
            low = middle + 1;
        else
            high = middle;
    }
    return SPH__NO_PART;
}

double sph__trust_node(const sph_tracker *tracker, const sph__track *t, uint32_t node, double *nearest)
{
    const sph_deformer *d = tracker->deformer;
    const size_t k = d->influence_count, v = tracker->shell.vertices[node];
    double all = 1, p[3], q[3], base[3];
    *nearest = INFINITY;
    for (int c = 0; c < 3; ++c) {
        p[c] = (double)tracker->shell.rest[3 * (size_t)node + c];
        base[c] = t->base[c][node];
    }
    for (size_t s = v * k; s < (v + 1) * k && d->weights[s] > 0; ++s) {
        sph__transform_point(t->transforms + 12 * (size_t)d->bones[s], p, q);
        *nearest = fmin(*nearest, sph__distance(q, base));
        for (size_t u = v * k; u < s; ++u) {
            const uint32_t joint = find_joint(tracker->implicit, d->bones[s], d->bones[u]);
            const double share = 4 * (double)d->weights[s] * (double)d->weights[u];
            if (joint != SPH__NO_PART) all *= 1 - fmin(share, 1) * (1 - t->trust[joint]);
        }
    }
    return all;
}
