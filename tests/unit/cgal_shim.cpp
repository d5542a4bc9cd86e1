/* SPDX-License-Identifier: MIT */
#include "cgal_shim.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <cmath>
#include <vector>

typedef CGAL::Exact_predicates_inexact_constructions_kernel Kernel;
typedef std::vector<Kernel::Triangle_3> Triangles;
typedef CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator> Primitive;
typedef CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>> Tree;

void cgal_distances(const float *xyz, const uint32_t *triangles, size_t triangle_count, const double *points,
                    size_t point_count, double *distances)
{
    Triangles all;
    for (size_t i = 0; i < triangle_count; ++i) {
        Kernel::Point_3 corners[3];
        for (int k = 0; k < 3; ++k) {
            const float *v = &xyz[3 * size_t(triangles[3 * i + k])];
            corners[k] = Kernel::Point_3(v[0], v[1], v[2]);
        }
        all.emplace_back(corners[0], corners[1], corners[2]);
    }
    const Triangles &constant = all;
    Tree tree(constant.begin(), constant.end());
    for (size_t i = 0; i < point_count; ++i)
        distances[i] =
            std::sqrt(tree.squared_distance(Kernel::Point_3(points[3 * i], points[3 * i + 1], points[3 * i + 2])));
}

static Kernel::Triangle_3 triangle_of(const float *p)
{
    return Kernel::Triangle_3(Kernel::Point_3(p[0], p[1], p[2]), Kernel::Point_3(p[3], p[4], p[5]),
                              Kernel::Point_3(p[6], p[7], p[8]));
}

int cgal_triangles_meet(const float *p, const float *q)
{
    return CGAL::do_intersect(triangle_of(p), triangle_of(q));
}
