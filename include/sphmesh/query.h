/* SPDX-License-Identifier: MIT */
/**
 * @file query.h
 * @brief What a posed level can be asked: casts of moving spheres and rays, distances, containment, contact of two levels.
 *
 * The solid is the union of the spheres interpolated over the level's simplices: a sphere, a tapered capsule along a wire
 * edge, a thick triangle. Every degenerate case (coincident or collinear centres, radii of 0, a sphere within another, a
 * simplex that names a sphere twice) is input and answers as the limit of the regular one. What is exact where:
 * docs/queries.md. Source: Thiery et al. 2016, section 6.1 and appendix B.
 */
#ifndef SPHMESH_QUERY_H
#define SPHMESH_QUERY_H

#include "level.h"

SPH_BEGIN_DECLS

/** Handle: a level in one pose, ready for queries. It stands alone: the level may go. */
typedef struct sph_query sph_query;

/** How the simplices are searched. The answers are the same, bit for bit. */
enum {
    SPH_SEARCH_AUTO = 0,       /**< by the number of simplices; default */
    SPH_SEARCH_EXHAUSTIVE = 1, /**< all bounds, vectorised */
    SPH_SEARCH_TREE = 2        /**< a tree of bounds, which is refitted to each pose, not rebuilt */
};

/** Options of sph_query_create(). Fill with sph_query_options_init() first. */
typedef struct sph_query_options {
    uint32_t struct_size; /**< bytes the caller knows of; written by the initialiser */
    uint32_t flags;       /**< must be 0 */
    int32_t search;       /**< one of SPH_SEARCH_*; default auto */
    uint32_t reserved0;   /**< must be 0 */
} sph_query_options;

/** @brief Fills `options` with the defaults. Call as `sph_query_options_init(&o, sizeof o)`. @since 0.1 */
SPH_API void sph_query_options_init(sph_query_options *options, size_t size);

/**
 * @brief Makes a query handle, posed at frame 0.
 * @param[in]  level    copied: later changes of it do not show.
 * @param[in]  options  may be NULL: all defaults.
 * @param[out] out      owned by the caller; NULL on failure.
 * @retval SPH_E_INVALID  NULL or bad options.
 * @retval SPH_E_LIMIT    more than 2^28 spheres or simplices.
 * @retval SPH_E_NOMEM    out of memory.
 * @par Thread safety  The functions that take a `const` handle may run on any number of threads; those that pose it on
 *                     one, while nothing else uses it.
 * @par Cost  O(F K) to copy, O(simplices log simplices) once.
 * @since 0.1
 */
SPH_API sph_status sph_query_create(const sph_level *level, const sph_query_options *options, sph_query **out);

/** @brief Destroys a query handle. NULL is fine. @since 0.1 */
SPH_API void sph_query_destroy(sph_query *query);

/**
 * @brief Poses the level as in a frame.
 * @retval SPH_E_INVALID  NULL, or `frame` is not below the frame count. The pose stays what it was.
 * @par Cost  O(simplices): about 0.1 microseconds each. No allocation.
 * @since 0.1
 */
SPH_API sph_status sph_query_pose_frame(sph_query *query, uint32_t frame);

/**
 * @brief Poses the level between frames: centres (and radii, where they vary) interpolated linearly.
 * @param[in] frame  from 0 to F - 1; 2.25 is a quarter of the way from frame 2 to frame 3.
 * @retval SPH_E_INVALID  NULL, or `frame` is out of range or NaN. The pose stays what it was.
 * @par Cost  As sph_query_pose_frame().
 * @since 0.1
 */
SPH_API sph_status sph_query_pose_time(sph_query *query, double frame);

/**
 * @brief Poses the level on centres of the caller's: an animation that the library need not know.
 * @param[in] centers  K centres, finite, model units; read during the call only.
 * @param[in] stride   bytes from one centre to the next, at least 12; 0 means 12.
 * @param[in] radii    shape (K), finite, >= 0; NULL: the level's, which must then not vary per frame.
 * @retval SPH_E_INVALID  NULL, a bad stride, or a value out of range (the message names the sphere). The pose stays.
 * @par Cost  As sph_query_pose_frame().
 * @since 0.1
 */
SPH_API sph_status sph_query_pose_centers(sph_query *query, const float *centers, size_t stride, const float *radii);

/** What kind of simplex, and in which list its number counts. */
enum {
    SPH_SIMPLEX_NONE = 0,     /**< no contact */
    SPH_SIMPLEX_SPHERE = 1,   /**< a sphere of no edge; its number */
    SPH_SIMPLEX_EDGE = 2,     /**< an entry of `edges` of sph_level_arrays */
    SPH_SIMPLEX_TRIANGLE = 3  /**< an entry of `triangles` of sph_level_arrays */
};

/** Where on the solid. Of simplices listed more than once the first is named. */
typedef struct sph_contact {
    double point[3];     /**< on the boundary of the simplex, model units */
    double normal[3];    /**< unit, outward; where it is not unique (on a skeleton), one of the possible ones */
    double weights[3];   /**< barycentric: the interpolated sphere that touches there is sum weights[k] * spheres[k];
                              >= 0, sum 1 */
    uint32_t spheres[3]; /**< of the simplex, in the order in which the level lists them; #SPH_NO_SPHERE beyond */
    uint32_t simplex;    /**< number in the list that `kind` names */
    uint32_t kind;       /**< one of SPH_SIMPLEX_* */
    uint32_t reserved0;  /**< 0 */
} sph_contact;

/** A sphere on its way from one point to another. A radius of 0 makes it a ray, equal ends a test in place. */
typedef struct sph_sweep {
    float from[3];      /**< finite, model units */
    float to[3];        /**< finite */
    float radius;       /**< finite, >= 0 */
    uint32_t reserved0; /**< not looked at */
} sph_sweep;

/** Answer to a sweep. Without a hit: s = 1, everything else 0, `spheres` #SPH_NO_SPHERE. */
typedef struct sph_hit {
    double s;            /**< the moving centre touches at from + s * (to - from); 0 to 1 */
    double depth;        /**< >= 0; above 0 the sphere starts inside, so deep in the simplex that it is deepest in: moving
                              out of the union may take a longer way (s is 0 then) */
    uint32_t hit;        /**< 1 or 0 */
    uint32_t reserved0;  /**< 0 */
    sph_contact contact; /**< on the solid, not on the moving sphere */
} sph_hit;

/**
 * @brief First contacts of moving spheres with the solid: the earliest over all simplices, of equally early ones that
 *        with the lowest number; of those a sphere starts in, the deepest.
 * @param[in]  sweeps  `count` of them.
 * @param[out] hits    `count` answers; untouched on failure.
 * @retval SPH_E_INVALID  NULL with a count above 0, or a sweep that is not finite or has a radius below 0 (the message
 *                        names it).
 * @par Determinism  Same bits for any way of searching, any size of batch and any processor.
 * @par Cost  With tens of simplices below a microsecond each, less in batches of 8 or more. No allocation; below 32 kB of stack.
 * @since 0.1
 */
SPH_API sph_status sph_query_cast(const sph_query *query, const sph_sweep *sweeps, size_t count, sph_hit *hits);

/**
 * @brief Whether moving spheres touch the solid at all: stops at the first simplex found. Arguments as sph_query_cast().
 * @param[out] hits  `count` values, 1 or 0.
 * @since 0.1
 */
SPH_API sph_status sph_query_cast_any(const sph_query *query, const sph_sweep *sweeps, size_t count, uint8_t *hits);

/** The nearest place of the solid. */
typedef struct sph_nearest {
    double distance;     /**< signed: the least over all simplices of the distance to the interpolated sphere. Outside that
                              is the distance to the solid. Inside it is minus the depth in the deepest simplex: the
                              way out of the union is at least as long */
    sph_contact contact; /**< on the boundary of that simplex */
} sph_nearest;

/**
 * @brief Signed distances of points to the solid, and the nearest places.
 * @param[in]  points   `count` points, finite, model units.
 * @param[in]  stride   bytes from one point to the next, at least 12; 0 means 12.
 * @param[out] nearest  `count` answers; untouched on failure.
 * @retval SPH_E_INVALID  NULL with a count above 0, a bad stride, or a point that is not finite (the message names it).
 * @par Cost  With tens of simplices below a microsecond each. No allocation.
 * @since 0.1
 */
SPH_API sph_status sph_query_nearest(const sph_query *query, const float *points, size_t stride, size_t count,
                                     sph_nearest *nearest);

/** What a cavity - a space that is not connected to infinity - counts as. */
enum {
    SPH_CAVITY_SOLID = 0, /**< inside the character is inside; the usual choice for collisions */
    SPH_CAVITY_SPACE = 1  /**< only what the spheres fill is inside */
};

/**
 * @brief Whether points are inside the solid (its boundary included).
 *
 * With #SPH_CAVITY_SOLID the first call after a new pose finds out which space is connected to infinity, on a grid of 64
 * cells along the longest side. A point that is told to be outside has a free way there. A passage narrower than two
 * cells may be taken for closed, and what is behind it for a cavity; sheets of no thickness are always tight.
 * @param[in]  cavities  one of SPH_CAVITY_*.
 * @param[out] inside    `count` values, 1 or 0; untouched on failure. Other arguments and errors as sph_query_nearest().
 * @retval SPH_E_NOMEM  no memory for the grid (0.3 MB, taken at the first such call and kept).
 * @par Cost  As sph_query_nearest(), and some milliseconds per pose where cavities are solid.
 * @since 0.1
 */
SPH_API sph_status sph_query_contains(const sph_query *query, const float *points, size_t stride, size_t count,
                                      int32_t cavities, uint8_t *inside);

/** How two posed levels stand to one another. */
typedef struct sph_gap {
    double s;           /**< of sph_query_cast_between(): 0 to 1; else 0 */
    double distance;    /**< signed: the least |c - d| - r - t over interpolated spheres (c, r) of the first and (d, t) of
                             the second. Apart it is the distance; below 0 it is minus the overlap of the two spheres
                             that overlap most */
    uint32_t hit;       /**< 1: they touch or overlap (at s); else 0 */
    uint32_t reserved0; /**< 0 */
    sph_contact first;  /**< that sphere of the first level, and the point on it that is nearest to or deepest in the second */
    sph_contact second; /**< likewise of the second; its normal points to the first, and is minus the other */
} sph_gap;

/**
 * @brief Distance between two posed levels, or their deepest penetration, with the places.
 * @param[out] gap  untouched on failure.
 * @retval SPH_E_INVALID  NULL.
 * @par Cost  About 10 microseconds per pair of simplices whose bounds come as near as the answer. No allocation.
 * @since 0.1
 */
SPH_API sph_status sph_query_between(const sph_query *first, const sph_query *second, sph_gap *gap);

/**
 * @brief First contact of the first posed level, moved along `motion`, with the second.
 * @param[in]  motion  finite, model units: at s the first level is moved by s * motion.
 * @param[out] gap     where they touch at first (places as they then are); without a hit s is 1 and the contacts are
 *                     empty. Where they overlap from the start, as sph_query_between(). Untouched on failure.
 * @retval SPH_E_INVALID  NULL or a motion that is not finite.
 * @since 0.1
 */
SPH_API sph_status sph_query_cast_between(const sph_query *first, const float motion[3], const sph_query *second,
                                          sph_gap *gap);

SPH_END_DECLS

#endif
