/* SPDX-License-Identifier: MIT */
/* Rotations of spheres from how their neighbours moved around them. */
#include <math.h>

#include "numeric/rotation.h"
#include "numeric/vector.h"
#include "pose/pose.h"
#include "skin/skin.h"

/* Rotations that are as good as the best, but for this part of what it is worth, are left open. */
static const double OPEN = 0.02;

typedef struct job {
    const sph_skin *skin;
    size_t *starts;      /* [J + 1] */
    uint32_t *neighbors; /* [2 L], each sphere's rising */
    double *from;        /* [J][3]: centres in the reference pose */
    const double *to;    /* [J][3] */
    double *turns;       /* [J][4]: unit quaternions; all 0: not known yet */
    double *ring;        /* [J][4]: those that are being found */
    uint32_t *queue;     /* [J]: spheres whose neighbours may now say what they leave open */
    bool *queued;
} job;

static void free_job(const job *j)
{
    const sph_context *context = j->skin->context;
    sph__free(context, j->starts);
    sph__free(context, j->neighbors);
    sph__free(context, j->from);
    sph__free(context, j->turns);
    sph__free(context, j->ring);
    sph__free(context, j->queue);
    sph__free(context, j->queued);
}

static sph_status allocate_job(job *j)
{
    const sph_context *context = j->skin->context;
    const size_t bones = j->skin->bone_count;
    j->starts = sph__zalloc(context, bones + 2, sizeof *j->starts);
    j->neighbors = sph__alloc(context, j->skin->link_count, 2 * sizeof *j->neighbors);
    j->from = sph__alloc(context, bones, 3 * sizeof *j->from);
    j->turns = sph__zalloc(context, bones, 4 * sizeof *j->turns);
    j->ring = sph__alloc(context, bones, 4 * sizeof *j->ring);
    j->queue = sph__alloc(context, bones, sizeof *j->queue);
    j->queued = sph__zalloc(context, bones, sizeof *j->queued);
    if (j->starts == NULL || j->neighbors == NULL || j->from == NULL || j->turns == NULL || j->ring == NULL ||
        j->queue == NULL || j->queued == NULL)
        return sph__fail_memory(context);
    return SPH_OK;
}

static void find_neighbors(job *j)
{
    const uint32_t *links = j->skin->links;
    size_t *next = j->starts + 1; /* of sphere b at b + 1, which becomes its end */
    for (size_t i = 0; i < 2 * j->skin->link_count; ++i)
        ++j->starts[links[i] + 2];
    for (size_t b = 0; b < j->skin->bone_count; ++b)
        next[b + 1] += next[b];
    for (size_t i = 0; i < j->skin->link_count; ++i) {
        const uint32_t a = links[2 * i], b = links[2 * i + 1];
        j->neighbors[next[a]++] = b;
        j->neighbors[next[b]++] = a;
    }
}

/* The weighted sum of q p' over the neighbours, p before and q after. */
static void sum_moves(const job *j, uint32_t sphere, double sum[9])
{
    memset(sum, 0, 9 * sizeof *sum);
    for (size_t i = j->starts[sphere]; i < j->starts[sphere + 1]; ++i) {
        const size_t other = j->neighbors[i];
        double p[3], q[3], square;
        sph__subtract(j->from + 3 * other, j->from + 3 * (size_t)sphere, p);
        sph__subtract(j->to + 3 * other, j->to + 3 * (size_t)sphere, q);
        square = sph__dot(p, p);
        for (int k = 0; k < 9 && square > 0; ++k)
            sum[k] += q[k / 3] * p[k % 3] / square;
    }
}

/*
 * trace(R' M) = q' S q for this symmetric S (Horn 1987): its largest eigenvalues and their vectors. Returns how many
 * are within reach of the largest.
 */
static int find_best(const double m[9], double vectors[16])
{
    const double upper[10] = {m[0] - m[4] - m[8], m[1] + m[3], m[2] + m[6],        m[7] - m[5], m[4] - m[0] - m[8],
                              m[5] + m[7],        m[2] - m[6], m[8] - m[0] - m[4], m[3] - m[1], m[0] + m[4] + m[8]};
    double s[16], values[4];
    int at = 0, count = 1;
    for (int i = 0; i < 4; ++i)
        for (int k = i; k < 4; ++k)
            s[4 * i + k] = s[4 * k + i] = upper[at++];
    sph__sym4_eigen(s, values, vectors);
    while (count < 4 && values[0] - values[count] <= OPEN * fabs(values[0]))
        ++count;
    return count;
}

/* Of all rotations that the first `count` vectors span the one nearest to `wish`. */
static void choose(const double *vectors, int count, const double wish[4], double turn[4])
{
    double length = 0;
    for (int k = 0; k < 4; ++k)
        turn[k] = 0;
    for (int i = 0; i < count; ++i) {
        double dot = 0;
        for (int k = 0; k < 4; ++k)
            dot += vectors[4 * i + k] * wish[k];
        for (int k = 0; k < 4; ++k)
            turn[k] += dot * vectors[4 * i + k];
    }
    for (int k = 0; k < 4; ++k)
        length += turn[k] * turn[k];
    length = sqrt(length);
    for (int k = 0; k < 4; ++k) /* a half turn away from the wish all are equally near */
        turn[k] = length > 1e-6 ? turn[k] / length : vectors[k];
}

/* The mean of the neighbours' rotations that are known; the identity where none is. */
static void average(const job *j, uint32_t sphere, double wish[4])
{
    double sum[16] = {0}, values[4], vectors[16];
    bool none = true;
    for (size_t i = j->starts[sphere]; i < j->starts[sphere + 1]; ++i) {
        const double *q = j->turns + 4 * (size_t)j->neighbors[i];
        for (int k = 0; k < 16; ++k) {
            sum[k] += q[k / 4] * q[k % 4];
            none = none && sum[k] == 0;
        }
    }
    for (int k = 0; k < 4; ++k)
        wish[k] = k == 3;
    if (none) return;
    sph__sym4_eigen(sum, values, vectors);
    memcpy(wish, vectors, 4 * sizeof *wish);
}

/* The rotation of a sphere that leaves one open, as its neighbours have it. */
static void turn_sphere(const job *j, uint32_t sphere, double turn[4])
{
    double sum[9], vectors[16], wish[4];
    sum_moves(j, sphere, sum);
    average(j, sphere, wish);
    choose(vectors, find_best(sum, vectors), wish, turn);
}

/* Those that leave nothing open, into the queue. */
static size_t turn_known(job *j)
{
    size_t count = 0;
    for (uint32_t b = 0; b < j->skin->bone_count; ++b) {
        double sum[9], vectors[16];
        sum_moves(j, b, sum);
        if (find_best(sum, vectors) != 1) continue;
        memcpy(j->turns + 4 * (size_t)b, vectors, 4 * sizeof *vectors);
        j->queue[count++] = b;
        j->queued[b] = true;
    }
    return count;
}

/* Outward from these, ring by ring: a ring sees those before it, not itself, so that the order within it is nothing. */
static void turn_rings(job *j, size_t count)
{
    for (size_t begin = 0, end; begin < count; begin = end) {
        end = count;
        for (size_t i = begin; i < end; ++i)
            for (size_t k = j->starts[j->queue[i]]; k < j->starts[j->queue[i] + 1]; ++k) {
                const uint32_t b = j->neighbors[k];
                if (j->queued[b]) continue;
                j->queue[count++] = b;
                j->queued[b] = true;
            }
        for (size_t i = end; i < count; ++i)
            turn_sphere(j, j->queue[i], j->ring + 4 * (i - end));
        for (size_t i = end; i < count; ++i)
            memcpy(j->turns + 4 * (size_t)j->queue[i], j->ring + 4 * (i - end), 4 * sizeof *j->turns);
    }
}

/* Where nobody near knows a rotation the smallest is taken, which is what an average of none asks for. */
static void turn_rest(job *j)
{
    uint32_t count = 0;
    for (uint32_t b = 0; b < j->skin->bone_count; ++b)
        if (!j->queued[b]) {
            turn_sphere(j, b, j->ring + 4 * (size_t)count);
            j->queue[count++] = b;
        }
    for (uint32_t i = 0; i < count; ++i)
        memcpy(j->turns + 4 * (size_t)j->queue[i], j->ring + 4 * (size_t)i, 4 * sizeof *j->turns);
}

/* The centres of the pose that is edited. */
static sph_status place(job *j, const double *reference)
{
    const sph_skin *skin = j->skin;
    for (size_t b = 0; b < skin->bone_count; ++b) {
        const double *pivot = skin->pivots + 3 * b;
        for (int k = 0; k < 3; ++k)
            if (!isfinite(j->to[3 * b + k]))
                return sph__fail(skin->context, SPH_E_INVALID, "the new centre of sphere %zu is not finite", b);
        for (int k = 0; k < 12 && reference != NULL; ++k)
            if (!isfinite(reference[12 * b + k]))
                return sph__fail(skin->context, SPH_E_INVALID, "the reference transform of bone %zu is not finite", b);
        if (reference == NULL)
            sph__copy3(pivot, j->from + 3 * b);
        else
            sph__transform_point(reference + 12 * b, pivot, j->from + 3 * b);
    }
    return SPH_OK;
}

/* transform = turn about the old centre and move to the new one, after the reference */
static void write_transform(const job *j, size_t b, const double *reference, double *transform)
{
    static const double IDENTITY[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    double before[12], turn[9];
    memcpy(before, reference == NULL ? IDENTITY : reference + 12 * b, sizeof before);
    sph__rotation_from_quaternion(j->turns + 4 * b, turn);
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 4; ++c) {
            double sum = c == 3 ? j->to[3 * b + r] : 0;
            for (int k = 0; k < 3; ++k)
                sum += turn[3 * r + k] * (before[4 * k + c] - (c == 3 ? j->from[3 * b + k] : 0));
            transform[12 * b + 4 * r + c] = sum;
        }
}

sph_status sph_pose_from_spheres(const sph_skin *skin, const double *reference, const double *centers,
                                 double *transforms)
{
    SPH__OWN(skin, SPH__SKIN);
    job j = {.skin = skin, .to = centers};
    sph_status status;
    if (skin == NULL || centers == NULL || transforms == NULL)
        return sph__fail(skin == NULL ? NULL : skin->context, SPH_E_INVALID,
                         "sph_pose_from_spheres: an argument is NULL");
    status = allocate_job(&j);
    if (status == SPH_OK) status = place(&j, reference);
    if (status == SPH_OK) {
        find_neighbors(&j);
        turn_rings(&j, turn_known(&j));
        turn_rest(&j);
        for (size_t b = 0; b < skin->bone_count; ++b)
            write_transform(&j, b, reference, transforms);
    }
    free_job(&j);
    return status;
}
