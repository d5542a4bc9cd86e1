/* SPDX-License-Identifier: MIT */
/**
 * @file io_rig.h
 * @brief Part of io.h: the skinned mesh of a glTF as it is in the file, and posed meshes into files.
 */
#ifndef SPHMESH_IO_RIG_H
#define SPHMESH_IO_RIG_H

#include "sphmesh.h"

SPH_BEGIN_DECLS

/** Handle: a rigged mesh that was read from a file, with the poses of its clips. The file is not needed any more. */
typedef struct sph_io_rig sph_io_rig;

/** Options of sph_io_open_rig(). Fill with sph_io_open_rig_options_init() first. */
typedef struct sph_io_open_rig_options {
    uint32_t struct_size; /**< bytes the caller knows of; written by the initialiser */
    uint32_t flags;       /**< must be 0 */
    const char
        *clip;  /**< the animation to take, by name, or by number from 0; NULL (default): all, one after another */
    double fps; /**< frames per second that clips are taken at; finite, >= 0; 0 (default): 30 */
    uint32_t first_frame; /**< default 0; frames are counted over all chosen clips */
    uint32_t end_frame;   /**< the first frame not taken; 0 (default): all */
    uint32_t frame_step;  /**< default 1; > 0 */
    uint32_t reserved0;   /**< must be 0 */
} sph_io_open_rig_options;

/** @brief Fills `options` with the defaults. Call as `sph_io_open_rig_options_init(&o, sizeof o)`. @since 0.1 */
SPH_API void sph_io_open_rig_options_init(sph_io_open_rig_options *options, size_t size);

/**
 * @brief Reads the skinned mesh of a glTF: what sph_io_open_animation() bakes, before it is baked.
 *
 * All meshes of the scene are joined, vertices along seams stay apart (as with #SPH_IO_WELD_NONE), and a mesh that no
 * skin moves follows its node as one bone. Frames are those of sph_io_open_animation() with the same clip and fps; a
 * file without clips has one, its pose at rest. Weights are multiples of 2^-24, so that vertices agree with the baked
 * ones to about 1e-7 of the model's size. Morph targets are taken with their weights at rest.
 * @param[in]  options  may be NULL: all defaults.
 * @param[out] out      owned by the caller; NULL on failure.
 * @retval SPH_E_INVALID      NULL, bad options, no such clip, or frames that there are not.
 * @retval SPH_E_UNSUPPORTED  the file is no glTF.
 * @retval SPH_E_LIMIT        more than 2^24 poses of bones in all frames, or far more than the file's size allows for.
 * @retval SPH_E_IO, SPH_E_FORMAT, SPH_E_NOMEM, SPH_E_CANCELLED  as sph_io_open_animation().
 * @since 0.1
 */
SPH_API sph_status sph_io_open_rig(sph_context *context, const char *path, const sph_io_open_rig_options *options,
                                   sph_io_rig **out);

/** @brief Destroys a rig. NULL is fine. @since 0.1 */
SPH_API void sph_io_rig_destroy(sph_io_rig *rig);

/**
 * @brief The rig as a skin, borrowed until the rig is destroyed; NULL for NULL.
 *
 * Its rest pose is that of the file's positions, in which the inverse bind matrices find the joints; it is not the
 * scene at rest. Transforms lead from there to the scene in a frame. Pivots are where joints are in the rest pose;
 * links join each to its parent. Clips have the names of the file.
 * @since 0.1
 */
SPH_API const sph_skin *sph_io_rig_skin(const sph_io_rig *rig);

/** What a rig has besides its skin. Bones are in the order of the skin's; a joint that several skins name, or name with
 *  different inverse bind matrices, is several bones. Matrices are rows of [linear | translation]. */
typedef struct sph_io_rig_arrays {
    uint32_t struct_size;       /**< sizeof(sph_io_rig_arrays), set by the caller */
    uint32_t bone_count;        /**< J */
    uint32_t frame_count;       /**< F */
    uint32_t morphs;            /**< 1: a chosen clip moves morph targets, which the skin does not know of; else 0 */
    const char *const *names;   /**< shape (J): of the joints' nodes, UTF-8; "" where they have none */
    const uint32_t *nodes;      /**< shape (J): numbers of the joints' nodes in the file */
    const uint32_t *parents;    /**< shape (J): the first bone of the nearest node above that is one; #SPH_NO_JOINT */
    const double *inverse_bind; /**< shape (J, 3, 4): mesh to joint in the rest pose */
    const double *joints_rest;  /**< shape (J, 3, 4): joint to scene, nodes at rest */
    const double *joints;       /**< shape (F, J, 3, 4): joint to scene in a frame; the skin's transforms are these
                                     times `inverse_bind` */
    size_t edge_count;          /**< lines of the file's */
    const uint32_t *edges;      /**< shape (edge_count, 2): lines of the file's, vertex indices */
} sph_io_rig_arrays;

/**
 * @brief The rig's other parts, borrowed until it is destroyed.
 * @param[in,out] arrays  `struct_size` set by the caller.
 * @retval SPH_E_INVALID  NULL or a size that is not known.
 * @since 0.1
 */
SPH_API sph_status sph_io_rig_get_arrays(const sph_io_rig *rig, sph_io_rig_arrays *arrays);

/**
 * @brief Saves a mesh; the name's ending says how: `.obj`, or `.ply` (binary).
 * @param[in] context    takes the message of a failure.
 * @param[in] positions  shape (vertex_count, 3).
 * @param[in] normals    shape (vertex_count, 3); NULL: none.
 * @param[in] triangles  shape (triangle_count, 3), vertex indices.
 * @retval SPH_E_INVALID      NULL, or an index out of range; the message names the triangle.
 * @retval SPH_E_UNSUPPORTED  another ending.
 * @retval SPH_E_IO           the file cannot be written: the message has the path and the reason.
 * @retval SPH_E_NOMEM        out of memory.
 * @since 0.1
 */
SPH_API sph_status sph_io_save_mesh(sph_context *context, uint32_t vertex_count, const float *positions,
                                    const float *normals, size_t triangle_count, const uint32_t *triangles,
                                    const char *path);

/** Frames of one mesh, as they are to be saved. */
typedef struct sph_io_frames {
    uint32_t struct_size;      /**< sizeof(sph_io_frames) */
    uint32_t vertex_count;     /**< n >= 1 */
    uint32_t frame_count;      /**< F >= 1 */
    uint32_t reserved0;        /**< must be 0 */
    const float *positions;    /**< shape (F, n, 3) */
    size_t triangle_count;     /**< >= 1 */
    const uint32_t *triangles; /**< shape (triangle_count, 3), vertex indices */
    double frames_per_second;  /**< finite, > 0 */
    const char *name;          /**< of mesh and animation, UTF-8; NULL: "" */
} sph_io_frames;

/**
 * @brief Saves frames as a `.glb` that any viewer of glTF plays: the first frame as a mesh, the others as morph targets
 * that an animation shows one after another, blended in between.
 * @param[in] context  takes the message of a failure.
 * @retval SPH_E_INVALID  NULL, a count or rate out of range, an index out of range, or a position that is not finite.
 * @retval SPH_E_LIMIT    more than 4096 frames or 4 GB.
 * @retval SPH_E_IO       the file cannot be written: the message has the path and the reason.
 * @retval SPH_E_NOMEM    out of memory.
 * @since 0.1
 */
SPH_API sph_status sph_io_save_frames_glb(sph_context *context, const sph_io_frames *frames, const char *path);

/** @brief Saves the implicit skin of a rig as a `.sphm` file. @retval SPH_E_IO the message has the path and the reason.
 * @since 0.1 */
SPH_API sph_status sph_io_save_implicit(sph_context *context, const sph_implicit *implicit, const char *path);
/** @brief Loads an implicit skin from a `.sphm` file; errors as sph_implicit_read() and SPH_E_IO. @since 0.1 */
SPH_API sph_status sph_io_load_implicit(sph_context *context, const char *path, sph_implicit **out);

SPH_END_DECLS

#endif
