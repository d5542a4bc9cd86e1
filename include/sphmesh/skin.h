/* SPDX-License-Identifier: MIT */
/**
 * @file skin.h
 * @brief A skinned mesh: a rest pose whose vertices follow bones by linear blend skinning, and the bones' poses.
 *
 * \f[ v_i^f = \sum_j w_{ij} A_j^f p_i \f] with p the rest pose, w the weights (>= 0, sum 1, at most k per vertex) and
 * A_j^f the affine transform of bone j in frame f. A skin comes from an animation and a level, whose spheres are the
 * bones (Thiery et al. 2016, section 6.2), or from the caller's arrays, as a character of glTF gives them.
 */
#ifndef SPHMESH_SKIN_H
#define SPHMESH_SKIN_H

#include "level.h"

SPH_BEGIN_DECLS

/** Handle: a skinned mesh. It stands alone: nothing it was made from needs to live on. */
typedef struct sph_skin sph_skin;

/** A range of frames with a name: what an engine plays. */
typedef struct sph_skin_clip {
    const char *name;         /**< UTF-8; may be NULL where the caller gives it, never where the library does */
    uint32_t first_frame;     /**< clips follow one another and cover all frames */
    uint32_t frame_count;     /**< >= 1 */
    double frames_per_second; /**< 0: not known */
} sph_skin_clip;

/**
 * The parts of a skinned mesh, for callers that make one; also what the getter returns.
 *
 * What the library returns is in order: the weights of a vertex fall along its slots, no bone has two slots, unused
 * slots have weight 0 and bone 0, and every weight is a multiple of 2^-24, so that the sum of a vertex's is exactly 1 in
 * whatever order and precision it is taken. What callers give may be in any order and name a bone twice, and sums may
 * be off 1 by up to 1e-2; it is brought in order.
 */
typedef struct sph_skin_arrays {
    uint32_t struct_size;       /**< sizeof(sph_skin_arrays) */
    uint32_t vertex_count;      /**< n >= 1 */
    uint32_t bone_count;        /**< J >= 1 */
    uint32_t influence_count;   /**< k >= 1: slots per vertex */
    uint32_t frame_count;       /**< F >= 0: frames of all clips */
    uint32_t clip_count;        /**< given as 0 with frames: one clip of all */
    const float *rest;          /**< shape (n, 3), model units */
    const uint32_t *bones;      /**< shape (n, k), below J */
    const float *weights;       /**< shape (n, k), >= 0 */
    const double *transforms;   /**< shape (F, J, 3, 4): A_j^f, rest pose to frame, rows of [linear | translation]; NULL
                                     where F is 0 */
    const sph_skin_clip *clips; /**< clip_count of them */
    const double *pivots;       /**< shape (J, 3): where a bone is in the rest pose (the sphere's centre), the natural
                                     place of its joint; NULL where the caller gives it: the weighted mean of the bone's
                                     vertices */
    const double *radii;        /**< shape (J): of the spheres; given as NULL: 0 */
    size_t triangle_count;      /**< 0 where there are none */
    const uint32_t *triangles;  /**< shape (triangle_count, 3), vertex indices */
    size_t link_count;          /**< 0 where there are none */
    const uint32_t *links;      /**< shape (link_count, 2): pairs of bones that touch (of a level: its edges and those of
                                     its triangles), the lower first, rising, none twice; given in any order */
    uint32_t rigid;             /**< returned: 1 where every transform is a proper rotation (to 1e-6) and a translation;
                                     ignored where given */
    uint32_t reserved0;         /**< must be 0 */
} sph_skin_arrays;

/**
 * @brief A skin from the caller's arrays, which are checked, copied and brought in order.
 * @param[in]  arrays  `struct_size` set; transforms need not be rigid.
 * @param[out] out     owned by the caller; NULL on failure.
 * @retval SPH_E_INVALID  NULL, a count of 0, an index out of range, weights below 0 or whose sum is more than 1e-2 off 1,
 *                        clips that do not cover the frames one after another, or a value that is not finite; the
 *                        message names it.
 * @retval SPH_E_NOMEM    out of memory.
 * @par Cost  O(n k^2 + F J).
 * @since 0.1
 */
SPH_API sph_status sph_skin_create_from_arrays(sph_context *context, const sph_skin_arrays *arrays, sph_skin **out);

/** What the weights are to be good for. */
enum {
    SPH_SKIN_MIXED = 0,     /**< geometric weights, learned from the animation where that tells (the paper's) */
    SPH_SKIN_ANIMATION = 1, /**< weights for the least reconstruction error */
    SPH_SKIN_GEOMETRIC = 2  /**< the initial weights stay: transforms only */
};

/** For counts among the options: what suits the mode. */
#define SPH_SKIN_AUTO UINT32_MAX

/** Flags. */
enum {
    SPH_SKIN_UNIFORM = 1 /**< all vertices count alike in what is minimised, and not by the area of their cells */
};

/** What was just done, as told to a #sph_skin_step_fn. */
enum {
    SPH_SKIN_STEP_START = 0,      /**< initial weights and transforms are there */
    SPH_SKIN_STEP_TRANSFORMS = 1, /**< all bones' transforms were optimised; minor bones may cost energy */
    SPH_SKIN_STEP_WEIGHTS = 2,    /**< the weights were optimised; the mixed ones may cost energy */
    SPH_SKIN_STEP_REST = 3,       /**< the rest pose was optimised */
    SPH_SKIN_STEP_AHEAD = 4       /**< weights and rest pose went on along the last round's change, and the transforms that
                                       belong to them lowered the energy */
};

/**
 * Told after every step of the solver, on the thread that made the call. `energy` is the sum over frames and vertices
 * of area times squared distance, model units to the fourth power.
 */
typedef void sph_skin_step_fn(void *user, uint32_t round, int32_t step, double energy);

/** Options of the decomposition. Fill with sph_skin_options_init() first. */
typedef struct sph_skin_options {
    uint32_t struct_size;     /**< bytes the caller knows of; written by the initialiser */
    uint32_t flags;           /**< any of #SPH_SKIN_UNIFORM; default 0 */
    int32_t mode;             /**< default #SPH_SKIN_MIXED */
    uint32_t influence_limit; /**< k: most bones per vertex, from 1; default 4 */
    uint32_t rings;           /**< how many cells away from a vertex's own a bone may be, along adjacent cells;
                                   default 1, the paper's */
    uint32_t round_limit;     /**< most rounds of transforms and weights; default #SPH_SKIN_AUTO: 60 for the animation
                                   mode, else 30 */
    uint32_t rest_interval;   /**< the rest pose is optimised every so many rounds; 0: never; default #SPH_SKIN_AUTO: 1
                                   for the animation mode, else 5 */
    uint32_t initial_influence_count; /**< slots of `initial_bones` and `initial_weights`; 0 (default): none */
    double tolerance;         /**< rounds end when the RMSE, weighted as the energy is, changes by less than this
                                   fraction per round, over five of them; default 1e-3 */
    double error_limit;       /**< rounds end when the RMSE is no more than so many percent of the diagonal; default 0 */
    double smoothness;        /**< gamma, squared diagonals of the bounding box; default 1e-4 */
    double filter_radius;     /**< sigma of the geodesic filter, diagonals; default 0.03 */
    double minor_bone;        /**< bones whose squared weights sum to less are minor; default 3 */
    const uint32_t *initial_bones;    /**< shape (n, initial_influence_count); weights of bones that are not within
                                           reach of a vertex are dropped */
    const float *initial_weights;     /**< shape (n, initial_influence_count); NULL: bone heat */
    const double *initial_transforms; /**< shape (F, J, 3, 4), rigid; NULL: those that fit the cells best */
    const uint8_t *locked_bones;      /**< J entries, not 0: the initial transform stays (they must be given); may be
                                           NULL */
    const uint8_t *locked_vertices;   /**< n entries, not 0: the initial weights and the rest position stay; may be
                                           NULL */
    sph_skin_step_fn *step;   /**< may be NULL */
    void *step_user;          /**< passed to `step` */
} sph_skin_options;

/** @brief Fills `options` with the defaults. Call as `sph_skin_options_init(&o, sizeof o)`. @since 0.1 */
SPH_API void sph_skin_options_init(sph_skin_options *options, size_t size);

/** An animation that a skin is to reproduce, and the name of the clip that comes of it. */
typedef struct sph_skin_source {
    const sph_animation *animation; /**< same vertices and triangles in all of them */
    const char *name;               /**< UTF-8; may be NULL: "" */
    double frames_per_second;       /**< 0: not known */
} sph_skin_source;

/**
 * @brief Decomposes animations into a skin whose bones are the spheres of a level.
 * @param[in]  level         with labels; its first frame is the first of the first source, which is the rest pose.
 * @param[in]  sources       one clip each, of one mesh.
 * @param[in]  source_count  >= 1.
 * @param[in]  options       may be NULL: all defaults.
 * @param[out] out           owned by the caller; NULL on failure.
 * @retval SPH_E_INVALID    NULL, bad options, a level without labels, counts of vertices or triangles that differ, or a
 *                          coordinate that is not finite; the message names it.
 * @retval SPH_E_NOMEM      out of memory.
 * @retval SPH_E_CANCELLED  progress asked to stop.
 * @return otherwise what a frame source returned.
 * @par Determinism  Same bits whatever the executor and threads.
 * @since 0.1
 */
SPH_API sph_status sph_skin_create(const sph_level *level, const sph_skin_source *sources, size_t source_count,
                                   const sph_skin_options *options, sph_skin **out);

/** @brief Destroys a skin. NULL is fine. @since 0.1 */
SPH_API void sph_skin_destroy(sph_skin *skin);

/** @brief n, or 0 for NULL. @since 0.1 */
SPH_API uint32_t sph_skin_vertex_count(const sph_skin *skin);
/** @brief J, or 0 for NULL. @since 0.1 */
SPH_API uint32_t sph_skin_bone_count(const sph_skin *skin);
/** @brief k, or 0 for NULL. @since 0.1 */
SPH_API uint32_t sph_skin_influence_count(const sph_skin *skin);
/** @brief F, or 0 for NULL. @since 0.1 */
SPH_API uint32_t sph_skin_frame_count(const sph_skin *skin);

/**
 * @brief The skin's parts, borrowed until it is destroyed.
 * @param[in,out] arrays  `struct_size` set by the caller.
 * @retval SPH_E_INVALID  NULL or a size that is not known.
 * @since 0.1
 */
SPH_API sph_status sph_skin_get_arrays(const sph_skin *skin, sph_skin_arrays *arrays);

/** How far a skin is from what it reproduces, in one frame or in all. Percent are of the diagonal `diagonal`. */
typedef struct sph_skin_error {
    double mse;          /**< Eq. 13: weighted by the areas of the vertices' cells, in squared diagonals; overall the mean of
                              the frames' */
    double rmse;         /**< root of the mean squared distance over vertices (and frames), model units */
    double max;          /**< largest distance of a vertex, model units */
    double rmse_percent; /**< rmse */
    double max_percent;  /**< max */
    double diagonal;     /**< mean over all frames of the diagonal of the bounding box, model units */
    uint32_t max_vertex; /**< which vertex is farthest */
    uint32_t max_frame;  /**< and in which frame, counted over all clips */
} sph_skin_error;

/**
 * @brief The errors that sph_skin_create() ended with.
 * @param[out] overall    may be NULL.
 * @param[out] per_frame  F entries; may be NULL.
 * @retval SPH_E_INVALID  `skin` is NULL.
 * @retval SPH_E_STATE    the skin was made from arrays: see sph_skin_measure().
 * @since 0.1
 */
SPH_API sph_status sph_skin_get_errors(const sph_skin *skin, sph_skin_error *overall, sph_skin_error *per_frame);

/**
 * @brief Measures a skin against animations of as many frames: what reconstruction by its arrays, as they are, is off.
 * @param[in]  sources    their frames, one source after another, are those of the skin.
 * @param[out] overall    untouched on failure; may be NULL.
 * @param[out] per_frame  F entries; may be NULL.
 * @retval SPH_E_INVALID    NULL, counts of vertices or frames that differ, or a coordinate that is not finite.
 * @retval SPH_E_NOMEM      out of memory.
 * @retval SPH_E_CANCELLED  progress asked to stop.
 * @return otherwise what a frame source returned.
 * @par Cost  O(F n k).
 * @since 0.1
 */
SPH_API sph_status sph_skin_measure(const sph_skin *skin, const sph_skin_source *sources, size_t source_count,
                                    sph_skin_error *overall, sph_skin_error *per_frame);

SPH_END_DECLS

#endif
