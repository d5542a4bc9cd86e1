/* SPDX-License-Identifier: MIT */
/* Small glTF files made by the tests themselves: buffers and accessors by call, everything else as JSON text. */
#ifndef SPH_TEST_GLB_H
#define SPH_TEST_GLB_H

#include "files.h"

typedef struct glb {
    layout binary;
    layout views, accessors; /* JSON, without the brackets */
    uint32_t view_count, accessor_count;
} glb;

enum { GLB_I8 = 5120, GLB_U8 = 5121, GLB_I16 = 5122, GLB_U16 = 5123, GLB_U32 = 5125, GLB_F32 = 5126 };

/* A bufferView of these bytes, begun at a multiple of 4; returns its number. */
uint32_t glb_view(glb *g, const void *bytes, size_t size, unsigned stride);
/* An accessor of any view; `more` is JSON that begins with a comma, or "". */
uint32_t glb_accessor(glb *g, uint32_t view, int component, const char *type, uint32_t count, const char *more);
/* An accessor of numbers, stored as the component says: floats, or integers. */
uint32_t glb_numbers(glb *g, int component, const char *type, uint32_t count, const double *numbers, const char *more);
uint32_t glb_floats(glb *g, const char *type, uint32_t count, const double *numbers);
/* {"asset":..,"buffers":..,"bufferViews":..,"accessors":..,REST} as the two chunks of a GLB. */
void glb_layout(const glb *g, const char *rest, layout *out);
/* The JSON alone; `uri` is that of the buffer. */
void glb_json(const glb *g, const char *rest, const char *uri, layout *out);
/* Writes it into the test's folder, frees it, and returns the path. */
const char *glb_write(glb *g, const char *name, const char *rest);
void glb_free(glb *g);

#endif
