/* SPDX-License-Identifier: MIT */
/* Levels as lists of spheres, for planners of robots. */
#include <string.h>

#include "io/level_export.h"

typedef struct list_format {
    const char *before_note, *after_note;
    void (*begin)(sph__io_output *o, const char *name);
    void (*put)(sph__io_output *o, const sph__io_ball *ball);
    void (*end)(sph__io_output *o);
} list_format;

static void put_center(sph__io_output *o, const sph__io_ball *ball)
{
    sph__io_output_floats(o, ball->center, 3);
}

/* --- SRDF --- */

static void begin_srdf(sph__io_output *o, const char *name)
{
    sph__io_output_text(o, "<robot name=\"%s\">\n", name);
    sph__io_output_text(o, "  <link_sphere_approximation link=\"%s\">\n", name);
}

static void put_srdf(sph__io_output *o, const sph__io_ball *ball)
{
    sph__io_output_text(o, "    <sphere center=\"");
    put_center(o, ball);
    sph__io_output_text(o, "\" radius=\"");
    sph__io_output_float(o, ball->radius);
    sph__io_output_text(o, "\"/>\n");
}

static void end_srdf(sph__io_output *o)
{
    sph__io_output_text(o, "  </link_sphere_approximation>\n</robot>\n");
}

/* --- URDF --- */

static void begin_urdf(sph__io_output *o, const char *name)
{
    sph__io_output_text(o, "<robot name=\"%s\">\n", name);
    sph__io_output_text(o, "  <link name=\"%s\">\n", name);
}

static void put_urdf(sph__io_output *o, const sph__io_ball *ball)
{
    sph__io_output_text(o, "    <collision><origin xyz=\"");
    put_center(o, ball);
    sph__io_output_text(o, "\" rpy=\"0 0 0\"/><geometry><sphere radius=\"");
    sph__io_output_float(o, ball->radius);
    sph__io_output_text(o, "\"/></geometry></collision>\n");
}

static void end_urdf(sph__io_output *o)
{
    sph__io_output_text(o, "  </link>\n</robot>\n");
}

/* --- YAML --- */

/* YAML 1.1 takes 1e-05 for a text: a number needs its point. */
static void put_yaml_float(sph__io_output *o, float value)
{
    char text[SPH__IO_FLOAT_TEXT];
    const size_t length = sph__io_format_float(text, value), digits = strcspn(text, "eE");
    sph__io_output_bytes(o, text, digits);
    if (memchr(text, '.', digits) == NULL) sph__io_output_text(o, ".0");
    sph__io_output_bytes(o, text + digits, length - digits);
}

static void begin_yaml(sph__io_output *o, const char *name)
{
    sph__io_output_text(o, "collision_spheres:\n  \"%s\":\n", name);
}

static void put_yaml(sph__io_output *o, const sph__io_ball *ball)
{
    for (int k = 0; k < 3; ++k) {
        sph__io_output_text(o, k == 0 ? "    - center: [" : ", ");
        put_yaml_float(o, ball->center[k]);
    }
    sph__io_output_text(o, "]\n      radius: ");
    put_yaml_float(o, ball->radius);
    sph__io_output_text(o, "\n");
}

static void end_yaml(sph__io_output *o)
{
    (void)o;
}

/* --- all --- */

static const list_format SRDF = {"<!-- ", " -->\n", begin_srdf, put_srdf, end_srdf};
static const list_format URDF = {"<!-- ", " -->\n", begin_urdf, put_urdf, end_urdf};
static const list_format YAML = {"# ", "\n", begin_yaml, put_yaml, end_yaml};

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
    format->begin(o, e->name);
    for (size_t i = 0; i < balls.count; ++i)
        format->put(o, &balls.items[i]);
    format->end(o);
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
