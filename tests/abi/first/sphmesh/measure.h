/* SPDX-License-Identifier: MIT */
/**
 * @file measure.h
 * @brief Distances between an animated mesh (1) and a level's outer surface, or another mesh (2): H, M12 and M21.
 *
 * Surface 2 of a level is the outer surface of the interpolated spheres: the part that is connected to infinity. Points are
 * spread evenly by area over either surface; distances are to the surface itself. Source: Thiery et al. 2016, Table I.
 */
#ifndef SPHMESH_MEASURE_H
#define SPHMESH_MEASURE_H

#include "level.h"

SPH_BEGIN_DECLS

/** Options of the measures. Fill with sph_measure_options_init() first. */
typedef struct sph_measure_options {
    uint32_t struct_size; /**< bytes the caller knows of; written by the initialiser */
    uint32_t flags;       /**< must be 0 */
    uint32_t samples;     /**< points per surface and frame, from 1 to 2^28, of a level's surface at least about 3000;
                               vertices of meshes count besides, for the largest distances only; default 10000 */
    uint32_t seed;        /**< of the points; default 1 */
    uint32_t first_frame; /**< default 0 */
    uint32_t frame_step;  /**< default 1; > 0 */
    uint32_t frame_limit; /**< measure at most so many frames; 0 (default): all */
    uint32_t reserved0;   /**< must be 0 */
} sph_measure_options;

/** @brief Fills `options` with the defaults. Call as `sph_measure_options_init(&o, sizeof o)`. @since 0.1 */
SPH_API void sph_measure_options_init(sph_measure_options *options, size_t size);

/** Distances of one frame, or their means over frames; model units. */
typedef struct sph_distances {
    double hausdorff; /**< H: the larger of max12 and max21 (of a mean over frames: the mean of H) */
    double mean12;    /**< M12: mean distance from points of surface 1 to surface 2 */
    double mean21;    /**< M21: mean distance from points of surface 2 to surface 1 */
    double max12;     /**< largest distance from a point of surface 1 to surface 2 */
    double max21;     /**< largest distance from a point of surface 2 to surface 1 */
    double area1;     /**< area of surface 1, model units squared */
    double area2;     /**< area of surface 2, estimated from the points, model units squared */
} sph_distances;

/**
 * @brief Measures a level against the animation that it approximates.
 * @param[in]  options    may be NULL: all defaults.
 * @param[out] mean       means over the frames measured; untouched on failure.
 * @param[out] per_frame  one entry per frame measured, in order; may be NULL.
 * @retval SPH_E_INVALID    NULL, bad options, no triangles, frame counts that differ (the message says both), or a
 *                          coordinate that is not finite.
 * @retval SPH_E_NOMEM      out of memory.
 * @retval SPH_E_CANCELLED  progress asked to stop.
 * @return otherwise what the frame source returned.
 * @par Determinism  Same bits whatever the executor and threads.
 * @par Cost  About a microsecond per sample and 10 simplices.
 * @since 0.1
 */
SPH_API sph_status sph_measure_level(const sph_animation *animation, const sph_level *level,
                                     const sph_measure_options *options, sph_distances *mean,
                                     sph_distances *per_frame);

/**
 * @brief Measures two animated meshes of as many frames against each other, both as they are: no part of either is left
 *        out. Arguments and errors as sph_measure_level().
 * @since 0.1
 */
SPH_API sph_status sph_measure_meshes(const sph_animation *animation1, const sph_animation *animation2,
                                      const sph_measure_options *options, sph_distances *mean,
                                      sph_distances *per_frame);

SPH_END_DECLS

#endif
