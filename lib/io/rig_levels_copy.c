/* SPDX-License-Identifier: MIT */
/* What stays of a document: members copied as they are, with the numbers of views and accessors made new. */
#include <stdio.h>
#include <string.h>

#include "io/rig_levels.h"

static void note(sph__levels_writer *w, sph_status status)
{
    if (w->status == SPH_OK) w->status = status;
}

uint32_t sph__levels_add_view(sph__levels_writer *w, const void *bytes, size_t size, void *owned, uint32_t stride,
                              uint32_t target)
{
    sph_context *context = w->l->context;
    void *memory = w->chunks;
    if (w->status == SPH_OK &&
        !sph__io_reserve(context, &memory, &w->chunk_capacity, w->chunk_count + 1, sizeof *w->chunks))
        note(w, sph__io_fail_memory(context, w->path));
    if (w->status != SPH_OK) {
        sph_context_release(context, owned);
        return 0;
    }
    w->chunks = memory;
    w->chunks[w->chunk_count++] = (sph__levels_chunk){bytes, size, owned};
    sph__io_text_add(&w->w.views, "%s{\"buffer\":0,\"byteOffset\":%llu,\"byteLength\":%zu",
                     w->w.view_count == 0 ? "" : ",", (unsigned long long)w->w.binary, size);
    if (stride != 0) sph__io_text_add(&w->w.views, ",\"byteStride\":%u", (unsigned)stride);
    if (target != 0) sph__io_text_add(&w->w.views, ",\"target\":%u", (unsigned)target);
    sph__io_text_add(&w->w.views, "}");
    w->w.binary += size + 3 - (size + 3) % 4;
    return w->w.view_count++;
}

/* A view of the file, with its bytes. */
static uint32_t keep_view(sph__levels_writer *w, uint32_t view)
{
    sph__gltf_document *d = (sph__gltf_document *)&w->l->d; /* buffers are looked for when they are first asked for */
    const uint32_t object = d->lists[SPH__GLTF_VIEWS].values[view];
    const unsigned char *bytes;
    uint64_t begin = 0, length = 0, stride = 0, target = 0;
    size_t size;
    uint32_t buffer;
    sph_status status;
    if (w->views[view] != SPH__GLTF_NONE || w->status != SPH_OK) return w->views[view];
    status = sph__gltf_get_index(d, object, "buffer", SPH__GLTF_BUFFERS, &buffer);
    if (status == SPH_OK) status = sph__gltf_get_unsigned(d, object, "byteOffset", &begin);
    if (status == SPH_OK) status = sph__gltf_get_unsigned(d, object, "byteLength", &length);
    if (status == SPH_OK) status = sph__gltf_get_unsigned(d, object, "byteStride", &stride);
    if (status == SPH_OK) status = sph__gltf_get_unsigned(d, object, "target", &target);
    if (status == SPH_OK && buffer == SPH__GLTF_NONE)
        status = sph__gltf_fail(d, object, "a bufferView without a buffer");
    if (status == SPH_OK) status = sph__gltf_buffer_bytes(d, buffer, &bytes, &size);
    if (status == SPH_OK && (begin > size || length > size - begin || length == 0 || stride > 252 || target > 65535))
        status = sph__gltf_fail(d, object, "a bufferView that its buffer does not have");
    note(w, status);
    if (status == SPH_OK)
        w->views[view] =
            sph__levels_add_view(w, bytes + begin, (size_t)length, NULL, (uint32_t)stride, (uint32_t)target);
    return w->views[view];
}

void sph__levels_member(sph__io_text *to, const char *name, bool *first)
{
    sph__io_text_add(to, "%s\"%s\":", *first ? "" : ",", name);
    *first = false;
}

static void copy_text(sph__levels_writer *w, sph__io_text *to, uint32_t value)
{
    const char *text;
    size_t length;
    const sph_status status = sph__gltf_get_text(&w->l->d, value, &text, &length);
    note(w, status);
    if (status == SPH_OK) sph__io_text_bytes(to, text, length);
}

static bool is_among(const sph__gltf_document *d, uint32_t key, const char *const *names)
{
    for (; names != NULL && *names != NULL; ++names)
        if (sph__gltf_is(d, key, *names)) return true;
    return false;
}

void sph__levels_copy_members(sph__levels_writer *w, sph__io_text *to, uint32_t object, const char *const *except,
                              bool *first)
{
    const sph__gltf_document *d = &w->l->d;
    uint32_t key = object + 1;
    for (uint32_t i = 0; i < d->values[object].count; ++i, key = d->values[key + 1].next) {
        uint32_t index;
        if (is_among(d, key, except) || sph__gltf_is(d, key, "KHR_draco_mesh_compression")) continue;
        if (!*first) sph__io_text_bytes(to, ",", 1);
        *first = false;
        copy_text(w, to, key);
        sph__io_text_bytes(to, ":", 1);
        if (!sph__gltf_is(d, key, "bufferView")) {
            sph__levels_copy(w, to, key + 1);
            continue;
        }
        note(w, sph__gltf_read_index(d, key + 1, SPH__GLTF_VIEWS, &index));
        if (w->status == SPH_OK) sph__io_text_add(to, "%u", (unsigned)keep_view(w, index));
    }
}

/* Documents are nested no deeper than their reader allows. */
void sph__levels_copy(sph__levels_writer *w, sph__io_text *to, uint32_t value)
{
    const sph__gltf_value *v = &w->l->d.values[value];
    bool first = true;
    uint32_t element = value + 1;
    if (v->kind == '{') {
        sph__io_text_bytes(to, "{", 1);
        sph__levels_copy_members(w, to, value, NULL, &first);
        sph__io_text_bytes(to, "}", 1);
    } else if (v->kind == '[') {
        for (uint32_t i = 0; i < v->count; ++i, element = w->l->d.values[element].next) {
            sph__io_text_bytes(to, i == 0 ? "[" : ",", 1);
            sph__levels_copy(w, to, element);
        }
        sph__io_text_add(to, v->count == 0 ? "[]" : "]");
    } else {
        copy_text(w, to, value);
    }
}

uint32_t sph__levels_keep_accessor(sph__levels_writer *w, uint32_t accessor)
{
    sph__io_text text = {.context = w->l->context};
    if (w->accessors[accessor] != SPH__GLTF_NONE || w->status != SPH_OK) return w->accessors[accessor];
    sph__levels_copy(w, &text, w->l->d.lists[SPH__GLTF_ACCESSORS].values[accessor]);
    if (w->w.accessor_count > 0) sph__io_text_bytes(&w->w.accessors, ",", 1);
    sph__io_text_bytes(&w->w.accessors, text.text, text.length);
    w->w.accessors.failed = w->w.accessors.failed || text.failed;
    sph__io_text_release(&text);
    return w->accessors[accessor] = w->w.accessor_count++;
}

/* A member that numbers an accessor, where the object has it. */
static void put_accessor(sph__levels_writer *w, uint32_t object, const char *name, bool *first)
{
    uint32_t index;
    note(w, sph__gltf_get_index(&w->l->d, object, name, SPH__GLTF_ACCESSORS, &index));
    if (w->status != SPH_OK || index == SPH__GLTF_NONE) return;
    sph__levels_member(&w->w.json, name, first);
    sph__io_text_add(&w->w.json, "%u", (unsigned)sph__levels_keep_accessor(w, index));
}

static void copy_samplers(sph__levels_writer *w, uint32_t array)
{
    static const char *const NUMBERED[] = {"input", "output", NULL};
    const sph__gltf_document *d = &w->l->d;
    sph__io_text *t = &w->w.json;
    uint32_t sampler = array + 1;
    sph__io_text_bytes(t, "[", 1);
    for (uint32_t i = 0; i < d->values[array].count; ++i, sampler = d->values[sampler].next) {
        bool first = true;
        sph__io_text_add(t, i == 0 ? "{" : ",{");
        if (d->values[sampler].kind == '{') {
            put_accessor(w, sampler, "input", &first);
            put_accessor(w, sampler, "output", &first);
            sph__levels_copy_members(w, t, sampler, NUMBERED, &first);
        }
        sph__io_text_bytes(t, "}", 1);
    }
    sph__io_text_bytes(t, "]", 1);
}

void sph__levels_copy_animations(sph__levels_writer *w)
{
    static const char *const SAMPLERS[] = {"samplers", NULL};
    const sph__gltf_list *list = &w->l->d.lists[SPH__GLTF_ANIMATIONS];
    sph__io_text *t = &w->w.json;
    if (list->count == 0) return;
    sph__io_text_add(t, ",\"animations\":[");
    for (uint32_t i = 0; i < list->count; ++i) {
        bool first = true;
        uint32_t array;
        sph__io_text_add(t, i == 0 ? "{" : ",{");
        sph__levels_copy_members(w, t, list->values[i], SAMPLERS, &first);
        note(w, sph__gltf_get_kind(&w->l->d, list->values[i], "samplers", '[', &array));
        if (w->status == SPH_OK && array != 0) {
            sph__levels_member(t, "samplers", &first);
            copy_samplers(w, array);
        }
        sph__io_text_bytes(t, "}", 1);
    }
    sph__io_text_bytes(t, "]", 1);
}

void sph__levels_copy_skins(sph__levels_writer *w)
{
    static const char *const NUMBERED[] = {"inverseBindMatrices", NULL};
    const sph__gltf_list *list = &w->l->d.lists[SPH__GLTF_SKINS];
    sph__io_text *t = &w->w.json;
    if (list->count == 0) return;
    sph__io_text_add(t, ",\"skins\":[");
    for (uint32_t i = 0; i < list->count; ++i) {
        bool first = true;
        sph__io_text_add(t, i == 0 ? "{" : ",{");
        sph__levels_copy_members(w, t, list->values[i], NUMBERED, &first);
        put_accessor(w, list->values[i], NUMBERED[0], &first);
        sph__io_text_bytes(t, "}", 1);
    }
    sph__io_text_bytes(t, "]", 1);
}

static size_t folder_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash == NULL ? 0 : (size_t)(slash - path) + 1;
}

/* What an image beside the file is, by its name; NULL: not known. */
static const char *image_type(const char *uri)
{
    static const char *const TYPES[][2] = {{"png", "image/png"},       {"jpg", "image/jpeg"},  {"jpeg", "image/jpeg"},
                                           {"webp", "image/webp"},     {"ktx2", "image/ktx2"}, {"avif", "image/avif"},
                                           {"dds", "image/vnd-ms.dds"}};
    for (size_t i = 0; i < sizeof TYPES / sizeof *TYPES; ++i)
        if (sph__io_has_ending(uri, TYPES[i][0])) return TYPES[i][1];
    return NULL;
}

/* The view of an image that is taken in; SPH__GLTF_NONE where it stays where it is. */
static uint32_t take_image(sph__levels_writer *w, uint32_t value, const char **type)
{
    sph__gltf_document *d = (sph__gltf_document *)&w->l->d;
    const size_t from = folder_of(d->path), to = folder_of(w->path);
    sph__io_map map = {NULL, 0};
    uint32_t view = SPH__GLTF_NONE;
    char *uri = NULL;
    void *copy;
    if (from == to && memcmp(d->path, w->path, from) == 0) return view;
    note(w, sph__gltf_copy_text(d, value, &uri));
    if (w->status == SPH_OK && strncmp(uri, "data:", 5) != 0 && (*type = image_type(uri)) != NULL) {
        if (sph__gltf_map_file(d, value, uri, &map) != SPH_OK)
            sph_context_log(w->l->context, SPH_LOG_WARNING,
                            "an image of a glTF is not beside it: only its name is kept");
        else if ((copy = sph_context_allocate(w->l->context, map.size + 1, 1)) == NULL)
            note(w, sph__io_fail_memory(w->l->context, w->path));
        else
            view = sph__levels_add_view(w, memcpy(copy, map.bytes, map.size), map.size, copy, 0, 0);
    }
    sph__io_map_close(&map);
    sph_context_release(w->l->context, uri);
    return view;
}

void sph__levels_copy_images(sph__levels_writer *w)
{
    static const char *const URI[] = {"uri", "mimeType", NULL};
    const sph__gltf_document *d = &w->l->d;
    sph__io_text *t = &w->w.json;
    uint32_t array, image;
    note(w, sph__gltf_get_kind(d, 0, "images", '[', &array));
    if (w->status != SPH_OK || array == 0 || d->values[array].count == 0) return;
    sph__io_text_add(t, ",\"images\":[");
    image = array + 1;
    for (uint32_t i = 0; i < d->values[array].count && w->status == SPH_OK; ++i, image = d->values[image].next) {
        const char *type = NULL;
        uint32_t uri, view = SPH__GLTF_NONE;
        bool first = true;
        note(w, sph__gltf_get_kind(d, image, "uri", '"', &uri));
        if (w->status == SPH_OK && uri != 0) view = take_image(w, uri, &type);
        if (i > 0) sph__io_text_bytes(t, ",", 1);
        if (view == SPH__GLTF_NONE) {
            sph__levels_copy(w, t, image);
            continue;
        }
        sph__io_text_add(t, "{\"bufferView\":%u,\"mimeType\":\"%s\"", (unsigned)view, type);
        first = false;
        sph__levels_copy_members(w, t, image, URI, &first);
        sph__io_text_bytes(t, "}", 1);
    }
    sph__io_text_bytes(t, "]", 1);
}
