/* SPDX-License-Identifier: MIT */
/* What glTF calls types of numbers, for its reader and its writers. */
#ifndef SPH_IO_GLTF_TYPES_H
#define SPH_IO_GLTF_TYPES_H

enum {
    SPH__GLTF_I8 = 5120,
    SPH__GLTF_U8 = 5121,
    SPH__GLTF_I16 = 5122,
    SPH__GLTF_U16 = 5123,
    SPH__GLTF_U32 = 5125,
    SPH__GLTF_F32 = 5126,
    SPH__GLTF_FLOAT = SPH__GLTF_F32
};

#endif
