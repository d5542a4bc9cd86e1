/* SPDX-License-Identifier: MIT */
/**
 * @file surface.h
 * @brief The outer surface of a level as a triangle mesh, frame by frame.
 *
 * The solid of a level is the union, over its simplices, of the spheres interpolated over them; its signed distance is
 * \f[ d(x) = \min_{\sigma} \min_{b \in \Delta_\sigma} |x - c(b)| - r(b), \quad c(b) = \sum b_i c_i,\; r(b) = \sum b_i
 * r_i \f] (Thiery et al. 2016, section 2, where the surface is extracted with marching cubes). Here d is sampled on a
 * body-centred cubic lattice near d = 0; the points that are joined to infinity by free points are outside, whatever
 * else is inside, so that cavities are no part of the surface; and marching tetrahedra on that lattice give a mesh. Its
 * vertices are the exact first hits of lattice edges with the solid, cast from outside.
 *
 * What is promised: every edge belongs to exactly two triangles, which run through it in opposite directions; the
 * triangles around a vertex form one cycle; triangles face outward. Before positions are rounded to float each triangle
 * lies within a tetrahedron of its own, so that none crosses another.
 *
 * What a resolution cannot show: radii below #SPH_SURFACE_LEAST_RADIUS cells count as that, so that sheets, wires and
 * points of no thickness have a volume, separate what they separate, and are meshed on both sides. Gaps of about a cell
 * may be closed, and then what lies behind them is a cavity.
 */
#ifndef SPHMESH_SURFACE_H
#define SPHMESH_SURFACE_H

#include "level.h"

SPH_BEGIN_DECLS

/** Handle: the outer surface of a level, of one frame or several. It stands alone. */
typedef struct sph_surface sph_surface;

/**
 * The least radius of a sphere, in cells. No point is farther than sqrt(5)/4 = 0.559 cells from the lattice, and the
 * points nearest to a curve or a sheet are joined: so nothing vanishes, falls apart or leaks.
 */
#define SPH_SURFACE_LEAST_RADIUS 0.56

/** Options of the extraction. Fill with sph_surface_options_init() first. */
typedef struct sph_surface_options {
    uint32_t struct_size; /**< bytes the caller knows of; written by the initialiser */
    uint32_t flags;       /**< must be 0 */
    uint32_t resolution;  /**< cells along the longest side of the bounding box, the largest of all frames of the level,
                             so  that cells are the same in all frames; from 1 to 4096; default 128 */
    uint32_t first_frame; /**< default 0 */
    uint32_t frame_step;  /**< default 1; > 0 */
    uint32_t frame_limit; /**< at most so many frames; 0 (default): all */
    uint64_t memory_limit; /**< bytes that the call may hold at once, its result included; default 2^30 */
} sph_surface_options;

/** @brief Fills `options` with the defaults. Call as `sph_surface_options_init(&o, sizeof o)`. @since 0.1 */
SPH_API void sph_surface_options_init(sph_surface_options *options, size_t size);

/**
 * @brief Extracts the outer surface of a level. The mesh of a frame does not depend on which other frames are
 * extracted.
 * @param[in]  options  may be NULL: all defaults.
 * @param[out] out      owned by the caller; NULL on failure.
 * @retval SPH_E_INVALID    NULL or bad options.
 * @retval SPH_E_LIMIT      more memory than `memory_limit` would be needed, or the level is too large for float.
 * @retval SPH_E_NOMEM      out of memory.
 * @retval SPH_E_CANCELLED  progress asked to stop.
 * @par Determinism  Same bits whatever the executor and threads.
 * @par Cost  Per frame O(resolution^2) casts, about a microsecond each; memory about 150 bytes per vertex.
 * @since 0.1
 */
SPH_API sph_status sph_surface_create(const sph_level *level, const sph_surface_options *options, sph_surface **out);

/** @brief Destroys a surface. NULL is fine. @since 0.1 */
SPH_API void sph_surface_destroy(sph_surface *surface);

/** @brief Frames that were extracted, or 0 for NULL. @since 0.1 */
SPH_API uint32_t sph_surface_frame_count(const sph_surface *surface);
/** @brief Side of a cell in model units, or 0 for NULL. @since 0.1 */
SPH_API double sph_surface_cell(const sph_surface *surface);

/**
 * @name The mesh of extracted frame `index` (0 is the first that was extracted)
 * Arrays are borrowed until the surface is destroyed. 0 or NULL for NULL and for an index out of range.
 */
/**@{*/
/** @brief Vertices. @since 0.1 */
SPH_API uint32_t sph_surface_vertex_count(const sph_surface *surface, uint32_t index);
/** @brief Triangles. @since 0.1 */
SPH_API size_t sph_surface_triangle_count(const sph_surface *surface, uint32_t index);
/** @brief Shape (vertex_count, 3), model units. @since 0.1 */
SPH_API const float *sph_surface_positions(const sph_surface *surface, uint32_t index);
/** @brief Shape (vertex_count, 3): unit, the solid's own outward normals at the vertices. @since 0.1 */
SPH_API const float *sph_surface_normals(const sph_surface *surface, uint32_t index);
/** @brief Shape (triangle_count, 3), vertex indices; counter-clockwise from outside. @since 0.1 */
SPH_API const uint32_t *sph_surface_triangles(const sph_surface *surface, uint32_t index);
/**@}*/

SPH_END_DECLS

#endif
