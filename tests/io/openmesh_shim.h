/* SPDX-License-Identifier: MIT */
/* OpenMesh's readers and writers, for C. */
#ifndef SPH_TEST_OPENMESH_SHIM_H
#define SPH_TEST_OPENMESH_SHIM_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct openmesh_mesh {
    size_t vertex_count, face_count, corner_count;
    float *positions;  /* 3 per vertex */
    uint32_t *sizes;   /* corners of each face */
    uint32_t *corners; /* of all faces, one after the other */
} openmesh_mesh;

/* 1 when OpenMesh read the file. */
int openmesh_read(const char *path, openmesh_mesh *mesh);
/* What a written file has besides vertices and faces; and how it is written. */
enum {
    OPENMESH_BINARY = 1,
    OPENMESH_BIG = 2,
    OPENMESH_NORMALS = 4,
    OPENMESH_COLORS = 8,
    OPENMESH_TEXTURE = 16,
    OPENMESH_FACE_COLORS = 32
};
/* 1 when OpenMesh wrote the file; normals, colours and so on are of no meaning. */
int openmesh_write(const char *path, const openmesh_mesh *mesh, unsigned flags);
void openmesh_free(openmesh_mesh *mesh);

#ifdef __cplusplus
}
#endif

#endif
