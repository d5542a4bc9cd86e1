/* SPDX-License-Identifier: MIT */
/* Animations as OBJ with a PC2 cache. */
#include <math.h>
#include <string.h>

#include "io/bytes.h"
#include "io/io.h"

static void write_pc2_header(sph__io_output *o, const sph_animation *animation, float first_frame, float sampling)
{
    unsigned char header[32] = "POINTCACHE2";
    sph__io_store_32(header + 12, 1, false);
    sph__io_store_32(header + 16, sph_animation_vertex_count(animation), false);
    sph__io_store_float(header + 20, first_frame, false);
    sph__io_store_float(header + 24, sampling, false);
    sph__io_store_32(header + 28, sph_animation_frame_count(animation), false);
    sph__io_output_bytes(o, header, sizeof header);
}

static void write_pc2_frame(sph__io_output *o, const float *xyz, size_t vertex_count)
{
    for (size_t i = 0; i < 3 * vertex_count; ++i) {
        unsigned char bytes[4];
        sph__io_store_float(bytes, xyz[i], false);
        sph__io_output_bytes(o, bytes, sizeof bytes);
    }
}

static void write_obj(sph__io_output *o, const sph_animation *animation, const float *xyz)
{
    const uint32_t *triangles = sph_animation_triangles(animation), *edges = sph_animation_edges(animation);
    const size_t n = sph_animation_vertex_count(animation);
    for (size_t i = 0; i < n; ++i) {
        sph__io_output_text(o, "v");
        for (size_t j = 0; j < 3; ++j) {
            sph__io_output_text(o, " ");
            sph__io_output_float(o, xyz[3 * i + j]);
        }
        sph__io_output_text(o, "\n");
    }
    for (size_t i = 0; i < sph_animation_triangle_count(animation); ++i)
        sph__io_output_text(o, "f %u %u %u\n", (unsigned)triangles[3 * i] + 1, (unsigned)triangles[3 * i + 1] + 1,
                            (unsigned)triangles[3 * i + 2] + 1);
    for (size_t i = 0; i < sph_animation_edge_count(animation); ++i)
        sph__io_output_text(o, "l %u %u\n", (unsigned)edges[2 * i] + 1, (unsigned)edges[2 * i + 1] + 1);
}

static sph_status write_frames(sph_context *context, const sph_animation *animation, float *xyz, sph__io_output *obj,
                               sph__io_output *pc2)
{
    const uint32_t frames = sph_animation_frame_count(animation);
    for (uint32_t f = 0; f < frames; ++f) {
        sph_status status = sph_context_report_progress(context, "writing frames", (double)f / frames);
        if (status == SPH_OK) status = sph_animation_read_frame(animation, f, xyz);
        if (status != SPH_OK) return status;
        if (f == 0) write_obj(obj, animation, xyz);
        write_pc2_frame(pc2, xyz, sph_animation_vertex_count(animation));
        if (obj->status != SPH_OK) return obj->status;
        if (pc2->status != SPH_OK) return pc2->status;
    }
    return SPH_OK;
}

sph_status sph_io_save_obj_pc2(sph_context *context, const sph_animation *animation, double first_frame,
                               double frames_per_sample, const char *obj_path, const char *pc2_path)
{
    sph__io_output obj = {.file = -1}, pc2 = {.file = -1};
    sph_status status;
    float *xyz;
    if (context == NULL || animation == NULL || obj_path == NULL || pc2_path == NULL)
        return sph_context_fail(context, SPH_E_INVALID, "sph_io_save_obj_pc2: an argument is NULL");
    if (!isfinite((float)first_frame) || !isfinite((float)frames_per_sample) || !((float)frames_per_sample > 0))
        return sph__io_fail(context, SPH_E_INVALID, "a cache from frame %g with %g frames per sample", first_frame,
                            frames_per_sample);
    if (strcmp(obj_path, pc2_path) == 0)
        return sph__io_fail(context, SPH_E_INVALID, "%s: both the mesh and its cache", sph__io_shown(obj_path));
    xyz = sph_context_allocate(context, sph_animation_vertex_count(animation), 3 * sizeof *xyz);
    if (xyz == NULL) return sph__io_fail_memory(context, obj_path);
    status = sph__io_output_open(context, obj_path, &obj);
    if (status == SPH_OK) status = sph__io_output_open(context, pc2_path, &pc2);
    if (status == SPH_OK) {
        write_pc2_header(&pc2, animation, (float)first_frame, (float)frames_per_sample);
        status = write_frames(context, animation, xyz, &obj, &pc2);
    }
    if (status == SPH_OK) status = sph__io_output_finish(&obj);
    if (status == SPH_OK) status = sph__io_output_finish(&pc2);
    if (status == SPH_OK) status = sph__io_output_commit(&obj);
    if (status == SPH_OK) status = sph__io_output_commit(&pc2);
    sph__io_output_release(&obj);
    sph__io_output_release(&pc2);
    sph_context_release(context, xyz);
    return status;
}
