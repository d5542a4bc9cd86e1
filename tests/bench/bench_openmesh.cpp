/* SPDX-License-Identifier: MIT */
#include <vector>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

#include "simplifiers.h"

double bench_openmesh(const float *xyz, uint32_t n, const uint32_t *triangles, size_t triangle_count, uint32_t target,
                      double (*clock)(void), uint32_t *left)
{
    using Mesh = OpenMesh::TriMesh_ArrayKernelT<>;
    Mesh mesh;
    std::vector<Mesh::VertexHandle> vertices(n);
    for (uint32_t i = 0; i < n; ++i)
        vertices[i] = mesh.add_vertex(Mesh::Point(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]));
    for (size_t i = 0; i < triangle_count; ++i)
        mesh.add_face(vertices[triangles[3 * i]], vertices[triangles[3 * i + 1]], vertices[triangles[3 * i + 2]]);
    const double began = clock();
    OpenMesh::Decimater::DecimaterT<Mesh> decimater(mesh);
    OpenMesh::Decimater::ModQuadricT<Mesh>::Handle quadric;
    decimater.add(quadric);
    decimater.module(quadric).unset_max_err();
    decimater.initialize();
    decimater.decimate_to(target);
    const double ended = clock();
    mesh.garbage_collection();
    *left = static_cast<uint32_t>(mesh.n_vertices());
    return ended - began;
}
