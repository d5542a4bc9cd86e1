/* SPDX-License-Identifier: MIT */
/* Frame 0 of a level as a mesh, to look at. */
#include "io/io.h"

/* Frame 0: centres as vertices, with their radii as comments; triangles as faces, wire edges as lines. */
void sph__io_level_obj_write(sph__io_output *o, const sph_level_arrays *a)
{
    sph__io_output_text(o, "# a sphere-mesh: %u spheres, frame 0 of %u\n", (unsigned)a->sphere_count,
                        (unsigned)a->frame_count);
    for (size_t i = 0; i < a->sphere_count; ++i) {
        sph__io_output_text(o, "v ");
        sph__io_output_floats(o, a->centers + 3 * i, 3);
        sph__io_output_text(o, " # radius ");
        sph__io_output_float(o, a->radii[i]);
        sph__io_output_text(o, "\n");
    }
    for (size_t i = 0; i < a->triangle_count; ++i)
        sph__io_output_text(o, "f %u %u %u\n", (unsigned)a->triangles[3 * i] + 1, (unsigned)a->triangles[3 * i + 1] + 1,
                            (unsigned)a->triangles[3 * i + 2] + 1);
    for (size_t i = 0; i < a->edge_count; ++i)
        sph__io_output_text(o, "l %u %u\n", (unsigned)a->edges[2 * i] + 1, (unsigned)a->edges[2 * i + 1] + 1);
}

/* Frame 0 as text: centres and radii as vertices, triangles as faces, wire edges as edges. */
void sph__io_level_ply_write(sph__io_output *o, const sph_level_arrays *a)
{
    sph__io_output_text(o, "ply\nformat ascii 1.0\ncomment a sphere-mesh: %u spheres, frame 0 of %u\n",
                        (unsigned)a->sphere_count, (unsigned)a->frame_count);
    sph__io_output_text(o, "element vertex %u\nproperty float x\nproperty float y\nproperty float z\n",
                        (unsigned)a->sphere_count);
    sph__io_output_text(o, "property float radius\nelement face %zu\nproperty list uchar int vertex_indices\n",
                        a->triangle_count);
    sph__io_output_text(o, "element edge %zu\nproperty int vertex1\nproperty int vertex2\nend_header\n", a->edge_count);
    for (size_t i = 0; i < a->sphere_count; ++i) {
        sph__io_output_floats(o, a->centers + 3 * i, 3);
        sph__io_output_text(o, " ");
        sph__io_output_float(o, a->radii[i]);
        sph__io_output_text(o, "\n");
    }
    for (size_t i = 0; i < a->triangle_count; ++i)
        sph__io_output_text(o, "3 %u %u %u\n", (unsigned)a->triangles[3 * i], (unsigned)a->triangles[3 * i + 1],
                            (unsigned)a->triangles[3 * i + 2]);
    for (size_t i = 0; i < a->edge_count; ++i)
        sph__io_output_text(o, "%u %u\n", (unsigned)a->edges[2 * i], (unsigned)a->edges[2 * i + 1]);
}
