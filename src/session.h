/* SPDX-License-Identifier: MIT */
/* One run of a command: the library's context, what it says while it works, and how a failure is told. */
#ifndef SESSION_H
#define SESSION_H

#include <sphmesh/io.h>

#include "options.h"
#include "program.h"
#include "progress.h"

typedef struct session {
    sph_context *context;
    sph_context *plain;  /* with a memory limit: the context that has none, */
    sph_io_spill *spill; /* and what the other one takes its memory from */
    progress progress;
    bool quiet, json;
} session;

#define MEMORY_OPTIONS(memory)                                                                                         \
    {"memory-limit", 0, OPTION_SIZE, &(memory).limit, (double)SPH_IO_SPILL_LEAST, 0, NULL},                            \
    {                                                                                                                  \
        "temporary-folder", 0, OPTION_TEXT, &(memory).folder, 0, 0, NULL                                               \
    }

/* What a command does with its own options (the `work` and `options` of session_run) while a session is open. */
typedef int session_work(session *s, const void *options, const arguments *paths);
/*
 * All that a command does once its options are read: where `parsed` is DONE, prints its help if that was asked for, or
 * opens a session, does the work and closes it. Frees the paths in any case. Returns how the command ends.
 */
int session_run(int parsed, const subcommand *command, const common_options *common, session_work *work,
                const void *options, arguments *paths);
/* Tells of a library call that failed (or that Ctrl-C stopped); `subject` is a file or NULL. Returns FAILED. */
int session_fail(session *s, sph_status status, const char *subject);

/* How to read the input of a command. */
typedef struct input_options {
    const char *cache;
    frame_range frames;
    int up;
    double scale, fps; /* fps 0: what the format has */
    const char *clip, *object;
    int space;
} input_options;

extern const char *const up_choices[], *const space_choices[];

#define INPUT_OPTIONS(input)                                                                                           \
    {"cache", 0, OPTION_TEXT, &(input).cache, 0, 0, NULL}, {"frames", 0, OPTION_FRAMES, &(input).frames, 0, 0, NULL},  \
        {"up", 0, OPTION_CHOICE, &(input).up, 0, 0, up_choices},                                                       \
        {"fps", 0, OPTION_NUMBER, &(input).fps, 1e-3, 1e6, NULL}, {"clip", 0, OPTION_TEXT, &(input).clip, 0, 0, NULL}, \
        {"object", 0, OPTION_TEXT, &(input).object, 0, 0, NULL},                                                       \
        {"space", 0, OPTION_CHOICE, &(input).space, 0, 0, space_choices},                                              \
    {                                                                                                                  \
        "scale", 0, OPTION_NUMBER, &(input).scale, -1e30, 1e30, NULL                                                   \
    }
#define INPUT_DEFAULTS                                                                                                 \
    {                                                                                                                  \
        .frames = {.step = 1}, .scale = 1                                                                              \
    }

/* What can be wrong with it before any file is opened: DONE or USAGE. */
int input_check(const char *command, const input_options *input, const arguments *paths);
/* Opens the frames in `frames` of the input; NULL: all. */
sph_status input_open(session *s, const input_options *input, const arguments *paths, const frame_range *frames,
                      sph_animation **out);
/* Loads a level, .json or .sphm: DONE, or FAILED after it has said why. */
int load_level(session *s, const char *path, sph_level **out);
/* True where the name ends like this, in either case. */
bool name_ends(const char *name, const char *ending);
/* The name with another ending, which is as long as its own; free(). NULL: out of memory. */
char *name_with_ending(const char *name, const char *ending);
/* DONE, or USAGE where no level can be written under such a name. */
int output_check_level(const char *command, const char *path);
/* Bytes of a file, 0 where there is none; and the most memory that the program has had. */
uint64_t file_size(const char *path);
uint64_t peak_memory(void);

#endif
