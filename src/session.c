/* SPDX-License-Identifier: MIT */
#include "session.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "program.h"

const char *const up_choices[] = {"y", "z", NULL}, *const space_choices[] = {"local", "world", NULL};

static void log_message(void *user, int32_t severity, const char *message)
{
    session *s = user;
    if (s->quiet || severity != SPH_LOG_WARNING) return;
    progress_clear(&s->progress);
    fprintf(stderr, "sphmesh: warning: %s\n", message);
}

int session_open(session *s, const common_options *common)
{
    sph_context_options o;
    sph_status status;
    *s = (session){.quiet = common->quiet, .json = common->json};
    progress_init(&s->progress, common->progress, common->quiet);
    interrupt_catch();
    sph_context_options_init(&o, sizeof o);
    o.thread_count = common->threads;
    o.progress = progress_callback;
    o.progress_user = &s->progress;
    o.log = log_message;
    o.log_user = s;
    status = sph_context_create(&o, &s->context);
    return status == SPH_OK ? DONE : failure("cannot start: %s", sph_status_text(status));
}

void session_close(session *s)
{
    progress_clear(&s->progress);
    sph_context_destroy(s->context);
    s->context = NULL;
}

int session_fail(session *s, sph_status status, const char *subject)
{
    const char *message = sph_context_last_message(s->context);
    progress_clear(&s->progress);
    if (status == SPH_E_CANCELLED || interrupted()) return failure("cancelled");
    if (message[0] == '\0') message = sph_status_text(status);
    if (subject == NULL || strstr(message, subject) != NULL) return failure("%s", message);
    return failure("%s: %s", subject, message);
}

int input_check(const char *command, const input_options *input, const arguments *paths)
{
    if (paths->count == 0) return usage_error(command, "no input: name a mesh, or several that are frames of one");
    if (paths->count > 1 && input->cache != NULL)
        return usage_error(command, "--cache: it goes with one mesh, not with %zu", paths->count);
    if (input->scale == 0) return usage_error(command, "--scale: 0 would leave nothing");
    return DONE;
}

sph_status input_open(session *s, const input_options *input, const arguments *paths, const frame_range *frames,
                      sph_animation **out)
{
    sph_io_open_options o;
    sph_io_open_options_init(&o, sizeof o);
    o.cache_path = input->cache;
    o.up_axis = input->up;
    o.scale = input->scale;
    o.fps = input->fps;
    o.clip = input->clip;
    o.object = input->object;
    o.space = input->space;
    if (frames != NULL && frames->given) {
        o.first_frame = frames->first;
        o.end_frame = frames->end;
        o.frame_step = frames->step;
    }
    return sph_io_open_animation(s->context, paths->items, paths->count, &o, out);
}

bool name_ends(const char *name, const char *ending)
{
    const size_t length = strlen(name), tail = strlen(ending);
    return length > tail && strcasecmp(name + length - tail, ending) == 0;
}

int output_check_level(const char *command, const char *path)
{
    if (path == NULL) return usage_error(command, "-o is missing: where should the level go?");
    if (name_ends(path, ".json") || name_ends(path, ".obj") || name_ends(path, ".ply") || name_ends(path, ".glb") ||
        name_ends(path, ".sphm"))
        return DONE;
    return usage_error(command, "-o: '%s' does not end in .json, .obj, .ply, .glb or .sphm", path);
}

int load_level(session *s, const char *path, sph_level **out)
{
    sph_status status = SPH_OK;
    int32_t kind = SPH_IO_LEVEL;
    if (name_ends(path, ".sphm")) status = sph_io_identify(s->context, path, &kind);
    if (status == SPH_OK && kind == SPH_IO_HIERARCHY)
        return failure("%s: holds a hierarchy; take a level first: sphmesh level %s --spheres K -o L.json", path, path);
    if (status == SPH_OK) status = sph_io_load_level(s->context, path, out);
    return status == SPH_OK ? DONE : session_fail(s, status, path);
}

uint64_t file_size(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && info.st_size > 0 ? (uint64_t)info.st_size : 0;
}

uint64_t peak_memory(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? (uint64_t)usage.ru_maxrss * 1024 : 0;
}
