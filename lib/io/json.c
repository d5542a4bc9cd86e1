/* SPDX-License-Identifier: MIT */
/* A strict JSON reader that hands values out as it comes to them: no tree, no memory. */
#include <string.h>

#include "io/io.h"

enum { DEPTH_LIMIT = 64 };

sph_status sph__io_json_fail(const sph__io_json *json, const char *what)
{
    return sph__io_fail(json->context, SPH_E_FORMAT, "%s: byte %zu: %s", sph__io_shown(json->path),
                        (size_t)(json->p - json->start), what);
}

char sph__io_json_peek(sph__io_json *json)
{
    while (json->p < json->end && (*json->p == ' ' || *json->p == '\t' || *json->p == '\n' || *json->p == '\r'))
        ++json->p;
    return json->p < json->end ? *json->p : '\0';
}

sph_status sph__io_json_take(sph__io_json *json, char c, const char *what)
{
    if (sph__io_json_peek(json) != c || json->p == json->end) return sph__io_json_fail(json, what);
    ++json->p;
    return SPH_OK;
}

sph_status sph__io_json_next(sph__io_json *json, char close, bool *first, bool *more)
{
    const char c = sph__io_json_peek(json);
    *more = false;
    if (json->p < json->end && c == close) {
        ++json->p;
        return SPH_OK;
    }
    if (!*first) {
        const sph_status status = sph__io_json_take(json, ',', close == ']' ? "not , or ]" : "not , or }");
        if (status != SPH_OK) return status;
    }
    *first = false;
    *more = true;
    return SPH_OK;
}

static int hexadecimal(char c)
{
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/* The four digits after \u. */
static bool read_code(sph__io_json *json, uint32_t *code)
{
    *code = 0;
    if (json->end - json->p < 4) return false;
    for (unsigned i = 0; i < 4; ++i) {
        const int digit = hexadecimal(json->p[i]);
        if (digit < 0) return false;
        *code = *code << 4 | (unsigned)digit;
    }
    json->p += 4;
    return true;
}

/* A character as UTF-8; what is none (half a pair, or 0, which would end the text) as '?'. Returns the length. */
static size_t encode(uint32_t code, char c[4])
{
    if (code == 0 || (code >= 0xD800 && code < 0xE000)) code = '?';
    if (code < 0x80) {
        c[0] = (char)code;
        return 1;
    }
    if (code < 0x800) {
        c[0] = (char)(0xC0 | code >> 6);
        c[1] = (char)(0x80 | (code & 0x3F));
        return 2;
    }
    if (code < 0x10000) {
        c[0] = (char)(0xE0 | code >> 12);
        c[1] = (char)(0x80 | (code >> 6 & 0x3F));
        c[2] = (char)(0x80 | (code & 0x3F));
        return 3;
    }
    c[0] = (char)(0xF0 | code >> 18);
    c[1] = (char)(0x80 | (code >> 12 & 0x3F));
    c[2] = (char)(0x80 | (code >> 6 & 0x3F));
    c[3] = (char)(0x80 | (code & 0x3F));
    return 4;
}

/* After the backslash. */
static sph_status read_escape(sph__io_json *json, char c[4], size_t *size)
{
    static const char NAMES[] = "\"\\/bfnrt", VALUES[] = "\"\\/\b\f\n\r\t";
    const char *name = json->p < json->end && *json->p != '\0' ? strchr(NAMES, *json->p) : NULL, *after;
    uint32_t code, second;
    *size = 1;
    if (name != NULL) {
        ++json->p;
        *c = VALUES[name - NAMES];
        return SPH_OK;
    }
    if (json->p == json->end || *json->p++ != 'u' || !read_code(json, &code))
        return sph__io_json_fail(json, "not an escape");
    after = json->p;
    if (code >= 0xD800 && code < 0xDC00 && json->end - json->p >= 6 && json->p[0] == '\\' && json->p[1] == 'u') {
        json->p += 2;
        if (!read_code(json, &second)) return sph__io_json_fail(json, "not an escape");
        if (second >= 0xDC00 && second < 0xE000)
            code = 0x10000 + ((code - 0xD800) << 10) + (second - 0xDC00);
        else
            json->p = after;
    }
    *size = encode(code, c);
    return SPH_OK;
}

sph_status sph__io_json_string(sph__io_json *json, char *text, size_t size)
{
    size_t length = 0;
    sph_status status = sph__io_json_take(json, '"', "not a string");
    while (status == SPH_OK) {
        char c[4];
        size_t count = 1;
        if (json->p == json->end) return sph__io_json_fail(json, "a string without an end");
        c[0] = *json->p;
        if ((unsigned char)c[0] < 0x20) return sph__io_json_fail(json, "a control character in a string");
        ++json->p;
        if (c[0] == '"') break;
        if (c[0] == '\\') status = read_escape(json, c, &count);
        if (length + count < size) {
            memcpy(text + length, c, count);
            length += count;
        }
    }
    if (size != 0) text[length] = '\0';
    return status;
}

static void pass_digits(sph__io_json *json)
{
    while (json->p < json->end && *json->p >= '0' && *json->p <= '9')
        ++json->p;
}

/* Passes over a number as JSON has it; *integer says whether it has no fraction and no exponent. */
static sph_status pass_number(sph__io_json *json, bool *integer)
{
    const char *digits;
    *integer = true;
    if (json->p < json->end && *json->p == '-') ++json->p;
    digits = json->p;
    pass_digits(json);
    if (json->p == digits || (*digits == '0' && json->p - digits > 1)) return sph__io_json_fail(json, "not a number");
    if (json->p < json->end && *json->p == '.') {
        digits = ++json->p;
        pass_digits(json);
        if (json->p == digits) return sph__io_json_fail(json, "not a number");
        *integer = false;
    }
    if (json->p < json->end && (*json->p | 0x20) == 'e') {
        ++json->p;
        if (json->p < json->end && (*json->p == '+' || *json->p == '-')) ++json->p;
        digits = json->p;
        pass_digits(json);
        if (json->p == digits) return sph__io_json_fail(json, "not a number");
        *integer = false;
    }
    return SPH_OK;
}

sph_status sph__io_json_float(sph__io_json *json, float *value)
{
    const char *start;
    bool integer;
    sph_status status;
    (void)sph__io_json_peek(json);
    start = json->p;
    status = pass_number(json, &integer);
    if (status == SPH_OK) (void)sph__io_parse_float(start, json->p, value);
    return status;
}

sph_status sph__io_json_integer(sph__io_json *json, int64_t *value)
{
    const char *p;
    bool integer, negative;
    sph_status status;
    (void)sph__io_json_peek(json);
    p = json->p;
    status = pass_number(json, &integer);
    if (status != SPH_OK) return status;
    if (!integer || json->p - p > 16) return sph__io_json_fail(json, "not an integer, or too large");
    negative = *p == '-';
    *value = 0;
    for (p += negative; p < json->p; ++p)
        *value = *value * 10 + (*p - '0');
    if (negative) *value = -*value;
    return SPH_OK;
}

static sph_status skip_word(sph__io_json *json)
{
    static const char *const WORDS[] = {"true", "false", "null"};
    for (size_t i = 0; i < 3; ++i) {
        const size_t length = strlen(WORDS[i]);
        if ((size_t)(json->end - json->p) >= length && memcmp(json->p, WORDS[i], length) == 0) {
            json->p += length;
            return SPH_OK;
        }
    }
    return sph__io_json_fail(json, "not a value");
}

sph_status sph__io_json_skip(sph__io_json *json)
{
    const char open = sph__io_json_peek(json);
    const char close = open == '{' ? '}' : ']';
    bool first = true, more, integer;
    sph_status status;
    if (open == '"') return sph__io_json_string(json, NULL, 0);
    if (open == '-' || (open >= '0' && open <= '9')) return pass_number(json, &integer);
    if (open != '{' && open != '[') return skip_word(json);
    if (json->depth == DEPTH_LIMIT) return sph__io_json_fail(json, "nested too deep");
    ++json->depth;
    ++json->p;
    while ((status = sph__io_json_next(json, close, &first, &more)) == SPH_OK && more) {
        if (open == '{') {
            status = sph__io_json_string(json, NULL, 0);
            if (status == SPH_OK) status = sph__io_json_take(json, ':', "not :");
        }
        if (status == SPH_OK) status = sph__io_json_skip(json);
        if (status != SPH_OK) return status;
    }
    --json->depth;
    return status;
}
