/* SPDX-License-Identifier: MIT */
/* An importer of one's own. A simulation has written the positions of a flag, frame after frame, as raw floats; the
   library pulls each frame from that file when it needs it; the importer itself never holds more than one. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <sphmesh/sphmesh.h>

enum { COLUMNS = 40, ROWS = 25, VERTICES = COLUMNS * ROWS, FRAMES = 30 };

/* What the importer needs to know; the library hands it back as `user`. */
typedef struct raw_file {
    sph_context *context;
    FILE *file;
} raw_file;

static sph_status read_raw_frame(void *user, uint32_t frame, float *xyz)
{
    const raw_file *raw = user;
    char message[80];
    if (fseek(raw->file, (long)(frame * 3 * sizeof(float) * VERTICES), SEEK_SET) == 0 &&
        fread(xyz, 3 * sizeof(float), VERTICES, raw->file) == VERTICES)
        return SPH_OK;
    snprintf(message, sizeof message, "the raw file ends before frame %u does", (unsigned)frame);
    return sph_context_fail(raw->context, SPH_E_IO, message);
}

/* Called once, when the animation goes. */
static void close_raw_file(void *user)
{
    fclose(((raw_file *)user)->file);
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

/* An animation of `frame_count` frames over a file that has FRAMES. `raw` must live as long. */
static sph_status open_flag(raw_file *raw, uint32_t frame_count, sph_animation **out)
{
    const sph_frame_source source = {raw, read_raw_frame, close_raw_file};
    raw->file = tmpfile();
    if (raw->file == NULL) return sph_context_fail(raw->context, SPH_E_IO, "cannot make the raw file");
    const sph_status status = sph_animation_create_from_source(raw->context, VERTICES, frame_count, &source, out);
    if (status != SPH_OK) return status; /* the file is closed then, too */
    return write_flag(raw->file) ? set_grid(*out)
                                 : sph_context_fail(raw->context, SPH_E_IO, "cannot write the raw file");
}

int main(void)
{
    sph_animation *flag = NULL, *too_long = NULL;
    sph_hierarchy *hierarchy = NULL, *none = NULL;
    sph_context *context = NULL;
    if (sph_context_create(NULL, &context) != SPH_OK) return 1;
    raw_file whole = {context, NULL}, cut = {context, NULL};
    bool done = open_flag(&whole, FRAMES, &flag) == SPH_OK && sph_hierarchy_create(flag, NULL, &hierarchy) == SPH_OK;
    if (!done) fprintf(stderr, "%s\n", sph_context_last_message(context));
    printf("the flag in %u frames: %u collapses\n", (unsigned)FRAMES,
           (unsigned)sph_hierarchy_collapse_count(hierarchy));

    /* What the importer says about a frame that it cannot read is what the library's caller hears. */
    done = done && open_flag(&cut, FRAMES + 1, &too_long) == SPH_OK &&
           sph_hierarchy_create(too_long, NULL, &none) == SPH_E_IO;
    printf("one frame more than the file has: %s\n", sph_context_last_message(context));

    sph_hierarchy_destroy(hierarchy), sph_animation_destroy(too_long), sph_animation_destroy(flag);
    sph_context_destroy(context);
    return done ? 0 : 1;
}
