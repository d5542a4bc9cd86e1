/* SPDX-License-Identifier: MIT */
/* Text by lines, for the readers of meshes. */
#include <stdio.h>
#include <string.h>

#include "io/reader.h"

sph__io_text sph__io_text_of(sph_context *context, const char *path, const sph__io_map *map)
{
    const char *start = (const char *)map->bytes;
    return (sph__io_text){.context = context, .path = path, .p = start, .end = start + map->size, .line = 1};
}

sph_status sph__io_text_fail(const sph__io_text *text, const char *what)
{
    return sph__io_fail(text->context, SPH_E_FORMAT, "%s: line %zu: %s", sph__io_shown(text->path), text->line, what);
}

void sph__io_next_line(sph__io_text *text)
{
    const char *p = text->p, *end = text->end;
    while (p < end && *p != '\n' && *p != '\r')
        ++p;
    if (p < end) {
        if (*p == '\r' && end - p >= 2 && p[1] == '\n') ++p;
        ++p;
        ++text->line;
    }
    text->p = p;
}

static bool at_digit(const sph__io_text *text)
{
    return text->p < text->end && (unsigned char)(*text->p - '0') <= 9;
}

bool sph__io_text_integer(sph__io_text *text, int64_t *value)
{
    const bool negative = text->p < text->end && *text->p == '-';
    *value = 0;
    if (text->p < text->end && (*text->p == '-' || *text->p == '+')) ++text->p;
    if (!at_digit(text)) return false;
    for (; at_digit(text); ++text->p)
        if (*value <= SPH__IO_INDEX_LIMIT) *value = *value * 10 + (*text->p - '0');
    if (negative) *value = -*value;
    return true;
}

size_t sph__io_word_length(const sph__io_text *text)
{
    sph__io_text rest = *text;
    while (!sph__io_at_token_end(&rest))
        ++rest.p;
    return (size_t)(rest.p - text->p);
}

bool sph__io_take_word(sph__io_text *text, const char *word)
{
    const size_t length = sph__io_word_length(text);
    if (length != strlen(word) || memcmp(text->p, word, length) != 0) return false;
    text->p += length;
    return true;
}

bool sph__io_take_any_case(sph__io_text *text, const char *word)
{
    const size_t length = strlen(word);
    if ((size_t)(text->end - text->p) < length) return false;
    for (size_t i = 0; i < length; ++i)
        if ((text->p[i] | 0x20) != word[i]) return false;
    text->p += length;
    if (sph__io_at_token_end(text)) return true;
    text->p -= length;
    return false;
}

void sph__io_warn_of_rest(sph__io_text *text)
{
    char message[300];
    if (!sph__io_skip_empty_lines(text)) return;
    snprintf(message, sizeof message, "%s: line %zu: the mesh ends before; the rest is left out",
             sph__io_shown(text->path), text->line);
    sph_context_log(text->context, SPH_LOG_WARNING, message);
}
