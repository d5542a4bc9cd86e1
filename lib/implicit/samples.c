/* SPDX-License-Identifier: MIT */
/* The samples of a part, and its field. */
#include <math.h>

#include "implicit/setup.h"
#include "numeric/numeric.h"

enum { CANDIDATES_PER_SAMPLE = 16, SAMPLE_LEAST = 4, ENDS_LIMIT = 32 };

/* Samples nearer to each other than this part of the part's size would be one. */
static const double LEAST_SPACING = 1e-3;
/* Of the opening's reach: within it, what is beyond the culling plane is left out. */
static const double CULL_REACH = 1.25;

/* A place where a part is closed. */
typedef struct end_cap {
    double center[3], axis[3];      /* unit, outward */
    double distance, reach, length; /* of the nearest node, of the opening, of the bone */
    bool closes;
} end_cap;

typedef struct part {
    const sph__setup *setup;
    uint32_t bone;
    size_t count, kept;       /* candidates: those that are not culled come first */
    double *points, *normals; /* [count][3] */
    double *nearest;          /* [count] */
    double center[3], size;   /* of the candidates, and the diagonal of their box */
    uint32_t end_count;
    end_cap ends[ENDS_LIMIT];
    double bones[ENDS_LIMIT + 1][2][3]; /* segments */
    uint32_t bone_count;
} part;

/* --- candidates: evenly over the area --- */

static double triangle_area(const sph__shell *s, size_t t)
{
    double u[3], v[3], n[3];
    for (int c = 0; c < 3; ++c) {
        const double o = (double)s->rest[3 * (size_t)s->triangles[3 * t] + c];
        u[c] = (double)s->rest[3 * (size_t)s->triangles[3 * t + 1] + c] - o;
        v[c] = (double)s->rest[3 * (size_t)s->triangles[3 * t + 2] + c] - o;
    }
    sph__cross(u, v, n);
    return 0.5 * sph__norm(n);
}

/* A point of the triangle, by low-discrepancy coordinates; false where it has no normal. */
static bool place_candidate(const sph__setup *s, size_t t, size_t index, double p[3], double n[3])
{
    double a = fmod(0.7548776662466927 * (double)(index + 1), 1), b = fmod(0.5698402909980532 * (double)(index + 1), 1);
    const uint32_t *corner = s->shell.triangles + 3 * t;
    if (a + b > 1) {
        a = 1 - a;
        b = 1 - b;
    }
    for (int c = 0; c < 3; ++c) {
        p[c] = n[c] = 0;
        for (int k = 0; k < 3; ++k) {
            const double share = k == 0 ? 1 - a - b : k == 1 ? a : b;
            p[c] += share * (double)s->shell.rest[3 * (size_t)corner[k] + c];
            n[c] += share * s->signs[corner[k]] * s->shell.normals[3 * (size_t)corner[k] + c];
        }
    }
    return sph__normalize(n);
}

static void find_candidates(part *p)
{
    const sph__setup *s = p->setup;
    const size_t wanted = (size_t)CANDIDATES_PER_SAMPLE * s->options->sample_count;
    double all = 0, before = 0;
    size_t next = 0;
    for (size_t i = s->starts[p->bone]; i < s->starts[p->bone + 1]; ++i)
        all += triangle_area(&s->shell, s->members[i]);
    for (size_t i = s->starts[p->bone]; i < s->starts[p->bone + 1] && all > 0; ++i) {
        before += triangle_area(&s->shell, s->members[i]);
        for (; next < wanted && ((double)next + 0.5) * all <= before * (double)wanted; ++next)
            if (place_candidate(s, s->members[i], next, p->points + 3 * p->count, p->normals + 3 * p->count))
                ++p->count;
    }
}

static void measure_candidates(part *p)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < 3 * p->count; ++i) {
        p->center[i % 3] += p->points[i] / (double)p->count;
        low[i % 3] = fmin(low[i % 3], p->points[i]);
        high[i % 3] = fmax(high[i % 3], p->points[i]);
    }
    p->size = p->count > 0 ? sph__distance(low, high) : 0;
}

/* --- bones and ends --- */

static void add_bone(part *p, const double a[3], const double b[3])
{
    memcpy(p->bones[p->bone_count][0], a, 3 * sizeof *a);
    memcpy(p->bones[p->bone_count++][1], b, 3 * sizeof *b);
}

/* From a point along an axis as far as the part goes, but for its thickness. */
static void add_bone_along(part *p, const double from[3], const double axis[3], bool both_ways)
{
    double high = 0, low = 0, around = 0, a[3], b[3];
    for (size_t i = 0; i < p->count; ++i) {
        double d[3], along, across;
        sph__subtract(p->points + 3 * i, from, d);
        along = sph__dot(d, axis);
        sph__add_scaled(d, -along, axis, d);
        across = sph__norm(d);
        high = fmax(high, along);
        low = fmin(low, along);
        around += across / (double)p->count;
    }
    high = fmax(high - around, 0);
    low = both_ways ? fmin(low + around, 0) : 0;
    for (int c = 0; c < 3; ++c) {
        a[c] = from[c] + low * axis[c];
        b[c] = from[c] + high * axis[c];
    }
    add_bone(p, a, b);
}

static void add_bone_of_shape(part *p)
{
    double m[6] = {0}, values[3], vectors[3][3];
    for (size_t i = 0; i < p->count; ++i) {
        double d[3];
        sph__subtract(p->points + 3 * i, p->center, d);
        sph__sym3_add_outer(1.0 / (double)p->count, d, m);
    }
    sph__sym3_eigen(m, values, vectors);
    add_bone_along(p, p->center, vectors[2], true);
}

/* The joints of the bone: how many, the mean of those below it. */
static uint32_t find_joints(const part *p, uint32_t joints[ENDS_LIMIT], double below[3], uint32_t *below_count)
{
    const sph__setup *s = p->setup;
    uint32_t count = 0;
    *below_count = 0;
    below[0] = below[1] = below[2] = 0;
    for (uint32_t j = 0; j < s->joint_count && count < ENDS_LIMIT; ++j) {
        if (s->joints[j].bones[0] != p->bone && s->joints[j].bones[1] != p->bone) continue;
        joints[count++] = j;
        if (s->upper[j] == p->bone) continue;
        ++*below_count;
        sph__add_scaled(below, 1, s->joints[j].position, below);
    }
    for (int c = 0; c < 3 && *below_count > 0; ++c)
        below[c] /= *below_count;
    return count;
}

static void find_ends(part *p)
{
    const sph__setup *s = p->setup;
    const double *pivot = s->skin->pivots + 3 * (size_t)p->bone;
    uint32_t joints[ENDS_LIMIT], below_count;
    double below[3];
    p->end_count = find_joints(p, joints, below, &below_count);
    for (uint32_t i = 0; i < p->end_count; ++i) {
        const sph_implicit_joint *j = s->joints + joints[i];
        const sph__opening *o = s->openings + joints[i];
        const bool own = s->upper[joints[i]] == p->bone;
        const double *far = !own ? pivot : below_count > 0 ? below : p->center;
        end_cap *e = p->ends + i;
        *e = (end_cap){.distance = o->distance, .reach = o->reach};
        memcpy(e->center, o->center, sizeof e->center);
        sph__subtract(o->center, far, e->axis);
        e->length = sph__norm(e->axis);
        if (!(e->length > LEAST_SPACING * p->size)) { /* a bone without length */
            sph__subtract(o->center, p->center, e->axis);
            e->length = sph__norm(e->axis);
        }
        e->closes = o->corner_count > 0 && e->length > LEAST_SPACING * p->size && sph__normalize(e->axis) &&
                    e->distance < p->size;
        if (!own && sph__distance(pivot, j->position) > LEAST_SPACING * p->size) add_bone(p, pivot, j->position);
    }
    if (p->bone_count == 0 && p->end_count > 0) {
        double axis[3];
        sph__subtract(p->center, s->joints[joints[0]].position, axis);
        if (sph__normalize(axis)) add_bone_along(p, s->joints[joints[0]].position, axis, false);
    }
    if (p->bone_count == 0) add_bone_of_shape(p);
}

/* --- samples --- */

static bool is_culled(const part *p, const double x[3])
{
    for (uint32_t i = 0; i < p->end_count; ++i) {
        const end_cap *e = p->ends + i;
        double d[3], along, across;
        if (!e->closes) continue;
        sph__subtract(x, e->center, d);
        across = sph__norm(d);
        along = sph__dot(d, e->axis);
        if (along > -p->setup->options->joint_gap * e->length && across < CULL_REACH * e->reach) return true;
        sph__add_scaled(d, -e->distance, e->axis, d); /* from the sample that closes it */
        if (sph__norm(d) < 0.5 * e->distance) return true;
    }
    return false;
}

static void swap_candidates(part *p, size_t i, size_t k)
{
    for (size_t c = 0; c < 3 && i != k; ++c) {
        const double point = p->points[3 * i + c], normal = p->normals[3 * i + c];
        p->points[3 * i + c] = p->points[3 * k + c];
        p->normals[3 * i + c] = p->normals[3 * k + c];
        p->points[3 * k + c] = point;
        p->normals[3 * k + c] = normal;
    }
}

/* Where almost nothing would be left, nothing is. */
static void cull(part *p)
{
    for (size_t i = 0; i < p->count; ++i)
        if (!is_culled(p, p->points + 3 * i)) swap_candidates(p, p->kept++, i);
    if (p->kept < (size_t)2 * SAMPLE_LEAST) p->kept = p->count;
}

static void add_sample(sph__field *f, const double point[3], const double normal[3])
{
    memcpy(f->samples + 3 * (size_t)f->count, point, 3 * sizeof *point);
    memcpy(f->normals + 3 * (size_t)f->count++, normal, 3 * sizeof *normal);
}

/* Each farthest from those before it: no two are nearer than the last one is to the others. */
static void choose_samples(part *p, sph__field *f)
{
    size_t next = 0;
    for (size_t i = 0; i < p->kept; ++i)
        p->nearest[i] = INFINITY;
    while (f->count < p->setup->options->sample_count && next < p->kept && p->nearest[next] > LEAST_SPACING * p->size) {
        size_t farthest = 0;
        add_sample(f, p->points + 3 * next, p->normals + 3 * next);
        for (size_t i = 0; i < p->kept; ++i) {
            p->nearest[i] = fmin(p->nearest[i], sph__distance(p->points + 3 * i, p->points + 3 * next));
            if (p->nearest[i] > p->nearest[farthest]) farthest = i;
        }
        next = farthest;
    }
}

static bool is_near_sample(const part *p, const sph__field *f, const double x[3])
{
    for (size_t i = 0; i < f->count; ++i)
        if (sph__distance(f->samples + 3 * i, x) <= LEAST_SPACING * p->size) return true;
    return false;
}

static void close_ends(const part *p, sph__field *f)
{
    for (uint32_t i = 0; i < p->end_count; ++i) {
        const end_cap *e = p->ends + i;
        double x[3];
        memcpy(x, e->center, sizeof x);
        sph__add_scaled(x, e->distance, e->axis, x);
        if (!e->closes || is_near_sample(p, f, x)) continue;
        add_sample(f, x, e->axis);
        ++f->closing_count;
    }
}

static double bone_distance(const part *p, const double x[3])
{
    double least = INFINITY;
    for (uint32_t i = 0; i < p->bone_count; ++i) {
        double along[3], from[3], square, t;
        sph__subtract(p->bones[i][1], p->bones[i][0], along);
        sph__subtract(x, p->bones[i][0], from);
        square = sph__dot(along, along);
        t = square > 0 ? fmin(fmax(sph__dot(from, along) / square, 0), 1) : 0;
        sph__add_scaled(from, -t, along, from);
        least = fmin(least, sph__norm(from));
    }
    return least;
}

static void measure_field(const part *p, sph__field *f)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    f->radius = 0.05 * p->size;
    for (size_t i = 0; i < f->count; ++i) {
        if (i + f->closing_count < f->count) f->radius = fmax(f->radius, bone_distance(p, f->samples + 3 * i));
        for (int c = 0; c < 3; ++c) {
            low[c] = fmin(low[c], f->samples[3 * i + c]);
            high[c] = fmax(high[c], f->samples[3 * i + c]);
        }
    }
    f->scale = p->size;
    for (int c = 0; c < 3; ++c) {
        f->low[c] = low[c] - f->radius;
        f->high[c] = high[c] + f->radius;
        f->origin[c] = 0.5 * (low[c] + high[c]);
    }
}

static bool fit_part(part *p)
{
    sph__field *f = p->setup->implicit->fields + p->bone;
    bool out_of_memory = false, fitted;
    find_candidates(p);
    measure_candidates(p);
    if (p->count < SAMPLE_LEAST || !(p->size > 0) || !isfinite(p->size)) return true;
    find_ends(p);
    cull(p);
    choose_samples(p, f);
    if (f->count < SAMPLE_LEAST) {
        f->count = 0;
        return true;
    }
    close_ends(p, f);
    measure_field(p, f);
    fitted = sph__field_fit(p->setup->skin->context, f, &out_of_memory);
    if (!fitted) f->count = f->closing_count = 0;
    return !out_of_memory;
}

void sph__setup_fields(void *argument, size_t begin, size_t end)
{
    sph__setup *s = argument;
    const sph_context *context = s->skin->context;
    const size_t most = (size_t)CANDIDATES_PER_SAMPLE * s->options->sample_count;
    for (size_t b = begin; b < end; ++b) {
        sph__field *f = s->implicit->fields + b;
        part *p;
        if (s->starts[b + 1] == s->starts[b]) continue;
        p = sph__zalloc(context, 1, sizeof *p);
        f->samples = sph__alloc(context, s->options->sample_count + (size_t)ENDS_LIMIT, 3 * sizeof *f->samples);
        f->normals = sph__alloc(context, s->options->sample_count + (size_t)ENDS_LIMIT, 3 * sizeof *f->normals);
        if (p != NULL) {
            p->setup = s;
            p->bone = (uint32_t)b;
            p->points = sph__alloc(context, most, 3 * sizeof *p->points);
            p->normals = sph__alloc(context, most, 3 * sizeof *p->normals);
            p->nearest = sph__alloc(context, most, sizeof *p->nearest);
        }
        if (p == NULL || f->samples == NULL || f->normals == NULL || p->points == NULL || p->normals == NULL ||
            p->nearest == NULL || !fit_part(p))
            __atomic_store_n(&s->out_of_memory, true, __ATOMIC_RELAXED);
        if (p != NULL) {
            sph__free(context, p->points);
            sph__free(context, p->normals);
            sph__free(context, p->nearest);
        }
        sph__free(context, p);
    }
}
