/* SPDX-License-Identifier: MIT */
/* Command lines: a table of options goes in, filled variables come out. */
#ifndef OPTIONS_H
#define OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum option_kind {
    OPTION_END,    /* ends a table */
    OPTION_FLAG,   /* bool: no value */
    OPTION_TEXT,   /* const char * */
    OPTION_COUNT,  /* uint32_t from `least` to `most` */
    OPTION_NUMBER, /* double from `least` to `most` */
    OPTION_CHOICE, /* int: index into `choices` */
    OPTION_SIZE,   /* uint64_t: bytes, with K, M, G or T after the number for more; at least `least` */
    OPTION_FRAMES  /* frame_range */
} option_kind;

/* A:B:STEP: frames A, A + STEP, ... below B. */
typedef struct frame_range {
    bool given;
    uint32_t first, end, step; /* end 0: to the last */
} frame_range;

typedef struct option {
    const char *name; /* without the dashes */
    char letter;      /* 0: none */
    option_kind kind;
    void *target;
    double least, most;
    const char *const *choices; /* ends with NULL */
} option;

/* What is no option. */
typedef struct arguments {
    const char **items; /* free() */
    size_t count;
} arguments;

/* How much memory a command may have resident, and where the rest goes. */
typedef struct memory_options {
    uint64_t limit;     /* 0: as much as it wants */
    const char *folder; /* NULL: $TMPDIR, else /var/tmp */
} memory_options;

/* Options that every command takes; `memory` stays 0 where a command's table lacks MEMORY_OPTIONS. */
typedef struct common_options {
    bool help, json, quiet;
    int progress; /* one of PROGRESS_* */
    uint32_t threads;
    memory_options memory;
} common_options;

enum { PROGRESS_AUTO, PROGRESS_BAR, PROGRESS_PLAIN, PROGRESS_JSON, PROGRESS_NONE };
extern const char *const progress_choices[];

#define COMMON_OPTIONS(common)                                                                                         \
    {"help", 'h', OPTION_FLAG, &(common).help, 0, 0, NULL}, {"json", 0, OPTION_FLAG, &(common).json, 0, 0, NULL},      \
        {"quiet", 'q', OPTION_FLAG, &(common).quiet, 0, 0, NULL},                                                      \
        {"progress", 0, OPTION_CHOICE, &(common).progress, 0, 0, progress_choices},                                    \
        {"threads", 0, OPTION_COUNT, &(common).threads, 0, 256, NULL},                                                 \
    {                                                                                                                  \
        NULL, 0, OPTION_END, NULL, 0, 0, NULL                                                                          \
    }

/* A:B:STEP, where every part may be missing; A alone is that frame alone. False where it is something else. */
bool read_frames(const char *text, frame_range *out);

/*
 * Reads argv[1] and on; options and arguments may be mixed, "--" ends the options. Returns DONE, or USAGE after it has
 * said which option is wrong. Stops at --help, which is an option of the table like the others.
 */
int options_parse(const char *command, const option *table, int argc, char **argv, arguments *rest);

#endif
