/* SPDX-License-Identifier: MIT */
/* The table, as text or as JSON. */
#define _XOPEN_SOURCE 700

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "bench.h"

static const char *section = "", *separator = "";
static char notes[4096];

static void processor_name(char *name, size_t size)
{
    char line[256];
    FILE *file = fopen("/proc/cpuinfo", "r");
    snprintf(name, size, "unknown processor");
    while (file != NULL && fgets(line, sizeof line, file) != NULL)
        if (strncmp(line, "model name", 10) == 0 && strchr(line, ':') != NULL) {
            line[strcspn(line, "\n")] = '\0';
            snprintf(name, size, "%s", strchr(line, ':') + 2);
            break;
        }
    if (file != NULL) fclose(file);
}

static double load_average(void)
{
    FILE *file = fopen("/proc/loadavg", "r");
    double load = NAN;
    if (file != NULL && fscanf(file, "%lf", &load) != 1) load = NAN;
    if (file != NULL) fclose(file);
    return load;
}

void bench_begin(void)
{
    char name[128], date[32];
    const time_t now = time(NULL);
    struct tm when;
    processor_name(name, sizeof name);
    strftime(date, sizeof date, "%Y-%m-%d", gmtime_r(&now, &when));
    if (bench.json)
        printf(
            "{\"bench\":\"build\",\"tiny\":%s,\"repeats\":%u,\"date\":\"%s\",\"processor\":\"%s\",\"processors\":%ld,"
            "\"load_average\":%.2f,\"figures\":[",
            bench.tiny ? "true" : "false", (unsigned)bench.repeats, date, name, sysconf(_SC_NPROCESSORS_ONLN),
            load_average());
    else
        printf("%s, %ld processors, %s; load average %.2f; medians of %u runs; times are processor time\n", name,
               sysconf(_SC_NPROCESSORS_ONLN), date, load_average(), (unsigned)bench.repeats);
}

void bench_end(void)
{
    if (bench.json) printf("],\"notes\":[%s]}\n", notes);
}

bool bench_section(const char *name, const char *title)
{
    const bool open = bench.only == NULL || strcmp(bench.only, name) == 0;
    section = name;
    fflush(stdout);
    if (!open || bench.json) return open;
    if (bench.markdown)
        printf("\n%s: %s\n\n| figure | measured | target | |\n|---|---|---|---|\n", name, title);
    else
        printf("\n%s: %s\n", name, title);
    return true;
}

static bool meets(double value, char relation, double target)
{
    return relation == '<' ? value <= target : value >= target;
}

static void print_json(const char *key, double value, const char *unit, char relation, double target)
{
    printf("%s{\"section\":\"%s\",\"key\":\"%s\",\"unit\":\"%s\",\"value\":", separator, section, key, unit);
    separator = ",";
    if (isfinite(value))
        printf("%.6g", value);
    else
        printf("null");
    if (relation != 0)
        printf(",\"target\":%g,\"at\":\"%s\",\"met\":%s", target, relation == '<' ? "most" : "least",
               meets(value, relation, target) ? "true" : "false");
    printf("}");
}

static void print_text(const char *key, double value, const char *unit, char relation, double target)
{
    printf("  %-46s %11.4g %-12s", key, value, unit);
    if (relation != 0)
        printf(" at %s %g: %s", relation == '<' ? "most" : "least", target,
               bench.tiny                       ? "(tiny)"
               : meets(value, relation, target) ? "met"
                                                : "MISSED");
    putchar('\n');
}

static void print_markdown(const char *key, double value, const char *unit, char relation, double target)
{
    printf("| %s | %.4g %s | ", key, value, unit);
    if (relation != 0)
        printf("at %s %g | %s |\n", relation == '<' ? "most" : "least", target,
               meets(value, relation, target) ? "met" : "**missed**");
    else
        printf("| |\n");
}

void bench_figure(const char *key, double value, const char *unit, char relation, double target)
{
    if (bench.json)
        print_json(key, value, unit, relation, target);
    else if (bench.markdown)
        print_markdown(key, value, unit, relation, target);
    else
        print_text(key, value, unit, relation, target);
    fflush(stdout);
}

void bench_note(const char *format, ...)
{
    char text[512];
    const size_t used = strlen(notes);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    for (char *p = text; *p != '\0'; ++p)
        if (*p == '"' || *p == '\\' || (unsigned char)*p < ' ') *p = '\'';
    if (bench.json)
        snprintf(notes + used, sizeof notes - used, "%s\"%s: %s\"", used == 0 ? "" : ",", section, text);
    else
        printf(bench.markdown ? "| %s | | | |\n" : "  %s\n", text);
    fflush(stdout);
}

void bench_die(const sph_context *context, const char *what)
{
    fprintf(stderr, "bench_build: %s: %s\n", what, context == NULL ? "failed" : sph_context_last_message(context));
    exit(1);
}
