/* SPDX-License-Identifier: MIT */
/*
 * What the files of the Alembic reader share: from the groups and data of an Ogawa file to the vertices of a frame. All
 * of it stays in the mapped file; only what is made of it takes memory.
 */
#ifndef SPH_IO_ALEMBIC_H
#define SPH_IO_ALEMBIC_H

#include "io/affine.h"
#include "io/io.h"

#define SPH__ABC_NONE UINT32_MAX

/* --- the file: groups of groups and data (alembic_ogawa.c) --- */

typedef struct sph__abc_bytes {
    const unsigned char *p;
    size_t size;
} sph__abc_bytes;

typedef struct sph__abc_group {
    uint64_t place, count; /* of its children */
} sph__abc_group;

/* When the samples of a property are: `count` stored times, repeated after `period`; infinite: no more than these. */
typedef struct sph__abc_sampling {
    double period;
    uint32_t count;
    const unsigned char *times;
    const char *fault; /* NULL: none */
} sph__abc_sampling;

enum { SPH__ABC_METADATA_MAX = 256, SPH__ABC_DEPTH_MAX = 128 };

typedef struct sph__abc_file {
    sph_context *context; /* not retained */
    char *path;
    sph__io_map map; /* borrowed */
    uint64_t budget; /* bytes that may still be made from the file */
    uint64_t work; /* bytes of headers that may still be looked through: a file may lead to the same ones many times */
    uint32_t version;
    sph__abc_bytes about; /* "key=value;key=value" */
    sph__abc_bytes metadata[SPH__ABC_METADATA_MAX];
    unsigned metadata_count;
    sph__abc_sampling *samplings;
    uint32_t sampling_count;
    sph__abc_group top;
} sph__abc_file;

/* Header, version, samplings, metadata. Where it fails the file is closed. */
sph_status sph__abc_file_open(sph_context *context, const char *path, const sph__io_map *map, sph__abc_file *f);
void sph__abc_file_close(sph__abc_file *f);
/* "path: byte N: what", SPH_E_FORMAT. */
sph_status sph__abc_fail(const sph__abc_file *f, uint64_t place, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
bool sph__abc_is_group(const sph__abc_file *f, const sph__abc_group *group, uint64_t child);
sph_status sph__abc_child_group(const sph__abc_file *f, const sph__abc_group *group, uint64_t child,
                                sph__abc_group *out);
sph_status sph__abc_child_data(const sph__abc_file *f, const sph__abc_group *group, uint64_t child,
                               sph__abc_bytes *out);
/* Takes from what may be made, or looked through. */
sph_status sph__abc_charge(sph__abc_file *f, uint64_t count, uint64_t size);
sph_status sph__abc_charge_work(sph__abc_file *f, uint64_t size);
/* The value of a key of metadata; size 0 where it is missing. */
sph__abc_bytes sph__abc_value(sph__abc_bytes metadata, const char *key);
bool sph__abc_begins(sph__abc_bytes text, const char *with);
bool sph__abc_equals(sph__abc_bytes text, const char *with);
/* A copy that ends with '\0', to be released; NULL when out of memory. */
char *sph__abc_copy(const sph__abc_file *f, sph__abc_bytes text);

/* --- headers (alembic_property.c) --- */

/* Numbers, from the place `at` of some bytes. */
typedef struct sph__abc_cursor {
    sph__abc_bytes bytes;
    size_t at;
} sph__abc_cursor;
bool sph__abc_take(sph__abc_cursor *c, unsigned size, uint64_t *value);
bool sph__abc_take_bytes(sph__abc_cursor *c, uint64_t size, sph__abc_bytes *out);
uint64_t sph__abc_place(const sph__abc_file *f, const sph__abc_cursor *c);

enum { SPH__ABC_MISSING, SPH__ABC_COMPOUND, SPH__ABC_SCALAR, SPH__ABC_ARRAY };
enum {
    SPH__ABC_BOOL = 0,
    SPH__ABC_U8 = 1,
    SPH__ABC_I8 = 2,
    SPH__ABC_I32 = 6,
    SPH__ABC_F32 = 10,
    SPH__ABC_F64 = 11,
    SPH__ABC_STRING = 12
};

typedef struct sph__abc_property {
    int kind, type;
    unsigned extent;
    uint32_t sample_count, first_changed, last_changed; /* samples before the one and after the other repeat */
    uint32_t sampling;
    sph__abc_group group;
} sph__abc_property;

/* A property of a compound, by name; its kind is SPH__ABC_MISSING where there is none. */
sph_status sph__abc_find(sph__abc_file *f, const sph__abc_group *compound, const char *name, sph__abc_property *out);
/* The same, which must be of this kind, type and extent (0: any) if it is there. */
sph_status sph__abc_find_typed(sph__abc_file *f, const sph__abc_group *compound, const char *name, int kind, int type,
                               unsigned extent, sph__abc_property *out);
/* How many samples are stored, and which of them sample `i` is, and the first sample that a stored one is. */
uint32_t sph__abc_stored_count(const sph__abc_property *p);
uint32_t sph__abc_stored(const sph__abc_property *p, uint32_t i);
uint32_t sph__abc_first_of(const sph__abc_property *p, uint32_t stored);
/* The bytes of a stored sample. */
sph_status sph__abc_sample(const sph__abc_file *f, const sph__abc_property *p, uint32_t stored, sph__abc_bytes *out);

/* --- objects (alembic_object.c) --- */

enum { SPH__ABC_OTHER, SPH__ABC_XFORM, SPH__ABC_POLYMESH, SPH__ABC_SUBD };

typedef struct sph__abc_object {
    uint32_t parent, end; /* SPH__ABC_NONE: none; the object after all that is below it */
    int kind;
    bool hidden, chosen;
    sph__abc_bytes name, schema;
    sph__abc_group properties;
} sph__abc_object;

typedef struct sph__abc_objects {
    sph__abc_object *items; /* parents before children */
    size_t count, capacity;
} sph__abc_objects;

sph_status sph__abc_read_objects(sph__abc_file *f, sph__abc_objects *objects);
/* Marks the meshes at and below the object of that name or path; NULL: all that are not hidden. */
sph_status sph__abc_choose(sph__abc_file *f, sph__abc_objects *objects, const char *name);
/* "/a/b", to be released; NULL when out of memory. */
char *sph__abc_path(const sph__abc_file *f, const sph__abc_objects *objects, uint32_t object);
/* "path: /a/b: what". */
sph_status sph__abc_fail_object(const sph__abc_file *f, const sph__abc_objects *objects, uint32_t object,
                                sph_status status, const char *format, ...) __attribute__((format(printf, 5, 6)));

/* --- times (alembic_time.c) --- */

/* What is wrong with a sampling as such; NULL: nothing. */
const char *sph__abc_sampling_fault(const sph__abc_sampling *s);
/* That a property's sampling is there and has a time for each of its samples. */
sph_status sph__abc_check_sampling(const sph__abc_file *f, const sph__abc_property *p);
double sph__abc_time(const sph__abc_sampling *s, uint32_t i);
/* The sample at or before a time, and how far it is from there to the next. */
uint32_t sph__abc_locate(const sph__abc_file *f, const sph__abc_property *p, double time, double *share);

/* When frames are. */
typedef struct sph__abc_frames {
    uint32_t *counts; /* of each sampling: samples that frames are taken at */
    double start, end, fps;
    uint32_t count, single; /* the only sampling of them, or SPH__ABC_NONE */
    double *times;          /* of frames, where there are several samplings */
    size_t time_capacity;
} sph__abc_frames;

sph_status sph__abc_frames_start(sph__abc_file *f, sph__abc_frames *frames);
/* Has frames at the samples of a property, if they differ; it has been checked. */
void sph__abc_frames_add(sph__abc_frames *frames, const sph__abc_property *p);
/* Fps 0: where there are samples. `still` is the time of the frame of what never changes. */
sph_status sph__abc_frames_finish(sph__abc_file *f, sph__abc_frames *frames, double fps, double still);
double sph__abc_frame_time(const sph__abc_file *f, const sph__abc_frames *frames, uint32_t frame);
void sph__abc_frames_release(const sph__abc_file *f, sph__abc_frames *frames);

/* --- transforms (alembic_xform.c) --- */

typedef struct sph__abc_xform {
    uint32_t object, parent; /* the transform above it in the list; SPH__ABC_NONE: none */
    sph__abc_bytes ops;
    uint32_t value_count;
    sph__abc_property values, inherits;
    bool roots;     /* it takes nothing from what is above it */
    bool switches;  /* it does so in some samples */
    bool placement; /* shared by all, the same in all frames, and left out */
    sph__io_affine global;
} sph__abc_xform;

sph_status sph__abc_read_xform(sph__abc_file *f, const sph__abc_objects *objects, uint32_t object, sph__abc_xform *x);
bool sph__abc_xform_moves(const sph__abc_xform *x);
/* Sets the global matrix of each; parents come first. */
sph_status sph__abc_pose(const sph__abc_file *f, sph__abc_xform *xforms, size_t count, double time);

/* --- meshes (alembic_mesh.c) --- */

typedef struct sph__abc_mesh {
    uint32_t object, xform; /* the transform above it in the list; SPH__ABC_NONE: none */
    sph__abc_property positions;
    size_t vertex_count, face_count;
    size_t first_vertex, first_triangle, triangle_count;
} sph__abc_mesh;

/* Positions and counts of a mesh object, without its faces. */
sph_status sph__abc_read_mesh(sph__abc_file *f, const sph__abc_objects *objects, uint32_t object, sph__abc_mesh *m);
/* Checks that its topology does not change, and adds its triangles. */
sph_status sph__abc_read_faces(sph__abc_file *f, const sph__abc_objects *objects, sph__abc_mesh *m, sph__io_mesh *mesh);
/* Its vertices at a time, moved by `matrix`. */
sph_status sph__abc_read_positions(const sph__abc_file *f, const sph__abc_mesh *m, double time,
                                   const sph__io_affine *matrix, float *xyz);

#endif
