/* SPDX-License-Identifier: MIT */
/* Levels of detail in the terminal: keys + and - double and halve the spheres, ] and [ add and take one, n and p step
   through the frames, q quits. A cursor walks the hierarchy; the picture is one batch of rays. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

#include <sphmesh/io.h>

enum { WIDTH = 72, HEIGHT = 24, RAYS = WIDTH * HEIGHT };

typedef struct view {
    sph_hierarchy *hierarchy;
    sph_cursor *cursor;
    uint32_t spheres, frame;
    float center[3], size; /* of the mesh in its first frame, about */
} view;

/* A ray for each character, which is twice as high as it is wide. Shades by how far the surface is turned away. */
static sph_status draw(const view *v, const sph_query *query)
{
    static sph_sweep rays[RAYS];
    static sph_hit hits[RAYS];
    for (int i = 0; i < RAYS; ++i) {
        const float x = v->center[0] + 2.0f * v->size * ((float)(i % WIDTH) + 0.5f - WIDTH / 2) / WIDTH;
        const float y = v->center[1] - 4.0f * v->size * ((float)(i / WIDTH) + 0.5f - HEIGHT / 2) / WIDTH;
        rays[i] = (sph_sweep){{x, y, v->center[2] + 3 * v->size}, {x, y, v->center[2] - 3 * v->size}, 0, 0};
    }
    const sph_status status = sph_query_cast(query, rays, RAYS, hits);
    for (int i = 0; i < RAYS && status == SPH_OK; ++i) {
        const double facing = fmax(0, hits[i].contact.normal[2]);
        putchar(hits[i].hit ? ".:-=+*#%@"[(int)(8.99 * facing)] : ' ');
        if (i % WIDTH == WIDTH - 1) putchar('\n');
    }
    return status;
}

static sph_status show(const view *v)
{
    sph_level_options one_frame; /* without labels: quick, however large the input was */
    sph_level *level = NULL;
    sph_query *query = NULL;
    sph_level_options_init(&one_frame, sizeof one_frame);
    one_frame.first_frame = v->frame, one_frame.frame_count = 1, one_frame.labels = SPH_LABELS_NONE;
    sph_status status = sph_cursor_move(v->cursor, v->spheres);
    if (status == SPH_OK) status = sph_level_extract(v->hierarchy, v->spheres, &one_frame, &level);
    if (status == SPH_OK) status = sph_query_create(level, NULL, &query);
    if (isatty(STDOUT_FILENO)) fputs("\033[H\033[J", stdout); /* clears the screen */
    if (status == SPH_OK) status = draw(v, query);
    printf("frame %u: %u spheres, %zu wire edges, %zu triangles. Keys: + - ] [ n p q\n", v->frame, v->spheres,
           sph_cursor_edge_count(v->cursor), sph_cursor_triangle_count(v->cursor));
    sph_query_destroy(query), sph_level_destroy(level);
    return status;
}

int main(int argc, char **argv)
{
    view v = {.spheres = 40};
    sph_context *context = NULL;
    struct termios before, raw;
    const bool terminal = tcgetattr(STDIN_FILENO, &before) == 0;
    if (argc != 2) return fprintf(stderr, "usage: lod_browser HIERARCHY.sphm\n"), 2;
    bool done = sph_context_create(NULL, &context) == SPH_OK &&
                sph_io_load_hierarchy(context, argv[1], &v.hierarchy) == SPH_OK &&
                sph_cursor_create(v.hierarchy, &v.cursor) == SPH_OK;
    const uint32_t most = sph_hierarchy_vertex_count(v.hierarchy), frames = sph_hierarchy_frame_count(v.hierarchy);
    const uint32_t least = most - sph_hierarchy_collapse_count(v.hierarchy), top = 2 * most - least - 1;
    float *centers = sph_context_allocate(context, frames, 3 * sizeof *centers);
    done = done && centers != NULL && sph_hierarchy_sphere(v.hierarchy, top, centers, NULL) == SPH_OK;
    if (done)
        memcpy(v.center, centers, sizeof v.center), v.size = (float)sph_hierarchy_bounding_diagonal(v.hierarchy) / 2;
    if (terminal) raw = before, raw.c_lflag &= ~(tcflag_t)(ICANON | ECHO), tcsetattr(STDIN_FILENO, TCSANOW, &raw);
    for (int key = '='; done && key != 'q' && key != EOF; key = getchar()) {
        if (key == '+') v.spheres *= 2;
        if (key == '-') v.spheres /= 2;
        if (key == ']') v.spheres += 1;
        if (key == '[') v.spheres -= 1;
        if (key == 'n' || key == 'p') v.frame = (v.frame + (key == 'n' ? 1 : frames - 1)) % frames;
        v.spheres = v.spheres < least ? least : v.spheres > most ? most : v.spheres;
        done = show(&v) == SPH_OK;
    }
    if (!done) fprintf(stderr, "lod_browser: %s\n", sph_context_last_message(context));
    if (terminal) tcsetattr(STDIN_FILENO, TCSANOW, &before);
    sph_context_release(context, centers), sph_cursor_destroy(v.cursor), sph_hierarchy_destroy(v.hierarchy);
    sph_context_destroy(context);
    return done ? 0 : 1;
}
