/* SPDX-License-Identifier: MIT */
/**
 * @file coverage.h
 * @brief How far the vertices of an animated mesh stick out of a level, and levels that contain them all.
 *
 * A vertex x is contained where some weights b >= 0 of sum 1 on some simplex have |x - c(b)| <= r(b). That is decided
 * for the 32-bit centres, radii and positions as they are stored, in 64-bit arithmetic whose rounding counts against
 * containment: so what is said to be contained is.
 */
#ifndef SPHMESH_COVERAGE_H
#define SPHMESH_COVERAGE_H

#include "level.h"

SPH_BEGIN_DECLS

/** How far a mesh sticks out of a level. */
typedef struct sph_coverage {
    uint32_t struct_size;     /**< sizeof(sph_coverage), set by the caller */
    uint32_t frame;           /**< where the distance is largest; the first such frame; 0 where all are contained */
    uint32_t vertex;          /**< and the first such vertex; 0 where all are contained */
    uint32_t reserved0;       /**< 0 */
    double distance;          /**< the largest uncovered distance: of a vertex to the solid, over all frames and vertices;
                                   model units; 0 where all are contained */
    uint64_t uncovered_count; /**< (frame, vertex) pairs that are not contained */
} sph_coverage;

/**
 * @brief The largest distance by which a vertex sticks out of the level, over all frames and vertices.
 * @param[in]     animation  the one that the level was made from, or any of as many frames.
 * @param[in,out] coverage   `struct_size` set by the caller; otherwise untouched on failure.
 * @retval SPH_E_INVALID    NULL, a size that is not known, frame counts that differ (the message says both), or a
 *                          coordinate that is not finite (the message names frame and vertex).
 * @retval SPH_E_NOMEM      out of memory.
 * @retval SPH_E_CANCELLED  progress asked to stop.
 * @return otherwise what the frame source returned.
 * @par Determinism  Same bits whatever the executor and threads.
 * @par Cost  Up to about a microsecond per frame and vertex.
 * @since 0.1
 */
SPH_API sph_status sph_coverage_measure(const sph_animation *animation, const sph_level *level,
                                        sph_coverage *coverage);

/** Options of the inflation. Fill with sph_inflation_options_init() first. */
typedef struct sph_inflation_options {
    uint32_t struct_size; /**< bytes the caller knows of; written by the initialiser */
    uint32_t flags;       /**< must be 0 */
    uint32_t rounds;      /**< passes over the animation that look for small radii, from 0 to 1000, before what is left is
                               covered at once; default 24 */
    uint32_t reserved0;   /**< must be 0 */
    double margin;        /**< how deep vertices shall lie in the solid; model units, finite, >= 0; default 0 */
} sph_inflation_options;

/** @brief Fills `options` with the defaults. Call as `sph_inflation_options_init(&o, sizeof o)`. @since 0.1 */
SPH_API void sph_inflation_options_init(sph_inflation_options *options, size_t size);

/** What an inflation has done. */
typedef struct sph_inflation {
    uint32_t struct_size;  /**< sizeof(sph_inflation), set by the caller */
    uint32_t rounds;       /**< passes that were made */
    uint64_t grown_count;  /**< radii that have grown; with radii per frame each frame's counts */
    double max_growth;     /**< the largest growth of a radius; model units */
    double mean_growth;    /**< the mean over all radii; model units */
    double volume_before;  /**< of the solid, the mean over frames; model units cubed. Estimated, as is the next, from the
                                same 8192 points in each of at most 32 frames: good to about 2 % */
    double volume_after;   /**< of the inflated solid */
} sph_inflation;

/**
 * @brief A level with radii so large that it contains every vertex in every frame; all else is that of `level`.
 *
 * Radii grow where vertices stick out, and by as little as they must: of all vertices found so far the least sum of
 * squared growths is taken that contains them where they were nearest to the level,
 * \f[ \min \sum_i (r'_i - r_i)^2 \quad \sum_i b_i r'_i \ge |x - c(b)| + \mathrm{margin} \f]
 * (a sum over frames too where radii are per frame), until a pass over the animation finds no more. A radius that is
 * constant over frames stays so; none gets smaller. The result has passed the test of sph_coverage_measure().
 * @param[in]     options    may be NULL: all defaults.
 * @param[in,out] inflation  `struct_size` set by the caller; may be NULL.
 * @param[out]    out        owned by the caller; NULL on failure.
 * @retval SPH_E_INVALID, SPH_E_NOMEM, SPH_E_CANCELLED  as sph_coverage_measure(); also bad options.
 * @retval SPH_E_LIMIT  a radius beyond what a float holds would be needed.
 * @par Determinism  Same bits whatever the executor and threads.
 * @par Cost  A measure per round, as a rule 5 to 25; later rounds are quicker, as vertices inside take less time.
 * @since 0.1
 */
SPH_API sph_status sph_coverage_inflate(const sph_animation *animation, const sph_level *level,
                                        const sph_inflation_options *options, sph_inflation *inflation,
                                        sph_level **out);

SPH_END_DECLS

#endif
