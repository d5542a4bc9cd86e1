/* SPDX-License-Identifier: MIT */
/* Meshes of all levels, and the nodes that have them. */
#include <math.h>
#include <string.h>

#include "io/rig_levels.h"

enum { SCREEN_ROWS = 1080 };

static void note(sph__levels_writer *w, sph_status status)
{
    if (w->status == SPH_OK) w->status = status;
}

/* The object's name, and which level it is; members that follow need a comma. */
static void put_name(sph__levels_writer *w, uint32_t object, uint32_t level, bool *first)
{
    char *name = NULL;
    uint32_t value;
    note(w, sph__gltf_get_kind(&w->l->d, object, "name", '"', &value));
    if (w->status == SPH_OK && value != 0) note(w, sph__gltf_copy_text(&w->l->d, value, &name));
    if (w->status == SPH_OK && name != NULL) {
        sph__levels_member(&w->w.json, "name", first);
        sph__io_text_string(&w->w.json, name);
        if (level > 0 && w->w.json.length > 0 && !w->w.json.failed) {
            --w->w.json.length; /* into the string */
            sph__io_text_add(&w->w.json, "_LOD%u\"", (unsigned)level);
        }
    }
    sph_context_release(w->l->context, name);
}

/* A primitive that no level changes: lines and points. */
static void keep_primitive(sph__levels_writer *w, uint32_t primitive, bool first)
{
    static const char *const NUMBERED[] = {"attributes", "indices", "targets", NULL};
    const sph__gltf_document *d = &w->l->d;
    const uint32_t attributes = sph__gltf_get(d, primitive, "attributes");
    sph__io_text *t = &w->w.json;
    uint32_t key = attributes + 1, index;
    bool none = false;
    sph__io_text_add(t, first ? "{\"attributes\":{" : ",{\"attributes\":{");
    for (uint32_t i = 0; i < d->values[attributes].count && w->status == SPH_OK; ++i, key = d->values[key + 1].next) {
        const char *name;
        size_t length;
        note(w, sph__gltf_read_index(d, key + 1, SPH__GLTF_ACCESSORS, &index));
        note(w, sph__gltf_get_text(d, key, &name, &length));
        if (w->status != SPH_OK) break;
        if (i > 0) sph__io_text_bytes(t, ",", 1);
        sph__io_text_bytes(t, name, length);
        sph__io_text_add(t, ":%u", (unsigned)sph__levels_keep_accessor(w, index));
    }
    sph__io_text_bytes(t, "}", 1);
    note(w, sph__gltf_get_index(d, primitive, "indices", SPH__GLTF_ACCESSORS, &index));
    if (w->status == SPH_OK && index != SPH__GLTF_NONE)
        sph__io_text_add(t, ",\"indices\":%u", (unsigned)sph__levels_keep_accessor(w, index));
    sph__levels_copy_members(w, t, primitive, NUMBERED, &none);
    sph__io_text_bytes(t, "}", 1);
}

/* The part that a primitive is at a node; the number of parts where it is none, or has no triangles. */
static size_t find_part(const sph_io_rig_levels *l, uint32_t node, uint32_t primitive)
{
    for (size_t k = 0; k < l->g->part_count; ++k)
        if (l->g->parts[k].node == node && l->g->parts[k].primitive == primitive && l->parts[k].triangle_count > 0)
            return k;
    return l->g->part_count;
}

/* Whether a node's mesh has anything at a level: nothing is written. */
static bool has_primitives(const sph__levels_writer *w, const sph__levels_mesh *m, uint32_t node)
{
    const sph_io_rig_levels *l = w->l;
    const uint32_t object = l->d.lists[SPH__GLTF_MESHES].values[l->g->nodes[node].mesh];
    const uint32_t array = sph__gltf_get(&l->d, object, "primitives");
    uint32_t value = array + 1;
    for (uint32_t i = 0; i < l->d.values[array].count; ++i, value = l->d.values[value].next) {
        const size_t part = find_part(l, node, value);
        if (part == l->g->part_count) return true;
        for (size_t t = 0; t < m->a.triangle_count; ++t)
            if (m->sources[t] >= l->g->parts[part].first_triangle &&
                m->sources[t] < l->g->parts[part].first_triangle + l->parts[part].triangle_count)
                return true;
    }
    return false;
}

static void put_mesh(sph__levels_writer *w, sph__levels_mesh *m, uint32_t node, uint32_t level)
{
    static const char *const MADE[] = {"primitives", "name", NULL};
    const sph_io_rig_levels *l = w->l;
    const uint32_t object = l->d.lists[SPH__GLTF_MESHES].values[l->g->nodes[node].mesh];
    const uint32_t array = sph__gltf_get(&l->d, object, "primitives");
    sph__io_text *t = &w->w.json;
    uint32_t value = array + 1;
    bool first = true, none = true;
    sph__io_text_add(t, w->mesh_count == 0 ? "{" : ",{");
    put_name(w, object, level, &first);
    sph__levels_member(t, "primitives", &first);
    sph__io_text_bytes(t, "[", 1);
    for (uint32_t i = 0; i < l->d.values[array].count && w->status == SPH_OK; ++i, value = l->d.values[value].next) {
        const size_t part = find_part(l, node, value);
        if (part < l->g->part_count) {
            none = !sph__levels_put_part(w, m, part, none) && none;
        } else {
            keep_primitive(w, value, none);
            none = false;
        }
    }
    sph__io_text_bytes(t, "]", 1);
    sph__levels_copy_members(w, t, object, MADE, &first);
    sph__io_text_bytes(t, "}", 1);
    ++w->mesh_count;
}

void sph__levels_put_meshes(sph__levels_writer *w)
{
    const sph_io_rig_levels *l = w->l;
    sph__io_text_add(&w->w.json, ",\"meshes\":[");
    for (uint32_t level = 0; level < w->level_count && w->status == SPH_OK; ++level) {
        sph__levels_mesh m;
        note(w, sph__levels_open_mesh(l, w->level_numbers[level], &m));
        for (uint32_t i = 0; i < l->g->drawn_count && w->status == SPH_OK; ++i) {
            uint32_t *mesh = &w->meshes[level * l->g->drawn_count + i];
            *mesh = SPH__GLTF_NONE;
            if (!has_primitives(w, &m, l->g->drawn[i])) continue;
            *mesh = w->mesh_count;
            put_mesh(w, &m, l->g->drawn[i], level);
        }
        sph__levels_close_mesh(l, &m);
    }
    sph__io_text_bytes(&w->w.json, "]", 1);
}

/* Levels below the first of a drawn node: their nodes come after those of the file. */
typedef struct below {
    uint32_t first, count; /* numbers of nodes */
    bool apart;            /* the mesh moves to a child of the node, which is number first - 1 */
} below;

static bool is_apart(const sph__gltf_node *node)
{
    return (node->skin == SPH__GLTF_NONE || node->first_child != SPH__GLTF_NONE) && node->weight_count == 0;
}

static void put_extension(sph__levels_writer *w, uint32_t extensions, const below *b, bool *first)
{
    sph__io_text *t = &w->w.json;
    bool none = true;
    sph__levels_member(t, "extensions", first);
    sph__io_text_bytes(t, "{", 1);
    if (extensions != 0) sph__levels_copy_members(w, t, extensions, NULL, &none);
    sph__levels_member(t, "MSFT_lod", &none);
    for (uint32_t i = 0; i < b->count; ++i)
        sph__io_text_add(t, "%s%u", i == 0 ? "{\"ids\":[" : ",", (unsigned)(b->first + i));
    sph__io_text_add(t, "]}}");
}

/* Below which share of the screen each level is good: where the one before is off by a pixel, and for the last nothing.
 */
static void put_coverage(sph__levels_writer *w, uint32_t count, bool *first)
{
    const sph_progressive *p = w->l->progressive;
    sph__io_text *t = &w->w.json;
    sph__levels_member(t, "extras", first);
    sph__io_text_add(t, "{\"MSFT_screencoverage\":[");
    for (uint32_t i = 0; i <= count; ++i) {
        sph_progressive_level level = {.struct_size = sizeof level};
        double rows = 0;
        if (i < count) {
            note(w, sph_progressive_get_level(p, w->level_numbers[i + 1], &level));
            rows = level.error > 0 ? sph_progressive_bounding_diagonal(p) / level.error / SCREEN_ROWS : 1;
        }
        if (i > 0) sph__io_text_bytes(t, ",", 1);
        sph__io_text_float(t, (float)fmin(1, rows * rows));
    }
    sph__io_text_add(t, "]}");
}

/* Mesh and skin, and the levels below. */
static void put_drawn(sph__levels_writer *w, uint32_t object, uint32_t mesh, const below *b, bool keeps, bool *first)
{
    static const char *const BOUND[] = {"skin", "weights", NULL};
    const sph__gltf_document *d = &w->l->d;
    sph__io_text *t = &w->w.json;
    if (mesh == SPH__GLTF_NONE) return;
    sph__levels_member(t, "mesh", first);
    sph__io_text_add(t, "%u", (unsigned)mesh);
    for (int i = 0; BOUND[i] != NULL; ++i) {
        const uint32_t value = sph__gltf_get(d, object, BOUND[i]);
        if (value == 0) continue;
        sph__levels_member(t, BOUND[i], first);
        sph__levels_copy(w, t, value);
    }
    if (b == NULL || b->count == 0) return;
    put_extension(w, keeps ? sph__gltf_get(d, object, "extensions") : 0, b, first);
    if (!keeps || sph__gltf_get(d, object, "extras") == 0) put_coverage(w, b->count, first);
}

/* A node of the file. */
static void put_node(sph__levels_writer *w, uint32_t index, uint32_t mesh, const below *b)
{
    static const char *const MADE[] = {"mesh", "skin", "weights", "children", "extensions", NULL};
    static const char *const PLAIN[] = {"mesh", "skin", "weights", "children", NULL};
    const sph__gltf_document *d = &w->l->d;
    const uint32_t object = d->lists[SPH__GLTF_NODES].values[index];
    const uint32_t children = sph__gltf_get(d, object, "children");
    const bool here = b->count > 0 && !b->apart;
    sph__io_text *t = &w->w.json;
    bool first = true;
    sph__io_text_add(t, index == 0 ? "{" : ",{");
    sph__levels_copy_members(w, t, object, here ? MADE : PLAIN, &first);
    if (!b->apart) put_drawn(w, object, mesh, b, true, &first);
    if (children != 0 || b->apart) {
        uint32_t child = children + 1;
        sph__levels_member(t, "children", &first);
        sph__io_text_bytes(t, "[", 1);
        for (uint32_t i = 0; children != 0 && i < d->values[children].count; ++i, child = d->values[child].next) {
            if (i > 0) sph__io_text_bytes(t, ",", 1);
            sph__levels_copy(w, t, child);
        }
        if (b->apart)
            sph__io_text_add(t, "%s%u", children != 0 && d->values[children].count > 0 ? "," : "",
                             (unsigned)(b->first - 1));
        sph__io_text_bytes(t, "]", 1);
    }
    sph__io_text_bytes(t, "}", 1);
}

/* The nodes of a drawn node's levels, and before them its child, where they are apart. */
static void put_below(sph__levels_writer *w, uint32_t index, uint32_t ordinal, const below *b)
{
    static const char *const MADE[] = {"mesh",   "skin",       "weights", "children", "name",
                                       "extras", "extensions", "camera",  NULL};
    static const char *const PLACED[] = {"mesh",   "skin",       "weights",     "children", "name",
                                         "extras", "extensions", "translation", "rotation", "scale",
                                         "matrix", "camera",     NULL};
    const sph_io_rig_levels *l = w->l;
    const uint32_t object = l->d.lists[SPH__GLTF_NODES].values[index];
    uint32_t level = b->apart ? 0 : 1, written = 0;
    for (; level < w->level_count && b->count > 0; ++level) {
        const uint32_t mesh = w->meshes[level * l->g->drawn_count + ordinal];
        bool first = true;
        if (mesh == SPH__GLTF_NONE) continue;
        if (level > 0 && written++ == b->count) break;
        sph__io_text_bytes(&w->w.json, ",{", 2);
        put_name(w, object, level, &first);
        sph__levels_copy_members(w, &w->w.json, object, b->apart ? PLACED : MADE, &first);
        put_drawn(w, object, mesh, level == 0 ? b : NULL, false, &first);
        sph__io_text_bytes(&w->w.json, "}", 1);
    }
}

/* How many levels a drawn node has below the first; a mesh that is empty at the first is so at all. */
static below count_below(const sph__levels_writer *w, uint32_t ordinal, uint32_t *next)
{
    const sph_io_rig_levels *l = w->l;
    below b = {.first = *next};
    for (uint32_t level = 1; level < w->level_count; ++level)
        b.count += w->meshes[level * l->g->drawn_count + ordinal] != SPH__GLTF_NONE;
    b.apart = b.count > 0 && is_apart(&l->g->nodes[l->g->drawn[ordinal]]);
    if (b.apart) ++b.first;
    *next = b.first + b.count;
    return b;
}

void sph__levels_put_nodes(sph__levels_writer *w)
{
    const sph_io_rig_levels *l = w->l;
    const uint32_t count = l->g->drawn_count;
    uint32_t next = l->g->node_count;
    below *all = sph_context_allocate(l->context, count + (size_t)1, sizeof *all);
    uint32_t *ordinals = sph_context_allocate(l->context, l->g->node_count, sizeof *ordinals);
    if (all == NULL || ordinals == NULL) note(w, sph__io_fail_memory(l->context, w->path));
    for (uint32_t i = 0; i < l->g->node_count && w->status == SPH_OK; ++i)
        ordinals[i] = count;
    for (uint32_t i = 0; i < count && w->status == SPH_OK; ++i) {
        ordinals[l->g->drawn[i]] = i;
        all[i] = count_below(w, i, &next);
    }
    if (w->status == SPH_OK) all[count] = (below){.count = 0};
    sph__io_text_add(&w->w.json, ",\"nodes\":[");
    for (uint32_t i = 0; i < l->g->node_count && w->status == SPH_OK; ++i)
        put_node(w, i, ordinals[i] < count ? w->meshes[ordinals[i]] : SPH__GLTF_NONE, &all[ordinals[i]]);
    for (uint32_t i = 0; i < count && w->status == SPH_OK; ++i)
        put_below(w, l->g->drawn[i], i, &all[i]);
    sph__io_text_bytes(&w->w.json, "]", 1);
    sph_context_release(l->context, all);
    sph_context_release(l->context, ordinals);
}
