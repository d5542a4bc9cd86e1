/* SPDX-License-Identifier: MIT */
#include "openmesh_shim.h"

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>

#include <algorithm>
#include <vector>

int openmesh_read(const char *path, openmesh_mesh *mesh)
{
    OpenMesh::PolyMesh_ArrayKernelT<> read;
    std::vector<uint32_t> sizes, corners;
    if (!OpenMesh::IO::read_mesh(read, path)) return 0;
    for (const auto face : read.faces()) {
        uint32_t size = 0;
        for (const auto vertex : read.fv_range(face)) {
            corners.push_back(static_cast<uint32_t>(vertex.idx()));
            ++size;
        }
        sizes.push_back(size);
    }
    *mesh = {read.n_vertices(),
             sizes.size(),
             corners.size(),
             new float[3 * read.n_vertices()],
             new uint32_t[sizes.size()],
             new uint32_t[corners.size()]};
    for (const auto vertex : read.vertices())
        for (int i = 0; i < 3; ++i)
            mesh->positions[3 * vertex.idx() + i] = read.point(vertex)[i];
    std::copy(sizes.begin(), sizes.end(), mesh->sizes);
    std::copy(corners.begin(), corners.end(), mesh->corners);
    return 1;
}

void openmesh_free(openmesh_mesh *mesh)
{
    delete[] mesh->positions;
    delete[] mesh->sizes;
    delete[] mesh->corners;
    *mesh = openmesh_mesh();
}
