/* SPDX-License-Identifier: MIT */
/*
 * The readers of files: the first byte says how the file is called, the second how it is read, the rest is its content.
 * What is read is looked at by everything that looks at animations, levels and rigs.
 */
#include <fcntl.h>
#include <unistd.h>

#include <sphmesh/io.h>

#include "fuzz.h"
#include "fuzz_rig.h"

enum { FRAME_LIMIT = 16, PATH_SIZE = 128, VERTEX_LIMIT = 2000000, CHOICE_RIG = 8, CHOICE_TELL = 16 };

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

static sph_status read_rig(sph_context *context, const char *path, uint8_t choice)
{
    sph_io_open_rig_options o;
    sph_io_rig *rig = NULL;
    sph_status status;
    sph_io_open_rig_options_init(&o, sizeof o);
    o.fps = (choice & 2) != 0 ? 1 : 0;
    status = sph_io_open_rig(context, path, &o, &rig);
    FUZZ_CHECK((rig != NULL) == (status == SPH_OK));
    if (status == SPH_OK) fuzz_use_rig(context, rig);
    sph_io_rig_destroy(rig);
    return status;
}

static void see_clip(void *user, const sph_io_clip *clip)
{
    *(size_t *)user += strlen(clip->name);
}

static void see_archive(void *user, const sph_io_archive *archive)
{
    *(size_t *)user += strlen(archive->application) + strlen(archive->library) + strlen(archive->date);
}

static void see_object(void *user, const sph_io_object *object)
{
    *(size_t *)user += strlen(object->path) + strlen(object->kind);
}

/* What can be told of a file without reading all of it. */
static sph_status tell(sph_context *context, const char *path)
{
    sph_io_description about = {.struct_size = sizeof about};
    int32_t kind = 0;
    size_t told = 0;
    (void)sph_io_list_clips(context, path, 0, see_clip, &told);
    (void)sph_io_list_objects(context, path, NULL, see_archive, see_object, &told);
    if (sph_io_identify(context, path, &kind) == SPH_OK) FUZZ_CHECK(kind == SPH_IO_HIERARCHY || kind == SPH_IO_LEVEL);
    return sph_io_describe(context, path, &about);
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
    if ((data[1] & CHOICE_TELL) != 0) {
        status = tell(context, path);
    } else if ((data[1] & CHOICE_RIG) != 0) {
        status = read_rig(context, path, data[1]);
    } else if (strcmp(ending, "json") == 0 || strcmp(ending, "sphm") == 0) {
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
