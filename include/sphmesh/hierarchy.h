/* SPDX-License-Identifier: MIT */
/**
 * @file hierarchy.h
 * @brief The hierarchy of animated sphere-meshes of one animated mesh, and a cursor that walks it.
 *
 * Nodes 0 to n - 1 are the input vertices; collapse t (from 0) unites two nodes into node n + t. A hierarchy of C
 * collapses ends with n - C spheres, one per connected component. Source: Thiery et al. 2016, sections 2 to 4.
 */
#ifndef SPHMESH_HIERARCHY_H
#define SPHMESH_HIERARCHY_H

#include "animation.h"

SPH_BEGIN_DECLS

/** Handle: a hierarchy; it holds a copy of everything it needs and never changes once it is made. */
typedef struct sph_hierarchy sph_hierarchy;

/** How planes are weighted beyond their area. */
enum {
    SPH_IMPORTANCE_NONE = 0,      /**< by area alone */
    SPH_IMPORTANCE_CURVATURE = 1, /**< by area, and vertices of positive curvature by that besides, so that
                                       sharp tips count (docs/importance.md); default */
    SPH_IMPORTANCE_CALLER = 2     /**< area times the caller's own weights */
};

/** What the radius of a sphere may do. */
enum {
    SPH_RADIUS_CONSTANT = 0,  /**< one radius for all frames; default */
    SPH_RADIUS_PER_FRAME = 1, /**< each frame has its own (Fig. 5) */
    SPH_RADIUS_ZERO = 2       /**< points instead of spheres: plain animated quadric error metrics (QEM) */
};

/** Which side of the triangles is outside. */
enum {
    SPH_ORIENTATION_OUTWARD = 0, /**< components whose signed volume, summed over frames, is negative count as wound the
                                      other way round; default */
    SPH_ORIENTATION_AS_GIVEN = 1 /**< as the triangles are wound (counter-clockwise seen from outside) */
};

/** Options of sph_hierarchy_create(). Fill with sph_hierarchy_options_init() first. */
typedef struct sph_hierarchy_options {
    uint32_t struct_size;             /**< bytes the caller knows of; written by the initialiser */
    uint32_t flags;                   /**< must be 0 */
    int32_t importance;               /**< one of SPH_IMPORTANCE_*; default curvature */
    int32_t radius_mode;              /**< one of SPH_RADIUS_*; default constant */
    double radius_factor;             /**< rho, radius bound = rho * width of the region; >= 0; default 3/4 */
    double temporal_coherence;        /**< delta of Eq. 11-12; >= 0, dimensionless; default 0: none */
    uint32_t width_directions;        /**< directions the width is taken over, 3 to 1024; default 30 */
    int32_t orientation;              /**< one of SPH_ORIENTATION_*; default outward */
    const float *importance_weights;  /**< for SPH_IMPORTANCE_CALLER: weight of vertex i in frame f at element f * importance_frame_stride + i; finite, >= 0 */
    size_t importance_frame_stride;   /**< elements; 0: the same n weights serve all frames */
} sph_hierarchy_options;

/** @brief Fills `options` with the defaults. Call as `sph_hierarchy_options_init(&o, sizeof o)`. @since 0.1 */
SPH_API void sph_hierarchy_options_init(sph_hierarchy_options *options, size_t size);

/** One collapse. */
typedef struct sph_collapse {
    uint32_t u;         /**< the first of the nodes united */
    uint32_t v;         /**< the second; u < v */
    uint32_t node;      /**< the node made: n + the collapse's index */
    uint32_t forced;    /**< 1 where it inverts triangles: taken because nothing else was left; else 0 */
    double cost;        /**< the quadric of the region at its sphere, model units squared times weight */
    double error;       /**< root mean square distance, by weight, between the spheres of the level after this collapse
                             and the tangent planes of their regions, all frames; made not to fall; model units */
} sph_collapse;

/**
 * @brief Builds the hierarchy: collapses edges by increasing cost until one sphere is left per connected component.
 *
 * Accepts any finite input: non-manifold, open, wire edges, several components, coincident vertices, zero-area triangles.
 * @param[in]  animation  read during the call only.
 * @param[in]  options    may be NULL: all defaults.
 * @param[out] out        owned by the caller; NULL on failure.
 * @retval SPH_E_INVALID    NULL, bad options, a coordinate or weight that is not finite or too large to square in 32 bits
 *                          (the message names frame and vertex), or vertex_count > 2^30.
 * @retval SPH_E_NOMEM      out of memory.
 * @retval SPH_E_CANCELLED  progress asked to stop.
 * @return otherwise what the frame source returned.
 * @par Determinism  Same bits for the same input and options, whatever the executor, threads and processor.
 * @par Cost  O(F (n + m) log n) time where vertices have few neighbours; one with k of them may cost O(F k^2).
 * @since 0.1
 */
SPH_API sph_status sph_hierarchy_create(const sph_animation *animation, const sph_hierarchy_options *options,
                                        sph_hierarchy **out);

/** @brief Destroys a hierarchy. NULL is fine. Cursors must go first; levels may stay. @since 0.1 */
SPH_API void sph_hierarchy_destroy(sph_hierarchy *hierarchy);

/** @brief n: vertices of the input, spheres of the finest level; 0 for NULL. @since 0.1 */
SPH_API uint32_t sph_hierarchy_vertex_count(const sph_hierarchy *hierarchy);
/** @brief F, or 0 for NULL. @since 0.1 */
SPH_API uint32_t sph_hierarchy_frame_count(const sph_hierarchy *hierarchy);
/** @brief Number of collapses C, or 0 for NULL; the coarsest level has n - C spheres. @since 0.1 */
SPH_API uint32_t sph_hierarchy_collapse_count(const sph_hierarchy *hierarchy);
/** @brief Mean over frames of the input's bounding-box diagonal, model units; 0 for NULL. @since 0.1 */
SPH_API double sph_hierarchy_bounding_diagonal(const sph_hierarchy *hierarchy);
/** @brief Edge costs evaluated while building; 0 for NULL and for a hierarchy that was loaded. @since 0.1 */
SPH_API uint64_t sph_hierarchy_evaluation_count(const sph_hierarchy *hierarchy);
/** @brief Index of the first forced collapse (see sph_collapse), or C where there was none. @since 0.1 */
SPH_API uint32_t sph_hierarchy_first_forced(const sph_hierarchy *hierarchy);

/**
 * @brief Tells of collapse `index`.
 * @param[out] collapse  untouched on failure.
 * @retval SPH_E_INVALID  NULL or `index` not below the collapse count.
 * @since 0.1
 */
SPH_API sph_status sph_hierarchy_collapse(const sph_hierarchy *hierarchy, uint32_t index, sph_collapse *collapse);

/**
 * @brief Tells of many collapses at once: of `count` of them, from `first` on.
 * @param[out] collapses  `count` entries; untouched on failure; may be NULL where `count` is 0.
 * @retval SPH_E_INVALID  NULL, or `first + count` is above the collapse count.
 * @par Cost  O(count).
 * @since 0.1
 */
SPH_API sph_status sph_hierarchy_read_collapses(const sph_hierarchy *hierarchy, uint32_t first, uint32_t count,
                                                sph_collapse *collapses);

/**
 * @brief Sphere of a node, all frames.
 * @param[in]  node     below n + C.
 * @param[out] centers  shape (F, 3), model units; may be NULL.
 * @param[out] radii    shape (F): the same value F times unless radii are per frame; may be NULL.
 * @retval SPH_E_INVALID  NULL handle or `node` out of range.
 * @since 0.1
 */
SPH_API sph_status sph_hierarchy_sphere(const sph_hierarchy *hierarchy, uint32_t node, float *centers, float *radii);

/**
 * @brief Number of spheres of the coarsest level whose error (see sph_collapse) is at most `max_error`.
 * @param[in]  max_error     model units, >= 0.
 * @param[out] sphere_count  untouched on failure.
 * @retval SPH_E_INVALID  NULL, negative or NaN.
 * @par Cost  O(log n).
 * @since 0.1
 */
SPH_API sph_status sph_hierarchy_count_for_error(const sph_hierarchy *hierarchy, double max_error,
                                                 uint32_t *sphere_count);

/** Takes the bytes of a serialised handle, in order. Return #SPH_OK, or a status that the call then returns. */
typedef sph_status sph_write_fn(void *user, const void *bytes, size_t size);

/**
 * @brief Writes the hierarchy as a `.sphm` container (docs/formats.md) through `write`.
 * @retval SPH_E_INVALID  NULL.
 * @retval SPH_E_NOMEM    out of memory.
 * @return otherwise what `write` returned.
 * @since 0.1
 */
SPH_API sph_status sph_hierarchy_write(const sph_hierarchy *hierarchy, sph_write_fn *write, void *user);

/**
 * @brief Makes a hierarchy from the bytes of a `.sphm` container. Safe for untrusted input: everything is checked.
 * @param[in]  bytes  any alignment; read during the call only.
 * @param[out] out    owned by the caller; NULL on failure.
 * @retval SPH_E_INVALID  NULL.
 * @retval SPH_E_FORMAT   not such a container, damaged, or not a hierarchy (the message names the byte).
 * @retval SPH_E_VERSION  of a newer major version.
 * @retval SPH_E_NOMEM    out of memory.
 * @since 0.1
 */
SPH_API sph_status sph_hierarchy_read(sph_context *context, const void *bytes, size_t size, sph_hierarchy **out);

/** Handle: a place in a hierarchy, which moves in time proportional to what changes. */
typedef struct sph_cursor sph_cursor;

/**
 * @brief Makes a cursor at the finest level (n spheres). The hierarchy must outlive it.
 * @param[out] out  owned by the caller; NULL on failure.
 * @retval SPH_E_INVALID, SPH_E_NOMEM
 * @par Thread safety  Distinct cursors on one hierarchy may be used from distinct threads.
 * @par Cost  O(n) once.
 * @since 0.1
 */
SPH_API sph_status sph_cursor_create(const sph_hierarchy *hierarchy, sph_cursor **out);

/** @brief Destroys a cursor. NULL is fine. @since 0.1 */
SPH_API void sph_cursor_destroy(sph_cursor *cursor);

/**
 * @brief Moves to the level of `sphere_count` spheres, collapse by collapse.
 * @retval SPH_E_INVALID  NULL, or a count that is not from n - C to n.
 * @par Cost  Proportional to the simplices that change on the way; no allocation.
 * @since 0.1
 */
SPH_API sph_status sph_cursor_move(sph_cursor *cursor, uint32_t sphere_count);

/** @brief Spheres of the level where the cursor is; 0 for NULL. @since 0.1 */
SPH_API uint32_t sph_cursor_sphere_count(const sph_cursor *cursor);
/** @brief Wire edges (of no triangle) of the level where the cursor is; 0 for NULL. @since 0.1 */
SPH_API size_t sph_cursor_edge_count(const sph_cursor *cursor);
/** @brief Triangles of the level where the cursor is; 0 for NULL. @since 0.1 */
SPH_API size_t sph_cursor_triangle_count(const sph_cursor *cursor);

/**
 * @brief Copies the level's nodes, wire edges and triangles out, as node numbers.
 * @param[out] nodes      sphere count entries, ascending; may be NULL.
 * @param[out] edges      2 * edge count entries, the smaller first, edges ascending; may be NULL.
 * @param[out] triangles  3 * triangle count entries, each wound as in the input but starting with its smallest, in
 *                        ascending order; may be NULL.
 * @retval SPH_E_INVALID  NULL cursor.
 * @retval SPH_E_NOMEM    out of memory.
 * @since 0.1
 */
SPH_API sph_status sph_cursor_read(const sph_cursor *cursor, uint32_t *nodes, uint32_t *edges, uint32_t *triangles);

SPH_END_DECLS

#endif
