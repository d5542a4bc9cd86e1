/* SPDX-License-Identifier: MIT */
/** @file version.h Version of the headers and of the library that runs. */
#ifndef SPHMESH_VERSION_H
#define SPHMESH_VERSION_H

#include <stdint.h>

#include "export.h"

/** Grows when programs must be built anew (docs/abi.md). */
#define SPH_VERSION_MAJOR 0
/** Grows when something is added. */
#define SPH_VERSION_MINOR 1
/** Grows when something is mended. */
#define SPH_VERSION_PATCH 0

/** Version of the headers as one number that grows: major * 1000000 + minor * 1000 + patch. */
#define SPH_VERSION (SPH_VERSION_MAJOR * 1000000 + SPH_VERSION_MINOR * 1000 + SPH_VERSION_PATCH)

SPH_BEGIN_DECLS

/**
 * @brief Version of the library that runs, in the form of #SPH_VERSION.
 * @par Thread safety  Any number of threads.
 * @since 0.1
 */
SPH_API uint32_t sph_version(void);

SPH_END_DECLS

#endif
