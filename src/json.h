/* SPDX-License-Identifier: MIT */
/* Writes one JSON value to a stream. */
#ifndef JSON_H
#define JSON_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

typedef struct json {
    FILE *to;
    int depth;
    bool one_line, first; /* `first`: nothing stands in the open bracket yet */
} json;

/* `name` is NULL inside an array and for the outermost value. */
void json_start(json *j, FILE *to, bool one_line);
void json_open(json *j, const char *name, char bracket);
void json_close(json *j, char bracket);
void json_text(json *j, const char *name, const char *text); /* bytes that are no UTF-8 become U+FFFD; NULL is null */
void json_number(json *j, const char *name, double value);   /* what is not finite is null */
void json_integer(json *j, const char *name, uint64_t value);
void json_boolean(json *j, const char *name, bool value);
void json_null(json *j, const char *name);
void json_finish(json *j);

#endif
