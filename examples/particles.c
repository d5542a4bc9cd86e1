/* SPDX-License-Identifier: MIT */
/*
 * Particles fall on an animated sphere-mesh, on a mesh of as many vertices simplified by quadric error metrics, and on
 * the input itself: figure 8 of the paper. Counts those that get into the input though their collider should have kept
 * them out, and measures how rough the normals are that they bounce off.
 *
 *     particles LEVEL QEM-LEVEL MESH CACHE [STRIP.png]
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "particles.h"

enum { PARTICLES = 1000, COLLIDERS = 3, COLUMNS = 3, STEPS_MOST = 1000, CONTACTS_MOST = 4 };

static const double RADIUS = 0.01;    /* of a particle; lengths are in diagonals of the mean bounding box */
static const double TOLERANCE = 0.02; /* so deep inside the input a particle has leaked */
static const double TWIN = 0.005;     /* between neighbours whose normals are compared */
static const double RESTITUTION = 0.5, GRIP = 0.1; /* shares of the speed that is kept along the normal, lost across */

typedef struct tally {
    uint32_t bounces, leaks, twins;
    double twin_squares, tilt; /* sums of squared angles between neighbours; of angles to the input's normal */
} tally;

typedef struct world {
    sph_context *context;
    collider colliders[COLLIDERS]; /* the last one is the input */
    particle *particles[COLLIDERS];
    tally tallies[COLLIDERS];
    uint32_t frames;
    double low[3], high[3], diagonal; /* mean box */
    double now, step;                 /* time in frames */
} world;

/* The base-b digits of i, mirrored at the point: evenly spread, and always the same. */
static double spread(uint32_t i, uint32_t b)
{
    double value = 0, place = 1;
    for (; i > 0; i /= b) {
        place /= b;
        value += place * (i % b);
    }
    return value;
}

static void measure_box(world *w)
{
    const sph_level_arrays *a = &w->colliders[COLLIDERS - 1].parts;
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
        for (uint32_t f = 0; f < w->frames; ++f) {
            const float *xyz = a->centers + 3 * (size_t)f * a->sphere_count + k;
            double low = INFINITY, high = -INFINITY;
            for (uint32_t i = 0; i < a->sphere_count; ++i) {
                low = fmin(low, xyz[3 * (size_t)i]);
                high = fmax(high, xyz[3 * (size_t)i]);
            }
            w->low[k] += low / w->frames;
            w->high[k] += high / w->frames;
        }
        sum += (w->high[k] - w->low[k]) * (w->high[k] - w->low[k]);
    }
    w->diagonal = sqrt(sum);
}

/* A shower during the first half of the time, over the whole box. */
static void let_rain(world *w, particle *particles)
{
    for (uint32_t i = 0; i < PARTICLES; ++i) {
        particle *p = &particles[i];
        *p = (particle){.born = 0.5 * (w->frames - 1) * i / PARTICLES};
        p->place[0] = w->low[0] + (w->high[0] - w->low[0]) * spread(i + 1, 2);
        p->place[1] = w->high[1] + 0.2 * w->diagonal;
        p->place[2] = w->low[2] + (w->high[2] - w->low[2]) * spread(i + 1, 3);
    }
}

static double center_at(const collider *c, uint32_t sphere, int k, double time)
{
    const uint32_t f = (uint32_t)time, next = f + 1 < c->parts.frame_count ? f + 1 : f;
    const float *a = c->parts.centers + 3 * ((size_t)f * c->parts.sphere_count + sphere) + k;
    const float *b = c->parts.centers + 3 * ((size_t)next * c->parts.sphere_count + sphere) + k;
    return *a + (time - f) * ((double)*b - *a);
}

/* How fast the surface moves at a contact, per frame: the interpolated sphere that touches there takes it along. */
static void surface_velocity(const world *w, const collider *c, const sph_contact *at, double velocity[3])
{
    for (int k = 0; k < 3; ++k) {
        velocity[k] = 0;
        for (int i = 0; i < 3; ++i)
            if (at->weights[i] > 0)
                velocity[k] +=
                    at->weights[i] *
                    (center_at(c, at->spheres[i], k, w->now) - center_at(c, at->spheres[i], k, w->now - w->step)) /
                    w->step;
    }
}

/* Steps per frame, so that no surface moves by more than half a particle's radius in one. */
static sph_status count_steps(const world *w, uint32_t *steps)
{
    double most = 0;
    for (int i = 0; i < COLLIDERS; ++i) {
        const sph_level_arrays *a = &w->colliders[i].parts;
        for (size_t j = a->sphere_count; j < (size_t)a->sphere_count * a->frame_count; ++j) {
            const size_t before = j - a->sphere_count;
            double sum = 0, swell = 0;
            for (size_t k = 0; k < 3; ++k) {
                const double way = (double)a->centers[3 * j + k] - a->centers[3 * before + k];
                sum += way * way;
            }
            if (a->radii_per_frame) swell = fabs((double)a->radii[j] - a->radii[before]);
            most = fmax(most, sqrt(sum) + swell);
        }
    }
    most = ceil(most / (0.5 * RADIUS * w->diagonal));
    if (!(most <= STEPS_MOST))
        return sph_context_fail(w->context, SPH_E_LIMIT, "the surface moves too far from one frame to the next");
    *steps = most < 1 ? 1 : (uint32_t)most;
    return SPH_OK;
}

static sph_sweep sweep(const double from[3], const double to[3], double radius)
{
    sph_sweep s = {.radius = (float)radius};
    for (int k = 0; k < 3; ++k) {
        s.from[k] = (float)from[k];
        s.to[k] = (float)to[k];
    }
    return s;
}

static double angle(const double a[3], const double b[3])
{
    return acos(fmax(-1, fmin(1, dot(a, b)))) * 180 / M_PI;
}

/* Compares the normal with that of a neighbour that moves alongside, and with the input's where that is nearest. */
static sph_status study_normal(world *w, int i, const sph_sweep *move, const sph_hit *hit)
{
    const collider *input = &w->colliders[COLLIDERS - 1];
    tally *t = &w->tallies[i];
    const double *n = hit->contact.normal, away = TWIN * w->diagonal;
    const int k = fabs(n[0]) < 0.6 ? 0 : 1;
    double side[3] = {0, 0, 0}, gap = 0, length, u[3], v[3], face[3];
    float point[3];
    sph_sweep twin = *move;
    sph_hit other;
    sph_nearest nearest;
    sph_status status;
    for (int j = 0; j < 3; ++j)
        side[j] = (j == k) - n[k] * n[j];
    length = sqrt(dot(side, side));
    for (int j = 0; j < 3; ++j) {
        twin.from[j] += (float)(away / length * side[j]);
        twin.to[j] += (float)(away / length * side[j]) - (float)(away * n[j]); /* further, as it may lie deeper */
        point[j] = (float)hit->contact.point[j];
    }
    status = sph_query_cast(w->colliders[i].query, &twin, 1, &other);
    if (status == SPH_OK) status = sph_query_nearest(input->query, point, 0, 1, &nearest);
    if (status != SPH_OK) return status;
    for (int j = 0; j < 3; ++j)
        gap = fmax(gap, fabs(other.contact.point[j] - hit->contact.point[j]));
    if (other.hit && gap < 4 * away) {
        t->twin_squares += angle(n, other.contact.normal) * angle(n, other.contact.normal);
        ++t->twins;
    }
    for (int j = 0; j < 3; ++j) {
        const double a = center_at(input, nearest.contact.spheres[0], j, w->now);
        u[j] = center_at(input, nearest.contact.spheres[1], j, w->now) - a;
        v[j] = center_at(input, nearest.contact.spheres[2], j, w->now) - a;
    }
    for (int j = 0; j < 3; ++j)
        face[j] = u[(j + 1) % 3] * v[(j + 2) % 3] - u[(j + 2) % 3] * v[(j + 1) % 3];
    length = sqrt(dot(face, face));
    for (int j = 0; j < 3 && length > 0; ++j)
        face[j] /= length;
    t->tilt += angle(n, face);
    return SPH_OK;
}

/* Turns the velocity, relative to the surface, where it points into it; true where it did. */
static bool bounce(const world *w, const collider *c, const sph_contact *at, particle *p)
{
    double surface[3], relative[3], into;
    surface_velocity(w, c, at, surface);
    for (int k = 0; k < 3; ++k)
        relative[k] = p->velocity[k] - surface[k];
    into = dot(relative, at->normal);
    if (into >= 0) return false;
    for (int k = 0; k < 3; ++k) {
        const double along = into * at->normal[k], across = relative[k] - along;
        p->velocity[k] = surface[k] + (1 - GRIP) * across - RESTITUTION * along;
    }
    if (p->state == FALLING) p->state = BOUNCED;
    return true;
}

/* Out along the normal of a surface that has moved into the particle; not with its centre through another one. */
static sph_status push_out(const world *w, const collider *c, const sph_hit *hit, particle *p)
{
    const double way = hit->depth + 1e-3 * RADIUS * w->diagonal;
    double to[3], share = 1;
    sph_sweep ray;
    sph_hit wall;
    sph_status status;
    for (int k = 0; k < 3; ++k)
        to[k] = p->place[k] + way * hit->contact.normal[k];
    ray = sweep(p->place, to, 0);
    status = sph_query_cast(c->query, &ray, 1, &wall);
    if (status == SPH_OK && wall.hit && wall.depth == 0 && wall.s > 0) share = 0.5 * wall.s;
    for (int k = 0; k < 3; ++k)
        p->place[k] += share * way * hit->contact.normal[k];
    return status;
}

/*
 * One step of one particle. The collider is posed at the end of the step: as its surface has come no further than half
 * a radius, the particle's centre is still on the side where it was, and starting in contact tells how deep and which
 * way.
 */
static sph_status move(world *w, int i, particle *p)
{
    const collider *c = &w->colliders[i];
    const double radius = RADIUS * w->diagonal, pull = 8 * w->diagonal / w->frames / w->frames;
    double left = w->step;
    p->velocity[1] -= pull * w->step;
    for (int contacts = 0; contacts < CONTACTS_MOST && left > 0; ++contacts) {
        double to[3];
        sph_sweep s;
        sph_hit hit;
        sph_status status;
        for (int k = 0; k < 3; ++k)
            to[k] = p->place[k] + left * p->velocity[k];
        s = sweep(p->place, to, radius);
        status = sph_query_cast(c->query, &s, 1, &hit);
        if (status != SPH_OK) return status;
        for (int k = 0; k < 3; ++k)
            p->place[k] += hit.s * (to[k] - p->place[k]);
        if (!hit.hit) return SPH_OK;
        left *= 1 - hit.s;
        if (bounce(w, c, &hit.contact, p)) {
            ++w->tallies[i].bounces;
            if (hit.depth == 0) status = study_normal(w, i, &s, &hit);
        }
        if (status == SPH_OK) status = push_out(w, c, &hit, p);
        if (status != SPH_OK) return status;
    }
    return SPH_OK;
}

/* Who has come into the input since the last frame? */
static sph_status count_leaks(world *w, int i)
{
    const sph_query *input = w->colliders[COLLIDERS - 1].query;
    for (uint32_t j = 0; j < PARTICLES; ++j) {
        particle *p = &w->particles[i][j];
        const float place[3] = {(float)p->place[0], (float)p->place[1], (float)p->place[2]};
        sph_nearest nearest;
        uint8_t inside;
        sph_status status = sph_query_nearest(input, place, 0, 1, &nearest);
        if (status == SPH_OK) status = sph_query_contains(input, place, 0, 1, SPH_CAVITY_SOLID, &inside);
        if (status != SPH_OK) return status;
        inside = inside && nearest.distance > TOLERANCE * w->diagonal;
        if (inside && !p->is_inside) {
            ++w->tallies[i].leaks;
            p->state = LEAKED;
        }
        p->is_inside = inside;
    }
    return SPH_OK;
}

static sph_status step_all(world *w)
{
    sph_status status = SPH_OK;
    for (int i = 0; i < COLLIDERS && status == SPH_OK; ++i)
        status = sph_query_pose_time(w->colliders[i].query, w->now);
    for (int i = 0; i < COLLIDERS && status == SPH_OK; ++i)
        for (uint32_t j = 0; j < PARTICLES && status == SPH_OK; ++j)
            if (w->particles[i][j].born < w->now) status = move(w, i, &w->particles[i][j]);
    return status;
}

static sph_status draw_all(world *w, strip *s, uint32_t column, uint32_t frame)
{
    sph_status status = SPH_OK;
    for (int i = 0; i < COLLIDERS && status == SPH_OK; ++i)
        status = strip_draw(s, column, (uint32_t)i, w->context, &w->colliders[i], frame, w->particles[i], PARTICLES,
                            (float)(RADIUS * w->diagonal), w->low, w->high);
    return status;
}

static sph_status simulate(world *w, strip *s)
{
    static const double MOMENTS[COLUMNS] = {0.4, 0.6, 0.8};
    uint32_t column = 0, steps = 1;
    sph_status status = count_steps(w, &steps);
    w->step = 1.0 / steps;
    if (status == SPH_OK) printf("%u particles, %u frames, %u steps per frame\n", PARTICLES, w->frames, steps);
    for (uint32_t f = 1; f < w->frames && status == SPH_OK; ++f) {
        for (uint32_t k = 1; k <= steps && status == SPH_OK; ++k) {
            w->now = f - 1 + (double)k / steps;
            status = step_all(w);
        }
        for (int i = 0; i < COLLIDERS && status == SPH_OK; ++i)
            status = count_leaks(w, i);
        if (status != SPH_OK || column == COLUMNS || f < MOMENTS[column] * (w->frames - 1)) continue;
        status = draw_all(w, s, column++, f);
    }
    return status;
}

static void tell(const world *w)
{
    printf("%-12s %8s %8s %8s %10s %8s\n", "collider", "vertices", "bounces", "leaks", "roughness", "tilt");
    for (int i = 0; i < COLLIDERS; ++i) {
        const tally *t = &w->tallies[i];
        printf("%-12s %8u %8u %8u %10.2f %8.2f\n", w->colliders[i].name, w->colliders[i].parts.sphere_count, t->bounces,
               t->leaks, sqrt(t->twin_squares / (t->twins > 0 ? t->twins : 1)),
               t->tilt / (t->bounces > 0 ? t->bounces : 1));
    }
    printf("leaks: particles that came into the input, deeper than %.0f %% of its diagonal;\n"
           "roughness: degrees between the normals of neighbours %.1f %% apart, root mean square;\n"
           "tilt: degrees between the normal and that of the input, mean\n",
           100 * TOLERANCE, 100 * TWIN);
}

static sph_status run(world *w, char **argv, strip *s)
{
    sph_status status = collider_open(&w->colliders[0], w->context, "sphere-mesh", argv[1], NULL);
    if (status == SPH_OK) status = collider_open(&w->colliders[1], w->context, "QEM", argv[2], NULL);
    if (status == SPH_OK) status = collider_open(&w->colliders[2], w->context, "input", argv[3], argv[4]);
    if (status != SPH_OK) return status;
    w->frames = w->colliders[2].parts.frame_count;
    for (int i = 0; i < COLLIDERS; ++i)
        if (w->colliders[i].parts.frame_count != w->frames || w->frames < 2)
            return sph_context_fail(w->context, SPH_E_INVALID,
                                    "the files must have the same number of frames, two or more");
    measure_box(w);
    for (int i = 0; i < COLLIDERS; ++i) {
        w->particles[i] = sph_context_allocate(w->context, PARTICLES, sizeof(particle));
        if (w->particles[i] == NULL) return sph_context_fail(w->context, SPH_E_NOMEM, "out of memory");
        let_rain(w, w->particles[i]);
    }
    return simulate(w, s);
}

int main(int argc, char **argv)
{
    world w = {0};
    strip s = {0};
    sph_status status;
    if (argc != 5 && argc != 6) return fprintf(stderr, "usage: particles LEVEL QEM-LEVEL MESH CACHE [STRIP.png]\n"), 2;
    if (!strip_create(&s, argc == 6 ? argv[5] : NULL, COLUMNS, COLLIDERS)) return 1;
    if (sph_context_create(NULL, &w.context) != SPH_OK) return 1;
    status = run(&w, argv, &s);
    if (status != SPH_OK) fprintf(stderr, "particles: %s\n", sph_context_last_message(w.context));
    if (status == SPH_OK) tell(&w);
    if (!strip_finish(&s) && status == SPH_OK) status = SPH_E_IO;
    for (int i = 0; i < COLLIDERS; ++i) {
        sph_context_release(w.context, w.particles[i]);
        collider_close(&w.colliders[i]);
    }
    sph_context_destroy(w.context);
    return status == SPH_OK ? 0 : 1;
}
