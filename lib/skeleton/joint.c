/* SPDX-License-Identifier: MIT */
/* The joint of two bones: the point, fixed to both, which they move alike. */
#include <float.h>
#include <math.h>

#include "numeric/numeric.h"
#include "skeleton/skeleton.h"

/* Squared angles (radians) below which the motion says nothing: 1e-5, far below what meshes in floats can tell. */
static const double LEAST_TURN = 1e-10;
/* What a squared length at rest counts against a squared gap: of links that are alike, the shorter. */
static const double LENGTH_SHARE = 1e-6;
enum { BISECTIONS = 100 };

/* The mean over frames of |D y + e|^2, with D = A_a - A_b (linear part) and e = (A_a - A_b) c: squares of y, y, and 1.
 */
typedef struct moments {
    double squares[6], linear[3];
} moments;

/* (A_a - A_b) p in one frame. */
static void difference(const double a[12], const double b[12], double d[9])
{
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
            d[3 * r + c] = a[4 * r + c] - b[4 * r + c];
}

static void parting(const double a[12], const double b[12], const double p[3], double e[3])
{
    double q[3];
    sph__transform_point(a, p, e);
    sph__transform_point(b, p, q);
    sph__subtract(e, q, e);
}

static const double *transform(const sph_skin *skin, uint32_t frame, uint32_t bone)
{
    return skin->transforms + 12 * ((size_t)frame * skin->bone_count + bone);
}

static void collect(const sph_skin *skin, const uint32_t bones[2], const double center[3], moments *m)
{
    *m = (moments){{0}, {0}};
    for (uint32_t f = 0; f < skin->frame_count; ++f) {
        const double *a = transform(skin, f, bones[0]), *b = transform(skin, f, bones[1]);
        double d[9], e[3];
        difference(a, b, d);
        parting(a, b, center, e);
        for (int r = 0; r < 3; ++r) {
            sph__sym3_add_outer(1.0 / skin->frame_count, d + 3 * r, m->squares);
            sph__add_scaled(m->linear, e[r] / skin->frame_count, d + 3 * r, m->linear);
        }
    }
}

static double mean_gap(const sph_skin *skin, const uint32_t bones[2], const double p[3])
{
    double sum = 0;
    for (uint32_t f = 0; f < skin->frame_count; ++f) {
        double e[3];
        parting(transform(skin, f, bones[0]), transform(skin, f, bones[1]), p, e);
        sum += sph__dot(e, e) / skin->frame_count;
    }
    return sum;
}

/* Where the two spheres meet in the rest pose, between their centres in proportion to the radii. */
static void meeting(const sph_skin *skin, const uint32_t bones[2], double point[3])
{
    const double *p = skin->pivots + 3 * (size_t)bones[0], *q = skin->pivots + 3 * (size_t)bones[1];
    const double r = skin->radii[bones[0]], s = skin->radii[bones[1]];
    const double share = r + s > 0 ? r / (r + s) : 0.5;
    for (int k = 0; k < 3; ++k)
        point[k] = p[k] + share * (q[k] - p[k]);
}

/* y = -(M + damping)^-1 g, in the eigenvectors of M, without those that the motion leaves open; its squared length. */
static double step(const double values[3], const double slopes[3], double damping, double y[3])
{
    for (int k = 0; k < 3; ++k)
        y[k] = values[k] > LEAST_TURN ? -slopes[k] / (values[k] + damping) : 0;
    return sph__dot(y, y);
}

/*
 * What is noise in the gap is noise in the place: the less the bones turn against one another, the more. So the gap
 * that stays is weighed against how far the place may be expected from where the spheres meet, half a link: the damping
 * is the quotient of both squares. A hinge without play is found exactly. `reach` bounds the step in any case.
 */
static void place(const moments *m, double gap, double link, double reach, double y[3])
{
    double values[3], vectors[3][3], slopes[3], coordinates[3], damping, high;
    sph__sym3_eigen(m->squares, values, vectors);
    for (int k = 0; k < 3; ++k)
        slopes[k] = sph__dot(vectors[k], m->linear);
    (void)step(values, slopes, 0, coordinates);
    for (int k = 0; k < 3; ++k) /* gap: at y = 0 */
        gap += coordinates[k] * slopes[k];
    damping = link > 0 && gap > 0 ? 4 * gap / (link * link) : 0;
    if (step(values, slopes, damping, coordinates) > reach * reach) {
        double low = damping;
        high = damping + (reach > 0 ? sph__length(slopes) / reach : DBL_MAX);
        for (int i = 0; i < BISECTIONS; ++i) {
            const double middle = low + (high - low) / 2;
            if (step(values, slopes, middle, coordinates) > reach * reach)
                low = middle;
            else
                high = middle;
        }
        (void)step(values, slopes, high, coordinates);
    }
    for (int k = 0; k < 3; ++k)
        y[k] = coordinates[0] * vectors[0][k] + coordinates[1] * vectors[1][k] + coordinates[2] * vectors[2][k];
}

static bool all_finite(const moments *m)
{
    double sum = 0;
    for (int k = 0; k < 6; ++k)
        sum += fabs(m->squares[k]);
    for (int k = 0; k < 3; ++k)
        sum += fabs(m->linear[k]);
    return isfinite(sum);
}

void sph__bond_fit(const sph_skin *skin, sph__bond *bond)
{
    const uint32_t *bones = bond->bones;
    double apart[3], center[3], y[3] = {0, 0, 0}, link, gap;
    moments m;
    sph__subtract(skin->pivots + 3 * (size_t)bones[0], skin->pivots + 3 * (size_t)bones[1], apart);
    link = sph__length(apart);
    meeting(skin, bones, center);
    collect(skin, bones, center, &m);
    gap = mean_gap(skin, bones, center);
    if (all_finite(&m) && isfinite(gap)) place(&m, gap, link, link + skin->radii[bones[0]] + skin->radii[bones[1]], y);
    for (int k = 0; k < 3; ++k)
        bond->position[k] = center[k] + y[k];
    gap = mean_gap(skin, bones, bond->position);
    bond->gap = sqrt(gap);
    bond->cost = gap + LENGTH_SHARE * link * link;
    if (!isfinite(bond->cost)) bond->cost = DBL_MAX;
}
