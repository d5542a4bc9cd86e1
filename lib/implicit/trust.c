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

/*
 * Two bones without a joint: how far apart they are at a point is what is left of its two places when a turn about
 * anything within a radius is taken off.
 */
static double trust_at(const sph__track *t, uint32_t first, uint32_t second, const double p[3], double radius)
{
    const uint32_t bones[2] = {first, second};
    const double *a = t->transforms + 12 * (size_t)first, *b = t->transforms + 12 * (size_t)second;
    double trace = 0, squares[2] = {0, 0}, cosine, part;
    for (int i = 0; i < 12; ++i) {
        if (i % 4 == 3) continue;
        trace += a[i] * b[i];
        squares[0] += a[i] * a[i];
        squares[1] += b[i] * b[i];
    }
    cosine = squares[0] > 0 && squares[1] > 0 ? 0.5 * (3 * trace / sqrt(squares[0] * squares[1]) - 1) : 1;
    part = (gap_at(t, bones, p) - radius * sqrt(fmax(0, 2 - 2 * cosine))) / (GAP_LIMIT * radius);
    return part > 0 ? 1 / (1 + part * part) : 1;
}

double sph__trust_pair(const sph_tracker *tracker, const sph__track *track, uint32_t node, uint32_t a, uint32_t b)
{
    const uint32_t joint = find_joint(tracker->implicit, a, b);
    double p[3];
    if (joint != SPH__NO_PART) return track->trust[joint];
    for (int c = 0; c < 3; ++c)
        p[c] = (double)tracker->shell.rest[3 * (size_t)node + c];
    return trust_at(track, a, b, p, tracker->limit[node]);
}

double sph__trust_node(const sph_tracker *tracker, const sph__track *t, uint32_t node, double *nearest,
                       double *farthest)
{
    const sph_deformer *d = tracker->deformer;
    const size_t k = d->influence_count, v = tracker->shell.vertices[node];
    double all = 1, p[3], q[3], base[3];
    *nearest = INFINITY;
    *farthest = 0;
    for (int c = 0; c < 3; ++c) {
        p[c] = (double)tracker->shell.rest[3 * (size_t)node + c];
        base[c] = t->base[c][node];
    }
    for (size_t s = v * k; s < (v + 1) * k && d->weights[s] > 0; ++s) {
        sph__transform_point(t->transforms + 12 * (size_t)d->bones[s], p, q);
        *nearest = fmin(*nearest, sph__distance(q, base));
        *farthest = fmax(*farthest, sph__distance(q, base));
        for (size_t u = v * k; u < s; ++u) {
            const double pair = sph__trust_pair(tracker, t, node, d->bones[s], d->bones[u]);
            const double share = 4 * (double)d->weights[s] * (double)d->weights[u];
            all *= 1 - fmin(share, 1) * (1 - pair);
        }
    }
    return all;
}
