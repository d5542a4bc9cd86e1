/* SPDX-License-Identifier: MIT */
/* STL names no vertices: each triangle brings its corners along. */
#ifndef SPH_IO_STL_H
#define SPH_IO_STL_H

#include "io/reader.h"

/*
 * The vertices of `mesh` are the corners of its triangles, one after the other: makes one vertex of those that
 * coincide, and sets the triangles. A mesh that belongs to a sequence is welded as the first one was; refuses one whose
 * corners stand in another order.
 */
sph_status sph__stl_weld(const char *path, sph__io_mesh *mesh);

#endif
