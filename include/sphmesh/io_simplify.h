/* SPDX-License-Identifier: MIT */
/**
 * @file io_simplify.h
 * @brief Part of io.h: levels of detail of a rigged glTF, as files that keep all else that it has.
 */
#ifndef SPHMESH_IO_SIMPLIFY_H
#define SPHMESH_IO_SIMPLIFY_H

#include "io_rig.h"

SPH_BEGIN_DECLS

/** Handle: all levels of the rigged meshes of a file. The file stays mapped until it is destroyed. */
typedef struct sph_io_rig_levels sph_io_rig_levels;

/**
 * @brief Reads a glTF and simplifies the meshes of its scene together.
 *
 * Vertices and triangles are those of sph_io_open_rig(). Normals, tangents, texture coordinates, colours, attributes of
 * the file's own and morph targets go along; meshes of different skins stay apart where they touch.
 * @param[in]  rig      the frames that are example poses; may be NULL: all clips.
 * @param[in]  options  may be NULL: all defaults. Its normals, attributes and groups must be NULL: they are the file's.
 * @param[out] out      owned by the caller; NULL on failure.
 * @retval SPH_E_INVALID      NULL, or bad options.
 * @retval SPH_E_UNSUPPORTED  the file is no glTF, or draws instances of a mesh.
 * @return otherwise as sph_io_open_rig() and sph_progressive_create().
 * @since 0.1
 */
SPH_API sph_status sph_io_open_rig_levels(sph_context *context, const char *path, const sph_io_open_rig_options *rig,
                                          const sph_simplify_options *options, sph_io_rig_levels **out);

/** @brief Destroys them. NULL is fine. @since 0.1 */
SPH_API void sph_io_rig_levels_destroy(sph_io_rig_levels *levels);

/** @brief The levels, borrowed until they are destroyed; NULL for NULL. @since 0.1 */
SPH_API const sph_progressive *sph_io_rig_levels_progressive(const sph_io_rig_levels *levels);

/** @brief The file's rig as it is read, borrowed until the levels are destroyed; NULL for NULL. @since 0.1 */
SPH_API const sph_io_rig *sph_io_rig_levels_rig(const sph_io_rig_levels *levels);

/**
 * @brief Writes the file with its meshes at a level, or at several: as a .glb whose materials, images, skins, clips and
 * nodes are those of the file.
 *
 * Of several levels, finest first, the first is what the scene draws; the others are nodes that it names by the
 * extension MSFT_lod, with the share of the screen below which each is good enough (its error is a pixel of 1080 rows).
 * Meshes that a level leaves no triangles are left out of it. Images beside the file are taken in where the new file is
 * in another folder.
 * @param[in] level_numbers  shape (level_count), as sph_progressive_level::collapse_count; rising.
 * @param[in] level_count    from 1 to 64.
 * @retval SPH_E_INVALID      NULL, or levels that there are not, or that do not rise.
 * @retval SPH_E_UNSUPPORTED  the name does not end in .glb.
 * @retval SPH_E_LIMIT        the file would be larger than 4 GB, or a level has no triangles left.
 * @retval SPH_E_IO           it cannot be written: the message has the path and the reason.
 * @retval SPH_E_NOMEM        out of memory.
 * @since 0.1
 */
SPH_API sph_status sph_io_rig_levels_save(const sph_io_rig_levels *levels, const uint32_t *level_numbers,
                                          size_t level_count, const char *path);

SPH_END_DECLS

#endif
