/* SPDX-License-Identifier: MIT */
#include "figure.h"

#include <math.h>
#include <string.h>

static const double SPHERE[3] = {0.62, 0.035, 0.025}, EDGE[3] = {0.86, 0.56, 0.03}, TRIANGLE[3] = {0.06, 0.17, 0.62};
static const double MESH[3] = {0.50, 0.47, 0.42};

sph_status figure_of_level(figure *f, sph_context *context, const sph_level *level, double line)
{
    sph_level_arrays a = {.struct_size = sizeof a};
    sph_status status = sph_level_get_arrays(level, &a);
    const size_t count = (size_t)a.sphere_count * (a.radii_per_frame ? a.frame_count : 1);
    float *radii;
    *f = (figure){.pen = line};
    if (status != SPH_OK) return status;
    radii = sph_context_allocate(context, count, sizeof *radii);
    if (radii == NULL) return sph_context_fail(context, SPH_E_NOMEM, "out of memory");
    for (size_t i = 0; i < count; ++i)
        radii[i] = a.radii[i] > (float)line ? a.radii[i] : (float)line;
    a.radii = radii;
    f->frame_count = a.frame_count;
    status = sph_level_create_from_arrays(context, &a, &f->level);
    sph_context_release(context, radii);
    return status == SPH_OK ? sph_query_create(f->level, NULL, &f->query) : status;
}

/* One frame of the mesh, whose wires are as thick as a line. */
static sph_status make_query(figure *f, sph_context *context, float *radii, double line)
{
    const uint32_t *edges = sph_animation_edges(f->animation);
    sph_level_arrays a = {.struct_size = sizeof a,
                          .sphere_count = sph_animation_vertex_count(f->animation),
                          .frame_count = 1,
                          .centers = f->positions,
                          .radii = radii,
                          .edge_count = sph_animation_edge_count(f->animation),
                          .edges = edges,
                          .triangle_count = sph_animation_triangle_count(f->animation),
                          .triangles = sph_animation_triangles(f->animation)};
    sph_status status;
    memset(radii, 0, a.sphere_count * sizeof *radii);
    for (size_t i = 0; i < 2 * a.edge_count; ++i)
        radii[edges[i]] = (float)line;
    status = sph_level_create_from_arrays(context, &a, &f->level);
    return status == SPH_OK ? sph_query_create(f->level, NULL, &f->query) : status;
}

sph_status figure_of_animation(figure *f, sph_context *context, sph_animation *animation, double line)
{
    const uint32_t n = sph_animation_vertex_count(animation);
    float *radii = sph_context_allocate(context, n, sizeof *radii);
    sph_status status = SPH_OK;
    *f = (figure){.animation = animation, .frame_count = sph_animation_frame_count(animation)};
    f->positions = sph_context_allocate(context, n, 3 * sizeof *f->positions);
    f->normals = sph_context_allocate(context, n, 3 * sizeof *f->normals);
    if (radii == NULL || f->positions == NULL || f->normals == NULL)
        status = sph_context_fail(context, SPH_E_NOMEM, "out of memory");
    if (status == SPH_OK) status = sph_animation_read_frame(animation, 0, f->positions);
    if (status == SPH_OK) status = make_query(f, context, radii, line);
    sph_context_release(context, radii);
    return status;
}

void figure_close(figure *f, sph_context *context)
{
    sph_query_destroy(f->query);
    sph_level_destroy(f->level);
    sph_animation_destroy(f->animation);
    sph_context_release(context, f->positions);
    sph_context_release(context, f->normals);
    sph_context_release(context, f->colours);
    *f = (figure){0};
}

/* Of the triangle a b c, as long as twice its area. */
static void face_normal(const float *xyz, const uint32_t t[3], double n[3])
{
    double u[3], v[3];
    for (int k = 0; k < 3; ++k) {
        u[k] = (double)xyz[3 * (size_t)t[1] + (size_t)k] - xyz[3 * (size_t)t[0] + (size_t)k];
        v[k] = (double)xyz[3 * (size_t)t[2] + (size_t)k] - xyz[3 * (size_t)t[0] + (size_t)k];
    }
    for (int k = 0; k < 3; ++k)
        n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
}

static void set_normals(figure *f)
{
    const uint32_t *triangles = sph_animation_triangles(f->animation);
    memset(f->normals, 0, (size_t)sph_animation_vertex_count(f->animation) * 3 * sizeof *f->normals);
    for (size_t i = 0; i < sph_animation_triangle_count(f->animation); ++i) {
        double n[3];
        face_normal(f->positions, triangles + 3 * i, n);
        for (size_t k = 0; k < 9; ++k)
            f->normals[3 * (size_t)triangles[3 * i + k / 3] + k % 3] += (float)n[k % 3];
    }
}

sph_status figure_pose(figure *f, uint32_t frame)
{
    sph_level_arrays a = {.struct_size = sizeof a};
    sph_status status;
    if (f->animation != NULL) {
        status = sph_animation_read_frame(f->animation, frame, f->positions);
        if (status != SPH_OK) return status;
        set_normals(f);
        f->centers = f->positions;
        return sph_query_pose_centers(f->query, f->positions, 0, NULL);
    }
    status = sph_level_get_arrays(f->level, &a);
    if (status != SPH_OK) return status;
    f->centers = a.centers + (size_t)frame * a.sphere_count * 3;
    f->radii = a.radii + (a.radii_per_frame ? (size_t)frame * a.sphere_count : 0);
    return sph_query_pose_frame(f->query, frame);
}

static double normalize(double x[3])
{
    const double length = sqrt(dot(x, x));
    for (int k = 0; k < 3 && length > 0; ++k)
        x[k] /= length;
    return length;
}

static void face_eye(double n[3], const double direction[3])
{
    if (dot(n, direction) <= 0) return;
    for (int k = 0; k < 3; ++k)
        n[k] = -n[k];
}

/* Interpolated from the vertices: smooth, and on the side of the triangle that is seen. */
static void mesh_normal(const figure *f, const sph_contact *c, const double direction[3], double n[3])
{
    double face[3], smooth[3] = {0, 0, 0};
    if (c->kind != SPH_SIMPLEX_TRIANGLE) return;
    face_normal(f->positions, c->spheres, face);
    if (!(normalize(face) > 0)) return;
    face_eye(face, direction);
    memcpy(n, face, sizeof face);
    for (int i = 0; i < 3; ++i)
        for (size_t k = 0; k < 3; ++k)
            smooth[k] += c->weights[i] * f->normals[3 * (size_t)c->spheres[i] + k];
    if (!(normalize(smooth) > 0)) return;
    if (dot(smooth, face) < 0)
        for (int k = 0; k < 3; ++k)
            smooth[k] = -smooth[k];
    if (dot(smooth, face) > 0.5) memcpy(n, smooth, sizeof smooth); /* else neighbours are wound both ways */
}

static double sphere_distance(const figure *f, uint32_t i, const double x[3])
{
    double sum = 0;
    for (size_t k = 0; k < 3; ++k)
        sum += (x[k] - f->centers[3 * (size_t)i + k]) * (x[k] - f->centers[3 * (size_t)i + k]);
    return sqrt(sum) - f->radii[i];
}

/* From x to the tapered capsule over two spheres. */
static double edge_distance(const figure *f, uint32_t i, uint32_t j, const double x[3])
{
    const double ends = fmin(sphere_distance(f, i, x), sphere_distance(f, j, x));
    double a[3], v[3], length, along, across, sine, cosine, m;
    for (size_t k = 0; k < 3; ++k) {
        a[k] = (double)f->centers[3 * (size_t)j + k] - f->centers[3 * (size_t)i + k];
        v[k] = x[k] - f->centers[3 * (size_t)i + k];
    }
    length = normalize(a);
    sine = length > 0 ? ((double)f->radii[i] - f->radii[j]) / length : 1;
    if (fabs(sine) >= 1) return ends;
    cosine = sqrt(1 - sine * sine);
    along = dot(v, a);
    across = sqrt(fmax(0, dot(v, v) - along * along));
    m = along - across * sine / cosine; /* the foot, so that x lies across the side and not across the axis */
    if (m <= 0 || m >= length) return ends;
    return along * sine + across * cosine - f->radii[i];
}

static const double *level_colour(const figure *f, const sph_contact *c)
{
    if (c->kind == SPH_SIMPLEX_SPHERE) return SPHERE;
    for (int i = 0; i < 3; ++i)
        if (c->spheres[i] != SPH_NO_SPHERE && sphere_distance(f, c->spheres[i], c->point) < f->pen) return SPHERE;
    if (c->kind == SPH_SIMPLEX_EDGE) return EDGE;
    for (int i = 0; i < 3; ++i)
        if (edge_distance(f, c->spheres[i], c->spheres[(i + 1) % 3], c->point) < 0.5 * f->pen) return EDGE;
    return TRIANGLE;
}

static void mix_colours(const figure *f, const sph_contact *c, double colour[3])
{
    memset(colour, 0, 3 * sizeof *colour);
    for (int i = 0; i < 3; ++i)
        for (size_t k = 0; k < 3 && c->spheres[i] != SPH_NO_SPHERE; ++k)
            colour[k] += c->weights[i] * f->colours[3 * (size_t)c->spheres[i] + k];
}

void figure_look(const figure *f, const sph_hit *hit, const double direction[3], figure_place *place)
{
    memcpy(place->normal, hit->contact.normal, sizeof place->normal);
    if (f->animation != NULL) mesh_normal(f, &hit->contact, direction, place->normal);
    if (f->animation == NULL) face_eye(place->normal, direction);
    if (f->colours != NULL)
        mix_colours(f, &hit->contact, place->colour);
    else
        memcpy(place->colour, f->animation != NULL ? MESH : level_colour(f, &hit->contact), sizeof place->colour);
}
