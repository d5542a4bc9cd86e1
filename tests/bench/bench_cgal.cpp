/* SPDX-License-Identifier: MIT */
#include <vector>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_placement.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include "simplifiers.h"

namespace simplification = CGAL::Surface_mesh_simplification;

double bench_cgal(const float *xyz, uint32_t n, const uint32_t *triangles, size_t triangle_count, uint32_t target,
                  double (*clock)(void), uint32_t *left)
{
    using Kernel = CGAL::Simple_cartesian<double>;
    using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
    using Policies = simplification::GarlandHeckbert_plane_policies<Mesh, Kernel>;
    using Placement = simplification::Bounded_normal_change_placement<Policies::Get_placement>;
    Mesh mesh;
    std::vector<Mesh::Vertex_index> vertices(n);
    for (uint32_t i = 0; i < n; ++i)
        vertices[i] = mesh.add_vertex(Kernel::Point_3(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]));
    for (size_t i = 0; i < triangle_count; ++i)
        mesh.add_face(vertices[triangles[3 * i]], vertices[triangles[3 * i + 1]], vertices[triangles[3 * i + 2]]);
    const double began = clock();
    Policies policies(mesh);
    const Placement placement(policies.get_placement());
    /* A closed mesh of genus 1 has three edges per vertex. */
    const simplification::Count_stop_predicate<Mesh> stop(3 * static_cast<size_t>(target) + 1);
    simplification::edge_collapse(mesh, stop, CGAL::parameters::get_cost(policies.get_cost()).get_placement(placement));
    const double ended = clock();
    *left = static_cast<uint32_t>(mesh.number_of_vertices());
    return ended - began;
}
