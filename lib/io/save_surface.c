/* SPDX-License-Identifier: MIT */
/* Surfaces as OBJ, PLY or GLB, and other meshes as OBJ or PLY. */
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

/* What is written: of a surface, or of the caller's. */
typedef struct shape {
    size_t vertex_count, triangle_count;
    const float *positions, *normals; /* `normals` NULL: none */
    const uint32_t *triangles;
} shape;

static void write_obj(sph__io_output *o, const shape *s)
{
    write_vectors(o, "v", s->positions, s->vertex_count);
    if (s->normals != NULL) write_vectors(o, "vn", s->normals, s->vertex_count);
    for (size_t i = 0; i < 3 * s->triangle_count; ++i) {
        const unsigned v = (unsigned)s->triangles[i] + 1;
        sph__io_output_text(o, s->normals == NULL ? "%s%u" : "%s%u//%u", i % 3 == 0 ? "f " : " ", v, v);
        if (i % 3 == 2) sph__io_output_text(o, "\n");
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

static void write_ply(sph__io_output *o, const shape *s)
{
    sph__io_output_text(o, "ply\nformat binary_little_endian 1.0\nelement vertex %zu\n", s->vertex_count);
    for (int i = 0; i < (s->normals == NULL ? 3 : 6); ++i)
        sph__io_output_text(o, "property float %s%c\n", i < 3 ? "" : "n", "xyz"[i % 3]);
    sph__io_output_text(o, "element face %zu\nproperty list uchar uint vertex_indices\nend_header\n",
                        s->triangle_count);
    for (size_t i = 0; i < s->vertex_count; ++i) {
        put_vector(o, s->positions + 3 * i);
        if (s->normals != NULL) put_vector(o, s->normals + 3 * i);
    }
    for (size_t i = 0; i < s->triangle_count; ++i) {
        const unsigned char corners = 3;
        sph__io_output_bytes(o, &corners, 1);
        for (size_t k = 0; k < 3; ++k)
            put_word(o, s->triangles[3 * i + k]);
    }
}

static sph_status finish(sph__io_output *o)
{
    sph_status status = sph__io_output_finish(o);
    if (status == SPH_OK) status = sph__io_output_commit(o);
    sph__io_output_release(o);
    return status;
}

static void write_shape(sph__io_output *o, const shape *s, const char *path)
{
    if (sph__io_has_ending(path, "ply"))
        write_ply(o, s);
    else
        write_obj(o, s);
}

sph_status sph_io_save_surface(sph_context *context, const sph_surface *surface, uint32_t index, const char *path)
{
    SPH__IO_OWN(context, sph_context_memory_used);
    SPH__IO_OWN(surface, sph_surface_frame_count);
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
    if (sph__io_has_ending(path, "glb")) {
        sph__io_surface_glb_write(&o, surface, index);
    } else {
        const shape s = {sph_surface_vertex_count(surface, index), sph_surface_triangle_count(surface, index),
                         sph_surface_positions(surface, index), sph_surface_normals(surface, index),
                         sph_surface_triangles(surface, index)};
        write_shape(&o, &s, path);
    }
    return finish(&o);
}

sph_status sph_io_save_mesh(sph_context *context, uint32_t vertex_count, const float *positions, const float *normals,
                            size_t triangle_count, const uint32_t *triangles, const char *path)
{
    SPH__IO_OWN(context, sph_context_memory_used);
    const shape s = {vertex_count, triangle_count, positions, normals, triangles};
    sph__io_output o = {.file = -1};
    sph_status status;
    if (context == NULL || (positions == NULL && vertex_count != 0) || (triangles == NULL && triangle_count != 0) ||
        path == NULL)
        return sph_context_fail(context, SPH_E_INVALID, "sph_io_save_mesh: an argument is NULL");
    for (size_t i = 0; i / 3 < triangle_count; ++i)
        if (triangles[i] >= vertex_count)
            return sph__io_fail(context, SPH_E_INVALID, "triangle %zu names vertex %u of %u", i / 3,
                                (unsigned)triangles[i], (unsigned)vertex_count);
    if (!sph__io_has_ending(path, "obj") && !sph__io_has_ending(path, "ply"))
        return sph__io_fail(context, SPH_E_UNSUPPORTED, "%s: a mesh is saved as .obj or .ply", sph__io_shown(path));
    status = sph__io_output_open(context, path, &o);
    if (status != SPH_OK) return status;
    write_shape(&o, &s, path);
    return finish(&o);
}
