/* SPDX-License-Identifier: MIT */
#include "options.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"

enum { NAMES_MAX = 64 };

const char *const progress_choices[] = {"auto", "bar", "plain", "json", "none", NULL};

/* Digits only: strtoul alone would take "-1" and " 7". */
static bool read_count(const char *text, const char **end, uint32_t *out)
{
    unsigned long long value;
    char *after;
    if (text[0] < '0' || text[0] > '9') return false;
    errno = 0;
    value = strtoull(text, &after, 10);
    if (errno != 0 || value > UINT32_MAX) return false;
    *end = after;
    *out = (uint32_t)value;
    return true;
}

static bool read_number(const char *text, double *out)
{
    char *end;
    if (text[0] == '\0' || strchr(" \t\n\v\f\r", text[0]) != NULL) return false;
    *out = strtod(text, &end);
    return *end == '\0' && isfinite(*out);
}

/* 512M, 1.5G, 100000: bytes. */
static bool read_size(const char *text, uint64_t *out)
{
    static const char UNITS[] = "KMGT";
    char *end;
    const char *unit;
    double value;
    if ((text[0] < '0' || text[0] > '9') && text[0] != '.') return false;
    value = strtod(text, &end);
    unit = *end == '\0' ? NULL : strchr(UNITS, *end >= 'a' ? *end - 'a' + 'A' : *end);
    if (*end != '\0') {
        if (unit == NULL) return false;
        for (const char *p = UNITS; p <= unit; ++p)
            value *= 1024;
        ++end;
        if (*end == 'i') ++end;
        if (*end == 'B' || *end == 'b') ++end;
    }
    if (*end != '\0' || !(value < 9e18)) return false;
    *out = (uint64_t)value;
    return true;
}

bool read_frames(const char *text, frame_range *out)
{
    frame_range r = {true, 0, 0, 1};
    if (*text != ':' && !read_count(text, &text, &r.first)) return false;
    if (*text == '\0') {
        r.end = r.first + 1;
        *out = r;
        return r.first < UINT32_MAX;
    }
    if (*text++ != ':') return false;
    if (*text >= '0' && *text <= '9' && (!read_count(text, &text, &r.end) || r.end <= r.first)) return false;
    if (*text == ':' && text[1] != '\0' && (!read_count(text + 1, &text, &r.step) || r.step == 0)) return false;
    if (*text == ':') ++text;
    *out = r;
    return *text == '\0';
}

static int bad_value(const char *command, const option *o, const char *value)
{
    char list[256] = "";
    size_t count = 0;
    const char *close;
    switch (o->kind) {
    case OPTION_COUNT:
        return usage_error(command, "--%s: '%s' is not a whole number from %.0f to %.0f", o->name, value, o->least,
                           o->most);
    case OPTION_NUMBER:
        if (o->most < 1e30)
            return usage_error(command, "--%s: '%s' is not a number from %g to %g", o->name, value, o->least, o->most);
        if (o->least > -1e30)
            return usage_error(command, "--%s: '%s' is not a number of at least %g", o->name, value, o->least);
        return usage_error(command, "--%s: '%s' is not a number", o->name, value);
    case OPTION_SIZE:
        return usage_error(command, "--%s: '%s' is not a size of at least %.0fM, such as 512M or 2G", o->name, value,
                           o->least / 1048576);
    case OPTION_FRAMES:
        return usage_error(command, "--%s: '%s' is not A:B or A:B:STEP with A below B and STEP above 0", o->name,
                           value);
    default:
        break;
    }
    for (; o->choices[count] != NULL; ++count) {
        const size_t used = strlen(list);
        snprintf(list + used, sizeof list - used, "%s%s", count == 0 ? "" : ", ", o->choices[count]);
    }
    close = closest_name(value, o->choices, count);
    return usage_error(command, "--%s: '%s' is not one of %s%s%s%s", o->name, value, list,
                       close == NULL ? "" : " (did you mean '", close == NULL ? "" : close, close == NULL ? "" : "'?)");
}

static int set_value(const char *command, const option *o, const char *value)
{
    const char *end = "";
    double number;
    uint32_t count;
    uint64_t size;
    switch (o->kind) {
    case OPTION_TEXT:
        if (*value == '\0') return usage_error(command, "--%s: the value is empty", o->name);
        *(const char **)o->target = value;
        return DONE;
    case OPTION_COUNT:
        if (!read_count(value, &end, &count) || *end != '\0' || count < o->least || count > o->most) break;
        *(uint32_t *)o->target = count;
        return DONE;
    case OPTION_NUMBER:
        if (!read_number(value, &number) || number < o->least || number > o->most) break;
        *(double *)o->target = number;
        return DONE;
    case OPTION_SIZE:
        if (!read_size(value, &size) || (double)size < o->least) break;
        *(uint64_t *)o->target = size;
        return DONE;
    case OPTION_CHOICE:
        for (int i = 0; o->choices[i] != NULL; ++i) {
            if (strcmp(o->choices[i], value) != 0) continue;
            *(int *)o->target = i;
            return DONE;
        }
        break;
    case OPTION_FRAMES:
        if (!read_frames(value, o->target)) break;
        return DONE;
    default:
        return DONE;
    }
    return bad_value(command, o, value);
}

static int unknown_option(const char *command, const option *table, const char *name, int length)
{
    const char *names[NAMES_MAX], *close;
    char word[64];
    size_t count = 0;
    for (const option *o = table; o->kind != OPTION_END && count < NAMES_MAX; ++o)
        names[count++] = o->name;
    snprintf(word, sizeof word, "%.*s", length, name);
    close = closest_name(word, names, count);
    if (close == NULL) return usage_error(command, "unknown option '--%s'", word);
    return usage_error(command, "unknown option '--%s' (did you mean '--%s'?)", word, close);
}

/* One "--name", "--name=value", "-x" or "-xvalue". `next` is what follows it, and *used whether it was the value. */
static int read_option(const char *command, const option *table, const char *text, const char *next, bool *used)
{
    const bool is_long = text[1] == '-';
    const char *name = text + (is_long ? 2 : 1);
    const int length = is_long ? (int)strcspn(name, "=") : 1;
    const char *value = name[length] == '\0' ? NULL : is_long ? name + length + 1 : name + 1;
    const option *o = table;
    *used = false;
    for (; o->kind != OPTION_END; ++o)
        if (is_long ? strlen(o->name) == (size_t)length && strncmp(o->name, name, (size_t)length) == 0
                    : o->letter == *name)
            break;
    if (o->kind == OPTION_END)
        return is_long ? unknown_option(command, table, name, length)
                       : usage_error(command, "unknown option '-%c'", *name);
    if (o->kind == OPTION_FLAG) {
        if (value != NULL) return usage_error(command, "'%s': --%s takes no value", text, o->name);
        *(bool *)o->target = true;
        return DONE;
    }
    if (value == NULL) {
        if (next == NULL) return usage_error(command, "--%s: the value is missing", o->name);
        value = next;
        *used = true;
    }
    return set_value(command, o, value);
}

int options_parse(const char *command, const option *table, int argc, char **argv, arguments *rest)
{
    bool only_arguments = false, used;
    const bool *help = NULL;
    for (const option *o = table; o->kind != OPTION_END; ++o)
        if (strcmp(o->name, "help") == 0) help = o->target;
    rest->count = 0;
    rest->items = malloc((size_t)(argc > 0 ? argc : 1) * sizeof *rest->items);
    if (rest->items == NULL) return failure("out of memory");
    for (int i = 1; i < argc; ++i) {
        int result;
        if (only_arguments || argv[i][0] != '-' || argv[i][1] == '\0') {
            rest->items[rest->count++] = argv[i];
            continue;
        }
        if (strcmp(argv[i], "--") == 0) {
            only_arguments = true;
            continue;
        }
        result = read_option(command, table, argv[i], i + 1 < argc ? argv[i + 1] : NULL, &used);
        if (result != DONE || (help != NULL && *help)) return result;
        i += used;
    }
    return DONE;
}
