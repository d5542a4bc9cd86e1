/* SPDX-License-Identifier: MIT */
/* Names of files that belong to frames. */
#ifndef NUMBERED_H
#define NUMBERED_H

#include <stdint.h>

#include "options.h"

/*
 * The name of the file of a frame, to be freed; NULL when out of memory. A %d in the name, also as %4d or %04d, becomes
 * the number; else it goes before the ending, with as many digits as `last` has but at least four: out-0012.ply.
 */
char *numbered_name(const char *path, uint32_t number, uint32_t last);

/* Has the name such a %d? */
bool name_is_pattern(const char *path);

/* Frames of 0 .. frame_count - 1 that a range has. */
uint32_t range_count(const frame_range *range, uint32_t frame_count);

#endif
