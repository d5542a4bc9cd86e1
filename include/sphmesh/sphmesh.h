/* SPDX-License-Identifier: MIT */
/** @file sphmesh.h Everything of the core library. Reading and writing files is io.h, of libsphmesh-io. */
#ifndef SPHMESH_SPHMESH_H
#define SPHMESH_SPHMESH_H

#include "animation.h"
#include "context.h"
#include "coverage.h"
#include "hierarchy.h"
#include "implicit.h"
#include "level.h"
#include "measure.h"
#include "pose.h"
#include "quadric.h"
#include "query.h"
#include "simplify.h"
#include "skeleton.h"
#include "skin.h"
#include "surface.h"
#include "version.h"

#endif
