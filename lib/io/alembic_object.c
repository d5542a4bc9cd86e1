/* SPDX-License-Identifier: MIT */
/* Objects: the tree of an archive as a list, instances in place of what they stand for, and which are chosen. */
#include <stdio.h>
#include <string.h>

#include "io/alembic.h"

enum { HASHES = 32, OWN_METADATA = 0xFF };

/* A child as its parent's header has it. */
typedef struct child {
    sph__abc_bytes name, metadata;
} child;

/* What the walk needs at each step. */
typedef struct walk {
    sph__abc_file *f;
    sph__abc_objects *objects;
} walk;

/* The headers of a group's children; empty where it has none. */
static sph_status open_headers(sph__abc_file *f, const sph__abc_group *group, sph__abc_cursor *c)
{
    sph_status status;
    *c = (sph__abc_cursor){{f->map.bytes, 0}, 0};
    if (group->count == 0 || sph__abc_is_group(f, group, group->count - 1)) return SPH_OK;
    status = sph__abc_child_data(f, group, group->count - 1, &c->bytes);
    if (status == SPH_OK) status = sph__abc_charge_work(f, 64 + c->bytes.size);
    c->bytes.size = c->bytes.size <= HASHES ? 0 : c->bytes.size - HASHES;
    return status;
}

static sph_status next_header(const sph__abc_file *f, sph__abc_cursor *c, child *out)
{
    const uint64_t place = sph__abc_place(f, c);
    uint64_t size, index;
    if (!sph__abc_take(c, 4, &size) || !sph__abc_take_bytes(c, size, &out->name) || !sph__abc_take(c, 1, &index))
        return sph__abc_fail(f, place, "the header of an object is damaged");
    if (index != OWN_METADATA) {
        if (index >= f->metadata_count) return sph__abc_fail(f, place, "an object with metadata that are not there");
        out->metadata = f->metadata[index];
        return SPH_OK;
    }
    if (!sph__abc_take(c, 4, &size) || !sph__abc_take_bytes(c, size, &out->metadata))
        return sph__abc_fail(f, place, "the header of an object is damaged");
    return SPH_OK;
}

/* The compound with an object's properties: without children where it has none. */
static sph_status open_properties(const sph__abc_file *f, const sph__abc_group *group, sph__abc_group *out)
{
    *out = (sph__abc_group){0, 0};
    return sph__abc_is_group(f, group, 0) ? sph__abc_child_group(f, group, 0, out) : SPH_OK;
}

/* The group of a child, by name. */
static sph_status find_child(sph__abc_file *f, const sph__abc_group *group, sph__abc_bytes name, sph__abc_group *out,
                             child *header)
{
    sph__abc_cursor c;
    sph_status status = open_headers(f, group, &c);
    for (uint64_t i = 1; status == SPH_OK && c.at < c.bytes.size; ++i) {
        if ((status = next_header(f, &c, header)) != SPH_OK) return status;
        if (header->name.size == name.size && memcmp(header->name.p, name.p, name.size) == 0)
            return sph__abc_child_group(f, group, i, out);
    }
    if (status != SPH_OK) return status;
    return sph__abc_fail(f, group->place, "an instance of an object that is not there");
}

static bool is_instance(const child *header)
{
    return sph__abc_equals(sph__abc_value(header->metadata, "isInstance"), "1");
}

/*
 * Replaces the group and the metadata of an instance by those of what it stands for; other objects stay. The path that
 * it names may lead through instances, and to one: each step costs work, so that circles end.
 */
static sph_status resolve(sph__abc_file *f, sph__abc_group *group, child *header, unsigned depth)
{
    sph__abc_group at = f->top, properties;
    sph__abc_property source;
    sph__abc_bytes path;
    child found = {.metadata = header->metadata};
    sph_status status;
    if (!is_instance(header)) return SPH_OK;
    if (depth == SPH__ABC_DEPTH_MAX) return sph__abc_fail(f, group->place, "instances of instances without end");
    status = open_properties(f, group, &properties);
    if (status == SPH_OK)
        status = sph__abc_find_typed(f, &properties, ".instanceSource", SPH__ABC_SCALAR, SPH__ABC_STRING, 1, &source);
    if (status == SPH_OK && source.kind == SPH__ABC_MISSING)
        return sph__abc_fail(f, group->place, "an instance that does not say of what");
    if (status == SPH_OK) status = sph__abc_sample(f, &source, 0, &path);
    while (status == SPH_OK && path.size > 0 && path.p[0] != '\0') {
        sph__abc_bytes name = {path.p + (path.p[0] == '/'), 0};
        const unsigned char *end = path.p + path.size;
        while (name.p + name.size < end && name.p[name.size] != '/' && name.p[name.size] != '\0')
            ++name.size;
        path = (sph__abc_bytes){name.p + name.size, (size_t)(end - name.p) - name.size};
        status = find_child(f, &at, name, &at, &found);
        if (status == SPH_OK) status = resolve(f, &at, &found, depth + 1);
    }
    if (status != SPH_OK) return status;
    *group = at;
    header->metadata = found.metadata;
    return SPH_OK;
}

static int kind_of(sph__abc_bytes schema)
{
    if (sph__abc_begins(schema, "AbcGeom_Xform_v")) return SPH__ABC_XFORM;
    if (sph__abc_begins(schema, "AbcGeom_PolyMesh_v")) return SPH__ABC_POLYMESH;
    return sph__abc_begins(schema, "AbcGeom_SubD_v") ? SPH__ABC_SUBD : SPH__ABC_OTHER;
}

/* Hidden in all its samples; what is neither hidden nor visible is as its parent is. */
static sph_status read_visibility(sph__abc_file *f, sph__abc_object *o, bool parent_hidden)
{
    sph__abc_property p;
    sph__abc_bytes sample;
    bool hidden = true, deferred = true;
    sph_status status = sph__abc_find(f, &o->properties, "visible", &p);
    o->hidden = parent_hidden;
    if (status != SPH_OK || p.kind != SPH__ABC_SCALAR || p.type != SPH__ABC_I8 || p.extent != 1) return status;
    for (uint32_t i = 0; i < sph__abc_stored_count(&p); ++i) {
        if ((status = sph__abc_sample(f, &p, i, &sample)) != SPH_OK) return status;
        if (sample.size == 0 || sample.p[0] == 0xFF) continue;
        deferred = false;
        if (sample.p[0] != 0) hidden = false;
    }
    if (!deferred) o->hidden = hidden;
    return SPH_OK;
}

static sph_status add_object(walk *w, const sph__abc_group *group, const child *header, uint32_t parent)
{
    sph__abc_objects *objects = w->objects;
    const bool parent_hidden = parent != SPH__ABC_NONE && objects->items[parent].hidden;
    sph__abc_object *o;
    void *memory = objects->items;
    const sph_status status = sph__abc_charge(w->f, 1, 2 * sizeof *o);
    if (status != SPH_OK) return status;
    if (!sph__io_reserve(w->f->context, &memory, &objects->capacity, objects->count + 1, sizeof *o))
        return sph__io_fail_memory(w->f->context, w->f->path);
    objects->items = memory;
    o = &objects->items[objects->count];
    *o =
        (sph__abc_object){.parent = parent, .name = header->name, .schema = sph__abc_value(header->metadata, "schema")};
    o->kind = kind_of(o->schema);
    ++objects->count;
    if (objects->count >= SPH__ABC_NONE)
        return sph__io_fail(w->f->context, SPH_E_LIMIT, "%s: too many objects", sph__io_shown(w->f->path));
    return open_properties(w->f, group, &o->properties) == SPH_OK ? read_visibility(w->f, o, parent_hidden)
                                                                  : SPH_E_FORMAT;
}

/* The objects below a group; the depth bounds groups and instances that hold themselves. */
static sph_status add_children(walk *w, const sph__abc_group *group, uint32_t parent, unsigned depth)
{
    sph__abc_cursor c;
    sph_status status = open_headers(w->f, group, &c);
    if (status == SPH_OK && depth == SPH__ABC_DEPTH_MAX && c.bytes.size > 0)
        return sph__io_fail(w->f->context, SPH_E_LIMIT, "%s: byte %llu: objects nested more than %d deep",
                            sph__io_shown(w->f->path), (unsigned long long)group->place, SPH__ABC_DEPTH_MAX);
    for (uint64_t i = 1; status == SPH_OK && c.at < c.bytes.size; ++i) {
        const uint32_t number = (uint32_t)w->objects->count;
        sph__abc_group below;
        child header;
        status = next_header(w->f, &c, &header);
        if (status == SPH_OK) status = sph__abc_child_group(w->f, group, i, &below);
        if (status == SPH_OK) status = resolve(w->f, &below, &header, 0);
        if (status == SPH_OK) status = add_object(w, &below, &header, parent);
        if (status == SPH_OK) status = add_children(w, &below, number, depth + 1);
        if (status == SPH_OK) w->objects->items[number].end = (uint32_t)w->objects->count;
    }
    return status;
}

sph_status sph__abc_read_objects(sph__abc_file *f, sph__abc_objects *objects)
{
    walk w = {f, objects};
    return add_children(&w, &f->top, SPH__ABC_NONE, 0);
}

char *sph__abc_path(const sph__abc_file *f, const sph__abc_objects *objects, uint32_t object)
{
    size_t length = 0;
    char *path;
    for (uint32_t i = object; i != SPH__ABC_NONE; i = objects->items[i].parent)
        length += objects->items[i].name.size + 1;
    path = sph_context_allocate(f->context, length + 1, 1);
    if (path == NULL) return NULL;
    path[length] = '\0';
    for (uint32_t i = object; i != SPH__ABC_NONE; i = objects->items[i].parent) {
        const sph__abc_bytes name = objects->items[i].name;
        length -= name.size;
        for (size_t k = 0; k < name.size; ++k) /* a damaged name must not end the text */
            path[length + k] = name.p[k] == '\0' ? '?' : (char)name.p[k];
        path[--length] = '/';
    }
    return path;
}

sph_status sph__abc_fail_object(const sph__abc_file *f, const sph__abc_objects *objects, uint32_t object,
                                sph_status status, const char *format, ...)
{
    char text[256], *path = sph__abc_path(f, objects, object);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (path == NULL) return sph__io_fail_memory(f->context, f->path);
    status = sph__io_fail(f->context, status, "%s: %.100s: %s", sph__io_shown(f->path), path, text);
    sph_context_release(f->context, path);
    return status;
}

/* Whether an object has this name, or, where it begins with a slash, this path. */
static bool is_named(const sph__abc_objects *objects, uint32_t object, const char *name)
{
    const char *end = name + strlen(name);
    if (name[0] != '/') return sph__abc_equals(objects->items[object].name, name);
    for (uint32_t i = object; i != SPH__ABC_NONE; i = objects->items[i].parent) {
        const sph__abc_bytes part = objects->items[i].name;
        if ((size_t)(end - name) < part.size + 1 || memcmp(end - part.size, part.p, part.size) != 0) return false;
        end -= part.size + 1;
        if (*end != '/') return false;
    }
    return end == name;
}

static bool is_mesh(const sph__abc_object *o)
{
    return o->kind == SPH__ABC_POLYMESH || o->kind == SPH__ABC_SUBD;
}

static sph_status fail_choice(const sph__abc_file *f, const sph__abc_objects *objects, const char *name)
{
    char list[256] = "";
    size_t length = 0;
    for (uint32_t i = 0; i < objects->count && length < sizeof list - 1; ++i) {
        const sph__abc_bytes part = objects->items[i].name;
        if (is_mesh(&objects->items[i]))
            length += (size_t)snprintf(list + length, sizeof list - length, "%s%.*s", length == 0 ? ": it has " : ", ",
                                       (int)(part.size < 80 ? part.size : 80), (const char *)part.p);
    }
    return sph__io_fail(f->context, SPH_E_INVALID, "%s: no mesh '%.80s'%s", sph__io_shown(f->path), name,
                        length == 0 ? ": it has none" : list);
}

sph_status sph__abc_choose(sph__abc_file *f, sph__abc_objects *objects, const char *name)
{
    uint32_t root = SPH__ABC_NONE, meshes = 0, chosen = 0;
    const uint32_t count = (uint32_t)objects->count;
    for (uint32_t i = 0; i < count && name != NULL; ++i) {
        if (!is_named(objects, i, name)) continue;
        if (root != SPH__ABC_NONE)
            return sph__abc_fail_object(f, objects, i, SPH_E_INVALID,
                                        "it is not the only object '%.80s': give the path of one", name);
        root = i;
    }
    for (uint32_t i = 0; i < count; ++i) {
        sph__abc_object *o = &objects->items[i];
        o->chosen = is_mesh(o) &&
                    (name == NULL ? !o->hidden : root != SPH__ABC_NONE && i >= root && i < objects->items[root].end);
        meshes += is_mesh(o);
        chosen += o->chosen;
    }
    if (chosen > 0) return SPH_OK;
    if (name != NULL) return fail_choice(f, objects, name);
    return sph__io_fail(f->context, SPH_E_FORMAT,
                        meshes == 0 ? "%s: an Alembic archive without a polygon mesh"
                                    : "%s: its meshes are all hidden: choose one by name",
                        sph__io_shown(f->path));
}
