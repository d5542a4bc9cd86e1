/* SPDX-License-Identifier: MIT */
/* What the tests of sph_animation_check() share. */
#ifndef SPH_TEST_CHECK_CASE_H
#define SPH_TEST_CHECK_CASE_H

#include "support.h"

sph_animation_report check(const sph_animation *animation);
sph_animation_report check_and_destroy(sph_animation *animation);

#endif
