/* SPDX-License-Identifier: MIT */
/* The primitives of a level as extras of the nodes of its GLB; docs/formats.md lists them. */
#include <inttypes.h>
#include <stdio.h>

#include "io/level_glb.h"

/* An edge or a triangle as a node; sphere i is node i + 1. */
static void add_simplex(sph__io_glb *w, const char *type, size_t number, const uint32_t *simplex, unsigned corners)
{
    sph__io_text_add(&w->file.json, ",{\"name\":\"%s %zu\",\"extras\":{\"sphmesh\":{\"type\":\"%s\",\"nodes\":[", type,
                     number, type);
    for (unsigned k = 0; k < corners; ++k)
        sph__io_text_add(&w->file.json, "%s%u", k == 0 ? "" : ",", (unsigned)simplex[k] + 1);
    sph__io_text_add(&w->file.json, "]");
    for (unsigned k = 0; k < corners && !w->a->radii_per_frame; ++k) {
        sph__io_text_add(&w->file.json, k == 0 ? ",\"radii\":[" : ",");
        sph__io_text_float(&w->file.json, w->a->radii[simplex[k]]);
        if (k + 1 == corners) sph__io_text_add(&w->file.json, "]");
    }
    sph__io_text_add(&w->file.json, "}}}");
}

void sph__io_glb_primitives(sph__io_glb *w, uint32_t first)
{
    const sph_level_arrays *a = w->a;
    const size_t count = a->edge_count + a->triangle_count;
    sph__io_text_add(&w->file.json, ",{\"name\":\"primitives\"");
    for (size_t i = 0; i < count; ++i)
        sph__io_text_add(&w->file.json, "%s%zu", i == 0 ? ",\"children\":[" : ",", first + 1 + i);
    sph__io_text_add(&w->file.json, count == 0 ? "}" : "]}");
    for (size_t i = 0; i < a->edge_count; ++i)
        add_simplex(w, "capsule", i, a->edges + 2 * i, 2);
    for (size_t i = 0; i < a->triangle_count; ++i)
        add_simplex(w, "triangle", i, a->triangles + 3 * i, 3);
}

void sph__io_glb_sphere_extras(sph__io_glb *w, uint32_t sphere)
{
    const sph_level_arrays *a = w->a;
    sph__io_text_add(&w->file.json, ",\"extras\":{\"sphmesh\":{\"type\":\"sphere\",\"sphere\":%u,\"alone\":%s,",
                     (unsigned)sphere, w->used[sphere] ? "false" : "true");
    if (!a->radii_per_frame) {
        sph__io_text_add(&w->file.json, "\"radius\":");
        sph__io_text_float(&w->file.json, a->radii[sphere]);
    }
    for (size_t f = 0; f < a->frame_count && a->radii_per_frame; ++f) {
        sph__io_text_add(&w->file.json, f == 0 ? "\"radii\":[" : ",");
        sph__io_text_float(&w->file.json, a->radii[f * a->sphere_count + sphere]);
        if (f + 1 == a->frame_count) sph__io_text_add(&w->file.json, "]");
    }
    sph__io_text_add(&w->file.json, "}}");
}

static void add_double(sph__io_glb *w, double value)
{
    char text[40];
    snprintf(text, sizeof text, "%.17g", value);
    for (char *p = text; *p != '\0'; ++p)
        if (*p == ',') *p = '.'; /* whatever the locale */
    sph__io_text_add(&w->file.json, "%s", text);
}

void sph__io_glb_scene_extras(sph__io_glb *w, uint32_t first)
{
    const sph_coverage *c = w->of->coverage;
    sph__io_text_add(&w->file.json, ",%u],\"extras\":{\"sphmesh\":{\"frames\":%u,\"first_frame\":%u,\"frame_step\":%u",
                     (unsigned)first, (unsigned)w->a->frame_count, (unsigned)w->of->first_frame,
                     (unsigned)w->of->frame_step);
    if (c != NULL) {
        sph__io_text_add(&w->file.json, ",\"coverage\":{\"contains_all_vertices\":%s,\"largest_uncovered_distance\":",
                         c->uncovered_count == 0 ? "true" : "false");
        add_double(w, c->distance);
        sph__io_text_add(&w->file.json, ",\"frame\":%u,\"vertex\":%u,\"uncovered\":%" PRIu64 "}", (unsigned)c->frame,
                         (unsigned)c->vertex, c->uncovered_count);
    }
    sph__io_text_add(&w->file.json, "}}");
}
