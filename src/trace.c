/* SPDX-License-Identifier: MIT */
/* From rays to colours: light from the upper left and from the sky, with their shadows. */
#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "picture.h"

enum { SAMPLES_MOST = 8, RAYS = SAMPLES_MOST * SAMPLES_MOST, SHADOWS = 3 };

static const double GLASS[3] = {0.12, 0.18, 0.24};

/* One ray through a pixel, and what comes of it. */
typedef struct sample {
    double point[3], normal[3], colour[3], direction[3];
    bool is_object, is_ground;
    double key, sky; /* how much of these lights arrives */
} sample;

typedef struct pixel {
    const tile *tile;
    uint32_t count;
    sph_sweep rays[RAYS], shadow_rays[RAYS * SHADOWS];
    sph_hit hits[RAYS], overlay_hits[RAYS];
    uint8_t shadows[RAYS * SHADOWS];
    sample samples[RAYS];
} pixel;

typedef struct job {
    picture *picture;
    const tile *tile;
    uint32_t first_row;
    atomic_int status;
} job;

/* The sequence of van der Corput in that base: spreads over [0, 1). */
static double spread(uint32_t i, uint32_t base)
{
    double value = 0, place = 1;
    for (; i > 0; i /= base) {
        place /= base;
        value += place * (i % base);
    }
    return value;
}

static void to_light(const camera *c, double light[3])
{
    for (int k = 0; k < 3; ++k)
        light[k] = -0.40 * c->right[k] + 0.72 * c->up[k] + 0.56 * c->back[k];
}

/* Directions around a unit n, more of them near it: the same for every pixel, so that there is no noise. */
static void around(const double n[3], uint32_t i, double out[3])
{
    const double sign = n[2] < 0 ? -1 : 1, a = -1 / (sign + n[2]), b = n[0] * n[1] * a;
    const double u[3] = {1 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]}, v[3] = {b, sign + n[1] * n[1] * a, -n[1]};
    const double turn = 2 * M_PI * spread(i, 2), square = (spread(i, 3) + 0.03) / 1.03, flat = sqrt(square);
    for (int k = 0; k < 3; ++k)
        out[k] = flat * cos(turn) * u[k] + flat * sin(turn) * v[k] + sqrt(1 - square) * n[k];
}

static void aim_shadow(const sample *s, const double direction[3], double length, double lift, sph_sweep *ray)
{
    memset(ray, 0, sizeof *ray);
    for (int k = 0; k < 3; ++k) {
        const double from = s->point[k] + lift * s->normal[k];
        ray->from[k] = (float)from;
        ray->to[k] = (float)(from + length * direction[k]);
    }
}

/* Where the ray meets the figure, or else the ground. */
static void place_sample(const tile *t, const sph_sweep *ray, const sph_hit *hit, sample *s)
{
    double length = 0, drop = (double)ray->to[1] - ray->from[1], share;
    figure_place place;
    memset(s, 0, sizeof *s);
    for (int k = 0; k < 3; ++k) {
        s->direction[k] = (double)ray->to[k] - ray->from[k];
        length += s->direction[k] * s->direction[k];
    }
    for (int k = 0; k < 3; ++k)
        s->direction[k] /= sqrt(length);
    share = drop < 0 ? (t->ground - ray->from[1]) / drop : -1;
    s->is_object = hit->hit != 0;
    s->is_ground = !s->is_object && t->has_shadows && share > 0 && share < 1;
    s->key = s->sky = 1;
    if (s->is_object) {
        figure_look(t->figure, hit, s->direction, &place);
        memcpy(s->point, hit->contact.point, sizeof s->point);
        memcpy(s->normal, place.normal, sizeof s->normal);
        memcpy(s->colour, place.colour, sizeof s->colour);
    } else if (s->is_ground) {
        for (int k = 0; k < 3; ++k)
            s->point[k] = ray->from[k] + share * ((double)ray->to[k] - ray->from[k]);
        s->normal[1] = 1;
    }
}

/* How much light arrives: one ray to the light, jittered as it is a wide one, and some to the sky. */
static sph_status find_shadows(pixel *p)
{
    const tile *t = p->tile;
    const double lift = 1e-3 * t->scale;
    double light[3];
    size_t count = 0;
    sph_status status;
    to_light(t->camera, light);
    for (uint32_t i = 0; i < p->count; ++i) {
        const sample *s = &p->samples[i];
        double direction[3];
        if (!s->is_object && !s->is_ground) continue;
        around(light, i, direction);
        for (int k = 0; k < 3; ++k)
            direction[k] = light[k] + 0.10 * direction[k];
        aim_shadow(s, direction, 2 * t->scale, lift, &p->shadow_rays[count++]);
        for (uint32_t j = 1; j < SHADOWS; ++j) {
            around(s->normal, 2 * i + j, direction);
            aim_shadow(s, direction, 0.3 * t->scale, lift, &p->shadow_rays[count++]);
        }
    }
    status = sph_query_cast_any(t->figure->query, p->shadow_rays, count, p->shadows);
    count = 0;
    for (uint32_t i = 0; i < p->count && status == SPH_OK; ++i) {
        sample *s = &p->samples[i];
        if (!s->is_object && !s->is_ground) continue;
        s->key = !p->shadows[count++];
        s->sky = 0;
        for (uint32_t j = 1; j < SHADOWS; ++j)
            s->sky += (double)!p->shadows[count++] / (SHADOWS - 1);
    }
    return status;
}

/* What light a place of this colour sends to the eye. */
static void shade(const camera *c, const sample *s, double colour[3])
{
    double light[3], half[3], key, sky, gloss;
    to_light(c, light);
    for (int k = 0; k < 3; ++k)
        half[k] = light[k] - s->direction[k];
    key = fmax(0, dot(s->normal, light)) * s->key;
    sky = s->sky * (0.75 + 0.25 * s->normal[1]) * (0.7 + 0.3 * fabs(dot(s->normal, s->direction)));
    gloss = 0.18 * s->key * pow(fmax(0, dot(s->normal, half)) / sqrt(dot(half, half)), 50);
    for (int k = 0; k < 3; ++k)
        colour[k] = s->colour[k] * (0.95 * key + 0.55 * sky) + gloss;
}

/* Glass: clear where it is looked at straight, milky where it turns away. */
static void add_glass(const tile *t, const sph_hit *hit, sample *s, double colour[3])
{
    figure_place place;
    double opacity, facing, glass[3];
    sample g = *s;
    figure_look(t->overlay, hit, s->direction, &place);
    memcpy(g.normal, place.normal, sizeof g.normal);
    memcpy(g.colour, GLASS, sizeof g.colour);
    g.key = g.sky = 1;
    facing = fabs(dot(g.normal, g.direction));
    opacity = 0.28 + 0.65 * (1 - facing) * (1 - facing);
    shade(t->camera, &g, glass);
    for (int k = 0; k < 3; ++k)
        colour[k] += opacity * (glass[k] - colour[k]);
}

static void add_sample(pixel *p, uint32_t i, double sum[3])
{
    const tile *t = p->tile;
    sample *s = &p->samples[i];
    double colour[3] = {1, 1, 1};
    if (s->is_object)
        shade(t->camera, s, colour);
    else
        for (int k = 0; k < 3; ++k)
            colour[k] = 1 - 0.30 * (1 - s->key) - 0.45 * (1 - s->sky);
    if (t->overlay != NULL && p->overlay_hits[i].hit && !(s->is_object && p->hits[i].s < p->overlay_hits[i].s))
        add_glass(t, &p->overlay_hits[i], s, colour);
    for (int k = 0; k < 3; ++k)
        sum[k] += fmin(1, fmax(0, colour[k])) / p->count;
}

static sph_status trace_pixel(pixel *p, uint32_t x, uint32_t y, unsigned char *rgb)
{
    const tile *t = p->tile;
    const uint32_t n = t->samples;
    double sum[3] = {0, 0, 0};
    sph_status status;
    p->count = n * n;
    for (uint32_t i = 0; i < n * n; ++i) {
        const double u = x + (i % n + 0.5) / n, v = y + (i / n + 0.5) / n;
        camera_ray(t->camera, 2 * u / t->width - 1, 1 - 2 * v / t->height, &p->rays[i]);
    }
    status = sph_query_cast(t->figure->query, p->rays, p->count, p->hits);
    if (status == SPH_OK && t->overlay != NULL)
        status = sph_query_cast(t->overlay->query, p->rays, p->count, p->overlay_hits);
    for (uint32_t i = 0; i < p->count && status == SPH_OK; ++i)
        place_sample(t, &p->rays[i], &p->hits[i], &p->samples[i]);
    if (status == SPH_OK && t->has_shadows) status = find_shadows(p);
    for (uint32_t i = 0; i < p->count && status == SPH_OK; ++i)
        add_sample(p, i, sum);
    for (int k = 0; k < 3; ++k)
        rgb[k] = (unsigned char)lround(255 * pow(fmin(1, sum[k]), 1 / 2.2));
    return status;
}

/* Casts start no loop of their own, so they may be asked from within one. */
static void trace_rows(void *argument, size_t begin, size_t end)
{
    job *j = argument;
    pixel p;
    p.tile = j->tile;
    for (size_t y = j->first_row + begin; y < j->first_row + end; ++y)
        for (uint32_t x = 0; x < j->tile->width && atomic_load(&j->status) == SPH_OK; ++x) {
            unsigned char *rgb = j->picture->rgb + 3 * ((j->tile->top + y) * j->picture->width + j->tile->left + x);
            const sph_status status = trace_pixel(&p, x, (uint32_t)y, rgb);
            if (status != SPH_OK) atomic_store(&j->status, status);
        }
}

/* In bands of rows, so that Ctrl-C does not have to wait for the whole of a large picture. */
sph_status picture_draw(picture *p, sph_context *context, const tile *t, double done, double share)
{
    enum { BAND = 32 };
    job j = {.picture = p, .tile = t};
    sph_status status = SPH_OK;
    for (; j.first_row < t->height && status == SPH_OK; j.first_row += BAND) {
        const uint32_t left = t->height - j.first_row;
        status = sph_context_report_progress(context, "render", done + share * j.first_row / t->height);
        if (status != SPH_OK) break;
        sph_context_parallel_for(context, left < BAND ? left : BAND, 1, trace_rows, &j);
        status = (sph_status)atomic_load(&j.status);
    }
    return status;
}
