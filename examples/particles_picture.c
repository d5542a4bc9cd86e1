/* SPDX-License-Identifier: MIT */
/* The strip of particles.c: a row per collider, a column per moment. Drawn by casting rays at collider and particles.
 */
#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "particles.h"

enum { WIDTH = 190, HEIGHT = 145, SAMPLES = 3, SHADES = 15 /* per colour: few, for small files */ };

static const double SOLID[3] = {0.50, 0.50, 0.50};
static const double STATES[3][3] = {{0.05, 0.16, 0.60}, {0.90, 0.50, 0.03}, {0.75, 0.0, 0.0}};

bool strip_create(strip *s, const char *path, uint32_t columns, uint32_t rows)
{
    *s = (strip){.path = path, .columns = columns, .rows = rows};
    if (path == NULL) return true;
    s->rgb = malloc((size_t)3 * WIDTH * HEIGHT * columns * rows);
    if (s->rgb != NULL) memset(s->rgb, 255, (size_t)3 * WIDTH * HEIGHT * columns * rows);
    return s->rgb != NULL;
}

bool strip_finish(strip *s)
{
    png_image image = {.version = PNG_IMAGE_VERSION, .format = PNG_FORMAT_RGB};
    bool done = s->path == NULL;
    image.width = s->columns * WIDTH;
    image.height = s->rows * HEIGHT;
    if (s->rgb != NULL) {
        done = png_image_write_to_file(&image, s->path, 0, s->rgb, 0, NULL) != 0;
        if (!done) fprintf(stderr, "particles: %s: %s\n", s->path, image.message);
    }
    free(s->rgb);
    s->rgb = NULL;
    return done;
}

/* The particles that are there, as a level of single spheres; `which` is told who they are. NULL where there are none.
 */
static sph_status make_balls(sph_context *context, const particle *particles, uint32_t count, double time, float radius,
                             uint32_t *which, sph_query **out)
{
    float *centers = sph_context_allocate(context, count, 3 * sizeof *centers);
    float *radii = sph_context_allocate(context, count, sizeof *radii);
    sph_level_arrays a = {.struct_size = sizeof a, .frame_count = 1, .centers = centers, .radii = radii};
    sph_level *level = NULL;
    sph_status status = SPH_OK;
    *out = NULL;
    if (centers == NULL || radii == NULL) status = sph_context_fail(context, SPH_E_NOMEM, "out of memory");
    for (uint32_t i = 0; i < count && status == SPH_OK; ++i) {
        if (particles[i].born >= time) continue;
        for (uint32_t k = 0; k < 3; ++k)
            centers[3 * a.sphere_count + k] = (float)particles[i].place[k];
        radii[a.sphere_count] = radius;
        which[a.sphere_count++] = i;
    }
    if (status == SPH_OK && a.sphere_count > 0) status = sph_level_create_from_arrays(context, &a, &level);
    if (level != NULL) status = sph_query_create(level, NULL, out);
    sph_level_destroy(level);
    sph_context_release(context, centers);
    sph_context_release(context, radii);
    return status;
}

/* Towards the eye; that of a sheet of no thickness is its plane's. */
static void normal_of(const collider *c, uint32_t frame, const sph_contact *at, const double back[3], double n[3])
{
    const float *xyz = c->parts.centers + 3 * (size_t)frame * c->parts.sphere_count;
    memcpy(n, at->normal, 3 * sizeof *n);
    if (at->kind == SPH_SIMPLEX_TRIANGLE && c->parts.radii[at->spheres[0]] + c->parts.radii[at->spheres[1]] == 0) {
        double u[3], v[3], length;
        for (int k = 0; k < 3; ++k) {
            u[k] = (double)xyz[3 * (size_t)at->spheres[1] + (size_t)k] - xyz[3 * (size_t)at->spheres[0] + (size_t)k];
            v[k] = (double)xyz[3 * (size_t)at->spheres[2] + (size_t)k] - xyz[3 * (size_t)at->spheres[0] + (size_t)k];
        }
        for (int k = 0; k < 3; ++k)
            n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
        length = sqrt(dot(n, n));
        for (int k = 0; k < 3 && length > 0; ++k)
            n[k] /= length;
    }
    for (int k = 0, turn = dot(n, back) < 0; k < 3 && turn; ++k)
        n[k] = -n[k];
}

static void light(const double n[3], const double colour[3], double sum[3])
{
    const double shine = fmax(0, 0.25 * n[0] + 0.75 * n[1] + 0.60 * n[2]);
    for (int k = 0; k < 3; ++k)
        sum[k] += fmin(1, colour[k] * (0.30 + 0.75 * shine)) / (SAMPLES * SAMPLES);
}

typedef struct view {
    double middle[3], right[3], up[3], back[3], half;
} view;

static sph_sweep ray_through(const view *v, double x, double y)
{
    const double a = v->half * (2 * x / WIDTH - 1), b = v->half * HEIGHT / WIDTH * (1 - 2 * y / HEIGHT);
    sph_sweep s = {.radius = 0};
    for (int k = 0; k < 3; ++k) {
        const double place = v->middle[k] + a * v->right[k] + b * v->up[k];
        s.from[k] = (float)(place + 6 * v->half * v->back[k]);
        s.to[k] = (float)(place - 6 * v->half * v->back[k]);
    }
    return s;
}

/* From the front right and a little above. */
static view look_at(const double low[3], const double high[3])
{
    const double a = 0.6, e = 0.2;
    view v = {.right = {cos(a), 0, -sin(a)},
              .up = {-sin(a) * sin(e), cos(e), -cos(a) * sin(e)},
              .back = {sin(a) * cos(e), sin(e), cos(a) * cos(e)}};
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
        v.middle[k] = (low[k] + high[k]) / 2;
        sum += (high[k] - low[k]) * (high[k] - low[k]);
    }
    v.half = 0.50 * sqrt(sum);
    v.middle[1] -= 0.04 * v.half; /* what is far above has nothing to tell */
    return v;
}

sph_status strip_draw(strip *s, uint32_t column, uint32_t row, sph_context *context, const collider *c, uint32_t frame,
                      const particle *particles, uint32_t count, float radius, const double low[3],
                      const double high[3])
{
    const view v = look_at(low, high);
    uint32_t *which = sph_context_allocate(context, count, sizeof *which);
    sph_query *balls = NULL;
    sph_status status = SPH_OK;
    if (s->rgb == NULL) {
        sph_context_release(context, which);
        return SPH_OK;
    }
    if (which == NULL) return sph_context_fail(context, SPH_E_NOMEM, "out of memory");
    status = make_balls(context, particles, count, frame, radius, which, &balls);
    for (uint32_t i = 0; i < WIDTH * HEIGHT && status == SPH_OK; ++i) {
        const size_t y = row * HEIGHT + i / WIDTH, x = column * WIDTH + i % WIDTH;
        double sum[3] = {0, 0, 0}, n[3];
        for (int j = 0; j < SAMPLES * SAMPLES && status == SPH_OK; ++j) {
            const sph_sweep ray =
                ray_through(&v, i % WIDTH + (j % SAMPLES + 0.5) / SAMPLES, i / WIDTH + (j / SAMPLES + 0.5) / SAMPLES);
            sph_hit solid = {.s = 1}, ball = {.s = 1};
            status = sph_query_cast(c->query, &ray, 1, &solid);
            if (status == SPH_OK && balls != NULL) status = sph_query_cast(balls, &ray, 1, &ball);
            if (ball.hit && (ball.s < solid.s || particles[which[ball.contact.simplex]].state == LEAKED)) {
                light(ball.contact.normal, STATES[particles[which[ball.contact.simplex]].state], sum);
            } else if (solid.hit) {
                normal_of(c, frame, &solid.contact, v.back, n);
                light(n, SOLID, sum);
            } else {
                for (int k = 0; k < 3; ++k)
                    sum[k] += 1.0 / (SAMPLES * SAMPLES);
            }
        }
        for (size_t k = 0; k < 3; ++k) {
            const double shade = round(SHADES * pow(fmin(1, sum[k]), 1 / 2.2));
            s->rgb[3 * (y * s->columns * WIDTH + x) + k] = (unsigned char)lround(255 * shade / SHADES);
        }
    }
    sph_query_destroy(balls);
    sph_context_release(context, which);
    return status;
}
