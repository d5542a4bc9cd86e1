/* SPDX-License-Identifier: MIT */
/* A level's vertices and triangles, part by part as the file has them. */
#include <math.h>
#include <string.h>

#include "io/bytes.h"
#include "io/rig_levels.h"

enum { NARROW_VERTICES = 65535, NARROW_JOINTS = 256, JOINTS_PER_SET = 4 };

static void note(sph__levels_writer *w, sph_status status)
{
    if (w->status == SPH_OK) w->status = status;
}

sph_status sph__levels_open_mesh(const sph_io_rig_levels *l, uint32_t level, sph__levels_mesh *m)
{
    sph_status status;
    *m = (sph__levels_mesh){.a = {.struct_size = sizeof m->a}};
    status = sph_progressive_get_skin(l->progressive, level, &m->skin);
    if (status == SPH_OK) status = sph_skin_get_arrays(m->skin, &m->a);
    if (status != SPH_OK) return status;
    m->normals = sph_context_allocate(l->context, m->a.vertex_count, 3 * sizeof *m->normals);
    m->numbers = sph_context_allocate(l->context, m->a.vertex_count, (l->columns + (size_t)1) * sizeof *m->numbers);
    m->sources = sph_context_allocate(l->context, m->a.triangle_count, sizeof *m->sources);
    m->place = sph_context_allocate(l->context, m->a.vertex_count, sizeof *m->place);
    m->used = sph_context_allocate(l->context, m->a.vertex_count, sizeof *m->used);
    if (m->normals == NULL || m->numbers == NULL || m->sources == NULL || m->place == NULL || m->used == NULL)
        return sph__io_fail_memory(l->context, l->path);
    memset(m->place, 0xff, m->a.vertex_count * sizeof *m->place);
    return sph_progressive_get_attributes(l->progressive, level, m->normals, m->numbers, NULL, m->sources);
}

void sph__levels_close_mesh(const sph_io_rig_levels *l, sph__levels_mesh *m)
{
    sph_context_release(l->context, m->normals);
    sph_context_release(l->context, m->numbers);
    sph_context_release(l->context, m->sources);
    sph_context_release(l->context, m->place);
    sph_context_release(l->context, m->used);
    sph_skin_destroy(m->skin);
    *m = (sph__levels_mesh){.skin = NULL};
}

/* A part of a level: some of its triangles, and the vertices that they have, in the order of their first use. */
typedef struct piece {
    sph__levels_writer *w;
    sph__levels_mesh *m;
    const sph__gltf_part *part;
    const sph__levels_part *more;
    size_t first, count; /* triangles of the level */
    uint32_t vertex_count;
} piece;

static size_t find_source(const sph__levels_mesh *m, size_t source)
{
    size_t low = 0, high = m->a.triangle_count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (m->sources[middle] < source)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Memory for a view; NULL after a failure. */
static unsigned char *make_room(sph__levels_writer *w, size_t count, size_t size)
{
    unsigned char *bytes = w->status == SPH_OK ? sph_context_allocate(w->l->context, count, size) : NULL;
    if (bytes == NULL) note(w, sph__io_fail_memory(w->l->context, w->path));
    return bytes;
}

static void put_little(unsigned char *to, uint32_t value, size_t size)
{
    for (size_t i = 0; i < size; ++i)
        to[i] = (unsigned char)(value >> 8 * i);
}

static void put_float(unsigned char *to, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_little(to, bits, sizeof bits);
}

static const char *const WIDTHS[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};

/* An accessor over a new view of `count` elements, which takes the bytes over. */
static uint32_t add_accessor(sph__levels_writer *w, unsigned char *bytes, size_t count, size_t size, int type,
                             const char *width, int target, const char *more)
{
    const uint32_t view = sph__levels_add_view(w, bytes, count * size, bytes,
                                               target == SPH__GLTF_VERTICES ? (uint32_t)size : 0, (uint32_t)target);
    return sph__io_gltf_add_accessor(&w->w, view, 0, type, width, count, more);
}

/* How far places, or moves, go: what their accessors must tell. */
typedef struct bounds {
    float low[3], high[3];
} bounds;

static const bounds NOWHERE = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

static void extend(bounds *b, const float xyz[3])
{
    for (int c = 0; c < 3; ++c) {
        b->low[c] = fminf(b->low[c], xyz[c]);
        b->high[c] = fmaxf(b->high[c], xyz[c]);
    }
}

static uint32_t add_bounded(sph__levels_writer *w, unsigned char *bytes, size_t count, const bounds *b)
{
    sph__io_text text = {.context = w->l->context};
    uint32_t accessor;
    sph__io_text_add(&text, ",\"min\":");
    sph__io_text_floats(&text, b->low, 3);
    sph__io_text_add(&text, ",\"max\":");
    sph__io_text_floats(&text, b->high, 3);
    sph__io_text_bytes(&text, "", 1);
    w->w.accessors.failed = w->w.accessors.failed || text.failed;
    accessor =
        add_accessor(w, bytes, count, 12, SPH__GLTF_F32, "VEC3", SPH__GLTF_VERTICES, text.failed ? "" : text.text);
    sph__io_text_release(&text);
    return accessor;
}

/* What a morph target's resting weight adds to a vertex is taken off again: engines will add it. */
static void take_morphs_off(const piece *p, uint32_t vertex, float xyz[3])
{
    const sph_io_rig_levels *l = p->w->l;
    const sph__gltf_node *node = &l->g->nodes[p->part->node];
    for (size_t i = 0; i < p->more->attribute_count; ++i) {
        const sph__levels_attribute *a = &l->attributes[p->more->first_attribute + i];
        if (a->target == SPH__GLTF_NONE || a->target >= node->weight_count || !sph__gltf_is(&l->d, a->name, "POSITION"))
            continue;
        for (uint32_t c = 0; c < 3; ++c)
            xyz[c] -= (float)(l->g->weights_rest[node->first_weight + a->target] *
                              (double)p->m->numbers[(size_t)vertex * l->columns + a->column + c]);
    }
}

static uint32_t put_positions(const piece *p)
{
    unsigned char *bytes = make_room(p->w, p->vertex_count, 12);
    bounds b = NOWHERE;
    for (uint32_t i = 0; i < p->vertex_count && bytes != NULL; ++i) {
        float xyz[3];
        memcpy(xyz, p->m->a.rest + 3 * (size_t)p->m->used[i], sizeof xyz);
        take_morphs_off(p, p->m->used[i], xyz);
        extend(&b, xyz);
        for (int c = 0; c < 3; ++c)
            put_float(bytes + 12 * (size_t)i + 4 * c, xyz[c]);
    }
    return add_bounded(p->w, bytes, p->vertex_count, &b);
}

/* What blending may have made of an attribute that the format binds: unit vectors, colours. */
static void keep_rules(const sph__gltf_document *d, const sph__levels_attribute *a, float *x)
{
    const bool tangent = a->target == SPH__GLTF_NONE && sph__gltf_is(d, a->name, "TANGENT");
    if (a->normal || tangent) {
        const double length =
            sqrt((double)x[0] * (double)x[0] + (double)x[1] * (double)x[1] + (double)x[2] * (double)x[2]);
        for (int c = 0; c < 3; ++c)
            x[c] = length > 1e-12 ? (float)((double)x[c] / length) : c == (tangent ? 0 : 1);
        if (tangent) x[3] = x[3] < 0 ? -1.0F : 1.0F;
    }
}

static uint32_t put_attribute(const piece *p, const sph__levels_attribute *a)
{
    const sph_io_rig_levels *l = p->w->l;
    const size_t size = 4 * (size_t)a->width;
    unsigned char *bytes = make_room(p->w, p->vertex_count, size);
    bounds b = NOWHERE;
    for (uint32_t i = 0; i < p->vertex_count && bytes != NULL; ++i) {
        const size_t v = p->m->used[i];
        float x[4] = {0, 0, 0, 0};
        memcpy(x, a->normal ? p->m->normals + 3 * v : p->m->numbers + v * l->columns + a->column, size);
        keep_rules(&l->d, a, x);
        extend(&b, x);
        for (uint32_t c = 0; c < a->width; ++c)
            put_float(bytes + size * i + 4 * (size_t)c, x[c]);
    }
    if (a->width == 3 && sph__gltf_is(&l->d, a->name, "POSITION")) return add_bounded(p->w, bytes, p->vertex_count, &b);
    return add_accessor(p->w, bytes, p->vertex_count, size, SPH__GLTF_F32, WIDTHS[a->width], SPH__GLTF_VERTICES, "");
}

/* Attributes of the part (target NONE), or of one of its morph targets. */
static void put_attributes(const piece *p, uint32_t target, bool *first)
{
    const sph_io_rig_levels *l = p->w->l;
    for (size_t i = 0; i < p->more->attribute_count; ++i) {
        const sph__levels_attribute *a = &l->attributes[p->more->first_attribute + i];
        char *name = NULL;
        uint32_t accessor;
        if (a->target != target) continue;
        accessor = put_attribute(p, a);
        note(p->w, sph__gltf_copy_text(&l->d, a->name, &name));
        if (!*first) sph__io_text_bytes(&p->w->w.json, ",", 1);
        *first = false;
        if (name != NULL) sph__io_text_string(&p->w->w.json, name);
        sph__io_text_add(&p->w->w.json, ":%u", (unsigned)accessor);
        sph_context_release(l->context, name);
    }
}

static uint32_t most_influences(const piece *p)
{
    const uint32_t k = p->m->a.influence_count;
    uint32_t most = 1;
    for (uint32_t i = 0; i < p->vertex_count; ++i)
        while (most < k && p->m->a.weights[(size_t)p->m->used[i] * k + most] > 0)
            ++most;
    return most;
}

static void put_influences(const piece *p)
{
    const sph_io_rig_levels *l = p->w->l;
    const sph__gltf_node *node = &l->g->nodes[p->part->node];
    const uint32_t k = p->m->a.influence_count, sets = (most_influences(p) + JOINTS_PER_SET - 1) / JOINTS_PER_SET;
    const uint32_t joints = sph__gltf_get(&l->d, l->d.lists[SPH__GLTF_SKINS].values[node->skin], "joints");
    const size_t size = l->d.values[joints].count > NARROW_JOINTS ? 2 : 1;
    for (uint32_t s = 0; s < sets; ++s) {
        unsigned char *numbers = make_room(p->w, p->vertex_count, JOINTS_PER_SET * size);
        unsigned char *weights = make_room(p->w, p->vertex_count, JOINTS_PER_SET * 4);
        uint32_t accessors[2];
        for (size_t i = 0; i < (size_t)p->vertex_count * JOINTS_PER_SET && numbers != NULL && weights != NULL; ++i) {
            const size_t slot = s * JOINTS_PER_SET + i % JOINTS_PER_SET;
            const size_t at = (size_t)p->m->used[i / JOINTS_PER_SET] * k + slot;
            const float weight = slot < k ? p->m->a.weights[at] : 0;
            put_little(numbers + i * size, weight > 0 ? p->m->a.bones[at] - l->g->skin_bones[node->skin] : 0, size);
            put_float(weights + 4 * i, weight);
        }
        accessors[0] = add_accessor(p->w, numbers, p->vertex_count, JOINTS_PER_SET * size,
                                    size == 1 ? SPH__GLTF_U8 : SPH__GLTF_U16, "VEC4", SPH__GLTF_VERTICES, "");
        accessors[1] = add_accessor(p->w, weights, p->vertex_count, JOINTS_PER_SET * 4, SPH__GLTF_F32, "VEC4",
                                    SPH__GLTF_VERTICES, "");
        sph__io_text_add(&p->w->w.json, ",\"JOINTS_%u\":%u,\"WEIGHTS_%u\":%u", (unsigned)s, (unsigned)accessors[0],
                         (unsigned)s, (unsigned)accessors[1]);
    }
}

static bool has_influences(const piece *p)
{
    const sph_io_rig_levels *l = p->w->l;
    const uint32_t attributes = sph__gltf_get(&l->d, p->part->primitive, "attributes");
    return l->g->nodes[p->part->node].skin != SPH__GLTF_NONE && sph__gltf_get(&l->d, attributes, "JOINTS_0") != 0;
}

/* Triangles that were turned round when they were read are turned back. */
static uint32_t put_indices(const piece *p)
{
    const size_t size = p->vertex_count > NARROW_VERTICES ? 4 : 2;
    unsigned char *bytes = make_room(p->w, p->count, 3 * size);
    for (size_t i = 0; i < p->count && bytes != NULL; ++i) {
        const uint32_t *corner = p->m->a.triangles + 3 * (p->first + i);
        for (size_t k = 0; k < 3; ++k)
            put_little(bytes + (3 * i + k) * size, p->m->place[corner[p->part->mirrored && k > 0 ? 3 - k : k]], size);
    }
    return add_accessor(p->w, bytes, 3 * p->count, size, size == 4 ? SPH__GLTF_U32 : SPH__GLTF_U16, "SCALAR",
                        SPH__GLTF_INDICES, "");
}

static void put_targets(const piece *p)
{
    const sph_io_rig_levels *l = p->w->l;
    const uint32_t array = sph__gltf_get(&l->d, p->part->primitive, "targets");
    if (array == 0) return;
    sph__io_text_add(&p->w->w.json, ",\"targets\":[");
    for (uint32_t t = 0; t < l->d.values[array].count; ++t) {
        bool first = true;
        sph__io_text_add(&p->w->w.json, t == 0 ? "{" : ",{");
        put_attributes(p, t, &first);
        sph__io_text_bytes(&p->w->w.json, "}", 1);
    }
    sph__io_text_bytes(&p->w->w.json, "]", 1);
}

static void put_piece(const piece *p)
{
    static const char *const MADE[] = {"attributes", "indices", "targets", "mode", NULL};
    sph__io_text *t = &p->w->w.json;
    bool first = false;
    sph__io_text_add(t, "{\"attributes\":{\"POSITION\":%u", (unsigned)put_positions(p));
    put_attributes(p, SPH__GLTF_NONE, &first);
    if (has_influences(p)) put_influences(p);
    sph__io_text_add(t, "},\"indices\":%u", (unsigned)put_indices(p));
    put_targets(p);
    sph__levels_copy_members(p->w, t, p->part->primitive, MADE, &first);
    sph__io_text_bytes(t, "}", 1);
}

bool sph__levels_put_part(sph__levels_writer *w, sph__levels_mesh *m, size_t part, bool first)
{
    piece p = {.w = w, .m = m, .part = &w->l->g->parts[part], .more = &w->l->parts[part]};
    p.first = find_source(m, p.part->first_triangle);
    p.count = find_source(m, p.part->first_triangle + p.more->triangle_count) - p.first;
    if (p.count == 0 || w->status != SPH_OK) return false;
    for (size_t i = 3 * p.first; i < 3 * (p.first + p.count); ++i) {
        uint32_t *place = &m->place[m->a.triangles[i]];
        if (*place != SPH__GLTF_NONE) continue;
        m->used[p.vertex_count] = m->a.triangles[i];
        *place = p.vertex_count++;
    }
    if (!first) sph__io_text_bytes(&w->w.json, ",", 1);
    put_piece(&p);
    for (uint32_t i = 0; i < p.vertex_count; ++i)
        m->place[m->used[i]] = SPH__GLTF_NONE;
    return true;
}
