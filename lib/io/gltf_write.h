/* SPDX-License-Identifier: MIT */
/* What the writers of glTF share: JSON that grows, the views and accessors of a buffer, and its bytes. */
#ifndef SPH_IO_GLTF_WRITE_H
#define SPH_IO_GLTF_WRITE_H

#include "io/gltf_types.h"
#include "io/io.h"

/* What a view is for. */
enum { SPH__GLTF_VERTICES = 34962, SPH__GLTF_INDICES = 34963 };

/* Text that grows; once it has failed for want of memory it stays as it is. */
typedef struct sph__io_text {
    sph_context *context; /* not retained */
    char *text;
    size_t length, capacity;
    bool failed;
} sph__io_text;

/* At most 255 bytes at once. */
void sph__io_text_add(sph__io_text *t, const char *format, ...) __attribute__((format(printf, 2, 3)));
void sph__io_text_bytes(sph__io_text *t, const char *bytes, size_t length);
void sph__io_text_float(sph__io_text *t, float value);
/* With commas between, in brackets. */
void sph__io_text_floats(sph__io_text *t, const float *values, size_t count);
/* A JSON string; what is no UTF-8 becomes U+FFFD. */
void sph__io_text_string(sph__io_text *t, const char *string);
void sph__io_text_release(sph__io_text *t);

/* A file of one buffer. Views follow one another; each begins at a multiple of 4. */
typedef struct sph__io_gltf_writer {
    sph__io_text json, views, accessors; /* the latter two are lists without their brackets */
    unsigned view_count, accessor_count;
    uint64_t binary; /* bytes so far, with what fills up to the next multiple of 4 */
} sph__io_gltf_writer;

void sph__io_gltf_writer_open(sph__io_gltf_writer *w, sph_context *context);
void sph__io_gltf_writer_release(sph__io_gltf_writer *w);
/* These return the number of what they add. `target` 0: none. `more` is JSON that begins with a comma, or "". */
unsigned sph__io_gltf_add_view(sph__io_gltf_writer *w, uint64_t size, int target);
unsigned sph__io_gltf_add_accessor(sph__io_gltf_writer *w, unsigned view, uint64_t offset, int type, const char *width,
                                   size_t count, const char *more);
/* Puts views, accessors and the buffer into the open object of w->json, ends the object, and fills up with blanks.
   `uri` NULL: the buffer is the chunk of a GLB. */
void sph__io_gltf_close_json(sph__io_gltf_writer *w, const char *uri);
/* Whether it is within what a GLB can have and within memory; `path` for the message. */
sph_status sph__io_gltf_check(const sph__io_gltf_writer *w, const char *path);
/* What comes before the buffer in a GLB: header, JSON, and the head of the chunk. */
void sph__io_gltf_put_head(sph__io_output *o, const sph__io_text *json, uint64_t binary);

/* Little-endian numbers of 1, 2 or 4 bytes. */
void sph__io_put(sph__io_output *o, uint32_t value, unsigned size);
void sph__io_put_float(sph__io_output *o, float value);

#endif
