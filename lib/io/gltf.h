/* SPDX-License-Identifier: MIT */
/* What the files of the glTF reader share: from JSON and buffers to the vertices of a frame. */
#ifndef SPH_IO_GLTF_H
#define SPH_IO_GLTF_H

#include "io/affine.h"
#include "io/gltf_types.h"
#include "io/io.h"

#define SPH__GLTF_NONE UINT32_MAX

/* --- the document: JSON as a tree, and the buffers (gltf_json.c, gltf_document.c) --- */

/* A value of the JSON; an object's members are names and values in turn. Value 0 is the whole, so it is no member. */
typedef struct sph__gltf_value {
    uint32_t begin; /* byte of the JSON */
    uint32_t next;  /* the value after this one and all that is in it */
    uint32_t count; /* members or elements */
    char kind;      /* its first character; '0' for all numbers */
} sph__gltf_value;

/* Elements of the arrays at the top, by number. */
enum {
    SPH__GLTF_ACCESSORS,
    SPH__GLTF_ANIMATIONS,
    SPH__GLTF_BUFFERS,
    SPH__GLTF_VIEWS,
    SPH__GLTF_MESHES,
    SPH__GLTF_NODES,
    SPH__GLTF_SCENES,
    SPH__GLTF_SKINS,
    SPH__GLTF_LISTS
};

typedef struct sph__gltf_list {
    uint32_t *values;
    uint32_t count;
} sph__gltf_list;

typedef struct sph__gltf_buffer {
    const unsigned char *bytes; /* NULL: not looked for yet */
    size_t size;
    unsigned char *decoded; /* from a data: URI */
    sph__io_map map;        /* of a file of its own */
} sph__gltf_buffer;

typedef struct sph__gltf_document {
    sph_context *context; /* not retained */
    const char *path;
    const sph__io_map *map;
    const char *text, *text_end;
    const unsigned char *binary; /* the second chunk of a GLB; NULL: none */
    size_t binary_size;
    sph__gltf_value *values;
    size_t value_count, value_capacity;
    sph__gltf_list lists[SPH__GLTF_LISTS];
    sph__gltf_buffer *buffers;
    uint64_t budget; /* bytes that arrays made from the file may still take */
} sph__gltf_document;

sph_status sph__gltf_document_open(sph_context *context, const char *path, const sph__io_map *map,
                                   sph__gltf_document *d);
void sph__gltf_document_close(sph__gltf_document *d);

sph_status sph__gltf_parse(sph__gltf_document *d);
/* "path: byte of the value: ...", SPH_E_FORMAT. */
sph_status sph__gltf_fail(const sph__gltf_document *d, uint32_t value, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* A member of an object; 0 where there is none. */
uint32_t sph__gltf_get(const sph__gltf_document *d, uint32_t object, const char *name);
/* The same, which must be of the kind '{', '[' or '"'; *value is 0 where there is none. */
sph_status sph__gltf_get_kind(const sph__gltf_document *d, uint32_t object, const char *name, char kind,
                              uint32_t *value);
/* What is missing stays what it was. */
sph_status sph__gltf_get_unsigned(const sph__gltf_document *d, uint32_t object, const char *name, uint64_t *number);
sph_status sph__gltf_get_numbers(const sph__gltf_document *d, uint32_t object, const char *name, uint32_t count,
                                 double *numbers);
/* The number of an element of a list, checked; SPH__GLTF_NONE where it is missing. */
sph_status sph__gltf_get_index(const sph__gltf_document *d, uint32_t object, const char *name, int list,
                               uint32_t *index);
sph_status sph__gltf_read_index(const sph__gltf_document *d, uint32_t value, int list, uint32_t *index);
/* Whether a string is this one. */
bool sph__gltf_is(const sph__gltf_document *d, uint32_t value, const char *text);
/* The text of a value, as it is in the file. */
sph_status sph__gltf_get_text(const sph__gltf_document *d, uint32_t value, const char **text, size_t *length);
/* A string, decoded; sph_context_release() it. */
sph_status sph__gltf_copy_text(const sph__gltf_document *d, uint32_t value, char **text);

/*
 * Memory for `count` elements made from the file. A small file may name the same bytes many times over: what it makes
 * of them has a limit.
 */
sph_status sph__gltf_allocate(sph__gltf_document *d, size_t count, size_t size, void *out);
/* Maps a file beside the glTF by its URI, which is decoded in place. */
sph_status sph__gltf_map_file(const sph__gltf_document *d, uint32_t value, char *uri, sph__io_map *map);
/* The bytes of a buffer. */
sph_status sph__gltf_buffer_bytes(sph__gltf_document *d, uint32_t index, const unsigned char **bytes, size_t *size);
sph_status sph__gltf_decode_base64(const sph__gltf_document *d, uint32_t value, const char *text,
                                   sph__gltf_buffer *buffer);

/* --- accessors (gltf_accessor.c) --- */

typedef struct sph__gltf_accessor {
    uint32_t value;             /* in the JSON */
    const unsigned char *bytes; /* NULL: zeros */
    size_t stride, component_size;
    uint32_t count, width; /* elements; components of each */
    int type;              /* of the components */
    bool normalized;
    uint32_t sparse_count;
    int sparse_type;
    const unsigned char *sparse_indices, *sparse_values;
} sph__gltf_accessor;

/* Checks all of it against its buffers. `width` is the number of components that is needed; 0: any. */
sph_status sph__gltf_accessor_open(sph__gltf_document *d, uint32_t index, uint32_t width, sph__gltf_accessor *a);
/* Element `i` as numbers, normalised integers divided. */
void sph__gltf_accessor_floats(const sph__gltf_accessor *a, uint32_t i, float *out);
/* Element `i` of an accessor of unsigned integers. */
void sph__gltf_accessor_integers(const sph__gltf_accessor *a, uint32_t i, uint32_t *out);

/* --- the scene (gltf_nodes.c, gltf_mesh.c) --- */

enum { SPH__GLTF_TRANSLATION, SPH__GLTF_ROTATION, SPH__GLTF_SCALE, SPH__GLTF_WEIGHTS };
enum { SPH__GLTF_STEP, SPH__GLTF_LINEAR, SPH__GLTF_CUBIC };

typedef struct sph__gltf_node {
    uint32_t parent, first_child, sibling; /* SPH__GLTF_NONE: none */
    uint32_t mesh, skin;
    uint32_t first_weight, weight_count; /* of the mesh's morph targets */
    bool has_matrix;
    sph__io_affine matrix;
    double rest[10], now[10]; /* translation, rotation x y z w, scale */
} sph__gltf_node;

/* What moves vertices: a joint of a skin, or a node with a mesh that has none. */
typedef struct sph__gltf_bone {
    uint32_t node;
    sph__io_affine bind; /* from the mesh to the joint */
} sph__gltf_bone;

/* Where what a primitive at a node adds begins. */
typedef struct sph__gltf_part {
    size_t first_vertex, first_triangle;
    uint32_t node, primitive; /* the latter in the JSON */
    uint32_t *used;           /* [used_count]: which of the primitive's vertices they are */
    size_t used_count;
    bool mirrored; /* its triangles were turned round */
} sph__gltf_part;

typedef struct sph__gltf_influence {
    uint32_t bone;
    float weight;
} sph__gltf_influence;

typedef struct sph__gltf_delta {
    uint32_t vertex;
    float xyz[3];
} sph__gltf_delta;

/* A morph target of a part of the mesh. */
typedef struct sph__gltf_target {
    uint32_t weight; /* which of the scene's weights */
    size_t first, count;
} sph__gltf_target;

typedef struct sph__gltf_clip {
    char *name;
    double duration; /* seconds */
} sph__gltf_clip;

typedef struct sph__gltf_channel {
    uint32_t node;
    int path, interpolation; /* of the names above */
    uint32_t key_count, width;
    float *times, *values;
} sph__gltf_channel;

/* The frames of a clip. */
typedef struct sph__gltf_run {
    uint32_t clip, first_frame, frame_count;
    size_t first_channel, channel_count;
} sph__gltf_run;

struct sph__io_gltf {
    sph_context *context; /* not retained */
    double fps;
    sph__gltf_node *nodes;
    uint32_t node_count;
    uint32_t *order; /* nodes, parents before children */
    uint32_t *drawn; /* nodes of the scene with a mesh, in the order of the scene */
    uint32_t drawn_count;
    sph__io_affine *globals; /* of nodes */
    sph__gltf_bone *bones;
    sph__io_affine *palette; /* of bones */
    size_t bone_count, bone_capacity;
    uint32_t *skin_bones; /* where each skin's joints begin; SPH__GLTF_NONE: not read */
    double *weights_rest, *weights;
    uint32_t weight_count;
    sph__gltf_part *parts;
    size_t part_count, part_capacity;
    size_t vertex_count;
    float *positions, *morphed;
    size_t *first_influence; /* [vertex_count + 1] */
    size_t first_influence_capacity;
    sph__gltf_influence *influences;
    size_t influence_count, influence_capacity;
    sph__gltf_target *targets;
    size_t target_count, target_capacity;
    sph__gltf_delta *deltas;
    size_t delta_count, delta_capacity;
    sph__gltf_clip *clips;
    uint32_t clip_count;
    sph__gltf_run *runs;
    uint32_t run_count, frame_count;
    sph__gltf_channel *channels;
    size_t channel_count, channel_capacity;
};

sph_status sph__gltf_read_nodes(sph__gltf_document *d, sph__io_gltf *g);
/* The first bone of a skin; reads it when it is first asked for. */
sph_status sph__gltf_read_skin(sph__gltf_document *d, sph__io_gltf *g, uint32_t skin, uint32_t *first, uint32_t *count);
sph_status sph__gltf_add_bone(sph__gltf_document *d, sph__io_gltf *g, const sph__gltf_bone *bone);
/* All meshes of the scene: triangles and edges go to `mesh`, the rest to the scene. */
sph_status sph__gltf_read_meshes(sph__gltf_document *d, sph__io_gltf *g, sph__io_mesh *mesh);
/* One more element at the end of an array of the scene. */
sph_status sph__gltf_push(sph__gltf_document *d, void *array, size_t *capacity, size_t count, size_t size);
/* Joints and weights, and morph targets, of the vertices `used` of a primitive, which begin at `first`. */
sph_status sph__gltf_read_influences(sph__gltf_document *d, sph__io_gltf *g, uint32_t primitive,
                                     const sph__gltf_node *node, const uint32_t *used, size_t used_count,
                                     uint32_t vertex_count);
sph_status sph__gltf_read_targets(sph__gltf_document *d, sph__io_gltf *g, uint32_t primitive,
                                  const sph__gltf_node *node, const uint32_t *used, size_t used_count,
                                  uint32_t vertex_count, size_t first);

/* --- clips (gltf_clip.c, gltf_sample.c) and poses (gltf_pose.c) --- */

sph_status sph__gltf_read_clips(sph__gltf_document *d, sph__io_gltf *g);
uint32_t sph__gltf_frames_of(const sph__gltf_clip *clip, double fps);
/* Chooses the clips to play and reads their channels. `name` NULL: all. */
sph_status sph__gltf_choose_clips(sph__gltf_document *d, sph__io_gltf *g, const char *name);
/* `out`: as many as the channel is wide. */
void sph__gltf_sample(const sph__gltf_channel *c, double time, double *out);

/* A document's scene, mesh and chosen clips; close what is there after failure too. As sph__io_gltf_open(). */
sph_status sph__gltf_open_scene(sph__gltf_document *d, double fps, const char *clip, sph__io_mesh *mesh,
                                sph__io_gltf **out);
/* Sets all nodes, bones and weights for a time of a run; NULL: at rest. */
void sph__gltf_pose(sph__io_gltf *g, const sph__gltf_run *run, double time);
/* The same for a frame, counted over all runs. */
void sph__gltf_pose_frame(sph__io_gltf *g, uint32_t frame);
/* Positions with the morph targets of the pose added, before bones move them; they belong to the scene. */
const float *sph__gltf_morph(sph__io_gltf *g);
/* The vertices of the pose. */
void sph__gltf_skin(sph__io_gltf *g, float *xyz);

#endif
