/* SPDX-License-Identifier: MIT */
/* Skins whose motion is known, and rigs laid open as JSON and numbers. */
#ifndef SPH_TEST_RIG_H
#define SPH_TEST_RIG_H

#include <jansson.h>

#include "files.h"

enum { RIG_VERTICES_MOST = 400, RIG_BONES_MOST = 300, RIG_SLOTS_MOST = 9, RIG_FRAMES = 15 };

/* Change what should differ, then make the skin. */
typedef struct rig_input {
    sph_skin_arrays arrays;
    sph_skin_clip clips[2];
    float rest[3 * RIG_VERTICES_MOST], weights[RIG_SLOTS_MOST * RIG_VERTICES_MOST];
    uint32_t bones[RIG_SLOTS_MOST * RIG_VERTICES_MOST], triangles[6 * RIG_VERTICES_MOST], links[2 * RIG_BONES_MOST];
    double pivots[3 * RIG_BONES_MOST], transforms[12 * RIG_BONES_MOST * RIG_FRAMES];
} rig_input;

/*
 * A strip of triangles about the origin; bones in a row, of which each hangs on the one before it and swings about
 * random axes; random weights of random bones; two clips, "walk" of 10 frames and "" of 5.
 */
void rig_input_make(rig_input *r, uint32_t vertices, uint32_t bones, uint32_t slots);
sph_skin *rig_skin(sph_context *context, const rig_input *r);
/* What the skin makes of a vertex. */
void rig_vertex(const sph_skin_arrays *skin, uint32_t frame, uint32_t vertex, double out[3]);

/* A GLB as it is. */
typedef struct rig_file {
    json_t *json;
    unsigned char *bytes, *binary; /* `binary` within `bytes` */
    size_t size, binary_size;
} rig_file;
/* Checks the layout of the chunks. */
void rig_open(rig_file *f, const char *path);
void rig_close(rig_file *f);
/* One number of an accessor, as it is stored (not normalised). */
double rig_number(const rig_file *f, json_int_t accessor, size_t element, unsigned component);
size_t rig_count(const rig_file *f, json_int_t accessor);
const char *rig_type(const rig_file *f, json_int_t accessor);
json_int_t rig_component_type(const rig_file *f, json_int_t accessor);
/* A number in the JSON by its path: "meshes/0/primitives/0/indices"; -1 where there is none. */
json_int_t rig_integer(const rig_file *f, const char *path);
json_t *rig_value(const rig_file *f, const char *path);

#endif
