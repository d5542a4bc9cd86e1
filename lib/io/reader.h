/* SPDX-License-Identifier: MIT */
/* What the readers of meshes share: text by lines, and meshes that grow. */
#ifndef SPH_IO_READER_H
#define SPH_IO_READER_H

#include "io/io.h"

enum { SPH__IO_INDEX_LIMIT = INT32_MAX };

/* --- text (reader.c) --- */
typedef struct sph__io_text {
    sph_context *context;
    const char *path;
    const char *p, *end;
    size_t line;
} sph__io_text;

sph__io_text sph__io_text_of(sph_context *context, const char *path, const sph__io_map *map);
/* "path: line 3: what", SPH_E_FORMAT. */
sph_status sph__io_text_fail(const sph__io_text *text, const char *what);
/* To the start of the next line. A line ends with LF, CR LF or CR. */
void sph__io_next_line(sph__io_text *text);
/* An integer with or without sign, cut beyond the index limit; false where there is none. */
bool sph__io_text_integer(sph__io_text *text, int64_t *value);
/* Bytes up to the next blank or end of line. */
size_t sph__io_word_length(const sph__io_text *text);
/* Whether the next word is this one, with or without regard to the case of letters; it is taken if it is. */
bool sph__io_take_word(sph__io_text *text, const char *word);
bool sph__io_take_any_case(sph__io_text *text, const char *word);
/* A warning to the log where anything but blanks and comments follows. */
void sph__io_warn_of_rest(sph__io_text *text);

static inline bool sph__io_is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

/* A comment ends a line too. */
static inline bool sph__io_at_line_end(const sph__io_text *text)
{
    return text->p == text->end || *text->p == '\n' || *text->p == '\r' || *text->p == '#';
}

static inline bool sph__io_at_token_end(const sph__io_text *text)
{
    return sph__io_at_line_end(text) || sph__io_is_blank(*text->p);
}

static inline void sph__io_skip_blanks(sph__io_text *text)
{
    while (text->p < text->end && sph__io_is_blank(*text->p))
        ++text->p;
}

/* Passes over blanks, comments and ends of lines; false at the end of the text. */
static inline bool sph__io_skip_empty_lines(sph__io_text *text)
{
    for (;;) {
        sph__io_skip_blanks(text);
        if (!sph__io_at_line_end(text)) return true;
        if (text->p == text->end) return false;
        sph__io_next_line(text);
    }
}

/* A number and nothing else up to the next blank or end of line. */
static inline bool sph__io_text_float(sph__io_text *text, float *value)
{
    const char *after = sph__io_parse_float(text->p, text->end, value);
    if (after == NULL) return false;
    text->p = after;
    return sph__io_at_token_end(text);
}

/* --- meshes that grow (mesh.c) --- */

/* Empties a mesh that is to be read anew. */
static inline void sph__io_mesh_start(sph__io_mesh *mesh, uint32_t first_index, bool binary)
{
    mesh->vertex_count = mesh->triangle_count = mesh->edge_count = 0;
    mesh->first_index = first_index;
    mesh->binary = binary;
}

/* SPH_E_LIMIT beyond 2^31 - 1, SPH_E_NOMEM. */
sph_status sph__io_reserve_vertices(sph__io_mesh *mesh, const char *path, size_t need);
sph_status sph__io_reserve_triangles(sph__io_mesh *mesh, const char *path, size_t need);
sph_status sph__io_add_edge(sph__io_mesh *mesh, const char *path, uint32_t a, uint32_t b);

static inline sph_status sph__io_add_vertex(sph__io_mesh *mesh, const char *path, const float xyz[3])
{
    if (mesh->vertex_count == mesh->vertex_capacity) {
        const sph_status status = sph__io_reserve_vertices(mesh, path, mesh->vertex_count + 1);
        if (status != SPH_OK) return status;
    }
    for (unsigned i = 0; i < 3; ++i)
        mesh->positions[3 * mesh->vertex_count + i] = xyz[i];
    ++mesh->vertex_count;
    return SPH_OK;
}

/* A polygon as a fan of triangles around its first corner; it starts zeroed. */
typedef struct sph__io_fan {
    uint32_t first, previous;
    size_t count; /* corners so far */
} sph__io_fan;

static inline sph_status sph__io_add_corner(sph__io_mesh *mesh, const char *path, sph__io_fan *fan, uint32_t index)
{
    if (fan->count >= 2) {
        uint32_t *triangle;
        if (mesh->triangle_count == mesh->triangle_capacity) {
            const sph_status status = sph__io_reserve_triangles(mesh, path, mesh->triangle_count + 1);
            if (status != SPH_OK) return status;
        }
        triangle = mesh->triangles + 3 * mesh->triangle_count++;
        triangle[0] = fan->first;
        triangle[1] = fan->previous;
        triangle[2] = index;
    } else if (fan->count == 0) {
        fan->first = index;
    }
    fan->previous = index;
    ++fan->count;
    return SPH_OK;
}

/* Where the triangle that is looked for stands; readers tell it each face's place after the face. */
typedef struct sph__io_watch {
    size_t triangle, place;
} sph__io_watch;

static inline void sph__io_watch_face(sph__io_watch *watch, const sph__io_mesh *mesh, size_t place)
{
    if (mesh->triangle_count <= watch->triangle) return;
    watch->place = place;
    watch->triangle = SIZE_MAX;
}

#endif
