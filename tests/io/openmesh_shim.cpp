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

int openmesh_write(const char *path, const openmesh_mesh *mesh, unsigned flags)
{
    OpenMesh::PolyMesh_ArrayKernelT<> written;
    OpenMesh::IO::Options options;
    const uint32_t *corner = mesh->corners;
    written.request_vertex_normals();
    written.request_face_normals();
    written.request_vertex_colors();
    written.request_face_colors();
    written.request_vertex_texcoords2D();
    for (size_t i = 0; i < mesh->vertex_count; ++i) {
        const float *xyz = mesh->positions + 3 * i;
        const auto vertex = written.add_vertex({xyz[0], xyz[1], xyz[2]});
        written.set_normal(vertex, {0, 0.5f, -1});
        written.set_color(vertex, {static_cast<unsigned char>(i), 128, 255});
        written.set_texcoord2D(vertex, {0.25f, 0.75f});
    }
    for (size_t f = 0; f < mesh->face_count; ++f) {
        std::vector<OpenMesh::VertexHandle> face;
        for (uint32_t i = 0; i < mesh->sizes[f]; ++i)
            face.push_back(OpenMesh::VertexHandle(static_cast<int>(*corner++)));
        const auto handle = written.add_face(face);
        if (!handle.is_valid()) return 0;
        written.set_color(handle, {1, 2, static_cast<unsigned char>(f)});
    }
    written.update_face_normals(); /* STL wants them */
    if (flags & OPENMESH_BINARY) options += OpenMesh::IO::Options::Binary;
    if (flags & OPENMESH_BIG) options += OpenMesh::IO::Options::MSB;
    if (flags & OPENMESH_NORMALS) options += OpenMesh::IO::Options::VertexNormal;
    if (flags & OPENMESH_COLORS) options += OpenMesh::IO::Options::VertexColor;
    if (flags & OPENMESH_TEXTURE) options += OpenMesh::IO::Options::VertexTexCoord;
    if (flags & OPENMESH_FACE_COLORS) options += OpenMesh::IO::Options::FaceColor;
    return OpenMesh::IO::write_mesh(written, path, options) ? 1 : 0;
}

void openmesh_free(openmesh_mesh *mesh)
{
    delete[] mesh->positions;
    delete[] mesh->sizes;
    delete[] mesh->corners;
    *mesh = openmesh_mesh();
}
