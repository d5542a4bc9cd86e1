/* SPDX-License-Identifier: MIT */
/** @file export.h Visibility of the public symbols. */
#ifndef SPHMESH_EXPORT_H
#define SPHMESH_EXPORT_H

#if defined(__GNUC__) || defined(__clang__)
#  define SPH_API __attribute__((visibility("default")))
#else
#  define SPH_API
#endif

#ifdef __cplusplus
#  define SPH_BEGIN_DECLS extern "C" {
#  define SPH_END_DECLS }
#else
#  define SPH_BEGIN_DECLS
#  define SPH_END_DECLS
#endif

#endif
