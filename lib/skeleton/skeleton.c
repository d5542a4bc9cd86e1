/* SPDX-License-Identifier: MIT */
/* The handle, its options, and the choice of a root. */
#include <math.h>

#include "numeric/numeric.h"
#include "skeleton/skeleton.h"

static const sph_skeleton_options DEFAULTS = {
    .struct_size = sizeof(sph_skeleton_options), .layout = SPH_SKELETON_TREE, .root = SPH_ROOT_CENTER};
enum { OPTIONS_V1 = offsetof(sph_skeleton_options, single_root) + sizeof(uint32_t) };

void sph_skeleton_options_init(sph_skeleton_options *options, size_t size)
{
    sph__options_init(options, size, &DEFAULTS, sizeof DEFAULTS, OPTIONS_V1);
}

static sph_status read_options(const sph_skin *skin, const sph_skeleton_options *in, sph_skeleton_options *o)
{
    const sph_context *context = skin->context;
    sph_status status;
    *o = DEFAULTS;
    status = sph__options_read(context, "sph_skeleton_options", in, o, sizeof *o, OPTIONS_V1);
    if (status != SPH_OK) return status;
    if (o->flags != 0) return sph__fail(context, SPH_E_INVALID, "sph_skeleton_options: flags must be 0");
    if (o->layout < SPH_SKELETON_TREE || o->layout > SPH_SKELETON_FLAT)
        return sph__fail(context, SPH_E_INVALID, "sph_skeleton_options: layout is %d", (int)o->layout);
    if (o->root < SPH_ROOT_CENTER || o->root > SPH_ROOT_GIVEN)
        return sph__fail(context, SPH_E_INVALID, "sph_skeleton_options: root is %d", (int)o->root);
    if (o->root == SPH_ROOT_GIVEN && o->root_bone >= skin->bone_count)
        return sph__fail(context, SPH_E_INVALID, "sph_skeleton_options: root_bone is %u, of %u bones",
                         (unsigned)o->root_bone, (unsigned)skin->bone_count);
    if (o->single_root > 1)
        return sph__fail(context, SPH_E_INVALID, "sph_skeleton_options: single_root is %u", (unsigned)o->single_root);
    return SPH_OK;
}

static sph_status allocate(sph_context *context, uint32_t bone_count, bool single_root, sph_skeleton **out)
{
    sph_skeleton *s;
    size_t joints;
    if (bone_count > INT32_MAX) return sph__fail(context, SPH_E_LIMIT, "a skeleton of %u bones", (unsigned)bone_count);
    s = sph__new(context, sizeof *s, SPH__SKELETON);
    if (s == NULL) return sph__fail_memory(context);
    s->context = sph__context_retain(context);
    s->bone_count = bone_count;
    s->joint_count = bone_count + single_root;
    joints = s->joint_count;
    s->parents = sph__alloc(context, joints, sizeof *s->parents);
    s->order = sph__alloc(context, joints, sizeof *s->order);
    s->positions = sph__zalloc(context, joints, 3 * sizeof *s->positions);
    s->rest = sph__zalloc(context, joints, 12 * sizeof *s->rest);
    s->inverse_bind = sph__zalloc(context, joints, 12 * sizeof *s->inverse_bind);
    s->gaps = sph__zalloc(context, joints, sizeof *s->gaps);
    *out = s;
    return s->parents == NULL || s->order == NULL || s->positions == NULL || s->rest == NULL ||
                   s->inverse_bind == NULL || s->gaps == NULL
               ? sph__fail_memory(context)
               : SPH_OK;
}

/* The bone of most area times weight. */
static sph_status find_heaviest(const sph_skin *skin, uint32_t *root)
{
    const uint32_t k = skin->influence_count;
    double *areas = sph__alloc(skin->context, skin->vertex_count, sizeof *areas);
    double *sums = sph__zalloc(skin->context, skin->bone_count, sizeof *sums), all = 0;
    if (areas != NULL && sums != NULL) {
        sph__cell_areas(skin->triangles, skin->triangle_count, skin->rest, skin->vertex_count, areas);
        for (size_t v = 0; v < skin->vertex_count; ++v)
            all += areas[v];
        for (size_t i = 0; i < (size_t)skin->vertex_count * k; ++i)
            sums[skin->bones[i]] += (double)skin->weights[i] * (all > 0 ? areas[i / k] : 1);
        *root = 0;
        for (uint32_t b = 1; b < skin->bone_count; ++b)
            if (sums[b] > sums[*root]) *root = b;
    }
    sph__free(skin->context, areas);
    sph__free(skin->context, sums);
    return areas == NULL || sums == NULL ? sph__fail_memory(skin->context) : SPH_OK;
}

/* Hangs the tree up at its root. */
static sph_status hang(sph_skeleton *s, const sph_skin *skin, const sph_skeleton_options *o, sph__tree *tree)
{
    uint32_t root = o->root_bone;
    sph_status status = SPH_OK;
    if (o->root == SPH_ROOT_CENTER) root = sph__tree_center(tree);
    if (o->root == SPH_ROOT_HEAVIEST) status = find_heaviest(skin, &root);
    if (status != SPH_OK) return status;
    sph__tree_walk_from(tree, root);
    for (uint32_t b = 0; b < s->bone_count; ++b) {
        const uint32_t parent = tree->walk.before[b];
        const sph__bond *bond = parent == SPH_NO_JOINT ? NULL : &tree->bonds[tree->walk.by[b]];
        const double *position = bond == NULL ? skin->pivots + 3 * (size_t)b : bond->position;
        memcpy(s->positions + 3 * (size_t)b, position, 3 * sizeof *position);
        s->parents[b] = parent;
        s->gaps[b] = bond == NULL ? 0 : bond->gap;
    }
    memcpy(s->order + (s->joint_count - s->bone_count), tree->walk.order, s->bone_count * sizeof *s->order);
    return SPH_OK;
}

static sph_status make_tree(sph_skeleton *s, const sph_skin *skin, const sph_skeleton_options *o,
                            sph__progress *progress)
{
    sph__bond *bonds = sph__alloc(s->context, s->bone_count, sizeof *bonds);
    sph__tree tree = {.context = s->context};
    sph_status status = bonds == NULL ? sph__fail_memory(s->context) : sph__tree_span(skin, progress, bonds);
    if (status == SPH_OK) status = sph__tree_open(&tree, skin, bonds);
    if (status == SPH_OK) status = hang(s, skin, o, &tree);
    sph__tree_close(&tree);
    sph__free(s->context, bonds);
    return status;
}

static void make_list(sph_skeleton *s, const sph_skin *skin)
{
    memcpy(s->positions, skin->pivots, (size_t)s->bone_count * 3 * sizeof *s->positions);
    for (uint32_t b = 0; b < s->bone_count; ++b) {
        s->parents[b] = SPH_NO_JOINT;
        s->order[b + (s->joint_count - s->bone_count)] = b;
    }
}

/* Joints are not turned at rest: all matrices are translations. */
static void finish(sph_skeleton *s)
{
    const bool single = s->joint_count > s->bone_count;
    if (single) s->order[0] = s->bone_count;
    for (uint32_t b = 0; b < s->bone_count && single; ++b)
        if (s->parents[b] == SPH_NO_JOINT) s->parents[b] = s->bone_count;
    if (single) s->parents[s->bone_count] = SPH_NO_JOINT;
    for (size_t j = 0; j < s->joint_count; ++j)
        for (int k = 0; k < 3; ++k) {
            const double at = s->positions[3 * j + k];
            s->rest[12 * j + 5 * k] = s->inverse_bind[12 * j + 5 * k] = 1;
            s->rest[12 * j + 4 * k + 3] =
                s->parents[j] == SPH_NO_JOINT ? at : at - s->positions[3 * (size_t)s->parents[j] + k];
            s->inverse_bind[12 * j + 4 * k + 3] = -at;
        }
}

sph_status sph_skeleton_create(const sph_skin *skin, const sph_skeleton_options *options, sph_skeleton **out)
{
    SPH__OWN(skin, SPH__SKIN);
    sph_skeleton_options o;
    sph_skeleton *skeleton = NULL;
    sph__progress progress;
    sph_status status;
    if (out != NULL) *out = NULL;
    if (skin == NULL || out == NULL)
        return sph__fail(skin == NULL ? NULL : skin->context, SPH_E_INVALID,
                         "sph_skeleton_create: an argument is NULL");
    status = read_options(skin, options, &o);
    if (status != SPH_OK) return status;
    sph__progress_begin(&progress, skin->context);
    sph__progress_part(&progress, 1);
    status = allocate(skin->context, skin->bone_count, o.single_root != 0, &skeleton);
    if (status == SPH_OK && o.layout == SPH_SKELETON_TREE) status = make_tree(skeleton, skin, &o, &progress);
    if (status == SPH_OK && o.layout == SPH_SKELETON_FLAT) make_list(skeleton, skin);
    if (status == SPH_OK) status = sph__progress_report(&progress, "skeleton", 1);
    if (status != SPH_OK) {
        sph_skeleton_destroy(skeleton);
        return status;
    }
    finish(skeleton);
    *out = skeleton;
    return SPH_OK;
}

void sph_skeleton_destroy(sph_skeleton *skeleton)
{
    SPH__OWN(skeleton, SPH__SKELETON);
    sph_context *context;
    if (skeleton == NULL) return;
    context = skeleton->context;
    sph__free(context, skeleton->parents);
    sph__free(context, skeleton->order);
    sph__free(context, skeleton->positions);
    sph__free(context, skeleton->rest);
    sph__free(context, skeleton->inverse_bind);
    sph__free(context, skeleton->gaps);
    sph__free(context, skeleton);
    sph__context_release(context);
}

sph_status sph_skeleton_get_arrays(const sph_skeleton *skeleton, sph_skeleton_arrays *arrays)
{
    SPH__OWN(skeleton, SPH__SKELETON);
    if (skeleton == NULL || arrays == NULL)
        return sph__fail(skeleton == NULL ? NULL : skeleton->context, SPH_E_INVALID,
                         "sph_skeleton_get_arrays: an argument is NULL");
    if (arrays->struct_size != sizeof *arrays)
        return sph__fail(skeleton->context, SPH_E_INVALID, "sph_skeleton_arrays: struct_size is %u, not %zu",
                         (unsigned)arrays->struct_size, sizeof *arrays);
    *arrays = (sph_skeleton_arrays){.struct_size = sizeof *arrays,
                                    .bone_count = skeleton->bone_count,
                                    .joint_count = skeleton->joint_count,
                                    .parents = skeleton->parents,
                                    .order = skeleton->order,
                                    .positions = skeleton->positions,
                                    .rest = skeleton->rest,
                                    .inverse_bind = skeleton->inverse_bind,
                                    .gaps = skeleton->gaps};
    return SPH_OK;
}
