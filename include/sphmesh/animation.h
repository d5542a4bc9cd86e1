/* SPDX-License-Identifier: MIT */
/**
 * @file animation.h
 * @brief An animated mesh: F frames of n vertex positions with one connectivity of triangles and edges.
 *
 * All positions are `float` x, y, z in model units. Indices are `uint32_t` and start at 0.
 */
#ifndef SPHMESH_ANIMATION_H
#define SPHMESH_ANIMATION_H

#include "context.h"

SPH_BEGIN_DECLS

/** Handle: an animated mesh. */
typedef struct sph_animation sph_animation;

/**
 * Where the frames of an animation come from, when the library should pull them rather than be given them: a memory-mapped
 * cache, a network stream, a host application. Copied into the animation. The functions are called on the thread that made
 * the library call and never two at once for one animation.
 */
typedef struct sph_frame_source {
    void *user; /**< passed back */
    /**
     * Writes the n positions of frame `frame` tightly to `xyz` (3 n floats). Returns #SPH_OK, or a status that the library
     * call then returns.
     */
    sph_status (*read_frame)(void *user, uint32_t frame, float *xyz);
    /** May be NULL. Called once with `user` when the animation is destroyed, and also when its creation fails. */
    void (*destroy)(void *user);
} sph_frame_source;

/**
 * @brief Makes an animation that holds its own positions, all zero until sph_animation_set_frame().
 * @param[in]  vertex_count  n, from 1 to 2^31 - 1.
 * @param[in]  frame_count   F, from 1 to 2^31 - 1.
 * @param[out] out           owned by the caller; NULL on failure.
 * @retval SPH_E_INVALID  `context` or `out` is NULL, or a count is out of range.
 * @retval SPH_E_NOMEM    12 n F bytes could not be had.
 * @since 0.1
 */
SPH_API sph_status sph_animation_create(sph_context *context, uint32_t vertex_count, uint32_t frame_count,
                                        sph_animation **out);

/**
 * @brief Makes an animation whose frames are pulled from `source` each time they are needed; nothing is read yet.
 * @retval SPH_E_INVALID  as sph_animation_create(), or `source` or its `read_frame` is NULL.
 * @retval SPH_E_NOMEM    out of memory.
 * @since 0.1
 */
SPH_API sph_status sph_animation_create_from_source(sph_context *context, uint32_t vertex_count, uint32_t frame_count,
                                                    const sph_frame_source *source, sph_animation **out);

/**
 * @brief Makes an animation on positions that the caller keeps: nothing is copied. For hosts that have all frames in memory.
 * @param[in] positions     x of vertex 0 in frame 0, aligned as a float; vertex i of frame f starts
 *                          `f * frame_stride + i * stride` bytes later. Borrowed until the animation is destroyed: it must
 *                          stay, and must not change during a call that reads it.
 * @param[in] stride        bytes from one vertex to the next, at least 12 and a multiple of 4; 0 means 12. With 12 no frame is
 *                          ever copied; with more, the frame that is read is.
 * @param[in] frame_stride  bytes from one frame to the next, a multiple of 4; 0 means n * stride. It may be smaller than a
 *                          frame: frames may overlap.
 * @retval SPH_E_INVALID  as sph_animation_create(); also NULL or misaligned positions, or a stride out of range.
 * @retval SPH_E_NOMEM    out of memory, which means that of the handle.
 * @par Thread safety  The functions that take a `const` animation, from any number of threads.
 * @since 0.1
 */
SPH_API sph_status sph_animation_create_from_positions(sph_context *context, uint32_t vertex_count, uint32_t frame_count,
                                                       const float *positions, size_t stride, size_t frame_stride,
                                                       sph_animation **out);

/** @brief Destroys an animation. NULL is fine. Handles made from it do not need it any more. @since 0.1 */
SPH_API void sph_animation_destroy(sph_animation *animation);

/**
 * @brief Copies the positions of one frame into the animation.
 * @param[in] frame   below F.
 * @param[in] xyz     first vertex's x; vertex i starts `i * stride` bytes later; read only.
 * @param[in] stride  bytes from one vertex to the next, at least 12; 0 means 12 (tight).
 * @retval SPH_E_INVALID  NULL, or `frame` or `stride` out of range. Values are not checked here but by
 *                        sph_animation_check() and by every call that uses them.
 * @retval SPH_E_STATE    the animation pulls its frames from a source, or stands on positions of the caller's.
 * @since 0.1
 */
SPH_API sph_status sph_animation_set_frame(sph_animation *animation, uint32_t frame, const float *xyz, size_t stride);

/**
 * @brief Sets the triangles; what was set before is dropped.
 * @param[in] indices         3 * triangle_count vertex indices, triangle i starting `i * stride` bytes after the first.
 * @param[in] stride          bytes from one triangle to the next, at least 12; 0 means 12.
 * @retval SPH_E_INVALID  NULL with a count above 0, `stride` out of range, or an index that is not below n (the message
 *                        names the triangle). Triangles that repeat a vertex or each other are accepted: see
 *                        sph_animation_check().
 * @retval SPH_E_LIMIT    more than 2^31 - 1 triangles.
 * @retval SPH_E_NOMEM    out of memory. After any failure what was set before stays.
 * @since 0.1
 */
SPH_API sph_status sph_animation_set_triangles(sph_animation *animation, const uint32_t *indices,
                                               size_t triangle_count, size_t stride);

/**
 * @brief Sets additional edges ("wire" edges, that need not belong to a triangle); what was set before is dropped.
 * @param[in] indices  2 * edge_count vertex indices, edge i starting `i * stride` bytes after the first.
 * @param[in] stride   bytes from one edge to the next, at least 8; 0 means 8.
 * @retval SPH_E_INVALID, SPH_E_LIMIT, SPH_E_NOMEM  as sph_animation_set_triangles().
 * @since 0.1
 */
SPH_API sph_status sph_animation_set_edges(sph_animation *animation, const uint32_t *indices, size_t edge_count,
                                           size_t stride);

/** @brief n, or 0 for NULL. @since 0.1 */
SPH_API uint32_t sph_animation_vertex_count(const sph_animation *animation);
/** @brief F, or 0 for NULL. @since 0.1 */
SPH_API uint32_t sph_animation_frame_count(const sph_animation *animation);
/** @brief Number of triangles, or 0 for NULL. @since 0.1 */
SPH_API size_t sph_animation_triangle_count(const sph_animation *animation);
/** @brief Number of additional edges, or 0 for NULL. @since 0.1 */
SPH_API size_t sph_animation_edge_count(const sph_animation *animation);
/** @brief The triangles, 3 indices each, borrowed until they are set anew; NULL where there are none. @since 0.1 */
SPH_API const uint32_t *sph_animation_triangles(const sph_animation *animation);
/** @brief The additional edges, 2 indices each, borrowed until they are set anew; NULL where there are none. @since 0.1 */
SPH_API const uint32_t *sph_animation_edges(const sph_animation *animation);

/**
 * @brief Copies the positions of one frame out.
 * @param[out] xyz  3 n floats, tight. Undefined content on failure.
 * @retval SPH_E_INVALID  NULL or `frame` out of range.
 * @return otherwise what the frame source returned.
 * @par Thread safety  Any number of threads for an animation that holds its positions; one at a time for one with a source.
 * @since 0.1
 */
SPH_API sph_status sph_animation_read_frame(const sph_animation *animation, uint32_t frame, float *xyz);

/**
 * @brief Mean over all frames of the diagonal of the axis-aligned bounding box (BBD in the paper).
 * @param[out] diagonal  model units; untouched on failure.
 * @retval SPH_E_INVALID  NULL, or a coordinate is not finite (the message names frame and vertex).
 * @retval SPH_E_NOMEM    out of memory.
 * @return otherwise what the frame source returned.
 * @par Cost  One pass over all frames.
 * @since 0.1
 */
SPH_API sph_status sph_animation_bounding_diagonal(const sph_animation *animation, double *diagonal);

/**
 * What sph_animation_check() found. Counts are exact; indices name the first case, frames before triangles and vertices. Fill
 * `struct_size` by the initialiser.
 *
 * Triangles and edges that name a vertex twice are counted as such. For all that concerns connectivity a triangle that names
 * two vertices is then the edge between them, which is a wire edge unless a triangle has it; one that names a single vertex,
 * and such an edge, is nothing. Duplicate triangles are triangles: each counts for its edges.
 *
 * For `inward_component_count` components are joined by triangles alone, and closed and consistently wound means that every
 * edge has as many triangles in one direction as in the other. Vertices that are not finite in a frame coincide with none,
 * have no part in the frame's diagonal, and give their triangles no area to compare and their component no volume in that
 * frame.
 */
typedef struct sph_animation_report {
    uint32_t struct_size;              /**< bytes the caller knows of */
    uint32_t reserved0;                /**< 0 */
    uint64_t non_finite_count;         /**< coordinates triples with a NaN or an infinity, over all frames */
    uint32_t first_non_finite_frame;   /**< valid where the count is above 0 */
    uint32_t first_non_finite_vertex;  /**< valid where the count is above 0 */
    uint64_t repeated_index_count;     /**< triangles and edges that name one vertex twice */
    uint64_t first_repeated_index;     /**< index of the first such triangle; of the first such edge plus the triangle count */
    uint64_t duplicate_triangle_count; /**< triangles beyond the first with the same three vertices, in any order */
    uint64_t zero_area_count;          /**< (triangle, frame) pairs of no area: at most 1e-12 times the squared diagonal of the
                                            frame; with those that name a vertex twice */
    uint32_t first_zero_area_frame;    /**< valid where the count is above 0 */
    uint32_t first_zero_area_triangle; /**< valid where the count is above 0 */
    uint64_t boundary_edge_count;      /**< edges of exactly one triangle */
    uint64_t non_manifold_edge_count;  /**< edges of three or more triangles */
    uint64_t inconsistent_edge_count;  /**< edges of two triangles that run along it in the same direction */
    uint64_t wire_edge_count;          /**< different edges of no triangle */
    uint64_t component_count;          /**< connected components, isolated vertices included */
    uint64_t isolated_vertex_count;    /**< vertices of no triangle and no edge to another */
    uint64_t coincident_vertex_count;  /**< vertices that coincide in all frames with one of lower index: what welding would remove */
    uint64_t inward_component_count;   /**< closed, consistently wound components whose signed volume, summed over frames, is
                                            negative beyond rounding: below -1e-12 of the sum of its parts */
} sph_animation_report;

/** @brief Zeroes a report and sets its size. Call as `sph_animation_report_init(&r, sizeof r)`. @since 0.1 */
SPH_API void sph_animation_report_init(sph_animation_report *report, size_t size);

/**
 * @brief Looks for everything that tends to be wrong with input. Finding something is not a failure.
 * @param[in,out] report  initialised by the caller; untouched on failure.
 * @retval SPH_E_INVALID    NULL, or a report that was not initialised.
 * @retval SPH_E_NOMEM      out of memory.
 * @retval SPH_E_CANCELLED  progress asked to stop.
 * @return otherwise what the frame source returned.
 * @par Cost  One pass over all frames, O(F (n + m)) time, n log n instead of n in frames that tell coincident vertices
 *            apart; O(n + m) memory.
 * @since 0.1
 */
SPH_API sph_status sph_animation_check(const sph_animation *animation, sph_animation_report *report);

/**
 * @brief Makes a new animation in which vertices that coincide in all frames are one.
 *
 * Two vertices are welded when their positions are equal in every frame (tolerance 0), or differ by no more than
 * `tolerance` in every coordinate of every frame from the vertex of lowest index of their group: in order of their index,
 * vertices join the first group whose lowest vertex is that close, or begin one. A group has the position of its lowest
 * vertex. Triangles and edges that come to name one vertex twice are dropped, duplicates are not. Kept vertices stay in their
 * order, and so do triangles and edges.
 * @param[in]  tolerance  model units, >= 0 and finite.
 * @param[out] map        n entries: the new index of every old vertex; may be NULL; untouched on failure.
 * @param[out] out        owned by the caller; holds its own positions; NULL on failure.
 * @retval SPH_E_INVALID    NULL, bad tolerance, or a coordinate is not finite (the message names frame and vertex).
 * @retval SPH_E_NOMEM      out of memory.
 * @retval SPH_E_CANCELLED  progress asked to stop.
 * @return otherwise what the frame source returned.
 * @par Cost  Tolerance 0: two passes over the frames, at worst O(F n log n) time, O(n) memory beside the result. Above 0: two
 *            passes more, and memory for all frames of the vertices that only a comparison in pairs can tell apart.
 * @since 0.1
 */
SPH_API sph_status sph_animation_weld(const sph_animation *animation, float tolerance, uint32_t *map,
                                      sph_animation **out);

SPH_END_DECLS

#endif
