/* SPDX-License-Identifier: MIT */
/*
 * The readers of files: the first byte says how the file is called, the rest is its content. What is read is looked at by
 * everything that looks at animations and levels.
 */
#include <fcntl.h>
#include <unistd.h>

#include <sphmesh/io.h>

#include "fuzz.h"

enum { FRAME_LIMIT = 16, PATH_SIZE = 128, VERTEX_LIMIT = 2000000 };

static const char *const ENDINGS[] = {"obj", "ply", "off", "stl", "gltf", "glb", "pc2", "mdd", "json", "sphm", "abc"};
enum { ENDING_COUNT = sizeof ENDINGS / sizeof *ENDINGS };

/* Four vertices, for the caches. */
static const char MESH[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

static void write_file(const char *path, const void *bytes, size_t size)
{
    const int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    FUZZ_CHECK(file >= 0 && write(file, bytes, size) == (ssize_t)size && close(file) == 0);
}

static void look_at(sph_animation *animation)
{
    const uint32_t frames = sph_animation_frame_count(animation), n = sph_animation_vertex_count(animation);
    sph_animation_report report;
    float *positions;
    FUZZ_CHECK(frames > 0 && n > 0);
    if (n > VERTEX_LIMIT) return;
    positions = malloc(3 * (size_t)n * sizeof *positions);
    FUZZ_CHECK(positions != NULL);
    for (uint32_t f = 0; f < frames && f < FRAME_LIMIT; ++f)
        (void)sph_animation_read_frame(animation, f, positions);
    free(positions);
    sph_animation_report_init(&report, sizeof report);
    if (frames <= FRAME_LIMIT) (void)sph_animation_check(animation, &report);
}

static sph_status read_animation(sph_context *context, const char *path, const char *mesh, uint8_t choice)
{
    sph_io_open_options o;
    sph_animation *animation = NULL;
    const char *paths[] = {mesh == NULL ? path : mesh};
    sph_status status;
    sph_io_open_options_init(&o, sizeof o);
    o.cache_path = mesh == NULL ? NULL : path;
    o.up_axis = choice & 1;
    o.fps = (choice & 2) != 0 ? 1 : 0;
    o.weld = (choice & 4) != 0 ? SPH_IO_WELD_ALL : SPH_IO_WELD_AUTO;
    status = sph_io_open_animation(context, paths, 1, &o, &animation);
    FUZZ_CHECK((animation != NULL) == (status == SPH_OK));
    if (status == SPH_OK) look_at(animation);
    sph_animation_destroy(animation);
    return status;
}

static sph_status read_level(sph_context *context, const char *path)
{
    sph_level *level = NULL;
    const sph_status status = sph_io_load_level(context, path, &level);
    FUZZ_CHECK((level != NULL) == (status == SPH_OK));
    if (status == SPH_OK) FUZZ_CHECK(sph_level_sphere_count(level) > 0 && sph_level_frame_count(level) > 0);
    sph_level_destroy(level);
    return status;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char path[PATH_SIZE], mesh[PATH_SIZE];
    const char *folder = getenv("TMPDIR"), *ending;
    fuzz_patience patience = {.reports_left = 2000};
    sph_context *context;
    uint64_t idle;
    sph_status status;
    if (size < 2) return 0;
    ending = ENDINGS[data[0] % ENDING_COUNT];
    if (folder == NULL || strlen(folder) > PATH_SIZE / 2) folder = "/tmp";
    snprintf(path, sizeof path, "%s/sphmesh-fuzz-%ld.%s", folder, (long)getpid(), ending);
    snprintf(mesh, sizeof mesh, "%s/sphmesh-fuzz-%ld-mesh.obj", folder, (long)getpid());
    write_file(path, data + 2, size - 2);
    context = fuzz_context(&patience);
    idle = sph_context_memory_used(context);
    if (strcmp(ending, "json") == 0 || strcmp(ending, "sphm") == 0) {
        status = read_level(context, path);
    } else if (strcmp(ending, "pc2") == 0 || strcmp(ending, "mdd") == 0) {
        write_file(mesh, MESH, sizeof MESH - 1);
        status = read_animation(context, path, mesh, data[1]);
        unlink(mesh);
    } else {
        status = read_animation(context, path, NULL, data[1]);
    }
    fuzz_end(context, status, idle);
    unlink(path);
    return 0;
}
