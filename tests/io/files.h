/* SPDX-License-Identifier: MIT */
/* A folder of its own for each test, and bytes laid out one by one. */
#ifndef SPH_TEST_FILES_H
#define SPH_TEST_FILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <sphmesh/io.h>

/* Makes an empty folder; removes it with all that is in it. */
void files_setup(void);
void files_teardown(void);
/* The path of a name in the folder; each call's answer stays until files_teardown(). */
const char *file_path(const char *name);
/* Writes a file into the folder and returns its path. */
const char *file_write(const char *name, const void *bytes, size_t size);
const char *file_text(const char *name, const char *text);
/* All bytes, to be freed. */
unsigned char *file_read(const char *path, size_t *size);
/* How many files are in the folder, hidden ones too. */
size_t file_count(void);

/* Bytes laid out by hand. */
typedef struct layout {
    unsigned char *bytes;
    size_t size, capacity;
} layout;
void put_bytes(layout *l, const void *bytes, size_t size);
void put_little(layout *l, uint64_t value, unsigned size);
void put_big(layout *l, uint64_t value, unsigned size);
void put_little_float(layout *l, float value);
void put_big_float(layout *l, float value);
void layout_free(layout *l);
/* A copy that ends where its memory ends, so that the address sanitizer sees every look beyond it. To be freed. */
unsigned char *exact_copy(const void *bytes, size_t size);

/* The coordinate of the files made below: exact in a float, and different for each. */
float coordinate(uint32_t frame, uint32_t vertex, unsigned axis);
void put_pc2(layout *l, uint32_t vertices, uint32_t frames);
void put_mdd(layout *l, uint32_t vertices, uint32_t frames);
/* An OBJ of so many vertices with the coordinates of a frame, and one triangle or more. */
const char *write_obj(const char *name, uint32_t vertices, uint32_t frame);

/* A PC2, or an MDD where the name has mdd in it. */
const char *write_cache(const char *name, uint32_t vertices, uint32_t frames);
/* That frame `f` of the animation is frame first + f * step of the coordinates. */
void check_frames(sph_context *context, const sph_animation *animation, uint32_t vertices, uint32_t frames,
                  uint32_t first, uint32_t step);

/* Opens one path; the animation, or NULL with *status. */
sph_animation *open_one(sph_context *context, const char *path, const sph_io_open_options *options, sph_status *status);
/* That the one frame, the triangles and the edges of a mesh are these: "0 0 0, 1 0 0, 0 1 0; f 0 1 2; l 0 1". */
void check_content(sph_context *context, const char *path, const char *expected);
/* That it is refused with this status and a message that has these words in it. */
void check_refused(sph_context *context, const char *path, sph_status expected, const char *message);

#endif
