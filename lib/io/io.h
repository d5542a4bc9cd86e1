/* SPDX-License-Identifier: MIT */
/* Internal door of the second library, libsphmesh-io. It sees the public headers of the core only. */
#ifndef SPH_IO_INTERNAL_H
#define SPH_IO_INTERNAL_H

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <sphmesh/io.h>

/* --- messages, memory --- */

/* Stores the calling thread's message and returns `status`. */
sph_status sph__io_fail(sph_context *context, sph_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
sph_status sph__io_fail_memory(sph_context *context, const char *path);
/* "path: what: the reason of errno", SPH_E_IO. */
sph_status sph__io_fail_system(sph_context *context, const char *path, const char *what);
/* A path as messages show it: the end of a long one, so that the reason after it is not cut off. */
const char *sph__io_shown(const char *path);
/* Makes room for `need` elements of `size` bytes in the growing array *memory of *capacity; false when out of memory.
 */
bool sph__io_reserve(sph_context *context, void **memory, size_t *capacity, size_t need, size_t size);
/* A copy of a string; NULL when out of memory. */
char *sph__io_copy_string(sph_context *context, const char *text);
/* Whether a name ends in `.ending`, in any case of letters. */
bool sph__io_has_ending(const char *path, const char *ending);

/* Options that grow: as sph__options_init() and sph__options_read() of the core. */
void sph__io_options_init(void *options, size_t size, const void *defaults, size_t full, size_t least);
sph_status sph__io_options_read(sph_context *context, const char *name, const void *in, void *out, size_t full,
                                size_t least);

/*
 * --- handles --- Checked where the core's are (lib/base/base.h), and first in each public function. Of the core's handles
 * public functions tell nothing, neither vertices nor bytes, when they are of another kind or destroyed: these become NULL.
 * Handles of this library begin with a mark. The core keeps blocks that begin with SPH__IO_DESTROYED for a while.
 */
#if defined(SPH_HANDLE_CHECKS)
#  define SPH__IO_RIG UINT64_C(0x51f5696f52694701)
#  define SPH__IO_SPILL UINT64_C(0x51f5696f5370696c)
#  define SPH__IO_RIG_LEVELS UINT64_C(0x51f5696f6c65766c)
#  define SPH__IO_DESTROYED UINT64_C(0xdead5f6f6973f0e1)
#  define SPH__IO_MARK uint64_t mark;
#  define SPH__IO_SET_MARK(handle, value) ((handle)->mark = (value))
#  define SPH__IO_OWN(handle, tells) ((handle) = tells(handle) != 0 ? (handle) : NULL)
#  define SPH__IO_OWN_MARKED(handle, value) \
      ((handle) = (handle) != NULL && (handle)->mark == (value) ? (handle) : NULL)
#else
#  define SPH__IO_MARK
#  define SPH__IO_SET_MARK(handle, value) ((void)0)
#  define SPH__IO_OWN(handle, tells) ((void)0)
#  define SPH__IO_OWN_MARKED(handle, value) ((void)0)
#endif

/* --- numbers (number.c): decimal point whatever the locale --- */

/*
 * Reads a decimal number, or nan or inf as C or Windows write them, from [p, end), rounded to the nearest float, ties
 * to even. Returns the place after it, or NULL where there is none.
 */
const char *sph__io_parse_float(const char *p, const char *end, float *value);
enum { SPH__IO_FLOAT_TEXT = 24 };
/* Writes the shortest of the plain roundings that reads back to the same float; returns its length. Ends with '\0'. */
size_t sph__io_format_float(char text[SPH__IO_FLOAT_TEXT], float value);

/* --- a file's bytes, memory-mapped (map.c) --- */
typedef struct sph__io_map {
    const unsigned char *bytes; /* never NULL while open, also for an empty file */
    size_t size;
} sph__io_map;
sph_status sph__io_map_open(sph_context *context, const char *path, sph__io_map *map);
/* Zeroed and closed maps are fine. */
void sph__io_map_close(sph__io_map *map);
/* Gives back the memory of the pages within [begin, end); they come back from the file when they are looked at again.
 */
void sph__io_map_drop(const sph__io_map *map, size_t begin, size_t end);

/* --- meshes --- */
typedef struct sph__io_mesh {
    sph_context *context; /* not retained */
    float *positions;     /* [vertex_count][3] */
    uint32_t *triangles;  /* [triangle_count][3] */
    uint32_t *edges;      /* [edge_count][2] */
    size_t vertex_count, triangle_count, edge_count;
    size_t vertex_capacity, triangle_capacity, edge_capacity;
    bool binary;             /* places in the file are bytes, not lines */
    uint32_t first_index;    /* what the file calls the first vertex */
    uint32_t *corners;       /* where vertices were made by welding: the first corner of each */
    struct sph__io_mesh *to; /* the first mesh of the sequence that this one belongs to; NULL: it is the first */
    bool apart;              /* it has been said that welded corners come apart in a later mesh */
} sph__io_mesh;
void sph__io_mesh_release(sph__io_mesh *mesh);

/*
 * Reads the bytes of a mesh file over what `mesh` holds, keeping its memory. Where `watched` is not NULL, it is the
 * number of a triangle, and is replaced by the line or byte where that triangle stands, for messages.
 */
typedef sph_status sph__io_read_fn(const char *path, const sph__io_map *map, sph__io_mesh *mesh, size_t *watched);
sph__io_read_fn sph__io_read_obj, sph__io_read_ply, sph__io_read_off, sph__io_read_stl;
sph__io_read_fn sph__io_read_gltf; /* at rest */
sph__io_read_fn sph__io_read_abc;  /* in its first frame */

/* Which reader a mesh file needs, by content and name; *read is NULL with SPH_E_UNSUPPORTED. */
sph_status sph__io_find_reader(sph_context *context, const char *path, const sph__io_map *map, sph__io_read_fn **read);
/* What a file is, by content and name; NULL: nothing that is known. */
const char *sph__io_format_name(const char *path, const sph__io_map *map);
/* Opens, finds the reader, reads. */
sph_status sph__io_read_mesh(const char *path, sph__io_mesh *mesh, size_t *watched);

/* --- a glTF as frames (gltf_open.c) --- */
enum { SPH__IO_FPS = 30 }; /* unless the caller says another */
typedef struct sph__io_gltf sph__io_gltf;
/* `clip` NULL: all. `mesh` gets triangles, edges and the number of vertices, no positions. */
sph_status sph__io_gltf_open(const char *path, const sph__io_map *map, double fps, const char *clip, sph__io_mesh *mesh,
                             sph__io_gltf **out);
uint32_t sph__io_gltf_frame_count(const sph__io_gltf *gltf);
void sph__io_gltf_read(sph__io_gltf *gltf, uint32_t frame, float *xyz);
/* NULL is fine. */
void sph__io_gltf_close(sph__io_gltf *gltf);

/* --- an Alembic archive as frames (alembic_open.c) --- */
typedef struct sph__io_abc sph__io_abc;
/*
 * `fps` 0: the samples of the file; `object` NULL: all that is visible; `world`: with what places the whole in its
 * scene. `mesh` gets triangles and the number of vertices, no positions. The map must outlive it.
 */
sph_status sph__io_abc_open(const char *path, const sph__io_map *map, double fps, const char *object, bool world,
                            sph__io_mesh *mesh, sph__io_abc **out);
uint32_t sph__io_abc_frame_count(const sph__io_abc *a);
sph_status sph__io_abc_read(sph__io_abc *a, uint32_t frame, float *xyz);
/* NULL is fine. */
void sph__io_abc_close(sph__io_abc *a);

/* --- point caches (cache.c) --- */
typedef struct sph__io_cache {
    sph__io_map map;
    size_t offset; /* of the first frame */
    uint32_t vertex_count, frame_count;
    bool big_endian;
} sph__io_cache;
sph_status sph__io_cache_open(sph_context *context, const char *path, sph__io_cache *cache);
/* The part of it that comes after the mapping of the file: checks the header, fills the rest in. */
sph_status sph__io_cache_interpret(sph_context *context, const char *path, sph__io_cache *cache);
void sph__io_cache_close(sph__io_cache *cache);
void sph__io_cache_read(const sph__io_cache *cache, uint32_t frame, float *xyz);
/* "PC2" or "MDD" where the bytes or the name say so, else NULL. */
const char *sph__io_cache_name(const char *path, const sph__io_map *map);

/* --- lists of files (names.c, expand.c) --- */
int sph__io_compare_natural(const char *a, const char *b);
typedef struct sph__io_names {
    sph_context *context; /* not retained */
    const char **names;   /* each from sph_context_allocate */
    size_t count, capacity;
} sph__io_names;
void sph__io_names_release(sph__io_names *names);
bool sph__io_names_add(sph__io_names *names, const char *name);
/* Globs and printf patterns are replaced by the files that they match; more than one file comes in natural order. */
sph_status sph__io_expand(sph__io_names *names, const char *const *paths, size_t path_count);

/* --- files that are whole or not there (output.c) --- */
typedef struct sph__io_output {
    sph_context *context; /* not retained */
    char *target, *temporary;
    int file;
    sph_status status; /* of the first failure; what follows it does nothing */
    unsigned char *buffer;
    size_t used;
} sph__io_output;
sph_status sph__io_output_open(sph_context *context, const char *path, sph__io_output *output);
void sph__io_output_bytes(sph__io_output *output, const void *bytes, size_t size);
void sph__io_output_text(sph__io_output *output, const char *format, ...) __attribute__((format(printf, 2, 3)));
void sph__io_output_float(sph__io_output *output, float value);
/* With blanks between. */
void sph__io_output_floats(sph__io_output *output, const float *values, size_t count);
/* Flushes and closes; the target is as it was. */
sph_status sph__io_output_finish(sph__io_output *output);
/* Puts the finished file in the target's place. */
sph_status sph__io_output_commit(sph__io_output *output);
/* Removes what was not committed; zeroed and committed outputs are fine. */
void sph__io_output_release(sph__io_output *output);

/* --- JSON (json.c, level_json.c) --- */
typedef struct sph__io_json {
    sph_context *context;
    const char *path;
    const char *start, *p, *end;
    unsigned depth;
} sph__io_json;
sph_status sph__io_json_fail(const sph__io_json *json, const char *what);
/* The next byte that is not blank, without taking it; '\0' at the end. */
char sph__io_json_peek(sph__io_json *json);
/* Takes the byte `c`, with `what` for the message if it is not there. */
sph_status sph__io_json_take(sph__io_json *json, char c, const char *what);
/* A string; escapes are decoded, what does not fit is cut. */
sph_status sph__io_json_string(sph__io_json *json, char *text, size_t size);
sph_status sph__io_json_float(sph__io_json *json, float *value);
sph_status sph__io_json_integer(sph__io_json *json, int64_t *value);
/* Passes over any value. */
sph_status sph__io_json_skip(sph__io_json *json);
/* After '{' or '[': *more says whether an element follows; takes the separator or the closing byte. */
sph_status sph__io_json_next(sph__io_json *json, char close, bool *first, bool *more);

sph_status sph__io_level_json_read(sph_context *context, const char *path, const sph__io_map *map, sph_level **out);

/* --- surfaces (surface_glb.c) --- */
void sph__io_surface_glb_write(sph__io_output *output, const sph_surface *surface, uint32_t index);

/* --- levels as what their names say (level_json.c, level_mesh.c, level_glb.c) --- */
typedef void sph__io_level_write_fn(sph__io_output *output, const sph_level_arrays *arrays);
sph__io_level_write_fn sph__io_level_json_write, sph__io_level_obj_write, sph__io_level_ply_write;
sph__io_level_write_fn sph__io_level_glb_write; /* to look at: spheres, triangles and edges that move */

#endif
