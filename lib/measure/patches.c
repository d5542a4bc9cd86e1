/* SPDX-License-Identifier: MIT */
/*
 * The boundary of a union of primitives is part of the spheres, the sides of the capsules and the faces of the thick
 * triangles. Points are spread over all of these evenly by area; what is left of them after those within other
 * primitives are dropped is spread evenly over the boundary.
 */
#include "measure/measure.h"

#include "numeric/vector.h"

static const double PI = 3.14159265358979323846;
static const double GOLDEN = 0.61803398874989484820;

enum { MOST_NEAR = 64, GATHER_FROM = 16 /* points */ };

typedef struct patch {
    int kind; /* 0 sphere, 1 side of a capsule, 2 face */
    double area;
    const double *center;   /* sphere */
    double radius;          /* sphere */
    sph__primitive capsule; /* side */
    double corners[3][3];   /* face */
    double normal[3];       /* face */
} patch;

static uint32_t patch_count(const sph__solid *solid)
{
    return solid->sphere_count + solid->edge_count + 2 * solid->triangle_count;
}

static void set_side(const sph__solid *solid, uint32_t edge, patch *p)
{
    const uint32_t *ends = solid->edges[edge];
    const sph__primitive_edge *e = &p->capsule.edge[0];
    double centers[2][3], radii[2] = {solid->radii[ends[0]], solid->radii[ends[1]]};
    sph__copy3(solid->centers[ends[0]], centers[0]);
    sph__copy3(solid->centers[ends[1]], centers[1]);
    sph__primitive_set(&p->capsule, 2, (const double(*)[3])centers, radii);
    p->kind = 1;
    p->area = e->only >= 0 ? 0 : PI * (radii[0] + radii[1]) * e->length * e->cosine * e->cosine;
}

static void set_face(const sph__solid *solid, uint32_t face, patch *p)
{
    const sph__primitive *triangle = &solid->primitives[face / 2]; /* the triangles come first */
    double u[3], v[3], n[3];
    p->kind = 2;
    p->area = 0;
    if (!triangle->has_faces) return;
    sph__primitive_face(triangle, face % 2 == 0 ? 1 : -1, p->corners, p->normal);
    sph__subtract(p->corners[1], p->corners[0], u);
    sph__subtract(p->corners[2], p->corners[0], v);
    sph__cross(u, v, n);
    p->area = 0.5 * sph__norm(n);
}

static void set_patch(const sph__solid *solid, uint32_t index, patch *p)
{
    if (index < solid->sphere_count) {
        p->kind = 0;
        p->center = solid->centers[index];
        p->radius = solid->radii[index];
        p->area = 4 * PI * p->radius * p->radius;
        return;
    }
    index -= solid->sphere_count;
    if (index < solid->edge_count)
        set_side(solid, index, p);
    else
        set_face(solid, index - solid->edge_count, p);
}

double sph__patches_area(const sph__solid *solid)
{
    const uint32_t count = patch_count(solid);
    double sum = 0;
    patch p;
    for (uint32_t i = 0; i < count; ++i) {
        set_patch(solid, i, &p);
        sum += p.area;
    }
    return sum;
}

static void sphere_point(const patch *p, double u, double v, sph__surface_point *out)
{
    const double z = 1 - 2 * u, r = sqrt(fmax(0, (1 - z) * (1 + z)));
    out->normal[0] = r * cos(2 * PI * v);
    out->normal[1] = r * sin(2 * PI * v);
    out->normal[2] = z;
    sph__add_scaled(p->center, p->radius, out->normal, out->position);
}

/* Circles grow along the side as the radius does, so by area the squared radius is even. */
static void side_point(const patch *p, double u, double v, sph__surface_point *out)
{
    const sph__primitive *c = &p->capsule;
    const sph__primitive_edge *e = &c->edge[0];
    const double r0 = c->radius[0], r1 = c->radius[1];
    const double radius = sqrt(r0 * r0 + u * (r1 - r0) * (r1 + r0));
    const double along = u * (r0 + r1) / (r0 + radius) * e->length;
    double a[3], b[3];
    sph__perpendicular(e->axis, a);
    sph__cross(e->axis, a, b);
    for (int k = 0; k < 3; ++k)
        out->normal[k] = e->sine * e->axis[k] + e->cosine * (cos(2 * PI * v) * a[k] + sin(2 * PI * v) * b[k]);
    sph__add_scaled(c->center[0], along, e->axis, out->position);
    sph__add_scaled(out->position, radius, out->normal, out->position);
}

static void face_point(const patch *p, double u, double v, sph__surface_point *out)
{
    const double root = sqrt(u);
    for (int k = 0; k < 3; ++k)
        out->position[k] = (1 - root) * p->corners[0][k] + root * ((1 - v) * p->corners[1][k] + v * p->corners[2][k]);
    sph__copy3(p->normal, out->normal);
}

static void patch_point(const sph__outer *outer, const patch *p, double u, double v, sph__surface_point *out)
{
    if (p->kind == 0)
        sphere_point(p, u, v, out);
    else if (p->kind == 1)
        side_point(p, u, v, out);
    else
        face_point(p, u, v, out);
    sph__add_scaled(out->position, outer->lift, out->normal, out->position);
}

/* A walk over `count` points of all patches. */
typedef struct walk {
    const sph__outer *outer;
    uint32_t next, count; /* point */
    uint32_t patch_index;
    double step, shift[2]; /* area of one point; where they start */
    double before;         /* area of the patches before this one */
    patch current;
    uint32_t cover;           /* the primitive that covered the last point that was covered */
    uint32_t near[MOST_NEAR]; /* primitives around the patch, where they have been gathered */
    uint32_t near_count;      /* 0: not gathered, or too many */
} walk;

/* A ball that holds the patch. */
static double patch_ball(const patch *p, double center[3])
{
    double radius = 0;
    if (p->kind == 0) {
        sph__copy3(p->center, center);
        return p->radius;
    }
    if (p->kind == 1) {
        const sph__primitive *c = &p->capsule;
        for (int k = 0; k < 3; ++k)
            center[k] = 0.5 * (c->center[0][k] + c->center[1][k]);
        return 0.5 * c->edge[0].length + fmax(c->radius[0], c->radius[1]);
    }
    for (int k = 0; k < 3; ++k)
        center[k] = (p->corners[0][k] + p->corners[1][k] + p->corners[2][k]) / 3;
    for (int i = 0; i < 3; ++i)
        radius = fmax(radius, sph__distance(p->corners[i], center));
    return radius;
}

/* Where the patch will have many points, it pays to know the primitives that may cover them. */
static void gather_near(walk *w)
{
    double center[3], radius;
    w->near_count = 0;
    if (w->current.area < GATHER_FROM * w->step) return;
    radius = patch_ball(&w->current, center) + 2 * w->outer->lift;
    w->near_count = sph__solid_gather(&w->outer->solid, center, radius, w->near, MOST_NEAR);
    if (w->near_count > MOST_NEAR) w->near_count = 0;
}

static void walk_begin(walk *w, const sph__outer *outer, double area, uint32_t count, const double shift[2])
{
    memset(w, 0, sizeof *w);
    w->outer = outer;
    w->count = count;
    w->step = area / count;
    w->shift[0] = shift[0];
    w->shift[1] = shift[1];
    set_patch(&outer->solid, 0, &w->current);
    gather_near(w);
}

static bool is_covered(walk *w, const double x[3])
{
    const sph__solid *solid = &w->outer->solid;
    if (sph__primitive_distance(&solid->primitives[w->cover], x) < 0) return true;
    if (w->near_count == 0) return sph__solid_covers(solid, x, 0, &w->cover);
    for (uint32_t i = 0; i < w->near_count; ++i) {
        if (sph__primitive_distance(&solid->primitives[w->near[i]], x) >= 0) continue;
        w->cover = w->near[i];
        return true;
    }
    return false;
}

/* The next point that nothing covers; false at the end. */
static bool walk_next(walk *w, sph__surface_point *point)
{
    const sph__solid *solid = &w->outer->solid;
    while (w->next < w->count) {
        const double target = (w->next + w->shift[0]) * w->step;
        double v = w->shift[1] + w->next * GOLDEN;
        if (target >= w->before + w->current.area) {
            w->before += w->current.area;
            if (++w->patch_index >= patch_count(solid)) return false; /* rounding: the last point falls off */
            set_patch(solid, w->patch_index, &w->current);
            gather_near(w);
            continue;
        }
        ++w->next;
        v -= floor(v);
        patch_point(w->outer, &w->current, (target - w->before) / w->current.area, v, point);
        point->kind = SPH__POINT_SPREAD;
        if (!is_covered(w, point->position)) return true;
    }
    return false;
}

uint32_t sph__patches_count(const sph__outer *outer, double area, uint32_t count)
{
    static const double SHIFT[2] = {0.5, 0.5};
    sph__surface_point point;
    uint32_t kept = 0;
    walk w;
    walk_begin(&w, outer, area, count, SHIFT);
    while (walk_next(&w, &point))
        ++kept;
    return kept;
}

static bool add_point(sph__outer *outer, const sph__surface_point *point)
{
    if (!sph__reserve(outer->context, (void **)&outer->points, &outer->point_capacity, (size_t)outer->point_count + 1,
                      sizeof *point))
        return false;
    outer->points[outer->point_count++] = *point;
    return true;
}

bool sph__patches_sample(sph__outer *outer, double area, uint32_t count, const double shift[2])
{
    sph__surface_point point;
    walk w;
    walk_begin(&w, outer, area, count, shift);
    while (walk_next(&w, &point))
        if (!add_point(outer, &point)) return false;
    return true;
}

/* `sums` holds for every sphere the unit vectors from its neighbours, added up. */
static void add_directions(const sph__solid *solid, double (*sums)[3])
{
    for (uint32_t i = 0; i < solid->edge_count; ++i) {
        const uint32_t a = solid->edges[i][0], b = solid->edges[i][1];
        double d[3], length;
        sph__subtract(solid->centers[a], solid->centers[b], d);
        length = sph__norm(d);
        if (length <= 0) continue;
        sph__add_scaled(sums[a], 1 / length, d, sums[a]);
        sph__add_scaled(sums[b], -1 / length, d, sums[b]);
    }
}

bool sph__patches_extremes(sph__outer *outer)
{
    const sph__solid *solid = &outer->solid;
    double(*sums)[3] = sph__zalloc(outer->context, solid->sphere_count, sizeof *sums);
    bool done = sums != NULL;
    if (done) add_directions(solid, sums);
    for (uint32_t i = 0; done && i < solid->sphere_count; ++i) {
        const double length = sph__norm(sums[i]);
        sph__surface_point point = {{0, 0, 0}, {0, 0, 1}, SPH__POINT_EXTREME};
        if (length > 1e-6)
            for (int k = 0; k < 3; ++k)
                point.normal[k] = sums[i][k] / length;
        sph__add_scaled(solid->centers[i], solid->radii[i] + outer->lift, point.normal, point.position);
        if (!sph__solid_covers(solid, point.position, 0, NULL)) done = add_point(outer, &point);
    }
    sph__free(outer->context, sums);
    return done;
}
