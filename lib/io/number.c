/* SPDX-License-Identifier: MIT */
/*
 * Floats from decimal text and back, exactly, whatever the locale. Reading is quick where a double tells which float is
 * nearest, which is all but always; else big integers decide.
 */
#include <math.h>
#include <string.h>

#include "io/io.h"

enum {
    LEAST_POWER = -66, /* 19 digits times a smaller power of ten is below half the least float */
    MOST_POWER = 40,   /* anything not 0 times a larger one is beyond the largest float */
    QUICK_DIGITS = 19, /* so many fit in 64 bits */
    EXACT_DIGITS = 120 /* half-way points between floats have at most 113 */
};

static const double POWERS[MOST_POWER - LEAST_POWER + 1] = {
    1e-66, 1e-65, 1e-64, 1e-63, 1e-62, 1e-61, 1e-60, 1e-59, 1e-58, 1e-57, 1e-56, 1e-55, 1e-54, 1e-53, 1e-52, 1e-51,
    1e-50, 1e-49, 1e-48, 1e-47, 1e-46, 1e-45, 1e-44, 1e-43, 1e-42, 1e-41, 1e-40, 1e-39, 1e-38, 1e-37, 1e-36, 1e-35,
    1e-34, 1e-33, 1e-32, 1e-31, 1e-30, 1e-29, 1e-28, 1e-27, 1e-26, 1e-25, 1e-24, 1e-23, 1e-22, 1e-21, 1e-20, 1e-19,
    1e-18, 1e-17, 1e-16, 1e-15, 1e-14, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9,  1e-8,  1e-7,  1e-6,  1e-5,  1e-4,  1e-3,
    1e-2,  1e-1,  1e0,   1e1,   1e2,   1e3,   1e4,   1e5,   1e6,   1e7,   1e8,   1e9,   1e10,  1e11,  1e12,  1e13,
    1e14,  1e15,  1e16,  1e17,  1e18,  1e19,  1e20,  1e21,  1e22,  1e23,  1e24,  1e25,  1e26,  1e27,  1e28,  1e29,
    1e30,  1e31,  1e32,  1e33,  1e34,  1e35,  1e36,  1e37,  1e38,  1e39,  1e40,
};

/* A decimal number as it stands in the text. */
typedef struct decimal {
    const char *digits, *digits_end; /* with at most one point among them */
    uint64_t leading;                /* the first 19 significant digits */
    int64_t exponent;      /* the number is leading * 10^exponent, or a little more where digits are left out */
    int64_t exponent_text; /* what stands after the e */
} decimal;

static bool is_digit(const char *p, const char *end)
{
    return p < end && (unsigned char)(*p - '0') <= 9;
}

static const char *scan_exponent(const char *p, const char *end, decimal *number)
{
    const char *start = p;
    int64_t value = 0;
    bool negative;
    if (p == end || (*p | 0x20) != 'e') return start;
    ++p;
    negative = p < end && *p == '-';
    if (p < end && (*p == '-' || *p == '+')) ++p;
    if (!is_digit(p, end)) return start;
    for (; is_digit(p, end); ++p)
        if (value < INT64_C(100000000000000000)) value = value * 10 + (*p - '0');
    number->exponent_text = negative ? -value : value;
    number->exponent += number->exponent_text;
    return p;
}

static const char *scan_decimal(const char *p, const char *end, decimal *number)
{
    uint64_t leading = 0;
    unsigned significant = 0;
    int64_t exponent = 0;
    bool any = false;
    number->digits = p;
    for (; is_digit(p, end); ++p) {
        any = true;
        if (significant < QUICK_DIGITS) {
            leading = leading * 10 + (uint64_t)(*p - '0');
            significant += leading != 0;
        } else {
            ++exponent;
        }
    }
    if (p < end && *p == '.') {
        const char *point = p++;
        for (; is_digit(p, end); ++p) {
            any = true;
            if (significant < QUICK_DIGITS) {
                leading = leading * 10 + (uint64_t)(*p - '0');
                significant += leading != 0;
                --exponent;
            }
        }
        if (!any) p = point;
    }
    if (!any) return NULL;
    number->digits_end = p;
    number->leading = leading;
    number->exponent = exponent;
    number->exponent_text = 0;
    return scan_exponent(p, end, number);
}

/* --- big integers, just enough to compare a decimal with a half-way point --- */
enum { LIMBS = 48 }; /* 1536 bits: twice what the largest comparison needs */
typedef struct big {
    uint32_t limbs[LIMBS];
    unsigned count;
} big;

static void multiply_add(big *a, uint32_t factor, uint32_t add)
{
    uint64_t carry = add;
    for (unsigned i = 0; i < a->count; ++i) {
        carry += (uint64_t)a->limbs[i] * factor;
        a->limbs[i] = (uint32_t)carry;
        carry >>= 32;
    }
    if (carry != 0 && a->count < LIMBS) a->limbs[a->count++] = (uint32_t)carry;
}

static void multiply_power(big *a, uint32_t factor, int64_t times)
{
    for (; times > 0; --times)
        multiply_add(a, factor, 0);
}

static int compare_big(const big *a, const big *b)
{
    if (a->count != b->count) return a->count < b->count ? -1 : 1;
    for (unsigned i = a->count; i-- > 0;)
        if (a->limbs[i] != b->limbs[i]) return a->limbs[i] < b->limbs[i] ? -1 : 1;
    return 0;
}

/* All significant digits, as integer * 10^exponent; beyond 120 of them only whether they are all 0 matters. */
static int64_t read_digits(const decimal *number, big *integer)
{
    unsigned significant = 0;
    int64_t exponent = number->exponent_text;
    bool fraction = false, rest = false;
    integer->count = 0;
    for (const char *p = number->digits; p < number->digits_end; ++p) {
        if (*p == '.') {
            fraction = true;
        } else if (significant < EXACT_DIGITS) {
            multiply_add(integer, 10, (uint32_t)(*p - '0'));
            significant += integer->count != 0;
            exponent -= fraction;
        } else {
            rest |= *p != '0';
            exponent += !fraction;
        }
    }
    if (rest) {
        multiply_add(integer, 10, 1);
        --exponent;
    }
    return exponent;
}

static uint32_t float_bits(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* The float nearest to a decimal that lies between `low` >= 0 and the next float. */
static float decide(const decimal *number, float low)
{
    const uint32_t bits = float_bits(low), next = bits + 1;
    const uint32_t biased = bits >> 23, fraction = bits & 0x7FFFFF;
    const uint32_t mantissa = biased == 0 ? fraction : fraction | 0x800000;
    const int exponent = (biased == 0 ? 1 : (int)biased) - 150 - 1; /* of the half-way point's last bit */
    big decimal_side, middle = {.count = 0};
    const int64_t ten = read_digits(number, &decimal_side);
    float high;
    int order;
    multiply_add(&middle, 1, 2 * mantissa + 1);
    multiply_power(&decimal_side, 10, ten);
    multiply_power(&middle, 10, -ten);
    multiply_power(&decimal_side, 2, -exponent);
    multiply_power(&middle, 2, exponent);
    order = compare_big(&decimal_side, &middle);
    memcpy(&high, &next, sizeof high);
    if (order == 0) return (bits & 1) == 0 ? low : high;
    return order < 0 ? low : high;
}

static float round_decimal(const decimal *number)
{
    double value;
    float low, high;
    if (number->leading == 0 || number->exponent < LEAST_POWER) return 0;
    if (number->exponent > MOST_POWER) return INFINITY;
    /* Three roundings and the digits left out: within 2^-51, so that the truth is between `low` and `high`. */
    value = (double)number->leading * POWERS[number->exponent - LEAST_POWER];
    low = (float)(value * (1 - 0x1p-50));
    high = (float)(value * (1 + 0x1p-50));
    return low == high ? low : decide(number, low);
}

/* Whether [p, end) begins with the word, in any case of letters. */
static bool begins(const char *p, const char *end, const char *word)
{
    for (; *word != '\0'; ++word, ++p)
        if (p == end || (*p | 0x20) != *word) return false;
    return true;
}

/* nan, nan(...), inf, infinity. */
static const char *scan_special(const char *p, const char *end, float *value)
{
    if (begins(p, end, "inf")) {
        *value = INFINITY;
        return p + (begins(p, end, "infinity") ? 8 : 3);
    }
    if (!begins(p, end, "nan")) return NULL;
    *value = NAN;
    p += 3;
    if (p < end && *p == '(')
        for (const char *q = p; q < end && *q != '\n'; ++q)
            if (*q == ')') return q + 1;
    return p;
}

/* 1.#INF, 1.#IND, 1.#QNAN, 1.#SNAN: how older Windows libraries print them, digits after it included. NULL if it is
 * none. */
static const char *scan_windows(const char *p, const char *end, float *value)
{
    const bool infinite = begins(p + 1, end, "inf");
    if (p[-1] != '.' ||
        !(infinite || begins(p + 1, end, "ind") || begins(p + 1, end, "qnan") || begins(p + 1, end, "snan")))
        return NULL;
    *value = infinite ? INFINITY : NAN;
    for (++p; p < end && ((unsigned char)((*p | 0x20) - 'a') < 26 || is_digit(p, end)); ++p) {
    }
    return p;
}

const char *sph__io_parse_float(const char *p, const char *end, float *value)
{
    decimal number;
    const char *after;
    const bool negative = p < end && *p == '-';
    if (p < end && (*p == '-' || *p == '+')) ++p;
    after = scan_decimal(p, end, &number);
    if (after == NULL) {
        after = scan_special(p, end, value);
        if (after == NULL) return NULL;
    } else {
        const char *special = after < end && *after == '#' ? scan_windows(after, end, value) : NULL;
        if (special != NULL)
            after = special;
        else
            *value = round_decimal(&number);
    }
    if (negative) *value = -*value;
    return after;
}

/* --- writing --- */

/* The nine significant digits of a positive finite float, as integer * 10^*exponent; off by at most one in the last. */
static uint64_t nine_digits(float value, int *exponent)
{
    double scaled = value;
    int power = (int)floor(log10(scaled)) - 8;
    /* Two steps for the least floats, whose power is beyond the table. */
    if (-power > MOST_POWER) {
        scaled *= POWERS[MOST_POWER - LEAST_POWER];
        scaled *= POWERS[-power - MOST_POWER - LEAST_POWER];
    } else {
        scaled *= POWERS[-power - LEAST_POWER];
    }
    if (scaled >= 999999999.5) {
        scaled /= 10;
        ++power;
    } else if (scaled < 99999999.5) {
        scaled *= 10;
        --power;
    }
    *exponent = power;
    return (uint64_t)(scaled + 0.5);
}

/* Lays out digits * 10^exponent, without zeros at the end. */
static size_t lay_out(char *text, uint64_t digits, int exponent)
{
    char reversed[20];
    int count = 0, point;
    char *p = text;
    for (; digits % 10 == 0; digits /= 10)
        ++exponent;
    for (; digits != 0; digits /= 10)
        reversed[count++] = (char)('0' + digits % 10);
    point = count + exponent; /* digits before the point */
    if (point > 9 || point < -4) {
        *p++ = reversed[count - 1];
        if (count > 1) *p++ = '.';
        for (int i = 1; i < count; ++i)
            *p++ = reversed[count - 1 - i];
        *p++ = 'e';
        *p++ = point - 1 < 0 ? '-' : '+';
        point = point - 1 < 0 ? 1 - point : point - 1;
        *p++ = (char)('0' + point / 10);
        *p++ = (char)('0' + point % 10);
    } else if (point <= 0) {
        *p++ = '0';
        *p++ = '.';
        for (int i = point; i < 0; ++i)
            *p++ = '0';
        while (count > 0)
            *p++ = reversed[--count];
    } else {
        for (int i = 0; i < count || i < point; ++i) {
            if (i == point) *p++ = '.';
            *p++ = i < count ? reversed[count - 1 - i] : '0';
        }
    }
    *p = '\0';
    return (size_t)(p - text);
}

size_t sph__io_format_float(char text[SPH__IO_FLOAT_TEXT], float value)
{
    static const uint64_t CUTS[] = {1000, 100, 10, 1}; /* 6 to 9 digits */
    char *p = text;
    size_t length = 0;
    uint64_t digits;
    int exponent;
    if (signbit(value) && !isnan(value)) *p++ = '-';
    value = fabsf(value);
    if (!isfinite(value) || value == 0) {
        memcpy(p, isnan(value) ? "nan" : isinf(value) ? "inf" : "0\0\0", 4);
        return strlen(text);
    }
    digits = nine_digits(value, &exponent);
    for (int i = 0; i < 4; ++i) {
        const uint64_t cut = (digits + CUTS[i] / 2) / CUTS[i];
        float back;
        length = lay_out(p, cut, exponent + 3 - i);
        if (sph__io_parse_float(p, p + length, &back) != NULL && back == value) break;
    }
    return (size_t)(p - text) + length;
}
