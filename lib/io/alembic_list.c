/* SPDX-License-Identifier: MIT */
/* What an archive holds, told object by object. */
#include <string.h>

#include "io/alembic.h"

typedef struct listing {
    sph__abc_file file;
    sph__abc_objects objects;
    sph_io_object_fn *visit;
    void *user;
} listing;

static sph_status tell_archive(const sph__abc_file *f, sph_io_archive_fn *visit, void *user)
{
    static const char *const KEYS[] = {"_ai_Application", "_ai_AlembicVersion", "_ai_DateWritten", "_ai_Description"};
    char *texts[4] = {NULL, NULL, NULL, NULL};
    bool good = true;
    for (int i = 0; i < 4; ++i) {
        texts[i] = sph__abc_copy(f, sph__abc_value(f->about, KEYS[i]));
        good = good && texts[i] != NULL;
    }
    if (good) {
        const sph_io_archive archive = {sizeof archive, f->version, texts[0], texts[1], texts[2], texts[3]};
        visit(user, &archive);
    }
    for (int i = 0; i < 4; ++i)
        sph_context_release(f->context, texts[i]);
    return good ? SPH_OK : sph__io_fail_memory(f->context, f->path);
}

/* "PolyMesh" of "AbcGeom_PolyMesh_v1"; what is of another form stays. */
static sph__abc_bytes short_kind(sph__abc_bytes schema)
{
    static const char PREFIX[] = "AbcGeom_";
    if (sph__abc_begins(schema, PREFIX)) {
        schema.p += sizeof PREFIX - 1;
        schema.size -= sizeof PREFIX - 1;
    }
    for (size_t i = 0; i + 1 < schema.size; ++i)
        if (schema.p[i] == '_' && schema.p[i + 1] == 'v') schema.size = i;
    return schema;
}

static void take_times(const sph__abc_file *f, const sph__abc_property *p, sph_io_object *o)
{
    const sph__abc_sampling *s;
    if (sph__abc_stored_count(p) < 2 || p->sample_count <= o->sample_count) return;
    s = &f->samplings[p->sampling];
    o->sample_count = p->sample_count;
    o->first_time = sph__abc_time(s, 0);
    o->last_time = sph__abc_time(s, p->sample_count - 1);
}

static sph_status describe(listing *l, uint32_t number, sph_io_object *o)
{
    const sph__abc_object *object = &l->objects.items[number];
    sph_status status = SPH_OK;
    *o = (sph_io_object){.struct_size = sizeof *o, .sample_count = 1};
    o->chosen = object->chosen;
    o->hidden = object->hidden;
    if (object->kind == SPH__ABC_XFORM) {
        sph__abc_xform x;
        status = sph__abc_read_xform(&l->file, &l->objects, number, &x);
        if (status != SPH_OK) return status;
        take_times(&l->file, &x.values, o);
        take_times(&l->file, &x.inherits, o);
    } else if (object->kind != SPH__ABC_OTHER) {
        sph__abc_mesh m;
        status = sph__abc_read_mesh(&l->file, &l->objects, number, &m);
        if (status != SPH_OK) return status;
        o->vertex_count = m.vertex_count;
        o->face_count = m.face_count;
        take_times(&l->file, &m.positions, o);
    }
    return status;
}

static sph_status tell_object(listing *l, uint32_t number)
{
    sph_io_object o;
    char *path = sph__abc_path(&l->file, &l->objects, number);
    char *kind = sph__abc_copy(&l->file, short_kind(l->objects.items[number].schema));
    sph_status status = describe(l, number, &o);
    if (status != SPH_E_NOMEM && !o.chosen) status = SPH_OK; /* what is not read may be what is not known */
    if (path == NULL || kind == NULL) status = sph__io_fail_memory(l->file.context, l->file.path);
    if (status == SPH_OK) {
        o.path = path;
        o.kind = kind;
        l->visit(l->user, &o);
    }
    sph_context_release(l->file.context, path);
    sph_context_release(l->file.context, kind);
    return status;
}

static sph_status list_objects(sph_context *context, const char *path, const sph__io_map *map, const char *object,
                               sph_io_archive_fn *archive, sph_io_object_fn *visit, void *user)
{
    listing l = {.visit = visit, .user = user};
    sph_status status = sph__abc_file_open(context, path, map, &l.file);
    if (status != SPH_OK) return status;
    status = sph__abc_read_objects(&l.file, &l.objects);
    if (status == SPH_OK) status = sph__abc_choose(&l.file, &l.objects, object);
    if (status == SPH_OK && archive != NULL) status = tell_archive(&l.file, archive, user);
    for (uint32_t i = 0; status == SPH_OK && visit != NULL && i < l.objects.count; ++i)
        status = tell_object(&l, i);
    sph_context_release(context, l.objects.items);
    sph__abc_file_close(&l.file);
    return status;
}

sph_status sph_io_list_objects(sph_context *context, const char *path, const char *object, sph_io_archive_fn *archive,
                               sph_io_object_fn *visit, void *user)
{
    SPH__IO_OWN(context, sph_context_memory_used);
    sph__io_map map;
    sph__io_read_fn *read;
    sph_status status;
    if (context == NULL || path == NULL)
        return sph_context_fail(context, SPH_E_INVALID, "sph_io_list_objects: an argument is NULL");
    if ((status = sph__io_map_open(context, path, &map)) != SPH_OK) return status;
    status = sph__io_find_reader(context, path, &map, &read);
    if (status == SPH_OK && read == sph__io_read_abc)
        status = list_objects(context, path, &map, object, archive, visit, user);
    sph__io_map_close(&map);
    return status;
}
