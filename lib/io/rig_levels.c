/* SPDX-License-Identifier: MIT */
/* Levels of a rigged glTF: the handle, and its files. */
#include "io/rig_levels.h"

#include <string.h>

static sph_status check_options(sph_context *context, const sph_simplify_options *o)
{
    if (o == NULL || o->struct_size < sizeof *o) return SPH_OK; /* what is wrong with it is said later */
    if (o->attribute_count == 0 && o->attributes == NULL && o->normals == NULL && o->groups == NULL) return SPH_OK;
    return sph_context_fail(context, SPH_E_INVALID,
                            "sph_simplify_options: normals, attributes and groups are those of the file");
}

static sph_status simplify(sph_io_rig_levels *l, const sph_simplify_options *options)
{
    sph_simplify_options o;
    sph_simplify_options_init(&o, sizeof o);
    if (options != NULL) {
        /* A caller of another version is told by the library itself. */
        if (options->struct_size != sizeof o)
            return sph_progressive_create(sph_io_rig_skin(l->rig), options, &l->progressive);
        o = *options;
    }
    o.attribute_count = l->columns;
    o.attributes = l->numbers;
    o.normals = l->normals;
    o.groups = l->groups;
    return sph_progressive_create(sph_io_rig_skin(l->rig), &o, &l->progressive);
}

void sph_io_rig_levels_destroy(sph_io_rig_levels *l)
{
    SPH__IO_OWN_MARKED(l, SPH__IO_RIG_LEVELS);
    sph_context *context;
    sph_progressive *progressive;
    sph_io_rig *rig;
    if (l == NULL) return;
    context = l->context;
    progressive = l->progressive;
    rig = l->rig;
    sph_context_release(context, l->path);
    sph_context_release(context, l->parts);
    sph_context_release(context, l->attributes);
    sph_context_release(context, l->numbers);
    sph_context_release(context, l->normals);
    sph_context_release(context, l->groups);
    sph__io_gltf_close(l->g);
    sph__gltf_document_close(&l->d);
    sph__io_map_close(&l->map);
    SPH__IO_SET_MARK(l, SPH__IO_DESTROYED);
    sph_context_release(context, l);
    sph_io_rig_destroy(rig);
    sph_progressive_destroy(progressive); /* may be the last to hold the context */
}

sph_status sph_io_open_rig_levels(sph_context *context, const char *path, const sph_io_open_rig_options *rig,
                                  const sph_simplify_options *options, sph_io_rig_levels **out)
{
    SPH__IO_OWN(context, sph_context_memory_used);
    sph_skin_arrays a = {.struct_size = sizeof a};
    sph_io_open_rig_options chosen;
    sph_io_rig_levels *l;
    sph_status status;
    if (out != NULL) *out = NULL;
    if (context == NULL || path == NULL || out == NULL)
        return sph_context_fail(context, SPH_E_INVALID, "sph_io_open_rig_levels: an argument is NULL");
    status = sph__io_rig_read_options(context, rig, &chosen);
    if (status == SPH_OK) status = check_options(context, options);
    if (status != SPH_OK) return status;
    l = sph_context_allocate(context, 1, sizeof *l);
    if (l == NULL) return sph__io_fail_memory(context, path);
    *l = (sph_io_rig_levels){.context = context, .d = {.context = context}, .path = sph__io_copy_string(context, path)};
    SPH__IO_SET_MARK(l, SPH__IO_RIG_LEVELS);
    if (l->path == NULL) status = sph__io_fail_memory(context, path);
    if (status == SPH_OK) status = sph__io_rig_map(context, l->path, &l->map, &l->d);
    if (status == SPH_OK) status = sph__io_rig_read(&l->d, &chosen, 0, &l->g, &l->rig);
    if (status == SPH_OK) status = sph_skin_get_arrays(sph_io_rig_skin(l->rig), &a);
    l->triangle_count = a.triangle_count;
    if (status == SPH_OK) status = sph__levels_read(l);
    if (status == SPH_OK) status = simplify(l, options);
    if (status != SPH_OK) {
        sph_io_rig_levels_destroy(l);
        return status;
    }
    *out = l;
    return SPH_OK;
}

const sph_progressive *sph_io_rig_levels_progressive(const sph_io_rig_levels *l)
{
    SPH__IO_OWN_MARKED(l, SPH__IO_RIG_LEVELS);
    return l == NULL ? NULL : l->progressive;
}

const sph_io_rig *sph_io_rig_levels_rig(const sph_io_rig_levels *l)
{
    SPH__IO_OWN_MARKED(l, SPH__IO_RIG_LEVELS);
    return l == NULL ? NULL : l->rig;
}

/* The extensions that the file has, but for what levels have not. */
static void put_extensions(sph__levels_writer *w)
{
    const sph__gltf_document *d = &w->l->d;
    const uint32_t array = sph__gltf_get(d, 0, "extensionsUsed");
    uint32_t value = array + 1;
    sph__io_text *t = &w->w.json;
    bool first = true;
    for (uint32_t i = 0; array != 0 && i < d->values[array].count; ++i, value = d->values[value].next) {
        if (sph__gltf_is(d, value, "KHR_draco_mesh_compression") || sph__gltf_is(d, value, "MSFT_lod") ||
            sph__gltf_is(d, value, "EXT_meshopt_compression") || sph__gltf_is(d, value, "KHR_mesh_quantization"))
            continue;
        sph__io_text_add(t, first ? ",\"extensionsUsed\":[" : ",");
        sph__levels_copy(w, t, value);
        first = false;
    }
    if (w->level_count > 1) sph__io_text_add(t, first ? ",\"extensionsUsed\":[\"MSFT_lod\"" : ",\"MSFT_lod\"");
    if (!first || w->level_count > 1) sph__io_text_bytes(t, "]", 1);
}

/* What the file requires; types of numbers are plain now. */
static void put_required(sph__levels_writer *w)
{
    const sph__gltf_document *d = &w->l->d;
    const uint32_t array = sph__gltf_get(d, 0, "extensionsRequired");
    uint32_t value = array + 1;
    bool first = true;
    for (uint32_t i = 0; array != 0 && i < d->values[array].count; ++i, value = d->values[value].next) {
        if (sph__gltf_is(d, value, "KHR_mesh_quantization")) continue;
        sph__io_text_add(&w->w.json, first ? ",\"extensionsRequired\":[" : ",");
        sph__levels_copy(w, &w->w.json, value);
        first = false;
    }
    if (!first) sph__io_text_bytes(&w->w.json, "]", 1);
}

static void describe(sph__levels_writer *w)
{
    static const char *const MADE[] = {
        "accessors",          "bufferViews", "buffers",    "meshes", "nodes", "extensionsUsed",
        "extensionsRequired", "skins",       "animations", "images", NULL};
    bool first = true;
    sph__io_text_bytes(&w->w.json, "{", 1);
    sph__levels_copy_members(w, &w->w.json, 0, MADE, &first);
    put_extensions(w);
    put_required(w);
    sph__levels_put_meshes(w);
    if (w->status == SPH_OK) sph__levels_put_nodes(w);
    if (w->status == SPH_OK) sph__levels_copy_skins(w);
    if (w->status == SPH_OK) sph__levels_copy_animations(w);
    if (w->status == SPH_OK) sph__levels_copy_images(w);
    sph__io_gltf_close_json(&w->w, NULL);
}

static sph_status write_file(sph__levels_writer *w)
{
    static const unsigned char ZEROS[4] = {0, 0, 0, 0};
    sph__io_output o = {.file = -1};
    sph_status status = sph__io_gltf_check(&w->w, w->path);
    if (status == SPH_OK) status = sph__io_output_open(w->l->context, w->path, &o);
    if (status == SPH_OK) sph__io_gltf_put_head(&o, &w->w.json, w->w.binary);
    for (size_t i = 0; i < w->chunk_count && status == SPH_OK; ++i) {
        sph__io_output_bytes(&o, w->chunks[i].bytes, w->chunks[i].size);
        sph__io_output_bytes(&o, ZEROS, 3 - (w->chunks[i].size + 3) % 4);
    }
    if (status == SPH_OK) status = sph__io_output_finish(&o);
    if (status == SPH_OK) status = sph__io_output_commit(&o);
    sph__io_output_release(&o);
    return status;
}

static sph_status allocate_writer(sph__levels_writer *w)
{
    const sph_io_rig_levels *l = w->l;
    const size_t views = l->d.lists[SPH__GLTF_VIEWS].count, accessors = l->d.lists[SPH__GLTF_ACCESSORS].count;
    w->views = sph_context_allocate(l->context, views + 1, sizeof *w->views);
    w->accessors = sph_context_allocate(l->context, accessors + 1, sizeof *w->accessors);
    w->meshes = sph_context_allocate(l->context, w->level_count, (l->g->drawn_count + (size_t)1) * sizeof *w->meshes);
    if (w->views == NULL || w->accessors == NULL || w->meshes == NULL) return sph__io_fail_memory(l->context, w->path);
    memset(w->views, 0xff, views * sizeof *w->views);
    memset(w->accessors, 0xff, accessors * sizeof *w->accessors);
    return SPH_OK;
}

static sph_status check_levels(const sph_io_rig_levels *l, const uint32_t *numbers, size_t count)
{
    if (count == 0 || count > SPH__LEVELS_LIMIT)
        return sph__io_fail(l->context, SPH_E_INVALID, "%zu levels in one file: from 1 to %d", count,
                            SPH__LEVELS_LIMIT);
    for (size_t i = 0; i < count; ++i)
        if (numbers[i] > sph_progressive_collapse_count(l->progressive) || (i > 0 && numbers[i] <= numbers[i - 1]))
            return sph__io_fail(l->context, SPH_E_INVALID, "level %u: there are 0 to %u, and they must rise",
                                (unsigned)numbers[i], (unsigned)sph_progressive_collapse_count(l->progressive));
    return SPH_OK;
}

sph_status sph_io_rig_levels_save(const sph_io_rig_levels *l, const uint32_t *level_numbers, size_t level_count,
                                  const char *path)
{
    SPH__IO_OWN_MARKED(l, SPH__IO_RIG_LEVELS);
    sph__levels_writer w = {.l = l, .path = path, .level_numbers = level_numbers};
    sph_status status;
    if (l == NULL || level_numbers == NULL || path == NULL)
        return sph_context_fail(l == NULL ? NULL : l->context, SPH_E_INVALID,
                                "sph_io_rig_levels_save: an argument is NULL");
    if (!sph__io_has_ending(path, "glb"))
        return sph__io_fail(l->context, SPH_E_UNSUPPORTED, "%s: levels are written as .glb", sph__io_shown(path));
    if ((status = check_levels(l, level_numbers, level_count)) != SPH_OK) return status;
    w.level_count = (uint32_t)level_count;
    w.w = (sph__io_gltf_writer){
        .json = {.context = l->context}, .views = {.context = l->context}, .accessors = {.context = l->context}};
    w.status = allocate_writer(&w);
    if (w.status == SPH_OK) describe(&w);
    status = w.status == SPH_OK ? write_file(&w) : w.status;
    for (size_t i = 0; i < w.chunk_count; ++i)
        sph_context_release(l->context, w.chunks[i].owned);
    sph_context_release(l->context, w.chunks);
    sph_context_release(l->context, w.views);
    sph_context_release(l->context, w.accessors);
    sph_context_release(l->context, w.meshes);
    sph__io_gltf_writer_release(&w.w);
    return status;
}
