/* SPDX-License-Identifier: MIT */
/* Levels as JSON; docs/formats.md has the schema. */
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "io/io.h"

enum { JSON_VERSION = 1 };

/* --- writing --- */

static void write_floats(sph__io_output *o, const float *values, size_t count)
{
    sph__io_output_text(o, "[");
    for (size_t i = 0; i < count; ++i) {
        if (i != 0) sph__io_output_text(o, ",");
        sph__io_output_float(o, values[i]);
    }
    sph__io_output_text(o, "]");
}

static void write_radii(sph__io_output *o, const sph_level_arrays *a)
{
    sph__io_output_text(o, "\"radii\":");
    if (!a->radii_per_frame) {
        write_floats(o, a->radii, a->sphere_count);
        return;
    }
    for (size_t f = 0; f < a->frame_count; ++f) {
        sph__io_output_text(o, f == 0 ? "[\n" : ",\n");
        write_floats(o, a->radii + f * a->sphere_count, a->sphere_count);
    }
    sph__io_output_text(o, "]");
}

static void write_centers(sph__io_output *o, const sph_level_arrays *a)
{
    sph__io_output_text(o, ",\n\"centers\":");
    for (size_t f = 0; f < a->frame_count; ++f) {
        sph__io_output_text(o, f == 0 ? "[\n" : ",\n");
        for (size_t i = 0; i < a->sphere_count; ++i) {
            sph__io_output_text(o, i == 0 ? "[" : ",");
            write_floats(o, a->centers + 3 * (f * a->sphere_count + i), 3);
        }
        sph__io_output_text(o, "]");
    }
    sph__io_output_text(o, "]");
}

static void write_simplices(sph__io_output *o, const char *name, const uint32_t *indices, size_t count, size_t corners)
{
    sph__io_output_text(o, ",\n\"%s\":[", name);
    for (size_t i = 0; i < count; ++i)
        for (size_t j = 0; j < corners; ++j)
            sph__io_output_text(o, "%s%s%u%s", i != 0 && j == 0 ? "," : "", j == 0 ? "[" : ",",
                                (unsigned)indices[corners * i + j], j + 1 == corners ? "]" : "");
    sph__io_output_text(o, "]");
}

void sph__io_level_json_write(sph__io_output *output, const sph_level_arrays *arrays)
{
    sph__io_output_text(output, "{\"format\":\"sphmesh-level\",\"version\":%d,\"frames\":%u,\"spheres\":%u,\n",
                        JSON_VERSION, (unsigned)arrays->frame_count, (unsigned)arrays->sphere_count);
    write_radii(output, arrays);
    write_centers(output, arrays);
    write_simplices(output, "edges", arrays->edges, arrays->edge_count, 2);
    write_simplices(output, "triangles", arrays->triangles, arrays->triangle_count, 3);
    sph__io_output_text(output, ",\n\"labels\":[");
    for (size_t i = 0; i < arrays->label_count; ++i) {
        if (i != 0) sph__io_output_text(output, ",");
        if (arrays->labels[i] == SPH_NO_SPHERE)
            sph__io_output_text(output, "-1");
        else
            sph__io_output_text(output, "%u", (unsigned)arrays->labels[i]);
    }
    sph__io_output_text(output, "]}\n");
}

/* --- reading --- */

typedef struct floats {
    float *values;
    size_t count, capacity;
} floats;

typedef struct indices {
    uint32_t *values;
    size_t count, capacity;
} indices;

enum { FORMAT, VERSION, FRAMES, SPHERES, RADII, CENTERS, EDGES, TRIANGLES, LABELS, FIELD_COUNT };
static const char *const FIELDS[FIELD_COUNT] = {"format",  "version", "frames",    "spheres", "radii",
                                                "centers", "edges",   "triangles", "labels"};

typedef struct reader {
    sph__io_json json;
    bool seen[FIELD_COUNT];
    int64_t version, frames, spheres;
    floats radii, centers;
    size_t radii_rows, center_rows; /* frames of either; 0 for radii without frames */
    indices edges, triangles, labels;
} reader;

static sph_status out_of_memory(const reader *r)
{
    return sph__io_fail_memory(r->json.context, r->json.path);
}

static sph_status read_float(reader *r, floats *list)
{
    void *memory = list->values;
    float value = 0;
    const sph_status status = sph__io_json_float(&r->json, &value);
    if (status != SPH_OK) return status;
    if (!isfinite(value)) return sph__io_json_fail(&r->json, "a number that a float cannot hold");
    if (!sph__io_reserve(r->json.context, &memory, &list->capacity, list->count + 1, sizeof *list->values))
        return out_of_memory(r);
    list->values = memory;
    list->values[list->count++] = value;
    return SPH_OK;
}

static sph_status read_index(reader *r, indices *list, int64_t least)
{
    void *memory = list->values;
    int64_t value;
    const sph_status status = sph__io_json_integer(&r->json, &value);
    if (status != SPH_OK) return status;
    if (value < least || value >= UINT32_MAX) return sph__io_json_fail(&r->json, "an index out of range");
    if (!sph__io_reserve(r->json.context, &memory, &list->capacity, list->count + 1, sizeof *list->values))
        return out_of_memory(r);
    list->values = memory;
    list->values[list->count++] = value < 0 ? SPH_NO_SPHERE : (uint32_t)value;
    return SPH_OK;
}

/* [x, y, ...] onto the list; *count says how many. */
static sph_status read_row(reader *r, floats *list, size_t *count)
{
    const size_t before = list->count;
    bool first = true, more;
    sph_status status = sph__io_json_take(&r->json, '[', "not an array of numbers");
    while (status == SPH_OK && (status = sph__io_json_next(&r->json, ']', &first, &more)) == SPH_OK && more)
        status = read_float(r, list);
    *count = list->count - before;
    return status;
}

/* One frame's centres, or for all frames' radii one frame's. */
static sph_status read_center_row(reader *r, size_t *count)
{
    bool first = true, more;
    sph_status status = sph__io_json_take(&r->json, '[', "not an array of centres");
    *count = 0;
    while (status == SPH_OK && (status = sph__io_json_next(&r->json, ']', &first, &more)) == SPH_OK && more) {
        size_t coordinates;
        status = read_row(r, &r->centers, &coordinates);
        if (status == SPH_OK && coordinates != 3)
            status = sph__io_json_fail(&r->json, "a centre without 3 coordinates");
        ++*count;
    }
    return status;
}

static sph_status read_centers(reader *r)
{
    bool first = true, more;
    size_t width = 0;
    sph_status status = sph__io_json_take(&r->json, '[', "not an array of frames");
    while (status == SPH_OK && (status = sph__io_json_next(&r->json, ']', &first, &more)) == SPH_OK && more) {
        size_t count;
        status = read_center_row(r, &count);
        if (status == SPH_OK && r->center_rows != 0 && count != width)
            status = sph__io_json_fail(&r->json, "frames with different numbers of centres");
        width = count;
        ++r->center_rows;
    }
    return status;
}

static sph_status read_radii(reader *r)
{
    bool first = true, more;
    size_t width = 0;
    sph_status status = sph__io_json_take(&r->json, '[', "not an array of radii");
    while (status == SPH_OK && (status = sph__io_json_next(&r->json, ']', &first, &more)) == SPH_OK && more) {
        size_t count;
        if (sph__io_json_peek(&r->json) != '[') {
            if (r->radii_rows != 0) return sph__io_json_fail(&r->json, "radii with and without frames");
            status = read_float(r, &r->radii);
            continue;
        }
        if (r->radii_rows == 0 && r->radii.count != 0)
            return sph__io_json_fail(&r->json, "radii with and without frames");
        status = read_row(r, &r->radii, &count);
        if (status == SPH_OK && r->radii_rows != 0 && count != width)
            status = sph__io_json_fail(&r->json, "frames with different numbers of radii");
        width = count;
        ++r->radii_rows;
    }
    return status;
}

/* [[a, b], ...] of `corners` indices each. */
static sph_status read_simplices(reader *r, indices *list, size_t corners)
{
    bool first = true, more;
    sph_status status = sph__io_json_take(&r->json, '[', "not an array of edges or triangles");
    while (status == SPH_OK && (status = sph__io_json_next(&r->json, ']', &first, &more)) == SPH_OK && more) {
        const size_t before = list->count;
        bool first_corner = true, more_corners;
        status = sph__io_json_take(&r->json, '[', "not an edge or triangle");
        while (status == SPH_OK &&
               (status = sph__io_json_next(&r->json, ']', &first_corner, &more_corners)) == SPH_OK && more_corners)
            status = read_index(r, list, 0);
        if (status == SPH_OK && list->count - before != corners)
            status =
                sph__io_json_fail(&r->json, corners == 2 ? "an edge without 2 ends" : "a triangle without 3 corners");
    }
    return status;
}

static sph_status read_labels(reader *r)
{
    bool first = true, more;
    sph_status status = sph__io_json_take(&r->json, '[', "not an array of labels");
    while (status == SPH_OK && (status = sph__io_json_next(&r->json, ']', &first, &more)) == SPH_OK && more)
        status = read_index(r, &r->labels, -1);
    return status;
}

static sph_status read_format(reader *r)
{
    char format[32];
    const sph_status status = sph__io_json_string(&r->json, format, sizeof format);
    if (status == SPH_OK && strcmp(format, "sphmesh-level") != 0)
        return sph__io_json_fail(&r->json, "the format is not sphmesh-level");
    return status;
}

static sph_status read_version(reader *r)
{
    const sph_status status = sph__io_json_integer(&r->json, &r->version);
    if (status == SPH_OK && r->version > JSON_VERSION)
        return sph__io_fail(r->json.context, SPH_E_VERSION, "%s: version %" PRId64 " of the format, only %d is known",
                            sph__io_shown(r->json.path), r->version, JSON_VERSION);
    if (status == SPH_OK && r->version < 1) return sph__io_json_fail(&r->json, "not a version");
    return status;
}

static sph_status read_field(reader *r, size_t field)
{
    switch (field) {
    case FORMAT:
        return read_format(r);
    case VERSION:
        return read_version(r);
    case FRAMES:
        return sph__io_json_integer(&r->json, &r->frames);
    case SPHERES:
        return sph__io_json_integer(&r->json, &r->spheres);
    case RADII:
        return read_radii(r);
    case CENTERS:
        return read_centers(r);
    case EDGES:
        return read_simplices(r, &r->edges, 2);
    case TRIANGLES:
        return read_simplices(r, &r->triangles, 3);
    case LABELS:
        return read_labels(r);
    default:
        return sph__io_json_skip(&r->json);
    }
}

static sph_status read_document(reader *r)
{
    bool first = true, more;
    sph_status status = sph__io_json_take(&r->json, '{', "not a JSON object");
    while (status == SPH_OK && (status = sph__io_json_next(&r->json, '}', &first, &more)) == SPH_OK && more) {
        char name[32];
        size_t field = 0;
        status = sph__io_json_string(&r->json, name, sizeof name);
        if (status == SPH_OK) status = sph__io_json_take(&r->json, ':', "not :");
        if (status != SPH_OK) return status;
        while (field < FIELD_COUNT && strcmp(name, FIELDS[field]) != 0)
            ++field;
        if (field < FIELD_COUNT && r->seen[field]) return sph__io_json_fail(&r->json, "a field that was there before");
        if (field < FIELD_COUNT) r->seen[field] = true;
        status = read_field(r, field);
    }
    if (status == SPH_OK && sph__io_json_peek(&r->json) != '\0')
        return sph__io_json_fail(&r->json, "more after the end");
    if (status == SPH_OK && r->json.p != r->json.end) return sph__io_json_fail(&r->json, "more after the end");
    return status;
}

static sph_status fail_shape(const reader *r, const char *what, size_t found, int64_t wanted)
{
    return sph__io_fail(r->json.context, SPH_E_FORMAT, "%s: %zu %s, not %" PRId64, sph__io_shown(r->json.path), found,
                        what, wanted);
}

static sph_status check_shape(const reader *r)
{
    for (size_t i = 0; i < EDGES; ++i)
        if (!r->seen[i])
            return sph__io_fail(r->json.context, SPH_E_FORMAT, "%s: no \"%s\"", sph__io_shown(r->json.path), FIELDS[i]);
    if (r->frames < 1 || r->frames > UINT32_MAX || r->spheres < 1 || r->spheres > UINT32_MAX)
        return sph__io_fail(r->json.context, SPH_E_FORMAT, "%s: %" PRId64 " frames of %" PRId64 " spheres",
                            sph__io_shown(r->json.path), r->frames, r->spheres);
    if ((int64_t)r->center_rows != r->frames) return fail_shape(r, "frames of centres", r->center_rows, r->frames);
    if ((int64_t)(r->centers.count / 3 / r->center_rows) != r->spheres)
        return fail_shape(r, "centres in a frame", r->centers.count / 3 / r->center_rows, r->spheres);
    if (r->radii_rows != 0 && (int64_t)r->radii_rows != r->frames)
        return fail_shape(r, "frames of radii", r->radii_rows, r->frames);
    if ((int64_t)(r->radii.count / (r->radii_rows == 0 ? 1 : r->radii_rows)) != r->spheres)
        return fail_shape(r, "radii in a frame", r->radii.count / (r->radii_rows == 0 ? 1 : r->radii_rows), r->spheres);
    return SPH_OK;
}

static sph_status make_level(const reader *r, sph_level **out)
{
    const sph_level_arrays arrays = {sizeof arrays,       (uint32_t)r->spheres, (uint32_t)r->frames,
                                     r->radii_rows != 0,  r->centers.values,    r->radii.values,
                                     r->edges.count / 2,  r->edges.values,      r->triangles.count / 3,
                                     r->triangles.values, r->labels.count,      r->labels.values};
    const sph_status status = sph_level_create_from_arrays(r->json.context, &arrays, out);
    if (status != SPH_E_INVALID) return status;
    return sph__io_fail(r->json.context, SPH_E_FORMAT, "%s: %s", sph__io_shown(r->json.path),
                        sph_context_last_message(r->json.context));
}

sph_status sph__io_level_json_read(sph_context *context, const char *path, const sph__io_map *map, sph_level **out)
{
    const char *start = (const char *)map->bytes;
    reader r = {.json = {.context = context, .path = path, .start = start, .p = start, .end = start + map->size}};
    sph_status status = read_document(&r);
    if (status == SPH_OK) status = check_shape(&r);
    if (status == SPH_OK) status = make_level(&r, out);
    sph_context_release(context, r.radii.values);
    sph_context_release(context, r.centers.values);
    sph_context_release(context, r.edges.values);
    sph_context_release(context, r.triangles.values);
    sph_context_release(context, r.labels.values);
    return status;
}
