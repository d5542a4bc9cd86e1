/* SPDX-License-Identifier: MIT */
/* Polygon File Format (Stanford): text, and both kinds of binary. */
#include <math.h>
#include <stdio.h>

#include "io/bytes.h"
#include "io/ply.h"

/* One element as it is read. */
typedef struct instance {
    float xyz[3];
    int64_t ends[2];
    sph__io_fan face;
} instance;

static const unsigned char *bytes(const sph__ply *s)
{
    return (const unsigned char *)s->text.p;
}

static size_t room(const sph__ply *s)
{
    return (size_t)(s->text.end - s->text.p);
}

/* Where the reader is, for messages: a line of a text, a byte else. */
static size_t place(const sph__ply *s)
{
    return s->binary ? (size_t)(s->text.p - s->start) : s->text.line;
}

static sph_status fail(const sph__ply *s, const char *what)
{
    return sph__io_fail(s->text.context, SPH_E_FORMAT, "%s: %s %zu: %s", sph__io_shown(s->text.path),
                        s->binary ? "byte" : "line", place(s), what);
}

static sph_status fail_end(const sph__ply *s, const sph__ply_element *e, size_t number)
{
    return sph__io_fail(s->text.context, SPH_E_FORMAT, "%s: ends at byte %zu, within %.*s %zu of %zu",
                        sph__io_shown(s->text.path), (size_t)(s->text.end - s->start), e->name_length, e->name, number,
                        e->count);
}

static sph_status fail_index(const sph__ply *s, int64_t index)
{
    return sph__io_fail(s->text.context, SPH_E_FORMAT, "%s: %s %zu: vertex index %lld, but there are %zu vertices",
                        sph__io_shown(s->text.path), s->binary ? "byte" : "line", place(s), (long long)index,
                        s->vertex_count);
}

static inline sph_status add_corner(sph__ply *s, instance *v, int64_t index)
{
    if (index < 0 || (uint64_t)index >= s->vertex_count) return fail_index(s, index);
    return sph__io_add_corner(s->mesh, s->text.path, &v->face, (uint32_t)index);
}

/* Puts an element that was read in its place in the mesh. `where` is the place of its start. */
static inline sph_status keep(sph__ply *s, const sph__ply_element *e, const instance *v, size_t where)
{
    sph__io_mesh *mesh = s->mesh;
    if (e->kind == SPH__PLY_VERTEX) {
        for (unsigned i = 0; i < 3; ++i) /* there is room for all of them */
            mesh->positions[3 * mesh->vertex_count + i] = v->xyz[i];
        ++mesh->vertex_count;
    } else if (e->kind == SPH__PLY_FACE) {
        sph__io_watch_face(&s->watch, mesh, where);
        if (v->face.count >= 3) return SPH_OK;
        if (s->binary) s->text.p = s->start + where;
        return fail(s, "a face of fewer than 3 vertices");
    } else if (e->kind == SPH__PLY_EDGE) {
        for (unsigned i = 0; i < 2; ++i)
            if (v->ends[i] < 0 || (uint64_t)v->ends[i] >= s->vertex_count) return fail_index(s, v->ends[i]);
        return sph__io_add_edge(mesh, s->text.path, (uint32_t)v->ends[0], (uint32_t)v->ends[1]);
    }
    return SPH_OK;
}

/* --- text: an element is a line --- */

/* A whole number, of whatever type. */
static bool read_integer(sph__ply *s, unsigned type, int64_t *value)
{
    float number;
    sph__io_skip_blanks(&s->text);
    if (type != SPH__PLY_FLOAT32 && type != SPH__PLY_FLOAT64)
        return sph__io_text_integer(&s->text, value) && sph__io_at_token_end(&s->text);
    if (!sph__io_text_float(&s->text, &number) || !(fabsf(number) <= 0x1p24f) || number != floorf(number)) return false;
    *value = (int64_t)number;
    return true;
}

static bool skip_word(sph__ply *s)
{
    sph__io_skip_blanks(&s->text);
    if (sph__io_at_line_end(&s->text)) return false;
    s->text.p += sph__io_word_length(&s->text);
    return true;
}

static sph_status read_list(sph__ply *s, const sph__ply_property *p, instance *v)
{
    int64_t count, index;
    sph_status status = SPH_OK;
    if (!read_integer(s, p->count_type, &count) || count < 0) return fail(s, "a list without its count");
    for (int64_t i = 0; i < count && status == SPH_OK; ++i) {
        if (p->role != SPH__PLY_CORNERS) {
            if (!skip_word(s)) return fail(s, "a list that is shorter than its count says");
        } else if (!read_integer(s, p->type, &index)) {
            return fail(s, "a face with fewer vertices than its count says, or with something that is not an index");
        } else {
            status = add_corner(s, v, index);
        }
    }
    return status;
}

static sph_status read_line(sph__ply *s, const sph__ply_element *e, instance *v)
{
    for (size_t i = 0; i < e->property_count; ++i) {
        const sph__ply_property *p = &s->properties[e->first + i];
        if (p->count_type != SPH__PLY_NONE) {
            const sph_status status = read_list(s, p, v);
            if (status != SPH_OK) return status;
        } else if (p->role == SPH__PLY_SKIP) {
            if (!skip_word(s)) return fail(s, "fewer values than the header has properties");
        } else if (p->role >= SPH__PLY_START) {
            if (!read_integer(s, p->type, &v->ends[p->role - SPH__PLY_START])) return fail(s, "not a vertex index");
        } else {
            sph__io_skip_blanks(&s->text);
            if (!sph__io_text_float(&s->text, &v->xyz[p->role - SPH__PLY_X]))
                return fail(s, "a vertex with a coordinate that is missing or not a number");
        }
    }
    sph__io_skip_blanks(&s->text);
    return sph__io_at_line_end(&s->text) ? SPH_OK : fail(s, "more values than the header has properties");
}

static sph_status read_text_element(sph__ply *s, const sph__ply_element *e)
{
    for (size_t i = 0; i < e->count && e->property_count != 0; ++i) {
        instance v = {.face.count = 0};
        sph_status status = SPH_OK;
        if (!sph__io_skip_empty_lines(&s->text)) return fail_end(s, e, i);
        if (e->kind != SPH__PLY_OTHER) status = read_line(s, e, &v);
        if (status == SPH_OK) status = keep(s, e, &v, s->text.line);
        if (status != SPH_OK) return status;
        sph__io_next_line(&s->text);
    }
    return SPH_OK;
}

/* --- binary --- */

/* A whole number, of whatever type. */
static inline bool load_integer(const unsigned char *p, unsigned type, bool big, int64_t *value)
{
    double number;
    switch (type) {
    case SPH__PLY_INT8:
        *value = (int8_t)*p;
        return true;
    case SPH__PLY_UINT8:
        *value = *p;
        return true;
    case SPH__PLY_INT16:
        *value = (int16_t)sph__io_load_16(p, big);
        return true;
    case SPH__PLY_UINT16:
        *value = sph__io_load_16(p, big);
        return true;
    case SPH__PLY_INT32:
        *value = (int32_t)sph__io_load_32(p, big);
        return true;
    case SPH__PLY_UINT32:
        *value = sph__io_load_32(p, big);
        return true;
    case SPH__PLY_FLOAT32:
        number = (double)sph__io_load_float(p, big);
        break;
    default:
        number = sph__io_load_double(p, big);
        break;
    }
    if (!(fabs(number) <= SPH__IO_INDEX_LIMIT) || number != floor(number)) return false;
    *value = (int64_t)number;
    return true;
}

static inline float load_number(const unsigned char *p, unsigned type, bool big)
{
    int64_t value = 0;
    if (type == SPH__PLY_FLOAT32) return sph__io_load_float(p, big);
    if (type == SPH__PLY_FLOAT64) return (float)sph__io_load_double(p, big);
    (void)load_integer(p, type, big, &value);
    return (float)value;
}

/* Without lists all elements are as long: the size has been checked with the header. */
static void load_vertices(sph__ply *s, const sph__ply_element *e)
{
    size_t offsets[3] = {0}, offset = 0;
    unsigned types[3] = {0};
    bool floats = true;
    float *out = s->mesh->positions;
    for (size_t i = 0; i < e->property_count; ++i) {
        const sph__ply_property *p = &s->properties[e->first + i];
        if (p->role != SPH__PLY_SKIP) {
            offsets[p->role - SPH__PLY_X] = offset;
            types[p->role - SPH__PLY_X] = p->type;
            floats = floats && p->type == SPH__PLY_FLOAT32;
        }
        offset += sph__ply_sizes[p->type];
    }
    for (size_t i = 0; i < e->count; ++i) {
        const unsigned char *p = bytes(s) + i * e->least;
        for (unsigned j = 0; j < 3; ++j)
            *out++ =
                floats ? sph__io_load_float(p + offsets[j], s->big) : load_number(p + offsets[j], types[j], s->big);
    }
    s->mesh->vertex_count = e->count;
    s->text.p += e->count * e->least;
}

/* The usual face without detours; false leaves it to the others. */
static inline bool load_triangle(sph__ply *s, const sph__ply_property *p, size_t count, instance *v)
{
    sph__io_mesh *mesh = s->mesh;
    uint32_t *triangle = mesh->triangles + 3 * mesh->triangle_count;
    if (count != 3 || (p->type != SPH__PLY_INT32 && p->type != SPH__PLY_UINT32)) return false;
    if (mesh->triangle_count == mesh->triangle_capacity) return false;
    for (unsigned i = 0; i < 3; ++i) {
        const uint32_t index = sph__io_load_32(bytes(s) + 4 * i, s->big);
        if (index >= s->vertex_count) return false; /* a negative one too */
        triangle[i] = index;
    }
    ++mesh->triangle_count;
    v->face.count = 3;
    s->text.p += 12;
    return true;
}

/* The file has room for them. */
static sph_status load_corners(sph__ply *s, const sph__ply_property *p, size_t count, instance *v)
{
    const size_t size = sph__ply_sizes[p->type];
    if (load_triangle(s, p, count, v)) return SPH_OK;
    for (size_t i = 0; i < count; ++i, s->text.p += size) {
        int64_t index;
        sph_status status;
        if (!load_integer(bytes(s), p->type, s->big, &index)) return fail(s, "a vertex index that is not whole");
        if ((status = add_corner(s, v, index)) != SPH_OK) return status;
    }
    return SPH_OK;
}

static sph_status load_list(sph__ply *s, const sph__ply_element *e, const sph__ply_property *p, instance *v,
                            size_t number)
{
    int64_t count;
    if (room(s) < sph__ply_sizes[p->count_type]) return fail_end(s, e, number);
    if (!load_integer(bytes(s), p->count_type, s->big, &count) || count < 0)
        return fail(s, "the count of a list is negative or not whole");
    s->text.p += sph__ply_sizes[p->count_type];
    if ((uint64_t)count > room(s) / sph__ply_sizes[p->type]) return fail_end(s, e, number);
    if (p->role == SPH__PLY_CORNERS) return load_corners(s, p, (size_t)count, v);
    s->text.p += (size_t)count * sph__ply_sizes[p->type];
    return SPH_OK;
}

static inline sph_status load_instance(sph__ply *s, const sph__ply_element *e, instance *v, size_t number)
{
    for (size_t i = 0; i < e->property_count; ++i) {
        const sph__ply_property *p = &s->properties[e->first + i];
        if (p->count_type != SPH__PLY_NONE) {
            const sph_status status = load_list(s, e, p, v, number);
            if (status != SPH_OK) return status;
            continue;
        }
        if (room(s) < sph__ply_sizes[p->type]) return fail_end(s, e, number);
        if (p->role >= SPH__PLY_START) {
            if (!load_integer(bytes(s), p->type, s->big, &v->ends[p->role - SPH__PLY_START]))
                return fail(s, "a vertex index that is not whole");
        } else if (p->role >= SPH__PLY_X) {
            v->xyz[p->role - SPH__PLY_X] = load_number(bytes(s), p->type, s->big);
        }
        s->text.p += sph__ply_sizes[p->type];
    }
    return SPH_OK;
}

static sph_status load_element(sph__ply *s, const sph__ply_element *e)
{
    if (!e->lists && (e->kind == SPH__PLY_VERTEX || e->kind == SPH__PLY_OTHER)) {
        if (e->least != 0 && e->count > room(s) / e->least) return fail_end(s, e, room(s) / e->least);
        if (e->kind == SPH__PLY_VERTEX)
            load_vertices(s, e);
        else
            s->text.p += e->count * e->least;
        return SPH_OK;
    }
    for (size_t i = 0; i < e->count && e->property_count != 0; ++i) {
        const size_t where = place(s);
        instance v = {.face.count = 0};
        sph_status status = load_instance(s, e, &v, i);
        if (status == SPH_OK) status = keep(s, e, &v, where);
        if (status != SPH_OK) return status;
    }
    return SPH_OK;
}

static void warn_of_rest(sph__ply *s)
{
    if (!s->binary)
        sph__io_warn_of_rest(&s->text);
    else if (room(s) != 0)
        sph_context_log(s->text.context, SPH_LOG_WARNING,
                        "a PLY file is longer than its header says; the rest is left out");
}

static sph_status read_elements(sph__ply *s)
{
    sph_status status = sph__io_reserve_vertices(s->mesh, s->text.path, s->vertex_count);
    for (size_t i = 0; i < s->element_count && status == SPH_OK; ++i) {
        const sph__ply_element *e = &s->elements[i];
        if (e->kind == SPH__PLY_FACE) status = sph__io_reserve_triangles(s->mesh, s->text.path, e->count);
        if (status == SPH_OK) status = s->binary ? load_element(s, e) : read_text_element(s, e);
    }
    if (status == SPH_OK) warn_of_rest(s);
    return status;
}

sph_status sph__io_read_ply(const char *path, const sph__io_map *map, sph__io_mesh *mesh, size_t *watched)
{
    sph__ply s = {.text = sph__io_text_of(mesh->context, path, map), .mesh = mesh};
    sph_status status;
    s.start = s.text.p;
    s.watch.triangle = watched == NULL ? SIZE_MAX : *watched;
    status = sph__ply_read_header(&s);
    sph__io_mesh_start(mesh, 0, s.binary);
    if (status == SPH_OK) status = read_elements(&s);
    sph_context_release(mesh->context, s.elements);
    sph_context_release(mesh->context, s.properties);
    if (watched != NULL) *watched = s.watch.place;
    return status;
}
