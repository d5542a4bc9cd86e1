/* SPDX-License-Identifier: MIT */
/* Levels as lists of spheres, for planners of robots. */
#include <string.h>

#include "io/level_export.h"

/* The pieces of text of a format: what stands around the level's name, and around the numbers of a sphere. */
typedef struct list_format {
    const char *before_note, *after_note;
    const char *head[4]; /* the name between each two of them; ends with NULL */
    const char *before_center, *between_numbers, *before_radius, *after_radius;
    const char *foot;
    bool pointed; /* numbers need a point */
} list_format;

static const list_format SRDF = {
    .before_note = "<!-- ",
    .after_note = " -->\n",
    .head = {"<robot name=\"", "\">\n  <link_sphere_approximation link=\"", "\">\n"},
    .before_center = "    <sphere center=\"",
    .between_numbers = " ",
    .before_radius = "\" radius=\"",
    .after_radius = "\"/>\n",
    .foot = "  </link_sphere_approximation>\n</robot>\n",
};
static const list_format URDF = {
    .before_note = "<!-- ",
    .after_note = " -->\n",
    .head = {"<robot name=\"", "\">\n  <link name=\"", "\">\n"},
    .before_center = "    <collision><origin xyz=\"",
    .between_numbers = " ",
    .before_radius = "\" rpy=\"0 0 0\"/><geometry><sphere radius=\"",
    .after_radius = "\"/></geometry></collision>\n",
    .foot = "  </link>\n</robot>\n",
};
static const list_format YAML = {
    .before_note = "# ",
    .after_note = "\n",
    .head = {"collision_spheres:\n  \"", "\":\n"},
    .before_center = "    - center: [",
    .between_numbers = ", ",
    .before_radius = "]\n      radius: ",
    .after_radius = "\n",
    .foot = "",
    .pointed = true,
};

/* YAML 1.1 takes 1e-05 for a text: a number needs its point. */
static void put_number(sph__io_output *o, const list_format *format, float value)
{
    char text[SPH__IO_FLOAT_TEXT];
    const size_t length = sph__io_format_float(text, value), digits = strcspn(text, "eE");
    sph__io_output_bytes(o, text, digits);
    if (format->pointed && memchr(text, '.', digits) == NULL) sph__io_output_text(o, ".0");
    sph__io_output_bytes(o, text + digits, length - digits);
}

static void put_text(sph__io_output *o, const char *text)
{
    sph__io_output_text(o, "%s", text);
}

static void put_head(sph__io_output *o, const list_format *format, const char *name)
{
    put_text(o, format->head[0]);
    for (int i = 1; format->head[i] != NULL; ++i) {
        put_text(o, name);
        put_text(o, format->head[i]);
    }
}

static void put_sphere(sph__io_output *o, const list_format *format, const sph__io_ball *ball)
{
    for (int k = 0; k < 3; ++k) {
        put_text(o, k == 0 ? format->before_center : format->between_numbers);
        put_number(o, format, ball->center[k]);
    }
    put_text(o, format->before_radius);
    put_number(o, format, ball->radius);
    put_text(o, format->after_radius);
}

static void write_list(sph__io_output *o, sph__io_export *e, const list_format *format)
{
    sph__io_balls balls = {.context = e->context};
    const sph_status status = sph__io_cover_with_balls(e, &balls);
    if (status != SPH_OK) {
        if (o->status == SPH_OK) o->status = status;
        sph__io_balls_release(&balls);
        return;
    }
    sph__io_export_notes(o, e, format->before_note, format->after_note);
    sph__io_output_text(o, "%s%zu spheres that %s ", format->before_note, balls.count,
                        e->cover_solid ? "contain its solid, and reach beyond it by at most"
                                       : "lie in its solid, of which no point is farther from them than");
    sph__io_export_double(o, balls.gap);
    sph__io_output_text(o, "%s", format->after_note);
    put_head(o, format, e->name);
    for (size_t i = 0; i < balls.count; ++i)
        put_sphere(o, format, &balls.items[i]);
    put_text(o, format->foot);
    e->report->sphere_count = balls.count;
    e->report->capsule_count = 0;
    e->report->triangle_count = 0;
    e->report->gap = balls.gap;
    sph__io_balls_release(&balls);
}

void sph__io_export_srdf(sph__io_output *o, sph__io_export *e)
{
    sph__io_output_text(o, "<?xml version=\"1.0\"?>\n");
    write_list(o, e, &SRDF);
}

void sph__io_export_urdf(sph__io_output *o, sph__io_export *e)
{
    sph__io_output_text(o, "<?xml version=\"1.0\"?>\n");
    write_list(o, e, &URDF);
}

void sph__io_export_yaml(sph__io_output *o, sph__io_export *e)
{
    write_list(o, e, &YAML);
}
