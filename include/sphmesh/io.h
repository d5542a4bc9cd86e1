/* SPDX-License-Identifier: MIT */
/**
 * @file io.h
 * @brief libsphmesh-io: files in and out. Everything it does a caller of the core could do.
 *
 * Paths are UTF-8, as the operating system takes them. Every reader checks counts against the file's size before it
 * allocates, and says in the message which file, line or byte it refuses. Writers write a temporary file beside the target and rename it,
 * so that a target is either whole or untouched.
 */
#ifndef SPHMESH_IO_H
#define SPHMESH_IO_H

#include "io_rig.h"
#include "io_simplify.h"
#include "sphmesh.h"

#include "spill.h"

SPH_BEGIN_DECLS

/** Axis that points up in a file; positions are turned so that y is up. */
enum { SPH_UP_Y = 0, SPH_UP_Z = 1 };

/**
 * Whether vertices that coincide in all frames become one (sph_animation_weld() without tolerance; the frames are then held in
 * memory). Auto welds a glTF whose own animation is read, as that format splits vertices along seams of texture and normals.
 */
enum {
    SPH_IO_WELD_AUTO = 0, /**< a glTF's own animation only; default */
    SPH_IO_WELD_NONE = 1, /**< never */
    SPH_IO_WELD_ALL = 2   /**< always */
};

/**
 * What an Alembic's transforms do. Local: transforms that are above all chosen meshes and never change are left out, as
 * they only place the whole in a scene, in its units and axes: one mesh that nothing moves gives the numbers that the file
 * has for it. World: all are applied.
 */
enum { SPH_IO_SPACE_LOCAL = 0, SPH_IO_SPACE_WORLD = 1 };

/** Options of sph_io_open_animation(). Fill with sph_io_open_options_init() first. */
typedef struct sph_io_open_options {
    uint32_t struct_size;   /**< bytes the caller knows of; written by the initialiser */
    uint32_t flags;         /**< must be 0 */
    const char *cache_path; /**< a PC2 or MDD point cache with the mesh's frames; NULL: none */
    uint32_t first_frame;   /**< A of --frames A:B:STEP; default 0 */
    uint32_t end_frame;     /**< B: the first frame not taken; 0 (default): all */
    uint32_t frame_step;    /**< default 1; > 0 */
    int32_t up_axis;        /**< one of SPH_UP_*; default y: positions are left as they are. z: (x, y, z) becomes (x, z, -y) */
    double scale;           /**< positions are multiplied by it; finite, not 0; default 1 */
    double fps;             /**< frames per second that a glTF is baked, or an Alembic is taken at; finite, >= 0;
                                 default 0: 30 of a glTF, the samples of an Alembic as they are */
    const char *clip;       /**< the animation of a glTF to bake, by name, or by number from 0; NULL: all, one after another */
    int32_t weld;           /**< one of SPH_IO_WELD_*; default auto */
    int32_t space;          /**< one of SPH_IO_SPACE_*, of an Alembic; default local */
    const char *object;     /**< the object of an Alembic to take, with all below it: its path ("/a/b") or its name; NULL: all
                                 meshes that are not hidden */
} sph_io_open_options;

/** @brief Fills `options` with the defaults. Call as `sph_io_open_options_init(&o, sizeof o)`. @since 0.1 */
SPH_API void sph_io_open_options_init(sph_io_open_options *options, size_t size);

/**
 * @brief Opens an animation: one mesh with a point cache, or a sequence of meshes, or one mesh alone (one frame).
 *
 * A glTF alone is baked: frame i of a clip is its pose i / fps seconds after the clip's start, up to the clip's end; without
 * clips it is its pose at rest. With a cache, or as one of a sequence, a glTF is the mesh at rest.
 *
 * An Alembic (Ogawa) alone has a frame wherever its meshes, or the transforms above them, have a sample; at a rate of the
 * caller's it is interpolated linearly between samples. Its faces, clockwise in the file, are turned.
 *
 * A sequence is several paths (or one glob such as `s*.obj`, or one printf pattern such as `s%04d.obj`), taken in natural
 * order: s2 before s10. All meshes of a sequence must have the vertex count, triangles and edges of the first; they are
 * checked here, and again when a frame is read, one file at a time. Point caches are memory-mapped, and read as frames are
 * asked for, as Alembic archives are: they must not be made shorter while the animation lives. Values that are not finite are left to
 * sph_animation_check() and the calls that use them. docs/formats.md says what is read of each format.
 * @param[in]  paths       path_count paths; more than one must not come with a cache.
 * @param[in]  options     may be NULL: all defaults.
 * @param[out] out         owned by the caller; NULL on failure.
 * @retval SPH_E_INVALID      NULL, no path, bad options.
 * @retval SPH_E_IO           a file cannot be opened or read; the message has the system's reason.
 * @retval SPH_E_FORMAT       a file is damaged or not what its name says; a mesh and a cache, or two meshes of a sequence,
 *                            do not belong together: the message says both counts.
 * @retval SPH_E_UNSUPPORTED  a format or a feature that is not read.
 * @retval SPH_E_NOMEM        out of memory.
 * @retval SPH_E_CANCELLED    progress asked to stop.
 * @since 0.1
 */
SPH_API sph_status sph_io_open_animation(sph_context *context, const char *const *paths, size_t path_count,
                                         const sph_io_open_options *options, sph_animation **out);

/** What a path stands for. */
typedef struct sph_io_description {
    uint32_t struct_size; /**< bytes that the library fills */
    uint32_t file_count;  /**< 1, or how many files a glob or pattern stands for */
    const char *format;   /**< "OBJ", "PLY", "Alembic", "PC2", ...; never freed */
    uint32_t point_count; /**< of a point cache; else 0 */
    uint32_t frame_count; /**< of a point cache; else 0 */
} sph_io_description;

/**
 * @brief Tells what a file is, or the first of those that a glob or pattern stands for, by content and name, also of formats
 * that are not read.
 * @param[out] out  untouched on failure.
 * @retval SPH_E_INVALID, SPH_E_IO, SPH_E_NOMEM  as sph_io_open_animation().
 * @retval SPH_E_FORMAT       a damaged point cache.
 * @retval SPH_E_UNSUPPORTED  not a format that is known.
 * @since 0.1
 */
SPH_API sph_status sph_io_describe(sph_context *context, const char *path, sph_io_description *out);

/** A clip (an "animation") of a glTF. */
typedef struct sph_io_clip {
    uint32_t struct_size; /**< bytes that the library fills */
    uint32_t frame_count; /**< when baked at the frames per second asked for */
    const char *name;     /**< UTF-8; "" where it has none; borrowed for the call */
    double duration;      /**< seconds: the time of its last key */
} sph_io_clip;

/** Is told of one clip. */
typedef void sph_io_clip_fn(void *user, const sph_io_clip *clip);

/**
 * @brief Tells of each clip of a file, in the file's order. Files of other formats than glTF have none.
 * @param[in] fps  frames per second to count frames at; 0: 30.
 * @retval SPH_E_INVALID, SPH_E_IO, SPH_E_FORMAT, SPH_E_UNSUPPORTED, SPH_E_LIMIT, SPH_E_NOMEM  as sph_io_open_animation().
 * @since 0.1
 */
SPH_API sph_status sph_io_list_clips(sph_context *context, const char *path, double fps, sph_io_clip_fn *visit,
                                     void *user);

/** What an Alembic archive says of itself; texts are UTF-8, "" where there is none, and borrowed for the call. */
typedef struct sph_io_archive {
    uint32_t struct_size;    /**< bytes that the library fills */
    uint32_t version;        /**< of the library that wrote it: 10508 is 1.5.8 */
    const char *application; /**< the program that wrote it */
    const char *library;     /**< the library, as it names itself */
    const char *date;        /**< when it was written */
    const char *description; /**< what its author wrote about it */
} sph_io_archive;

/** An object of an Alembic archive. */
typedef struct sph_io_object {
    uint32_t struct_size;  /**< bytes that the library fills */
    uint32_t sample_count; /**< of its positions or its transform; 1 where they do not change */
    const char *path;      /**< as "/a/b"; borrowed for the call, as is the next */
    const char *kind;      /**< "PolyMesh", "SubD", "Xform", or what else the file calls it */
    uint64_t vertex_count; /**< 0 for what is no mesh */
    uint64_t face_count;   /**< 0 for what is no mesh */
    double first_time;     /**< of its first sample, seconds; 0 with one sample */
    double last_time;      /**< of its last sample, seconds; 0 with one sample */
    uint32_t chosen;       /**< 1: a mesh that is read */
    uint32_t hidden;       /**< 1: hidden in all its samples, by itself or by what is above it */
} sph_io_object;

/** Is told of an archive. */
typedef void sph_io_archive_fn(void *user, const sph_io_archive *archive);
/** Is told of one object. */
typedef void sph_io_object_fn(void *user, const sph_io_object *object);

/**
 * @brief Tells of an Alembic archive and each of its objects, parents before children. Files of other formats have none.
 * @param[in] object   as in sph_io_open_options: which meshes are chosen.
 * @param[in] archive  may be NULL, as may `visit`.
 * @retval SPH_E_INVALID, SPH_E_IO, SPH_E_FORMAT, SPH_E_UNSUPPORTED, SPH_E_LIMIT, SPH_E_NOMEM  as sph_io_open_animation().
 * @since 0.1
 */
SPH_API sph_status sph_io_list_objects(sph_context *context, const char *path, const char *object,
                                       sph_io_archive_fn *archive, sph_io_object_fn *visit, void *user);

/**
 * @brief Sorts names in natural order, in place: digits compare as numbers, so that s2 comes before s10.
 * @since 0.1
 */
SPH_API void sph_io_sort_natural(const char **names, size_t count);

/**
 * @brief Writes the animation's first frame, triangles and additional edges as OBJ, and all its frames as a PC2 cache.
 * @param[in] context            takes the message of a failure; best the one that the animation was made with.
 * @param[in] first_frame        the cache's start frame, as its readers show it; finite; as a rule 0.
 * @param[in] frames_per_sample  the cache's sampling: frames of the reading program from one frame here to the next; finite
 *                               and > 0; as a rule 1. The format holds no frames per second.
 * @retval SPH_E_INVALID    NULL, a number out of range, or both paths are the same.
 * @retval SPH_E_IO         a file cannot be written: the message has the path and the system's reason.
 * @retval SPH_E_NOMEM      out of memory.
 * @retval SPH_E_CANCELLED  progress asked to stop.
 * @return otherwise what the frame source returned. Whatever fails, no file is left half written.
 * @since 0.1
 */
SPH_API sph_status sph_io_save_obj_pc2(sph_context *context, const sph_animation *animation, double first_frame,
                                       double frames_per_sample, const char *obj_path, const char *pc2_path);

/**
 * @brief Writes the animation's first frame, triangles and additional edges as OBJ, and all its frames as an MDD cache.
 * @param[in] context            as for sph_io_save_obj_pc2(), as are the errors.
 * @param[in] first_second       time of the first frame; finite; as a rule 0.
 * @param[in] frames_per_second  finite and > 0; the format holds the time of each frame.
 * @since 0.1
 */
SPH_API sph_status sph_io_save_obj_mdd(sph_context *context, const sph_animation *animation, double first_second,
                                       double frames_per_second, const char *obj_path, const char *mdd_path);

/** What a `.sphm` file holds. */
enum { SPH_IO_HIERARCHY = 1, SPH_IO_LEVEL = 2, SPH_IO_IMPLICIT = 3 };

/**
 * @brief Tells what a file made by the functions below holds, without reading all of it.
 * @param[out] kind  one of SPH_IO_HIERARCHY, SPH_IO_LEVEL, SPH_IO_IMPLICIT; untouched on failure.
 * @retval SPH_E_IO, SPH_E_FORMAT, SPH_E_VERSION
 * @since 0.1
 */
SPH_API sph_status sph_io_identify(sph_context *context, const char *path, int32_t *kind);

/** @brief Saves a hierarchy as a `.sphm` file. @retval SPH_E_IO the message has the path and the reason. @since 0.1 */
SPH_API sph_status sph_io_save_hierarchy(sph_context *context, const sph_hierarchy *hierarchy, const char *path);
/** @brief Loads a hierarchy from a `.sphm` file; errors as sph_hierarchy_read() and SPH_E_IO. @since 0.1 */
SPH_API sph_status sph_io_load_hierarchy(sph_context *context, const char *path, sph_hierarchy **out);

/**
 * @brief Saves a level; the name's ending says how: `.sphm`, `.json` (docs/formats.md), frame 0 alone as `.obj` or `.ply`
 *        (centres as vertices, triangles as faces, wire edges as lines or edges, radii as comments or a property), or `.glb`
 *        (a preview that any viewer of glTF plays at 30 frames per second; at most 65535 spheres).
 * @retval SPH_E_LIMIT        more spheres or bytes than a `.glb` can have.
 * @retval SPH_E_UNSUPPORTED  another ending.
 * @since 0.1
 */
SPH_API sph_status sph_io_save_level(sph_context *context, const sph_level *level, const char *path);
/**
 * @brief Saves one frame of a surface with its normals; the name's ending says how: `.obj`, `.ply` (binary), or `.glb`.
 * @param[in] context  takes the message of a failure.
 * @param[in] index    which of the frames that were extracted.
 * @retval SPH_E_INVALID      NULL or an index out of range.
 * @retval SPH_E_UNSUPPORTED  another ending.
 * @retval SPH_E_IO           the file cannot be written: the message has the path and the reason.
 * @retval SPH_E_NOMEM        out of memory.
 * @since 0.1
 */
SPH_API sph_status sph_io_save_surface(sph_context *context, const sph_surface *surface, uint32_t index,
                                       const char *path);
/** How a rig's weights are written. Whole numbers have a sum of exactly one, as floats do. */
enum { SPH_IO_WEIGHTS_FLOAT = 0, SPH_IO_WEIGHTS_U8 = 1, SPH_IO_WEIGHTS_U16 = 2 };

/** Options of sph_io_save_rig(). Fill with sph_io_rig_options_init() first. */
typedef struct sph_io_rig_options {
    uint32_t struct_size;     /**< bytes the caller knows of; written by the initialiser */
    uint32_t flags;           /**< must be 0 */
    int32_t weights;          /**< one of SPH_IO_WEIGHTS_*; default float */
    uint32_t reserved0;       /**< must be 0 */
    double frames_per_second; /**< of clips that do not know theirs; finite, > 0; default 30 */
} sph_io_rig_options;

/** @brief Fills `options` with the defaults. Call as `sph_io_rig_options_init(&o, sizeof o)`. @since 0.1 */
SPH_API void sph_io_rig_options_init(sph_io_rig_options *options, size_t size);

/**
 * @brief Saves a skin as a skinned, animated glTF 2.0: `.glb`, or `.gltf` with its buffer as `.bin` beside it.
 *
 * Mesh with normals of the rest pose, joints as nodes that hang on one another, inverse bind matrices, and for each clip an
 * animation with a key for each frame and bone. docs/formats.md has the details. What is rounded to floats in a joint is made
 * good by those that hang on it, so that a long chain is as exact as a short one.
 * @param[in] context   takes the message of a failure.
 * @param[in] skin      whose transforms are rigid.
 * @param[in] skeleton  of this skin; NULL: as sph_skeleton_create() makes it without options.
 * @param[in] options   may be NULL: all defaults.
 * @retval SPH_E_INVALID      NULL, bad options, a skeleton of another number of bones, or frames per second of a clip that are
 *                            not from 1e-6 to 1e6.
 * @retval SPH_E_UNSUPPORTED  another ending, or a transform that is not rigid; the message names bone and frame.
 * @retval SPH_E_LIMIT        more than 65536 joints, 4194304 frames in a clip, or 4 GB; a joint beyond what a float holds.
 * @retval SPH_E_IO           a file cannot be written: the message has the path and the reason.
 * @retval SPH_E_NOMEM        out of memory.
 * @retval SPH_E_CANCELLED    progress asked to stop. Whatever fails, no file is left half written.
 * @since 0.1
 */
SPH_API sph_status sph_io_save_rig(sph_context *context, const sph_skin *skin, const sph_skeleton *skeleton,
                                   const sph_io_rig_options *options, const char *path);
/** @brief Loads a level from `.sphm` or `.json`. @since 0.1 */
SPH_API sph_status sph_io_load_level(sph_context *context, const char *path, sph_level **out);

/**
 * What sph_io_export_level() writes; docs/formats.md has them field by field. `PRIMITIVES` (.json) and `GLB` hold many
 * frames; the others are one pose. `SRDF`, `YAML` (.yaml, .yml) and `URDF` know spheres only: there capsules and thick
 * triangles are made of many.
 */
enum {
    SPH_IO_EXPORT_BY_NAME = 0,    /**< as the name's ending says */
    SPH_IO_EXPORT_PRIMITIVES = 1, /**< JSON: spheres, tapered capsules and thick triangles, frame by frame */
    SPH_IO_EXPORT_MA = 2,         /**< text: a medial mesh, as Q-MAT and its relatives read it */
    SPH_IO_EXPORT_SRDF = 3,       /**< `link_sphere_approximation` of MoveIt */
    SPH_IO_EXPORT_YAML = 4,       /**< `collision_spheres` of cuRobo */
    SPH_IO_EXPORT_URDF = 5,       /**< a link whose collision shapes are spheres */
    SPH_IO_EXPORT_GLB = 6         /**< as sph_io_save_level(), with all primitives as `extras` of nodes */
};

/** Options of sph_io_export_level(). Fill with sph_io_export_options_init() first. */
typedef struct sph_io_export_options {
    uint32_t struct_size; /**< bytes the caller knows of; written by the initialiser */
    uint32_t flags;       /**< must be 0 */
    int32_t format;       /**< one of SPH_IO_EXPORT_*; default by name */
    uint32_t first_frame; /**< default 0; the pose of the formats that hold one */
    uint32_t frame_step;  /**< default 1; > 0 */
    uint32_t frame_limit; /**< at most so many frames; 0 (default): all, or the one that the format holds */
    uint32_t cover_solid; /**< of lists of spheres. 0 (default): spheres that lie in the solid, and reach to within `gap` of
                               all its points; 1: spheres that contain the solid, and reach at most `gap` beyond theirs */
    uint32_t reserved0;   /**< must be 0 */
    double gap;           /**< of lists of spheres; model units, finite, >= 0; 0 (default): 1/50 of the diagonal of the box
                               around the solid */
    const char *name;     /**< of the robot and of its link; printable ASCII without " ' < > & \\; NULL (default): sphmesh */
    const sph_coverage *coverage; /**< what the file shall say of the level's coverage; NULL (default): nothing */
} sph_io_export_options;

/** @brief Fills `options` with the defaults. Call as `sph_io_export_options_init(&o, sizeof o)`. @since 0.1 */
SPH_API void sph_io_export_options_init(sph_io_export_options *options, size_t size);

/** What was exported. */
typedef struct sph_io_export_report {
    uint32_t struct_size;    /**< sizeof(sph_io_export_report), set by the caller */
    uint32_t frame_count;    /**< frames written */
    uint64_t sphere_count;   /**< spheres of a list of spheres; of other formats those without edge and triangle */
    uint64_t capsule_count;  /**< 0 for lists of spheres */
    uint64_t triangle_count; /**< 0 for lists of spheres */
    double gap;              /**< of lists of spheres: a bound of the distance of any point of the solid to them, or where they
                                  cover the solid, of how far they reach beyond it; 0 for other formats */
} sph_io_export_report;

/**
 * @brief Writes a level for other tools.
 * @param[in]     options  may be NULL: all defaults.
 * @param[in,out] report   `struct_size` set by the caller; may be NULL; untouched on failure.
 * @retval SPH_E_INVALID      NULL or bad options; frames that the level has not.
 * @retval SPH_E_UNSUPPORTED  an ending that says no format.
 * @retval SPH_E_LIMIT        a million spheres would not do for the gap, or more than a `.glb` can have.
 * @retval SPH_E_IO           the file cannot be written: the message has the path and the reason.
 * @retval SPH_E_NOMEM        out of memory.
 * @since 0.1
 */
SPH_API sph_status sph_io_export_level(sph_context *context, const sph_level *level, const char *path,
                                       const sph_io_export_options *options, sph_io_export_report *report);

SPH_END_DECLS

#endif
