/* SPDX-License-Identifier: MIT */
/**
 * @file pose.h
 * @brief New poses of a skin: its vertices moved by any transforms of its bones, and transforms of the bones from
 * spheres that were moved by hand.
 */
#ifndef SPHMESH_POSE_H
#define SPHMESH_POSE_H

#include "skin.h"

SPH_BEGIN_DECLS

/** Handle: what is needed to move the vertices of a skin, laid out for it. It stands alone: the skin need not live on.
 */
typedef struct sph_deformer sph_deformer;

/** How the transforms of a vertex's bones are blended. */
enum {
    SPH_POSE_LINEAR = 0,         /**< linear blend skinning: the weighted mean of the transforms, as engines and
                                      sph_skin_measure() have it; it may shear and shrink where bones turn far */
    SPH_POSE_DUAL_QUATERNION = 1 /**< rotations and translations are blended as dual quaternions, which gives a rotation
                                      and a translation (Kavan et al. 2008). What a transform has besides these, scale
                                      and shear, is blended linearly and applied first, about the bone's pivot */
};

/** Options of sph_deformer_create(). Fill with sph_deformer_options_init() first. */
typedef struct sph_deformer_options {
    uint32_t struct_size; /**< bytes the caller knows of; written by the initialiser */
    uint32_t flags;       /**< must be 0 */
    const float *normals; /**< shape (n, 3): of the rest pose, of any length; NULL (default): those of the triangles,
                               each as heavy as its area */
} sph_deformer_options;

/** @brief Fills `options` with the defaults. Call as `sph_deformer_options_init(&o, sizeof o)`. @since 0.1 */
SPH_API void sph_deformer_options_init(sph_deformer_options *options, size_t size);

/**
 * @brief Makes a deformer. Arrays of the caller's own become a skin first, by sph_skin_create_from_arrays(); it needs
 * no frames.
 * @param[in]  options  may be NULL: all defaults.
 * @param[out] out      owned by the caller; NULL on failure.
 * @retval SPH_E_INVALID  NULL, bad options, or a normal that is not finite; the message names its vertex.
 * @retval SPH_E_NOMEM    out of memory.
 * @par Cost  O(n k + J).
 * @since 0.1
 */
SPH_API sph_status sph_deformer_create(const sph_skin *skin, const sph_deformer_options *options, sph_deformer **out);

/** @brief Destroys a deformer. NULL is fine. @since 0.1 */
SPH_API void sph_deformer_destroy(sph_deformer *deformer);

/**
 * @brief Moves the vertices of the rest pose, for one pose or many.
 *
 * Normals are turned by the same blended transform as the vertex, as the cross product of two directions on the surface
 * is (also where it scales or mirrors: they stay on the side from which the triangles run counter-clockwise), and have
 * length 1; 0 where there is none, or where products of a transform's numbers are beyond what a double holds.
 * @param[in]  transforms  shape (pose_count, J, 3, 4), as sph_skin_arrays::transforms: rest pose to pose; any affine
 * ones.
 * @param[in]  method      one of SPH_POSE_*.
 * @param[out] positions   shape (pose_count, n, 3); untouched where the call is refused; may be NULL.
 * @param[out] normals     shape (pose_count, n, 3); may be NULL.
 * @retval SPH_E_INVALID    NULL, an unknown method, sizes that overflow, or a transform that is not finite; the message
 *                          names pose and bone.
 * @retval SPH_E_STATE      normals of a skin without triangles, made without normals.
 * @retval SPH_E_CANCELLED  progress asked to stop.
 * @par Cost  O(pose_count (n k + J)), no allocation; vertices and poses are spread over the executor's threads.
 * @par Thread safety  One call at a time with one deformer; any number with others.
 * @par Determinism  Same bits whatever the executor and threads, and whether poses come one by one or together.
 * @since 0.1
 */
SPH_API sph_status sph_deformer_pose(sph_deformer *deformer, const double *transforms, size_t pose_count,
                                     int32_t method, float *positions, float *normals);

/**
 * @brief Transforms of the bones from places of their spheres: the user moves centres, rotations follow.
 *
 * A sphere is turned as its neighbours, to which the skin's links lead, have moved around it: by the rotation R of
 * least \f$ \sum_j |R (c_j - c_i) - (c'_j - c'_i)|^2 / |c_j - c_i|^2 \f$. Where neighbours leave it open - one of them,
 * or all on a line, within some 10 percent - it is, of those rotations, the one nearest to the mean of the
 * neighbours' whose rotation is known, and where none is known, the smallest. A sphere without neighbours is moved, not
 * turned. Radii stay what they are. A motion of all spheres as one rigid body so gives that motion, in any part of the
 * skin that has one sphere with neighbours that are not on a line.
 * @param[in]  skin        its pivots are the spheres' centres in the rest pose.
 * @param[in]  reference   shape (J, 3, 4): the pose that is edited, as one frame of sph_skin_arrays::transforms; NULL:
 *                         the rest pose.
 * @param[in]  centers     shape (J, 3): the new centres.
 * @param[out] transforms  shape (J, 3, 4): rest pose to the new pose, for sph_deformer_pose(); rigid where the
 * reference is. May be `reference`.
 * @retval SPH_E_INVALID  NULL, or a number that is not finite; the message names the bone.
 * @retval SPH_E_NOMEM    out of memory.
 * @par Cost  O(J + L) for L links.
 * @par Thread safety  Any number of threads.
 * @since 0.1
 */
SPH_API sph_status sph_pose_from_spheres(const sph_skin *skin, const double *reference, const double *centers,
                                         double *transforms);

SPH_END_DECLS

#endif
