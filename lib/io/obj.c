/* SPDX-License-Identifier: MIT */
/* Wavefront OBJ: vertices, faces and line elements; every other record is passed over. */
#include "io/reader.h"

typedef struct parser {
    sph__io_text text;
    sph__io_mesh *mesh;
    int64_t forward_index; /* the largest index that named a vertex before it came, and its line */
    size_t forward_line;
    sph__io_watch watch;
} parser;

static sph_status fail(const parser *s, const char *what)
{
    return sph__io_text_fail(&s->text, what);
}

/* Passes over blanks, and over ends of lines that a backslash takes back. */
static void skip_blanks(parser *s)
{
    sph__io_text *t = &s->text;
    for (;;) {
        sph__io_skip_blanks(t);
        if (t->end - t->p >= 2 && t->p[0] == '\\' && t->p[1] == '\n')
            t->p += 2;
        else if (t->end - t->p >= 3 && t->p[0] == '\\' && t->p[1] == '\r' && t->p[2] == '\n')
            t->p += 3;
        else
            break;
        ++t->line;
    }
}

/* Whether a number or word ends here. */
static bool at_token_end(const parser *s)
{
    return sph__io_at_token_end(&s->text) || *s->text.p == '\\';
}

static sph_status read_vertex(parser *s)
{
    float values[8]; /* x y z, then w or a colour, with or without alpha: not kept */
    unsigned count = 0;
    for (;; ++count) {
        const char *after;
        skip_blanks(s);
        if (sph__io_at_line_end(&s->text)) break;
        if (count == 8) return fail(s, "a vertex of more than 8 numbers");
        after = sph__io_parse_float(s->text.p, s->text.end, &values[count]);
        if (after == NULL) return fail(s, "a vertex with something that is not a number");
        s->text.p = after;
        if (!at_token_end(s)) return fail(s, "a vertex with something that is not a number");
    }
    if (count < 3) return fail(s, "a vertex of fewer than 3 numbers");
    return sph__io_add_vertex(s->mesh, s->text.path, values);
}

/* v, v/t, v//n or v/t/n: the vertex, counted from 0. */
static sph_status read_reference(parser *s, uint32_t *index)
{
    const int64_t count = (int64_t)s->mesh->vertex_count;
    int64_t value, ignored;
    if (!sph__io_text_integer(&s->text, &value)) return fail(s, "not a vertex index");
    for (unsigned i = 0; i < 2 && s->text.p < s->text.end && *s->text.p == '/'; ++i) {
        ++s->text.p;
        (void)sph__io_text_integer(&s->text,
                                   &ignored); /* of the texture coordinate or the normal; it may be left out */
    }
    if (!at_token_end(s)) return fail(s, "not a vertex index");
    if (value == 0) return fail(s, "vertex index 0: they start at 1");
    if (value > SPH__IO_INDEX_LIMIT || value < -SPH__IO_INDEX_LIMIT) return fail(s, "a vertex index beyond 2^31 - 1");
    if (value < -count)
        return sph__io_fail(s->mesh->context, SPH_E_FORMAT,
                            "%s: line %zu: vertex index %lld, but only %lld vertices come before",
                            sph__io_shown(s->text.path), s->text.line, (long long)value, (long long)count);
    if (value > count && value > s->forward_index) {
        s->forward_index = value;
        s->forward_line = s->text.line;
    }
    *index = (uint32_t)(value < 0 ? count + value : value - 1);
    return SPH_OK;
}

static sph_status read_face(parser *s)
{
    sph__io_fan fan = {0};
    sph_status status = SPH_OK;
    while (status == SPH_OK) {
        uint32_t index;
        skip_blanks(s);
        if (sph__io_at_line_end(&s->text)) break;
        status = read_reference(s, &index);
        if (status == SPH_OK) status = sph__io_add_corner(s->mesh, s->text.path, &fan, index);
    }
    sph__io_watch_face(&s->watch, s->mesh, s->text.line);
    if (status == SPH_OK && fan.count < 3) return fail(s, "a face of fewer than 3 vertices");
    return status;
}

static sph_status read_line_element(parser *s)
{
    uint32_t previous = 0, index = 0;
    size_t count = 0;
    sph_status status = SPH_OK;
    for (; status == SPH_OK; ++count) {
        skip_blanks(s);
        if (sph__io_at_line_end(&s->text)) break;
        if ((status = read_reference(s, &index)) != SPH_OK) return status;
        if (count >= 1) status = sph__io_add_edge(s->mesh, s->text.path, previous, index);
        previous = index;
    }
    if (status == SPH_OK && count < 2) return fail(s, "a line element of fewer than 2 vertices");
    return status;
}

static sph_status read_record(parser *s)
{
    const sph__io_text *t = &s->text;
    char keyword;
    if (t->end - t->p < 2 || !(sph__io_is_blank(t->p[1]) || t->p[1] == '\\')) {
        /* A lone letter at the end of a line is a record without its numbers. */
        const bool lone = t->p < t->end && (t->end - t->p < 2 || t->p[1] == '\n' || t->p[1] == '\r');
        if (!lone) return SPH_OK;
    }
    keyword = *t->p;
    if (keyword != 'v' && keyword != 'f' && keyword != 'l') return SPH_OK;
    ++s->text.p;
    return keyword == 'v' ? read_vertex(s) : keyword == 'f' ? read_face(s) : read_line_element(s);
}

static sph_status read_records(parser *s)
{
    sph__io_text *t = &s->text;
    if (t->end - t->p >= 3 && t->p[0] == '\xEF' && t->p[1] == '\xBB' && t->p[2] == '\xBF') t->p += 3;
    while (t->p < t->end) {
        sph_status status;
        sph__io_skip_blanks(t);
        status = read_record(s);
        if (status != SPH_OK) return status;
        sph__io_next_line(t);
    }
    return SPH_OK;
}

sph_status sph__io_read_obj(const char *path, const sph__io_map *map, sph__io_mesh *mesh, size_t *watched)
{
    parser s = {.text = sph__io_text_of(mesh->context, path, map), .mesh = mesh};
    sph_status status;
    s.watch.triangle = watched == NULL ? SIZE_MAX : *watched;
    sph__io_mesh_start(mesh, 1, false);
    status = read_records(&s);
    if (watched != NULL) *watched = s.watch.place;
    if (status != SPH_OK) return status;
    if (mesh->vertex_count == 0)
        return sph__io_fail(mesh->context, SPH_E_FORMAT, "%s: an OBJ file without vertices", sph__io_shown(path));
    if (s.forward_index > (int64_t)mesh->vertex_count)
        return sph__io_fail(mesh->context, SPH_E_FORMAT, "%s: line %zu: vertex index %lld, but there are %zu vertices",
                            sph__io_shown(path), s.forward_line, (long long)s.forward_index, mesh->vertex_count);
    return SPH_OK;
}
