/* SPDX-License-Identifier: MIT */
/* A game loop at 60 ticks a second around a character that was animated at 24 frames a second. In every tick the level
   is posed between two frames and asked: what do the projectiles hit, is the player in its way, does a guard see it? */
#include <math.h>
#include <stdio.h>

#include <sphmesh/io.h>

enum { TICKS = 180, PROJECTILES = 64 };
static const double TICK = 1.0 / 60, FRAMES_PER_SECOND = 24;

typedef struct player {
    float place[3], radius, speed[3];
} player;

/* Out of the character along its normal, as far as it is in; the part of the speed that leads in is lost. */
static sph_status push_out(const sph_query *query, player *p)
{
    sph_nearest n;
    const sph_status status = sph_query_nearest(query, p->place, 0, 1, &n);
    if (status != SPH_OK || n.distance >= p->radius) return status;
    const double *normal = n.contact.normal;
    const double in = fmin(0, p->speed[0] * normal[0] + p->speed[1] * normal[1] + p->speed[2] * normal[2]);
    for (int i = 0; i < 3; ++i) {
        p->place[i] += (float)((p->radius - n.distance) * normal[i]);
        p->speed[i] -= (float)(in * normal[i]);
    }
    return SPH_OK;
}

/* A ring of balls that are shot at the middle, one tick's way each: moving spheres, in one batch. */
static sph_status shoot(const sph_query *query, int tick, const float middle[3], float size, int *hit_count)
{
    sph_sweep ways[PROJECTILES];
    sph_hit hits[PROJECTILES];
    for (int i = 0; i < PROJECTILES; ++i) {
        const float angle = 6.2831853f * (float)i / PROJECTILES;
        const float far = size * (1 - (float)(tick % 30) / 30), near = size * (1 - (float)(tick % 30 + 1) / 30);
        const float c = cosf(angle), s = sinf(angle);
        ways[i] = (sph_sweep){.from = {middle[0] + far * c, middle[1] + 0.2f * size * s, middle[2] + far * s},
                              .to = {middle[0] + near * c, middle[1] + 0.2f * size * s, middle[2] + near * s},
                              .radius = 0.01f * size};
    }
    const sph_status status = sph_query_cast(query, ways, PROJECTILES, hits);
    for (int i = 0; i < PROJECTILES && status == SPH_OK; ++i)
        *hit_count += hits[i].hit && hits[i].s > 0; /* at s = 0 it was in already: an earlier tick has counted it */
    return status;
}

int main(int argc, char **argv)
{
    sph_context *context = NULL;
    sph_level *level = NULL;
    sph_query *query = NULL;
    sph_level_arrays a = {.struct_size = sizeof a};
    int hit_count = 0, hidden_ticks = 0;
    if (argc != 2) return fprintf(stderr, "usage: game_loop LEVEL\n"), 2;
    bool done = sph_context_create(NULL, &context) == SPH_OK && sph_io_load_level(context, argv[1], &level) == SPH_OK &&
                sph_level_get_arrays(level, &a) == SPH_OK && sph_query_create(level, NULL, &query) == SPH_OK;
    float middle[3] = {0, 0, 0}, size = 0;
    for (uint32_t i = 0; i < 3 * a.sphere_count; ++i)
        middle[i % 3] += a.centers[i] / (float)a.sphere_count;
    for (uint32_t i = 0; i < 3 * a.sphere_count; ++i)
        size = fmaxf(size, fabsf(a.centers[i] - middle[i % 3]));
    player p = {{middle[0], middle[1], middle[2] + size}, 0.05f * size, {0.1f * size, 0, -size}};
    for (int tick = 0; done && tick < TICKS; ++tick) {
        const double last = a.frame_count - 1, frame = last > 0 ? fmod(tick * TICK * FRAMES_PER_SECOND, last) : 0;
        for (int i = 0; i < 3; ++i)
            p.place[i] += (float)TICK * p.speed[i];
        const sph_sweep gaze = {
            {middle[0], middle[1], middle[2] - 2 * size}, {p.place[0], p.place[1], p.place[2]}, 0, 0};
        uint8_t hidden = 0;
        done = sph_query_pose_time(query, frame) == SPH_OK && push_out(query, &p) == SPH_OK &&
               shoot(query, tick, middle, size, &hit_count) == SPH_OK &&
               sph_query_cast_any(query, &gaze, 1, &hidden) == SPH_OK;
        hidden_ticks += hidden;
        if (tick % 21 == 0)
            printf("%6.3f s, frame %6.3f: player at %.6f %.6f %.6f\n", tick * TICK, frame, p.place[0], p.place[1],
                   p.place[2]);
    }
    printf("%d projectiles hit; the player was out of sight for %d of %d ticks\n", hit_count, hidden_ticks, TICKS);
    if (!done) fprintf(stderr, "game_loop: %s\n", sph_context_last_message(context));
    sph_query_destroy(query), sph_level_destroy(level), sph_context_destroy(context);
    return done ? 0 : 1;
}
