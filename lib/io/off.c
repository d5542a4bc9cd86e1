/* SPDX-License-Identifier: MIT */
/* Object File Format (Geomview), as text: a vertex or a face is a line. Comments may stand anywhere. */
#include "io/reader.h"

enum {
    LEAST_VERTEX = 6, /* "0 0 0" and the end of the line */
    LEAST_FACE = 8,   /* "3 0 1 2" and the end of the line */
    MOST_NUMBERS = 12 /* of a vertex: 3, and a normal, a colour and a texture coordinate */
};

static sph_status fail(const sph__io_text *t, const char *what)
{
    return sph__io_text_fail(t, what);
}

static bool take(sph__io_text *t, const char *letters)
{
    const char *p = t->p;
    for (; *letters != '\0'; ++letters, ++p)
        if (p == t->end || *p != *letters) return false;
    t->p = p;
    return true;
}

static sph_status refuse(const sph__io_text *t, const char *what)
{
    return sph__io_fail(t->context, SPH_E_UNSUPPORTED, "%s: line %zu: %s", sph__io_shown(t->path), t->line, what);
}

/* [ST][C][N][4][n]OFF [BINARY]. The counts may follow without a blank, as in some collections of models. */
static sph_status read_keyword(sph__io_text *t)
{
    bool four, any;
    if (!sph__io_skip_empty_lines(t)) return fail(t, "an empty file");
    (void)take(t, "ST");
    (void)take(t, "C");
    (void)take(t, "N");
    four = take(t, "4");
    any = take(t, "n");
    if (!take(t, "OFF")) return fail(t, "not an OFF file, which begins with the word OFF");
    if (four) return refuse(t, "OFF with four coordinates (4OFF) is not read");
    if (any) return refuse(t, "OFF of any dimension (nOFF) is not read");
    if (!sph__io_at_token_end(t) && (unsigned char)(*t->p - '0') > 9) return fail(t, "not an OFF file");
    sph__io_skip_blanks(t);
    if (sph__io_take_word(t, "BINARY")) return refuse(t, "binary OFF is not read, only text");
    return SPH_OK;
}

static sph_status read_counts(sph__io_text *t, size_t *vertices, size_t *faces)
{
    int64_t counts[2], edges;
    size_t room;
    for (unsigned i = 0; i < 2; ++i) {
        if (!sph__io_skip_empty_lines(t) || !sph__io_text_integer(t, &counts[i]) || !sph__io_at_token_end(t) ||
            counts[i] < 0 || counts[i] > SPH__IO_INDEX_LIMIT)
            return fail(t, i == 0 ? "the number of vertices is missing, or not from 0 to 2^31 - 1"
                                  : "the number of faces is missing, or not from 0 to 2^31 - 1");
    }
    sph__io_skip_blanks(t); /* the number of edges says nothing, and some leave it out */
    if (!sph__io_at_line_end(t) && !(sph__io_text_integer(t, &edges) && sph__io_at_token_end(t)))
        return fail(t, "the number of edges is not a number");
    sph__io_skip_blanks(t);
    if (!sph__io_at_line_end(t)) return fail(t, "more than the numbers of vertices, faces and edges");
    sph__io_next_line(t);
    *vertices = (size_t)counts[0];
    *faces = (size_t)counts[1];
    room = (size_t)(t->end - t->p) + 1; /* the last line may do without its end */
    if (*vertices > room / LEAST_VERTEX || *faces > (room - *vertices * LEAST_VERTEX) / LEAST_FACE)
        return sph__io_fail(t->context, SPH_E_FORMAT,
                            "%s: line %zu: the file is too short for %zu vertices and %zu faces",
                            sph__io_shown(t->path), t->line, *vertices, *faces);
    return SPH_OK;
}

static sph_status fail_end(const sph__io_text *t, const char *what, size_t number, size_t count)
{
    return sph__io_fail(t->context, SPH_E_FORMAT, "%s: line %zu: ends before %s %zu of %zu", sph__io_shown(t->path),
                        t->line, what, number, count);
}

static sph_status read_vertex(sph__io_text *t, sph__io_mesh *mesh)
{
    float values[MOST_NUMBERS];
    unsigned count = 0;
    for (;; ++count) {
        sph__io_skip_blanks(t);
        if (sph__io_at_line_end(t)) break;
        if (count == MOST_NUMBERS) return fail(t, "a vertex of more than 12 numbers");
        if (!sph__io_text_float(t, &values[count])) return fail(t, "a vertex with something that is not a number");
    }
    if (count < 3) return fail(t, "a vertex of fewer than 3 numbers");
    return sph__io_add_vertex(mesh, t->path, values);
}

/* The corners; what follows on the line is the face's colour. */
static sph_status read_face(sph__io_text *t, sph__io_mesh *mesh)
{
    sph__io_fan fan = {0};
    int64_t count, index;
    if (!sph__io_text_integer(t, &count) || !sph__io_at_token_end(t)) return fail(t, "a face without its count");
    if (count < 3) return fail(t, "a face of fewer than 3 vertices");
    for (int64_t i = 0; i < count; ++i) {
        sph_status status;
        sph__io_skip_blanks(t);
        if (sph__io_at_line_end(t)) return fail(t, "a face with fewer vertices than its count says");
        if (!sph__io_text_integer(t, &index) || !sph__io_at_token_end(t)) return fail(t, "not a vertex index");
        if (index < 0 || (uint64_t)index >= mesh->vertex_count)
            return sph__io_fail(t->context, SPH_E_FORMAT, "%s: line %zu: vertex index %lld, but there are %zu vertices",
                                sph__io_shown(t->path), t->line, (long long)index, mesh->vertex_count);
        if ((status = sph__io_add_corner(mesh, t->path, &fan, (uint32_t)index)) != SPH_OK) return status;
    }
    return SPH_OK;
}

static sph_status read_lines(sph__io_text *t, sph__io_mesh *mesh, sph__io_watch *watch)
{
    size_t vertices = 0, faces = 0;
    sph_status status = read_keyword(t);
    if (status == SPH_OK) status = read_counts(t, &vertices, &faces);
    if (status != SPH_OK) return status;
    if (vertices == 0) return fail(t, "an OFF file without vertices");
    status = sph__io_reserve_vertices(mesh, t->path, vertices);
    if (status == SPH_OK) status = sph__io_reserve_triangles(mesh, t->path, faces);
    for (size_t i = 0; i < vertices && status == SPH_OK; ++i) {
        if (!sph__io_skip_empty_lines(t)) return fail_end(t, "vertex", i, vertices);
        status = read_vertex(t, mesh);
        if (status == SPH_OK) sph__io_next_line(t);
    }
    for (size_t i = 0; i < faces && status == SPH_OK; ++i) {
        if (!sph__io_skip_empty_lines(t)) return fail_end(t, "face", i, faces);
        status = read_face(t, mesh);
        sph__io_watch_face(watch, mesh, t->line);
        if (status == SPH_OK) sph__io_next_line(t);
    }
    return status;
}

sph_status sph__io_read_off(const char *path, const sph__io_map *map, sph__io_mesh *mesh, size_t *watched)
{
    sph__io_text text = sph__io_text_of(mesh->context, path, map);
    sph__io_watch watch = {watched == NULL ? SIZE_MAX : *watched, 0};
    sph_status status;
    sph__io_mesh_start(mesh, 0, false);
    status = read_lines(&text, mesh, &watch);
    if (watched != NULL) *watched = watch.place;
    if (status == SPH_OK) sph__io_warn_of_rest(&text);
    return status;
}
