/* SPDX-License-Identifier: MIT */
#include "hierarchy/single.h"

/* Puts a region into a lane. */
static void put_lane(const float *rows, size_t lane, sph__lanes *lanes)
{
    for (size_t k = 0; k < SPH__BLOCK_ROWS; ++k) lanes->block[k][lane] = rows[k];
    for (size_t k = 0; k < 3; ++k) lanes->center[k][lane] = rows[SPH__SINGLE_CENTER + k];
    lanes->radius[lane] = (double)rows[SPH__SINGLE_RADIUS];
}

static sph__region scalars_of(const sph__builder *b, const sph__slot *slot)
{
    return (sph__region){.radius = (double)sph__single_rows(b, (size_t)(slot - b->slots))[SPH__SINGLE_RADIUS],
                         .w = slot->w,
                         .b = slot->b,
                         .c = slot->c};
}

/* Up to eight edges; lanes without one repeat the last. */
static void evaluate_eight(const sph__builder *b, const uint32_t *edges, size_t count, double *costs)
{
    const sph__slot *su[SPH__LANES], *sv[SPH__LANES];
    sph__region us[SPH__LANES], vs[SPH__LANES];
    sph__sums sums[SPH__LANES];
    sph__parabola parabola; /* costs are exact */
    sph__lanes u, v;
    for (size_t l = 0; l < SPH__LANES; ++l) {
        uint32_t nu, nv;
        sph__edge_ends(&b->mesh, edges[l < count ? l : count - 1], &nu, &nv);
        su[l] = sph__slot_of(b, nu);
        sv[l] = sph__slot_of(b, nv);
        us[l] = scalars_of(b, su[l]);
        vs[l] = scalars_of(b, sv[l]);
        put_lane(su[l]->block, l, &u);
        put_lane(sv[l]->block, l, &v);
    }
    sph__kernel_pair_sums(&u, &v, us, vs, count, sums);
    for (size_t l = 0; l < count; ++l)
        costs[l] = sph__evaluate_sums(b, &sums[l], us[l].radius, su[l], sv[l], &b->candidates[edges[l]], &parabola);
}

void sph__single_evaluate(const sph__builder *b, const uint32_t *edges, size_t count, double *costs)
{
    for (size_t i = 0; i < count; i += SPH__LANES)
        evaluate_eight(b, edges + i, count - i < SPH__LANES ? count - i : SPH__LANES, costs + i);
}

/* A region as the kernels for many frames take it: the first of eight, and the others are padding. */
static sph__region pad_region(const sph__builder *b, uint32_t node, sph__lanes *lanes)
{
    sph__region region = scalars_of(b, sph__slot_of(b, node));
    *lanes = (sph__lanes){.block = {{0}}};
    put_lane(sph__slot_of(b, node)->block, 0, lanes);
    region.block = lanes->block[0];
    region.center = lanes->center[0];
    return region;
}

void sph__single_center(const sph__builder *b, uint32_t u, uint32_t v, const sph__candidate *candidate)
{
    _Alignas(SPH__ALIGN) float center[3][SPH__LANES];
    sph__lanes lu, lv;
    const sph__region ru = pad_region(b, u, &lu), rv = pad_region(b, v, &lv);
    sph__kernel_centers(&ru, &rv, SPH__LANES, 0, candidate->lambda, (double)candidate->radius, center[0]);
    for (size_t k = 0; k < 3; ++k) b->new_center[k] = center[k][0];
}

static const float *center_of(const sph__builder *b, uint32_t node)
{
    return sph__single_rows(b, b->mesh.nodes[node].slot) + SPH__SINGLE_CENTER;
}

/* The triangles of `node`, eight at once. */
static bool inverts_around(const sph__builder *b, uint32_t node, uint32_t other, const float *center)
{
    const uint32_t *triangles = sph__triangles_of(&b->mesh, node), count = sph__triangle_count_of(&b->mesh, node);
    _Alignas(SPH__ALIGN) float corners[4][3][SPH__LANES] = {{{0}}}; /* no triangle: a point, which does not turn */
    const float *own = center_of(b, node);
    size_t lane = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const float *p, *q;
        uint32_t x[2];
        sph__triangle_others(&b->mesh, triangles[i], node, x);
        if (x[0] == other || x[1] == other) continue;
        p = center_of(b, x[0]);
        q = center_of(b, x[1]);
        for (size_t k = 0; k < 3; ++k) {
            corners[0][k][lane] = p[k];
            corners[1][k][lane] = q[k];
            corners[2][k][lane] = own[k];
            corners[3][k][lane] = center[k];
        }
        if (++lane < SPH__LANES) continue;
        if (sph__kernel_any_inversion(corners)) return true;
        lane = 0; /* what stays in the lanes does not turn */
    }
    return lane > 0 && sph__kernel_any_inversion(corners);
}

bool sph__single_inverts(const sph__builder *b, uint32_t u, uint32_t v, const float *center)
{
    return inverts_around(b, u, v, center) || inverts_around(b, v, u, center);
}

void sph__single_unite(const sph__builder *b, uint32_t u, uint32_t v, const sph__candidate *candidate)
{
    _Alignas(SPH__ALIGN) float block[SPH__BLOCK_ROWS][SPH__LANES], center[3][SPH__LANES] = {{0}};
    sph__slot *slot = sph__slot_of(b, u);
    sph__lanes lu, lv;
    const sph__region ru = pad_region(b, u, &lu), rv = pad_region(b, v, &lv);
    for (size_t k = 0; k < 3; ++k) center[k][0] = b->new_center[k];
    sph__kernel_unite(&ru, &rv, SPH__LANES, center[0], (double)candidate->radius, block[0], &slot->w, &slot->b,
                      &slot->c);
    for (size_t k = 0; k < SPH__BLOCK_ROWS; ++k) slot->block[k] = block[k][0];
    memcpy(slot->block + SPH__SINGLE_CENTER, b->new_center, 3 * sizeof(float));
    slot->block[SPH__SINGLE_RADIUS] = candidate->radius;
}
