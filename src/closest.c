/* SPDX-License-Identifier: MIT */
/* What a mistyped word was probably meant to be. */
#include <string.h>

#include "program.h"

enum { WORD_MAX = 40 };

/* Letters to insert, drop or replace to get from one word to the other (Levenshtein). */
static size_t edit_distance(const char *a, const char *b)
{
    size_t row[WORD_MAX + 1];
    const size_t m = strlen(a), n = strlen(b);
    if (m > WORD_MAX || n > WORD_MAX) return WORD_MAX;
    for (size_t j = 0; j <= n; ++j)
        row[j] = j;
    for (size_t i = 1; i <= m; ++i) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= n; ++j) {
            const size_t replaced = diagonal + (a[i - 1] != b[j - 1]);
            const size_t other = (row[j] < row[j - 1] ? row[j] : row[j - 1]) + 1;
            diagonal = row[j];
            row[j] = replaced < other ? replaced : other;
        }
    }
    return row[n];
}

const char *closest_name(const char *word, const char *const *names, size_t count)
{
    const size_t length = strlen(word);
    size_t least = length < 4 ? 2 : length < 7 ? 3 : 4; /* this far is no likeness */
    const char *best = NULL;
    for (size_t i = 0; i < count; ++i) {
        const bool begins = length >= 3 && strncmp(word, names[i], length) == 0;
        const size_t distance = begins ? 1 : edit_distance(word, names[i]);
        if (distance >= least) continue;
        least = distance;
        best = names[i];
    }
    return best;
}
