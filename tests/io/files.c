/* SPDX-License-Identifier: MIT */
#include "files.h"

#include <check.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "support.h"

enum { PATH_SIZE = 512, PATH_LIMIT = 4096 };

static char folder[PATH_SIZE];
static char *paths[PATH_LIMIT];
static size_t path_count;

void files_setup(void)
{
    const char *base = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%s/sphmesh-test-XXXXXX", base == NULL ? "/tmp" : base);
    ck_assert_ptr_nonnull(mkdtemp(folder));
    path_count = 0;
}

static void remove_all(const char *path)
{
    DIR *directory = opendir(path);
    const struct dirent *entry;
    ck_assert_ptr_nonnull(directory);
    while ((entry = readdir(directory)) != NULL) {
        char name[2 * PATH_SIZE];
        struct stat found;
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0) continue;
        snprintf(name, sizeof name, "%s/%s", path, entry->d_name);
        if (lstat(name, &found) == 0 && S_ISDIR(found.st_mode))
            remove_all(name);
        else
            unlink(name);
    }
    closedir(directory);
    rmdir(path);
}

/* Whether this process still has a file of the folder mapped or open. */
static void check_let_go(void)
{
    FILE *maps = fopen("/proc/self/maps", "r");
    DIR *open_files = opendir("/proc/self/fd");
    const struct dirent *entry;
    char line[2 * PATH_SIZE];
    while (maps != NULL && fgets(line, sizeof line, maps) != NULL)
        ck_assert_msg(strstr(line, folder) == NULL, "still mapped: %s", line);
    while (open_files != NULL && (entry = readdir(open_files)) != NULL) {
        const ssize_t length = readlinkat(dirfd(open_files), entry->d_name, line, sizeof line - 1);
        line[length < 0 ? 0 : length] = '\0';
        ck_assert_msg(strstr(line, folder) == NULL, "still open: %s", line);
    }
    if (maps != NULL) fclose(maps);
    if (open_files != NULL) closedir(open_files);
}

void files_teardown(void)
{
    check_let_go();
    remove_all(folder);
    while (path_count > 0)
        free(paths[--path_count]);
}

const char *file_path(const char *name)
{
    const size_t size = strlen(folder) + strlen(name) + 2;
    char *path = test_malloc(size, 1);
    ck_assert_uint_lt(path_count, PATH_LIMIT);
    snprintf(path, size, "%s/%s", folder, name);
    paths[path_count++] = path;
    return path;
}

const char *file_write(const char *name, const void *bytes, size_t size)
{
    const char *path = file_path(name);
    FILE *file = fopen(path, "wb");
    ck_assert_ptr_nonnull(file);
    ck_assert_uint_eq(size == 0 ? 0 : fwrite(bytes, 1, size, file), size);
    ck_assert_int_eq(fclose(file), 0);
    return path;
}

const char *file_text(const char *name, const char *text)
{
    return file_write(name, text, strlen(text));
}

unsigned char *file_read(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    unsigned char *bytes;
    long length;
    ck_assert_msg(file != NULL, "%s is not there", path);
    ck_assert_int_eq(fseek(file, 0, SEEK_END), 0);
    length = ftell(file);
    ck_assert_int_ge(length, 0);
    rewind(file);
    bytes = test_malloc((size_t)length + 1, 1);
    ck_assert_uint_eq(fread(bytes, 1, (size_t)length, file), (size_t)length);
    bytes[length] = '\0';
    fclose(file);
    *size = (size_t)length;
    return bytes;
}

size_t file_count(void)
{
    DIR *directory = opendir(folder);
    size_t count = 0;
    ck_assert_ptr_nonnull(directory);
    while (readdir(directory) != NULL)
        ++count;
    closedir(directory);
    return count - 2;
}

void put_bytes(layout *l, const void *bytes, size_t size)
{
    if (l->size + size > l->capacity) {
        unsigned char *grown = test_malloc(2 * (l->size + size), 1);
        if (l->size != 0) memcpy(grown, l->bytes, l->size);
        free(l->bytes);
        l->bytes = grown;
        l->capacity = 2 * (l->size + size);
    }
    if (size != 0) memcpy(l->bytes + l->size, bytes, size);
    l->size += size;
}

void put_little(layout *l, uint64_t value, unsigned size)
{
    for (unsigned i = 0; i < size; ++i) {
        const unsigned char byte = (unsigned char)(value >> 8 * i);
        put_bytes(l, &byte, 1);
    }
}

void put_big(layout *l, uint64_t value, unsigned size)
{
    for (unsigned i = size; i-- > 0;) {
        const unsigned char byte = (unsigned char)(value >> 8 * i);
        put_bytes(l, &byte, 1);
    }
}

void put_little_float(layout *l, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_little(l, bits, 4);
}

void put_big_float(layout *l, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_big(l, bits, 4);
}

void layout_free(layout *l)
{
    free(l->bytes);
    *l = (layout){NULL, 0, 0};
}

unsigned char *exact_copy(const void *bytes, size_t size)
{
    unsigned char *copy = malloc(size);
    if (size != 0) memcpy(copy, bytes, size);
    return copy;
}

float coordinate(uint32_t frame, uint32_t vertex, unsigned axis)
{
    return (float)(vertex * 4 + axis) + (float)frame / 1024;
}

void put_pc2(layout *l, uint32_t vertices, uint32_t frames)
{
    put_bytes(l, "POINTCACHE2", 12);
    put_little(l, 1, 4); /* version */
    put_little(l, vertices, 4);
    put_little_float(l, 0); /* start */
    put_little_float(l, 1); /* frames per sample */
    put_little(l, frames, 4);
    for (uint32_t f = 0; f < frames; ++f)
        for (uint32_t i = 0; i < 3 * vertices; ++i)
            put_little_float(l, coordinate(f, i / 3, i % 3));
}

void put_mdd(layout *l, uint32_t vertices, uint32_t frames)
{
    put_big(l, frames, 4);
    put_big(l, vertices, 4);
    for (uint32_t f = 0; f < frames; ++f)
        put_big_float(l, (float)f / 25);
    for (uint32_t f = 0; f < frames; ++f)
        for (uint32_t i = 0; i < 3 * vertices; ++i)
            put_big_float(l, coordinate(f, i / 3, i % 3));
}

const char *write_obj(const char *name, uint32_t vertices, uint32_t frame)
{
    const char *path = file_path(name);
    FILE *file = fopen(path, "w");
    ck_assert_ptr_nonnull(file);
    for (uint32_t i = 0; i < vertices; ++i)
        fprintf(file, "v %.10f %.10f %.10f\n", (double)coordinate(frame, i, 0), (double)coordinate(frame, i, 1),
                (double)coordinate(frame, i, 2));
    for (uint32_t i = 0; i + 2 < vertices; ++i)
        fprintf(file, "f %u %u %u\n", i + 1, i + 2, i + 3);
    ck_assert_int_eq(fclose(file), 0);
    return path;
}

/* That frame `f` of the animation is frame first + f * step of the coordinates. */
void check_frames(sph_context *context, const sph_animation *animation, uint32_t vertices, uint32_t frames,
                  uint32_t first, uint32_t step)
{
    float *xyz = test_malloc(3 * vertices, sizeof *xyz);
    ck_assert_msg(animation != NULL, "%s", sph_context_last_message(context));
    ck_assert_uint_eq(sph_animation_vertex_count(animation), vertices);
    ck_assert_uint_eq(sph_animation_frame_count(animation), frames);
    ck_assert_uint_eq(sph_animation_triangle_count(animation), vertices - 2);
    for (uint32_t f = frames; f-- > 0;) { /* any order will do */
        ck_assert_int_eq(sph_animation_read_frame(animation, f, xyz), SPH_OK);
        for (uint32_t i = 0; i < 3 * vertices; ++i)
            ck_assert_float_eq(xyz[i], coordinate(first + f * step, i / 3, i % 3));
    }
    free(xyz);
}

const char *write_cache(const char *name, uint32_t vertices, uint32_t frames)
{
    layout l = {NULL, 0, 0};
    const char *path;
    if (strstr(name, "mdd") != NULL)
        put_mdd(&l, vertices, frames);
    else
        put_pc2(&l, vertices, frames);
    path = file_write(name, l.bytes, l.size);
    layout_free(&l);
    return path;
}

/* Counts, first coordinate and first index of each simplex in one line. */
void check_content(sph_context *context, const char *path, const char *expected)
{
    sph_status status;
    sph_animation *animation = open_one(context, path, NULL, &status);
    const uint32_t n = sph_animation_vertex_count(animation);
    float *xyz = test_malloc(3 * n + 1, sizeof *xyz);
    char found[1000];
    size_t length = 0;
    ck_assert_msg(animation != NULL, "%s", sph_context_last_message(context));
    ck_assert_uint_eq(sph_animation_frame_count(animation), 1);
    ck_assert_int_eq(sph_animation_read_frame(animation, 0, xyz), SPH_OK);
    for (uint32_t i = 0; i < n; ++i)
        length += (size_t)snprintf(found + length, sizeof found - length, "%s%g %g %g", i == 0 ? "" : ", ",
                                   (double)xyz[3 * i], (double)xyz[3 * i + 1], (double)xyz[3 * i + 2]);
    for (size_t i = 0; i < sph_animation_triangle_count(animation); ++i) {
        const uint32_t *t = sph_animation_triangles(animation) + 3 * i;
        length += (size_t)snprintf(found + length, sizeof found - length, "%s%u %u %u", i == 0 ? "; f " : ", ", t[0],
                                   t[1], t[2]);
    }
    for (size_t i = 0; i < sph_animation_edge_count(animation); ++i) {
        const uint32_t *e = sph_animation_edges(animation) + 2 * i;
        length +=
            (size_t)snprintf(found + length, sizeof found - length, "%s%u %u", i == 0 ? "; l " : ", ", e[0], e[1]);
    }
    ck_assert_str_eq(found, expected);
    free(xyz);
    sph_animation_destroy(animation);
}

void check_refused(sph_context *context, const char *path, sph_status expected, const char *message)
{
    sph_status status;
    ck_assert_ptr_null(open_one(context, path, NULL, &status));
    ck_assert_msg(strstr(sph_context_last_message(context), message) != NULL, "«%s», not «%s»",
                  sph_context_last_message(context), message);
    ck_assert_int_eq(status, expected);
}

sph_animation *open_one(sph_context *context, const char *path, const sph_io_open_options *options, sph_status *status)
{
    sph_animation *animation = NULL;
    *status = sph_io_open_animation(context, &path, 1, options, &animation);
    ck_assert_int_eq(animation == NULL, *status != SPH_OK);
    return animation;
}
