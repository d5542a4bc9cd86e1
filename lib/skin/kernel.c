/* SPDX-License-Identifier: MIT */
#include "skin/kernel.h"

#include "hierarchy/lanes.h"

typedef sph__v8d v8d;



SPH__CLONES static void add_gram(const sph__problem *p, uint32_t group, double *gram)
{
    for (size_t v = 0; v < p->n; ++v) {
        const double *rest = p->rest + 3 * v, x = rest[0], y = rest[1], z = rest[2];
        const double products[10] = {x * x, x * y, x * z, x, y * y, y * z, y, z * z, z, 1};
        const uint32_t count = p->now.count[v], *places = p->now.places + v * p->limit;
        const double *weights = p->now.weights + v * p->limit;
        const sph__candidates *set = &p->sets[p->set[v]];
        const v8d area = sph__load(sph__problem_data(p, group, v), 24);
        for (uint32_t a = 0; a < count; ++a)
            for (uint32_t b = 0; b <= a; ++b) {
                v8d *sums = (v8d *)(gram + (size_t)sph__candidate_pair(set, places[a], places[b]) * 80);
                const v8d both = area * (weights[a] * weights[b]);
                for (int q = 0; q < 10; ++q)
                    sums[q] += both * products[q];
            }
    }
}

void sph__skin_kernel_gram(const sph__problem *p, uint32_t group, double *gram)
{
    memset(gram, 0, p->pair_count * 80 * sizeof *gram);
    add_gram(p, group, gram);
}

SPH__CLONES static void add_moments(const sph__problem *p, uint32_t group, double *moments)
{
    for (size_t v = 0; v < p->n; ++v) {
        const float *cell = sph__problem_data(p, group, v);
        const double x = p->rest[3 * v], y = p->rest[3 * v + 1], z = p->rest[3 * v + 2];
        const sph__candidates *set = &p->sets[p->set[v]];
        const v8d area = sph__load(cell, 24);
        const v8d moved[3] = {sph__load(cell, 0) * area, sph__load(cell, 8) * area, sph__load(cell, 16) * area};
        for (uint32_t a = 0; a < p->now.count[v]; ++a) {
            const double w = p->now.weights[v * p->limit + a];
            v8d *into = (v8d *)(moments + (size_t)set->bones[p->now.places[v * p->limit + a]] * SPH__SKIN_POSE);
            for (int r = 0; r < 3; ++r) {
                const v8d q = moved[r] * w;
                into[4 * r] += q * x;
                into[4 * r + 1] += q * y;
                into[4 * r + 2] += q * z;
                into[4 * r + 3] += q;
            }
        }
    }
}

void sph__skin_kernel_moments(const sph__problem *p, uint32_t group, double *moments)
{
    memset(moments, 0, (size_t)p->bones * SPH__SKIN_POSE * sizeof *moments);
    add_moments(p, group, moments);
}

SPH__CLONES static void subtract_others(const sph__problem *p, uint32_t group, uint32_t bone, const double *gram,
                                        v8d *product)
{
    for (size_t i = p->near_starts[bone]; i < p->near_starts[bone + 1]; ++i) {
        const v8d *g = (const v8d *)(gram + (size_t)p->near[i].pair * 80);
        const v8d *a = (const v8d *)sph__problem_pose(p, group, p->near[i].bone);
        for (int r = 0; r < 3; ++r) {
            const v8d a0 = a[4 * r], a1 = a[4 * r + 1], a2 = a[4 * r + 2], a3 = a[4 * r + 3];
            product[4 * r] -= a0 * g[0] + a1 * g[1] + a2 * g[2] + a3 * g[3];
            product[4 * r + 1] -= a0 * g[1] + a1 * g[4] + a2 * g[5] + a3 * g[6];
            product[4 * r + 2] -= a0 * g[2] + a1 * g[5] + a2 * g[7] + a3 * g[8];
            product[4 * r + 3] -= a0 * g[3] + a1 * g[6] + a2 * g[8] + a3 * g[9];
        }
    }
}

void sph__skin_kernel_remainder(const sph__problem *p, uint32_t group, uint32_t bone, const double *gram,
                                const double *moments, double *product)
{
    memcpy(product, moments + (size_t)bone * SPH__SKIN_POSE, SPH__SKIN_POSE * sizeof *product);
    subtract_others(p, group, bone, gram, (v8d *)product);
}

SPH__CLONES static void add_residual_gram(const sph__problem *p, size_t begin, size_t end, double *sums,
                                          double *offsets)
{
    const sph__candidates *set = &p->sets[p->set[begin]];
    const size_t count = set->count, pairs = count * (count + 1) / 2;
    v8d *off = (v8d *)offsets;
    for (uint32_t group = 0; group < p->groups; ++group)
        for (size_t v = begin; v < end; ++v) {
            const float *cell = sph__problem_data(p, group, v);
            const double x = p->rest[3 * v], y = p->rest[3 * v + 1], z = p->rest[3 * v + 2];
            const v8d v0 = sph__load(cell, 0), v1 = sph__load(cell, 8), v2 = sph__load(cell, 16);
            const v8d area = sph__load(cell, 24);
            v8d *into = (v8d *)sums + (v - begin) * pairs;
            for (size_t a = 0; a < count; ++a) {
                const v8d *t = (const v8d *)sph__problem_pose(p, group, set->bones[a]);
                const v8d d0 = t[0] * x + t[1] * y + t[2] * z + t[3] - v0;
                const v8d d1 = t[4] * x + t[5] * y + t[6] * z + t[7] - v1;
                const v8d d2 = t[8] * x + t[9] * y + t[10] * z + t[11] - v2;
                const v8d e0 = d0 * area, e1 = d1 * area, e2 = d2 * area;
                off[3 * a] = d0;
                off[3 * a + 1] = d1;
                off[3 * a + 2] = d2;
                for (size_t b = 0; b <= a; ++b)
                    *into++ += e0 * off[3 * b] + e1 * off[3 * b + 1] + e2 * off[3 * b + 2];
            }
        }
}

void sph__skin_kernel_residual_gram(const sph__problem *p, size_t begin, size_t end, double *sums, double *offsets)
{
    const size_t count = p->sets[p->set[begin]].count;
    memset(sums, 0, (end - begin) * (count * (count + 1) / 2) * SPH__SKIN_LANES * sizeof *sums);
    add_residual_gram(p, begin, end, sums, offsets);
}

SPH__CLONES static void add_energy(const sph__problem *p, const sph__influences *at, size_t begin, size_t end,
                                   double energy[2])
{
    v8d weighted = {0}, plain = {0};
    for (uint32_t group = 0; group < p->groups; ++group) {
        const uint32_t left = p->frames - group * SPH__SKIN_LANES;
        v8d counts;
        for (uint32_t lane = 0; lane < SPH__SKIN_LANES; ++lane)
            counts[lane] = lane < left;
        for (size_t v = begin; v < end; ++v) {
            const float *cell = sph__problem_data(p, group, v);
            const double x = p->rest[3 * v], y = p->rest[3 * v + 1], z = p->rest[3 * v + 2];
            const sph__candidates *set = &p->sets[p->set[v]];
            v8d d0 = -sph__load(cell, 0), d1 = -sph__load(cell, 8), d2 = -sph__load(cell, 16), squared;
            for (uint32_t s = 0; s < at->count[v]; ++s) {
                const uint32_t place = at->places[v * p->limit + s];
                const v8d *t = (const v8d *)sph__problem_pose(p, group, set->bones[place]);
                const double w = at->weights[v * p->limit + s];
                d0 += w * (t[0] * x + t[1] * y + t[2] * z + t[3]);
                d1 += w * (t[4] * x + t[5] * y + t[6] * z + t[7]);
                d2 += w * (t[8] * x + t[9] * y + t[10] * z + t[11]);
            }
            squared = d0 * d0 + d1 * d1 + d2 * d2;
            weighted += squared * sph__load(cell, 24);
            plain += squared * counts;
        }
    }
    energy[0] = sph__sum(weighted);
    energy[1] = sph__sum(plain);
}

void sph__skin_kernel_energy(const sph__problem *p, const sph__influences *at, size_t begin, size_t end,
                             double energy[2])
{
    add_energy(p, at, begin, end, energy);
}

SPH__CLONES static void add_rest(const sph__problem *p, size_t v, double out[9])
{
    const sph__candidates *set = &p->sets[p->set[v]];
    v8d sums[9] = {{0}};
    for (uint32_t group = 0; group < p->groups; ++group) {
        const float *cell = sph__problem_data(p, group, v);
        const v8d area = sph__load(cell, 24);
        v8d m[12] = {{0}}, d[3];
        for (uint32_t s = 0; s < p->now.count[v]; ++s) {
            const uint32_t place = p->now.places[v * p->limit + s];
            const v8d *t = (const v8d *)sph__problem_pose(p, group, set->bones[place]);
            const double w = p->now.weights[v * p->limit + s];
            for (int i = 0; i < 12; ++i)
                m[i] += w * t[i];
        }
        for (int r = 0; r < 3; ++r)
            d[r] = sph__load(cell, 8 * r) - m[4 * r + 3];
        for (int a = 0, at = 0; a < 3; ++a) {
            for (int b = a; b < 3; ++b)
                sums[at++] += area * (m[a] * m[b] + m[4 + a] * m[4 + b] + m[8 + a] * m[8 + b]);
            sums[6 + a] += area * (m[a] * d[0] + m[4 + a] * d[1] + m[8 + a] * d[2]);
        }
    }
    for (int i = 0; i < 9; ++i)
        out[i] = sph__sum(sums[i]);
}

void sph__skin_kernel_rest(const sph__problem *p, size_t v, double sums[9])
{
    add_rest(p, v, sums);
}
