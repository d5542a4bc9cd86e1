/* SPDX-License-Identifier: MIT */
/* Wavefront OBJ: vertices, faces and line elements; every other record is passed over. */
#include "io/io.h"

enum { INDEX_LIMIT = INT32_MAX };

typedef struct parser {
    const char *path;
    const char *p, *end;
    size_t line;
    sph__io_mesh *mesh;
    int64_t forward_index; /* the largest index that named a vertex before it came, and its line */
    size_t forward_line;
    size_t watched_triangle, watched_line;
} parser;

static sph_status fail(const parser *s, const char *what)
{
    return sph__io_fail(s->mesh->context, SPH_E_FORMAT, "%s: line %zu: %s", sph__io_shown(s->path), s->line, what);
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

static bool is_digit(const parser *s)
{
    return s->p < s->end && (unsigned char)(*s->p - '0') <= 9;
}

/* Passes over blanks, and over ends of lines that a backslash takes back. */
static void skip_blanks(parser *s)
{
    while (s->p < s->end) {
        if (is_blank(*s->p)) {
            ++s->p;
        } else if (*s->p == '\\' && s->end - s->p >= 2 && s->p[1] == '\n') {
            s->p += 2;
            ++s->line;
        } else if (*s->p == '\\' && s->end - s->p >= 3 && s->p[1] == '\r' && s->p[2] == '\n') {
            s->p += 3;
            ++s->line;
        } else {
            break;
        }
    }
}

static bool at_line_end(const parser *s)
{
    return s->p == s->end || *s->p == '\n' || *s->p == '\r' || *s->p == '#';
}

/* To the start of the next line. A line ends with LF, CR LF or CR. */
static void next_line(parser *s)
{
    while (s->p < s->end && *s->p != '\n' && *s->p != '\r')
        ++s->p;
    if (s->p == s->end) return;
    if (*s->p == '\r' && s->end - s->p >= 2 && s->p[1] == '\n') ++s->p;
    ++s->p;
    ++s->line;
}

/* Whether a number or word ends here. */
static bool at_token_end(const parser *s)
{
    return at_line_end(s) || is_blank(*s->p) || *s->p == '\\';
}

static sph_status read_vertex(parser *s)
{
    sph__io_mesh *mesh = s->mesh;
    void *memory = mesh->positions;
    float values[8]; /* x y z, then w or a colour, with or without alpha: not kept */
    unsigned count = 0;
    for (;; ++count) {
        const char *after;
        skip_blanks(s);
        if (at_line_end(s)) break;
        if (count == 8) return fail(s, "a vertex of more than 8 numbers");
        after = sph__io_parse_float(s->p, s->end, &values[count]);
        if (after == NULL) return fail(s, "a vertex with something that is not a number");
        s->p = after;
        if (!at_token_end(s)) return fail(s, "a vertex with something that is not a number");
    }
    if (count < 3) return fail(s, "a vertex of fewer than 3 numbers");
    if (mesh->vertex_count == INDEX_LIMIT) return fail(s, "more than 2^31 - 1 vertices");
    if (!sph__io_reserve(mesh->context, &memory, &mesh->vertex_capacity, mesh->vertex_count + 1, 3 * sizeof(float)))
        return sph__io_fail_memory(mesh->context, s->path);
    mesh->positions = memory;
    for (unsigned i = 0; i < 3; ++i)
        mesh->positions[3 * mesh->vertex_count + i] = values[i];
    ++mesh->vertex_count;
    return SPH_OK;
}

/* An integer with or without sign, cut at the limit; false where there is none. */
static bool read_integer(parser *s, int64_t *value)
{
    const bool negative = s->p < s->end && *s->p == '-';
    *value = 0;
    if (s->p < s->end && (*s->p == '-' || *s->p == '+')) ++s->p;
    if (!is_digit(s)) return false;
    for (; is_digit(s); ++s->p)
        if (*value <= INDEX_LIMIT) *value = *value * 10 + (*s->p - '0');
    if (negative) *value = -*value;
    return true;
}

/* v, v/t, v//n or v/t/n: the vertex, counted from 0. */
static sph_status read_reference(parser *s, uint32_t *index)
{
    const int64_t count = (int64_t)s->mesh->vertex_count;
    int64_t value, ignored;
    if (!read_integer(s, &value)) return fail(s, "not a vertex index");
    for (unsigned i = 0; i < 2 && s->p < s->end && *s->p == '/'; ++i) {
        ++s->p;
        (void)read_integer(s, &ignored); /* of the texture coordinate or the normal; it may be left out */
    }
    if (!at_token_end(s)) return fail(s, "not a vertex index");
    if (value == 0) return fail(s, "vertex index 0: they start at 1");
    if (value > INDEX_LIMIT || value < -INDEX_LIMIT) return fail(s, "a vertex index beyond 2^31 - 1");
    if (value < -count)
        return sph__io_fail(s->mesh->context, SPH_E_FORMAT,
                            "%s: line %zu: vertex index %lld, but only %lld vertices come before",
                            sph__io_shown(s->path), s->line, (long long)value, (long long)count);
    if (value > count && value > s->forward_index) {
        s->forward_index = value;
        s->forward_line = s->line;
    }
    *index = (uint32_t)(value < 0 ? count + value : value - 1);
    return SPH_OK;
}

static sph_status add_triangle(parser *s, uint32_t a, uint32_t b, uint32_t c)
{
    sph__io_mesh *mesh = s->mesh;
    void *memory = mesh->triangles;
    uint32_t *triangle;
    if (!sph__io_reserve(mesh->context, &memory, &mesh->triangle_capacity, mesh->triangle_count + 1,
                         3 * sizeof(uint32_t)))
        return sph__io_fail_memory(mesh->context, s->path);
    mesh->triangles = memory;
    if (mesh->triangle_count == s->watched_triangle) s->watched_line = s->line;
    triangle = mesh->triangles + 3 * mesh->triangle_count++;
    triangle[0] = a;
    triangle[1] = b;
    triangle[2] = c;
    return SPH_OK;
}

static sph_status add_edge(parser *s, uint32_t a, uint32_t b)
{
    sph__io_mesh *mesh = s->mesh;
    void *memory = mesh->edges;
    if (!sph__io_reserve(mesh->context, &memory, &mesh->edge_capacity, mesh->edge_count + 1, 2 * sizeof(uint32_t)))
        return sph__io_fail_memory(mesh->context, s->path);
    mesh->edges = memory;
    mesh->edges[2 * mesh->edge_count] = a;
    mesh->edges[2 * mesh->edge_count + 1] = b;
    ++mesh->edge_count;
    return SPH_OK;
}

/* A polygon as a fan of triangles around its first corner. */
static sph_status read_face(parser *s)
{
    uint32_t first = 0, previous = 0, index = 0;
    size_t count = 0;
    sph_status status = SPH_OK;
    for (; status == SPH_OK; ++count) {
        skip_blanks(s);
        if (at_line_end(s)) break;
        if ((status = read_reference(s, &index)) != SPH_OK) return status;
        if (count == 0) first = index;
        if (count >= 2) status = add_triangle(s, first, previous, index);
        previous = index;
    }
    if (status == SPH_OK && count < 3) return fail(s, "a face of fewer than 3 vertices");
    return status;
}

static sph_status read_line_element(parser *s)
{
    uint32_t previous = 0, index = 0;
    size_t count = 0;
    sph_status status = SPH_OK;
    for (; status == SPH_OK; ++count) {
        skip_blanks(s);
        if (at_line_end(s)) break;
        if ((status = read_reference(s, &index)) != SPH_OK) return status;
        if (count >= 1) status = add_edge(s, previous, index);
        previous = index;
    }
    if (status == SPH_OK && count < 2) return fail(s, "a line element of fewer than 2 vertices");
    return status;
}

static sph_status read_record(parser *s)
{
    char keyword;
    if (s->end - s->p < 2 || !(is_blank(s->p[1]) || s->p[1] == '\\')) {
        /* A lone letter at the end of a line is a record without its numbers. */
        const bool lone = s->p < s->end && (s->end - s->p < 2 || s->p[1] == '\n' || s->p[1] == '\r');
        if (!lone) return SPH_OK;
    }
    keyword = *s->p;
    if (keyword != 'v' && keyword != 'f' && keyword != 'l') return SPH_OK;
    ++s->p;
    return keyword == 'v' ? read_vertex(s) : keyword == 'f' ? read_face(s) : read_line_element(s);
}

static sph_status read_records(parser *s)
{
    if (s->end - s->p >= 3 && s->p[0] == '\xEF' && s->p[1] == '\xBB' && s->p[2] == '\xBF') s->p += 3;
    while (s->p < s->end) {
        sph_status status;
        while (s->p < s->end && is_blank(*s->p))
            ++s->p;
        status = read_record(s);
        if (status != SPH_OK) return status;
        next_line(s);
    }
    return SPH_OK;
}

sph_status sph__io_read_obj(const char *path, const sph__io_map *map, sph__io_mesh *mesh, size_t *watched)
{
    const char *start = (const char *)map->bytes;
    parser s = {.path = path, .p = start, .end = start + map->size, .line = 1, .mesh = mesh};
    sph_status status;
    s.watched_triangle = watched == NULL ? SIZE_MAX : *watched;
    mesh->vertex_count = mesh->triangle_count = mesh->edge_count = 0;
    status = read_records(&s);
    if (watched != NULL) *watched = s.watched_line;
    if (status != SPH_OK) return status;
    if (mesh->vertex_count == 0)
        return sph__io_fail(mesh->context, SPH_E_FORMAT, "%s: an OBJ file without vertices", sph__io_shown(path));
    if (s.forward_index > (int64_t)mesh->vertex_count)
        return sph__io_fail(mesh->context, SPH_E_FORMAT, "%s: line %zu: vertex index %lld, but there are %zu vertices",
                            sph__io_shown(path), s.forward_line, (long long)s.forward_index, mesh->vertex_count);
    return SPH_OK;
}
