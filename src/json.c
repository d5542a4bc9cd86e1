/* SPDX-License-Identifier: MIT */
#include "json.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

/* Length of the UTF-8 sequence at `s`; 0 where there is none. */
static int sequence_length(const unsigned char *s)
{
    const int length = s[0] < 0x80                   ? 1
                       : s[0] >= 0xC2 && s[0] < 0xE0 ? 2
                       : s[0] >= 0xE0 && s[0] < 0xF0 ? 3
                       : s[0] >= 0xF0 && s[0] < 0xF5 ? 4
                                                     : 0;
    for (int i = 1; i < length; ++i)
        if ((s[i] & 0xC0) != 0x80) return 0;
    if ((s[0] == 0xE0 && s[1] < 0xA0) || (s[0] == 0xED && s[1] >= 0xA0)) return 0; /* too long, surrogates */
    if ((s[0] == 0xF0 && s[1] < 0x90) || (s[0] == 0xF4 && s[1] >= 0x90)) return 0; /* too long, too large */
    return length;
}

static void put_string(FILE *to, const char *text)
{
    const unsigned char *s = (const unsigned char *)text;
    putc('"', to);
    while (*s != '\0') {
        const int length = sequence_length(s);
        if (length == 0)
            fputs("\\ufffd", to);
        else if (*s == '"' || *s == '\\')
            fprintf(to, "\\%c", *s);
        else if (*s < 0x20 || *s == 0x7F)
            fprintf(to, "\\u%04x", *s);
        else
            fwrite(s, 1, (size_t)length, to);
        s += length == 0 ? 1 : length;
    }
    putc('"', to);
}

static void put_line(json *j)
{
    if (j->one_line) return;
    putc('\n', j->to);
    for (int i = 0; i < j->depth; ++i)
        fputs("  ", j->to);
}

static void put_name(json *j, const char *name)
{
    if (!j->first) fputs(j->one_line ? ", " : ",", j->to);
    j->first = false;
    if (j->depth > 0) put_line(j);
    if (name == NULL) return;
    put_string(j->to, name);
    fputs(": ", j->to);
}

void json_start(json *j, FILE *to, bool one_line)
{
    *j = (json){.to = to, .one_line = one_line, .first = true};
}

void json_open(json *j, const char *name, char bracket)
{
    put_name(j, name);
    putc(bracket, j->to);
    ++j->depth;
    j->first = true;
}

void json_close(json *j, char bracket)
{
    --j->depth;
    if (!j->first) put_line(j);
    putc(bracket, j->to);
    j->first = false;
}

void json_text(json *j, const char *name, const char *text)
{
    put_name(j, name);
    if (text == NULL)
        fputs("null", j->to);
    else
        put_string(j->to, text);
}

void json_number(json *j, const char *name, double value)
{
    char text[32];
    put_name(j, name);
    if (!isfinite(value)) {
        fputs("null", j->to);
        return;
    }
    for (int digits = 6; digits <= 17; ++digits) { /* as short as it reads back exactly */
        snprintf(text, sizeof text, "%.*g", digits, value);
        if (strtod(text, NULL) == value) break;
    }
    fputs(text, j->to);
}

void json_integer(json *j, const char *name, uint64_t value)
{
    put_name(j, name);
    fprintf(j->to, "%" PRIu64, value);
}

void json_boolean(json *j, const char *name, bool value)
{
    put_name(j, name);
    fputs(value ? "true" : "false", j->to);
}

void json_null(json *j, const char *name)
{
    put_name(j, name);
    fputs("null", j->to);
}

void json_finish(json *j)
{
    putc('\n', j->to);
}
