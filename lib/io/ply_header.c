/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "io/ply.h"

const unsigned char sph__ply_sizes[SPH__PLY_TYPES] = {0, 1, 1, 2, 2, 4, 4, 4, 8};

static const struct {
    const char *name;
    unsigned char type;
} TYPES[] = {{"char", SPH__PLY_INT8},      {"int8", SPH__PLY_INT8},       {"uchar", SPH__PLY_UINT8},
             {"uint8", SPH__PLY_UINT8},    {"short", SPH__PLY_INT16},     {"int16", SPH__PLY_INT16},
             {"ushort", SPH__PLY_UINT16},  {"uint16", SPH__PLY_UINT16},   {"int", SPH__PLY_INT32},
             {"int32", SPH__PLY_INT32},    {"uint", SPH__PLY_UINT32},     {"uint32", SPH__PLY_UINT32},
             {"float", SPH__PLY_FLOAT32},  {"float32", SPH__PLY_FLOAT32}, {"double", SPH__PLY_FLOAT64},
             {"float64", SPH__PLY_FLOAT64}};

static const struct {
    const char *name;
    unsigned kind;
} KINDS[] = {
    {"vertex", SPH__PLY_VERTEX}, {"face", SPH__PLY_FACE}, {"edge", SPH__PLY_EDGE}, {"tristrips", SPH__PLY_STRIPS}};

static const struct {
    unsigned kind;
    const char *name;
    unsigned char role;
} ROLES[] = {{SPH__PLY_VERTEX, "x", SPH__PLY_X},
             {SPH__PLY_VERTEX, "y", SPH__PLY_Y},
             {SPH__PLY_VERTEX, "z", SPH__PLY_Z},
             {SPH__PLY_FACE, "vertex_indices", SPH__PLY_CORNERS},
             {SPH__PLY_FACE, "vertex_index", SPH__PLY_CORNERS},
             {SPH__PLY_EDGE, "vertex1", SPH__PLY_START},
             {SPH__PLY_EDGE, "vertex2", SPH__PLY_END}};

enum {
    TYPE_COUNT = sizeof TYPES / sizeof *TYPES,
    KIND_COUNT = sizeof KINDS / sizeof *KINDS,
    ROLE_COUNT = sizeof ROLES / sizeof *ROLES,
    POSITION_ROLES = 1 << SPH__PLY_X | 1 << SPH__PLY_Y | 1 << SPH__PLY_Z,
    EDGE_ROLES = 1 << SPH__PLY_START | 1 << SPH__PLY_END,
    NAME_SHOWN = 40
};

static sph_status fail(const sph__ply *s, const char *what)
{
    return sph__io_text_fail(&s->text, what);
}

static sph_status fail_word(const sph__ply *s, sph_status status, const char *what)
{
    const size_t length = sph__io_word_length(&s->text);
    return sph__io_fail(s->text.context, status, "%s: line %zu: %s \"%.*s\"", sph__io_shown(s->text.path), s->text.line,
                        what, (int)(length < NAME_SHOWN ? length : NAME_SHOWN), s->text.p);
}

static sph_status read_format(sph__ply *s)
{
    sph__io_text *t = &s->text;
    sph__io_skip_blanks(t);
    if (sph__io_take_word(t, "binary_little_endian"))
        s->binary = true;
    else if (sph__io_take_word(t, "binary_big_endian"))
        s->binary = s->big = true;
    else if (!sph__io_take_word(t, "ascii"))
        return fail_word(s, SPH_E_UNSUPPORTED, "an unknown format,");
    sph__io_skip_blanks(t);
    if (!sph__io_take_word(t, "1.0")) return fail_word(s, SPH_E_UNSUPPORTED, "only version 1.0 of PLY is known, not");
    return SPH_OK;
}

static sph_status read_element(sph__ply *s)
{
    sph__io_text *t = &s->text;
    void *memory = s->elements;
    sph__ply_element e = {.first = s->property_count};
    int64_t count;
    sph__io_skip_blanks(t);
    e.name = t->p;
    e.name_length = (int)(sph__io_word_length(t) < NAME_SHOWN ? sph__io_word_length(t) : NAME_SHOWN);
    for (size_t i = 0; i < KIND_COUNT && e.kind == SPH__PLY_OTHER; ++i)
        if (sph__io_take_word(t, KINDS[i].name)) e.kind = KINDS[i].kind;
    if (e.kind == SPH__PLY_OTHER) t->p += sph__io_word_length(t);
    sph__io_skip_blanks(t);
    if (e.name_length == 0 || !sph__io_text_integer(t, &count) || !sph__io_at_token_end(t) || count < 0 ||
        count > SPH__IO_INDEX_LIMIT)
        return fail(s, "an element without a name or a count from 0 to 2^31 - 1");
    e.count = (size_t)count;
    for (size_t i = 0; i < s->element_count; ++i)
        if (e.kind != SPH__PLY_OTHER && s->elements[i].kind == e.kind)
            return fail(s, "an element that was there before");
    if (!sph__io_reserve(t->context, &memory, &s->element_capacity, s->element_count + 1, sizeof e))
        return sph__io_fail_memory(t->context, t->path);
    s->elements = memory;
    s->elements[s->element_count++] = e;
    return SPH_OK;
}

static sph_status read_type(sph__ply *s, unsigned char *type)
{
    sph__io_skip_blanks(&s->text);
    for (size_t i = 0; i < TYPE_COUNT; ++i) {
        if (!sph__io_take_word(&s->text, TYPES[i].name)) continue;
        *type = TYPES[i].type;
        return SPH_OK;
    }
    return fail_word(s, SPH_E_UNSUPPORTED, "an unknown type,");
}

/* What one element takes more for this property, at least: a face has three corners. */
static size_t least_size(const sph__ply *s, const sph__ply_property *p)
{
    const size_t numbers = p->role == SPH__PLY_CORNERS ? 3 : 0;
    if (!s->binary) return 2 * (1 + numbers);
    if (p->count_type == SPH__PLY_NONE) return sph__ply_sizes[p->type];
    return sph__ply_sizes[p->count_type] + numbers * sph__ply_sizes[p->type];
}

static sph_status find_role(sph__ply *s, sph__ply_element *e, sph__ply_property *p)
{
    for (size_t i = 0; i < ROLE_COUNT && p->role == SPH__PLY_SKIP; ++i)
        if (ROLES[i].kind == e->kind && sph__io_take_word(&s->text, ROLES[i].name)) p->role = ROLES[i].role;
    if (p->role == SPH__PLY_SKIP) return SPH_OK;
    if (e->roles & 1u << p->role) return fail(s, "a property that was there before");
    if ((p->role == SPH__PLY_CORNERS) != (p->count_type != SPH__PLY_NONE))
        return fail(s, p->role == SPH__PLY_CORNERS ? "corners that are not a list" : "a list where one number belongs");
    e->roles |= 1u << p->role;
    return SPH_OK;
}

static sph_status read_property(sph__ply *s)
{
    void *memory = s->properties;
    sph__ply_property p = {.role = SPH__PLY_SKIP};
    sph__ply_element *e;
    sph_status status = SPH_OK;
    if (s->element_count == 0) return fail(s, "a property before any element");
    e = &s->elements[s->element_count - 1];
    sph__io_skip_blanks(&s->text);
    if (sph__io_take_word(&s->text, "list")) status = read_type(s, &p.count_type);
    if (status == SPH_OK) status = read_type(s, &p.type);
    if (status != SPH_OK) return status;
    sph__io_skip_blanks(&s->text);
    if (sph__io_word_length(&s->text) == 0) return fail(s, "a property without a name");
    if ((status = find_role(s, e, &p)) != SPH_OK) return status;
    if (!sph__io_reserve(s->text.context, &memory, &s->property_capacity, s->property_count + 1, sizeof p))
        return sph__io_fail_memory(s->text.context, s->text.path);
    s->properties = memory;
    s->properties[s->property_count++] = p;
    ++e->property_count;
    e->least += least_size(s, &p);
    e->lists |= p.count_type != SPH__PLY_NONE;
    return SPH_OK;
}

static sph_status read_lines(sph__ply *s)
{
    sph__io_text *t = &s->text;
    bool format = false;
    for (;;) {
        sph_status status = SPH_OK;
        sph__io_next_line(t);
        sph__io_skip_blanks(t);
        if (t->p == t->end) return fail(s, "the file ends within the header");
        if (sph__io_take_word(t, "end_header")) break;
        if (sph__io_take_word(t, "comment") || sph__io_take_word(t, "obj_info") || sph__io_at_line_end(t)) continue;
        if (sph__io_take_word(t, "format")) {
            status = format ? fail(s, "the format for a second time") : read_format(s);
            format = true;
        } else if (!format) {
            return fail(s, "the format is missing before this");
        } else if (sph__io_take_word(t, "element")) {
            status = read_element(s);
        } else if (sph__io_take_word(t, "property")) {
            status = read_property(s);
        } else {
            return fail_word(s, SPH_E_FORMAT, "unknown in a header:");
        }
        if (status != SPH_OK) return status;
    }
    return format ? SPH_OK : fail(s, "a header without format");
}

static sph_status check_element(sph__ply *s, sph__ply_element *e)
{
    if (e->kind == SPH__PLY_STRIPS && e->count > 0)
        return sph__io_fail(s->text.context, SPH_E_UNSUPPORTED, "%s: triangle strips are not read from PLY files",
                            sph__io_shown(s->text.path));
    if (e->kind == SPH__PLY_VERTEX && (e->roles & POSITION_ROLES) != POSITION_ROLES)
        return fail(s, "vertices without x, y and z");
    if (e->kind == SPH__PLY_FACE && e->count > 0 && e->roles == 0)
        return fail(s, "faces without vertex_indices or vertex_index");
    if (e->kind == SPH__PLY_EDGE && e->roles != EDGE_ROLES) e->kind = SPH__PLY_OTHER; /* other edges than these */
    if (e->kind == SPH__PLY_VERTEX) s->vertex_count = e->count;
    return SPH_OK;
}

static sph_status check_elements(sph__ply *s)
{
    /* The last line of a text may do without its end. */
    size_t room = (size_t)(s->text.end - s->text.p) + (s->binary ? 0 : 1);
    for (size_t i = 0; i < s->element_count; ++i) {
        sph__ply_element *e = &s->elements[i];
        const sph_status status = check_element(s, e);
        if (status != SPH_OK) return status;
        if (e->least != 0 && e->count > room / e->least)
            return sph__io_fail(s->text.context, SPH_E_FORMAT,
                                "%s: ends at byte %zu: its header says %zu of element %.*s, for which it is too short",
                                sph__io_shown(s->text.path), (size_t)(s->text.end - s->start), e->count, e->name_length,
                                e->name);
        room -= e->count * e->least;
    }
    if (s->vertex_count == 0)
        return sph__io_fail(s->text.context, SPH_E_FORMAT, "%s: a PLY file without vertices",
                            sph__io_shown(s->text.path));
    return SPH_OK;
}

sph_status sph__ply_read_header(sph__ply *ply)
{
    sph__io_text *t = &ply->text;
    bool lone_return;
    sph_status status;
    sph__io_skip_blanks(t);
    if (!sph__io_take_word(t, "ply")) return fail(ply, "not a PLY file, which begins with the word ply");
    sph__io_skip_blanks(t);
    lone_return = t->end - t->p >= 2 && t->p[0] == '\r' && t->p[1] != '\n';
    if ((status = read_lines(ply)) != SPH_OK) return status;
    sph__io_skip_blanks(t);
    if (t->p < t->end && *t->p != '\n' && *t->p != '\r') return fail(ply, "more after end_header");
    if (t->p < t->end && *t->p == '\r' && lone_return) {
        ++t->p; /* a line feed that follows is the first byte of the first element */
        ++t->line;
    } else {
        sph__io_next_line(t);
    }
    return check_elements(ply);
}
