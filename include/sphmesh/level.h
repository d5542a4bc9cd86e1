/* SPDX-License-Identifier: MIT */
/**
 * @file level.h
 * @brief One level of detail: K animated spheres, and the edges and triangles over which they are interpolated.
 */
#ifndef SPHMESH_LEVEL_H
#define SPHMESH_LEVEL_H

#include "hierarchy.h"

SPH_BEGIN_DECLS

/** Handle: a level. It stands alone: nothing it was made from needs to live on. */
typedef struct sph_level sph_level;

/** Label of an input vertex that no sphere holds (only in levels that callers make). */
#define SPH_NO_SPHERE UINT32_MAX

/** The parts of a level, for callers that make one; also what the getters return. */
typedef struct sph_level_arrays {
    uint32_t struct_size;      /**< sizeof(sph_level_arrays) */
    uint32_t sphere_count;     /**< K >= 1 */
    uint32_t frame_count;      /**< F >= 1 */
    uint32_t radii_per_frame;  /**< 0: `radii` has K entries; 1: F * K */
    const float *centers;      /**< shape (F, K, 3), model units */
    const float *radii;        /**< shape (K) or (F, K), model units, >= 0 */
    size_t edge_count;         /**< wire edges: of no triangle */
    const uint32_t *edges;     /**< shape (edge_count, 2), sphere indices */
    size_t triangle_count;     /**< triangles over which spheres are interpolated */
    const uint32_t *triangles; /**< shape (triangle_count, 3), sphere indices */
    size_t label_count;        /**< n, or 0 for none */
    const uint32_t *labels;    /**< for every input vertex the sphere that holds it, or #SPH_NO_SPHERE */
} sph_level_arrays;

/**
 * @brief The level of a hierarchy with `sphere_count` spheres. Spheres are in ascending order of their nodes.
 * @param[in]  sphere_count  from n - C to n (see sph_hierarchy_collapse_count()).
 * @param[out] out           owned by the caller; NULL on failure.
 * @retval SPH_E_INVALID  NULL or a count out of range (the message says the range).
 * @retval SPH_E_NOMEM    out of memory.
 * @par Cost  O(K F) for the spheres, O(K log K) for the simplices, O(n) for the labels.
 * @since 0.1
 */
SPH_API sph_status sph_level_create(const sph_hierarchy *hierarchy, uint32_t sphere_count, sph_level **out);

/** Whether a level says for every input vertex which sphere holds it. */
enum { SPH_LABELS_VERTICES = 0, SPH_LABELS_NONE = 1 };

/** Options of sph_level_extract(). Fill with sph_level_options_init() first. */
typedef struct sph_level_options {
    uint32_t struct_size; /**< bytes the caller knows of; written by the initialiser */
    uint32_t flags;       /**< must be 0 */
    uint32_t first_frame; /**< the level's frame 0; default 0 */
    uint32_t frame_count; /**< 0 (default): all from first_frame on */
    int32_t labels;       /**< one of SPH_LABELS_*; default all vertices */
} sph_level_options;

/** @brief Fills `options` with the defaults. Call as `sph_level_options_init(&o, sizeof o)`. @since 0.1 */
SPH_API void sph_level_options_init(sph_level_options *options, size_t size);

/**
 * @brief sph_level_create() of some frames, or without labels: a jump whose time does not grow with the input.
 * @param[in]  options  NULL: as sph_level_create().
 * @param[out] out      owned by the caller; NULL on failure.
 * @retval SPH_E_INVALID  as sph_level_create(), frames that there are not, or bad options.
 * @retval SPH_E_VERSION  options that only a newer library knows are set.
 * @retval SPH_E_NOMEM    out of memory.
 * @par Cost  O(K f) for the spheres of f frames, O(K log K) for the simplices, O(n) for labels where they are wanted.
 * @since 0.1
 */
SPH_API sph_status sph_level_extract(const sph_hierarchy *hierarchy, uint32_t sphere_count,
                                     const sph_level_options *options, sph_level **out);

/**
 * @brief A level from the caller's arrays, which are checked and copied.
 * @retval SPH_E_INVALID  NULL, a count of 0, an index out of range, a radius below 0, or a value that is not finite; the
 *                        message names it.
 * @retval SPH_E_NOMEM    out of memory.
 * @since 0.1
 */
SPH_API sph_status sph_level_create_from_arrays(sph_context *context, const sph_level_arrays *arrays, sph_level **out);

/** @brief Destroys a level. NULL is fine. @since 0.1 */
SPH_API void sph_level_destroy(sph_level *level);

/**
 * @brief The level's parts, borrowed until it is destroyed or its connectivity optimised.
 * @param[in,out] arrays  `struct_size` set by the caller.
 * @retval SPH_E_INVALID  NULL or a size that is not known.
 * @since 0.1
 */
SPH_API sph_status sph_level_get_arrays(const sph_level *level, sph_level_arrays *arrays);

/** @brief K, or 0 for NULL. @since 0.1 */
SPH_API uint32_t sph_level_sphere_count(const sph_level *level);
/** @brief F, or 0 for NULL. @since 0.1 */
SPH_API uint32_t sph_level_frame_count(const sph_level *level);

/**
 * @brief Connectivity optimisation (section 4.3): every input vertex goes to the sphere, of its own and that one's
 *        neighbours, of least signed distance summed over frames; edges and triangles become the duals of these labels.
 * @param[in,out] level      unchanged on failure. Its edges, triangles and labels change, its spheres do not.
 * @param[in]     animation  the one that the level was made from.
 * @retval SPH_E_INVALID    NULL, no labels, or counts of frames or vertices that differ (the message says both).
 * @retval SPH_E_NOMEM      out of memory.
 * @retval SPH_E_CANCELLED  progress asked to stop.
 * @return otherwise what the frame source returned.
 * @since 0.1
 */
SPH_API sph_status sph_level_optimize_connectivity(sph_level *level, const sph_animation *animation);

/** @brief Writes the level as a `.sphm` container through `write`; see sph_hierarchy_write(). @since 0.1 */
SPH_API sph_status sph_level_write(const sph_level *level, sph_write_fn *write, void *user);

/** @brief Makes a level from the bytes of a `.sphm` container; see sph_hierarchy_read(). @since 0.1 */
SPH_API sph_status sph_level_read(sph_context *context, const void *bytes, size_t size, sph_level **out);

SPH_END_DECLS

#endif
