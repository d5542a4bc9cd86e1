/* SPDX-License-Identifier: MIT */
#include "picture.h"

#include <errno.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "program.h"

int picture_save(const picture *p, const char *path)
{
    png_image image = {.version = PNG_IMAGE_VERSION, .width = p->width, .height = p->height, .format = PNG_FORMAT_RGB};
    const size_t length = strlen(path) + 40;
    char *temporary = malloc(length);
    int result = DONE;
    if (temporary == NULL) return failure("out of memory");
    snprintf(temporary, length, "%s.%ld.tmp", path, (long)getpid());
    if (!png_image_write_to_file(&image, temporary, 0, p->rgb, 0, NULL))
        result = failure("%s: cannot be written: %s", path, image.message);
    else if (rename(temporary, path) != 0)
        result = failure("%s: cannot be put in place: %s", path, strerror(errno));
    if (result != DONE) remove(temporary);
    free(temporary);
    return result;
}
