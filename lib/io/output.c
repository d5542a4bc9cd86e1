/* SPDX-License-Identifier: MIT */
/* Files that are whole or not there: written under another name beside the target, then renamed. */
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/io.h"

enum { BUFFER_SIZE = 1 << 16, TEXT_SIZE = 256, ATTEMPTS = 100, SUFFIX_SIZE = 48 };

static sph_status fail(sph__io_output *o, sph_status status)
{
    if (o->status == SPH_OK) o->status = status;
    return o->status;
}

/* What the target is now. A link is followed, so that what it points to is replaced. */
static sph_status find_target(sph__io_output *o, const char *path, mode_t *mode)
{
    char resolved[PATH_MAX];
    struct stat found;
    *mode = 0;
    if (lstat(path, &found) == 0) {
        if (S_ISLNK(found.st_mode) && realpath(path, resolved) != NULL) path = resolved;
        if (stat(path, &found) == 0) {
            if (!S_ISREG(found.st_mode))
                return sph__io_fail(o->context, SPH_E_IO, "%s: %s, not a file", sph__io_shown(path),
                                    S_ISDIR(found.st_mode) ? "a directory" : "a pipe or a device");
            *mode = found.st_mode & 0777;
        }
    }
    o->target = sph__io_copy_string(o->context, path);
    return o->target == NULL ? sph__io_fail_memory(o->context, path) : SPH_OK;
}

/* A name in the target's directory that nobody uses; short, so that it is allowed wherever the target's is. */
static sph_status open_temporary(sph__io_output *o)
{
    const char *slash = strrchr(o->target, '/');
    const size_t length = slash == NULL ? 0 : (size_t)(slash + 1 - o->target);
    char *name = sph_context_allocate(o->context, length + SUFFIX_SIZE, 1);
    if (name == NULL) return sph__io_fail_memory(o->context, o->target);
    memcpy(name, o->target, length);
    for (unsigned i = 0; i < ATTEMPTS && o->file < 0; ++i) {
        snprintf(name + length, SUFFIX_SIZE, ".sphmesh-%ld-%u.tmp", (long)getpid(), i);
        o->file = open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (o->file < 0 && errno != EEXIST) break;
    }
    if (o->file < 0) {
        const sph_status status = sph__io_fail_system(o->context, o->target, "cannot be written");
        sph_context_release(o->context, name);
        return status;
    }
    o->temporary = name;
    return SPH_OK;
}

sph_status sph__io_output_open(sph_context *context, const char *path, sph__io_output *output)
{
    mode_t mode;
    sph_status status;
    *output = (sph__io_output){.context = context, .file = -1};
    if (*path == '\0') return sph_context_fail(context, SPH_E_INVALID, "the name of a file to write is empty");
    output->buffer = sph_context_allocate(context, BUFFER_SIZE, 1);
    if (output->buffer == NULL) return sph__io_fail_memory(context, path);
    status = find_target(output, path, &mode);
    if (status == SPH_OK) status = open_temporary(output);
    if (status == SPH_OK && mode != 0) (void)fchmod(output->file, mode); /* as the file that it replaces */
    if (status != SPH_OK) sph__io_output_release(output);
    return status;
}

static void write_all(sph__io_output *o, const unsigned char *bytes, size_t size)
{
    while (size != 0 && o->status == SPH_OK) {
        const ssize_t written = write(o->file, bytes, size < INT_MAX ? size : INT_MAX);
        if (written < 0 && errno != EINTR) fail(o, sph__io_fail_system(o->context, o->target, "cannot be written"));
        if (written <= 0) continue;
        bytes += written;
        size -= (size_t)written;
    }
}

static void flush(sph__io_output *o)
{
    write_all(o, o->buffer, o->used);
    o->used = 0;
}

void sph__io_output_bytes(sph__io_output *output, const void *bytes, size_t size)
{
    if (output->status != SPH_OK || size == 0) return;
    if (size > BUFFER_SIZE - output->used) flush(output);
    if (size >= BUFFER_SIZE) {
        write_all(output, bytes, size);
        return;
    }
    memcpy(output->buffer + output->used, bytes, size);
    output->used += size;
}

void sph__io_output_text(sph__io_output *output, const char *format, ...)
{
    char text[TEXT_SIZE];
    va_list arguments;
    int length;
    va_start(arguments, format);
    length = vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (length < 0 || length >= TEXT_SIZE)
        fail(output,
             sph__io_fail(output->context, SPH_E_IO, "%s: a line cannot be formatted", sph__io_shown(output->target)));
    else
        sph__io_output_bytes(output, text, (size_t)length);
}

void sph__io_output_float(sph__io_output *output, float value)
{
    char text[SPH__IO_FLOAT_TEXT];
    sph__io_output_bytes(output, text, sph__io_format_float(text, value));
}

void sph__io_output_floats(sph__io_output *output, const float *values, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        if (i != 0) sph__io_output_bytes(output, " ", 1);
        sph__io_output_float(output, values[i]);
    }
}

sph_status sph__io_output_finish(sph__io_output *output)
{
    const int file = output->file;
    flush(output);
    output->file = -1;
    if (file >= 0 && close(file) != 0 && errno != EINTR)
        fail(output, sph__io_fail_system(output->context, output->target, "cannot be written"));
    return output->status;
}

sph_status sph__io_output_commit(sph__io_output *output)
{
    if (output->status != SPH_OK) return output->status;
    if (rename(output->temporary, output->target) != 0)
        return fail(output, sph__io_fail_system(output->context, output->target, "cannot be put in place"));
    sph_context_release(output->context, output->temporary);
    output->temporary = NULL;
    return SPH_OK;
}

void sph__io_output_release(sph__io_output *output)
{
    if (output->context == NULL) return;
    if (output->file >= 0) close(output->file);
    if (output->temporary != NULL) unlink(output->temporary);
    sph_context_release(output->context, output->temporary);
    sph_context_release(output->context, output->target);
    sph_context_release(output->context, output->buffer);
    *output = (sph__io_output){.file = -1};
}
