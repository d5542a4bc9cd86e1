/* SPDX-License-Identifier: MIT */
/* Surfaces as OBJ, PLY or GLB. */
#include <string.h>

#include "io/io.h"

static void write_vectors(sph__io_output *o, const char *keyword, const float *xyz, size_t count)
{
    for (size_t i = 0; i < 3 * count; ++i) {
        sph__io_output_text(o, "%s ", i % 3 == 0 ? keyword : "");
        sph__io_output_float(o, xyz[i]);
        if (i % 3 == 2) sph__io_output_text(o, "\n");
    }
}

static void write_obj(sph__io_output *o, const sph_surface *surface, uint32_t index)
{
    const size_t vertices = sph_surface_vertex_count(surface, index);
    const uint32_t *t = sph_surface_triangles(surface, index);
    write_vectors(o, "v", sph_surface_positions(surface, index), vertices);
    write_vectors(o, "vn", sph_surface_normals(surface, index), vertices);
    for (size_t i = 0; i < 3 * sph_surface_triangle_count(surface, index); ++i) {
        const unsigned v = (unsigned)t[i] + 1;
        sph__io_output_text(o, "%s%u//%u%s", i % 3 == 0 ? "f " : " ", v, v, i % 3 == 2 ? "\n" : "");
    }
}

static void put_word(sph__io_output *o, uint32_t value)
{
    const unsigned char bytes[4] = {(unsigned char)value, (unsigned char)(value >> 8), (unsigned char)(value >> 16),
                                    (unsigned char)(value >> 24)};
    sph__io_output_bytes(o, bytes, sizeof bytes);
}

static void put_vector(sph__io_output *o, const float *xyz)
{
    for (int k = 0; k < 3; ++k) {
        uint32_t bits;
        memcpy(&bits, &xyz[k], sizeof bits);
        put_word(o, bits);
    }
}

static void write_ply(sph__io_output *o, const sph_surface *surface, uint32_t index)
{
    const size_t vertices = sph_surface_vertex_count(surface, index),
                 triangles = sph_surface_triangle_count(surface, index);
    const float *xyz = sph_surface_positions(surface, index), *normals = sph_surface_normals(surface, index);
    const uint32_t *t = sph_surface_triangles(surface, index);
    sph__io_output_text(o, "ply\nformat binary_little_endian 1.0\nelement vertex %zu\n", vertices);
    for (int i = 0; i < 6; ++i)
        sph__io_output_text(o, "property float %s%c\n", i < 3 ? "" : "n", "xyz"[i % 3]);
    sph__io_output_text(o, "element face %zu\nproperty list uchar uint vertex_indices\nend_header\n", triangles);
    for (size_t i = 0; i < vertices; ++i) {
        put_vector(o, xyz + 3 * i);
        put_vector(o, normals + 3 * i);
    }
    for (size_t i = 0; i < triangles; ++i) {
        const unsigned char corners = 3;
        sph__io_output_bytes(o, &corners, 1);
        for (size_t k = 0; k < 3; ++k)
            put_word(o, t[3 * i + k]);
    }
}

sph_status sph_io_save_surface(sph_context *context, const sph_surface *surface, uint32_t index, const char *path)
{
    sph__io_output o = {.file = -1};
    sph_status status;
    if (context == NULL || surface == NULL || path == NULL)
        return sph_context_fail(context, SPH_E_INVALID, "sph_io_save_surface: an argument is NULL");
    if (index >= sph_surface_frame_count(surface))
        return sph__io_fail(context, SPH_E_INVALID, "frame %u of a surface of %u frames", (unsigned)index,
                            (unsigned)sph_surface_frame_count(surface));
    if (!sph__io_has_ending(path, "obj") && !sph__io_has_ending(path, "ply") && !sph__io_has_ending(path, "glb"))
        return sph__io_fail(context, SPH_E_UNSUPPORTED, "%s: a surface is saved as .obj, .ply or .glb",
                            sph__io_shown(path));
    status = sph__io_output_open(context, path, &o);
    if (status != SPH_OK) return status;
    if (sph__io_has_ending(path, "ply"))
        write_ply(&o, surface, index);
    else if (sph__io_has_ending(path, "glb"))
        sph__io_surface_glb_write(&o, surface, index);
    else
        write_obj(&o, surface, index);
    status = sph__io_output_finish(&o);
    if (status == SPH_OK) status = sph__io_output_commit(&o);
    sph__io_output_release(&o);
    return status;
}
