/* SPDX-License-Identifier: MIT */
/**
 * @file simplify.h
 * @brief Levels of detail of a skinned mesh: a progressive mesh whose vertices get new rest positions and new weights.
 *
 * Edges are collapsed by the error that the posed mesh makes, summed over example poses: \f[ E(v, a) = \sum_j (A^j(a)
 * v)' Q^j (A^j(a) v), \quad A^j(a) = \sum_k a_k M_k^j \f] with Q^j the plane quadric of the united vertices in pose j.
 * It is minimised over the rest position v and the weights a (>= 0, sum 1) in turn. Source: Landreneau and Schaefer
 * 2009.
 *
 * A level is named by its number of collapses, from 0 (the input) to sph_progressive_collapse_count(). Vertices that
 * share a place and move alike are one point, and collapse together; what differs between them - texture coordinates,
 * normals - stays a seam.
 */
#ifndef SPHMESH_SIMPLIFY_H
#define SPHMESH_SIMPLIFY_H

#include "hierarchy.h"
#include "skin.h"

SPH_BEGIN_DECLS

/** Handle: all levels of a skinned mesh. It stands alone, and never changes once it is made. */
typedef struct sph_progressive sph_progressive;

/** What the error of a collapse is made of, and what is optimised. */
enum {
    SPH_SIMPLIFY_SKINNED = 0,     /**< the surface in all example poses; position and weights (Landreneau and Schaefer
                                     2009);     default */
    SPH_SIMPLIFY_POSITION = 1,    /**< the same error; the position alone, weights are blended along the edge (Mohr and
                                       Gleicher 2003) */
    SPH_SIMPLIFY_PULLED_BACK = 2, /**< quadrics of all poses taken back to the rest pose by each vertex's own transform;
                                       weights as before (DeCoro and Rusinkiewicz 2005) */
    SPH_SIMPLIFY_REST = 3         /**< the rest pose alone (Garland and Heckbert 1997); needs no poses */
};

/** Options of sph_progressive_create(). Fill with sph_simplify_options_init() first. */
typedef struct sph_simplify_options {
    uint32_t struct_size;     /**< bytes the caller knows of; written by the initialiser */
    uint32_t flags;           /**< must be 0 */
    int32_t method;           /**< one of SPH_SIMPLIFY_*; default skinned */
    uint32_t influence_limit; /**< k: most bones per vertex, 1 to 32; 0 (default): as many as the skin has */
    uint32_t pose_limit;      /**< at most so many frames of the skin, evenly spread, are example poses; 0: all; default
                                   64 */
    uint32_t pose_count;      /**< of `poses`; default 0 */
    const double *poses;      /**< shape (pose_count, J, 3, 4): example poses as sph_skin_arrays::transforms; NULL
                                   (default): frames of the skin, and where it has none its rest pose */
    double border_weight;     /**< how heavy a border or a seam of texture is, beside a triangle as long and as wide;
                                   finite, >= 0; default 1 */
    double tolerance;         /**< the minimisation of an edge ends when a round lowers its error by less than this
                                   fraction; default 1e-4; finite, >= 0 */
    uint32_t round_limit;     /**< most rounds of it, 1 to 1000; default 8 */
    uint32_t attribute_count; /**< C: numbers per vertex in `attributes`; at most 4096 */
    const float *attributes;  /**< shape (n, C): texture coordinates, colours, ...: blended along the edges; where they
                                   differ between vertices of one place there is a seam; may be NULL where C is 0 */
    const float *normals;     /**< shape (n, 3): blended too, and brought to length 1; NULL (default): none */
    const uint32_t *groups;   /**< n numbers: vertices of different groups are never one point; NULL (default): one
                                   group */
    const uint8_t *locked;    /**< n entries, not 0: the vertex is in all levels, as it is; NULL (default): none */
} sph_simplify_options;

/** @brief Fills `options` with the defaults. Call as `sph_simplify_options_init(&o, sizeof o)`. @since 0.1 */
SPH_API void sph_simplify_options_init(sph_simplify_options *options, size_t size);

/**
 * @brief Makes all levels of a skinned mesh. A mesh of the caller's own becomes a skin first, by
 * sph_skin_create_from_arrays(); it needs no frames where `poses` are given.
 *
 * Accepts any skin with triangles: open, non-manifold, of many parts, with triangles of no area. Vertices of no
 * triangle belong to no level. Where a vertex has more bones than the limit, its heaviest stay.
 * @param[in]  skin     read during the call only.
 * @param[in]  options  may be NULL: all defaults.
 * @param[out] out      owned by the caller; NULL on failure.
 * @retval SPH_E_INVALID    NULL, bad options, a skin without triangles or of more than 2^30 vertices, or a number that
 * is not finite or too large to square in 32 bits; the message names it.
 * @retval SPH_E_NOMEM      out of memory.
 * @retval SPH_E_CANCELLED  progress asked to stop.
 * @par Determinism  Same bits for the same input and options, whatever the executor, threads and processor.
 * @par Cost  O(P K^2 n log n) time for P poses and K bones around an edge, O(P n) memory.
 * @since 0.1
 */
SPH_API sph_status sph_progressive_create(const sph_skin *skin, const sph_simplify_options *options,
                                          sph_progressive **out);

/** @brief Destroys it. NULL is fine. Cursors must go first; skins of levels may stay. @since 0.1 */
SPH_API void sph_progressive_destroy(sph_progressive *progressive);

/** @brief Number of collapses C: levels are 0 to C; 0 for NULL. @since 0.1 */
SPH_API uint32_t sph_progressive_collapse_count(const sph_progressive *progressive);
/** @brief Mean over the example poses of the bounding-box diagonal of the input, model units; 0 for NULL. @since 0.1 */
SPH_API double sph_progressive_bounding_diagonal(const sph_progressive *progressive);
/** @brief Example poses that the error is summed over; 0 for NULL. @since 0.1 */
SPH_API uint32_t sph_progressive_pose_count(const sph_progressive *progressive);

/** A level in figures. */
typedef struct sph_progressive_level {
    uint32_t struct_size;    /**< sizeof(sph_progressive_level), set by the caller */
    uint32_t collapse_count; /**< the level */
    uint32_t vertex_count;   /**< as engines count them: apart along seams */
    uint32_t point_count;    /**< places: vertices but for the seams */
    uint32_t triangle_count; /**< those that have three corners left */
    uint32_t forced;         /**< 1: some collapse before this level turned triangles over, or pinched the surface, as
                                  nothing else was left; else 0 */
    double error;            /**< root mean square distance, by area, between the level's vertices and the planes of the
                                  triangles that they stand for, over all example poses; made not to fall; model units */
    double max_error;        /**< the same of the worst vertex so far */
} sph_progressive_level;

/**
 * @brief Tells of a level.
 * @param[in,out] out  `struct_size` set by the caller; else untouched on failure.
 * @retval SPH_E_INVALID  NULL, a size that is not known, or a level above C.
 * @par Cost  O(1).
 * @since 0.1
 */
SPH_API sph_status sph_progressive_get_level(const sph_progressive *progressive, uint32_t level,
                                             sph_progressive_level *out);

/**
 * @brief The finest level of at most so many vertices, as engines count them.
 * @param[out] level  untouched on failure.
 * @retval SPH_E_INVALID  NULL.
 * @retval SPH_E_LIMIT    there is none: the message has the least.
 * @par Cost  O(log n).
 * @since 0.1
 */
SPH_API sph_status sph_progressive_find_vertices(const sph_progressive *progressive, uint32_t vertex_count,
                                                 uint32_t *level);
/** @brief The finest level of at most so many triangles; as sph_progressive_find_vertices(). @since 0.1 */
SPH_API sph_status sph_progressive_find_triangles(const sph_progressive *progressive, uint32_t triangle_count,
                                                  uint32_t *level);
/**
 * @brief The coarsest level whose `error` is at most `max_error`.
 * @param[in]  max_error  model units, >= 0.
 * @param[out] level      untouched on failure.
 * @retval SPH_E_INVALID  NULL, negative or NaN.
 * @par Cost  O(log n).
 * @since 0.1
 */
SPH_API sph_status sph_progressive_find_error(const sph_progressive *progressive, double max_error, uint32_t *level);

/**
 * @brief A level as a skin: the same bones, frames, clips, pivots and links.
 * @param[out] out  owned by the caller; NULL on failure.
 * @retval SPH_E_INVALID  NULL, or a level above C.
 * @retval SPH_E_LIMIT    the level has no triangles left.
 * @retval SPH_E_NOMEM    out of memory.
 * @par Cost  O(the level + F J).
 * @since 0.1
 */
SPH_API sph_status sph_progressive_get_skin(const sph_progressive *progressive, uint32_t level, sph_skin **out);

/**
 * @brief What belongs to the vertices and triangles of a level, in the order of its skin.
 * @param[out] normals           shape (vertex_count, 3); zeros where none were given; may be NULL.
 * @param[out] attributes        shape (vertex_count, C); may be NULL.
 * @param[out] vertex_sources    vertex_count numbers: an input vertex that each comes from; may be NULL.
 * @param[out] triangle_sources  triangle_count numbers: the input triangle that each is; may be NULL.
 * @retval SPH_E_INVALID  NULL, or a level above C.
 * @retval SPH_E_NOMEM    out of memory.
 * @par Cost  O(the level).
 * @since 0.1
 */
SPH_API sph_status sph_progressive_get_attributes(const sph_progressive *progressive, uint32_t level, float *normals,
                                                  float *attributes, uint32_t *vertex_sources,
                                                  uint32_t *triangle_sources);

/**
 * @brief A cursor over the points of the levels: sph_cursor_move() takes a point count, sph_cursor_read() gives points
 * and their triangles, without the seams. The progressive mesh must outlive it.
 * @param[out] out  owned by the caller, sph_cursor_destroy() it; NULL on failure.
 * @retval SPH_E_INVALID, SPH_E_NOMEM
 * @par Cost  O(n) once.
 * @since 0.1
 */
SPH_API sph_status sph_progressive_create_cursor(const sph_progressive *progressive, sph_cursor **out);

/** @brief Places that the vertices of the input share: points 0 to this - 1 are theirs, the others are those of
 * collapses, in their order; 0 for NULL. @since 0.1 */
SPH_API uint32_t sph_progressive_point_count(const sph_progressive *progressive);
/** @brief k: slots of a point's bones and weights; 0 for NULL. @since 0.1 */
SPH_API uint32_t sph_progressive_influence_count(const sph_progressive *progressive);
/** @brief C: numbers per vertex in the attributes, which size those of sph_progressive_get_attributes(); 0 for NULL.
 *  @since 0.1 */
SPH_API uint32_t sph_progressive_attribute_count(const sph_progressive *progressive);

/**
 * @brief A point of any level.
 * @param[in]  point    below the point count + C.
 * @param[out] rest     shape (3); may be NULL.
 * @param[out] bones    sph_progressive_influence_count() numbers, as in sph_skin_arrays; may be NULL.
 * @param[out] weights  as many; may be NULL.
 * @retval SPH_E_INVALID  NULL handle, or no such point.
 * @since 0.1
 */
SPH_API sph_status sph_progressive_point(const sph_progressive *progressive, uint32_t point, float rest[3],
                                         uint32_t *bones, float *weights);

SPH_END_DECLS

#endif
