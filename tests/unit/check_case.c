/* SPDX-License-Identifier: MIT */
#include "check_case.h"

#include <check.h>

sph_animation_report check(const sph_animation *animation)
{
    sph_animation_report report;
    ck_assert_ptr_nonnull(animation);
    sph_animation_report_init(&report, sizeof report);
    ck_assert_int_eq(sph_animation_check(animation, &report), SPH_OK);
    ck_assert_uint_eq(report.struct_size, sizeof report);
    ck_assert_uint_eq(report.reserved0, 0);
    return report;
}

sph_animation_report check_and_destroy(sph_animation *animation)
{
    const sph_animation_report report = check(animation);
    sph_animation_destroy(animation);
    return report;
}
