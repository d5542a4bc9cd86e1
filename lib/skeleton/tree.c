/* SPDX-License-Identifier: MIT */
/* The spanning tree of a skin's links, and ways along it. */
#include <math.h>

#include "numeric/numeric.h"
#include "skeleton/skeleton.h"

enum { GRAIN = 16 };

/* --- parts that hang together --- */

static uint32_t find(uint32_t *parts, uint32_t bone)
{
    while (parts[bone] != bone) {
        parts[bone] = parts[parts[bone]];
        bone = parts[bone];
    }
    return bone;
}

/* False where the two hang together already. The lowest bone stands for a part. */
static bool unite(uint32_t *parts, uint32_t a, uint32_t b)
{
    a = find(parts, a);
    b = find(parts, b);
    if (a == b) return false;
    parts[a > b ? a : b] = a > b ? b : a;
    return true;
}

typedef struct spanning {
    const sph_skin *skin;
    sph__progress *progress;
    uint32_t *parts;   /* [J] */
    sph__bond *links;  /* of all the skin's links */
    sph__keyed *keys;  /* of them */
    double *distances; /* [J]: to the nearest bone of the part that grows */
    uint32_t *nearest; /* [J]: that bone */
    sph__bond *bonds;  /* the result */
    uint32_t bond_count;
} spanning;

static void fit_links(void *argument, size_t begin, size_t end)
{
    spanning *s = argument;
    for (size_t i = begin; i < end; ++i) {
        s->links[i].bones[0] = s->skin->links[2 * i];
        s->links[i].bones[1] = s->skin->links[2 * i + 1];
        sph__bond_fit(s->skin, &s->links[i]);
    }
}

/* Kruskal's: the cheapest links that close no ring. Numbers that are not negative compare as their bits do. */
static void take_links(spanning *s)
{
    const size_t count = s->skin->link_count;
    for (size_t i = 0; i < count; ++i) {
        s->keys[i].item = i;
        memcpy(&s->keys[i].key, &s->links[i].cost, sizeof s->keys[i].key);
    }
    sph__sort(s->keys, count);
    for (size_t i = 0; i < count; ++i) {
        const sph__bond *link = &s->links[s->keys[i].item];
        if (unite(s->parts, link->bones[0], link->bones[1])) s->bonds[s->bond_count++] = *link;
    }
}

/* --- what no link joins: by the nearest spheres of the rest pose (Prim's) --- */

/* Marks a bone as one of the part that grows, and looks how near it is to the others. */
static void absorb(spanning *s, uint32_t bone)
{
    const sph_skin *skin = s->skin;
    s->nearest[bone] = bone;
    s->distances[bone] = -INFINITY;
    for (uint32_t b = 0; b < skin->bone_count; ++b) {
        double apart[3], distance;
        if (s->nearest[b] == b) continue;
        sph__subtract(skin->pivots + 3 * (size_t)bone, skin->pivots + 3 * (size_t)b, apart);
        distance = sph__length(apart) - skin->radii[bone] - skin->radii[b];
        if (s->nearest[b] != SPH_NO_JOINT && !(distance < s->distances[b])) continue;
        s->distances[b] = distance;
        s->nearest[b] = bone;
    }
}

/* Absorbs all bones of a part; counts them. */
static sph_status absorb_part(spanning *s, uint32_t part, uint32_t *absorbed)
{
    for (uint32_t b = 0; b < s->skin->bone_count; ++b) {
        sph_status status;
        if (s->nearest[b] == b || find(s->parts, b) != part) continue;
        status = sph__progress_report(s->progress, "skeleton", (double)*absorbed / s->skin->bone_count);
        if (status != SPH_OK) return status;
        absorb(s, b);
        ++*absorbed;
    }
    return SPH_OK;
}

static uint32_t nearest_outside(const spanning *s)
{
    uint32_t best = SPH_NO_JOINT;
    for (uint32_t b = 0; b < s->skin->bone_count; ++b)
        if (s->nearest[b] != b && (best == SPH_NO_JOINT || s->distances[b] < s->distances[best])) best = b;
    return best;
}

static sph_status bridge(spanning *s)
{
    const uint32_t count = s->skin->bone_count;
    uint32_t absorbed = 0, bone = 0;
    sph_status status = SPH_OK;
    if (s->bond_count == count - 1) return SPH_OK;
    for (uint32_t b = 0; b < count; ++b)
        s->nearest[b] = SPH_NO_JOINT;
    while (bone != SPH_NO_JOINT && status == SPH_OK) {
        /* Parts as the links left them: bridges do not unite them. */
        status = absorb_part(s, find(s->parts, bone), &absorbed);
        bone = nearest_outside(s);
        if (bone == SPH_NO_JOINT || status != SPH_OK) continue;
        s->bonds[s->bond_count] = (sph__bond){.bones = {s->nearest[bone], bone}};
        sph__bond_fit(s->skin, &s->bonds[s->bond_count++]);
    }
    return status;
}

sph_status sph__tree_span(const sph_skin *skin, sph__progress *progress, sph__bond *bonds)
{
    const sph_context *context = skin->context;
    spanning s = {.skin = skin, .progress = progress, .bonds = bonds};
    sph_status status = SPH_OK;
    s.parts = sph__alloc(context, skin->bone_count, sizeof *s.parts);
    s.links = sph__zalloc(context, skin->link_count, sizeof *s.links);
    s.keys = sph__alloc(context, skin->link_count, sizeof *s.keys);
    s.distances = sph__alloc(context, skin->bone_count, sizeof *s.distances);
    s.nearest = sph__alloc(context, skin->bone_count, sizeof *s.nearest);
    if (s.parts == NULL || s.links == NULL || s.keys == NULL || s.distances == NULL || s.nearest == NULL)
        status = sph__fail_memory(context);
    for (uint32_t b = 0; b < skin->bone_count && status == SPH_OK; ++b)
        s.parts[b] = b;
    if (status == SPH_OK) status = sph__progress_report(progress, "skeleton", 0);
    if (status == SPH_OK) {
        sph__parallel_for(context, skin->link_count, GRAIN, fit_links, &s);
        take_links(&s);
        status = bridge(&s);
    }
    sph__free(context, s.parts);
    sph__free(context, s.links);
    sph__free(context, s.keys);
    sph__free(context, s.distances);
    sph__free(context, s.nearest);
    return status;
}

/* --- ways --- */

sph_status sph__tree_open(sph__tree *tree, const sph_skin *skin, const sph__bond *bonds)
{
    const sph_context *context = skin->context;
    const size_t count = skin->bone_count;
    *tree = (sph__tree){.context = context, .skin = skin, .bonds = bonds};
    tree->starts = sph__zalloc(context, count + 2, sizeof *tree->starts);
    tree->around = sph__alloc(context, 2 * count, sizeof *tree->around);
    tree->walk.order = sph__alloc(context, count, sizeof *tree->walk.order);
    tree->walk.before = sph__alloc(context, count, sizeof *tree->walk.before);
    tree->walk.by = sph__alloc(context, count, sizeof *tree->walk.by);
    tree->walk.way = sph__alloc(context, count, sizeof *tree->walk.way);
    if (tree->starts == NULL || tree->around == NULL || tree->walk.order == NULL || tree->walk.before == NULL ||
        tree->walk.by == NULL || tree->walk.way == NULL)
        return sph__fail_memory(context);
    for (size_t i = 0; i < 2 * (count - 1); ++i)
        ++tree->starts[bonds[i / 2].bones[i % 2] + 2];
    for (size_t b = 2; b <= count; ++b)
        tree->starts[b] += tree->starts[b - 1];
    for (size_t i = 0; i < 2 * (count - 1); ++i) /* starts[b + 1] grows to where b's bonds end */
        tree->around[tree->starts[bonds[i / 2].bones[i % 2] + 1]++] = (uint32_t)(i / 2);
    return SPH_OK;
}

void sph__tree_close(sph__tree *tree)
{
    sph__free(tree->context, tree->starts);
    sph__free(tree->context, tree->around);
    sph__free(tree->context, tree->walk.order);
    sph__free(tree->context, tree->walk.before);
    sph__free(tree->context, tree->walk.by);
    sph__free(tree->context, tree->walk.way);
    *tree = (sph__tree){0};
}

void sph__tree_walk_from(sph__tree *tree, uint32_t bone)
{
    const double *pivots = tree->skin->pivots;
    sph__walk *w = &tree->walk;
    uint32_t found = 0;
    w->order[found++] = bone;
    w->before[bone] = w->by[bone] = SPH_NO_JOINT;
    w->way[bone] = 0;
    for (uint32_t done = 0; done < found; ++done) {
        const uint32_t at = w->order[done];
        for (uint32_t i = tree->starts[at]; i < tree->starts[at + 1]; ++i) {
            const sph__bond *bond = &tree->bonds[tree->around[i]];
            const uint32_t next = bond->bones[bond->bones[0] == at];
            double apart[3];
            if (next == w->before[at]) continue;
            sph__subtract(pivots + 3 * (size_t)at, pivots + 3 * (size_t)next, apart);
            w->before[next] = at;
            w->by[next] = tree->around[i];
            w->way[next] = w->way[at] + sph__length(apart);
            w->order[found++] = next;
        }
    }
}

static uint32_t farthest(const sph__tree *tree)
{
    uint32_t best = 0;
    for (uint32_t b = 1; b < tree->skin->bone_count; ++b)
        if (tree->walk.way[b] > tree->walk.way[best]) best = b;
    return best;
}

/* The bone nearest to the middle of a longest way. */
uint32_t sph__tree_center(sph__tree *tree)
{
    const sph__walk *w = &tree->walk;
    uint32_t end, best;
    double whole;
    sph__tree_walk_from(tree, 0);
    sph__tree_walk_from(tree, farthest(tree));
    best = end = farthest(tree);
    whole = w->way[end];
    for (uint32_t b = end; b != SPH_NO_JOINT; b = w->before[b])
        if (fmax(w->way[b], whole - w->way[b]) < fmax(w->way[best], whole - w->way[best])) best = b;
    return best;
}
