/* SPDX-License-Identifier: MIT */
/*
 * An importer of one's own. A simulation has written the positions of a flag, frame after frame, as raw floats; the
 * library pulls each frame from that file when it needs it; the importer itself never holds more than one.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sphmesh/sphmesh.h>

enum { COLUMNS = 40, ROWS = 25, VERTICES = COLUMNS * ROWS, FRAMES = 30, SPHERES = 60 };

/* What read_raw_frame() needs to know; the library hands it back as `user`. */
typedef struct raw_file {
    sph_context *context;
    FILE *file;
    uint32_t vertex_count;
} raw_file;

static sph_status read_raw_frame(void *user, uint32_t frame, float *xyz)
{
    raw_file *raw = user;
    const size_t floats = 3 * (size_t)raw->vertex_count;
    char message[80];
    if (fseek(raw->file, (long)(frame * floats * sizeof(float)), SEEK_SET) == 0 &&
        fread(xyz, sizeof(float), floats, raw->file) == floats)
        return SPH_OK;
    snprintf(message, sizeof message, "the raw file ends before frame %u does", (unsigned)frame);
    return sph_context_fail(raw->context, SPH_E_IO, message);
}

static void close_raw_file(void *user)
{
    raw_file *raw = user;
    fclose(raw->file);
    free(raw);
}

/* The importer: from here on `file` belongs to the animation, also when this fails. */
static sph_status open_raw_animation(sph_context *context, FILE *file, uint32_t vertex_count, uint32_t frame_count,
                                     sph_animation **out)
{
    raw_file *raw = malloc(sizeof *raw);
    if (raw == NULL) {
        fclose(file);
        return sph_context_fail(context, SPH_E_NOMEM, "no memory for the importer");
    }
    *raw = (raw_file){context, file, vertex_count};
    const sph_frame_source source = {raw, read_raw_frame, close_raw_file};
    return sph_animation_create_from_source(context, vertex_count, frame_count, &source, out);
}

/* Stands for the simulation: a flag in the wind. */
static bool write_flag(FILE *file)
{
    for (uint32_t frame = 0; frame < FRAMES; ++frame)
        for (uint32_t i = 0; i < VERTICES; ++i) {
            const float x = 0.1f * (float)(i % COLUMNS), y = 0.1f * (float)(i / COLUMNS);
            const float xyz[3] = {x, y, 0.1f * x * sinf(2 * x - 0.5f * (float)frame)};
            if (fwrite(xyz, sizeof xyz, 1, file) != 1) return false;
        }
    return fflush(file) == 0;
}

static sph_status set_grid(sph_animation *flag)
{
    static uint32_t triangles[2 * (COLUMNS - 1) * (ROWS - 1)][3];
    size_t count = 0;
    for (uint32_t row = 0; row + 1 < ROWS; ++row)
        for (uint32_t column = 0; column + 1 < COLUMNS; ++column, count += 2) {
            const uint32_t i = row * COLUMNS + column;
            const uint32_t both[2][3] = {{i, i + 1, i + COLUMNS + 1}, {i, i + COLUMNS + 1, i + COLUMNS}};
            memcpy(triangles[count], both, sizeof both);
        }
    return sph_animation_set_triangles(flag, triangles[0], count, 0);
}

/* An animation of `frame_count` frames over a file that has FRAMES. */
static sph_status open_flag(sph_context *context, uint32_t frame_count, sph_animation **out)
{
    FILE *file = tmpfile();
    *out = NULL;
    if (file == NULL) return sph_context_fail(context, SPH_E_IO, "cannot make the raw file");
    if (!write_flag(file)) {
        fclose(file);
        return sph_context_fail(context, SPH_E_IO, "cannot write the raw file");
    }
    const sph_status status = open_raw_animation(context, file, VERTICES, frame_count, out);
    return status == SPH_OK ? set_grid(*out) : status;
}

static sph_status print_level(const sph_level *level)
{
    sph_level_arrays a = {.struct_size = sizeof a};
    const sph_status status = sph_level_get_arrays(level, &a);
    printf("the flag in %u frames: %u spheres, %zu triangles, %zu wire edges\n", (unsigned)a.frame_count,
           (unsigned)a.sphere_count, a.triangle_count, a.edge_count);
    return status;
}

int main(void)
{
    sph_context *context = NULL;
    sph_animation *flag = NULL, *too_long = NULL;
    sph_hierarchy *hierarchy = NULL, *none = NULL;
    sph_level *level = NULL;
    if (sph_context_create(NULL, &context) != SPH_OK) return 1;
    bool done = open_flag(context, FRAMES, &flag) == SPH_OK && sph_hierarchy_create(flag, NULL, &hierarchy) == SPH_OK &&
                sph_level_create(hierarchy, SPHERES, &level) == SPH_OK && print_level(level) == SPH_OK;
    if (!done) fprintf(stderr, "%s\n", sph_context_last_message(context));

    /* What the importer says about a frame that it cannot read is what the library's caller hears. */
    done = done && open_flag(context, FRAMES + 1, &too_long) == SPH_OK &&
           sph_hierarchy_create(too_long, NULL, &none) == SPH_E_IO;
    printf("one frame more than the file has: %s\n", sph_context_last_message(context));

    sph_level_destroy(level);
    sph_hierarchy_destroy(hierarchy);
    sph_animation_destroy(too_long);
    sph_animation_destroy(flag);
    sph_context_destroy(context);
    return done ? 0 : 1;
}
