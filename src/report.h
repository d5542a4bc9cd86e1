/* SPDX-License-Identifier: MIT */
/* What several commands print: checks in words, distances, hierarchies. */
#ifndef REPORT_H
#define REPORT_H

#include <sphmesh/sphmesh.h>

#include "json.h"

/* Counts with thousands apart: "14 980". Up to eight texts live at once. */
const char *count_text(uint64_t count);
/* "3.1 MB". The same eight texts. */
const char *size_text(uint64_t bytes);

/* What deserves attention in a check, each with a hint; says so where nothing does. */
void report_check(const sph_animation_report *r);
void report_check_json(json *j, const sph_animation_report *r);

/* The distances as members of the open object, times `factor`. */
void report_distances_json(json *j, const sph_distances *d, double factor);

/* Error of the level with so many spheres, model units. */
double level_error(const sph_hierarchy *h, uint32_t sphere_count);
uint32_t coarsest_count(const sph_hierarchy *h);

#endif
