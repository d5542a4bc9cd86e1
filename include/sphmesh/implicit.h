/* SPDX-License-Identifier: MIT */
/**
 * @file implicit.h
 * @brief Implicit skinning: poses of a skin corrected by the solids of its parts, so that joints keep their volume and
 * skin that folds comes into contact instead of passing through itself.
 *
 * Each bone's part of the mesh is approximated by a smooth field of compact support, 1 inside, 1/2 on the surface and 0
 * outside (Hermite radial basis functions through some samples of it). In a pose the fields go with their bones and are
 * composed; every vertex then walks from where linear blending or dual quaternions put it along the composed field's
 * gradient to the value that it has in the rest pose, unless it meets another part before (Vaillant et al. 2013,
 * "Implicit Skinning: Real-Time Skin Deformation with Contact Modeling"; operators of Gourmel et al. 2013).
 *
 * A skin gives an #sph_implicit, the set-up that an artist may edit and save; that and the skin give an #sph_tracker,
 * which takes transforms of the bones and returns corrected vertices.
 */
#ifndef SPHMESH_IMPLICIT_H
#define SPHMESH_IMPLICIT_H

#include "hierarchy.h"
#include "pose.h"

SPH_BEGIN_DECLS

/** Handle: the fields of a skin's parts and how they are composed at joints. It stands alone: the skin need not live
 * on. */
typedef struct sph_implicit sph_implicit;
/** Handle: what is needed to correct poses of one skin. It stands alone: neither skin nor set-up need live on. */
typedef struct sph_tracker sph_tracker;

/** How the fields of two bones at a joint are composed. */
enum {
    SPH_OPERATION_UNION = 0, /**< the larger one: a sharp crease, and contact where skin folds */
    SPH_OPERATION_BLEND = 1, /**< a smooth transition where the surfaces meet at about 45 degrees, else as the union */
    SPH_OPERATION_BULGE = 2  /**< contact, with a bulge beside it that grows as the joint bends */
};

/** How fields and operators are evaluated. */
enum {
    SPH_EVALUATION_TABLE = 0, /**< from grids, trilinear: fast; docs/implicit.md says how far off it is */
    SPH_EVALUATION_EXACT = 1  /**< from the closed forms */
};

/**
 * theta as a function of the angle alpha between the gradients of two fields: theta_0 up to alpha_0, theta_1 at
 * alpha_1, theta_2 from alpha_2 on; between these \f$ \theta_1 + (\theta_0 - \theta_1) \kappa(x)^{s_0} \f$ with x
 * falling from 1 to 0, and \f$ \theta_1 + (\theta_2 - \theta_1) \kappa(x)^{s_1} \f$ with x rising from 0 to 1, where
 * \f$ \kappa(x) = 1 - \exp(1 - 1 / (1 - \exp(1 - 1/x))) \f$ is flat at both ends.
 */
typedef struct sph_theta_curve {
    double angles[3];    /**< radians, 0 <= alpha_0 <= alpha_1 <= alpha_2 <= pi */
    double thetas[3];    /**< radians, 0 (the operator at its fullest) to pi/4 (the union) */
    double exponents[2]; /**< s_0, s_1, from 0.01 to 100 */
} sph_theta_curve;

/** A joint: two bones whose fields are composed by an operator of their own. Fields of all joints are united. */
typedef struct sph_implicit_joint {
    uint32_t struct_size;  /**< sizeof(sph_implicit_joint), set by the caller */
    int32_t operation;     /**< one of SPH_OPERATION_* */
    uint32_t bones[2];     /**< both with a part of the mesh; not the same */
    double position[3];    /**< in the rest pose: where the parts are closed */
    double strength;       /**< m of the bulge, 0 to #SPH_BULGE_LIMIT; ignored by the others */
    sph_theta_curve curve; /**< ignored by the union */
} sph_implicit_joint;

/** The largest strength of a bulge: beyond it fields would fall where a part's own field rises. */
#define SPH_BULGE_LIMIT 0.5

/** Options of sph_implicit_create(). Fill with sph_implicit_options_init() first. */
typedef struct sph_implicit_options {
    uint32_t struct_size;         /**< bytes the caller knows of; written by the initialiser */
    uint32_t flags;               /**< must be 0 */
    uint32_t sample_count;        /**< samples of a part, 4 to 400; default 50 */
    int32_t operation;            /**< of joints that are not in `joints`; default #SPH_OPERATION_UNION */
    uint32_t table_size;          /**< nodes of a field's grid along each axis, 8 to 128; default 32 */
    uint32_t operator_table_size; /**< of the operators' grids, 8 to 256; default 128 */
    double joint_gap; /**< h: samples that are nearer to a joint than this part of the bone's length are left out,
                           0 to 0.4; default 0.05 */
    const uint32_t *parents; /**< shape (J): the bone that a bone hangs on, by a joint at its pivot; #SPH_NO_JOINT-like
                                  UINT32_MAX: none. As sph_io_rig_arrays::parents. NULL (default): bones are spheres
                                that the skin's links join, and joints are where two of these meet */
    const uint32_t *parts; /**< shape (n): which bone's part a vertex belongs to; UINT32_MAX: none. NULL (default): that
                                of its largest weight */
    const sph_implicit_joint *joints; /**< overrides: joint_count of them, each with its struct_size; a joint that two
                                           bones do not have is added; may be NULL */
    size_t joint_count;               /**< default 0 */
} sph_implicit_options;

/** @brief Fills `options` with the defaults. Call as `sph_implicit_options_init(&o, sizeof o)`. @since 0.1 */
SPH_API void sph_implicit_options_init(sph_implicit_options *options, size_t size);

/**
 * @brief Fits fields to the parts of a skin and finds the joints between them.
 *
 * A part is what hangs most on one bone. Its samples are a Poisson-disk set of its surface without what is near joints;
 * one more sample closes it at each joint, at the distance of the nearest vertex, facing along the bone. Parts that are
 * wound inside out are turned. Bones with too small a part (fewer than four samples, or all in one place) have no
 * field; joints reach over them to the next bone that has one.
 * @param[in]  options  may be NULL: all defaults.
 * @param[out] out      owned by the caller; NULL on failure.
 * @retval SPH_E_INVALID    NULL, bad options, parents that run in a circle, a bone or number out of range; the message
 *                          names it.
 * @retval SPH_E_STATE      a skin without triangles.
 * @retval SPH_E_NOMEM      out of memory.
 * @retval SPH_E_CANCELLED  progress asked to stop.
 * @par Cost  O(n + J m^3) for m samples; parts are fitted on the executor's threads.
 * @par Determinism  Same bits whatever the executor and threads.
 * @since 0.1
 */
SPH_API sph_status sph_implicit_create(const sph_skin *skin, const sph_implicit_options *options, sph_implicit **out);

/** @brief Destroys a set-up. NULL is fine. @since 0.1 */
SPH_API void sph_implicit_destroy(sph_implicit *implicit);

/** @brief J, or 0 for NULL. @since 0.1 */
SPH_API uint32_t sph_implicit_bone_count(const sph_implicit *implicit);
/** @brief Number of joints, or 0 for NULL. @since 0.1 */
SPH_API uint32_t sph_implicit_joint_count(const sph_implicit *implicit);

/** What is known of a bone's field. Pointers are borrowed until the set-up is destroyed. */
typedef struct sph_implicit_part {
    uint32_t struct_size;   /**< sizeof(sph_implicit_part), set by the caller */
    uint32_t vertex_count;  /**< vertices of the skin that belong to it */
    uint32_t sample_count;  /**< m, those that close it included; 0: it has no field */
    uint32_t closing_count; /**< how many close it; they come last */
    double radius;          /**< r: the field falls from 1 to 0 between -r and r from the surface, model units */
    double low[3];          /**< box, in the rest pose, beyond which the field is 0 */
    double high[3];         /**< its other corner */
    const double *samples;  /**< shape (m, 3): in the rest pose */
    const double *normals;  /**< shape (m, 3): of length 1, outward */
} sph_implicit_part;

/**
 * @brief A bone's part.
 * @param[in,out] part  `struct_size` set by the caller.
 * @retval SPH_E_INVALID  NULL, a size that is not known, or no such bone.
 * @since 0.1
 */
SPH_API sph_status sph_implicit_get_part(const sph_implicit *implicit, uint32_t bone, sph_implicit_part *part);

/**
 * @brief A joint; they are in order of their bones.
 * @param[in,out] joint  `struct_size` set by the caller.
 * @retval SPH_E_INVALID  NULL, a size that is not known, or no such joint.
 * @since 0.1
 */
SPH_API sph_status sph_implicit_get_joint(const sph_implicit *implicit, uint32_t index, sph_implicit_joint *joint);

/**
 * @brief Changes a joint's operation, strength and curve. Trackers that were made before keep what they know.
 * @param[in] joint  of the same bones; its position is not looked at.
 * @retval SPH_E_INVALID  NULL, no such joint, other bones, or a number out of range; the message says which.
 * @since 0.1
 */
SPH_API sph_status sph_implicit_set_joint(sph_implicit *implicit, uint32_t index, const sph_implicit_joint *joint);

/**
 * @brief The curve that goes with an operation: of the blend union, blend at pi/4, union from pi/2 on (elbows, knees);
 * of the bulge union at 0, the full bulge from pi/2 on; of the union, union throughout.
 * @param[out] curve  untouched for an operation that there is not.
 * @since 0.1
 */
SPH_API void sph_theta_curve_preset(sph_theta_curve *curve, int32_t operation);
/** @brief theta(alpha); NaN for NULL or NaN. Any number of threads. @since 0.1 */
SPH_API double sph_theta_curve_at(const sph_theta_curve *curve, double alpha);

/**
 * @brief Composes two field values: the closed form of an operator.
 *
 * With k(C) = C tan(theta) up to C = 1/2, and (7 - 5 tan(theta)) C / 2 + 7 (tan(theta) - 1) / 4 beyond it, which
 * reaches C at 0.7: where one value is below k of the other, or above 0.7, it is the larger one; else the C with \f$
 * \sqrt{(f_1 - k)^2 + (f_2 - k)^2} = (C - k)\,p(t) \f$, where p is 1 for the blend, and for the bulge \f$ 1 - m (1 - t)
 * e^{1 - 1/t} \f$ with t the lesser of f_1 - k and f_2 - k over the greater (Vaillant et al. 2013, appendix A).
 * @param[in]  operation  one of SPH_OPERATION_*.
 * @param[in]  strength   m, 0 to #SPH_BULGE_LIMIT.
 * @param[in]  theta      0 to pi/4.
 * @param[in]  values     f_1, f_2, each from 0 to 1.
 * @param[out] result     the composed value.
 * @param[out] slopes     its derivatives by f_1 and f_2; may be NULL.
 * @retval SPH_E_INVALID  NULL or a number out of range.
 * @par Thread safety  Any number of threads.
 * @since 0.1
 */
SPH_API sph_status sph_operation_compose(int32_t operation, double strength, double theta, const double values[2],
                                         double *result, double slopes[2]);

/**
 * @brief The signed distance, about, from one bone's part in the rest pose: what its field is made from.
 * @param[in]  points     shape (count, 3).
 * @param[out] distances  shape (count): < 0 inside; model units.
 * @param[out] gradients  shape (count, 3); may be NULL.
 * @retval SPH_E_INVALID  NULL, no such bone, or a point that is not finite.
 * @retval SPH_E_STATE    the bone has no field.
 * @par Thread safety  Any number of threads.
 * @par Cost  O(count m).
 * @since 0.1
 */
SPH_API sph_status sph_implicit_distances(const sph_implicit *implicit, uint32_t bone, size_t count,
                                          const double *points, double *distances, double *gradients);

/**
 * @brief The composed field in a pose.
 * @param[in]  transforms  shape (J, 3, 4): rest pose to pose; NULL: the rest pose. A bone whose transform cannot be
 *                         inverted has no field.
 * @param[in]  evaluation  one of SPH_EVALUATION_*.
 * @param[in]  points      shape (count, 3).
 * @param[out] values      shape (count): 0 to 1, 1/2 on the surface.
 * @param[out] gradients   shape (count, 3), with theta held; may be NULL.
 * @param[out] bones       shape (count): whose field is the largest there; UINT32_MAX where all are 0; may be NULL.
 * @retval SPH_E_INVALID  NULL, an unknown evaluation, or a number that is not finite; the message names it.
 * @retval SPH_E_NOMEM    out of memory.
 * @par Thread safety  Any number of threads.
 * @par Cost  O(count (J + parts that reach the point)); points are spread over the executor's threads.
 * @par Determinism  Same bits whatever the executor, threads and CPU.
 * @since 0.1
 */
SPH_API sph_status sph_implicit_evaluate(const sph_implicit *implicit, const double *transforms, int32_t evaluation,
                                         size_t count, const double *points, double *values, double *gradients,
                                         uint32_t *bones);

/** @brief Writes the set-up as a `.sphm` container through `write`; see sph_hierarchy_write(). @since 0.1 */
SPH_API sph_status sph_implicit_write(const sph_implicit *implicit, sph_write_fn *write, void *user);
/** @brief Makes a set-up from the bytes of a `.sphm` container; see sph_hierarchy_read(). @since 0.1 */
SPH_API sph_status sph_implicit_read(sph_context *context, const void *bytes, size_t size, sph_implicit **out);

/** Flags of trackers. */
enum {
    SPH_TRACKER_UNGUARDED = 1,  /**< intersections are not looked for: faster, and without the promise */
    SPH_TRACKER_UNSMOOTHED = 2, /**< contact regions stay as sharp as they come out */
    SPH_TRACKER_COUNTED = 4     /**< all intersecting pairs are counted, before and after, which takes its time */
};

/** Options of sph_tracker_create(). Fill with sph_tracker_options_init() first. */
typedef struct sph_tracker_options {
    uint32_t struct_size;      /**< bytes the caller knows of; written by the initialiser */
    uint32_t flags;            /**< any of SPH_TRACKER_*; default 0 */
    int32_t method;            /**< where vertices start: one of SPH_POSE_*; default #SPH_POSE_DUAL_QUATERNION */
    int32_t evaluation;        /**< default #SPH_EVALUATION_TABLE */
    uint32_t iteration_limit;  /**< most steps of a vertex, 1 to 1000; default 24 */
    uint32_t smoothing_rounds; /**< of contact regions, 0 to 100; default 4 */
    double step;               /**< sigma, in (0, 1]; default 0.35 */
    double contact_angle;      /**< radians, in (0, pi); default 55 degrees: a gradient that turns more is contact */
    double tolerance;          /**< of field values, in [0, 0.1]; default 1e-4: vertices this near are left alone */
    double reach; /**< the farthest that a vertex may be moved, as a part of its bone's radius r, in (0, 10];
                       default 1 */
} sph_tracker_options;

/** @brief Fills `options` with the defaults. Call as `sph_tracker_options_init(&o, sizeof o)`. @since 0.1 */
SPH_API void sph_tracker_options_init(sph_tracker_options *options, size_t size);

/**
 * @brief Makes a tracker of a skin: each vertex is told its value in the rest pose.
 *
 * Vertices that share a place and weights in the rest pose are one, and stay together. Vertices of which the fields
 * know nothing, or the opposite of what the surface says, stay where blending puts them.
 * @param[in]  skin     with triangles, and as many bones as the set-up.
 * @param[in]  options  may be NULL: all defaults.
 * @param[out] out      owned by the caller; NULL on failure.
 * @retval SPH_E_INVALID  NULL, bad options, or another number of bones; the message says which.
 * @retval SPH_E_STATE    a skin without triangles.
 * @retval SPH_E_NOMEM    out of memory.
 * @since 0.1
 */
SPH_API sph_status sph_tracker_create(const sph_implicit *implicit, const sph_skin *skin,
                                      const sph_tracker_options *options, sph_tracker **out);

/** @brief Destroys a tracker. NULL is fine. @since 0.1 */
SPH_API void sph_tracker_destroy(sph_tracker *tracker);

/** What was done to one pose. */
typedef struct sph_tracker_report {
    uint32_t moved;        /**< vertices that are not where blending put them */
    uint32_t contacts;     /**< vertices that were stopped by another part */
    uint32_t held_back;    /**< vertices that were moved less, so that no intersection comes of it */
    uint32_t reserved0;    /**< 0 */
    double farthest;       /**< how far a vertex was moved, at most; model units */
    uint64_t pairs_before; /**< intersecting pairs of triangles as blending has them, and */
    uint64_t pairs_after;  /**< after the correction: never more; both 0 without #SPH_TRACKER_COUNTED */
} sph_tracker_report;

/**
 * @brief Poses the skin and corrects the result, for one pose or many.
 *
 * Poses are independent of one another. Where intersections are guarded against (the default), the result never has
 * more intersecting pairs of triangles (as sph_mesh_intersections() counts them) than blending alone gives: what would
 * make new ones is taken back as far as it must.
 * @param[in]  transforms  shape (pose_count, J, 3, 4): rest pose to pose; any affine ones.
 * @param[out] positions   shape (pose_count, n, 3); untouched where the call is refused.
 * @param[out] normals     shape (pose_count, n, 3): of the corrected triangles, length 1; 0 where there is none; may be
 *                         NULL.
 * @param[out] reports     shape (pose_count); may be NULL.
 * @retval SPH_E_INVALID    NULL, sizes that overflow, or a transform that is not finite; the message names pose and
 * bone.
 * @retval SPH_E_NOMEM      out of memory.
 * @retval SPH_E_CANCELLED  progress asked to stop.
 * @par Cost  O(n) field values per step; vertices and poses are spread over the executor's threads.
 * @par Thread safety  One call at a time with one tracker; any number with others.
 * @par Determinism  Same bits whatever the executor, threads and CPU, and whether poses come one by one or together.
 * @since 0.1
 */
SPH_API sph_status sph_tracker_pose(sph_tracker *tracker, const double *transforms, size_t pose_count, float *positions,
                                    float *normals, sph_tracker_report *reports);

/**
 * @brief Counts the pairs of triangles of a mesh that intersect, exactly.
 *
 * Corners at the same place are one corner. Triangles that share none intersect where they have a point in common;
 * those that share one, where they have another; those that share two, where they lie upon one another. Two triangles
 * of the same three corners are no pair.
 * @param[in]  positions  shape (vertex_count, 3); finite.
 * @param[in]  triangles  shape (triangle_count, 3), vertex indices.
 * @param[out] pairs      how many.
 * @retval SPH_E_INVALID  NULL, an index out of range, or a position that is not finite; the message names it.
 * @retval SPH_E_NOMEM    out of memory.
 * @par Cost  O(t log t) for t triangles that lie apart.
 * @par Thread safety  Any number of threads.
 * @since 0.1
 */
SPH_API sph_status sph_mesh_intersections(sph_context *context, uint32_t vertex_count, const float *positions,
                                          size_t triangle_count, const uint32_t *triangles, uint64_t *pairs);

SPH_END_DECLS

#endif
