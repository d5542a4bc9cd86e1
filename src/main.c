/* SPDX-License-Identifier: MIT */
/* The sphmesh program: finds the command and hands over. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sphmesh/version.h>

#include "program.h"

static const subcommand *const COMMANDS[] = {&build_command,   &info_command,    &level_command,
                                             &measure_command, &convert_command, &surface_command,
                                             &cast_command,    &export_command,  &skin_command,
#ifdef HAVE_PNG
                                             &render_command,
#endif
                                             &pose_command,    &simplify_command, &demo_command};
enum { COMMAND_COUNT = sizeof COMMANDS / sizeof COMMANDS[0] };

int usage_error(const char *name, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fprintf(stderr, "sphmesh%s%s: ", name == NULL ? "" : " ", name == NULL ? "" : name);
    vfprintf(stderr, format, arguments);
    fprintf(stderr, "\nTry 'sphmesh%s%s --help'.\n", name == NULL ? "" : " ", name == NULL ? "" : name);
    va_end(arguments);
    return USAGE;
}

int failure(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fputs("sphmesh: ", stderr);
    vfprintf(stderr, format, arguments);
    putc('\n', stderr);
    va_end(arguments);
    return FAILED;
}

static void print_help(void)
{
    puts("sphmesh turns an animated mesh into a hierarchy of animated sphere-meshes.\n\n"
         "usage: sphmesh COMMAND [OPTION]... [FILE]...\n\ncommands:");
    for (size_t i = 0; i < COMMAND_COUNT; ++i)
        printf("  %-9s %s\n", COMMANDS[i]->name, COMMANDS[i]->summary);
    puts("\n"
         "examples:\n"
         "  sphmesh demo -o demo                              try everything, without a file\n"
         "  sphmesh info horse.obj --cache horse.pc2          is the input sound?\n"
         "  sphmesh build horse.obj --cache horse.pc2 -o horse.sphm\n"
         "  sphmesh build 'frames/s*.obj' -o s.sphm           one mesh per frame\n"
         "  sphmesh level horse.sphm --spheres 40 -o horse-40.json\n"
         "  sphmesh measure horse.obj --cache horse.pc2 --level horse-40.json\n"
         "  sphmesh convert 'scan/s*.ply' -o scan.obj         OBJ with a PC2 cache\n"
         "  sphmesh export horse-40.json -o horse-40.ma       for other tools\n\n"
         "All commands take --json (figures on stdout), --progress HOW (auto, bar, plain,\n"
         "json or none, on stderr), --quiet, --threads N and --help.\n"
         "Exit codes: 0 done, 1 failed or cancelled, 2 wrong usage.\n"
         "'sphmesh help COMMAND' tells more; so does the manual page, sphmesh(1).");
}

static const subcommand *find_command(const char *name)
{
    for (size_t i = 0; i < COMMAND_COUNT; ++i)
        if (strcmp(COMMANDS[i]->name, name) == 0) return COMMANDS[i];
    return NULL;
}

static int unknown_command(const char *name)
{
    const char *names[COMMAND_COUNT + 1], *close;
    for (size_t i = 0; i < COMMAND_COUNT; ++i)
        names[i] = COMMANDS[i]->name;
    names[COMMAND_COUNT] = "help";
    if (name[0] == '-') return usage_error(NULL, "unknown option '%s' (options of a command go after it)", name);
    close = closest_name(name, names, COMMAND_COUNT + 1);
    if (close == NULL) return usage_error(NULL, "unknown command '%s'", name);
    return usage_error(NULL, "unknown command '%s' (did you mean '%s'?)", name, close);
}

static int no_command(void)
{
    char list[16 * COMMAND_COUNT] = "";
    size_t length = 0;
    for (size_t i = 0; i < COMMAND_COUNT && length < sizeof list; ++i)
        length += (size_t)snprintf(list + length, sizeof list - length, "%s, ", COMMANDS[i]->name);
    return usage_error(NULL, "no command; there are %shelp", list);
}

static int run(int argc, char **argv)
{
    const subcommand *c;
    const char *word = argc > 1 ? argv[1] : "";
    if (argc < 2)
        return no_command();
    if (strcmp(word, "--version") == 0 || strcmp(word, "-V") == 0) {
        const unsigned v = sph_version();
        printf("sphmesh %u.%u.%u\n", v / 1000000, v / 1000 % 1000, v % 1000);
        return DONE;
    }
    if (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0 || (strcmp(word, "help") == 0 && argc == 2)) {
        print_help();
        return DONE;
    }
    if (strcmp(word, "help") == 0) word = argv[2];
    c = find_command(word);
    if (c == NULL) return unknown_command(word);
    if (word == argv[1]) return c->run(argc - 1, argv + 1);
    fputs(c->help, stdout);
    return DONE;
}

int main(int argc, char **argv)
{
    const int result = run(argc, argv);
    if ((fflush(stdout) != 0 || ferror(stdout)) && result == DONE) return failure("cannot write to standard output");
    return result;
}
