/* SPDX-License-Identifier: MIT */
/* What all commands share: how a command is described, and how it ends. */
#ifndef PROGRAM_H
#define PROGRAM_H

#include <stdbool.h>
#include <stddef.h>

/* Exit codes. */
enum { DONE = 0, FAILED = 1, USAGE = 2 };

typedef struct subcommand {
    const char *name;
    const char *summary;               /* one line for the list of commands */
    const char *help;                  /* the whole page */
    int (*run)(int argc, char **argv); /* argv[0] is the command's name */
} subcommand;

extern const subcommand build_command, info_command, level_command, measure_command, convert_command, surface_command,
    cast_command, export_command, skin_command, pose_command, simplify_command, render_command, demo_command;

/* Prints "sphmesh COMMAND: ..." and where to find help; returns USAGE. `name` may be NULL. */
int usage_error(const char *name, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Prints "sphmesh: ..."; returns FAILED. */
int failure(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* The one of `count` names that `word` was probably meant to be, or NULL. */
const char *closest_name(const char *word, const char *const *names, size_t count);

#endif
