/* SPDX-License-Identifier: MIT */
/* Runs a fuzz target over the files that the arguments name, and over those of the folders among them. Speaks TAP. */
#include <dirent.h>
#include <sys/stat.h>

#include "fuzz.h"

enum { PATH_LIMIT = 4096, DEPTH_LIMIT = 4 };

static unsigned count;

static void replay_file(const char *path, size_t size)
{
    FILE *file = fopen(path, "rb");
    uint8_t *bytes = malloc(size == 0 ? 1 : size); /* of that size alone: a look beyond is seen */
    if (file == NULL || bytes == NULL || fread(bytes, 1, size, file) != size) {
        fprintf(stderr, "%s cannot be read\n", path);
        exit(1);
    }
    fclose(file);
    LLVMFuzzerTestOneInput(bytes, size);
    free(bytes);
    printf("ok %u - %s\n", ++count, path);
}

static void replay(const char *path, unsigned depth)
{
    struct stat about;
    struct dirent **names;
    int found;
    if (stat(path, &about) != 0) {
        fprintf(stderr, "%s is not there\n", path);
        exit(1);
    }
    if (!S_ISDIR(about.st_mode)) {
        replay_file(path, (size_t)about.st_size);
        return;
    }
    found = depth < DEPTH_LIMIT ? scandir(path, &names, NULL, alphasort) : -1;
    for (int i = 0; i < found; ++i) {
        char inner[PATH_LIMIT];
        const int length = snprintf(inner, sizeof inner, "%s/%s", path, names[i]->d_name);
        if (names[i]->d_name[0] != '.' && length > 0 && length < PATH_LIMIT) replay(inner, depth + 1);
        free(names[i]);
    }
    if (found >= 0) free(names);
}

int main(int argc, char **argv)
{
    for (int i = 1; i < argc; ++i) replay(argv[i], 0);
    printf("1..%u\n", count);
    return count == 0;
}
