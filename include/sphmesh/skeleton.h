/* SPDX-License-Identifier: MIT */
/**
 * @file skeleton.h
 * @brief The bones of a skin as a tree of joints: where each joint is, which one it hangs on, and poses relative to
 * that.
 *
 * A skin has a list of bones, each with a transform of its own from the rest pose to a frame. Artists and engines want
 * a tree: a joint's transform relative to its parent, about a place at which a turn alone does most of it. Bones that
 * touch are linked where they move most alike, and the joint between two of them is put at the point, fixed to both,
 * which both move alike (Schaefer and Yuksel 2007; Le and Deng 2014). Nothing of the motion changes: poses relative to
 * parents are the same poses.
 */
#ifndef SPHMESH_SKELETON_H
#define SPHMESH_SKELETON_H

#include "skin.h"

SPH_BEGIN_DECLS

/** Handle: a tree of joints. It stands alone: the skin need not live on. */
typedef struct sph_skeleton sph_skeleton;

/** Parent of a joint that hangs on none. */
#define SPH_NO_JOINT UINT32_MAX

/** What hangs on what. */
enum {
    SPH_SKELETON_TREE = 0, /**< a spanning tree of the skin's links; parts that no link joins are joined where their
                              spheres are nearest in the rest pose */
    SPH_SKELETON_FLAT = 1  /**< a list: no bone hangs on another; joints are at the bones' pivots */
};

/** Which bone the others hang on, in a tree. */
enum {
    SPH_ROOT_CENTER = 0,   /**< from which the way to the farthest bone, along the tree at rest, is shortest */
    SPH_ROOT_HEAVIEST = 1, /**< that moves most of the surface: area of the rest pose times weight */
    SPH_ROOT_GIVEN = 2     /**< `root_bone` */
};

/** Options of sph_skeleton_create(). Fill with sph_skeleton_options_init() first. */
typedef struct sph_skeleton_options {
    uint32_t struct_size; /**< bytes the caller knows of; written by the initialiser */
    uint32_t flags;       /**< must be 0 */
    int32_t layout;       /**< default #SPH_SKELETON_TREE */
    int32_t root;         /**< default #SPH_ROOT_CENTER */
    uint32_t root_bone;   /**< below J; for #SPH_ROOT_GIVEN */
    uint32_t single_root; /**< 1: one joint more, of no bone, at the origin, that does not move, and that all others
                             hang on; default 0 */
} sph_skeleton_options;

/** @brief Fills `options` with the defaults. Call as `sph_skeleton_options_init(&o, sizeof o)`. @since 0.1 */
SPH_API void sph_skeleton_options_init(sph_skeleton_options *options, size_t size);

/**
 * @brief Finds the joints of a skin.
 *
 * For two linked bones a and b the joint is the point x of the rest pose of least mean square of |A_a x - A_b x| over
 * all frames. Directions in which the motion leaves it open (along the axis of a hinge) or in which its noise does (two
 * bones that hardly turn against one another) draw it to where the two spheres meet; it is no farther from there than
 * the spheres reach together. The root of a tree is at its bone's pivot. Joints are not turned in the rest pose.
 * @param[in]  options  may be NULL: all defaults.
 * @param[out] out      owned by the caller; NULL on failure.
 * @retval SPH_E_INVALID    NULL or bad options; the message says which.
 * @retval SPH_E_NOMEM      out of memory.
 * @retval SPH_E_CANCELLED  progress asked to stop.
 * @par Cost  O(F L + L log L + n k) for L links; O(J^2) more where they leave several parts.
 * @par Determinism  Same bits whatever the executor and threads.
 * @since 0.1
 */
SPH_API sph_status sph_skeleton_create(const sph_skin *skin, const sph_skeleton_options *options, sph_skeleton **out);

/** @brief Destroys a skeleton. NULL is fine. @since 0.1 */
SPH_API void sph_skeleton_destroy(sph_skeleton *skeleton);

/** The parts of a skeleton. Joint j is that of bone j; a single root, if there is one, comes last. */
typedef struct sph_skeleton_arrays {
    uint32_t struct_size;    /**< sizeof(sph_skeleton_arrays) */
    uint32_t bone_count;     /**< J */
    uint32_t joint_count;    /**< J, or J + 1 */
    uint32_t reserved0;      /**< 0 */
    const uint32_t *parents; /**< shape (joint_count): a joint, or #SPH_NO_JOINT */
    const uint32_t *order;   /**< shape (joint_count): all joints, each after its parent */
    const double *positions; /**< shape (joint_count, 3): of the joints in the rest pose, model units */
    const double
        *rest; /**< shape (joint_count, 3, 4): joint to parent in the rest pose, rows of [linear | translation] */
    const double *inverse_bind; /**< shape (joint_count, 3, 4): model to joint in the rest pose */
    const double *gaps; /**< shape (joint_count): root of the mean square over frames of how far the bone and its
                           parent's take the joint apart, model units; 0 where the parent is no bone */
} sph_skeleton_arrays;

/**
 * @brief The skeleton's parts, borrowed until it is destroyed.
 * @param[in,out] arrays  `struct_size` set by the caller.
 * @retval SPH_E_INVALID  NULL or a size that is not known.
 * @since 0.1
 */
SPH_API sph_status sph_skeleton_get_arrays(const sph_skeleton *skeleton, sph_skeleton_arrays *arrays);

/**
 * @brief A pose of the bones as a pose of the joints, each relative to its parent.
 * @param[in]  transforms  shape (J, 3, 4): rest pose to pose, as one frame of sph_skin_arrays::transforms.
 * @param[out] locals      shape (joint_count, 3, 4): joint to parent; not `transforms`. A single root's is the
 * identity.
 * @retval SPH_E_INVALID  NULL, a number that is not finite, or a parent whose transform cannot be inverted; the message
 *                        names the bone.
 * @par Cost  O(J).
 * @par Thread safety  Any number of threads.
 * @since 0.1
 */
SPH_API sph_status sph_skeleton_get_locals(const sph_skeleton *skeleton, const double *transforms, double *locals);

/**
 * @brief The other way round: the bones' transforms of a pose that is given joint by joint. A joint that is changed
 * takes all that hang on it along.
 * @param[in]  locals      shape (joint_count, 3, 4).
 * @param[out] transforms  shape (J, 3, 4); not `locals`.
 * @retval SPH_E_INVALID  NULL, or a number that is not finite; the message names the joint.
 * @retval SPH_E_NOMEM    out of memory.
 * @par Cost  O(J).
 * @par Thread safety  Any number of threads.
 * @since 0.1
 */
SPH_API sph_status sph_skeleton_get_transforms(const sph_skeleton *skeleton, const double *locals, double *transforms);

SPH_END_DECLS

#endif
