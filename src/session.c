/* SPDX-License-Identifier: MIT */
#include "session.h"

#include <stdio.h>
#include <stdlib.h>
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

/* Progress is a good moment to look at memory. */
static bool trim_and_go_on(void *user, const char *stage, double fraction)
{
    session *s = user;
    sph_io_spill_trim(s->spill);
    return progress_callback(&s->progress, stage, fraction);
}

static int open_spill(session *s, const memory_options *memory, const sph_context_options *base)
{
    sph_context_options plain = *base;
    sph_io_spill_options o;
    const char *folder = memory->folder != NULL ? memory->folder : getenv("TMPDIR");
    sph_status status;
    status = sph_context_create(&plain, &s->plain);
    if (status != SPH_OK) return failure("cannot start: %s", sph_status_text(status));
    sph_io_spill_options_init(&o, sizeof o);
    o.memory_limit = memory->limit;
    o.folder = folder != NULL && *folder != '\0' ? folder : NULL;
    status = sph_io_spill_create(s->plain, &o, &s->spill);
    return status == SPH_OK ? DONE : failure("--memory-limit: %s", sph_context_last_message(s->plain));
}

static void session_close(session *s)
{
    progress_clear(&s->progress);
    sph_context_destroy(s->context);
    sph_io_spill_destroy(s->spill);
    sph_context_destroy(s->plain);
    s->context = s->plain = NULL;
    s->spill = NULL;
}

/* DONE, or FAILED after it has said why. */
static int session_open(session *s, const common_options *common)
{
    sph_context_options o;
    sph_status status;
    *s = (session){.quiet = common->quiet, .json = common->json};
    progress_init(&s->progress, common->progress, common->quiet);
    interrupt_catch();
    sph_context_options_init(&o, sizeof o);
    o.thread_count = common->threads;
    o.progress = trim_and_go_on;
    o.progress_user = s;
    o.log = log_message;
    o.log_user = s;
    if (common->memory.limit != 0) {
        if (open_spill(s, &common->memory, &o) != DONE) {
            session_close(s);
            return FAILED;
        }
        sph_io_spill_get_allocator(s->spill, &o.allocator);
        sph_io_spill_get_executor(s->spill, &o.executor);
    }
    status = sph_context_create(&o, &s->context);
    if (status == SPH_OK) return DONE;
    session_close(s);
    return failure("cannot start: %s", sph_status_text(status));
}

int session_run(int parsed, const subcommand *command, const common_options *common, session_work *work,
                const void *options, arguments *paths)
{
    session s;
    int result = parsed;
    if (result == DONE && common->help) {
        fputs(command->help, stdout);
    } else if (result == DONE && (result = session_open(&s, common)) == DONE) {
        result = work(&s, options, paths);
        session_close(&s);
    }
    free(paths->items);
    *paths = (arguments){0};
    return result;
}

int session_fail(session *s, sph_status status, const char *subject)
{
    const char *message = sph_context_last_message(s->context);
    progress_clear(&s->progress);
    if (status == SPH_E_CANCELLED || interrupted()) return failure("cancelled");
    if (status == SPH_E_NOMEM && s->spill != NULL && sph_context_last_message(s->plain)[0] != '\0')
        message = sph_context_last_message(s->plain); /* the disk was full, not memory */
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

char *name_with_ending(const char *name, const char *ending)
{
    char *copy = strdup(name);
    if (copy != NULL) memcpy(copy + strlen(name) - strlen(ending), ending, strlen(ending));
    return copy;
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

/* getrusage also counts what the process had before it became this program, where it was started by a larger one. */
uint64_t peak_memory(void)
{
    struct rusage usage;
    unsigned long long kilobytes = 0;
    char line[256];
    FILE *file = fopen("/proc/self/status", "r");
    while (file != NULL && kilobytes == 0 && fgets(line, sizeof line, file) != NULL)
        if (strncmp(line, "VmHWM:", 6) == 0) kilobytes = strtoull(line + 6, NULL, 10);
    if (file != NULL) fclose(file);
    if (kilobytes != 0) return (uint64_t)kilobytes * 1024;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? (uint64_t)usage.ru_maxrss * 1024 : 0;
}
