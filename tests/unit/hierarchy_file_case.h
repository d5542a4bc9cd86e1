/* SPDX-License-Identifier: MIT */
/* What the tests of hierarchies as bytes share. */
#ifndef SPH_TEST_HIERARCHY_FILE_CASE_H
#define SPH_TEST_HIERARCHY_FILE_CASE_H

#include "support.h"

typedef struct bytes {
    unsigned char *data; /* to be freed */
    size_t size, capacity;
} bytes;

/* A sph_write_fn that appends to `bytes`. */
sph_status keep(void *bytes, const void *data, size_t size);
bytes write_all(const sph_hierarchy *h);

/* Of meshes of every kind: closed, open, wire edges, several components, isolated vertices, nothing but one vertex. */
enum { MESH_COUNT = 8 };
sph_hierarchy *make_hierarchy(sph_context *of, int kind, int32_t radius_mode);

#endif
