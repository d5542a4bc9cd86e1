/* SPDX-License-Identifier: MIT */
/**
 * @file quadric.h
 * @brief The spherical quadric error of a set of animated planes, and the animated sphere that minimises it.
 *
 * One oriented plane (p, n) with weight w in one frame f costs w (n·(p - q_f) - r)^2; a quadric sums any number of planes
 * in F frames, in double precision. Source: Thiery et al. 2016, Eq. 1 and 5-12, and appendix A.
 */
#ifndef SPHMESH_QUADRIC_H
#define SPHMESH_QUADRIC_H

#include "context.h"

SPH_BEGIN_DECLS

/** Handle: a quadric over F frames. */
typedef struct sph_quadric sph_quadric;

/** An animated sphere's scalar part, and how it was found. */
typedef struct sph_quadric_minimum {
    double radius;              /**< r in [0, radius_max], model units */
    double lambda;              /**< in [0, 1], where on the segments from u to v the degenerate frames have their centre; 0 where there are none */
    double cost;                /**< Q at the minimum, model units squared times the weights' unit; >= 0 but for rounding */
    uint32_t degenerate_frames; /**< number of frames whose centre the planes alone do not fix */
    uint32_t reserved0;         /**< 0 */
} sph_quadric_minimum;

/**
 * @brief Makes a quadric that is zero: no planes.
 * @param[in]  frame_count  F, from 1 to 2^31 - 1.
 * @param[out] out          owned by the caller; NULL on failure.
 * @retval SPH_E_INVALID  NULL or a count out of range.
 * @retval SPH_E_NOMEM    out of memory.
 * @since 0.1
 */
SPH_API sph_status sph_quadric_create(sph_context *context, uint32_t frame_count, sph_quadric **out);

/** @brief Destroys a quadric. NULL is fine. @since 0.1 */
SPH_API void sph_quadric_destroy(sph_quadric *quadric);

/** @brief F, or 0 for NULL. @since 0.1 */
SPH_API uint32_t sph_quadric_frame_count(const sph_quadric *quadric);

/**
 * @brief Adds one oriented plane to one frame (Eq. 8).
 * @param[in] frame   below F.
 * @param[in] point   any point of the plane, model units.
 * @param[in] normal  outward normal; normalised here; a zero normal is refused.
 * @param[in] weight  >= 0 and finite, e.g. a third of the triangle's area.
 * @retval SPH_E_INVALID  NULL, out of range, or not finite, also where a sum overflows. The quadric is unchanged.
 * @par Cost  O(1).
 * @since 0.1
 */
SPH_API sph_status sph_quadric_add_plane(sph_quadric *quadric, uint32_t frame, const double point[3],
                                         const double normal[3], double weight);

/**
 * @brief Adds weight * |q_f - center|^2 to one frame: the attachment of temporal coherence (Eq. 11-12).
 * @retval SPH_E_INVALID  as sph_quadric_add_plane().
 * @since 0.1
 */
SPH_API sph_status sph_quadric_add_attachment(sph_quadric *quadric, uint32_t frame, const double center[3],
                                              double weight);

/**
 * @brief Adds another quadric of as many frames; `other` may be `quadric` itself.
 * @retval SPH_E_INVALID  NULL, different frame counts, or a sum overflows. The quadric is unchanged.
 * @par Cost  O(F).
 * @since 0.1
 */
SPH_API sph_status sph_quadric_add(sph_quadric *quadric, const sph_quadric *other);

/**
 * @brief Q of a given animated sphere (Eq. 7).
 * @param[in]  centers  shape (F, 3), model units.
 * @param[in]  radius   model units, finite.
 * @param[out] cost     untouched on failure.
 * @retval SPH_E_INVALID  NULL or not finite, also where the cost overflows.
 * @since 0.1
 */
SPH_API sph_status sph_quadric_evaluate(const sph_quadric *quadric, const double *centers, double radius, double *cost);

/**
 * @brief The animated sphere of least Q with 0 <= r <= radius_max: closed form, exact (appendix A).
 *
 * In frames whose planes do not fix the centre it lies on the segment from u to v, at one lambda for all such frames.
 * That is where their matrix is numerically singular: its determinant at most 1e-6 times the cube of a third of its
 * trace. Of several minima that with the smallest r is taken; where lambda makes no difference it is 1/2.
 * @param[in]  u           shape (F, 3): one end of the segment per frame; NULL, as v: the origin of every frame.
 * @param[in]  v           shape (F, 3): its other end.
 * @param[in]  radius_max  R >= 0, model units; INFINITY is allowed.
 * @param[out] minimum     radius, lambda and cost; untouched on failure.
 * @param[out] centers     shape (F, 3); may be NULL: costs less. Untouched on failure.
 * @retval SPH_E_INVALID  NULL (one of u, v alone too), radius_max negative or NaN, or a segment that is not
 *                        finite or makes the cost overflow.
 * @par Thread safety  Any number of threads on one quadric.
 * @par Cost  O(F), no allocation.
 * @since 0.1
 */
SPH_API sph_status sph_quadric_minimize(const sph_quadric *quadric, const double *u, const double *v, double radius_max,
                                        sph_quadric_minimum *minimum, double *centers);

SPH_END_DECLS

#endif
