/* SPDX-License-Identifier: MIT */
/* OpenMesh's OBJ reader, for C. */
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
void openmesh_free(openmesh_mesh *mesh);

#ifdef __cplusplus
}
#endif

#endif
