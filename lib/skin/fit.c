/* SPDX-License-Identifier: MIT */
/* Poses and rest positions with the weights fixed. */
#include <math.h>

#include "numeric/numeric.h"
#include "numeric/rotation.h"
#include "skin/kernel.h"

enum { BATCH = 16 /* groups whose sums are held at once */, ENERGY_BLOCK = 256, REST_GRAIN = 64 };

typedef struct fit_job {
    sph__problem *p;
    const sph_skin *skin;
    const uint8_t *minor; /* [bones]: 1, and 2 where a bone that is not is near */
    uint32_t first, sweeps;
    bool exact; /* rotations of the last sweep from scratch */
    double *sums; /* [BATCH][sums_size] */
    size_t sums_size;
    const double *shared; /* the sums that do not depend on frames, where areas do not; else NULL */
} fit_job;

/* The rigid motion of least squares from the normal equations of one bone in one frame. */
static void solve_lane(const double *gram, const double *product, bool exact, double *pose, int lane)
{
    enum { L = SPH__SKIN_LANES };
    static const int COLUMN[3] = {3, 6, 8}; /* of the sums of p in a gram */
    const double mass = gram[9 * L + lane];
    double m[9], r[9];
    if (!(mass > 0)) return;
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            m[3 * a + b] = product[(4 * a + b) * L + lane] -
                           product[(4 * a + 3) * L + lane] * (gram[COLUMN[b] * L + lane] / mass);
    if (exact) {
        sph__nearest_rotation(m, r);
    } else {
        for (int i = 0; i < 9; ++i)
            r[i] = pose[(i / 3 * 4 + i % 3) * L + lane];
        sph__nearest_rotation_from(m, r, r);
    }
    for (int a = 0; a < 3; ++a) {
        double turned = 0;
        for (int b = 0; b < 3; ++b) {
            pose[(4 * a + b) * L + lane] = r[3 * a + b];
            turned += r[3 * a + b] * gram[COLUMN[b] * L + lane];
        }
        pose[(4 * a + 3) * L + lane] = (product[(4 * a + 3) * L + lane] - turned) / mass;
    }
}

/* The mean pose of the bones that `bone` is linked to and that are not minor: of rotations by their quaternions, of where they take the pivot. */
static void average_lane(const fit_job *j, uint32_t group, uint32_t bone, int lane)
{
    enum { L = SPH__SKIN_LANES };
    double form[16] = {0}, values[4], vectors[16], place[3] = {0}, r[9], pivot[3];
    double *pose = sph__problem_pose(j->p, group, bone);
    uint32_t count = 0;
    for (int k = 0; k < 3; ++k)
        pivot[k] = j->skin->pivots[3 * (size_t)bone + k] - j->p->origin[k];
    for (size_t i = 0; i < 2 * j->skin->link_count; ++i) {
        const uint32_t other = j->skin->links[i ^ 1];
        const double *from;
        double q[4];
        if (j->skin->links[i] != bone || j->minor[other]) continue;
        from = sph__problem_pose(j->p, group, other);
        for (int a = 0; a < 3; ++a) {
            place[a] += from[(4 * a + 3) * L + lane];
            for (int b = 0; b < 3; ++b) {
                r[3 * a + b] = from[(4 * a + b) * L + lane];
                place[a] += r[3 * a + b] * pivot[b];
            }
        }
        sph__quaternion_from_rotation(r, q);
        for (int a = 0; a < 4; ++a)
            for (int b = 0; b < 4; ++b)
                form[4 * a + b] += q[a] * q[b];
        ++count;
    }
    if (count == 0) return;
    sph__sym4_eigen(form, values, vectors);
    sph__rotation_from_quaternion(vectors, r);
    for (int a = 0; a < 3; ++a) {
        double turned = 0;
        for (int b = 0; b < 3; ++b) {
            pose[(4 * a + b) * L + lane] = r[3 * a + b];
            turned += r[3 * a + b] * pivot[b];
        }
        pose[(4 * a + 3) * L + lane] = place[a] / count - turned;
    }
}

static void average(const fit_job *j, uint32_t group, uint32_t bone)
{
    for (int lane = 0; lane < SPH__SKIN_LANES; ++lane)
        average_lane(j, group, bone, lane);
}

static void fit_group(void *argument, size_t begin, size_t end)
{
    const fit_job *j = argument;
    for (size_t i = begin; i < end; ++i) {
        const uint32_t group = j->first + (uint32_t)i;
        double *moments = j->sums + i * j->sums_size, *own = moments + (size_t)j->p->bones * SPH__SKIN_POSE;
        const double *gram = j->shared == NULL ? own : j->shared;
        if (j->shared == NULL) sph__skin_kernel_gram(j->p, group, own);
        sph__skin_kernel_moments(j->p, group, moments);
        for (uint32_t sweep = 0; sweep < j->sweeps; ++sweep)
            for (uint32_t bone = 0; bone < j->p->bones; ++bone) {
                _Alignas(SPH__ALIGN) double product[SPH__SKIN_POSE];
                if (j->p->still[bone]) continue;
                if (j->minor[bone] == 2) {
                    average(j, group, bone);
                    continue;
                }
                sph__skin_kernel_remainder(j->p, group, bone, gram, moments, product);
                for (int lane = 0; lane < SPH__SKIN_LANES; ++lane)
                    solve_lane(gram + (size_t)bone * 10 * SPH__SKIN_LANES, product, j->exact && sweep + 1 == j->sweeps,
                               sph__problem_pose(j->p, group, bone), lane);
            }
    }
}

/*
 * Which bones are minor: `marks` has a byte for each. Those with none but minor ones around have nobody to be like; they
 * are fitted as any other.
 */
static sph_status find_minor(const sph__problem *p, const sph_skin *skin, double threshold, uint8_t *marks)
{
    double *squares = sph__zalloc(p->context, p->bones, sizeof *squares);
    if (squares == NULL) return sph__fail_memory(p->context);
    for (size_t v = 0; v < p->n; ++v)
        for (uint32_t s = 0; s < p->now.count[v]; ++s) {
            const double w = p->now.weights[v * p->limit + s];
            squares[p->sets[p->set[v]].bones[p->now.places[v * p->limit + s]]] += w * w;
        }
    for (uint32_t b = 0; b < p->bones; ++b)
        marks[b] = !p->still[b] && (squares[b] < threshold || squares[b] == 0);
    for (size_t i = 0; i < 2 * skin->link_count; ++i)
        if (marks[skin->links[i]] != 0 && marks[skin->links[i ^ 1]] == 0) marks[skin->links[i]] = 2;
    sph__free(p->context, squares);
    return SPH_OK;
}

sph_status sph__fit_poses(sph__problem *p, const sph_skin *skin, double minor, uint32_t sweeps, bool exact)
{
    fit_job j = {.p = p, .skin = skin, .sweeps = sweeps, .exact = exact};
    uint8_t *marks = sph__alloc(p->context, p->bones, 1);
    sph_status status = marks == NULL ? sph__fail_memory(p->context) : SPH_OK;
    j.minor = marks;
    j.sums_size = ((p->uniform ? 0 : p->pair_count * 10) + (size_t)p->bones * 12) * SPH__SKIN_LANES;
    if (status == SPH_OK)
        j.sums = sph__alloc(p->context, BATCH * j.sums_size + p->pair_count * 10 * SPH__SKIN_LANES, sizeof *j.sums);
    if (status == SPH_OK && j.sums == NULL) status = sph__fail_memory(p->context);
    if (status == SPH_OK) status = find_minor(p, skin, minor, marks);
    if (status == SPH_OK && p->uniform) { /* lanes behind the last frame have sums then, and moments of 0 */
        sph__skin_kernel_gram(p, 0, j.sums + BATCH * j.sums_size);
        j.shared = j.sums + BATCH * j.sums_size;
    }
    for (; status == SPH_OK && j.first < p->groups; j.first += BATCH) {
        const uint32_t left = p->groups - j.first;
        sph__parallel_for(p->context, left < BATCH ? left : BATCH, 1, fit_group, &j);
    }
    sph__free(p->context, marks);
    sph__free(p->context, j.sums);
    return status;
}

typedef struct energy_job {
    const sph__problem *p;
    const sph__influences *at;
    double (*sums)[2];
} energy_job;

static void energy_block(void *argument, size_t begin, size_t end)
{
    const energy_job *j = argument;
    sph__skin_kernel_energy(j->p, j->at, begin, end, j->sums[begin / ENERGY_BLOCK]);
}

sph_status sph__problem_energy(const sph__problem *p, const sph__influences *at, double energy[2])
{
    const size_t blocks = (p->n + ENERGY_BLOCK - 1) / ENERGY_BLOCK;
    energy_job j = {p, at, sph__alloc(p->context, blocks, sizeof *j.sums)};
    if (j.sums == NULL) return sph__fail_memory(p->context);
    sph__parallel_for(p->context, p->n, ENERGY_BLOCK, energy_block, &j);
    energy[0] = energy[1] = 0;
    for (size_t b = 0; b < blocks; ++b)
        for (int k = 0; k < 2; ++k)
            energy[k] += j.sums[b][k];
    sph__free(p->context, j.sums);
    return SPH_OK;
}

/*
 * The least change of a position that brings its gradient to zero, but for directions that no frame tells of: there the
 * smallest eigenvalues are raised to 1e-9 of the largest.
 */
static void rest_range(void *argument, size_t begin, size_t end)
{
    sph__problem *p = argument;
    for (size_t v = begin; v < end; ++v) {
        double sums[9], gradient[3], step[3], *rest = p->rest + 3 * v;
        sph__sym3_factor factor;
        if (p->fixed != NULL && p->fixed[v]) continue;
        sph__skin_kernel_rest(p, v, sums);
        sph__sym3_apply(sums, rest, gradient);
        for (int k = 0; k < 3; ++k)
            gradient[k] = sums[6 + k] - gradient[k];
        for (int k = 0; k < 6; k += k == 0 ? 3 : 2)
            sums[k] += 1e-9 * p->total[v];
        if (!sph__sym3_factorize(sums, &factor)) continue;
        sph__sym3_solve(&factor, gradient, step);
        for (int k = 0; k < 3; ++k)
            rest[k] += step[k];
    }
}

void sph__fit_rest(sph__problem *p)
{
    sph__parallel_for(p->context, p->n, REST_GRAIN, rest_range, p);
}
