/* SPDX-License-Identifier: MIT */
#include "report.h"

#include <inttypes.h>
#include <stdarg.h>
#include <string.h>

enum { TEXTS = 8, TEXT_SIZE = 40 };

/* The program prints from one thread, and never more than a line at a time. */
static char *next_text(void)
{
    static char texts[TEXTS][TEXT_SIZE];
    static int next;
    next = (next + 1) % TEXTS;
    return texts[next];
}

const char *count_text(uint64_t count)
{
    char digits[TEXT_SIZE], *text = next_text(), *to = text;
    const int length = snprintf(digits, sizeof digits, "%" PRIu64, count);
    for (int i = 0; i < length; ++i) {
        if (i > 0 && (length - i) % 3 == 0 && length > 4) *to++ = ' ';
        *to++ = digits[i];
    }
    *to = '\0';
    return text;
}

const char *size_text(uint64_t bytes)
{
    static const char *const UNITS[] = {"bytes", "kB", "MB", "GB", "TB"};
    char *text = next_text();
    double value = (double)bytes;
    int unit = 0;
    while (value >= 1000 && unit < 4) {
        value /= 1000;
        ++unit;
    }
    snprintf(text, TEXT_SIZE, unit == 0 || value >= 100 ? "%.0f %s" : "%.1f %s", value, UNITS[unit]);
    return text;
}

/* One finding: what there is, and what it means. */
static void finding(int *count, const char *hint, const char *format, ...) __attribute__((format(printf, 3, 4)));

static void finding(int *count, const char *hint, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fputs(*count == 0 ? "check:      " : "            ", stdout);
    vprintf(format, arguments);
    printf("\n              %s\n", hint);
    va_end(arguments);
    ++*count;
}

static const char *plural(uint64_t count, const char *one, const char *many)
{
    return count == 1 ? one : many;
}

static void report_broken(const sph_animation_report *r, int *count)
{
    if (r->non_finite_count > 0)
        finding(count, "a hierarchy cannot be built from these: repair the file, or leave the frame out with --frames",
                "%s %s not a number, first vertex %" PRIu32 " in frame %" PRIu32, count_text(r->non_finite_count),
                plural(r->non_finite_count, "position is", "positions are"), r->first_non_finite_vertex,
                r->first_non_finite_frame);
    if (r->repeated_index_count > 0)
        finding(count, "they are left out of everything; harmless", "%s %s one vertex twice, first number %" PRIu64,
                count_text(r->repeated_index_count),
                plural(r->repeated_index_count, "triangle or edge names", "triangles or edges name"),
                r->first_repeated_index);
    if (r->duplicate_triangle_count > 0)
        finding(count, "each weighs on the spheres as often as it is there; usually an export error",
                "%s %s the same three vertices as another", count_text(r->duplicate_triangle_count),
                plural(r->duplicate_triangle_count, "triangle has", "triangles have"));
    if (r->zero_area_count > 0)
        finding(count, "they have no say in these frames; harmless if few",
                "%s times a triangle has no area in a frame, first triangle %" PRIu32 " in frame %" PRIu32,
                count_text(r->zero_area_count), r->first_zero_area_triangle, r->first_zero_area_frame);
}

static void report_shape(const sph_animation_report *r, int *count)
{
    if (r->coincident_vertex_count > 0)
        finding(count, "seams keep the parts on either side from uniting: build with --weld",
                "%s %s with another in all frames", count_text(r->coincident_vertex_count),
                plural(r->coincident_vertex_count, "vertex coincides", "vertices coincide"));
    if (r->inconsistent_edge_count > 0)
        finding(count, "spheres need to know where outside is: make the normals consistent in your modeller",
                "the triangles at %s %s are wound against each other", count_text(r->inconsistent_edge_count),
                plural(r->inconsistent_edge_count, "edge", "edges"));
    if (r->inward_component_count > 0)
        finding(count, "they are taken as wound the other way round; nothing to do", "%s %s wound inside out",
                count_text(r->inward_component_count),
                plural(r->inward_component_count, "component is", "components are"));
    if (r->non_manifold_edge_count > 0)
        finding(count, "accepted; the surface has no clear inside there", "%s %s to three or more triangles",
                count_text(r->non_manifold_edge_count),
                plural(r->non_manifold_edge_count, "edge belongs", "edges belong"));
    if (r->boundary_edge_count > 0)
        finding(count, "the surface is open there; small holes do no harm", "%s %s to one triangle only",
                count_text(r->boundary_edge_count), plural(r->boundary_edge_count, "edge belongs", "edges belong"));
    if (r->component_count > 1)
        finding(count, "each keeps a sphere of its own to the end: no level has fewer spheres", "%s components",
                count_text(r->component_count));
    if (r->isolated_vertex_count > 0)
        finding(count, "each would be a component of its own; remove them in your modeller",
                "%s %s to no triangle and no edge", count_text(r->isolated_vertex_count),
                plural(r->isolated_vertex_count, "vertex belongs", "vertices belong"));
}

void report_check(const sph_animation_report *r)
{
    int count = 0;
    report_broken(r, &count);
    report_shape(r, &count);
    if (count == 0)
        puts(r->wire_edge_count > 0 ? "check:      sound: one component"
                                    : "check:      sound: one closed, consistently wound component");
}

void report_check_json(json *j, const sph_animation_report *r)
{
    json_open(j, "check", '{');
    json_integer(j, "non_finite", r->non_finite_count);
    json_integer(j, "repeated_index", r->repeated_index_count);
    json_integer(j, "duplicate_triangles", r->duplicate_triangle_count);
    json_integer(j, "zero_area", r->zero_area_count);
    json_integer(j, "boundary_edges", r->boundary_edge_count);
    json_integer(j, "non_manifold_edges", r->non_manifold_edge_count);
    json_integer(j, "inconsistent_edges", r->inconsistent_edge_count);
    json_integer(j, "wire_edges", r->wire_edge_count);
    json_integer(j, "components", r->component_count);
    json_integer(j, "isolated_vertices", r->isolated_vertex_count);
    json_integer(j, "coincident_vertices", r->coincident_vertex_count);
    json_integer(j, "inward_components", r->inward_component_count);
    json_close(j, '}');
}

void report_distances_json(json *j, const sph_distances *d, double factor)
{
    json_number(j, "hausdorff", factor * d->hausdorff);
    json_number(j, "mean12", factor * d->mean12);
    json_number(j, "mean21", factor * d->mean21);
    json_number(j, "max12", factor * d->max12);
    json_number(j, "max21", factor * d->max21);
}

uint32_t coarsest_count(const sph_hierarchy *h)
{
    return sph_hierarchy_vertex_count(h) - sph_hierarchy_collapse_count(h);
}

double level_error(const sph_hierarchy *h, uint32_t sphere_count)
{
    sph_collapse c;
    const uint32_t n = sph_hierarchy_vertex_count(h);
    if (sphere_count >= n || sph_hierarchy_collapse(h, n - sphere_count - 1, &c) != SPH_OK) return 0;
    return c.error;
}
